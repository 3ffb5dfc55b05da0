//! Growth in the models with dilatancy on both sides of the bounds on the non-coaxiality: verdicts by properties of the
//! background, confirmed by brute force in 256 bits.

mod backgrounds;
mod balanced_gradients;
mod brute_force;
mod harris_grekova;
mod leading_coefficient;
mod potential_and_double_shearing;
