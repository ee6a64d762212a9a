//! Covers a STEP model with developable panels and writes all files:
//! `cargo run --release --example approximate -- hull.step 2 hull-panels` (tolerance in mm).

#![allow(clippy::print_stdout)]

use std::error::Error;
use torse::{approximate, files, read, Approximate};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, tolerance, folder] = &arguments[..] else { return Err("give FILE TOLERANCE FOLDER".into()) };
    let model = read(&std::fs::read(file)?)?;
    let mut answer = approximate(&model, &Approximate::new(tolerance.parse()?))?;
    std::fs::create_dir_all(folder)?;
    for (name, bytes) in files(&mut answer, "2026-01-31T12:00:00")? {
        std::fs::write(format!("{folder}/{name}"), bytes)?;
    }
    println!("{:?}: {} panels", answer.status(), answer.patchwork().panels.len());
    for (panel, proof) in answer.strips().zip(answer.certificate().iter().flat_map(|c| &c.panels)) {
        println!("{}: within {:.3} mm, bends to {:.0} mm", panel.name, proof.deviation_bound, proof.min_bend_radius);
    }
    for pattern in answer.patterns() {
        println!("{}: {:.0} x {:.0} mm of sheet", pattern.name, pattern.length, pattern.width);
    }
    Ok(())
}
