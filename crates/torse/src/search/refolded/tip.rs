//! The tip in which the rulings of a cone meet.

use crate::develop::refold::atlas::{Atlas, OnPanel};
use crate::geom::Vec2;
use crate::torse::ribbon::{Ribbon, Span};

/// Rulings with so little of the part on them (share of its size) are looked at as if it were so much.
pub(super) const SHORT: f64 = 1e-3;

/// The tip of a cone in the plane, where rulings have no places: outlines go around it.
pub(super) struct Tip {
    /// Where it is.
    pub at: Vec2,
    /// How far from it they keep, mm.
    pub around: f64,
}

impl Tip {
    /// Where all rulings of a part on a panel meet, if they do so at an end of the panel.
    pub fn of(size: f64, ribbon: &Ribbon, atlas: &Atlas, panel: usize) -> Option<Self> {
        let meet = |s: &Span| {
            let (pose, rates) = (&s.flat, &s.in_plane);
            pose.at.xy() - pose.ruling().xy() * (rates.across / rates.spin)
        };
        let at = meet(ribbon.spans.get(ribbon.spans.len() / 2)?);
        // Rulings that are parallel meet nowhere.
        let farther = |most: f64, off: f64| if off.is_nan() { f64::INFINITY } else { most.max(off) };
        let apart = ribbon.spans.iter().map(|s| (meet(s) - at).norm()).fold(0.0, farther);
        let corners = atlas.panels[panel].panel.loops.iter().flatten();
        // Panels end a hair before their tips.
        let hair = corners.map(|uv| (atlas.flat(&OnPanel { panel, uv: *uv, off: 0.0 }) - at).norm());
        let around = (ROOM * hair.fold(f64::INFINITY, f64::min)).max(ONE_POINT * size).max(2.0 * apart);
        (apart <= NEARLY_ONE_POINT * size && around < SHORT * size).then_some(Self { at, around })
    }

    /// Way along the ruling at a place to the tip.
    pub fn on(&self, ribbon: &Ribbon, t: f64) -> f64 {
        let pose = ribbon.flat(t);
        (self.at - pose.at.xy()).dot(&pose.ruling().xy())
    }

    /// The corners of a polygon from the first one behind the tip to the last one before it, and those between these beside the
    /// tip; `None` where there are not one run of each.
    pub fn split(&self, polygon: &[Vec2]) -> Option<(Vec<Vec2>, Vec<Vec2>)> {
        let near = |q: &Vec2| (q - self.at).norm() <= self.around;
        let n = polygon.len();
        let first = (0..n).find(|&k| near(&polygon[(k + n - 1) % n]) && !near(&polygon[k]))?;
        let turned: Vec<Vec2> = (0..n).map(|k| polygon[(first + k) % n]).collect();
        let count = turned.iter().take_while(|q| !near(q)).count();
        turned[count..].iter().all(near).then(|| (turned[..count].to_vec(), turned[count..].to_vec()))
    }
}

/// Share of the size of a part within which rulings that were laid meet in one point, which is known to what lines of files are.
const NEARLY_ONE_POINT: f64 = 1e-5;
/// Least way around it, as a share of the size; twice what rulings miss it by, if that is more.
const ONE_POINT: f64 = 1e-6;
/// Way around a tip, in lengths of what a panel leaves of it: that the line goes around it counts once as distance from the outline, and
/// what it is farther off than the panel as distance from its border.
const ROOM: f64 = 1.1;
