//! Reading and writing of IGES files, on small files made here.

mod assemblies;
mod damage;
mod file;
mod kinds;
mod solids;
mod trims;
mod written;

use torse::brep::area::area_estimate;
use torse::brep::face::Face;
use torse::certify::trims::trim_proof;
use torse::io::iges::read;

/// The model of a file that is to be read without loss.
pub fn model(f: &file::File) -> torse::Model {
    let model = read::read(&f.bytes()).expect("a model");
    assert!(model.skipped.is_empty(), "{:?}", model.skipped);
    model
}

/// Its area, mm².
pub fn area(f: &Face) -> f64 {
    area_estimate(f)
}

/// Whether an area is as it should be, within what chords lose, and the trim is proven.
pub fn has_area(f: &Face, wanted: f64) {
    let a = area(f);
    assert!((a - wanted).abs() <= 1e-4 * wanted, "area {a}, wanted {wanted}");
    let size = f.surface.bbox().diagonal();
    let bound = trim_proof(f, 1e-6 * size).bound().value();
    assert!(bound <= 1e-3 * size, "trim bound {bound} of a face of {size}");
}
