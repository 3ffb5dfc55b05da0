//! Tests of the analysis in one program, so that it is compiled and linked once and its tests use all threads.
//!
//! `cargo test --release -p wellposed-analysis --test analysis waves::` runs the tests of one file.

mod support;

#[path = "acoustic_tensor2.rs"]
mod acoustic_tensor2;
#[path = "acoustic_tensor3/main.rs"]
mod acoustic_tensor3;
#[path = "bloch/main.rs"]
mod bloch;
#[path = "bound.rs"]
mod bound;
#[path = "brute_force.rs"]
mod brute_force;
#[path = "certified/main.rs"]
mod certified;
#[path = "characteristics.rs"]
mod characteristics;
#[path = "dilatant/main.rs"]
mod dilatant;
#[path = "equations/main.rs"]
mod equations;
#[path = "extended_precision.rs"]
mod extended_precision;
#[path = "form.rs"]
mod form;
#[path = "hyperbolic.rs"]
mod hyperbolic;
#[path = "invariances.rs"]
mod invariances;
#[path = "kelvin.rs"]
mod kelvin;
#[path = "plane_shocks/main.rs"]
mod plane_shocks;
#[path = "qz.rs"]
mod qz;
#[path = "roots.rs"]
mod roots;
#[path = "verdict/main.rs"]
mod verdict;
#[path = "waves/main.rs"]
mod waves;
