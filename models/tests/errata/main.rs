//! The printed errors of Harris & Grekova (2005), one test per erratum.
//!
//! Each test holds the printed formula and the corrected one against a truth that uses neither: the
//! derivative of the nonlinear equations, an elimination carried out in complex arithmetic, or a
//! determinant expanded in 31 digits. It fails when the corrected form misses the truth, and it
//! fails when the printed form would do as well (then the erratum is none).
//!
//! Numbering of rows and columns as in the paper for ν = 0: rows momentum 1, 2, spin, continuity,
//! rotation; columns v₁, v₂, ω, p, ψ. Indices in code count from zero: e₁₄ is `e[0][3]`.

mod comparison;
mod dispersion_polynomial;
mod eliminated_equations;
mod elimination;
mod linearised_equations;
mod roots;
#[path = "../support/mod.rs"]
mod support;
mod system;
mod well_posedness;
