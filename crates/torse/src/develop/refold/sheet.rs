//! Sheet metal bent back: plane regions and the bends between them.
//!
//! *Method*. A bend takes up its allowance to both sides of its centre line; a rolled face takes up what lies half way to
//! the neighbouring lines. The part is cut along both edges of every zone, and the regions are put into space one after the
//! other, from the largest plane one. What is bent is the skin that is drawn: in a bend towards the eye it has the inside
//! radius, in one away from the eye that and the thickness, while the drawing has the length of the neutral fibre.

use super::course::plane_ribbon;
use super::cut::{cut, Region};
use super::drawn::{area, crossings, inside, FlatPart, SheetRow};
use super::leaf::{Leaf, Refolded};
use super::RefoldError;
use crate::geom::Vec2;
use crate::patchwork::pattern::BendSense;
use crate::torse::ribbon::pose::{Pose, Rates};
use crate::torse::ribbon::{Ribbon, Span};
use std::collections::VecDeque;

/// Share of a zone's breadth by which its edges lie inside: edges of the outline may lie on them.
const INSIDE: f64 = 1e-7;
/// Share of the size within which lines are one.
const ON_ONE_LINE: f64 = 1e-6;
/// Share of the shorter one by which a stretch of an edge and the centre line are beside each other.
const BESIDE: f64 = 0.5;
/// Regions below this share of the part's area are the seams between neighbouring zones.
const SEAM: f64 = 1e-6;

/// A bent zone: the strip between two lines that do not cross in it.
#[derive(Clone, Copy, Debug)]
struct Zone {
    /// Its first and last line: a point and a unit direction; the zone lies to the left of the first.
    edges: [(Vec2, Vec2); 2],
    /// Turn towards the eye, rad.
    turn: f64,
    /// Length of the skin over that of the drawing, across.
    stretch: f64,
}

/// A chord: a piece of a zone's edge.
#[derive(Clone, Copy, Debug)]
struct Edge {
    zone: usize,
    /// First or last edge of the zone; `None`: both, of a zone without breadth.
    last: Option<bool>,
}

/// Bends a part of sheet metal back.
///
/// # Errors
/// Outlines that cross themselves, bend lines outside the part, regions that no bend joins to the rest.
pub fn refold(part: &FlatPart) -> Result<Refolded, RefoldError> {
    part.check()?;
    let (mut zones, mut edges, mut chords) = (Vec::new(), Vec::new(), Vec::new());
    let thickness = thickness(&part.bends);
    for row in &part.bends {
        for (zone, lines) in zones_of(part, row, thickness)? {
            let index = zones.len();
            zones.push(zone);
            let sharp = (zone.edges[1].0 - zone.edges[0].0).norm() <= ON_ONE_LINE * part.size();
            let both: &[(usize, Option<bool>)] =
                if sharp { &[(0, None)] } else { &[(0, Some(false)), (1, Some(true))] };
            for (k, last) in both {
                for chord in stretches(part, &zone.edges[*k], &lines) {
                    edges.push(Edge { zone: index, last: *last });
                    chords.push(chord);
                }
            }
        }
    }
    let regions = cut(&part.loops, &chords);
    let leaves = placed(&zones, &edges, &regions)?;
    Ok(Refolded { leaves, disagreement: 0.0, method: "bends of sheet metal" })
}

/// Thickness of the sheet (mm) by the allowances of its bends; 0 where the neutral fibre is the skin itself.
pub fn thickness(bends: &[SheetRow]) -> f64 {
    let of = |b: &SheetRow| (b.allowance / b.angle - b.inside_radius) / b.k;
    // The largest allowance has the smallest relative rounding.
    let known = bends.iter().filter(|b| b.k > 0.0 && b.angle > 0.0 && of(b).is_finite());
    known.max_by(|a, b| (a.angle * a.k).total_cmp(&(b.angle * b.k))).map_or(0.0, |b| of(b).max(0.0))
}

/// A zone with its centre lines.
type Lined = (Zone, Vec<[Vec2; 2]>);

/// The zones of a bend, each with its centre lines.
fn zones_of(part: &FlatPart, row: &SheetRow, thickness: f64) -> Result<Vec<Lined>, RefoldError> {
    let mut lines: Vec<Vec<[Vec2; 2]>> = Vec::new();
    for k in row.lines.clone() {
        let l = part.lines.get(k).ok_or_else(|| {
            RefoldError::Table(format!("bend_table.csv names more lines than bends.csv has; line {} is missing", k + 1))
        })?;
        let [a, b] = l.ends;
        if !inside(&part.loops, &((a + b) * 0.5)) {
            return Err(RefoldError::Outside { line: k + 1 });
        }
        let on = |m: &Vec<[Vec2; 2]>| {
            let way = (m[0][1] - m[0][0]).normalize();
            [a, b].iter().all(|p| way.perp(&(p - m[0][0])).abs() <= ON_ONE_LINE * part.size())
        };
        match lines.iter_mut().find(|m| on(m)) {
            Some(m) => m.push(l.ends),
            None => lines.push(vec![l.ends]),
        }
    }
    let n = lines.len();
    let sign = if row.sense == BendSense::Down { -1.0 } else { 1.0 };
    let turn = sign * row.angle / n.max(1) as f64;
    let directed = |l: &[Vec2; 2], like: Vec2| {
        let way = (l[1] - l[0]).normalize();
        (l[0], if way.dot(&like) < 0.0 { -way } else { way })
    };
    let Some(first) = lines.first().map(|l| l[0][1] - l[0][0]) else { return Ok(Vec::new()) };
    let mut all: Vec<(Vec2, Vec2)> = lines.iter().map(|l| directed(&l[0], first)).collect();
    // Neighbours follow each other to the left.
    if n > 1 && all[0].1.perp(&(all[1].0 - all[0].0)) < 0.0 {
        all.iter_mut().for_each(|l| l.1 = -l.1);
    }
    let breadth = if row.allowance.is_finite() { row.allowance / n as f64 } else { 0.0 };
    let skin = row.inside_radius + if sign < 0.0 { thickness } else { 0.0 };
    // Edges of the outline may lie on the edges of a zone, which are only known as far as the table is printed.
    let hair = if n == 1 { part.printed.min(0.25 * breadth) } else { 0.5 * INSIDE * breadth };
    let narrow = breadth - 2.0 * hair;
    let stretch = if narrow > 0.0 && skin.is_finite() && thickness > 0.0 {
        (skin * row.angle / n as f64 - 2.0 * hair).max(0.0) / narrow
    } else {
        1.0
    };
    let zone = |k: usize| {
        let (at, way) = all[k];
        let left = Vec2::new(-way.y, way.x);
        let parallel = n == 1 || row.allowance.is_finite();
        let edges = if parallel {
            let half = left * (0.5 * narrow);
            [(at - half, way), (at + half, way)]
        } else {
            [k.checked_sub(1), Some(k + 1).filter(|m| *m < n)].map(|m| match m {
                Some(m) => between(&all[k], &all[m]),
                // Beyond the last line, as far as before it.
                None => {
                    let other = if k == 0 { 1 } else { k - 1 };
                    mirrored(&all[k], &between(&all[k], &all[other]))
                }
            })
        };
        Zone { edges, turn, stretch }
    };
    Ok((0..n).map(|k| (zone(k), lines[k].clone())).collect())
}

/// The line half way between two lines of one direction, a hair nearer to the first.
fn between(a: &(Vec2, Vec2), b: &(Vec2, Vec2)) -> (Vec2, Vec2) {
    let way = (a.1 * (1.0 + INSIDE) + b.1 * (1.0 - INSIDE)).normalize();
    // Through the meeting point of both, or half way where they are parallel: the mean of their equations.
    let (n, m) = (Vec2::new(-a.1.y, a.1.x), Vec2::new(-b.1.y, b.1.x));
    let sum = n * (1.0 + INSIDE) + m * (1.0 - INSIDE);
    let p = n.dot(&a.0) * (1.0 + INSIDE) + m.dot(&b.0) * (1.0 - INSIDE);
    // The point of it nearest to the first line's own.
    let at = a.0 + sum * ((p - sum.dot(&a.0)) / sum.norm_squared());
    (at, way)
}

/// A line mirrored on another one.
fn mirrored(on: &(Vec2, Vec2), line: &(Vec2, Vec2)) -> (Vec2, Vec2) {
    let flip = |v: Vec2| on.1 * (2.0 * on.1.dot(&v)) - v;
    (on.0 + flip(line.0 - on.0), flip(line.1))
}

/// The stretches of a zone's edge inside the part that lie beside its centre lines.
fn stretches(part: &FlatPart, (at, way): &(Vec2, Vec2), lines: &[[Vec2; 2]]) -> Vec<[Vec2; 2]> {
    let cuts = crossings(&part.loops, at, way);
    let beside = |a: f64, b: f64| {
        lines.iter().any(|l| {
            let [p, q] = l.map(|x| way.dot(&(x - at)));
            // A corner beside the bend may open a stretch that only begins there.
            b.min(p.max(q)) - a.max(p.min(q)) > BESIDE * (b - a).min((q - p).abs())
        })
    };
    cuts.chunks_exact(2).filter(|c| beside(c[0], c[1])).map(|c| [at + way * c[0], at + way * c[1]]).collect()
}

/// What is known of a region.
#[derive(Clone)]
enum Put {
    /// The frame of the drawing, put where this plane region is.
    Plane(Pose),
    Bent(Ribbon, [Pose; 2]),
}

/// Regions in space, from the largest plane one on.
fn placed(zones: &[Zone], edges: &[Edge], regions: &[Region]) -> Result<Vec<Leaf>, RefoldError> {
    let zone_of = |r: &Region| {
        r.chords.iter().find_map(|(c, left)| edges[*c].last.filter(|last| last != left).map(|_| edges[*c].zone))
    };
    let size = |r: &Region| r.loops.iter().map(|l| area(l)).sum::<f64>();
    let root = (0..regions.len())
        .filter(|k| zone_of(&regions[*k]).is_none())
        .max_by(|a, b| size(&regions[*a]).total_cmp(&size(&regions[*b])))
        .or((!regions.is_empty()).then_some(0));
    let mut put: Vec<Option<Put>> = vec![None; regions.len()];
    let mut open = VecDeque::new();
    let world = Pose::flat(Vec2::zeros(), Vec2::x());
    if let Some(root) = root {
        put[root] = Some(match zone_of(&regions[root]) {
            Some(z) => bent(&zones[z], world, false),
            None => Put::Plane(world),
        });
        open.push_back(root);
    }
    while let Some(k) = open.pop_front() {
        let Some(here) = put[k].clone() else { continue };
        for (c, left) in &regions[k].chords {
            let Some(beyond) = regions.iter().position(|r| r.chords.contains(&(*c, !left))) else { continue };
            if put[beyond].is_some() {
                continue;
            }
            let e = edges[*c];
            let z = &zones[e.zone];
            put[beyond] = Some(match (&here, e.last) {
                (Put::Plane(frame), None) => {
                    // A fold: to the left the sheet is turned by the whole angle, to the right it comes before that.
                    let turn = if *left { -z.turn } else { z.turn };
                    let line = Pose::flat(z.edges[0].0, z.edges[0].1);
                    Put::Plane(frame_of(&on(frame, &line).moved(&Rates { turn, ..Rates::default() }, 1.0), &line))
                }
                (Put::Plane(frame), Some(last)) => bent(z, *frame, last),
                (Put::Bent(_, ends), Some(last)) => Put::Plane(ends[usize::from(last)]),
                (Put::Bent(..), None) => continue,
            });
            open.push_back(beyond);
        }
    }
    let whole: f64 = regions.iter().map(size).sum();
    let mut out = Vec::new();
    for (r, p) in regions.iter().zip(put) {
        let small = size(r) <= SEAM * whole;
        match p {
            _ if small => {}
            None => {
                let at = r.loops[0][0];
                return Err(RefoldError::Loose { x: at.x, y: at.y });
            }
            Some(Put::Plane(frame)) => out.push(Leaf { ribbon: plane_ribbon(&r.loops, frame), loops: r.loops.clone() }),
            Some(Put::Bent(mut ribbon, _)) => {
                if let Some(s) = ribbon.spans.first_mut() {
                    let along: Vec<f64> =
                        r.loops.iter().flatten().map(|p| s.flat.ruling().xy().dot(&(p - s.flat.at.xy()))).collect();
                    s.reach =
                        along.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |b, x| [b[0].min(*x), b[1].max(*x)]);
                }
                out.push(Leaf { ribbon, loops: r.loops.clone() });
            }
        }
    }
    Ok(out)
}

/// A frame of the plane where the drawing's frame is put.
fn on(frame: &Pose, flat: &Pose) -> Pose {
    Pose { axes: frame.axes * flat.axes, at: frame.point(flat.at.x, flat.at.y) }
}

/// Where the drawing's frame is if one of its frames is known in space.
fn frame_of(space: &Pose, flat: &Pose) -> Pose {
    let axes = space.axes * flat.axes.transpose();
    Pose { axes, at: space.at - axes * flat.at }
}

/// A zone beside a plane whose frame is known, entered by its first or last edge.
fn bent(zone: &Zone, frame: Pose, by_last: bool) -> Put {
    let [(at, way), (to, other)] = zone.edges;
    let first = Pose::flat(at, way);
    // The point across, so that parallel edges need no way along.
    let last = Pose::flat(to + other * other.dot(&(at - to)), other);
    let in_plane = first.flat_rates_to(&last);
    let in_space = Rates { turn: zone.turn, across: in_plane.across * zone.stretch, ..in_plane };
    let start = if by_last { on(&frame, &last).moved(&in_space, -1.0) } else { on(&frame, &first) };
    let end = start.moved(&in_space, 1.0);
    let ribbon = Ribbon { spans: vec![Span { flat: first, space: start, in_plane, in_space, reach: [0.0; 2] }] };
    Put::Bent(ribbon, [frame_of(&start, &first), frame_of(&end, &last)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::refold::drawn::BendLine;
    use crate::patchwork::pattern::Bend;

    /// A plate 40 + bend + 60 long and 30 wide, bent about one line.
    fn bracket(sense: BendSense, angle: f64, radius: f64, thickness: f64, k: f64) -> (FlatPart, f64) {
        let breadth = (radius + k * thickness) * angle;
        let x = 40.0 + 0.5 * breadth;
        let outline =
            [(0.0, 0.0), (100.0 + breadth, 0.0), (100.0 + breadth, 30.0), (0.0, 30.0)].map(|(x, y)| Vec2::new(x, y));
        let ends = [Vec2::new(x, 0.0), Vec2::new(x, 30.0)];
        let line = BendLine { ends, bend: Bend::of(sense, angle, [radius; 2]) };
        let row = SheetRow { lines: 0..1, rolled: false, sense, angle, inside_radius: radius, allowance: breadth, k };
        let loops = vec![outline.to_vec()];
        (FlatPart { joints: loops.clone(), loops, lines: vec![line], bends: vec![row], ..FlatPart::default() }, breadth)
    }

    #[test]
    fn a_bracket_has_its_flanges_where_its_skin_has_them() {
        let (angle, radius, t, k) = (std::f64::consts::FRAC_PI_2, 3.0, 2.0, 0.4);
        for (sense, skin) in [(BendSense::Up, radius), (BendSense::Down, radius + t)] {
            let (flat, breadth) = bracket(sense, angle, radius, t, k);
            assert!((thickness(&flat.bends) - t).abs() < 1e-12);
            let back = refold(&flat).expect("a part");
            assert_eq!(back.leaves.len(), 3);
            let place = |x: f64| back.frame(&back.locate(&Vec2::new(x, 10.0)).expect("a place")).0;
            // Ends of the flanges are apart by their lengths and the radius of the skin.
            let wanted = (40.0 + skin).hypot(60.0 + skin);
            let found = (place(100.0 + breadth) - place(0.0)).norm();
            assert!((found - wanted).abs() < 1e-6, "{found} {wanted}");
        }
    }

    #[test]
    fn bends_that_leave_something_loose_or_name_no_line_are_refused() {
        let (mut flat, _) = bracket(BendSense::Up, 1.0, 3.0, 2.0, 0.4);
        flat.bends[0].lines = 0..2;
        assert!(matches!(refold(&flat), Err(RefoldError::Table(_))));
        let (mut flat, _) = bracket(BendSense::Up, 1.0, 3.0, 2.0, 0.4);
        flat.lines[0].ends = [Vec2::new(200.0, 0.0), Vec2::new(200.0, 30.0)];
        assert_eq!(refold(&flat).map(|_| ()), Err(RefoldError::Outside { line: 1 }));
    }
}
