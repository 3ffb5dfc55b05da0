//! Flutter and shear bands over all directions against brute force, caps of flutter of known size, invariances
//! and Rudnicki & Rice's closed form.

mod brute_force;
mod certified;
mod covering;
mod directions;
mod flutter;
mod invariances;
mod random_solids;
mod shear_bands;
mod special_cases;
