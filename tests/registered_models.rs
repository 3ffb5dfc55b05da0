//! Tests of a flow model, a solid and a yield set that are not part of the project and are registered through public
//! interfaces by one call each: verdict, map, run and check treat them like built-in models.

mod polyhedral_set;

use analysis::growth::Verdict;
use models::InputError;
use models::LinearisedSystem;
use models::Rounded;
use models::common::parameter::{Parameter, to_constant_array};
use models::common::range::AllowedRange;
use models::common::system::RoundedMatrix;
use models::flow::balance::{
    EQUATIONS_WITH_ROTATION, write_shared_equations, write_stress_axes_rotation,
};
use models::flow::state::{DeformingFlow, FlowRule, MaterialRotation, MohrCoulomb};
use models::flow::{COHESION, DILATANCY_ANGLE, FRICTION_ANGLE, FlowLaw, FlowModel, RotationKind};
use models::registry;
use models::solid::parameters::Theory;
use models::solid::stress::{Stress, StressComponent};
use models::solid::waves::{SolidField, VelocityStressPair};
use models::solid::{ElasticLaw, Elasticity, SolidModel};
use models::yield_set::parameters::{ActiveCondition, Mises};
use models::yield_set::projection::Projection;
use models::yield_set::{
    RayStartError, SolidClass, YieldConditions, YieldSet, YieldSetModel, check_associated,
};
use polyhedral_set::{active_conditions, ray_exit};
use std::sync::{Arc, Once};
use wellposed::case::{Case, MediumKind, ModelKind};
use wellposed::study::check::CheckExtent;
use wellposed::study::simulate::SimulationSettings;
use wellposed::study::{MapOptions, ignore_progress};

/// Double shearing whose rotation term of the stress axes is multiplied by a factor; a larger factor means slower
/// rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SlowRotation {
    mohr_coulomb: MohrCoulomb,
    dilatancy_angle: f64,
    rotation_factor: f64,
}

impl SlowRotation {
    fn new(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion, rotation_factor] =
            to_constant_array(given)?;
        let coulomb = MohrCoulomb::new(friction_angle, cohesion)?;
        ROTATION_FACTOR.check(rotation_factor, "a positive number")?;
        Ok(Self { mohr_coulomb: coulomb, dilatancy_angle, rotation_factor })
    }
}

impl FlowLaw for SlowRotation {
    fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::new(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &MohrCoulomb {
        &self.mohr_coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        let rule =
            FlowRule::new_double_shearing(self.mohr_coulomb.friction_angle, self.dilatancy_angle);
        FlowRule {
            rotation_coefficient: Rounded::from_rounded(self.rotation_factor)
                * rule.rotation_coefficient,
            ..rule
        }
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::StressAxes
    }

    fn write_symbol(&self, flow: &DeformingFlow, system: &mut LinearisedSystem<2>) {
        let rule = self.flow_rule();
        let coulomb = &self.mohr_coulomb;
        let columns =
            write_shared_equations(system, &EQUATIONS_WITH_ROTATION, false, coulomb, &rule, flow);
        write_stress_axes_rotation(system, 3, &columns, &rule, flow);
    }
}

const ROTATION_FACTOR: Parameter =
    Parameter::new_required(["rotation_factor", "rotation factor", ""], "factor; > 0", 2.0)
        .with_range(AllowedRange::Positive);

static SLOW_ROTATION: FlowModel = FlowModel {
    name: "slow-rotation",
    title: "double shearing with slow rotation",
    parameters: &[FRICTION_ANGLE, DILATANCY_ANGLE, COHESION, ROTATION_FACTOR],
    rotation: RotationKind::StressAxes,
    constructor: |given| Ok(Arc::new(SlowRotation::new(given)?)),
};

/// Orthotropic solid in plane strain with the axes x₁ and x₂: stiffnesses c11, c22, c12 and c66 (Pa) and density
/// (kg/m³).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Orthotropic {
    c11: f64,
    c22: f64,
    c12: f64,
    c66: f64,
    density: f64,
}

impl Elasticity for Orthotropic {
    fn theory(&self) -> Theory {
        Theory::Classical
    }

    fn is_plane(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn stiffness(&self, stresses: &[StressComponent]) -> RoundedMatrix {
        RoundedMatrix::from_fn(stresses.len(), stresses.len(), |row, column| {
            let StressComponent::Symmetric(i, j) = stresses[row] else { return Rounded::ZERO };
            let StressComponent::Symmetric(k, l) = stresses[column] else { return Rounded::ZERO };
            match ((i, j), (k, l)) {
                ((0, 0), (0, 0)) => Rounded::from_rounded(self.c11),
                ((1, 1), (1, 1)) => Rounded::from_rounded(self.c22),
                ((0, 0), (1, 1)) | ((1, 1), (0, 0)) => Rounded::from_rounded(self.c12),
                ((0, 1), (0, 1)) => Rounded::from_rounded(self.c66),
                _ => Rounded::ZERO,
            }
        })
    }

    fn pairs(&self, _dimensions: usize, axis: usize) -> Vec<VelocityStressPair> {
        let along = [self.c11, self.c22][axis];
        let pair = |i: usize| VelocityStressPair {
            velocity: SolidField::Velocity(i),
            stress: SolidField::Stress(i.min(axis), i.max(axis)),
            inertia: self.density,
            modulus: if i == axis { along } else { self.c66 },
            passive_stresses: match i == axis {
                true => vec![(SolidField::Stress(1 - axis, 1 - axis), self.c12 / along)],
                false => Vec::new(),
            },
        };
        vec![pair(0), pair(1)]
    }

    fn stored_energy(&self, stress: &Stress) -> f64 {
        let [s11, s22, s12] = [stress.force[0][0], stress.force[1][1], stress.force[0][1]];
        let determinant = self.c11 * self.c22 - self.c12 * self.c12;
        let normal = self.c22 * s11 * s11 - 2.0 * self.c12 * s11 * s22 + self.c11 * s22 * s22;
        0.5 * (normal / determinant + s12 * s12 / self.c66)
    }
}

const fn modulus_parameter(name: &'static str, example: f64) -> Parameter {
    Parameter::new_required([name, name, "Pa"], "stiffness; positive definite", example)
}

const ORTHOTROPIC_ENTRY: SolidModel = SolidModel {
    name: "orthotropic",
    title: "orthotropic solid",
    parameters: &[
        modulus_parameter("c11", 9e9),
        modulus_parameter("c22", 4e9),
        modulus_parameter("c12", 2e9),
        modulus_parameter("c66", 1.5e9),
        Parameter::new_required(["density", "density ρ", "kg/m³"], "density ρ; > 0", 2000.0)
            .with_range(AllowedRange::Positive),
    ],
    theory: Theory::Classical,
    is_plane: true,
    constructor: |given| {
        let [c11, c22, c12, c66, density] = to_constant_array(given)?;
        if !(c11 > 0.0 && c22 > 0.0 && c11 * c22 > c12 * c12 && c66 > 0.0 && density > 0.0) {
            return Err(InputError {
                input: "c11",
                rejected_value: format!("{given:?}"),
                allowed_values: "a positive definite stiffness".to_owned(),
            });
        }
        Ok(ElasticLaw::from(Orthotropic { c11, c22, c12, c66, density }))
    },
};

static ORTHOTROPIC: SolidModel = ORTHOTROPIC_ENTRY;

/// Yield set |σ₁₂| ≤ k in plane strain: layers normal to x₁ and x₂ that slip without friction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ShearLimit {
    strength: f64,
}

impl ShearLimit {
    fn conditions(&self) -> [(ActiveCondition, f64); 2] {
        [("σ12 > 0", 0.5), ("σ12 < 0", -0.5)].map(|(name, half)| {
            let mut normal = Stress::default();
            (normal.force[0][1], normal.force[1][0]) = (half, half);
            (
                ActiveCondition { name, normal, flow_direction: normal, hardening: 0.0 },
                self.strength,
            )
        })
    }
}

impl YieldConditions for ShearLimit {
    fn yield_function(&self, stress: &Stress) -> f64 {
        stress.force[0][1].abs() - self.strength
    }

    fn active_conditions(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition> {
        active_conditions(&self.conditions(), stress, tolerance)
    }

    fn check_ideal_and_associated(&self) -> Result<(), InputError> {
        check_associated("strength", self.strength, self.strength)
    }

    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, RayStartError> {
        ray_exit(&self.conditions(), start, direction)
    }

    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress> {
        let mut stress = *trial;
        let shear = trial.force[0][1].clamp(-self.strength, self.strength);
        (stress.force[0][1], stress.force[1][0]) = (shear, shear);
        // Shear is decoupled from the normal stresses in isotropic and orthotropic solids.
        let energy_lost = law.stored_energy(trial) - law.stored_energy(&stress);
        Projection { stress, energy_lost }
    }

    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        Some(self.conditions().to_vec())
    }
}

const SHEAR_STRENGTH: Parameter =
    Parameter::new_required(["strength", "shear strength k", "Pa"], "strength; > 0", 1e6)
        .with_range(AllowedRange::Positive);

const SHEAR_LIMIT_ENTRY: YieldSetModel = YieldSetModel {
    name: "shear-limit",
    title: "limit of shear",
    parameters: &[(SHEAR_STRENGTH, SolidClass::AllSolids)],
    is_plane: true,
    is_curved: false,
    conditions: &[("+sigma12", SolidClass::AllSolids), ("-sigma12", SolidClass::AllSolids)],
    is_compatible_law: |law| law.theory() == Theory::Classical,
    constructor: |_, given| {
        let [strength] = to_constant_array(given)?;
        SHEAR_STRENGTH.check(strength, "a positive strength, in Pa")?;
        Ok(YieldSet::from(ShearLimit { strength }))
    },
};

static SHEAR_LIMIT: YieldSetModel = SHEAR_LIMIT_ENTRY;

fn register_models() {
    static REGISTRATION: Once = Once::new();
    REGISTRATION.call_once(|| {
        registry::register_flow(&SLOW_ROTATION).expect("a new flow");
        registry::register_solid(&ORTHOTROPIC).expect("a new solid");
        registry::register_yield_set(&SHEAR_LIMIT).expect("a new yield set");
    });
}

fn parse_case(text: &str) -> Case {
    register_models();
    Case::parse(text, "toy.toml", &[]).unwrap_or_else(|error| panic!("{error}"))
}

const FLOW_CASE: &str = "
[model]
kind = 'slow-rotation'
friction_angle_deg = 30
rotation_factor = 1.5
[background]
density = 1600
pressure = 1000
stress_angle_deg = 45
shear_rate = 25
half_vorticity = -25
";

const RUN_SECTIONS: &str = "
[grid]
cells = [16, 16]
length = 0.1
[time]
duration = 1e-4
[[initial]]
kind = 'noise'
field = 'v'
from = 1
to = 3
amplitude = 1e-6
seed = 1
";

#[test]
fn registered_flow_has_verdict_map_run_and_check() {
    // Ill-posed like double shearing: growth rate proportional to k.
    let point =
        wellposed::analyse_point(&parse_case(FLOW_CASE), &ignore_progress).expect("a state");
    let Some(Verdict::IllPosed { growth: Some(growth), .. }) = point.verdict() else {
        panic!("{:?}", point.verdict());
    };
    assert_eq!(growth.order.to_f64(), 1.0);
    // With factor 1 the model is double shearing, which gives the same verdict by its equations and by its closed
    // form.
    let same = FLOW_CASE.replace("rotation_factor = 1.5", "rotation_factor = 1");
    let double =
        same.replace("slow-rotation", "double-shearing").replace("rotation_factor = 1", "");
    let [own, double] = [same, double].map(|text| {
        match wellposed::analyse_point(&parse_case(&text), &ignore_progress) {
            Ok(point) => match point.verdict() {
                Some(Verdict::IllPosed { growth: Some(growth), .. }) => growth.coefficient,
                other => panic!("{other:?}"),
            },
            Err(error) => panic!("{error}"),
        }
    });
    assert!((own / double - 1.0).abs() < 1e-9, "{own} {double}");

    let map = "[map]
x = { parameter = 'model.rotation_factor', from = 0.5, to = 2, points = 4 }
y = { parameter = 'background.pressure', from = 500, to = 2000, points = 3 }";
    let map = wellposed::compute_map(
        &parse_case(&format!("{FLOW_CASE}{map}")),
        MapOptions::default(),
        &ignore_progress,
    );
    let points = map.expect("a map").points;
    assert!(points.len() == 12 && points.iter().all(|point| point.growth_order == 1.0));

    let run = parse_case(&format!("{FLOW_CASE}{RUN_SECTIONS}"));
    let settings = SimulationSettings { accept_ill_posed: true };
    let result = wellposed::simulate(&run, settings, &ignore_progress).expect("a run");
    assert!(result.stop_report.is_none() && result.fields.get("psi").is_some());
    let checked =
        wellposed::check_agreement(&parse_case(FLOW_CASE), CheckExtent::Short, &ignore_progress)
            .expect("a check");
    assert_eq!(checked.is_in_agreement, Some(true), "{checked:?}");
}

const SOLID_CASE: &str = "
[model]
kind = 'orthotropic'
c11 = 9e9
c22 = 4e9
c12 = 2e9
c66 = 1.5e9
density = 2000
[wave]
number = 2.0
direction_deg = 45
";

#[test]
fn registered_solid_has_verdict_waves_map_and_check() {
    let point =
        wellposed::analyse_point(&parse_case(SOLID_CASE), &ignore_progress).expect("a state");
    assert_eq!(point.verdict(), Some(&Verdict::WellPosed));
    // Christoffel equation along 45°: ρc² are the eigenvalues of ½[c11 + c66, c12 + c66; c12 + c66, c22 + c66].
    let found =
        wellposed::compute_dispersion(&parse_case(SOLID_CASE), &ignore_progress).expect("waves");
    let mut speeds: Vec<f64> =
        found.families.iter().flat_map(|family| family.characteristic_speeds.clone()).collect();
    speeds.sort_by(f64::total_cmp);
    let (a, b, c): (f64, f64, f64) = (5.25e9, 1.75e9, 2.75e9);
    let (mean, half) = (0.5 * (a + c), (0.25 * (a - c).powi(2) + b * b).sqrt());
    for (speed, square) in speeds.iter().zip([mean - half, mean + half]) {
        assert!((speed - (square / 2000.0).sqrt()).abs() < 1e-9 * speed, "{speeds:?}");
    }

    let map = "[map]
x = { parameter = 'model.c12', from = 0, to = 3e9, points = 3 }
y = { parameter = 'model.density', from = 1000, to = 2000, points = 2 }";
    let map = wellposed::compute_map(
        &parse_case(&format!("{SOLID_CASE}{map}")),
        MapOptions::default(),
        &ignore_progress,
    );
    assert_eq!(map.expect("a map").points.len(), 6);
    let checked =
        wellposed::check_agreement(&parse_case(SOLID_CASE), CheckExtent::Short, &ignore_progress)
            .expect("a check");
    assert_eq!(checked.is_in_agreement, Some(true), "{checked:?}");
}

/// Verifies verdict, run and check for a shear load on the upper boundary of a block that yields in shear.
#[test]
fn registered_yield_set_has_verdict_run_and_check() {
    let text = "
[model]
kind = 'classical'
dimensions = 2
lambda = 2e9
mu = 2e9
density = 2000
[yield]
kind = 'shear-limit'
strength = 1e6
";
    let active = text.replace("strength = 1e6", "strength = 1e6\nactive = ['+sigma12']");
    let point = wellposed::analyse_point(&parse_case(&active), &ignore_progress).expect("a state");
    assert_eq!(point.verdict(), Some(&Verdict::WellPosed));
    let checked =
        wellposed::check_agreement(&parse_case(&active), CheckExtent::Short, &ignore_progress)
            .expect("a check");
    assert_eq!(checked.is_in_agreement, Some(true), "{checked:?}");

    let run = "
[grid]
cells = [4, 60]
spacing = 1.0
[time]
duration = 0.03
[[boundary]]
side = 'x1-'
kind = 'periodic'
[[boundary]]
side = 'x1+'
kind = 'periodic'
[[load]]
side = 'x2+'
field = 'sigma12'
amplitude = 3e6
time = { kind = 'step', duration = 0.02 }
";
    let settings = SimulationSettings { accept_ill_posed: false };
    let result =
        wellposed::simulate(&parse_case(&format!("{text}{run}")), settings, &ignore_progress);
    let fields = result.expect("a run").fields;
    let shear = fields.get("sigma12").expect("the shear stress");
    let max_shear = shear.iter().fold(0.0f64, |max, value| max.max(value.abs()));
    assert!((0.99e6..=1e6 * (1.0 + 1e-12)).contains(&max_shear), "{max_shear}");
    assert!(fields.plastic_dissipation.iter().sum::<f64>() > 0.0);
}

#[test]
fn registered_names_are_listed_and_unique() {
    register_models();
    let kinds: Vec<&str> = ModelKind::all_kinds().into_iter().map(ModelKind::name).collect();
    assert!(kinds.contains(&"slow-rotation") && kinds.contains(&"orthotropic"));
    // Every registered medium has a template, which is a valid case.
    for medium in MediumKind::all_media() {
        let text = wellposed::cli::new::generate_state_template(medium);
        Case::parse(&text, "new.toml", &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
    for result in [
        registry::register_flow(&SLOW_ROTATION),
        registry::register_solid(&ORTHOTROPIC),
        registry::register_yield_set(&SHEAR_LIMIT),
    ] {
        assert!(matches!(result, Err(registry::RegistryError::DuplicateName(_))), "{result:?}");
    }
}

/// Verifies that a yield set whose projection is in the norm of one elastic law is refused for a solid with another
/// law.
#[test]
fn unsupported_solid_of_yield_set_is_refused_with_both_names() {
    register_models();
    let run = "
[grid]
cells = [4, 8]
spacing = 1.0
[time]
duration = 0.001
[yield]
kind = 'interlayer'
shear_strength = 1e6
shear_friction = 0.5
shear_dilatancy = 0.5
";
    let error =
        Case::parse(&format!("{SOLID_CASE}{run}"), "toy.toml", &[]).expect_err("no such medium");
    let error = error.to_string();
    assert!(error.contains("orthotropic") && error.contains("interlayer"), "{error}");
    assert!(error.contains("shear-limit"), "the set that it can have is named: {error}");
    // For every solid that a yield set accepts, the projection maps a stress far outside onto the set.
    for medium in MediumKind::all_media() {
        let (ModelKind::Solid(solid), Some(kind)) = (medium.kind, medium.yield_set) else {
            continue;
        };
        let examples: Vec<f64> =
            kind.parameters_for(solid.theory).map(Parameter::example_value).collect();
        let set = kind.build_set(solid.theory, &examples).expect("examples make a set");
        let force = [[0.0, 1e9, 0.0], [1e9, 0.0, 0.0], [0.0; 3]];
        let trial = Stress { force, ..Stress::default() };
        let law = solid.build_example_law().expect("examples make a law");
        let found = set.project(&law, &trial);
        let excess = set.yield_function(&found.stress) / set.yield_function(&trial);
        assert!(excess.abs() < 1e-12 && found.energy_lost > 0.0, "{}: {excess}", medium.title());
    }
}

/// Verifies that inconsistent entries are refused: a solid whose theory differs from that of the entry or whose example
/// constants are out of range, and a yield set whose entry names conditions that the set does not have.
#[test]
fn inconsistent_entries_are_refused() {
    static CURVED_YIELD_SET: YieldSetModel = YieldSetModel {
        name: "curved-with-names",
        title: "",
        conditions: &[("+sigma12", SolidClass::AllSolids)],
        constructor: |_, _| Ok(YieldSet::from(Mises::new_von_mises(1e6))),
        ..SHEAR_LIMIT_ENTRY
    };
    let error =
        registry::register_yield_set(&CURVED_YIELD_SET).expect_err("no half-spaces").to_string();
    assert!(error.contains("curved-with-names") && error.contains("0 half-spaces"), "{error}");

    static SPATIAL_SOLID: SolidModel =
        SolidModel { name: "orthotropic-space", is_plane: false, ..ORTHOTROPIC_ENTRY };
    let found = registry::register_solid(&SPATIAL_SOLID);
    assert!(matches!(found, Err(registry::RegistryError::TheoryMismatch(_))), "{found:?}");

    static NEGATIVE_MODULUS_SOLID: SolidModel = SolidModel {
        name: "negative",
        parameters: &[
            modulus_parameter("c11", -9e9),
            modulus_parameter("c22", 4e9),
            modulus_parameter("c12", 2e9),
            modulus_parameter("c66", 1.5e9),
            Parameter::new_required(["density", "density ρ", "kg/m³"], "density ρ; > 0", 2000.0),
        ],
        ..ORTHOTROPIC_ENTRY
    };
    let error = registry::register_solid(&NEGATIVE_MODULUS_SOLID)
        .expect_err("a negative modulus")
        .to_string();
    assert!(error.contains("negative") && error.contains("c11"), "{error}");
    let listed = registry::solids();
    assert!(listed.iter().all(|solid| !["orthotropic-space", "negative"].contains(&solid.name)));
}
