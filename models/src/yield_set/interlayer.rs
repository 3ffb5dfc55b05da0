//! Interlayer yield set: slip and rolling along the layers between blocks; plane strain.

use super::Needs::{All, Couples};
use super::{
    NotInterior, YieldConditions, YieldSet, YieldSetModel, check_associated, linear_ray_exit,
};
use crate::common::input::InputError;
use crate::common::parameter::constants;
use crate::solid::ElasticLaw;
use crate::solid::parameters::{Isotropic, PlaneCompliances, Theory};
use crate::solid::stress::Stress;
use crate::yield_set::parameters::{
    ActiveCondition, COUPLE_DILATANCY, COUPLE_FRICTION, COUPLE_STRENGTH, Interlayer,
    InterlayerCouple, SHEAR_DILATANCY, SHEAR_FRICTION, SHEAR_STRENGTH, absolute, contract,
};
use crate::yield_set::projection::{PlaneMetric, Projection};

/// Registry entry of the interlayer yield set.
pub static INTERLAYER: YieldSetModel = YieldSetModel {
    name: "interlayer",
    title: "interlayer slip",
    parameters: &[
        (SHEAR_STRENGTH, All),
        (SHEAR_FRICTION, All),
        (SHEAR_DILATANCY, All),
        (COUPLE_STRENGTH, Couples),
        (COUPLE_FRICTION, Couples),
        (COUPLE_DILATANCY, Couples),
    ],
    is_plane: true,
    is_curved: false,
    conditions: &[
        ("+sigma21", All),
        ("-sigma21", All),
        ("+sigma12", All),
        ("-sigma12", All),
        ("+m31", Couples),
        ("-m31", Couples),
        ("+m32", Couples),
        ("-m32", Couples),
    ],
    admits: |law| {
        law.downcast::<Isotropic>().is_some() || law.downcast::<PlaneCompliances>().is_some()
    },
    build: |theory, given| {
        let (shear, couple) = if theory == Theory::Cosserat {
            let [shear_strength, shear_friction, shear_dilatancy, strength, friction, dilatancy] =
                constants(given)?;
            let couple = InterlayerCouple { strength, friction, dilatancy };
            ([shear_strength, shear_friction, shear_dilatancy], Some(couple))
        } else {
            (constants(given)?, None)
        };
        let [shear_strength, shear_friction, shear_dilatancy] = shear;
        let set = Interlayer { shear_strength, shear_friction, shear_dilatancy, couple };
        set.check().map(YieldSet::from)
    },
};

impl YieldConditions for Interlayer {
    fn value(&self, stress: &Stress) -> f64 {
        Interlayer::half_spaces(self)
            .map(|(condition, strength)| contract(&condition.normal, stress) - strength)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn active(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition> {
        Interlayer::half_spaces(self)
            .filter(|(condition, strength)| {
                let value = contract(&condition.normal, stress);
                let size = contract(&absolute(&condition.normal), &absolute(stress));
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

    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, NotInterior> {
        let mut reach = f64::INFINITY;
        for (condition, strength) in Interlayer::half_spaces(self) {
            let used = contract(&condition.normal, start);
            let rate = contract(&condition.normal, direction);
            reach = reach.min(linear_ray_exit(used, strength, rate)?);
        }
        Ok(reach)
    }

    /// Projects for isotropic laws and laws by compliances; returns the trial stress unchanged for other laws.
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress> {
        if let Some(solid) = law.downcast::<Isotropic>() {
            let mut found = project_in_plane(self, &PlaneMetric::from(solid), trial);
            // The out-of-plane stresses follow from Hooke's law: the out-of-plane elastic and plastic strains are zero.
            let change = |i: usize, j: usize| found.stress.force[i][j] - trial.force[i][j];
            let normal = change(0, 0) + change(1, 1);
            found.stress.force[2][2] += solid.lambda / (2.0 * (solid.lambda + solid.mu)) * normal;
            let ratio = solid.couple().map_or(0.0, |m| (m.gamma - m.eta) / (m.gamma + m.eta));
            for axis in 0..2 {
                let change = found.stress.couple[2][axis] - trial.couple[2][axis];
                found.stress.couple[axis][2] += ratio * change;
            }
            found
        } else if let Some(solid) = law.downcast::<PlaneCompliances>() {
            project_in_plane(self, &PlaneMetric::from(solid), trial)
        } else {
            Projection { stress: *trial, energy_lost: 0.0 }
        }
    }

    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        Some(Interlayer::half_spaces(self).collect())
    }
}

/// Projects the in-plane stresses; the out-of-plane stresses are unchanged.
fn project_in_plane(set: &Interlayer, metric: &PlaneMetric, trial: &Stress) -> Projection<Stress> {
    const PLACES: [(usize, usize); 4] = [(0, 0), (1, 1), (1, 0), (0, 1)];
    let [a, b, c, d] = PLACES.map(|(i, j)| trial.force[i][j]);
    let found = set.project(metric, &[a, b, c, d, trial.couple[2][0], trial.couple[2][1]]);
    let mut stress = *trial;
    for ((i, j), value) in PLACES.into_iter().zip(found.stress) {
        stress.force[i][j] = value;
    }
    stress.couple[2][..2].copy_from_slice(&found.stress[4..]);
    Projection { stress, energy_lost: found.energy_lost }
}
