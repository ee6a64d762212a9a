//! Branches of coplanar tangents of two rails: the zero set of `f(s, t) = det(a', b', b − a)` \[W15, 4B\].
//!
//! *Method.* Values of f, all three vectors of unit length, on a grid of both tracks; marching squares; every crossing
//! of a grid line polished to rounding; crossings joined to chains. Chains are cut into runs along which both rails are
//! followed monotonically and the type does not change.

pub(crate) use super::branch::used_share;
pub use super::branch::{Branch, BranchType, Direction};
use super::links::linked;
use super::track::{LineElement, Track};
use crate::torse::rail::Rail;
use std::f64::consts::FRAC_PI_2;

/// Knobs of [`branches`].
#[derive(Clone, Copy, Debug)]
pub struct BranchOptions {
    /// Cells of the grid along each rail; default 400.
    pub cells: usize,
    /// Whether to leave out branches that a plane touches from inside; default false.
    pub all_types: bool,
}

impl Default for BranchOptions {
    fn default() -> Self {
        Self { cells: 400, all_types: true }
    }
}

/// Below this, f is rounding: unit vectors, so its own error is a few 1e-16.
const ZERO: f64 = 1e-13;
/// Steps of the track's parameter below this are rest.
const REST: f64 = 1e-10;
/// Brackets narrower than this share of their ends cannot be halved any more.
const LAST_DIGIT: f64 = 1e-16;

/// `det(a', b', b − a)` with unit vectors; 0 where rounding is all there is.
pub(crate) fn coplanarity(a: &LineElement, b: &LineElement) -> f64 {
    let r = b.point - a.point;
    let l = r.norm();
    if l == 0.0 {
        return 0.0;
    }
    let f = a.tangent.cross(&b.tangent).dot(&r) / l;
    if f.abs() < ZERO {
        0.0
    } else {
        f
    }
}

/// Coplanarity of two tangents of one curve divided by the third power of the chord: regular on the diagonal, where
/// it tends to `−κ²τ/12` \[W15, 5.2\]. mm⁻³.
pub fn self_coplanarity(a: &LineElement, b: &LineElement) -> f64 {
    let r = b.point - a.point;
    let l = r.norm();
    a.tangent.cross(&b.tangent).dot(&r) / (l * l * l * l)
}

/// Oriented twist of the ruling between two line elements, rad in [0, π]; `None` where a tangent lies along the ruling.
pub(crate) fn twist(a: &LineElement, b: &LineElement) -> Option<f64> {
    const ALONG: f64 = 1e-9;
    let r = (b.point - a.point).try_normalize(0.0)?;
    let (x, y) = (a.tangent.cross(&r), b.tangent.cross(&r));
    (x.norm() > ALONG && y.norm() > ALONG).then(|| x.cross(&y).norm().atan2(x.dot(&y)))
}

/// All runs between two rails, best first: regular before double-cone, then by the share of the rails that they use.
///
/// *Guarantee*: stations satisfy f = 0 to about 1e-14 along grid lines. *Not guaranteed*: branches that stay within
/// one cell of the grid are missed.
/// *Cost*: cells² evaluations of a determinant.
pub fn branches(a: &Rail, b: &Rail, options: &BranchOptions) -> Vec<Branch> {
    let (ta, tb) = (Track::new(a), Track::new(b));
    let f = |x: f64, y: f64| coplanarity(&ta.at(x), &tb.at(y));
    let grid = Grid::new(&ta, &tb, options.cells, coplanarity);
    let found: Vec<Branch> = grid.chains(&f).iter().flat_map(|c| runs(c, &ta, &tb)).collect();
    let mut out = linked(found, [&ta, &tb], [&grid.x, &grid.y], &f);
    out.retain(|r| options.all_types || r.kind == BranchType::Regular);
    out.sort_by(|p, q| {
        let key = |r: &Branch| (r.kind == BranchType::DoubleCone, -r.merit());
        key(p).0.cmp(&key(q).0).then(key(p).1.total_cmp(&key(q).1))
    });
    out
}

/// Values on the nodes of two tracks.
pub(crate) struct Grid {
    x: Vec<f64>,
    y: Vec<f64>,
    values: Vec<f64>,
    /// Periods of closed tracks.
    period: [Option<f64>; 2],
}

/// Crossings in order along a zero line; both coordinates continuous.
#[derive(Clone, Debug)]
pub(crate) struct ZeroLine {
    pub points: Vec<[f64; 2]>,
    pub closed: bool,
}

const NONE: u32 = u32::MAX;

impl Grid {
    /// Evaluates `value` on all pairs of nodes.
    pub fn new(a: &Track, b: &Track, cells: usize, value: fn(&LineElement, &LineElement) -> f64) -> Self {
        let (x, y) = (a.nodes(cells), b.nodes(cells));
        let p: Vec<LineElement> = x.iter().map(|&x| a.at(x)).collect();
        let q: Vec<LineElement> = y.iter().map(|&y| b.at(y)).collect();
        let mut values = Vec::with_capacity(p.len() * q.len());
        for a in &p {
            values.extend(q.iter().map(|b| value(a, b)));
        }
        let period = [(a, a.rail.closed), (b, b.rail.closed)].map(|(t, closed)| closed.then_some(t.end()));
        Self { x, y, values, period }
    }

    /// Parameter of node `i`, one period on for the node after the last of a closed track.
    fn node(&self, d: usize, i: usize) -> f64 {
        let nodes = if d == 0 { &self.x } else { &self.y };
        match nodes.get(i) {
            Some(&x) => x,
            None => nodes[0] + self.period[d].unwrap_or(0.0),
        }
    }

    /// Zero lines: crossings polished along grid lines by `f`, joined.
    #[expect(clippy::too_many_lines, reason = "one march with its state")]
    pub fn chains(&self, f: &dyn Fn(f64, f64) -> f64) -> Vec<ZeroLine> {
        let (na, nb) = (self.x.len(), self.y.len());
        let (ca, cb) =
            (if self.period[0].is_some() { na } else { na - 1 }, if self.period[1].is_some() { nb } else { nb - 1 });
        // Edges along a: (i, j) → (i + 1, j); edges along b: (i, j) → (i, j + 1).
        let along_a = |i: usize, j: usize| (i * nb + j % nb) as u32;
        let along_b = |i: usize, j: usize| (ca * nb + (i % na) * cb + j) as u32;
        let mut links = vec![[NONE; 2]; ca * nb + na * cb];
        let mut crossed: Vec<u32> = Vec::new();
        let mut link = |p: u32, q: u32| {
            for (e, o) in [(p, q), (q, p)] {
                let l = &mut links[e as usize];
                if l[0] == NONE {
                    l[0] = o;
                    crossed.push(e);
                } else {
                    l[1] = o;
                }
            }
        };
        for i in 0..ca {
            let (row, next) = (i * nb, (i + 1) % na * nb);
            for j in 0..cb {
                let k = (j + 1) % nb;
                let v = [self.values[row + j], self.values[next + j], self.values[next + k], self.values[row + k]];
                let s = v.map(|x| x >= 0.0);
                if s[0] == s[1] && s[1] == s[2] && s[2] == s[3] {
                    continue;
                }
                let e = [along_a(i, j), along_b(i + 1, j), along_a(i, j + 1), along_b(i, j)];
                let open: Vec<u32> = (0..4).filter(|&k| s[k] != s[(k + 1) % 4]).map(|k| e[k]).collect();
                match open[..] {
                    [p, q] => link(p, q),
                    [p, q, r, t] => {
                        // A saddle: the middle decides which corners belong together.
                        if (v.iter().sum::<f64>() >= 0.0) == s[0] {
                            link(p, q);
                            link(r, t);
                        } else {
                            link(t, p);
                            link(q, r);
                        }
                    }
                    _ => {}
                }
            }
        }
        let place = |e: u32| -> [f64; 2] {
            let e = e as usize;
            if e < ca * nb {
                let (i, j) = (e / nb, e % nb);
                let y = self.y[j];
                let (v, w) = (self.values[i * nb + j], self.values[(i + 1) % na * nb + j]);
                [root(&|x| f(x, y), [self.node(0, i), self.node(0, i + 1)], [v, w]), y]
            } else {
                let (i, j) = ((e - ca * nb) / cb, (e - ca * nb) % cb);
                let x = self.x[i];
                let (v, w) = (self.values[i * nb + j], self.values[i * nb + (j + 1) % nb]);
                [x, root(&|y| f(x, y), [self.node(1, j), self.node(1, j + 1)], [v, w])]
            }
        };
        let mut seen = vec![false; links.len()];
        let mut out = Vec::new();
        for ends in [true, false] {
            for &start in &crossed {
                let is_end = links[start as usize][1] == NONE;
                if seen[start as usize] || is_end != ends {
                    continue;
                }
                let mut points: Vec<[f64; 2]> = Vec::new();
                let mut at = start;
                let mut closed = false;
                loop {
                    seen[at as usize] = true;
                    let p = place(at);
                    points.push(points.last().map_or(p, |q| self.near(p, q)));
                    let l = links[at as usize];
                    if let Some(next) = l.into_iter().find(|&e| e != NONE && !seen[e as usize]) {
                        at = next;
                        continue;
                    }
                    if !ends && points.len() > 2 && l.contains(&start) {
                        closed = true;
                        points.push(self.near(points[0], &points[points.len() - 1]));
                    }
                    break;
                }
                if points.len() > 1 {
                    out.push(ZeroLine { points, closed });
                }
            }
        }
        out
    }

    /// The copy of `p`, by whole periods, nearest to `q`.
    fn near(&self, p: [f64; 2], q: &[f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| match self.period[d] {
            Some(period) => p[d] + ((q[d] - p[d]) / period).round() * period,
            None => p[d],
        })
    }
}

/// Root of a function whose values at the ends have different signs (0 counts as positive): secants kept inside the
/// bracket, halvings where these are slow.
pub(crate) fn root(f: &dyn Fn(f64) -> f64, ends: [f64; 2], values: [f64; 2]) -> f64 {
    let ([mut a, mut b], [mut fa, mut fb]) = (ends, values);
    for (x, v) in [(a, fa), (b, fb)] {
        if v == 0.0 {
            // A zero at a node is the crossing, unless a whole stretch is zero; its border is a crossing all the same.
            return x;
        }
    }
    let mut side = 0;
    for k in 0..100 {
        let width = b - a;
        if width.abs() <= LAST_DIGIT * (a.abs() + b.abs()) {
            break;
        }
        // Illinois: the value of an end that stays is halved.
        let secant = (a * fb - b * fa) / (fb - fa);
        let inside = secant.is_finite() && (secant - a) * (secant - b) < 0.0;
        let x = if k > 40 || !inside { 0.5 * (a + b) } else { secant };
        let v = f(x);
        if v == 0.0 {
            return x;
        }
        if (v > 0.0) == (fb > 0.0) {
            (b, fb) = (x, v);
            if side == 1 {
                fa *= 0.5;
            }
            side = 1;
        } else {
            (a, fa) = (x, v);
            if side == 2 {
                fb *= 0.5;
            }
            side = 2;
        }
    }
    0.5 * (a + b)
}

/// Cuts a chain into runs.
fn runs(chain: &ZeroLine, ta: &Track, tb: &Track) -> Vec<Branch> {
    let n = chain.points.len() - 1;
    // Class of a step: direction (+1, −1; 0 where one rail rests) and type (1 regular, 2 double cone, 0 unknown).
    let class: Vec<(i8, u8)> = (0..n)
        .map(|k| {
            let (p, q) = (chain.points[k], chain.points[k + 1]);
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            let rest = |d: f64| d.abs() <= REST;
            let direction = if rest(dx) || rest(dy) {
                0
            } else if (dx > 0.0) == (dy > 0.0) {
                1
            } else {
                -1
            };
            // A step that starts or ends at a tangency knows its type in the middle.
            let (a, b) = (ta.at(0.5 * (p[0] + q[0])), tb.at(0.5 * (p[1] + q[1])));
            let kind = twist(&a, &b).map_or(0, |w| if w < FRAC_PI_2 { 1 } else { 2 });
            (direction, kind)
        })
        .collect();
    // On closed chains begin where the class changes.
    let agree = |p: (i8, u8), q: (i8, u8)| (p.0 == 0 || q.0 == 0 || p.0 == q.0) && (p.1 == 0 || q.1 == 0 || p.1 == q.1);
    let breaks_at = |k: usize| !agree(class[(k + n - 1) % n], class[k]);
    let start = if chain.closed { (0..n).find(|&k| breaks_at(k)).unwrap_or(0) } else { 0 };
    let shift = {
        let (first, last) = (chain.points[0], chain.points[n]);
        [last[0] - first[0], last[1] - first[1]]
    };
    let point = |k: usize| {
        let turn = (k / n) as f64;
        let p = chain.points[k % n];
        if k == n && !chain.closed {
            return chain.points[n];
        }
        [p[0] + turn * shift[0], p[1] + turn * shift[1]]
    };
    let mut out = Vec::new();
    let mut k = start;
    while k < start + n {
        let mut known = class[k % n];
        let mut end = k + 1;
        while end < start + n && agree(known, class[end % n]) {
            let c = class[end % n];
            known = (if known.0 == 0 { c.0 } else { known.0 }, if known.1 == 0 { c.1 } else { known.1 });
            end += 1;
        }
        let mut stations: Vec<[f64; 2]> = (k..=end).map(point).collect();
        if stations[stations.len() - 1][0] < stations[0][0] {
            stations.reverse();
        }
        let closed = chain.closed && end - k == n;
        k = end;
        let direction = if known.0 < 0 { Direction::Opposite } else { Direction::Same };
        if known.0 == 0 {
            // One rail rests all the way: a plane that touches a whole stretch.
            let (p, q) = (stations[0], stations[stations.len() - 1]);
            if q[1] < p[1] && (q[0] - p[0]).abs() <= REST {
                stations.reverse();
            }
        }
        let used = |t: &Track, d: usize| {
            let (x0, x1) = (stations[0][d], stations[stations.len() - 1][d]);
            used_share(t, x0.min(x1), x0.max(x1))
        };
        let coverage = [used(ta, 0), used(tb, 1)];
        let kind = if known.1 == 2 { BranchType::DoubleCone } else { BranchType::Regular };
        out.push(Branch { stations, kind, direction, closed, coverage });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::geom::{Frame, Vec3};
    use std::f64::consts::TAU;

    fn ellipse(origin: Vec3, a: f64, b: f64) -> Rail {
        let frame = Frame { origin, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
        Rail::new("ellipse", &[c]).expect("rail")
    }

    fn angle(r: &Rail, s: f64) -> (f64, f64) {
        let p = r.point(s);
        (p.x, p.y)
    }

    #[test]
    fn circle_and_ellipse_have_parallel_tangents_on_both_branches() {
        let (a, b) = (ellipse(Vec3::zeros(), 1.0, 1.0), ellipse(Vec3::z(), 1.5, 0.6));
        let found = branches(&a, &b, &BranchOptions { cells: 200, ..BranchOptions::default() });
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].kind, found[1].kind), (BranchType::Regular, BranchType::DoubleCone));
        assert!(found.iter().all(|f| f.closed && f.coverage == [1.0, 1.0] && f.direction == Direction::Same));
        let (ta, tb) = (Track::new(&a), Track::new(&b));
        for p in &found[0].stations {
            let (x, y) = angle(&a, ta.rail_parameter(p[0].rem_euclid(ta.end())));
            let (u, v) = angle(&b, tb.rail_parameter(p[1].rem_euclid(tb.end())));
            // Normals (x, y) and (u/a², v/b²) are parallel.
            let n = (u / 2.25, v / 0.36);
            assert!((x * n.1 - y * n.0).abs() < 1e-11 && x * n.0 + y * n.1 > 0.0);
        }
    }

    #[test]
    fn square_and_circle_meet_in_facets_and_fans() {
        let points = [(0.8, -0.8), (0.8, 0.8), (-0.8, 0.8), (-0.8, -0.8), (0.8, -0.8)];
        let square = Rail::polyline("square", &points.map(|(x, y)| Vec3::new(x, y, 1.5))).expect("rail");
        let found = branches(&ellipse(Vec3::zeros(), 1.0, 1.0), &square, &BranchOptions::default());
        assert_eq!(found[0].kind, BranchType::Regular);
        assert!(found[0].closed && found[0].coverage == [1.0, 1.0]);
    }

    /// The share of both rails that the best branch uses, and whether it goes on as straight as it should: both at the same share of
    /// their own.
    fn followed(a: &Rail, b: &Rail) -> ([f64; 2], f64) {
        let found = branches(a, b, &BranchOptions::default());
        let best =
            found.iter().find(|f| f.kind == BranchType::Regular && f.direction == Direction::Same).expect("a branch");
        let off = best.stations.iter().map(|s| (s[0] - s[1]).abs()).fold(0.0, f64::max);
        (best.coverage, off)
    }

    #[test]
    fn a_curve_that_bends_both_ways_and_its_copy_are_followed_from_end_to_end() {
        let s = |z: f64, k: f64| {
            let points = [[0.0, 0.0], [40.0, 0.0], [60.0, 60.0], [100.0, 60.0]].map(|p| [k * p[0], k * p[1], z, 1.0]);
            let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
            Rail::new("s", &[crate::spline::curve::Curve::new(3, knots, points.to_vec()).expect("a curve")])
                .expect("a rail")
        };
        for k in [1.0, 0.7] {
            let (coverage, off) = followed(&s(0.0, 1.0), &s(80.0, k));
            assert!(coverage.iter().all(|c| *c > 1.0 - 1e-9) && off < 1e-6, "{coverage:?} {off}");
        }
    }

    /// Lines and arcs: a profile of sheet that bends to one side and back, and the same wider and with other radii.
    fn joggle(z: f64, [flat, r]: [f64; 2], web: f64) -> Rail {
        use crate::spline::curve::Curve;
        let angle = 1.0_f64;
        let line = |a: Vec3, b: Vec3| {
            Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[a.x, a.y, a.z, 1.0], [b.x, b.y, b.z, 1.0]]).expect("a line")
        };
        let arc = |c: Vec3, from: f64, to: f64| {
            let (half, mid) = (0.5 * (to - from), 0.5 * (from + to));
            let w = half.cos();
            let at = |t: f64, r: f64, w: f64| [w * (c.x + r * t.cos()), w * (c.y + r * t.sin()), w * c.z, w];
            let points = vec![at(from, r, 1.0), at(mid, r / w, w), at(to, r, 1.0)];
            Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], points).expect("an arc")
        };
        let way = |t: f64| Vec3::new(t.cos(), t.sin(), 0.0);
        let p = [Vec3::new(0.0, 0.0, z), Vec3::new(flat, 0.0, z)];
        let c = p[1] + way(FRAC_PI_2) * r;
        let q = c + way(angle - FRAC_PI_2) * r;
        let u = q + way(angle) * web;
        let d = u + way(angle - FRAC_PI_2) * r;
        let v = d + way(FRAC_PI_2) * r;
        let pieces = [
            line(p[0], p[1]),
            arc(c, -FRAC_PI_2, angle - FRAC_PI_2),
            line(q, u),
            arc(d, angle + FRAC_PI_2, FRAC_PI_2),
            line(v, v + way(0.0) * flat),
        ];
        Rail::new("joggle", &pieces).expect("a rail")
    }

    #[test]
    fn straight_parts_that_are_parallel_lead_from_bend_to_bend() {
        let first = joggle(0.0, [50.0, 30.0], 20.0);
        for other in [joggle(80.0, [50.0, 30.0], 20.0), joggle(80.0, [80.0, 12.0], 35.0)] {
            let (coverage, _) = followed(&first, &other);
            assert!(coverage.iter().all(|c| *c > 1.0 - 1e-9), "{coverage:?}");
        }
    }

    #[test]
    fn a_star_and_its_copy_are_followed_all_the_way_round() {
        let corner = |k: u32, z: f64| {
            let (r, t) =
                (if k.is_multiple_of(2) { 50.0 } else { 25.0 }, f64::from(k % 10) * 0.2 * std::f64::consts::PI);
            Vec3::new(r * t.cos(), r * t.sin(), z)
        };
        let star =
            |z: f64| Rail::polyline("star", &(0..=10).map(|k| corner(k, z)).collect::<Vec<_>>()).expect("a rail");
        let found = branches(&star(0.0), &star(80.0), &BranchOptions::default());
        assert!(found[0].closed && found[0].coverage == [1.0; 2], "{:?} {:?}", found[0].closed, found[0].coverage);
    }

    #[test]
    fn on_the_diagonal_the_quotient_tends_to_torsion() {
        let p = 0.5;
        let at = |t: f64| LineElement {
            point: Vec3::new(t.cos(), t.sin(), p * t),
            tangent: Vec3::new(-t.sin(), t.cos(), p) / (1.0f64 + p * p).sqrt(),
        };
        let (kappa, tau) = (1.0 / 1.25, p / 1.25);
        let value = self_coplanarity(&at(0.3), &at(0.3 + 2e-2));
        assert!((value + kappa * kappa * tau / 12.0).abs() < 1e-5);
    }
}
