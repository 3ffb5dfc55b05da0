//! Energy balance, dissipation and symmetry of layers of all kinds under random loads, and equality of SIMD lanes with
//! scalars.

use crate::interface::support::{
    History, MASS_DISTRIBUTIONS, RandomLoad, TwoLanes, face_work, initial_history, layer_materials,
    step_interval,
};
use wellposed_models::common::number::Number;
use wellposed_models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use wellposed_models::interface::{FaceEnergy, FaceLaw, Interval, RiemannData, history, power};

/// Number of time steps of a random load.
const STEP_COUNT: usize = 20_000;
/// Time step.
const TIME_STEP: f64 = 0.21;

/// Dissipated energies of a face: plastic, viscous, released, lost at fracture, and by the flow of the fluid.
fn dissipated_energies(energy: &FaceEnergy<f64>) -> [f64; 5] {
    let FaceEnergy {
        plastic_dissipation,
        viscous_dissipation,
        released_energy,
        fracture_energy,
        fluid_dissipation,
        ..
    } = *energy;
    [plastic_dissipation, viscous_dissipation, released_energy, fracture_energy, fluid_dissipation]
}

/// Sets the sums of dissipated energy to zero, so that those of a single step are exact.
fn clear_sums(law: &LayerLaw<f64>, history: &mut History) {
    let sums: &[usize] = match law {
        LayerLaw::Elastic(_) => &[],
        LayerLaw::Plastic(_) => &[history::PLASTIC_DISSIPATION],
        LayerLaw::Viscous(_) => &[history::VISCOUS_DISSIPATION],
        LayerLaw::Porous(law) => match law.shear {
            wellposed_models::interface::porous::TangentialComponent::Elastic(_) => &[],
            wellposed_models::interface::porous::TangentialComponent::Viscous(_) => {
                &[history::VISCOUS_DISSIPATION]
            }
            wellposed_models::interface::porous::TangentialComponent::Plastic(..) => {
                &[history::PLASTIC_DISSIPATION]
            }
        },
        LayerLaw::Saturated(_) => &[history::VISCOUS_DISSIPATION, history::FLUID_DISSIPATION],
        LayerLaw::Cracked(_) => &[history::PLASTIC_DISSIPATION, history::RELEASED_ENERGY],
        LayerLaw::Breaking(_) => {
            &[history::PLASTIC_DISSIPATION, history::RELEASED_ENERGY, history::FRACTURE_ENERGY]
        }
    };
    for &sum in sums {
        history[sum..sum + 2].fill(0.0);
    }
}

/// In each of 20,000 steps the energy gained and dissipated equals the work of both cells to rounding, and no
/// dissipated energy is negative.
#[test]
fn energy_balance_of_each_step_holds_to_rounding_for_all_kinds() {
    for distribution in MASS_DISTRIBUTIONS {
        for (name, material) in layer_materials() {
            let law = material.check().expect("valid").to_law(distribution);
            let mut load = RandomLoad::new(7);
            let mut history = initial_history(&law, [[0.3, -0.2], [0.1, 0.4]]);
            let (mut worst, mut kinks) = (0.0f64, 0);
            let mut least = f64::INFINITY;
            for number in 0..STEP_COUNT {
                clear_sums(&law, &mut history);
                let incoming = load.next();
                let before = law.energy(&history);
                let old = law.to_face_record(&history);
                let states =
                    law.advance(&incoming, &step_interval(number, TIME_STEP), &mut history);
                let after = law.energy(&history);
                let new = law.to_face_record(&history);
                assert!(history.iter().all(|x| x.is_finite()), "{name}: {history:?}");
                let (work, size) = face_work(&states, &incoming, TIME_STEP);
                let scale = size + before.total() + after.total();
                worst = worst.max((after.total() - before.total() - work).abs() / scale);
                least = dissipated_energies(&after).into_iter().fold(least, f64::min);
                let is_open = |record: f64| record > 0.0;
                kinks += usize::from(
                    is_open(old.opening) != is_open(new.opening)
                        || is_open(old.porosity) != is_open(new.porosity)
                        || new.slip > old.slip && old.slip_time > 0.0,
                );
            }
            println!("{distribution:?}, {name}: {worst:e}, switches or slip in {kinks} steps");
            assert!(worst < 1e-14, "{name}: {worst:e}");
            assert!(least >= 0.0, "{name}: {least:e}");
            let smooth = matches!(law, LayerLaw::Elastic(_) | LayerLaw::Viscous(_));
            assert!(smooth || kinks > 100, "{name}: {kinks}");
        }
    }
}

/// Error of the energy balance summed over 20,000 steps in the number type `N`, relative to the sum of the magnitudes
/// of the work.
fn ledger_error<N: Number>(law: &LayerLaw<f64>, to_f64: impl Fn(N) -> f64) -> f64 {
    let law = law.to_number::<N>();
    let mut load = RandomLoad::new(8);
    let mut history = [N::ZERO; MAX_HISTORY_VARIABLES];
    let (mut work, mut passed) = (0.0, 0.0);
    for number in 0..STEP_COUNT {
        let incoming = load.next().map(|data| RiemannData {
            impedance: data.impedance.map(N::from_f64),
            invariant: data.invariant.map(N::from_f64),
        });
        let Interval { end, step, .. } = step_interval(number, TIME_STEP);
        let interval = Interval::new(N::from_f64(end), N::from_f64(step));
        let states = law.advance(&incoming, &interval, &mut history);
        for states in &states {
            work += TIME_STEP * to_f64(power(states));
            passed += TIME_STEP * to_f64(power(states)).abs();
        }
    }
    (to_f64(law.energy(&history).total()) - work).abs() / passed
}

#[test]
fn ledger_of_many_steps_is_accurate_in_double_and_single_precision() {
    for (name, material) in layer_materials() {
        let law = material.to_law(Default::default());
        let double = ledger_error::<f64>(&law, |x| x);
        let single = ledger_error::<f32>(&law, f64::from);
        println!("{name}: {double:e} in double, {single:e} in single precision");
        assert!(double < 1e-13, "{name}: {double:e}");
        assert!(single < 2e-6, "{name}: {single:e}");
    }
}

/// With the example constants of the registry in SI units, between blocks of rock and with velocities of 0.5 m/s, the
/// summed energy balance is accurate.
#[test]
fn ledger_is_accurate_with_the_constants_of_the_registry() {
    fn relative_error<N: Number>(law: &LayerLaw<f64>, to_f64: impl Fn(N) -> f64) -> f64 {
        let law = law.to_number::<N>();
        let mut load = RandomLoad::new(14);
        let mut history = [N::ZERO; MAX_HISTORY_VARIABLES];
        let (step, impedances) = (1e-6, [2700.0 * 5000.0, 2700.0 * 3000.0]);
        let (mut work, mut passed) = (0.0, 0.0);
        for number in 0..5000 {
            let loads = load.next();
            let incoming = std::array::from_fn(|i| RiemannData {
                impedance: [N::from_f64(impedances[i]), N::from_f64(0.9 * impedances[i])],
                invariant: loads[i].invariant.map(|x| N::from_f64(0.5 * impedances[i] * x)),
            });
            let end = N::from_f64((number + 1) as f64 * step);
            let interval = Interval::new(end, N::from_f64(step));
            for states in &law.advance(&incoming, &interval, &mut history) {
                work += step * to_f64(power(states));
                passed += step * to_f64(power(states)).abs();
            }
        }
        (to_f64(law.energy(&history).total()) - work).abs() / passed
    }
    for kind in wellposed_models::registry::LAYERS {
        let constants: Vec<f64> = kind.parameters.iter().map(|p| p.example_value()).collect();
        let material = kind.build(&constants).expect("valid");
        for distribution in MASS_DISTRIBUTIONS {
            let law = material.to_law(distribution);
            let (double, single) =
                (relative_error::<f64>(&law, |x| x), relative_error::<f32>(&law, f64::from));
            println!("{kind:?}, {distribution:?}: {double:e}, {single:e} in single precision");
            assert!(double < 1e-13, "{kind:?}: {double:e}");
            assert!(single < 2e-5, "{kind:?}: {single:e}");
        }
    }
}

/// Two lanes with different histories are bitwise equal to two scalar evaluations.
#[test]
fn lanes_agree_bitwise_with_scalars() {
    for distribution in MASS_DISTRIBUTIONS {
        for (name, material) in layer_materials() {
            let law = material.to_law(distribution);
            let lanes = law.to_number::<TwoLanes>();
            let mut loads = [RandomLoad::new(9), RandomLoad::new(10)];
            let mut scalar = [[0.0; MAX_HISTORY_VARIABLES]; 2];
            let mut paired = [TwoLanes::ZERO; MAX_HISTORY_VARIABLES];
            for number in 0..2000 {
                let incoming = [loads[0].next(), loads[1].next()];
                let time = step_interval(number, TIME_STEP);
                let states: [_; 2] = std::array::from_fn(|lane| {
                    law.advance(&incoming[lane], &time, &mut scalar[lane])
                });
                let joined = std::array::from_fn(|component| RiemannData {
                    impedance: std::array::from_fn(|side| {
                        TwoLanes(std::array::from_fn(|lane| {
                            incoming[lane][component].impedance[side]
                        }))
                    }),
                    invariant: std::array::from_fn(|side| {
                        TwoLanes(std::array::from_fn(|lane| {
                            incoming[lane][component].invariant[side]
                        }))
                    }),
                });
                let time =
                    Interval::new(TwoLanes::from_f64(time.end), TwoLanes::from_f64(time.step));
                let found = lanes.advance(&joined, &time, &mut paired);
                for lane in 0..2 {
                    for component in 0..2 {
                        for side in 0..2 {
                            let (one, other) =
                                (states[lane][component][side], found[component][side]);
                            assert_eq!(one.velocity.to_bits(), other.velocity.0[lane].to_bits());
                            assert_eq!(one.stress.to_bits(), other.stress.0[lane].to_bits());
                        }
                    }
                    let bits = |x: f64| x.to_bits();
                    assert_eq!(
                        scalar[lane].map(bits),
                        paired.map(|x| bits(x.0[lane])),
                        "{name}: step {number}"
                    );
                }
            }
        }
    }
}

/// A face at rest stays at rest: a division by zero in a branch that is not used has no effect.
#[test]
fn face_at_rest_stays_at_rest() {
    for distribution in MASS_DISTRIBUTIONS {
        for (name, material) in layer_materials() {
            let law = material.to_law(distribution);
            assert!(law.history_variable_count() <= MAX_HISTORY_VARIABLES);
            let mut history = initial_history(&law, [[0.0; 2]; 2]);
            let incoming = crate::interface::support::IMPEDANCES
                .map(|impedance| RiemannData { impedance, invariant: [0.0; 2] });
            let states = law.advance(&incoming, &step_interval(0, TIME_STEP), &mut history);
            for state in states.as_flattened() {
                assert_eq!((state.velocity, state.stress), (0.0, 0.0), "{name}");
            }
            assert_eq!(history, [0.0; MAX_HISTORY_VARIABLES], "{name}");
        }
    }
}

/// A law works with a history of exactly [`LayerLaw::history_variable_count`] variables.
#[test]
fn law_uses_no_more_history_variables_than_it_states() {
    for (_, material) in layer_materials() {
        let law = material.to_law(Default::default());
        let mut history = vec![0.0; law.history_variable_count()];
        law.initialise(&[[0.1, 0.2]; 2], &mut history);
        law.advance(&RandomLoad::new(1).next(), &step_interval(0, TIME_STEP), &mut history);
        law.energy(&history);
        law.to_face_record(&history);
    }
}

/// A reflection of the axis or a half turn of the load reflects or turns all results exactly.
#[test]
fn reflections_and_half_turns_commute_with_all_kinds() {
    for distribution in MASS_DISTRIBUTIONS {
        for (name, material) in layer_materials() {
            let law = material.to_law(distribution);
            // Signs of the tangential velocity after the exchange of both sides; the normal one changes its sign.
            for sign in [1.0, -1.0] {
                let signs = [-1.0, sign];
                let mut load = RandomLoad::new(15);
                let mut history = initial_history(&law, [[0.3, -0.2], [0.1, 0.4]]);
                let mut image = initial_history(&law, [[0.2, -0.3], [sign * 0.4, sign * 0.1]]);
                for number in 0..3000 {
                    let incoming = load.next();
                    let turned = std::array::from_fn(|i| {
                        let RiemannData { impedance: [z, x], invariant: [r, s] } = incoming[i];
                        RiemannData { impedance: [x, z], invariant: [signs[i] * s, signs[i] * r] }
                    });
                    let time = step_interval(number, TIME_STEP);
                    let states = law.advance(&incoming, &time, &mut history);
                    let found = law.advance(&turned, &time, &mut image);
                    for i in 0..2 {
                        for side in 0..2 {
                            let (one, other) = (states[i][side], found[i][1 - side]);
                            assert_eq!(one.velocity, signs[i] * other.velocity, "{name}");
                            assert_eq!(one.stress, -signs[i] * other.stress, "{name}");
                        }
                    }
                    assert_eq!(law.energy(&history), law.energy(&image), "{name}");
                    let (one, other) = (law.to_face_record(&history), law.to_face_record(&image));
                    assert_eq!((one.slip, one.opening), (other.slip, other.opening), "{name}");
                }
            }
        }
    }
}
