//! The STEP reader on small files written here, whole and damaged.

mod damage;
mod kinds;
mod more;
mod text;
mod trims;
