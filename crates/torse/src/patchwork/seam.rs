//! Seams: stretches of border that two panels share, with both of their sides.

use super::panel::{Border, Coedge, Panel, Patchwork};
use crate::geom::Vec3;

/// One side of a seam.
#[derive(Clone, Copy, Debug)]
pub struct SeamSide<'a> {
    /// Index of the panel.
    pub panel: usize,
    /// The panel.
    pub of: &'a Panel,
    /// Its run along the seam.
    pub run: &'a Coedge,
}

/// A seam: the side that runs along the seam's own direction, and the other one.
#[derive(Clone, Copy, Debug)]
pub struct Seam<'a> {
    /// Number of the seam.
    pub seam: u32,
    /// Both sides; the second runs backwards.
    pub sides: [SeamSide<'a>; 2],
}

/// Gauss nodes and weights on [0, 1], exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_02, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_331_9, 0.118_463_442_528_094_54),
];

impl Patchwork {
    /// Seams with two sides, in the order of their numbers.
    pub fn seams(&self) -> Vec<Seam<'_>> {
        let mut sides: Vec<[Option<SeamSide>; 2]> = vec![[None; 2]; self.seam_count];
        for (panel, of) in self.panels.iter().enumerate() {
            for run in of.loops().iter().flatten() {
                if let Border::Seam { seam, forward } = run.border {
                    if let Some(slot) = sides.get_mut(seam as usize) {
                        slot[usize::from(!forward)] = Some(SeamSide { panel, of, run });
                    }
                }
            }
        }
        (0..).zip(sides).filter_map(|(seam, [a, b])| Some(Seam { seam, sides: [a?, b?] })).collect()
    }
}

impl SeamSide<'_> {
    /// Unit normal of the patch at the parameter `s` of the run; zero where the patch degenerates.
    pub fn normal(&self, s: f64) -> Vec3 {
        let q = self.run.trim.point(s);
        let j = self.of.strip.patch.jet(q[0], q[1]);
        j.normal().try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    }
}

impl Seam<'_> {
    /// Whether both sides have the very same edge in space, bit by bit: they meet as far as their patches contain it.
    pub fn is_shared(&self) -> bool {
        let [a, b] = self.sides.map(|s| &s.run.edge);
        // Mirrored knots are rounded, in the one direction or the other.
        let mirrored = a.knots.reversed() == b.knots || b.knots.reversed() == a.knots;
        let (a, b) = (&a.control, &b.control);
        mirrored
            && a.len() == b.len()
            && a.iter().zip(b.iter().rev()).all(|(p, q)| p.iter().zip(q).all(|(x, y)| x.to_bits() == y.to_bits()))
    }

    /// Length of the edge of the first side, mm.
    pub fn length(&self) -> f64 {
        let edge = &self.sides[0].run.edge;
        edge.knots
            .breaks()
            .windows(2)
            .map(|w| {
                let h = w[1] - w[0];
                GAUSS.iter().map(|(x, g)| g * h * Vec3::from(edge.jet(w[0] + h * x)[1]).norm()).sum::<f64>()
            })
            .sum()
    }

    /// Angle (rad) between the panels at the parameter `s` of the first side: 0 where they pass smoothly into each other.
    pub fn kink(&self, s: f64) -> f64 {
        let [a, b] = [self.sides[0].normal(s), self.sides[1].normal(1.0 - s)];
        // Patches may be oriented either way.
        let angle = a.cross(&b).norm().atan2(a.dot(&b));
        angle.min(std::f64::consts::PI - angle)
    }

    /// Smallest and largest angle (rad) between the panels along the seam, sampled.
    pub fn kink_range_estimate(&self) -> (f64, f64) {
        const SAMPLES: u32 = 32;
        (0..=SAMPLES)
            .map(|i| self.kink(f64::from(i) / f64::from(SAMPLES)))
            .fold((f64::INFINITY, 0.0), |(a, b), x| (a.min(x), b.max(x)))
    }
}
