//! Kinds of cases about spline developables that one pulls on, ruled surfaces and diagnostics.

use super::value::{number, vector, Case, Checks};
use torse::constraint::proximity::squared_distance;
use torse::control::Control;
use torse::design::composite::{
    BoundaryCurve, Composite, CompositeError, Handle, Hold, Options, RuledStrip, Session, StripShape,
};
use torse::draw::reflection::reflected;
use torse::fit::ruled::directions::{Curvatures, Family};
use torse::geom::Vec3;
use torse::num::gauss_newton::Status;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::SurfaceJet;
use torse::torse::ruled_point::{gauss_curvature, tangent_rotation};

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    match case.kind.as_str() {
        "spline_det_degree" => Some(det_degree(case)),
        "gp_drag" => Some(drag(case)),
        "sqdist_quadratic" => Some(quadratic(case)),
        "asymptotic_torus" => Some(torus(case)),
        "asymptotic_saddle" => Some(saddle(case)),
        "gauss_ruled" => Some(gauss(case)),
        "reflect" => Some(reflection(case)),
        _ => None,
    }
}

/// Clamped knots on [0, 1] with inner knots repeated.
fn knots(degree: usize, intervals: usize, multiplicity: usize) -> Result<Knots, String> {
    let mut values = vec![0.0; degree + 1];
    for i in 1..intervals {
        values.extend(std::iter::repeat_n(i as f64 / intervals as f64, multiplicity));
    }
    values.extend(vec![1.0; degree + 1]);
    let control = values.len() - degree - 1;
    Knots::new(degree, values, control).map_err(|e| e.to_string())
}

/// Mean of the knots of every control point.
fn greville(k: &Knots) -> Vec<f64> {
    let p = k.degree();
    (0..k.control_count()).map(|i| k.values()[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

/// `c_k(g) = (2g, k/P, .25 sin(2πg + .7 k/P) + .15 g k/P)` at the Greville abscissae, strips between neighbours.
fn waves(strips: usize, knots: &Knots) -> Composite {
    let mut out = Composite::default();
    for k in 0..=strips {
        let y = k as f64 / strips as f64;
        let point = |g: &f64| [2.0 * g, y, 0.25 * (std::f64::consts::TAU * g + 0.7 * y).sin() + 0.15 * g * y];
        let curve = Curve { knots: knots.clone(), control: greville(knots).iter().map(point).collect() };
        out.curves.push(BoundaryCurve { name: format!("c{k}"), curve, fixed: false });
    }
    out.strips = (0..strips)
        .map(|k| RuledStrip {
            name: format!("s{k}"),
            sides: [format!("c{k}"), format!("c{}", k + 1)],
            shape: StripShape::Developable { margin: 0.02 },
        })
        .collect();
    out
}

fn det_degree(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let whole = |key| number(&case.input, key).map(|x| x as usize);
    let (degree, intervals) = (whole("degree")?, whole("intervals")?);
    // Degree on one piece: the last order of differences that does not vanish.
    let mut one = waves(1, &knots(degree, 1, 1)?);
    // Control points in no order: nothing cancels by itself.
    for (k, p) in one.curves.iter_mut().flat_map(|b| &mut b.curve.control).enumerate() {
        (0..3).for_each(|d| p[d] += (12.9898 * k as f64 + 78.233 * d as f64).sin());
    }
    let det = |u: f64| {
        let [a, b] = [0, 1].map(|k: usize| one.curves[k].curve.jet(u).map(Vec3::from));
        a[1].cross(&b[1]).dot(&(b[0] - a[0]))
    };
    let mut row: Vec<f64> = (0..=3 * degree).map(|i| det(i as f64 / (3 * degree) as f64)).collect();
    let largest = row.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let mut found = 0;
    for order in 1..=3 * degree {
        row = row.windows(2).map(|w| w[1] - w[0]).collect();
        if row.iter().any(|x| x.abs() > 1e-11 * largest) {
            found = order;
        }
    }
    checks.close("degree of the determinant", found as f64, number(&case.output, "det_degree")?, 0.0);
    // Conditions on one strip whose curves stay.
    let conditions = |multiplicity: usize, intervals: usize| -> Result<(usize, usize), String> {
        let mut c = waves(1, &knots(degree, intervals, multiplicity)?);
        let free = c.curves.iter().map(|b| 3 * b.curve.control.len()).sum();
        c.curves.iter_mut().for_each(|b| b.fixed = true);
        match Session::new(c, Options::default()).err() {
            Some(CompositeError::OverDetermined { conditions, .. }) => Ok((conditions, free)),
            other => Err(format!("fixed curves: {other:?}")),
        }
    };
    let (most, free) = conditions(2, intervals)?;
    let per_interval = number(&case.output, "samples_per_interval")?;
    checks.close("rulings per piece", most as f64 / intervals as f64, per_interval, 0.0);
    let (more, freer) = conditions(2, intervals + 1)?;
    let gained = (freer - free) as f64 - (more - most) as f64;
    checks.close("freedom, double knots", gained, number(&case.output, "dof_per_interval_C_dm2")?, 0.0);
    // Simple knots are refused for what they take.
    let simple = 6.0 * 1.0 - per_interval;
    checks.close("freedom, simple knots", simple, number(&case.output, "dof_per_interval_C_dm1")?, 0.0);
    let refused = Session::new(waves(1, &knots(degree, intervals, 1)?), Options::default()).err();
    checks.holds("simple knots are refused", matches!(refused, Some(CompositeError::Stiff { .. })));
    Ok(checks)
}

fn drag(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let whole = |key| number(&case.input, key).map(|x| x as usize);
    let knots = knots(whole("degree")?, whole("intervals")?, whole("knot_multiplicity")?)?;
    let strips = whole("strips")?;
    let mut c = waves(strips, &knots);
    for k in [0, strips] {
        for u in [0.0, 1.0] {
            let at = Vec3::from(c.curves[k].curve.point(u));
            c.handles.push(Handle::point(&format!("c{k}"), u, at));
        }
    }
    let start = Vec3::from(c.curves[0].curve.point(0.5));
    c.handles.push(Handle::point("c0", 0.5, start));
    let mut session = Session::new(c, Options::default()).map_err(|e| e.to_string())?;
    let control = Control::default();
    checks.holds("the first shape converges", session.settle(&control).status == Status::Converged);
    let allowed = |key| number(&case.output, key);
    for k in 1..=12 {
        let to = start + Vec3::new(0.0, -0.008, 0.02) * f64::from(k);
        session.set_handle(4, Hold::Point(to)).map_err(|e| e.to_string())?;
        let report = session.step(&control);
        checks.holds("every step converges", report.status == Status::Converged);
        checks.at_most("iterations", report.iterations as f64, allowed("max_iterations_per_drag")?);
        checks.at_most("residual", report.residual, allowed("final_residual")?);
        let (mut twist, mut clear) = (0.0f64, true);
        for s in session.strips().map_err(|e| e.to_string())? {
            for i in 0..=600 {
                let u = f64::from(i) / 600.0;
                twist = twist.max(s.twist(u));
                clear &= s.regression_clearance(u) > 0.0;
            }
        }
        checks.at_most("twist", twist, allowed("dense_twist_max_rad")?);
        checks.holds("no regression point inside", clear);
    }
    Ok(checks)
}

fn quadratic(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let k = [number(&case.input, "kappa1")?, number(&case.input, "kappa2")?];
    let found = squared_distance(number(&case.input, "d")?, k);
    checks.all_close("coefficients", &found, &vector::<3>(&case.output, "diag")?, number(&case.tol, "abs")?);
    Ok(checks)
}

fn torus(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let (big, small, v) = (number(&case.input, "R")?, number(&case.input, "r")?, number(&case.input, "v")?);
    let allowed = number(&case.tol, "abs")?;
    let ((s, c), (su, cu)) = (v.sin_cos(), 0.7f64.sin_cos());
    let w = big + small * c;
    // Meridians first, so that the normal points to the axis of the tube.
    let jet = SurfaceJet {
        p: Vec3::new(w * cu, w * su, small * s),
        du: Vec3::new(-small * s * cu, -small * s * su, small * c),
        dv: Vec3::new(-w * su, w * cu, 0.0),
        duu: Vec3::new(-small * c * cu, -small * c * su, -small * s),
        duv: Vec3::new(small * s * su, -small * s * cu, 0.0),
        dvv: Vec3::new(-w * cu, -w * su, 0.0),
    };
    let found = Curvatures::of(&jet).ok_or("no tangent plane")?;
    checks.close("meridian", found.principal[0], number(&case.output, "kappa_meridian")?, allowed);
    checks.close("parallel", found.principal[1], number(&case.output, "kappa_parallel")?, allowed);
    let angle = number(&case.output, "angle_to_parallel_deg")?;
    let mut sides = Vec::new();
    for family in [Family::Left, Family::Right] {
        let [a, b] = found.straightest(family)[0];
        let t = jet.du * a + jet.dv * b;
        let (along, across) = (t.dot(&jet.dv.normalize()), t.dot(&jet.du.normalize()));
        checks.close("angle", across.abs().atan2(along.abs()).to_degrees(), angle, allowed);
        sides.push(along * across > 0.0);
    }
    checks.holds("one direction to each side", sides[0] != sides[1]);
    Ok(checks)
}

fn saddle(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let ([x, y], allowed) = (vector::<2>(&case.input, "point")?, number(&case.tol, "abs")?);
    let p = Vec3::new(x, y, x * y);
    let (zero, du, dv) = (Vec3::zeros(), Vec3::new(1.0, 0.0, y), Vec3::new(0.0, 1.0, x));
    let jet = SurfaceJet { p, du, dv, duu: zero, duv: Vec3::z(), dvv: zero };
    let found = Curvatures::of(&jet).ok_or("no tangent plane")?;
    let rows: Vec<[f64; 2]> = super::value::vectors(&case.output, "directions_xy")?;
    let mut lie = true;
    for wanted in &rows {
        let off = |family| {
            let d = found.straightest(family)[0];
            (d[0] * wanted[1] - d[1] * wanted[0]).abs() / d[0].hypot(d[1])
        };
        checks.at_most("direction", off(Family::Left).min(off(Family::Right)), allowed);
        // The line through the point in this direction.
        let line = |t: f64| p + (du * wanted[0] + dv * wanted[1]) * t;
        lie &= [-2.0, 0.5, 3.0].iter().all(|t| (line(*t).z - line(*t).x * line(*t).y).abs() <= allowed);
    }
    checks.holds("lines in the surface", case.output["lines_lie_in_surface"].as_bool() == Some(lie));
    Ok(checks)
}

fn gauss(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let (delta, v) = (number(&case.input, "distribution_parameter")?, number(&case.input, "v")?);
    let allowed = number(&case.tol, "abs")?;
    checks.close("Gauss curvature", gauss_curvature(delta, v), number(&case.output, "K")?, allowed);
    let turn = number(&case.output, "normal_rotation_from_striction")?;
    checks.close("turn of the tangent plane", tangent_rotation(delta, v), turn, allowed);
    Ok(checks)
}

fn reflection(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let given = |key| vector::<3>(&case.input, key).map(Vec3::from);
    let found = reflected(&given("view_dir")?, &given("normal")?);
    let wanted = vector::<3>(&case.output, "reflected")?;
    checks.all_close("reflected ray", found.as_slice(), &wanted, number(&case.tol, "abs")?);
    Ok(checks)
}
