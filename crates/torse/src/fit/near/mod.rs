//! Torses near samples of a surface: planes, torses over profiles, envelopes of planes; the largest distance counts.

pub(in crate::fit) mod basis;
pub(crate) mod centre_line;
pub(crate) mod chords;
pub mod descent;
pub(in crate::fit) mod directions;
pub mod dual;
pub(in crate::fit) mod envelope;
pub(crate) mod exact;
pub mod plane;
pub(in crate::fit) mod power_form;
pub mod primal;
pub(in crate::fit) mod profile;
pub mod refit;
pub mod samples;
pub mod tangent_envelope;
