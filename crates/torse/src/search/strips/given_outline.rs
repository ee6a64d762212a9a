//! Where strips of given rulings and faces end: outlines through the ends of the rulings, or along the border of the face, in
//! the plane and on the patch \[PW99, 4.3: the segments of interest\]. How near outlines keep to these is judged elsewhere.

use crate::certify::points::points;
use crate::control::Control;
use crate::develop::scanned::{needed, sharp, CarriedLoop, ScanOutline, Shown};
use crate::develop::smooth_ends::through;
use crate::geom::polygon::area;
use crate::geom::segment;
use crate::geom::{Vec2, Vec3};
use crate::torse::contact::ContactElement;
use crate::torse::strip::Strip;

/// What a strip should end at.
#[derive(Clone, Debug)]
pub(crate) enum GivenBorder {
    /// The rulings of these elements, neighbours beside each other and all in one direction, and how far a sheet may bulge
    /// from straight lines between neighbours, mm.
    Rulings(Vec<[Vec3; 2]>, f64),
    /// The border of a face: closed loops of places that are dense enough for its curves, the outer one first.
    Face(Vec<Vec<Vec3>>),
}

/// Share of the tolerance within which a whole strip ends where it should: its smooth edges stay then.
const ENDS: f64 = 0.3;
/// Gauss–Newton steps to the last digits.
const STEPS: usize = 3;
/// Places along each border of a strip at which that is looked at.
const LOOKS: usize = 512;
/// Stretches beside one between neighbours tell how it turns if they are so long against it: noise turns short ones.
const LONG: f64 = 0.5;

impl GivenBorder {
    /// The border of elements with rulings; `None` if some have none.
    pub fn of(elements: &[ContactElement]) -> Option<Self> {
        let all = elements.len() > 1 && elements.iter().all(ContactElement::has_ruling);
        let bulge = || (1..elements.len()).map(|k| bulge(elements, k)).fold(0.0, f64::max);
        all.then(|| Self::Rulings(elements.iter().map(|e| e.ends).collect(), bulge()))
    }

    /// What is given, as points and, of rulings, the indices of the ends of neighbours.
    pub fn points_and_cells(&self) -> (Vec<Vec3>, Vec<[u32; 4]>) {
        match self {
            Self::Rulings(all, _) => {
                let between = (1..all.len() as u32).map(|k| [2 * k - 2, 2 * k - 1, 2 * k, 2 * k + 1]);
                (all.iter().flatten().copied().collect(), between.collect())
            }
            Self::Face(loops) => (loops.iter().flatten().copied().collect(), Vec::new()),
        }
    }
}

/// Where a strip is cut.
pub(super) enum Cut {
    /// It ends where it should already; the numbers are those of an outline, see [`ScanOutline::keeps`].
    Whole([f64; 2]),
    /// At this outline.
    At(ScanOutline, Vec<CarriedLoop>),
}

/// The outline of a strip in the plane and on its patch. `None` where the border is none on the strip.
pub(super) fn cut(
    shown: &Shown,
    strip: &Strip,
    border: &GivenBorder,
    tolerance: f64,
    control: &Control,
) -> Option<Cut> {
    let (loops, off) = match border {
        GivenBorder::Rulings(all, bulge) => {
            let (outline, beside) = around(shown, strip, all, control)?;
            (vec![outline], beside + bulge)
        }
        GivenBorder::Face(loops) => {
            let thin = |l: &Vec<Vec3>| {
                let all = places(strip, l, control);
                let flat: Vec<Vec2> = all.iter().map(|q| shown.flat(q)).collect();
                let kept: Vec<[f64; 2]> = needed(&flat, 0.5 * shown.chord).into_iter().map(|k| all[k]).collect();
                (kept.len() > 2).then_some(kept)
            };
            (loops.iter().map(thin).collect::<Option<Vec<_>>>()?, 0.0)
        }
    };
    let mut flat: Vec<Vec<Vec2>> = loops.iter().map(|l| l.iter().map(|q| shown.flat(q)).collect()).collect();
    let turned = area(flat.first()?) < 0.0;
    let mut loops = loops;
    if turned {
        flat.iter_mut().for_each(|l| l.reverse());
        loops.iter_mut().for_each(|l| l.reverse());
    }
    let keeps = [tolerance, tolerance + off];
    if flat.len() == 1 && ends_there(shown, &flat[0], ENDS * tolerance) {
        return Some(Cut::Whole(keeps));
    }
    let carried = loops
        .iter()
        .zip(&flat)
        .map(|(places, flat)| shown.carried(&places.iter().copied().zip(sharp(flat)).collect::<Vec<_>>(), true));
    let carried = carried.collect::<Option<Vec<_>>>()?;
    Some(Cut::At(ScanOutline { loops: flat, spacing: 0.0, keeps, closed: 0, stray: 0 }, carried))
}

/// Places of points on a strip.
fn places(strip: &Strip, x: &[Vec3], control: &Control) -> Vec<[f64; 2]> {
    let on = points(std::slice::from_ref(strip), x, control);
    let (a, b) = strip.domain();
    let near = |(_, u, v): &(u32, f32, f32)| [f64::from(*u).clamp(a, b), f64::from(*v).clamp(0.0, 1.0)];
    on.places().iter().zip(x).map(|(place, x)| foot(strip, x, near(place))).collect()
}

/// The place of a strip nearest to a point from one that is known to seven digits.
fn foot(strip: &Strip, x: &Vec3, mut at: [f64; 2]) -> [f64; 2] {
    let (from, to) = strip.domain();
    for _ in 0..STEPS {
        let j = strip.patch.jet(at[0], at[1]);
        let w = x - j.p;
        let (a, b, c) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
        let (p, q) = (w.dot(&j.du), w.dot(&j.dv));
        let next = [at[0] + (c * p - b * q) / (a * c - b * b), at[1] + (a * q - b * p) / (a * c - b * b)];
        let next = [next[0].clamp(from, to), next[1].clamp(0.0, 1.0)];
        let nearer = (x - strip.patch.point(next[0], next[1])).norm_squared() < w.norm_squared();
        if !nearer {
            break;
        }
        at = next;
    }
    at
}

/// A closed loop through the ends of rulings, as places of a strip: curved where the ends lie on curves. And how far it lies
/// beside the lines between the ends, mm.
fn around(shown: &Shown, strip: &Strip, rulings: &[[Vec3; 2]], control: &Control) -> Option<(Vec<[f64; 2]>, f64)> {
    let (mut out, mut beside): (Vec<[f64; 2]>, f64) = (Vec::new(), 0.0);
    for side in 0..2 {
        let mut ends = places(strip, &rulings.iter().map(|r| r[side]).collect::<Vec<_>>(), control);
        // Rulings that are known up to some noise may be in another order at one side.
        ends.sort_by(|p, q| p[0].total_cmp(&q[0]));
        ends.dedup_by(|q, p| (shown.flat(p) - shown.flat(q)).norm() <= shown.chord);
        let flat: Vec<Vec2> = ends.iter().map(|q| shown.flat(q)).collect();
        let mut along = vec![*ends.first()?];
        for ((inner, w), b) in through(&flat, shown.chord).iter().zip(flat.windows(2)).zip(ends.windows(2)) {
            let ([a, b], d) = ([b[0], b[1]], w[1] - w[0]);
            let off = |p: &Vec2| (d.perp(&(p - w[0])) / d.norm()).abs();
            beside = inner.iter().map(off).fold(beside, f64::max);
            let n = (inner.len() + 1) as f64;
            let near = |k: usize| [0, 1].map(|d: usize| a[d] + (b[d] - a[d]) * (k + 1) as f64 / n);
            along.extend(inner.iter().enumerate().map(|(k, p)| shown.place(p, near(k))));
            along.push(b);
        }
        if side == 1 {
            along.reverse();
        }
        out.extend(along);
    }
    out.dedup();
    (out.len() > 2).then_some((out, beside))
}

/// How far a sheet may bulge from straight lines between an element and the one before it, mm. One that turns by θ between both
/// without turning back stays within the triangle of its tangents, whose height over their distance w is at most w/2 · tan(θ/2). Found
/// normals know little of wide stretches: the triangle of straight stretches before and behind, not much shorter, holds it too.
/// Never more than w is allowed. This is what is given alone: no strip widens what it is held to.
fn bulge(elements: &[ContactElement], k: usize) -> f64 {
    let apart = |i: usize, j: usize| {
        let ways = [0, 1].map(|side: usize| (elements[j].ends[side] - elements[i].ends[side]).norm());
        ways[0].max(ways[1])
    };
    let across = |i: usize, j: usize| {
        let along = elements[j].ends[1] - elements[j].ends[0] + elements[i].ends[1] - elements[i].ends[0];
        along.cross(&(elements[j].centre() - elements[i].centre())).try_normalize(0.0)
    };
    let width = apart(k - 1, k);
    let own = across(k - 1, k);
    let before = (0..k - 1).rev().find(|&i| apart(i, k - 1) >= LONG * width);
    let behind = (k + 1..elements.len()).find(|&i| apart(k, i) >= LONG * width);
    let turn = |other: Option<Vec3>| Some(own?.angle(&other?));
    let turns = [before.and_then(|i| turn(across(i, k - 1))), behind.and_then(|i| turn(across(k, i)))];
    let stretches = match turns {
        [Some(a), Some(b)] => a + b,
        [Some(a), None] | [None, Some(a)] => 2.0 * a,
        [None, None] => 0.0,
    };
    let turn = stretches.max(elements[k - 1].normal.angle(&elements[k].normal)).min(std::f64::consts::PI);
    width * (0.5 * (0.5 * turn).tan()).min(1.0)
}

/// Whether a polygon of the plane and the border of a whole strip are within `off` (mm) of each other.
fn ends_there(shown: &Shown, polygon: &[Vec2], off: f64) -> bool {
    let (a, b) = shown.development.domain();
    let share = |k: usize| k as f64 / LOOKS as f64;
    let at = |u: f64, v: f64| shown.flat(&[a + (b - a) * u, v]);
    let rail = |v: f64| (0..LOOKS).map(move |k| (share(k), v));
    let border: Vec<Vec2> = rail(0.0)
        .chain((0..LOOKS).map(|k| (1.0, share(k))))
        .chain((1..=LOOKS).rev().map(|k| (share(k), 1.0)))
        .chain((1..=LOOKS).rev().map(|k| (0.0, share(k))))
        .map(|(u, v)| at(u, v))
        .collect();
    let near =
        |x: &Vec2, l: &[Vec2]| (0..l.len()).any(|k| (segment::foot(&l[k], &l[(k + 1) % l.len()], x) - x).norm() <= off);
    border.iter().all(|x| near(x, polygon)) && polygon.iter().all(|x| near(x, &border))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_sheet_may_bulge_by_is_at_least_what_a_cylinder_does() {
        for turn in [1e-3, 0.1, 0.5, 1.0, 2.0, 3.0] {
            let elements = [-0.5 * turn, 0.5 * turn].map(|a: f64| {
                let normal = Vec3::new(a.sin(), 0.0, a.cos());
                let at = |y: f64| 100.0 * normal + Vec3::new(0.0, y, 0.0);
                ContactElement { normal, ends: [at(0.0), at(50.0)], radius: 10.0, weight: 1.0 }
            });
            let (allowed, apart) = (bulge(&elements, 1), 200.0 * (0.5 * turn).sin());
            let sagitta = 100.0 * (1.0 - (0.5 * turn).cos());
            assert!(allowed >= sagitta && allowed <= apart, "{turn}: {allowed} {sagitta}");
            assert!(turn > 1.0 || allowed <= 2.2 * sagitta, "{turn}: {allowed} {sagitta}");
        }
    }

    #[test]
    fn wide_stretches_may_bulge_by_what_the_stretches_beside_them_leave() {
        // Normals as they are found, of the chords beside: they hardly turn over the wide stretch from 0.6 to 1.4 rad.
        let angles = [0.0_f64, 0.3, 0.6, 1.4, 1.7, 2.0];
        let elements: Vec<ContactElement> = angles
            .iter()
            .map(|a| {
                let at = |y: f64| Vec3::new(100.0 * a.cos(), 100.0 * a.sin(), y);
                ContactElement { normal: Vec3::x(), ends: [at(0.0), at(50.0)], radius: 10.0, weight: 1.0 }
            })
            .collect();
        let sagitta = 100.0 * (1.0 - 0.4_f64.cos());
        let allowed = bulge(&elements, 3);
        assert!(allowed > sagitta && allowed < 5.0 * sagitta, "{allowed} {sagitta}");
    }
}
