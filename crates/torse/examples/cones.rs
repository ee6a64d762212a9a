//! Makes developable faces exact cones, cylinders and planes:
//! `cargo run --release --example cones -- chute.step 0.5 chute-cones` (tolerance in mm).

#![allow(clippy::print_stdout)]

use std::error::Error;
use torse::{cones, files, read, ConesOptions, Control};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, tolerance, folder] = &arguments[..] else { return Err("give FILE TOLERANCE FOLDER".into()) };
    let model = read(&std::fs::read(file)?)?;
    let options = ConesOptions::new(tolerance.parse()?, "chute");
    let mut answer = cones(&model.faces, &model.skipped, &options, &Control::default())?;
    std::fs::create_dir_all(folder)?;
    for (name, bytes) in files(&mut answer, "2026-01-31T12:00:00")? {
        std::fs::write(format!("{folder}/{name}"), bytes)?;
    }
    println!("{:?}: {} pieces in {} parts", answer.status(), answer.patchwork().panels.len(), answer.parts.len());
    Ok(())
}
