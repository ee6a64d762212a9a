//! Where rulings that were laid are on the panel that they belong to.

use super::tip::{Tip, SHORT};
use crate::certify::refolded::{Along, JudgedPanel, SpanChord};
use crate::develop::refold::atlas::{Atlas, OnPanel};
use crate::geom::Vec2;
use crate::num::parallel;
use crate::spline::knots::Knots;
use crate::torse::ribbon::Span;
use nalgebra::Matrix2;

/// How far (in spans) an outline may lie beyond the rulings that were laid: rounding of tables.
pub(super) const BEYOND: f64 = 1e-3;
/// Shares of a span that are one place.
pub(super) const SAME: f64 = 1e-9;

/// Whether rulings of a part are straight in the parameters of their panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Straight {
    /// They are taken for straight.
    Taken,
    /// They are not where rulings of the panel lie across them.
    Not,
}

/// A panel of an atlas as it is judged.
pub(super) struct Seat<'a> {
    pub atlas: &'a Atlas,
    pub panel: usize,
    pub judged: &'a JudgedPanel<'a>,
    /// Places in the plane of the panel of places of the drawing: turn, shear and shift, where it is judged in its plane.
    in_plane: Option<(Matrix2<f64>, Vec2)>,
}

impl<'a> Seat<'a> {
    pub fn new(atlas: &'a Atlas, panel: usize, judged: &'a JudgedPanel<'a>) -> Self {
        let places = atlas.panels[panel].panel.loops.iter().flatten();
        let both: Option<Vec<[Vec2; 2]>> = places
            .map(|uv| {
                let on = OnPanel { panel, uv: *uv, off: 0.0 };
                Some([atlas.flat(&on), judged.in_its_plane(&atlas.space(&on))?.into()])
            })
            .collect();
        Self { atlas, panel, judged, in_plane: both.as_deref().and_then(linear_map) }
    }

    /// Parameters of the judged panel at a place of the drawing.
    fn parameters(&self, q: &Vec2) -> [f64; 2] {
        match &self.in_plane {
            Some((turn, shift)) => (turn * q + shift).into(),
            None => self.atlas.on_panel(self.panel, q),
        }
    }
}

/// The affine map with the least squares from the first to the second of all places.
fn linear_map(both: &[[Vec2; 2]]) -> Option<(Matrix2<f64>, Vec2)> {
    let middle = both.iter().fold([Vec2::zeros(); 2], |m, p| [m[0] + p[0], m[1] + p[1]]).map(|m| m / both.len() as f64);
    let (mut from, mut across) = (Matrix2::zeros(), Matrix2::zeros());
    for [p, q] in both {
        let (p, q) = (p - middle[0], q - middle[1]);
        from += p * p.transpose();
        across += q * p.transpose();
    }
    let turn = across * from.try_inverse()?;
    Some((turn, middle[1] - turn * middle[0]))
}

/// Inner parameters at which a patch is less than C¹, and how near to one is on it.
pub(super) fn creases(knots: &Knots) -> Vec<(f64, f64)> {
    let (first, last) = knots.domain();
    let inner = knots.distinct().into_iter().filter(|(t, m)| *m >= knots.degree() && *t > first && *t < last);
    inner.map(|(t, _)| (t, SAME * (last - first))).collect()
}

/// No stretch of a ruling.
pub(super) const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Where the rulings of spans are on their panel: by the flat image of two of their points, and of the one between them.
pub(super) fn places(
    spans: &[Span],
    lines: &[Vec<SpanChord>],
    seat: &Seat,
    (tip, along): (Option<&Tip>, Straight),
) -> Vec<Along> {
    let n = spans.len();
    let (mut reach, mut beside) = (vec![NOTHING; n + 1], vec![NOTHING; n + 1]);
    for p in lines.iter().flatten() {
        // A plane is one wide span: what the part has on its first and last ruling is all that is surely on the panel.
        let plane = spans[p.span].in_space.turn == 0.0;
        for (end, k) in [p.span, p.span + 1].into_iter().enumerate() {
            for e in &p.ends {
                let on = !plane || (e[0] - end as f64).abs() <= BEYOND;
                for all in [&mut beside].into_iter().chain(on.then_some(&mut reach)) {
                    all[k] = [all[k][0].min(e[1]), all[k][1].max(e[1])];
                }
            }
        }
    }
    // Where the part ends before a ruling, what is beside that.
    for (own, beside) in reach.iter_mut().zip(beside).filter(|(own, _)| own[0] > own[1]) {
        *own = beside;
    }
    let ways = || lines.iter().flatten().flat_map(|p| p.ends).map(|e| e[1]);
    let size = ways().fold(f64::NEG_INFINITY, f64::max) - ways().fold(f64::INFINITY, f64::min);
    let creases = creases(&seat.judged.surface().knots_u);
    let place = |k: usize| {
        let pose = if k < n { spans[k].flat } else { spans[n - 1].flat.moved(&spans[n - 1].in_plane, 1.0) };
        let [mut a, mut b] = reach[k];
        if b.is_nan() || a.is_nan() || b - a < SHORT * size {
            let middle = if a.is_finite() { 0.5 * (a + b) } else { 0.0 };
            (a, b) = (middle - 0.5 * SHORT * size, middle + 0.5 * SHORT * size);
        }
        // Beside a tip the least shift of the drawing is another ruling.
        let beside_tip = tip.map(|tip| (tip.at - pose.at.xy()).dot(&pose.ruling().xy()));
        if let Some(t) = beside_tip {
            let far = if (a - t).abs() > (b - t).abs() { a } else { b };
            (a, b) = (far, 0.5 * (far + t));
        }
        let middle = 0.5 * (a + b);
        let [p, m, q] = [a, middle, b].map(|v| seat.parameters(&pose.point(v, 0.0).xy()));
        // What is on a crease but for rounding must not cross it.
        let crease = creases.iter().find(|(t, hair)| (p[0] - t).abs() <= *hair && (q[0] - t).abs() <= *hair);
        let slope = [0, 1].map(|d: usize| (q[d] - p[d]) / (b - a));
        let rest = |d: usize| 4.0 * (0.5 * (p[d] + q[d]) - m[d]) / ((b - a) * (b - a));
        let bend = if along == Straight::Not && beside_tip.is_none() { [0, 1].map(rest) } else { [0.0; 2] };
        // Through the places at both ends and in the middle.
        let slope = [0, 1].map(|d: usize| slope[d] - bend[d] * (a + b));
        let found = Along { at: [0, 1].map(|d: usize| p[d] - (slope[d] + bend[d] * a) * a), slope, bend };
        let on_crease = |t: f64| Along { at: [t, found.at[1]], slope: [0.0, slope[1]], bend: [0.0, found.bend[1]] };
        crease.map_or(found, |(t, _)| on_crease(*t))
    };
    parallel::map(0..=n, place)
}
