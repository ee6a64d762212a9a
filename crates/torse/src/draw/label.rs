//! Where names go in a picture: for each thing drawn, the visible place with the most room around it.

use super::raster::Vertex;
use crate::geom::Vec2;

/// Side of a cell in pixels: names need no finer placing.
const CELL: f64 = 4.0;
/// No thing in this cell.
const NONE: u32 = u32::MAX;
/// A name beside the things in this cell.
const NAME: u32 = u32::MAX - 1;

/// Space about a name on paper, px.
const SPACE: f64 = 2.5;
/// Share of the picture's width that a line to a name keeps to before it runs across other things.
const LEADER: f64 = 0.35;

/// A place for a name, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Middle of the name.
    pub middle: Vec2,
    /// Distance from there to where something else begins.
    pub room: f64,
    /// Width of the widest level line centred there that stays on the same thing.
    pub breadth: f64,
}

/// A coarse map of what is in sight.
#[derive(Clone, Debug)]
pub(crate) struct SightMap {
    columns: usize,
    rows: usize,
    owner: Vec<u32>,
    depth: Vec<f64>,
}

impl SightMap {
    /// An empty map of a picture of `width` × `height` pixels.
    pub fn new(width: usize, height: usize) -> Self {
        let cells = |n: usize| (n as f64 / CELL).ceil() as usize;
        let (columns, rows) = (cells(width), cells(height));
        Self { columns, rows, owner: vec![NONE; columns * rows], depth: vec![0.0; columns * rows] }
    }

    /// Enters a triangle that belongs to thing `owner`.
    pub fn triangle(&mut self, owner: u32, corners: &[Vertex; 3]) {
        let [a, b, c] = corners.map(|v| v.place);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let range = |k: usize, most: usize| {
            let low = (a[k].min(b[k]).min(c[k]) / CELL - 0.5).ceil().max(0.0) as usize;
            let high = (a[k].max(b[k]).max(c[k]) / CELL + 0.5).floor().max(0.0) as usize;
            low..high.min(most)
        };
        for row in range(1, self.rows) {
            for column in range(0, self.columns) {
                let p = [(column as f64 + 0.5) * CELL, (row as f64 + 0.5) * CELL];
                let side =
                    |u: [f64; 3], v: [f64; 3]| ((v[0] - u[0]) * (p[1] - u[1]) - (v[1] - u[1]) * (p[0] - u[0])) / area;
                let w = [side(b, c), side(c, a), side(a, b)];
                let depth = w[0] * a[2] + w[1] * b[2] + w[2] * c[2];
                let cell = row * self.columns + column;
                if w.iter().all(|&w| w >= 0.0) && depth > self.depth[cell] {
                    self.depth[cell] = depth;
                    self.owner[cell] = owner;
                }
            }
        }
    }

    /// Enters closed outlines, even-odd, that belong to thing `owner`; however narrow it is, its border is entered.
    pub fn outlines(&mut self, owner: u32, outlines: &[Vec<Vec2>]) {
        let edges = || outlines.iter().flat_map(|o| (0..o.len()).map(|k| (o[k], o[(k + 1) % o.len()])));
        let finite = |(a, b): &(Vec2, Vec2)| a.iter().chain(b.iter()).all(|x| x.is_finite());
        let height = |(a, _): (Vec2, Vec2)| a.y;
        let low = edges().filter(finite).map(height).fold(f64::INFINITY, f64::min);
        let high = edges().filter(finite).map(height).fold(f64::NEG_INFINITY, f64::max);
        let row = |y: f64| ((y / CELL).max(0.0) as usize).min(self.rows);
        for row in row(low)..row(high + CELL) {
            let y = (row as f64 + 0.5) * CELL;
            let crossing =
                |(a, b): (Vec2, Vec2)| ((a.y <= y) != (b.y <= y)).then(|| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
            let mut x: Vec<f64> = edges().filter(finite).filter_map(crossing).collect();
            x.sort_by(f64::total_cmp);
            for pair in x.chunks_exact(2) {
                let [from, to] =
                    [pair[0], pair[1]].map(|x| ((x / CELL - 0.5).ceil().max(0.0) as usize).min(self.columns));
                self.owner[row * self.columns + from..row * self.columns + to].fill(owner);
            }
        }
        for (a, b) in edges().filter(finite) {
            let cells: Vec<usize> = self.way(a, b).collect();
            cells.into_iter().for_each(|k| self.owner[k] = owner);
        }
    }

    /// Keeps names out of everything below a height (pixels).
    pub fn close_below(&mut self, y: f64) {
        let first = ((y / CELL).floor().max(0.0) as usize).min(self.rows);
        for owner in &mut self.owner[first * self.columns..] {
            if *owner == NONE {
                *owner = NAME;
            }
        }
    }

    /// Whether a box (middle and half its size, pixels) lies on the thing of `owner` alone.
    pub fn is_on(&self, owner: u32, middle: Vec2, half: Vec2) -> bool {
        let (low, high) = (middle - half, middle + half);
        let size = Vec2::new(self.columns as f64, self.rows as f64) * CELL;
        if !(low.x >= 0.0 && low.y >= 0.0 && high.x < size.x && high.y < size.y) {
            return false;
        }
        let cells = |from: f64, to: f64| (from / CELL) as usize..=(to / CELL) as usize;
        cells(low.y, high.y)
            .all(|row| cells(low.x, high.x).all(|column| self.owner[row * self.columns + column] == owner))
    }

    /// For each of `count` things: the place with the most room, preferring the middle of the thing. `None` for
    /// things out of sight.
    pub fn places(&self, count: usize) -> Vec<Option<Place>> {
        // A place nearer to the middle is worth a little less room.
        const MIDDLE: f64 = 0.06;
        let room = self.room();
        let centre =
            |cell: usize| Vec2::new((cell % self.columns) as f64 + 0.5, (cell / self.columns) as f64 + 0.5) * CELL;
        let mut sum = vec![(Vec2::zeros(), 0.0); count];
        for (cell, &owner) in self.owner.iter().enumerate() {
            if let Some(s) = sum.get_mut(owner as usize) {
                *s = (s.0 + centre(cell), s.1 + 1.0);
            }
        }
        let mut best: Vec<Option<(f64, Vec2, f64)>> = vec![None; count];
        for (cell, &owner) in self.owner.iter().enumerate() {
            let Some(slot) = best.get_mut(owner as usize) else { continue };
            let (total, n) = sum[owner as usize];
            let score = room[cell] - MIDDLE * (centre(cell) - total / n).norm();
            if slot.is_none_or(|(s, ..)| score > s) {
                *slot = Some((score, centre(cell), room[cell]));
            }
        }
        best.into_iter()
            .map(|b| b.map(|(_, middle, room)| Place { middle, room, breadth: self.breadth(middle) }))
            .collect()
    }

    /// Where a line from a name beside the thing of `owner`, whose most room is at `middle`, may begin: there, and where the
    /// thing is farthest to each side.
    pub fn starts(&self, owner: u32, middle: Vec2) -> Vec<Vec2> {
        let centre =
            |cell: usize| Vec2::new((cell % self.columns) as f64 + 0.5, (cell / self.columns) as f64 + 0.5) * CELL;
        let mut far = [middle; 4];
        for p in (0..self.owner.len()).filter(|&k| self.owner[k] == owner).map(centre) {
            for (best, side) in far.iter_mut().zip([Vec2::x(), -Vec2::x(), Vec2::y(), -Vec2::y()]) {
                if side.dot(&p) > side.dot(best) {
                    *best = p;
                }
            }
        }
        std::iter::once(middle).chain(far).collect()
    }

    /// The place on paper, below `top`, where a name of half the size `half` (pixels) is nearest to the thing of `owner`, and
    /// the start of the line to it, out of `starts`; its cells and those of the line are taken. Where there is no other place the
    /// line runs across other things, if it may go `across`. `None` where nothing is free.
    pub fn beside(&mut self, owner: u32, starts: &[Vec2], half: Vec2, (top, across): (f64, bool)) -> Option<[Vec2; 2]> {
        let nearest = |over: bool| {
            let most = if over { f64::INFINITY } else { LEADER * CELL * self.columns as f64 };
            let mut best: Option<(f64, Vec2, Vec2)> = None;
            for &from in starts {
                let within = best.map_or(most, |b| b.0);
                if let Some((far, place)) = self.nearest(owner, from, half, (top, within, over)) {
                    best = Some((far, from, place));
                }
            }
            best
        };
        let (_, from, place) = nearest(false).or_else(|| across.then(|| nearest(true)).flatten())?;
        // Later names keep off the line to this one.
        let line: Vec<usize> = self.way(from, place).collect();
        for k in line {
            if self.owner[k] == NONE {
                self.owner[k] = NAME;
            }
        }
        for (row, a, b) in self.block(place, half) {
            self.owner[row * self.columns + a..=row * self.columns + b].fill(NAME);
        }
        Some([from, place])
    }

    /// Cells to either side of the one in which the middle of a name lies that the name and some space take.
    fn reach(half: Vec2) -> [usize; 2] {
        [half.x, half.y].map(|h| ((h + SPACE) / CELL - 0.5).ceil().max(0.0) as usize)
    }

    /// Rows, and first and last column of each, of the cells about a name in the middle of a cell.
    fn block(&self, middle: Vec2, half: Vec2) -> impl Iterator<Item = (usize, usize, usize)> {
        let reach = Self::reach(half);
        let (c, r) = ((middle.x / CELL) as usize, (middle.y / CELL) as usize);
        (r - reach[1]..=r + reach[1]).map(move |row| (row, c - reach[0], c + reach[0]))
    }

    /// The place on paper, below `top`, nearest to `from` and nearer than `within`, with its distance; the line to it may run
    /// over other things if `over`.
    fn nearest(
        &self,
        owner: u32,
        from: Vec2,
        half: Vec2,
        (top, within, over): (f64, f64, bool),
    ) -> Option<(f64, Vec2)> {
        let reach = Self::reach(half);
        let clear = |k: usize| match self.owner[k] {
            NAME => false,
            NONE => true,
            other => over || other == owner,
        };
        let mut best: Option<(f64, Vec2)> = None;
        for r in reach[1] + (top / CELL).ceil() as usize..self.rows.saturating_sub(reach[1]) {
            for c in reach[0]..self.columns.saturating_sub(reach[0]) {
                let place = Vec2::new(c as f64 + 0.5, r as f64 + 0.5) * CELL;
                let far = (place - from).norm();
                let free = |(row, a, b): (usize, usize, usize)| {
                    self.owner[row * self.columns + a..=row * self.columns + b].iter().all(|&o| o == NONE)
                };
                if far < best.map_or(within, |b| b.0)
                    && self.block(place, half).all(free)
                    && self.way(from, place).all(clear)
                {
                    best = Some((far, place));
                }
            }
        }
        best
    }

    /// The cells on the way from one place to another.
    fn way(&self, from: Vec2, to: Vec2) -> impl Iterator<Item = usize> + '_ {
        let steps = ((to - from).norm() / CELL).ceil().max(1.0) as usize;
        (0..=steps).map(move |k| {
            let p = from + (to - from) * (k as f64 / steps as f64);
            let cell = |x: f64, most: usize| ((x / CELL).max(0.0) as usize).min(most - 1);
            cell(p.y, self.rows) * self.columns + cell(p.x, self.columns)
        })
    }

    /// Width (pixels) of the widest level line centred at a place that stays on the same thing.
    fn breadth(&self, middle: Vec2) -> f64 {
        let (column, row) = ((middle.x / CELL) as usize, (middle.y / CELL) as usize);
        let line = &self.owner[row * self.columns..(row + 1) * self.columns];
        let same = |&&owner: &&u32| owner == line[column];
        let left = line[..column].iter().rev().take_while(same).count();
        let right = line[column + 1..].iter().take_while(same).count();
        (2 * left.min(right) + 1) as f64 * CELL
    }

    /// Distance (pixels, chamfer 3-4) from each cell to the nearest cell of another owner or the picture's edge.
    fn room(&self) -> Vec<f64> {
        let (w, h) = (self.columns as isize, self.rows as isize);
        let mut steps = vec![f64::INFINITY; self.owner.len()];
        let mut relax = |x: isize, y: isize, near: [(isize, isize, f64); 4]| {
            let cell = (y * w + x) as usize;
            for (dx, dy, cost) in near {
                let (u, v) = (x + dx, y + dy);
                let reach = if u < 0 || v < 0 || u >= w || v >= h {
                    cost / 2.0
                } else {
                    let other = (v * w + u) as usize;
                    if self.owner[other] == self.owner[cell] {
                        steps[other] + cost
                    } else {
                        cost / 2.0
                    }
                };
                steps[cell] = steps[cell].min(reach);
            }
        };
        let (one, diagonal) = (1.0, 4.0 / 3.0);
        for y in 0..h {
            for x in 0..w {
                relax(x, y, [(-1, 0, one), (0, -1, one), (-1, -1, diagonal), (1, -1, diagonal)]);
            }
        }
        for y in (0..h).rev() {
            for x in (0..w).rev() {
                relax(x, y, [(1, 0, one), (0, 1, one), (1, 1, diagonal), (-1, 1, diagonal)]);
            }
        }
        steps.iter().map(|s| s * CELL).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    #[test]
    fn boxes_lie_on_what_outlines_bound() {
        let mut map = SightMap::new(400, 200);
        let ring = |x: [f64; 2], y: [f64; 2]| {
            [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]: [usize; 2]| Vec2::new(x[i], y[j])).to_vec()
        };
        map.outlines(3, &[ring([40.0, 360.0], [40.0, 160.0]), ring([180.0, 220.0], [80.0, 120.0])]);
        map.outlines(4, &[ring([10.0, 10.5], [20.0, 180.0])]);
        let at = |x: f64, y: f64| Vec2::new(x, y);
        assert!(map.is_on(3, at(100.0, 100.0), at(40.0, 40.0)) && !map.is_on(4, at(100.0, 100.0), at(4.0, 4.0)));
        // Across the hole, across the border, and beyond the picture.
        assert!(!map.is_on(3, at(180.0, 100.0), at(40.0, 10.0)) && !map.is_on(3, at(60.0, 100.0), at(40.0, 10.0)));
        assert!(!map.is_on(3, at(395.0, 100.0), at(40.0, 10.0)));
        // Narrower than a cell, and there all the same.
        let places = map.places(5);
        assert!(places[4].is_some() && places[0].is_none());
        map.close_below(100.0);
        assert!(map.beside(9, &[at(200.0, 150.0)], at(10.0, 6.0), (0.0, true)).is_none_or(|[_, p]| p.y < 100.0));
    }

    #[test]
    fn names_beside_things_lie_on_paper_and_apart() {
        let mut map = SightMap::new(400, 200);
        rectangle(&mut map, 0, [100.0, 300.0], [80.0, 120.0], 1.0);
        let (from, half) = (Vec2::new(200.0, 100.0), Vec2::new(20.0, 8.0));
        let places = [0; 3].map(|_| map.beside(0, &[from], half, (20.0, true)).expect("room")[1]);
        for (k, p) in places.iter().enumerate() {
            assert!(
                (p.y + half.y <= 80.0 && p.y - half.y >= 20.0)
                    || p.y - half.y >= 120.0
                    || !(80.0..=320.0).contains(&p.x)
            );
            for q in &places[..k] {
                assert!((p.x - q.x).abs() >= 2.0 * half.x || (p.y - q.y).abs() >= 2.0 * half.y);
            }
        }
        assert_eq!(map.beside(0, &[from], Vec2::new(190.0, 90.0), (0.0, true)), None);
        // No line to a name runs through another name.
        for (k, p) in places.iter().enumerate() {
            for q in &places[..k] {
                let within = |x: Vec2| (x.x - q.x).abs() < half.x && (x.y - q.y).abs() < half.y;
                assert!((0..=100).all(|s| !within(from + (p - from) * (f64::from(s) / 100.0))), "{p} {q}");
            }
        }
    }

    #[test]
    fn lines_to_names_keep_off_other_things_where_they_can() {
        // A narrow thing between two others that hide it but for its right end.
        let mut map = SightMap::new(600, 200);
        rectangle(&mut map, 0, [40.0, 400.0], [20.0, 90.0], 1.0);
        rectangle(&mut map, 1, [40.0, 420.0], [96.0, 104.0], 1.0);
        rectangle(&mut map, 2, [40.0, 400.0], [110.0, 190.0], 1.0);
        let half = Vec2::new(20.0, 8.0);
        let middle = Vec2::new(220.0, 100.0);
        let starts = map.starts(1, middle);
        let [from, place] = map.clone().beside(1, &starts, half, (0.0, true)).expect("room");
        assert!(from.x > 400.0 && place.x > 400.0, "{from} {place}");
        // From its middle alone the line has to cross a neighbour.
        assert!(map.beside(1, &[middle], half, (0.0, true)).is_some());
    }

    fn rectangle(map: &mut SightMap, owner: u32, x: [f64; 2], y: [f64; 2], depth: f64) {
        let v = |x: f64, y: f64| Vertex { place: [x, y, depth], normal: Vec3::z(), value: 0.0 };
        let [a, b, c, d] = [v(x[0], y[0]), v(x[1], y[0]), v(x[1], y[1]), v(x[0], y[1])];
        map.triangle(owner, &[a, b, c]);
        map.triangle(owner, &[a, c, d]);
    }

    #[test]
    fn names_go_to_the_middle_of_what_is_in_sight() {
        let mut map = SightMap::new(400, 200);
        rectangle(&mut map, 0, [0.0, 400.0], [0.0, 200.0], 1.0);
        rectangle(&mut map, 1, [0.0, 200.0], [0.0, 200.0], 2.0);
        rectangle(&mut map, 2, [20.0, 100.0], [20.0, 100.0], 0.5);
        let places = map.places(3);
        let right = places[0].expect("the right half is in sight");
        assert!((right.middle - Vec2::new(300.0, 100.0)).norm() < 8.0, "{right:?}");
        assert!((right.room - 100.0).abs() < 8.0 && (right.breadth - 200.0).abs() < 16.0, "{right:?}");
        let left = places[1].expect("the left half is in sight");
        assert!((left.middle - Vec2::new(100.0, 100.0)).norm() < 8.0);
        assert!(places[2].is_none());
    }
}
