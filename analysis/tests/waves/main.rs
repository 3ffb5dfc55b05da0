//! Plane waves of elastic and yielding solids against closed forms, and against the first-order
//! equations.

mod associated_flow;
mod branches;
mod elastic_waves;
mod energy;
mod first_order_equations;
mod flutter;
mod random_solids;
mod yielding;
