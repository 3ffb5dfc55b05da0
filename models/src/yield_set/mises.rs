//! The von Mises, Drucker–Prager and Cosserat–Mises yield sets.

use super::SolidClass::{AllSolids, CoupleStressSolids, MicrorotationSolids};
use super::{
    RayStartError, YieldConditions, YieldSet, YieldSetModel, check_associated, linear_ray_exit,
};
use crate::common::input::{InputError, ensure};
use crate::common::parameter::to_constant_array;
use crate::solid::ElasticLaw;
use crate::solid::parameters::{Isotropic, Theory};
use crate::solid::stress::{Stress, StressComponent};
use crate::yield_set::parameters::{
    ANTISYMMETRIC_LENGTH, ANTISYMMETRIC_WEIGHT, ActiveCondition, DILATANCY, FRICTION, HARDENING,
    Mises, STRENGTH, SYMMETRIC_LENGTH, mean_stress,
};
use crate::yield_set::projection::Projection;
use nalgebra::DMatrix;

/// Registry entry of the von Mises yield set.
pub static VON_MISES: YieldSetModel = YieldSetModel {
    name: "von-mises",
    title: "von Mises",
    parameters: &[(STRENGTH, AllSolids), (HARDENING, AllSolids)],
    is_plane: false,
    is_curved: true,
    conditions: &[],
    is_compatible_law: is_isotropic,
    constructor: |_, given| {
        let [strength, hardening] = to_constant_array(given)?;
        build_checked(Mises { hardening, ..Mises::new_von_mises(strength) })
    },
};

/// Registry entry of the Drucker–Prager yield set (Mises–Schleicher condition linear in the mean stress).
pub static DRUCKER_PRAGER: YieldSetModel = YieldSetModel {
    name: "drucker-prager",
    title: "Drucker–Prager",
    parameters: &[
        (STRENGTH, AllSolids),
        (FRICTION, AllSolids),
        (DILATANCY, AllSolids),
        (HARDENING, AllSolids),
    ],
    is_plane: false,
    is_curved: true,
    conditions: &[],
    is_compatible_law: is_isotropic,
    constructor: |_, given| {
        let [strength, friction, dilatancy, hardening] = to_constant_array(given)?;
        build_checked(Mises {
            hardening,
            ..Mises::new_drucker_prager(strength, friction, dilatancy)
        })
    },
};

/// Registry entry of the Cosserat–Mises yield set, with antisymmetric stress and couple stress.
pub static COSSERAT_MISES: YieldSetModel = YieldSetModel {
    name: "cosserat-mises",
    title: "Cosserat–Mises",
    parameters: &[
        (STRENGTH, AllSolids),
        (FRICTION, AllSolids),
        (DILATANCY, AllSolids),
        (ANTISYMMETRIC_WEIGHT, MicrorotationSolids),
        (SYMMETRIC_LENGTH, CoupleStressSolids),
        (ANTISYMMETRIC_LENGTH, CoupleStressSolids),
        (HARDENING, AllSolids),
    ],
    is_plane: false,
    is_curved: true,
    conditions: &[],
    is_compatible_law: |law| is_isotropic(law) && law.theory() != Theory::Classical,
    constructor: |theory, given| {
        let ([strength, friction, dilatancy, antisymmetric_weight, hardening], lengths) =
            if theory == Theory::Cosserat {
                let [k, friction, dilatancy, weight, symmetric, antisymmetric, hardening] =
                    to_constant_array(given)?;
                ([k, friction, dilatancy, weight, hardening], [symmetric, antisymmetric])
            } else {
                (to_constant_array(given)?, [0.0; 2])
            };
        let [symmetric_internal_length, antisymmetric_internal_length] =
            lengths.map(|length| (length != 0.0).then_some(length));
        build_checked(Mises {
            strength,
            friction,
            dilatancy,
            antisymmetric_weight,
            symmetric_internal_length,
            antisymmetric_internal_length,
            hardening,
        })
    },
};

/// Whether a law is isotropic: the projection needs the eigenspaces of Hooke's law.
fn is_isotropic(law: &ElasticLaw) -> bool {
    law.downcast::<Isotropic>().is_some()
}

fn build_checked(set: Mises) -> Result<YieldSet, InputError> {
    set.check().map(YieldSet::from)
}

impl YieldConditions for Mises {
    fn yield_function(&self, stress: &Stress) -> f64 {
        self.equivalent_shear(stress) + self.friction * mean_stress(stress) - self.strength
    }

    fn active_conditions(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition> {
        let (shear, mean) = (self.equivalent_shear(stress), self.friction * mean_stress(stress));
        let size = shear + mean.abs() + self.strength;
        let is_active = shear + mean - self.strength >= -tolerance * size;
        is_active.then(|| self.condition(stress)).flatten().into_iter().collect()
    }

    fn check_ideal_and_associated(&self) -> Result<(), InputError> {
        ensure(
            self.hardening == 0.0,
            "hardening",
            self.hardening,
            "expected 0: the solver has ideal plasticity",
        )?;
        check_associated("dilatancy", self.dilatancy, self.friction)
    }

    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, RayStartError> {
        linear_ray_exit(
            self.friction * mean_stress(start),
            self.strength,
            self.equivalent_shear(direction) + self.friction * mean_stress(direction),
        )
    }

    /// Projects for isotropic laws; returns the trial stress unchanged for other laws.
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress> {
        match law.downcast::<Isotropic>() {
            Some(solid) => Mises::project(self, solid, trial),
            None => Projection { stress: *trial, energy_lost: 0.0 },
        }
    }

    fn curvature(&self, stress: &Stress, components: &[StressComponent]) -> Option<DMatrix<f64>> {
        Mises::curvature(self, stress, components)
    }
}
