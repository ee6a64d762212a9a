//! Parts that are equal in the plane, as they lie or turned over: one drawing serves for all of them.
//!
//! *Method*: outlines with as many joints are laid on each other by a rigid motion for every shift of the joints; holes and
//! bend lines must then fall together too, and so must curves that are marked. Round outlines whose joints lie elsewhere are not found.

use crate::geom::Vec2;
use crate::patchwork::pattern::{BendSense, Contour, MarkLine, Pattern};

/// An earlier part that a part equals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SamePart {
    /// Index of the earlier pattern.
    pub pattern: usize,
    /// Whether one of them must be turned over.
    pub mirrored: bool,
}

/// Places may differ by this share of the part's length: what files print, with a margin.
const SAME: f64 = 1e-5;
/// Turns of bends may differ by this, rad.
const SAME_TURN: f64 = 1e-5;

/// For every pattern the first one before it that it equals; `thicknesses` (mm) may be empty.
pub(crate) fn same_parts(patterns: &[Pattern], thicknesses: &[f64]) -> Vec<Option<SamePart>> {
    let one = |q: &Pattern, p: &Pattern| match equal(q, p) {
        true => Some(false),
        false => equal(&q.turned_over(), p).then_some(true),
    };
    let found = alike(patterns, thicknesses, &|_| true, &one);
    found.into_iter().map(|f| f.map(|(pattern, mirrored)| SamePart { pattern, mirrored })).collect()
}

/// For every pattern that equals no earlier one the first before it whose part is its mirror image: the other outline, bent the
/// same way. Parts that stay flat are turned over for that.
pub(crate) fn opposite_hands(
    patterns: &[Pattern],
    thicknesses: &[f64],
    same: &[Option<SamePart>],
) -> Vec<Option<usize>> {
    let is_bent = |k: usize| patterns[k].bends.iter().any(|b| b.sense != BendSense::Flat);
    let one = |q: &Pattern, p: &Pattern| equal(&q.mirror_image(), p).then_some(());
    let found = alike(patterns, thicknesses, &|k| same[k].is_none() && is_bent(k), &one);
    found.into_iter().map(|f| f.map(|(pattern, ())| pattern)).collect()
}

/// For every pattern that is asked for the first one before it, itself alike no other, that is alike, and how.
fn alike<T>(
    patterns: &[Pattern],
    thicknesses: &[f64],
    asked: &dyn Fn(usize) -> bool,
    one: &dyn Fn(&Pattern, &Pattern) -> Option<T>,
) -> Vec<Option<(usize, T)>> {
    let mut out: Vec<Option<(usize, T)>> = patterns.iter().map(|_| None).collect();
    let mut order: Vec<usize> =
        (0..patterns.len()).filter(|k| !patterns[*k].contours.is_empty() && asked(*k)).collect();
    order.sort_by(|a, b| patterns[*a].area.total_cmp(&patterns[*b].area).then(a.cmp(b)));
    let thickness = |k: usize| thicknesses.get(k).copied().unwrap_or(0.0);
    for (at, &k) in order.iter().enumerate() {
        let p = &patterns[k];
        let near = |j: usize| p.area - patterns[j].area <= 2.0 * SAME * p.area;
        // Of parts of one area, those before in the list.
        let alike = order[..at]
            .iter()
            .rev()
            .take_while(|j| near(**j))
            .chain(order[at + 1..].iter().take_while(|j| patterns[**j].area - p.area <= 2.0 * SAME * p.area));
        let mut alike: Vec<usize> = alike.copied().filter(|j| *j < k && out[*j].is_none()).collect();
        alike.sort_unstable();
        let as_thick = |j: &usize| (thickness(*j) - thickness(k)).abs() <= SAME * thickness(k);
        out[k] = alike.into_iter().filter(as_thick).find_map(|j| Some((j, one(&patterns[j], p)?)));
    }
    out
}

/// A rigid motion of the plane without reflection.
#[derive(Clone, Copy)]
struct Motion {
    cos: f64,
    sin: f64,
    shift: Vec2,
}

impl Motion {
    /// Takes the first pair of places to the second.
    fn between([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> Option<Self> {
        let (u, v) = (b - a, d - c);
        let scale = (u.norm_squared() * v.norm_squared()).sqrt();
        let (cos, sin) = (u.dot(&v) / scale, u.perp(&v) / scale);
        let out = Self { cos, sin, shift: Vec2::zeros() };
        let shift = (c + d) * 0.5 - out.apply(&((a + b) * 0.5));
        (cos.is_finite() && sin.is_finite()).then_some(Self { shift, ..out })
    }

    fn apply(&self, p: &Vec2) -> Vec2 {
        Vec2::new(self.cos * p.x - self.sin * p.y, self.sin * p.x + self.cos * p.y) + self.shift
    }
}

/// Whether a motion lays one pattern on the other.
fn equal(p: &Pattern, q: &Pattern) -> bool {
    let slack = SAME * q.length.max(p.length);
    let counts =
        |p: &Pattern| [p.contours.len(), p.formed.len(), p.rulings.len(), p.contours[0].vertices.len(), p.curves.len()];
    if p.contours.is_empty() || q.contours.is_empty() || counts(p) != counts(q) {
        return false;
    }
    if (p.length - q.length).abs() > slack || (p.width - q.width).abs() > slack {
        return false;
    }
    let (v, w) = (&p.contours[0].vertices, &q.contours[0].vertices);
    let n = v.len();
    // The joint farthest from the first one gives the best hold.
    let far = |k: &usize| (v[*k].point - v[0].point).norm_squared();
    let Some(hold) = (0..n).max_by(|a, b| far(a).total_cmp(&far(b))) else { return false };
    (0..n).any(|shift| {
        let (c, d) = (w[shift].point, w[(shift + hold) % n].point);
        if ((d - c).norm() - far(&hold).sqrt()).abs() > slack {
            return false;
        }
        let Some(motion) = Motion::between([v[0].point, v[hold].point], [c, d]) else { return false };
        falls_together(p, q, &motion, slack)
    })
}

fn falls_together(p: &Pattern, q: &Pattern, motion: &Motion, slack: f64) -> bool {
    let each = |own: &[Contour], other: &[Contour]| own.iter().all(|c| other.iter().any(|d| on(c, d, motion, slack)));
    let marked = p.curves.iter().all(|l| q.curves.iter().any(|m| is_line(l, m, motion, slack)));
    marked && each(&p.contours, &q.contours) && each(&p.formed, &q.formed) && {
        let line = |k: usize| (p.rulings[k].map(|x| motion.apply(&x)), p.bend(k));
        (0..p.rulings.len()).map(line).all(|([a, b], bend)| {
            (0..q.rulings.len()).any(|j| {
                let ([c, d], other) = (q.rulings[j], q.bend(j));
                let near = |x: &Vec2, y: &Vec2| (x - y).norm() <= slack;
                let there = (near(&a, &c) && near(&b, &d)) || (near(&a, &d) && near(&b, &c));
                let flat = bend.sense == BendSense::Flat && other.sense == BendSense::Flat;
                there && (flat || (bend.sense == other.sense && (bend.angle - other.angle).abs() <= SAME_TURN))
            })
        })
    }
}

/// Whether a marked line, moved, is another, run through either way.
fn is_line(l: &MarkLine, m: &MarkLine, motion: &Motion, slack: f64) -> bool {
    if l.closed != m.closed || l.joints.len() != m.joints.len() {
        return false;
    }
    [m.contour(), m.reversed().contour()].iter().any(|other| match l.closed {
        true => on(&l.contour(), other, motion, slack),
        false => falls_on(&l.contour(), other, 0, motion, slack),
    })
}

/// Whether a contour, moved, is another.
fn on(c: &Contour, d: &Contour, motion: &Motion, slack: f64) -> bool {
    if let Some(((o, r), (m, s))) = c.circle().zip(d.circle()) {
        return (motion.apply(&o) - m).norm() <= slack && (r - s).abs() <= slack;
    }
    let n = c.vertices.len();
    n == d.vertices.len() && (0..n).any(|shift| falls_on(c, d, shift, motion, slack))
}

/// Whether a contour, moved, is another one as long, whose joints begin so many places later.
fn falls_on(c: &Contour, d: &Contour, shift: usize, motion: &Motion, slack: f64) -> bool {
    let (v, w) = (&c.vertices, &d.vertices);
    let n = v.len();
    (0..n).all(|k| {
        let (a, b) = (&v[k], &w[(k + shift) % n]);
        let chord = (v[(k + 1) % n].point - a.point).norm();
        (motion.apply(&a.point) - b.point).norm() <= slack && (a.bulge - b.bulge).abs() * chord <= slack
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patchwork::pattern::{Bend, ContourVertex};

    /// An L with a hole and a bend line, turned and moved, its joints counted from another one.
    fn part(angle: f64, first: usize, sense: BendSense) -> Pattern {
        let (s, c) = angle.sin_cos();
        let at = |x: f64, y: f64| Vec2::new(c * x - s * y + 7.0, s * x + c * y - 3.0);
        let vertex = |x: f64, y: f64, bulge: f64| ContourVertex { point: at(x, y), bulge, corner: true };
        let mut outer = vec![
            vertex(0.0, 0.0, 0.0),
            vertex(50.0, 0.0, 0.2),
            vertex(50.0, 20.0, 0.0),
            vertex(20.0, 20.0, 0.0),
            vertex(20.0, 60.0, 0.0),
            vertex(0.0, 60.0, 0.0),
        ];
        outer.rotate_left(first);
        let hole = vec![vertex(8.0, 30.0, -1.0), vertex(12.0, 30.0, -1.0)];
        Pattern {
            contours: vec![Contour { vertices: outer }, Contour { vertices: hole }],
            rulings: vec![[at(0.0, 25.0), at(20.0, 25.0)]],
            bends: vec![Bend::of(sense, 1.0, [2.0; 2])],
            area: 1800.0,
            length: 65.0,
            width: 45.0,
            ..Pattern::default()
        }
    }

    #[test]
    fn turned_parts_are_the_same_and_mirrored_ones_are_said_to_be() {
        let (up, down) = (BendSense::Up, BendSense::Down);
        let all = [part(0.0, 0, up), part(2.0, 3, up), part(1.0, 1, up).turned_over(), part(0.5, 2, down)];
        let found = same_parts(&all, &[]);
        assert_eq!(found[0], None);
        assert_eq!(found[1], Some(SamePart { pattern: 0, mirrored: false }));
        assert_eq!(found[2], Some(SamePart { pattern: 0, mirrored: true }));
        // The same outline, bent the other way, is another part.
        assert_eq!(found[3], None);
        let hands = |all: &[Pattern]| opposite_hands(all, &[], &same_parts(all, &[]));
        assert_eq!(hands(&all), [None; 4]);
        // Mirrored and bent the same way it is the opposite hand; a flat part is the same turned over.
        let mirrored = part(1.0, 1, up).mirror_image();
        assert_eq!(hands(&[all[0].clone(), mirrored.clone(), mirrored]), [None, Some(0), None]);
        let flat = part(0.0, 0, BendSense::Flat);
        assert_eq!(hands(&[flat.clone(), flat.mirror_image()]), [None, None]);
    }

    #[test]
    fn what_differs_is_not_the_same() {
        let one = part(0.0, 0, BendSense::Up);
        let mut other = part(1.0, 0, BendSense::Up);
        other.contours[1].vertices[0].point.x += 0.01;
        let thick = [1.0, 2.0];
        assert_eq!(same_parts(&[one.clone(), other], &[])[1], None);
        assert_eq!(same_parts(&[one.clone(), one.clone()], &thick)[1], None);
        assert_eq!(same_parts(&[one.clone(), Pattern::default(), one], &[])[2].map(|s| s.pattern), Some(0));
    }
}
