//! The library as its users meet it: every job from what is read to what is written, laws, readers, proofs.

mod across;
mod approximate;
mod cones;
mod discrete;
mod dual;
mod exact;
mod fit;
mod flat_parts;
mod iges;
mod laws;
mod panels;
mod refold;
mod round_trip;
mod ruled;
mod seams;
mod shop;
mod step;
mod view;
mod written;
