//! Growth in the models with dilatancy, on both sides of the bounds on the non-coaxiality: which
//! parts of the background decide, and that brute force in 256 bits sees the same.

mod backgrounds;
mod balanced_gradients;
mod brute_force;
mod harris_grekova;
mod highest_coefficient;
mod other_models;
#[path = "../support/mod.rs"]
mod support;
