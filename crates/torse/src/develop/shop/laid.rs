//! A part of an answer with the very maps that made its pattern: rulings in space beside rulings of the drawing
//! (docs/algorithms/shop.md, "Places").
//!
//! Patterns are drawn from whichever side was wanted, so the map of a panel is known up to the side that is seen and a
//! mirror image; the joint at which the outline begins and the direction of the rulings drawn tell which.

mod panel;

use crate::develop::bends;
use crate::develop::pattern::developed;
use crate::develop::strip;
use crate::develop::unfold::bends::{BendKind, SheetBend};
use crate::develop::unfold::part::SheetPart;
use crate::develop::unfold::placed_face::PlacedFace;
use crate::develop::unfold::region::Motion;
use crate::geom::polygon::crossings;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::clip::ClippedRulings;
use crate::patchwork::panel::{Panel, Patchwork};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::spline::surface::Surface;
use crate::torse::strip::Strip;
use panel::{Image, MappedPanel};

/// Stations over the rulings of a part at least.
const STATIONS: usize = 96;
/// Share of the part's size below which places are one: what the patterns' own construction leaves.
const SAME: f64 = 1e-7;
/// Sine of the angle below which rulings are parallel.
const PARALLEL: f64 = 1e-5;
/// Share of the way to the middle of a panel by which rulings are moved before they are cut off at the outline.
const INWARDS: f64 = 1e-6;
/// Share of its length by which a place may lie beyond the end of a ruling.
const OVER: f64 = 0.02;

/// Ends of a section on both sides of a sharp bend may be farther apart than these by rounding.
const WIDER: f64 = 1.001;

/// A place on a part: on a ruling of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Index of the panel within the part.
    pub panel: usize,
    /// Parameter of the ruling.
    pub t: f64,
    /// Share of the way along the ruling of the patch, in space and in the plane alike.
    pub s: f64,
}

/// A part with its maps.
pub struct Laid<'a> {
    panels: Vec<MappedPanel<'a>>,
    mirrored: bool,
    size: f64,
    /// Of parts of faces, of every line drawn the rolled face that it is drawn for.
    lines: Option<Vec<Option<usize>>>,
    /// Widest gap or overlap of its faces, mm.
    fold: f64,
}

impl<'a> Laid<'a> {
    /// The maps of a part, as its pattern is drawn. `None` where panels cannot be developed again or the pattern is none of
    /// theirs, as in jobs that draw from other surfaces than their panels.
    pub fn of(patchwork: &'a Patchwork, part: &Part, pattern: &Pattern) -> Option<Self> {
        let panels = patchwork.panels.get(part.first..part.first + part.count)?;
        let size = pattern.length.max(pattern.area.sqrt());
        let joints = pattern.contours.first().map_or(&[][..], |c| &c.vertices);
        let is = |p: &Vec2, q: &Vec2| (p - q).norm() <= SAME * size;
        let trimmed = panels.len() == 1 && panels[0].trim.is_some();
        let sides = if trimmed { &[1.0][..] } else { &[1.0, -1.0][..] };
        let mut fallback = None;
        for (side, mirrored) in sides.iter().flat_map(|s| [(*s, false), (*s, true)]) {
            let (panels, corners) =
                if trimmed { Self::trimmed(patchwork, &panels[0])? } else { Self::chain(panels, part.first, side)? };
            let laid = Self { panels, mirrored, size, lines: None, fold: 0.0 };
            if !laid.fits(&pattern.rulings) {
                continue;
            }
            // The outline begins with the first corner; the others are joints of it.
            let corners: Vec<Vec2> = corners.iter().map(|c| laid.seen(c)).collect();
            let begins = joints.first().zip(corners.first()).is_some_and(|(v, c)| is(&v.point, c));
            if begins && corners.iter().all(|c| joints.iter().any(|v| is(&v.point, c))) {
                return Some(laid);
            }
            fallback = fallback.or(Some(laid));
        }
        // Outlines that were cut back have other joints, but rulings all the same.
        fallback.filter(|_| pattern.rulings.len() > 1)
    }

    /// The same for a part of faces that are laid flat by their own maps, or of their neutral fibre: the surface in space is that of
    /// the faces, of a body of sheet the skin that is drawn. `None` where a line drawn for a rolled face is none of its rulings.
    pub(crate) fn of_faces(faces: &'a [PlacedFace], sheet: &SheetPart, pattern: &Pattern) -> Option<Self> {
        let rolled = |b: &SheetBend| std::iter::repeat_n(b.face, b.lines.len());
        let lines: Vec<Option<usize>> = sheet.bends.iter().flat_map(rolled).collect();
        let panels = faces.iter().map(|f| MappedPanel::of_face(f, STATIONS)).collect();
        let gaps = sheet.bends.iter().filter(|b| b.kind == BendKind::Fold).map(|b| b.allowance.abs());
        let fold = WIDER * gaps.fold(0.0, f64::max);
        let size = pattern.length.max(pattern.area.sqrt());
        let laid = Self { panels, mirrored: false, size, lines: Some(lines), fold };
        let is_ruling = |(k, l): (usize, &[Vec2; 2])| laid.rolled(k).is_none() || laid.spot_of(k, l).is_some();
        let told = laid.lines.as_ref().is_some_and(|l| l.len() == pattern.rulings.len());
        (!faces.is_empty() && told && pattern.rulings.iter().enumerate().all(is_ruling)).then_some(laid)
    }

    /// A trimmed panel, and where its outline begins.
    fn trimmed(patchwork: &'a Patchwork, panel: &'a Panel) -> Option<(Vec<MappedPanel<'a>>, Vec<Vec2>)> {
        let start = panel.loops().first()?.iter().find(|r| !r.is_point())?.trim.control.first().copied()?;
        let (development, _) = developed(patchwork, panel).ok()?;
        let first = development.map(start[0], start[1]);
        let range = ClippedRulings::new(panel).range();
        let domain = development.domain();
        let image = Image::Developed(&panel.strip.patch, Box::new(development), Motion::identity());
        Some((vec![MappedPanel::new(image, domain, range, STATIONS)], vec![first]))
    }

    /// A chain of whole strips, with its first corner and those of its last ruling.
    fn chain(panels: &'a [Panel], index: usize, side: f64) -> Option<(Vec<MappedPanel<'a>>, Vec<Vec2>)> {
        let strips: Vec<&Strip> = panels.iter().map(|p| &p.strip).collect();
        let laid = strip::lay(&strips, index, side).ok()?;
        let (first, last) = (laid.first()?, laid.last()?);
        let end = last.strip.domain().1;
        let corners = vec![first.map(first.strip.domain().0, 0.0), last.map(end, 0.0), last.map(end, 1.0)];
        let each = STATIONS.div_ceil(laid.len());
        let panels = laid.into_iter().map(|l| {
            let (turn, shift) = l.motion();
            let domain = l.development.domain();
            let image = Image::Developed(&l.strip.patch, Box::new(l.development), Motion { turn, shift });
            MappedPanel::new(image, domain, l.strip.domain(), each)
        });
        Some((panels.collect(), corners))
    }

    /// Whether lines drawn are rulings, and run as these do.
    fn fits(&self, lines: &[[Vec2; 2]]) -> bool {
        lines.iter().all(|[a, b]| {
            let Some(spot) = self.spot(&((a + b) * 0.5)) else { return false };
            let [c, d] = self.ruling(spot.panel, spot.t);
            let (v, w) = (b - a, d - c);
            v.dot(&w) > 0.0 && v.perp(&w).abs() <= PARALLEL * v.norm() * w.norm()
        })
    }

    /// An image as it is seen.
    fn seen(&self, p: &Vec2) -> Vec2 {
        if self.mirrored {
            Vec2::new(-p.x, p.y)
        } else {
            *p
        }
    }

    /// Number of panels.
    pub fn len(&self) -> usize {
        self.panels.len()
    }

    /// Size of the part, mm.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The patch of a panel; `None` of faces that have maps of their own.
    pub fn patch(&self, panel: usize) -> Option<&'a Surface> {
        self.panels[panel].patch()
    }

    /// The face that a panel is; `None` where panels are laid flat by their patches.
    pub(crate) fn face(&self, panel: usize) -> Option<&'a PlacedFace> {
        self.panels[panel].face()
    }

    /// Whether the part is made of faces that have maps of their own.
    pub fn is_of_faces(&self) -> bool {
        self.lines.is_some()
    }

    /// The rolled face that a line of the pattern is drawn for, in a part of faces.
    pub fn rolled(&self, line: usize) -> Option<usize> {
        self.lines.as_ref()?.get(line).copied().flatten()
    }

    /// The rolled faces of a part of faces.
    pub fn all_rolled(&self) -> Vec<usize> {
        let mut out: Vec<usize> = self.lines.iter().flatten().flatten().copied().collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// Widest gap or overlap (mm) of faces along sharp bends in the drawing.
    pub fn widest_fold(&self) -> f64 {
        self.fold
    }

    /// The place of the middle of a line drawn for a ruling; of a part of faces only if it is a rolled one's.
    pub fn spot_of(&self, line: usize, [a, b]: &[Vec2; 2]) -> Option<Spot> {
        let middle = (a + b) * 0.5;
        match self.lines {
            Some(_) => self.spot_on(self.rolled(line)?, &middle),
            None => self.spot(&middle),
        }
    }

    /// Parameters of the rulings of a panel between which its maps are smooth and steps small, rising.
    pub fn stations(&self, panel: usize) -> impl Iterator<Item = f64> + '_ {
        self.panels[panel].rows.iter().map(|r| r.0)
    }

    /// The rulings at which a panel begins and ends.
    pub fn range(&self, panel: usize) -> (f64, f64) {
        self.panels[panel].range
    }

    /// The image of a ruling, from v = 0 to v = 1.
    pub fn ruling(&self, panel: usize, t: f64) -> [Vec2; 2] {
        self.panels[panel].ends(t).map(|p| self.seen(&p))
    }

    /// A ruling in space, from v = 0 to v = 1.
    pub fn ruling_in_space(&self, panel: usize, t: f64) -> [Vec3; 2] {
        self.panels[panel].in_space(t)
    }

    /// Place in the drawing.
    pub fn flat(&self, at: &Spot) -> Vec2 {
        let [a, b] = self.ruling(at.panel, at.t);
        a + (b - a) * at.s
    }

    /// Place in space.
    pub fn space(&self, at: &Spot) -> Vec3 {
        let [a, b] = self.ruling_in_space(at.panel, at.t);
        a + (b - a) * at.s
    }

    /// Parameter v of the patch at a place: another number than the share where weights differ.
    pub fn v(&self, at: &Spot) -> Option<f64> {
        let patch = self.patch(at.panel)?;
        let [w0, w1] = [0.0, 1.0].map(|v| patch.homogeneous_jet(at.t, v, 0)[0][3]);
        Some(at.s * w0 / (w1 * (1.0 - at.s) + at.s * w0))
    }

    /// Radius of curvature (mm) at a place; of the skin of a body that of the inside of its sheet.
    pub fn radius(&self, at: &Spot) -> f64 {
        match &self.panels[at.panel].image {
            Image::Developed(patch, ..) => bends::radius(patch, at.t, self.v(at).unwrap_or(at.s)),
            Image::Face(f) => f.placed.chart.bend_at(at.t, f.region.reach).map_or(f64::NAN, |b| {
                let [p, q] = b.radii;
                // Equal radii may be infinite.
                let own = if p == q { p } else { p + (q - p) * at.s };
                if b.hollow {
                    own
                } else {
                    (own - f.region.thickness).max(0.0)
                }
            }),
        }
    }

    /// Unit normal in the middle of a ruling, and +1 where the sheet is hollow on its side, else −1.
    pub fn normal(&self, panel: usize, t: f64) -> Option<(Vec3, f64)> {
        match &self.panels[panel].image {
            Image::Developed(patch, ..) => {
                let j = patch.jet(t, 0.5);
                Some((j.normal().try_normalize(0.0)?, j.normal().dot(&j.duu).signum()))
            }
            Image::Face(f) => {
                let b = f.placed.chart.bend_at(t, f.region.reach)?;
                Some((b.normal, if b.hollow { 1.0 } else { -1.0 }))
            }
        }
    }

    /// Depth (mm) below a face of the surface that is laid flat, and the unit normal from which it counts; 0 for panels.
    pub fn depth(&self, panel: usize, t: f64) -> Option<(f64, Vec3)> {
        match &self.panels[panel].image {
            Image::Developed(..) => Some((0.0, Vec3::zeros())),
            Image::Face(f) => f.placed.chart.bend_at(t, f.region.reach).map(|b| (b.depth, b.normal)),
        }
    }

    /// The place of a point of the drawing; `None` where no ruling runs through it.
    pub fn spot(&self, q: &Vec2) -> Option<Spot> {
        let all = (0..self.panels.len()).filter_map(|k| self.near(k, q));
        all.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|b| b.1)
    }

    /// The same on one panel.
    pub fn spot_on(&self, panel: usize, q: &Vec2) -> Option<Spot> {
        self.near(panel, q).map(|b| b.1)
    }

    /// The ruling of a panel on which a point lies best, and by which share of it the point lies beyond its end.
    fn near(&self, panel: usize, q: &Vec2) -> Option<(f64, Spot)> {
        let all = self.panels[panel].through(&self.seen(q), SAME * self.size).into_iter();
        let over = |s: f64| (-s).max(s - 1.0).max(0.0);
        let near = all.map(|(t, s)| (over(s), Spot { panel, t, s })).filter(|b| b.0 <= OVER);
        near.reduce(|a, b| if b.0 < a.0 { b } else { a })
    }

    /// The stretches of a ruling that lie inside polygons of the drawing, as shares.
    pub fn inside(&self, panel: usize, t: f64, loops: &[Vec<Vec2>]) -> Vec<[f64; 2]> {
        // The first and the last ruling lie on the outline, where inside and outside cannot be told.
        let (first, last) = self.range(panel);
        let [a, b] = self.ruling(panel, t + INWARDS * (0.5 * (first + last) - t));
        let length = (b - a).norm();
        let Some(way) = (b - a).try_normalize(0.0) else { return Vec::new() };
        let cuts = crossings(loops, &a, &way);
        cuts.chunks_exact(2)
            .map(|c| [c[0] / length, c[1] / length].map(|s| s.clamp(0.0, 1.0)))
            .filter(|c| c[1] > c[0])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::shop::specimens::{cone, cylinder, part_of, pattern_of};

    #[test]
    fn places_of_the_drawing_are_found_again_from_either_side() {
        for (side, turned) in [(1.0, false), (-1.0, false), (1.0, true), (-1.0, true)] {
            let (patchwork, pattern) = pattern_of(vec![cone("a", 0.0, 1.0), cone("b", 1.0, 1.7)], side);
            let pattern = if turned { pattern.turned_over() } else { pattern };
            let laid = Laid::of(&patchwork, &part_of(2), &pattern).expect("maps");
            assert_eq!(laid.len(), 2);
            for (panel, t, s) in [(0, 0.3, 0.2), (1, 0.0, 0.5), (1, 0.77, 0.9)] {
                let spot = Spot { panel, t, s };
                let found = laid.spot(&laid.flat(&spot)).expect("a place");
                assert!((laid.space(&found) - laid.space(&spot)).norm() < 1e-9 * laid.size(), "{spot:?} {found:?}");
            }
            // Lengths are kept across the rulings too.
            let [p, q] = [0.3, 0.3001].map(|t| Spot { panel: 0, t, s: 0.4 });
            let (flat, space) = ((laid.flat(&p) - laid.flat(&q)).norm(), (laid.space(&p) - laid.space(&q)).norm());
            assert!((flat / space - 1.0).abs() < 1e-6);
            assert!(laid.spot(&Vec2::new(1e4, 1e4)).is_none());
        }
    }

    #[test]
    fn a_pattern_of_other_panels_is_refused() {
        let (_, pattern) = pattern_of(vec![cone("a", 0.0, 1.0)], 1.0);
        let (other, _) = pattern_of(vec![cylinder("b", 0.0, 1.0)], 1.0);
        assert!(Laid::of(&other, &part_of(1), &pattern).is_none());
    }
}
