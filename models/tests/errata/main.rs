//! The printed errors of Harris & Grekova (2005), one test per erratum.
//!
//! Each test compares the printed and the corrected formula with an independent reference value: the derivative of the
//! nonlinear equations, an elimination in complex arithmetic, or a determinant expanded in 31 digits. A test fails if
//! the corrected formula is wrong in any of the random states, or if the printed formula is right in more than a few
//! percent of them.
//!
//! Rows and columns are numbered as in the paper for ν = 0: rows momentum 1, 2, spin, continuity, rotation; columns v₁,
//! v₂, ω, p, ψ. Indices in code start from zero: e₁₄ is `e[0][3]`.

mod comparison;
mod dispersion_polynomial;
mod eliminated_equations;
mod elimination;
mod linearised_equations;
mod roots;
mod system;
mod well_posedness;
