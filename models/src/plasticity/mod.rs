//! Yield sets of solids, and what they make of Hooke's law.

pub mod parameters;
pub mod projection;
pub mod symbol;
