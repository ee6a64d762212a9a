//! A flat part as its drawing has it: outlines as polygons, bend lines with what the table says of them.

use super::RefoldError;
use crate::develop::unfold::allowance::Fibre;
use crate::geom::polygon::{area, bounds, sides};
use crate::geom::Vec2;
use crate::patchwork::pattern::{Bend, BendSense};

/// A bend line of a drawing with its row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendLine {
    /// Ends, mm.
    pub ends: [Vec2; 2],
    /// What the table says.
    pub bend: Bend,
}

/// A bend of sheet metal: a row of its table.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetRow {
    /// Indices of its lines among those of the part.
    pub lines: std::ops::Range<usize>,
    /// Whether it is rolled over many lines.
    pub rolled: bool,
    /// Which way.
    pub sense: BendSense,
    /// Whole turn, rad.
    pub angle: f64,
    /// Inside radius, mm; not a number where it is not one.
    pub inside_radius: f64,
    /// Breadth in the plane, mm; not a number where it varies.
    pub allowance: f64,
    /// Depth of the neutral fibre as a share of the thickness.
    pub k: f64,
}

/// One part of a cutting drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlatPart {
    /// Outlines as polygons, mm: the outer one first and counter-clockwise, holes clockwise.
    pub loops: Vec<Vec<Vec2>>,
    /// Joints of lines and arcs on the outlines, in the order of the file; the first begins the outer outline.
    pub joints: Vec<Vec<Vec2>>,
    /// Bend lines in the order of the table.
    pub lines: Vec<BendLine>,
    /// Bends of sheet metal; empty for parts without a thickness.
    pub bends: Vec<SheetRow>,
    /// Lines where bends begin and end, mm.
    pub extents: Vec<[Vec2; 2]>,
    /// By how much bend lines were shortened at both ends, mm.
    pub inset: f64,
    /// Where the neutral fibre, which is drawn, lies below the faces of a body of sheet or surfaces that were given one; `None` for surfaces
    /// that are drawn themselves and where nothing is said.
    pub fibre: Option<Fibre>,
    /// Thickness (mm) of a sheet whose neutral fibre was unfolded; 0 for others and where nothing is said.
    pub thickness: f64,
    /// The same at each of its panels, in no order: tabs and edges may be thinner than the sheet; empty where nothing is said.
    pub local: Vec<f64>,
    /// The last digit of lengths in the bend table, mm.
    pub printed: f64,
    /// Distance of the polygons from the lines and arcs of the file, mm.
    pub chords: f64,
}

/// Chords of arcs keep so near to them (share of the size of the part): far below what drawings are drawn to.
const CHORD: f64 = 2e-7;
/// Least turn of an arc that one chord may stand for, rad, so that no arc needs more memory than a file that draws it: of arcs that
/// turn by more than this in all, as the others are no longer than the part.
const LEAST_TURN: f64 = 5e-3;
/// See [`LEAST_TURN`].
const LONG_TURN: f64 = 1.0;

/// Where a program writes a drawing anew with three decimals, a place moves by up to 0.0007 mm; two that were one are no farther apart
/// than this, mm.
pub(crate) const ROUNDED: f64 = 2e-3;

/// Places of a drawing that are one to all its digits are no farther apart than this, mm.
const DIGITS: f64 = 1e-6;
/// Share of the size within which both sides of a slit are one line: far above what files print, far below any cut.
const SLIT: f64 = 1e-7;

/// Radius of an arc over a chord and the number of chords that stand for it; `None` for a line.
fn chords((bulge, chord): (f64, f64), size: f64) -> Option<(f64, usize)> {
    let sweep = 4.0 * bulge.atan();
    if sweep == 0.0 {
        return None;
    }
    let radius = chord / (2.0 * (0.5 * sweep).sin().abs());
    let least = if sweep.abs() > LONG_TURN { LEAST_TURN } else { 0.0 };
    let step = (8.0 * CHORD * size / radius.max(f64::MIN_POSITIVE)).sqrt().clamp(least, 0.5);
    Some((radius, (sweep.abs() / step).ceil().max(1.0) as usize))
}

/// Greatest height (mm) of an arc of an outline over the chords of [`polygon`].
pub(crate) fn chord_height(joints: &[(Vec2, f64)], size: f64) -> f64 {
    let height = |k: usize| {
        let ((a, bulge), b) = (joints[k], joints[(k + 1) % joints.len()].0);
        let Some((radius, n)) = chords((bulge, (b - a).norm()), size) else { return 0.0 };
        // r (1 − cos x) without cancellation.
        2.0 * radius * (bulge.atan() / n as f64).sin().powi(2)
    };
    (0..joints.len()).map(height).fold(0.0, f64::max)
}

/// A closed outline of lines and arcs (place and bulge of every piece) as a polygon.
pub(crate) fn polygon(joints: &[(Vec2, f64)], size: f64) -> Vec<Vec2> {
    let mut out = Vec::new();
    for (k, (a, bulge)) in joints.iter().enumerate() {
        let b = joints[(k + 1) % joints.len()].0;
        out.push(*a);
        let (sweep, chord) = (4.0 * bulge.atan(), b - a);
        let Some((_, n)) = chords((*bulge, chord.norm()), size) else { continue };
        let left = Vec2::new(-chord.y, chord.x);
        let centre = (a + b) * 0.5 + left * (0.25 * (1.0 / bulge - bulge));
        let v = a - centre;
        for i in 1..n {
            let (s, c) = (sweep * i as f64 / n as f64).sin_cos();
            out.push(centre + Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y));
        }
    }
    out
}

impl FlatPart {
    /// The joint of the outlines that a place is meant to be: at most `near` (mm) off if the drawing is rounded, else the same to all digits.
    /// Sides may be a hair long, as before the tip of a fan, which rulings from their ends would miss.
    pub(crate) fn joint_meant(&self, q: &Vec2, near: f64) -> Option<Vec2> {
        let off = |c: &Vec2| (c - q).norm();
        let joint = self.joints.iter().flatten().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let near = if self.is_rounded() { near } else { DIGITS };
        (off(joint) <= near).then_some(*joint)
    }

    /// Whether all joints are written with few decimals: at most one more than its tables.
    fn is_rounded(&self) -> bool {
        let digit = 0.1 * self.printed;
        let is_short = |x: &f64| digit == 0.0 || (x - (x / digit).round() * digit).abs() <= DIGITS;
        self.joints.iter().flatten().flat_map(|c| c.iter()).all(is_short)
    }

    /// Diagonal of the box around the part, mm.
    pub fn size(&self) -> f64 {
        let (lo, hi) = bounds(&self.loops);
        let d = (hi - lo).norm();
        if d.is_finite() {
            d
        } else {
            0.0
        }
    }

    /// Refuses outlines that cross or touch themselves or each other, and parts without area.
    ///
    /// # Errors
    /// [`RefoldError::Outline`], [`RefoldError::Empty`].
    pub(crate) fn check(&self) -> Result<(), RefoldError> {
        let total: f64 = self.loops.iter().map(|l| area(l)).sum();
        if self.loops.iter().any(|l| l.len() < 3) || !(total > 0.0 && total.is_finite()) {
            return Err(RefoldError::Empty);
        }
        // Sides sorted by their left ends: only those that overlap in x are compared.
        let mut all: Vec<(usize, usize, Vec2, Vec2)> = Vec::new();
        for (c, l) in self.loops.iter().enumerate() {
            all.extend((0..l.len()).map(|k| (c, k, l[k], l[(k + 1) % l.len()])));
        }
        all.sort_by(|a, b| a.2.x.min(a.3.x).total_cmp(&b.2.x.min(b.3.x)));
        for (i, (c, k, p, q)) in all.iter().enumerate() {
            let right = p.x.max(q.x);
            for (d, m, r, s) in all[i + 1..].iter().take_while(|o| o.2.x.min(o.3.x) <= right) {
                let n = self.loops[*c].len();
                let beside = c == d && (k == m || (k + 1) % n == *m || (m + 1) % n == *k);
                if !beside && segments_meet([p, q], [r, s]) {
                    return Err(RefoldError::Outline { contour: c.max(d) + 1, x: p.x, y: p.y });
                }
            }
        }
        Ok(())
    }

    /// As [`Self::check`], but outlines may touch themselves, as both sides of a slit without breadth do: what counts is that they
    /// go around every place once or not at all.
    ///
    /// # Errors
    /// See [`Self::check`].
    pub(crate) fn check_slits(&self) -> Result<(), RefoldError> {
        match self.check() {
            Err(RefoldError::Outline { .. }) if self.winds_once() => Ok(()),
            other => other,
        }
    }

    /// Whether the outlines go around places to their left once and around those to their right not at all, or once where
    /// another side runs back along them.
    fn winds_once(&self) -> bool {
        let near = ROUNDED.max(SLIT * self.size());
        let all: Vec<(Vec2, Vec2)> = sides(&self.loops).filter(|(p, q)| (q - p).norm() > near).collect();
        let side = |(p, q): &(Vec2, Vec2)| {
            let (way, length) = ((q - p).normalize(), (q - p).norm());
            // Where other sides begin, end or run across.
            let mut cuts = vec![0.0, length];
            for (r, s) in &all {
                let (a, b) = (way.perp(&(r - p)), way.perp(&(s - p)));
                let along = [r, s].map(|x| way.dot(&(x - p)));
                cuts.extend([(a, along[0]), (b, along[1])].iter().filter(|c| c.0.abs() <= near).map(|c| c.1));
                if a * b < 0.0 {
                    cuts.push(along[0] + (along[1] - along[0]) * a / (a - b));
                }
            }
            cuts.retain(|c| (0.0..=length).contains(c));
            cuts.sort_by(f64::total_cmp);
            let left = Vec2::new(-way.y, way.x) * near;
            // Pieces as short as places are apart from their side tell of what is beside them.
            cuts.windows(2).filter(|c| c[1] - c[0] > 4.0 * near).all(|c| {
                let middle = p + way * (0.5 * (c[0] + c[1]));
                windings(&self.loops, &(middle + left)) == 1
                    && (0..=1).contains(&windings(&self.loops, &(middle - left)))
            })
        };
        all.iter().all(side)
    }
}

/// How often polygons go around a point, counter-clockwise.
fn windings(loops: &[Vec<Vec2>], x: &Vec2) -> i32 {
    let turn = |(p, q): (Vec2, Vec2)| match (p.y > x.y, q.y > x.y) {
        (false, true) if (q - p).perp(&(x - p)) > 0.0 => 1,
        (true, false) if (q - p).perp(&(x - p)) < 0.0 => -1,
        _ => 0,
    };
    sides(loops).map(turn).sum()
}

/// Whether two segments have a point in common.
fn segments_meet(a: [&Vec2; 2], b: [&Vec2; 2]) -> bool {
    let side = |o: [&Vec2; 2], x: &Vec2| (o[1] - o[0]).perp(&(x - o[0]));
    let (p, q) = (side(a, b[0]) * side(a, b[1]), side(b, a[0]) * side(b, a[1]));
    let apart =
        (0..2).any(|k| a[0][k].max(a[1][k]) < b[0][k].min(b[1][k]) || b[0][k].max(b[1][k]) < a[0][k].min(a[1][k]));
    p <= 0.0 && q <= 0.0 && !apart
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(a: f64) -> Vec<Vec2> {
        vec![Vec2::zeros(), Vec2::new(a, 0.0), Vec2::new(a, a), Vec2::new(0.0, a)]
    }

    #[test]
    fn outlines_that_cross_or_touch_are_named() {
        let good = FlatPart { loops: vec![square(10.0)], ..FlatPart::default() };
        assert!(good.check().is_ok());
        let mut bow = good.clone();
        bow.loops[0] = [(0.0, 0.0), (10.0, 0.0), (1.0, 9.0), (8.0, 9.0)].map(|(x, y)| Vec2::new(x, y)).to_vec();
        assert!(matches!(bow.check(), Err(RefoldError::Outline { contour: 1, .. })));
        let mut touching = good.clone();
        touching.loops.push([(3.0, 0.0), (3.0, 4.0), (6.0, 4.0)].map(|(x, y)| Vec2::new(x, y)).to_vec());
        assert!(matches!(touching.check(), Err(RefoldError::Outline { contour: 2, .. })));
        assert_eq!(FlatPart::default().check(), Err(RefoldError::Empty));
    }

    /// Two squares that a corner without breadth joins to a plate, whose sides run along each other.
    #[test]
    fn slits_without_breadth_are_no_crossings() {
        let part = |corners: &[(f64, f64)]| {
            let outline = corners.iter().map(|(x, y)| Vec2::new(*x, *y)).collect();
            FlatPart { loops: vec![outline], ..FlatPart::default() }
        };
        // A slit from (6, 0) to (6, 4), whose sides differ by what files print.
        let slit =
            part(&[(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (6.000000001, 0.0), (10.0, 0.0), (10.0, 8.0), (0.0, 8.0)]);
        assert!(slit.check_slits().is_ok());
        let notched =
            part(&[(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (6.0, 2.0), (6.0, -3.0), (10.0, -3.0), (10.0, 8.0), (0.0, 8.0)]);
        assert!(notched.check().is_err() && notched.check_slits().is_ok());
        // The flap lies on the plate.
        let lapped =
            part(&[(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (5.0, 2.0), (5.0, -3.0), (10.0, -3.0), (10.0, 8.0), (0.0, 8.0)]);
        assert!(lapped.check_slits().is_err());
        let bow = part(&[(0.0, 0.0), (10.0, 0.0), (1.0, 9.0), (8.0, 9.0)]);
        assert!(bow.check_slits().is_err());
        let mut holed = slit;
        holed.loops.push([(2.0, 4.0), (2.0, 6.0), (6.0, 6.0), (6.0, 4.0)].map(|(x, y)| Vec2::new(x, y)).to_vec());
        assert!(holed.check_slits().is_ok(), "a hole may end a slit");
        holed.loops[1].reverse();
        assert!(holed.check_slits().is_err());
    }

    #[test]
    fn arcs_are_followed() {
        // A disc of two half circles.
        let disc = polygon(&[(Vec2::new(-5.0, 0.0), 1.0), (Vec2::new(5.0, 0.0), 1.0)], 10.0);
        assert!(disc.iter().all(|p| (p.norm() - 5.0).abs() < 1e-12));
        let height = chord_height(&[(Vec2::new(-5.0, 0.0), 1.0), (Vec2::new(5.0, 0.0), 1.0)], 10.0);
        let middle = |k: usize| (disc[k] + disc[(k + 1) % disc.len()]).norm() * 0.5;
        assert!((0..disc.len()).all(|k| (5.0 - middle(k) - height).abs() < 1e-9));
        assert!((area(&disc) - 25.0 * std::f64::consts::PI).abs() < 1e-3);
    }
}
