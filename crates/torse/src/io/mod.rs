//! Floor 9: files in and out. What is computed for them is asked of lower floors; nothing is fitted or proven here.

pub mod artwork;
mod artwork_drawing;
pub mod bend_table;
pub mod bends;
pub mod bundle;
pub mod cad;
pub mod cloud;
pub mod curves;
pub mod drawings;
pub mod dxf;
pub mod elements;
pub mod glb;
pub(crate) mod html;
pub mod iges;
pub mod json;
pub mod marks;
mod markup;
pub mod materials;
pub mod model;
pub mod net;
pub(crate) mod parts;
pub(crate) mod pictures;
pub mod png;
pub mod quads;
pub mod refold_report;
pub mod result_folder;
pub mod rulings;
pub mod shape;
pub(crate) mod shop_tables;
pub mod step;
mod stretches;
pub(crate) mod svg;
pub mod sweep;
mod table;
pub mod threedm;
pub mod words;

#[cfg(test)]
mod laws;
