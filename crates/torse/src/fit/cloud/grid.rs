//! Points in cubic cells: the neighbourhoods of a cloud. After the cell lists of molecular dynamics; see
//! `docs/algorithms/dual.md` for its place in the fit of clouds (\[PW99\] begins where planes are known).

use crate::geom::{BBox, Vec3};
use std::collections::HashMap;

/// Points that take part in finding sizes: enough for shares of a hundredth, in clouds of any size.
const SIZED_BY: usize = 60_000;

/// Cells with the indices of their points.
pub(super) struct Grid {
    origin: Vec3,
    /// Edge of a cell, mm.
    pub size: f64,
    order: Vec<u32>,
    cells: HashMap<[i32; 3], (u32, u32)>,
}

impl Grid {
    /// Cells of edge `size`.
    pub fn new(points: &[Vec3], size: f64) -> Self {
        let origin = core(points).min;
        let mut keyed: Vec<([i32; 3], u32)> =
            points.iter().enumerate().map(|(i, p)| (key(&origin, size, p), i as u32)).collect();
        keyed.sort_unstable();
        let mut cells = HashMap::new();
        let mut start = 0;
        while start < keyed.len() {
            let k = keyed[start].0;
            let end = start + keyed[start..].partition_point(|e| e.0 == k);
            cells.insert(k, (start as u32, end as u32));
            start = end;
        }
        Self { origin, size, order: keyed.into_iter().map(|e| e.1).collect(), cells }
    }

    /// A grid with at most about `count` occupied cells: surfaces fill cells with the square of the refinement.
    pub fn with_count(points: &[Vec3], count: usize) -> Self {
        // Steps towards the size.
        const STEPS: usize = 7;
        let diagonal = core(points).diagonal();
        let some: Vec<Vec3> = points.iter().step_by(points.len().div_ceil(SIZED_BY).max(1)).copied().collect();
        let mut size = diagonal / (count as f64).sqrt();
        for _ in 0..STEPS {
            let found = Self::new(&some, size).cells.len() as f64;
            size *= (found / count as f64).sqrt().clamp(0.3, 3.0);
        }
        Self::new(points, size)
    }

    /// Keys of the occupied cells, in a fixed order.
    pub fn keys(&self) -> Vec<[i32; 3]> {
        let mut keys: Vec<[i32; 3]> = self.cells.keys().copied().collect();
        keys.sort_unstable();
        keys
    }

    /// Indices of the points of a cell.
    pub fn cell(&self, k: &[i32; 3]) -> &[u32] {
        self.cells.get(k).map_or(&[], |&(a, b)| &self.order[a as usize..b as usize])
    }

    /// The cell that holds a place.
    pub fn key(&self, p: &Vec3) -> [i32; 3] {
        key(&self.origin, self.size, p)
    }
}

/// The box around nearly all points: a few that lie far away, as scanners write them, do not count.
pub(crate) fn core(points: &[Vec3]) -> BBox {
    // Share of the points that is left out on each side.
    const SHARE: f64 = 0.01;
    // The box of the rest is wider by as much of its diagonal, so that it holds the borders.
    const WIDER: f64 = 0.5;
    let some: Vec<&Vec3> = points.iter().step_by(points.len().div_ceil(SIZED_BY).max(1)).collect();
    let whole = BBox::of(points);
    if some.is_empty() {
        return whole;
    }
    let cut = ((SHARE * some.len() as f64).ceil() as usize).min((some.len() - 1) / 2);
    let range = |k: usize| {
        let mut x: Vec<f64> = some.iter().map(|p| p[k]).collect();
        x.sort_by(f64::total_cmp);
        (x[cut], x[x.len() - 1 - cut])
    };
    let [x, y, z] = [0, 1, 2].map(range);
    let inner = BBox { min: Vec3::new(x.0, y.0, z.0), max: Vec3::new(x.1, y.1, z.1) };
    let room = Vec3::repeat(WIDER * inner.diagonal());
    let out = BBox { min: (inner.min - room).sup(&whole.min), max: (inner.max + room).inf(&whole.max) };
    if inner.diagonal() > 0.0 {
        out
    } else {
        whole
    }
}

/// Keys of a cell and those up to `reach` cells from it.
pub(super) fn around(k: &[i32; 3], reach: i32) -> impl Iterator<Item = [i32; 3]> + '_ {
    (-reach..=reach).flat_map(move |x| {
        (-reach..=reach).flat_map(move |y| {
            (-reach..=reach).map(move |z| [k[0].saturating_add(x), k[1].saturating_add(y), k[2].saturating_add(z)])
        })
    })
}

fn key(origin: &Vec3, size: f64, p: &Vec3) -> [i32; 3] {
    let c = (p - origin) / size;
    [c.x.floor() as i32, c.y.floor() as i32, c.z.floor() as i32]
}
