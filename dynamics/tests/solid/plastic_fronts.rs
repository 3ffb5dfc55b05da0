//! Strong plastic waves: exact solutions, verification of these solutions, and errors of both plastic steps with
//! default settings.

use crate::simple_waves::{self, Impact};
use crate::uniaxial::{Bar, End, Profile, State};
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::solid::waves::Field;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use wellposed_dynamics::boundary::{Boundary, Condition, Load};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

const STRENGTH: f64 = 0.1;
const COURANT: f64 = 0.9;

fn solid() -> Isotropic {
    Isotropic::new(1.4, 0.9, 1.2, None).expect("sound moduli")
}

fn bar() -> Bar {
    Bar::new(&solid(), STRENGTH, 1.0)
}

fn medium() -> Medium {
    Medium::new(solid(), 2).yielding(YieldSet::from(Mises::von_mises(STRENGTH)))
}

/// A plane wave problem on 0 ≤ x₁ ≤ 1 with its exact solution.
struct Case {
    name: &'static str,
    duration: f64,
    /// Boundary conditions by end.
    sides: [Vec<Condition>; 2],
    /// Time, s, and change of the condition of the first pair at the lower end from that time on.
    change: Option<(f64, f64)>,
    /// Initial and final v₁, v₂, σ₁₁, σ₁₂, σ₂₂: means over an interval of x₁.
    start: Box<dyn Fn(f64, f64) -> [f64; 5]>,
    end: Box<dyn Fn(f64, f64) -> [f64; 5]>,
    /// Positions of jumps and kinks of the exact solution at the final time.
    edges: Vec<f64>,
}

fn uniaxial_values(state: State) -> [f64; 5] {
    [state.velocity, 0.0, state.stress, 0.0, state.stress - state.difference]
}

fn uniaxial_case(
    name: &'static str,
    duration: f64,
    start: Profile,
    ends: [Vec<(f64, End)>; 2],
) -> Case {
    let end = bar().advance(&start, &ends, duration);
    let is_strong = |index: &usize| {
        let [a, b] = [end.states[*index], end.states[index + 1]].map(uniaxial_values);
        (a[2] - b[2]).abs().max((a[4] - b[4]).abs()) > 0.01 * bar().elastic_limit()
    };
    let strong = (0..end.fronts.len()).filter(is_strong);
    let edges = strong.map(|index| end.fronts[index].place).collect();
    let condition = |end: &Vec<(f64, End)>| match end[0].1 {
        End::Stress(stress) => vec![Condition::Traction(stress), Condition::Traction(0.0)],
        End::Velocity(velocity) => vec![Condition::Velocity(velocity), Condition::Velocity(0.0)],
    };
    let value = |end: End| match end {
        End::Stress(value) | End::Velocity(value) => value,
    };
    let change = ends[0].get(1).map(|&(time, end)| (time, value(end) - value(ends[0][0].1)));
    Case {
        name,
        duration,
        sides: ends.each_ref().map(condition),
        change,
        start: Box::new(move |from, to| uniaxial_values(start.mean(from, to))),
        end: Box::new(move |from, to| uniaxial_values(end.mean(from, to))),
        edges,
    }
}

fn impact_case(name: &'static str, impact: Impact) -> Case {
    let waves = impact.waves();
    let duration = 0.85 / waves.points[0].0;
    let side = waves.last().velocity;
    let mut edges = vec![waves.points[0].0 * duration];
    for range in &waves.simple {
        edges.push(waves.points[range.start].0 * duration);
        edges.push(waves.points[range.end - 1].0 * duration);
    }
    let given = |velocity: [f64; 2]| velocity.map(Condition::Velocity).to_vec();
    Case {
        name,
        duration,
        sides: [given(side), given([0.0; 2])],
        change: None,
        start: Box::new(move |_, _| [0.0, 0.0, 0.0, impact.prestress, 0.0]),
        end: Box::new(move |from, to| waves.mean(from, to, duration).numbers()),
        edges,
    }
}

fn cases() -> Vec<Case> {
    let bar = bar();
    let [elastic, _] = bar.speeds();
    let limit = bar.elastic_limit();
    let velocity = limit / (bar.density * elastic);
    let free = || vec![(0.0, End::Stress(0.0))];
    let rest = || Profile::moving(&[0.0], &[]);
    let push =
        |pressure: f64| vec![(0.0, End::Stress(-pressure)), (0.2 / elastic, End::Stress(0.0))];
    vec![
        uniaxial_case(
            "bar against a wall",
            0.85 / elastic,
            Profile::moving(&[-4.0 * velocity], &[]),
            [vec![(0.0, End::Velocity(0.0))], free()],
        ),
        uniaxial_case("pressure taken away", 0.85 / elastic, rest(), [push(1.8 * limit), free()]),
        uniaxial_case("reverse yield", 0.85 / elastic, rest(), [push(4.0 * limit), free()]),
        uniaxial_case(
            "flyer plate, rear face free",
            1.2 / elastic,
            Profile::moving(&[5.0 * velocity, 0.0], &[0.3]),
            [free(), free()],
        ),
        impact_case("pressure–shear impact", impact(0.0, 1.2)),
        impact_case("the same on a sheared plate", impact(0.6 * STRENGTH, 1.2)),
    ]
}

/// Runs a case and returns the cell means of v₁, v₂, σ₁₁, σ₁₂, σ₂₂ at the final time.
fn run(case: &Case, count: usize, scheme: Scheme) -> Vec<[f64; 5]> {
    let (medium, h) = (medium(), 1.0 / count as f64);
    let longest = 2.0 * COURANT * h / medium.greatest_speed();
    let steps = (case.duration / longest * (1.0 - 1e-12)).ceil();
    let periodic = [Boundary::Periodic, Boundary::Periodic];
    let sides = case.sides.clone().map(Boundary::Given);
    let grid = Grid { cells: [count, 1], spacing: [h, h] };
    let step = case.duration / steps;
    let mut problem =
        Problem::new(grid, vec![medium], vec![0; count], [sides, periodic], step, scheme);
    if let Some((from, change)) = case.change {
        problem.loads.push(Load {
            axis: 0,
            end: 0,
            pair: 0,
            faces: vec![(0, change)],
            signal: std::sync::Arc::new(move |time| f64::from(u8::from(time >= from))),
        });
    }
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("a sound domain");
    const FIELDS: [Field; 5] = [
        Field::Velocity(0),
        Field::Velocity(1),
        Field::Stress(0, 0),
        Field::Stress(0, 1),
        Field::Stress(1, 1),
    ];
    let mean = |values: &dyn Fn(f64, f64) -> [f64; 5], cell: usize| {
        values(cell as f64 * h, (cell + 1) as f64 * h)
    };
    for (index, field) in FIELDS.into_iter().enumerate() {
        let values: Vec<f64> = (0..count).map(|cell| mean(&case.start, cell)[index]).collect();
        domain.set(field, &values);
        if field == Field::Stress(1, 1) {
            domain.set(Field::Stress(2, 2), &values);
        }
    }
    (0..steps as usize).for_each(|_| domain.advance());
    let places = FIELDS.map(|field| {
        domain.fields().iter().position(|own| *own == field).expect("a field of plane strain")
    });
    let shown = |cell: usize| {
        let mut values = Vec::new();
        domain.output_cell(cell, &mut values);
        places.map(|place| values[place])
    };
    (0..count).map(shown).collect()
}

/// Computes the errors of a run relative to the range of each field in the exact solution, maxima over the fields: mean
/// over all cells, and maximum over cells farther than 0.05 from all jumps and kinks.
fn errors(case: &Case, count: usize, scheme: Scheme) -> [f64; 2] {
    let h = 1.0 / count as f64;
    let exact: Vec<[f64; 5]> =
        (0..count).map(|i| (case.end)(i as f64 * h, (i + 1) as f64 * h)).collect();
    let found = run(case, count, scheme);
    let (mut mean, mut most) = (0f64, 0f64);
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
            if case.edges.iter().all(|edge| (x - edge).abs() > 0.05) {
                most = most.max(error);
            }
        }
        mean = mean.max(sum);
    }
    [mean, most]
}

fn scheme(plastic_step: PlasticStep) -> Scheme {
    let splitting = match plastic_step {
        PlasticStep::ReturnMapping => Splitting::Alternating,
        PlasticStep::MidpointReflection => Splitting::TwoCyclic,
    };
    Scheme { splitting, ..Scheme::new(Slopes::Limited, plastic_step) }
}

const COUNTS: [usize; 4] = [100, 200, 400, 800];

/// Prints the table of BENCHMARKS.md: errors in % of the range, mean (maximum away from fronts), and the order of the
/// mean from 100 to 800 cells.
#[test]
fn errors_of_both_plastic_steps() {
    for case in cases() {
        let tables =
            [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection].map(|plastic_step| {
                let all = COUNTS.map(|count| errors(&case, count, scheme(plastic_step)));
                let cells =
                    all.map(|[mean, most]| format!("{:.2} ({:.2})", 100.0 * mean, 100.0 * most));
                let order = (all[0][0] / all[3][0]).log2() / 3.0;
                println!(
                    "| {} | {plastic_step:?} | {} | {order:.2} |",
                    case.name,
                    cells.join(" | ")
                );
                assert!(
                    plastic_step == PlasticStep::MidpointReflection || order > 0.3,
                    "{}: {all:?}",
                    case.name
                );
                all
            });
        // The midpoint reflection smears fronts less, but leaves residual stress behind them.
        assert!(tables[1][3][0] < tables[0][3][0], "{}: {tables:?}", case.name);
        assert!(tables[0][3][1] < 0.03, "{}: {tables:?}", case.name);
    }
}

/// Verifies that fronts satisfy the balance of momentum and the constitutive law, and that the bar conserves momentum.
#[test]
fn fronts_obey_their_jump_conditions() {
    let bar = bar();
    let [elastic, plastic] = bar.speeds();
    let velocity = bar.elastic_limit() / (bar.density * elastic);
    let free = || vec![(0.0, End::Stress(0.0))];
    let push =
        vec![(0.0, End::Stress(-4.0 * bar.elastic_limit())), (0.2 / elastic, End::Stress(0.0))];
    let flyer = Profile::moving(&[5.0 * velocity, 0.0], &[0.3]);
    let rest = Profile::moving(&[0.0], &[]);
    let (mut plastic_fronts, mut contacts) = (0, 0);
    for (start, ends) in [(flyer, [free(), free()]), (rest, [push, free()])] {
        let is_flyer = start.states.len() > 1;
        for time in [0.1, 0.3, 0.55, 0.8, 1.0, 1.2].map(|time| time / elastic) {
            let profile = bar.advance(&start, &ends, time);
            let scale = bar.elastic_limit();
            let close = |a: f64, b: f64| (a - b).abs() < 1e-7 * scale;
            for (front, pair) in profile.fronts.iter().zip(profile.states.windows(2)) {
                let [stress, jump, difference] = [
                    pair[1].stress - pair[0].stress,
                    pair[1].velocity - pair[0].velocity,
                    pair[1].difference - pair[0].difference,
                ];
                assert!(close(stress, -bar.density * front.speed * jump), "{front:?} {pair:?}");
                if front.speed == 0.0 {
                    contacts += 1;
                    assert!(close(elastic * bar.density * jump, 0.0), "{pair:?}");
                } else if front.speed.abs() > 0.5 * (elastic + plastic) {
                    let ratio = 2.0 * bar.shear_modulus / bar.elastic_modulus;
                    assert!(close(difference, ratio * stress), "{pair:?}");
                } else {
                    plastic_fronts += 1;
                    // The yield surface is reached on both sides, and loading continues.
                    assert!(close(difference, 0.0), "{pair:?}");
                    assert!(close(pair[0].difference.abs(), bar.yield_stress), "{pair:?}");
                    let behind = stress * -front.speed.signum();
                    assert!(behind * pair[0].difference > 0.0, "{front:?} {pair:?}");
                }
            }
            let within =
                profile.states.iter().all(|s| s.difference.abs() < bar.yield_stress + 1e-7);
            assert!(within, "{profile:?}");
            let momentum = bar.density * profile.mean(0.0, 1.0).velocity;
            let given = match is_flyer {
                true => bar.density * 5.0 * velocity * 0.3,
                false => 4.0 * bar.elastic_limit() * time.min(0.2 / elastic),
            };
            // The far end is free, so that no momentum leaves through it.
            assert!((momentum - given).abs() < 1e-7 * given, "{time}: {momentum} {given}");
        }
    }
    assert!(plastic_fronts > 20 && contacts > 10, "{plastic_fronts} {contacts}");
}

/// Verifies the flyer plate (Wood 1952): precursor and plastic plateau, half the velocity at the contact of the plates,
/// twice the precursor's velocity at a free face.
#[test]
fn plateaus_of_a_flyer_plate() {
    let bar = bar();
    let [elastic, plastic] = bar.speeds();
    let limit = bar.elastic_limit();
    let velocity = limit / (bar.density * elastic);
    let free = || vec![(0.0, End::Stress(0.0))];
    let flyer = Profile::moving(&[5.0 * velocity, 0.0], &[0.3]);
    let early = bar.advance(&flyer, &[free(), free()], 0.1 / elastic);
    let plateau = early.mean(0.299, 0.301);
    assert!((plateau.velocity - 2.5 * velocity).abs() < 1e-9 * velocity, "{plateau:?}");
    let expected = -limit - bar.density * plastic * 1.5 * velocity;
    assert!((plateau.stress - expected).abs() < 1e-9 * limit, "{plateau:?}");
    assert!((plateau.difference + bar.yield_stress).abs() < 1e-9 * limit, "{plateau:?}");
    let precursor = early.mean(0.39, 0.395);
    assert!((precursor.stress + limit).abs() < 1e-9 * limit, "{precursor:?}");
    let late = bar.advance(&flyer, &[free(), free()], 0.71 / elastic);
    let face = late.mean(0.999, 1.0);
    assert!((face.velocity - 2.0 * velocity).abs() < 1e-9 * velocity, "{face:?}");
}

fn impact(prestress: f64, last_angle: f64) -> Impact {
    let fast_fall = 2.0 * bar().elastic_limit();
    Impact { solid: solid(), strength: STRENGTH, prestress, fast_fall, last_angle }
}

/// Verifies both simple waves: the stress follows from the strain −∂v/ξ by the return mapping of the solver, momentum
/// is balanced, and speeds decrease along the waves.
#[test]
fn simple_waves_obey_the_law() {
    let (solid, medium) = (solid(), medium());
    for prestress in [0.0, 0.3 * STRENGTH, 0.6 * STRENGTH] {
        let impact = impact(prestress, 1.2);
        let waves = impact.waves();
        let stress = |state: simple_waves::State| Stress {
            force: [
                [state.normal, state.shear, 0.0],
                [state.shear, state.across, 0.0],
                [0.0, 0.0, state.across],
            ],
            ..Stress::default()
        };
        for points in waves.simple.iter().map(|range| &waves.points[range.clone()]) {
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
                let change = (b.normal - a.normal).hypot(b.shear - a.shear);
                for (i, j) in [(0, 0), (0, 1), (1, 1), (2, 2)] {
                    let error = (found[i][j] - expected[i][j]).abs();
                    assert!(error < 2e-3 * change, "{prestress} {i}{j}: {error} of {change}");
                }
                let jumps = [b.normal - a.normal, b.shear - a.shear];
                for (jump, i) in jumps.into_iter().zip(0..) {
                    let balance = jump + solid.density * speed * (b.velocity[i] - a.velocity[i]);
                    assert!(
                        balance.abs() < 1e-6 * change,
                        "{prestress} {i}: {balance} of {change}"
                    );
                }
            }
        }
        let [pressure, shear] =
            [solid.lambda + 2.0 * solid.mu, solid.mu].map(|m| (m / solid.density).sqrt());
        let [fast, slow] = &waves.simple;
        let speed = |index: usize| waves.points[index].0;
        assert!(speed(fast.start) < pressure && speed(fast.end - 1) > shear);
        assert!(speed(slow.start) <= shear * (1.0 + 1e-12) && speed(slow.end - 1) > 0.0);
    }
}

/// Verifies limits of pressure–shear impact: Wood's waves without shear, and zero speed of the slow wave at ψ = π/2.
#[test]
fn limits_of_pressure_shear_impact() {
    let bar = bar();
    let [elastic, plastic] = bar.speeds();
    let waves = impact(0.0, 0.0).waves();
    let limit = bar.elastic_limit();
    let expected = limit / (bar.density * elastic) + 2.0 * limit / (bar.density * plastic);
    let last = waves.last();
    assert!((last.velocity[0] - expected).abs() < 1e-12 && last.velocity[1] == 0.0, "{last:?}");
    assert!((last.normal + 3.0 * limit).abs() < 1e-12, "{last:?}");
    assert!((last.across - last.normal - bar.yield_stress).abs() < 1e-12, "{last:?}");
    let still = impact(0.0, 0.0).moduli(std::f64::consts::FRAC_PI_2).1[1];
    assert!(still.abs() < 1e-15, "{still}");
}
