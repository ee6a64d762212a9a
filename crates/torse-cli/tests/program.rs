//! The program as people call it.

mod bad_input;
mod branch_and_trough;
mod cones;
mod curves;
mod fit;
mod folders;
mod left_out;
mod loft;
mod net;
mod planarise;
mod refold;
mod shop_floor;
mod smooth_faces;
mod sweep;
mod unroll;
mod view;
