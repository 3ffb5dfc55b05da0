//! From a case to a solid.

use crate::case::{Case, Kind, Wave, names, radians};
use dynamics::medium::Medium;
use models::InputError;
use models::common::elementary::Elementary;
use models::elastoplastic::{Plastic, Solid};
use models::solid::stress::Stress;
use models::solid::{ElasticLaw, SolidKind};
use models::yield_set::{YieldSet, YieldSetKind};

/// The solid of a case.
///
/// # Errors
/// The constant that is out of range; that the stress never yields; that the case is one of a flow.
pub fn solid(case: &Case) -> Result<Solid, InputError> {
    let elastic = elastic_law(case)?;
    let plastic = case.yields.map(|set| plastic(case, set)).transpose()?;
    Ok(Solid::new(elastic, case.numbers.dimensions, plastic))
}

/// The elastic law of a case and its yield set, whatever the stress.
///
/// # Errors
/// The constant that is out of range; that the case is one of a flow.
pub fn elastic_law_and_set(case: &Case) -> Result<(ElasticLaw, Option<YieldSet>), InputError> {
    let set = case.yields.map(|set| yield_set(case, set)).transpose()?;
    Ok((elastic_law(case)?, set))
}

/// What a case's solid is to the solver.
///
/// # Errors
/// The constant that is out of range; that the flow is not one that a run knows; that the case is one of a
/// flow.
pub fn medium(case: &Case, dimensions: usize) -> Result<Medium, InputError> {
    let (elastic, set) = elastic_law_and_set(case)?;
    let medium = Medium::new(elastic, dimensions);
    let Some(set) = set else { return Ok(medium) };
    // A run knows no other flow.
    set.check_ideal_and_associated()?;
    Ok(medium.yielding(set))
}

/// Unit vector along a wave.
pub fn normal(wave: &Wave) -> [f64; 3] {
    let (sin, cos) = radians(wave.direction_deg).cr_sin_cos();
    let (up, along) = radians(wave.elevation_deg).cr_sin_cos();
    [along * cos, along * sin, up]
}

/// The elastic law of a case.
fn elastic_law(case: &Case) -> Result<ElasticLaw, InputError> {
    let mut constants = Vec::new();
    let solid = solid_kind(case)?;
    case.numbers.model.in_order(solid.parameters, &mut constants);
    solid.law(&constants)
}

/// The kind of a solid.
fn solid_kind(case: &Case) -> Result<SolidKind, InputError> {
    match case.kind {
        Kind::Solid(solid) => Ok(solid),
        Kind::Flow(_) => Err(InputError {
            input: "kind",
            found: format!("{}, a flow", case.kind.name()),
            allowed: format!(
                "this needs a solid ({}); for flows see wellposed point and map",
                names(&Kind::solids())
            ),
        }),
    }
}

fn plastic(case: &Case, kind: YieldSetKind) -> Result<Plastic, InputError> {
    let set = yield_set(case, kind)?;
    if let Some(active) = &case.active {
        return Plastic::with_active(set, active);
    }
    let pressure = case.numbers.stress.pressure;
    Plastic::at_stress(set, pressure, &direction(case), case.numbers.plastic_rate)
}

/// The stress of a case but for its pressure.
fn direction(case: &Case) -> Stress {
    let given = case.numbers.stress;
    let (sin, cos) = (2.0 * radians(given.stress_angle_deg)).cr_sin_cos();
    let [q, r] = [given.deviatoric_stress, given.rotational_stress];
    let mut stress = Stress::default();
    stress.force[0] = [q * cos, q * sin - r, 0.0];
    stress.force[1] = [q * sin + r, -q * cos, 0.0];
    stress.force[2][2] = given.out_of_plane_stress;
    stress.couple[2] = [given.couple_stress[0], given.couple_stress[1], 0.0];
    stress
}

fn yield_set(case: &Case, kind: YieldSetKind) -> Result<YieldSet, InputError> {
    let theory = solid_kind(case)?.theory;
    let mut constants = Vec::new();
    case.numbers.yields.in_order(kind.parameters_for(theory), &mut constants);
    kind.set(theory, &constants)
}
