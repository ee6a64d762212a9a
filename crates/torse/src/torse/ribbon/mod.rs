//! Rulings in the plane with their places in space: the map that bends a flat part, piece by piece exactly a plane, a
//! circular cylinder or a circular cone ([`pose`]).

pub mod pose;

use crate::geom::Vec3;
use pose::{Pose, Rates};

/// A stretch between two rulings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// First ruling in the plane.
    pub flat: Pose,
    /// First ruling in space.
    pub space: Pose,
    /// How it moves in the plane; no turn.
    pub in_plane: Rates,
    /// How it moves in space.
    pub in_space: Rates,
    /// Which part of the first ruling belongs to the sheet, mm along it.
    pub reach: [f64; 2],
}

impl Span {
    /// From one share of it to another; beyond 0 and 1 it goes on as it is.
    pub fn part(&self, [from, to]: [f64; 2]) -> Self {
        let part = |r: &Rates| {
            let x = to - from;
            Rates { turn: r.turn * x, spin: r.spin * x, along: r.along * x, across: r.across * x }
        };
        Self {
            flat: self.flat.moved(&self.in_plane, from),
            space: self.space.moved(&self.in_space, from),
            in_plane: part(&self.in_plane),
            in_space: part(&self.in_space),
            reach: self.reach,
        }
    }
}

/// A sequence of rulings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ribbon {
    /// Stretches in order; each begins where the one before ends.
    pub spans: Vec<Span>,
}

/// A place on a ribbon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Number of the span and share of it: below 0 and beyond the number of spans the outermost spans go on.
    pub t: f64,
    /// Way along the ruling, mm.
    pub v: f64,
}

impl Ribbon {
    /// The stretch between two places, at least as long as a share of a span.
    pub fn between(&self, [from, to]: [f64; 2]) -> Self {
        let n = self.spans.len();
        let first = (from.max(0.0) as usize).min(n.saturating_sub(1));
        let last = (to.ceil().max(0.0) as usize).clamp(first + 1, n.max(first + 1)) - 1;
        let ends = |k: usize| {
            let at = k as f64;
            [if k == first { from - at } else { 0.0 }, if k == last { to - at } else { 1.0 }]
        };
        let spans = (first..=last).filter_map(|k| Some(self.spans.get(k)?.part(ends(k)))).collect();
        Self { spans }
    }

    /// The same rulings and more: every span in so many parts.
    pub fn parted(&self, parts: &[usize]) -> Self {
        let of = |(s, n): (&Span, &usize)| {
            let share = |i: usize| i as f64 / *n as f64;
            (0..*n).map(|i| s.part([share(i), share(i + 1)])).collect::<Vec<_>>()
        };
        Self { spans: self.spans.iter().zip(parts).flat_map(of).collect() }
    }

    /// Range of the parameter.
    pub fn end(&self) -> f64 {
        self.spans.len() as f64
    }

    /// The stretch that holds a place, and the share of it.
    pub fn span(&self, t: f64) -> (&Span, f64) {
        let k = (t.max(0.0) as usize).min(self.spans.len() - 1);
        (&self.spans[k], t - k as f64)
    }

    /// The ruling in the plane.
    pub fn flat(&self, t: f64) -> Pose {
        let (s, share) = self.span(t);
        s.flat.moved(&s.in_plane, share)
    }

    /// The ruling in space.
    pub fn space(&self, t: f64) -> Pose {
        let (s, share) = self.span(t);
        s.space.moved(&s.in_space, share)
    }

    /// The point in space, and the unit vectors along the ruling, across it and square to the sheet.
    pub fn frame(&self, spot: &Spot) -> (Vec3, Pose) {
        let pose = self.space(spot.t);
        (pose.point(spot.v, 0.0), pose)
    }

    /// Greatest turn of the sheet per mm across, over the sheet: one over the least radius of curvature.
    pub fn curvature(&self) -> f64 {
        let of = |s: &Span| {
            let widths = s.reach.map(|v| (s.in_space.across + v * s.in_space.spin).abs());
            let least = widths[0].min(widths[1]);
            if s.in_space.turn == 0.0 {
                0.0
            } else {
                s.in_space.turn.abs() / least
            }
        };
        self.spans.iter().map(of).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec2;

    #[test]
    fn a_stretch_is_where_it_was_on_the_whole() {
        let rates = Rates { turn: 0.3, spin: 0.1, along: 1.0, across: 5.0 };
        let mut pose = Pose::flat(Vec2::new(1.0, 2.0), Vec2::x());
        let mut spans = Vec::new();
        for _ in 0..4 {
            spans.push(Span { flat: pose, space: pose, in_plane: rates, in_space: rates, reach: [0.0, 1.0] });
            pose = pose.moved(&rates, 1.0);
        }
        let whole = Ribbon { spans };
        let parted = whole.parted(&[1, 3, 1, 2]);
        assert!(parted.spans.len() == 7 && (parted.space(7.0).at - whole.space(4.0).at).norm() < 1e-12);
        assert!((parted.space(3.0).at - whole.space(1.0 + 2.0 / 3.0).at).norm() < 1e-12);
        for (from, to) in [(0.5, 3.25), (1.0, 2.0), (2.2, 2.7), (-0.5, 4.5)] {
            let part = whole.between([from, to]);
            for (t, s) in [(from, 0.0), (to, part.end())] {
                assert!((whole.space(t).at - part.space(s).at).norm() < 1e-12, "{from} {to}");
            }
        }
    }
}
