//! Kinds of cases about cone pairs and cone splines.

use super::value::{number, numbers, vector, Case, Checks};
use serde_json::Value;
use torse::design::cones::{joins, Osculating};
use torse::develop::cones::{bent, develop, Bending};
use torse::fit::elements::cones::{cones, ConeFitOptions};
use torse::geom::{Vec2, Vec3};
use torse::torse::cone::forms::dual_planes;
use torse::torse::cone::pair::{any_pair, congruent_distances, cylinder_first, least_distances, ConePair, PairOptions};
use torse::torse::cone::spline::{ConeSpline, Segment, Shape};
use torse::torse::g1_element::G1Element;
use torse::torse::ruled_patch::{tangent_strip, HelicalStrip, RuledStrip, StripFn};

/// Relative tolerance of the file.
const ALLOWED: f64 = 1e-9;

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    match case.kind.as_str() {
        "cone_pair_general" | "cone_pair_family" | "cone_pair_constant_slope" | "cone_pair_cone" => Some(pair(case)),
        "cone_pair_cylinder" => Some(cylinder(case)),
        "cone_pair_degenerate" => Some(degenerate(case)),
        "osculating_join" => Some(osculating_join(case)),
        "osculating_join_cylinder" => Some(osculating_cylinder(case)),
        "develop_bend_offset" => Some(develop_bend_offset(case)),
        "adaptive_cone_spline" => Some(adaptive(case)),
        _ => None,
    }
}

fn v3(v: &Value, key: &str) -> Result<Vec3, String> {
    Ok(Vec3::from(vector::<3>(v, key)?))
}

fn element(v: &Value, point: &str, e: &str, p: &str) -> Result<G1Element, String> {
    G1Element::new(v3(v, point)?, v3(v, e)?, v3(v, p)?).map_err(|e| e.to_string())
}

fn both(v: &Value) -> Result<[G1Element; 2], String> {
    Ok([element(v, "l1", "e1", "p1")?, element(v, "l2", "e2", "p2")?])
}

fn same_cone(checks: &mut Checks, s: &Segment, expected: &Value) -> Result<(), String> {
    let Shape::Cone { cos_gamma, sin_gamma, angle, .. } = s.shape else { return Err("not a cone".into()) };
    if let Some(v) = s.vertex() {
        checks.all_close("vertex", v.as_slice(), &numbers(expected, "vertex")?, ALLOWED);
    }
    checks.all_close("axis", s.axis().as_slice(), &numbers(expected, "axis")?, ALLOWED);
    if !expected["cos_gamma"].is_null() {
        checks.close("cos gamma", cos_gamma, number(expected, "cos_gamma")?, ALLOWED);
    }
    checks.close("sin gamma", sin_gamma, number(expected, "sin_gamma")?, ALLOWED);
    checks.close("phi", angle, number(expected, "phi")?, ALLOWED);
    Ok(())
}

/// Both elements taken, one junction.
fn smooth(checks: &mut Checks, pair: &ConePair, a: &G1Element, b: &G1Element) {
    let length = (b.point - a.point).norm();
    let [one, two] = &pair.segments;
    checks.at_most("first element", one.start.mismatch(a, length), 1e-12);
    checks.at_most("junction", one.end().mismatch(&two.start, length), 1e-12);
    checks.at_most("second element", two.end().mismatch(b, length), 1e-12);
}

fn pair(case: &Case) -> Result<Checks, String> {
    let (i, o) = (&case.input, &case.output);
    let [a, b] = both(i)?;
    let options = PairOptions { psi: number(i, "psi")?, rotation_limit: 3.2, ..PairOptions::default() };
    let pair = any_pair(&a, &b, &options).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    smooth(&mut checks, &pair, &a, &b);
    checks.close("theta", pair.rotation, number(o, "theta")?, ALLOWED);
    checks.close("K", pair.shift, number(o, "K")?, ALLOWED);
    let g = pair.junction();
    for (key, v) in [("junction_direction", g.direction), ("junction_normal", g.normal), ("junction_p", g.forward)] {
        checks.all_close(key, v.as_slice(), &numbers(o, key)?, ALLOWED);
    }
    for (k, s) in pair.segments.iter().enumerate() {
        same_cone(&mut checks, s, &o[["cone1", "cone2"][k]])?;
        let v = s.vertex().ok_or("no vertex")?;
        checks.all_close("v", v.as_slice(), &numbers(o, ["v1", "v2"][k])?, ALLOWED);
    }
    if !o["sphere_center"].is_null() {
        sphere(&mut checks, &pair, &a, &b, o)?;
    }
    if !o["bezier_planes_cone1"].is_null() {
        let expected = o["bezier_planes_cone1"].as_array().ok_or("planes")?;
        let planes = dual_planes(&pair.segments[0]).ok_or("no planes")?;
        for (p, e) in planes.iter().zip(expected) {
            let e: Vec<f64> = e.as_array().ok_or("plane")?.iter().filter_map(Value::as_f64).collect();
            checks.all_close("Bézier plane", p, &e, ALLOWED);
        }
    }
    if let Some(expected) = o["offset_vertices_0p1"].as_array() {
        for (s, e) in pair.segments.iter().zip(expected) {
            let e: Vec<f64> = e.as_array().ok_or("vertex")?.iter().filter_map(Value::as_f64).collect();
            let v = s.offset(0.1).vertex().ok_or("no vertex")?;
            checks.all_close("offset vertex", v.as_slice(), &e, ALLOWED);
        }
    }
    Ok(checks)
}

/// Sphere, biarc and the special members of the family.
fn sphere(checks: &mut Checks, pair: &ConePair, a: &G1Element, b: &G1Element, o: &Value) -> Result<(), String> {
    let (m, r) = pair.inscribed_sphere().ok_or("no sphere")?;
    checks.all_close("sphere", m.as_slice(), &numbers(o, "sphere_center")?, ALLOWED);
    checks.close("radius", r.abs(), number(o, "sphere_radius")?, ALLOWED);
    let touch = |g: &G1Element| g.at((m - g.point).dot(&g.direction));
    checks.all_close("a1", touch(a).as_slice(), &numbers(o, "a1")?, ALLOWED);
    checks.all_close("a2", touch(b).as_slice(), &numbers(o, "a2")?, ALLOWED);
    let from_touch = |mu: f64| mu;
    let congruent = congruent_distances(a, b).map_err(|e| e.to_string())?;
    checks.all_close("congruent", &congruent.map(from_touch), &numbers(o, "mu_congruent")?, ALLOWED);
    // Distances of the file are counted from the sphere.
    let k = (m - a.point).dot(&a.direction);
    let (members, practical) = least_distances(a, b).map_err(|e| e.to_string())?;
    let expected = o["mu_roots_min_distance"].as_array().ok_or("roots")?;
    for (mu, e) in members.iter().zip(expected) {
        let e: Vec<f64> = e.as_array().ok_or("root")?.iter().filter_map(Value::as_f64).collect();
        checks.all_close("least distance", &[mu[0] - k, mu[1] + k], &e, ALLOWED);
    }
    checks.close("practical", practical as f64, number(o, "practical_index")?, 0.0);
    let cylinder = cylinder_first(a, b, &PairOptions::default()).map_err(|e| e.to_string())?;
    let v = cylinder.segments[1].vertex().ok_or("no vertex")?;
    let mu = (b.at(pair.shift) - v).dot(&b.direction) + k;
    checks.close("cylinder", mu, number(o, "mu2_when_v1_at_infinity")?, ALLOWED);
    Ok(())
}

fn cylinder(case: &Case) -> Result<Checks, String> {
    let (i, o) = (&case.input, &case.output);
    let [a, b] = both(i)?;
    let pair = any_pair(&a, &b, &PairOptions::default()).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    smooth(&mut checks, &pair, &a, &b);
    let radii = numbers(o, "signed_radii")?;
    let axes = o["axis_points"].as_array().ok_or("axis_points")?;
    for (k, s) in pair.segments.iter().enumerate() {
        let Shape::Cylinder { radius, .. } = s.shape else { return Err("not a cylinder".into()) };
        // The file counts radii along the normal to the axis.
        checks.close("radius", -radius, radii[k], ALLOWED);
        let e: Vec<f64> = axes[k].as_array().ok_or("point")?.iter().filter_map(Value::as_f64).collect();
        let off = s.start.point - s.start.normal * radius - Vec3::new(e[0], e[1], e[2]);
        checks.at_most("axis", off.cross(&s.axis()).norm(), ALLOWED);
    }
    let c = Vec3::from(vector::<3>(o, "junction_point")?) - pair.junction().point;
    checks.at_most("junction line", c.cross(&pair.junction().direction).norm(), ALLOWED);
    Ok(checks)
}

fn degenerate(case: &Case) -> Result<Checks, String> {
    let [a, b] = both(&case.input)?;
    let pair = any_pair(&a, &b, &PairOptions::default());
    let mut checks = Checks::default();
    if case.output["expect"].as_str() == Some("error") {
        checks.holds("refused", pair.is_err());
    } else {
        let pair = pair.map_err(|e| e.to_string())?;
        smooth(&mut checks, &pair, &a, &b);
        checks.holds("plane", pair.segments.iter().all(|s| s.shape.is_plane()));
    }
    Ok(checks)
}

fn osculating_join(case: &Case) -> Result<Checks, String> {
    let (i, o) = (&case.input, &case.output);
    let cone = |k: usize| -> Result<Osculating, String> {
        let [v, w, e, p] = [["v1", "w1", "e1", "p1"], ["v2", "w2", "e2", "p2"]][k];
        let (vertex, axis, d) = (v3(i, v)?, v3(i, w)?, v3(i, e)?);
        // A point of the strip 1..2 of the case.
        let g = G1Element::new(vertex + d.normalize() * 1.5, d, v3(i, p)?).map_err(|e| e.to_string())?;
        let shape = Shape::Cone {
            distance: 1.5,
            cos_gamma: axis.dot(&g.direction),
            sin_gamma: axis.dot(&g.normal),
            angle: 0.0,
        };
        Ok(Osculating { element: g, shape })
    };
    let mut checks = Checks::default();
    let found = joins(&cone(0)?, &cone(1)?);
    let expected = (number(o, "phi1")?, number(o, "phi2")?);
    let best = found
        .iter()
        .min_by(|a, b| (a.first_angle - expected.0).abs().total_cmp(&(b.first_angle - expected.0).abs()))
        .ok_or("no join")?;
    checks.close("phi1", best.first_angle, expected.0, ALLOWED);
    checks.close("phi2", best.second_angle, expected.1, ALLOWED);
    checks.all_close("g1", best.filler.start.direction.as_slice(), &numbers(o, "g1")?, ALLOWED);
    checks.all_close("g2", best.filler.end().direction.as_slice(), &numbers(o, "g2")?, ALLOWED);
    same_cone(&mut checks, &best.filler, &o["filler"])?;
    Ok(checks)
}

fn osculating_cylinder(case: &Case) -> Result<Checks, String> {
    let (i, o) = (&case.input, &case.output);
    let (n, p) = (v3(i, "n1")?, v3(i, "p1")?);
    let (rho, e) = (number(i, "signed_radius")?, v3(i, "cyl_dir")?);
    let g = G1Element::new(v3(i, "cyl_axis_point")? + n * rho, e, p).map_err(|e| e.to_string())?;
    let cylinder = Osculating { element: g, shape: Shape::Cylinder { radius: rho, angle: 0.0 } };
    let (w, k, s) = (v3(i, "w2")?, number(i, "cos_gamma2")?, number(i, "sin_gamma2")?);
    // Any ruling of the second cone will do.
    let across = w.cross(&Vec3::x()).normalize();
    let d = w * k + across * s;
    let at = G1Element::new(v3(i, "v2")? + d, d, w.cross(&d) / s).map_err(|e| e.to_string())?;
    let shape = Shape::Cone { distance: 1.0, cos_gamma: k, sin_gamma: s, angle: 0.0 };
    let found = joins(&cylinder, &Osculating { element: at, shape });
    let mut checks = Checks::default();
    let expected = o["candidates"].as_array().ok_or("candidates")?;
    checks.close("number of joins", found.len() as f64, expected.len() as f64, 0.0);
    for c in expected {
        let psi = number(c, "psi")?;
        let j = found
            .iter()
            .min_by(|a, b| (a.first_angle - psi).abs().total_cmp(&(b.first_angle - psi).abs()))
            .ok_or("no join")?;
        checks.close("psi", j.first_angle, psi, ALLOWED);
        let point = v3(c, "point_on_cylinder")? - j.filler.start.point;
        checks.at_most("line", point.cross(&j.filler.start.direction).norm(), ALLOWED);
        checks.all_close("normal", j.filler.start.normal.as_slice(), &numbers(c, "normal")?, ALLOWED);
        checks.all_close("g2", j.filler.end().direction.as_slice(), &numbers(c, "g2")?, ALLOWED);
        let v = j.filler.vertex().ok_or("no vertex")?;
        checks.all_close("vertex", v.as_slice(), &numbers(c, "vertex")?, ALLOWED);
    }
    Ok(checks)
}

/// The chain of a case that lists vertices, openings and angles.
fn chain(i: &Value) -> Result<ConeSpline, String> {
    let f = &i["first_element"];
    let cones = i["cones"].as_array().ok_or("cones")?;
    let mut segments: Vec<Segment> = Vec::new();
    for c in cones {
        let vertex = v3(c, "vertex")?;
        let start = match segments.last() {
            None => element_at(vertex + v3(f, "e")? * 1.5, &v3(f, "e")?, &v3(f, "p")?)?,
            Some(s) => {
                // On the same line, again 1.5 from the new vertex.
                let mut end = s.end();
                end.point = end.at((vertex - end.point).dot(&end.direction) + 1.5);
                end
            }
        };
        let distance = (start.point - vertex).dot(&start.direction);
        let (cos_gamma, sin_gamma, angle) = (number(c, "cos_gamma")?, number(c, "sin_gamma")?, number(c, "phi")?);
        segments.push(Segment::new(start, Shape::Cone { distance, cos_gamma, sin_gamma, angle }));
    }
    Ok(ConeSpline { segments })
}

fn element_at(point: Vec3, e: &Vec3, p: &Vec3) -> Result<G1Element, String> {
    G1Element::new(point, *e, *p).map_err(|e| e.to_string())
}

fn develop_bend_offset(case: &Case) -> Result<Checks, String> {
    let (i, o) = (&case.input, &case.output);
    let spline = chain(i)?;
    let mut checks = Checks::default();
    checks.at_most("chain", spline.mismatch(1.0), ALLOWED);
    // The first apex in the origin.
    let flats = develop(&spline, Vec2::new(1.5, 0.0), 0.0);
    for (f, e) in flats.iter().zip(o["development"].as_array().ok_or("development")?) {
        let apex = f.apex().ok_or("no apex")?;
        checks.all_close("apex", apex.as_slice(), &numbers(e, "apex")?, ALLOWED);
        checks.close("beta0", f.angle, number(e, "beta0")?, ALLOWED);
        checks.close("beta1", f.end_angle(), number(e, "beta1")?, ALLOWED);
    }
    let half = bent(&spline, number(i, "bend_s")?, Bending::Sine);
    for (s, e) in half.segments.iter().zip(o["bend"].as_array().ok_or("bend")?) {
        same_cone(&mut checks, s, e)?;
    }
    let offset = spline.offset(number(i, "offset")?).map_err(|(k, f)| format!("segment {k}: {f}"))?;
    for (s, e) in offset.segments.iter().zip(o["offset_vertices"].as_array().ok_or("offset_vertices")?) {
        let e: Vec<f64> = e.as_array().ok_or("vertex")?.iter().filter_map(Value::as_f64).collect();
        checks.all_close("offset", s.vertex().ok_or("no vertex")?.as_slice(), &e, ALLOWED);
    }
    Ok(checks)
}

fn adaptive(case: &Case) -> Result<Checks, String> {
    let (i, o) = (&case.input, &case.output);
    let range = vector::<2>(i, "u_range")?;
    let reach = vector::<2>(i, "strip")?;
    let curve = i["regression_curve"].as_str().unwrap_or("");
    if curve.starts_with("helix") {
        let strip = HelicalStrip { radius: 1.0, rise: 0.6, reach, domain: (range[0], range[1]) };
        approximated(&strip, i, o)
    } else {
        let jet = move |u: f64| {
            let c = [
                Vec3::new(u, u * u, u * u * u),
                Vec3::new(1.0, 2.0 * u, 3.0 * u * u),
                Vec3::new(0.0, 2.0, 6.0 * u),
                Vec3::new(0.0, 0.0, 6.0),
            ];
            tangent_strip(&c, reach)
        };
        approximated(&StripFn { domain: (range[0], range[1]), breaks: Vec::new(), jet }, i, o)
    }
}

fn approximated(strip: &impl RuledStrip, i: &Value, o: &Value) -> Result<Checks, String> {
    let tolerance = number(i, "tol")?;
    let fit = cones(strip, &ConeFitOptions::new(tolerance)).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    let pairs = (fit.nodes.len() - 1) as f64;
    checks.at_most("pairs", pairs, number(o, "reference_pairs")?.min(number(o, "max_pairs_accepted")?));
    checks.at_most("joints", fit.spline.mismatch(1.0), 1e-10);
    let (a, b) = strip.domain();
    let mut worst = 0.0_f64;
    for k in 0..=2000 {
        let ends = strip.jet(a + (b - a) * f64::from(k) / 2000.0).ends.map(|e| e[0]);
        for v in [0.0, 0.5, 1.0] {
            let x = ends[0] + (ends[1] - ends[0]) * v;
            worst = worst.max(fit.spline.nearest(&x).ok_or("empty chain")?.1);
        }
    }
    checks.at_most("distance", worst, tolerance);
    Ok(checks)
}
