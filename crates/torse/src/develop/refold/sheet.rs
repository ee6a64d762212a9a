//! Sheet metal bent back: plane regions and the bends between them.
//!
//! *Method*. A bend takes up its allowance to both sides of its centre line; a rolled face without one radius lies between the
//! lines where it begins and ends. The part is cut along both edges of every zone, and the regions are put into space one after the
//! other, from the largest plane one. What is bent is the skin that is drawn: in a bend towards the eye it has the inside
//! radius, in one away from the eye that and the thickness, while the drawing has the length of the neutral fibre. Where the
//! outside of a sharp bend is drawn, the skin is longer than the drawing: both regions go on beyond the line to their edge.

use super::cut::{cut, CutRegion};
use super::drawn::FlatPart;
use super::leaf::{Leaf, Refolded};
use super::one_family::plane_ribbon;
use super::rolled::{is_rolled, rolled, Chord};
use super::zone::{round, thickness, Strip, Zone, ON_ONE_LINE};
use super::RefoldError;
use crate::geom::polygon::{area, crossings, inside};
use crate::geom::segment::same_segment;
use crate::geom::Vec2;
use crate::torse::ribbon::pose::{Pose, Rates};
use crate::torse::ribbon::{Ribbon, Span};
use std::collections::VecDeque;

/// Regions below this share of the part's area, or as slim as two last digits of the table, are the seams between neighbouring
/// zones.
const SEAM: f64 = 1e-6;

/// An end of a zone: its number, and whether it is the last edge.
type End = (usize, bool);

/// A chord between regions.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [Vec2; 2],
    /// The zones that begin or end there, to the right and to the left; planes otherwise.
    beside: [Option<End>; 2],
    /// The fold along it, and whether that is directed the other way.
    fold: Option<(usize, bool)>,
}

impl Edge {
    /// The first or last edge of a zone, which lies to the left of that or to its right.
    fn of(ends: Chord, end: End) -> Self {
        let mut beside = [None; 2];
        beside[usize::from(!end.1)] = Some(end);
        Self { ends, beside, fold: None }
    }

    /// The end of the zone on one of its sides.
    fn side(&self, left: bool) -> Option<End> {
        self.beside[usize::from(left)]
    }
}

/// The chords of a part.
struct Edges {
    all: Vec<Edge>,
    /// Ends so near to each other (mm) are one.
    near: f64,
}

impl Edges {
    /// The edge of a chord, and whether it runs the other way.
    fn of(&mut self, chord: Chord) -> (&mut Edge, bool) {
        let same = |(k, e): (usize, &Edge)| Some((k, same_segment(&e.ends, &chord, self.near)?));
        let (known, back) = self.all.iter().enumerate().find_map(same).unwrap_or_else(|| {
            self.all.push(Edge { ends: chord, beside: [None; 2], fold: None });
            (self.all.len() - 1, false)
        });
        (&mut self.all[known], back)
    }

    /// A fold.
    fn folds(&mut self, chord: Chord, zone: usize) {
        let (edge, back) = self.of(chord);
        edge.fold = Some((zone, back));
    }

    /// As [`Edge::of`], where another zone may end or a fold may lie on the same line.
    fn bounds(&mut self, chord: Chord, end: End) {
        let (edge, back) = self.of(chord);
        edge.beside[usize::from(end.1 == back)] = Some(end);
    }
}

/// Bends a part of sheet metal back.
///
/// # Errors
/// Outlines that cross themselves, bend lines outside the part, regions that no bend joins to the rest.
pub fn refold(part: &FlatPart) -> Result<Refolded, RefoldError> {
    part.check_slits()?;
    let mut zones: Vec<Zone> = Vec::new();
    let mut edges = Edges { all: Vec::new(), near: ON_ONE_LINE * part.size() };
    let mut disagreement = 0.0_f64;
    let thickness = if part.thickness > 0.0 { part.thickness } else { thickness(&part.bends) };
    for row in part.bends.iter().filter(|r| is_rolled(r)) {
        let Some(found) = rolled(part, row)? else { continue };
        disagreement = disagreement.max(found.disagreement);
        for (last, chords) in [false, true].into_iter().zip(found.chords) {
            chords.into_iter().for_each(|c| edges.bounds(c, (zones.len(), last)));
        }
        zones.push(found.zone);
    }
    for row in part.bends.iter().filter(|r| !is_rolled(r)) {
        let Some((zone, [first, last])) = round(part, row, thickness)? else { continue };
        let number = zones.len();
        if zone.inner.is_empty() {
            for c in first {
                edges.folds(c, number);
            }
        } else {
            // Edges of neighbours are as far apart as the table is printed.
            first.into_iter().for_each(|c| edges.all.push(Edge::of(c, (number, false))));
            last.into_iter().for_each(|c| edges.all.push(Edge::of(c, (number, true))));
        }
        zones.push(zone);
    }
    let chords: Vec<Chord> = edges.all.iter().map(|e| e.ends).collect();
    let regions = cut(&part.loops, &chords);
    let leaves = placed((&zones, &edges.all, &regions), part.printed)?;
    Ok(Refolded { leaves, disagreement, method: "bends of sheet metal" })
}

/// What is known of a region.
#[derive(Clone)]
enum Put {
    /// The frame of the drawing, put where this plane region is.
    Plane(Pose),
    Bent(Ribbon, [Pose; 2]),
}

/// Regions in space, from the largest plane one on.
fn placed((zones, edges, regions): (&[Zone], &[Edge], &[CutRegion]), printed: f64) -> Result<Vec<Leaf>, RefoldError> {
    let zone_of = |r: &CutRegion| {
        let by_chord = |(c, left): &(usize, bool)| edges[*c].side(*left).map(|end| end.0);
        // A part that is bent from end to end has no chord at all.
        let holds = |z: &Zone| z.inner.iter().any(|q| inside(&r.loops, q));
        r.chords.iter().find_map(by_chord).or_else(|| zones.iter().position(holds))
    };
    let size = |r: &CutRegion| r.loops.iter().map(|l| area(l)).sum::<f64>();
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
            let edge = edges[*c];
            let mut frame = match (&here, edge.side(*left)) {
                (Put::Plane(frame), _) => *frame,
                (Put::Bent(_, ends), Some((_, last))) => ends[usize::from(last)],
                (Put::Bent(..), None) => continue,
            };
            if let Some((z, back)) = edge.fold {
                frame = folded(&zones[z], &frame, *left != back);
            }
            put[beyond] = Some(match edge.side(!left) {
                Some((z, last)) => bent(&zones[z], frame, last),
                None => Put::Plane(frame),
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
                out.push(Leaf::new(plane_ribbon(&loops, frame), loops));
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
                out.push(Leaf::new(ribbon, r.loops.clone()));
            }
        }
    }
    Ok(out)
}

/// The loops of a plane region, as far as the skin goes beyond its bend lines.
fn to_edges(zones: &[Zone], edges: &[Edge], region: &CutRegion) -> Vec<Vec<Vec2>> {
    let mut loops = region.loops.clone();
    for (c, left) in &region.chords {
        let Some((zone, back)) = edges[*c].fold else { continue };
        let (zone, [a, b]) = (&zones[zone], edges[*c].ends);
        let (way, length) = ((b - a).normalize(), (b - a).norm());
        let near = ON_ONE_LINE * length;
        let on = |p: &Vec2| way.perp(&(p - a)).abs() <= near && (-near..=length + near).contains(&way.dot(&(p - a)));
        if zone.beyond > 0.0 {
            loops.iter_mut().flatten().filter(|p| on(p)).for_each(|p| *p += zone.reach(*left != back));
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

/// The frame of the drawing beyond a fold, where it is known on one side: to the left the sheet is turned by the whole angle, to the
/// right it comes before that.
fn folded(fold: &Zone, frame: &Pose, left: bool) -> Pose {
    let turn = if left { -fold.turn } else { fold.turn };
    let (at, way) = fold.edges[0];
    let line = |side: bool| Pose::flat(at + fold.reach(side), way);
    let edge = on(frame, &line(left)).moved(&Rates { turn, ..Rates::default() }, 1.0);
    frame_of(&edge, &line(!left))
}

/// A zone where the frame of the drawing is known at its first or last edge.
fn bent(zone: &Zone, frame: Pose, by_last: bool) -> Put {
    let strips = &zone.strips;
    let (Some(first), Some(end)) = (strips.first(), strips.last()) else { return Put::Plane(frame) };
    let last = end.flat.moved(&end.in_plane, 1.0);
    let start = if by_last {
        strips.iter().rev().fold(on(&frame, &last), |pose, s| pose.moved(&s.in_space, -1.0))
    } else {
        on(&frame, &first.flat)
    };
    let (mut spans, mut space) = (Vec::with_capacity(strips.len()), start);
    for Strip { flat, in_plane, in_space } in strips.iter().copied() {
        spans.push(Span { flat, space, in_plane, in_space, reach: [0.0; 2] });
        space = space.moved(&in_space, 1.0);
    }
    Put::Bent(Ribbon { spans }, [frame_of(&start, &first.flat), frame_of(&space, &last)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::refold::drawn::{BendLine, SheetRow};
    use crate::patchwork::pattern::{Bend, BendSense};

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

    /// A tab that is thinner than its sheet bends about its own skin.
    #[test]
    fn a_bend_of_a_thinner_tab_has_the_skin_of_that() {
        let (angle, radius, t, k) = (0.8, 1.0, 0.5, 0.44);
        let (flat, breadth) = bracket(BendSense::Down, angle, radius, t, k);
        // The table is printed to four digits.
        let printed = (flat.bends[0].allowance * 1e4).round() * 1e-4;
        let mut flat = FlatPart { thickness: 1.0, local: vec![1.0, 0.5, 0.0], ..flat };
        flat.bends[0].allowance = printed;
        let place = |flat: &FlatPart| {
            let back = refold(flat).expect("a part");
            let at = |x: f64| back.frame(&back.locate(&Vec2::new(x, 10.0)).expect("a place")).0;
            (at(100.0 + breadth) - at(0.0)).norm()
        };
        // From the corner of both flanges' skins: each is longer by the tangent of its half of the bend.
        let set = (radius + t) * (0.5 * angle).tan();
        let (a, b) = (40.0 + set, 60.0 + set);
        let wanted = (a * a + b * b + 2.0 * a * b * angle.cos()).sqrt();
        assert!((place(&flat) - wanted).abs() < 2e-4, "{} {wanted}", place(&flat));
        flat.local.clear();
        assert!((place(&flat) - wanted).abs() > 0.1, "without it, the skin of the sheet");
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
