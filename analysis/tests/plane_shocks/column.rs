//! Granular columns: compaction of a loosened column, spall at a free end.

use super::media::{assert_close, sand};
use wellposed_analysis::plane_shocks::column::{CompactionShock, PulseShape, Spall};
use wellposed_analysis::plane_shocks::{PistonLoad, PistonSolution, WaveKind};

const DENSITY: f64 = 1800.0;

/// Modulus E_c of the sand, Pa.
fn modulus() -> f64 {
    sand().loading_diagram().segments()[1].slope
}

#[test]
fn compaction_shock_is_the_general_solution_of_the_loosened_column() {
    let diagram = sand().loading_diagram();
    for (loosening, speed) in [(1e-6, 1.0), (1e-3, 1.0), (0.02, 3.0), (0.3, 0.1), (0.0, 2.0)] {
        let own = CompactionShock::new(DENSITY, modulus(), loosening, speed).unwrap();
        let load = PistonLoad::Speed(speed);
        let general = PistonSolution::new(&diagram, DENSITY, -loosening, load).unwrap();
        let [wave] = general.waves[..] else { panic!("{general:?}") };
        let kind = if loosening > 0.0 { WaveKind::Compaction } else { WaveKind::Elastic };
        assert_eq!(wave.kind, kind);
        // The strain behind loses the digits of p/E beside ε₀.
        let tolerance = 1e-12 * (1.0 + loosening * modulus() / own.pressure);
        assert_close(own.speed, wave.speed, tolerance);
        assert_close(own.pressure, wave.behind.pressure, 1e-9);
        assert!((own.dissipation - wave.dissipation).abs() <= 1e-9 * own.dissipation.max(1e-300));
        // D² = p/[ρ(ε₀ + p/E)].
        let square = own.pressure / (DENSITY * (loosening + own.pressure / modulus()));
        assert_close(own.speed * own.speed, square, 1e-12);
    }
}

/// Limits: D → c for a closed column, D → v_p/ε₀ (snow plough) for a loose one.
#[test]
fn compaction_shock_tends_to_sound_and_to_the_snow_plough() {
    let sound = (modulus() / DENSITY).sqrt();
    assert_close(sound, 1219.87, 1e-5);
    let tight = CompactionShock::new(DENSITY, modulus(), 1e-12, 5.0).unwrap();
    assert_close(tight.speed, sound, 1e-9);
    let loose = CompactionShock::new(DENSITY, modulus(), 0.2, 1e-3).unwrap();
    assert_close(loose.speed, 1e-3 / 0.2, 1e-9);
    assert!(CompactionShock::new(DENSITY, modulus(), -0.1, 1.0).is_err());
    assert!(CompactionShock::new(DENSITY, modulus(), 0.1, 0.0).is_err());
}

/// Column of particles of the spacing h with unilateral springs, at Courant number 1: exact for linear waves. Index 0 is
/// the free end; the pulse runs towards it.
struct Particles {
    velocity: Vec<f64>,
    strain: Vec<f64>,
    sound: f64,
}

impl Particles {
    /// Places the pulse with its front at the free end.
    fn new(spall: &Spall, spacing: f64, count: usize) -> Self {
        let sound = spall.sound_speed();
        // Springs lie between particles, half a step later in time.
        let pulse = |position: f64| spall.pulse_velocity(position / sound);
        Self {
            velocity: (0..count).map(|i| pulse((i as f64 + 0.5) * spacing)).collect(),
            strain: (0..count).map(|i| pulse((i as f64 + 0.5) * spacing) / sound).collect(),
            sound,
        }
    }

    /// Advances by one step h/c. `strain[i]` is the spring between the particles i and i + 1; positive in compression,
    /// and velocities point to the end, so that a spring shortens when the farther particle is faster.
    fn step(&mut self) {
        let c = self.sound;
        let traction = |strain: f64| strain.max(0.0);
        for i in 0..self.velocity.len() {
            let near = if i == 0 { 0.0 } else { traction(self.strain[i - 1]) };
            self.velocity[i] += c * (traction(self.strain[i]) - near);
        }
        for i in 0..self.strain.len() - 1 {
            self.strain[i] += (self.velocity[i + 1] - self.velocity[i]) / c;
        }
    }
}

fn assert_spall_agrees_with_particles(shape: PulseShape) {
    let spall = Spall::new(DENSITY, modulus(), 2.0, 1e-3, shape).unwrap();
    let errors = [200, 800].map(|cells: usize| {
        let spacing = spall.thickness() / cells as f64;
        let mut particles = Particles::new(&spall, spacing, 6 * cells);
        let steps = 3 * cells;
        for _ in 0..steps {
            particles.step();
        }
        let time = steps as f64 * spacing / spall.sound_speed();
        let state = |i: usize| spall.state((i as f64 + 0.5) * spacing, time);
        let difference = |i: usize| (particles.velocity[i] - state(i).velocity).abs();
        let velocity = (0..3 * cells).map(difference).sum::<f64>() / (cells as f64 * 2.0);
        // The springs between the layer and the column hold the gap.
        let extension: f64 =
            (0..3 * cells).map(|i| (-particles.strain[i]).max(0.0) * spacing).sum();
        let exact: f64 = (0..cells).map(|i| (-state(i).strain).max(0.0) * spacing).sum();
        [velocity, (extension / (exact + spall.gap(time)) - 1.0).abs()]
    });
    for (coarse, fine) in errors[0].into_iter().zip(errors[1]) {
        assert!(fine < 0.01 && fine <= 0.5 * coarse.max(1e-12));
    }
}

#[test]
fn spall_agrees_with_a_column_of_particles() {
    assert_spall_agrees_with_particles(PulseShape::Rectangle);
    assert_spall_agrees_with_particles(PulseShape::Triangle);
}

/// The rectangle leaves a layer of thickness ct₀/2 with twice the velocity; momentum and energy of the pulse are in the
/// layer, for both shapes.
#[test]
fn spalled_layer_has_the_momentum_and_energy_of_the_pulse() {
    for shape in [PulseShape::Rectangle, PulseShape::Triangle] {
        let (velocity, duration) = (3.0, 2e-4);
        let own = Spall::new(DENSITY, modulus(), velocity, duration, shape).unwrap();
        let c = own.sound_speed();
        let (momentum, energy) = match shape {
            PulseShape::Rectangle => {
                (DENSITY * c * duration * velocity, DENSITY * c * duration * velocity.powi(2))
            }
            PulseShape::Triangle => (
                0.5 * DENSITY * c * duration * velocity,
                DENSITY * c * duration * velocity.powi(2) / 3.0,
            ),
        };
        // Midpoint rule: exact for the momentum, of second order for the energy of the triangle.
        let count = 20_000;
        let width = own.thickness() / f64::from(count);
        let late = 2.0 * duration;
        let states = (0..count).map(|i| own.state((f64::from(i) + 0.5) * width, late));
        let [mut p, mut e] = [0.0; 2];
        for state in states {
            assert_eq!(state.pressure, 0.0);
            p += DENSITY * state.velocity * width;
            e += 0.5 * DENSITY * state.velocity.powi(2) * width;
        }
        assert_close(p, momentum, 1e-11);
        assert_close(e, energy, 1e-8);
        let behind = own.state(1.01 * own.thickness(), late);
        assert_eq!((behind.velocity, behind.pressure), (0.0, 0.0));
    }
    let rectangle = Spall::new(DENSITY, modulus(), 3.0, 2e-4, PulseShape::Rectangle).unwrap();
    assert_eq!(rectangle.state(0.5 * rectangle.thickness(), 1e-3).velocity, 6.0);
    assert_close(rectangle.gap(3e-4), 6.0 * 2e-4, 1e-12);
    // The triangle extends uniformly, at the rate 4v₀/(ct₀).
    let triangle = Spall::new(DENSITY, modulus(), 3.0, 2e-4, PulseShape::Triangle).unwrap();
    let c = triangle.sound_speed();
    let d = 0.3 * triangle.thickness();
    let rate = (triangle.state(d, 3e-4).strain - triangle.state(d, 4e-4).strain) / 1e-4;
    assert_close(rate, 4.0 * 3.0 / (c * 2e-4), 1e-10);
}
