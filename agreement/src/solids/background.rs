//! Uniform background on the yield surface for waves in a yielding solid.

use crate::AgreementError;
use crate::scheme::EnergyForm;
use models::elastoplastic::{PlasticState, Solid};
use models::solid::stress::{Stress, StressComponent};
use models::yield_set::parameters::{ActiveCondition, contract};
use nalgebra::{DMatrix, DVector};

/// Uniform background stress on the yield surface.
pub(super) struct BackgroundStress {
    pub(super) stress: Stress,
    /// Stress, as a vector of unknowns, for which every active condition has unit value in energy coordinates.
    pub(super) yield_normal_stress: DVector<f64>,
    /// Whether the yield set is no polyhedron.
    pub(super) has_curved_yield_surface: bool,
    /// Energy norm of the background stress, √(J/m³).
    pub(super) energy_norm: f64,
    /// Largest energy norm of a wave that activates no further yield condition, at most `energy_norm`, √(J/m³).
    pub(super) wave_capacity: f64,
}

/// Yield normals of the active conditions, with respect to all unknowns.
pub(super) fn yield_normals<const D: usize>(solid: &Solid) -> Vec<DVector<f64>> {
    let active = solid.plastic_state.iter().flat_map(|plastic| &plastic.active_conditions);
    active.map(|condition| yield_normal::<D>(solid, condition)).collect()
}

fn yield_normal<const D: usize>(solid: &Solid, condition: &ActiveCondition) -> DVector<f64> {
    assemble_unknowns::<D>(solid, |component| component.derivative(&condition.normal))
}

/// Vector over the unknowns with the given values of stress components, zero for velocities.
fn assemble_unknowns<const D: usize>(
    solid: &Solid,
    value: impl Fn(StressComponent) -> f64,
) -> DVector<f64> {
    let velocities = solid.elastic_law.rates_with_out_of_plane::<D>().velocity_count();
    let stresses: Vec<StressComponent> = solid.all_stresses::<D>();
    let mut values = DVector::zeros(velocities + stresses.len());
    for (place, &component) in stresses.iter().enumerate() {
        values[velocities + place] = value(component);
    }
    values
}

impl BackgroundStress {
    /// Background of a solid; `None` if it is elastic.
    pub(super) fn new<const D: usize>(
        solid: &Solid,
        yielding: &EnergyForm<D>,
    ) -> Result<Option<Self>, AgreementError> {
        let Some(plastic) = &solid.plastic_state else { return Ok(None) };
        let stress = find_yield_stress_state(plastic);
        let unknowns = assemble_unknowns::<D>(solid, |component| component.value_in(&stress));
        let norm = (&yielding.energy_transform * &unknowns).norm();
        let mut capacity = norm;
        let half_spaces = plastic.set.half_spaces();
        let has_curved_yield_surface = half_spaces.is_none();
        for (condition, strength) in half_spaces.into_iter().flatten() {
            if plastic.active_conditions.contains(&condition) {
                continue;
            }
            let normal = yield_normal::<D>(solid, &condition);
            // Transformed by L⁻¹ to energy coordinates, like all normals.
            let scaled = yielding.inverse_transform.transpose() * &normal;
            capacity = capacity.min((strength - normal.dot(&unknowns)) / scaled.norm());
        }
        if plastic.set.active_conditions(&stress, 1e-9) != plastic.active_conditions
            || capacity <= 0.0
        {
            return Err(AgreementError::UnattainableConditions);
        }
        let yield_normal_stress =
            yielding.yield_normal_stress().ok_or(AgreementError::NonPositiveMultiplier)?;
        Ok(Some(Self {
            stress,
            yield_normal_stress,
            has_curved_yield_surface,
            energy_norm: norm,
            wave_capacity: capacity,
        }))
    }
}

/// A stress at which all active conditions hold with equality.
fn find_yield_stress_state(plastic: &PlasticState) -> Stress {
    if let Some(stress) = plastic.stress {
        return stress;
    }
    let half_spaces = plastic.set.half_spaces().into_iter().flatten();
    let active: Vec<(ActiveCondition, f64)> = half_spaces
        .filter(|(condition, _)| plastic.active_conditions.contains(condition))
        .collect();
    let shears: Vec<Stress> =
        active.iter().map(|(condition, _)| shear_components(condition)).collect();
    // A condition that limits normal stresses only cannot be reached by shear.
    let mut own = active.iter().zip(&shears);
    if !own.all(|((condition, _), shear)| contract(&condition.normal, shear) > 0.0) {
        return solve_minimum_norm_stress(&active);
    }
    // Each condition is reached by the shear and couple stress components of its normal.
    let mut stress = Stress::default();
    for ((condition, strength), shear) in active.iter().zip(&shears) {
        // Multiple of the shear at which the condition holds with equality.
        let scale = strength / contract(&condition.normal, shear);
        for face in 0..2 {
            stress.force[1 - face][face] += shear.force[1 - face][face] * scale;
            stress.couple[2][face] += shear.couple[2][face] * scale;
        }
    }
    stress
}

/// In-plane shear and couple stress components of the normal of a condition.
fn shear_components(condition: &ActiveCondition) -> Stress {
    let own = condition.normal;
    let mut shear = Stress::default();
    for face in 0..2 {
        shear.force[1 - face][face] = own.force[1 - face][face];
        shear.couple[2][face] = own.couple[2][face];
    }
    shear
}

/// Minimum-norm stress s = Σ cᵢnᵢ (components in SI units) at which all conditions hold with equality, nᵢ·s = kᵢ;
/// zero if the normals are linearly dependent.
fn solve_minimum_norm_stress(active: &[(ActiveCondition, f64)]) -> Stress {
    let normal = |index: usize| &active[index].0.normal;
    let count = active.len();
    let products = DMatrix::from_fn(count, count, |i, j| contract(normal(i), normal(j)));
    let strengths = DVector::from_iterator(count, active.iter().map(|own| own.1));
    let mut stress = Stress::default();
    let Some(factors) = products.lu().solve(&strengths) else { return stress };
    for (index, factor) in factors.iter().enumerate() {
        let own = normal(index);
        for i in 0..3 {
            for j in 0..3 {
                stress.force[i][j] += factor * own.force[i][j];
                stress.couple[i][j] += factor * own.couple[i][j];
            }
        }
    }
    stress
}
