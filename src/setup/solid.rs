//! Solids and solver media from materials of a case.

use crate::case::{Material, ModelKind, WaveNumbers, degrees_to_radians, join_names};
use dynamics::medium::Medium;
use models::InputError;
use models::common::elementary::Elementary;
use models::elastoplastic::{PlasticState, Solid};
use models::solid::stress::Stress;
use models::solid::{ElasticLaw, SolidKind};
use models::yield_set::{YieldSet, YieldSetKind};

/// Creates the solid of a material.
///
/// # Errors
/// A constant is out of range, the yield set cannot be combined with the elastic law, the pressure is outside the yield
/// set, the yield surface is never reached in the direction of the stress, the index of an active condition is out of
/// range, or the material is a flow.
pub fn create_solid(material: &Material) -> Result<Solid, InputError> {
    let elastic = create_elastic_law(material)?;
    check_yield_set(material, &elastic)?;
    let plastic = material.yield_set.map(|set| create_plasticity(material, set)).transpose()?;
    Ok(Solid::new(elastic, material.numbers.dimensions, plastic))
}

/// Creates the elastic law of a material and its yield set; the stress of the material is not used.
///
/// # Errors
/// A constant is out of range, the yield set cannot be combined with the elastic law, or the material is a flow.
pub fn create_elastic_law_and_set(
    material: &Material,
) -> Result<(ElasticLaw, Option<YieldSet>), InputError> {
    let set = material.yield_set.map(|set| create_yield_set(material, set)).transpose()?;
    let elastic = create_elastic_law(material)?;
    check_yield_set(material, &elastic)?;
    Ok((elastic, set))
}

/// Creates the solver medium of a solid in a grid of `dimensions` axes.
///
/// # Errors
/// A constant is out of range, the yield set cannot be combined with the elastic law, its plastic flow is not ideal and
/// associated, or the material is a flow.
pub fn create_medium(material: &Material, dimensions: usize) -> Result<Medium, InputError> {
    let (elastic, set) = create_elastic_law_and_set(material)?;
    let medium = Medium::new(elastic, dimensions);
    let Some(set) = set else { return Ok(medium) };
    // The solver supports ideal associated plasticity only.
    set.check_ideal_and_associated()?;
    Ok(medium.with_yield_set(set))
}

/// Returns the unit wave normal (cos β cos α, cos β sin α, sin β) with the direction α and the elevation β of a wave.
pub fn wave_normal(wave: &WaveNumbers) -> [f64; 3] {
    let (sin, cos) = degrees_to_radians(wave.direction_deg).cr_sin_cos();
    let (up, along) = degrees_to_radians(wave.elevation_deg).cr_sin_cos();
    [along * cos, along * sin, up]
}

/// Returns the constants of a material and its yield set by name, in SI units and rad.
///
/// # Errors
/// The material is a flow.
pub fn constants_by_name(material: &Material) -> Result<Vec<(&'static str, f64)>, InputError> {
    let solid = solid_kind(material)?;
    let mut values = Vec::new();
    material.numbers.model_constants.collect_si_values(solid.parameters, &mut values);
    let names = solid.parameters.iter().map(|own| own.name);
    let mut all: Vec<_> = names.zip(values.iter().copied()).collect();
    if let Some(set) = material.yield_set {
        material
            .numbers
            .yield_constants
            .collect_si_values(set.parameters_for(solid.theory), &mut values);
        let names = set.parameters_for(solid.theory).map(|own| own.name);
        all.extend(names.zip(values.iter().copied()));
    }
    // An absent constant is NaN; the model uses its default.
    all.retain(|own| !own.1.is_nan());
    Ok(all)
}

/// Creates the elastic law of a material.
fn create_elastic_law(material: &Material) -> Result<ElasticLaw, InputError> {
    let mut constants = Vec::new();
    let solid = solid_kind(material)?;
    material.numbers.model_constants.collect_si_values(solid.parameters, &mut constants);
    solid.build_law(&constants)
}

/// Checks that the yield set of a material, if any, can be combined with the elastic law.
fn check_yield_set(material: &Material, law: &ElasticLaw) -> Result<(), InputError> {
    match material.yield_set {
        Some(set) => set.check_compatible(solid_kind(material)?, law),
        None => Ok(()),
    }
}

/// Returns the solid kind of a material.
fn solid_kind(material: &Material) -> Result<SolidKind, InputError> {
    match material.kind {
        ModelKind::Solid(solid) => Ok(solid),
        ModelKind::Flow(_) => Err(InputError {
            input: "kind",
            rejected_value: format!("{}, a flow", material.kind.name()),
            allowed_values: format!(
                "expected a solid ({}); for flows see wellposed point and map",
                join_names(&ModelKind::solid_kinds())
            ),
        }),
        ModelKind::Rheology | ModelKind::Equations => Err(material.unsuitable_kind_error()),
    }
}

fn create_plasticity(material: &Material, kind: YieldSetKind) -> Result<PlasticState, InputError> {
    let set = create_yield_set(material, kind)?;
    if let Some(active) = &material.active_conditions {
        return PlasticState::with_active(set, active);
    }
    let pressure = material.numbers.stress.pressure;
    PlasticState::from_stress(
        set,
        pressure,
        &compute_stress_direction(material),
        material.numbers.plastic_rate,
    )
}

/// Returns the stress of a material without its pressure: force stresses, Pa, and couple stresses, N/m.
fn compute_stress_direction(material: &Material) -> Stress {
    let given = material.numbers.stress;
    let (sin, cos) = (2.0 * degrees_to_radians(given.stress_angle_deg)).cr_sin_cos();
    let [q, r] = [given.deviatoric_stress, given.rotational_stress];
    let mut stress = Stress::default();
    stress.force[0] = [q * cos, q * sin - r, 0.0];
    stress.force[1] = [q * sin + r, -q * cos, 0.0];
    stress.force[2][2] = given.out_of_plane_stress;
    stress.couple[2] = [given.couple_stress[0], given.couple_stress[1], 0.0];
    stress
}

fn create_yield_set(material: &Material, kind: YieldSetKind) -> Result<YieldSet, InputError> {
    let theory = solid_kind(material)?.theory;
    let mut constants = Vec::new();
    material.numbers.yield_constants.collect_si_values(kind.parameters_for(theory), &mut constants);
    kind.build_set(theory, &constants)
}
