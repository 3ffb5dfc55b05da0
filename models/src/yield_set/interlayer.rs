//! Interlayer yield set: slip and rolling along the layers between blocks; plane strain.

use super::SolidClass::{AllSolids, CoupleStressSolids};
use super::{
    RayStartError, YieldConditions, YieldSet, YieldSetModel, check_associated, linear_ray_exit,
};
use crate::common::input::InputError;
use crate::common::parameter::to_constant_array;
use crate::solid::ElasticLaw;
use crate::solid::parameters::{Isotropic, PlaneCompliances, Theory};
use crate::solid::stress::Stress;
use crate::yield_set::parameters::{
    ActiveCondition, COUPLE_DILATANCY, COUPLE_FRICTION, COUPLE_STRENGTH, InterlayerCoupleLimits,
    InterlayerYieldSet, SHEAR_DILATANCY, SHEAR_FRICTION, SHEAR_STRENGTH, absolute_values, contract,
};
use crate::yield_set::projection::{PlaneMetric, Projection};

/// Registry entry of the interlayer yield set.
pub static INTERLAYER: YieldSetModel = YieldSetModel {
    name: "interlayer",
    title: "interlayer slip",
    parameters: &[
        (SHEAR_STRENGTH, AllSolids),
        (SHEAR_FRICTION, AllSolids),
        (SHEAR_DILATANCY, AllSolids),
        (COUPLE_STRENGTH, CoupleStressSolids),
        (COUPLE_FRICTION, CoupleStressSolids),
        (COUPLE_DILATANCY, CoupleStressSolids),
    ],
    is_plane: true,
    is_curved: false,
    conditions: &[
        ("+sigma21", AllSolids),
        ("-sigma21", AllSolids),
        ("+sigma12", AllSolids),
        ("-sigma12", AllSolids),
        ("+m31", CoupleStressSolids),
        ("-m31", CoupleStressSolids),
        ("+m32", CoupleStressSolids),
        ("-m32", CoupleStressSolids),
    ],
    is_compatible_law: |law| {
        law.downcast::<Isotropic>().is_some() || law.downcast::<PlaneCompliances>().is_some()
    },
    constructor: |theory, given| {
        let (shear, couple) = if theory == Theory::Cosserat {
            let [shear_strength, shear_friction, shear_dilatancy, strength, friction, dilatancy] =
                to_constant_array(given)?;
            let couple = InterlayerCoupleLimits { strength, friction, dilatancy };
            ([shear_strength, shear_friction, shear_dilatancy], Some(couple))
        } else {
            (to_constant_array(given)?, None)
        };
        let [shear_strength, shear_friction, shear_dilatancy] = shear;
        let set = InterlayerYieldSet { shear_strength, shear_friction, shear_dilatancy, couple };
        set.check().map(YieldSet::from)
    },
};

impl YieldConditions for InterlayerYieldSet {
    fn yield_function(&self, stress: &Stress) -> f64 {
        InterlayerYieldSet::half_spaces(self)
            .map(|(condition, strength)| contract(&condition.normal, stress) - strength)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn active_conditions(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition> {
        InterlayerYieldSet::half_spaces(self)
            .filter(|(condition, strength)| {
                let value = contract(&condition.normal, stress);
                let size = contract(&absolute_values(&condition.normal), &absolute_values(stress));
                value - strength >= -tolerance * (size + strength)
            })
            .map(|(condition, _)| condition)
            .collect()
    }

    fn check_ideal_and_associated(&self) -> Result<(), InputError> {
        check_associated("shear_dilatancy", self.shear_dilatancy, self.shear_friction)?;
        match self.couple {
            Some(couple) => check_associated("couple_dilatancy", couple.dilatancy, couple.friction),
            None => Ok(()),
        }
    }

    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, RayStartError> {
        let mut exit_distance = f64::INFINITY;
        for (condition, strength) in InterlayerYieldSet::half_spaces(self) {
            let start_value = contract(&condition.normal, start);
            let rate = contract(&condition.normal, direction);
            exit_distance = exit_distance.min(linear_ray_exit(start_value, strength, rate)?);
        }
        Ok(exit_distance)
    }

    /// Projects for isotropic laws and laws by compliances; returns the trial stress unchanged for other laws.
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress> {
        if let Some(solid) = law.downcast::<Isotropic>() {
            let mut projection = project_in_plane(self, &PlaneMetric::from(solid), trial);
            // The out-of-plane stresses follow from Hooke's law: the plastic strain has no out-of-plane components, so
            // the out-of-plane elastic strains do not change.
            let change = |i: usize, j: usize| projection.stress.force[i][j] - trial.force[i][j];
            let normal = change(0, 0) + change(1, 1);
            projection.stress.force[2][2] +=
                solid.lambda / (2.0 * (solid.lambda + solid.mu)) * normal;
            let ratio = solid.couple().map_or(0.0, |m| (m.gamma - m.eta) / (m.gamma + m.eta));
            for axis in 0..2 {
                let change = projection.stress.couple[2][axis] - trial.couple[2][axis];
                projection.stress.couple[axis][2] += ratio * change;
            }
            projection
        } else if let Some(solid) = law.downcast::<PlaneCompliances>() {
            project_in_plane(self, &PlaneMetric::from(solid), trial)
        } else {
            Projection { stress: *trial, energy_lost: 0.0 }
        }
    }

    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        Some(InterlayerYieldSet::half_spaces(self).collect())
    }
}

/// Projects the in-plane stresses; the out-of-plane stresses are unchanged.
fn project_in_plane(
    set: &InterlayerYieldSet,
    metric: &PlaneMetric,
    trial: &Stress,
) -> Projection<Stress> {
    const IN_PLANE_INDICES: [(usize, usize); 4] = [(0, 0), (1, 1), (1, 0), (0, 1)];
    let [a, b, c, d] = IN_PLANE_INDICES.map(|(i, j)| trial.force[i][j]);
    let projection = set.project(metric, &[a, b, c, d, trial.couple[2][0], trial.couple[2][1]]);
    let mut stress = *trial;
    for ((i, j), value) in IN_PLANE_INDICES.into_iter().zip(projection.stress) {
        stress.force[i][j] = value;
    }
    stress.couple[2][..2].copy_from_slice(&projection.stress[4..]);
    Projection { stress, energy_lost: projection.energy_lost }
}
