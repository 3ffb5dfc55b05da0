//! Viscoelastic laws: solids whose stress depends on history, by memory variables with rate equations of their own.

pub mod relaxation;
