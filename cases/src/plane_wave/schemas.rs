//! Schemas of the sections of plane waves.

use super::{DashpotArrangement, PoreContactKind, SpallShape};
use crate::schema::{AllowedRange, KeyCondition, KeyGroup, KeySchema, TableSchema, ValueType};

const YIELD_STRESS_KEY: KeySchema = KeySchema::new_optional(
    "yield_stress",
    ValueType::Number(AllowedRange::Positive),
    "Pa",
    "5e6",
    "limit τ_s of the intensity of shear stress τ; without it the particles or the skeleton are elastic",
)
.with_note("yield stress");

const INTENSITY_COEFFICIENT_KEY: KeySchema = KeySchema::new_with_default(
    "intensity_coefficient",
    ValueType::Number(AllowedRange::Positive),
    "",
    "0.375",
    "coefficient c² of the intensity of shear stress τ² = c² s:s of the stress deviator s; 3/8: half of the von Mises stress",
)
.with_note("coefficient c² of the intensity of shear stress");

const PROFILE_TIME_KEY: KeySchema = KeySchema::new_optional(
    "profile_time",
    ValueType::Number(AllowedRange::Positive),
    "s",
    "1e-4",
    "time of the profile; default: a time at which all waves are apart",
)
.with_note("time of the profile");

/// Schema of the section `[granular]`.
pub(crate) const GRANULAR_SCHEMA: TableSchema = TableSchema::new_section(
    "granular",
    "granular medium: particles with the elasticity and density of [model] in contact; for wellposed shocks, and for wellposed run with [grid]",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "friction",
            ValueType::Number(AllowedRange::NotNegative),
            "",
            "0.5",
            "friction æ of the cone τ ≤ æp of transmitted stresses",
        )
        .with_note("friction of the contacts"),
        YIELD_STRESS_KEY,
        INTENSITY_COEFFICIENT_KEY,
        KeySchema::new_optional(
            "shear_viscosity",
            ValueType::Number(AllowedRange::Positive),
            "Pa·s",
            "1e6",
            "viscosity η_s of the particles; with a dashpot in series the deviator of the stress decays by exp(−μt/η_s) at constant strain; for wellposed run",
        )
        .with_note("viscosity of shear"),
        KeySchema::new_optional(
            "bulk_viscosity",
            ValueType::Number(AllowedRange::Positive),
            "Pa·s",
            "2e6",
            "viscosity η_v of the particles; with a dashpot in series the pressure decays by exp(−kt/η_v) at constant strain; for wellposed run",
        )
        .with_note("viscosity of volume"),
        KeySchema::new_optional(
            "dashpot",
            ValueType::OneOf(|_| names(DashpotArrangement::ALL, DashpotArrangement::name)),
            "",
            "\"parallel\"",
            "arrangement of spring and dashpot of viscous particles; series, the default: Maxwell; parallel: Kelvin–Voigt, whose time step is at most ρh²/(2η) times 4C² for cells h and the Courant number C",
        ),
    ])],
);

/// Schema of the section `[porous]`.
pub(crate) const POROUS_SCHEMA: TableSchema = TableSchema::new_section(
    "porous",
    "porous medium: a skeleton with the elasticity of [model], and pores that collapse; model.density is that of the porous medium; for wellposed shocks, and for wellposed run with [grid]",
    &[
        KeyGroup::new(&[
            KeySchema::new_required(
                "porosity",
                ValueType::Number(AllowedRange::NotNegativeBelow(1.0)),
                "",
                "0.01",
                "porosity θ₀ of the natural state",
            )
            .with_note("porosity of the natural state"),
            YIELD_STRESS_KEY,
            KeySchema::new_required(
                "contact_bulk_modulus",
                ValueType::Number(AllowedRange::NotNegative),
                "Pa",
                "4.256e9",
                "bulk modulus k_b that collapsed pores add",
            )
            .with_note("bulk modulus of collapsed pores"),
            INTENSITY_COEFFICIENT_KEY,
            KeySchema::new_with_default(
                "contact",
                ValueType::OneOf(|_| names(PoreContactKind::ALL, PoreContactKind::name)),
                "",
                "\"spherical\"",
                "contact of the walls of pores; spherical: they transmit a mean stress when tr ε < −θ₀; cone: stresses τ ≤ æp",
            ),
        ]),
        KeyGroup::with_conditions(
            &[KeyCondition::Present("yield_stress")],
            &[KeySchema::new_optional(
                "plastic_viscosity",
                ValueType::Number(AllowedRange::Positive),
                "Pa·s",
                "100.0",
                "viscosity η_p of the plastic flow: at constant strain τ − τ_s decays by exp(−2μc²t/η_p); for wellposed run, with a spherical contact",
            )
            .with_note("viscosity of plastic flow")],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("contact", &[PoreContactKind::Cone.name()])],
            &[
                KeySchema::new_required(
                    "contact_shear_modulus",
                    ValueType::Number(AllowedRange::Positive),
                    "Pa",
                    "1.459e9",
                    "shear modulus μ_b that collapsed pores add",
                )
                .with_note("shear modulus of collapsed pores"),
                KeySchema::new_required(
                    "friction",
                    ValueType::Number(AllowedRange::NotNegative),
                    "",
                    "0.6",
                    "friction æ between the walls of pores",
                )
                .with_note("friction of the walls"),
            ],
        ),
    ],
);

/// Schema of the section `[piston]`.
pub(crate) const PISTON_SCHEMA: TableSchema = TableSchema::new_section(
    "piston",
    "constant load of a half-space by a piston from the time 0 on",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "pressure",
            ValueType::Number(AllowedRange::Positive),
            "Pa",
            "1e9",
            "pressure on the piston",
        )
        .with_note("pressure on the piston")
        .with_conditions(&[KeyCondition::Absent("speed")]),
        KeySchema::new_required(
            "speed",
            ValueType::Number(AllowedRange::Positive),
            "m/s",
            "10.0",
            "speed of the piston",
        )
        .with_note("speed of the piston")
        .with_conditions(&[KeyCondition::Absent("pressure")]),
        KeySchema::new_optional(
            "duration",
            ValueType::Number(AllowedRange::Positive),
            "s",
            "1e-5",
            "duration of the load, after which the surface is free; without it the load has no end",
        )
        .with_note("duration of the load"),
        KeySchema::new_with_default(
            "loosening",
            ValueType::Number(AllowedRange::NotNegative),
            "",
            "0.0",
            "extension ε₀ of the loosened medium at rest; granular media only",
        )
        .with_note("extension of the loosened medium"),
        PROFILE_TIME_KEY,
    ])],
);

/// Schema of the section `[spall]`.
pub(crate) const SPALL_SCHEMA: TableSchema = TableSchema::new_section(
    "spall",
    "compressive pulse that meets the free end of a granular column",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "speed",
            ValueType::Number(AllowedRange::Positive),
            "m/s",
            "2.0",
            "particle velocity behind the front of the pulse",
        )
        .with_note("particle velocity of the pulse"),
        KeySchema::new_required(
            "duration",
            ValueType::Number(AllowedRange::Positive),
            "s",
            "1e-3",
            "duration of the pulse",
        )
        .with_note("duration of the pulse"),
        KeySchema::new_with_default(
            "shape",
            ValueType::OneOf(|_| names(SpallShape::ALL, SpallShape::name)),
            "",
            "\"rectangle\"",
            "shape in time; rectangle: constant velocity; triangle: falls linearly to 0 behind the front",
        ),
        PROFILE_TIME_KEY,
    ])],
);

/// Schemas of all sections of plane waves, in the order of writing.
pub(crate) const PLANE_WAVE_SCHEMAS: &[&TableSchema] =
    &[&GRANULAR_SCHEMA, &POROUS_SCHEMA, &PISTON_SCHEMA, &SPALL_SCHEMA];

fn names<T: Copy>(all: &[T], name: fn(T) -> &'static str) -> Vec<String> {
    all.iter().map(|&own| name(own).to_owned()).collect()
}
