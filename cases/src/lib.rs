//! Case files: one schema of all sections, from which reader, writer, templates and documentation are derived.
//!
//! [`Case`] is a case as stated in its file, overridden by options, with defaults filled in; it can be written as TOML.
//! Rows of [`keys()`] are the scalar keys, which a map can sweep; they include the constants of the registered models.
//! A structured section is a [`schema::TableSchema`] of keys with type, unit, range, default and meaning. Reader,
//! writer, the templates of `wellposed new` ([`template`]), the reference page ([`generate_reference()`]) and the JSON
//! Schema ([`generate_json_schema()`]) are derived from these schemas. An error gives file, line and key, the value
//! found and the values allowed. [`CASES`] has the texts of the bundled cases.
//!
//! The crate depends on the models, but not on analysis, solvers or reports.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bundled;
mod case;
mod check;
mod continuum;
mod convert;
pub mod dynamics;
mod entries;
mod equations;
mod error;
pub mod flow;
mod former_names;
mod json_schema;
mod key_positions;
mod keys;
mod kind;
mod map;
mod material;
mod missing_grid;
mod named_enum;
mod node;
mod numbers;
mod periodic_blocks;
pub mod plane_wave;
mod position_checks;
mod receivers;
mod reference;
mod rheology;
mod scalar_keys;
pub mod schema;
mod section;
mod section_schemas;
pub mod template;
mod toml_faults;
mod types;
mod value;

pub use bundled::{CASES, bundled_case_name, find_bundled_case, suggest_case};
pub use case::{Case, MAX_FILE_SIZE, TimeDomainRun};
pub use check::CheckOptions;
pub use continuum::{ContinuumOptions, EquivalentContinuum};
pub use convert::{ConvertedCase, degrees_to_radians};
pub use dynamics::SolidRun;
pub use equations::{EquationsCase, derivative_name};
pub use error::{CaseError, SourcePosition};
pub use flow::FlowRun;
pub use former_names::CaseHint;
pub use json_schema::generate_json_schema;
pub use keys::{Key, Presence, SweepParameter, keys};
pub use kind::{MediumKind, ModelKind, SolidKind, YieldSetError, YieldSetKind, join_names};
pub use map::{MAX_MAP_POINTS, MapAxes, ParameterSweep, SweepSpacing};
pub use material::Material;
pub use numbers::{BackgroundNumbers, CaseNumbers, ConstantValues, StressNumbers, WaveNumbers};
pub use periodic_blocks::{PeriodicBlocks, SquareBlocks};
pub use reference::generate_reference;
pub use rheology::{LoadHistory, RheologyCase, TREE_KIND};
pub use section_schemas::all_schemas;
pub use value::find_similar_name;
