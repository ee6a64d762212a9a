//! Tells what a STEP file holds: `cargo run --release --example info -- hull.step`.

#![allow(clippy::print_stdout)]

use std::error::Error;
use torse::{measure, read};

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("give a file")?;
    let model = read(&std::fs::read(file)?)?;
    for (face, info) in model.faces.iter().zip(measure(&model.faces)) {
        println!("#{}: {}, {}, {:.0} mm²", face.entity, info.kind, info.character(), info.area_estimate);
    }
    for item in &model.skipped {
        println!("not read: {}", torse::io::words::left_out(item));
    }
    Ok(())
}
