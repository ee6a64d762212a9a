//! Ruled strips over saddles, tori and surfaces of mixed curvature: from faces to what is proven, and what must be refused.

use torse::brep::face::Face;
use torse::brep::support_surface::SupportSurface;
use torse::certify;
use torse::certify::claim::{Evidence, Subject, What};
use torse::control::Control;
use torse::geom::{Frame, Vec3};
use torse::io::words;
use torse::patchwork::panel::{PanelForm, Patchwork};
use torse::pipeline::ruled::{of_faces, RuledAnswer, RuledError};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::{RuledOptions, Status};

/// A part of a torus with radii R = 2000 and r = 1000 about its inner circle: a quarter of the way round, and 45° to
/// either side.
fn torus() -> Surface {
    let arc = Knots::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 3).expect("knots");
    let h = std::f64::consts::FRAC_1_SQRT_2;
    // Meridian from 135° to 225°, weights 1, h, 1; the middle point is where the end tangents meet.
    let meridian = [(2000.0 - 1000.0 * h, 1000.0 * h), (2000.0 - 2000.0 * h, 0.0), (2000.0 - 1000.0 * h, -1000.0 * h)];
    let parallel = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (i, (x, y)) in parallel.iter().enumerate() {
        for (j, (r, z)) in meridian.iter().enumerate() {
            points.push(Vec3::new(r * x, r * y, *z));
            weights.push([1.0, h, 1.0][i] * [1.0, h, 1.0][j]);
        }
    }
    Surface::new(arc.clone(), arc, &points, Some(&weights)).expect("a torus")
}

/// z = f(x, y) on a square of 2 m through a grid of control points: smooth, not the function itself.
fn graph(f: impl Fn(f64, f64) -> f64) -> Surface {
    let knots = Knots::uniform(3, 5, -1000.0, 1000.0).expect("knots");
    let values = knots.values();
    let greville: Vec<f64> = (0..8).map(|i| values[i + 1..=i + 3].iter().sum::<f64>() / 3.0).collect();
    let points: Vec<Vec3> = greville
        .iter()
        .flat_map(|&x| greville.iter().map(move |&y| (x, y)))
        .map(|(x, y)| Vec3::new(x, y, f(x, y)))
        .collect();
    Surface::new(knots.clone(), knots, &points, None).expect("a graph")
}

fn made(surface: Surface, options: &RuledOptions) -> Result<RuledAnswer, RuledError> {
    of_faces(vec![Face::untrimmed(surface)], Vec::new(), options, &Control::default())
}

fn with_width(tolerance: f64, width: f64) -> RuledOptions {
    let mut options = RuledOptions::new(tolerance);
    options.strips.width = Some(width);
    options
}

fn proven(found: &RuledAnswer) -> f64 {
    let claim = found.answer.claim(What::Deviation).expect("a claim");
    assert_eq!(claim.evidence(), Evidence::Proven);
    claim.value()
}

#[test]
fn a_hyperbolic_paraboloid_is_one_strip_and_exact() {
    let found = made(graph(|x, y| x * y / 2000.0), &RuledOptions::new(1.0)).expect("an answer");
    assert_eq!(found.answer.status(), Status::Certified, "{:?}", found.answer.claims());
    assert_eq!(found.answer.patchwork().panels.len(), 1);
    assert!(proven(&found) < 0.05, "{}", proven(&found));
    // Its rulings are lines x = const or y = const.
    for r in &found.rulings {
        let d = (r.ends[1] - r.ends[0]).normalize();
        assert!(d.x.abs().min(d.y.abs()) < 1e-3, "{d:?}");
    }
}

#[test]
fn the_inner_part_of_a_torus_is_smooth_and_within_a_hundredth_of_its_radius() {
    let found = made(torus(), &with_width(10.0, 400.0)).expect("an answer");
    assert_eq!(found.answer.status(), Status::Certified, "{:?}", found.answer.claims());
    let panels = &found.answer.patchwork().panels;
    assert!(panels.len() >= 4 && panels.len() <= 12, "{}", panels.len());
    assert!(proven(&found) <= 10.0);
    let kink = found.answer.claim(What::Kink).expect("a claim").value();
    assert!(kink < 1.0, "{kink}");
    let gap = found.answer.claim(What::SeamGap).expect("a claim").value();
    // Edges are shared; how exactly borders keep to them is shown to a thousandth of the tolerance.
    assert!(gap <= 0.01, "{gap}");
    let longest = found.answer.claim(What::LongestRuling).expect("a claim").value();
    assert!(longest <= 400.0, "{longest}");
    // Samples inside the trims stay below the bound.
    let surface = torus();
    let certificate = found.answer.certificate().expect("a certificate");
    for (panel, proof) in panels.iter().zip(&certificate.panels) {
        let Some(PanelForm::Ruled(map)) = panel.trim.as_ref().map(|t| &t.form) else { panic!("no ruled panel") };
        for run in panel.loops().iter().flatten() {
            for k in 0..=20 {
                let [s, t] = run.trim.point(f64::from(k) / 20.0);
                let [u, v] = map.jet(s, t).p;
                let d = (surface.point(u, v) - panel.strip.patch.point(s, t)).norm();
                assert!(d <= proof.distance_bound + 1e-9, "{d} {}", proof.distance_bound);
            }
        }
    }
}

/// Faces whose own lines are straight and which bend to no side are taken as they are: one strip each, at once.
#[test]
fn developable_faces_are_one_strip_each() {
    let model = torse::read(include_bytes!("../../../data/bracket.step")).expect("a bracket");
    let count = model.faces.len();
    let found = of_faces(model.faces, Vec::new(), &RuledOptions::new(0.1), &Control::default()).expect("an answer");
    assert_eq!(found.answer.status(), Status::Certified, "{:?}", found.answer.claims());
    assert_eq!(found.answer.patchwork().panels.len(), count);
    assert!(found.answer.seconds < 20.0, "{}", found.answer.seconds);
}

#[test]
fn what_is_too_far_is_told_with_its_bound() {
    let found = made(torus(), &with_width(10.0, 600.0)).expect("an answer");
    let bound = proven(&found);
    let strict = certify::patchwork(found.answer.patchwork(), 0.1 * bound, &Control::default());
    assert!(!strict.certified);
    assert!(strict.deviation_bound > 0.8 * bound && strict.deviation_bound < 1.2 * bound, "{}", strict.deviation_bound);
    assert!(strict.missing.iter().any(|m| words::why(m).contains("all that is proven")), "{:?}", strict.missing);
}

#[test]
fn a_planar_point_is_cut_and_a_flat_face_is_one_strip() {
    let monkey = made(graph(|x, y| (x * x * x - 3.0 * x * y * y) / 7e6), &RuledOptions::new(30.0)).expect("an answer");
    assert_eq!(monkey.answer.status(), Status::Certified, "{:?}", monkey.answer.claims());
    // Joins of its pieces are not smoothed, but counted.
    let kink = monkey.answer.claim(What::Kink).expect("a claim").value();
    assert!(kink > 1.0 && kink < 30.0, "{kink}");
    // Nor do they share edges: what is said of gaps holds across the cuts, too.
    let border = |k: usize| -> Vec<Vec3> {
        let runs = monkey.answer.patchwork().panels[k].loops().iter().flatten();
        let on = |e: &torse::spline::curve::Curve<3>| -> Vec<Vec3> {
            let (a, b) = e.domain();
            (0..=400).map(|i| Vec3::from(e.point(a + (b - a) * f64::from(i) / 400.0))).collect()
        };
        runs.flat_map(|r| on(&r.edge)).collect()
    };
    let borders: Vec<Vec<Vec3>> = (0..monkey.answer.patchwork().panels.len()).map(border).collect();
    let inside = |p: &&Vec3| p.x.abs().max(p.y.abs()) < 950.0;
    let gap = |(k, p): (usize, &Vec3)| {
        let others = borders.iter().enumerate().filter(|o| o.0 != k).flat_map(|o| o.1);
        others.map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min)
    };
    let inner = borders.iter().enumerate().flat_map(|(k, b)| b.iter().filter(inside).map(move |p| (k, p)));
    let measured = inner.map(gap).fold(0.0, f64::max);
    let told = monkey.answer.claim(What::SeamGap).expect("a claim").value();
    assert!(measured > 0.3 && told >= measured && told <= 60.0, "{measured} {told}");
    let flat = made(graph(|x, y| 0.1 * x - 0.2 * y), &RuledOptions::new(1.0)).expect("an answer");
    assert_eq!((flat.answer.status(), flat.answer.patchwork().panels.len()), (Status::Certified, 1));
}

#[test]
fn what_was_stopped_is_not_certified() {
    let control = Control::default();
    control.cancel();
    let faces = vec![Face::untrimmed(torus())];
    let Err(RuledError::Nothing(why)) = of_faces(faces, Vec::new(), &RuledOptions::new(10.0), &control) else {
        panic!("an answer")
    };
    assert!(why.contains("ended early"), "{why}");
}

#[test]
fn a_strip_that_was_moved_is_refused() {
    let found = made(torus(), &with_width(10.0, 600.0)).expect("an answer");
    let good = found.answer.patchwork();
    let judge = |p: &Patchwork| certify::patchwork(p, 10.0, &Control::default());
    assert!(judge(good).certified);
    let middle = good.panels[1].strip.patch.control.len() / 2;
    let mut moved = good.clone();
    (0..3).for_each(|d| moved.panels[1].strip.patch.control[middle][d] += 60.0);
    assert!(!judge(&moved).certified);
    assert!(judge(&moved).panels[0].certified);
    // A map to somewhere else proves nothing, nor does one that folds over.
    for share in [0.3, -1.0] {
        let mut lost = good.clone();
        let Some(PanelForm::Ruled(map)) = lost.panels[1].trim.as_mut().map(|t| &mut t.form) else { panic!("no map") };
        map.control.iter_mut().for_each(|c| c[0] = 0.5 + share * (c[0] - 0.5));
        assert!(!judge(&lost).certified, "{share}");
    }
    let mut cut = good.clone();
    let run = &mut cut.panels[1].loops_mut()[0][0];
    let count = run.trim.control.len();
    run.trim.control[1..count - 1].iter_mut().for_each(|c| c[1] = 0.5 + 0.8 * (c[1] - 0.5));
    assert!(!judge(&cut).certified);
}

#[test]
fn a_dome_has_no_strips_and_mixed_curvature_goes_on_without_it() {
    let dome = made(graph(|x, y| -(x * x + y * y) / 4000.0), &RuledOptions::new(5.0));
    let Err(RuledError::Nothing(reason)) = dome else { panic!("{dome:?}") };
    assert!(reason.contains("positive curvature") && reason.contains("torse approximate"), "{reason}");
    // A saddle on one side, a dome on the other.
    let found = made(graph(|x, y| y * y / 4000.0 + x * x * x / 6e6), &RuledOptions::new(5.0)).expect("an answer");
    assert_eq!(found.answer.status(), Status::Uncertified);
    assert!(found.answer.skipped.iter().any(|s| words::why(&s.reason).contains("positive curvature")));
    let certificate = found.answer.certificate().expect("a certificate");
    assert!(certificate.panels.iter().all(|p| p.certified), "{:?}", certificate.missing);
    assert!(found.map[0].values.iter().any(|v| *v > 0.5) && found.map[0].values.iter().any(|v| *v < -0.5));
}

#[test]
fn conoidal_strips_have_rulings_parallel_to_a_plane() {
    let mut options = RuledOptions::new(10.0);
    options.strips.conoidal = true;
    let found = made(torus(), &options).expect("an answer");
    assert_eq!(found.answer.status(), Status::Certified, "{:?}", found.answer.claims());
    assert_eq!(found.directing.len(), found.answer.patchwork().panels.len());
    for (panel, m) in found.answer.patchwork().panels.iter().zip(&found.directing) {
        let m = m.expect("a plane");
        let (a, b) = panel.strip.domain();
        for k in 0..=20 {
            let [p, q] = panel.strip.ruling(a + (b - a) * f64::from(k) / 20.0);
            assert!(m.dot(&(q - p)).abs() < 1e-6, "{}", m.dot(&(q - p)));
        }
    }
    assert!(found.answer.claims_of(Subject::Whole).any(|c| c.what() == What::SeamGap));
}

#[test]
fn lengths_that_are_none_are_refused() {
    for (tolerance, width) in [(-1.0, 100.0), (f64::NAN, 100.0), (1.0, 0.0)] {
        assert!(matches!(made(torus(), &with_width(tolerance, width)), Err(RuledError::Length { .. })));
    }
}

/// A cone up to its tip is developable: one strip on its own rulings, at coarse tolerances too.
#[test]
fn a_cone_up_to_its_tip_is_one_strip() {
    let cone = SupportSurface::Cone { frame: Frame::world(), radius: 300.0, slope: -0.6 };
    let whole = cone.to_spline((0.0, std::f64::consts::TAU), (0.0, 500.0)).expect("a surface").0;
    let found = made(whole, &RuledOptions::new(10.0)).expect("an answer");
    assert_eq!((found.answer.status(), found.answer.parts.len()), (Status::Certified, 1));
    assert!(proven(&found) < 10.0);
}
