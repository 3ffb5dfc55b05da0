//! Plane waves at normal incidence on a periodic stack of blocks and layers, by transfer matrices (Brillouin 1946).
//!
//! With velocity v and traction σ = is of a wave e^{iωt}, blocks and layers map (v, s) by matrices of determinant 1,
//! real at real ω without viscosity. A block of length ℓ, wave speed c and impedance z = ρc turns by θ = ωℓ/c, a layer
//! of mass m and compliance C = 1/K with the box scheme (Preissmann 1961) by ψ = 2 arctan(½ω√(mC)) at z′ = √(m/C):
//!
//! ```text
//! block [ cos θ, −(sin θ)/z ]      layer [ cos ψ, −(sin ψ)/z′ ]
//!       [ z sin θ,    cos θ ],           [ z′ sin ψ,    cos ψ ].
//! ```
//!
//! A layer with the opening mass n (n = ¼m: lumped masses) is a mass 2n on each face and a box of mass m − 4n between
//! them. Bloch's condition with the period h gives cos κh = Δ(ω), half the trace of the product T of all matrices. For
//! one block and one box layer
//!
//! ```text
//! cos κh = cos θ cos ψ − ½(z/z′ + z′/z) sin θ sin ψ,
//! ```
//!
//! and for lumped masses cos κh = (1 − ½mCω²) cos θ − ½[zωC + ωm(1 − ¼mCω²)/z] sin θ.
//!
//! The discrete scheme of blocks at Courant number 1 and layers by the midpoint rule with the step Δt has the same
//! relation, exactly, with ω in the matrices of the layers replaced by (2/Δt) tan ½ωΔt; its frequencies end at π/Δt.
//!
//! Branches: T is an element of SL(2, ℝ), and its angle of rotation on the universal cover, the Bloch phase Φ(ω), never
//! decreases with ω, since the energy is positive. It is Φ = jπ + κh or (j + 1)π − κh on branch j = 0, 1, …, for even
//! and odd j, and an integer multiple of π in gaps. Bisection on Φ finds each branch, none twice.

mod branches;
mod damped;

pub use branches::{BlochPhase, ChainGap};

use super::{BlochError, ensure};
use models::common::elementary::Elementary;
use models::interface::elastic::ElasticMaterial;
use models::interface::homogenised::BlockMaterial;
use models::interface::opening_line::LayerMass;
use num_complex::Complex64;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Polarisation of a wave at normal incidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ChainPolarisation {
    /// Longitudinal: c₁ and the normal stiffness of layers.
    Longitudinal,
    /// Transverse: c₂ and the tangential stiffness of layers.
    Transverse,
}

/// Block or layer in a period of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChainElement {
    /// Elastic block.
    Block {
        /// Length ℓ, m.
        length: f64,
        /// Wave speed c, m/s.
        speed: f64,
        /// Impedance z = ρc, kg/(m²s).
        impedance: f64,
    },
    /// Layer, without thickness along the chain.
    Layer {
        /// Mass per area, kg/m².
        mass: LayerMass<f64>,
        /// Instantaneous and delayed compliance, m/Pa.
        compliance: LayerCompliance,
    },
}

/// Compliance of a layer, C(ω) = C₀ + C₁/(1 + iωτ) for e^{iωt}: a spring C₀ in series with a spring C₁ and a dashpot in
/// parallel (standard linear solid). In the constants of a viscous layer of thickness δ: C₀ = δa₀, C₁ = δa₁, τ = ηa₁.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerCompliance {
    /// Instantaneous compliance C₀ ≥ 0, m/Pa; 0 is a welded interface.
    pub elastic: f64,
    /// Delayed compliance C₁ ≥ 0, m/Pa; 0 without viscosity.
    pub delayed: f64,
    /// Retardation time τ, s; positive if the layer is viscous.
    pub retardation_time: f64,
}

impl LayerCompliance {
    /// Creates a compliance without viscosity, m/Pa.
    pub const fn new_elastic(compliance: f64) -> Self {
        Self { elastic: compliance, delayed: 0.0, retardation_time: 0.0 }
    }

    /// Compliance C₀ + C₁ under slow loads, m/Pa.
    pub fn relaxed(&self) -> f64 {
        self.elastic + self.delayed
    }
}

impl ChainElement {
    /// Element of a block of the given length, m, for waves of a polarisation.
    pub fn from_block(
        material: &BlockMaterial,
        length: f64,
        polarisation: ChainPolarisation,
    ) -> Self {
        let speed = match polarisation {
            ChainPolarisation::Longitudinal => material.longitudinal_speed,
            ChainPolarisation::Transverse => material.shear_speed,
        };
        Self::Block { length, speed, impedance: material.density * speed }
    }

    /// Element of an elastic layer, with the mass distributed as in the box scheme or lumped, for waves of a
    /// polarisation.
    pub fn from_layer(
        material: &ElasticMaterial,
        is_lumped: bool,
        polarisation: ChainPolarisation,
    ) -> Self {
        let compliance = match polarisation {
            ChainPolarisation::Longitudinal => material.normal_compliance(),
            ChainPolarisation::Transverse => material.tangential_compliance(),
        };
        let mass = match is_lumped {
            true => LayerMass::new_lumped(material.mass()),
            false => LayerMass::new_box(material.mass()),
        };
        Self::Layer { mass, compliance: LayerCompliance::new_elastic(compliance) }
    }

    fn check(&self) -> Result<(), BlochError> {
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        let is_nonnegative = |x: f64| x >= 0.0 && x.is_finite();
        match *self {
            Self::Block { length, speed, impedance } => {
                for (name, value) in
                    [("length", length), ("speed", speed), ("impedance", impedance)]
                {
                    ensure(is_positive(value), name, value, "a positive number")?;
                }
            }
            Self::Layer { mass: LayerMass { mass, opening_mass }, compliance } => {
                ensure(is_nonnegative(mass), "mass", mass, "at least 0")?;
                let is_valid = is_nonnegative(opening_mass) && 4.0 * opening_mass <= mass;
                ensure(is_valid, "opening_mass", opening_mass, "from 0 to ¼ of the mass")?;
                let LayerCompliance { elastic, delayed, retardation_time } = compliance;
                ensure(is_nonnegative(elastic), "compliance", elastic, "at least 0 and finite")?;
                ensure(is_nonnegative(delayed), "delayed_compliance", delayed, "at least 0")?;
                let is_valid = delayed == 0.0 || is_positive(retardation_time);
                ensure(is_valid, "retardation_time", retardation_time, "a positive number")?;
            }
        }
        Ok(())
    }
}

/// Periodic chain of blocks and layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    elements: Vec<ChainElement>,
    factors: Vec<TransferFactor>,
    time_step: Option<f64>,
}

/// Factor of the transfer matrix of a period. Impedances are divided by that of long waves, Z = √(mass/compliance) with
/// the mass per area and the compliance under slow loads of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TransferFactor {
    /// Block: travel time ℓ/c, s, and relative impedance z/Z.
    Block { time: f64, impedance: f64 },
    /// Mass m without compliance: m/Z, s.
    Mass(f64),
    /// Layer by the box scheme: mass m/Z, s, instantaneous compliance C₀Z, s, and delayed compliance C₁Z, s, with its
    /// retardation time τ, s.
    Box { mass: f64, elastic: f64, delayed: f64, time: f64 },
}

impl Chain {
    /// Creates the chain from the elements of a period.
    ///
    /// # Errors
    /// An element is rejected, or no element is a block.
    pub fn new(elements: Vec<ChainElement>) -> Result<Self, BlochError> {
        elements.iter().try_for_each(ChainElement::check)?;
        let mut chain = Self { elements, factors: Vec::new(), time_step: None };
        let has_length = chain.period() > 0.0;
        ensure(has_length, "elements", chain.elements.len(), "at least one block")?;
        let [mass, compliance] = chain.mass_and_compliance();
        let unit = (mass / compliance).sqrt();
        for element in &chain.elements {
            match *element {
                ChainElement::Block { length, speed, impedance } => {
                    chain.factors.push(TransferFactor::Block {
                        time: length / speed,
                        impedance: impedance / unit,
                    });
                }
                ChainElement::Layer { mass, compliance } => {
                    let outer = TransferFactor::Mass(2.0 * mass.opening_mass / unit);
                    let inner = TransferFactor::Box {
                        mass: (mass.mass - 4.0 * mass.opening_mass) / unit,
                        elastic: compliance.elastic * unit,
                        delayed: compliance.delayed * unit,
                        time: compliance.retardation_time,
                    };
                    match mass.opening_mass == 0.0 {
                        true => chain.factors.push(inner),
                        false => chain.factors.extend([outer, inner, outer]),
                    }
                }
            }
        }
        Ok(chain)
    }

    /// Chain discretised with the time step Δt, s: blocks at Courant number 1, layers by the midpoint rule.
    ///
    /// # Errors
    /// The step is not positive and finite.
    pub fn with_time_step(self, time_step: f64) -> Result<Self, BlochError> {
        let is_valid = time_step > 0.0 && time_step.is_finite();
        ensure(is_valid, "time_step", time_step, "a positive number")?;
        Ok(Self { time_step: Some(time_step), ..self })
    }

    /// Period h, m: the sum of the lengths of the blocks.
    pub fn period(&self) -> f64 {
        let lengths = self.elements.iter().map(|element| match element {
            ChainElement::Block { length, .. } => *length,
            ChainElement::Layer { .. } => 0.0,
        });
        lengths.sum()
    }

    /// Speed of long waves, m/s: c² = h²/[(Σ ℓ/(ρc²) + Σ C)(Σ ρℓ + Σ m)] with the compliances of slow loads.
    pub fn long_wave_speed(&self) -> f64 {
        let [mass, compliance] = self.mass_and_compliance();
        self.period() / (mass * compliance).sqrt()
    }

    /// Mass per area, kg/m², and compliance, m/Pa, of a period under slow loads.
    fn mass_and_compliance(&self) -> [f64; 2] {
        self.elements.iter().fold([0.0; 2], |[mass, compliance], element| match *element {
            ChainElement::Block { length, speed, impedance } => {
                let time = length / speed;
                [mass + time * impedance, compliance + time / impedance]
            }
            ChainElement::Layer { mass: layer, compliance: law } => {
                [mass + layer.mass, compliance + law.relaxed()]
            }
        })
    }

    /// Transfer matrix of a period and its derivative with respect to ω; `delayed_share` multiplies the delayed
    /// compliances.
    fn transfer<T: Frequency>(&self, frequency: T, delayed_share: f64) -> Transfer<T> {
        let layer = self.layer_frequency(frequency);
        let mut product = Transfer::identity();
        for factor in &self.factors {
            product = factor.transfer(frequency, layer, delayed_share).multiply(product);
        }
        product
    }

    /// Frequency in the matrices of layers, (2/Δt) tan ½ωΔt with a time step, else ω; and its derivative by ω.
    fn layer_frequency<T: Frequency>(&self, frequency: T) -> [T; 2] {
        let Some(step) = self.time_step else { return [frequency, T::from(1.0)] };
        let (sin, cos) = (frequency * T::from(0.5 * step)).sin_cos();
        let tan = sin / cos;
        [tan * T::from(2.0 / step), tan * tan + T::from(1.0)]
    }
}

impl TransferFactor {
    fn transfer<T: Frequency>(
        &self,
        frequency: T,
        [layer, slope]: [T; 2],
        delayed_share: f64,
    ) -> Transfer<T> {
        let [zero, one] = [T::from(0.0), T::from(1.0)];
        match *self {
            Self::Block { time, impedance } => {
                let (sin, cos) = (frequency * T::from(time)).sin_cos();
                let (z, time) = (T::from(impedance), T::from(time));
                Transfer {
                    matrix: [cos, -sin / z, z * sin, cos],
                    derivative: [-time * sin, -time * cos / z, time * z * cos, -time * sin],
                }
            }
            Self::Mass(mass) => {
                let mass = T::from(mass);
                Transfer {
                    matrix: [one, zero, mass * layer, one],
                    derivative: [zero, zero, mass * slope, zero],
                }
            }
            Self::Box { mass, elastic, delayed, time } => {
                let mass = T::from(mass);
                let [compliance, compliance_slope] = match delayed == 0.0 {
                    true => [T::from(elastic), zero],
                    false => {
                        let [denominator, rate] =
                            [T::retardation_factor(layer, time), T::retardation_factor_slope(time)];
                        let delayed = T::from(delayed * delayed_share) / denominator;
                        [T::from(elastic) + delayed, -delayed * rate * slope / denominator]
                    }
                };
                // cos ψ = 8/D − 1, (sin ψ)/z′ = 4ωC/D, z′ sin ψ = 4ωm/D with D = 4 + mCω².
                let four = T::from(4.0);
                let square = layer * layer;
                let denominator = four + mass * compliance * square;
                let denominator_slope =
                    mass * (compliance * (layer + layer) * slope + compliance_slope * square);
                let ratio = four / denominator;
                let ratio_slope = -ratio * denominator_slope / denominator;
                let [cos, cos_slope] = [ratio + ratio - one, ratio_slope + ratio_slope];
                let opening = layer * compliance;
                let opening_slope = slope * compliance + layer * compliance_slope;
                Transfer {
                    matrix: [cos, -opening * ratio, layer * mass * ratio, cos],
                    derivative: [
                        cos_slope,
                        -(opening_slope * ratio + opening * ratio_slope),
                        mass * (slope * ratio + layer * ratio_slope),
                        cos_slope,
                    ],
                }
            }
        }
    }
}

/// Transfer matrix of (Zv, s) by rows and its derivative with respect to ω; determinant 1.
#[derive(Clone, Copy, Debug)]
struct Transfer<T> {
    matrix: [T; 4],
    derivative: [T; 4],
}

impl<T: Frequency> Transfer<T> {
    fn identity() -> Self {
        let [zero, one] = [T::from(0.0), T::from(1.0)];
        Self { matrix: [one, zero, zero, one], derivative: [zero; 4] }
    }

    /// Product `self` × `first`, and its derivative by the product rule.
    fn multiply(self, first: Self) -> Self {
        let product = |[a, b, c, d]: [T; 4], [e, f, g, h]: [T; 4]| {
            [a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h]
        };
        let [left, right] =
            [product(self.derivative, first.matrix), product(self.matrix, first.derivative)];
        Self {
            matrix: product(self.matrix, first.matrix),
            derivative: std::array::from_fn(|i| left[i] + right[i]),
        }
    }

    /// Half the trace Δ and its derivative with respect to ω.
    fn half_trace(&self) -> [T; 2] {
        let half = T::from(0.5);
        let [[a, _, _, d], [da, _, _, dd]] = [self.matrix, self.derivative];
        [half * (a + d), half * (da + dd)]
    }

    /// Δ² − 1, by the formula with the smaller rounding: directly, or as ¼(T₁₁ − T₂₂)² + T₁₂T₂₁, since det T = 1. All
    /// terms of the second vanish where a gap is closed; with strong contrasts they are large and cancel.
    fn discriminant(&self) -> T {
        let [a, b, c, d] = self.matrix;
        let one = T::from(1.0);
        let [half_trace, _] = self.half_trace();
        let coupling = b.modulus() + c.modulus();
        let sum = a.modulus() + d.modulus();
        let half = T::from(0.5) * (a - d);
        match ((a - d).modulus() + coupling) * (sum + coupling) < sum * half_trace.modulus() {
            true => half * half + b * c,
            false => (half_trace - one) * (half_trace + one),
        }
    }
}

/// Angular frequency, real or complex: the operations that transfer matrices need.
trait Frequency:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Absolute value.
    fn modulus(self) -> f64;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Factor 1 + iωτ of the retardation time τ = `time`.
    fn retardation_factor(frequency: Self, time: f64) -> Self;
    /// Derivative iτ of the factor 1 + iωτ by ω.
    fn retardation_factor_slope(time: f64) -> Self;
}

/// For chains without viscosity only: the factor 1 + iωτ is replaced by 1.
impl Frequency for f64 {
    fn modulus(self) -> f64 {
        self.abs()
    }

    fn sin_cos(self) -> (Self, Self) {
        self.cr_sin_cos()
    }

    fn retardation_factor(_: Self, _: f64) -> Self {
        1.0
    }

    fn retardation_factor_slope(_: f64) -> Self {
        0.0
    }
}

impl Frequency for Complex64 {
    fn modulus(self) -> f64 {
        self.re.root_sum_square(self.im)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.re.cr_sin_cos();
        let (sinh, cosh) = (self.im.cr_sinh(), self.im.cr_cosh());
        (Self::new(sin * cosh, cos * sinh), Self::new(cos * cosh, -sin * sinh))
    }

    fn retardation_factor(frequency: Self, time: f64) -> Self {
        Self::new(1.0, 0.0) + Self::i() * frequency * time
    }

    fn retardation_factor_slope(time: f64) -> Self {
        Self::new(0.0, time)
    }
}
