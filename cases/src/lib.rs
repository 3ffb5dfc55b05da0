//! Case files: one schema of all sections, from which reader, writer, templates and documentation are derived.
//!
//! [`Case`] is a case as stated in its file, overridden by options, with defaults filled in; it can be written as TOML.
//! Rows of [`keys()`] are the scalar keys, which a map can sweep; they include the constants of the registered models.
//! A structured section is a [`schema::Form`] of items with type, unit, range, default and meaning. Reader, writer, the
//! templates of `wellposed new` ([`template`]), the reference page ([`reference()`]) and the JSON Schema
//! ([`json_schema()`]) are derived from these schemas. An error gives file, line and key, the value found and the
//! values allowed. [`CASES`] has the texts of the bundled cases.
//!
//! The crate depends on the models, but not on analysis, solvers or reports.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bundled;
mod case;
mod check;
mod convert;
pub mod dynamics;
mod entries;
mod error;
mod flat;
pub mod flow;
mod forms;
mod json_schema;
mod keys;
mod kind;
mod map;
mod material;
mod named_enum;
mod node;
mod numbers;
mod place;
mod position;
mod receivers;
mod reference;
pub mod schema;
mod section;
pub mod template;
mod types;
mod value;

pub use bundled::CASES;
pub use case::{Case, InTime, MAX_FILE};
pub use check::Check;
pub use convert::{Converted, radians};
pub use dynamics::Dynamics;
pub use error::{CaseError, Place};
pub use flow::FlowRun;
pub use forms::all_forms;
pub use json_schema::json_schema;
pub use keys::{Key, Parameter, Presence, keys};
pub use kind::{Kind, Medium, NoSuchMedium, Solid, Yield, names};
pub use map::{MAX_POINTS, Map, Sweep};
pub use material::Material;
pub use numbers::{BackgroundNumbers, Constants, Numbers, StressNumbers, Wave};
pub use reference::reference;
