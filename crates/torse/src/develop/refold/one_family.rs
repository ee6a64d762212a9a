//! Parts that bend about one family of rulings: the family between the lines that are drawn, and the turn of the sheet
//! along it.
//!
//! *Method*. Between two lines family and turn are those of `develop::between`; the table says how far the sheet has turned at
//! every line. Rulings are laid so closely that the sheet between two of them may be exactly a plane, a circular cylinder or a
//! circular cone. More: the page on refolding in `docs/algorithms`.

use super::drawn::FlatPart;
use super::family::Family;
use super::leaf::{Leaf, Refolded};
use super::lines::{check, order, whole_lines, Whole};
use super::skin::skin;
use super::RefoldError;
use crate::geom::polygon::bounds;
use crate::geom::Vec2;
use crate::torse::ribbon::pose::{Pose, Rates};
use crate::torse::ribbon::{Ribbon, Span};

/// Turn, of sheet and rulings together (rad), from one ruling laid to the next: their frames differ from the family by the
/// cube of it.
const STEP: f64 = 2e-3;
/// Rulings laid between two lines at least and at most.
const BETWEEN: (f64, f64) = (8.0, 400.0);
/// Distance (share of the part's size) of a line that is added where the outermost one does not tell how the sheet goes on.
const BESIDE: f64 = 0.01;
/// Rulings over the size of a part beyond such lines.
const PARALLELS: f64 = 512.0;
/// Share of the part's size within which points from which ways are counted are one.
const ONE_POINT: f64 = 1e-9;
/// Intervals by which the family may go on beyond the first and last line.
const BEYOND: f64 = 24.0;

/// Bends a part back about one family of rulings, in the order of its lines. A part without lines is plane.
///
/// # Errors
/// Outlines that cross themselves; lines that cross inside the part or do not run through it.
pub fn refold(part: &FlatPart) -> Result<Refolded, RefoldError> {
    part.check()?;
    let lines = whole_lines(part);
    if lines.is_empty() {
        return Ok(plane(part));
    }
    let method = if lines.iter().all(|l| l.fold) { "folds" } else { "turns and radii of the bend lines" };
    let (ribbon, disagreement) = rulings(part, lines)?;
    let ribbon = match &part.fibre {
        Some(fibre) => skin(ribbon, fibre),
        None => ribbon,
    };
    let leaf = Leaf::new(ribbon, part.loops.clone());
    Ok(Refolded { leaves: vec![leaf], disagreement, method })
}

/// Rulings laid close over a part with at least one line, and the largest turn (rad) by which the table differs from its radii.
///
/// # Errors
/// Lines that cross inside the part or do not run through it.
pub(super) fn rulings(part: &FlatPart, mut lines: Vec<Whole>) -> Result<(Ribbon, f64), RefoldError> {
    order(&mut lines);
    check(part, &lines)?;
    let single = lines.len() == 1;
    let beside = BESIDE * part.size();
    let added = [single || lines[0].joins(), single || lines[lines.len() - 1].joins()];
    if added[0] {
        let before = lines[0].moved(-beside);
        lines.insert(0, before);
    }
    if added[1] {
        let behind = lines[lines.len() - 1].moved(beside);
        lines.push(behind);
    }
    let family = Family::through(part, &lines);
    let ribbon = family.ribbon(part, &lines, added);
    let disagreement = family.stretches.iter().map(|s| s.disagreement()).fold(0.0, f64::max);
    Ok((ribbon, disagreement))
}

/// A part that is not bent.
fn plane(part: &FlatPart) -> Refolded {
    let leaf = Leaf::new(plane_ribbon(&part.loops, Pose::flat(Vec2::zeros(), Vec2::x())), part.loops.clone());
    Refolded { leaves: vec![leaf], disagreement: 0.0, method: "plane" }
}

/// The rulings of a plane region; `frame` is where the frame of the drawing is in space.
pub(super) fn plane_ribbon(loops: &[Vec<Vec2>], frame: Pose) -> Ribbon {
    let (lo, hi) = bounds(loops);
    let flat = Pose::flat(lo, Vec2::x());
    let space = Pose { axes: frame.axes, at: frame.point(lo.x, lo.y) };
    let step = Rates { across: hi.y - lo.y, ..Rates::default() };
    Ribbon { spans: vec![Span { flat, space, in_plane: step, in_space: step, reach: [0.0, hi.x - lo.x] }] }
}

impl Family {
    /// Rulings laid close, over the whole part.
    fn ribbon(&self, part: &FlatPart, lines: &[Whole], added: [bool; 2]) -> Ribbon {
        let last = self.last();
        let counts: Vec<f64> = (0..self.stretches.len()).map(|k| self.count(k)).collect();
        let step = |k: usize, added: bool| if added { 1.0 / (PARALLELS * BESIDE) } else { 1.0 / counts[k] };
        let steps = [-step(0, added[0]), step(counts.len() - 1, added[1])];
        let most = |k: usize, added: bool| if added { PARALLELS } else { BEYOND * counts[k] } as usize;
        let mut before = self.beyond(part, 0.0, steps[0], (most(0, added[0]), self.reach[0]));
        before.reverse();
        let mut places = before;
        for (k, l) in lines.iter().enumerate().take(lines.len() - 1) {
            let mut like = l.reach.map(|v| v + l.way.dot(&(l.at - self.origin)));
            let n = counts[k] as usize;
            for i in 0..n {
                let t = k as f64 + i as f64 / n as f64;
                like = self.reach_at(part, t, like).unwrap_or(like);
                places.push((t, like));
            }
        }
        places.push((last, self.reach[1]));
        places.extend(self.beyond(part, last, steps[1], (most(counts.len() - 1, added[1]), self.reach[1])));
        self.laid(part, lines, &places)
    }

    /// Rulings to be laid from a line to the next.
    fn count(&self, k: usize) -> f64 {
        let [a, b] = [0.0, 1.0].map(|x| self.stretches[k].ruling(x).0);
        let turn = self.stretches[k].turn(0.0, 1.0).abs() + a.ruling().angle(&b.ruling());
        (turn / STEP).ceil().clamp(BETWEEN.0, BETWEEN.1)
    }

    /// Places beyond an end, until no ruling meets the part any more.
    fn beyond(
        &self,
        part: &FlatPart,
        from: f64,
        step: f64,
        (most, mut like): (usize, [f64; 2]),
    ) -> Vec<(f64, [f64; 2])> {
        let mut out = Vec::new();
        for k in 1..=most {
            let t = from + step * k as f64;
            let found = self.reach_at(part, t, like);
            let regular = self.is_regular(part, t, like);
            like = found.unwrap_or(like);
            out.push((t, like));
            if found.is_none() || !regular {
                break;
            }
        }
        out
    }

    /// The ribbon over given places, with the folds of lines.
    fn laid(&self, part: &FlatPart, lines: &[Whole], places: &[(f64, [f64; 2])]) -> Ribbon {
        let mut spans = Vec::with_capacity(places.len());
        let mut flat = self.ruling(places[0].0).0;
        let mut space = flat;
        for w in places.windows(2) {
            let (a, b) = (w[0].0, w[1].0);
            let at = |l: usize| (l as f64) >= a && (l as f64) < b;
            let fold: f64 = lines
                .iter()
                .enumerate()
                .filter(|(l, w)| w.fold && at(*l))
                .map(|(_, w)| w.turned[1] - w.turned[0])
                .sum();
            space = space.moved(&Rates { turn: fold, ..Rates::default() }, 1.0);
            // Rulings that meet in a point of the outline are laid about it: they stay straight through it.
            let centre = self.centre(0.5 * (a + b));
            let way = |pose: &Pose| pose.ruling().xy().dot(&(centre - pose.at.xy()));
            let slid = |pose: &Pose, by: f64| Pose { at: pose.point(by, 0.0), ..*pose };
            let start = way(&flat);
            // Ways along rulings are those of the frame: it slides along one where they are counted from another point.
            if start.abs() > ONE_POINT * part.size() {
                let slide = Rates { along: start, ..Rates::default() };
                let foot = flat.ruling().xy().dot(&(self.origin - flat.at.xy()));
                let reach = w[0].1.map(|v| v + foot);
                spans.push(Span { flat, space, in_plane: slide, in_space: slide, reach });
                (flat, space) = (slid(&flat, start), slid(&space, start));
            }
            let next = self.ruling(b).0;
            let next = slid(&next, way(&next));
            let in_space = self.motion([a, b], [&flat, &next]);
            let in_plane = Rates { turn: 0.0, ..in_space };
            // Ways are from the foot of the origin until here.
            let foot = flat.ruling().xy().dot(&(self.origin - flat.at.xy()));
            spans.push(Span { flat, space, in_plane, in_space, reach: w[0].1.map(|v| v + foot) });
            space = space.moved(&in_space, 1.0);
            flat = next;
        }
        Ribbon { spans }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::refold::drawn::BendLine;
    use crate::geom::Vec3;
    use crate::patchwork::pattern::Bend;
    use crate::patchwork::pattern::BendSense;

    /// A sector of a ring between two radii with `count` lines at equal turns: a piece of a cone of half angle `alpha`, or
    /// with `alpha` = 0 a rectangle that bends to a cylinder of radius 100.
    fn part(alpha: f64, count: usize) -> (FlatPart, f64) {
        let turn = 2.0_f64;
        let at = |s: f64, r: f64| {
            if alpha == 0.0 {
                Vec2::new(100.0 * turn * s, r - 100.0)
            } else {
                let a = turn * alpha.tan() * s;
                Vec2::new(a.cos(), a.sin()) * r
            }
        };
        let radius = |r: f64| if alpha == 0.0 { 100.0 } else { r * alpha.tan() };
        let n = 400;
        let side = |r: f64| (0..=n).map(|k| at(k as f64 / n as f64, r)).collect::<Vec<_>>();
        let mut outline = side(if alpha == 0.0 { 100.0 } else { 200.0 });
        outline.extend(side(if alpha == 0.0 { 200.0 } else { 100.0 }).into_iter().rev());
        if crate::geom::polygon::area(&outline) < 0.0 {
            outline.reverse();
        }
        let line = |k: usize| {
            let s = (k as f64 + 0.5) / count as f64;
            let bend = Bend::of(BendSense::Up, turn / count as f64, [radius(100.0), radius(200.0)]);
            BendLine { ends: [at(s, 100.0), at(s, 200.0)], bend: Bend { turned: turn * s, ..bend } }
        };
        let lines = (0..count).map(line).collect();
        (FlatPart { joints: vec![outline.clone()], loops: vec![outline], lines, ..FlatPart::default() }, turn)
    }

    #[test]
    fn a_rectangle_becomes_a_cylinder() {
        for count in [1, 2, 3, 12] {
            let (flat, turn) = part(0.0, count);
            let back = refold(&flat).expect("a part");
            let place = |x: f64, y: f64| back.frame(&back.locate(&Vec2::new(x, y)).expect("a place")).0;
            for x in [0.0, 30.0, 111.0, 200.0] {
                // The chord of the arc between two points.
                let chord = (place(x, 20.0) - place(3.0, 20.0)).norm();
                let wanted = 200.0 * (0.5 * (x - 3.0_f64).abs() / 100.0).sin();
                assert!((chord - wanted).abs() < 1e-6, "{count} {x}: {chord} {wanted}");
            }
            // Both sides come up towards the eye.
            let (middle, end) = (back.locate(&Vec2::new(100.0, 50.0)), back.locate(&Vec2::new(199.0, 50.0)));
            let (m, normal) = back.frame(&middle.expect("a place"));
            assert!((back.frame(&end.expect("a place")).0 - m).dot(&normal.normal()) > 10.0);
            assert!(turn > 0.0);
        }
    }

    #[test]
    fn a_sector_becomes_a_cone() {
        let alpha = 0.5_f64;
        let (flat, turn) = part(alpha, 16);
        let back = refold(&flat).expect("a part");
        let full = turn * alpha.tan();
        let place = |s: f64, r: f64| {
            let a = full * s;
            back.frame(&back.locate(&(Vec2::new(a.cos(), a.sin()) * r)).expect("a place")).0
        };
        // Around the axis by the flat angle over the sine of the half angle.
        let around = full / alpha.sin();
        for (s, r) in [(0.0, 120.0), (0.4, 150.0), (1.0, 199.0)] {
            let (a, b): (Vec3, Vec3) = (place(s, r), place(0.13, r));
            let wanted = 2.0 * r * alpha.sin() * (0.5 * around * (s - 0.13_f64).abs()).sin();
            assert!(((a - b).norm() - wanted).abs() < 1e-4, "{s}: {} {wanted}", (a - b).norm());
        }
    }

    /// A sector of far more than half a turn that ends a hair before its tip, which lies inside it: no ruling goes on behind the tip,
    /// and both sides of the slit come together.
    #[test]
    fn a_sector_up_to_its_tip_closes() {
        let (sector, radius, hair) = (5.4_f64, 200.0, 2e-3);
        let half_angle = (sector / std::f64::consts::TAU).asin();
        let turn = std::f64::consts::TAU * half_angle.cos();
        let at = |a: f64, r: f64| Vec2::new(a.cos(), a.sin()) * r;
        let mut outline: Vec<Vec2> = (0..=400).map(|k| at(sector * f64::from(k) / 400.0, radius)).collect();
        outline.extend([at(sector, hair), at(0.0, hair)]);
        let count = 24;
        let line = |k: usize| {
            let s = (k as f64 + 0.5) / count as f64;
            let bend = Bend::of(BendSense::Up, turn / count as f64, [0.05, radius].map(|r: f64| r * half_angle.tan()));
            BendLine { ends: [at(sector * s, 0.05), at(sector * s, radius)], bend: Bend { turned: turn * s, ..bend } }
        };
        let part = FlatPart {
            joints: vec![outline.clone()],
            loops: vec![outline],
            lines: (0..count).map(line).collect(),
            ..FlatPart::default()
        };
        let back = refold(&part).expect("a part");
        let place = |a: f64, r: f64| back.frame(&back.locate(&at(a, r)).expect("a place")).0;
        for r in [50.0, 150.0, radius] {
            assert!((place(0.0, r) - place(sector, r)).norm() < 1e-4, "{r}");
            let across = (place(0.0, r) - place(0.5 * sector, r)).norm();
            assert!((across - 2.0 * r * half_angle.sin()).abs() < 1e-3, "{r}: {across}");
        }
    }

    #[test]
    fn a_wrong_angle_or_sense_is_another_shape() {
        let (flat, turn) = part(0.0, 12);
        let chord = |f: &FlatPart| {
            let back = refold(f).expect("a part");
            let place = |x: f64| back.frame(&back.locate(&Vec2::new(x, 50.0)).expect("a place")).0;
            (place(200.0) - place(0.0)).norm()
        };
        let right = chord(&flat);
        let mut other = flat.clone();
        for l in &mut other.lines[6..] {
            l.bend = Bend { sense: BendSense::Down, turned: 2.0 * turn * 6.0 / 12.0 - l.bend.turned, ..l.bend };
        }
        assert!(chord(&other) > right + 10.0);
        let mut sharper = flat.clone();
        for l in &mut sharper.lines {
            let radii = l.bend.radii.map(|r| r / 1.1);
            l.bend = Bend { turned: 1.1 * l.bend.turned, ..Bend::of(l.bend.sense, 1.1 * l.bend.angle, radii) };
        }
        assert!((chord(&sharper) - right).abs() > 1.0);
    }

    #[test]
    fn lines_that_cross_or_lie_outside_are_named() {
        let (mut flat, _) = part(0.0, 3);
        flat.lines[2].ends = [Vec2::new(80.0, 5.0), Vec2::new(150.0, 95.0)];
        flat.lines[1].ends = [Vec2::new(80.0, 95.0), Vec2::new(150.0, 5.0)];
        assert_eq!(refold(&flat).map(|_| ()), Err(RefoldError::Crossing { first: 2, second: 3 }));
        let (mut flat, _) = part(0.0, 3);
        flat.lines[1].ends = [Vec2::new(80.0, 195.0), Vec2::new(80.0, 300.0)];
        assert_eq!(refold(&flat).map(|_| ()), Err(RefoldError::Outside { line: 2 }));
    }

    #[test]
    fn lines_that_meet_may_be_rounded() {
        let (mut flat, _) = part(0.0, 3);
        flat.lines[2].ends = [Vec2::new(150.0, 0.0), Vec2::new(100.0, 100.0)];
        for (off, good) in [(0.001, true), (0.1, false)] {
            flat.lines[1].ends = [Vec2::new(100.0, 0.0), Vec2::new(100.0 + off, 100.0)];
            let mut lines = whole_lines(&flat);
            order(&mut lines);
            assert_eq!(check(&flat, &lines).is_ok(), good, "{off}");
        }
    }
}
