//! The nine figures of Pottmann and Wallner's paper on developables as curves of planes, made with the library.

use std::error::Error;
use std::path::Path;
use torse::draw::picture::{panels, Caption};
use torse::draw::raster::{Drawing, Image};
use torse::draw::scene::{PanelShape, Scene};
use torse::draw::stroke_font;
use torse::fit::planes::correction::corrected;
use torse::fit::planes::linear_system::{planes, PlaneDatum, PlanesOptions};
use torse::fit::planes::multiresolution::trigonometric::{cone_strip, ConeStrip, RadiusSign};
use torse::fit::planes::regression::{regression_free, ForbiddenZone, RegressionOptions};
use torse::fit::planes::rulings::{slope_fit, RulingDatum, SlopeData, SlopeOptions};
use torse::geom::measure::{LineMeasure, Measure};
use torse::geom::mesh::Mesh;
use torse::geom::{Vec2, Vec3};
use torse::io::png;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::tessellate::strip::{border_line, grid, mesh, ruling_lines};
use torse::torse::dual::DualCurve;
use torse::torse::form::PanelKind;
use torse::torse::strip::Strip;

type Done<T> = Result<T, Box<dyn Error>>;

const INK: [f64; 3] = [0.1, 0.12, 0.16];
const GREY: [f64; 3] = [0.6, 0.63, 0.68];
const RED: [f64; 3] = [0.78, 0.16, 0.12];
const BLUE: [f64; 3] = [0.15, 0.35, 0.7];
const ZONE: [f64; 3] = [0.9, 0.9, 0.78];

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Done<()> {
    let save = |name: &str, image: &Image| -> Done<()> { Ok(std::fs::write(folder.join(name), png::write(image)?)?) };
    save("figure-1.png", &figure_1()?)?;
    let (before, after) = figure_2()?;
    save("figure-2-left.png", &before)?;
    save("figure-2-right.png", &after)?;
    let (without, with) = figure_3()?;
    save("figure-3-left.png", &without)?;
    save("figure-3-right.png", &with)?;
    save("figure-4.png", &figure_4())?;
    let control = controlled()?;
    save("figure-5-left.png", &figure_5(&control.0, "line of regression of the free fit")?)?;
    save("figure-5-right.png", &figure_5(&control.1, "pushed out of the forbidden area")?)?;
    save("figure-6.png", &figure_6(&control))?;
    save("figure-7.png", &figure_7(&control.1)?)?;
    save("figure-8.png", &figure_8())?;
    save("figure-9.png", &figure_9()?)?;
    for (name, count) in [("figure-9-fine.png", 16), ("figure-9-coarse.png", 4)] {
        save(name, &figure_9_strip(count)?)?;
    }
    notes(&save)
}

/// Figures 4.9 and 4.10 of \[W15\]: four planes as control elements, and where the regression curve goes when one of them
/// moves a little.
fn notes(save: &dyn Fn(&str, &Image) -> Done<()>) -> Done<()> {
    // The third coordinate is the parameter itself.
    let third = 1.0 / 3.0;
    let control = |last: f64| [[0.5, -0.3, -1.0], [-0.25, 0.15, -third], [-0.2, -0.1, third], [0.55, last, 1.0]];
    let bezier = |last: f64| DualCurve::graph(3, [[-1.0; 4], [1.0; 4]].concat(), &control(last));
    let curve = bezier(0.3)?;
    let mut shapes = vec![shape(&between("4.9", &curve)?, 0.08)];
    for (k, plane) in control(0.3).iter().enumerate() {
        // A line of the plane beside the ruling that it is nearest to.
        let r = curve.ruling(2.0 * k as f64 * third - 1.0)?;
        let z = |x: f64| plane[0] + plane[1] * x + plane[2] * r.point.y;
        let (p, d) = (Vec3::new(0.0, r.point.y, z(0.0)), Vec3::new(1.0, 0.0, plane[1]));
        shapes.push(plane_piece(plane, (&p, &d)));
    }
    save(
        "notes-4-09.png",
        &perspective(shapes, Vec::new(), "Four planes as control elements", "a dual Bézier curve of degree 3"),
    )?;
    for (letter, last) in [("a", 0.3), ("b", 0.1), ("c", -0.2)] {
        let title = format!("Rulings and regression curve, last plane at {last}");
        save(&format!("notes-4-10-{letter}.png"), &figure_5(&bezier(last)?, &title)?)?;
    }
    Ok(())
}

/// The surface that the figures approximate, as `z = u0 + u1 x + u2 y`; its slope u2 is s.
fn given(s: f64) -> [f64; 3] {
    [0.7 * s * s + 0.05 * (3.0 * s).sin(), 0.15 * s * s, s]
}

fn region() -> Done<Measure> {
    Ok(Measure::rectangle([-1.0, 1.0], [-1.0, 1.0])?)
}

fn data(count: usize, parameter: impl Fn(f64) -> f64) -> Done<Vec<PlaneDatum>> {
    let measure = region()?;
    Ok((0..count)
        .map(|i| {
            let s = i as f64 / (count - 1) as f64;
            PlaneDatum { plane: given(1.6 * s - 0.8), parameter: parameter(s), measure, weight: 1.0 }
        })
        .collect())
}

/// A surface between the planes x = ±1 as a strip.
fn between(name: &str, curve: &DualCurve) -> Done<Strip> {
    let patch: Surface = curve.rational_tensor_product(&[1.0, 1.0, 0.0, 0.0], &[-1.0, 1.0, 0.0, 0.0])?;
    let row = |j: f64| patch.curve_at_v(j);
    Ok(Strip::between(name, PanelKind::Torse, &row(0.0), &row(1.0))?)
}

fn shape(strip: &Strip, spacing: f64) -> PanelShape {
    let (u, v) = grid(strip);
    PanelShape {
        name: String::new(),
        mesh: mesh(strip, &u, &v, &[]),
        rulings: ruling_lines(strip, spacing),
        borders: vec![border_line(strip)],
        marked: false,
    }
}

/// A rectangle of a plane around a point of the surface.
fn plane_piece(plane: &[f64; 3], ruling: (&Vec3, &Vec3)) -> PanelShape {
    let z = |x: f64, y: f64| Vec3::new(x, y, plane[0] + plane[1] * x + plane[2] * y);
    let (p, d) = ruling;
    let at = |x: f64| p + d * ((x - p.x) / d.x);
    let (a, b) = (at(-1.0), at(1.0));
    let corners = [z(a.x, a.y - 0.12), z(b.x, b.y - 0.12), z(b.x, b.y + 0.12), z(a.x, a.y + 0.12)];
    let n = Vec3::new(-plane[1], -plane[2], 1.0).normalize();
    let mut border = corners.to_vec();
    border.push(corners[0]);
    PanelShape {
        mesh: Mesh {
            positions: corners.to_vec(),
            normals: vec![n; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            values: Vec::new(),
        },
        borders: vec![border],
        ..PanelShape::default()
    }
}

fn perspective(shapes: Vec<PanelShape>, guides: Vec<Vec<Vec3>>, title: &str, note: &str) -> Image {
    let scene = Scene { panels: shapes, guides, ..Scene::default() };
    let caption = Caption { width: 800, title: title.into(), note: note.into() };
    panels(&scene, &Vec3::new(1.4, -1.9, 1.5), &caption)
}

fn figure_1() -> Done<Image> {
    let given = data(9, |s| s)?;
    let knots = Knots::uniform(3, 3, 0.0, 1.0)?;
    let fit = planes(&given, &knots, &PlanesOptions::default())?;
    let strip = between("1", &fit.curve)?;
    let mut shapes = vec![shape(&strip, 0.08)];
    for d in &given {
        let r = fit.curve.ruling(d.parameter)?;
        shapes.push(plane_piece(&d.plane, (&r.point, &r.direction)));
    }
    let note = format!("9 planes, {} control planes", knots.control_count());
    Ok(perspective(shapes, Vec::new(), "Planes, and a developable near them", &note))
}

fn figure_2() -> Done<(Image, Image)> {
    let given = data(41, |s| s.powf(1.6))?;
    let knots = Knots::uniform(3, 2, 0.0, 1.0)?;
    let picture = |count: usize, title: &str| -> Done<Image> {
        let c = corrected(&given, &knots, &PlanesOptions::default(), count)?;
        let strip = between("2", &c.fit.curve)?;
        let error = (c.fit.cost / 41.0).sqrt();
        let guides = given.iter().step_by(4).map(|d| ruling_of(d.plane[2])).collect();
        Ok(perspective(vec![shape(&strip, 0.08)], guides, title, &format!("5 basis functions, mean error {error:.1e}")))
    };
    Ok((picture(0, "Original parameter values")?, picture(60, "After parameter correction")?))
}

/// The ruling of the given surface with slope `s` between x = −1 and x = 1.
fn ruling_of(s: f64) -> Vec<Vec3> {
    let (d0, d1) = (1.4 * s + 0.15 * (3.0 * s).cos(), 0.3 * s);
    let u = given(s);
    [-1.0, 1.0]
        .map(|x| {
            let y = -(d0 + d1 * x);
            Vec3::new(x, y, u[0] + u[1] * x + u[2] * y)
        })
        .to_vec()
}

fn slope_data() -> Done<SlopeData> {
    let mut planes = data(13, |s| 1.6 * s - 0.8)?;
    planes.iter_mut().for_each(|d| d.parameter = d.plane[2]);
    Ok(SlopeData { planes, ..SlopeData::default() })
}

fn figure_3() -> Done<(Image, Image)> {
    let knots = Knots::uniform(3, 3, -0.8, 0.8)?;
    let mut data = slope_data()?;
    let wanted: [(f64, [f64; 2]); 2] = [(-0.4, [-0.4, -0.3]), (0.45, [0.6, 0.35])];
    let lines = |s: f64, h: [f64; 2]| -> Vec<Vec3> {
        let u = given(s);
        [-1.0, 1.0].map(|x| (x, -(h[0] + h[1] * x))).map(|(x, y)| Vec3::new(x, y, u[0] + u[1] * x + s * y)).to_vec()
    };
    let guides: Vec<Vec<Vec3>> = wanted.iter().map(|(s, h)| lines(*s, *h)).collect();
    let free = slope_fit(&data, &knots, &SlopeOptions::default())?;
    let along = LineMeasure::interval(-1.0, 1.0)?;
    for (parameter, ground_plan) in wanted {
        data.rulings.push(RulingDatum { parameter, ground_plan, along, weight: 1.0 });
    }
    let bound = slope_fit(&data, &knots, &SlopeOptions::default())?;
    let picture = |c: &DualCurve, title: &str| -> Done<Image> {
        Ok(perspective(vec![shape(&between("3", c)?, 0.08)], guides.clone(), title, "two wanted rulings in red"))
    };
    Ok((picture(&free.curve, "Only tangent planes")?, picture(&bound.curve, "Planes and two rulings")?))
}

/// A plot: the square around `centre` of half width `half` on a canvas of the given size.
struct Plot {
    drawing: Drawing,
    centre: Vec2,
    scale: Vec2,
}

impl Plot {
    fn new(width: usize, height: usize, low: Vec2, high: Vec2, title: &str) -> Self {
        let mut drawing = Drawing::new(width, height);
        let size = f64::min(20.0, (width as f64 - 60.0) / stroke_font::width(title, 1.0));
        drawing.text(title, Vec2::new(30.0, 42.0), size, INK);
        let size = Vec2::new(width as f64 - 80.0, height as f64 - 130.0);
        Self { drawing, centre: (low + high) * 0.5, scale: size.component_div(&(high - low)) }
    }

    fn at(&self, p: Vec2) -> Vec2 {
        let d = (p - self.centre).component_mul(&self.scale);
        Vec2::new(self.drawing.width as f64 * 0.5 + d.x, self.drawing.height as f64 * 0.5 + 25.0 - d.y)
    }

    fn line(&mut self, points: &[Vec2], width: f64, colour: [f64; 3]) {
        let points: Vec<Vec2> = points.iter().map(|p| self.at(*p)).collect();
        self.drawing.stroke(&points, width, colour, 1.0);
    }

    fn area(&mut self, points: &[Vec2], colour: [f64; 3]) {
        let points = points.iter().map(|p| self.at(*p)).collect();
        self.drawing.fill(vec![points], colour, 1.0);
    }

    fn word(&mut self, text: &str, p: Vec2) {
        let p = self.at(p);
        self.drawing.text(text, p, 17.0, INK);
    }
}

/// Both wedges in which (u0'', u1'') may lie, for the slab [a, b].
fn wedges(plot: &mut Plot, a: f64, b: f64, size: f64) {
    for sign in [1.0, -1.0] {
        // Corners where u0'' + a u1'' = 0 and u0'' + b u1'' = 0.
        let corner = |c: f64, v: f64| Vec2::new(-c * v, v) * sign;
        let far = Vec2::new(size * sign, 0.0);
        let (p, q) = (corner(a, size), corner(b, -size));
        let points = [Vec2::zeros(), p, Vec2::new(far.x, p.y), Vec2::new(far.x, q.y), q];
        plot.area(&points, [0.82, 0.84, 0.88]);
    }
    plot.line(&[Vec2::new(-size, 0.0), Vec2::new(size, 0.0)], 1.0, GREY);
    plot.line(&[Vec2::new(0.0, -size), Vec2::new(0.0, size)], 1.0, GREY);
}

fn figure_4() -> Image {
    let mut plot = Plot::new(
        800,
        600,
        Vec2::new(-1.0, -1.0),
        Vec2::new(1.0, 1.0),
        "Forbidden region (white) for x0 = u0'', x1 = u1''",
    );
    wedges(&mut plot, -0.6, 0.4, 1.0);
    plot.word("x0", Vec2::new(0.93, 0.03));
    plot.word("x1", Vec2::new(0.03, 0.93));
    plot.drawing.render()
}

/// Fits without and with control of the regression curve.
fn controlled() -> Done<(DualCurve, DualCurve)> {
    let knots = Knots::uniform(3, 5, -0.8, 0.8)?;
    let mut data = slope_data()?;
    for d in &mut data.planes {
        let s = d.plane[2];
        d.plane[1] += 0.12 * (4.0 * s).sin();
    }
    let free = slope_fit(&data, &knots, &SlopeOptions::default())?;
    let options = RegressionOptions { margin: Some(0.05), ..RegressionOptions::default() };
    let kept = regression_free(&data, &knots, &ForbiddenZone::Slab(-1.0, 1.0), &options)?;
    Ok((free.curve, kept.fit.curve))
}

/// Regression curve in pieces inside a window.
fn regression(curve: &DualCurve, window: f64) -> Vec<Vec<Vec3>> {
    let (a, b) = curve.domain();
    let mut out = vec![Vec::new()];
    for i in 0..=2000 {
        let p = curve.regression_point(a + (b - a) * f64::from(i) / 2000.0);
        let x = Vec3::new(p[0], p[1], p[2]) / p[3];
        if x.x.abs() < window && x.y.abs() < window {
            let last = out.len() - 1;
            if out[last].last().is_some_and(|q: &Vec3| (q - x).norm() > 0.3 * window) {
                out.push(vec![x]);
            } else {
                out[last].push(x);
            }
        } else if out.last().is_some_and(|l| !l.is_empty()) {
            out.push(Vec::new());
        }
    }
    out.retain(|l| l.len() > 1);
    out
}

fn figure_5(curve: &DualCurve, title: &str) -> Done<Image> {
    const WINDOW: f64 = 3.0;
    let mut plot = Plot::new(720, 720, Vec2::new(-WINDOW, -WINDOW), Vec2::new(WINDOW, WINDOW), title);
    plot.area(
        &[Vec2::new(-1.0, -WINDOW), Vec2::new(1.0, -WINDOW), Vec2::new(1.0, WINDOW), Vec2::new(-1.0, WINDOW)],
        ZONE,
    );
    let (a, b) = curve.domain();
    for i in 0..=60 {
        let d = curve.graph_jet(a + (b - a) * f64::from(i) / 60.0)[1];
        let at = |x: f64| Vec2::new(x, -(d[0] + d[1] * x));
        plot.line(&[at(-WINDOW), at(WINDOW)], 1.0, GREY);
        plot.line(&[at(-1.0), at(1.0)], 1.6, BLUE);
    }
    for part in regression(curve, WINDOW) {
        let points: Vec<Vec2> = part.iter().map(|p| Vec2::new(p.x, p.y)).collect();
        plot.line(&points, 3.5, RED);
    }
    Ok(plot.drawing.render())
}

fn figure_6(curves: &(DualCurve, DualCurve)) -> Image {
    let second = |c: &DualCurve| -> Vec<Vec2> {
        let (a, b) = c.domain();
        (0..=800).map(|i| c.graph_jet(a + (b - a) * f64::from(i) / 800.0)[2]).map(|u| Vec2::new(u[0], u[1])).collect()
    };
    let (free, kept) = (second(&curves.0), second(&curves.1));
    let size = free.iter().chain(&kept).fold(0.1f64, |m, p| m.max(p.amax())) * 1.1;
    let title = "(u0'', u1'') before (black) and after (red)";
    let mut plot = Plot::new(800, 720, Vec2::new(-size, -size), Vec2::new(size, size), title);
    wedges(&mut plot, -1.0, 1.0, size);
    plot.line(&free, 2.5, INK);
    plot.line(&kept, 3.0, RED);
    plot.drawing.render()
}

fn figure_7(curve: &DualCurve) -> Done<Image> {
    let strip = between("7", curve)?;
    let guides = regression(curve, 1.7);
    Ok(perspective(
        vec![shape(&strip, 0.08)],
        guides,
        "Line of regression outside the strip",
        "red: line of regression",
    ))
}

fn figure_8() -> Image {
    let mut plot =
        Plot::new(800, 560, Vec2::new(-1.0, -0.2), Vec2::new(1.2, 1.2), "Deviation between planes U1 and U2");
    for z in [0.0, 1.0] {
        plot.line(&[Vec2::new(-0.9, z), Vec2::new(1.1, z)], 1.0, GREY);
        plot.word(if z > 0.5 { "z = 1" } else { "z = 0" }, Vec2::new(0.9, z + 0.03));
    }
    let (first, second) = ([-0.4, -0.1], [0.1, 0.6]);
    for (line, colour, name) in [(first, INK, "U1"), (second, BLUE, "U2")] {
        let at = |z: f64| Vec2::new(line[0] + (line[1] - line[0]) * z, z);
        plot.line(&[at(-0.15), at(1.15)], 3.0, colour);
        plot.word(name, at(1.12) + Vec2::new(0.04, 0.0));
    }
    for (k, z) in [0.0, 1.0].into_iter().enumerate() {
        plot.line(&[Vec2::new(first[k], z), Vec2::new(second[k], z)], 5.0, RED);
        plot.word(if k == 0 { "h0" } else { "h1" }, Vec2::new(0.5 * (first[k] + second[k]) - 0.03, z + 0.04));
    }
    plot.drawing.render()
}

fn support(level: usize, phi: f64) -> f64 {
    if level == 0 {
        2.0 + 0.2 * (2.0 * phi).cos() + 0.08 * (3.0 * phi).sin()
    } else {
        1.3 + 0.1 * (2.0 * phi).cos() + 0.1 * (3.0 * phi).sin()
    }
}

fn cones(count: usize) -> Done<ConeStrip> {
    let angles: Vec<f64> = (0..=count).map(|i| 0.2 + 2.4 * i as f64 / count as f64).collect();
    Ok(cone_strip(&|p| support(0, p), &|p| support(1, p), &angles, RadiusSign::Free)?)
}

fn figure_9() -> Done<Image> {
    let title = "Support and radii: z = 0 black, z = 1 blue";
    let mut plot = Plot::new(800, 540, Vec2::new(0.1, 0.0), Vec2::new(2.7, 3.3), title);
    for (count, width) in [(16, 2.0), (4, 1.0)] {
        let strip = cones(count)?;
        for (contour, colour) in [(&strip.bottom, INK), (&strip.top, BLUE)] {
            let h: Vec<Vec2> =
                (0..=300).map(|i| 0.2 + 0.008 * f64::from(i)).map(|p| Vec2::new(p, contour.value(p).0)).collect();
            plot.line(&h, 1.5 * width, colour);
            for arc in contour.arcs() {
                plot.line(&[Vec2::new(arc.angles.0, arc.radius), Vec2::new(arc.angles.1, arc.radius)], width, colour);
            }
        }
    }
    Ok(plot.drawing.render())
}

fn figure_9_strip(count: usize) -> Done<Image> {
    let strip = cones(count)?;
    let mut shapes = Vec::new();
    for w in strip.bottom.angles().windows(2) {
        let mut mesh = Mesh::default();
        let mut rulings = Vec::new();
        for i in 0..=12 {
            let phi = w[0] + (w[1] - w[0]) * f64::from(i) / 12.0;
            let (p, q) = (strip.bottom.point(phi), strip.top.point(phi));
            let (a, b) = (Vec3::new(p[0], p[1], 0.0), Vec3::new(q[0], q[1], 1.0));
            let n = Vec3::new(phi.cos(), phi.sin(), strip.bottom.value(phi).0 - strip.top.value(phi).0).normalize();
            mesh.positions.extend([a, b]);
            mesh.normals.extend([n, n]);
            if i > 0 {
                let k = 2 * i as u32;
                mesh.triangles.extend([[k - 2, k, k + 1], [k - 2, k + 1, k - 1]]);
            }
            if i == 0 || i == 12 {
                rulings.push([a, b]);
            }
        }
        shapes.push(PanelShape { mesh, rulings, ..PanelShape::default() });
    }
    let scene = Scene { panels: shapes, ..Scene::default() };
    let caption = Caption {
        width: 800,
        title: format!("{count} oblique circular cones"),
        note: "circular sections in z = 0 and z = 1".into(),
    };
    Ok(panels(&scene, &Vec3::new(0.3, 2.2, 1.4), &caption))
}
