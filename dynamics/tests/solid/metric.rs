//! Blocks in the plane whose spacing differs between layers, and polar blocks.

use crate::support::media::isotropic;
use crate::support::noise;
use models::solid::parameters::Theory;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Condition, Load};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::InstructionSet;
use wellposed_dynamics::solid::metric::Metric;

const LAMBDA: f64 = 1.4;
const MU: f64 = 0.9;
const DENSITY: f64 = 1.2;

/// Inner radius and width of polar blocks, m.
const INNER_RADIUS: f64 = 0.5;
const RADIAL_WIDTH: f64 = 2.0;

fn build_polar_grid(cells: [usize; 2]) -> (Grid<2>, Metric) {
    let spacing = [TAU / cells[0] as f64, RADIAL_WIDTH / cells[1] as f64];
    (Grid { cells, spacing }, Metric::new_polar(INNER_RADIUS, cells[1], spacing))
}

fn build_straight_metric(spacing: Vec<f64>) -> Metric {
    Metric { spacing, curvature: Vec::new(), field_factors: Vec::new() }
}

/// Returns the time step, s, for which sweeps of half a step have the Courant number 0.9 in the smallest cell.
fn stable_time_step(grid: &Grid<2>, metric: &Metric, medium: &Medium) -> f64 {
    let min_length = metric.spacing.iter().copied().fold(grid.spacing[1], f64::min);
    1.8 * min_length / medium.max_speed()
}

fn fill_with_noise<T: SolverReal>(problem: &Problem<2>, mut set: impl FnMut(SolidField, &[T])) {
    for (index, field) in problem.fields().into_iter().enumerate() {
        let value = |cell: usize| T::from_f64(noise((100_003 * index + cell) as u64));
        set(field, &(0..problem.grid.count()).map(value).collect::<Vec<_>>());
    }
}

/// Compares the fused solver, with several decompositions and instruction sets, with the reference solver, for two
/// media distributed at random and a random initial state; verifies the ledger.
fn compare_with_reference<T: SolverReal>(theory: Theory, is_polar: bool, slopes: Slopes) {
    let cells = [23, 17];
    let (grid, polar) = build_polar_grid(cells);
    let spacing = (0..cells[1]).map(|layer| 0.1 * (1.5 + noise(layer as u64))).collect();
    let metric = if is_polar { polar } else { build_straight_metric(spacing) };
    let set = YieldSet::from(Mises::new_von_mises(0.3));
    let soft = Medium::new(isotropic(theory, 1.0), 2);
    let media = vec![soft.with_yield_set(set), Medium::new(isotropic(theory, 2.3), 2)];
    let cell_media = (0..grid.count()).map(|i| u16::from(noise(i as u64) > 0.2)).collect();
    let boundaries =
        [[Boundary::NonReflecting, Boundary::Free], [Boundary::Free, Boundary::NonReflecting]];
    let step = stable_time_step(&grid, &metric, &media[1]);
    let scheme = Scheme::new(slopes, PlasticStep::ReturnMapping);
    let problem = Problem {
        metric: Some(metric),
        ..Problem::new(grid, media, cell_media, boundaries, step, scheme)
    };
    let mut reference: Reference<T, 2> = Reference::new(&problem).expect("sound");
    fill_with_noise(&problem, |field, values: &[T]| reference.set_field(field, values));
    let start = reference.energy().total();
    reference.advance(15);
    let expected = reference.snapshot();
    let error = reference.energy().total() - start - reference.ledger().energy_change();
    let limit = if size_of::<T>() == 4 { 1e-5 } else { 1e-13 };
    assert!(error.abs() < limit * start, "{error:e} of {start}");
    assert!(reference.ledger().boundary_work != 0.0);
    let bits = |all: &[Vec<T>]| -> Vec<u64> {
        all.iter().flatten().map(|value| value.to_f64().to_bits()).collect()
    };
    for parts in [[1, 1], [1, 3], [2, 1], [2, 2]] {
        for instructions in InstructionSet::available_sets() {
            let mut decomposed: DecomposedDomain<T, 2> =
                DecomposedDomain::with_subdomains(0, &problem, parts).expect("sound");
            decomposed.set_instructions(instructions);
            fill_with_noise(&problem, |field, values: &[T]| decomposed.set_field(field, values));
            decomposed.advance(4).expect("threads");
            decomposed.advance(11).expect("threads");
            let found = decomposed.snapshot();
            assert!(bits(&found.fields) == bits(&expected.fields), "{parts:?} {instructions:?}");
            assert_eq!(found.cell_sums, expected.cell_sums);
            assert_eq!(found.work_sums[0], expected.work_sums[0]);
            assert_eq!(decomposed.energy(), reference.energy());
        }
    }
}

#[test]
fn fused_solver_equals_the_reference_with_a_metric() {
    for is_polar in [true, false] {
        compare_with_reference::<f64>(Theory::Classical, is_polar, Slopes::Limited);
        compare_with_reference::<f64>(Theory::Cosserat, is_polar, Slopes::FourthOrder);
        compare_with_reference::<f32>(Theory::Reduced, is_polar, Slopes::Limited);
    }
}

/// Verifies that a metric with the spacing of the grid in all layers changes no bit.
#[test]
fn uniform_metric_changes_no_bit() {
    let grid = Grid { cells: [15, 12], spacing: [0.1, 0.13] };
    let medium = Medium::new(isotropic(Theory::Cosserat, 1.0), 2);
    let boundaries = [[Boundary::Periodic, Boundary::Periodic], [Boundary::Fixed, Boundary::Free]];
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    let step = 0.19 / medium.max_speed();
    let plain = Problem::new(grid, vec![medium], vec![0; 180], boundaries, step, scheme);
    let metric = Some(build_straight_metric(vec![0.1; 12]));
    let with_metric = Problem { metric, ..plain.clone() };
    let [plain, with_metric] = [plain, with_metric].map(|problem| {
        let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
        fill_with_noise(&problem, |field, values: &[f64]| domain.set_field(field, values));
        (0..20).for_each(|_| domain.advance());
        let values = domain.fields().to_vec().into_iter().map(|field| domain.values(field));
        values.collect::<Vec<_>>()
    });
    assert_eq!(plain, with_metric);
}

/// Computes Bessel's function Jₙ(x) from its integral; the trapezoidal rule is exact to rounding.
fn bessel(order: i32, x: f64) -> f64 {
    const QUADRATURE_POINTS: usize = 64;
    let term = |index: usize| {
        let angle = TAU * index as f64 / QUADRATURE_POINTS as f64;
        (f64::from(order) * angle - x * angle.sin()).cos()
    };
    (0..QUADRATURE_POINTS).map(term).sum::<f64>() / QUADRATURE_POINTS as f64
}

/// Computes a standing P wave with the displacement u = ∇φ sin(ωt)/ω, φ = J₂(kr) cos 2θ, in polar coordinates (wave
/// number k, frequency ω). Returns v_θ, v_r, then the stresses σ_θθ, σ_rr, σ_rθ.
fn standing_wave(k: f64, [theta, r]: [f64; 2], time: f64) -> [f64; 5] {
    let m = 2.0;
    let speed = ((LAMBDA + 2.0 * MU) / DENSITY).sqrt();
    let x = k * r;
    let value = bessel(2, x);
    let slope = 0.5 * (bessel(1, x) - bessel(3, x));
    let second = -slope / x - (1.0 - m * m / (x * x)) * value;
    let ((sin, cos), (s, c)) = ((m * theta).sin_cos(), (speed * k * time).sin_cos());
    let strain = s / (speed * k);
    let pressure = -LAMBDA * k * k * value;
    [
        -m / r * value * sin * c,
        k * slope * cos * c,
        (pressure + 2.0 * MU * (k * slope / r - m * m / (r * r) * value)) * cos * strain,
        (pressure + 2.0 * MU * k * k * second) * cos * strain,
        -2.0 * MU * m * (k * slope / r - value / (r * r)) * sin * strain,
    ]
}

const PLANE_STRAIN_FIELDS: [SolidField; 5] = [
    SolidField::Velocity(0),
    SolidField::Velocity(1),
    SolidField::Stress(0, 0),
    SolidField::Stress(1, 1),
    SolidField::Stress(0, 1),
];

/// Computes a standing P wave in Cartesian coordinates, φ = cos 2x cos ly, k² = 4 + l²; returns fields in the order of
/// [`standing_wave`].
fn plane_standing_wave(k: f64, [x, y]: [f64; 2], time: f64) -> [f64; 5] {
    let l = (k * k - 4.0).sqrt();
    let speed = ((LAMBDA + 2.0 * MU) / DENSITY).sqrt();
    let ((sx, cx), (sy, cy)) = ((2.0 * x).sin_cos(), (l * y).sin_cos());
    let (s, c) = (speed * k * time).sin_cos();
    let strain = s / (speed * k);
    let pressure = -LAMBDA * k * k * cx * cy;
    [
        -2.0 * sx * cy * c,
        -l * cx * sy * c,
        (pressure - 8.0 * MU * cx * cy) * strain,
        (pressure - 2.0 * MU * l * l * cx * cy) * strain,
        4.0 * MU * l * sx * sy * strain,
    ]
}

/// Computes the L2 error of a standing wave over all fields, relative to its norm: in all layers, and in the layers
/// that no wave from the boundaries, whose velocities are prescribed, can have reached.
fn standing_wave_errors(cells: [usize; 2], is_polar: bool) -> [f64; 2] {
    let (grid, metric) = build_polar_grid(cells);
    let medium = Medium::new(isotropic(Theory::Classical, 1.0), 2);
    let (k, time) = (3.0, 0.3);
    let steps = (time / stable_time_step(&grid, &metric, &medium)).ceil();
    let speed = medium.max_speed();
    let prescribed_velocity = |_| Boundary::ByPair(vec![Condition::Velocity(0.0); 2]);
    let boundaries = [[Boundary::Periodic, Boundary::Periodic], [0, 1].map(prescribed_velocity)];
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let mut problem =
        Problem::new(grid, vec![medium], vec![0; grid.count()], boundaries, time / steps, scheme);
    problem.metric = Some(metric).filter(|_| is_polar);
    let exact_at = |position: [f64; 2], time: f64| match is_polar {
        true => standing_wave(k, position, time).map(|value| position[1].sqrt() * value),
        false => plane_standing_wave(k, position, time),
    };
    let angle = |index: usize| (index as f64 + 0.5) * grid.spacing[0];
    for (end, radius) in [INNER_RADIUS, INNER_RADIUS + RADIAL_WIDTH].into_iter().enumerate() {
        for (pair, own) in problem.media[0].pairs[1].iter().enumerate() {
            let SolidField::Velocity(component) = own.velocity else { panic!("a velocity") };
            let value = |face: usize| exact_at([angle(face), radius], 0.0)[component];
            let faces = (0..cells[0]).map(|face| (face, value(face))).collect();
            let signal = Arc::new(move |time: f64| (speed * k * time).cos());
            problem.loads.push(Load { axis: 1, end, pair, faces, signal });
        }
    }
    let polar_position = |cell: usize| {
        [angle(cell % cells[0]), INNER_RADIUS + ((cell / cells[0]) as f64 + 0.5) * grid.spacing[1]]
    };
    let exact = |index: usize, time: f64| -> Vec<f64> {
        (0..grid.count()).map(|cell| exact_at(polar_position(cell), time)[index]).collect()
    };
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
    PLANE_STRAIN_FIELDS
        .iter()
        .enumerate()
        .for_each(|(index, field)| domain.set_field(*field, &exact(index, 0.0)));
    (0..steps as usize).for_each(|_| domain.advance());
    let (mut error, mut size) = ([0.0; 2], [0.0; 2]);
    for (index, field) in PLANE_STRAIN_FIELDS.into_iter().enumerate() {
        let found = domain.values(field).expect("a field");
        for (cell, (found, exact)) in found.iter().zip(exact(index, time)).enumerate() {
            let depth = polar_position(cell)[1] - INNER_RADIUS;
            // Margin of 30 %, since errors of short waves may travel faster.
            let is_reached = depth.min(RADIAL_WIDTH - depth) < 1.3 * speed * time;
            for which in 0..if is_reached { 1 } else { 2 } {
                error[which] += (found - exact) * (found - exact);
                size[which] += exact * exact;
            }
        }
    }
    [0, 1].map(|which| f64::sqrt(error[which] / size[which]))
}

/// Verifies second order in the interior. At moving boundaries splitting reduces the order, in a polar block no more
/// than on a Cartesian grid.
#[test]
fn standing_waves_of_a_polar_block_are_second_order() {
    let grids = [[32, 16], [64, 32], [128, 64], [256, 128]];
    let [polar, plane] = [true, false].map(|is_polar| {
        let errors = grids.map(|cells| standing_wave_errors(cells, is_polar));
        println!("{errors:?}");
        // All layers: order of the last refinement; interior: mean order of all three.
        [(errors[2][0] / errors[3][0]).log2(), (errors[0][1] / errors[3][1]).log2() / 3.0]
    });
    println!("{polar:?} {plane:?}");
    assert!(polar[1] > 1.9 && plane[1] > 1.9, "{polar:?} {plane:?}");
    assert!(polar[0] > plane[0] - 0.1 && polar[0] > 1.4, "{polar:?} {plane:?}");
}

/// Verifies rotation about the centre and translation of a Cosserat solid: stresses vanish with the cell size, at an
/// order lower by one half at moving boundaries.
#[test]
fn rigid_motions_cause_no_stress() {
    let motion = |is_rotation: bool, [theta, r]: [f64; 2]| match is_rotation {
        // The third axis of (θ, r) points opposite to that of (x, y).
        true => [r, 0.0, -1.0],
        false => [-theta.sin(), theta.cos(), 0.0],
    };
    for is_rotation in [true, false] {
        let stresses = [[24, 8], [48, 16], [96, 32]].map(|cells| {
            let (grid, metric) = build_polar_grid(cells);
            let medium = Medium::new(isotropic(Theory::Cosserat, 1.0), 2);
            let steps = (0.7 / stable_time_step(&grid, &metric, &medium)).ceil();
            let faces = |end: usize| {
                let radius = INNER_RADIUS + RADIAL_WIDTH * end as f64;
                let value = |velocity: SolidField, face: usize| {
                    let theta = (face as f64 + 0.5) * grid.spacing[0];
                    let [v0, v1, spin] = motion(is_rotation, [theta, radius]);
                    Condition::Velocity(
                        radius.sqrt()
                            * match velocity {
                                SolidField::Velocity(0) => v0,
                                SolidField::Velocity(_) => v1,
                                _ => spin,
                            },
                    )
                };
                let pairs = medium.pairs[1].iter();
                let pair_values =
                    |velocity| (0..cells[0]).map(|face| value(velocity, face)).collect();
                Boundary::ByFace(pairs.map(|pair| pair_values(pair.velocity)).collect())
            };
            let boundaries = [[Boundary::Periodic, Boundary::Periodic], [0, 1].map(faces)];
            let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
            let media = vec![medium.clone()];
            let cell_media = vec![0; grid.count()];
            let problem = Problem {
                metric: Some(metric),
                ..Problem::new(grid, media, cell_media, boundaries, 0.7 / steps, scheme)
            };
            let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
            let positions = (0..grid.count()).map(|cell| {
                let radius = INNER_RADIUS + ((cell / cells[0]) as f64 + 0.5) * grid.spacing[1];
                [((cell % cells[0]) as f64 + 0.5) * grid.spacing[0], radius]
            });
            let fields = [SolidField::Velocity(0), SolidField::Velocity(1), SolidField::Spin(2)];
            for (index, field) in fields.into_iter().enumerate() {
                let value =
                    |position: [f64; 2]| position[1].sqrt() * motion(is_rotation, position)[index];
                domain.set_field(field, &positions.clone().map(value).collect::<Vec<_>>());
            }
            (0..steps as usize).for_each(|_| domain.advance());
            (domain.energy().stored / domain.energy().kinetic).sqrt()
        });
        println!("{stresses:?}");
        assert!(stresses[2] < 2e-3, "{stresses:?}");
        assert!((stresses[1] / stresses[2]).log2() > 1.5, "{stresses:?}");
    }
}

/// Complex amplitudes of v₀, v₁, σ₀₀, σ₁₁, σ₀₁ at nodes across the layers.
type LayerAmplitudes = Vec<[Complex64; 5]>;

/// Computes waves with one period along rows whose length depends on y, periodic in y: trigonometric collocation across
/// layers, fourth-order Runge–Kutta in time. Returns v₀, v₁, σ₀₀, σ₁₁, σ₀₁ at the positions `at`.
fn solve_by_collocation(length: impl Fn(f64) -> f64, time: f64, at: &[f64]) -> LayerAmplitudes {
    const NODE_COUNT: usize = 40;
    let node = |i: usize| i as f64 / NODE_COUNT as f64;
    let derivative = |i: usize, j: usize| {
        let apart = i as f64 - j as f64;
        let sign = if (i + j).is_multiple_of(2) { PI } else { -PI };
        if i == j { 0.0 } else { sign / (PI * apart / NODE_COUNT as f64).tan() }
    };
    let rates = |state: &LayerAmplitudes| -> LayerAmplitudes {
        let along_y = |i: usize, field: usize| -> Complex64 {
            (0..NODE_COUNT).map(|j| derivative(i, j) * state[j][field]).sum()
        };
        let rate = |i: usize| {
            let ik = Complex64::new(0.0, TAU / length(node(i)));
            let [v0, v1, s00, _, s01] = state[i];
            let m = LAMBDA + 2.0 * MU;
            [
                (ik * s00 + along_y(i, 4)) / DENSITY,
                (ik * s01 + along_y(i, 3)) / DENSITY,
                m * ik * v0 + LAMBDA * along_y(i, 1),
                LAMBDA * ik * v0 + m * along_y(i, 1),
                MU * (ik * v1 + along_y(i, 0)),
            ]
        };
        (0..NODE_COUNT).map(rate).collect()
    };
    let plus = |state: &LayerAmplitudes, rates: &LayerAmplitudes, time: f64| -> LayerAmplitudes {
        let cells = state.iter().zip(rates);
        cells.map(|(own, rate)| std::array::from_fn(|i| own[i] + time * rate[i])).collect()
    };
    let mut state: LayerAmplitudes =
        (0..NODE_COUNT).map(|i| initial_fields(node(i)).map(Complex64::from)).collect();
    const RUNGE_KUTTA_STEPS: usize = 1000;
    let step = time / RUNGE_KUTTA_STEPS as f64;
    for _ in 0..RUNGE_KUTTA_STEPS {
        let one = rates(&state);
        let two = rates(&plus(&state, &one, 0.5 * step));
        let three = rates(&plus(&state, &two, 0.5 * step));
        let four = rates(&plus(&state, &three, step));
        for (index, own) in state.iter_mut().enumerate() {
            for (i, value) in own.iter_mut().enumerate() {
                let sum = one[index][i] + 2.0 * (two[index][i] + three[index][i]) + four[index][i];
                *value += step / 6.0 * sum;
            }
        }
    }
    let interpolate = |y: &f64| {
        let cardinal = |i: usize| {
            let apart = y - node(i);
            match apart.abs() < 1e-12 {
                true => 1.0,
                false => {
                    (PI * NODE_COUNT as f64 * apart).sin()
                        / (NODE_COUNT as f64 * (PI * apart).tan())
                }
            }
        };
        std::array::from_fn(|field| (0..NODE_COUNT).map(|i| cardinal(i) * state[i][field]).sum())
    };
    at.iter().map(interpolate).collect()
}

/// Initial fields at the position y: v₀ = sin²(πy), all others zero.
fn initial_fields(y: f64) -> [f64; 5] {
    [(PI * y).sin().powi(2), 0.0, 0.0, 0.0, 0.0]
}

#[test]
fn waves_along_layers_of_different_spacing_are_second_order() {
    // Length of one period along a row, between 1 and 2.
    let length = |y: f64| 1.0 + (PI * y).sin().powi(2);
    let time = 0.9;
    let errors = [16, 32, 64, 128].map(|cells: usize| {
        let (count, width) = (cells * cells, 1.0 / cells as f64);
        let layer_centre = |layer: usize| (layer as f64 + 0.5) * width;
        let spacing: Vec<f64> =
            (0..cells).map(|layer| length(layer_centre(layer)) * width).collect();
        let metric = build_straight_metric(spacing);
        let grid = Grid { cells: [cells; 2], spacing: [width; 2] };
        let medium = Medium::new(isotropic(Theory::Classical, 1.0), 2);
        let steps = (time / stable_time_step(&grid, &metric, &medium)).ceil();
        let boundaries = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
        let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
        let problem = Problem {
            metric: Some(metric),
            ..Problem::new(grid, vec![medium], vec![0; count], boundaries, time / steps, scheme)
        };
        let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
        let phase = |cell: usize| TAU * (cell % cells) as f64 * width;
        let value = |cell: usize| initial_fields(layer_centre(cell / cells))[0] * phase(cell).cos();
        domain.set_field(SolidField::Velocity(0), &(0..count).map(value).collect::<Vec<_>>());
        let before = domain.energy().total();
        (0..steps as usize).for_each(|_| domain.advance());
        assert!(domain.energy().total() <= before * (1.0 + 1e-14));
        let layer_centres: Vec<f64> = (0..cells).map(layer_centre).collect();
        let exact = solve_by_collocation(length, time, &layer_centres);
        let (mut error, mut size) = (0.0, 0.0);
        for (index, field) in PLANE_STRAIN_FIELDS.into_iter().enumerate() {
            let found = domain.values(field).expect("a field");
            for (cell, found) in found.into_iter().enumerate() {
                let phase_factor = Complex64::from_polar(1.0, phase(cell));
                let exact = (exact[cell / cells][index] * phase_factor).re;
                error += (found - exact) * (found - exact);
                size += exact * exact;
            }
        }
        (error / size).sqrt()
    });
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1]).log2() > 1.9, "{errors:?}");
    }
}

#[test]
fn invalid_metrics_are_refused() {
    let (grid, metric) = build_polar_grid([24, 10]);
    let medium = Medium::new(isotropic(Theory::Classical, 1.0), 2);
    let boundaries = || std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    let step = stable_time_step(&grid, &metric, &medium);
    let plain = Problem::new(grid, vec![medium.clone()], vec![0; 240], boundaries(), step, scheme);
    let refused = |metric: &Metric, change: &dyn Fn(&mut Problem<2>)| {
        let mut problem = Problem { metric: Some(metric.clone()), ..plain.clone() };
        change(&mut problem);
        matches!(Domain::<f64, 2>::new(&problem), Err(DomainError::Metric(_)))
    };
    assert!(!refused(&metric, &|_| ()));
    let mut short = metric.clone();
    short.spacing.pop();
    assert!(refused(&short, &|_| ()));
    let mut none = metric.clone();
    none.spacing[3] = 0.0;
    assert!(refused(&none, &|_| ()));
    assert!(refused(&metric, &|problem| problem.scheme.splitting = Splitting::Alternating));
    assert!(refused(&metric, &|problem| problem.acceleration = [0.0, 1.0]));
    assert!(refused(&metric, &|problem| {
        problem.initial_stress = Some((1, vec![Stress::default(); 10]));
    }));
    assert!(refused(&metric, &|problem| {
        problem.boundaries[1] = [Boundary::Periodic, Boundary::Periodic];
    }));
    let mut negative = metric.clone();
    negative.field_factors[4] = -1.0;
    assert!(refused(&negative, &|_| ()));
    // Layers must remain normal to the second axis.
    let polar = Problem { metric: Some(metric.clone()), ..plain.clone() };
    let decomposed = DecomposedDomain::<f64, 2>::with_first_axis(1, &polar, 1).err();
    assert!(matches!(decomposed, Some(DomainError::Metric(_))));
    let reference = Reference::<f64, 2>::with_first_axis(1, &polar).err();
    assert!(matches!(reference, Some(DomainError::Metric(_))));
    // The spacing of the innermost layer limits the step.
    let mut long = Problem { metric: Some(metric.clone()), ..plain.clone() };
    long.step *= 1.2;
    assert!(matches!(Domain::<f64, 2>::new(&long), Err(DomainError::Courant { axis: 0, .. })));
}
