//! Places of a ribbon by points of the plane.

use crate::geom::{Vec2, Vec3};
use crate::torse::ribbon::pose::Pose;
use crate::torse::ribbon::{Ribbon, Span, Spot};

/// Steps of Newton's method; they converge quadratically from any place inside a span.
const STEPS: usize = 12;
/// Step (share of a span) below which Newton's method has ended.
const LAST_STEP: f64 = 1e-14;
/// Share of a span by which places may lie beyond its ends: rounding.
const SLACK: f64 = 1e-9;
/// How far (in spans) beyond its ends a ribbon may be continued.
const BEYOND: f64 = 64.0;

impl Ribbon {
    /// The place of a point of the plane; the one nearest to the sheet where rulings cross in it.
    pub fn locate(&self, q: &Vec2) -> Option<Spot> {
        let n = self.spans.len();
        // Of the plane: there are many rulings, and few near the point.
        let side = |pose: &Pose| (q.x - pose.at.x) * pose.axes[(0, 1)] + (q.y - pose.at.y) * pose.axes[(1, 1)];
        let offer = |best: &mut Option<(f64, Spot)>, k: usize, start: f64, limits: [f64; 2]| {
            let Some(share) = self.share(k, q, start, limits) else { return };
            let spot = self.spot(k, share, q);
            let Span { reach: [a, b], in_plane, .. } = &self.spans[k];
            // Beyond its ends a ribbon is a continuation: what lies on it comes first.
            let outside = (-(k as f64 + share)).max(k as f64 + share - n as f64).max(0.0);
            let speed = (in_plane.across + spot.v * in_plane.spin).abs();
            let off = (a - spot.v).max(spot.v - b).max(0.0) + outside * speed;
            if best.is_none_or(|(least, _)| off < least) {
                *best = Some((off, spot));
            }
        };
        let mut best: Option<(f64, Spot)> = None;
        let mut here = side(&self.spans.first()?.flat);
        for k in 0..n {
            let next = self.spans.get(k + 1).map_or_else(|| side(&self.flat(self.end())), |s| side(&s.flat));
            if here >= 0.0 && next <= 0.0 || here <= 0.0 && next >= 0.0 {
                let whole = here - next;
                let start = if whole == 0.0 { 0.5 } else { here / whole };
                offer(&mut best, k, start, [0.0, 1.0]);
            }
            here = next;
        }
        if best.is_none_or(|b| b.0 > 0.0) {
            offer(&mut best, 0, 0.0, [-BEYOND, 0.0]);
            offer(&mut best, n - 1, 1.0, [1.0, 1.0 + BEYOND]);
        }
        best.map(|b| b.1)
    }

    fn spot(&self, k: usize, share: f64, q: &Vec2) -> Spot {
        let s = &self.spans[k];
        let pose = s.flat.moved(&s.in_plane, share);
        Spot { t: k as f64 + share, v: (Vec3::new(q.x, q.y, 0.0) - pose.at).dot(&pose.ruling()) }
    }

    /// Share of a span at which its ruling runs through a point.
    fn share(&self, k: usize, q: &Vec2, start: f64, limits: [f64; 2]) -> Option<f64> {
        let s = &self.spans[k];
        let (mut share, mut left) = (start, f64::INFINITY);
        for _ in 0..STEPS {
            let pose = s.flat.moved(&s.in_plane, share);
            let off = Vec3::new(q.x, q.y, 0.0) - pose.at;
            let (across, along) = (off.dot(&pose.across()), off.dot(&pose.ruling()));
            let slope = s.in_plane.across + along * s.in_plane.spin;
            let step = across / slope;
            if !step.is_finite() {
                return None;
            }
            // A step that stays beyond the limits does not lead to the point.
            left = step.abs();
            if left < LAST_STEP {
                break;
            }
            share = (share + step).clamp(limits[0] - SLACK, limits[1] + SLACK);
        }
        (left <= SLACK).then_some(share)
    }
}
