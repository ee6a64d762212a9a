//! Kinds of cases about B-spline developable nets and their interpolation.

use super::value::{number, numbers, vector, vectors, Case, Checks};
use serde_json::Value;
use torse::design::interpolate::{interpolate, rational_for, solvability, EndRulings, Options};
use torse::geom::Vec3;
use torse::spline::curve::Curve;
use torse::torse::net::{from_first_cell, from_paper_knots, homogeneous, paper_knots, recognise, Net, NetKind, Shape};

/// Allowed where the file states nothing.
const TOLERANCE: f64 = 1e-9;

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    Some(match case.kind.as_str() {
        "build" => build(&case.input, &case.output),
        "build_mk" => build_mk(&case.input, &case.output),
        "from_first_cell" => first_cell(&case.input, &case.output),
        "build_error" => build_error(&case.input),
        "interpolate_end_rulings" => end_rulings(&case.input, &case.output),
        "interpolate_both_ends" => both_ends(&case.input, &case.output),
        "rational_interpolate" => rational(&case.input, &case.output),
        _ => return None,
    })
}

fn curve(input: &Value) -> Result<Curve<3>, String> {
    let degree = number(input, "degree")? as usize;
    let control = vectors::<3>(input, "c")?;
    let knots = from_paper_knots(degree, &numbers(input, "knots")?, control.len()).map_err(|e| e.to_string())?;
    Curve::new(degree, knots.values().to_vec(), control).map_err(|e| e.to_string())
}

fn point(input: &Value, key: &str) -> Result<Vec3, String> {
    vector::<3>(input, key).map(Vec3::from)
}

fn flat(points: &[[f64; 3]]) -> Vec<f64> {
    points.as_flattened().to_vec()
}

fn coordinates(points: impl IntoIterator<Item = Vec3>) -> Vec<f64> {
    points.into_iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// The opposite control points against the case's `d`.
fn opposite(checks: &mut Checks, net: &Net, output: &Value) -> Result<(), String> {
    let d: Vec<f64> = net.opposite_points().iter().flat_map(|p| [p[0] / p[3], p[1] / p[3], p[2] / p[3]]).collect();
    checks.all_close("d", &d, &flat(&vectors::<3>(output, "d")?), TOLERANCE);
    Ok(())
}

fn regular(checks: &mut Checks, net: &Net, output: &Value) {
    if let Some(expected) = output["regular"].as_bool() {
        checks.holds("regularity", net.regularity().holds() == expected);
    }
}

/// Determinant of c', d' and d − c against their lengths: what makes the net developable.
fn developable(checks: &mut Checks, net: &Net) -> Result<(), String> {
    let patch = net.patch().map_err(|e| e.to_string())?;
    let ((a, b), _) = patch.domain();
    for k in 0..=40 {
        let u = a + (b - a) * f64::from(k) / 40.0;
        let (p, q) = (patch.jet(u, 0.0), patch.jet(u, 1.0));
        let scale = p.du.norm() * q.du.norm() * p.dv.norm();
        checks.at_most("det(c', d', d - c)", p.du.cross(&q.du).dot(&p.dv).abs(), 1e-12 * scale);
    }
    Ok(())
}

fn build(input: &Value, output: &Value) -> Result<Checks, String> {
    let c = curve(input)?;
    let shape = Shape::from_stars(c.domain(), number(input, "Lstar")?, number(input, "Mstar")?).ok_or("no shape")?;
    let net = Net::through(&c, &point(input, "d0")?, shape).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    opposite(&mut checks, &net, output)?;
    regular(&mut checks, &net, output);
    developable(&mut checks, &net)?;
    let (degree, knots) = (net.degree(), paper_knots(&net.curve().knots));
    let breaks = net.curve().knots.breaks();
    let segments: Vec<[f64; 2]> = breaks.windows(2).map(|w| shape.of_segment(w[0], w[1])).collect();
    let cells: Vec<[f64; 2]> =
        (1..net.rulings().len()).map(|i| shape.of_cell(knots[i - 1], knots[i + degree - 1])).collect();
    for (key, column) in [("Lambda_seg", 0), ("M_seg", 1)] {
        if output.get(key).is_some() {
            let got: Vec<f64> = segments.iter().map(|s| s[column]).collect();
            checks.all_close(key, &got, &numbers(output, key)?, TOLERANCE);
        }
    }
    for (key, column) in [("lam", 0), ("mu", 1)] {
        if output.get(key).is_some() {
            let got: Vec<f64> = cells.iter().map(|s| s[column]).collect();
            checks.all_close(key, &got, &numbers(output, key)?, TOLERANCE);
        }
    }
    let parameters = numbers(input, "params")?;
    let d = net.opposite();
    let on = |f: &dyn Fn(f64) -> Vec3| coordinates(parameters.iter().map(|&u| f(u)));
    let slope = |c: &Curve<4>, u: f64| Vec3::new(c.jet(u)[1][0], c.jet(u)[1][1], c.jet(u)[1][2]);
    let curves: [(&str, Vec<f64>); 5] = [
        ("c_pts", on(&|u| net.ruling(u)[0])),
        ("d_pts", on(&|u| net.ruling(u)[1])),
        ("c_der", on(&|u| slope(net.curve(), u))),
        ("d_der", on(&|u| slope(&d, u))),
        ("regression_points", on(&|u| net.regression_point(u).unwrap_or(Vec3::repeat(f64::NAN)))),
    ];
    for (key, got) in &curves {
        if output.get(*key).is_some() {
            checks.all_close(key, got, &flat(&vectors::<3>(output, key)?), TOLERANCE);
        }
    }
    if output.get("v_regression").is_some() {
        let got: Vec<f64> = parameters.iter().map(|&u| net.regression(u)).collect();
        checks.all_close("v_regression", &got, &numbers(output, "v_regression")?, TOLERANCE);
    }
    // The patch as it would be written is read back as the same net.
    let back = recognise(&net.patch().map_err(|e| e.to_string())?).map_err(|e| e.to_string())?;
    let scale = net.opposite_points().as_flattened().iter().fold(1.0f64, |m, x| m.max(x.abs()));
    checks.at_most("read back", back.deviation, TOLERANCE * scale);
    Ok(checks)
}

fn build_mk(input: &Value, output: &Value) -> Result<Checks, String> {
    let c = curve(input)?;
    let shape = Shape::new(c.domain(), number(input, "m")?, number(input, "kappa")?);
    let net = Net::through(&c, &point(input, "d0")?, shape).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    opposite(&mut checks, &net, output)?;
    regular(&mut checks, &net, output);
    developable(&mut checks, &net)?;
    if output.get("cone_vertex").is_some() {
        match net.kind() {
            NetKind::Cone { vertex } => {
                checks.all_close("vertex", &coordinates([vertex]), &numbers(output, "cone_vertex")?, TOLERANCE);
            }
            other => return Err(format!("a cone is expected, not {other:?}")),
        }
    }
    Ok(checks)
}

fn first_cell(input: &Value, output: &Value) -> Result<Checks, String> {
    let net = from_first_cell(&curve(input)?, &point(input, "d0")?, &point(input, "d1")?).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    checks.close("Lambda*", net.shape().lambda_star(), number(output, "Lstar")?, TOLERANCE);
    checks.close("M*", net.shape().m_star(), number(output, "Mstar")?, TOLERANCE);
    opposite(&mut checks, &net, output)?;
    developable(&mut checks, &net)?;
    Ok(checks)
}

fn build_error(input: &Value) -> Result<Checks, String> {
    let c = curve(input)?;
    let mut checks = Checks::default();
    let shape = Shape::from_stars(c.domain(), number(input, "Lstar")?, number(input, "Mstar")?);
    let refused =
        shape.is_none_or(|s| Net::through(&c, &Vec3::from(vector::<3>(input, "d0").unwrap_or([0.0; 3])), s).is_err());
    checks.holds("M* on a knot is refused", refused);
    Ok(checks)
}

/// Allowed for roots of the solvability polynomial and what follows from them, as the file says.
const ROOT_TOLERANCE: f64 = 1e-8;

fn lines(input: &Value) -> Result<EndRulings, String> {
    Ok(EndRulings { start: point(input, "ruling_a")?, end: point(input, "ruling_b")? })
}

fn end_rulings(input: &Value, output: &Value) -> Result<Checks, String> {
    let c = homogeneous(&curve(input)?);
    let (a, b) = c.domain();
    let lines = lines(input)?;
    let options = Options { reach: number(input, "sigma")?, ..Options::default() };
    let count = solvability(&c, &lines).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    checks.all_close("delta", &count.delta, &numbers(output, "delta")?, TOLERANCE);
    checks.holds("the count is certain", count.certain);
    checks.all_close("regular roots", &count.regular, &numbers(output, "regular_roots_m")?, ROOT_TOLERANCE);
    let inside = count.singular.iter().map(|m_star| 1.0 / (m_star - 0.5 * (a + b)));
    let mut all: Vec<f64> = count.regular.iter().copied().chain(inside).collect();
    all.sort_by(f64::total_cmp);
    checks.all_close("real roots", &all, &numbers(output, "real_roots_m")?, ROOT_TOLERANCE);
    let answer = interpolate(&c, &lines, &options).map_err(|e| e.to_string())?;
    let expected = output["solutions"].as_array().ok_or("no solutions")?;
    checks.holds("number of solutions", answer.candidates.len() == expected.len());
    for want in expected {
        let m = number(want, "m")?;
        let off = |x: f64| (x - m).abs();
        let got = answer
            .candidates
            .iter()
            .min_by(|x, y| off(x.strip.net.shape().m).total_cmp(&off(y.strip.net.shape().m)))
            .ok_or("a solution is missing")?;
        let shape = got.strip.net.shape();
        let pairs = [
            ("m", shape.m),
            ("Mstar", shape.m_star()),
            ("Lstar", shape.lambda_star()),
            ("kappa", shape.kappa),
            ("sigma", got.start_reach),
            ("tau", got.end_reach),
        ];
        for (key, value) in pairs {
            checks.close(key, value, number(want, key)?, ROOT_TOLERANCE);
        }
        checks.at_most("end rulings", got.end_error, 1e-9);
        // The file's clearance is the least over 33 rulings; the one found between them is no larger.
        let net = &got.strip.net;
        let sampled = (0..=32)
            .map(|k| a + (b - a) * f64::from(k) / 32.0)
            .map(|u| net.regression_point(u).map_or(f64::INFINITY, |r| (r - net.ruling(u)[0]).norm()))
            .fold(f64::INFINITY, f64::min);
        checks.close("clearance", sampled, number(want, "clearance")?, ROOT_TOLERANCE);
        checks.holds("least clearance", got.clearance_estimate <= sampled);
        regular(&mut checks, &got.strip.net, want);
        let d: Vec<f64> = got.strip.net.opposite_points().iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        checks.all_close("d", &d, &flat(&vectors::<3>(want, "d")?), ROOT_TOLERANCE);
    }
    for s in &answer.strips {
        checks.holds("strips are regular", s.regularity.holds() && s.start_reach > 0.0 && s.end_reach > 0.0);
        developable(&mut checks, &s.strip.net)?;
    }
    Ok(checks)
}

fn both_ends(input: &Value, output: &Value) -> Result<Checks, String> {
    let c = homogeneous(&curve(input)?);
    let options =
        Options { reach: number(input, "sigma")?, end_reach: Some(number(input, "tau")?), ..Options::default() };
    let answer = interpolate(&c, &lines(input)?, &options).map_err(|e| e.to_string())?;
    let m = number(output, "m")?;
    let got = answer
        .candidates
        .iter()
        .find(|s| (s.strip.net.shape().m - m).abs() <= ROOT_TOLERANCE * m.abs().max(1.0))
        .ok_or("no candidate with that m")?;
    let mut checks = Checks::default();
    checks.close("m", got.strip.net.shape().m, m, ROOT_TOLERANCE);
    checks.close("tau", got.end_reach, number(input, "tau")?, TOLERANCE);
    checks.holds("regularity", got.regularity.holds() == output["regular"].as_bool().unwrap_or(true));
    let (c, d) = got.strip.boundaries().map_err(|e| e.to_string())?;
    checks.holds("degree", c.knots.degree() as f64 == number(output, "degree")?);
    checks.all_close("knots", paper_knots(&c.knots), &numbers(output, "knots")?, TOLERANCE);
    for (key, curve) in [("c", &c), ("d", &d)] {
        let got: Vec<f64> = curve.control.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        checks.all_close(key, &got, &flat(&vectors::<3>(output, key)?), ROOT_TOLERANCE);
    }
    Ok(checks)
}

fn rational(input: &Value, output: &Value) -> Result<Checks, String> {
    let c = curve(input)?;
    let weights = numbers(input, "weights")?;
    let control = c.control.iter().zip(&weights).map(|(p, w)| [w * p[0], w * p[1], w * p[2], *w]).collect();
    let c = Curve { knots: c.knots, control };
    let options = Options { reach: number(input, "sigma")?, ..Options::default() };
    let got = rational_for(&c, &lines(input)?, &options, number(input, "m")?)
        .map_err(|e| e.to_string())?
        .ok_or("no rational net")?;
    let shape = got.strip.net.shape();
    let mut checks = Checks::default();
    checks.close("kappa", shape.kappa, number(output, "kappa")?, TOLERANCE);
    checks.close("tau", got.end_reach, number(output, "tau")?, TOLERANCE);
    checks.close("Mstar", shape.m_star(), number(output, "Mstar")?, TOLERANCE);
    checks.close("Lstar", shape.lambda_star(), number(output, "Lstar")?, TOLERANCE);
    checks.at_most("end rulings", got.end_error, 1e-9);
    checks.holds("regularity", got.regularity.holds() == output["regular"].as_bool().unwrap_or(true));
    // The file writes the weight first.
    let d: Vec<f64> = got.strip.net.opposite_points().iter().flat_map(|p| [p[3], p[0], p[1], p[2]]).collect();
    let expected = vectors::<4>(output, "d_hom")?;
    checks.all_close("d", &d, expected.as_flattened(), TOLERANCE);
    developable(&mut checks, &got.strip.net)?;
    Ok(checks)
}
