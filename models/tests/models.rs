//! Tests of the models in one program, so that it is compiled and linked once and its tests use all threads.
//!
//! `cargo test --release -p wellposed-models --test models projection::` runs the tests of one file.

mod support;

#[path = "background.rs"]
mod background;
#[path = "characteristics.rs"]
mod characteristics;
#[path = "closed_form_verdict.rs"]
mod closed_form_verdict;
#[path = "closed_forms.rs"]
mod closed_forms;
#[path = "contact_media/main.rs"]
mod contact_media;
#[path = "cosserat/main.rs"]
mod cosserat;
#[path = "elementary.rs"]
mod elementary;
#[path = "equations/main.rs"]
mod equations;
#[path = "errata/main.rs"]
mod errata;
#[path = "homogenised.rs"]
mod homogenised;
#[path = "hopper.rs"]
mod hopper;
#[path = "ill_conditioned_inputs.rs"]
mod ill_conditioned_inputs;
#[path = "interface/main.rs"]
mod interface;
#[path = "invariances.rs"]
mod invariances;
#[path = "linearisation.rs"]
mod linearisation;
#[path = "plasticity.rs"]
mod plasticity;
#[path = "projection/main.rs"]
mod projection;
#[path = "relaxation.rs"]
mod relaxation;
#[path = "return_mapping.rs"]
mod return_mapping;
#[path = "rheology/main.rs"]
mod rheology;
#[path = "rounding.rs"]
mod rounding;
#[path = "solid.rs"]
mod solid;
#[path = "taylor_model.rs"]
mod taylor_model;
#[path = "waves.rs"]
mod waves;
