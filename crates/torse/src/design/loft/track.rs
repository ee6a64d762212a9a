//! A rail prepared for common tangent planes: at corners the tangent turns on the spot \[W15, 4B\].
//!
//! Corners become segments of their own, on which the point rests while the tangent turns in the plane of both
//! tangents. On the track the tangent is continuous, so that fans about corners need no special case.

use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::torse::rail::{jet, span_length, tangent, Rail};
use std::sync::OnceLock;

/// A segment of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// A smooth piece of the rail.
    Piece(usize),
    /// A corner: the point rests, the tangent turns from `from` to `to`.
    Corner {
        /// Piece that ends here.
        after: usize,
        /// Place.
        point: Vec3,
        /// Unit tangent before.
        from: Vec3,
        /// Unit tangent behind.
        to: Vec3,
    },
}

/// A rail with its corners as segments. Its parameter runs over [0, number of segments].
#[derive(Clone, Debug)]
pub struct Track<'a> {
    /// The rail.
    pub rail: &'a Rail,
    /// Its segments.
    pub segments: Vec<Segment>,
    /// Lengths (mm) of the rail up to every knot of every piece: quadratures, once for all that ask.
    lengths: OnceLock<Vec<Vec<f64>>>,
}

/// Point and unit tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineElement {
    /// Point, mm.
    pub point: Vec3,
    /// Unit tangent.
    pub tangent: Vec3,
}

/// Turns (rad) below which pieces join smoothly.
const SMOOTH: f64 = 1e-6;
/// Rails that turn less than this (rad) as a whole are straight: rounding of their turns must not place nodes.
const LEAST_TURN: f64 = 1e-3;
/// A derivative below this share of the second one, by the piece's own parameter, has no direction to be trusted: the
/// piece stops within that share of itself.
const STOPS: f64 = 1e-6;
/// Length below which a mixture of two unit tangents has no direction.
const NO_DIRECTION: f64 = 1e-9;

impl<'a> Track<'a> {
    /// The track of a rail.
    pub fn new(rail: &'a Rail) -> Self {
        let n = rail.pieces.len();
        let mut segments = Vec::new();
        for k in 0..n {
            segments.push(Segment::Piece(k));
            if k + 1 < n || rail.closed {
                let next = &rail.pieces[(k + 1) % n];
                let (from, to) = (tangent(&rail.pieces[k], 1.0), tangent(next, 0.0));
                if from.angle(&to) > SMOOTH {
                    segments.push(Segment::Corner { after: k, point: jet(next, 0.0)[0], from, to });
                }
            }
        }
        Self { rail, segments, lengths: OnceLock::new() }
    }

    fn lengths(&self) -> &[Vec<f64>] {
        self.lengths.get_or_init(|| {
            let mut here = 0.0;
            let piece = |c: &Curve<4>| {
                let mut out = vec![here];
                for w in c.knots.breaks().windows(2) {
                    here += span_length(c, w[0], w[1]);
                    out.push(here);
                }
                out
            };
            self.rail.pieces.iter().map(piece).collect()
        })
    }

    /// Length of the whole rail, mm.
    pub fn length(&self) -> f64 {
        self.lengths().last().and_then(|l| l.last()).copied().unwrap_or(0.0)
    }

    /// Length of the rail from its start to `x`, mm.
    pub fn length_to(&self, x: f64) -> f64 {
        let s = self.rail_parameter(x);
        let k = (s.floor().max(0.0) as usize).min(self.rail.pieces.len() - 1);
        let (c, t) = (&self.rail.pieces[k], s - k as f64);
        let breaks = c.knots.breaks();
        let span = breaks.partition_point(|b| *b <= t).clamp(1, breaks.len() - 1) - 1;
        self.lengths()[k][span] + span_length(c, breaks[span], t)
    }

    /// Number of segments: the end of the parameter.
    pub fn end(&self) -> f64 {
        self.segments.len() as f64
    }

    /// Segment and the parameter on it; closed tracks go round.
    pub fn locate(&self, x: f64) -> (Segment, f64) {
        let n = self.segments.len();
        let x = if self.rail.closed && !(0.0..=self.end()).contains(&x) { x.rem_euclid(self.end()) } else { x };
        let k = (x.floor().max(0.0) as usize).min(n - 1);
        (self.segments[k], (x - k as f64).clamp(0.0, 1.0))
    }

    /// Point and tangent at `x`.
    pub fn at(&self, x: f64) -> LineElement {
        let (segment, t) = self.locate(x);
        line_element(self.rail, &segment, t)
    }

    /// The rail's own parameter at `x`, in [0, number of pieces].
    pub fn rail_parameter(&self, x: f64) -> f64 {
        match self.locate(x) {
            (Segment::Piece(k), t) => k as f64 + t,
            (Segment::Corner { after, .. }, _) => after as f64 + 1.0,
        }
    }

    /// Parameters of a grid of about `cells` cells: finer where the rail is long and where it turns; ends of segments
    /// belong to it. A closed track's last node, which is its first, is left out.
    pub fn nodes(&self, cells: usize) -> Vec<f64> {
        const PROBES: usize = 16;
        const FEWEST_PARTS: f64 = 4.0;
        let turn = |s: &Segment| -> f64 {
            match s {
                Segment::Corner { from, to, .. } => from.angle(to),
                Segment::Piece(k) => {
                    let c = &self.rail.pieces[*k];
                    let t: Vec<Vec3> = (0..=PROBES).map(|i| tangent(c, i as f64 / PROBES as f64)).collect();
                    t.windows(2).map(|w| w[0].angle(&w[1])).sum()
                }
            }
        };
        let length = |s: &Segment| match s {
            Segment::Corner { .. } => 0.0,
            Segment::Piece(k) => self.rail.piece_length(*k, 1.0),
        };
        let (turns, lengths): (Vec<f64>, Vec<f64>) = self.segments.iter().map(|s| (turn(s), length(s))).unzip();
        let (all_turns, all_lengths) =
            (turns.iter().sum::<f64>().max(LEAST_TURN), lengths.iter().sum::<f64>().max(f64::MIN_POSITIVE));
        let mut out = Vec::with_capacity(cells + 8 * self.segments.len());
        for (k, (t, l)) in turns.iter().zip(&lengths).enumerate() {
            let share = 0.5 * (t / all_turns + l / all_lengths);
            let parts = (share * cells as f64).ceil().max(FEWEST_PARTS) as usize;
            out.extend((0..parts).map(|i| k as f64 + i as f64 / parts as f64));
        }
        if !self.rail.closed {
            out.push(self.end());
        }
        out
    }
}

/// Point and tangent on a segment.
pub(crate) fn line_element(rail: &Rail, segment: &Segment, t: f64) -> LineElement {
    match segment {
        Segment::Piece(k) => {
            let c = &rail.pieces[*k];
            let j = jet(c, t);
            let speed = j[1].norm();
            let slow = speed <= STOPS * j[2].norm();
            LineElement { point: j[0], tangent: if slow { tangent(c, t) } else { j[1] / speed } }
        }
        Segment::Corner { point, from, to, .. } => {
            let angle = from.angle(to);
            let s = angle.sin();
            let mixed = from * (((1.0 - t) * angle).sin() / s) + to * ((t * angle).sin() / s);
            LineElement { point: *point, tangent: mixed.try_normalize(NO_DIRECTION).unwrap_or(*from) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_of_a_square_turn_on_the_spot_at_its_corners() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let rail = Rail::polyline("square", &points).expect("rail");
        let track = Track::new(&rail);
        assert_eq!(track.segments.len(), 8);
        let c = track.at(1.5);
        assert!((c.point - points[1]).norm() < 1e-14);
        assert!((c.tangent - Vec3::new(0.5f64.sqrt(), 0.5f64.sqrt(), 0.0)).norm() < 1e-14);
        assert!((track.at(-0.5).point - track.at(7.5).point).norm() < 1e-14);
        let nodes = track.nodes(100);
        assert!(nodes.windows(2).all(|w| w[0] < w[1]) && nodes.len() >= 100);
    }
}
