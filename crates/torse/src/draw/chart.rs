//! Charts with two logarithmic axes: quantities over a tolerance.

use super::colour::{self, Rgb};
use super::raster::{Drawing, Image};
use super::stroke_font;
use crate::geom::Vec2;

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points (x, y), both positive; others are left out.
    pub points: Vec<[f64; 2]>,
    /// Whether the points get marks and a full line (measured) or only a thin line (theory).
    pub measured: bool,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// First line, upper left.
    pub title: String,
    /// What runs to the right, with its unit.
    pub x: String,
    /// What runs upwards, with its unit.
    pub y: String,
    /// Lines.
    pub series: Vec<Series>,
}

const SIZE: [usize; 2] = [1000, 640];
const INK: Rgb = [0.10, 0.12, 0.16];
const GRID: Rgb = [0.86, 0.88, 0.90];
/// Share of ink in the colours of lines.
const LINES: f64 = 0.35;
/// Space left, right, above and below the axes, px.
const ROOM: [f64; 4] = [90.0, 40.0, 110.0, 80.0];
/// Height of capitals, px.
const TITLE: f64 = 20.0;
/// See [`TITLE`].
const SMALL: f64 = 15.0;
/// Ticks of a decade, from coarse to fine: the coarsest that gives enough of them.
const TICKS: [&[f64]; 4] = [
    &[1.0],
    &[1.0, 2.0, 5.0],
    &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
    &[1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0, 8.5, 9.0, 9.5],
];
/// Ticks of an axis are at least so many where that is possible.
const ENOUGH_TICKS: usize = 4;

/// One logarithmic axis: from data to pixels.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// Axis over the data, widened to ticks.
    fn over(data: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let (mut low, mut high) = data
            .filter(|x| *x > 0.0 && x.is_finite())
            .fold((f64::INFINITY, 0.0), |(a, b), x: f64| (x.min(a), x.max(b)));
        if low > high {
            return None;
        }
        // A hair of room, and at least a factor between the ends.
        (low, high) = (low / 1.15, high * 1.15);
        Some(Self { low: low.log10(), high: high.log10(), from, to })
    }

    fn place(&self, x: f64) -> f64 {
        self.from + (self.to - self.from) * (x.log10() - self.low) / (self.high - self.low)
    }

    fn ticks(&self) -> Vec<f64> {
        let with = |decade: &[f64]| -> Vec<f64> {
            let decades = self.low.floor() as i32..=self.high.ceil() as i32;
            let all = decades.flat_map(|d| decade.iter().map(move |t| t * 10f64.powi(d)));
            all.filter(|t| (self.low..=self.high).contains(&t.log10())).collect()
        };
        let found = TICKS.iter().map(|t| with(t)).find(|t| t.len() >= ENOUGH_TICKS);
        found.unwrap_or_else(|| with(TICKS[TICKS.len() - 1]))
    }
}

/// The colour of a line: those of panels are made for areas, lines are darker.
fn line_colour(k: usize) -> Rgb {
    colour::mix(colour::panel(k), INK, LINES)
}

/// Draws a chart; `None` if no series has a point.
pub fn chart(chart: &Chart) -> Option<Image> {
    let (width, height) = (SIZE[0] as f64, SIZE[1] as f64);
    let all = || chart.series.iter().flat_map(|s| &s.points);
    let x = Axis::over(all().map(|p| p[0]), ROOM[0], width - ROOM[1])?;
    let y = Axis::over(all().map(|p| p[1]), height - ROOM[3], ROOM[2])?;
    let mut d = Drawing::new(SIZE[0], SIZE[1]);
    d.text(&chart.title, Vec2::new(ROOM[0], 40.0), TITLE, INK);
    // Products with powers of ten are off by rounding: six digits are more than ticks have.
    let number = |t: f64| format!("{}", (t * 1e6).round() / 1e6);
    for t in x.ticks() {
        let at = x.place(t);
        d.stroke(&[Vec2::new(at, y.from), Vec2::new(at, y.to)], 1.0, GRID, 1.0);
        let label = number(t);
        let left = at - 0.5 * stroke_font::width(&label, SMALL);
        d.text(&label, Vec2::new(left, y.from + 24.0), SMALL, INK);
    }
    for t in y.ticks() {
        let at = y.place(t);
        d.stroke(&[Vec2::new(x.from, at), Vec2::new(x.to, at)], 1.0, GRID, 1.0);
        let label = number(t);
        let left = x.from - 12.0 - stroke_font::width(&label, SMALL);
        d.text(&label, Vec2::new(left, at + 0.5 * SMALL), SMALL, INK);
    }
    let corner = Vec2::new(x.from, y.from);
    d.stroke(&[Vec2::new(x.from, y.to), corner, Vec2::new(x.to, y.from)], 1.6, INK, 1.0);
    d.text(&chart.x, Vec2::new(x.to - stroke_font::width(&chart.x, SMALL), height - 22.0), SMALL, INK);
    d.text(&chart.y, Vec2::new(14.0, ROOM[2] - 18.0), SMALL, INK);
    // Names end where the axis does.
    let names = chart.series.iter().map(|s| stroke_font::width(&s.name, SMALL)).fold(0.0, f64::max);
    let left = x.to - names - 42.0;
    for (k, s) in chart.series.iter().enumerate() {
        let colour = line_colour(k);
        let mut points: Vec<[f64; 2]> = s.points.iter().copied().filter(|p| p[0] > 0.0 && p[1] > 0.0).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let line: Vec<Vec2> = points.iter().map(|p| Vec2::new(x.place(p[0]), y.place(p[1]))).collect();
        d.stroke(&line, if s.measured { 3.0 } else { 1.6 }, colour, 1.0);
        if s.measured {
            for p in &line {
                d.stroke(&[*p, p + Vec2::new(0.01, 0.0)], 10.0, colour, 1.0);
            }
        }
        let row = ROOM[2] - 60.0 + 24.0 * k as f64;
        d.stroke(
            &[Vec2::new(left, row - 5.0), Vec2::new(left + 30.0, row - 5.0)],
            if s.measured { 3.0 } else { 1.6 },
            colour,
            1.0,
        );
        d.text(&s.name, Vec2::new(left + 42.0, row), SMALL, INK);
    }
    Some(d.render())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_shows_its_lines_and_nothing_without_points() {
        let series = Series { name: "panels".into(), points: vec![[0.1, 30.0], [1.0, 10.0]], measured: true };
        let mut c =
            Chart { title: "count".into(), x: "tolerance, mm".into(), y: "panels".into(), series: vec![series] };
        let image = chart(&c).expect("an image");
        assert_eq!((image.width, image.height), (SIZE[0], SIZE[1]));
        let colour = colour::bytes(line_colour(0));
        assert!(image.pixels.iter().filter(|p| **p == colour).count() > 500);
        c.series[0].points = vec![[0.0, 1.0], [-1.0, f64::NAN]];
        assert!(chart(&c).is_none());
    }
}
