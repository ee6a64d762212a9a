//! Figures of the paper on panels along curves \[SE06\], on surfaces of our own of the same kind.

use std::error::Error;
use std::path::Path;
use torse::answer::presentation::present;
use torse::certify::claim::Status;
use torse::control::Control;
use torse::draw::picture::{self, Caption};
use torse::draw::raster::{Drawing, Image};
use torse::draw::scene::{PanelShape, Scene};
use torse::draw::stroke_font;
use torse::fit::near::tangent_envelope::{envelope_along, interval, paper_estimate, smoothed, walked, EnvelopeRuling};
use torse::geom::mesh::Mesh;
use torse::geom::{Vec2, Vec3};
use torse::io::png;
use torse::io::step::read::read;
use torse::pipeline::approximate::{of_faces, Options};
use torse::search::cover::{CurveShape, Layout, Limits, PanelCurve};
use torse::spline::surface::Surface;

type Done<T> = Result<T, Box<dyn Error>>;

const BOWL: &[u8] = include_bytes!("../../../../data/half_bowl.step");
const FUSELAGE: &[u8] = include_bytes!("../../../../data/fuselage.step");
const TORUS: &[u8] = include_bytes!("../../../../data/torus_piece.step");

const INK: [f64; 3] = [0.1, 0.12, 0.16];
const GREY: [f64; 3] = [0.6, 0.63, 0.68];
const RED: [f64; 3] = [0.78, 0.16, 0.12];
const BLUE: [f64; 3] = [0.15, 0.35, 0.7];
const AREA: [f64; 3] = [0.62, 0.76, 0.92];

/// Tolerance of the figures of one panel, mm; the bowl is 1 m wide.
const TOLERANCE: f64 = 10.0;

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Done<()> {
    let save = |name: &str, image: &Image| -> Done<()> { Ok(std::fs::write(folder.join(name), png::write(image)?)?) };
    let bowl = surface(BOWL)?;
    let rich = Study::new(&bowl, 41)?;
    save("figure-1-a.png", &regions(&bowl, &rich, &[20], "The region near one ruling")?)?;
    save("figure-1-b.png", &in_space(&bowl, &rich, &[20], "The minimal interval of one ruling", false))?;
    let some: Vec<usize> = (2..41).step_by(6).collect();
    save("figure-2-a.png", &regions(&bowl, &rich, &some, "The regions near sampled rulings")?)?;
    save("figure-2-b.png", &in_space(&bowl, &rich, &some, "Developable surface through the rulings", true))?;
    for (letter, rulings, m, share) in [("a", 4, 0, 1.0), ("b", 5, 0, 1.0), ("c", 5, 1, 1.0), ("d", 5, 1, 0.7)] {
        save(&format!("figure-3-{letter}.png"), &refinement(&bowl, rulings, m, share)?)?;
    }
    smoothing(&bowl, &rich, &save)?;
    let across = PanelCurve { name: "section".into(), shape: CurveShape::AlongU(0.5) };
    let meridian = PanelCurve { name: "meridian".into(), shape: CurveShape::AlongV(0.5) };
    save("figure-6-a.png", &input(BOWL, "Half a bowl")?)?;
    save("figure-6-b.png", &covered(BOWL, 10.0, &across)?)?;
    save("figure-6-c.png", &covered(BOWL, 3.0, &across)?)?;
    save("figure-7-a.png", &input(FUSELAGE, "Upper half of a fuselage")?)?;
    save("figure-7-b.png", &covered(FUSELAGE, 10.0, &across)?)?;
    save("covering-torus.png", &covered(TORUS, 2.0, &meridian)?)?;
    Ok(())
}

fn surface(bytes: &[u8]) -> Done<Surface> {
    Ok(read(bytes)?.faces.into_iter().next().ok_or("no face")?.surface)
}

/// Rulings along one curve with their minimal intervals.
struct Study {
    points: Vec<EnvelopeRuling>,
    ends: Vec<[f64; 2]>,
}

impl Study {
    /// Rulings along a bent curve between the sides of the bowl.
    fn new(surface: &Surface, count: usize) -> Done<Self> {
        let ((u0, u1), (v0, v1)) = surface.domain();
        let line: Vec<[f64; 2]> = (0..count)
            .map(|i| {
                let s = 0.08 + 0.84 * i as f64 / (count - 1) as f64;
                let v = 0.52 + 0.06 * (std::f64::consts::PI * s).sin();
                [u0 + (u1 - u0) * s, v0 + (v1 - v0) * v]
            })
            .collect();
        let points = envelope_along(surface, &line)?;
        let reach = 0.4 * surface.bbox().diagonal();
        let ends = points.iter().map(|p| interval(surface, p, TOLERANCE, reach)).collect();
        Ok(Self { points, ends })
    }

    fn line(&self) -> Vec<[f64; 2]> {
        self.points.iter().map(|p| p.uv).collect()
    }

    /// Borders in the parameter plane, backward and forward.
    fn borders(&self, surface: &Surface) -> [Vec<[f64; 2]>; 2] {
        [0, 1].map(|side| {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let each = self.points.iter().zip(&self.ends);
            each.map(|(p, e)| walked(surface, p, sign * e[side]).unwrap_or(p.uv)).collect()
        })
    }
}

/// A plot of the parameter plane.
struct Plot {
    drawing: Drawing,
    domain: ((f64, f64), (f64, f64)),
}

impl Plot {
    fn new(surface: &Surface, title: &str, note: &str) -> Self {
        let mut drawing = Drawing::new(800, 560);
        // Words too long for the picture are written smaller.
        let fitting = |text: &str, size: f64| size.min(720.0 / stroke_font::width(text, 1.0));
        drawing.text(title, Vec2::new(40.0, 46.0), fitting(title, 20.0), INK);
        drawing.text(note, Vec2::new(40.0, 76.0), fitting(note, 16.0), GREY);
        Self { drawing, domain: surface.domain() }
    }

    fn at(&self, p: [f64; 2]) -> Vec2 {
        let ((u0, u1), (v0, v1)) = self.domain;
        Vec2::new(40.0 + 720.0 * (p[0] - u0) / (u1 - u0), 530.0 - 430.0 * (p[1] - v0) / (v1 - v0))
    }

    fn line(&mut self, points: &[[f64; 2]], width: f64, colour: [f64; 3]) {
        let points: Vec<Vec2> = points.iter().map(|p| self.at(*p)).collect();
        self.drawing.stroke(&points, width, colour, 1.0);
    }

    fn area(&mut self, points: &[[f64; 2]], colour: [f64; 3], alpha: f64) {
        let points = points.iter().map(|p| self.at(*p)).collect();
        self.drawing.fill(vec![points], colour, alpha);
    }

    fn finished(mut self) -> Image {
        let ((u0, u1), (v0, v1)) = self.domain;
        self.line(&[[u0, v0], [u1, v0], [u1, v1], [u0, v1], [u0, v0]], 2.0, INK);
        self.drawing.render()
    }
}

/// Points of the surface within the tolerance of rulings, in the parameter plane.
fn regions(surface: &Surface, study: &Study, which: &[usize], title: &str) -> Done<Image> {
    const CELLS: usize = 320;
    let mut plot = Plot::new(surface, title, &format!("blue: within {TOLERANCE} mm of a ruling; red: the curve"));
    let ((u0, u1), (v0, v1)) = surface.domain();
    let (du, dv) = ((u1 - u0) / CELLS as f64, (v1 - v0) / CELLS as f64);
    for &k in which {
        let p = study.points.get(k).ok_or("no such ruling")?;
        let [back, forth] = study.ends[k];
        let near = |u: f64, v: f64| {
            let x = surface.point(u, v) - p.ruling.point;
            let r = x.dot(&p.ruling.direction);
            r >= -back && r <= forth && (x - p.ruling.direction * r).norm() <= TOLERANCE
        };
        for j in 0..CELLS {
            let (low, high) = (v0 + dv * j as f64, v0 + dv * (j + 1) as f64);
            // One rectangle for every run of cells.
            let mut first = None;
            for i in 0..=CELLS {
                let inside = i < CELLS && near(u0 + du * (i as f64 + 0.5), 0.5 * (low + high));
                if inside && first.is_none() {
                    first = Some(i);
                }
                if let (false, Some(f)) = (inside, first) {
                    let (a, b) = (u0 + du * f as f64, u0 + du * i as f64);
                    plot.area(&[[a, low], [b, low], [b, high], [a, high]], AREA, 1.0);
                    first = None;
                }
            }
        }
    }
    for &k in which {
        let (p, [back, forth]) = (&study.points[k], study.ends[k]);
        let below = (0..=20).filter_map(|i| walked(surface, p, back * (f64::from(i) / 20.0 - 1.0)));
        let above = (1..=20).filter_map(|i| walked(surface, p, forth * f64::from(i) / 20.0));
        let beside: Vec<[f64; 2]> = below.chain(above).collect();
        plot.line(&beside, 2.5, BLUE);
    }
    plot.line(&study.line(), 4.0, RED);
    Ok(plot.finished())
}

fn whole(surface: &Surface) -> Mesh {
    const N: u32 = 60;
    let ((u0, u1), (v0, v1)) = surface.domain();
    let mut mesh = Mesh::default();
    for i in 0..=N {
        for j in 0..=N {
            let (s, t) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
            let jet = surface.extended_jet(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
            mesh.positions.push(jet.p);
            mesh.normals.push(jet.normal().try_normalize(0.0).unwrap_or_else(Vec3::z));
            if i > 0 && j > 0 {
                let k = i * (N + 1) + j;
                let (a, b, c) = (k - N - 2, k - 1, k - N - 1);
                mesh.triangles.extend([[a, b, k], [a, k, c]]);
            }
        }
    }
    mesh
}

/// The ruled piece between the ends of rulings.
fn ruled(points: &[EnvelopeRuling], ends: &[[f64; 2]], step: usize) -> PanelShape {
    let mut shape = PanelShape::default();
    let each = || points.iter().zip(ends);
    for (i, (p, e)) in each().enumerate() {
        let ruling = [p.ruling.at(-e[0]), p.ruling.at(e[1])];
        shape.mesh.positions.extend(ruling);
        shape.mesh.normals.extend([p.ruling.normal; 2]);
        if i > 0 {
            let k = 2 * i as u32;
            shape.mesh.triangles.extend([[k - 2, k, k + 1], [k - 2, k + 1, k - 1]]);
        }
        if i % step == 0 {
            shape.rulings.push(ruling);
        }
    }
    let back = each().map(|(p, e)| p.ruling.at(-e[0]));
    let forth = each().rev().map(|(p, e)| p.ruling.at(e[1]));
    let mut border: Vec<Vec3> = back.chain(forth).collect();
    border.extend(border.first().copied());
    shape.borders.push(border);
    shape
}

const EYE: Vec3 = Vec3::new(0.5, 1.6, 0.9);

/// The surface with its curve, rulings in red, and the developable.
fn in_space(surface: &Surface, study: &Study, which: &[usize], title: &str, sheet: bool) -> Image {
    let mut scene = Scene::default();
    let border = |s: usize| {
        let ((u0, u1), (v0, v1)) = surface.domain();
        let corner = [[u0, v0], [u1, v0], [u1, v1], [u0, v1], [u0, v0]];
        let (a, b) = (corner[s], corner[s + 1]);
        (0..=40).map(move |i| f64::from(i) / 40.0).map(move |t| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])])
    };
    let borders = (0..4).map(|s| border(s).map(|p| surface.point(p[0], p[1])).collect()).collect();
    scene.panels.push(PanelShape { mesh: whole(surface), borders, ..PanelShape::default() });
    if sheet {
        scene.panels.push(ruled(&study.points, &study.ends, 2));
    }
    scene.guides.push(study.points.iter().map(|p| p.ruling.point).collect());
    for &k in which {
        let (p, e) = (&study.points[k], study.ends[k]);
        scene.guides.push(vec![p.ruling.at(-e[0]), p.ruling.at(e[1])]);
    }
    let note = format!("red: the curve, and rulings within {TOLERANCE} mm");
    picture::panels(&scene, &EYE, &Caption { width: 800, title: title.into(), note })
}

/// The quadrangles of the comparison between surface and developable.
fn refinement(surface: &Surface, rulings: usize, m: u32, share: f64) -> Done<Image> {
    let mut study = Study::new(surface, rulings)?;
    study.ends.iter_mut().flatten().for_each(|e| *e *= share);
    let parts = 1i32 << m;
    let found = paper_estimate(surface, &study.points, &study.ends, m);
    let title = format!("{rulings} rulings, {} samples on each", 2 * parts + 1);
    let note = format!("{:.0} % of the intervals; distance by samples {found:.1} mm", 100.0 * share);
    let mut plot = Plot::new(surface, &title, &note);
    let rows: Vec<Vec<[f64; 2]>> = (-parts..=parts)
        .map(|k| {
            let part = f64::from(k) / f64::from(parts);
            let each = study.points.iter().zip(&study.ends);
            each.map(|(p, e)| walked(surface, p, part * e[usize::from(k > 0)]).unwrap_or(p.uv)).collect()
        })
        .collect();
    for (below, above) in rows.iter().zip(&rows[1..]) {
        for (a, b) in below.windows(2).zip(above.windows(2)) {
            plot.area(&[a[0], a[1], b[1], b[0]], AREA, 1.0);
        }
    }
    for row in &rows {
        plot.line(row, 2.0, BLUE);
    }
    for i in 0..rulings {
        let column: Vec<[f64; 2]> = rows.iter().map(|r| r[i]).collect();
        plot.line(&column, 2.0, BLUE);
    }
    plot.line(&study.line(), 3.5, RED);
    Ok(plot.finished())
}

/// Figures 4 and 5: borders before and after smoothing. To the intervals teeth are added, as coarser root finders
/// leave them, so that there is something to smooth.
fn smoothing(surface: &Surface, study: &Study, save: &dyn Fn(&str, &Image) -> Done<()>) -> Done<()> {
    let mut rough = Study { points: study.points.clone(), ends: study.ends.clone() };
    for (i, e) in rough.ends.iter_mut().enumerate() {
        let tooth = 0.88 + 0.12 * (2.3 * i as f64).sin();
        *e = [e[0] * tooth, e[1] * (1.76 - tooth).min(1.0)];
    }
    let centre = rough.line();
    let before = rough.borders(surface);
    let after = [0, 1].map(|s| smoothed(&centre, &before[s], 8.0));
    // Rulings shrink by the same factors as their images.
    let mut mild = Study { points: rough.points.clone(), ends: rough.ends.clone() };
    for (i, c) in centre.iter().enumerate() {
        for s in [0, 1] {
            let length = |q: [f64; 2]| (q[0] - c[0]).hypot(q[1] - c[1]);
            let full = length(before[s][i]);
            mild.ends[i][s] *= if full > 0.0 { length(after[s][i]) / full } else { 0.0 };
        }
    }
    let stages = [("a", "before smoothing", &before, &rough), ("b", "after smoothing", &after, &mild)];
    for (letter, when, borders, study) in stages {
        let mut plot = Plot::new(surface, &format!("Borders {when}"), "intervals with teeth of 24 % added");
        let around: Vec<[f64; 2]> = borders[0].iter().chain(borders[1].iter().rev()).copied().collect();
        plot.area(&around, AREA, 1.0);
        borders.iter().for_each(|b| plot.line(b, 3.0, BLUE));
        plot.line(&centre, 3.5, RED);
        save(&format!("figure-4-{letter}.png"), &plot.finished())?;
        let title = format!("The developable {when}");
        save(&format!("figure-5-{letter}.png"), &in_space(surface, study, &[], &title, true))?;
    }
    Ok(())
}

fn input(bytes: &[u8], title: &str) -> Done<Image> {
    let surface = surface(bytes)?;
    let scene = Scene { surfaces: vec![whole(&surface)], ..Scene::default() };
    let caption = Caption { width: 800, title: title.into(), note: "the surface given".into() };
    Ok(picture::panels(&scene, &picture::direction(&scene), &caption))
}

/// A whole face covered by panels along a curve and those that follow from their borders.
fn covered(bytes: &[u8], tolerance: f64, curve: &PanelCurve) -> Done<Image> {
    let options = Options {
        tolerance,
        max_panels: None,
        input: "surface".into(),
        limits: Limits::default(),
        layout: Layout { curves: vec![curve.clone()], ..Layout::default() },
        meet: false,
        smooth_angle: 0.0,
        drawn: torse::develop::view::Drawn::default(),
    };
    let given = Scene { surfaces: vec![whole(&surface(bytes)?)], ..Scene::default() };
    let answer = of_faces(read(bytes)?.faces, Vec::new(), &options, &Control::default())?;
    let shown = present(&answer);
    let proof = if answer.status() == Status::Certified { "certified" } else { "not certified" };
    let note = format!("{} along the {} or in its wake; {proof}", answer.along.len(), curve.name);
    let title = format!("{} panels at {tolerance} mm", answer.patchwork().panels.len());
    // Seen as the surface is.
    Ok(picture::panels(&shown.scene, &picture::direction(&given), &Caption { width: 800, title, note }))
}
