//! Keys of the sections of a model given as equations.

use crate::map::SweepSpacing;
use crate::schema::{
    AllowedRange, KeyGroup, KeySchema, NamedValues, SchemaScope, TableSchema, ValueType,
};

/// Kind in case files of a model given as equations.
pub(crate) const EQUATIONS_KIND: &str = "equations";

pub(super) const KIND_KEY: &str = "kind";
pub(super) const TITLE_KEY: &str = "title";
pub(super) const DIMENSIONS_KEY: &str = "dimensions";
pub(super) const UNKNOWNS_KEY: &str = "unknowns";
pub(super) const VELOCITY_KEY: &str = "velocity";
pub(super) const DRIVEN_KEY: &str = "driven";
pub(super) const PARAMETERS_KEY: &str = "parameters";
pub(super) const DEFINITIONS_KEY: &str = "define";
pub(super) const EQUATIONS_KEY: &str = "equations";

/// Schema of the section `[model]` of a model given as equations.
pub(super) const MODEL_SCHEMA: TableSchema = TableSchema::new_section(
    "model",
    "model given as equations (kind = \"equations\")",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            KIND_KEY,
            ValueType::OneOf(|_: &SchemaScope| vec![EQUATIONS_KIND.to_owned()]),
            "",
            "\"equations\"",
            "kind of model",
        ),
        KeySchema::new_optional(
            TITLE_KEY,
            ValueType::Text,
            "",
            "\"advection and diffusion\"",
            "title; used if the case has none",
        ),
        KeySchema::new_with_default(
            DIMENSIONS_KEY,
            ValueType::WholeNumber(1),
            "",
            "2",
            "number of space dimensions: 1, 2 or 3",
        ),
        KeySchema::new_required(
            UNKNOWNS_KEY,
            ValueType::Named(NamedValues::Units),
            "",
            "{ c = \"kg/m^3\" }",
            "unknowns with their SI units, in the order of results; a list of names if no units are checked",
        ),
        KeySchema::new_optional(
            VELOCITY_KEY,
            ValueType::TextList,
            "",
            "[\"v1\", \"v2\"]",
            "unknowns that are the velocity, for the material derivative D",
        ),
        KeySchema::new_optional(
            DRIVEN_KEY,
            ValueType::TextList,
            "",
            "[\"balance\"]",
            "equations that a body force balances at the background",
        ),
        KeySchema::new_optional(
            PARAMETERS_KEY,
            ValueType::Named(NamedValues::Parameters),
            "",
            "{ a = { value = 2.0, unit = \"m/s\" }, nu = { value = 0.1, unit = \"m^2/s\" } }",
            "parameters: a number, or { value = ..., unit = ... }",
        ),
        KeySchema::new_optional(
            DEFINITIONS_KEY,
            ValueType::Named(NamedValues::Expressions),
            "",
            "{ flux = \"a*c - nu*d1(c)\" }",
            "names for expressions, in any order",
        ),
        KeySchema::new_required(
            EQUATIONS_KEY,
            ValueType::Named(NamedValues::Expressions),
            "",
            "{ balance = \"dt(c) + d1(flux) = 0\" }",
            "equations by name, at most as many as unknowns",
        ),
    ])],
);

/// Schema of the section `[background]` of a model given as equations, whose keys are the unknowns.
pub(super) const BACKGROUND_SCHEMA: TableSchema = TableSchema::new_open_section(
    "background",
    "background of a model given as equations: for each unknown a value, or a table with value and derivatives d1, d2, \
     d12, dt, ... ; \"solve\" in place of a derivative determines it from the equations",
    NamedValues::Background,
);

/// Schema of the section `[wave]`.
pub(super) const WAVE_SCHEMA: TableSchema = TableSchema::new_section(
    "wave",
    "wave vector at which roots are listed, of a model given as equations",
    &[KeyGroup::new(&[
        KeySchema::new_with_default(
            "number",
            ValueType::Number(AllowedRange::Positive),
            "1/m",
            "1000.0",
            "wave number k",
        ),
        KeySchema::new_with_default(
            "direction_deg",
            ValueType::Number(AllowedRange::Finite),
            "deg",
            "0.0",
            "direction of the wave vector from x₁, anticlockwise; 0 in one dimension",
        ),
        KeySchema::new_with_default(
            "elevation_deg",
            ValueType::Number(AllowedRange::Finite),
            "deg",
            "0.0",
            "elevation of the wave vector above the x₁x₂ plane; 0 below three dimensions",
        ),
    ])],
);

/// Schema of an axis of the section `[map]`.
pub(super) const AXIS_SCHEMA: TableSchema = TableSchema::new_inline_table(
    "axis",
    "axis of a map of a model given as equations",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "parameter",
            ValueType::Text,
            "",
            "\"model.parameters.nu\"",
            "swept number: a parameter of the model, a number of the background or of the wave",
        ),
        KeySchema::new_required(
            "from",
            ValueType::Number(AllowedRange::Finite),
            "",
            "-1.0",
            "first value",
        ),
        KeySchema::new_required(
            "to",
            ValueType::Number(AllowedRange::Finite),
            "",
            "1.0",
            "last value",
        ),
        KeySchema::new_required("points", ValueType::WholeNumber(1), "", "41", "number of points"),
        KeySchema::new_with_default(
            "spacing",
            ValueType::OneOf(|_| {
                SweepSpacing::ALL.iter().map(|own| own.name().to_owned()).collect()
            }),
            "",
            "\"linear\"",
            "spacing of the points: linear, or log with equal ratios between positive ends",
        ),
    ])],
);

/// Schema of the section `[map]`.
pub(super) const MAP_SCHEMA: TableSchema = TableSchema::new_section(
    "map",
    "parameter sweep of a model given as equations",
    &[KeyGroup::new(&[
        KeySchema::new_required("x", ValueType::Table(&AXIS_SCHEMA), "", "{}", "horizontal axis"),
        KeySchema::new_required("y", ValueType::Table(&AXIS_SCHEMA), "", "{}", "vertical axis"),
    ])],
);
