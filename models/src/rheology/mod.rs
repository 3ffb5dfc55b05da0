//! Viscoelastic laws: solids whose stress depends on history through history variables with rate equations.

pub mod relaxation;
