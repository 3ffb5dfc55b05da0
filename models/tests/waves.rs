//! Comparison of the two formulations of an elastic law, velocity–stress pairs and coefficient matrices; spin rotation,
//! and stored energy.

use crate::support::RandomNumbers;
use crate::support::solids::random_plane_compliances;
use nalgebra::DMatrix;
use wellposed_models::LinearisedSystem;
use wellposed_models::common::rates::RateEquations;
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use wellposed_models::solid::waves::{SolidField, SpinRotation, VelocityStressPair, state_fields};

const THEORIES: [Theory; 3] = [Theory::Classical, Theory::Reduced, Theory::Cosserat];

fn random_solid(random: &mut RandomNumbers, theory: Theory) -> Isotropic {
    let couple = (theory == Theory::Cosserat).then(|| CoupleModuli {
        beta: random.uniform(-0.2, 1.0),
        gamma: random.uniform(0.5, 2.0),
        eta: random.uniform(0.2, 2.0),
    });
    let microrotation = (theory != Theory::Classical).then(|| Microrotation {
        alpha: random.uniform(0.1, 2.0),
        inertia: random.uniform(0.2, 2.0),
        couple,
    });
    let lambda = random.uniform(-0.5, 3.0);
    Isotropic::new(lambda, random.uniform(0.8, 2.0), random.uniform(0.5, 2.0), microrotation)
        .unwrap()
}

/// Linearised equations solved for the rates, U̇ = Σ Bⁱ∂ᵢU + QU, with the names of the unknowns.
struct RateMatrices<const D: usize> {
    names: Vec<String>,
    gradient: [DMatrix<f64>; D],
    source: DMatrix<f64>,
}

fn rate_matrices<const D: usize>(equations: &RateEquations<D>) -> RateMatrices<D> {
    let mut system = LinearisedSystem::default();
    equations.linearise(&mut system);
    let solved = |matrix: &wellposed_models::common::system::RoundedMatrix| {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
            -matrix[(i, j)].value / system.a[(i, i)].value
        })
    };
    RateMatrices {
        names: system.unknowns.iter().map(|u| u.name.to_owned()).collect(),
        gradient: system.b.each_ref().map(solved),
        source: solved(&system.c),
    }
}

fn assert_matrices_close(found: &DMatrix<f64>, expected: &DMatrix<f64>, name: &str) {
    let error = (found - expected).amax() / expected.amax();
    assert!(error < 1e-14, "{name}: {error:e}\n{found:.3}{expected:.3}");
}

fn compare_wave_pairs<const D: usize>(
    equations: &RateEquations<D>,
    pairs: impl Fn(usize) -> Vec<VelocityStressPair>,
    rotation: Option<SpinRotation>,
) {
    let expected = rate_matrices(equations);
    let size = expected.names.len();
    let position_of = |field: SolidField| {
        let name = field.to_string();
        expected.names.iter().position(|own| *own == name)
    };
    let required_position =
        |field: SolidField| position_of(field).unwrap_or_else(|| panic!("no {field}"));
    for axis in 0..D {
        let mut found = DMatrix::zeros(size, size);
        for pair in pairs(axis) {
            let (v, s) = (required_position(pair.velocity), required_position(pair.stress));
            found[(v, s)] += 1.0 / pair.inertia;
            found[(s, v)] += pair.modulus;
            assert!((pair.speed() * pair.impedance() / pair.modulus - 1.0).abs() < 1e-15);
            for (follower, ratio) in &pair.passive_stresses {
                found[(required_position(*follower), v)] += ratio * pair.modulus;
            }
        }
        assert_matrices_close(&found, &expected.gradient[axis], "gradient");
    }
    let mut source = DMatrix::zeros(size, size);
    if let Some(rotation) = rotation {
        // ω̇ = −(frequency/ratio) a, ȧ = frequency · ratio · ω, aₖ = ½(σᵢⱼ − σⱼᵢ), ijk cyclic.
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let [Some(spin), Some(first), Some(second)] =
                [SolidField::Spin(k), SolidField::Stress(i, j), SolidField::Stress(j, i)]
                    .map(position_of)
            else {
                continue;
            };
            source[(spin, first)] -= 0.5 * rotation.frequency / rotation.ratio;
            source[(spin, second)] += 0.5 * rotation.frequency / rotation.ratio;
            source[(first, spin)] += rotation.frequency * rotation.ratio;
            source[(second, spin)] -= rotation.frequency * rotation.ratio;
        }
        assert_matrices_close(&source, &expected.source, "rotation");
    } else {
        assert_eq!(expected.source.amax(), 0.0);
    }
}

/// The velocity–stress pairs and the spin rotation of isotropic solids agree with the matrices of the rate equations.
#[test]
fn wave_pairs_of_isotropic_solids_agree_with_the_rate_matrices() {
    let random = &mut RandomNumbers::new(51);
    for index in 0..300 {
        let theory = THEORIES[index % 3];
        let solid = random_solid(random, theory);
        let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
        let plane = solid.layout::<2>().with_out_of_plane();
        let law = solid.stiffness(plane.all_stresses());
        let equations: RateEquations<2> = plane.rates(&law, solid.density, inertia);
        compare_wave_pairs(&equations, |axis| solid.pairs(2, axis), solid.rotation());
        compare_wave_pairs(&solid.rates::<3>(), |axis| solid.pairs(3, axis), solid.rotation());
    }
}

/// The velocity–stress pairs and the spin rotation of solids by compliances agree with the matrices of the rate
/// equations.
#[test]
fn wave_pairs_from_compliances_agree_with_the_rate_matrices() {
    let random = &mut RandomNumbers::new(52);
    for _ in 0..100 {
        let solid = random_plane_compliances(random, 0.9);
        compare_wave_pairs(&solid.rates(), |axis| solid.pairs(axis), Some(solid.rotation()));
    }
}

/// The state components have the names of the unknowns of the rate equations.
#[test]
fn state_fields_have_the_names_of_the_unknowns() {
    let random = &mut RandomNumbers::new(53);
    for theory in THEORIES {
        let solid = random_solid(random, theory);
        let sorted = |mut names: Vec<String>| {
            names.sort();
            names
        };
        for dimensions in [2, 3] {
            let own: Vec<String> =
                state_fields(theory, dimensions).iter().map(ToString::to_string).collect();
            let unknowns = match dimensions {
                2 => solid.layout::<2>().with_out_of_plane().unknowns(),
                _ => solid.layout::<3>().unknowns(),
            };
            let names = unknowns.iter().map(|u| u.name.to_owned()).collect();
            assert_eq!(sorted(own), sorted(names), "{theory:?} {dimensions}");
        }
    }
}

/// The spin rotation of spin ω and antisymmetric stress a agrees with a Runge–Kutta solution of its equations and
/// conserves the energy ½jω² + ½a²/α.
#[test]
fn spin_rotation_agrees_with_runge_kutta_integration() {
    let random = &mut RandomNumbers::new(54);
    for _ in 0..200 {
        let solid = random_solid(random, Theory::Reduced);
        let (rotation, own) = (solid.rotation().unwrap(), solid.microrotation.unwrap());
        let state = [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
        let duration = random.uniform(0.0, 3.0);
        let found = rotation.advance(state, duration);
        // Reference: ω̇ = −2a/j, ȧ = 2αω integrated by the classical Runge–Kutta method.
        let steps = 2000;
        let h = duration / f64::from(steps);
        let rate = |[w, a]: [f64; 2]| [-2.0 * a / own.inertia, 2.0 * own.alpha * w];
        let mut expected = state;
        for _ in 0..steps {
            let at = |k: [f64; 2], f: f64| [expected[0] + f * k[0], expected[1] + f * k[1]];
            let k1 = rate(expected);
            let k2 = rate(at(k1, 0.5 * h));
            let k3 = rate(at(k2, 0.5 * h));
            let k4 = rate(at(k3, h));
            for i in 0..2 {
                expected[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        let energy = |[w, a]: [f64; 2]| 0.5 * own.inertia * w * w + 0.5 * a * a / own.alpha;
        assert!((energy(found) / energy(state) - 1.0).abs() < 1e-14);
        for i in 0..2 {
            assert!((found[i] - expected[i]).abs() < 1e-9, "{found:?} {expected:?}");
        }
    }
}

/// The stored energy of a stress s equals ½ s·D⁻¹s with the stiffness matrix D.
#[test]
fn stored_energy_agrees_with_hookes_law() {
    let random = &mut RandomNumbers::new(55);
    for index in 0..300 {
        let theory = THEORIES[index % 3];
        let solid = random_solid(random, theory);
        let components: Vec<_> = solid.layout::<3>().all_stresses().collect();
        let stiffness = solid.stiffness(components.iter().copied()).map(|entry| entry.value);
        let values = nalgebra::DVector::from_fn(components.len(), |_, _| random.uniform(-1.0, 1.0));
        let mut stress = wellposed_models::solid::stress::Stress::default();
        for (component, value) in components.iter().zip(values.iter()) {
            component.set(&mut stress, *value);
        }
        let strain = stiffness.cholesky().expect("positive definite").solve(&values);
        let expected = 0.5 * values.dot(&strain);
        assert!((solid.stored_energy(&stress) / expected - 1.0).abs() < 1e-12, "{theory:?}");
    }
}
