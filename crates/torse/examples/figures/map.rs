//! A drawing on the flat pattern of a bracket, carried onto the bracket as it is folded.

use std::path::Path;
use torse::answer::presentation::present;
use torse::control::Control;
use torse::draw::picture::{panels, Caption};
use torse::geom::Vec3;
use torse::io::png;
use torse::pipeline::map_artwork::Side;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Places on each line of the drawing.
const PLACES: usize = 400;
/// How far lines are drawn in front of the sheet, mm.
const LIFT: f64 = 1.0;

/// Draws it into a folder.
pub fn draw(folder: &Path) -> Result<()> {
    let model = torse::read(include_bytes!("../../../../data/bracket.step"))?;
    let mut answer = torse::unroll(&model, &torse::UnrollOptions::new(0.01), &Control::default())?;
    let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
    let map = torse::read_map(&|name| files.iter().find(|f| f.0 == name).map(|f| f.1.clone()), None, None)?;
    let shown = present(&answer);
    let mut scene = shown.scene;
    // A little above the sheet, or its triangles would hide some of the lines.
    let above = shown.direction.normalize() * LIFT;
    let lines = drawing();
    let seen = lines.iter().flat_map(|line| carried(&map, line));
    scene.guides = seen.map(|stretch| stretch.iter().map(|p| p + above).collect()).collect();
    let note = "two rings and two waves".into();
    let caption = Caption { width: 800, title: "Drawn flat, carried into space".into(), note };
    Ok(std::fs::write(folder.join("carried.png"), png::write(&panels(&scene, &shown.direction, &caption))?)?)
}

/// Rings and waves on the flat part.
fn drawing() -> Vec<Vec<Vec3>> {
    let share = |k: usize| k as f64 / PLACES as f64;
    let ring = |radius: f64| -> Vec<Vec3> {
        let turn = |k: usize| std::f64::consts::TAU * share(k);
        (0..=PLACES).map(|k| Vec3::new(68.0 + radius * turn(k).cos(), 40.0 + radius * turn(k).sin(), 0.0)).collect()
    };
    let wave = |middle: f64| -> Vec<Vec3> {
        let across = |k: usize| middle + 5.0 * (6.0 * std::f64::consts::TAU * share(k)).sin();
        (0..=PLACES).map(|k| Vec3::new(140.0 * share(k), across(k), 0.0)).collect()
    };
    vec![ring(34.0), ring(26.0), wave(12.0), wave(68.0)]
}

/// A line of the flat part in space, in as many stretches as lie on it.
fn carried(map: &torse::ArtworkMap, line: &[Vec3]) -> Vec<Vec<Vec3>> {
    let points: Vec<(usize, Vec3)> = line.iter().copied().enumerate().collect();
    let rows = map.points(&points, Side::Space);
    rows.split(|r| r.place.is_none())
        .map(|stretch| stretch.iter().filter_map(|r| r.place).collect())
        .filter(|stretch: &Vec<Vec3>| stretch.len() > 1)
        .collect()
}
