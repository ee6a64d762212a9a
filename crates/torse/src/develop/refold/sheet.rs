//! Sheet metal bent back: plane regions and the bends between them.
//!
//! *Method*. A bend takes up its allowance to both sides of its centre line; a rolled face takes up what lies half way to
//! the neighbouring lines. The part is cut along both edges of every zone, and the regions are put into space one after the
//! other, from the largest plane one. What is bent is the skin that is drawn: in a bend towards the eye it has the inside
//! radius, in one away from the eye that and the thickness, while the drawing has the length of the neutral fibre. Where the
//! outside of a sharp bend is drawn, the skin is longer than the drawing: both regions go on beyond the line to their edge.

use super::course::plane_ribbon;
use super::cut::{cut, Region};
use super::drawn::{area, crossings, distance, inside, FlatPart, SheetRow};
use super::leaf::{Leaf, Refolded};
use super::RefoldError;
use crate::geom::Vec2;
use crate::patchwork::pattern::BendSense;
use crate::torse::ribbon::pose::{Pose, Rates};
use crate::torse::ribbon::{Ribbon, Span};
use std::collections::VecDeque;

/// Share of the size within which lines are one.
const ON_ONE_LINE: f64 = 1e-6;
/// Share of the size within which lines of a fan meet on the outline.
const BESIDE_APEX: f64 = 1e-3;
/// Share of the shorter one by which a stretch of an edge and the centre line are beside each other.
const BESIDE: f64 = 0.5;
/// Regions below this share of the part's area, or as slim as two last digits of the table, are the seams between neighbouring
/// zones.
const SEAM: f64 = 1e-6;

/// A bent zone: strips between lines that do not cross in it, each turning alike; one for a bend, several for a rolled face.
#[derive(Clone, Debug)]
struct Zone {
    /// Its lines: a point and a unit direction; the zone lies to the left of the first and between that and the last.
    edges: Vec<(Vec2, Vec2)>,
    /// Places on the centre lines; none of a zone without breadth.
    inner: Vec<Vec2>,
    /// Turn of every strip towards the eye, rad.
    turn: f64,
    /// Length of the skin over that of the drawing, across.
    stretch: f64,
    /// Way (mm) by which the regions beside a line go on beyond it, to their common edge.
    beyond: f64,
}

/// A chord: a piece of a zone's edge.
#[derive(Clone, Copy, Debug)]
struct Edge {
    zone: usize,
    /// First or last edge of the zone; `None`: both, of a zone without breadth.
    last: Option<bool>,
    /// The chord.
    ends: [Vec2; 2],
}

/// Bends a part of sheet metal back.
///
/// # Errors
/// Outlines that cross themselves, bend lines outside the part, regions that no bend joins to the rest.
pub fn refold(part: &FlatPart) -> Result<Refolded, RefoldError> {
    part.check_slits()?;
    let (mut zones, mut edges, mut chords) = (Vec::new(), Vec::new(), Vec::new());
    let thickness = if part.thickness > 0.0 { part.thickness } else { thickness(&part.bends) };
    for row in &part.bends {
        let Some((mut zone, lines)) = zone_of(part, row, thickness)? else { continue };
        let last = zone.edges.len() - 1;
        if !row.allowance.is_finite() && part.bends.len() > 1 && is_fan(part, &zone) {
            return Err(RefoldError::Fan { line: row.lines.start + 1 });
        }
        let sharp = last == 1 && (zone.edges[1].0 - zone.edges[0].0).norm() <= ON_ONE_LINE * part.size();
        let both = [(0, (!sharp).then_some(false), 0), (last, Some(true), lines.len() - 1)];
        for (k, last, beside) in &both[..if sharp { 1 } else { 2 }] {
            for chord in stretches(part, &zone.edges[*k], (&lines[*beside], sharp)) {
                edges.push(Edge { zone: zones.len(), last: *last, ends: chord });
                chords.push(chord);
            }
        }
        if !sharp {
            zone.inner = lines.iter().flatten().map(|l| (l[0] + l[1]) * 0.5).collect();
        }
        zones.push(zone);
    }
    let regions = cut(&part.loops, &chords);
    let leaves = placed((&zones, &edges, &regions), part.printed)?;
    Ok(Refolded { leaves, disagreement: 0.0, method: "bends of sheet metal" })
}

/// Thickness of the sheet (mm) by the allowances of its bends; 0 where the neutral fibre is the skin itself.
pub fn thickness(bends: &[SheetRow]) -> f64 {
    let of = |b: &SheetRow| match b.allowance < 0.0 {
        true => b.allowance / (b.k * b.angle - 2.0 * (0.5 * b.angle).tan()),
        false => (b.allowance / b.angle - b.inside_radius) / b.k,
    };
    // The largest allowance has the smallest relative rounding.
    let known = bends.iter().filter(|b| b.k > 0.0 && b.angle > 0.0 && of(b).is_finite());
    known.max_by(|a, b| (a.angle * a.k).total_cmp(&(b.angle * b.k))).map_or(0.0, |b| of(b).max(0.0))
}

/// A zone with its centre lines, in parts where holes lie between.
type Lined = (Zone, Vec<Vec<[Vec2; 2]>>);

/// The zone of a bend with its centre lines.
fn zone_of(part: &FlatPart, row: &SheetRow, thickness: f64) -> Result<Option<Lined>, RefoldError> {
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
    let Some(first) = lines.first().map(|l| l[0][1] - l[0][0]) else { return Ok(None) };
    let mut all: Vec<(Vec2, Vec2)> = lines.iter().map(|l| directed(&l[0], first)).collect();
    // Neighbours follow each other to the left.
    if n > 1 && all[0].1.perp(&(all[1].0 - all[0].0)) < 0.0 {
        all.iter_mut().for_each(|l| l.1 = -l.1);
    }
    let breadth = if row.allowance.is_finite() { row.allowance.max(0.0) / n as f64 } else { 0.0 };
    let beyond = 0.5 * (-row.allowance).max(0.0);
    let skin = row.inside_radius + if sign < 0.0 { thickness } else { 0.0 };
    // Edges of the outline may lie on the edges of a zone, which are only known as far as the table is printed.
    let hair = part.printed.min(0.25 * breadth);
    let stretch = if breadth > 0.0 && skin.is_finite() && thickness > 0.0 {
        let narrow = row.allowance - 2.0 * hair;
        (skin * row.angle - 2.0 * hair).max(0.0) / narrow
    } else {
        1.0
    };
    let beside = |(at, way): (Vec2, Vec2), by: f64| (at + Vec2::new(-way.y, way.x) * by, way);
    let half = 0.5 * breadth - hair;
    let edges: Vec<(Vec2, Vec2)> = if n == 1 || row.allowance.is_finite() {
        let inner = (1..n).map(|k| beside(all[k], -0.5 * breadth));
        std::iter::once(beside(all[0], -half)).chain(inner).chain([beside(all[n - 1], half)]).collect()
    } else {
        // Half way between lines; beyond the outermost ones as far as before them.
        let inner: Vec<(Vec2, Vec2)> = all.windows(2).map(|w| between(&w[0], &w[1])).collect();
        let outer = [mirrored(&all[0], &inner[0]), mirrored(&all[n - 1], &inner[n - 2])];
        std::iter::once(outer[0]).chain(inner).chain([outer[1]]).collect()
    };
    Ok(Some((Zone { edges, inner: Vec::new(), turn, stretch, beyond }, lines)))
}

/// Whether the first and last line of a zone meet on the outline.
fn is_fan(part: &FlatPart, zone: &Zone) -> bool {
    let ((p, e), (q, f)) = (zone.edges[0], zone.edges[zone.edges.len() - 1]);
    let meet = p + e * ((q - p).perp(&f) / e.perp(&f));
    meet.iter().all(|x| x.is_finite()) && distance(&part.loops, &meet) <= BESIDE_APEX * part.size()
}

/// The line half way between two lines of one direction.
fn between(a: &(Vec2, Vec2), b: &(Vec2, Vec2)) -> (Vec2, Vec2) {
    let way = (a.1 + b.1).normalize();
    // Through the meeting point of both, or half way where they are parallel: the mean of their equations.
    let (n, m) = (Vec2::new(-a.1.y, a.1.x), Vec2::new(-b.1.y, b.1.x));
    let sum = n + m;
    let p = n.dot(&a.0) + m.dot(&b.0);
    // The point of it nearest to the first line's own.
    let at = a.0 + sum * ((p - sum.dot(&a.0)) / sum.norm_squared());
    (at, way)
}

/// A line mirrored on another one.
fn mirrored(on: &(Vec2, Vec2), line: &(Vec2, Vec2)) -> (Vec2, Vec2) {
    let flip = |v: Vec2| on.1 * (2.0 * on.1.dot(&v)) - v;
    (on.0 + flip(line.0 - on.0), flip(line.1))
}

/// The stretches of a zone's edge inside the part that lie beside its centre lines; of a sharp one these themselves.
fn stretches(part: &FlatPart, (at, way): &(Vec2, Vec2), (lines, sharp): (&[[Vec2; 2]], bool)) -> Vec<[Vec2; 2]> {
    // Sides of neighbouring regions may go on along a fold, so that crossings do not tell where it ends.
    let near = ON_ONE_LINE * part.size() + part.printed;
    if sharp && lines.iter().flatten().all(|p| distance(&part.loops, p) <= near) {
        return lines.iter().map(|l| if way.dot(&(l[1] - l[0])) < 0.0 { [l[1], l[0]] } else { *l }).collect();
    }
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
fn placed((zones, edges, regions): (&[Zone], &[Edge], &[Region]), printed: f64) -> Result<Vec<Leaf>, RefoldError> {
    let zone_of = |r: &Region| {
        let by_chord = |(c, left): &(usize, bool)| edges[*c].last.filter(|last| last != left).map(|_| edges[*c].zone);
        // A part that is bent from end to end has no chord at all.
        let holds = |z: &Zone| z.inner.iter().any(|q| inside(&r.loops, q));
        r.chords.iter().find_map(by_chord).or_else(|| zones.iter().position(holds))
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
                    let line = |side: bool| Pose::flat(z.edges[0].0 + z.reach(side), z.edges[0].1);
                    let edge = on(frame, &line(*left)).moved(&Rates { turn, ..Rates::default() }, 1.0);
                    Put::Plane(frame_of(&edge, &line(!left)))
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
        let around: f64 =
            r.loops.iter().flat_map(|l| l.iter().zip(l.iter().cycle().skip(1))).map(|(p, q)| (q - p).norm()).sum();
        let small = size(r) <= (SEAM * whole).max(printed * around);
        match p {
            _ if small => {}
            None => {
                let at = r.loops[0][0];
                return Err(RefoldError::Loose { x: at.x, y: at.y });
            }
            Some(Put::Plane(frame)) => {
                let loops = without_tips(to_edges(zones, edges, r), printed);
                out.push(Leaf { ribbon: plane_ribbon(&loops, frame), loops });
            }
            Some(Put::Bent(mut ribbon, _)) => {
                for s in &mut ribbon.spans {
                    let middle = s.flat.moved(&s.in_plane, 0.5);
                    let cuts = crossings(&r.loops, &middle.at.xy(), &middle.ruling().xy());
                    let far = |p: &Vec2| s.flat.ruling().xy().dot(&(p - s.flat.at.xy()));
                    let along = if cuts.is_empty() { r.loops.iter().flatten().map(far).collect() } else { cuts };
                    s.reach =
                        along.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |b, x| [b[0].min(*x), b[1].max(*x)]);
                }
                out.push(Leaf { ribbon, loops: r.loops.clone() });
            }
        }
    }
    Ok(out)
}

impl Zone {
    /// Way by which a region beside the first edge, to its left or its right, goes on beyond it.
    fn reach(&self, left: bool) -> Vec2 {
        let way = self.edges[0].1;
        Vec2::new(-way.y, way.x) * if left { -self.beyond } else { self.beyond }
    }
}

/// The loops of a plane region, as far as the skin goes beyond its bend lines.
fn to_edges(zones: &[Zone], edges: &[Edge], region: &Region) -> Vec<Vec<Vec2>> {
    let mut loops = region.loops.clone();
    for (c, left) in &region.chords {
        let (edge, zone) = (&edges[*c], &zones[edges[*c].zone]);
        let [a, b] = edge.ends;
        let (way, length) = ((b - a).normalize(), (b - a).norm());
        let near = ON_ONE_LINE * length;
        let on = |p: &Vec2| way.perp(&(p - a)).abs() <= near && (-near..=length + near).contains(&way.dot(&(p - a)));
        if zone.beyond > 0.0 {
            loops.iter_mut().flatten().filter(|p| on(p)).for_each(|p| *p += zone.reach(*left));
        }
    }
    loops
}

/// The loops of a region without what is left of a slit beside the edge of a zone, which lies inside it by the last digit of the
/// table: corners at which they run back by no more than twice that.
fn without_tips(mut loops: Vec<Vec<Vec2>>, printed: f64) -> Vec<Vec<Vec2>> {
    for l in &mut loops {
        let is_tip = |l: &[Vec2], k: usize| {
            let (before, behind) = (l[(k + l.len() - 1) % l.len()] - l[k], l[(k + 1) % l.len()] - l[k]);
            let short = before.norm().min(behind.norm());
            short <= 2.0 * printed
                && before.dot(&behind) > 0.0
                && before.angle(&behind) * short <= ON_ONE_LINE * printed
        };
        while let Some(k) = (0..l.len()).find(|k| l.len() > 3 && is_tip(l, *k)) {
            l.remove(k);
        }
    }
    loops
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
    let mut flat = vec![Pose::flat(zone.edges[0].0, zone.edges[0].1)];
    for (to, way) in &zone.edges[1..] {
        // The point across, so that parallel edges need no way along.
        let at = flat[flat.len() - 1].at.xy();
        flat.push(Pose::flat(to + way * way.dot(&(at - to)), *way));
    }
    let rates: Vec<[Rates; 2]> = (flat.windows(2))
        .map(|w| {
            let in_plane = w[0].flat_rates_to(&w[1]);
            [in_plane, Rates { turn: zone.turn, across: in_plane.across * zone.stretch, ..in_plane }]
        })
        .collect();
    let last = &flat[flat.len() - 1];
    let start = if by_last {
        rates.iter().rev().fold(on(&frame, last), |pose, [_, r]| pose.moved(r, -1.0))
    } else {
        on(&frame, &flat[0])
    };
    let (mut spans, mut space) = (Vec::with_capacity(rates.len()), start);
    for (flat, [in_plane, in_space]) in flat.iter().zip(rates) {
        spans.push(Span { flat: *flat, space, in_plane, in_space, reach: [0.0; 2] });
        space = space.moved(&in_space, 1.0);
    }
    Put::Bent(Ribbon { spans }, [frame_of(&start, &flat[0]), frame_of(&space, last)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::refold::drawn::BendLine;
    use crate::patchwork::pattern::Bend;

    /// A plate of 40 and 60 mm outside its sharp bend, 30 wide.
    fn sharp_outside(t: f64, k: f64) -> FlatPart {
        let angle = std::f64::consts::FRAC_PI_2;
        let allowance = k * t * angle - 2.0 * t;
        let x = 40.0 + 0.5 * allowance;
        let (mut flat, _) = bracket(BendSense::Down, angle, 0.0, t, k);
        flat.loops = vec![[(0.0, 0.0), (100.0 + allowance, 0.0), (100.0 + allowance, 30.0), (0.0, 30.0)]
            .map(|(x, y)| Vec2::new(x, y))
            .to_vec()];
        flat.joints.clone_from(&flat.loops);
        flat.lines[0].ends = [Vec2::new(x, 0.0), Vec2::new(x, 30.0)];
        flat.bends[0].allowance = allowance;
        flat
    }

    #[test]
    fn outside_a_sharp_bend_both_flanges_reach_to_its_edge() {
        let flat = sharp_outside(3.0, 0.44);
        assert!((thickness(&flat.bends) - 3.0).abs() < 1e-12);
        let back = refold(&flat).expect("a part");
        let place = |x: f64| back.frame(&back.locate(&Vec2::new(x, 10.0)).expect("a place")).0;
        let long = 100.0 + flat.bends[0].allowance;
        assert!(((place(long) - place(0.0)).norm() - 40.0_f64.hypot(60.0)).abs() < 1e-9);
        let areas: Vec<f64> = back.leaves.iter().map(|l| area(&l.loops[0])).collect();
        assert!((areas.iter().sum::<f64>() - 3000.0).abs() < 1e-9, "{areas:?}");
    }

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
