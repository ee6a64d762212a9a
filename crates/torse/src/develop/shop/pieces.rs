//! Pieces of one section on several faces, joined to lines where the faces meet.

use crate::geom::polygon::distance;
use crate::geom::{Vec2, Vec3};

/// A piece of a section on one face.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Index of the face within the part.
    pub panel: usize,
    /// The piece in the drawing.
    pub points: Vec<Vec2>,
    /// Both its ends in space; not numbers where they are not known.
    pub ends: [Vec3; 2],
}

/// Distances (mm) within which ends of pieces are one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// On one face.
    pub same: f64,
    /// Where two faces meet: what their borders are drawn within.
    pub edge: f64,
    /// Widest gap or overlap of faces along sharp bends in the drawing.
    pub fold: f64,
}

/// An end of a piece: its number, and whether it is the last.
type End = (usize, usize);

/// Pieces joined at their ends to lines, each end with the nearest that fits. Pieces that are drawn twice, as where a plane runs along a
/// common edge, are one.
pub(super) fn joined(pieces: Vec<Piece>, near: Near) -> Vec<Vec<Vec2>> {
    let pieces = once(pieces, near.edge);
    let place = |(k, e): End| pieces[k].points[e * (pieces[k].points.len() - 1)];
    let mut pairs: Vec<(f64, End, End)> = Vec::new();
    let ends: Vec<End> = (0..pieces.len()).flat_map(|k| [(k, 0), (k, 1)]).collect();
    for (i, a) in ends.iter().enumerate() {
        for b in ends[i + 1..].iter().filter(|b| b.0 != a.0) {
            let apart = (place(*a) - place(*b)).norm();
            let (p, q) = (&pieces[a.0], &pieces[b.0]);
            // Beside a sharp bend places of the drawing are apart that are one in space.
            let is_fold = || apart <= near.fold && (p.ends[a.1] - q.ends[b.1]).norm() <= near.edge;
            let meets = if p.panel == q.panel { apart <= near.same } else { apart <= near.edge || is_fold() };
            if meets {
                pairs.push((apart, *a, *b));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut next: Vec<[Option<End>; 2]> = vec![[None; 2]; pieces.len()];
    for (_, a, b) in pairs {
        if next[a.0][a.1].is_none() && next[b.0][b.1].is_none() {
            next[a.0][a.1] = Some(b);
            next[b.0][b.1] = Some(a);
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut out = Vec::new();
    // Lines with two ends first; what is left runs round.
    let open = ends.iter().filter(|(k, e)| next[*k][*e].is_none());
    for start in open.chain(&ends) {
        let mut line: Vec<Vec2> = Vec::new();
        let mut at = Some(*start);
        while let Some((k, e)) = at.filter(|(k, _)| !used[*k]) {
            used[k] = true;
            let mut points = pieces[k].points.clone();
            if e == 1 {
                points.reverse();
            }
            append(&mut line, points, near.edge);
            at = next[k][1 - e];
        }
        if !line.is_empty() {
            out.push(line);
        }
    }
    out
}

/// Pieces without those that lie on one of another face, from end to end within `edge` (mm); the longest come first.
fn once(mut pieces: Vec<Piece>, edge: f64) -> Vec<Piece> {
    let length = |p: &Piece| p.points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    pieces.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let mut out: Vec<Piece> = Vec::new();
    for piece in pieces {
        let is_again = |o: &Piece| {
            let sides: Vec<Vec<Vec2>> = o.points.windows(2).map(<[Vec2]>::to_vec).collect();
            let middles = piece.points.windows(2).map(|w| (w[0] + w[1]) * 0.5);
            o.panel != piece.panel && middles.chain(piece.points.iter().copied()).all(|q| distance(&sides, &q) <= edge)
        };
        if !out.iter().any(is_again) {
            out.push(piece);
        }
    }
    out
}

/// Goes on along a piece that begins where a line ends: at once within `edge` (mm), across a gap straight, and from what both reach
/// beyond the line of a bend back to it.
fn append(line: &mut Vec<Vec2>, mut piece: Vec<Vec2>, edge: f64) {
    if let (Some(p), Some(q)) = (line.last().copied(), piece.first().copied()) {
        let middle = (p + q) * 0.5;
        if (p - q).norm() <= edge {
            line.pop();
            piece[0] = middle;
        } else if line.len() > 1 && (q - p).dot(&(p - line[line.len() - 2])) < 0.0 {
            shorten(line, &middle);
            piece.reverse();
            shorten(&mut piece, &middle);
            piece.reverse();
        }
    }
    line.extend(piece);
}

/// Takes back the end of a line to where it is nearest to a place.
fn shorten(line: &mut Vec<Vec2>, to: &Vec2) {
    while line.len() > 1 {
        let (a, b) = (line[line.len() - 2], line[line.len() - 1]);
        let share = (b - a).dot(&(to - a)) / (b - a).norm_squared();
        line.pop();
        if share > 0.0 || line.len() == 1 {
            line.push(a + (b - a) * share.clamp(0.0, 1.0));
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(panel: usize, points: &[[f64; 2]], ends: [f64; 2]) -> Piece {
        let points = points.iter().map(|p| Vec2::new(p[0], p[1])).collect();
        Piece { panel, points, ends: ends.map(|x| Vec3::new(x, 0.0, 0.0)) }
    }

    const NEAR: Near = Near { same: 1e-6, edge: 0.01, fold: 3.0 };

    #[test]
    fn pieces_follow_each_other_whichever_way_they_run() {
        let all = vec![
            piece(2, &[[9.0, 1.0], [5.0, 0.0]], [9.0, 5.0]),
            piece(0, &[[0.0, 0.0], [2.0, 0.0]], [0.0, 2.0]),
            piece(1, &[[2.0, 0.005], [5.0, 0.0]], [2.0, 5.0]),
        ];
        let lines = joined(all, NEAR);
        assert_eq!((lines.len(), lines[0].len()), (1, 4), "{lines:?}");
        let ends = [lines[0][0], lines[0][3]];
        assert!(ends.contains(&Vec2::zeros()) && ends.contains(&Vec2::new(9.0, 1.0)));
    }

    #[test]
    fn a_sharp_bend_is_crossed_where_both_sides_are_one_place_in_space() {
        // With a gap straight across; where faces reach over each other to the middle; not where places differ.
        let gap = joined(
            vec![piece(0, &[[0.0, 0.0], [4.0, 0.0]], [0.0, 4.0]), piece(1, &[[6.0, 0.0], [9.0, 0.0]], [4.0, 9.0])],
            NEAR,
        );
        assert_eq!((gap.len(), gap[0].len()), (1, 4));
        let over = joined(
            vec![piece(0, &[[0.0, 0.0], [6.0, 0.0]], [0.0, 5.0]), piece(1, &[[4.0, 0.0], [9.0, 0.0]], [5.0, 9.0])],
            NEAR,
        );
        assert!(over.len() == 1 && over[0].windows(2).all(|w| w[1].x >= w[0].x), "{over:?}");
        let apart = joined(
            vec![piece(0, &[[0.0, 0.0], [4.0, 0.0]], [0.0, 4.0]), piece(1, &[[6.0, 0.0], [9.0, 0.0]], [5.0, 9.0])],
            NEAR,
        );
        assert_eq!(apart.len(), 2);
    }

    #[test]
    fn a_piece_that_both_faces_of_an_edge_have_is_drawn_once() {
        let lines = joined(
            vec![
                piece(0, &[[0.0, 0.0], [4.0, 0.0]], [0.0, 4.0]),
                piece(1, &[[4.0, 0.0], [2.0, 0.0], [0.0, 0.004]], [4.0, 0.0]),
            ],
            NEAR,
        );
        assert_eq!(lines.len(), 1, "{lines:?}");
        let way: f64 = lines[0].windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        assert!((way - 4.0).abs() < NEAR.edge, "{lines:?}");
    }
}
