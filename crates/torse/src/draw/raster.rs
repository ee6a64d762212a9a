//! A small software rasteriser: shaded triangles and thick lines with a depth buffer, plane fills and strokes.
//!
//! Pictures need no GPU and no display, and are the same on every machine. Each pixel is the mean of
//! `SAMPLES`² samples; bands of rows are drawn in parallel, so memory stays small. Knows no units: x to the
//! right and y downwards in pixels, depth as the inverse distance from the eye (greater is nearer).

use super::colour::{self, Rgb};
use crate::geom::{Vec2, Vec3};
use crate::num::parallel;

/// Samples per pixel and direction.
pub(crate) const SAMPLES: usize = 3;
/// Room (samples) for rounding beside what sides cut out of a row.
const ROUNDING: f64 = 0.01;
/// Rows of pixels per band: small enough that a band's buffers stay in the cache's reach.
const BAND: usize = 16;

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels per row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Rows from the top, sRGB.
    pub pixels: Vec<[u8; 3]>,
}

/// How a triangle gets its colour before shading.
#[derive(Clone, Copy, Debug)]
pub enum Paint {
    /// One colour.
    Solid(Rgb),
    /// The deviation scale; the values at the vertices are shares of the tolerance.
    Deviation,
}

/// A projected vertex.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// x, y in pixels and depth.
    pub place: [f64; 3],
    /// Unit normal in view coordinates (x right, y up, z towards the eye); its sign does not matter.
    pub normal: Vec3,
    /// Value for [`Paint::Deviation`].
    pub value: f64,
}

/// A polyline of round pen.
#[derive(Clone, Debug)]
pub struct PenLine {
    /// x, y in pixels and depth of each point.
    pub points: Vec<[f64; 3]>,
    /// Width of the pen in pixels.
    pub width: f64,
    /// Colour.
    pub colour: Rgb,
    /// Opacity, 0..=1.
    pub alpha: f64,
}

/// An area bounded by closed polygons, even-odd.
#[derive(Clone, Debug)]
pub struct Fill {
    /// Polygons in pixels, the last point joined to the first.
    pub loops: Vec<Vec<Vec2>>,
    /// Colour.
    pub colour: Rgb,
    /// Opacity, 0..=1.
    pub alpha: f64,
}

/// Something flat, drawn over what was drawn before.
#[derive(Clone, Debug)]
pub enum Overlay {
    /// A line; its depths are ignored.
    Line(PenLine),
    /// An area.
    Fill(Fill),
}

/// What is to be drawn: triangles, then lines hidden by them where they lie deeper, then overlays in order.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Colour of the paper.
    pub background: Rgb,
    /// Shaded triangles.
    pub triangles: Vec<(Paint, [Vertex; 3])>,
    /// Lines with depth.
    pub lines: Vec<PenLine>,
    /// Flat things on top.
    pub overlays: Vec<Overlay>,
}

impl Drawing {
    /// An empty white drawing.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, background: [1.0; 3], triangles: Vec::new(), lines: Vec::new(), overlays: Vec::new() }
    }

    /// Adds a flat polyline.
    pub fn stroke(&mut self, points: &[Vec2], width: f64, colour: Rgb, alpha: f64) {
        let points = points.iter().map(|p| [p.x, p.y, 0.0]).collect();
        self.overlays.push(Overlay::Line(PenLine { points, width, colour, alpha }));
    }

    /// Adds a flat area.
    pub fn fill(&mut self, loops: Vec<Vec<Vec2>>, colour: Rgb, alpha: f64) {
        self.overlays.push(Overlay::Fill(Fill { loops, colour, alpha }));
    }

    /// Adds text with its baseline starting at `at`, capitals `height` pixels tall.
    pub fn text(&mut self, text: &str, at: Vec2, height: f64, colour: Rgb) {
        self.pen_text(text, at, height, height * 0.135, colour);
    }

    /// Adds text with a white rim, readable over a drawing.
    pub fn rimmed_text(&mut self, text: &str, at: Vec2, height: f64, colour: Rgb) {
        self.pen_text(text, at, height, height * 0.135 + 3.4, [1.0; 3]);
        self.text(text, at, height, colour);
    }

    fn pen_text(&mut self, text: &str, at: Vec2, height: f64, pen: f64, colour: Rgb) {
        for stroke in super::stroke_font::strokes(text, height) {
            let points: Vec<Vec2> = stroke.iter().map(|p| Vec2::new(at.x + p.x, at.y - p.y)).collect();
            self.stroke(&points, pen, colour, 1.0);
        }
    }

    /// Draws the picture. Items with coordinates that are not finite are left out.
    pub fn render(&self) -> Image {
        let bands = self.height.div_ceil(BAND);
        let rows_of = |low: f64, high: f64| {
            let band = |y: f64| (y / BAND as f64).floor().clamp(-1.0, bands as f64) as isize;
            (band(low).max(0) as usize)..((band(high) + 1).max(0) as usize).min(bands)
        };
        let mut bins: Vec<Vec<u32>> = vec![Vec::new(); bands];
        for (i, (_, t)) in self.triangles.iter().enumerate() {
            if t.iter().flat_map(|v| v.place).all(f64::is_finite) {
                let y = t.map(|v| v.place[1]);
                let (low, high) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
                for band in rows_of(low, high) {
                    bins[band].push(i as u32);
                }
            }
        }
        // Lines by their segments: a band sees a few of those of long ones, in the order in which they are drawn.
        let segments = |line: &PenLine, number: usize, out: &mut [Vec<(u32, u32)>]| {
            if !line.points.iter().flatten().all(|x| x.is_finite()) {
                return;
            }
            let beside = 0.5 * line.width + 1.0;
            for (i, ends) in line.points.windows(2).enumerate() {
                let (a, b) = (ends[0][1], ends[1][1]);
                for band in rows_of(a.min(b) - beside, a.max(b) + beside) {
                    out[band].push((number as u32, i as u32));
                }
            }
        };
        let mut lines: Vec<Vec<(u32, u32)>> = vec![Vec::new(); bands];
        self.lines.iter().enumerate().for_each(|(k, line)| segments(line, k, &mut lines));
        let mut overlays: Vec<Vec<(u32, u32)>> = vec![Vec::new(); bands];
        for (k, item) in self.overlays.iter().enumerate() {
            match item {
                Overlay::Line(line) => segments(line, k, &mut overlays),
                Overlay::Fill(fill) => {
                    let y = || fill.loops.iter().flatten().map(|p| p.y);
                    let (low, high) = (y().fold(f64::INFINITY, f64::min), y().fold(f64::NEG_INFINITY, f64::max));
                    rows_of(low, high).for_each(|band| overlays[band].push((k as u32, 0)));
                }
            }
        }
        let rows: Vec<Vec<[u8; 3]>> = parallel::map(bins.iter().enumerate(), |(i, bin)| {
            let first = i * BAND;
            let mut band = Band::new(self.width, first, BAND.min(self.height - first), self.background);
            for &k in bin {
                let (paint, corners) = &self.triangles[k as usize];
                band.triangle(*paint, corners);
            }
            for &(k, segment) in &lines[i] {
                band.segment(&self.lines[k as usize], segment as usize, true);
            }
            for &(k, segment) in &overlays[i] {
                match &self.overlays[k as usize] {
                    Overlay::Line(line) => band.segment(line, segment as usize, false),
                    Overlay::Fill(fill) => band.fill(fill),
                }
            }
            band.pixels()
        });
        Image { width: self.width, height: self.height, pixels: rows.concat() }
    }
}

/// Some rows of the picture as samples.
struct Band {
    /// Samples per row.
    columns: usize,
    /// First row of samples.
    first: usize,
    /// Rows of samples.
    rows: usize,
    colour: Vec<[f32; 3]>,
    depth: Vec<f32>,
}

impl Band {
    fn new(width: usize, first: usize, rows: usize, background: Rgb) -> Self {
        let (columns, rows) = (width * SAMPLES, rows * SAMPLES);
        let colour = vec![background.map(|c| c as f32); columns * rows];
        Self { columns, first: first * SAMPLES, rows, colour, depth: vec![0.0; columns * rows] }
    }

    /// Sample rows of the band whose centres lie in `low..=high` (sample coordinates).
    fn rows_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let first = self.first as f64;
        let start = (low - 0.5 - first).ceil().clamp(0.0, self.rows as f64) as usize;
        let end = ((high - 0.5 - first).floor() + 1.0).clamp(0.0, self.rows as f64) as usize;
        start..end.max(start)
    }

    /// Sample columns whose centres lie in `low..=high`.
    fn columns_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let start = (low - 0.5).ceil().clamp(0.0, self.columns as f64) as usize;
        let end = ((high - 0.5).floor() + 1.0).clamp(0.0, self.columns as f64) as usize;
        start..end.max(start)
    }

    fn triangle(&mut self, paint: Paint, corners: &[Vertex; 3]) {
        let s = SAMPLES as f64;
        let [a, b, c] = corners.map(|v| Vec2::new(v.place[0] * s, v.place[1] * s));
        let cross = |p: Vec2, q: Vec2| p.x * q.y - p.y * q.x;
        let twice_area = cross(b - a, c - a);
        if twice_area == 0.0 {
            return;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        // Weights of the corners are linear over the picture, the depth too.
        let per_area = 1.0 / twice_area;
        let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| (p, (q - p) * per_area));
        let deep = corners.map(|v| v.place[2]);
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| (p, q.y, (q.x - p.x) / (q.y - p.y)));
        for row in self.rows_within(low.y, high.y) {
            let y = (self.first + row) as f64 + 0.5;
            // What the sides cut out of this row, a little wider for rounding: slanting slivers would else cost their whole box.
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (p, end, slope) in edges {
                if (p.y <= y) != (end <= y) {
                    let x = p.x + (y - p.y) * slope;
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let columns = self.columns_within((left - ROUNDING).max(low.x), (right + ROUNDING).min(high.x));
            if columns.is_empty() {
                continue;
            }
            let in_row = sides.map(|(p, d)| d.x * (y - p.y) + d.y * p.x);
            let slopes = sides.map(|(_, d)| d.y);
            // Samples of a pixel beside each other share their shade: it costs more than all the rest.
            let mut shaded: Option<(usize, [f32; 3])> = None;
            for column in columns {
                let x = column as f64 + 0.5;
                let weight = [in_row[0] - slopes[0] * x, in_row[1] - slopes[1] * x, in_row[2] - slopes[2] * x];
                if weight[0] < 0.0 || weight[1] < 0.0 || weight[2] < 0.0 {
                    continue;
                }
                let depth = weight[0] * deep[0] + weight[1] * deep[1] + weight[2] * deep[2];
                let index = row * self.columns + column;
                if depth as f32 <= self.depth[index] {
                    continue;
                }
                if let Some((_, shade)) = shaded.filter(|s| s.0 == column / SAMPLES) {
                    (self.depth[index], self.colour[index]) = (depth as f32, shade);
                    continue;
                }
                // Depth is the inverse distance, so weights over distance make attributes right in perspective.
                let [u, v, w] = [weight[0] * deep[0] / depth, weight[1] * deep[1] / depth, weight[2] * deep[2] / depth];
                let normal = corners[0].normal * u + corners[1].normal * v + corners[2].normal * w;
                let base = match paint {
                    Paint::Solid(rgb) => rgb,
                    Paint::Deviation => {
                        colour::deviation(u * corners[0].value + v * corners[1].value + w * corners[2].value)
                    }
                };
                self.depth[index] = depth as f32;
                let shade = shade(base, &normal, matches!(paint, Paint::Deviation)).map(|c| c as f32);
                shaded = Some((column / SAMPLES, shade));
                self.colour[index] = shade;
            }
        }
    }

    fn segment(&mut self, line: &PenLine, number: usize, tested: bool) {
        let s = SAMPLES as f64;
        let half = (0.5 * line.width * s).max(0.5);
        let ends = [line.points[number], line.points[number + 1]];
        let [a, b] = [0, 1].map(|k: usize| Vec2::new(ends[k][0] * s, ends[k][1] * s));
        let d = b - a;
        let length_sq = d.norm_squared();
        for row in self.rows_within(a.y.min(b.y) - half, a.y.max(b.y) + half) {
            let y = (self.first + row) as f64 + 0.5;
            // The stretch of the segment that can reach this row, then its extent in x.
            let (mut t0, mut t1) = (0.0f64, 1.0f64);
            if d.y.abs() > f64::EPSILON * length_sq.sqrt() {
                let (p, q) = ((y - half - a.y) / d.y, (y + half - a.y) / d.y);
                (t0, t1) = (p.min(q).clamp(0.0, 1.0), p.max(q).clamp(0.0, 1.0));
            }
            let (x0, x1) = (a.x + t0 * d.x, a.x + t1 * d.x);
            for column in self.columns_within(x0.min(x1) - half, x0.max(x1) + half) {
                let p = Vec2::new(column as f64 + 0.5, y);
                let t = if length_sq > 0.0 { ((p - a).dot(&d) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
                let near = |q: Vec2| (p - q).norm_squared() <= half * half;
                // The joint belongs to the segment before, or half-transparent lines would show it twice.
                if !near(a + d * t) || (number > 0 && near(a)) {
                    continue;
                }
                let index = row * self.columns + column;
                let depth = ends[0][2] + t * (ends[1][2] - ends[0][2]);
                if !tested || depth as f32 >= self.depth[index] {
                    self.blend(index, line.colour, line.alpha);
                }
            }
        }
    }

    fn fill(&mut self, fill: &Fill) {
        let s = SAMPLES as f64;
        if !fill.loops.iter().flatten().all(|p| p.x.is_finite() && p.y.is_finite()) {
            return;
        }
        let all = fill.loops.iter().flat_map(|l| (0..l.len()).map(move |i| (l[i] * s, l[(i + 1) % l.len()] * s)));
        // Those that cross the band.
        let (top, bottom) = (self.first as f64, (self.first + self.rows) as f64);
        let sides: Vec<(Vec2, Vec2)> = all.filter(|(a, b)| a.y.min(b.y) <= bottom && a.y.max(b.y) >= top).collect();
        let low = sides.iter().map(|(a, b)| a.y.min(b.y)).fold(f64::INFINITY, f64::min);
        let high = sides.iter().map(|(a, b)| a.y.max(b.y)).fold(f64::NEG_INFINITY, f64::max);
        for row in self.rows_within(low, high) {
            let y = (self.first + row) as f64 + 0.5;
            let mut crossings: Vec<f64> = sides
                .iter()
                .filter(|(a, b)| (a.y <= y) != (b.y <= y))
                .map(|(a, b)| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x))
                .collect();
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                for column in self.columns_within(pair[0], pair[1]) {
                    self.blend(row * self.columns + column, fill.colour, fill.alpha);
                }
            }
        }
    }

    fn blend(&mut self, index: usize, colour: Rgb, alpha: f64) {
        let alpha = alpha as f32;
        for (under, over) in self.colour[index].iter_mut().zip(colour) {
            *under += (over as f32 - *under) * alpha;
        }
    }

    fn pixels(&self) -> Vec<[u8; 3]> {
        let (width, height) = (self.columns / SAMPLES, self.rows / SAMPLES);
        let mut out = Vec::with_capacity(width * height);
        // Most pixels are like the one before: paper, or one colour.
        let mut last = ([f32::NAN; 3], [0; 3]);
        for y in 0..height {
            for x in 0..width {
                let mut sum = [0.0f32; 3];
                for row in y * SAMPLES..(y + 1) * SAMPLES {
                    for sample in &self.colour[row * self.columns + x * SAMPLES..][..SAMPLES] {
                        for k in 0..3 {
                            sum[k] += sample[k];
                        }
                    }
                }
                if sum != last.0 {
                    last = (sum, colour::bytes(sum.map(|c| f64::from(c) / (SAMPLES * SAMPLES) as f64)));
                }
                out.push(last.1);
            }
        }
        out
    }
}

/// Light on a surface seen from +z: sky and ground, one soft lamp from the upper left, a little gloss. Maps
/// (`plain`) get weaker light, or the legend's colours could not be recognised.
fn shade(base: Rgb, normal: &Vec3, plain: bool) -> Rgb {
    const LAMP: [f64; 3] = [-0.436, 0.581, 0.687];
    let length = normal.norm();
    let n = if length > 0.0 { normal / length } else { Vec3::z() };
    let n = if n.z < 0.0 { -n } else { n };
    let lamp = Vec3::from(LAMP);
    let sky = 0.5 + 0.5 * n.y;
    let lit = n.dot(&lamp);
    // Half-way between Lambert and wrapped light: no hard edge between light and shadow.
    let soft = ((lit + 0.35) / 1.35).max(0.0);
    let (ambient, light, gloss) = if plain { (0.66, 0.38, 0.05) } else { (0.58, 0.50, 0.14) };
    let half = (lamp + Vec3::z()).normalize();
    let shine = gloss * n.dot(&half).max(0.0).powi(40);
    let level = ambient * (0.72 + 0.28 * sky) + light * soft;
    base.map(|c| (c * level + shine).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(x: f64, y: f64, depth: f64) -> Vertex {
        Vertex { place: [x, y, depth], normal: Vec3::z(), value: 0.0 }
    }

    fn square(paint: Paint, low: f64, high: f64, depth: f64) -> [(Paint, [Vertex; 3]); 2] {
        let v = |x, y| vertex(x, y, depth);
        [(paint, [v(low, low), v(high, low), v(high, high)]), (paint, [v(low, low), v(high, high), v(low, high)])]
    }

    #[test]
    fn nearer_triangles_hide_farther_ones_whatever_the_order() {
        let mut drawing = Drawing::new(40, 40);
        drawing.triangles.extend(square(Paint::Solid([0.0, 1.0, 0.0]), 10.0, 30.0, 2.0));
        drawing.triangles.extend(square(Paint::Solid([1.0, 0.0, 0.0]), 0.0, 40.0, 1.0));
        let picture = drawing.render();
        let [r, g, _] = picture.pixels[20 * 40 + 20];
        assert!(g > 100 && g > r + 60);
        let [r, g, _] = picture.pixels[5 * 40 + 5];
        assert!(r > 100 && r > g + 60);
    }

    #[test]
    fn lines_are_hidden_behind_triangles_and_overlays_are_not() {
        let mut drawing = Drawing::new(40, 40);
        drawing.triangles.extend(square(Paint::Solid([1.0; 3]), 10.0, 30.0, 2.0));
        let points = vec![[0.0, 20.0, 1.0], [40.0, 20.0, 1.0]];
        drawing.lines.push(PenLine { points, width: 3.0, colour: [0.0; 3], alpha: 1.0 });
        let picture = drawing.render();
        assert_eq!(picture.pixels[20 * 40 + 5], [0; 3]);
        assert!(picture.pixels[20 * 40 + 20][0] > 150);
        drawing.stroke(&[Vec2::new(0.0, 20.0), Vec2::new(40.0, 20.0)], 3.0, [0.0; 3], 1.0);
        assert_eq!(drawing.render().pixels[20 * 40 + 20], [0; 3]);
    }

    #[test]
    fn an_even_odd_fill_covers_its_area_and_leaves_its_hole() {
        let mut drawing = Drawing::new(60, 60);
        let ring = |a: f64, b: f64| vec![Vec2::new(a, a), Vec2::new(b, a), Vec2::new(b, b), Vec2::new(a, b)];
        drawing.fill(vec![ring(10.0, 50.0), ring(20.0, 40.0)], [0.0; 3], 1.0);
        let black = drawing.render().pixels.iter().filter(|p| **p == [0; 3]).count();
        assert_eq!(black, 40 * 40 - 20 * 20);
    }

    #[test]
    fn coordinates_that_are_not_numbers_are_left_out() {
        let mut drawing = Drawing::new(20, 20);
        drawing
            .triangles
            .push((Paint::Deviation, [vertex(f64::NAN, 0.0, 1.0), vertex(9.0, 9.0, 1.0), vertex(0.0, 9.0, 1.0)]));
        drawing.stroke(&[Vec2::new(0.0, f64::INFINITY), Vec2::new(1.0, 1.0)], 2.0, [0.0; 3], 1.0);
        drawing.fill(vec![vec![Vec2::new(f64::NAN, 0.0); 3], vec![]], [0.0; 3], 1.0);
        assert!(drawing.render().pixels.iter().all(|p| *p == [255; 3]));
    }
}
