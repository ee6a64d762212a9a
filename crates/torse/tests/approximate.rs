//! The main job from bytes to bytes through the public interface, on small models of our own. What is claimed is
//! measured again here by other means: dense samples in both directions with feet of our own.

use std::sync::OnceLock;
use std::time::Duration;
use torse::reason::{FaceReason, JobReason, Limit};

use torse::answer::marks::Marks;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::brep::face::Face;
use torse::certify;
use torse::certify::claim::Status;
use torse::control::Control;
use torse::geom::Vec3;
use torse::io::bundle;
use torse::io::model::ReadOptions;
use torse::io::step::read::read;
use torse::io::words;
use torse::patchwork::panel::{Panel, PanelForm, Patchwork};
use torse::pipeline::approximate::{of_faces, ApproximateError, Options};
use torse::search::cover::{CurveError, CurveShape, Guide, Layout, LayoutKind, PanelCurve, SeamPlane};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::form::Torse;

const TORUS: &[u8] = include_bytes!("../../../data/torus_piece.step");
const CONE: &[u8] = include_bytes!("../../../data/cone_holes.step");

/// Tolerance for the piece of a torus (850 mm wide): two panels, which meet easily.
const TOLERANCE: f64 = 20.0;
/// One that two panels hardly keep.
const TIGHT: f64 = 10.0;

fn options(tolerance: f64) -> Options {
    Options { smooth_angle: 0.0, ..Options::new(tolerance) }
}

/// The same with strips that need not meet, where that is not the question: they are found sooner.
fn apart(tolerance: f64) -> Options {
    Options { meet: false, ..options(tolerance) }
}

fn run(bytes: &[u8], options: &Options) -> Result<Answer, ApproximateError> {
    let model = read(bytes).expect("a model");
    of_faces(model.faces, model.skipped, options, &Control::default())
}

/// The piece of a torus, covered once for all tests.
fn torus() -> &'static Answer {
    static DONE: OnceLock<Answer> = OnceLock::new();
    DONE.get_or_init(|| run(TORUS, &options(TOLERANCE)).expect("an answer"))
}

/// The nearest point of a surface over a rectangle of parameters: best of a grid, then Gauss–Newton steps held inside.
fn nearest(s: &Surface, x: &Vec3, grid: [usize; 2]) -> ([f64; 2], f64) {
    let (du, dv) = s.domain();
    let at = |d: (f64, f64), i: usize, n: usize| d.0 + (d.1 - d.0) * i as f64 / n as f64;
    let mut best = ([du.0, dv.0], f64::INFINITY);
    for i in 0..=grid[0] {
        for j in 0..=grid[1] {
            let (u, v) = (at(du, i, grid[0]), at(dv, j, grid[1]));
            let d = (s.point(u, v) - x).norm();
            if d < best.1 {
                best = ([u, v], d);
            }
        }
    }
    let mut p = best.0;
    for _ in 0..30 {
        let j = s.jet(p[0], p[1]);
        let r = x - j.p;
        let (a, b, c) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
        let (e, f) = (j.du.dot(&r), j.dv.dot(&r));
        let det = a * c - b * b;
        if det <= 0.0 {
            break;
        }
        p = [(p[0] + (c * e - b * f) / det).clamp(du.0, du.1), (p[1] + (a * f - b * e) / det).clamp(dv.0, dv.1)];
        let d = (s.point(p[0], p[1]) - x).norm();
        if d < best.1 {
            best = (p, d);
        }
    }
    best
}

/// Polygons along the trimming curves of a panel in the parameter plane of its patch.
fn trims(panel: &Panel) -> Vec<Vec<[f64; 2]>> {
    let along = |l: &Vec<torse::patchwork::panel::Coedge>| {
        l.iter().flat_map(|r| (0..200).map(|k| r.trim.point(f64::from(k) / 200.0))).collect()
    };
    panel.loops().iter().map(along).collect()
}

fn inside(loops: &[Vec<[f64; 2]>], p: [f64; 2]) -> bool {
    let crossed = |(a, b): (&[f64; 2], &[f64; 2])| {
        (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    let hits = |l: &Vec<[f64; 2]>| l.iter().zip(l.iter().cycle().skip(1)).filter(|s| crossed(*s)).count();
    loops.iter().map(hits).sum::<usize>() % 2 == 1
}

/// Distance from a point to the border of a panel in space: samples, then ever closer ones around the best.
fn to_border(panel: &Panel, x: &Vec3) -> f64 {
    let mut least = f64::INFINITY;
    for run in panel.loops().iter().flatten() {
        let far = |s: f64| (Vec3::from(run.edge.point(s)) - x).norm();
        let (mut middle, mut step) = (0.0, 1.0 / 60.0);
        for k in 1..=60 {
            let s = f64::from(k) / 60.0;
            if far(s) < far(middle) {
                middle = s;
            }
        }
        for _ in 0..40 {
            let around = [(middle - step).max(0.0), middle, (middle + step).min(1.0)];
            middle = around.into_iter().min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(middle);
            step *= 0.6;
        }
        least = least.min(far(middle));
    }
    least
}

/// Largest distance met from points of a trimmed panel to the face; the face covers its whole surface.
fn panel_to_face(panel: &Panel, face: &Surface) -> f64 {
    let loops = trims(panel);
    let ((t0, t1), _) = panel.strip.patch.domain();
    let mut worst = 0.0_f64;
    for i in 0..=40 {
        for j in 0..=16 {
            let p = [t0 + (t1 - t0) * f64::from(i) / 40.0, f64::from(j) / 16.0];
            if inside(&loops, p) {
                worst = worst.max(nearest(face, &panel.strip.patch.point(p[0], p[1]), [24, 24]).1);
            }
        }
    }
    // The border too: there the trimming has its say.
    for run in panel.loops().iter().flatten() {
        for k in 0..=20 {
            let q = run.trim.point(f64::from(k) / 20.0);
            worst = worst.max(nearest(face, &panel.strip.patch.point(q[0], q[1]), [24, 24]).1);
        }
    }
    worst
}

/// Largest distance met from points of the face to the nearest trimmed panel.
fn face_to_panels(face: &Surface, panels: &[Panel]) -> f64 {
    let loops: Vec<_> = panels.iter().map(trims).collect();
    let (du, dv) = face.domain();
    let mut worst = 0.0_f64;
    for i in 0..=24 {
        for j in 0..=24 {
            let x = face.point(du.0 + (du.1 - du.0) * f64::from(i) / 24.0, dv.0 + (dv.1 - dv.0) * f64::from(j) / 24.0);
            let to = |(panel, loops): (&Panel, &Vec<Vec<[f64; 2]>>)| {
                let (foot, d) = nearest(&panel.strip.patch, &x, [32, 4]);
                if inside(loops, foot) {
                    d
                } else {
                    to_border(panel, &x)
                }
            };
            worst = worst.max(panels.iter().zip(&loops).map(to).fold(f64::INFINITY, f64::min));
        }
    }
    worst
}

#[test]
fn a_small_model_is_certified_and_lies_flat() {
    let o = torus();
    assert_eq!(o.status(), Status::Certified);
    assert!(
        o.certificate().expect("a certificate").certified
            && o.certificate().expect("a certificate").covered
            && o.certificate().expect("a certificate").missing.is_empty()
    );
    assert!(
        o.certificate().expect("a certificate").deviation_bound <= TOLERANCE
            && o.certificate().expect("a certificate").deviation_bound > 0.0
    );
    assert!(o.patchwork().panels.len() >= 2 && o.patterns().len() == o.patchwork().panels.len());
    for (p, c) in o.patterns().iter().zip(&o.certificate().expect("a certificate").panels) {
        assert!((p.area / p.area_in_space - 1.0).abs() < 1e-6, "{}: {} and {}", p.name, p.area, p.area_in_space);
        assert!(p.isometry_error < 1e-6, "{}: {}", p.name, p.isometry_error);
        assert!(
            c.certified
                && c.regression_clearance > 0.0
                && c.deviation_bound <= o.certificate().expect("a certificate").deviation_bound
        );
    }
}

#[test]
fn dense_samples_never_exceed_the_bound_in_either_direction() {
    let o = torus();
    let face = &o.patchwork().faces[0].surface;
    let mut worst = 0.0_f64;
    for (panel, proof) in o.patchwork().panels.iter().zip(&o.certificate().expect("a certificate").panels) {
        let d = panel_to_face(panel, face);
        assert!(d <= proof.deviation_bound, "{}: {d} exceeds {}", panel.strip.name, proof.deviation_bound);
        worst = worst.max(d);
    }
    let back = face_to_panels(face, &o.patchwork().panels);
    let bound = o.certificate().expect("a certificate").deviation_bound;
    assert!(back <= bound, "{back} exceeds {bound}");
    // A bound far above what is there would pass for nothing; one that samples nearly reach means something.
    assert!(worst.max(back) > 0.5 * bound, "{worst} and {back} against {bound}");
}

/// The same panel moved by `d`: torse, patch and edges.
fn moved(panel: &mut Panel, d: &Vec3) {
    match &mut panel.trim.as_mut().expect("a trim").form {
        PanelForm::Torse(Torse::Primal(p)) => p.frame.origin += d,
        PanelForm::Torse(Torse::Cylinder(c)) => c.frame.origin += d,
        PanelForm::Torse(Torse::Dual(t)) => {
            for c in &mut t.planes.control {
                c[3] += Vec3::new(c[0], c[1], c[2]).dot(d);
            }
        }
        PanelForm::Ruled(_) => {}
    }
    for c in &mut panel.strip.patch.control {
        for k in 0..3 {
            c[k] += c[3] * d[k];
        }
    }
    for c in panel.loops_mut().iter_mut().flatten().flat_map(|r| &mut r.edge.control) {
        for k in 0..3 {
            c[k] += d[k];
        }
    }
}

fn judged(patchwork: &Patchwork) -> certify::Certificate {
    certify::patchwork(patchwork, TOLERANCE, &Control::default())
}

#[test]
fn a_panel_moved_by_twice_the_tolerance_is_refused_with_a_witness() {
    let o = torus();
    for k in 0..o.patchwork().panels.len() {
        let mut changed = o.patchwork().clone();
        let normal = {
            let p = &changed.panels[k];
            let q = p.loops()[0][0].trim.point(0.5);
            p.strip.patch.jet(q[0], q[1]).normal().normalize()
        };
        moved(&mut changed.panels[k], &(2.0 * TOLERANCE * normal));
        let c = judged(&changed);
        assert!(!c.certified && !c.panels[k].certified, "{}", changed.panels[k].strip.name);
        let (_, d) = c.panels[k].witness.expect("a witness");
        assert!(d.abs() > TOLERANCE, "{d}");
    }
    assert!(judged(o.patchwork()).certified);
}

#[test]
fn numbers_rounded_for_export_are_part_of_the_bound() {
    let o = torus();
    // Control points of the exported patch to whole eighths of a millimetre, the torse left as it was.
    let mut coarse = o.patchwork().clone();
    for c in coarse.panels.iter_mut().flat_map(|p| &mut p.strip.patch.control) {
        for k in 0..3 {
            c[k] = (c[k] / c[3] * 8.0).round() / 8.0 * c[3];
        }
    }
    let fine = judged(o.patchwork());
    let c = judged(&coarse);
    for ((panel, was), (before, now)) in
        coarse.panels.iter().zip(&o.patchwork().panels).zip(fine.panels.iter().zip(&c.panels))
    {
        let ((t0, t1), _) = panel.strip.patch.domain();
        let mut gap = 0.0_f64;
        for i in 0..=50 {
            let t = t0 + (t1 - t0) * f64::from(i) / 50.0;
            for r in [0.0, 0.5, 1.0] {
                gap = gap.max((panel.strip.patch.point(t, r) - was.strip.patch.point(t, r)).norm());
            }
        }
        assert!(gap > 0.0 && now.rounding_bound >= gap, "{}: {gap} against {}", panel.strip.name, now.rounding_bound);
        // Written exactly, there is still a bound for rounding, and it is not zero.
        assert!(
            before.rounding_bound > 0.0 && before.rounding_bound < 1e-6 && now.deviation_bound > before.deviation_bound
        );
    }
}

#[test]
fn too_few_panels_end_uncertified_with_witness_and_panels() {
    let o = run(TORUS, &Options { max_panels: Some(1), ..options(TOLERANCE) }).expect("an answer");
    assert_eq!(o.status(), Status::Uncertified, "one panel cannot be certified");
    let reason = words::reason(o.claims(), &[]);
    assert!(!reason.is_empty());
    assert_eq!((o.patchwork().panels.len(), o.patterns().len()), (1, 1));
    let (uv, d) = o.certificate().expect("a certificate").panels[0].witness.expect("a witness");
    assert!(d.abs() > TOLERANCE, "{d}");
    // The witness is a place where the panel is indeed too far away.
    let x = o.patchwork().faces[0].surface.point(uv[0], uv[1]);
    assert!(nearest(&o.patchwork().panels[0].strip.patch, &x, [60, 8]).1 > TOLERANCE);
}

#[test]
fn cancelled_work_answers_with_what_it_has() {
    // A busy machine may need longer for it than people wait.
    let control = Control::default().finishing_within(Duration::from_secs(120));
    control.cancel();
    let model = read(TORUS).expect("a model");
    let o = of_faces(model.faces, model.skipped, &options(0.5), &control).expect("an answer");
    let reason = words::reason(o.claims(), &[]);
    assert!(reason.contains("ended early"), "{reason}");
    // A cover of the whole face with a bound that holds, far from what was asked for, and nothing of it to be cut.
    let bound = o.certificate().expect("a certificate").deviation_bound;
    assert!(o.certificate().expect("a certificate").covered && bound > 0.5 && bound < 0.07 * 850.0 * 2.0, "{bound}");
    assert!(Marks::of(&o).panels.iter().all(|m| *m));
    let face = &o.patchwork().faces[0].surface;
    assert!(face_to_panels(face, &o.patchwork().panels) <= bound);
}

/// A cylinder, a cone: no search is cut short, and half a proof is none.
#[test]
fn what_is_developable_is_covered_and_proven_though_time_is_up() {
    let control = Control::default();
    control.cancel();
    let model = read(CONE).expect("a model");
    let o = of_faces(model.faces, model.skipped, &options(0.5), &control).expect("an answer");
    let certificate = o.certificate().expect("a certificate");
    assert!(certificate.certified && o.patchwork().panels.len() == 1, "{:?}", certificate.panels[0].reason);
}

/// Time that runs out at some moment: whatever was reached covers the whole face and has a bound, which needs some time of
/// its own.
#[test]
fn limited_time_gives_a_whole_cover_with_its_bound() {
    let model = read(TORUS).expect("a model");
    let limit = std::time::Instant::now() + Duration::from_secs(2);
    let control = Control::default().until(limit).finishing_within(Duration::from_secs(6));
    let o = of_faces(model.faces, model.skipped, &options(0.002), &control).expect("an answer");
    assert!(
        o.certificate().expect("a certificate").covered
            && o.certificate().expect("a certificate").deviation_bound.is_finite(),
        "{:?}",
        o.certificate().expect("a certificate").missing
    );
    assert!(o.status() != Status::Certified && Marks::of(&o).any());
}

/// Of panels that are not certified, these alone are marked, in every file; where none is to blame, all are; where
/// something is left out, none is.
#[test]
fn what_must_not_be_cut_is_marked_in_every_file() {
    let mut o = torus().clone();
    let count = o.patchwork().panels.len();
    assert!(count > 1 && !Marks::of(&o).any());
    let mut stopped = o.clone();
    stopped.object(JobReason::Stopped);
    assert_eq!(Marks::of(&stopped).panels, vec![true; count]);
    o.object(FaceReason::Limit { panel: "A-02".into(), limit: Limit::SheetWidth, value: 9.0, asked: 8.0, more: 0 });
    o.beyond_limits = vec![1];
    let marks = Marks::of(&o);
    assert!(marks.panels.iter().enumerate().all(|(k, m)| *m == (k == 1)) && marks.patterns == marks.panels);

    let files = bundle::files(&o, &present(&o), "2026-01-01T00:00:00").expect("files");
    let text = |name: &str| String::from_utf8_lossy(&files.iter().find(|f| f.0 == name).expect(name).1).into_owned();
    for name in ["panels.step", "model.glb", "patterns.svg", "report.html"] {
        assert!(text(name).contains("A-02 NOT CERTIFIED") && !text(name).contains("A-01 NOT CERTIFIED"), "{name}");
    }
    let product = format!("PRODUCT('model (1 of {count} NOT CERTIFIED)'");
    assert!(text("panels.step").contains(&product));
    let layers = text("patterns.dxf");
    assert_eq!(layers.matches("\nCUT_OUTER\n").count(), count, "the other panels and the table of layers");
    assert!(layers.matches("\nNOT_CERTIFIED\n").count() > 10);
    let page = text("report.html");
    let first = &page[page.find("<body>").expect("a body")..][..200];
    assert!(first.contains("do not cut A-02."), "{first}");
    let report: serde_json::Value = serde_json::from_str(&text("report.json")).expect("json");
    assert_eq!(report["panels"][1]["certified"], false);
    assert_eq!(report["panels"][0]["certified"], true);
    assert!(report["panels"][1]["reason"].as_str().is_some_and(|r| r.contains("limits")));
    assert!(text("report.json").contains("where 8 mm are allowed"));
}

/// Strips of the piece of a torus run along its meridians when its axis is given as their direction, and around the
/// axis when the guide does.
#[test]
fn strips_follow_a_direction_and_a_guide() {
    let circle: Vec<Vec3> = (0..=40)
        .map(|i| (f64::from(i) * std::f64::consts::FRAC_PI_2 / 40.0).sin_cos())
        .map(|(s, c)| Vec3::new(850.0 * c, 850.0 * s, 0.0))
        .collect();
    let guides = [(Guide::Direction(Vec3::z()), true), (Guide::Curve(circle), false)];
    for (guide, meridians) in guides {
        let layout = Layout { guide: Some(guide), ..Layout::default() };
        let o = run(TORUS, &Options { layout, ..options(TIGHT) }).expect("an answer");
        assert_eq!(o.status(), Status::Certified);
        let seams = o.patchwork().seams();
        assert!(!seams.is_empty());
        for seam in seams {
            let edge = &seam.sides[0].run.edge;
            let d = Vec3::from(edge.point(0.55)) - Vec3::from(edge.point(0.45));
            let x = edge.point(0.5);
            // Share of the direction around the axis.
            let around = Vec3::new(-x[1], x[0], 0.0).normalize().dot(&d.normalize()).abs();
            assert!(if meridians { around < 0.5 } else { around > 0.85 }, "{around}");
        }
    }
}

fn turned(angle: f64) -> Vec3 {
    Vec3::new(angle.cos(), angle.sin(), 0.0)
}

/// A seam along a circle of the torus, and one along a curve that ends on the face: no panel lies on both sides.
#[test]
fn seams_along_curves_are_kept() {
    let face = &read(TORUS).expect("a model").faces[0];
    let ((u0, u1), (v0, v1)) = face.surface.domain();
    let (u, v) = (u0 + 0.4 * (u1 - u0), |s: f64| v0 + s * (v1 - v0));
    let part: Vec<Vec3> = (0..=40).map(|k| face.surface.point(u, v(0.3 + 0.4 * f64::from(k) / 40.0))).collect();
    for (meet, shape) in [(true, CurveShape::AlongV(0.4)), (false, CurveShape::Points(part))] {
        let seam_curves = vec![PanelCurve { name: "the seam".into(), shape }];
        let layout = Layout { seam_curves, ..Layout::default() };
        let o = run(TORUS, &Options { layout, meet, ..options(TOLERANCE) }).expect("an answer");
        assert_eq!(o.status(), Status::Certified);
        assert!(o.patchwork().panels.len() >= 2);
        for panel in &o.patchwork().panels {
            // Where the panel's border lies over the face: along u, mm at least.
            let speed = face.surface.jet(u, v(0.5)).du.norm();
            let along = trims(panel).into_iter().flatten().map(|p| {
                let x = panel.strip.patch.point(p[0], p[1]);
                (nearest(&face.surface, &x, [40, 40]).0[0] - u) * speed
            });
            let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
            assert!(lo > -TIGHT || hi < TIGHT, "{} (seams meet: {meet}): {lo} to {hi}", panel.strip.name);
        }
    }
    // A loop within a face whose mesh has no vertex inside it.
    let line = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let corners = [[0.0, 0.0], [0.0, 80.0], [120.0, 0.0], [120.0, 80.0]].map(|p| Vec3::new(p[0], p[1], 0.0));
    let plane = Face::untrimmed(Surface::new(line.clone(), line, &corners, None).expect("a plane"));
    let at = |k: i32| Vec3::new(60.0, 40.0, 0.0) + 15.0 * turned(f64::from(k % 40) * std::f64::consts::TAU / 40.0);
    let shape = CurveShape::Points((0..=40).map(at).collect());
    let layout = Layout { seam_curves: vec![PanelCurve { name: "a loop".into(), shape }], ..Layout::default() };
    let o =
        of_faces(vec![plane], Vec::new(), &Options { layout, ..options(0.1) }, &Control::default()).expect("an answer");
    assert_eq!((o.status(), o.patchwork().panels.len()), (Status::Certified, 2), "{:?}", o.claims());

    let shape = CurveShape::Section { normal: Vec3::x(), offset: 1e6 };
    let layout = Layout { seam_curves: vec![PanelCurve { name: "the seam".into(), shape }], ..Layout::default() };
    let e = run(TORUS, &Options { layout, ..options(TOLERANCE) }).expect_err("refused");
    assert!(matches!(&e, ApproximateError::Curve(CurveError::Misses { name, .. }) if name == "the seam"), "{e}");
}

#[test]
fn seams_that_are_asked_for_are_kept() {
    let plane = SeamPlane { normal: Vec3::x(), offset: 500.0 };
    let layout = Layout { seams: vec![plane], ..Layout::default() };
    for (meet, tolerance) in [(false, TIGHT), (true, TOLERANCE)] {
        let o = run(TORUS, &Options { layout: layout.clone(), meet, ..options(tolerance) }).expect("an answer");
        assert_eq!(o.status(), Status::Certified);
        for panel in &o.patchwork().panels {
            let heights =
                trims(panel).into_iter().flatten().map(|p| panel.strip.patch.point(p[0], p[1]).x - plane.offset);
            let (lo, hi) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
            // Panels leave the surface, and so the plane, by no more than the tolerance.
            assert!(lo > -tolerance || hi < tolerance, "{} (seams meet: {meet}): {lo} to {hi}", panel.strip.name);
        }
    }
    let layout = Layout { seams: vec![SeamPlane { offset: 5000.0, ..plane }], ..Layout::default() };
    let e = run(TORUS, &Options { layout, ..options(TOLERANCE) }).expect_err("refused");
    assert!(matches!(e, ApproximateError::SeamPlane { index: 1, .. }), "{e}");
    let layout = Layout { guide: Some(Guide::Direction(Vec3::zeros())), ..Layout::default() };
    let e = run(TORUS, &Options { layout, ..options(TOLERANCE) }).expect_err("refused");
    assert_eq!(e, ApproximateError::Guide);
}

/// Rings around the middle: every panel but the caps leaves it out, and seams run around it.
#[test]
fn rings_run_around_the_middle() {
    let layout = Layout { kind: LayoutKind::Rings, ..Layout::default() };
    let o = run(TORUS, &Options { layout, ..apart(TIGHT) }).expect("an answer");
    assert_eq!(o.status(), Status::Certified);
    // The middle of the piece, on its outer equator.
    let middle = Vec3::new(850.0 * 0.5f64.sqrt(), 850.0 * 0.5f64.sqrt(), 0.0);
    let seams = o.patchwork().seams();
    let closest = |s: &torse::patchwork::seam::Seam| {
        let edge = &s.sides[0].run.edge;
        (0..=20).map(|i| (Vec3::from(edge.point(f64::from(i) / 20.0)) - middle).norm()).fold(f64::INFINITY, f64::min)
    };
    // One cut goes through the middle, the other seams keep clear of it.
    assert!(seams.iter().filter(|s| closest(s) > 60.0).count() * 3 >= seams.len(), "{}", seams.len());
}

/// The piece of a torus with panels along one curve.
fn panels_along(shape: CurveShape, tolerance: f64) -> Result<Answer, ApproximateError> {
    let curves = vec![PanelCurve { name: "the curve".into(), shape }];
    run(TORUS, &Options { layout: Layout { curves, ..Layout::default() }, ..apart(tolerance) })
}

#[test]
fn panels_along_a_curve_go_on_until_the_face_is_covered() {
    let o = panels_along(CurveShape::AlongU(0.5), TIGHT).expect("an answer");
    assert_eq!(o.status(), Status::Certified);
    // Envelopes of tangent planes need about √2 times as many panels as best fits, which are two here.
    assert!(o.patchwork().panels.len() <= 3, "{}", o.patchwork().panels.len());
    assert!(o.along.iter().any(|a| a.step == 0) && o.along.iter().all(|a| a.curve == "the curve"));
    let widest = o.along.iter().map(|a| a.paper_estimate).fold(0.0, f64::max);
    assert!(widest > 0.5 * TIGHT && widest <= TIGHT, "{widest}");
}

/// Strips in the direction of a curve, where those along it and on from there would be clearly more: it names the one that
/// it lies in.
#[test]
fn strips_in_the_direction_of_a_curve_are_the_other_answer() {
    let o = panels_along(CurveShape::AlongU(0.5), 5.0).expect("an answer");
    assert_eq!(o.status(), Status::Certified);
    assert!(o.patchwork().panels.len() <= 4, "{}", o.patchwork().panels.len());
    assert!(matches!(&o.notes[..], [torse::answer::note::Note::DirectionOf { curve }] if curve == "the curve"));
    assert!(o.along.len() == 1 && o.along[0].step == 0 && o.along[0].curve == "the curve", "{:?}", o.along);
}

#[test]
fn a_section_gives_a_panel_or_a_direction() {
    let o = panels_along(CurveShape::Section { normal: Vec3::x(), offset: 400.0 }, TIGHT).expect("an answer");
    assert_eq!(o.status(), Status::Certified);
    assert!(o.along.iter().any(|a| a.step == 0) && o.along.iter().all(|a| a.curve == "the curve"));
}

#[test]
fn curves_of_no_use_are_refused_by_name() {
    let e = panels_along(CurveShape::Section { normal: Vec3::x(), offset: 1e6 }, 1.0).expect_err("misses");
    assert!(matches!(&e, ApproximateError::Curve(CurveError::Misses { name, .. }) if name == "the curve"), "{e}");
    let far: Vec<Vec3> = (0..9).map(|i| Vec3::new(0.0, 10.0 * i as f64, 5e3)).collect();
    let e = panels_along(CurveShape::Points(far), 1.0).expect_err("off the surface");
    assert!(matches!(e, ApproximateError::Curve(CurveError::Off { distance, .. }) if distance > 1e3), "{e}");
    let e = panels_along(CurveShape::Points(vec![Vec3::zeros(); 5]), 1.0).expect_err("no length");
    assert!(matches!(e, ApproximateError::Curve(CurveError::Empty { .. })), "{e}");
    let e = panels_along(CurveShape::Points(vec![Vec3::new(f64::NAN, 0.0, 0.0); 5]), 1.0).expect_err("not finite");
    assert!(matches!(e, ApproximateError::Curve(CurveError::Empty { .. })), "{e}");
    let e = panels_along(CurveShape::AlongV(1.5), 1.0).expect_err("no share");
    assert!(matches!(e, ApproximateError::Curve(CurveError::Share { .. })), "{e}");
}

#[test]
fn impossible_tolerances_are_refused() {
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let e = run(TORUS, &options(tolerance)).expect_err("refused");
        assert!(matches!(e, ApproximateError::Tolerance(_)), "{tolerance}: {e}");
    }
    let e = run(TORUS, &options(1e-12)).expect_err("refused");
    assert!(matches!(e, ApproximateError::Precision { least, .. } if least > 1e-12), "{e}");
    let e = run(TORUS, &Options { max_panels: Some(0), ..options(1.0) }).expect_err("refused");
    assert_eq!(e, ApproximateError::MaxPanels);
    let e = of_faces(Vec::new(), Vec::new(), &options(1.0), &Control::default()).expect_err("refused");
    assert!(matches!(e, ApproximateError::NoFaces(_)), "{e}");
}

/// Area of a face on a patch that is ruled along v: `−∮ F du` with `F(u, v) = ∫₀ᵛ |S_u × S_v| dv`, by Simpson's rule
/// along the rulings and along pieces of the sides that are short against the patch.
fn area_by_rulings(face: &Face) -> f64 {
    const PIECES: f64 = 500.0;
    let s = &face.surface;
    let ((u0, u1), _) = s.domain();
    let strip = |u: f64, v: f64| {
        let [a, b, c] = [0.0, 0.5 * v, v].map(|v| s.jet(u, v).normal().norm());
        v / 6.0 * (a + 4.0 * b + c)
    };
    let mut area = 0.0;
    for (p, q) in face.loops.iter().flat_map(|l| l.points.iter().zip(l.points.iter().cycle().skip(1))) {
        let n = ((q[0] - p[0]).abs() / (u1 - u0) * PIECES).ceil();
        let at = |x: f64| strip(p[0] + x * (q[0] - p[0]), p[1] + x * (q[1] - p[1]));
        for k in 0..n as u32 {
            let [a, b, c] = [0.0, 0.5, 1.0].map(|x| at((f64::from(k) + x) / n));
            area -= (q[0] - p[0]) / n * (a + 4.0 * b + c) / 6.0;
        }
    }
    area
}

#[test]
fn written_panels_are_read_back_face_by_face() {
    let o = torus();
    let files = bundle::files(o, &present(o), "2026-01-01T00:00:00").expect("files");
    let step = &files.iter().find(|f| f.0 == "panels.step").expect("panels.step").1;
    // The reader's chords are kept short enough for the area.
    let back = torse::read_with(step, &ReadOptions { chord_tolerance: Some(1e-5) }).expect("our own file");
    assert!(back.skipped.is_empty() && back.notes.is_empty(), "{:?} {:?}", back.skipped, back.notes);
    assert_eq!(back.faces.len(), o.patchwork().panels.len());
    for (face, (panel, pattern)) in back.faces.iter().zip(o.patchwork().panels.iter().zip(o.patterns())) {
        assert_eq!(face.name, panel.strip.name);
        let area = area_by_rulings(face);
        assert!(
            (area / pattern.area_in_space - 1.0).abs() < 1e-6,
            "{}: {area}, {}",
            panel.strip.name,
            pattern.area_in_space
        );
    }
}

#[test]
fn a_cone_with_holes_is_one_panel() {
    let o = run(CONE, &options(1.0)).expect("an answer");
    assert_eq!(o.status(), Status::Certified);
    assert_eq!(o.patchwork().panels.len(), 1);
    assert!(o.patchwork().panels[0].loops().len() >= 2, "holes are kept");
}

/// Bands across an arch need 4√ε each in the metric of its curvature; along them run six waves, over which fits with the
/// usual spans fail.
#[test]
fn bands_run_over_waves_as_far_as_the_face_goes() {
    let knots = |spans: usize, half: f64| Knots::uniform(3, spans, -half, half).expect("knots");
    let (ku, kv) = (knots(2, 150.0), knots(30, 500.0));
    let greville = |k: &Knots| -> Vec<f64> {
        (0..k.control_count()).map(|i| k.values()[i + 1..i + 4].iter().sum::<f64>() / 3.0).collect()
    };
    let along = greville(&kv);
    let height = |x: f64, y: f64| -x * x / 2000.0 + 15.0 * (std::f64::consts::TAU * y / 330.0).cos();
    let points: Vec<Vec3> =
        greville(&ku).iter().flat_map(|&x| along.iter().map(move |&y| Vec3::new(x, y, height(x, y)))).collect();
    let face = Face::untrimmed(Surface::new(ku, kv, &points, None).expect("a surface"));
    let answer = of_faces(vec![face], Vec::new(), &apart(0.5), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified);
    // 300 √(1/1000) / (4 √0.5) = 3.4.
    assert!(answer.patchwork().panels.len() <= 4, "{}", answer.patchwork().panels.len());
}

#[test]
fn a_bending_radius_that_no_cover_keeps_is_named_and_the_face_is_covered_all_the_same() {
    // Two plane panels are no cover for this.
    let tolerance = 12.0;
    let mut o = apart(tolerance);
    o.limits.min_bend_radius = Some(20_000.0);
    let out = run(TORUS, &o).expect("an answer");
    assert_eq!(out.status(), Status::Uncertified);
    let why = words::reason(out.claims(), &[]);
    assert!(why.contains("attempts whose panels bend with a radius of 20000 mm"), "{why}");
    // Deviation and cover are proven; only the bends are sharper than asked for.
    let certificate = out.certificate().expect("a certificate");
    assert!(certificate.covered && certificate.deviation_bound <= tolerance, "{}", certificate.deviation_bound);
    assert!(!out.beyond_limits.is_empty());
}

#[test]
fn a_width_that_asks_for_thousands_of_strips_is_refused_at_once() {
    let mut o = options(TOLERANCE);
    o.limits.max_width = Some(0.1);
    assert!(matches!(run(TORUS, &o), Err(ApproximateError::TooMany { .. })));
}
