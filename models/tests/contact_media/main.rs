//! Diagrams of granular and porous media in uniaxial strain against the tensor laws, integrated in small steps with a
//! conic solver, and against closed forms; steps of their laws against optimality conditions, energies and diagrams.

mod closed_forms;
mod granular_steps;
mod kelvin_voigt;
mod maxwell;
mod parameters;
mod plastic_cone_steps;
mod pore_cone_steps;
mod pore_steps;
mod tensor_law;
mod tensors;
