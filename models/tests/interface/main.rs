//! Face laws of layers: energy balance, independent references, closed-form limits, flow along saturated layers.

mod balance;
mod elastic;
mod fluid;
mod fracture;
mod kinds;
mod limits;
mod plastic;
mod reference;
mod support;
