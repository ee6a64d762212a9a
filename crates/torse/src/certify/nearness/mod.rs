//! How far pieces of surface reach from others: no point of them is farther from the others than the bound.
//!
//! *Method.* Pieces are cut into cells. For every cell a linear map ψ of its parameters into those of one of the other pieces
//! is guessed from nearest points; nothing is assumed of it. Then `|S(ψ(y)) − R(y)|` is bounded over the cell by a Taylor
//! polynomial of degree 2 about its middle whose rest is enclosed by intervals \[MKC09\]. Since ψ(y) is a point of the other
//! piece, this bounds the distance. Cells are halved until the bound exceeds the greatest distance seen by little, the worst
//! cells first; if these become too many, or a control says stop, what is known of the rest is the bound. Where the other
//! piece is trimmed, images that are not surely inside its polygons show nothing: then one place inside or on the polygons is
//! taken for the whole cell.
//! *Guaranteed*: the bound holds for every point, rounding included. *Not guaranteed*: that it is sharp.

mod ground;
mod piece;
mod region;
mod target;

pub(crate) use target::{distance_from, panels_from_faces, Open, Target, TargetDistance};

use ground::Ground;
use piece::Piece;

use super::claim::UpperBound;
use super::gap::{Bounded, Gap};
use super::tensor::Jet2;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::num::parallel;
use ground::{Affine, Foot};

/// The bound may exceed the greatest distance seen by this share of it, or by this share of the tolerance.
const EXCESS: (f64, f64) = (0.03, 0.01);
/// Along the border of trimmed faces, where one place may stand for a cell, a bound below this share of the tolerance will do:
/// it may be as large as the cell, and there are as many cells as it is sharp.
const ALONE: f64 = 0.25;
/// Cells looked at beyond those that every piece begins with, at most.
const MOST_CELLS: usize = 150_000;
/// Halvings of a cell at most.
const DEPTH: usize = 48;

/// What is known of a distance between pieces.
#[derive(Clone, Copy, Debug)]
struct Nearness {
    /// No point is farther, mm.
    bound: UpperBound,
    /// The greatest distance that was seen, mm.
    seen: f64,
    /// Where it was.
    place: Vec3,
}

/// A part of a piece.
#[derive(Clone, Copy)]
struct Cell {
    piece: usize,
    box_: [Interval; 2],
    depth: usize,
    /// The foot of the middle of the cell that this one is a half of.
    near: Option<Foot>,
    /// What is known already.
    bound: f64,
}

/// What was found of a cell.
struct BoundedCell {
    bound: f64,
    seen: f64,
    place: Vec3,
    foot: Option<Foot>,
    /// How much of the bound comes from either direction.
    share: [f64; 2],
    /// Whether it passes the border of what counts: one place stands for the whole cell, or the way back is paid for.
    alone: bool,
}

/// Bounds the distance of every point of the pieces from the ground; `tolerance` (mm) says how sharp the bound should be.
fn farthest(pieces: &[Piece], ground: &Ground, tolerance: f64, control: &Control) -> Nearness {
    let whole = |(k, p): (usize, &Piece)| {
        p.cells().into_iter().map(move |box_| Cell { piece: k, box_, depth: 0, near: None, bound: f64::INFINITY })
    };
    let mut open: Vec<Cell> = pieces.iter().enumerate().flat_map(whole).collect();
    let most = open.len() + MOST_CELLS;
    let (mut bound, mut cells) = (0.0f64, 0);
    let mut out = Nearness { bound: UpperBound::UNKNOWN, seen: 0.0, place: Vec3::zeros() };
    while !open.is_empty() {
        cells += open.len();
        if cells > most || control.stopped() {
            bound = open.iter().fold(bound, |m, c| m.max(c.bound));
            break;
        }
        let far = out.seen;
        let bounded: Vec<(Cell, Option<BoundedCell>)> = parallel::map(open.iter(), |c| {
            (*c, pieces[c.piece].is_used(&c.box_).then(|| bound_cell(c, pieces, ground, far)))
        });
        for found in bounded.iter().filter_map(|l| l.1.as_ref()) {
            if found.seen > out.seen {
                (out.seen, out.place) = (found.seen, found.place);
            }
        }
        let goal = out.seen * (1.0 + EXCESS.0) + EXCESS.1 * tolerance;
        open = Vec::new();
        for (cell, found) in bounded {
            let Some(found) = found else { continue };
            let known = found.bound.min(cell.bound);
            let enough = if found.alone { goal.max(ALONE * tolerance) } else { goal };
            if known <= enough || cell.depth == DEPTH {
                bound = bound.max(known);
                continue;
            }
            let d = usize::from(found.share[1] > found.share[0]);
            let m = cell.box_[d].mid();
            for k in 0..2 {
                let mut box_ = cell.box_;
                box_[d] = if k == 0 { Interval { hi: m, ..box_[d] } } else { Interval { lo: m, ..box_[d] } };
                open.push(Cell { box_, depth: cell.depth + 1, near: found.foot, bound: known, ..cell });
            }
        }
    }
    if !pieces.is_empty() {
        out.bound = UpperBound::shown(bound);
    }
    out
}

fn bound_cell(cell: &Cell, pieces: &[Piece], ground: &Ground, far: f64) -> BoundedCell {
    let piece = &pieces[cell.piece];
    let middle = cell.box_.map(Interval::mid);
    let place = piece.point(middle);
    let nothing = BoundedCell { bound: f64::INFINITY, seen: 0.0, place, foot: None, share: [1.0, 0.0], alone: false };
    let Some(foot) = ground.foot(&place, cell.near.as_ref().or(piece.hint()), far) else { return nothing };
    let (x, y) = (cell.box_[0] - Interval::point(middle[0]), cell.box_[1] - Interval::point(middle[1]));
    let (over, middle_of) = (piece.over(&cell.box_), piece.at(middle));
    let by_map = mapped(cell, &foot, piece, ground, [&over, &middle_of]);
    let by_place = || {
        let (there, paid) = ground.alone(&foot)?;
        let (none, face) = ([Interval::ZERO; 2], ground.over(foot.of, &there));
        let gap = |piece: &Jet2<3>| Gap::linear(&face, [&none, &none], piece);
        let found = gap(&over).bounded(&gap(&middle_of), [x, y], false);
        Some(Bounded { bound: (Interval::point(found.bound) + Interval::point(paid)).hi, ..found })
    };
    let (bounded, alone) = match by_map {
        Some((bounded, false)) => (bounded, false),
        Some((bounded, true)) => (by_place().filter(|p| p.bound < bounded.bound).unwrap_or(bounded), true),
        None => match by_place() {
            Some(place) => (place, true),
            None => return BoundedCell { foot: Some(foot), alone: true, ..nothing },
        },
    };
    let seen = if piece.holds(middle) { foot.distance } else { 0.0 };
    // What is no number is no bound.
    let bound = if bounded.bound >= 0.0 { bounded.bound } else { f64::INFINITY };
    BoundedCell { bound, seen, place, foot: Some(foot), share: bounded.share, alone }
}

/// The bound by a linear map from the cell about a foot, and whether it passes the border of what counts; `None` where nothing
/// is known of its image.
fn mapped(
    cell: &Cell,
    foot: &Foot,
    piece: &Piece,
    ground: &Ground,
    [over, at]: [&Jet2<3>; 2],
) -> Option<(Bounded, bool)> {
    let middle = cell.box_.map(Interval::mid);
    let start = match foot.border {
        Some(_) => ground.on(foot.of, &piece.point(middle), foot.at),
        None => foot.at,
    };
    let half = cell.box_.map(|x| 0.5 * (x.hi - x.lo));
    // Slopes of the map from the feet of the sides' middles.
    let side = |d: usize, sign: f64| {
        let mut at = middle;
        at[d] += sign * half[d];
        ground.on(foot.of, &piece.point(at), start)
    };
    let slope = |d: usize| {
        let (p, q) = (side(d, -1.0), side(d, 1.0));
        let width = 2.0 * half[d];
        if width > 0.0 {
            [(q[0] - p[0]) / width, (q[1] - p[1]) / width]
        } else {
            [0.0; 2]
        }
    };
    let map = ground.kept(foot.of, Affine { at: start, slopes: [slope(0), slope(1)], half });
    let (x, y) = (cell.box_[0] - Interval::point(middle[0]), cell.box_[1] - Interval::point(middle[1]));
    let image = map.image([x, y]);
    let inside = foot.border.is_none() && ground.contains(foot.of, &image);
    let aside = if inside {
        0.0
    } else {
        let corners: Vec<[f64; 2]> =
            piece.corners(&cell.box_).into_iter().map(|c| [c[0] - middle[0], c[1] - middle[1]]).collect();
        ground.beside(foot.of, &map, &image, &corners)?
    };
    let there = ground.over(foot.of, &image);
    let [du, dv] = map.slopes.map(|s| s.map(Interval::point));
    let gap = Gap::linear(&there, [&du, &dv], over);
    let first = Gap::linear(&ground.at(foot.of, &map.at), [&du, &dv], at);
    let found = gap.bounded(&first, [x, y], ground.creased(foot.of, &image));
    let paid = Interval::point(ground.beyond(foot.of, &map, [x, y], &there)) + Interval::point(aside);
    Some((Bounded { bound: (Interval::point(found.bound) + paid).hi, ..found }, !inside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::cloud::Cloud;
    use crate::geom::Frame;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use std::slice;

    fn cylinder(radius: f64, turn: f64, height: f64) -> Surface {
        SupportSurface::Cylinder { frame: Frame::world(), radius }.to_spline((0.0, turn), (0.0, height)).expect("one").0
    }

    fn plane(corner: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Surface {
        let knots = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let [o, x, y] = [corner, x, y].map(Vec3::from);
        Surface::new(knots(), knots(), &[o, o + y, o + x, o + x + y], None).expect("a plane")
    }

    fn from(pieces: &[Surface], ground: &[&Surface]) -> Nearness {
        let pieces: Vec<Piece> = pieces.iter().map(|s| Piece::surface(s, [0.0; 3], &[])).collect();
        let ground = Ground::surfaces(ground.to_vec(), [0.0; 3]);
        farthest(&pieces, &ground, 1.0, &Control::default())
    }

    fn is_near(n: &Nearness, distance: f64) {
        let bound = n.bound.value();
        assert!(bound >= distance * (1.0 - 1e-12) && bound <= 1.04 * distance + 0.011, "{n:?} {distance}");
    }

    #[test]
    fn cylinders_are_as_far_apart_as_their_radii() {
        let (inner, outer) = (cylinder(100.0, 2.0, 80.0), cylinder(103.0, 2.0, 80.0));
        is_near(&from(slice::from_ref(&inner), &[&outer]), 3.0);
        is_near(&from(&[outer], &[&inner]), 3.0);
        is_near(&from(slice::from_ref(&inner), &[&inner]), 0.0);
    }

    #[test]
    fn what_reaches_beyond_counts() {
        // A plane 50 wide, 2 above another that ends 10 before it.
        let above = plane([0.0, 0.0, 2.0], [50.0, 0.0, 0.0], [0.0, 30.0, 0.0]);
        let below = plane([0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0]);
        is_near(&from(slice::from_ref(&above), &[&below]), 104f64.sqrt());
        is_near(&from(slice::from_ref(&below), &[&above]), 2.0);
        // Another piece goes on there.
        let rest = plane([40.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 30.0, 0.0]);
        is_near(&from(&[above], &[&below, &rest]), 2.0);
    }

    #[test]
    fn only_what_is_inside_the_trim_counts() {
        let above = plane([0.0, 0.0, 2.0], [50.0, 0.0, 0.0], [0.0, 30.0, 0.0]);
        let below = plane([0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0]);
        let trim = vec![vec![[0.0, 0.0], [0.8, 0.0], [0.8, 1.0], [0.0, 1.0]]];
        let piece = [Piece::surface(&above, [0.0; 3], &trim)];
        let ground = Ground::surfaces(vec![&below], [0.0; 3]);
        is_near(&farthest(&piece, &ground, 1.0, &Control::default()), 2.0);
    }

    #[test]
    fn meshes_are_bounded_both_ways() {
        // A fine mesh of a cylinder of radius 100.
        let (n, m) = (40u32, 6u32);
        let mut cloud = Cloud::default();
        for i in 0..=n {
            for j in 0..=m {
                let a = 0.05 * f64::from(i);
                cloud.points.push(Vec3::new(100.0 * a.cos(), 100.0 * a.sin(), 12.0 * f64::from(j)));
                if i < n && j < m {
                    let k = i * (m + 1) + j;
                    cloud.triangles.extend([[k, k + m + 1, k + 1], [k + m + 1, k + m + 2, k + 1]]);
                }
            }
        }
        let outer = cylinder(103.0, 2.0, 72.0);
        let mesh = Ground::mesh(&cloud, [0.0; 3]).expect("triangles");
        let pieces = [Piece::surface(&outer, [0.0; 3], &[])];
        let sagitta = 100.0 * (1.0 - 0.025f64.cos());
        let there = farthest(&pieces, &mesh, 1.0, &Control::default());
        let bound = there.bound.value();
        assert!(bound >= 3.0 && bound <= 1.05 * (3.0 + sagitta) + 0.011, "{there:?}");
        let triangles: Vec<Piece> = cloud
            .triangles
            .iter()
            .map(|t| Piece::triangle(t.map(|i| cloud.points[i as usize]), [0.0; 3], None))
            .collect();
        let ground = Ground::surfaces(vec![&outer], [0.0; 3]);
        is_near(&farthest(&triangles, &ground, 1.0, &Control::default()), 3.0 + sagitta);
    }

    #[test]
    fn stopped_early_it_knows_what_it_has_seen_and_nothing_of_nothing() {
        let (inner, outer) = (cylinder(100.0, 2.0, 80.0), cylinder(103.0, 2.0, 80.0));
        let pieces = [Piece::surface(&inner, [0.0; 3], &[])];
        let ground = Ground::surfaces(vec![&outer], [0.0; 3]);
        let control = Control::default();
        control.cancel();
        assert_eq!(farthest(&pieces, &ground, 1.0, &control).bound, UpperBound::UNKNOWN);
        assert_eq!(farthest(&[], &ground, 1.0, &Control::default()).bound, UpperBound::UNKNOWN);
    }
}
