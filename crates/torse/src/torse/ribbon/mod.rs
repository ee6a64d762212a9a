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
