//! Strips that meet, through the public interface on a piece of a torus.

use std::sync::{Arc, OnceLock};

use torse::answer::Answer;
use torse::certify::claim::Status;
use torse::certify::Certificate;
use torse::certify::SeamStatus;
use torse::control::Control;
use torse::geom::Vec3;
use torse::io::step::read::read;
use torse::io::step::write::{panels, Header};
use torse::patchwork::panel::Border;
use torse::patchwork::seam::Seam;
use torse::pipeline::approximate::{of_faces, Options};
use torse::torse::form::PanelKind;

const TORUS: &[u8] = include_bytes!("../../../data/torus_piece.step");
const TOLERANCE: f64 = 2.0;

fn run(options: Options) -> Answer {
    let model = read(TORUS).expect("a model");
    of_faces(model.faces, model.skipped, &options, &Control::default()).expect("an answer")
}

fn proof(answer: &Answer) -> &Certificate {
    answer.certificate().expect("a certificate")
}

/// As strips are unless something else is asked for.
fn met() -> &'static Answer {
    static DONE: OnceLock<Answer> = OnceLock::new();
    DONE.get_or_init(|| run(Options::new(TOLERANCE)))
}

fn alone() -> &'static Answer {
    static DONE: OnceLock<Answer> = OnceLock::new();
    DONE.get_or_init(|| run(Options { meet: false, ..Options::new(TOLERANCE) }))
}

/// The STEP file of panels.
fn step_file(answer: &Answer) -> String {
    let header = Header { name: "panels".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-3 };
    let bytes = panels(&header, answer.patchwork(), &[]).expect("a file");
    String::from_utf8(bytes).expect("text")
}

#[test]
fn strips_that_meet_are_certified_and_as_many_as_before() {
    let (alone, met) = (alone(), met());
    assert_eq!(met.status(), Status::Certified);
    assert_eq!(met.patchwork().panels.len(), alone.patchwork().panels.len());
    assert!(met.patchwork().panels.len() >= 4);
    assert_eq!(proof(met).seams.len(), met.patchwork().panels.len() - 1);
    assert!(proof(met).seams.iter().all(|s| s.status == SeamStatus::Exact), "{:?}", proof(met).seams);
    assert!(proof(alone).seams.iter().all(|s| s.status != SeamStatus::Exact));
    assert!(proof(met).seam_gap_bound < 0.01 * TOLERANCE && proof(alone).seam_gap_bound > 0.02 * TOLERANCE);
}

/// A face that is turned about an axis and has a pole: cones, as few as chords of its meridian, all of whose circles are common edges,
/// as are the slits in which they close.
#[test]
fn cones_about_an_axis_meet_in_circles() {
    let model = read(include_bytes!("../../../data/dished_end.step")).expect("a model");
    let tolerance = 10.0;
    let answer =
        of_faces(model.faces, model.skipped, &Options::new(tolerance), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified);
    let panels = &answer.patchwork().panels;
    assert!(panels.len() == 3 && panels.iter().all(|p| p.strip.kind == PanelKind::Cone), "{}", panels.len());
    let seams = &proof(&answer).seams;
    assert!(seams.len() == 5 && seams.iter().all(|s| s.status == SeamStatus::Exact), "{seams:?}");
    assert_eq!(seams.iter().filter(|s| s.panels[0] == s.panels[1]).count(), 3);
    for edge in panels.iter().flat_map(|p| p.loops()).flatten().filter(|c| matches!(c.border, Border::Seam { .. })) {
        let [a, b] = [0.0, 0.37].map(|s| Vec3::from(edge.edge.point(s)));
        assert!((a.xy().norm() - b.xy().norm()).abs() < 1e-3 && (a.z - b.z).abs() < 1e-3, "{a} {b}");
    }
}

/// Cones that are too large for a sheet are cut along rulings into equal sectors, which meet each other too, the first and the last
/// where the face closes.
#[test]
fn cones_about_an_axis_are_cut_into_sectors_that_fit_the_sheet() {
    let model = read(include_bytes!("../../../data/dished_end.step")).expect("a model");
    let mut options = Options::new(10.0);
    options.limits.sheet = Some([1000.0, 2000.0]);
    let answer = of_faces(model.faces, model.skipped, &options, &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified);
    let panels = &answer.patchwork().panels;
    assert!(panels.len() == 5 && panels.iter().all(|p| p.strip.kind == PanelKind::Cone), "{}", panels.len());
    assert!(answer.patterns().iter().all(|p| p.length <= 2000.0 && p.width <= 1000.0));
    let seams = &proof(&answer).seams;
    assert!(seams.len() == 9 && seams.iter().all(|s| s.status == SeamStatus::Exact), "{seams:?}");
    // The cap stays whole; its ends keep an edge each in the file, on the same two vertices.
    let slits = seams.iter().filter(|s| s.panels[0] == s.panels[1]).count();
    let runs = panels.iter().flat_map(|p| p.loops()).flatten().filter(|r| !r.is_point()).count();
    let text = step_file(&answer);
    assert_eq!((slits, text.matches("=EDGE_CURVE(").count()), (1, runs - (seams.len() - slits)));
    assert_eq!((text.matches("=OPEN_SHELL(").count(), text.matches("=SEAM_CURVE(").count()), (1, 0));
}

/// Panels that are too large for a sheet are laid so that they meet, and cut then: their parts do so as well.
#[test]
fn parts_of_panels_that_meet_do_so_too() {
    let mut options = Options::new(8.0);
    options.limits.max_length = Some(400.0);
    let answer = run(options);
    assert_eq!(answer.status(), Status::Certified);
    let (patchwork, seams) = (answer.patchwork(), &proof(&answer).seams);
    assert!(answer.patterns().iter().all(|p| p.length <= 400.0));
    assert!(!seams.is_empty() && seams.iter().all(|s| s.status == SeamStatus::Exact), "{seams:?}");
    // Some of them are cuts through one torse, which goes on smoothly.
    let smooth = |s: &Seam| (1..8).all(|k| s.kink(f64::from(k) / 8.0) < 1e-6);
    assert!(patchwork.seams().iter().any(smooth) && !patchwork.seams().iter().all(smooth));
}

/// Whoever stops the work while strips are joined keeps the cover, proven as it was.
#[test]
fn what_was_certified_stays_so_when_joining_is_stopped() {
    let shared: Arc<OnceLock<Control>> = Arc::default();
    let stop = Arc::clone(&shared);
    let control = Control::with_progress(Arc::new(move |p| {
        if p.stage == "joining strips" {
            stop.get().expect("the control").cancel();
        }
    }));
    assert!(shared.set(control.clone()).is_ok());
    let model = read(TORUS).expect("a model");
    let found = of_faces(model.faces, model.skipped, &Options::new(TOLERANCE), &control).expect("an answer");
    assert!(control.stopped());
    assert_eq!(found.status(), Status::Certified);
    assert_eq!(found.patchwork().panels.len(), alone().patchwork().panels.len());
    assert!(proof(&found).seams.iter().all(|s| s.status != SeamStatus::Exact));
}

/// No point of a seam is farther apart than its bound, which exceeds the greatest distance by little.
#[test]
fn bounds_of_gaps_hold_at_every_place_and_are_close() {
    // The share of the tolerance to which gaps are enclosed, and as much again for the places between samples.
    const SLACK: f64 = 2e-3;
    let seams = alone().patchwork().seams();
    assert_eq!(seams.len(), proof(alone()).seams.len());
    for (seam, proof) in seams.iter().zip(&proof(alone()).seams) {
        assert_eq!(proof.panels, seam.sides.map(|s| s.panel));
        let bound = proof.gap_bound;
        let [a, b] = seam.sides;
        let greatest = (0..=4000)
            .map(|k| f64::from(k) / 4000.0)
            .map(|s| {
                let (p, q) = (a.run.trim.point(s), b.run.trim.point(1.0 - s));
                (a.of.strip.patch.point(p[0], p[1]) - b.of.strip.patch.point(q[0], q[1])).norm()
            })
            .fold(0.0, f64::max);
        assert!(greatest > 0.0 && bound >= greatest, "seam {}: {bound} below {greatest}", seam.seam);
        assert!(bound <= greatest + SLACK * TOLERANCE, "seam {}: {bound} for {greatest}", seam.seam);
    }
}

/// The kink of a seam is about `κ ω`, with ω the length of the rulings between the middles of both strips.
#[test]
fn seams_are_creases_with_the_angle_of_theory() {
    for s in &proof(met()).seams {
        let (least, most) = s.kink_range_estimate;
        assert!(least > 0.2 && most < 0.5, "{least} {most}");
    }
}

#[test]
fn both_sides_of_an_exact_seam_are_one_edge_in_space() {
    for seam in met().patchwork().seams() {
        assert!(seam.is_shared());
        for k in 0..=200 {
            let s = f64::from(k) / 200.0;
            let y = Vec3::from(seam.sides[0].run.edge.point(s));
            for (side, s) in [(&seam.sides[0], s), (&seam.sides[1], 1.0 - s)] {
                let q = side.run.trim.point(s);
                assert!((side.of.strip.patch.point(q[0], q[1]) - y).norm() < 1e-3 * TOLERANCE);
            }
        }
    }
}

#[test]
fn flat_edges_of_an_exact_seam_have_equal_lengths() {
    let met = met();
    for seam in met.patchwork().seams() {
        let [a, b] = seam.sides.map(|side| {
            let pattern = &met.patterns()[side.panel];
            let ours = |b: &Border| matches!(b, Border::Seam { seam: k, .. } if *k == seam.seam);
            pattern.sides.iter().find(|s| ours(&s.border)).expect("a side").length
        });
        assert!((a - b).abs() < 1e-9 * a, "{a} {b}: {:e}", (a - b) / a);
        assert!((a - seam.length()).abs() < 1e-8 * a, "{a} {}", seam.length());
    }
}

/// Euler: faces, shared edges and free edges of one shell that is a strip of panels.
#[test]
fn the_step_file_holds_one_shell_with_shared_edges() {
    let text = step_file(met());
    let count = |what: &str| text.matches(what).count();
    let n = met().patchwork().panels.len();
    assert_eq!(count("=OPEN_SHELL("), 1);
    assert_eq!(count("=ADVANCED_FACE("), n);
    let runs: usize = met().patchwork().panels.iter().flat_map(|p| p.loops()).map(Vec::len).sum();
    assert_eq!(count("=EDGE_CURVE("), runs - (n - 1));
    assert_eq!(count("=ORIENTED_EDGE("), runs);
}
