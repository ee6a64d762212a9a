//! Pictures of ruled surfaces and discrete torses.
//!
//! Figures 1.1 to 1.5 of \[W15\]: a ruled surface between two curves, the tangent plane that turns along a ruling, a
//! tangent surface with its edge of regression, a discrete torse, the envelope of a family of planes. Figures 4.8 and
//! 4.12: a strip that is planarised and subdivided, with its reflection lines and its singular points. Last, the shapes
//! of which a developable consists.

use std::path::Path;
use torse::answer::presentation::present;
use torse::answer::{Answer, Job};
use torse::control::Control;
use torse::design::discrete::planarise::Hold;
use torse::design::discrete::subdivide::{subdivide, SubdivideOptions};
use torse::develop::strip::{pattern, StripOptions};
use torse::draw::picture::{panels, shapes, Caption};
use torse::draw::scene::{PanelShape, Scene};
use torse::geom::mesh::Mesh;
use torse::geom::Vec3;
use torse::io::png;
use torse::patchwork::part::Part;
use torse::tessellate::strip;
use torse::torse::quad_strip::QuadStrip;
use torse::torse::ruled_point::RuledPoint;
use torse::torse::strip::Strip;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Result<()> {
    let save = |name: &str, scene: &Scene, eye: [f64; 3], title: &str| -> Result<()> {
        let caption = Caption { width: 800, title: title.into(), note: "W15".into() };
        let image = panels(scene, &Vec3::from(eye), &caption);
        Ok(std::fs::write(folder.join(format!("{name}.png")), png::write(&image)?)?)
    };

    // Figure 1.1: two curves and the lines that join points of equal parameter.
    let a = |u: f64| Vec3::new(4.0 * u, 0.25 * (5.0 * u).sin(), 0.2 * (3.0 * u).cos());
    let b = |u: f64| Vec3::new(0.4 + 3.2 * u, 2.0 + 0.3 * (4.0 * u).cos(), 0.9 * (u - 0.3) + 0.35 * (6.0 * u).sin());
    let mut scene = Scene { panels: vec![ruled("", &a, &b, 24)], ..Scene::default() };
    scene.guides = vec![
        (0..=200).map(|k| a(f64::from(k) / 200.0)).collect(),
        (0..=200).map(|k| b(f64::from(k) / 200.0)).collect(),
    ];
    save("fig1_1_ruled_surface", &scene, [0.25, -0.8, 1.0], "ruled surface between two curves")?;

    save("fig1_2_turning_tangent_plane", &turning(), [0.9, -0.75, 0.55], "the tangent plane turns along a ruling")?;
    save("fig1_3_tangent_surface", &tangent_surface(), [0.7, -1.0, 0.9], "the tangents of a curve")?;

    // Figure 1.4: successive segments are coplanar; the regression polyline of figure 1.5 extends them.
    let torse = discrete();
    save("fig1_4_discrete_torse", &quads(&torse, false)?, [0.3, -1.0, 0.8], "successive segments are coplanar")?;
    save("fig1_5_envelope", &envelope(&torse), [0.3, -1.0, 0.8], "planes, rulings and regression points")?;

    // A strip that is not plane, made plane and refined.
    for levels in [0, 1, 3] {
        let done = subdivide(&warped()?, &SubdivideOptions::new(levels, Hold::Nothing), &Control::default())?;
        let bend = done.strip.bend_jump();
        save(
            &format!("subdivision_level_{levels}"),
            &quads(&done.strip, true)?,
            [0.5, -0.6, 0.9],
            &format!(
                "level {levels}: warp {:.0e}, bends jump by {:.0} % of their mean",
                done.strip.largest_warp(),
                100.0 * bend
            ),
        )?;
    }

    // Figure 4.8: reflection lines jump from plane to plane at first, and are smooth in the end.
    for levels in [0, 2, 5] {
        let done = subdivide(&warped()?, &SubdivideOptions::new(levels, Hold::Nothing), &Control::default())?;
        let title = format!("reflection lines, {} plane quadrilaterals", done.strip.quads());
        save(&format!("fig4_8_reflection_lines_level_{levels}"), &reflection_lines(&done.strip), VIEW, &title)?;
    }
    // Figure 4.12: the coarse strip and the refined one with its singular points.
    for levels in [0, 2] {
        let done = subdivide(&warped()?, &SubdivideOptions::new(levels, Hold::Nothing), &Control::default())?;
        let mut scene = quads(&done.strip, false)?;
        scene.guides = regression(&done.strip);
        let title = format!("level {levels} and its near singular points");
        save(&format!("fig4_12_subdivision_level_{levels}"), &scene, VIEW, &title)?;
    }

    // What a developable consists of.
    let answer = mixed()?;
    let shown = present(&answer);
    let caption =
        Caption { width: 1200, title: "planes, cylinders, cones, tangent surfaces".into(), note: String::new() };
    let image = shapes(&shown.scene, &shown.shape_patches, &Vec3::new(0.2, -1.0, 0.9), &caption);
    std::fs::write(folder.join("shapes.png"), png::write(&image)?)?;
    Ok(())
}

/// A ruled surface over u in [0, 1] with rulings.
fn ruled(name: &str, a: &dyn Fn(f64) -> Vec3, b: &dyn Fn(f64) -> Vec3, rulings: u32) -> PanelShape {
    const PARTS: u32 = 120;
    const ACROSS: u32 = 12;
    let mut shape = PanelShape { name: name.into(), ..PanelShape::default() };
    let h = 1e-5;
    for i in 0..=PARTS {
        let u = f64::from(i) / f64::from(PARTS);
        let (da, db) = ((a(u + h) - a(u - h)) / (2.0 * h), (b(u + h) - b(u - h)) / (2.0 * h));
        for j in 0..=ACROSS {
            let v = f64::from(j) / f64::from(ACROSS);
            shape.mesh.positions.push(a(u) * (1.0 - v) + b(u) * v);
            let n = (da * (1.0 - v) + db * v).cross(&(b(u) - a(u)));
            shape.mesh.normals.push(n.try_normalize(0.0).unwrap_or_else(Vec3::zeros));
            if i > 0 && j > 0 {
                let k = i * (ACROSS + 1) + j;
                shape.mesh.triangles.extend([[k - ACROSS - 2, k - ACROSS - 1, k - 1], [k - 1, k - ACROSS - 1, k]]);
            }
        }
    }
    shape.rulings = (0..=rulings).map(|i| f64::from(i) / f64::from(rulings)).map(|u| [a(u), b(u)]).collect();
    shape
}

/// A square about `p`, spanned by two unit vectors.
fn square(name: &str, p: Vec3, x: Vec3, y: Vec3, half: [f64; 2]) -> PanelShape {
    let corner = |s: f64, t: f64| p + x * (s * half[0]) + y * (t * half[1]);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mut shape = PanelShape { name: name.into(), ..PanelShape::default() };
    shape.mesh.positions = corners.to_vec();
    shape.mesh.normals = vec![x.cross(&y); 4];
    shape.mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
    shape.borders = vec![corners.iter().chain(&corners[..1]).copied().collect()];
    shape
}

/// Figure 1.2: a hyperboloid's rulings, and tangent planes along one of them.
fn turning() -> Scene {
    let at = |u: f64, v: f64| {
        let (s, c) = (1.2 * (u - 0.5)).sin_cos();
        Vec3::new(c - v * s, s + v * c, 1.1 * v)
    };
    let (low, high) = (|u: f64| at(u, -2.2), |u: f64| at(u, 2.2));
    let mut scene = Scene { panels: vec![ruled("", &low, &high, 16)], ..Scene::default() };
    let r = Vec3::new(0.0, 1.0, 1.1);
    let point = RuledPoint { a_dot: Vec3::y() * 1.2, r, r_dot: Vec3::new(-1.2, 0.0, 0.0) };
    let e = r.normalize();
    // The tangent plane at the striction point, turned as the lemma says.
    let across = Vec3::y() - e * e.y;
    let (x, y) = (across.normalize(), across.normalize().cross(&e));
    for k in -4i32..=4 {
        let s = 0.75 * f64::from(k);
        let turned = point.tangent_rotation(s) - point.tangent_rotation(0.0);
        // Which way round: along the velocity of the surface point.
        let velocity = point.a_dot + point.r_dot * (s / r.norm());
        let sign = (velocity.dot(&y) * turned).signum();
        let (sin, cos) = (sign * turned).sin_cos();
        let direction = x * cos + y * sin;
        scene.panels.push(square("", Vec3::x() + e * s, direction, e, [0.5, 0.12]));
    }
    scene
}

/// Figure 1.3: one half of each tangent.
fn tangent_surface() -> Scene {
    let c = |u: f64| {
        let t = 4.5 * u;
        Vec3::new(t.cos(), t.sin(), 0.25 * t)
    };
    let d = |u: f64| {
        let t = 4.5 * u;
        c(u) + Vec3::new(-t.sin(), t.cos(), 0.25) * 1.6
    };
    let guides = vec![(0..=200).map(|k| c(f64::from(k) / 200.0)).collect()];
    Scene { panels: vec![ruled("", &c, &d, 36)], guides, ..Scene::default() }
}

/// Edges of a polygon of space, cut at two distances from it.
fn discrete() -> QuadStrip {
    let c = |k: u32| {
        let t = 0.3 * f64::from(k);
        Vec3::new(1.5 * t.cos(), 1.5 * t.sin(), 0.35 * t)
    };
    let along = |k: u32, d: f64| c(k) + (c(k + 1) - c(k)).normalize() * d;
    let side = |d: f64| (0..9).map(|k| along(k, d)).collect();
    QuadStrip::new(side(0.9), side(2.2)).unwrap_or_else(|_| unreachable!("distinct points"))
}

/// A strip whose quadrilaterals are not plane.
fn warped() -> Result<QuadStrip> {
    let a = (0..=7).map(|k| 0.4 * f64::from(k)).map(|t| Vec3::new(t.cos(), t.sin(), 0.1 * (2.0 * t).sin())).collect();
    let b = (0..=7)
        .map(|k| 0.4 * f64::from(k))
        .map(|t| Vec3::new(1.5 * (t + 0.2).cos(), 1.2 * (t + 0.2).sin(), 0.7 + 0.15 * t));
    Ok(QuadStrip::new(a, b.collect())?)
}

const VIEW: [f64; 3] = [0.5, -0.6, 0.9];

/// Stripes of light reflected to an eye near by: each cell of a face is light or dark by the direction from which its
/// light comes.
fn reflection_lines(strip: &QuadStrip) -> Scene {
    const ACROSS: u32 = 160;
    const ALONG: u32 = 320;
    const STRIPES: f64 = 36.0;
    let eye = strip.a()[0] + Vec3::from(VIEW).normalize() * (1.2 * strip.size());
    let side = Vec3::from(VIEW).cross(&Vec3::z()).normalize();
    let other = Vec3::from(VIEW).cross(&side).normalize();
    let steps = (ALONG / u32::try_from(strip.quads()).unwrap_or(ALONG).max(1)).max(1);
    let mut halves = [Mesh::default(), Mesh::default()];
    for i in 0..strip.quads() {
        let Some((n, _)) = strip.plane(i) else { continue };
        let ends = [strip.ruling(i), strip.ruling(i + 1)];
        let at = |s: u32, r: u32| {
            let (s, r) = (f64::from(s) / f64::from(steps), f64::from(r) / f64::from(ACROSS));
            let [p, q] = [0, 1].map(|k| ends[0][k] * (1.0 - s) + ends[1][k] * s);
            p * (1.0 - r) + q * r
        };
        for (s, r) in (0..steps).flat_map(|s| (0..ACROSS).map(move |r| (s, r))) {
            let cell = [at(s, r), at(s + 1, r), at(s + 1, r + 1), at(s, r + 1)];
            let e = (eye - (cell[0] + cell[2]) * 0.5).normalize();
            let y = n * (2.0 * e.dot(&n)) - e;
            let stripe = STRIPES * y.dot(&other).atan2(y.dot(&side)) / std::f64::consts::TAU;
            let mesh = &mut halves[usize::from(stripe.rem_euclid(2.0) < 1.0)];
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(cell);
            mesh.normals.extend([n; 4]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    let panels = halves.map(|mesh| PanelShape { mesh, ..PanelShape::default() }).into();
    Scene { panels, ..Scene::default() }
}

/// Stretches of the regression polyline not farther from the strip than its size.
fn regression(strip: &QuadStrip) -> Vec<Vec<Vec3>> {
    let reach = strip.size();
    let near = |p: &Option<Vec3>| p.filter(|p| strip.a().iter().chain(strip.b()).any(|q| (p - q).norm() < reach));
    let all: Vec<Option<Vec3>> = strip.regression_polyline().iter().map(near).collect();
    all.split(Option::is_none)
        .map(|run| run.iter().flatten().copied().collect())
        .filter(|l: &Vec<Vec3>| l.len() > 1)
        .collect()
}

/// The faces of a strip.
fn quads(strip: &QuadStrip, given: bool) -> Result<Scene> {
    let mut scene = Scene::default();
    for face in strip.faces("")? {
        let (u, v) = strip::grid(&face);
        let mesh = strip::mesh(&face, &u, &v, &[]);
        scene.panels.push(PanelShape { mesh, borders: vec![strip::border_line(&face)], ..PanelShape::default() });
    }
    if given {
        let w = warped()?;
        scene.guides = vec![w.a().to_vec(), w.b().to_vec()];
    }
    Ok(scene)
}

/// Figure 1.5: planes about the faces, rulings extended to the regression polyline.
fn envelope(strip: &QuadStrip) -> Scene {
    let mut scene = Scene::default();
    for i in 0..strip.quads() {
        let (Some((n, _)), Some(c)) = (strip.plane(i), strip.regression_point(i)) else { continue };
        let [p, q] = strip.ruling(i);
        let [r, s] = strip.ruling(i + 1);
        let along = ((q - p) + (s - r)).normalize();
        let middle = c + along * 1.3;
        let mut plane = square("", middle, along, n.cross(&along), [1.5, 0.42]);
        plane.rulings = vec![[c - (q - p).normalize() * 0.3, q], [c, s]];
        scene.panels.push(plane);
    }
    scene.guides = vec![strip.regression_polyline().into_iter().flatten().collect()];
    scene
}

/// A plane, a cylinder, a cone and a tangent surface that continue each other, as one finely ruled strip.
fn mixed() -> Result<Answer> {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    // Each step goes forward in the tangent plane, turns the ruling in it, and bends about the new ruling.
    let (mut p, mut e, mut forward) = (Vec3::zeros(), Vec3::y(), Vec3::x());
    let mut put = |p: &Vec3, e: &Vec3| {
        a.push(*p);
        b.push(p + e * 60.0);
    };
    put(&p, &e);
    let turned = |v: Vec3, about: Vec3, angle: f64| {
        nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(about), angle) * v
    };
    // Steps, turn and bend of plane, cylinder, cone, tangent surface.
    let kinds: [(usize, f64, f64); 4] = [(24, 0.0, 0.0), (24, 0.0, 0.05), (30, -0.03, 0.03), (30, 0.01, -0.05)];
    for (kind, (steps, turn, bend)) in kinds.into_iter().enumerate() {
        // The cone's apex lies on its first ruling, and all points keep their distance from it.
        const RADIUS: f64 = 130.0;
        let apex = p + e * RADIUS;
        for k in 0..steps {
            // A tangent surface turns at a rate that changes.
            let turn = if kind == 3 { turn * (1.0 + 0.1 * f64::from(u32::try_from(k)?)) } else { turn };
            let normal = e.cross(&forward);
            e = turned(e, normal, turn);
            p = if kind == 2 { apex - e * RADIUS } else { p + forward * 4.0 };
            forward = turned((forward - e * forward.dot(&e)).normalize(), e, bend);
            put(&p, &e);
        }
    }
    let strips: Vec<Strip> = QuadStrip::new(a, b)?.faces("A")?;
    let chain: Vec<&Strip> = strips.iter().collect();
    let patterns = pattern(&chain, 0, "A", &StripOptions::new(0.01)).into_iter().collect();
    let parts = vec![Part { name: "A".into(), first: 0, count: strips.len(), missing: None }];
    let mut answer = Answer::shown(Job::Planarise, "mixed", 1e-3, strips, patterns);
    answer.parts = parts;
    Ok(answer)
}
