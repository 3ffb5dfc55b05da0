//! Sweeps of one pair of fields along a line: exact steps, order, reflection, energy, symmetry.

use crate::support::random::CongruentialGenerator;
use models::solid::parameters::Isotropic;
use std::f64::consts::PI;
use wellposed_dynamics::line::{CellConstants, GHOSTS, Slopes, SweepAccount, energy, sweep};

const ALL_SLOPES: [Slopes; 3] = [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder];

#[derive(Clone)]
struct PeriodicLine {
    velocity: Vec<f64>,
    stress: Vec<f64>,
    cells: Vec<CellConstants<f64>>,
}

impl PeriodicLine {
    fn new(inner: usize, cell_values: impl Fn(usize) -> (f64, f64, CellConstants<f64>)) -> Self {
        let length = inner + 2 * GHOSTS;
        // Ghosts are periodic initially.
        let periodic_index = |i: usize| (i + inner - GHOSTS) % inner;
        let values: Vec<_> = (0..length).map(|i| cell_values(periodic_index(i))).collect();
        Self {
            velocity: values.iter().map(|a| a.0).collect(),
            stress: values.iter().map(|a| a.1).collect(),
            cells: values.iter().map(|a| a.2).collect(),
        }
    }

    fn interior(&self) -> std::ops::Range<usize> {
        GHOSTS..self.cells.len() - GHOSTS
    }

    fn make_periodic(&mut self) {
        let inner = self.interior().len();
        for i in 0..GHOSTS {
            for field in [&mut self.velocity, &mut self.stress] {
                field[i] = field[i + inner];
                field[GHOSTS + inner + i] = field[GHOSTS + i];
            }
        }
    }

    fn advance(&mut self, slopes: Slopes, account: Option<&mut SweepAccount>) {
        let mut cells = vec![SweepAccount::default(); self.interior().len()];
        let accounts = account.is_some().then_some(cells.as_mut_slice());
        sweep(&mut self.velocity, &mut self.stress, &self.cells, slopes, accounts);
        if let Some(account) = account {
            *account = cells.iter().sum();
        }
    }

    fn energy(&self) -> f64 {
        energy(&self.velocity, &self.stress, &self.cells)
    }
}

#[test]
fn at_courant_number_one_waves_move_by_a_cell() {
    let mut random = CongruentialGenerator::new(1);
    let z = 2.5;
    for slopes in ALL_SLOPES {
        let invariants: Vec<[f64; 2]> =
            (0..20).map(|_| [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]).collect();
        // Right-going invariant s − zv, left-going invariant s + zv.
        let cell_values = |i: usize| {
            let [right, left] = invariants[i];
            ((left - right) / (2.0 * z), 0.5 * (left + right), CellConstants::new(z, 1.0))
        };
        let mut line = PeriodicLine::new(20, cell_values);
        for _ in 0..7 {
            line.make_periodic();
            line.advance(slopes, None);
        }
        for (i, place) in line.interior().enumerate() {
            let (v, s) = (line.velocity[place], line.stress[place]);
            assert!((s - z * v - invariants[(i + 20 - 7) % 20][0]).abs() < 1e-14);
            assert!((s + z * v - invariants[(i + 7) % 20][1]).abs() < 1e-14);
        }
    }
}

/// Computes the mean errors of velocity and stress of periodic waves at the time 0.83 on `count` cells, and returns the
/// larger one.
fn wave_error(count: usize, slopes: Slopes) -> f64 {
    let (z, c, courant) = (1.7, 1.3, 0.62);
    let h = 1.0 / count as f64;
    let steps = (0.83 * c / (courant * h)).round();
    let courant = 0.83 * c / (h * steps);
    // Cell means of right- and left-going waves by three-point Gauss quadrature.
    let mean = |f: &dyn Fn(f64) -> f64, i: usize, shift: f64| {
        let shifted_value = |x: f64| f(h * i as f64 + x * h - shift);
        let (low, high) = (0.5 - 0.15f64.sqrt(), 0.5 + 0.15f64.sqrt());
        (5.0 * shifted_value(low) + 8.0 * shifted_value(0.5) + 5.0 * shifted_value(high)) / 18.0
    };
    let right = |x: f64| (2.0 * PI * x).sin();
    let left = |x: f64| (2.0 * PI * x + 0.4).cos() + 0.3 * (4.0 * PI * x).sin();
    let exact = |i: usize, time: f64| {
        let (r, l) = (mean(&right, i, c * time), mean(&left, i, -c * time));
        [(l - r) / (2.0 * z), 0.5 * (l + r)]
    };
    let mut line = PeriodicLine::new(count, |i| {
        let [v, s] = exact(i, 0.0);
        (v, s, CellConstants::new(z, courant))
    });
    for _ in 0..steps as usize {
        line.make_periodic();
        line.advance(slopes, None);
    }
    let mut sums = [0.0; 2];
    for (i, place) in line.interior().enumerate() {
        let [v, s] = exact(i, 0.83);
        sums[0] += (line.velocity[place] - v).abs() * h;
        sums[1] += (line.stress[place] - s).abs() * h;
    }
    sums[0].max(sums[1])
}

#[test]
fn all_slopes_converge_at_their_orders() {
    for (slopes, least, most) in
        [(Slopes::Godunov, 0.9, 1.1), (Slopes::Limited, 1.95, 2.6), (Slopes::FourthOrder, 3.9, 4.1)]
    {
        let errors: Vec<f64> = [64, 128, 256, 512].map(|n| wave_error(n, slopes)).to_vec();
        let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
        println!("{slopes:?}: errors {errors:?}, orders {orders:.3?}");
        assert!((least..most).contains(&orders[2]), "{slopes:?} {orders:?}");
    }
}

/// Verifies that fourth-order sweeps advect cell means of a cubic exactly.
#[test]
fn fourth_order_sweeps_advect_cubics_exactly() {
    let mut random = CongruentialGenerator::new(6);
    for _ in 0..100 {
        let (z, courant) = (random.uniform(0.1, 5.0), random.uniform(0.0, 1.0));
        let powers: [f64; 4] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
        // Integral over the cell [i, i + 1].
        let mean = |i: f64| -> f64 {
            let integral = |x: f64| -> f64 {
                (0..4i32).map(|n| powers[n as usize] * x.powi(n + 1) / f64::from(n + 1)).sum()
            };
            integral(i + 1.0) - integral(i)
        };
        for sign in [-1.0, 1.0] {
            let mut line = PeriodicLine::new(9, |_| (0.0, 0.0, CellConstants::new(z, courant)));
            for i in 0..line.cells.len() {
                // Invariant s − zv for the sign −1, s + zv for the sign 1.
                let wave = mean(i as f64 - 6.0);
                line.stress[i] = 0.5 * wave;
                line.velocity[i] = sign * 0.5 * wave / z;
            }
            line.advance(Slopes::FourthOrder, None);
            for i in line.interior() {
                let expected = mean(i as f64 - 6.0 + sign * courant);
                let found = line.stress[i] + sign * z * line.velocity[i];
                assert!((found - expected).abs() < 1e-12, "{courant} {found} {expected}");
            }
        }
    }
}

/// Verifies that a step overshoots by 10 to 20 % at fourth order, and not at all with limited slopes.
#[test]
fn only_fourth_order_slopes_overshoot_at_steps() {
    for courant in [0.2, 0.52, 0.9] {
        let [linear, limited] = [Slopes::FourthOrder, Slopes::Limited].map(|slopes| {
            let mut line = PeriodicLine::new(200, |i| {
                let wave = f64::from(u8::from((50..100).contains(&i)));
                (-0.5 * wave, 0.5 * wave, CellConstants::new(1.0, courant))
            });
            for _ in 0..60 {
                line.make_periodic();
                line.advance(slopes, None);
            }
            line.interior().map(|i| line.stress[i] - line.velocity[i]).fold(0.0, f64::max) - 1.0
        });
        println!("Courant number {courant}: {linear:.3}, {limited:e}");
        assert!((0.1..0.2).contains(&linear) && limited.abs() < 1e-14);
    }
}

/// Verifies a wave that meets another medium: the stresses of the reflected and transmitted waves relative to the
/// incident one are s_r/s_i = (z₂ − z₁)/(z₂ + z₁) and s_t/s_i = 2z₂/(z₂ + z₁), with the impedances z₁ and z₂; exact at
/// Courant number 1 in both media.
#[test]
fn reflection_and_transmission_are_exact_at_courant_number_one() {
    let solids = [(1.0, 1.0, 1.0), (3.0, 2.0, 0.7)];
    let solids = solids.map(|(lambda, mu, rho)| Isotropic::new(lambda, mu, rho, None).unwrap());
    let pairs = solids.map(|solid| solid.pairs(2, 0).swap_remove(0));
    let z = pairs.each_ref().map(|pair| pair.impedance());
    for slopes in ALL_SLOPES {
        let pulse = |i: usize| if (20..25).contains(&i) { 1.0 + 0.1 * i as f64 } else { 0.0 };
        let mut line = PeriodicLine::new(100, |i| {
            let impedance = z[usize::from(i >= 50)];
            // Right-going wave: v = −s/z.
            (-pulse(i) / impedance, pulse(i), CellConstants::new(impedance, 1.0))
        });
        for _ in 0..40 {
            line.advance(slopes, None);
        }
        let reflected = (z[1] - z[0]) / (z[1] + z[0]);
        let transmitted = 2.0 * z[1] / (z[1] + z[0]);
        for (i, place) in line.interior().enumerate() {
            let expected = if i < 50 {
                // Image of the cell in the interface between the cells 49 and 50, moved back by 40 steps of one cell.
                let source = 99 - i as i64 - 40;
                reflected * usize::try_from(source).map_or(0.0, pulse)
            } else {
                transmitted * pulse(i - 40)
            };
            // One rounding error of stresses up to 5 in each of 40 steps.
            let rounding = 40.0 * 5.0 * f64::EPSILON;
            assert!((line.stress[place] - expected).abs() < rounding, "{slopes:?} {i}");
        }
    }
}

fn random_line(random: &mut CongruentialGenerator, count: usize) -> PeriodicLine {
    let cell_values: Vec<(f64, f64, CellConstants<f64>)> = (0..count)
        .map(|_| {
            let cell = CellConstants::new(random.uniform(0.1, 5.0), random.uniform(0.05, 1.0));
            (random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), cell)
        })
        .collect();
    PeriodicLine::new(count, |i| cell_values[i])
}

/// Verifies that the energy of the cells changes by inflow minus dissipation, with a different medium in every cell and
/// work at both ends.
#[test]
fn energy_account_closes() {
    let mut random = CongruentialGenerator::new(3);
    for slopes in ALL_SLOPES {
        let mut max_residual = 0.0f64;
        for _ in 0..500 {
            let mut line = random_line(&mut random, 30);
            // Random ghosts, so that energy flows through the ends.
            for i in (0..GHOSTS).chain(30 + GHOSTS..30 + 2 * GHOSTS) {
                line.velocity[i] = random.uniform(-1.0, 1.0);
                line.stress[i] = random.uniform(-1.0, 1.0);
            }
            let before = line.energy();
            let mut account = SweepAccount::default();
            line.advance(slopes, Some(&mut account));
            let change = line.energy() - before;
            let residual = change - account.boundary_work + account.dissipation;
            max_residual = max_residual.max((residual / before).abs());
        }
        println!("{slopes:?} {max_residual:e}");
        assert!(max_residual < 1e-14);
    }
}

/// Verifies that an impedance error of one percent in one cell leaves a residual in the energy account.
#[test]
fn energy_account_detects_a_wrong_impedance() {
    let mut random = CongruentialGenerator::new(4);
    let mut line = random_line(&mut random, 30);
    let before = line.energy();
    let right = line.cells.clone();
    let cell = line.cells[15];
    line.cells[15] = CellConstants::new(1.01 * cell.impedance, cell.courant());
    let mut account = SweepAccount::default();
    line.advance(Slopes::Limited, Some(&mut account));
    line.cells = right;
    let residual = line.energy() - before - account.boundary_work + account.dissipation;
    assert!((residual / before).abs() > 1e-6);
}

/// Verifies that energy does not grow without work at the ends, in any medium.
#[test]
fn energy_does_not_grow() {
    let mut random = CongruentialGenerator::new(5);
    for slopes in ALL_SLOPES {
        for _ in 0..200 {
            let mut line = random_line(&mut random, 40);
            let start = line.energy();
            let mut max_energy = start;
            for _ in 0..200 {
                line.make_periodic();
                line.advance(slopes, None);
                max_energy = max_energy.max(line.energy());
            }
            assert!(max_energy <= start * (1.0 + 1e-13), "{slopes:?} {}", max_energy / start);
        }
    }
}

/// Verifies that with the limiter the updated invariant lies between the old values of the cell and its upwind
/// neighbour.
#[test]
fn limited_slopes_create_no_new_extrema() {
    let mut random = CongruentialGenerator::new(8);
    let mut overshoot_count = 0;
    for _ in 0..300 {
        let (z, courant) = (random.uniform(0.1, 5.0), random.uniform(0.0, 1.0));
        // Only a right-going wave: rough, smooth or piecewise constant.
        let kind = random.uniform(0.0, 3.0);
        let w: Vec<f64> = (0..40)
            .map(|i| match kind {
                0.0..1.0 => random.uniform(-1.0, 1.0),
                1.0..2.0 => (0.4 * f64::from(i)).sin(),
                _ => f64::from(u8::from(i % 13 < 4)),
            })
            .collect();
        let mut line = PeriodicLine::new(40, |i| {
            (-0.5 * w[i] / z, 0.5 * w[i], CellConstants::new(z, courant))
        });
        let mut unlimited = line.clone();
        line.advance(Slopes::Limited, None);
        unlimited.advance(Slopes::FourthOrder, None);
        for (i, place) in line.interior().enumerate() {
            let wave = |line: &PeriodicLine| line.stress[place] - z * line.velocity[place];
            let (old_value, upwind) = (w[i], w[(i + 39) % 40]);
            let allowed_range = old_value.min(upwind) - 1e-14..=old_value.max(upwind) + 1e-14;
            assert!(
                allowed_range.contains(&wave(&line)),
                "{courant} {old_value} {upwind} {}",
                wave(&line)
            );
            overshoot_count += usize::from(!allowed_range.contains(&wave(&unlimited)));
        }
    }
    // Without the limiter many updated values lie outside this interval.
    assert!(overshoot_count > 1000, "{overshoot_count}");
}

/// Verifies the decay of waves as short as 2 to 4 cells in first-order sweeps. The amplification factor of the
/// right-going wave is 1 − C(1 − exp(−iθ)), with the Courant number C and the phase θ per cell.
#[test]
fn grid_scale_wave_decays_by_the_amplification_factor() {
    for (waves, count, courant) in [(4, 16, 0.3), (7, 16, 0.7), (8, 16, 0.9)] {
        let angle = 2.0 * PI * f64::from(waves) / f64::from(count);
        let z = 1.0;
        let mut line = PeriodicLine::new(count as usize, |i| {
            let s = (angle * i as f64).cos();
            (-s / z, s, CellConstants::new(z, courant))
        });
        let start = line.energy();
        for _ in 0..10 {
            line.make_periodic();
            line.advance(Slopes::Godunov, None);
        }
        let factor = 1.0 - 2.0 * courant * (1.0 - courant) * (1.0 - angle.cos());
        let found = line.energy() / start;
        assert!((found / factor.powi(10) - 1.0).abs() < 1e-12, "{found} {factor}");
    }
}

#[test]
fn mirrored_states_give_mirrored_bits() {
    let mut random = CongruentialGenerator::new(6);
    for slopes in ALL_SLOPES {
        let mut line = random_line(&mut random, 33);
        let mut mirrored = line.clone();
        mirrored.velocity = line.velocity.iter().rev().map(|v| -v).collect();
        mirrored.stress.reverse();
        mirrored.cells.reverse();
        for _ in 0..20 {
            line.advance(slopes, None);
            mirrored.advance(slopes, None);
        }
        for index in line.interior() {
            let mirror_index = line.cells.len() - 1 - index;
            assert_eq!(
                line.velocity[index].to_bits(),
                (-mirrored.velocity[mirror_index]).to_bits()
            );
            assert_eq!(line.stress[index].to_bits(), mirrored.stress[mirror_index].to_bits());
        }
    }
}

/// Verifies single precision against double precision, within 1e-4.
#[test]
fn single_precision_agrees_with_double_precision() {
    let mut random = CongruentialGenerator::new(7);
    let mut line = random_line(&mut random, 50);
    let narrow = |list: &[f64]| list.iter().map(|&x| x as f32).collect::<Vec<f32>>();
    let (mut velocity, mut stress) = (narrow(&line.velocity), narrow(&line.stress));
    let cells: Vec<CellConstants<f32>> =
        line.cells.iter().map(|c| CellConstants::new(c.impedance, c.courant())).collect();
    for _ in 0..10 {
        line.advance(Slopes::Limited, None);
        sweep(&mut velocity, &mut stress, &cells, Slopes::Limited, None);
    }
    for place in line.interior() {
        assert!((line.velocity[place] - f64::from(velocity[place])).abs() < 1e-4);
        assert!((line.stress[place] - f64::from(stress[place])).abs() < 1e-4);
    }
}

#[test]
fn lines_without_interior_cells_are_unchanged() {
    for length in 0..=2 * GHOSTS {
        let (mut velocity, mut stress) = (vec![1.0; length], vec![2.0; length]);
        let cells = vec![CellConstants::new(1.0, 0.5); length];
        sweep(&mut velocity, &mut stress, &cells, Slopes::Limited, None);
        assert_eq!((velocity, stress), (vec![1.0; length], vec![2.0; length]));
    }
}
