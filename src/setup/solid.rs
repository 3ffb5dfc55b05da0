//! Solids and solver media from materials of a case.

use crate::case::{Kind, Material, Wave, names, radians};
use dynamics::medium::Medium;
use models::InputError;
use models::common::elementary::Elementary;
use models::elastoplastic::{Plastic, Solid};
use models::solid::stress::Stress;
use models::solid::{ElasticLaw, SolidKind};
use models::yield_set::{YieldSet, YieldSetKind};

/// Creates the solid of a material.
///
/// # Errors
/// A constant is out of range, the yield surface is never reached in the direction of the stress, or the material is a
/// flow.
pub fn solid(material: &Material) -> Result<Solid, InputError> {
    let elastic = elastic_law(material)?;
    check_admits(material, &elastic)?;
    let plastic = material.yields.map(|set| plastic(material, set)).transpose()?;
    Ok(Solid::new(elastic, material.numbers.dimensions, plastic))
}

/// Creates the elastic law of a material and its yield set, independent of the stress.
///
/// # Errors
/// A constant is out of range, or the material is a flow.
pub fn elastic_law_and_set(
    material: &Material,
) -> Result<(ElasticLaw, Option<YieldSet>), InputError> {
    let set = material.yields.map(|set| yield_set(material, set)).transpose()?;
    let elastic = elastic_law(material)?;
    check_admits(material, &elastic)?;
    Ok((elastic, set))
}

/// Creates the solver medium of a solid.
///
/// # Errors
/// A constant is out of range, the solver does not support the plastic flow, or the material is a flow.
pub fn medium(material: &Material, dimensions: usize) -> Result<Medium, InputError> {
    let (elastic, set) = elastic_law_and_set(material)?;
    let medium = Medium::new(elastic, dimensions);
    let Some(set) = set else { return Ok(medium) };
    // The solver supports ideal associated plasticity only.
    set.check_ideal_and_associated()?;
    Ok(medium.yielding(set))
}

/// Returns the unit wave normal.
pub fn normal(wave: &Wave) -> [f64; 3] {
    let (sin, cos) = radians(wave.direction_deg).cr_sin_cos();
    let (up, along) = radians(wave.elevation_deg).cr_sin_cos();
    [along * cos, along * sin, up]
}

/// Returns the constants of a material and its yield set by name, in SI units and rad.
///
/// # Errors
/// The material is a flow.
pub fn constants(material: &Material) -> Result<Vec<(&'static str, f64)>, InputError> {
    let solid = solid_kind(material)?;
    let mut values = Vec::new();
    material.numbers.model.in_order(solid.parameters, &mut values);
    let names = solid.parameters.iter().map(|own| own.name);
    let mut all: Vec<_> = names.zip(values.iter().copied()).collect();
    if let Some(set) = material.yields {
        material.numbers.yields.in_order(set.parameters_for(solid.theory), &mut values);
        let names = set.parameters_for(solid.theory).map(|own| own.name);
        all.extend(names.zip(values.iter().copied()));
    }
    // Absent constants (NaN) have defaults of the model.
    all.retain(|own| !own.1.is_nan());
    Ok(all)
}

/// Creates the elastic law of a material.
fn elastic_law(material: &Material) -> Result<ElasticLaw, InputError> {
    let mut constants = Vec::new();
    let solid = solid_kind(material)?;
    material.numbers.model.in_order(solid.parameters, &mut constants);
    solid.law(&constants)
}

/// Checks that the yield set of a material, if any, admits the elastic law.
fn check_admits(material: &Material, law: &ElasticLaw) -> Result<(), InputError> {
    match material.yields {
        Some(set) => set.check_admits(solid_kind(material)?, law),
        None => Ok(()),
    }
}

/// Returns the solid kind of a material.
fn solid_kind(material: &Material) -> Result<SolidKind, InputError> {
    match material.kind {
        Kind::Solid(solid) => Ok(solid),
        Kind::Flow(_) => Err(InputError {
            input: "kind",
            found: format!("{}, a flow", material.kind.name()),
            allowed: format!(
                "this needs a solid ({}); for flows see wellposed point and map",
                names(&Kind::solids())
            ),
        }),
    }
}

fn plastic(material: &Material, kind: YieldSetKind) -> Result<Plastic, InputError> {
    let set = yield_set(material, kind)?;
    if let Some(active) = &material.active {
        return Plastic::with_active(set, active);
    }
    let pressure = material.numbers.stress.pressure;
    Plastic::at_stress(set, pressure, &direction(material), material.numbers.plastic_rate)
}

/// Returns the stress of a material without its pressure, Pa and N/m.
fn direction(material: &Material) -> Stress {
    let given = material.numbers.stress;
    let (sin, cos) = (2.0 * radians(given.stress_angle_deg)).cr_sin_cos();
    let [q, r] = [given.deviatoric_stress, given.rotational_stress];
    let mut stress = Stress::default();
    stress.force[0] = [q * cos, q * sin - r, 0.0];
    stress.force[1] = [q * sin + r, -q * cos, 0.0];
    stress.force[2][2] = given.out_of_plane_stress;
    stress.couple[2] = [given.couple_stress[0], given.couple_stress[1], 0.0];
    stress
}

fn yield_set(material: &Material, kind: YieldSetKind) -> Result<YieldSet, InputError> {
    let theory = solid_kind(material)?.theory;
    let mut constants = Vec::new();
    material.numbers.yields.in_order(kind.parameters_for(theory), &mut constants);
    kind.set(theory, &constants)
}
