//! Triangles of refolded parts.

use super::leaf::{Leaf, Refolded};
use super::RefoldError;
use crate::geom::mesh::Mesh;
use crate::geom::placement::Placement;
use crate::geom::polygon::bounds;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::triangulate::triangulate;
use crate::torse::ribbon::{Ribbon, Spot};

/// Turn (rad) from line to line of triangles, about 2°.
const TURN: f64 = 0.035;
/// Lines across one region at most.
const MOST_LINES: usize = 400;

/// Triangles and borders of a part, moved; borders are closed polylines.
///
/// # Errors
/// Outlines that cross themselves.
pub fn mesh(part: &Refolded, motion: &Placement) -> Result<(Mesh, Vec<Vec<Vec3>>), RefoldError> {
    let (mut out, mut borders) = (Mesh::default(), Vec::new());
    for leaf in &part.leaves {
        add(leaf, motion, &mut out, &mut borders)?;
    }
    Ok((out, borders))
}

fn add(leaf: &Leaf, motion: &Placement, out: &mut Mesh, borders: &mut Vec<Vec<Vec3>>) -> Result<(), RefoldError> {
    let (lo, hi) = bounds(&leaf.loops);
    let step = (hi - lo).max() / cells(&leaf.ribbon);
    let grid = |k: usize| {
        let n = ((hi[k] - lo[k]) / step).ceil().max(1.0) as usize;
        (0..=n).map(|i| lo[k] + (hi[k] - lo[k]) * i as f64 / n as f64).collect::<Vec<_>>()
    };
    let single = leaf.ribbon.spans.len() == 1;
    // One plane, cylinder or cone has lines along its rulings; the drawing's own grid serves where rulings are many.
    let spots = if single { spots(leaf) } else { Vec::new() };
    let (loops, across, along) = match ends(&spots) {
        Some([[a, b], [c, d]]) => (spots, lines(leaf, a, b), vec![c, d]),
        None if single => return Ok(()),
        None => (leaf.loops.iter().map(|l| l.iter().map(|p| [p.x, p.y]).collect()).collect(), grid(0), grid(1)),
    };
    let with_sides: Vec<(Vec<[f64; 2]>, Vec<u32>)> = loops.iter().map(|l| (l.clone(), vec![0; l.len()])).collect();
    let made = triangulate(&with_sides, &across, &along).map_err(|e| RefoldError::Table(e.to_string()))?;
    let place = |p: &[f64; 2]| match single {
        true => Some(Spot { t: p[0], v: p[1] }),
        false => leaf.ribbon.locate(&Vec2::new(p[0], p[1])),
    };
    let first = out.positions.len() as u32;
    for p in &made.vertices {
        let (x, pose) = match place(p) {
            Some(spot) => leaf.ribbon.frame(&spot),
            None => return Err(RefoldError::Loose { x: p[0], y: p[1] }),
        };
        out.positions.push(motion.point(&x));
        out.normals.push(motion.linear * pose.normal());
    }
    // The ribbon's own coordinates run across, then along: turned over against the drawing.
    out.triangles.extend(made.triangles.iter().map(|t| match single {
        true => [first + t[0], first + t[2], first + t[1]],
        false => [first + t[0], first + t[1], first + t[2]],
    }));
    let on = |q: &Vec2| leaf.ribbon.locate(q).map(|s| motion.point(&leaf.ribbon.frame(&s).0));
    borders.extend(leaf.loops.iter().map(|l| l.iter().chain(l.first()).filter_map(on).collect()));
    Ok(())
}

/// Cells of the grid over the longer side of a part: least and most.
const GRID: (f64, f64) = (16.0, 120.0);

/// Cells of the grid by how far the sheet turns in all.
fn cells(ribbon: &Ribbon) -> f64 {
    let turn: f64 = ribbon.spans.iter().map(|s| s.in_space.turn.abs()).sum();
    (turn / TURN).ceil().clamp(GRID.0, GRID.1)
}

/// The outlines of a region in the coordinates of its ribbon.
pub(crate) fn spots(leaf: &Leaf) -> Vec<Vec<[f64; 2]>> {
    let spot = |q: &Vec2| leaf.ribbon.locate(q).map(|s| [s.t, s.v]);
    leaf.loops.iter().map(|l| l.iter().filter_map(spot).collect()).collect()
}

/// Range of both coordinates; `None` where there is none.
pub fn ends(spots: &[Vec<[f64; 2]>]) -> Option<[[f64; 2]; 2]> {
    let range = |k: usize| {
        let all = spots.iter().flatten().map(|p| p[k]);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |b, x| [b[0].min(x), b[1].max(x)])
    };
    let both = [range(0), range(1)];
    both.iter().all(|[a, b]| a < b).then_some(both)
}

/// Rulings between two places, about 2° of turn apart.
pub fn lines(leaf: &Leaf, a: f64, b: f64) -> Vec<f64> {
    // Lines at equal turns, at the rulings between spans where there are many.
    let spans = &leaf.ribbon.spans;
    let mut lines = vec![a];
    if let [one] = &spans[..] {
        let count = ((one.in_space.turn.abs() * (b - a) / TURN).ceil() as usize).clamp(1, MOST_LINES);
        lines.extend((1..count).map(|k| a + (b - a) * k as f64 / count as f64));
    } else {
        let whole: f64 = spans.iter().map(|s| s.in_space.turn.abs()).sum();
        let step = TURN.max(whole / MOST_LINES as f64);
        let mut turn = 0.0;
        for (k, s) in spans.iter().enumerate() {
            turn += s.in_space.turn.abs();
            let at = k as f64 + 1.0;
            if turn >= step && at > a && at < b {
                lines.push(at);
                turn = 0.0;
            }
        }
    }
    lines.push(b);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::ribbon::pose::{Pose, Rates};
    use crate::torse::ribbon::Span;

    #[test]
    fn grids_are_as_fine_as_the_sheet_turns() {
        let of = |turn: f64| {
            let rates = Rates { turn, across: 5.0, ..Rates::default() };
            let pose = Pose::flat(Vec2::zeros(), Vec2::x());
            let span = Span { flat: pose, space: pose, in_plane: rates, in_space: rates, reach: [0.0, 1.0] };
            cells(&Ribbon { spans: vec![span; 4] })
        };
        assert_eq!([0.0, 0.3, -0.3, 5.0].map(of), [GRID.0, 35.0, 35.0, GRID.1]);
    }
}
