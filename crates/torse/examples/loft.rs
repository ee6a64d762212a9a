//! Lays a developable surface between two curves: `cargo run --release --example loft -- a.dxf b.dxf duct`.

#![allow(clippy::print_stdout)]

use std::error::Error;
use torse::io::curves::CurveOptions;
use torse::{files, loft, read_curve, Control, Loft};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [a, b, folder] = &arguments[..] else { return Err("give RAIL_A RAIL_B FOLDER".into()) };
    // Tables do not say their unit: theirs is taken for the millimetre.
    let options = |name: &str| CurveOptions { unit: Some(1.0), ..CurveOptions::new(name) };
    let (rail_a, _) = read_curve(&std::fs::read(a)?, &options(a))?;
    let (rail_b, _) = read_curve(&std::fs::read(b)?, &options(b))?;
    let mut answer = loft(&rail_a, &rail_b, &Loft::new(0.1), &Control::default())?;
    std::fs::create_dir_all(folder)?;
    for (name, bytes) in files(&mut answer, "2026-01-31T12:00:00")? {
        std::fs::write(format!("{folder}/{name}"), bytes)?;
    }
    println!("{:?}: {} strips in {} parts", answer.status(), answer.patchwork().panels.len(), answer.parts.len());
    Ok(())
}
