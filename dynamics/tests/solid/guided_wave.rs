//! Wave guided by a saturated layer between elastic half-spaces, against its dispersion relation.
//!
//! The wave is symmetric about the layer, x₂ = 0, and proportional to exp(ik(x₁ − ct)). In the upper half-space the
//! potentials are φ = A exp(−kq₁x₂) and ψ = iB exp(−kq₂x₂), q² = 1 − c²/c₁² and 1 − c²/c₂² (Rayleigh 1885). With the
//! displacements u of its surface, its tractions σ, the displacement W of the fluid along the layer, the strain ε across
//! the layer, δε = 2u₂, and D = ∂W/∂x₁, the layer requires
//!
//! ```text
//! δ[(ρ_s + ρ_a)ü₁ − ρ_aẄ] = 2σ₁₂,   (ρ_f + ρ_a)Ẅ − ρ_aü₁ = ∂(b_sε + b_fD)/∂x₁,   σ₂₂ = b₀ε + b_sD.
//! ```
//!
//! For kδ → 0 the half-spaces yield freely and the speed is √[(b_f − b_s²/b₀)/(ρ_f + ρ_a)]; for larger kδ they hold the
//! layer at a constant thickness, and it rises towards √[b_f/(ρ_f + ρ_a)].

use models::interface::history;
use models::interface::parameters::{
    LayerMaterial, MassDistribution, PorousConstants, SaturatedMaterial, ViscousConstants,
};
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::solid::interlayers::{InterlayerLaw, Interlayers};

/// Density of the half-spaces, kg/m³.
const DENSITY: f64 = 2.0;
/// Speeds of P and S waves in the half-spaces, m/s. The fluid alone has half the speed of P waves, so that its flow has
/// Courant number 1 in a step.
const SPEEDS: [f64; 2] = [2.0, 1.2];
/// Wave number k, 1/m: wavelength 1 m.
const WAVE_NUMBER: f64 = TAU;

/// Returns the layer of a thickness, m: ρ_f + ρ_sρ_a/(ρ_s + ρ_a) = b_f s²/m².
fn layer(thickness: f64) -> SaturatedMaterial {
    SaturatedMaterial {
        thickness,
        skeleton_density: 1.0,
        fluid_density: 0.5,
        added_density: 0.25,
        undrained_stiffness: 1.0,
        pores: PorousConstants { collapse_stiffness: 2.0, porosity: 0.5 },
        coupling_stiffness: 0.7,
        fluid_stiffness: 0.7,
        instantaneous_compliance: 1.0,
        viscous: ViscousConstants { delayed_compliance: 1.0, viscosity: 1.0 },
    }
}

/// Guided wave: speed and amplitudes A, B, W/(ik).
struct GuidedWave {
    speed: f64,
    amplitudes: [f64; 3],
    decay: [f64; 2],
}

/// Returns the equations of a wave of speed `c` for its amplitudes, and the decay rates q₁ and q₂.
fn wave_equations(layer: &SaturatedMaterial, c: f64) -> (Matrix3<f64>, [f64; 2]) {
    let k = WAVE_NUMBER;
    let [q1, q2] = SPEEDS.map(|speed| (1.0 - (c / speed).powi(2)).sqrt());
    let (modulus, square) = (DENSITY * SPEEDS[1] * SPEEDS[1], (k * c).powi(2));
    let (delta, added) = (layer.thickness, layer.added_density);
    // Strain across the layer per amplitude, and the combination of amplitudes in u₁ = ik(A − q₂B).
    let strain = [-2.0 * k * q1 / delta, 2.0 * k / delta];
    let tangential = [1.0, -q2];
    let bend = 1.0 + q2 * q2;
    let skeleton = layer.skeleton_density + added;
    let shear = [-2.0 * q1, bend].map(|factor| 2.0 * modulus * k * factor);
    let momentum = [0, 1].map(|i| square * delta * skeleton * tangential[i] + shear[i]);
    let fluid =
        [0, 1].map(|i| square * added * tangential[i] - layer.coupling_stiffness * strain[i]);
    let normal = [bend, -2.0 * q2].map(|factor| modulus * k * k * factor);
    let across = [0, 1].map(|i| normal[i] - layer.undrained_stiffness * strain[i]);
    let matrix = Matrix3::new(
        momentum[0],
        momentum[1],
        -square * delta * added,
        fluid[0],
        fluid[1],
        layer.fluid_stiffness * k * k - square * (layer.fluid_density + added),
        across[0],
        across[1],
        layer.coupling_stiffness * k * k,
    );
    (matrix, [q1, q2])
}

/// Speeds between which that of the guided wave lies, for kδ → 0 and at constant thickness, m/s.
fn speed_limits(layer: &SaturatedMaterial) -> [f64; 2] {
    let density = layer.fluid_density + layer.added_density;
    let soft = layer.fluid_stiffness - layer.coupling_stiffness.powi(2) / layer.undrained_stiffness;
    [soft, layer.fluid_stiffness].map(|stiffness| (stiffness / density).sqrt())
}

/// Finds the guided wave between the two limits of its speed, by bisection.
fn find_guided_wave(layer: &SaturatedMaterial) -> GuidedWave {
    let determinant = |c: f64| wave_equations(layer, c).0.determinant();
    let [mut low, mut high] = speed_limits(layer);
    assert!(determinant(low).signum() != determinant(high).signum());
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match determinant(middle).signum() == determinant(low).signum() {
            true => low = middle,
            false => high = middle,
        }
    }
    let (matrix, decay) = wave_equations(layer, low);
    // Null vector: the last two equations with W/(ik) = 1.
    let block = matrix.fixed_view::<2, 2>(1, 0).into_owned();
    let right = -matrix.fixed_view::<2, 1>(1, 2).into_owned();
    let found = block.lu().solve(&right).expect("independent equations");
    let amplitudes = [found[0], found[1], 1.0];
    let residual = (matrix * Vector3::from(amplitudes)).amax() / matrix.amax();
    assert!(residual < 1e-12, "{residual}");
    // Strains of a few 10⁻³, so that the pores stay open.
    let amplitudes = amplitudes.map(|amplitude| 1e-4 * amplitude);
    GuidedWave { speed: low, amplitudes, decay }
}

impl GuidedWave {
    /// Value of a field at a distance x₂ > 0 above the layer, or below for x₂ < 0, and at the phase k(x₁ − ct).
    fn field(&self, field: SolidField, x2: f64, phase: f64) -> f64 {
        let (k, [q1, q2]) = (WAVE_NUMBER, self.decay);
        let frequency = k * self.speed;
        let a = self.amplitudes[0] * (-k * q1 * x2.abs()).exp();
        let b = self.amplitudes[1] * (-k * q2 * x2.abs()).exp();
        let [longitudinal, shear] = SPEEDS.map(|speed| DENSITY * speed * speed);
        let lambda = longitudinal - 2.0 * shear;
        let dilatation = k * k * (q1 * q1 - 1.0) * a;
        match field {
            SolidField::Velocity(0) => k * frequency * (a - q2 * b) * phase.cos(),
            SolidField::Velocity(1) => k * frequency * (b - q1 * a) * phase.sin() * x2.signum(),
            SolidField::Stress(0, 0) => {
                (lambda * dilatation - 2.0 * shear * k * k * (a - q2 * b)) * phase.cos()
            }
            SolidField::Stress(1, 1) => {
                (lambda * dilatation + 2.0 * shear * k * k * (q1 * q1 * a - q2 * b)) * phase.cos()
            }
            SolidField::Stress(2, 2) => lambda * dilatation * phase.cos(),
            SolidField::Stress(0, 1) => {
                let amplitude = (1.0 + q2 * q2) * b - 2.0 * q1 * a;
                -shear * k * k * amplitude * phase.sin() * x2.signum()
            }
            _ => 0.0,
        }
    }

    /// History variables of a face of the layer at a phase.
    fn face(&self, layer: &SaturatedMaterial, phase: f64) -> Vec<f64> {
        let (k, [q1, _]) = (WAVE_NUMBER, self.decay);
        let [a, b, fluid] = self.amplitudes;
        let mut variables = vec![0.0; history::FLUID_DISSIPATION + 2];
        variables[history::NORMAL_STATE] = 2.0 * k * (b - q1 * a) / layer.thickness * phase.cos();
        variables[history::SHEAR_MOTION] = self.field(SolidField::Velocity(0), 0.0, phase);
        variables[history::FLUID_VELOCITY] = k * k * self.speed * fluid * phase.cos();
        variables[history::FLUID_STRAIN] = -k * k * fluid * phase.cos();
        variables
    }
}

/// Advances the guided wave on `cells` cells per wavelength by about a period; returns the largest errors of the velocity
/// and the strain of the fluid, by their amplitudes.
fn guided_wave_error(layer: &SaturatedMaterial, wave: &GuidedWave, cells: usize) -> [f64; 2] {
    let spacing = 1.0 / cells as f64;
    let half = 3 * cells / 2;
    let [longitudinal, shear] = SPEEDS.map(|speed| DENSITY * speed * speed);
    let solid = Isotropic::new(longitudinal - 2.0 * shear, shear, DENSITY, None);
    let medium = Medium::new(solid.expect("sound moduli"), 2);
    let law = LayerMaterial::Saturated(*layer).check().expect("sound constants");
    let law = InterlayerLaw::Plane(law.to_law(MassDistribution::Box), 1);
    let boundaries = [
        [Boundary::Periodic, Boundary::Periodic],
        [Boundary::NonReflecting, Boundary::NonReflecting],
    ];
    let grid = Grid { cells: [cells, 2 * half], spacing: [spacing; 2] };
    let problem = Problem {
        interlayers: vec![Interlayers::new_regular(1, 2 * half, [half, 2 * half], law)],
        ..Problem::new(
            grid,
            vec![medium],
            vec![0; grid.count()],
            boundaries,
            2.0 * spacing / SPEEDS[0],
            Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping),
        )
    };
    let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
    let phase = |cell: usize, time: f64| {
        WAVE_NUMBER * ((cell % cells) as f64 + 0.5) * spacing - WAVE_NUMBER * wave.speed * time
    };
    let height = |cell: usize| ((cell / cells) as f64 + 0.5 - half as f64) * spacing;
    for field in domain.fields().to_vec() {
        let value = |cell| wave.field(field, height(cell), phase(cell, 0.0));
        domain.set_field(field, &(0..grid.count()).map(value).collect::<Vec<_>>());
    }
    let faces = |time: f64| {
        let columns = problem.interlayer_faces().into_iter();
        columns.flat_map(move |face| wave.face(layer, phase(face.cell, time))).collect::<Vec<_>>()
    };
    domain.set_interlayer_history(&mut faces(0.0).into_iter());
    while domain.time() < 1.0 / wave.speed {
        domain.advance();
    }
    let (found, expected) = (domain.interlayer_history(), faces(domain.time()));
    let count = history::FLUID_DISSIPATION + 2;
    [history::FLUID_VELOCITY, history::FLUID_STRAIN].map(|index| {
        let values =
            |all: &[f64]| all.iter().skip(index).step_by(count).copied().collect::<Vec<_>>();
        let (found, expected) = (values(&found), values(&expected));
        let amplitude = expected.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let differences = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max) / amplitude
    })
}

/// Verifies the speed of the guided wave between its limits, and that the solver propagates the wave at second order.
#[test]
fn wave_guided_by_a_saturated_layer_has_the_speed_of_its_dispersion_relation() {
    let mut speeds = Vec::new();
    for thickness in [0.01, 0.1, 0.3] {
        let layer = layer(thickness);
        let wave = find_guided_wave(&layer);
        let errors = [16, 32, 64].map(|cells| guided_wave_error(&layer, &wave, cells));
        let orders = [0, 1].map(|index| (errors[1][index] / errors[2][index]).log2());
        println!("δ {thickness}: c {}, {errors:?}, {orders:?}", wave.speed);
        assert!(orders.iter().all(|order| (1.7..2.6).contains(order)), "{errors:?} {orders:?}");
        // A phase error of 2π/200 after a period: the speed is within 0.5 %.
        assert!(errors[2].iter().all(|error| *error < TAU / 200.0), "{errors:?}");
        speeds.push(wave.speed);
    }
    let layer = layer(1e-5);
    let [soft, held] = speed_limits(&layer);
    assert!((find_guided_wave(&layer).speed / soft - 1.0).abs() < 1e-3);
    assert!(soft < speeds[0] && speeds[0] < speeds[1] && speeds[1] < speeds[2] && speeds[2] < held);
}
