//! Composites \[W15, TBWP16\]: ruled strips about planar pieces (figure 2.4), discrete and smooth developables along conjugate
//! curves (3.2, 3.5), and a composite that is pulled.

use super::stripes::{ruled_mesh, striped};
use std::path::Path;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::control::Control;
use torse::design::composite::{
    BoundaryCurve, Composite, Facet, Handle, Join, Options, Place, RuledStrip, Session, Smoothness, StripShape,
};
use torse::draw::picture::{self, Caption};
use torse::draw::raster::Image;
use torse::draw::scene::{PanelShape, Scene};
use torse::draw::sequence::sequence;
use torse::geom::mesh::Mesh;
use torse::geom::Vec3;
use torse::io::png;
use torse::io::shape::read;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::tessellate::strip;
use torse::torse::strip::Strip;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Result<()> {
    let save = |name: &str, image: &Image| -> Result<()> {
        Ok(std::fs::write(folder.join(format!("{name}.png")), png::write(image)?)?)
    };
    planar_and_ruled(&save)?;
    limits(&save)?;
    conjugate(&save)?;
    let job = read(include_bytes!("../../../../data/pulled_hull.json"), "hull", None)?;
    let answer = torse::shape(&job, &torse::Shape::new(0.5), &|name| Err(name.into()), &Control::default())?;
    let shown = present(&answer);
    save("pulled", &sequence(&shown.stages, &shown.direction))?;
    let meshes: Vec<Mesh> = answer.strips().map(|s| ruled_mesh(s, 300, 40)).collect();
    let title = "Reflections in the pulled composite";
    save("pulled-reflections", &drawn(striped(&meshes, &shown.direction), &shown.direction, title, ""))
}

fn drawn(scene: Scene, eye: &Vec3, title: &str, note: &str) -> Image {
    picture::panels(&scene, eye, &Caption { width: 800, title: title.into(), note: note.into() })
}

fn shape(s: &Strip, spacing: f64) -> PanelShape {
    let mut out = PanelShape { mesh: ruled_mesh(s, 120, 8), ..PanelShape::default() };
    out.rulings = strip::ruling_lines(s, spacing);
    out.borders = vec![strip::border_line(s)];
    out
}

/// Clamped cubic knots over [0, 1] with so many pieces, inner ones twice.
fn knots(pieces: usize) -> Result<Knots> {
    let mut values = vec![0.0; 4];
    (1..pieces).for_each(|i| values.extend([i as f64 / pieces as f64; 2]));
    values.extend([1.0; 4]);
    let count = values.len() - 4;
    Ok(Knots::new(3, values, count)?)
}

/// A ruled strip between two lines, bent upwards by `rise` in the middle.
fn add(c: &mut Composite, name: &str, ends: [[Vec3; 2]; 2], rise: f64) -> Result<()> {
    let knots = knots(3)?;
    let n = knots.control_count();
    let mut sides: [String; 2] = Default::default();
    for (k, side) in sides.iter_mut().enumerate() {
        *side = format!("{name}{}", ["a", "b"][k]);
        let (p, q) = (ends[0][k], ends[1][k]);
        let at = |i: usize| {
            let g = i as f64 / (n - 1) as f64;
            (p + (q - p) * g + Vec3::z() * (rise * (std::f64::consts::PI * g).sin())).into()
        };
        let curve = Curve { knots: knots.clone(), control: (0..n).map(at).collect() };
        c.curves.push(BoundaryCurve { name: side.clone(), curve, fixed: false });
    }
    c.strips.push(RuledStrip { name: name.into(), sides, shape: StripShape::Ruled });
    Ok(())
}

/// Figure 2.4: six ruled pieces about four planar triangles.
fn planar_and_ruled(save: &dyn Fn(&str, &Image) -> Result<()>) -> Result<()> {
    let mut c = Composite::default();
    let turn = |k: f64, r: f64, z: f64| {
        let a = std::f64::consts::TAU * k / 3.0;
        Vec3::new(r * a.cos(), r * a.sin(), z)
    };
    let place = |curve: String, u: f64| Place { curve, u };
    let mut joins = Vec::new();
    let mut meet = |a: Place, b: Place| joins.push(Join::Ends { ends: [a, b], smoothness: Smoothness::G0 });
    for i in 0..3 {
        let (x, next) = (f64::from(i), (i + 1) % 3);
        // From a side of the middle to a triangle, and from another side of that outwards.
        let inner = [turn(x - 0.5, 1.0, 1.2), turn(x + 0.5, 1.0, 1.2)];
        let outer = [turn(x - 0.2, 2.6, 0.8), turn(x + 0.2, 2.6, 0.7)];
        let tip = turn(x + 0.05, 3.4, 0.4);
        let low = [turn(x + 0.3, 4.2, -0.6), turn(x + 0.16, 4.9, -0.9)];
        add(&mut c, &format!("in{i}"), [inner, outer], 0.25)?;
        add(&mut c, &format!("out{i}"), [[outer[1], tip], low], 0.2)?;
        meet(place(format!("in{i}b"), 0.0), place(format!("in{next}a"), 0.0));
        meet(place(format!("in{i}b"), 1.0), place(format!("out{i}a"), 0.0));
        let corners =
            vec![place(format!("in{i}a"), 1.0), place(format!("in{i}b"), 1.0), place(format!("out{i}b"), 0.0)];
        c.facets.push(Facet { name: format!("t{i}"), corners, alpha: None });
        for (side, at) in [("a", low[0]), ("b", low[1])] {
            c.handles.push(Handle::point(&format!("out{i}{side}"), 1.0, at));
        }
    }
    c.joins = joins;
    let corners = (0..3).map(|i| place(format!("in{i}a"), 0.0)).collect();
    c.facets.push(Facet { name: "middle".into(), corners, alpha: None });
    let mut session = Session::new(c, Options::default())?;
    let control = Control::default();
    let report = session.settle(&control);
    session.polish(1e-12, &control)?;
    let strips: Vec<Strip> = session.strips()?.into_iter().chain(session.facets()?).collect();
    let eye = Vec3::new(0.4, -1.0, 1.1);
    let scene = Scene { panels: strips.iter().map(|s| shape(s, 0.16)).collect(), ..Scene::default() };
    let note =
        format!("six ruled strips and four triangles; {:?} after {} iterations", report.status, report.iterations);
    save("figure-2-04-left", &drawn(scene, &eye, "Planar and ruled pieces", &note))?;
    let meshes: Vec<Mesh> = strips.iter().map(|s| ruled_mesh(s, 160, 60)).collect();
    let title = "Reflections in the same surface";
    save("figure-2-04-right", &drawn(striped(&meshes, &eye), &eye, title, "they go on from piece to piece"))
}

/// A surface of revolution with a wavy outline: parallels and meridians are conjugate.
fn turned(v: f64, a: f64) -> Vec3 {
    let r = 1.0 + 0.35 * (3.0 * v).cos();
    Vec3::new(r * a.cos(), r * a.sin(), 1.8 * v)
}

/// Figure 3.2: plane quadrilaterals, refined one way, become a few developables.
fn limits(save: &dyn Fn(&str, &Image) -> Result<()>) -> Result<()> {
    let eye = Vec3::new(1.0, 0.6, 0.35);
    for (letter, along) in [("a", 6u32), ("b", 12), ("c", 24), ("d", 96)] {
        let mut panels = Vec::new();
        for k in 0..6u32 {
            let mut panel = PanelShape::default();
            for i in 0..along {
                let corner = |i: u32, k: u32| turned(f64::from(k) / 6.0, 2.4 * f64::from(i) / f64::from(along) - 0.7);
                let p = [corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1)];
                let first = panel.mesh.positions.len() as u32;
                panel.mesh.positions.extend(p);
                panel.mesh.normals.extend([(p[1] - p[0]).cross(&(p[3] - p[0])).normalize(); 4]);
                panel.mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
                let lines = if along < 96 { vec![p[0], p[1], p[2], p[3], p[0]] } else { vec![p[0], p[1]] };
                panel.borders.push(lines);
            }
            panels.push(panel);
        }
        let scene = Scene { panels, ..Scene::default() };
        let title = if along < 96 { "Plane quadrilaterals" } else { "In the limit: developable strips" };
        save(&format!("figure-3-02-{letter}"), &drawn(scene, &eye, title, &format!("6 strips of {along}")))?;
    }
    Ok(())
}

/// Figure 3.5: strips between parallels of a surface of revolution whose outline bends, drawn to it.
fn conjugate(save: &dyn Fn(&str, &Image) -> Result<()>) -> Result<()> {
    const N: usize = 48;
    let size = 400.0;
    let at = |v: f64, a: f64| turned(v, a) * size;
    let list = |p: Vec3| format!("[{:.9}, {:.9}, {:.9}]", p.x, p.y, p.z);
    let points: Vec<String> = (0..=N)
        .flat_map(|i| (0..=N).map(move |j| (i as f64, j as f64)))
        .map(|(i, j)| list(at(i / N as f64, 1.6 * j / N as f64)))
        .collect();
    let cell = |i: usize, j: usize| {
        let k = i * (N + 1) + j;
        format!("[{k}, {}, {}], [{k}, {}, {}]", k + 1, k + N + 2, k + N + 2, k + N + 1)
    };
    let triangles: Vec<String> = (0..N).flat_map(|i| (0..N).map(move |j| cell(i, j))).collect();
    let curves: Vec<String> = (0..=6)
        .map(|k| {
            let through: Vec<String> = (0..=8).map(|j| list(at(k as f64 / 6.0, 0.2 * j as f64))).collect();
            format!(r#"{{ "name": "c{k}", "through": [{}], "spans": 4 }}"#, through.join(", "))
        })
        .collect();
    let strips: Vec<String> =
        (0..6).map(|k| format!(r#"{{ "name": "s{k}", "sides": ["c{k}", "c{}"] }}"#, k + 1)).collect();
    let job = format!(
        r#"{{ "unit": "mm", "curves": [{}], "strips": [{}],
        "targets": [ {{ "points": [{}], "triangles": [{}], "within": 5 }} ] }}"#,
        curves.join(", "),
        strips.join(", "),
        points.join(", "),
        triangles.join(", ")
    );
    let job = read(job.as_bytes(), "conjugate", None)?;
    let mut mesh = Mesh::default();
    for (i, j) in (0..=N).flat_map(|i| (0..=N).map(move |j| (i, j))) {
        let (v, a) = (i as f64 / N as f64, 1.6 * j as f64 / N as f64);
        mesh.positions.push(at(v, a));
        let across = at(v + 1e-6, a) - at(v - 1e-6, a);
        mesh.normals.push((at(v, a + 1e-6) - at(v, a - 1e-6)).cross(&across).normalize());
        if i > 0 && j > 0 {
            let k = (i * (N + 1) + j) as u32;
            let n = N as u32;
            mesh.triangles.extend([[k - n - 2, k - 1, k], [k - n - 2, k, k - n - 1]]);
        }
    }
    let given = PanelShape { mesh, ..PanelShape::default() };
    let eye = Vec3::new(1.0, 0.9, 0.35);
    let mut guides: Vec<Vec<Vec3>> =
        job.curves.iter().map(|(_, c, _)| c.control.iter().map(|p| Vec3::from(*p)).collect()).collect();
    guides.extend((0..=8).map(|j| (0..=40).map(|i| at(f64::from(i) / 40.0, 0.2 * f64::from(j))).collect()));
    let scene = Scene { panels: vec![given.clone()], guides, ..Scene::default() };
    save(
        "figure-3-05-left",
        &drawn(scene, &eye, "A surface with conjugate curves", "and control points for strips between some of them"),
    )?;
    let answer: Answer = torse::shape(&job, &torse::Shape::new(1.0), &|name| Err(name.into()), &Control::default())?;
    let mut panels: Vec<PanelShape> = answer.strips().map(|s| shape(s, 25.0)).collect();
    panels.push(given);
    let distance = answer.claims().iter().find(|c| torse::io::words::id(c.what()) == "target_distance");
    let note = format!(
        "{:?}: strips and surface within {:.2} mm of each other (proven)",
        answer.status(),
        distance.map_or(f64::NAN, torse::certify::claim::Claim::value)
    );
    save(
        "figure-3-05-right",
        &drawn(Scene { panels, ..Scene::default() }, &eye, "Developable strips drawn to it", &note),
    )
}
