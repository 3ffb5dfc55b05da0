//! Bloch waves of blocky media against published frequencies, closed forms and independent computations.

mod bands;
mod cell;
mod chain;
mod damped_cell;
mod finite_elements;
mod media;
mod scheme;
