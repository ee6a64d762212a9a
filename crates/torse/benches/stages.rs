//! The main job on half a bowl at 1 mm, stage by stage: where its time goes.

use std::sync::OnceLock;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::brep::face::Face;
use torse::certify;
use torse::control::Control;
use torse::develop::pattern::{pattern, PatternOptions};
use torse::fit::strip_potential::{strip_potentials, StripPotentialOptions};
use torse::io::bundle;
use torse::io::step::read::read;
use torse::pipeline::approximate::{of_faces, Options};
use torse::search::cover::{cover, Cover, CoverOptions, Layout, Limits};

const BOWL: &[u8] = include_bytes!("../../../data/half_bowl.step");

/// Tolerance, mm.
const TOLERANCE: f64 = 1.0;

fn main() {
    divan::main();
}

fn face() -> Face {
    read(BOWL).expect("a model").faces.remove(0)
}

/// The job done once: what later stages begin with.
fn answer() -> &'static Answer {
    static DONE: OnceLock<Answer> = OnceLock::new();
    DONE.get_or_init(|| {
        let options = Options { smooth_angle: 0.0, ..Options::new(TOLERANCE) };
        of_faces(vec![face()], Vec::new(), &options, &Control::default()).expect("an answer")
    })
}

#[divan::bench]
fn reading() -> usize {
    read(BOWL).expect("a model").faces.len()
}

/// One of the two spaces in which strip potentials are sought.
#[divan::bench(sample_count = 10)]
fn field(bencher: divan::Bencher) {
    let cover = Cover::of_face(&face(), f64::INFINITY).expect("a triangulation");
    let (forms, places) = (cover.region(0).forms(1500), cover.region(0).places());
    bencher.bench(|| {
        strip_potentials(
            &forms,
            &places,
            &StripPotentialOptions { spans: 3, keep: 3, ..StripPotentialOptions::default() },
        )
        .len()
    });
}

/// Field, fits and the proofs that accept them.
#[divan::bench(sample_count = 3)]
fn cover_with_proofs(bencher: divan::Bencher) {
    let face = face();
    let options = CoverOptions {
        tolerance: TOLERANCE,
        max_panels: usize::MAX,
        facets: false,
        limits: Limits::default(),
        layout: Layout::default(),
    };
    bencher.bench(|| cover(&face, &options, &Control::default()).expect("a cover").panels.len());
}

/// The last proof, of panels as they are written.
#[divan::bench(sample_count = 10)]
fn certificate(bencher: divan::Bencher) {
    let patchwork = &answer().patchwork();
    bencher.bench(|| certify::patchwork(patchwork, TOLERANCE, &Control::default()).deviation_bound);
}

/// Flat patterns of all panels.
#[divan::bench(sample_count = 10)]
fn development(bencher: divan::Bencher) {
    let patchwork = &answer().patchwork();
    let options = PatternOptions::new(0.05 * TOLERANCE);
    let one = |k| pattern(patchwork, k, &options).expect("a pattern").width;
    bencher.bench(|| (0..patchwork.panels.len()).map(one).sum::<f64>());
}

/// STEP, DXF, SVG, GLB, pictures, report.
#[divan::bench(sample_count = 3)]
fn files(bencher: divan::Bencher) {
    let answer = answer();
    bencher.bench(|| bundle::files(answer, &present(answer), "2000-01-01T00:00:00").expect("files").len());
}
