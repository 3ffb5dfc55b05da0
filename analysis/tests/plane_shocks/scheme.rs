//! Exact profiles against a first-order scheme that knows neither waves nor the majorant: Rusanov fluxes of the system
//! ρv̇ + ∂ₓp = 0, ε̇ + ∂ₓv = 0 with one speed for all faces, which converges to the limit of vanishing viscosity.

use super::media::{FOAM_YIELD_STRESS, aluminium_foam, diagram, random_diagram, sand, strong_foam};
use models::uniaxial::UniaxialDiagram;
use testkit::random::RandomNumbers;
use wellposed_analysis::plane_shocks::{PistonLoad, PistonSolution};

/// Half-space divided into cells, behind a piston at x = 0.
pub struct Scheme<'a> {
    pub diagram: &'a UniaxialDiagram,
    pub density: f64,
    pub spacing: f64,
    pub strain: Vec<f64>,
    pub velocity: Vec<f64>,
    /// Greatest speed of sound, the viscosity of all faces.
    pub speed: f64,
}

impl<'a> Scheme<'a> {
    pub fn new(
        diagram: &'a UniaxialDiagram,
        density: f64,
        initial_strain: f64,
        [spacing, length]: [f64; 2],
    ) -> Self {
        let count = (length / spacing).ceil() as usize;
        let stiffness = diagram.segments().iter().map(|own| own.slope).fold(0.0, f64::max);
        Self {
            diagram,
            density,
            spacing,
            strain: vec![initial_strain; count],
            velocity: vec![0.0; count],
            speed: (stiffness / density).sqrt(),
        }
    }

    /// Advances by `time` with a load at the piston.
    pub fn advance(&mut self, time: f64, load: PistonLoad) {
        let count = (time / (0.9 * self.spacing / self.speed)).ceil();
        let step = time / count;
        for _ in 0..count as usize {
            self.step(step, load);
        }
    }

    fn step(&mut self, time_step: f64, load: PistonLoad) {
        let (rho, a) = (self.density, self.speed);
        let pressures: Vec<f64> = self.strain.iter().map(|&e| self.diagram.pressure(e)).collect();
        let mut left = match load {
            PistonLoad::Pressure(p) => [p, self.velocity[0] + (p - pressures[0]) / (rho * a)],
            PistonLoad::Speed(v) => [pressures[0] + rho * a * (v - self.velocity[0]), v],
        };
        let ratio = time_step / self.spacing;
        let count = self.strain.len();
        for i in 0..count {
            let right = match i + 1 < count {
                true => [
                    0.5 * (pressures[i] + pressures[i + 1])
                        + 0.5 * rho * a * (self.velocity[i] - self.velocity[i + 1]),
                    0.5 * (self.velocity[i] + self.velocity[i + 1])
                        + 0.5 * a * (self.strain[i] - self.strain[i + 1]),
                ],
                false => [pressures[i], self.velocity[i]],
            };
            // The velocities of both faces use the old values: the update of this cell is last.
            let (dp, dv) = (right[0] - left[0], right[1] - left[1]);
            left = right;
            self.strain[i] -= ratio * dv;
            self.velocity[i] -= ratio * dp / rho;
        }
    }
}

/// L1 error of the velocity, relative to the exact momentum, on a grid of `cells` cells up to the fastest front.
fn velocity_error(
    diagram: &UniaxialDiagram,
    density: f64,
    initial_strain: f64,
    load: PistonLoad,
    cells: usize,
) -> f64 {
    let exact = PistonSolution::new(diagram, density, initial_strain, load).unwrap();
    let time = 1.0 / exact.waves[0].speed;
    let spacing = 1.0 / cells as f64;
    let mut scheme = Scheme::new(diagram, density, initial_strain, [spacing, 1.6]);
    scheme.advance(time, load);
    let profile = exact.profile(time);
    let mut error = 0.0;
    let mut total = 0.0;
    for (i, &found) in scheme.velocity.iter().enumerate() {
        let x = (i as f64 + 0.5) * spacing;
        let piece = profile.pieces.iter().find(|own| x < own.range[1]).unwrap();
        error += (found - piece.state.velocity).abs();
        total += piece.state.velocity;
    }
    error / total
}

/// Asserts that the error falls by 40 % or more when the grid is refined fourfold (linear waves: by half, shocks: to a
/// quarter), and is
/// small on the finer grid.
fn assert_converges(
    name: &str,
    diagram: &UniaxialDiagram,
    [density, initial_strain]: [f64; 2],
    load: PistonLoad,
) {
    let error = |cells| velocity_error(diagram, density, initial_strain, load, cells);
    let [coarse, fine] = [error(200), error(800)];
    assert!(fine < 0.6 * coarse && fine < 0.06, "{name}: {coarse:e} {fine:e}");
}

#[test]
fn random_diagrams_agree_with_the_scheme() {
    let mut random = RandomNumbers::new(21);
    for index in 0..40 {
        let diagram = random_diagram(&mut random, 1 + index % 5);
        let top = diagram.corners().last().unwrap().pressure;
        let load = match index % 2 {
            0 => PistonLoad::Pressure(random.uniform(0.3, 1.4) * top.max(0.1)),
            _ => PistonLoad::Speed(random.uniform(0.2, 2.0)),
        };
        assert_converges(&format!("random {index}"), &diagram, [1.3, 0.0], load);
    }
}

#[test]
fn media_agree_with_the_scheme() {
    for (porosity, factor) in [(0.001, 5.0), (0.01, 25.0), (0.05, 75.0), (0.05, 125.0)] {
        let own = aluminium_foam(porosity);
        let load = PistonLoad::Pressure(factor * FOAM_YIELD_STRESS);
        assert_converges("aluminium", &diagram(own), [own.density, 0.0], load);
    }
    for pressure in [1e8, 3e8] {
        let own = strong_foam();
        let load = PistonLoad::Pressure(pressure);
        assert_converges("strong", &diagram(own), [own.density, 0.0], load);
    }
    let diagram = sand().loading_diagram();
    assert_converges("sand", &diagram, [1800.0, -0.002], PistonLoad::Speed(4.0));
}
