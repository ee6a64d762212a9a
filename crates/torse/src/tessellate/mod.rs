//! Floor 6: triangles, for pictures and mesh files. Nothing is proven here.

pub(crate) mod coverage;
pub(crate) mod diagnostics;
pub mod panel;
pub mod strip;

#[cfg(test)]
mod laws;
