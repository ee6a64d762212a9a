//! Whether the exported trimming loops are simple closed curves that bound one region, and stay on their patch.
//!
//! *Method* \[certificate, H7\]: the cubic pieces are halved until every piece runs forward in some direction together
//! with its successor (so neither meets itself, and both meet in their common end only), and all other pairs are
//! separated by a line between their control polygons. Then the loops are disjoint simple curves with the topology of
//! their chords: the winding of the outer chord polygon and of the holes' inside it is decided by exact predicates.
//!
//! A curve shorter than the margin (the rim of a pole) counts as a point: whatever it does changes the region inside a
//! disc of that size only, far below the rounding of the points themselves.
//!
//! Control points are computed in f64; all separations are required with a margin far above their rounding.

use crate::reason::LoopFault;
use crate::spline::curve::{bezier_pieces, Curve};
use robust::{orient2d, Coord};

/// Separation required, relative to the extent of the loops: pieces come from convex combinations, 40 halvings err by
/// less than 1e-13.
const MARGIN: f64 = 1e-12;

/// Rounds of halving at most.
const ROUNDS: usize = 36;

/// The same for straight sides: where two are not apart whole, halves that touch are not either.
const STRAIGHT_ROUNDS: usize = 4;

/// Pieces at most, beyond ten times the number given: loops that need more come too close to themselves.
const PIECES: usize = 4_000;

/// Distance that computed control points keep from the sides of a box, as a share of its size: rounding is far below.
const BOX_MARGIN: f64 = 1e-9;

/// Halvings of a piece at most, to show that it stays in a box.
const BOX_ROUNDS: usize = 12;

/// A cubic piece in coordinates scaled to the unit square.
#[derive(Clone, Copy, Debug)]
struct PlanarCubic {
    c: [[f64; 2]; 4],
    /// Number of the loop.
    group: u32,
}

/// What could not be shown of loops, and where: a place in the plane of the loops, where it is at one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Refusal {
    pub fault: LoopFault,
    pub at: Option<[f64; 2]>,
}

/// Whether loops (outer first) of trimming curves are simple, disjoint, and the others lie inside the first.
///
/// # Errors
/// What could not be shown.
pub(super) fn loops_are_simple(loops: &[Vec<&Curve<2>>]) -> Result<(), Refusal> {
    let scale = Scale::of(loops.iter().flatten().flat_map(|c| &c.control));
    let rings = gather(loops, &scale)?;
    rings_are_simple(rings, loops.len(), ROUNDS).map_err(|r| r.unscaled(&scale))
}

/// The same of closed polygons (outer first); corners that coincide with the one before are none.
///
/// # Errors
/// What could not be shown.
pub(super) fn polygons_are_simple(polygons: &[Vec<[f64; 2]>]) -> Result<(), Refusal> {
    let scale = Scale::of(polygons.iter().flatten());
    let place = |p: &[f64; 2]| scale.to(p);
    let mut rings = Vec::new();
    for (group, polygon) in polygons.iter().enumerate() {
        for (k, p) in polygon.iter().enumerate() {
            let (a, b) = (place(p), place(&polygon[(k + 1) % polygon.len()]));
            let at = |s: f64| [0, 1].map(|d: usize| a[d] + (b[d] - a[d]) * s);
            let c = [a, at(1.0 / 3.0), at(2.0 / 3.0), b];
            if c.iter().flatten().any(|x| !x.is_finite()) {
                return Err(LoopFault::PolygonNoExtent.into());
            }
            if (0..2).any(|d| (a[d] - b[d]).abs() > MARGIN) {
                rings.push(PlanarCubic { c, group: group as u32 });
            }
        }
    }
    if (0..polygons.len()).any(|g| !rings.iter().any(|r: &PlanarCubic| r.group as usize == g)) {
        return Err(LoopFault::NoSides.into());
    }
    rings_are_simple(rings, polygons.len(), STRAIGHT_ROUNDS).map_err(|r| r.unscaled(&scale))
}

/// Whether closed rings of pieces in the unit square are simple; places of refusals are places there.
fn rings_are_simple(mut rings: Vec<PlanarCubic>, loops: usize, rounds: usize) -> Result<(), Refusal> {
    let most = PIECES + 10 * rings.len();
    let mut last = None;
    let mut fresh = vec![true; rings.len()];
    for _ in 0..rounds {
        let marks = match conflicts(&rings, &fresh) {
            Ok(marks) => marks,
            Err(crossing) => return Err(Refusal { fault: LoopFault::Meets, at: Some(crossing) }),
        };
        let Some(open) = marks.iter().position(|m| *m) else { return nested(&rings, loops) };
        last = Some(rings[open].c[0]);
        if marks.len() > most {
            break;
        }
        let mut next = Vec::with_capacity(2 * rings.len());
        fresh.clear();
        for (p, &m) in rings.iter().zip(&marks) {
            if m {
                next.extend(p.halves());
                fresh.extend([true; 2]);
            } else {
                next.push(*p);
                fresh.push(false);
            }
        }
        rings = next;
    }
    Err(Refusal { fault: LoopFault::Meets, at: last })
}

/// Where a trimming curve is not shown to stay in a box; `None` if it stays there: its control points do, or those of its pieces
/// once they are short enough.
pub(super) fn leaves(curve: &Curve<2>, low: [f64; 2], high: [f64; 2]) -> Option<[f64; 2]> {
    let within = |c: &[f64; 2], margin: f64| {
        (0..2).all(|d| {
            let m = margin * (high[d] - low[d]);
            c[d] >= low[d] + m && c[d] <= high[d] - m
        })
    };
    let out = curve.control.iter().find(|c| !within(c, 0.0))?;
    if curve.knots.degree() != 3 {
        return Some(*out);
    }
    let pieces = bezier_pieces(curve).into_iter();
    let mut open: Vec<(PlanarCubic, usize)> =
        pieces.map(|(_, _, b)| (PlanarCubic { c: [b[0], b[1], b[2], b[3]], group: 0 }, 0)).collect();
    while let Some((p, depth)) = open.pop() {
        if p.c.iter().all(|c| within(c, BOX_MARGIN)) {
            continue;
        }
        if depth == BOX_ROUNDS || !within(&p.c[0], BOX_MARGIN) || !within(&p.c[3], BOX_MARGIN) {
            return Some(if within(&p.c[3], BOX_MARGIN) { p.c[0] } else { p.c[3] });
        }
        open.extend(p.halves().map(|h| (h, depth + 1)));
    }
    None
}

impl From<LoopFault> for Refusal {
    fn from(fault: LoopFault) -> Self {
        Self { fault, at: None }
    }
}

impl Refusal {
    fn unscaled(self, scale: &Scale) -> Self {
        Self { at: self.at.map(|p| scale.from(&p)), ..self }
    }
}

/// The map that takes points to the unit square.
struct Scale {
    low: [f64; 2],
    high: [f64; 2],
}

impl Scale {
    fn of<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for c in points {
            for d in 0..2 {
                low[d] = low[d].min(c[d]);
                high[d] = high[d].max(c[d]);
            }
        }
        Self { low, high }
    }

    fn to(&self, p: &[f64; 2]) -> [f64; 2] {
        [0, 1].map(|d: usize| (p[d] - self.low[d]) / (self.high[d] - self.low[d]))
    }

    fn from(&self, p: &[f64; 2]) -> [f64; 2] {
        [0, 1].map(|d: usize| self.low[d] + p[d] * (self.high[d] - self.low[d]))
    }
}

/// All pieces in order, scaled; checks that the curves join bit by bit.
fn gather(loops: &[Vec<&Curve<2>>], scale: &Scale) -> Result<Vec<PlanarCubic>, Refusal> {
    let place = |p: &[f64; 2]| scale.to(p);
    let mut out = Vec::new();
    for (group, l) in loops.iter().enumerate() {
        for (i, c) in l.iter().enumerate() {
            let next = l[(i + 1) % l.len()];
            let bits = |p: Option<&[f64; 2]>| p.map(|p| p.map(f64::to_bits));
            if bits(c.control.last()) != bits(next.control.first()) {
                return Err(Refusal { fault: LoopFault::Apart, at: c.control.last().copied() });
            }
            if c.knots.degree() != 3 || !super::boundary::clamped(c) {
                return Err(Refusal { fault: LoopFault::NotCubic, at: c.control.first().copied() });
            }
            let start = place(&c.control[0]);
            if c.control.iter().map(place).all(|p| (0..2).all(|d| (p[d] - start[d]).abs() <= MARGIN)) {
                continue;
            }
            for (_, _, b) in bezier_pieces(c) {
                let c = [place(&b[0]), place(&b[1]), place(&b[2]), place(&b[3])];
                if c.iter().flatten().any(|x| !x.is_finite()) {
                    return Err(LoopFault::NoExtent.into());
                }
                out.push(PlanarCubic { c, group: group as u32 });
            }
        }
    }
    if out.is_empty() {
        return Err(LoopFault::None.into());
    }
    Ok(out)
}

impl PlanarCubic {
    fn halves(&self) -> [Self; 2] {
        let mid = |p: [f64; 2], q: [f64; 2]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        let [a, b, c, d] = self.c;
        let (ab, bc, cd) = (mid(a, b), mid(b, c), mid(c, d));
        let (abc, bcd) = (mid(ab, bc), mid(bc, cd));
        let m = mid(abc, bcd);
        [Self { c: [a, ab, abc, m], ..*self }, Self { c: [m, bcd, cd, d], ..*self }]
    }

    fn chord(&self) -> [f64; 2] {
        [self.c[3][0] - self.c[0][0], self.c[3][1] - self.c[0][1]]
    }

    /// Smallest advance of the control polygon in a direction.
    fn advance(&self, w: [f64; 2]) -> f64 {
        self.c.windows(2).map(|p| (p[1][0] - p[0][0]) * w[0] + (p[1][1] - p[0][1]) * w[1]).fold(f64::INFINITY, f64::min)
    }

    /// Whether the piece runs forward in a direction. Legs of no length are allowed, where a curve starts or ends at
    /// rest: a cubic whose legs do not go back is monotone if it gets anywhere. Going back by less than the margin
    /// changes the region inside a disc of that size only.
    fn runs_along(&self, w: [f64; 2]) -> bool {
        let chord = self.chord();
        self.advance(w) >= -0.25 * MARGIN && chord[0] * w[0] + chord[1] * w[1] > MARGIN
    }

    /// Whether two pieces surely cross: both ends of each lie on either side of the other's chord, farther than that strays.
    fn crosses(&self, o: &Self) -> bool {
        let parted = |p: &Self, q: &Self| {
            let d = unit(p.chord());
            let off = |x: [f64; 2]| d[0] * (x[1] - p.c[0][1]) - d[1] * (x[0] - p.c[0][0]);
            let strays = p.c.iter().map(|x| off(*x).abs()).fold(MARGIN, f64::max);
            let (a, b) = (off(q.c[0]), off(q.c[3]));
            a.abs() > strays && b.abs() > strays && (a > 0.0) != (b > 0.0)
        };
        parted(self, o) && parted(o, self)
    }

    fn range(&self, w: [f64; 2]) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in &self.c {
            let v = p[0] * w[0] + p[1] * w[1];
            low = low.min(v);
            high = high.max(v);
        }
        (low, high)
    }

    /// Whether some line separates the control polygons of pieces whose boxes overlap.
    fn apart(&self, o: &Self) -> bool {
        let is_clear = |w: [f64; 2]| {
            let ((a, b), (c, d)) = (self.range(w), o.range(w));
            b + MARGIN < c || d + MARGIN < a
        };
        let (p, q) = (unit(self.chord()), unit(o.chord()));
        let between = |a: [f64; 2], b: [f64; 2]| is_clear(unit([a[0] - b[0], a[1] - b[1]]));
        is_clear([-p[1], p[0]])
            || is_clear([-q[1], q[0]])
            || is_clear(p)
            || is_clear(q)
            || is_clear(unit([p[0] + q[0], p[1] + q[1]]))
            || is_clear(unit([p[0] - q[0], p[1] - q[1]]))
            || between(self.c[3], o.c[0])
            || between(self.c[0], o.c[3])
    }
}

fn unit(v: [f64; 2]) -> [f64; 2] {
    let l = v[0].hypot(v[1]);
    if l > 0.0 {
        [v[0] / l, v[1] / l]
    } else {
        [1.0, 0.0]
    }
}

/// Pieces that are not yet shown to be clear of the others; those that are not `fresh` are clear of each other.
///
/// # Errors
/// Where two cross.
fn conflicts(rings: &[PlanarCubic], fresh: &[bool]) -> Result<Vec<bool>, [f64; 2]> {
    let n = rings.len();
    let mut marks = vec![false; n];
    // Successors along each loop.
    let mut next = vec![0usize; n];
    let mut start = 0;
    for i in 0..n {
        let last = i + 1 == n || rings[i + 1].group != rings[i].group;
        next[i] = if last { start } else { i + 1 };
        if last {
            start = i + 1;
        }
    }
    for i in 0..n {
        let (p, q) = (&rings[i], &rings[next[i]]);
        let (d, e) = (unit(p.chord()), unit(q.chord()));
        let w = unit([d[0] + e[0], d[1] + e[1]]);
        if !p.runs_along(w) || !q.runs_along(w) {
            marks[i] = true;
            marks[next[i]] = true;
        }
    }
    // Sweep over boxes sorted by their left sides.
    let boxes: Vec<[(f64, f64); 2]> = rings.iter().map(|p| [p.range([1.0, 0.0]), p.range([0.0, 1.0])]).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| boxes[a][0].0.total_cmp(&boxes[b][0].0));
    let mut active: Vec<usize> = Vec::new();
    for &i in &order {
        active.retain(|&j| boxes[j][0].1 + MARGIN >= boxes[i][0].0);
        for &j in &active {
            let overlap = boxes[i][1].0 <= boxes[j][1].1 + MARGIN && boxes[j][1].0 <= boxes[i][1].1 + MARGIN;
            let neighbours = next[i] == j || next[j] == i;
            if (fresh[i] || fresh[j]) && overlap && !neighbours && !rings[i].apart(&rings[j]) {
                if rings[i].crosses(&rings[j]) {
                    return Err(rings[i].c[0]);
                }
                marks[i] = true;
                marks[j] = true;
            }
        }
        active.push(i);
    }
    // A loop of fewer than three pieces has neighbours on both sides at once.
    for i in 0..n {
        if next[next[i]] == i {
            marks[i] = true;
        }
    }
    Ok(marks)
}

/// Outer loop and holes turn in opposite senses, and the holes are inside.
fn nested(rings: &[PlanarCubic], loops: usize) -> Result<(), Refusal> {
    let polygon =
        |g: usize| -> Vec<[f64; 2]> { rings.iter().filter(|p| p.group as usize == g).map(|p| p.c[0]).collect() };
    let outer = polygon(0);
    let sense = turning(&outer);
    let holes: Vec<Vec<[f64; 2]>> = (1..loops).map(polygon).collect();
    for (i, hole) in holes.iter().enumerate() {
        let p = hole[0];
        let refused = |fault: LoopFault| Err(Refusal { fault, at: Some(p) });
        if turning(hole) != -sense {
            return refused(LoopFault::HoleSense);
        }
        if !inside(&outer, p) {
            return refused(LoopFault::HoleOutside);
        }
        if holes.iter().enumerate().any(|(j, h)| j != i && inside(h, p)) {
            return refused(LoopFault::HoleInHole);
        }
    }
    Ok(())
}

fn at(p: [f64; 2]) -> Coord<f64> {
    Coord { x: p[0], y: p[1] }
}

/// +1 for counter-clockwise simple polygons, −1 for clockwise ones: the turn at the lowest corner.
fn turning(p: &[[f64; 2]]) -> i32 {
    let n = p.len();
    let lowest = |i: &usize, j: &usize| p[*i][1].total_cmp(&p[*j][1]).then(p[*i][0].total_cmp(&p[*j][0]));
    let Some(i) = (0..n).min_by(lowest) else { return 0 };
    let o = orient2d(at(p[(i + n - 1) % n]), at(p[i]), at(p[(i + 1) % n]));
    if o > 0.0 {
        1
    } else if o < 0.0 {
        -1
    } else {
        // Three corners in a row at the bottom: the left one comes first or last.
        (p[(i + 1) % n][0] - p[(i + n - 1) % n][0]).signum() as i32
    }
}

/// Whether `x` is inside a simple polygon: crossings of a ray, decided exactly.
fn inside(p: &[[f64; 2]], x: [f64; 2]) -> bool {
    let n = p.len();
    let mut odd = false;
    for i in 0..n {
        let (a, b) = (p[i], p[(i + 1) % n]);
        if (a[1] > x[1]) != (b[1] > x[1]) {
            let o = orient2d(at(a), at(b), at(x));
            if (o > 0.0) == (b[1] > a[1]) {
                odd = !odd;
            }
        }
    }
    odd
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::curve;
    use crate::spline::knots::Knots;

    /// An arc of a circle-like curve, ends exactly as given.
    fn arc(f: &dyn Fn(f64) -> [f64; 2], a: [f64; 2], b: [f64; 2]) -> Curve<2> {
        let k = Knots::uniform(3, 6, 0.0, 1.0).expect("knots");
        let mut c = curve(&k, f);
        let n = c.control.len();
        c.control[0] = a;
        c.control[n - 1] = b;
        c
    }

    fn circle(r: f64, sense: f64, centre: [f64; 2]) -> Vec<Curve<2>> {
        let place = |s: f64| {
            let a = std::f64::consts::TAU * s * sense;
            [centre[0] + r * a.cos(), centre[1] + 3.0 * r * a.sin()]
        };
        let (p, q) = (place(0.0), place(0.5));
        vec![arc(&|s| place(0.5 * s), p, q), arc(&|s| place(0.5 + 0.5 * s), q, p)]
    }

    fn refs(loops: &[Vec<Curve<2>>]) -> Vec<Vec<&Curve<2>>> {
        loops.iter().map(|l| l.iter().collect()).collect()
    }

    #[test]
    fn polygons_are_simple_or_not() {
        let square = |a: f64, b: f64| vec![[a, a], [b, a], [b, b], [a, b]];
        let back = |mut p: Vec<[f64; 2]>| {
            p.reverse();
            p
        };
        assert_eq!(polygons_are_simple(&[square(0.0, 4.0), back(square(1.0, 2.0))]), Ok(()));
        let twice = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        assert_eq!(polygons_are_simple(&[twice]), Ok(()));
        for wrong in [
            vec![square(0.0, 4.0), square(1.0, 2.0)],
            vec![square(0.0, 4.0), back(square(3.0, 5.0))],
            vec![vec![[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]]],
            vec![vec![[1.0, 1.0]; 3]],
        ] {
            assert!(polygons_are_simple(&wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn refusals_say_where() {
        // A bow tie, larger than the unit square: it crosses itself in (50, 20).
        let bow = vec![[0.0, 0.0], [100.0, 40.0], [100.0, 0.0], [0.0, 40.0]];
        let refused = polygons_are_simple(&[bow]).expect_err("it meets itself");
        let [x, y] = refused.at.expect("a place");
        assert_eq!(refused.fault, LoopFault::Meets);
        // On one of the two sides that cross, no farther off than the sides are long.
        let off = (x - 50.0).hypot(y - 20.0);
        assert!(((y - 0.4 * x).abs() < 1e-9 || (y - 40.0 + 0.4 * x).abs() < 1e-9) && off < 55.0, "{x} {y}");
        let hole = |at: f64| vec![[at, 1.0], [at, 2.0], [at + 1.0, 2.0], [at + 1.0, 1.0]];
        let square = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let refused = polygons_are_simple(&[square, hole(6.0)]).expect_err("outside");
        assert_eq!((refused.fault, refused.at), (LoopFault::HoleOutside, Some([6.0, 1.0])));
    }

    #[test]
    fn rings_with_holes() {
        let outer = circle(1.0, 1.0, [0.0, 0.0]);
        let hole = circle(0.3, -1.0, [0.4, 0.0]);
        assert_eq!(loops_are_simple(&refs(&[outer.clone(), hole.clone()])), Ok(()));
        assert!(loops_are_simple(&refs(&[outer.clone(), circle(0.3, 1.0, [0.4, 0.0])])).is_err(), "sense");
        assert!(loops_are_simple(&refs(&[outer.clone(), circle(0.3, -1.0, [1.0, 0.0])])).is_err(), "crossing");
        assert!(loops_are_simple(&refs(&[outer.clone(), circle(0.3, -1.0, [2.0, 0.0])])).is_err(), "outside");
        assert!(loops_are_simple(&refs(&[outer, hole, circle(0.1, -1.0, [0.4, 0.0])])).is_err(), "hole in hole");
    }

    #[test]
    fn eights_and_loose_ends() {
        let place = |s: f64| {
            let a = std::f64::consts::TAU * s + 0.3;
            [a.sin(), (2.0 * a).sin()]
        };
        let (p, q) = (place(0.0), place(0.5));
        let eight = vec![arc(&|s| place(0.5 * s), p, q), arc(&|s| place(0.5 + 0.5 * s), q, p)];
        assert!(loops_are_simple(&refs(&[eight])).is_err());
        let mut pole = circle(1.0, 1.0, [0.0, 0.0]);
        let p = pole[1].control[0];
        pole.insert(1, arc(&|_| p, p, p));
        assert_eq!(loops_are_simple(&refs(&[pole])), Ok(()), "a curve of no length");
        let mut open = circle(1.0, 1.0, [0.0, 0.0]);
        open[1].control[0][0] += 1e-9;
        assert!(loops_are_simple(&refs(&[open])).is_err());
    }

    #[test]
    fn curves_stay_in_a_box_whatever_their_control_points_do() {
        // The cubic t(1 − t)(1 − 2t) on [0, 1] reaches about ±0.0962, its control points ±1/3.
        let knots = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
        let third = 1.0 / 3.0;
        let c = Curve { knots, control: vec![[0.0, 0.0], [third, third], [2.0 * third, -third], [1.0, 0.0]] };
        assert!(leaves(&c, [-0.1, -0.0963], [1.1, 0.0963]).is_none());
        assert!(leaves(&c, [-0.1, -0.0961], [1.1, 0.0961]).is_some());
        assert!(leaves(&c, [-0.1, -0.0963], [0.9, 0.0963]).is_some());
        // On the very side of the box nothing is computed.
        assert!(leaves(&c, [0.0, -third], [1.0, third]).is_none());
    }

    #[test]
    fn acute_corners_and_thin_strips() {
        let line = |a: [f64; 2], b: [f64; 2]| arc(&move |s| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])], a, b);
        let ring = |p: &[[f64; 2]]| vec![(0..p.len()).map(|i| line(p[i], p[(i + 1) % p.len()])).collect::<Vec<_>>()];
        assert_eq!(loops_are_simple(&refs(&ring(&[[0., 0.], [1., 0.02], [1., 0.04]]))), Ok(()));
        assert_eq!(loops_are_simple(&refs(&ring(&[[0., 0.], [100., 50.], [100., 50.2], [0., 0.2]]))), Ok(()));
        assert!(loops_are_simple(&refs(&ring(&[[0., 0.], [1., 0.], [0., 1.], [1., 1.]]))).is_err());
    }
}
