//! Closed lines on a panel beside its border: which place of the border belongs to which of theirs.

use crate::certify::refolded::SpanChord;
use crate::geom::Vec2;
use crate::num::parallel;
use crate::spline::surface::Surface;
use nalgebra::Matrix2;

/// Share of a piece within which a corner of the border is at its end.
const AT_END: f64 = 1e-6;

/// Lengths on a patch.
pub(super) struct Metric<'a> {
    surface: &'a Surface,
    /// In the middle of the patch.
    even: Matrix2<f64>,
}

/// Share of the lengths in the middle of a patch that count everywhere: at a tip all rulings are one point.
const EVEN: f64 = 1e-6;

impl<'a> Metric<'a> {
    pub fn of(surface: &'a Surface) -> Self {
        let ((u0, u1), (v0, v1)) = surface.domain();
        Self { surface, even: first_form(surface, &Vec2::new(0.5 * (u0 + u1), 0.5 * (v0 + v1))) }
    }

    /// The square of a length about a place, as a form in the parameters.
    pub fn at(&self, uv: &Vec2) -> Matrix2<f64> {
        first_form(self.surface, uv) + self.even * EVEN
    }
}

/// Scalar products of both derivatives of a patch.
fn first_form(surface: &Surface, uv: &Vec2) -> Matrix2<f64> {
    let jet = surface.jet(uv.x, uv.y);
    let mixed = jet.du.dot(&jet.dv);
    Matrix2::new(jet.du.norm_squared(), mixed, mixed, jet.dv.norm_squared())
}

/// A closed line with its places on the border of its panel, a polygon: cut where the border turns, because sides of the border
/// are as long as they are, and pieces that went around a corner would be compared with the wrong side of it.
pub(super) fn beside(
    line: Vec<SpanChord>,
    border: &[Vec2],
    metric: &Metric,
    on_patch: &(impl Fn(&SpanChord, [f64; 2]) -> Vec2 + Sync),
) -> Vec<SpanChord> {
    let (n, corners) = (line.len(), border.len() as f64);
    let place = |q: Vec2| nearest(border, &q, &metric.at(&q)).0;
    let mut at = vec![place(on_patch(&line[0], line[0].ends[0]))];
    let behind: Vec<f64> = parallel::map(line.iter(), |p| place(on_patch(p, p.ends[1])));
    for here in behind {
        let last = at[at.len() - 1];
        // The shorter way.
        let step = (here - last).rem_euclid(corners);
        at.push(last + if step > 0.5 * corners { step - corners } else { step });
    }
    let share = |p: &SpanChord, corner: f64| {
        let [a, b] = p.ends.map(|e| on_patch(p, e));
        let x = border[(corner as i64).rem_euclid(border.len() as i64) as usize];
        let way = metric.at(&a) * (b - a);
        way.dot(&(x - a)) / way.dot(&(b - a))
    };
    // Corners between the places of both ends, in the direction of the piece.
    let between = |a: f64, b: f64| {
        let mut all: Vec<f64> =
            (a.min(b).floor() as i64 + 1..).map(|k| k as f64).take_while(|x| *x < a.max(b)).collect();
        if b < a {
            all.reverse();
        }
        all
    };
    for (k, p) in line.iter().enumerate() {
        for c in between(at[k], at[k + 1]) {
            let x = share(p, c);
            if x <= AT_END {
                // The first place is the last one too.
                if k == 0 {
                    at[n] += c - at[0];
                }
                at[k] = c;
            } else if x >= 1.0 - AT_END {
                if k + 1 == n {
                    at[0] += c - at[n];
                }
                at[k + 1] = c;
                break;
            }
        }
    }
    let mut out = Vec::with_capacity(n);
    for (k, p) in line.into_iter().enumerate() {
        let mut rest = SpanChord { border: [at[k], at[k + 1]], ..p };
        let mut done = 0.0;
        for c in between(at[k], at[k + 1]) {
            let x = share(&p, c);
            if !(x > done + AT_END && x < 1.0 - AT_END) {
                continue;
            }
            let part = |a: f64, b: f64| a + (b - a) * (x - done) / (1.0 - done);
            let [[s, v], [t, w]] = rest.ends;
            let place = [part(s, t), part(v, w)];
            let drawn = rest.drawn.map(|[a, b]| (a, a + (b - a) * ((x - done) / (1.0 - done)), b));
            out.push(SpanChord {
                ends: [rest.ends[0], place],
                border: [rest.border[0], c],
                drawn: drawn.map(|(a, m, _)| [a, m]),
                ..rest
            });
            rest = SpanChord {
                ends: [place, rest.ends[1]],
                border: [c, rest.border[1]],
                drawn: drawn.map(|(_, m, b)| [m, b]),
                ..rest
            };
            done = x;
        }
        out.push(rest);
    }
    out
}

/// Place on a closed polygon nearest to a point (number of a corner and share of the way to the next), and its distance, with
/// lengths as they are about the point.
pub(super) fn nearest(polygon: &[Vec2], q: &Vec2, metric: &Matrix2<f64>) -> (f64, f64) {
    let mut best = (0.0, f64::INFINITY);
    for (k, p) in polygon.iter().enumerate() {
        let d = polygon[(k + 1) % polygon.len()] - p;
        let way = metric * d;
        let share = way.dot(&(q - p)) / way.dot(&d);
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        let away = q - p - d * share;
        let off = (metric * away).dot(&away);
        if off < best.1 {
            best = (k as f64 + share, off);
        }
    }
    (best.0, best.1.max(0.0).sqrt())
}
