//! Writes the pictures of a made-up model: a look at the drawing code without fitting anything.
//!
//! `cargo run --example report_sample -- FOLDER`

use std::error::Error;
use std::path::Path;
use torse::draw::flat;
use torse::draw::picture::{self, Caption};
use torse::draw::scene::{PanelShape, Scene};
use torse::geom::mesh::Mesh;
use torse::geom::{Vec2, Vec3};
use torse::io::html::{self, Page};
use torse::io::json::{FaceRecord, PanelRecord, Report, WitnessRecord, SCHEMA};
use torse::io::png;
use torse::patchwork::pattern::{Contour, ContourVertex, Mark, Pattern};

const STRIPS: usize = 9;
const TOLERANCE: f64 = 1.0;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give a folder to write to")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let scene = scene();
    let patterns: Vec<Pattern> = (0..STRIPS).map(pattern).collect();
    let placements: Vec<(f64, Vec2)> =
        (0..STRIPS).map(|i| (0.0, Vec2::new((i % 2) as f64 * 1350.0, (i / 2) as f64 * 170.0))).collect();
    let pieces = flat::pieces(&patterns, &placements, 0.1);
    let caption = |note: &str| Caption { title: "sample".into(), note: note.into(), ..Caption::default() };
    let direction = picture::direction(&scene);
    let note = caption("9 panels, each within 0.987 mm of the surface");
    let panels_png = png::write(&picture::panels(&scene, &direction, &note))?;
    std::fs::write(folder.join("panels.png"), &panels_png)?;
    let note = caption("distance of the panels from the surface");
    let deviation_png = png::write(&picture::deviation(&scene, &direction, TOLERANCE, &note))?;
    std::fs::write(folder.join("deviation.png"), &deviation_png)?;
    std::fs::write(
        folder.join("layout.png"),
        png::write(&picture::layout(&pieces, &caption("flat patterns, 1:1 in patterns.dxf")))?,
    )?;
    let report = report(&patterns);
    std::fs::write(folder.join("report.json"), report.to_json()?)?;
    let page = Page {
        report: &report,
        scene: &scene,
        direction,
        layout: &pieces,
        panels_png: &panels_png,
        deviation_png: &deviation_png,
    };
    std::fs::write(folder.join("report.html"), html::write(&page)?)?;
    let mut failed = report.clone();
    failed.status = "uncertified".into();
    failed.reason = "panel A-03 exceeds the tolerance".into();
    failed.deviation_bound = Some(1.31);
    failed.panels[2].certified = false;
    failed.panels[2].reason = "the distance exceeds the tolerance".into();
    failed.panels[2].deviation_bound = Some(1.31);
    failed.panels[2].witness = Some(WitnessRecord { uv: [0.25, 0.3125], distance: Some(-1.287) });
    std::fs::write(folder.join("uncertified.html"), html::write(&Page { report: &failed, ..page })?)?;
    Ok(())
}

/// Made-up numbers for the report.
fn report(patterns: &[Pattern]) -> Report {
    let panel = |p: &Pattern| PanelRecord {
        name: p.name.clone(),
        face: 0,
        kind: "torse".into(),
        certified: true,
        reason: String::new(),
        witness: None,
        deviation_bound: Some(0.987 - 0.013 * p.panel as f64),
        developability_bound: Some(3.1e-10 * (p.panel + 1) as f64),
        regression_clearance: (p.panel != 4).then_some(2120.0 - 37.0 * p.panel as f64),
        min_bend_radius: Some(240.0 - 25.5 * p.panel as f64),
        area: Some(p.area_in_space),
        flat_area: Some(p.area),
        isometry_error: Some(p.isometry_error),
        contour_error: Some(p.contour_error),
        strain_bound: None,
        drawing_bound: None,
        length: Some(p.length),
        width: Some(p.width),
        view: p.view.name().into(),
        bends: Vec::new(),
    };
    Report {
        schema: SCHEMA.into(),
        version: "0.1.0".into(),
        status: "certified".into(),
        reason: String::new(),
        unit: "mm".into(),
        input: "sample.step".into(),
        tolerance: TOLERANCE,
        deviation_bound: Some(0.987),
        seam_gap_bound: Some(0.0042),
        coverage: 1.0,
        seconds: 3.217,
        missing: vec![],
        notes: Vec::new(),
        skipped: vec![],
        faces: vec![FaceRecord {
            entity: 42,
            name: "side".into(),
            part: "boat".into(),
            kind: "spline".into(),
            panels: STRIPS,
            coverage: 1.0,
            trim_deviation_estimate: Some(0.0),
            surface_deviation_estimate: Some(0.0),
            joined: Vec::new(),
            joint_bound: 0.0,
            trim_bound: Some(0.0),
        }],
        panels: patterns.iter().map(panel).collect(),
        seams: Vec::new(),
        along: Vec::new(),
        written: Vec::new(),
    }
}

/// A point of a boat-like surface; u along, v from keel to sheer.
fn point(u: f64, v: f64) -> Vec3 {
    let beam = 330.0 * (1.0 - (2.0 * u - 1.05).powi(2) * 0.75);
    let angle = v * 1.45;
    Vec3::new(
        1300.0 * (u - 0.5) * (1.0 + 0.06 * v),
        -beam * angle.sin(),
        300.0 - (240.0 + 50.0 * u) * angle.cos() + 60.0 * (2.0 * u - 1.0).powi(2),
    )
}

fn normal(u: f64, v: f64) -> Vec3 {
    let h = 1e-4;
    (point(u + h, v) - point(u - h, v)).cross(&(point(u, v + h) - point(u, v - h))).normalize()
}

fn seam(u: f64, k: usize) -> f64 {
    k as f64 / STRIPS as f64 + if k == 0 || k == STRIPS { 0.0 } else { 0.03 * (5.0 * u).sin() }
}

fn scene() -> Scene {
    const N: usize = 80;
    const M: usize = 10;
    let grid = |at: &dyn Fn(f64, f64) -> (f64, f64), value: &dyn Fn(f64, f64) -> f64| {
        let mut mesh = Mesh::default();
        for i in 0..=N {
            for j in 0..=M {
                let (s, t) = (i as f64 / N as f64, j as f64 / M as f64);
                let (u, v) = at(s, t);
                mesh.positions.push(point(u, v));
                mesh.normals.push(normal(u, v));
                mesh.values.push(value(s, t));
            }
        }
        let row = M as u32 + 1;
        for i in 0..N as u32 {
            for j in 0..M as u32 {
                let k = i * row + j;
                mesh.triangles.extend([[k, k + row, k + 1], [k + 1, k + row, k + row + 1]]);
            }
        }
        mesh
    };
    let panels = (0..STRIPS)
        .map(|k| {
            let place = move |s: f64, t: f64| (s, seam(s, k) * (1.0 - t) + seam(s, k + 1) * t);
            let at = |s: f64, t: f64| {
                let (u, v) = place(s, t);
                point(u, v)
            };
            let border = (0..=N)
                .map(|i| at(i as f64 / N as f64, 0.0))
                .chain((0..=N).rev().map(|i| at(i as f64 / N as f64, 1.0)))
                .chain([at(0.0, 0.0)])
                .collect();
            PanelShape {
                name: format!("A-{:02}", k + 1),
                mesh: grid(&place, &move |s, t| {
                    TOLERANCE
                        * 0.97
                        * (1.0 - 2.0 * (2.0 * t - 1.0).powi(2))
                        * (0.75 + 0.25 * (9.0 * s + k as f64).sin())
                }),
                rulings: (0..=30).map(|i| [at(i as f64 / 30.0, 0.0), at(i as f64 / 30.0, 1.0)]).collect(),
                borders: vec![border],
                marked: false,
            }
        })
        .collect();
    Scene { panels, surfaces: vec![grid(&|s, t| (s, t), &|_, _| 0.0)], ..Scene::default() }
}

fn pattern(k: usize) -> Pattern {
    let name = format!("A-{:02}", k + 1);
    let bend = 0.02 + 0.012 * k as f64;
    let vertex = |x: f64, y: f64, bulge: f64| ContourVertex { point: Vec2::new(x, y), bulge, corner: true };
    let contour = Contour {
        vertices: vec![
            vertex(0.0, 10.0, bend),
            vertex(640.0, 0.0, bend),
            vertex(1280.0, 20.0, 0.0),
            vertex(1265.0, 75.0, -0.8 * bend),
            vertex(650.0, 70.0, -0.8 * bend),
            vertex(15.0, 80.0, 0.0),
        ],
    };
    let rulings = (1..30)
        .map(|i| {
            let x = 1280.0 * i as f64 / 30.0;
            [Vec2::new(x, 5.0), Vec2::new(0.985 * x + 10.0, 66.0)]
        })
        .collect();
    let marks = (1..8)
        .map(|i| Mark {
            point: Vec2::new(160.0 * i as f64, 2.0),
            inward: Vec2::new(0.0, 1.0),
            label: format!("S{k}.{i}"),
        })
        .collect();
    Pattern {
        panel: k,
        name,
        contours: vec![contour],
        bends: Vec::new(),
        view: Default::default(),
        rulings,
        marks,
        sides: vec![],
        area: 82_000.0,
        area_in_space: 82_000.0,
        isometry_error: 2e-9,
        contour_error: 0.08,
        width: 90.0,
        length: 1281.0,
    }
}
