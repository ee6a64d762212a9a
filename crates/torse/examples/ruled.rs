//! Ruled strips over the saddle-shaped faces of a CAD model: `cargo run --example ruled -- FILE.step`.

#![allow(clippy::print_stdout)]

use torse::{Control, RuledOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: ruled FILE")?;
    let model = torse::read(&std::fs::read(&file)?)?;
    let found = torse::ruled(model.faces, model.skipped, &RuledOptions::new(10.0), &Control::default())?;
    println!("{:?}: {} strips", found.answer.status(), found.answer.patchwork().panels.len());
    for claim in found.answer.claims() {
        println!("{:?}: {:.4} ({:?})", claim.what(), claim.value(), claim.evidence());
    }
    for ruling in found.rulings.iter().take(3) {
        println!(
            "{} {}: {:.1} to {:.1}",
            ruling.strip,
            ruling.number,
            ruling.ends[0].transpose(),
            ruling.ends[1].transpose()
        );
    }
    Ok(())
}
