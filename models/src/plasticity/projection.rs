//! Projection onto yield sets.
