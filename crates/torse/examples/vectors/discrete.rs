//! Kinds of cases about rulings to first order, moving planes, discrete torses and decompositions.

use super::value::{number, numbers, vector, vectors, Case, Checks};
use torse::control::Control;
use torse::design::discrete::planarise::Hold;
use torse::design::discrete::subdivide::{lane_riesenfeld, subdivide, SubdivideOptions};
use torse::fit::elements::decompose::{decompose, DecomposeOptions};
use torse::fit::ruled::directions::{Curvatures, Family};
use torse::geom::Vec3;
use torse::spline::surface::SurfaceJet;
use torse::torse::envelope_point::EnvelopePoint;
use torse::torse::kind::TangentPlane;
use torse::torse::quad_strip::QuadStrip;
use torse::torse::ruled_point::{gauss_curvature, tangent_rotation, RuledPoint};

/// Allowed angles, as sines, for exact data.
const EXACT: f64 = 1e-9;

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    Some(match case.kind.as_str() {
        "lemma11_helicoid" | "lemma11_hyperboloid" | "tangent_surface_helix" => ruling(case),
        "dual_regression" => dual_regression(case),
        "decompose" => shapes(case),
        "lane_riesenfeld" => refinement(case),
        "pq_subdivision" => subdivision(case),
        "gauss_ruled" => curvature(case),
        "asymptotic_torus" => asymptotic_torus(case),
        "asymptotic_saddle" => asymptotic_saddle(case),
        _ => return None,
    })
}

/// Both straightest directions of a surface, in (u, v).
fn straightest(jet: &SurfaceJet) -> Result<([[f64; 2]; 2], [f64; 2]), String> {
    let c = Curvatures::of(jet).ok_or("no tangent plane")?;
    Ok(([Family::Left, Family::Right].map(|f| c.straightest(f)[0]), c.principal))
}

fn asymptotic_torus(case: &Case) -> Result<Checks, String> {
    let given = |key: &str| number(&case.input, key);
    let (big, small, (s, c)) = (given("R")?, given("r")?, given("v")?.sin_cos());
    let r = big + small * c;
    // At u = 0, with v first so that the normal is the inner one.
    let jet = SurfaceJet {
        p: Vec3::new(r, 0.0, small * s),
        du: Vec3::new(0.0, r, 0.0),
        dv: Vec3::new(-small * s, 0.0, small * c),
        duu: Vec3::new(-r, 0.0, 0.0),
        duv: Vec3::new(0.0, -small * s, 0.0),
        dvv: Vec3::new(-small * c, 0.0, -small * s),
    };
    let (directions, principal) = straightest(&jet)?;
    let out = |key: &str| number(&case.output, key);
    let allowed = number(&case.tol, "abs")?;
    let mut checks = Checks::default();
    let mut wanted = [out("kappa_meridian")?, out("kappa_parallel")?].map(f64::abs);
    let mut found = principal.map(f64::abs);
    wanted.sort_by(f64::total_cmp);
    found.sort_by(f64::total_cmp);
    (0..2).for_each(|k| checks.close("curvature", found[k], wanted[k], allowed));
    checks.holds("curvatures of both signs", principal[0] * principal[1] < 0.0);
    for d in directions {
        let angle = (d[1] * jet.dv.norm()).abs().atan2((d[0] * jet.du.norm()).abs());
        checks.close("angle to the parallel", angle.to_degrees(), out("angle_to_parallel_deg")?, allowed);
    }
    Ok(checks)
}

fn asymptotic_saddle(case: &Case) -> Result<Checks, String> {
    let [x, y] = vector::<2>(&case.input, "point")?;
    let z = Vec3::z();
    let jet = SurfaceJet {
        p: Vec3::new(x, y, x * y),
        du: Vec3::x() + z * y,
        dv: Vec3::y() + z * x,
        duu: Vec3::zeros(),
        duv: z,
        dvv: Vec3::zeros(),
    };
    let (directions, _) = straightest(&jet)?;
    let allowed = number(&case.tol, "abs")?;
    let mut checks = Checks::default();
    for wanted in vectors::<2>(&case.output, "directions_xy")? {
        let off = directions.iter().map(|d| (d[0] * wanted[1] - d[1] * wanted[0]).abs() / d[0].hypot(d[1]));
        checks.close("direction", off.fold(f64::INFINITY, f64::min), 0.0, allowed);
    }
    Ok(checks)
}

fn ruling(case: &Case) -> Result<Checks, String> {
    let given = |key: &str| vector::<3>(&case.input, key).map(Vec3::from);
    let at = RuledPoint { a_dot: given("a_dot")?, r: given("r")?, r_dot: given("r_dot")? };
    let allowed = number(&case.tol, "abs")?;
    let mut checks = Checks::default();
    checks.close("rank", at.rank(EXACT) as f64, number(&case.output, "rank")?, 0.0);
    if let Some(name) = case.output["case"].as_str() {
        checks.holds("case of the lemma", at.case(EXACT).name() == name);
    }
    let delta = at.distribution_parameter().ok_or("the ruling does not turn")?;
    let striction = at.striction().ok_or("the ruling does not turn")?;
    let out = |key: &str| case.output[key].as_f64();
    if let Some(expected) = out("distribution_parameter") {
        checks.close("distribution parameter", delta, expected, allowed);
        checks.close("striction", striction, number(&case.output, "striction_v_arclength")?, allowed);
    }
    if let Some(expected) = out("K_at_v1") {
        checks.close("Gauss curvature", at.gauss_curvature(1.0), expected, allowed);
        let turned = at.tangent_rotation(1e15) - at.tangent_rotation(-1e15);
        checks.close("rotation", turned.to_degrees(), number(&case.output, "total_rotation_deg")?, allowed);
    }
    if let Some(expected) = out("singular_v") {
        checks.close("regression point", striction, expected, allowed);
        checks.close("distribution parameter", delta, 0.0, allowed);
        // The developed edge of regression keeps its curvature: the rate at which unit tangents turn.
        let speed = at.a_dot.norm();
        let curvature = at.r.normalize().cross(&at.r_dot).norm() / at.r.norm() / speed;
        checks.close("curvature", curvature, number(&case.output, "kappa")?, allowed);
        checks.close("developed radius", 1.0 / curvature, number(&case.output, "developed_radius")?, allowed);
    }
    Ok(checks)
}

fn dual_regression(case: &Case) -> Result<Checks, String> {
    let given = |key: &str| vector::<3>(&case.input, key).map(Vec3::from);
    // The papers have n·x + n₀ = 0.
    let offset = |key: &str| number(&case.input, key).map(|n0| -n0);
    let e = EnvelopePoint {
        normal: [given("n")?, given("n_dot")?, given("n_ddot")?],
        offset: [offset("n0")?, offset("n0_dot")?, offset("n0_ddot")?],
    };
    let allowed = number(&case.tol, "abs")?;
    let mut checks = Checks::default();
    let ruling = e.ruling().ok_or("no ruling")?;
    let direction = Vec3::from(vector::<3>(&case.output, "ruling_direction_parallel_to")?).normalize();
    checks.at_most("direction of the ruling", ruling.direction.cross(&direction).norm(), allowed);
    let expected = Vec3::from(vector::<3>(&case.output, "regression_point")?);
    let point = e.regression_point().ok_or("no regression point")?;
    checks.all_close("regression point", point.as_slice(), expected.as_slice(), allowed);
    checks.at_most("ruling through it", (point - ruling.point).cross(&ruling.direction).norm(), allowed);
    Ok(checks)
}

fn shapes(case: &Case) -> Result<Checks, String> {
    let planes: Vec<TangentPlane> = vectors::<4>(&case.input, "planes_n_n0")?
        .iter()
        .map(|p| TangentPlane { normal: Vec3::new(p[0], p[1], p[2]), offset: -p[3] })
        .collect();
    let default = DecomposeOptions::default();
    let noise = number(&case.input, "noise_sigma")?.max(default.noise);
    let runs = decompose(&planes, &DecomposeOptions { noise, ..default }).map_err(|e| e.to_string())?;
    let labels = case.output["labels"].as_array().ok_or("no labels")?;
    let right = runs
        .iter()
        .flat_map(|r| (r.first..r.end).map(move |i| (i, r.shape.name())))
        .filter(|(i, name)| labels.get(*i).and_then(|l| l.as_str()) == Some(name))
        .count();
    let mut checks = Checks::default();
    let share = right as f64 / labels.len() as f64;
    checks.at_most("wrong labels", 1.0 - share, 1.0 - number(&case.tol, "label_accuracy_min")?);
    let found: Vec<f64> = runs.iter().skip(1).map(|r| r.first as f64).collect();
    let expected = numbers(&case.output, "breaks")?;
    checks.holds("number of breaks", found.len() == expected.len());
    for (f, e) in found.iter().zip(&expected) {
        checks.at_most("place of a break", (f - e).abs(), number(&case.tol, "break_index")?);
    }
    Ok(checks)
}

fn refinement(case: &Case) -> Result<Checks, String> {
    let p: Vec<Vec3> = vectors::<3>(&case.input, "p")?.into_iter().map(Vec3::from).collect();
    let got = lane_riesenfeld(&p);
    let inner: Vec<f64> = got[1..got.len() - 1].iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let mut checks = Checks::default();
    let expected = vectors::<3>(&case.output, "p1_interior")?;
    checks.all_close("inner points", &inner, expected.as_flattened(), number(&case.tol, "abs")?);
    checks.holds("end points are kept", got.first() == p.first() && got.last() == p.last());
    Ok(checks)
}

fn subdivision(case: &Case) -> Result<Checks, String> {
    let side = |key: &str| -> Result<Vec<Vec3>, String> {
        Ok(vectors::<3>(&case.input, key)?.into_iter().map(Vec3::from).collect())
    };
    let strip = QuadStrip::new(side("p")?, side("q")?).map_err(|e| e.to_string())?;
    let levels = number(&case.input, "levels")? as usize;
    let options = SubdivideOptions::new(levels, Hold::Nothing);
    let answer = subdivide(&strip, &options, &Control::default()).map_err(|e| e.to_string())?;
    let mut checks = Checks::default();
    for l in &answer.levels {
        checks.at_most("warp", l.warp, number(&case.output, "planarity_max_each_level")?);
        checks.at_most("steps", l.steps as f64, number(&case.output, "max_iterations_per_level")?);
    }
    checks.at_most("warp of the result", answer.strip.largest_warp(), 1e-12);
    for w in answer.levels[2..].windows(2) {
        let ratio = w[1].bend_jump / w[0].bend_jump;
        checks.at_most("ratio of bend jumps", ratio, number(&case.output, "bend_jump_ratio_per_level_max")?);
    }
    Ok(checks)
}

fn curvature(case: &Case) -> Result<Checks, String> {
    let (delta, v) = (number(&case.input, "distribution_parameter")?, number(&case.input, "v")?);
    let allowed = number(&case.tol, "abs")?;
    let mut checks = Checks::default();
    checks.close("K", gauss_curvature(delta, v), number(&case.output, "K")?, allowed);
    let turned = number(&case.output, "normal_rotation_from_striction")?;
    checks.close("rotation of the normal", tangent_rotation(delta, v), turned, allowed);
    Ok(checks)
}
