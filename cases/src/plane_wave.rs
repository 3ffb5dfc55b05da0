//! The sections of granular and porous media, `[granular]` and `[porous]`, and of plane waves in them, `[piston]` and
//! `[spall]`.
//!
//! The section `[model]` of the kind `classical` gives the elastic particles or the elastic skeleton; `[granular]` or
//! `[porous]` adds contacts and plastic flow.

mod schemas;

use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::kind::MediumKind;
use crate::named_enum::named_enum;
use crate::section::{SectionReader, TableWriter};
use models::common::decimal::ToPlainText;
pub(crate) use schemas::{
    GRANULAR_SCHEMA, PISTON_SCHEMA, PLANE_WAVE_SCHEMAS, POROUS_SCHEMA, SPALL_SCHEMA,
};

/// Kind of model of the particles or of the skeleton.
pub(crate) const ELASTIC_KIND: &str = "classical";

named_enum! {
    /// Contact of the walls of pores.
    PoreContactKind {
        /// Walls transmit a mean stress.
        Spherical = "spherical",
        /// Walls transmit stresses in a friction cone.
        Cone = "cone"
    }
}

named_enum! {
    /// Arrangement of spring and dashpot of viscous particles.
    DashpotArrangement {
        /// Dashpot and spring in series: Maxwell.
        Series = "series",
        /// Dashpot and spring in parallel: Kelvin–Voigt.
        Parallel = "parallel"
    }
}

named_enum! {
    /// Shape in time of a pulse that meets a free end.
    SpallShape {
        /// Constant velocity.
        Rectangle = "rectangle",
        /// Velocity that falls linearly to zero behind the front.
        Triangle = "triangle"
    }
}

/// Loads of plane waves in a granular or porous medium.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneWaveOptions {
    /// Section `[piston]`.
    pub piston: Option<Piston>,
    /// Section `[spall]`, of granular media only.
    pub spall: Option<SpallPulse>,
}

/// Medium with contacts: constants in addition to those of `[model]`.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactMedium {
    /// Section `[granular]`.
    Granular {
        /// Friction æ of the cone; ≥ 0.
        friction: f64,
        /// Yield stress τ_s of the particles, Pa; `None` for elastic particles.
        yield_stress: Option<f64>,
        /// Coefficient c² of the intensity of shear stress.
        intensity_coefficient: f64,
        /// Viscosities η_s of shear and η_v of volume of the particles, Pa·s; `None`: no viscosity.
        viscosities: [Option<f64>; 2],
        /// Arrangement of spring and dashpot.
        dashpot: DashpotArrangement,
    },
    /// Section `[porous]`.
    Porous {
        /// Porosity θ₀ of the natural state; in [0, 1).
        porosity: f64,
        /// Yield stress τ_s of the skeleton, Pa; `None` for an elastic skeleton.
        yield_stress: Option<f64>,
        /// Bulk modulus k_b that collapsed pores add, Pa.
        contact_bulk_modulus: f64,
        /// Shear modulus μ_b that collapsed pores add (Pa) and friction æ of the contact by cone; `None` for the
        /// spherical contact.
        contact_cone: Option<[f64; 2]>,
        /// Coefficient c² of the intensity of shear stress.
        intensity_coefficient: f64,
        /// Viscosity η_p of plastic flow, Pa·s; `None` for flow without viscosity.
        plastic_viscosity: Option<f64>,
    },
}

/// Load by a piston, section `[piston]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piston {
    /// Load from the time 0 on.
    pub load: PistonLoadValue,
    /// Duration of the load, s; `None` for a load without end.
    pub duration: Option<f64>,
    /// Extension ε₀ by which a granular medium is loosened at rest.
    pub loosening: f64,
    /// Time of the profile, s; `None` for a time chosen by the program.
    pub profile_time: Option<f64>,
}

/// Value of the load by a piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PistonLoadValue {
    /// Pressure, Pa.
    Pressure(f64),
    /// Speed, m/s.
    Speed(f64),
}

/// Pulse that meets a free end, section `[spall]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpallPulse {
    /// Velocity v₀ behind the front, m/s.
    pub speed: f64,
    /// Duration t₀, s.
    pub duration: f64,
    /// Shape in time.
    pub shape: SpallShape,
    /// Time of the profile after the front has met the end, s; `None` for a time chosen by the program.
    pub profile_time: Option<f64>,
}

/// Reads the section `[granular]` or `[porous]`; `None` if there is neither.
///
/// # Errors
/// A key is unknown or missing, a value is invalid, the elastic solid is not classical or has a yield set, or the medium is
/// missing or given twice.
pub(super) fn read_contacts(
    root: &SectionReader,
    positions: &KeyPositions,
    medium: MediumKind,
) -> Result<Option<ContactMedium>, CaseError> {
    let given = PLANE_WAVE_SCHEMAS.iter().map(|own| own.name).find(|name| root.has_key(name));
    let Some(section) = given else { return Ok(None) };
    if medium.kind.name() != ELASTIC_KIND {
        let found = format!("not used by the model {}", medium.kind.name());
        let allowed = format!("write model.kind = \"{ELASTIC_KIND}\", or leave the section out");
        return Err(root.key_error(section, found, allowed));
    }
    if medium.yield_set.is_some() {
        let allowed = "leave [yield] out: the yield stress is a key of [granular] and [porous]";
        return Err(positions.key_error("yield", format!("found beside [{section}]"), allowed));
    }
    let contacts = match (root.open_section(&GRANULAR_SCHEMA)?, root.open_section(&POROUS_SCHEMA)?)
    {
        (Some(_), Some(_)) => {
            let allowed = "keep one of both sections";
            return Err(root.key_error("porous", "found beside [granular]", allowed));
        }
        (None, None) => {
            let allowed = "add a section [granular] or [porous]";
            return Err(root.key_error(section, "found without a medium", allowed));
        }
        (Some(granular), None) => read_granular(granular)?,
        (None, Some(porous)) => read_porous(porous)?,
    };
    Ok(Some(contacts))
}

/// Reads the loads of plane waves in a medium with contacts; `None` if there is none beside a grid.
///
/// # Errors
/// A key is unknown or missing, a value is invalid, or a load is missing or belongs to another medium.
pub(super) fn read_loads(
    root: &SectionReader,
    contacts: Option<&ContactMedium>,
    has_grid: bool,
) -> Result<Option<PlaneWaveOptions>, CaseError> {
    let Some(medium) = contacts else { return Ok(None) };
    let is_granular = matches!(medium, ContactMedium::Granular { .. });
    let piston = root.open_section(&PISTON_SCHEMA)?.map(|own| read_piston(own, is_granular));
    let piston = piston.transpose()?;
    let spall = root.open_section(&SPALL_SCHEMA)?.map(read_spall).transpose()?;
    if spall.is_some() && !is_granular {
        let allowed = "leave it out: it belongs to [granular]";
        return Err(root.key_error("spall", "not used by a porous medium", allowed));
    }
    if piston.is_none() && spall.is_none() {
        if has_grid {
            return Ok(None);
        }
        let allowed = match is_granular {
            true => "add a section [piston] with pressure or speed, or [spall]",
            false => "add a section [piston] with pressure or speed",
        };
        return Err(root.key_error(medium.section(), "found without a load", allowed));
    }
    Ok(Some(PlaneWaveOptions { piston, spall }))
}

fn read_granular(section: SectionReader) -> Result<ContactMedium, CaseError> {
    let arrangement = section.read_optional_choice(
        "dashpot",
        DashpotArrangement::ALL,
        DashpotArrangement::name,
    )?;
    let is_viscous = ["shear_viscosity", "bulk_viscosity"].iter().any(|key| section.has_key(key));
    if let (Some(own), false) = (arrangement, is_viscous) {
        let allowed = "add shear_viscosity or bulk_viscosity, in Pa·s, or leave it out";
        let found = format!("found '{}' for particles without viscosity", own.name());
        return Err(section.key_error("dashpot", found, allowed));
    }
    let medium = ContactMedium::Granular {
        friction: section.read_required("friction")?,
        yield_stress: section.read_optional("yield_stress")?,
        intensity_coefficient: section.read_or_default("intensity_coefficient")?,
        viscosities: [
            section.read_optional("shear_viscosity")?,
            section.read_optional("bulk_viscosity")?,
        ],
        dashpot: arrangement.unwrap_or_default(),
    };
    section.finish()?;
    Ok(medium)
}

fn read_porous(section: SectionReader) -> Result<ContactMedium, CaseError> {
    let contact =
        section.read_optional_choice("contact", PoreContactKind::ALL, PoreContactKind::name)?;
    let contact_cone = match contact.unwrap_or_default() {
        PoreContactKind::Spherical => None,
        PoreContactKind::Cone => Some([
            section.read_required("contact_shear_modulus")?,
            section.read_required("friction")?,
        ]),
    };
    let medium = ContactMedium::Porous {
        porosity: section.read_required("porosity")?,
        yield_stress: section.read_optional("yield_stress")?,
        contact_bulk_modulus: section.read_required("contact_bulk_modulus")?,
        contact_cone,
        intensity_coefficient: section.read_or_default("intensity_coefficient")?,
        plastic_viscosity: match section.has_key("yield_stress") {
            true => section.read_optional("plastic_viscosity")?,
            false => None,
        },
    };
    section.finish()?;
    Ok(medium)
}

fn read_piston(section: SectionReader, is_granular: bool) -> Result<Piston, CaseError> {
    if section.has_key("pressure") && section.has_key("speed") {
        let allowed = "give either pressure or speed";
        return Err(section.key_error("speed", "found beside pressure", allowed));
    }
    let load = match section.has_key("speed") {
        true => PistonLoadValue::Speed(section.read_required("speed")?),
        false => PistonLoadValue::Pressure(section.read_required("pressure")?),
    };
    let loosening: f64 = section.read_or_default("loosening")?;
    if loosening != 0.0 && !is_granular {
        let allowed = "leave it out: only a granular medium is loosened";
        return Err(section.key_error(
            "loosening",
            format!("found {loosening}", loosening = loosening.to_plain_text()),
            allowed,
        ));
    }
    let piston = Piston {
        load,
        duration: section.read_optional("duration")?,
        loosening,
        profile_time: section.read_optional("profile_time")?,
    };
    section.finish()?;
    Ok(piston)
}

fn read_spall(section: SectionReader) -> Result<SpallPulse, CaseError> {
    let shape = section.read_optional_choice("shape", SpallShape::ALL, SpallShape::name)?;
    let spall = SpallPulse {
        speed: section.read_required("speed")?,
        duration: section.read_required("duration")?,
        shape: shape.unwrap_or_default(),
        profile_time: section.read_optional("profile_time")?,
    };
    section.finish()?;
    Ok(spall)
}

impl ContactMedium {
    /// Returns the name of the section of the medium.
    pub fn section(&self) -> &'static str {
        match self {
            Self::Granular { .. } => GRANULAR_SCHEMA.name,
            Self::Porous { .. } => POROUS_SCHEMA.name,
        }
    }

    /// Whether particles or skeleton have a yield stress.
    pub fn is_plastic(&self) -> bool {
        match self {
            Self::Granular { yield_stress, .. } | Self::Porous { yield_stress, .. } => {
                yield_stress.is_some()
            }
        }
    }

    /// Formats the section as TOML.
    pub(super) fn to_toml(&self) -> String {
        let with_number = |text: TableWriter, key: &'static str, value: &Option<f64>| match value {
            Some(value) => text.with_number(key, value),
            None => text,
        };
        let with_limit =
            |text: TableWriter, limit: &Option<f64>| with_number(text, "yield_stress", limit);
        match self {
            Self::Granular {
                friction,
                yield_stress,
                intensity_coefficient,
                viscosities: [shear_viscosity, bulk_viscosity],
                dashpot,
            } => {
                let text = TableWriter::default().with_number("friction", friction);
                let text = with_limit(text, yield_stress)
                    .with_number("intensity_coefficient", intensity_coefficient);
                let text = with_number(text, "shear_viscosity", shear_viscosity);
                let text = with_number(text, "bulk_viscosity", bulk_viscosity);
                match (shear_viscosity, bulk_viscosity) {
                    (None, None) => text,
                    _ => text.with_text("dashpot", dashpot.name()),
                }
                .to_section_toml(&GRANULAR_SCHEMA)
            }
            Self::Porous {
                porosity,
                yield_stress,
                contact_bulk_modulus,
                contact_cone,
                intensity_coefficient,
                plastic_viscosity,
            } => {
                let text = TableWriter::default().with_number("porosity", porosity);
                let text = with_limit(text, yield_stress);
                let text = with_number(text, "plastic_viscosity", plastic_viscosity)
                    .with_number("contact_bulk_modulus", contact_bulk_modulus)
                    .with_number("intensity_coefficient", intensity_coefficient);
                match contact_cone {
                    None => text.with_text("contact", PoreContactKind::Spherical.name()),
                    Some([shear_modulus, friction]) => text
                        .with_text("contact", PoreContactKind::Cone.name())
                        .with_number("contact_shear_modulus", shear_modulus)
                        .with_number("friction", friction),
                }
                .to_section_toml(&POROUS_SCHEMA)
            }
        }
    }
}

impl PlaneWaveOptions {
    /// Formats the sections as TOML.
    pub(super) fn to_toml(&self) -> String {
        let mut text = String::new();
        let with_time = |text: TableWriter, time: Option<f64>| match time {
            Some(time) => text.with_number("profile_time", time),
            None => text,
        };
        if let Some(own) = &self.piston {
            let table = TableWriter::default();
            let mut table = match own.load {
                PistonLoadValue::Pressure(pressure) => table.with_number("pressure", pressure),
                PistonLoadValue::Speed(speed) => table.with_number("speed", speed),
            };
            if let Some(duration) = own.duration {
                table = table.with_number("duration", duration);
            }
            if own.loosening != 0.0 {
                table = table.with_number("loosening", own.loosening);
            }
            text += &with_time(table, own.profile_time).to_section_toml(&PISTON_SCHEMA);
        }
        if let Some(own) = &self.spall {
            let table = TableWriter::default()
                .with_number("speed", own.speed)
                .with_number("duration", own.duration)
                .with_text("shape", own.shape.name());
            text += &with_time(table, own.profile_time).to_section_toml(&SPALL_SCHEMA);
        }
        text
    }
}
