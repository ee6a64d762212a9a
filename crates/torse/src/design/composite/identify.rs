//! One unknown point per control point, common ones once \[TBWP16\].
//!
//! A curve that bounds two strips is one curve, so its points are common anyway. Where a strip's last ruling is another's
//! first, the ends of their curves become one. Points are numbered along the strips first and then across: in that order the
//! equations are a band.

use super::check::size;
use super::{Composite, Join, Place};
use crate::constraint::fairness::greville;
use crate::constraint::proximity::Scale;
use crate::geom::Vec3;

/// Starting values and numbers of unknown points.
pub(super) struct Identified {
    /// Coordinates of all unknown points, in units of the scale.
    pub start: Vec<f64>,
    /// First unknown of every control point, by curve.
    pub points: Vec<Vec<u32>>,
    /// From units to mm.
    pub scale: Scale,
}

/// Indices of the curves of both sides, for every pair of strips with a common ruling.
fn rulings(c: &Composite) -> Vec<[[usize; 2]; 2]> {
    let sides = |strip: &str| {
        let [a, b] = &c.strips[c.strip(strip)?].sides;
        Some([c.curve(a)?, c.curve(b)?])
    };
    let pair = |j: &Join| match j {
        Join::Ruling { first, second, .. } => Some([sides(first)?, sides(second)?]),
        Join::Curve { .. } | Join::Ends { .. } => None,
    };
    c.joins.iter().filter_map(pair).collect()
}

/// Indices of curves and control points of both ends, for every pair of curves that meet at an end.
fn ends(c: &Composite) -> Vec<[(usize, usize); 2]> {
    let of = |j: &Join| match j {
        Join::Ends { ends: [p, q], .. } => Some([end(c, p)?, end(c, q)?]),
        _ => None,
    };
    c.joins.iter().filter_map(of).collect()
}

/// Curve and control point of a place that is an end of its curve.
pub(super) fn end(c: &Composite, place: &Place) -> Option<(usize, usize)> {
    let k = c.curve(&place.curve)?;
    let curve = &c.curves[k].curve;
    let (a, b) = curve.domain();
    if place.u <= a {
        Some((k, 0))
    } else {
        (place.u >= b).then(|| (k, curve.control.len() - 1))
    }
}

/// The representative of an item of a partition.
fn find(root: &mut [usize], mut i: usize) -> usize {
    while root[i] != i {
        root[i] = root[root[i]];
        i = root[i];
    }
    i
}

/// For every curve, how many rulings lie before it: strips that follow each other come one after the other.
fn offsets(c: &Composite, rulings: &[[[usize; 2]; 2]]) -> Vec<usize> {
    let mut offset = vec![0usize; c.curves.len()];
    // A ring begins somewhere, and is no longer than there are strips.
    for _ in 0..c.strips.len() {
        let before = offset.clone();
        for [p, q] in rulings.iter().filter(|[p, q]| p != q) {
            let next = offset[p[0]].max(offset[p[1]]) + 1;
            q.iter().for_each(|&k| offset[k] = offset[k].max(next).min(c.strips.len()));
        }
        if offset == before {
            break;
        }
    }
    offset
}

/// Numbers the control points of a composite that was checked.
pub(super) fn identified(c: &Composite) -> Identified {
    let mut first = Vec::new();
    let mut count = 0;
    for b in &c.curves {
        first.push(count);
        count += b.curve.control.len();
    }
    let rulings = rulings(c);
    let mut root: Vec<usize> = (0..count).collect();
    for [p, q] in &rulings {
        for (&p, &q) in p.iter().zip(q) {
            let (i, j) = (find(&mut root, first[p] + c.curves[p].curve.control.len() - 1), find(&mut root, first[q]));
            root[i.max(j)] = i.min(j);
        }
    }
    for [p, q] in ends(c) {
        let (i, j) = (find(&mut root, first[p.0] + p.1), find(&mut root, first[q.0] + q.1));
        root[i.max(j)] = i.min(j);
    }
    let all: Vec<Vec3> = c.curves.iter().flat_map(|b| b.curve.control.iter().map(|p| Vec3::from(*p))).collect();
    let places = places(c, &all, &mut root);
    let unit = size(c);
    let scale =
        Scale { origin: all.iter().sum::<Vec3>() / count.max(1) as f64, size: if unit > 0.0 { unit } else { 1.0 } };
    let offset = offsets(c, &rulings);
    let mut order: Vec<(f64, usize, usize)> = Vec::with_capacity(count);
    for (k, b) in c.curves.iter().enumerate() {
        let (a, e) = b.curve.domain();
        let g = greville(&b.curve.knots);
        order.extend(g.iter().enumerate().map(|(i, t)| (offset[k] as f64 + (t - a) / (e - a), k, i)));
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut unknown = vec![u32::MAX; count];
    let mut start = Vec::with_capacity(3 * count);
    let mut points: Vec<Vec<u32>> = c.curves.iter().map(|b| vec![0; b.curve.control.len()]).collect();
    for (_, k, i) in order {
        let r = find(&mut root, first[k] + i);
        if unknown[r] == u32::MAX {
            unknown[r] = start.len() as u32;
            start.extend_from_slice(((places[r] - scale.origin) / scale.size).as_slice());
        }
        points[k][i] = unknown[r];
    }
    Identified { start, points, scale }
}

/// The place of every representative: the mean of the points that it stands for, of the fixed ones if there are any.
fn places(c: &Composite, all: &[Vec3], root: &mut [usize]) -> Vec<Vec3> {
    let fixed = c.curves.iter().flat_map(|b| std::iter::repeat_n(b.fixed, b.curve.control.len()));
    let fixed: Vec<bool> = fixed.collect();
    let mut sums = vec![(Vec3::zeros(), 0usize); all.len()];
    for held in [true, false] {
        let empty: Vec<bool> = sums.iter().map(|s| s.1 == 0).collect();
        for i in (0..all.len()).filter(|&i| fixed[i] == held) {
            let r = find(root, i);
            if held || empty[r] {
                sums[r].0 += all[i];
                sums[r].1 += 1;
            }
        }
    }
    sums.into_iter().map(|(sum, n)| sum / n.max(1) as f64).collect()
}
