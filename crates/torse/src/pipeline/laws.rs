//! Laws of jobs: what is unrolled has the size of its neutral fibre and keeps its holes, wherever it lies, large or small.

use super::unroll::{unroll, UnrollOptions};
use crate::certify::claim::Status;
use crate::control::Control;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::specimens::{BentSheet, Stretch};
use crate::geom::generated::{frame, powers_of_ten};
use crate::geom::placement::Placement;
use crate::geom::Frame;
use crate::io::model::Model;
use crate::pipeline::info::measure;
use proptest::prelude::*;

/// A sheet bent up and down in turn, with a window in its middle strip across some of its stretches.
#[derive(Clone, Debug)]
struct Bracket {
    thickness: f64,
    profile: Vec<Stretch>,
    lines: [f64; 4],
    window: Vec<[usize; 2]>,
}

impl Bracket {
    /// Length of each stretch on the neutral fibre.
    fn lengths(&self, k: f64) -> Vec<f64> {
        let of = |s: &Stretch| match *s {
            Stretch::Line(length) => length,
            Stretch::Bend(angle, inside) => angle.abs() * (inside + k * self.thickness),
        };
        self.profile.iter().map(of).collect()
    }

    fn model(&self, place: &Frame, size: f64) -> Model {
        let mut placement = Placement::of_frame(place);
        placement.linear *= size;
        let sheet = BentSheet::new(self.thickness, &self.profile, &self.lines, &self.window);
        Model {
            faces: sheet.faces().iter().map(|f| f.placed(&placement, "sheet")).collect(),
            skipped: Vec::new(),
            unit: "millimetre".into(),
            notes: Vec::new(),
            products: Vec::new(),
            curves: Vec::new(),
        }
    }
}

fn bracket() -> impl Strategy<Value = Bracket> {
    let bend = (10.0..40.0f64, powers_of_ten(-2.0..0.15), 0.5..6.0f64);
    let widths = [8.0..40.0f64, 8.0..40.0, 8.0..40.0];
    (proptest::collection::vec(bend, 1..4), 15.0..40.0f64, 0.5..3.0f64, widths, any::<[bool; 2]>(), any::<bool>())
        .prop_map(|(bends, last, thickness, [a, b, c], [holed, wide], up)| {
            let mut profile = Vec::new();
            for (k, (line, angle, inside)) in bends.iter().enumerate() {
                let sign = if (k % 2 == 0) == up { 1.0 } else { -1.0 };
                profile.extend([Stretch::Line(*line), Stretch::Bend(sign * angle, *inside)]);
            }
            // Straight before and behind the window, so that it is a hole.
            profile.extend([Stretch::Line(last), Stretch::Line(last)]);
            let n = profile.len();
            let first = if wide { 1 } else { n - 2 };
            let window = if holed { (first..n - 1).map(|i| [i, 1]).collect() } else { Vec::new() };
            Bracket { thickness, profile, lines: [0.0, a, a + b, a + b + c], window }
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]
    #[test]
    fn brackets_have_the_size_of_their_neutral_fibre(
        bracket in bracket(), k in 0.1..0.5f64, place in frame(1e3), size in powers_of_ten(-0.5..1.5),
    ) {
        let lengths = bracket.lengths(k);
        let [_, a, b, width] = bracket.lines;
        let cut: f64 = bracket.window.iter().map(|w| lengths[w[0]] * (b - a)).sum();
        let wanted = (lengths.iter().sum::<f64>() * width - cut) * size * size;
        let model = bracket.model(&place, size);
        let options = UnrollOptions { k: KFactor::Ansi(k), ..UnrollOptions::new(1e-3 * size) };
        let answer = unroll(&model, &options, &Control::default()).expect("an answer");
        prop_assert_eq!(answer.patterns().len(), 1);
        let pattern = &answer.patterns()[0];
        prop_assert!((pattern.area - wanted).abs() < 1e-6 * wanted, "{} {wanted}", pattern.area);
        prop_assert_eq!(pattern.contours.len(), if bracket.window.is_empty() { 1 } else { 2 });
        prop_assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims());
    }

    #[test]
    fn faces_are_as_large_as_they_are_scaled(
        bracket in bracket(), place in frame(1e3), size in powers_of_ten(-3.0..3.0),
    ) {
        let world = measure(&bracket.model(&Frame::world(), 1.0).faces);
        let moved = measure(&bracket.model(&place, size).faces);
        prop_assert_eq!(world.len(), moved.len());
        for (a, b) in world.iter().zip(&moved) {
            let areas = [a.area_estimate * size * size, b.area_estimate];
            prop_assert!((areas[1] - areas[0]).abs() < 1e-6 * areas[1], "{areas:?}");
            prop_assert_eq!(a.character(), b.character());
            let radii = [a.smallest_radius().map(|r| r * size), b.smallest_radius()];
            let near = radii[0].zip(radii[1]).is_none_or(|(r, s)| (r - s).abs() < 1e-4 * s);
            prop_assert!(near && radii[0].is_some() == radii[1].is_some(), "{radii:?}");
        }
    }
}
