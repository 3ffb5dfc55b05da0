//! Viscoelastic laws: solids whose stress depends on history through memory variables with their own rate equations.

pub mod relaxation;
