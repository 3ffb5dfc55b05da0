//! Tests of a registered yield set that limits normal stresses only, which no shear stress reaches.

use analysis::growth::Verdict;
use models::InputError;
use models::common::parameter::{Parameter, constants};
use models::common::range::Range;
use models::registry;
use models::solid::ElasticLaw;
use models::solid::parameters::{Isotropic, Theory};
use models::solid::stress::Stress;
use models::yield_set::parameters::{ActiveCondition, contract};
use models::yield_set::projection::Projection;
use models::yield_set::{
    Needs, NotInterior, YieldConditions, YieldSet, YieldSetModel, linear_ray_exit,
};
use wellposed::case::{Case, Medium};
use wellposed::study::check::{Extent, Outcome};
use wellposed::study::unwatched;

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
            (ActiveCondition { name, normal, flow: normal, hardening: 0.0 }, self.strength)
        })
    }
}

impl YieldConditions for TensionLimit {
    fn value(&self, stress: &Stress) -> f64 {
        stress.force[0][0].max(stress.force[1][1]) - self.strength
    }

    fn active(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition> {
        let is_active = |own: &(ActiveCondition, f64)| {
            contract(&own.0.normal, stress) >= self.strength * (1.0 - tolerance)
        };
        self.conditions().into_iter().filter(is_active).map(|own| own.0).collect()
    }

    fn check_ideal_and_associated(&self) -> Result<(), InputError> {
        Ok(())
    }

    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, NotInterior> {
        let mut least = f64::INFINITY;
        for (condition, strength) in self.conditions() {
            let used = contract(&condition.normal, start);
            least =
                least.min(linear_ray_exit(used, strength, contract(&condition.normal, direction))?);
        }
        Ok(least)
    }

    /// A plastic multiplier x of an active condition reduces the stress by (λ + 2μ)x along its axis and by λx along
    /// the others.
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress> {
        let solid = law.downcast::<Isotropic>().expect("admitted");
        let (along, across) = (solid.lambda + 2.0 * solid.mu, solid.lambda);
        let excess = [0, 1].map(|axis| trial.force[axis][axis] - self.strength);
        let one = |own: usize| {
            let mut multipliers = [0.0; 2];
            multipliers[own] = excess[own] / along;
            multipliers
        };
        let multipliers = match excess {
            [a, b] if a <= 0.0 && b <= 0.0 => [0.0; 2],
            [a, b] if b - across * (a / along) <= 0.0 => one(0),
            [a, b] if a - across * (b / along) <= 0.0 => one(1),
            [a, b] => {
                let determinant = along * along - across * across;
                [(along * a - across * b) / determinant, (along * b - across * a) / determinant]
            }
        };
        let sum = multipliers[0] + multipliers[1];
        let mut stress = *trial;
        for axis in 0..3 {
            let own = multipliers.get(axis).copied().unwrap_or(0.0);
            stress.force[axis][axis] -= across * sum + 2.0 * solid.mu * own;
        }
        let energy_lost = law.stored_energy(trial) - law.stored_energy(&stress);
        Projection { stress, energy_lost }
    }

    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        Some(self.conditions().to_vec())
    }
}

const STRENGTH: Parameter =
    Parameter::required(["tension", "tensile strength k", "Pa"], "tensile strength; > 0", 1e6)
        .within(Range::Positive);

static TENSION_LIMIT: YieldSetModel = YieldSetModel {
    name: "tension-limit",
    title: "limit of tension",
    parameters: &[(STRENGTH, Needs::All)],
    is_plane: true,
    is_curved: false,
    conditions: &[("+sigma11", Needs::All), ("+sigma22", Needs::All)],
    admits: |law| law.downcast::<Isotropic>().is_some() && law.theory() == Theory::Classical,
    build: |_, given| {
        let [strength] = constants(given)?;
        STRENGTH.check(strength, "a positive strength, in Pa")?;
        Ok(YieldSet::from(TensionLimit { strength }))
    },
};

#[test]
fn limits_of_normal_stress_are_checked() {
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
        let point = wellposed::point(&case, &unwatched).expect("a state");
        assert_eq!(point.verdict(), Some(&Verdict::WellPosed), "{active}");
        let checked = wellposed::check(&case, Extent::Short, &unwatched)
            .unwrap_or_else(|error| panic!("{active}: {error}"));
        assert_eq!(checked.agrees, Some(true), "{active}: {checked:?}");
        let Outcome::Solid(solid) = &checked.outcome else { panic!("a solid") };
        assert!(solid.media[0].rows.iter().any(|row| row.limit.is_some()), "{active}");
    }

    // Messages and the reference of keys contain the name, and the template contains the example.
    let error = Case::parse(
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = 1\ndensity = 1\n[yield]\n",
        "toy.toml",
        &[],
    );
    let error = error.expect_err("no kind").to_string();
    assert!(error.contains("tension-limit"), "{error}");
    assert!(wellposed::case::reference().contains("tension-limit"));
    let medium =
        Medium::all().find(|own| own.yields.is_some_and(|set| set.name == "tension-limit"));
    let text = wellposed::cli::new::text(medium.expect("a medium"));
    assert!(text.contains("tension = 1000000.0"), "{text}");
}
