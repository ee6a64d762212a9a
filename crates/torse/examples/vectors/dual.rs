//! Kinds of cases about developables as curves in dual space.

use super::value::{number, numbers, vector, vectors, Case, Checks};
use serde_json::Value;
use torse::fit::planes::correction::corrected;
use torse::fit::planes::estimates::{planes_of_rulings, Ends};
use torse::fit::planes::frame::frame_of_normals;
use torse::fit::planes::linear_system::{planes, slope_weight, PlaneDatum, PlanesOptions};
use torse::fit::planes::multiresolution::trigonometric::{cone_strip, ConeStrip, ContourMetric, RadiusSign};
use torse::fit::planes::multiresolution::wavelets::split;
use torse::fit::planes::reduce::reduced;
use torse::fit::planes::regression::{regression_free, ForbiddenZone, RegressionOptions};
use torse::fit::planes::rulings::{slope_fit, PointDatum, RulingDatum, SlopeData, SlopeOptions};
use torse::fit::planes::Freedom;
use torse::geom::measure::{LineMeasure, Measure};
use torse::geom::Vec3;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::torse::dual::{DualCurve, DualKind, Plane};

/// Relative difference that is allowed.
const ALLOWED: f64 = 1e-9;

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    let (i, o) = (&case.input, &case.output);
    Some(match case.kind.as_str() {
        "dual_eval" => dual_eval(i, o),
        "tp_type3" => polynomial_form(i, o),
        "tp_rational_type1" => rational_form(i, o),
        "metric" => metric(i, o),
        "F1_type2" => f1(i, o),
        "param_correction" => parameter_correction(i, o),
        "frame" => frame(i, o),
        "F2_degree_reduction" => f2(i, o),
        "F3_type3" => f3(i, o),
        "regression_control" => regression_control(i, o),
        "mra_bspline" => wavelets(i, o),
        "mra_trig" => trigonometric(i, o),
        "plane_estimation" => estimation(i, o),
        _ => return None,
    })
}

fn text<E: std::fmt::Display>(e: E) -> String {
    e.to_string()
}

fn list<'a>(v: &'a Value, key: &str) -> Result<&'a Vec<Value>, String> {
    v[key].as_array().ok_or_else(|| format!("`{key}` is not a list"))
}

fn degree(v: &Value) -> Result<usize, String> {
    Ok(number(v, "degree")? as usize)
}

fn knots(v: &Value, degree: usize, key: &str) -> Result<Knots, String> {
    let values = numbers(v, key)?;
    let control = values.len().saturating_sub(degree + 1);
    Knots::new(degree, values, control).map_err(text)
}

fn gram(v: &Value, key: &str) -> Result<Measure, String> {
    let rows: [[f64; 3]; 3] = vectors::<3>(v, key)?.try_into().map_err(|_| format!("`{key}` is not 3x3"))?;
    Measure::of_gram(rows).map_err(text)
}

/// The plane `u0 + u1 x + u2 y + u3 z = 0` of the paper.
fn plane([u0, u1, u2, u3]: [f64; 4]) -> Plane {
    [u1, u2, u3, -u0]
}

/// The paper's coordinates of planes of a curve, where those that are graphs have `u3 = −1`.
fn coordinates(of: &DualCurve, [x, y, z, h]: Plane) -> [f64; 4] {
    let u = [-h, x, y, z];
    if of.kind() == DualKind::General {
        u
    } else {
        u.map(|x| -x)
    }
}

fn curve_of_type(i: &Value) -> Result<DualCurve, String> {
    let (k, knots, control) = (degree(i)?, numbers(i, "knots")?, vectors::<4>(i, "control_planes")?);
    match number(i, "type")? as i64 {
        2 => DualCurve::graph(k, knots, &control.iter().map(|c| [c[0], c[1], c[2]]).collect::<Vec<_>>()),
        3 => DualCurve::slope(k, knots, &control.iter().map(|c| [c[0], c[1]]).collect::<Vec<_>>()),
        _ => DualCurve::general(k, knots, control.into_iter().map(plane).collect()),
    }
    .map_err(text)
}

/// Compares rows of coordinates.
fn rows<const D: usize>(c: &mut Checks, what: &str, got: &[[f64; D]], wanted: &[[f64; D]]) {
    c.all_close(what, got.as_flattened(), wanted.as_flattened(), ALLOWED);
}

fn dual_eval(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let s = curve_of_type(i)?;
    let control: Vec<[f64; 4]> = s.planes().control.iter().map(|p| coordinates(&s, *p)).collect();
    rows(&mut c, "control planes", &control, &vectors::<4>(o, "control_planes")?);
    for e in list(o, "eval")? {
        let t = number(e, "t")?;
        let jet = s.jet(t).map(|p| coordinates(&s, p));
        for (key, got) in ["U", "dU", "ddU"].into_iter().zip(&jet) {
            c.all_close(key, got, &vector::<4>(e, key)?, ALLOWED);
        }
        let r = s.ruling(t).map_err(text)?;
        c.all_close("ruling point", r.point.as_slice(), &numbers(e, "ruling_point_closest_to_origin")?, ALLOWED);
        let d = Vec3::from(vector::<3>(e, "ruling_dir")?);
        c.all_close("ruling direction", (r.direction * r.direction.dot(&d).signum()).as_slice(), d.as_slice(), ALLOWED);
        let wanted = numbers(e, "regression_point")?;
        let p = s.regression_point(t);
        c.all_close("regression point", &[p[0] / p[3], p[1] / p[3], p[2] / p[3]], &wanted, ALLOWED);
        let piece = s.regression_curve().map_err(text)?.into_iter().find(|q| q.a <= t && t <= q.b);
        let piece = piece.ok_or("no piece of the regression curve")?;
        let q = piece.points.point((t - piece.a) / (piece.b - piece.a));
        c.all_close("regression curve", &[q[0] / q[3], q[1] / q[3], q[2] / q[3]], &wanted, ALLOWED);
    }
    Ok(c)
}

fn polynomial_form(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let s = DualCurve::slope(degree(i)?, numbers(i, "knots")?, &vectors::<2>(i, "u01")?).map_err(text)?;
    let (a, b) = (number(i, "a")?, number(i, "b")?);
    let patch = s.tensor_product(a, b).map_err(text)?;
    c.all_close("knots", patch.knots_u.values(), &numbers(o, "out_knots")?, ALLOWED);
    for (v, key) in ["Ca", "Cb"].into_iter().enumerate() {
        let got: Vec<[f64; 3]> = patch.control.iter().skip(v).step_by(2).map(|p| [p[0], p[1], p[2]]).collect();
        rows(&mut c, key, &got, &vectors::<3>(o, key)?);
    }
    Ok(c)
}

fn rational_form(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let control = vectors::<4>(i, "control_planes")?.into_iter().map(plane).collect();
    let s = DualCurve::general(degree(i)?, numbers(i, "knots")?, control).map_err(text)?;
    let (a, b) = (plane(vector::<4>(i, "planeA")?), plane(vector::<4>(i, "planeB")?));
    let curves = [s.rational_section(&a).map_err(text)?, s.rational_section(&b).map_err(text)?];
    c.close("degree", curves[0].knots.degree() as f64, number(o, "out_degree")?, ALLOWED);
    for e in list(o, "points")? {
        let t = number(e, "t")?;
        for (curve, key) in curves.iter().zip(["PA", "PB"]) {
            let p = curve.point(t);
            c.all_close(key, &[p[0] / p[3], p[1] / p[3], p[2] / p[3]], &numbers(e, key)?, ALLOWED);
        }
    }
    for span in list(o, "spans")? {
        let (from, to) = (number(span, "a")?, number(span, "b")?);
        let mut factor = None;
        for (curve, key) in curves.iter().zip(["A_homog", "B_homog"]) {
            let part = curve.restricted(from, to).map_err(text)?;
            // Weight first in the file.
            let wanted: Vec<[f64; 4]> = vectors::<4>(span, key)?.iter().map(|p| [p[1], p[2], p[3], p[0]]).collect();
            // One factor common to both boundaries of a span is free.
            let f = *factor.get_or_insert(wanted[0][3] / part.control[0][3]);
            let got: Vec<[f64; 4]> = part.control.iter().map(|p| p.map(|x| f * x)).collect();
            rows(&mut c, key, &got, &wanted);
        }
    }
    // The patch between the planes exists where weights keep their sign; where not, it is refused.
    if let Ok(patch) = s.rational_tensor_product(&a, &b) {
        for e in list(o, "points")? {
            let p = patch.point(number(e, "t")?, 0.0);
            c.all_close("patch", p.as_slice(), &numbers(e, "PA")?, ALLOWED);
        }
    }
    Ok(c)
}

fn metric(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let (u, v) = (vector::<3>(i, "U1")?, vector::<3>(i, "U2")?);
    let difference = [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
    for e in list(o, "cases")? {
        let d = &e["data"];
        let measure = match e["kind"].as_str() {
            Some("rect") => {
                let r = vector::<4>(e, "data")?;
                Measure::rectangle([r[0], r[1]], [r[2], r[3]])
            }
            Some("polygon") => Measure::polygon(&vectors::<2>(e, "data")?),
            Some("disc") => {
                let r = vector::<3>(e, "data")?;
                Measure::disc([r[0], r[1]], r[2])
            }
            _ => {
                let points: Vec<[f64; 2]> = serde_json::from_value(d[0].clone()).map_err(text)?;
                let masses: Vec<f64> = serde_json::from_value(d[1].clone()).map_err(text)?;
                Measure::masses(&points, &masses)
            }
        }
        .map_err(text)?;
        rows(&mut c, "gram", measure.gram(), &vectors::<3>(e, "gram")?);
        c.close("distance", measure.distance_sq(&difference), number(e, "d2")?, ALLOWED);
        let three = measure.three_masses(0.0).map(|p| [p.x, p.y]);
        let wanted = measure.scaled(3.0 / measure.mass());
        for points in [three.to_vec(), vectors::<2>(e, "three_points_theta0")?] {
            let again = Measure::masses(&points, &[1.0; 3]).map_err(text)?;
            rows(&mut c, "three masses", again.gram(), wanted.gram());
        }
    }
    Ok(c)
}

fn plane_data(i: &Value, parameters: &[f64]) -> Result<Vec<PlaneDatum>, String> {
    let measure = gram(i, "gram_base")?;
    let given = vectors::<3>(i, "planes")?;
    Ok(given
        .iter()
        .zip(parameters)
        .map(|(&plane, &parameter)| PlaneDatum { plane, parameter, measure, weight: slope_weight(&plane) })
        .collect())
}

fn control_of(s: &DualCurve) -> Vec<[f64; 3]> {
    s.graphs().control
}

/// The case that another one refers to by its kind.
fn remembered(set: Option<&Value>) -> Option<Value> {
    use std::cell::RefCell;
    thread_local!(static LAST: RefCell<Option<Value>> = const { RefCell::new(None) });
    LAST.with(|last| {
        if let Some(v) = set {
            *last.borrow_mut() = Some(v.clone());
        }
        last.borrow().clone()
    })
}

fn f1(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    remembered(Some(i));
    let data = plane_data(i, &numbers(i, "params")?)?;
    let weights: Vec<f64> = data.iter().map(|d| d.weight).collect();
    c.all_close("weights", &weights, &numbers(o, "weight_values")?, ALLOWED);
    let knots = knots(i, degree(i)?, "knots")?;
    let fit = planes(&data, &knots, &PlanesOptions::default()).map_err(text)?;
    rows(&mut c, "control", &control_of(&fit.curve), &vectors::<3>(o, "control")?);
    let wanted = number(o, "F1")?;
    c.at_most("F1", (fit.cost - wanted).abs(), ALLOWED * wanted);
    let mut conditions = Vec::new();
    for (key, _) in i["fixed"].as_object().ok_or("`fixed` is not an object")? {
        let index: usize = key.parse().map_err(text)?;
        conditions.push((index, Freedom::Fixed(vector::<3>(&i["fixed"], key)?)));
    }
    let fit = planes(&data, &knots, &PlanesOptions { conditions, ..PlanesOptions::default() }).map_err(text)?;
    rows(&mut c, "control with fixed ends", &control_of(&fit.curve), &vectors::<3>(o, "control_fixed")?);
    let wanted = number(o, "F1_fixed")?;
    c.at_most("F1 with fixed ends", (fit.cost - wanted).abs(), ALLOWED * wanted);
    Ok(c)
}

fn parameter_correction(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let base = remembered(None).ok_or("the case of kind F1_type2 that holds the data must come first")?;
    let data = plane_data(&base, &numbers(i, "start_params")?)?;
    let wanted = numbers(o, "F1_history")?;
    let knots = knots(&base, degree(&base)?, "knots")?;
    let got = corrected(&data, &knots, &PlanesOptions::default(), wanted.len() - 1).map_err(text)?;
    c.all_close("F1 history", &got.history, &wanted, ALLOWED);
    for (a, b) in got.history.iter().zip(&wanted) {
        c.at_most("F1", (a - b).abs(), ALLOWED * b);
    }
    Ok(c)
}

fn frame(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let normals: Vec<Vec3> = vectors::<3>(i, "normals")?.into_iter().map(Vec3::from).collect();
    let got = frame_of_normals(&normals).map_err(text)?;
    c.all_close("e", got.frame.z.as_slice(), &numbers(o, "e")?, ALLOWED);
    let y = Vec3::from(vector::<3>(o, "axis_y_up_to_sign")?);
    c.all_close("second axis", (got.frame.y * got.frame.y.dot(&y).signum()).as_slice(), y.as_slice(), ALLOWED);
    c.close("smallest cosine", got.min_cosine, number(o, "min_cos")?, ALLOWED);
    Ok(c)
}

fn f2(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let from = number(i, "from_degree")? as usize;
    let source = DualCurve::graph(from, numbers(i, "from_knots")?, &vectors::<3>(i, "from_control")?).map_err(text)?;
    let knots = knots(i, number(i, "to_degree")? as usize, "to_knots")?;
    let measure = gram(i, "gram")?;
    for (keep, control, cost) in [(false, "control", "F2"), (true, "control_ends_fixed", "F2_ends_fixed")] {
        let got = reduced(&source, &knots, &|_| measure, keep).map_err(text)?;
        rows(&mut c, control, &control_of(&got.curve), &vectors::<3>(o, control)?);
        let wanted = number(o, cost)?;
        c.at_most(cost, (got.cost - wanted).abs(), ALLOWED * wanted);
    }
    Ok(c)
}

fn slope_planes(i: &Value, measure: Measure) -> Result<Vec<PlaneDatum>, String> {
    Ok(vectors::<3>(i, "planes")?
        .iter()
        .map(|&plane| PlaneDatum { plane, parameter: plane[2], measure, weight: 1.0 })
        .collect())
}

fn f3(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let mut data = SlopeData { planes: slope_planes(i, gram(i, "gram")?)?, ..SlopeData::default() };
    for g in list(i, "generators")? {
        let at = g["i"].as_u64().ok_or("`i` is not an index")? as usize;
        let along = vector::<2>(g, "I")?;
        data.rulings.push(RulingDatum {
            parameter: data.planes.get(at).ok_or("no such plane")?.parameter,
            ground_plan: [number(g, "h0")?, number(g, "h1")?],
            along: LineMeasure::interval(along[0], along[1]).map_err(text)?,
            weight: number(g, "alpha")?,
        });
    }
    for p in list(i, "points")? {
        data.points.push(PointDatum {
            parameter: number(p, "v")?,
            ground_plan: [number(p, "p1")?, number(p, "p2")?],
            weight: number(p, "weight")?,
        });
    }
    let fit = slope_fit(&data, &knots(i, degree(i)?, "knots")?, &SlopeOptions::default()).map_err(text)?;
    let got: Vec<[f64; 2]> = fit.curve.graphs().control.iter().map(|p| [p[0], p[1]]).collect();
    rows(&mut c, "control", &got, &vectors::<2>(o, "u01")?);
    let wanted = number(o, "F3")?;
    c.at_most("F3", (fit.cost - wanted).abs(), ALLOWED * wanted);
    Ok(c)
}

fn regression_control(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let measure = Measure::rectangle([-1.0, 1.0], [-1.0, 1.0]).map_err(text)?;
    let knots = knots(i, degree(i)?, "knots")?;
    let zone = ForbiddenZone::Slab(number(i, "a")?, number(i, "b")?);
    let options = RegressionOptions { margin: Some(number(i, "margin")?), ..RegressionOptions::default() };
    for e in list(o, "cases")? {
        let data = SlopeData { planes: slope_planes(e, measure)?, ..SlopeData::default() };
        let got = regression_free(&data, &knots, &zone, &options).map_err(text)?;
        c.close("free F3", got.free_cost, number(e, "free_F3")?, ALLOWED);
        let costs = [number(&e["plus"], "F3")?, number(&e["minus"], "F3")?];
        for (got, wanted) in got.costs.iter().zip(costs) {
            c.close("F3", got.ok_or("one side has no solution")?, wanted, ALLOWED);
        }
        let side = if got.side > 0.0 { "plus" } else { "minus" };
        c.holds("the nearer side", (got.side > 0.0) == (costs[0] <= costs[1]));
        let control: Vec<[f64; 2]> = got.fit.curve.graphs().control.iter().map(|p| [p[0], p[1]]).collect();
        rows(&mut c, "control", &control, &vectors::<2>(&e[side], "u01")?);
    }
    Ok(c)
}

fn wavelets(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let k = degree(i)?;
    let fine = Curve { knots: knots(i, k, "fine")?, control: vectors::<2>(i, "c")? };
    let got = split(&fine, &knots(i, k, "coarse")?).map_err(text)?;
    rows(&mut c, "coarse", &got.coarse.control, &vectors::<2>(o, "coarse_coeff")?);
    rows(&mut c, "detail", &got.detail.control, &vectors::<2>(o, "detail_in_fine_coeff")?);
    let again = got.joined().map_err(text)?;
    rows(&mut c, "reconstruction", &again.control, &fine.control);
    let nodes = torse::num::quadrature::gauss_legendre(k + 1);
    let mut norms = [0.0; 2];
    for w in fine.knots.breaks().windows(2) {
        for (x, weight) in &nodes {
            let p = got.detail.point(w[0] + (w[1] - w[0]) * x);
            (0..2).for_each(|d| norms[d] += weight * (w[1] - w[0]) * p[d] * p[d]);
        }
    }
    c.all_close("norm of the detail", &norms, &numbers(o, "detail_L2_sq")?, ALLOWED);
    Ok(c)
}

fn trigonometric(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let s = numbers(i, "s")?;
    let h0 = |p: f64| 2.0 + s[0] * (2.0 * p).cos() + s[1] * (3.0 * p).sin() + 0.3 * p.cos();
    let h1 = |p: f64| 1.2 + s[2] * (2.0 * p).cos() + s[3] * (3.0 * p).sin() - 0.2 * p.sin();
    let fine = cone_strip(&h0, &h1, &numbers(i, "knots")?, RadiusSign::Free).map_err(text)?;
    let coarse = fine.coarsened(&numbers(i, "coarse_knots")?).map_err(text)?;
    let direct = cone_strip(&h0, &h1, &numbers(i, "coarse_knots")?, RadiusSign::Free).map_err(text)?;
    let check = |c: &mut Checks, key: &str, strip: &ConeStrip| -> Result<(), String> {
        for (wanted, contour) in list(o, key)?.iter().zip([&strip.bottom, &strip.top]) {
            let wanted = wanted.as_array().ok_or("arcs are not a list")?;
            let arcs = contour.arcs();
            c.holds("number of arcs", arcs.len() == wanted.len());
            for (arc, w) in arcs.iter().zip(wanted) {
                c.all_close("centre", &arc.centre, &numbers(w, "centre")?, ALLOWED);
                c.close("radius", arc.radius, number(w, "radius")?, ALLOWED);
            }
        }
        Ok(())
    };
    check(&mut c, "fine", &fine)?;
    check(&mut c, "coarse", &coarse)?;
    check(&mut c, "coarse", &direct)?;
    for (key, metric) in [("dist_sq_q15", ContourMetric::Contours), ("dist_sq_q16", ContourMetric::Integral)] {
        let got = [fine.distance_sq(&h0, &h1, metric), coarse.distance_sq(&h0, &h1, metric)];
        for (a, b) in got.iter().zip(numbers(o, key)?) {
            c.at_most(key, (a - b).abs(), ALLOWED * b);
        }
    }
    Ok(c)
}

fn estimation(i: &Value, o: &Value) -> Result<Checks, String> {
    let mut c = Checks::default();
    let points =
        |key: &str| -> Result<Vec<Vec3>, String> { Ok(vectors::<3>(i, key)?.into_iter().map(Vec3::from).collect()) };
    let (p, q) = (points("P")?, points("Q")?);
    let got = planes_of_rulings(&p, &q, Ends::OneSided).map_err(text)?;
    let truth = vectors::<3>(o, "true_normals")?;
    let mut worst = 0.0f64;
    for (k, (n, w)) in got.iter().zip(vectors::<3>(o, "normals_up_to_sign")?).enumerate() {
        let w = Vec3::from(w);
        c.all_close("normal", (n * n.dot(&w).signum()).as_slice(), w.as_slice(), ALLOWED);
        if k > 0 && k + 1 < got.len() {
            worst = worst.max(n.dot(&Vec3::from(truth[k])).abs().min(1.0).acos());
        }
    }
    c.close("largest angle inside", worst, number(o, "max_angle_interior")?, ALLOWED);
    Ok(c)
}
