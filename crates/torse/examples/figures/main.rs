//! Figures of the papers, drawn with the library: `cargo run --release --example figures -- NAME FOLDER`.

mod composite;
mod cones;
mod counts;
mod curves;
mod discrete;
mod dual;
mod inputs;
mod loft;
mod map;
mod nets;
mod ruled;
mod stripes;

use std::error::Error;
use std::path::Path;

type Draw = fn(&Path) -> Result<(), Box<dyn Error>>;

/// What can be drawn, by name.
const FIGURES: &[(&str, Draw)] = &[
    ("composite", composite::draw),
    ("cones", cones::draw),
    ("counts", counts::draw),
    ("curves", curves::draw),
    ("discrete", discrete::draw),
    ("dual", dual::draw),
    ("inputs", inputs::draw),
    ("loft", loft::draw),
    ("map", map::draw),
    ("nets", nets::draw),
    ("ruled", ruled::draw),
];

fn main() -> Result<(), Box<dyn Error>> {
    let names = FIGURES.iter().map(|f| f.0).collect::<Vec<_>>().join(", ");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, folder] = arguments.as_slice() else {
        return Err(format!("give a name ({names}) and a folder").into());
    };
    let (_, draw) = FIGURES.iter().find(|f| f.0 == name).ok_or(format!("'{name}' is none of {names}"))?;
    std::fs::create_dir_all(folder)?;
    draw(Path::new(folder))
}
