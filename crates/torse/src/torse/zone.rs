//! Where a regression curve must not be: the region of interest of \[PW99, 4.4\], as people give it.

use crate::geom::Vec3;

/// Points whose coordinates lie in three ranges: a slab if only one is bounded, a box if all are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Smallest and largest coordinate along each axis, mm; infinite where there is no bound.
    pub ranges: [(f64, f64); 3],
}

impl Zone {
    /// A zone without bounds: everything.
    pub const ALL: Self = Self { ranges: [(f64::NEG_INFINITY, f64::INFINITY); 3] };

    /// The slab between two planes square to an axis (0, 1 or 2), mm.
    pub fn slab(axis: usize, from: f64, to: f64) -> Self {
        let mut out = Self::ALL;
        if let Some(r) = out.ranges.get_mut(axis) {
            *r = (from, to);
        }
        out
    }

    /// Whether each range is one and at least one is bounded.
    pub(crate) fn is_usable(&self) -> bool {
        self.ranges.iter().all(|(a, b)| a <= b) && self.ranges.iter().any(|(a, b)| a.is_finite() || b.is_finite())
    }

    /// The part of the line `point + s direction` in the zone as an interval of s, perhaps without end; `None` if the
    /// line misses the zone.
    pub(crate) fn part(&self, point: &Vec3, direction: &Vec3) -> Option<(f64, f64)> {
        let (mut a, mut b) = (f64::NEG_INFINITY, f64::INFINITY);
        for (k, (from, to)) in self.ranges.iter().enumerate() {
            let (p, d) = (point[k], direction[k]);
            if d == 0.0 {
                if p < *from || p > *to {
                    return None;
                }
                continue;
            }
            let (s, t) = ((from - p) / d, (to - p) / d);
            (a, b) = (a.max(s.min(t)), b.min(s.max(t)));
        }
        (a <= b).then_some((a, b))
    }
}

/// What is asked of regression curves: a distance from the strip that they belong to, and zones they keep out of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegressionLimits {
    /// Least distance along the rulings between a strip and its regression curve, mm.
    pub clearance: f64,
    /// Zones that no regression curve enters.
    pub zones: Vec<Zone>,
}

/// Limits that are not usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitsError {
    /// A clearance that is no length.
    #[error("the clearance {0} of the regression curve is not a length")]
    Clearance(f64),
    /// A zone, by its index, without inside or outside.
    #[error(
        "zone {index} of the regression curve is empty or everything (x from {} to {}, y from {} to {}, z from {} to {} mm)",
        ranges[0].0, ranges[0].1, ranges[1].0, ranges[1].1, ranges[2].0, ranges[2].1
    )]
    Zone {
        /// Its index.
        index: usize,
        /// From and to, for each coordinate, mm.
        ranges: [(f64, f64); 3],
    },
}

impl RegressionLimits {
    /// Refuses limits that nothing can keep.
    pub(crate) fn check(&self) -> Result<(), LimitsError> {
        if !(self.clearance >= 0.0 && self.clearance.is_finite()) {
            return Err(LimitsError::Clearance(self.clearance));
        }
        match self.zones.iter().position(|z| !z.is_usable()) {
            Some(index) => Err(LimitsError::Zone { index, ranges: self.zones[index].ranges }),
            None => Ok(()),
        }
    }

    /// The same with zones moved by a vector, mm.
    pub(crate) fn moved(&self, by: &Vec3) -> Self {
        let moved = |z: &Zone| Zone { ranges: [0, 1, 2].map(|k| (z.ranges[k].0 + by[k], z.ranges[k].1 + by[k])) };
        Self { clearance: self.clearance, zones: self.zones.iter().map(moved).collect() }
    }

    /// The same with zones that reach farther by a distance (mm) on all sides.
    pub(crate) fn widened(&self, by: f64) -> Self {
        let wider = |z: &Zone| Zone { ranges: z.ranges.map(|(a, b)| (a - by, b + by)) };
        Self { clearance: self.clearance, zones: self.zones.iter().map(wider).collect() }
    }

    /// Whether a point of the line `point + s direction` (`direction` of unit length) is out of bounds, for a strip that
    /// reaches from `own.0` to `own.1` on it.
    pub(crate) fn forbid(&self, point: &Vec3, direction: &Vec3, own: (f64, f64), s: f64) -> bool {
        let near = s >= own.0 - self.clearance && s <= own.1 + self.clearance;
        near || self.parts(point, direction).any(|(a, b)| s >= a && s <= b)
    }

    /// One interval of a line that holds all that is out of bounds; see [`RegressionLimits::forbid`].
    pub(crate) fn hull(&self, point: &Vec3, direction: &Vec3, own: (f64, f64)) -> (f64, f64) {
        let start = (own.0 - self.clearance, own.1 + self.clearance);
        self.parts(point, direction).fold(start, |(a, b), (p, q)| (a.min(p), b.max(q)))
    }

    fn parts<'a>(&'a self, point: &'a Vec3, direction: &'a Vec3) -> impl Iterator<Item = (f64, f64)> + 'a {
        self.zones.iter().filter_map(move |z| z.part(point, direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_by_slabs_and_boxes() {
        let slab = Zone::slab(0, 1.0, 3.0);
        let (p, d) = (Vec3::new(0.0, 5.0, 0.0), Vec3::new(-0.5, 0.0, 0.0));
        assert_eq!(slab.part(&p, &d), Some((-6.0, -2.0)));
        assert_eq!(slab.part(&p, &Vec3::y()), None);
        assert_eq!(slab.part(&Vec3::x(), &Vec3::y()), Some((f64::NEG_INFINITY, f64::INFINITY)));
        let mut cube = slab;
        cube.ranges[1] = (6.0, 7.0);
        assert_eq!(cube.part(&p, &d), None);
        assert!(slab.is_usable() && !Zone::ALL.is_usable() && !Zone::slab(1, 2.0, 1.0).is_usable());
        assert!(!Zone::slab(1, f64::NAN, 1.0).is_usable());
    }

    #[test]
    fn limits_forbid_the_strip_its_surroundings_and_the_zones() {
        let limits = RegressionLimits { clearance: 2.0, zones: vec![Zone::slab(0, 20.0, 30.0)] };
        let (p, d) = (Vec3::zeros(), Vec3::x());
        let forbidden: Vec<bool> =
            [-2.5, -1.0, 5.0, 11.0, 15.0, 25.0, 31.0].map(|s| limits.forbid(&p, &d, (0.0, 10.0), s)).into();
        assert_eq!(forbidden, [false, true, true, true, false, true, false]);
        assert_eq!(limits.hull(&p, &d, (0.0, 10.0)), (-2.0, 30.0));
        assert!(limits.widened(5.5).forbid(&p, &d, (0.0, 10.0), 15.0));
    }
}
