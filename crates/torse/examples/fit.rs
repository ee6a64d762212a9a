//! Fits developable strips to measured points: `cargo run --release --example fit -- scan.ply 0.5 sheet`.

#![allow(clippy::print_stdout)]

use std::error::Error;
use torse::io::cloud;
use torse::{files, fit, Control, FitOptions};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, tolerance, folder] = &arguments[..] else { return Err("give FILE TOLERANCE FOLDER".into()) };
    // Scans do not say their unit: theirs is taken for the millimetre.
    let scan = cloud::read(file, &std::fs::read(file)?, Some(1.0))?;
    let mut answer = fit(&scan, &FitOptions::new(tolerance.parse()?, "scan"), &Control::default())?;
    std::fs::create_dir_all(folder)?;
    for (name, bytes) in files(&mut answer, "2026-01-31T12:00:00")? {
        std::fs::write(format!("{folder}/{name}"), bytes)?;
    }
    println!("{:?}: {} strips for {} points", answer.status(), answer.patchwork().panels.len(), scan.points.len());
    Ok(())
}
