//! A part of an answer with the very maps that made its pattern: rulings in space beside rulings of the drawing
//! (docs/algorithms/shop.md, "Places").
//!
//! Patterns are drawn from whichever side was wanted, so the map of a panel is known up to the side that is seen and a
//! mirror image; the joint at which the outline begins and the direction of the rulings drawn tell which.

use crate::develop::map::Development;
use crate::develop::pattern::developed;
use crate::develop::strip;
use crate::develop::unfold::part::PlacedChart;
use crate::develop::unfold::region::Motion;
use crate::geom::polygon::crossings;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::clip::ClippedRulings;
use crate::patchwork::panel::{Panel, Patchwork};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::spline::surface::Surface;
use crate::torse::strip::Strip;

/// Stations over the rulings of a part, and over every span of knots, at least.
const STATIONS: (usize, usize) = (96, 6);
/// A panel's rulings are known a little beyond its borders, by this share of their range: trims touch the last ruling.
const BEYOND: f64 = 1e-3;
/// Share of the part's size below which places are one: what the patterns' own construction leaves.
const SAME: f64 = 1e-7;
/// Sine of the angle below which rulings are parallel.
const PARALLEL: f64 = 1e-5;
/// Steps by which the ruling through a point is found: each halves what is left or does better.
const STEPS: usize = 60;
/// Share of the way to the middle of a panel by which rulings are moved before they are cut off at the outline.
const INWARDS: f64 = 1e-6;
/// Share of its length by which a place may lie beyond the end of a ruling.
const OVER: f64 = 0.02;

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

/// How a panel is laid in the plane.
enum Image<'a> {
    /// By its own development, and a motion of the image within the part.
    Developed(Box<Development>, Motion),
    /// As the face that it is the panel of.
    Charted(&'a PlacedChart),
}

/// A panel and its map.
struct MappedPanel<'a> {
    patch: &'a Surface,
    image: Image<'a>,
    /// Rulings at which it begins and ends.
    range: (f64, f64),
    /// Parameters of rulings, rising, with the ends of their images; the first and the last lie a little beyond the panel.
    rows: Vec<(f64, [Vec2; 2])>,
}

/// A part with its maps.
pub struct Laid<'a> {
    panels: Vec<MappedPanel<'a>>,
    mirrored: bool,
    size: f64,
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
            let laid = Self { panels, mirrored, size };
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

    /// The same for a part that is one face, laid flat by its chart, or its neutral fibre. `None` where the face closes on itself, so
    /// that places in space do not tell on which turn they are.
    pub fn charted(patchwork: &'a Patchwork, part: &Part, pattern: &Pattern, chart: &'a PlacedChart) -> Option<Self> {
        let panel = patchwork.panels.get(part.first).filter(|p| part.count == 1 && p.trim.is_some())?;
        if chart.chart.closes() {
            return None;
        }
        let (patch, range) = (&panel.strip.patch, ClippedRulings::new(panel).range());
        let panel = MappedPanel::new(patch, Image::Charted(chart), patch.knots_u.domain(), range, STATIONS.0);
        let laid = Self { panels: vec![panel], mirrored: false, size: pattern.length.max(pattern.area.sqrt()) };
        pattern.rulings.iter().all(|[a, b]| laid.spot(&((a + b) * 0.5)).is_some()).then_some(laid)
    }

    /// A trimmed panel, and where its outline begins.
    fn trimmed(patchwork: &'a Patchwork, panel: &'a Panel) -> Option<(Vec<MappedPanel<'a>>, Vec<Vec2>)> {
        let start = panel.loops().first()?.iter().find(|r| !r.is_point())?.trim.control.first().copied()?;
        let (development, _) = developed(patchwork, panel).ok()?;
        let first = development.map(start[0], start[1]);
        let range = ClippedRulings::new(panel).range();
        let domain = development.domain();
        let image = Image::Developed(Box::new(development), Motion::identity());
        Some((vec![MappedPanel::new(&panel.strip.patch, image, domain, range, STATIONS.0)], vec![first]))
    }

    /// A chain of whole strips, with its first corner and those of its last ruling.
    fn chain(panels: &'a [Panel], index: usize, side: f64) -> Option<(Vec<MappedPanel<'a>>, Vec<Vec2>)> {
        let strips: Vec<&Strip> = panels.iter().map(|p| &p.strip).collect();
        let laid = strip::lay(&strips, index, side).ok()?;
        let (first, last) = (laid.first()?, laid.last()?);
        let end = last.strip.domain().1;
        let corners = vec![first.map(first.strip.domain().0, 0.0), last.map(end, 0.0), last.map(end, 1.0)];
        let each = STATIONS.0.div_ceil(laid.len());
        let panels = laid.into_iter().map(|l| {
            let (turn, shift) = l.motion();
            let domain = l.development.domain();
            let image = Image::Developed(Box::new(l.development), Motion { turn, shift });
            MappedPanel::new(&l.strip.patch, image, domain, l.strip.domain(), each)
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

    /// Whether there is no panel.
    pub fn is_empty(&self) -> bool {
        self.panels.is_empty()
    }

    /// Size of the part, mm.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The patch of a panel.
    pub fn patch(&self, panel: usize) -> &'a Surface {
        self.panels[panel].patch
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
        let patch = self.panels[panel].patch;
        [patch.point(t, 0.0), patch.point(t, 1.0)]
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
    pub fn v(&self, at: &Spot) -> f64 {
        let patch = self.panels[at.panel].patch;
        let [w0, w1] = [0.0, 1.0].map(|v| patch.homogeneous_jet(at.t, v, 0)[0][3]);
        at.s * w0 / (w1 * (1.0 - at.s) + at.s * w0)
    }

    /// The place of a point of the drawing; `None` where no ruling runs through it.
    pub fn spot(&self, q: &Vec2) -> Option<Spot> {
        let own = self.seen(q);
        let mut best: Option<(f64, Spot)> = None;
        for (k, panel) in self.panels.iter().enumerate() {
            for (t, s) in panel.through(&own, SAME * self.size) {
                let over = (-s).max(s - 1.0).max(0.0);
                if over <= OVER && best.is_none_or(|b| over < b.0) {
                    best = Some((over, Spot { panel: k, t, s }));
                }
            }
        }
        best.map(|b| b.1)
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

impl<'a> MappedPanel<'a> {
    fn new(patch: &'a Surface, image: Image<'a>, (a, b): (f64, f64), range: (f64, f64), stations: usize) -> Self {
        let mut out = Self { patch, image, range, rows: Vec::new() };
        let more = BEYOND * (range.1 - range.0);
        let (lo, hi) = ((range.0 - more).max(a), (range.1 + more).min(b));
        let mut ends = patch.knots_u.breaks();
        ends.retain(|t| *t > range.0 && *t < range.1);
        ends.extend([range.0, range.1]);
        ends.sort_by(f64::total_cmp);
        let parts = STATIONS.1.max(stations.div_ceil(ends.len()));
        let mut all: Vec<f64> = ends
            .windows(2)
            .flat_map(|w| (0..parts).map(move |k| w[0] + (w[1] - w[0]) * k as f64 / parts as f64))
            .collect();
        all.push(range.1);
        all.extend((hi > range.1).then_some(hi));
        if lo < range.0 {
            all.insert(0, lo);
        }
        out.rows = all.into_iter().map(|t| (t, out.ends(t))).collect();
        out
    }

    fn ends(&self, t: f64) -> [Vec2; 2] {
        [0.0, 1.0].map(|v| match &self.image {
            Image::Developed(development, motion) => motion.apply(&development.map(t, v)),
            Image::Charted(placed) => placed.motion.apply(&placed.chart.flat(&self.patch.point(t, v), None)),
        })
    }

    /// Rulings through a point of the plane, with the share along each.
    fn through(&self, q: &Vec2, same: f64) -> Vec<(f64, f64)> {
        // Distance from the line of a ruling, with its side.
        let off = |[a, b]: &[Vec2; 2]| {
            let d = b - a;
            d.perp(&(q - a)) / d.norm()
        };
        let share = |[a, b]: &[Vec2; 2]| (b - a).dot(&(q - a)) / (b - a).norm_squared();
        let mut out = Vec::new();
        for w in self.rows.windows(2) {
            let (mut x, mut y) = ((w[0].0, off(&w[0].1)), (w[1].0, off(&w[1].1)));
            if (x.1 > 0.0) == (y.1 > 0.0) {
                continue;
            }
            let mut t = x.0;
            for k in 0..STEPS {
                // Regula falsi, and now and then a halving.
                t = if k % 3 == 2 { 0.5 * (x.0 + y.0) } else { x.0 - x.1 * (y.0 - x.0) / (y.1 - x.1) };
                let here = off(&self.ends(t));
                if here == 0.0 || t <= x.0 || t >= y.0 {
                    break;
                }
                if (here > 0.0) == (x.1 > 0.0) {
                    x = (t, here);
                } else {
                    y = (t, here);
                }
                if y.0 - x.0 <= f64::EPSILON * (x.0.abs() + y.0.abs()) {
                    break;
                }
            }
            out.push((t, share(&self.ends(t))));
        }
        let ends = [self.rows.first(), self.rows.last()].into_iter().flatten();
        out.extend(ends.filter(|r| off(&r.1).abs() <= same).map(|r| (r.0, share(&r.1))));
        out
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
            assert!(laid.len() == 2 && !laid.is_empty());
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
