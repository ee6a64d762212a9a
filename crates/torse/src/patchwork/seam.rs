//! Seams: stretches of border that two panels share, with both of their sides; inside faces, and where faces meet at an angle.

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
    /// Number of the seam; joints of faces are numbered after the seams of all faces.
    pub seam: u32,
    /// Both sides.
    pub sides: [SeamSide<'a>; 2],
    /// Whether the second side runs backwards: always inside a face, and between faces that are oriented alike.
    pub turned: bool,
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
    /// Seams with two sides, in the order of their numbers, then joints along borders of faces.
    pub fn seams(&self) -> Vec<Seam<'_>> {
        let mut sides: Vec<[Option<SeamSide>; 2]> = vec![[None; 2]; self.seam_count + self.joint_count];
        for (panel, of) in self.panels.iter().enumerate() {
            for run in of.loops().iter().flatten() {
                let Some((seam, first)) = self.side_of(&run.border) else { continue };
                if let Some(slot) = sides.get_mut(seam) {
                    slot[usize::from(!first)] = Some(SeamSide { panel, of, run });
                }
            }
        }
        (0..).zip(sides).filter_map(|(seam, [a, b])| Seam::of(seam, [a?, b?])).collect()
    }

    /// Number of the seam that a border lies along, see [`Seam::seam`], and whether it is the first of both sides.
    pub fn side_of(&self, border: &Border) -> Option<(usize, bool)> {
        match *border {
            Border::Seam { seam, forward } => Some((seam as usize, forward)).filter(|s| s.0 < self.seam_count),
            Border::Joint { joint, first, .. } => Some((self.seam_count + joint as usize, first)),
            Border::Trim { .. } => None,
        }
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

impl<'a> Seam<'a> {
    /// `None` where the sides are not those of one seam.
    fn of(seam: u32, sides: [SeamSide<'a>; 2]) -> Option<Self> {
        let turned = sides[0].run.border.across(&sides[1].run.border)?;
        Some(Self { seam, sides, turned })
    }

    /// Whether both sides have the very same edge in space, bit by bit: they meet as far as their patches contain it.
    pub fn is_shared(&self) -> bool {
        let [a, b] = self.sides.map(|s| &s.run.edge);
        let same = |p: &[f64; 3], q: &[f64; 3]| p.iter().zip(q).all(|(x, y)| x.to_bits() == y.to_bits());
        if !self.turned {
            let control = a.control.iter().zip(&b.control).all(|(p, q)| same(p, q));
            return a.knots == b.knots && a.control.len() == b.control.len() && control;
        }
        // Mirrored knots are rounded, in the one direction or the other.
        let mirrored = a.knots.reversed() == b.knots || b.knots.reversed() == a.knots;
        let (a, b) = (&a.control, &b.control);
        mirrored && a.len() == b.len() && a.iter().zip(b.iter().rev()).all(|(p, q)| same(p, q))
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

    /// The parameter on one side of the place that has the parameter `s` on the other.
    pub fn opposite(&self, s: f64) -> f64 {
        if self.turned {
            1.0 - s
        } else {
            s
        }
    }

    /// Angle (rad) between the panels at the parameter `s` of the first side: 0 where they pass smoothly into each other.
    pub fn kink(&self, s: f64) -> f64 {
        let [a, b] = [self.sides[0].normal(s), self.sides[1].normal(self.opposite(s))];
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
