//! Layers of all kinds with constants of order one, random loads, and a number type of two lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};
use testkit::random::RandomNumbers;
use wellposed_models::common::number::Number;
use wellposed_models::interface::elastic::ElasticMaterial;
use wellposed_models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use wellposed_models::interface::parameters::{
    LayerMaterial, MassDistribution, PlasticConstants, PorousConstants, SaturatedMaterial,
    TangentialConstants, ViscousConstants,
};
use wellposed_models::interface::{FaceLaw, FaceState, Interval, RiemannData};

/// Both distributions of the mass of a layer.
pub const MASS_DISTRIBUTIONS: [MassDistribution; 2] =
    [MassDistribution::Box, MassDistribution::Lumped];

/// History variables of a face.
pub type History = [f64; MAX_HISTORY_VARIABLES];

pub const ELASTIC: ElasticMaterial =
    ElasticMaterial { thickness: 0.3, density: 0.9, longitudinal_speed: 1.4, shear_speed: 0.8 };
pub const VISCOUS: ViscousConstants = ViscousConstants { delayed_compliance: 2.0, viscosity: 0.7 };
pub const PORES: PorousConstants = PorousConstants { collapse_stiffness: 9.0, porosity: 0.2 };
pub const SATURATED: SaturatedMaterial = SaturatedMaterial {
    thickness: 0.3,
    skeleton_density: 1.3,
    fluid_density: 0.25,
    added_density: 0.1,
    undrained_stiffness: 1.5,
    pores: PorousConstants { collapse_stiffness: 6.0, porosity: 0.2 },
    coupling_stiffness: 0.45,
    fluid_stiffness: 0.7,
    instantaneous_compliance: 1.5,
    viscous: VISCOUS,
};

/// Constants of a layer that slips.
pub fn plastic_constants(shear_strength: f64, friction: f64, hardening: f64) -> PlasticConstants {
    PlasticConstants { shear_strength, friction, hardening }
}

/// Layers of all kinds with their names.
pub fn layer_materials() -> Vec<(&'static str, LayerMaterial)> {
    use LayerMaterial::{Breaking, Cracked, Elastic, Plastic, Porous, Saturated, Viscous};
    let plastic_shear = TangentialConstants::Plastic { shear_strength: 0.4, hardening: 0.002 };
    vec![
        ("elastic", Elastic(ELASTIC)),
        ("elastic-plastic", Plastic(ELASTIC, plastic_constants(0.4, 0.5, 0.0))),
        ("elastic-plastic, hardening", Plastic(ELASTIC, plastic_constants(0.4, 0.5, 0.002))),
        ("elastic-plastic, cohesive", Plastic(ELASTIC, plastic_constants(0.4, 0.0, 0.0))),
        ("elastic-plastic, no strength", Plastic(ELASTIC, plastic_constants(0.0, 0.5, 0.0))),
        ("elastic-plastic, no shear", Plastic(ELASTIC, plastic_constants(0.0, 0.0, 0.0))),
        ("viscous", Viscous(ELASTIC, VISCOUS)),
        ("porous", Porous(ELASTIC, PORES, TangentialConstants::Elastic)),
        ("porous, viscous", Porous(ELASTIC, PORES, TangentialConstants::Viscous(VISCOUS))),
        ("porous, plastic", Porous(ELASTIC, PORES, plastic_shear)),
        ("saturated", Saturated(SATURATED)),
        ("cracked", Cracked(ELASTIC, None)),
        ("cracked, friction", Cracked(ELASTIC, Some(0.5))),
        ("breaking", Breaking(ELASTIC, plastic_constants(0.6, 0.5, 0.002), 0.7)),
        ("breaking at the apex", Breaking(ELASTIC, plastic_constants(0.6, 0.5, 0.0), 1.2)),
    ]
}

/// Random load of a face: Riemann invariants that relax towards random target values of both signs and of random
/// amplitude. The targets change in about one of twenty steps and are zero in a tenth of the cases.
pub struct RandomLoad {
    random: RandomNumbers,
    target: [[f64; 2]; 2],
    value: [[f64; 2]; 2],
}

/// Impedances z⁻ and z⁺ of both cells by component.
pub const IMPEDANCES: [[f64; 2]; 2] = [[1.3, 0.4], [0.5, 0.9]];

impl RandomLoad {
    pub fn new(seed: u64) -> Self {
        Self { random: RandomNumbers::new(seed), target: [[0.0; 2]; 2], value: [[0.0; 2]; 2] }
    }

    /// Riemann data of the next step, by component.
    pub fn next(&mut self) -> [RiemannData<f64>; 2] {
        for (component, &impedance) in IMPEDANCES.iter().enumerate() {
            if self.random.bernoulli(0.05) {
                let amplitude = self.random.log_uniform(0.03, 3.0);
                for (target, z) in self.target[component].iter_mut().zip(impedance) {
                    let quiet = self.random.bernoulli(0.1);
                    let value = self.random.uniform(-amplitude, amplitude);
                    *target = if quiet { 0.0 } else { value * z };
                }
            }
            for side in 0..2 {
                let value = &mut self.value[component][side];
                *value += 0.3 * (self.target[component][side] - *value);
            }
        }
        // A mean compression, so that cracks close.
        let bias = [[0.1, -0.1], [0.0; 2]];
        std::array::from_fn(|component| RiemannData {
            impedance: IMPEDANCES[component],
            invariant: std::array::from_fn(|side| {
                self.value[component][side] + bias[component][side]
            }),
        })
    }
}

/// Returns the work of both cells on a face in a step, J/m², and the sum of the magnitudes of its terms.
pub fn face_work(
    states: &[[FaceState<f64>; 2]; 2],
    incoming: &[RiemannData<f64>; 2],
    step: f64,
) -> (f64, f64) {
    let (mut total, mut size) = (0.0, 0.0);
    for (component, [lower, upper]) in states.iter().enumerate() {
        let impedance = incoming[component].impedance;
        total += step * (upper.stress * upper.velocity - lower.stress * lower.velocity);
        for (state, z) in [(lower, impedance[0]), (upper, impedance[1])] {
            size += 0.5 * step * (z * state.velocity.powi(2) + state.stress.powi(2) / z);
        }
    }
    (total, size)
}

/// Initial history variables of a face whose cells have the given velocities.
pub fn initial_history(law: &LayerLaw<f64>, velocities: [[f64; 2]; 2]) -> History {
    let mut history = [0.0; MAX_HISTORY_VARIABLES];
    law.initialise(&velocities, &mut history);
    history
}

/// Time interval of the step `number`, counted from 0.
pub fn step_interval(number: usize, step: f64) -> Interval<f64> {
    Interval::new((number + 1) as f64 * step, step)
}

/// Number type of two lanes of doubles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLanes(pub [f64; 2]);

impl TwoLanes {
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait for TwoLanes {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.zip(other, f64::$method)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for TwoLanes {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Number for TwoLanes {
    const ZERO: Self = Self([0.0; 2]);
    const ONE: Self = Self([1.0; 2]);
    const HALF: Self = Self([0.5; 2]);
    const THIRD: Self = Self([1.0 / 3.0; 2]);
    const QUARTER: Self = Self([0.25; 2]);
    const MIN_POSITIVE: Self = Self([f64::MIN_POSITIVE; 2]);
    const EPSILON: Self = Self([f64::EPSILON; 2]);

    fn from_f64(value: f64) -> Self {
        Self([value; 2])
    }

    fn max(self, other: Self) -> Self {
        self.zip(other, Number::max)
    }

    fn min(self, other: Self) -> Self {
        self.zip(other, Number::min)
    }

    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    fn minmod3(self, one: Self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].minmod3(one.0[i], other.0[i])))
    }

    fn flush_below(self, limit: Self) -> Self {
        self.zip(limit, Number::flush_below)
    }

    fn any_gt(self, other: Self) -> bool {
        (0..2).any(|lane| self.0[lane] > other.0[lane])
    }

    fn select_gt(self, other: Self, if_greater: Self, otherwise: Self) -> Self {
        Self(std::array::from_fn(|i| {
            self.0[i].select_gt(other.0[i], if_greater.0[i], otherwise.0[i])
        }))
    }
}
