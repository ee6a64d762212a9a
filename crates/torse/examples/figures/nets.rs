//! The figures of a paper on B-spline control nets for developable surfaces \[FJ07\], drawn from the library.
//!
//! One PNG per figure.

use std::error::Error;
use std::path::Path;
use torse::design::interpolate::{interpolate, EndRulings, Options};
use torse::draw::camera::{Camera, Rect};
use torse::draw::colour::{self, Rgb};
use torse::draw::raster::{Drawing, Paint, PenLine, Vertex};
use torse::draw::stroke_font;
use torse::geom::{Vec2, Vec3};
use torse::io::png;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::net::{aumann, homogeneous, Net, Shape};

const WIDTH: usize = 800;
const HEIGHT: usize = 560;
const INK: Rgb = [0.13, 0.15, 0.19];
const NET: Rgb = [0.75, 0.22, 0.17];
const REGRESSION: Rgb = [0.10, 0.45, 0.25];
/// Rulings drawn across a strip, and facets between them.
const RULINGS: usize = 24;
const FACETS: usize = 4;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Outcome<()> {
    let figures = [
        ("figure-1", developable()?),
        ("figure-2", cylinder()?),
        ("figure-3", cone()?),
        ("figure-4", tangent_surface()?),
        ("figure-5", coplanarity()?),
        ("figure-6", meeting_tangents()?),
        ("figure-7", regular_net()?),
        ("figure-8", singular_segment()?),
        ("interpolation", interpolation()?),
        ("rational", rational()?),
    ];
    for (name, figure) in figures {
        std::fs::write(folder.join(format!("{name}.png")), png::write(&figure.draw().render())?)?;
    }
    Ok(())
}

/// Figure 1: c', d' and d − c lie in one plane on every ruling.
fn developable() -> Outcome<Figure> {
    let net = bezier(2.3, 1.5)?;
    let mut f = Figure::new("c', d' and d - c are coplanar on every ruling", (1.0, -1.6, 2.6));
    f.strip(&net.patch()?, colour::panel(0));
    let patch = net.patch()?;
    for u in [0.3, 0.75] {
        let (p, q) = (patch.jet(u, 0.0), patch.jet(u, 1.0));
        f.arrow(p.p, p.du * 0.22, NET);
        f.arrow(q.p, q.du * 0.22 * (p.du.norm() / q.du.norm()), NET);
        f.line(&[p.p, q.p], 4.0, NET);
        f.label("c", p.p);
        f.label("d", q.p);
    }
    Ok(f)
}

/// Figure 2: parallel rulings.
fn cylinder() -> Outcome<Figure> {
    let c = curve(3, 1, &WAVE);
    let net = Net::cylinder(c, &Vec3::new(0.3, 1.6, 1.2))?;
    let mut f = Figure::new("cylinder: the edges c d of the net are parallel", (1.0, -2.2, 1.3));
    f.strip(&net.patch()?, colour::panel(1));
    f.net(&net, true);
    Ok(f)
}

/// Figure 3: rulings through a vertex.
fn cone() -> Outcome<Figure> {
    let vertex = Vec3::new(2.2, 2.4, 2.6);
    let net = Net::cone(curve(3, 1, &WAVE), &vertex, 0.6)?;
    let mut f = Figure::new("cone: the sides of both polygons are parallel", (1.0, -2.2, 1.3));
    f.strip(&net.patch()?, colour::panel(2));
    f.net(&net, true);
    for c in &net.curve().control {
        f.line(&[Vec3::new(c[0], c[1], c[2]), vertex], 1.2, colour::mix(NET, [1.0; 3], 0.5));
    }
    f.dot(vertex, REGRESSION);
    f.label("vertex", vertex);
    Ok(f)
}

/// Figure 4: tangents of a curve, from the curve on.
fn tangent_surface() -> Outcome<Figure> {
    let r = homogeneous(&Curve {
        knots: Knots::uniform(3, 1, 0.0, 1.0)?,
        control: vec![[0., 0., 0.], [1.2, 0., 0.3], [1.6, 1.4, 0.9], [0.2, 1.8, 2.0]],
    });
    // From just off the curve: v = 0 is the polar curve for an M* just before the domain.
    let net = Net::tangent_surface(&r, -0.9, -0.02)?;
    let mut f = Figure::new("tangent surface of its regression curve", (2.0, -1.6, 1.6));
    f.strip(&net.patch()?, colour::panel(3));
    f.regression(&net, (0.0, 1.0));
    f.net(&net, false);
    Ok(f)
}

/// Figure 5: the four points of the last step but one of the de Boor schemes.
fn coplanarity() -> Outcome<Figure> {
    let net = bezier(2.3, 1.5)?;
    let mut f = Figure::new("c0, c1, d0, d1 of the last step are coplanar", (1.0, -2.2, 1.3));
    f.strip(&net.patch()?, colour::mix(colour::panel(0), [1.0; 3], 0.45));
    let u = 0.55;
    let step = |c: &Curve<4>| -> Outcome<[Vec3; 2]> {
        let n = c.knots.degree();
        let mut args = vec![u; n];
        let mut at = |x: f64| -> Outcome<Vec3> {
            args[0] = x;
            let p = c.blossom(u, &args).ok_or("wrong number of arguments")?;
            Ok(Vec3::new(p[0], p[1], p[2]) / p[3])
        };
        Ok([at(0.0)?, at(1.0)?])
    };
    let (c, d) = (step(net.curve())?, step(&net.opposite())?);
    f.line(&[c[0], c[1], d[1], d[0], c[0]], 3.0, NET);
    f.line(&net.ruling(u), 3.0, INK);
    for (name, p) in [("c0", c[0]), ("c1", c[1]), ("d0", d[0]), ("d1", d[1])] {
        f.dot(p, NET);
        f.label(name, p);
    }
    Ok(f)
}

/// Figure 6: the tangents at c(u) and d(u) meet where the blossoms agree.
fn meeting_tangents() -> Outcome<Figure> {
    let net = bezier(2.3, 1.5)?;
    let mut f = Figure::new("tangents meet at c[u, u, L*] = d[u, u, M*]", (1.0, -2.2, 1.3));
    f.strip(&net.patch()?, colour::mix(colour::panel(0), [1.0; 3], 0.3));
    let patch = net.patch()?;
    for u in [0.2, 0.6] {
        let args: Vec<f64> = [u, u, net.shape().lambda_star()].to_vec();
        let x = net.curve().blossom(u, &args).ok_or("wrong number of arguments")?;
        let meeting = Vec3::new(x[0], x[1], x[2]);
        for v in [0.0, 1.0] {
            let p = patch.point(u, v);
            f.line(&[p, meeting], 2.6, NET);
            f.dot(p, INK);
        }
        f.line(&net.ruling(u), 2.6, INK);
        f.dot(meeting, REGRESSION);
    }
    Ok(f)
}

/// Figure 7: a regular net of several pieces with its control points.
fn regular_net() -> Outcome<Figure> {
    let net = spline_net(2, -0.9, -0.55)?;
    let mut f = Figure::new("regular, of degree 2, five pieces", (0.6, -2.2, 1.5));
    f.strip(&net.patch()?, colour::panel(0));
    f.net(&net, true);
    f.breaks(&net);
    f.note = note(&net);
    Ok(f)
}

/// Figure 8: two segments, one regular, one crossed by the regression curve.
fn singular_segment() -> Outcome<Figure> {
    let c = curve(2, 2, &[[0., 0., 0.], [1., 1.1, 0.3], [2.4, 1.0, 0.8], [3.4, 0., 0.9]]);
    let shape = Shape::from_stars((0.0, 1.0), 0.93, 1.35).ok_or("no shape")?;
    let first = Vec3::new(-0.35, 1.1, 1.5);
    let net = Net::from_first(c, [first.x, first.y, first.z, 0.0], shape)?;
    let mut f = Figure::new("one regular and one singular segment", (0.4, -2.0, 1.8));
    let patch = net.patch()?;
    let ((a, b), v) = patch.domain();
    f.strip(&patch.restricted((a, 0.5), v)?, colour::panel(0));
    f.strip(&patch.restricted((0.5, b), v)?, colour::panel(1));
    f.net(&net, true);
    f.breaks(&net);
    f.regression(&net, (0.86, 1.0));
    f.note = format!("{}; green: regression curve", note(&net));
    Ok(f)
}

/// Section 4: the net through a curve with two given lines, the same with both end points given.
fn interpolation() -> Outcome<Figure> {
    let (c, rulings) = question();
    let mut f = Figure::new("a curve with its first and last ruling: two nets", (0.6, -2.0, 1.6));
    for (end_reach, base) in [(None, colour::panel(0)), (Some(1.0), colour::mix(colour::panel(1), [1.0; 3], 0.35))] {
        let options = Options { end_reach, ..Options::default() };
        let answer = interpolate(&c, &rulings, &options)?;
        for s in &answer.strips {
            f.strip(&s.strip.patch()?, base);
        }
        if let (None, Some(s)) = (end_reach, answer.strips.first()) {
            f.note = format!("{}, last reach {:.3}", note(&s.strip.net), s.end_reach);
        }
    }
    f.lines_of(&c, &rulings);
    Ok(f)
}

/// The same question where no polynomial net exists: a rational one.
fn rational() -> Outcome<Figure> {
    let c = curve(3, 1, &[[0., 0., 0.], [1., 0.1, 0.4], [2., 0.3, 0.5], [3., 0., 0.4]]);
    let rulings = EndRulings { start: Vec3::new(0.1, 1.0, 0.1), end: Vec3::new(0.1, 1.0, 0.6) };
    let answer = interpolate(&c, &rulings, &Options { reach: 0.6, ..Options::default() })?;
    let mut f = Figure::new("no polynomial net exists: a rational one does", (0.6, -2.0, 1.6));
    let count = answer.solvability.as_ref().map_or(String::new(), |s| s.pattern());
    for s in &answer.strips {
        f.strip(&s.strip.patch()?, colour::panel(2));
        f.net(&s.strip.net, true);
        f.note = format!("legs of the polygon: {count}; {}, last reach {:.3}", note(&s.strip.net), s.end_reach);
    }
    f.lines_of(&c, &rulings);
    Ok(f)
}

const WAVE: [[f64; 3]; 4] = [[0., 0., 0.], [1.2, -0.8, 1.0], [2.6, 0.9, 0.6], [4., 0., 0.]];

fn curve(degree: usize, pieces: usize, control: &[[f64; 3]]) -> Curve<4> {
    // Uniform knots on [0, 1] for the given number of control points are always valid.
    let values: Vec<f64> =
        (0..=control.len() + degree).map(|i| (i.saturating_sub(degree) as f64 / pieces as f64).min(1.0)).collect();
    let knots = Knots::new(degree, values, control.len()).expect("clamped uniform knots");
    homogeneous(&Curve { knots, control: control.to_vec() })
}

fn bezier(lambda_star: f64, m_star: f64) -> Outcome<Net> {
    let points = [[0., 0., 0.], [1.2, 0.9, 0.2], [2.6, 0.8, 0.9], [4., -0.2, 0.6]].map(Vec3::from);
    let shape = Shape::from_stars((0.0, 1.0), lambda_star, m_star).ok_or("no shape")?;
    let [lambda, mu] = shape.of_cell(0.0, 1.0);
    Ok(aumann(&points, &Vec3::new(-0.2, 1.2, 1.4), lambda, mu)?)
}

fn spline_net(degree: usize, lambda_star: f64, m_star: f64) -> Outcome<Net> {
    let control: Vec<[f64; 3]> = (0..degree + 5)
        .map(|i| i as f64 / (degree + 4) as f64)
        .map(|x| [8.0 * x, 1.1 * (6.0 * x).sin(), 0.9 * (4.0 * x).cos()])
        .collect();
    let shape = Shape::from_stars((0.0, 1.0), lambda_star, m_star).ok_or("no shape")?;
    Ok(Net::from_first(curve(degree, 5, &control), [-0.2, 0.5, 1.2, 0.0], shape)?)
}

fn question() -> (Curve<4>, EndRulings) {
    let c = curve(3, 2, &[[0., 0., 0.], [1., 0.5, 0.3], [2., 0.75, 0.6], [3., 0.5, 0.2], [4., 0., 0.125]]);
    (c, EndRulings { start: Vec3::new(0.1, 1.0, 0.35), end: Vec3::new(-0.15, 1.0, 0.25) })
}

fn note(net: &Net) -> String {
    let s = net.shape();
    // Far away is as good as infinite.
    let number = |x: f64| if x.abs() > 1e4 { format!("{x:.0e}") } else { format!("{x:.3}") };
    format!(
        "L* = {}, M* = {}: {}",
        number(s.lambda_star()),
        number(s.m_star()),
        if net.regularity().holds() { "regular" } else { "singular" }
    )
}

/// Things to be drawn, in space.
struct Figure {
    title: String,
    note: String,
    eye: Vec3,
    triangles: Vec<(Rgb, [(Vec3, Vec3); 3])>,
    lines: Vec<(Vec<Vec3>, f64, Rgb)>,
    dots: Vec<(Vec3, Rgb)>,
    labels: Vec<(String, Vec3)>,
}

impl Figure {
    fn new(title: &str, eye: (f64, f64, f64)) -> Self {
        Self {
            title: title.into(),
            note: String::new(),
            eye: Vec3::new(eye.0, eye.1, eye.2),
            triangles: vec![],
            lines: vec![],
            dots: vec![],
            labels: vec![],
        }
    }

    fn line(&mut self, points: &[Vec3], width: f64, colour: Rgb) {
        self.lines.push((points.to_vec(), width, colour));
    }

    fn dot(&mut self, p: Vec3, colour: Rgb) {
        self.dots.push((p, colour));
    }

    fn label(&mut self, text: &str, p: Vec3) {
        self.labels.push((text.into(), p));
    }

    fn arrow(&mut self, from: Vec3, along: Vec3, colour: Rgb) {
        let tip = from + along;
        let side = along.cross(&self.eye).normalize() * (0.08 * along.norm());
        self.line(&[from, tip], 3.4, colour);
        let back = tip - along * 0.2;
        self.line(&[back + side, tip, back - side], 3.4, colour);
    }

    /// A ruled patch with its rulings and boundaries.
    fn strip(&mut self, patch: &Surface, base: Rgb) {
        let ((a, b), _) = patch.domain();
        let count = RULINGS * FACETS;
        let at = |k: usize| a + (b - a) * k as f64 / count as f64;
        // Along the ruling the normal is the same where the patch is regular, and may turn over where it is not.
        const ALONG: usize = 12;
        let vertex = |k: usize, j: usize| {
            let jet = patch.jet(at(k), j as f64 / ALONG as f64);
            (jet.p, jet.normal().try_normalize(0.0).unwrap_or_else(Vec3::z))
        };
        for k in 0..count {
            for j in 0..ALONG {
                let q = [vertex(k, j), vertex(k + 1, j), vertex(k + 1, j + 1), vertex(k, j + 1)];
                self.triangles.push((base, [q[0], q[1], q[2]]));
                self.triangles.push((base, [q[0], q[2], q[3]]));
            }
            if k % FACETS == 0 {
                self.line(&[vertex(k, 0).0, vertex(k, ALONG).0], 1.1, colour::mix(base, INK, 0.5));
            }
        }
        for j in [0, ALONG] {
            let border: Vec<Vec3> = (0..=count).map(|k| vertex(k, j).0).collect();
            self.line(&border, 2.8, INK);
        }
        for k in [0, count] {
            self.line(&[vertex(k, 0).0, vertex(k, ALONG).0], 2.8, INK);
        }
    }

    /// Control polygons, and the edges between them.
    fn net(&mut self, net: &Net, edges: bool) {
        let affine = |p: &[f64; 4]| Vec3::new(p[0], p[1], p[2]) / p[3];
        let c: Vec<Vec3> = net.curve().control.iter().map(affine).collect();
        let d: Vec<Vec3> = net.opposite_points().iter().map(affine).collect();
        self.line(&c, 1.8, NET);
        self.line(&d, 1.8, NET);
        for (p, q) in c.iter().zip(&d) {
            if edges {
                self.line(&[*p, *q], 1.2, NET);
            }
            self.dot(*p, NET);
            self.dot(*q, NET);
        }
    }

    /// Rulings at which two pieces meet.
    fn breaks(&mut self, net: &Net) {
        for u in net.curve().knots.breaks() {
            self.line(&net.ruling(u), 3.2, INK);
        }
    }

    fn regression(&mut self, net: &Net, (a, b): (f64, f64)) {
        let points: Vec<Vec3> =
            (0..=80).filter_map(|k| net.regression_point(a + (b - a) * f64::from(k) / 80.0)).collect();
        self.line(&points, 4.0, REGRESSION);
    }

    fn lines_of(&mut self, c: &Curve<4>, rulings: &EndRulings) {
        let (a, b) = c.domain();
        for (u, v) in [(a, rulings.start), (b, rulings.end)] {
            let p = c.point(u);
            let p = Vec3::new(p[0], p[1], p[2]) / p[3];
            self.line(&[p - v * 0.25, p + v * 1.4], 3.2, NET);
            self.dot(p, INK);
        }
    }

    fn draw(&self) -> Drawing {
        let mut drawing = Drawing::new(WIDTH, HEIGHT);
        let points: Vec<Vec3> = self
            .triangles
            .iter()
            .flat_map(|t| t.1.map(|v| v.0))
            .chain(self.lines.iter().flat_map(|l| l.0.clone()))
            .chain(self.dots.iter().map(|d| d.0))
            .collect();
        let rect = Rect { x: 50.0, y: 100.0, width: WIDTH as f64 - 100.0, height: HEIGHT as f64 - 165.0 };
        let camera = Camera::fitting(points.iter(), &self.eye, rect);
        let size = camera.distance;
        for (base, corners) in &self.triangles {
            let corners =
                corners.map(|(p, n)| Vertex { place: camera.project(&p), normal: camera.to_view(&n), value: 0.0 });
            drawing.triangles.push((Paint::Solid(*base), corners));
        }
        for (points, width, colour) in &self.lines {
            let points = points.iter().map(|p| camera.project_towards_eye(p, 0.002 * size)).collect();
            drawing.lines.push(PenLine { points, width: *width, colour: *colour, alpha: 1.0 });
        }
        for (p, colour) in &self.dots {
            let at = camera.project_towards_eye(p, 0.003 * size);
            drawing.lines.push(PenLine {
                points: vec![at, [at[0] + 0.1, at[1], at[2]]],
                width: 9.0,
                colour: *colour,
                alpha: 1.0,
            });
        }
        for (text, p) in &self.labels {
            let at = camera.project(p);
            drawing.rimmed_text(text, Vec2::new(at[0] + 10.0, at[1] - 8.0), 17.0, INK);
        }
        // Words too long for the picture are written smaller.
        let fitting = |text: &str, size: f64| size.min((WIDTH as f64 - 60.0) / stroke_font::width(text, 1.0).max(1.0));
        drawing.text(&self.title, Vec2::new(30.0, 46.0), fitting(&self.title, 20.0), INK);
        let grey = colour::mix(INK, [1.0; 3], 0.3);
        drawing.text(&self.note, Vec2::new(30.0, HEIGHT as f64 - 20.0), fitting(&self.note, 16.0), grey);
        drawing
    }
}
