//! Diagrams of granular and porous media in uniaxial strain against the tensor laws, integrated in small steps with a
//! conic solver, and against closed forms.

mod closed_forms;
mod parameters;
mod tensor_law;
