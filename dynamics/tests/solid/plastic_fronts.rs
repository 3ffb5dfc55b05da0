//! Strong plastic waves: exact solutions, verification of these solutions, and errors of both plastic steps with
//! default settings.

use crate::simple_waves::{self, PressureShearImpact};
use crate::uniaxial::{BarProfile, ElasticPlasticBar, EndCondition, UniaxialState};
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use wellposed_dynamics::boundary::{Boundary, Condition, Load};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

const SHEAR_STRENGTH: f64 = 0.1;
const COURANT_NUMBER: f64 = 0.9;

fn elastic_solid() -> Isotropic {
    Isotropic::new(1.4, 0.9, 1.2, None).expect("sound moduli")
}

fn exact_bar() -> ElasticPlasticBar {
    ElasticPlasticBar::new(&elastic_solid(), SHEAR_STRENGTH, 1.0)
}

fn mises_medium() -> Medium {
    Medium::new(elastic_solid(), 2)
        .with_yield_set(YieldSet::from(Mises::new_von_mises(SHEAR_STRENGTH)))
}

/// A plane wave problem on 0 ≤ x₁ ≤ 1 with its exact solution.
struct PlaneWaveCase {
    name: &'static str,
    duration: f64,
    /// Boundary conditions at the lower and the upper end, by pair of fields.
    boundary_conditions: [Vec<Condition>; 2],
    /// Time, s, and change of the condition of the first pair at the lower end from that time on.
    condition_change: Option<(f64, f64)>,
    /// Initial and final v₁, v₂ (m/s), σ₁₁, σ₁₂, σ₂₂ (Pa): means over an interval of x₁ given by its ends (m).
    initial_means: Box<dyn Fn(f64, f64) -> [f64; 5]>,
    final_means: Box<dyn Fn(f64, f64) -> [f64; 5]>,
    /// Positions of jumps and kinks of the exact solution at the final time, m.
    front_positions: Vec<f64>,
}

fn uniaxial_values(state: UniaxialState) -> [f64; 5] {
    [state.velocity, 0.0, state.stress, 0.0, state.stress - state.stress_difference]
}

fn uniaxial_case(
    name: &'static str,
    duration: f64,
    start: BarProfile,
    ends: [Vec<(f64, EndCondition)>; 2],
) -> PlaneWaveCase {
    let end = exact_bar().advance(&start, &ends, duration);
    let is_strong = |index: &usize| {
        let [a, b] = [end.states[*index], end.states[index + 1]].map(uniaxial_values);
        (a[2] - b[2]).abs().max((a[4] - b[4]).abs()) > 0.01 * exact_bar().elastic_limit()
    };
    let strong = (0..end.fronts.len()).filter(is_strong);
    let edges = strong.map(|index| end.fronts[index].position).collect();
    let condition = |end: &Vec<(f64, EndCondition)>| match end[0].1 {
        EndCondition::Stress(stress) => vec![Condition::Traction(stress), Condition::Traction(0.0)],
        EndCondition::Velocity(velocity) => {
            vec![Condition::Velocity(velocity), Condition::Velocity(0.0)]
        }
    };
    let value = |end: EndCondition| match end {
        EndCondition::Stress(value) | EndCondition::Velocity(value) => value,
    };
    let change = ends[0].get(1).map(|&(time, end)| (time, value(end) - value(ends[0][0].1)));
    PlaneWaveCase {
        name,
        duration,
        boundary_conditions: ends.each_ref().map(condition),
        condition_change: change,
        initial_means: Box::new(move |from, to| uniaxial_values(start.mean_state(from, to))),
        final_means: Box::new(move |from, to| uniaxial_values(end.mean_state(from, to))),
        front_positions: edges,
    }
}

fn impact_case(name: &'static str, impact: PressureShearImpact) -> PlaneWaveCase {
    let waves = impact.solve();
    let duration = 0.85 / waves.points[0].0;
    let side = waves.boundary_state().velocity;
    let mut edges = vec![waves.points[0].0 * duration];
    for range in &waves.simple_wave_ranges {
        edges.push(waves.points[range.start].0 * duration);
        edges.push(waves.points[range.end - 1].0 * duration);
    }
    let given = |velocity: [f64; 2]| velocity.map(Condition::Velocity).to_vec();
    PlaneWaveCase {
        name,
        duration,
        boundary_conditions: [given(side), given([0.0; 2])],
        condition_change: None,
        initial_means: Box::new(move |_, _| [0.0, 0.0, 0.0, impact.initial_shear_stress, 0.0]),
        final_means: Box::new(move |from, to| waves.mean_state(from, to, duration).to_array()),
        front_positions: edges,
    }
}

fn exact_cases() -> Vec<PlaneWaveCase> {
    let bar = exact_bar();
    let [elastic, _] = bar.speeds();
    let limit = bar.elastic_limit();
    let velocity = limit / (bar.density * elastic);
    let free = || vec![(0.0, EndCondition::Stress(0.0))];
    let at_rest = || BarProfile::with_velocities(&[0.0], &[]);
    let push = |pressure: f64| {
        vec![(0.0, EndCondition::Stress(-pressure)), (0.2 / elastic, EndCondition::Stress(0.0))]
    };
    vec![
        uniaxial_case(
            "bar against a wall",
            0.85 / elastic,
            BarProfile::with_velocities(&[-4.0 * velocity], &[]),
            [vec![(0.0, EndCondition::Velocity(0.0))], free()],
        ),
        uniaxial_case(
            "pressure taken away",
            0.85 / elastic,
            at_rest(),
            [push(1.8 * limit), free()],
        ),
        uniaxial_case("reverse yield", 0.85 / elastic, at_rest(), [push(4.0 * limit), free()]),
        uniaxial_case(
            "flyer plate, rear face free",
            1.2 / elastic,
            BarProfile::with_velocities(&[5.0 * velocity, 0.0], &[0.3]),
            [free(), free()],
        ),
        impact_case("pressure–shear impact", pressure_shear_impact(0.0, 1.2)),
        impact_case(
            "the same on a sheared plate",
            pressure_shear_impact(0.6 * SHEAR_STRENGTH, 1.2),
        ),
    ]
}

/// Runs a case and returns the cell means of v₁, v₂, σ₁₁, σ₁₂, σ₂₂ at the final time.
fn run_case(case: &PlaneWaveCase, count: usize, scheme: Scheme) -> Vec<[f64; 5]> {
    let (medium, h) = (mises_medium(), 1.0 / count as f64);
    let longest = 2.0 * COURANT_NUMBER * h / medium.max_speed();
    let steps = (case.duration / longest * (1.0 - 1e-12)).ceil();
    let periodic = [Boundary::Periodic, Boundary::Periodic];
    let boundaries = case.boundary_conditions.clone().map(Boundary::ByPair);
    let grid = Grid { cells: [count, 1], spacing: [h, h] };
    let step = case.duration / steps;
    let mut problem =
        Problem::new(grid, vec![medium], vec![0; count], [boundaries, periodic], step, scheme);
    if let Some((from, change)) = case.condition_change {
        problem.loads.push(Load {
            axis: 0,
            end: 0,
            pair: 0,
            faces: vec![(0, change)],
            signal: std::sync::Arc::new(move |time| f64::from(u8::from(time >= from))),
        });
    }
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("a sound domain");
    const PLANE_STRAIN_FIELDS: [SolidField; 5] = [
        SolidField::Velocity(0),
        SolidField::Velocity(1),
        SolidField::Stress(0, 0),
        SolidField::Stress(0, 1),
        SolidField::Stress(1, 1),
    ];
    let mean = |values: &dyn Fn(f64, f64) -> [f64; 5], cell: usize| {
        values(cell as f64 * h, (cell + 1) as f64 * h)
    };
    for (index, field) in PLANE_STRAIN_FIELDS.into_iter().enumerate() {
        let values: Vec<f64> =
            (0..count).map(|cell| mean(&case.initial_means, cell)[index]).collect();
        domain.set_field(field, &values);
        if field == SolidField::Stress(1, 1) {
            domain.set_field(SolidField::Stress(2, 2), &values);
        }
    }
    (0..steps as usize).for_each(|_| domain.advance());
    let field_indices = PLANE_STRAIN_FIELDS.map(|field| {
        domain.fields().iter().position(|own| *own == field).expect("a field of plane strain")
    });
    let output_values = |cell: usize| {
        let mut values = Vec::new();
        domain.output_cell(cell, &mut values);
        field_indices.map(|place| values[place])
    };
    (0..count).map(output_values).collect()
}

/// Computes the errors of a run relative to the range of each field in the exact solution, maxima over the fields: mean
/// over all cells, and maximum over cells farther than 0.05 from all jumps and kinks.
fn case_errors(case: &PlaneWaveCase, count: usize, scheme: Scheme) -> [f64; 2] {
    let h = 1.0 / count as f64;
    let exact: Vec<[f64; 5]> =
        (0..count).map(|i| (case.final_means)(i as f64 * h, (i + 1) as f64 * h)).collect();
    let found = run_case(case, count, scheme);
    let (mut mean, mut max_error) = (0f64, 0f64);
    for field in 0..5 {
        let values = || exact.iter().map(|own| own[field]);
        let range = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
        if range < 1e-9 {
            continue;
        }
        let mut sum = 0.0;
        for (i, (found, exact)) in found.iter().zip(&exact).enumerate() {
            let error = (found[field] - exact[field]).abs() / range;
            sum += error * h;
            let x = (i as f64 + 0.5) * h;
            if case.front_positions.iter().all(|edge| (x - edge).abs() > 0.05) {
                max_error = max_error.max(error);
            }
        }
        mean = mean.max(sum);
    }
    [mean, max_error]
}

fn default_scheme(plastic_step: PlasticStep) -> Scheme {
    let splitting = match plastic_step {
        PlasticStep::ReturnMapping => Splitting::Alternating,
        PlasticStep::MidpointReflection => Splitting::TwoCyclic,
    };
    Scheme { splitting, ..Scheme::new(Slopes::Limited, plastic_step) }
}

const CELL_COUNTS: [usize; 4] = [100, 200, 400, 800];

/// Prints the table of BENCHMARKS.md: errors in % of the range of each field, as mean (and maximum away from fronts),
/// and the order of the mean error from 100 to 800 cells; verifies bounds on them.
#[test]
fn errors_of_both_plastic_steps_are_bounded() {
    for case in exact_cases() {
        let tables =
            [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection].map(|plastic_step| {
                let errors = CELL_COUNTS
                    .map(|count| case_errors(&case, count, default_scheme(plastic_step)));
                let columns =
                    errors.map(|[mean, max]| format!("{:.2} ({:.2})", 100.0 * mean, 100.0 * max));
                let order = (errors[0][0] / errors[3][0]).log2() / 3.0;
                println!(
                    "| {} | {plastic_step:?} | {} | {order:.2} |",
                    case.name,
                    columns.join(" | ")
                );
                assert!(
                    plastic_step == PlasticStep::MidpointReflection || order > 0.3,
                    "{}: {errors:?}",
                    case.name
                );
                errors
            });
        // The midpoint reflection smears fronts less, but leaves residual stress behind them.
        assert!(tables[1][3][0] < tables[0][3][0], "{}: {tables:?}", case.name);
        assert!(tables[0][3][1] < 0.03, "{}: {tables:?}", case.name);
    }
}

/// Verifies that fronts satisfy the balance of momentum and the constitutive law, and that the bar conserves momentum.
#[test]
fn fronts_obey_their_jump_conditions() {
    let bar = exact_bar();
    let [elastic, plastic] = bar.speeds();
    let velocity = bar.elastic_limit() / (bar.density * elastic);
    let free = || vec![(0.0, EndCondition::Stress(0.0))];
    let push = vec![
        (0.0, EndCondition::Stress(-4.0 * bar.elastic_limit())),
        (0.2 / elastic, EndCondition::Stress(0.0)),
    ];
    let flyer = BarProfile::with_velocities(&[5.0 * velocity, 0.0], &[0.3]);
    let at_rest = BarProfile::with_velocities(&[0.0], &[]);
    let (mut plastic_fronts, mut contacts) = (0, 0);
    for (start, ends) in [(flyer, [free(), free()]), (at_rest, [push, free()])] {
        let is_flyer = start.states.len() > 1;
        for time in [0.1, 0.3, 0.55, 0.8, 1.0, 1.2].map(|time| time / elastic) {
            let profile = bar.advance(&start, &ends, time);
            let scale = bar.elastic_limit();
            let close = |a: f64, b: f64| (a - b).abs() < 1e-7 * scale;
            for (front, pair) in profile.fronts.iter().zip(profile.states.windows(2)) {
                let [stress, jump, stress_difference] = [
                    pair[1].stress - pair[0].stress,
                    pair[1].velocity - pair[0].velocity,
                    pair[1].stress_difference - pair[0].stress_difference,
                ];
                assert!(close(stress, -bar.density * front.speed * jump), "{front:?} {pair:?}");
                if front.speed == 0.0 {
                    contacts += 1;
                    assert!(close(elastic * bar.density * jump, 0.0), "{pair:?}");
                } else if front.speed.abs() > 0.5 * (elastic + plastic) {
                    let ratio = 2.0 * bar.shear_modulus / bar.elastic_modulus;
                    assert!(close(stress_difference, ratio * stress), "{pair:?}");
                } else {
                    plastic_fronts += 1;
                    // The yield surface is reached ahead of the front and behind it, and loading continues.
                    assert!(close(stress_difference, 0.0), "{pair:?}");
                    assert!(close(pair[0].stress_difference.abs(), bar.yield_stress), "{pair:?}");
                    let stress_behind = stress * -front.speed.signum();
                    assert!(stress_behind * pair[0].stress_difference > 0.0, "{front:?} {pair:?}");
                }
            }
            let is_inside_yield_set =
                profile.states.iter().all(|s| s.stress_difference.abs() < bar.yield_stress + 1e-7);
            assert!(is_inside_yield_set, "{profile:?}");
            let momentum = bar.density * profile.mean_state(0.0, 1.0).velocity;
            let initial_momentum = match is_flyer {
                true => bar.density * 5.0 * velocity * 0.3,
                false => 4.0 * bar.elastic_limit() * time.min(0.2 / elastic),
            };
            // The far end is free, so that no momentum leaves through it.
            assert!(
                (momentum - initial_momentum).abs() < 1e-7 * initial_momentum,
                "{time}: {momentum} {initial_momentum}"
            );
        }
    }
    assert!(plastic_fronts > 20 && contacts > 10, "{plastic_fronts} {contacts}");
}

/// Verifies the flyer plate (Wood 1952): precursor and plastic plateau, half the velocity at the contact of the plates,
/// twice the precursor's velocity at a free face.
#[test]
fn flyer_plate_has_the_exact_plateaus() {
    let bar = exact_bar();
    let [elastic, plastic] = bar.speeds();
    let limit = bar.elastic_limit();
    let velocity = limit / (bar.density * elastic);
    let free = || vec![(0.0, EndCondition::Stress(0.0))];
    let flyer = BarProfile::with_velocities(&[5.0 * velocity, 0.0], &[0.3]);
    let early = bar.advance(&flyer, &[free(), free()], 0.1 / elastic);
    let plateau = early.mean_state(0.299, 0.301);
    assert!((plateau.velocity - 2.5 * velocity).abs() < 1e-9 * velocity, "{plateau:?}");
    let expected = -limit - bar.density * plastic * 1.5 * velocity;
    assert!((plateau.stress - expected).abs() < 1e-9 * limit, "{plateau:?}");
    assert!((plateau.stress_difference + bar.yield_stress).abs() < 1e-9 * limit, "{plateau:?}");
    let precursor = early.mean_state(0.39, 0.395);
    assert!((precursor.stress + limit).abs() < 1e-9 * limit, "{precursor:?}");
    let late = bar.advance(&flyer, &[free(), free()], 0.71 / elastic);
    let face = late.mean_state(0.999, 1.0);
    assert!((face.velocity - 2.0 * velocity).abs() < 1e-9 * velocity, "{face:?}");
}

fn pressure_shear_impact(initial_shear_stress: f64, final_angle: f64) -> PressureShearImpact {
    let fast_wave_stress_drop = 2.0 * exact_bar().elastic_limit();
    PressureShearImpact {
        solid: elastic_solid(),
        strength: SHEAR_STRENGTH,
        initial_shear_stress,
        fast_wave_stress_drop,
        final_angle,
    }
}

/// Verifies both simple waves: the stress increment follows from the strain increment −dv/ξ, ξ = x₁/t, by the return
/// mapping of the solver, momentum is balanced, and speeds decrease along the waves.
#[test]
fn simple_waves_satisfy_momentum_balance_and_return_mapping() {
    let (solid, medium) = (elastic_solid(), mises_medium());
    for initial_shear_stress in [0.0, 0.3 * SHEAR_STRENGTH, 0.6 * SHEAR_STRENGTH] {
        let impact = pressure_shear_impact(initial_shear_stress, 1.2);
        let waves = impact.solve();
        let stress = |state: simple_waves::WaveState| Stress {
            force: [
                [state.normal_stress, state.shear, 0.0],
                [state.shear, state.transverse_stress, 0.0],
                [0.0, 0.0, state.transverse_stress],
            ],
            ..Stress::default()
        };
        for points in waves.simple_wave_ranges.iter().map(|range| &waves.points[range.clone()]) {
            for pair in points.windows(2) {
                let ([(faster, a), (slower, b)], speed) =
                    ([pair[0], pair[1]], 0.5 * (pair[0].0 + pair[1].0));
                assert!(slower <= faster * (1.0 + 1e-14), "{faster} {slower}");
                let strain = [0, 1].map(|i| -(b.velocity[i] - a.velocity[i]) / speed);
                let mut trial = stress(a);
                for i in 0..3 {
                    trial.force[i][i] += solid.lambda * strain[0];
                }
                trial.force[0][0] += 2.0 * solid.mu * strain[0];
                trial.force[0][1] += solid.mu * strain[1];
                trial.force[1][0] += solid.mu * strain[1];
                let found = medium.project(&trial).stress.force;
                let expected = stress(b).force;
                let change = (b.normal_stress - a.normal_stress).hypot(b.shear - a.shear);
                for (i, j) in [(0, 0), (0, 1), (1, 1), (2, 2)] {
                    let error = (found[i][j] - expected[i][j]).abs();
                    assert!(
                        error < 2e-3 * change,
                        "{initial_shear_stress} {i}{j}: {error} of {change}"
                    );
                }
                let jumps = [b.normal_stress - a.normal_stress, b.shear - a.shear];
                for (jump, i) in jumps.into_iter().zip(0..) {
                    let balance = jump + solid.density * speed * (b.velocity[i] - a.velocity[i]);
                    assert!(
                        balance.abs() < 1e-6 * change,
                        "{initial_shear_stress} {i}: {balance} of {change}"
                    );
                }
            }
        }
        let [pressure, shear] =
            [solid.lambda + 2.0 * solid.mu, solid.mu].map(|m| (m / solid.density).sqrt());
        let [fast, slow] = &waves.simple_wave_ranges;
        let speed = |index: usize| waves.points[index].0;
        assert!(speed(fast.start) < pressure && speed(fast.end - 1) > shear);
        assert!(speed(slow.start) <= shear * (1.0 + 1e-12) && speed(slow.end - 1) > 0.0);
    }
}

/// Verifies limits of pressure–shear impact: Wood's uniaxial waves if there is no shear, and zero speed of the slow
/// wave at the angle ψ = π/2 of the yield surface.
#[test]
fn impact_without_shear_has_uniaxial_waves() {
    let bar = exact_bar();
    let [elastic, plastic] = bar.speeds();
    let waves = pressure_shear_impact(0.0, 0.0).solve();
    let limit = bar.elastic_limit();
    let expected = limit / (bar.density * elastic) + 2.0 * limit / (bar.density * plastic);
    let last = waves.boundary_state();
    assert!((last.velocity[0] - expected).abs() < 1e-12 && last.velocity[1] == 0.0, "{last:?}");
    assert!((last.normal_stress + 3.0 * limit).abs() < 1e-12, "{last:?}");
    assert!(
        (last.transverse_stress - last.normal_stress - bar.yield_stress).abs() < 1e-12,
        "{last:?}"
    );
    let still = pressure_shear_impact(0.0, 0.0).moduli(std::f64::consts::FRAC_PI_2).1[1];
    assert!(still.abs() < 1e-15, "{still}");
}
