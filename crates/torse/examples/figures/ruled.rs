//! Figures of lecture notes on ruled surfaces \[W15, section 2\]: splines, reflection lines, composites with planar pieces,
//! squared distances, asymptotic curves, and strips that follow from them; surfaces of our own of the same kind.

use super::stripes::{ruled_mesh, striped};
use std::path::Path;
use torse::answer::presentation::present;
use torse::brep::face::Face;
use torse::constraint::proximity::squared_distance;
use torse::control::Control;
use torse::draw::picture::{panels, Caption};
use torse::draw::raster::{Drawing, Image};
use torse::draw::scene::{PanelShape, Scene};
use torse::fit::ruled::directions::{Curvatures, Family};
use torse::geom::mesh::Mesh;
use torse::geom::{Vec2, Vec3};
use torse::io::png;
use torse::pipeline::ruled::{of_faces, RuledOptions, Strips};
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::tessellate::strip;
use torse::torse::form::PanelKind;
use torse::torse::strip::Strip;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const INK: [f64; 3] = [0.1, 0.12, 0.16];
const GREY: [f64; 3] = [0.6, 0.63, 0.68];
const RED: [f64; 3] = [0.78, 0.16, 0.12];
const BLUE: [f64; 3] = [0.15, 0.35, 0.7];

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Result<()> {
    let save = |name: &str, image: &Image| -> Result<()> {
        Ok(std::fs::write(folder.join(format!("figure-{name}.png")), png::write(image)?)?)
    };
    save("2-01", &basis_functions()?)?;
    save("2-02", &auxiliary_points()?)?;
    for (letter, degree) in [("a", 2), ("b", 3)] {
        let strip = [wave(degree, 0.0)?, wave(degree, 1.0)?];
        let strip = Strip::polynomial("s", PanelKind::Ruled, &strip[0], &strip[1])?;
        let eye = Vec3::new(0.2, -1.0, 0.9);
        let title = format!("reflections in a ruled surface of degree {degree}");
        let note = if degree == 2 { "C1: lines with corners" } else { "C2: smooth lines" };
        save(&format!("2-03-{letter}"), &picture(striped(&[ruled_mesh(&strip, 400, 60)], &eye), &eye, &title, note))?;
    }
    save("2-05-cells", &distance_field(true))?;
    save("2-05-one", &distance_field(false))?;
    let saddle = saddle()?;
    from_asymptotic_curves(&saddle, &save)?;
    save("2-08", &tangent_plane())?;
    save("2-09", &asymptotic(&saddle))?;
    conoidal(&waist()?, &save)?;
    save("2-11", &books())
}

fn picture(scene: Scene, eye: &Vec3, title: &str, note: &str) -> Image {
    panels(&scene, eye, &Caption { width: 800, title: title.into(), note: note.into() })
}

/// Figure 2.1: basis functions over uniform knots, one row for every degree.
fn basis_functions() -> Result<Image> {
    let mut drawing = Drawing::new(800, 620);
    drawing.text("Basis functions of degree 0 to 3", Vec2::new(40.0, 46.0), 20.0, INK);
    let place = |row: usize, t: f64, y: f64| Vec2::new(40.0 + 90.0 * t, 180.0 + 130.0 * row as f64 - 80.0 * y);
    for degree in 0..4usize {
        drawing.stroke(&[place(degree, 0.0, 0.0), place(degree, 8.0, 0.0)], 1.5, GREY, 1.0);
        let starts = (0..8 - degree).filter(|i| i % 2 == 0 || degree == 0);
        for (k, start) in starts.enumerate() {
            let colour = if k % 2 == 0 { BLUE } else { RED };
            if degree == 0 {
                let (a, b) = (start as f64, start as f64 + 1.0);
                drawing.stroke(&[place(0, a, 1.0), place(0, b, 1.0)], 3.0, colour, 1.0);
                continue;
            }
            // The only control point that is not zero is the function's own.
            let knots: Vec<f64> = (0..=8 + 2 * degree).map(|i| i as f64 - degree as f64).collect();
            let count = knots.len() - degree - 1;
            let control = (0..count).map(|i| [f64::from(u8::from(i == start + degree))]).collect();
            let curve = Curve::new(degree, knots, control)?;
            let points: Vec<Vec2> =
                (0..=400).map(|i| 0.02 * f64::from(i)).map(|t| place(degree, t, curve.point(t)[0])).collect();
            drawing.stroke(&points, 2.5, colour, 1.0);
        }
    }
    Ok(drawing.render())
}

/// A wavy curve over equal pieces, as smooth as its degree allows.
fn wave(degree: usize, y: f64) -> Result<Curve<3>> {
    let knots = Knots::uniform(degree, 7, 0.0, 1.0)?;
    let n = knots.control_count();
    let point = |i: usize| {
        let x = i as f64 / (n - 1) as f64;
        let up = 0.22 * (8.0 * x + 1.2 * y).sin() + 0.1 * (15.0 * x - y).cos();
        [3.0 * x + 0.2 * y, 1.3 * y, up + 0.25 * y]
    };
    Ok(Curve { control: (0..n).map(point).collect(), knots })
}

/// Figure 2.2: control points, and the points of de Boor's scheme that span tangent and osculating plane.
fn auxiliary_points() -> Result<Image> {
    let (a, b) = (wave(3, 0.0)?, wave(3, 1.0)?);
    let strip = Strip::polynomial("", PanelKind::Ruled, &a, &b)?;
    let mut shape = PanelShape { mesh: ruled_mesh(&strip, 200, 1), ..PanelShape::default() };
    shape.rulings = strip::ruling_lines(&strip, 0.1);
    shape.borders = vec![strip::border_line(&strip)];
    let t = 0.52;
    let (span, knots) = (a.knots.span(t), a.knots.values());
    let mut level: Vec<Vec3> = (span - 3..=span).map(|i| Vec3::from(a.control[i])).collect();
    let mut guides = vec![a.control.iter().map(|p| Vec3::from(*p)).collect::<Vec<_>>()];
    guides.push(b.control.iter().map(|p| Vec3::from(*p)).collect());
    for r in 1..=3 {
        level = (0..level.len() - 1)
            .map(|k| {
                let i = span - 3 + r + k;
                let s = (t - knots[i]) / (knots[i + 4 - r] - knots[i]);
                level[k] * (1.0 - s) + level[k + 1] * s
            })
            .collect();
        guides.extend(level.iter().map(|p| cross(p, 0.03)));
        if level.len() > 1 {
            guides.push(level.clone());
        }
    }
    let eye = Vec3::new(0.3, -1.1, 0.8);
    let scene = Scene { panels: vec![shape], guides, ..Scene::default() };
    Ok(picture(
        scene,
        &eye,
        "Spline curves and the ruled surface between",
        "red: control polygons, points of tangent and osculating plane",
    ))
}

/// A small mark in space.
fn cross(p: &Vec3, size: f64) -> Vec<Vec3> {
    let (x, z) = (Vec3::x() * size, Vec3::z() * size);
    vec![p - x, p + x, *p, p - z, p + z]
}

/// Figure 2.5: level sets of the quadratic function that is nearest to the squared distance from a curve, in every cell or
/// as one cell has it.
fn distance_field(cells: bool) -> Image {
    const SIZE: [f64; 2] = [8.0, 5.0];
    const PIXEL: f64 = 4.0;
    let curve = |x: f64| Vec2::new(x, 1.6 + 0.9 * (0.9 * x).sin());
    let feet: Vec<Vec2> = (0..=2400).map(|i| curve(-1.0 + f64::from(i) / 240.0)).collect();
    // Quadratic about a centre: foot, tangent, coefficient along it.
    let about = |p: &Vec2| {
        let far = |q: &&Vec2| (**q - p).norm_squared();
        let q = feet.iter().min_by(|a, b| far(a).total_cmp(&far(b))).copied().unwrap_or_else(Vec2::zeros);
        let slope = 0.81 * (0.9 * q.x).cos();
        let bend = -0.729 * (0.9 * q.x).sin() / (1.0 + slope * slope).powf(1.5);
        let t = Vec2::new(1.0, slope).normalize();
        let n = Vec2::new(-t.y, t.x);
        (q, t, n, squared_distance(n.dot(&(p - q)), [bend, 0.0])[0])
    };
    let mut drawing = Drawing::new(880, 640);
    let title =
        if cells { "Squared distance: every cell its own quadratic" } else { "The quadratic of the framed cell" };
    drawing.text(title, Vec2::new(40.0, 46.0), 20.0, INK);
    let place = |p: &Vec2| Vec2::new(40.0 + 100.0 * p.x, 600.0 - 100.0 * p.y);
    let chosen = Vec2::new(4.25, 2.25);
    let (columns, rows) = ((100.0 * SIZE[0] / PIXEL) as usize, (100.0 * SIZE[1] / PIXEL) as usize);
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let p = Vec2::new((i as f64 + 0.5) * PIXEL / 100.0, (j as f64 + 0.5) * PIXEL / 100.0);
        let centre =
            if cells { Vec2::new((2.0 * p.x).floor() / 2.0 + 0.25, (2.0 * p.y).floor() / 2.0 + 0.25) } else { chosen };
        let (q, t, n, c) = about(&centre);
        let x = p - q;
        let f = n.dot(&x).powi(2) + c * t.dot(&x).powi(2);
        let band = (f.abs().sqrt() * 5.0).floor() as i64 % 2 == 0;
        let colour = if f < 0.0 {
            [0.9, 0.85, 0.7]
        } else if band {
            [0.62, 0.76, 0.92]
        } else {
            [0.88, 0.93, 0.98]
        };
        let corner = |s: f64, t: f64| place(&(p + Vec2::new(s, t) * (0.5 * PIXEL / 100.0)));
        drawing.fill(
            vec![vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]],
            colour,
            1.0,
        );
    }
    let shown: Vec<Vec2> = feet.iter().filter(|p| p.x >= 0.0 && p.x <= SIZE[0]).map(place).collect();
    drawing.stroke(&shown, 4.0, RED, 1.0);
    if !cells {
        let at = |s: f64, t: f64| place(&(chosen + Vec2::new(s, t) * 0.25));
        drawing.stroke(&[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0), at(-1.0, -1.0)], 3.0, INK, 1.0);
    }
    drawing.render()
}

/// A saddle-shaped bicubic surface, mm.
fn saddle() -> Result<Surface> {
    let knots = Knots::uniform(3, 3, 0.0, 1.0)?;
    let n = knots.control_count();
    let point = |k: usize| {
        let (x, y) = ((k / n) as f64 / (n - 1) as f64 - 0.5, (k % n) as f64 / (n - 1) as f64 - 0.5);
        Vec3::new(2000.0 * x, 1400.0 * y, 900.0 * (x * x - 1.2 * y * y) + 500.0 * x * x * y)
    };
    let points: Vec<Vec3> = (0..n * n).map(point).collect();
    Ok(Surface::new(knots.clone(), knots, &points, None)?)
}

/// A surface with a waist, saddle-shaped all over, whose straightest lines turn about its axis; mm.
fn waist() -> Result<Surface> {
    let knots = Knots::uniform(3, 4, 0.0, 1.0)?;
    let n = knots.control_count();
    let point = |k: usize| {
        let (a, z) = (1.6 * ((k / n) as f64 / (n - 1) as f64 - 0.5), (k % n) as f64 / (n - 1) as f64 - 0.5);
        let r = 700.0 + 1100.0 * z * z;
        // About the axis that points upwards, bulging towards the eye.
        Vec3::new(r * a.sin(), -r * a.cos(), 1300.0 * z)
    };
    let points: Vec<Vec3> = (0..n * n).map(point).collect();
    Ok(Surface::new(knots.clone(), knots, &points, None)?)
}

const EYE: Vec3 = Vec3::new(0.5, -1.0, 0.8);

/// Figures 2.6 and 2.7: ruled strips near the saddle, and reflections in them.
fn from_asymptotic_curves(surface: &Surface, save: &dyn Fn(&str, &Image) -> Result<()>) -> Result<()> {
    let strips = Strips { tolerance: 8.0, width: Some(260.0), conoidal: false };
    let options = RuledOptions { strips, input: "saddle".into(), spacing: None };
    let found = of_faces(vec![Face::untrimmed(surface.clone())], Vec::new(), &options, &Control::default())?;
    let shown = present(&found.answer);
    let count = found.answer.patchwork().panels.len();
    let note = format!("{count} strips within 8 mm, {:?}", found.answer.status());
    let given =
        Scene { panels: vec![PanelShape { mesh: whole(surface), ..PanelShape::default() }], ..Scene::default() };
    save("2-06-left", &picture(given, &EYE, "The surface given", ""))?;
    save("2-06-right", &picture(shown.scene.clone(), &EYE, "Ruled strips near it", &note))?;
    let strips = found.answer.strips();
    let meshes: Vec<Mesh> = shown.scene.panels.iter().zip(strips).map(|(p, s)| finer(&p.mesh, s)).collect();
    let borders = shown.scene.panels.into_iter().map(|p| PanelShape { borders: p.borders, ..PanelShape::default() });
    let mut scene = striped(&meshes, &EYE);
    scene.panels.extend(borders);
    save("2-07", &picture(scene, &EYE, "Reflections go on from strip to strip", "rulings of neighbours meet at angles"))
}

/// A mesh of a strip with every triangle cut into many, whose corners and normals are those of the strip.
fn finer(mesh: &Mesh, s: &Strip) -> Mesh {
    const CUTS: u32 = 12;
    const STARTS: u32 = 40;
    const STEPS: usize = 10;
    let (a, b) = s.domain();
    let starts: Vec<[f64; 2]> = (0..=STARTS)
        .flat_map(|i| [0.0, 0.5, 1.0].map(|v| [a + (b - a) * f64::from(i) / f64::from(STARTS), v]))
        .collect();
    let off = |p: &Vec3, at: &[f64; 2]| (s.patch.point(at[0], at[1]) - p).norm();
    let foot = |p: &Vec3| {
        let start = starts.iter().min_by(|x, y| off(p, x).total_cmp(&off(p, y))).copied().unwrap_or([a, 0.0]);
        // Gauss and Newton's steps to the nearest place.
        (0..STEPS).fold(start, |[u, v], _| {
            let j = s.patch.jet(u, v);
            let off = p - j.p;
            let (xx, xy, yy) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
            let (x, y, det) = (j.du.dot(&off), j.dv.dot(&off), xx * yy - xy * xy);
            if det > 0.0 {
                [(u + (yy * x - xy * y) / det).clamp(a, b), (v + (xx * y - xy * x) / det).clamp(0.0, 1.0)]
            } else {
                [u, v]
            }
        })
    };
    let feet: Vec<[f64; 2]> = mesh.positions.iter().map(foot).collect();
    let mut out = Mesh::default();
    for t in &mesh.triangles {
        let f = t.map(|k| feet[k as usize]);
        let n: Vec3 = t.map(|k| mesh.normals[k as usize]).iter().sum();
        let first = out.positions.len() as u32;
        for (i, j) in (0..=CUTS).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let (x, y) = (f64::from(i) / f64::from(CUTS), f64::from(j) / f64::from(CUTS));
            let [u, v] = [0, 1].map(|d: usize| f[0][d] * (1.0 - x) + f[1][d] * (x - y) + f[2][d] * y);
            let jet = s.patch.jet(u, v);
            let normal = jet.normal().normalize();
            out.positions.push(jet.p);
            out.normals.push(if normal.dot(&n) < 0.0 { -normal } else { normal });
        }
        let at = |i: u32, j: u32| first + i * (i + 1) / 2 + j;
        for (i, j) in (0..CUTS).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            out.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            if j < i {
                out.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    out
}

fn whole(surface: &Surface) -> Mesh {
    const N: u32 = 60;
    let mut mesh = Mesh::default();
    for (i, j) in (0..=N).flat_map(|i| (0..=N).map(move |j| (i, j))) {
        let jet = surface.jet(f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
        mesh.positions.push(jet.p);
        mesh.normals.push(jet.normal().normalize());
        if i > 0 && j > 0 {
            let k = i * (N + 1) + j;
            mesh.triangles.extend([[k - N - 2, k - 1, k], [k - N - 2, k, k - N - 1]]);
        }
    }
    mesh
}

/// Figure 2.8: a surface cut by one of its tangent planes; the branches of the section leave in asymptotic directions.
fn tangent_plane() -> Image {
    let f = |x: f64, y: f64| 0.35 * (x * x - 1.4 * y * y) + 0.12 * x * x * x - 0.1 * x * y * y;
    const N: i32 = 140;
    let at = |i: i32| 1.4 * f64::from(i) / f64::from(N);
    let mut mesh = Mesh::default();
    let mut lines = Vec::new();
    for (i, j) in (-N..=N).flat_map(|i| (-N..=N).map(move |j| (i, j))) {
        let (x, y, h) = (at(i), at(j), 1e-5);
        mesh.positions.push(Vec3::new(x, y, f(x, y)));
        let slope = [f(x + h, y) - f(x - h, y), f(x, y + h) - f(x, y - h)].map(|d| d / (2.0 * h));
        mesh.normals.push(Vec3::new(-slope[0], -slope[1], 1.0).normalize());
        if i > -N && j > -N {
            let k = ((i + N) * (2 * N + 1) + j + N) as u32;
            let row = (2 * N + 1) as u32;
            mesh.triangles.extend([[k - row - 1, k - 1, k], [k - row - 1, k, k - row]]);
            // The plane z = 0 touches at the origin: the section by marching squares.
            let corner = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)].map(|(i, j)| {
                let (x, y) = (at(i), at(j));
                (Vec3::new(x, y, 0.0), f(x, y))
            });
            let cuts: Vec<Vec3> = (0..4)
                .filter_map(|k| {
                    let ((p, a), (q, b)) = (corner[k], corner[(k + 1) % 4]);
                    ((a < 0.0) != (b < 0.0)).then(|| p + (q - p) * (a / (a - b)))
                })
                .collect();
            lines.extend(cuts.chunks_exact(2).map(<[Vec3]>::to_vec));
        }
    }
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let plane = Mesh {
        positions: corners.to_vec(),
        normals: vec![Vec3::z(); 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        values: Vec::new(),
    };
    let shapes = [mesh, plane].map(|mesh| PanelShape { mesh, ..PanelShape::default() }).into();
    let scene = Scene { panels: shapes, guides: lines, ..Scene::default() };
    picture(
        scene,
        &Vec3::new(0.5, -0.9, 0.9),
        "A surface and its tangent plane",
        "red: the section; its tangents are the asymptotic directions",
    )
}

/// An asymptotic curve through a place of the parameter plane, by steps of Heun's method, until it leaves the domain.
fn followed(surface: &Surface, start: [f64; 2], family: Family) -> Vec<[f64; 2]> {
    const STEP: f64 = 20.0;
    let inside = |p: &[f64; 2]| p.iter().all(|x| (0.0..=1.0).contains(x));
    let along = |p: [f64; 2], before: [f64; 2]| {
        let d = Curvatures::of(&surface.jet(p[0], p[1])).map_or([0.0; 2], |c| c.straightest(family)[0]);
        let sign = if d[0] * before[0] + d[1] * before[1] < 0.0 { -STEP } else { STEP };
        d.map(|x| x * sign)
    };
    let half = |sign: f64| {
        let (mut p, mut out) = (start, Vec::new());
        let mut way = along(p, [1e-9, 1e-9]).map(|x| x * sign);
        while inside(&p) && out.len() < 400 {
            out.push(p);
            let one = along(p, way);
            let two = along([p[0] + one[0], p[1] + one[1]], one);
            way = [0, 1].map(|k: usize| 0.5 * (one[k] + two[k]));
            p = [p[0] + way[0], p[1] + way[1]];
        }
        out
    };
    let mut all = half(-1.0);
    all.reverse();
    all.extend(half(1.0).into_iter().skip(1));
    all
}

/// Starts of curves across a surface.
fn starts() -> impl Iterator<Item = [f64; 2]> {
    (1..18).map(|k| f64::from(k) / 18.0).map(|x| [x, 0.5])
}

/// Figure 2.9: asymptotic curves of both families.
fn asymptotic(surface: &Surface) -> Image {
    let families = [Family::Left, Family::Right];
    let curves = families.iter().flat_map(|f| starts().map(|p| followed(surface, p, *f)));
    let guides = curves.map(|c| c.iter().map(|p| surface.point(p[0], p[1])).collect()).collect();
    let scene = Scene {
        panels: vec![PanelShape { mesh: whole(surface), ..PanelShape::default() }],
        guides,
        ..Scene::default()
    };
    picture(
        scene,
        &EYE,
        "Asymptotic curves of both families",
        "one gives the rulings, curves across it the borders of strips",
    )
}

/// Figure 2.10: conoidal strips, and the directions of their rulings on the unit sphere: every strip is part of a great
/// circle.
fn conoidal(surface: &Surface, save: &dyn Fn(&str, &Image) -> Result<()>) -> Result<()> {
    let strips = Strips { tolerance: 25.0, width: Some(260.0), conoidal: true };
    let options = RuledOptions { strips, input: "waist".into(), spacing: None };
    let found = of_faces(vec![Face::untrimmed(surface.clone())], Vec::new(), &options, &Control::default())?;
    let shown = present(&found.answer);
    let count = found.directing.iter().flatten().count();
    let note = format!("{count} of {} strips have a directing plane", found.directing.len());
    save("2-10-a", &picture(shown.scene, &EYE, "Conoidal strips", &note))?;
    let (mut arcs, mut circles) = (Vec::new(), Vec::new());
    for (panel, normal) in found.answer.patchwork().panels.iter().zip(&found.directing) {
        let Some(normal) = normal else { continue };
        let name = &panel.strip.name;
        let own = found.rulings.iter().filter(|r| r.strip == *name);
        // All on one half of the sphere.
        let turned = |p: Vec3| if p.dot(&RULING_SIDE) < 0.0 { -p } else { p };
        arcs.push(arc(own.filter_map(|r| (r.ends[1] - r.ends[0]).try_normalize(0.0)).map(turned), normal));
        let x = normal.cross(&EYE).normalize();
        let y = normal.cross(&x);
        let at = |k: u32| f64::from(k) * std::f64::consts::TAU / 200.0;
        circles.push((0..=200).map(|k| (x * at(k).cos() + y * at(k).sin()) * 1.004).collect());
    }
    let mut ball = Mesh::default();
    const N: u32 = 48;
    for (i, j) in (0..=2 * N).flat_map(|i| (0..=N).map(move |j| (i, j))) {
        let (a, b) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N) - 0.5);
        let (a, b) = (std::f64::consts::PI * a, std::f64::consts::PI * b);
        let p = Vec3::new(b.cos() * a.cos(), b.cos() * a.sin(), b.sin());
        ball.positions.push(p * 0.995);
        ball.normals.push(p);
        if i > 0 && j > 0 {
            let k = i * (N + 1) + j;
            ball.triangles.extend([[k - N - 2, k - 1, k], [k - N - 2, k, k - N - 1]]);
        }
    }
    let middle: Vec3 = arcs.iter().flat_map(|a: &Mesh| &a.positions).sum();
    let across: Vec3 = found.directing.iter().flatten().map(|m| if m.z < 0.0 { -m } else { *m }).sum();
    let shapes = std::iter::once(ball).chain(arcs).map(|mesh| PanelShape { mesh, ..PanelShape::default() });
    let scene = Scene { panels: shapes.collect(), guides: circles, ..Scene::default() };
    // From beside the great circles, which would look like straight lines from within their planes.
    let eye = middle.normalize() + across.normalize() * 0.9;
    save("2-10-b", &picture(scene, &eye, "Their rulings as directions", "every strip lies on a great circle"))
}

/// A side of the sphere on which directions of rulings are shown.
const RULING_SIDE: Vec3 = Vec3::new(1.0, -0.4, 0.2);

/// A narrow band over directions that lie on the great circle about a normal.
fn arc(directions: impl Iterator<Item = Vec3>, normal: &Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for (k, p) in directions.enumerate() {
        mesh.positions.extend([-0.02, 0.02].map(|h| (p + normal * h).normalize() * 1.008));
        mesh.normals.extend([p; 2]);
        if k > 0 {
            let n = 2 * k as u32;
            mesh.triangles.extend([[n - 2, n - 1, n + 1], [n - 2, n + 1, n]]);
        }
    }
    mesh
}

/// Figure 2.11: a stack of books, each turned a little against the one below; its sides are near conoidal surfaces.
fn books() -> Image {
    const COUNT: u32 = 22;
    let mut shapes = Vec::new();
    for k in 0..COUNT {
        let t = f64::from(k) / f64::from(COUNT);
        let angle = 1.1 * t + 0.35 * (4.0 * t).sin();
        let (s, c) = angle.sin_cos();
        let corner = |x: f64, y: f64, top: f64| {
            let (x, y) = (1.0 * x + 0.25 * t, 0.7 * y);
            Vec3::new(c * x - s * y, s * x + c * y, 0.09 * (f64::from(k) + top * 0.94))
        };
        let ring = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mut shape = PanelShape::default();
        let mut face = |p: [Vec3; 4]| {
            let first = shape.mesh.positions.len() as u32;
            let n = (p[1] - p[0]).cross(&(p[3] - p[0])).normalize();
            shape.mesh.positions.extend(p);
            shape.mesh.normals.extend([n; 4]);
            shape.mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            shape.borders.push(vec![p[0], p[1], p[2], p[3], p[0]]);
        };
        for i in 0..4 {
            let ([x, y], [z, w]) = (ring[i], ring[(i + 1) % 4]);
            face([corner(x, y, 0.0), corner(z, w, 0.0), corner(z, w, 1.0), corner(x, y, 1.0)]);
        }
        face(ring.map(|[x, y]| corner(x, y, 1.0)));
        shapes.push(shape);
    }
    let scene = Scene { panels: shapes, ..Scene::default() };
    picture(
        scene,
        &Vec3::new(0.6, -1.0, 0.55),
        "A stack of books",
        "four conoidal surfaces: all rulings are horizontal",
    )
}
