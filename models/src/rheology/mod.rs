//! Rheology: laws whose stress depends on history.
//!
//! A rheological scheme is a tree of springs, dampers, plastic hinges and rigid contacts in series and in parallel
//! (Sadovskii & Sadovskaya 2019): uniaxial laws of granular and porous media.
//!
//! | module | holds |
//! |---|---|
//! | [`element`] | the elements with their constants, states and energies |
//! | [`scheme`] | trees of named elements, and their checks |
//! | [`step`] | one implicit step, solved exactly by sums of monotone polylines |
//! | [`load_path`] | strain or stress against time, and the diagram of the response |
//! | [`named`] | the schemes that have names |
//! | [`relaxation`] | standard linear solid in space: relaxation of the deviator through history variables |

pub mod element;
pub mod load_path;
pub mod named;
mod notation;
mod polyline;
pub mod relaxation;
pub mod scheme;
pub mod step;
