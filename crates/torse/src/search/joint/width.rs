//! How wide strips are across their lines, and what it costs to make them narrower or wider than they should be: distances
//! and gaps alone leave lines free to wander where nothing is at its largest.

use super::columns::Columns;
use super::form::Tie;
use super::line::{slide_functions, LinePoint, Width};
use super::network::{median, Network};
use crate::geom::Vec3;
use crate::spline::knots::Knots;
use std::collections::BTreeMap;

/// Every so manyth point of a line is measured.
const EVERY: usize = 6;
/// Least cosine between the conormal of a line and the way to what is across.
const ACROSS: f64 = 0.7;
/// Strips narrower than this share of the median run out there.
const RUN_OUT: f64 = 0.2;
/// Strips should be as wide as the cover made them to begin with (0), or as their median everywhere (1). With 0 the hull at
/// 10 mm comes out 33 to 200 mm wide where 54 to 132 will do, and its edges do not all close; with 1 corners would fill up.
const EVENED: f64 = 0.6;

/// The place across a strip from a point of one of its lines.
struct Across {
    /// mm.
    width: f64,
    /// Unit vector.
    way: Vec3,
    /// The line there and its point; none on the border of the face.
    on: Option<[usize; 2]>,
}

impl Network<'_> {
    /// Widths as they should be, from those as they are: none where nothing is across, or the strip runs out.
    pub fn wanted_widths(&self) -> Vec<Width> {
        let borders = self.borders();
        let points = |l: usize| (0..self.lines[l].count).step_by(EVERY);
        let all = (0..self.lines.len()).flat_map(|l| points(l).flat_map(move |i| [(l, i, 0), (l, i, 1)]));
        let of = |(line, point, side)| {
            Some(Width { line, point, side, wanted: self.across(&borders, line, point, side)?.width })
        };
        let mut out: Vec<Width> = all.filter_map(of).collect();
        let least = RUN_OUT * median(out.iter().map(|w| w.wanted).collect());
        out.retain(|w| w.wanted > least);
        for k in 0..self.members.len() {
            let is_of = |w: &Width| self.lines[w.line].strips[w.side] == k;
            let middle = median(out.iter().filter(|w| is_of(w)).map(|w| w.wanted).collect());
            let of_strip = out.iter_mut().filter(|w| is_of(w));
            of_strip.for_each(|w| w.wanted = w.wanted.powf(1.0 - EVENED) * middle.powf(EVENED));
        }
        out
    }

    /// Places on the border of the face, by strip.
    fn borders(&self) -> Vec<Vec<Vec3>> {
        let mut out = vec![Vec::new(); self.members.len()];
        self.samples.iter().filter(|s| s.up.is_some()).for_each(|s| out[s.strip].push(s.x));
        out
    }

    /// What lies across the strip on one side of a point of a line: the nearest point of another line or of the border.
    fn across(&self, borders: &[Vec<Vec3>], l: usize, i: usize, side: usize) -> Option<Across> {
        let (line, p) = (&self.lines[l], &self.lines[l].points[i]);
        let strip = line.strips[side];
        let conormal = p.normal.cross(&p.tangent) * [1.0, -1.0][side];
        let of_lines = self.lines.iter().enumerate().filter(|(m, o)| *m != l && o.strips.contains(&strip));
        let of_lines = of_lines.flat_map(|(m, o)| o.points.iter().enumerate().map(move |(j, q)| (q.x, Some([m, j]))));
        let of_border = borders[strip].iter().map(|x| (*x, None));
        let found = of_lines.chain(of_border).filter_map(|(x, on)| {
            let width = (x - p.x).norm();
            let way = (x - p.x) / width;
            (way.dot(&conormal) > ACROSS).then_some(Across { width, way, on })
        });
        found.min_by(|a, b| a.width.total_cmp(&b.width))
    }

    /// Rows that pay for widths that are not those wanted, by the logarithms of their ratios.
    pub fn pay_widths(&self, columns: &Columns, knots: &Knots, price: f64, tie: &mut Tie) {
        let weight = price / self.widths.len().max(1) as f64;
        let borders = self.borders();
        for w in &self.widths {
            let Some(across) = self.across(&borders, w.line, w.point, w.side) else { continue };
            let scale = self.unit / across.width;
            let mut vertices: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
            let mut ways = |l: usize, p: &LinePoint, sign: f64| {
                let (first, slide) = slide_functions(knots, p.share);
                let along = sign * scale * across.way.dot(&p.slide);
                tie.rows.run(columns.slides[l] + first, slide.map(|s| s * along));
                for (v, axes) in self.lines[l].vertex_ways(p) {
                    let sum = vertices.entry(v).or_insert([0.0; 2]);
                    (0..2).for_each(|d| sum[d] += sign * scale * across.way.dot(&axes[d]));
                }
            };
            ways(w.line, &self.lines[w.line].points[w.point], -1.0);
            if let Some([m, j]) = across.on {
                ways(m, &self.lines[m].points[j], 1.0);
            }
            vertices.into_iter().for_each(|(v, sum)| tie.rows.run(columns.vertices[v], sum));
            tie.end(weight, (across.width / w.wanted).ln());
        }
    }
}
