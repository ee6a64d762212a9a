//! The STEP reader on small files written here, whole and damaged.

mod assemblies;
mod damage;
mod kinds;
mod more;
mod skins;
mod text;
mod trims;
