//! One-dimensional waves of elastic solids along a coordinate axis in closed form, for time-domain solvers.
//!
//! Along x_a the equations decouple into velocity–stress pairs with speeds c and impedances z,
//!
//! ```text
//! m v̇ = ∂ₐs,    ṡ = M ∂ₐv,    c = √(M/m),    z = √(mM),
//! ```
//!
//! with inertia m and modulus M, and passive stresses s′ follow s in a fixed ratio r: s′ − r s is a Riemann invariant
//! of speed zero (Sadovskii & Sadovskaya 2019, "Elastic Cosserat continuum"). Without gradients, spins and
//! antisymmetric stress oscillate with the natural frequency 2√(α/j).
//!
//! These formulas are independent of [`symbol`](super::symbol), which states the same equations as matrices; a test
//! compares both.

use super::parameters::{Isotropic, PlaneCompliances, Theory};
use crate::common::elementary::Elementary;
use std::fmt;

/// A component of the state of a time-domain solver; axes from 0. The second index of a stress is the face normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SolidField {
    /// Velocity vᵢ, m/s.
    Velocity(usize),
    /// Spin ωₖ, rad/s.
    Spin(usize),
    /// Force stress σᵢⱼ, Pa; in classical solids only i ≤ j.
    Stress(usize, usize),
    /// Couple stress mₖⱼ, N/m.
    Couple(usize, usize),
    /// Viscous strain aᵢⱼ = aⱼᵢ, i ≤ j: history variable of a [viscoelastic solid](crate::rheology::relaxation).
    ViscousStrain(usize, usize),
    /// Excess sᵢⱼ − σᵢⱼ of the conditional stress, i ≤ j, Pa: history variable of a
    /// [granular medium](crate::granular_medium).
    ExcessStress(usize, usize),
    /// Stress of the spring of particles with a parallel dashpot, i ≤ j, Pa: history variable of a
    /// [granular medium](crate::granular_medium).
    SpringStress(usize, usize),
    /// Plastic strain εᵖᵢⱼ of the skeleton, i ≤ j: history variable of a [porous medium](crate::porous) with contact by cone.
    PlasticStrain(usize, usize),
    /// Volumetric strain tr ε: history variable of a [porous medium](crate::porous).
    VolumetricStrain,
    /// Closure κ = min(θ₀ + tr ε, 0) of the pores of a [porous medium](crate::porous): history variable.
    PoreClosure,
}
use SolidField::{
    Couple, ExcessStress, PlasticStrain, PoreClosure, Spin, SpringStress, Stress, Velocity,
    ViscousStrain, VolumetricStrain,
};

impl SolidField {
    /// Whether the component is a history variable of a local law, which the sweeps do not read.
    pub const fn is_history(self) -> bool {
        match self {
            Velocity(_) | Spin(_) | Stress(..) | Couple(..) => false,
            ViscousStrain(..) | ExcessStress(..) | SpringStress(..) | PlasticStrain(..)
            | VolumetricStrain | PoreClosure => true,
        }
    }
}

/// Writes the name of the component, as among the unknowns of the [rate equations](crate::common::rates): `v1`, `ω3`,
/// `σ12`, `m31`; for history variables `a12`, `x12`, `b12`, `εp12`, `θ` and `κ`.
impl fmt::Display for SolidField {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Velocity(i) => write!(formatter, "v{}", i + 1),
            Spin(k) => write!(formatter, "ω{}", k + 1),
            Stress(i, j) => write!(formatter, "σ{}{}", i + 1, j + 1),
            Couple(k, j) => write!(formatter, "m{}{}", k + 1, j + 1),
            ViscousStrain(i, j) => write!(formatter, "a{}{}", i + 1, j + 1),
            ExcessStress(i, j) => write!(formatter, "x{}{}", i + 1, j + 1),
            SpringStress(i, j) => write!(formatter, "b{}{}", i + 1, j + 1),
            PlasticStrain(i, j) => write!(formatter, "εp{}{}", i + 1, j + 1),
            VolumetricStrain => formatter.write_str("θ"),
            PoreClosure => formatter.write_str("κ"),
        }
    }
}

/// A velocity–stress pair of a one-dimensional wave along an axis: m v̇ = ∂ₐs, ṡ = M ∂ₐv.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityStressPair {
    /// Velocity v: a translation or a spin.
    pub velocity: SolidField,
    /// Stress s that drives the velocity.
    pub stress: SolidField,
    /// Inertia m: density, kg/m³, or moment of inertia, kg/m.
    pub inertia: f64,
    /// Modulus M, Pa or N.
    pub modulus: f64,
    /// Passive stresses, which the pair changes but which do not enter its equations (characteristics of speed zero),
    /// each with its coupling ratio r = ds′/ds: λ/(λ + 2μ) for the transverse normal stresses of a P wave.
    pub passive_stresses: Vec<(SolidField, f64)>,
}

impl VelocityStressPair {
    /// Wave speed c = √(M/m), m/s.
    pub fn speed(&self) -> f64 {
        (self.modulus / self.inertia).sqrt()
    }

    /// Whether the pair is that of longitudinal waves, with a normal stress.
    pub fn is_longitudinal(&self) -> bool {
        matches!(self.stress, Stress(i, j) if i == j)
    }

    /// Impedance z = mc, kg/(m²s) for translations and kg/s for spins.
    pub fn impedance(&self) -> f64 {
        (self.inertia * self.modulus).sqrt()
    }
}

/// Rotation between spins and antisymmetric stress, the source term of Cosserat solids: with the axial vector
/// aₖ = ½εₖᵢⱼσᵢⱼ of the antisymmetric stress
///
/// ```text
/// j ω̇ₖ = −2 aₖ,    ȧₖ = 2α ωₖ.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpinRotation {
    /// Natural frequency 2√(α/j), rad/s.
    pub frequency: f64,
    /// Amplitude ratio √(αj) of a to ω, Pa·s.
    pub ratio: f64,
}

impl SpinRotation {
    fn new(alpha: f64, inertia: f64) -> Self {
        Self { frequency: 2.0 * (alpha / inertia).sqrt(), ratio: (alpha * inertia).sqrt() }
    }

    /// Exact solution: advances (ω, a) by the time `duration` (s).
    pub fn advance(&self, [spin, stress]: [f64; 2], duration: f64) -> [f64; 2] {
        let (sin, cos) = (self.frequency * duration).cr_sin_cos();
        [spin * cos - stress / self.ratio * sin, stress * cos + self.ratio * spin * sin]
    }
}

/// State components of a theory in 2 (plane strain, with the out-of-plane stresses that enter yield conditions and
/// energies) or 3 dimensions.
pub fn state_fields(theory: Theory, dimensions: usize) -> Vec<SolidField> {
    let axes = 0..dimensions;
    let mut fields: Vec<SolidField> = axes.clone().map(Velocity).collect();
    if theory != Theory::Classical {
        fields.extend(if dimensions == 2 {
            vec![Spin(2)]
        } else {
            axes.clone().map(Spin).collect()
        });
    }
    for i in axes.clone() {
        for j in axes.clone().filter(|&j| theory != Theory::Classical || i <= j) {
            fields.push(Stress(i, j));
        }
    }
    if dimensions == 2 {
        fields.push(Stress(2, 2));
    }
    if theory == Theory::Cosserat {
        if dimensions == 2 {
            fields.extend([Couple(2, 0), Couple(2, 1), Couple(0, 2), Couple(1, 2)]);
        } else {
            fields.extend(axes.clone().flat_map(|k| axes.clone().map(move |j| Couple(k, j))));
        }
    }
    fields
}

/// Coefficients of an isotropic law t = `trace` tr(T) δ + `direct` T + `transposed` Tᵀ between a stress t and a strain
/// T. For waves along axis a they give the moduli of longitudinal waves (strain Tₐₐ) and of transverse waves (strain
/// Tᵢₐ, i ≠ a), and the coupling ratios of the passive stresses.
struct IsotropicLaw {
    trace: f64,
    direct: f64,
    transposed: f64,
}

impl IsotropicLaw {
    fn new(trace: f64, symmetric: f64, antisymmetric: f64) -> Self {
        Self { trace, direct: symmetric + antisymmetric, transposed: symmetric - antisymmetric }
    }

    fn modulus(&self, is_along: bool) -> f64 {
        match is_along {
            true => self.trace + self.direct + self.transposed,
            false => self.direct,
        }
    }

    fn coupling_ratio(&self, is_along: bool) -> f64 {
        let passive = if is_along { self.trace } else { self.transposed };
        passive / self.modulus(is_along)
    }
}

impl Isotropic {
    /// Velocity–stress pairs along `axis`, in 2 (plane strain) or 3 dimensions.
    pub fn pairs(&self, dimensions: usize, axis: usize) -> Vec<VelocityStressPair> {
        let alpha = self.microrotation.map_or(0.0, |m| m.alpha);
        let force = IsotropicLaw::new(self.lambda, self.mu, alpha);
        let is_classical = self.theory() == Theory::Classical;
        let normals = move || (0..3).filter(move |&k| k != axis);
        let mut pairs: Vec<VelocityStressPair> = (0..dimensions)
            .map(|i| {
                let passive_stresses = match (i == axis, is_classical) {
                    (true, _) => {
                        normals().map(|k| (Stress(k, k), force.coupling_ratio(true))).collect()
                    }
                    (false, true) => Vec::new(),
                    (false, false) => vec![(Stress(axis, i), force.coupling_ratio(false))],
                };
                let [first, second] = match is_classical {
                    true => [i.min(axis), i.max(axis)],
                    false => [i, axis],
                };
                VelocityStressPair {
                    velocity: Velocity(i),
                    stress: Stress(first, second),
                    inertia: self.density,
                    modulus: force.modulus(i == axis),
                    passive_stresses,
                }
            })
            .collect();
        if let (Some(couple), Some(rotation)) = (self.couple(), self.microrotation) {
            let law = IsotropicLaw::new(couple.beta, couple.gamma, couple.eta);
            let spins = if dimensions == 2 { 2..3 } else { 0..3 };
            pairs.extend(spins.map(|k| VelocityStressPair {
                velocity: Spin(k),
                stress: Couple(k, axis),
                inertia: rotation.inertia,
                modulus: law.modulus(k == axis),
                passive_stresses: match k == axis {
                    true => normals().map(|l| (Couple(l, l), law.coupling_ratio(true))).collect(),
                    false => vec![(Couple(axis, k), law.coupling_ratio(false))],
                },
            }));
        }
        pairs
    }

    /// Rotation between spins and antisymmetric stress; `None` in classical solids.
    pub fn rotation(&self) -> Option<SpinRotation> {
        self.microrotation.map(|m| SpinRotation::new(m.alpha, m.inertia))
    }
}

impl PlaneCompliances {
    /// Velocity–stress pairs along `axis` in plane strain: a₁ and b₁ relate normal stresses, a₂ and b₂ shear stresses.
    pub fn pairs(&self, axis: usize) -> Vec<VelocityStressPair> {
        let pair = |i: usize| {
            let (a, b) = if i == axis { (self.a1, self.b1) } else { (self.a2, self.b2) };
            let other = 1 - axis;
            let passive = if i == axis { Stress(other, other) } else { Stress(axis, i) };
            VelocityStressPair {
                velocity: Velocity(i),
                stress: Stress(i, axis),
                inertia: self.density,
                modulus: a / ((a - b) * (a + b)),
                passive_stresses: vec![(passive, b / a)],
            }
        };
        let rotation = VelocityStressPair {
            velocity: Spin(2),
            stress: Couple(2, axis),
            inertia: self.inertia,
            modulus: self.alpha2,
            passive_stresses: Vec::new(),
        };
        vec![pair(0), pair(1), rotation]
    }

    /// Rotation between spins and antisymmetric stress, with α = ½/(a₂ + b₂).
    pub fn rotation(&self) -> SpinRotation {
        SpinRotation::new(0.5 / (self.a2 + self.b2), self.inertia)
    }
}
