//! Tests of a registered yield set that limits normal stresses only, which no shear stress reaches.

use crate::polyhedral_set;

use analysis::growth::Verdict;
use models::InputError;
use models::common::parameter::{Parameter, to_constant_array};
use models::common::range::AllowedRange;
use models::registry;
use models::solid::ElasticLaw;
use models::solid::parameters::{Isotropic, Theory};
use models::solid::stress::Stress;
use models::yield_set::parameters::ActiveCondition;
use models::yield_set::projection::Projection;
use models::yield_set::{RayStartError, SolidClass, YieldConditions, YieldSet, YieldSetModel};
use polyhedral_set::{active_conditions, ray_exit};
use wellposed::case::{Case, MediumKind};
use wellposed::study::check::{CheckExtent, CheckOutcome};
use wellposed::study::ignore_progress;

/// Yield set σ₁₁ ≤ k and σ₂₂ ≤ k in plane strain: cracks normal to x₁ and x₂ open at constant tension k.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TensionLimit {
    strength: f64,
}

impl TensionLimit {
    fn conditions(&self) -> [(ActiveCondition, f64); 2] {
        [("σ11", 0), ("σ22", 1)].map(|(name, face): (&'static str, usize)| {
            let mut normal = Stress::default();
            normal.force[face][face] = 1.0;
            (
                ActiveCondition { name, normal, flow_direction: normal, hardening: 0.0 },
                self.strength,
            )
        })
    }
}

impl YieldConditions for TensionLimit {
    fn yield_function(&self, stress: &Stress) -> f64 {
        stress.force[0][0].max(stress.force[1][1]) - self.strength
    }

    fn active_conditions(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition> {
        active_conditions(&self.conditions(), stress, tolerance)
    }

    fn check_ideal_and_associated(&self) -> Result<(), InputError> {
        Ok(())
    }

    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, RayStartError> {
        ray_exit(&self.conditions(), start, direction)
    }

    /// Projects onto the set in the energy norm: a plastic multiplier x of an active condition reduces the normal
    /// stress along its axis by (λ + 2μ)x and those along the other axes by λx.
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress> {
        let solid = law.downcast::<Isotropic>().expect("admitted");
        let (along, across) = (solid.lambda + 2.0 * solid.mu, solid.lambda);
        let excess = [0, 1].map(|axis| trial.force[axis][axis] - self.strength);
        let single_multiplier = |axis: usize| {
            let mut multipliers = [0.0; 2];
            multipliers[axis] = excess[axis] / along;
            multipliers
        };
        let multipliers = match excess {
            [a, b] if a <= 0.0 && b <= 0.0 => [0.0; 2],
            [a, b] if b - across * (a / along) <= 0.0 => single_multiplier(0),
            [a, b] if a - across * (b / along) <= 0.0 => single_multiplier(1),
            [a, b] => {
                let determinant = along * along - across * across;
                [(along * a - across * b) / determinant, (along * b - across * a) / determinant]
            }
        };
        let sum = multipliers[0] + multipliers[1];
        let mut stress = *trial;
        for axis in 0..3 {
            let multiplier = multipliers.get(axis).copied().unwrap_or(0.0);
            stress.force[axis][axis] -= across * sum + 2.0 * solid.mu * multiplier;
        }
        let energy_lost = law.stored_energy(trial) - law.stored_energy(&stress);
        Projection { stress, energy_lost }
    }

    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        Some(self.conditions().to_vec())
    }
}

const TENSILE_STRENGTH: Parameter =
    Parameter::new_required(["tension", "tensile strength k", "Pa"], "tensile strength; > 0", 1e6)
        .with_range(AllowedRange::Positive);

static TENSION_LIMIT: YieldSetModel = YieldSetModel {
    name: "tension-limit",
    title: "limit of tension",
    parameters: &[(TENSILE_STRENGTH, SolidClass::AllSolids)],
    is_plane: true,
    is_curved: false,
    conditions: &[("+sigma11", SolidClass::AllSolids), ("+sigma22", SolidClass::AllSolids)],
    is_compatible_law: |law| {
        law.downcast::<Isotropic>().is_some() && law.theory() == Theory::Classical
    },
    constructor: |_, given| {
        let [strength] = to_constant_array(given)?;
        TENSILE_STRENGTH.check(strength, "a positive strength, in Pa")?;
        Ok(YieldSet::from(TensionLimit { strength }))
    },
};

#[test]
fn registered_tension_limit_is_assessed_and_checked() {
    registry::register_yield_set(&TENSION_LIMIT).expect("a new set");
    for active in ["['+sigma11']", "['+sigma22']", "['+sigma11', '+sigma22']"] {
        let text = format!(
            "
[model]
kind = 'classical'
dimensions = 2
lambda = 2e9
mu = 1e9
density = 2000
[yield]
kind = 'tension-limit'
tension = 1e6
active = {active}
[check]
cells = [16, 24]
"
        );
        let case = Case::parse(&text, "toy.toml", &[]).unwrap_or_else(|error| panic!("{error}"));
        let point = wellposed::analyse_point(&case, &ignore_progress).expect("a state");
        assert_eq!(point.verdict(), Some(&Verdict::WellPosed), "{active}");
        let checked = wellposed::check_agreement(&case, CheckExtent::Short, &ignore_progress)
            .unwrap_or_else(|error| panic!("{active}: {error}"));
        assert_eq!(checked.is_in_agreement, Some(true), "{active}: {checked:?}");
        let CheckOutcome::Solid(solid) = &checked.outcome else { panic!("a solid") };
        assert!(
            solid.medium_checks[0]
                .branch_checks
                .iter()
                .any(|row| row.extrapolated_result.is_some()),
            "{active}"
        );
    }

    // Messages and the reference of keys contain the name of the yield set, and the template contains its example.
    let error = Case::parse(
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = 1\ndensity = 1\n[yield]\n",
        "toy.toml",
        &[],
    );
    let error = error.expect_err("no kind").to_string();
    assert!(error.contains("tension-limit"), "{error}");
    assert!(wellposed::case::generate_reference().contains("tension-limit"));
    let medium = MediumKind::all_media()
        .find(|medium| medium.yield_set.is_some_and(|set| set.name == "tension-limit"));
    let text = wellposed::cli::new::generate_state_template(medium.expect("a medium"));
    assert!(text.contains("tension = 1000000.0"), "{text}");
}
