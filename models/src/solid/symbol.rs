//! Rate equations of elastic solids, written from the balances of momentum and of spin
//!
//! ```text
//! ρ v̇ᵢ = ∂ⱼσᵢⱼ,    j ω̇ₖ = ∂ⱼmₖⱼ − εₖᵢⱼσᵢⱼ,
//! ```
//!
//! the strain rates Λ̇ᵢⱼ = ∂ⱼvᵢ + εᵢⱼₖωₖ and Ṁₖⱼ = ∂ⱼωₖ, and Hooke's law
//! (Sadovskii & Sadovskaya 2019, "Elastic Cosserat continuum").

use super::parameters::{Isotropic, PlaneCompliances, Theory};
use super::stress::StressComponent::{self, Couple, Force, Symmetric};
use crate::common::rates::RateEquations;
use crate::common::rounding::Rounded;
use crate::common::system::{RoundedMatrix, Unknown};
use nalgebra::DMatrix;

/// A generalised velocity; axes from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Velocity {
    /// Translational velocity vᵢ, m/s.
    Translation(usize),
    /// Spin ωₖ, rad/s.
    Spin(usize),
}
use Velocity::{Spin, Translation};

/// Unknowns and equations of a theory in space or in plane strain.
#[derive(Debug)]
pub struct UnknownLayout {
    /// Velocities, then all stresses; a layout without out-of-plane stresses uses a leading part of the list.
    unknowns: &'static [Unknown],
    /// Names of the equations: balances, then constitutive laws; used like `unknowns`.
    equations: &'static [&'static str],
    /// Generalised velocities among the unknowns.
    pub velocities: &'static [Velocity],
    /// Stress components among the unknowns.
    pub stresses: &'static [StressComponent],
    /// `stresses`, followed by the out-of-plane stresses of plane strain. These do not enter the balances and have zero
    /// conjugate strain, but enter yield conditions and energies.
    all_components: &'static [StressComponent],
}

const fn new_unknown(name: &'static str, family: &'static str) -> Unknown {
    Unknown { name, family }
}

/// Builds the static lists of unknowns and of names of equations.
macro_rules! names {
    ($($name:literal $family:literal $equation:literal;)*) => {
        (&[$(new_unknown($name, $family)),*], &[$($equation),*])
    };
}

/// Unknowns and names of the equations of a system.
type SystemNames = (&'static [Unknown], &'static [&'static str]);

static PLANE_CLASSICAL: SystemNames = names! {
    "v1" "velocity" "momentum 1";
    "v2" "velocity" "momentum 2";
    "σ11" "stress" "law of σ11";
    "σ22" "stress" "law of σ22";
    "σ12" "stress" "law of σ12";
    "σ33" "stress" "law of σ33";
};

static PLANE_REDUCED: SystemNames = names! {
    "v1" "velocity" "momentum 1";
    "v2" "velocity" "momentum 2";
    "ω3" "spin" "spin 3";
    "σ11" "stress" "law of σ11";
    "σ22" "stress" "law of σ22";
    "σ21" "stress" "law of σ21";
    "σ12" "stress" "law of σ12";
    "σ33" "stress" "law of σ33";
};

static PLANE_COSSERAT: SystemNames = names! {
    "v1" "velocity" "momentum 1";
    "v2" "velocity" "momentum 2";
    "ω3" "spin" "spin 3";
    "σ11" "stress" "law of σ11";
    "σ22" "stress" "law of σ22";
    "σ21" "stress" "law of σ21";
    "σ12" "stress" "law of σ12";
    "m31" "couple stress" "law of m31";
    "m32" "couple stress" "law of m32";
    "σ33" "stress" "law of σ33";
    "m13" "couple stress" "law of m13";
    "m23" "couple stress" "law of m23";
};

static SPACE_CLASSICAL: SystemNames = names! {
    "v1" "velocity" "momentum 1";
    "v2" "velocity" "momentum 2";
    "v3" "velocity" "momentum 3";
    "σ11" "stress" "law of σ11";
    "σ22" "stress" "law of σ22";
    "σ33" "stress" "law of σ33";
    "σ23" "stress" "law of σ23";
    "σ13" "stress" "law of σ13";
    "σ12" "stress" "law of σ12";
};

static SPACE_COSSERAT: SystemNames = names! {
    "v1" "velocity" "momentum 1";
    "v2" "velocity" "momentum 2";
    "v3" "velocity" "momentum 3";
    "ω1" "spin" "spin 1";
    "ω2" "spin" "spin 2";
    "ω3" "spin" "spin 3";
    "σ11" "stress" "law of σ11";
    "σ12" "stress" "law of σ12";
    "σ13" "stress" "law of σ13";
    "σ21" "stress" "law of σ21";
    "σ22" "stress" "law of σ22";
    "σ23" "stress" "law of σ23";
    "σ31" "stress" "law of σ31";
    "σ32" "stress" "law of σ32";
    "σ33" "stress" "law of σ33";
    "m11" "couple stress" "law of m11";
    "m12" "couple stress" "law of m12";
    "m13" "couple stress" "law of m13";
    "m21" "couple stress" "law of m21";
    "m22" "couple stress" "law of m22";
    "m23" "couple stress" "law of m23";
    "m31" "couple stress" "law of m31";
    "m32" "couple stress" "law of m32";
    "m33" "couple stress" "law of m33";
};

const PLANE_VELOCITIES: [Velocity; 3] = [Translation(0), Translation(1), Spin(2)];
const SPACE_VELOCITIES: [Velocity; 6] =
    [Translation(0), Translation(1), Translation(2), Spin(0), Spin(1), Spin(2)];

// In each list of plane-strain stresses the out-of-plane stresses are last.
const CLASSICAL_PLANE_STRESSES: [StressComponent; 4] =
    [Symmetric(0, 0), Symmetric(1, 1), Symmetric(0, 1), Symmetric(2, 2)];
const REDUCED_PLANE_STRESSES: [StressComponent; 5] =
    [Force(0, 0), Force(1, 1), Force(1, 0), Force(0, 1), Force(2, 2)];
const COSSERAT_PLANE_STRESSES: [StressComponent; 9] = [
    Force(0, 0),
    Force(1, 1),
    Force(1, 0),
    Force(0, 1),
    Couple(2, 0),
    Couple(2, 1),
    Force(2, 2),
    Couple(0, 2),
    Couple(1, 2),
];
const CLASSICAL_SPACE_STRESSES: [StressComponent; 6] = [
    Symmetric(0, 0),
    Symmetric(1, 1),
    Symmetric(2, 2),
    Symmetric(1, 2),
    Symmetric(0, 2),
    Symmetric(0, 1),
];
const COSSERAT_SPACE_STRESSES: [StressComponent; 18] = [
    Force(0, 0),
    Force(0, 1),
    Force(0, 2),
    Force(1, 0),
    Force(1, 1),
    Force(1, 2),
    Force(2, 0),
    Force(2, 1),
    Force(2, 2),
    Couple(0, 0),
    Couple(0, 1),
    Couple(0, 2),
    Couple(1, 0),
    Couple(1, 1),
    Couple(1, 2),
    Couple(2, 0),
    Couple(2, 1),
    Couple(2, 2),
];

/// Layout of the unknowns in plane strain.
pub fn plane_layout(theory: Theory) -> UnknownLayout {
    match theory {
        Theory::Classical => UnknownLayout::new(
            PLANE_CLASSICAL,
            &PLANE_VELOCITIES[..2],
            &CLASSICAL_PLANE_STRESSES,
            3,
        ),
        Theory::Reduced => {
            UnknownLayout::new(PLANE_REDUCED, &PLANE_VELOCITIES, &REDUCED_PLANE_STRESSES, 4)
        }
        Theory::Cosserat => {
            UnknownLayout::new(PLANE_COSSERAT, &PLANE_VELOCITIES, &COSSERAT_PLANE_STRESSES, 6)
        }
    }
}

/// Layout of the unknowns in three-dimensional space.
pub fn space_layout(theory: Theory) -> UnknownLayout {
    match theory {
        Theory::Classical => UnknownLayout::new(
            SPACE_CLASSICAL,
            &SPACE_VELOCITIES[..3],
            &CLASSICAL_SPACE_STRESSES,
            6,
        ),
        Theory::Reduced => {
            UnknownLayout::new(SPACE_COSSERAT, &SPACE_VELOCITIES, &COSSERAT_SPACE_STRESSES[..9], 9)
        }
        Theory::Cosserat => {
            UnknownLayout::new(SPACE_COSSERAT, &SPACE_VELOCITIES, &COSSERAT_SPACE_STRESSES, 18)
        }
    }
}

/// Permutation symbol εᵢⱼₖ (Levi-Civita).
fn permutation_symbol(i: usize, j: usize, k: usize) -> f64 {
    match (i, j, k) {
        (0, 1, 2) | (1, 2, 0) | (2, 0, 1) => 1.0,
        (2, 1, 0) | (1, 0, 2) | (0, 2, 1) => -1.0,
        _ => 0.0,
    }
}

impl UnknownLayout {
    /// Creates the layout whose stress unknowns are the first `stress_count` of `all_components`. The lists in `names`
    /// may be longer than the layout.
    fn new(
        names: SystemNames,
        velocities: &'static [Velocity],
        all_components: &'static [StressComponent],
        stress_count: usize,
    ) -> Self {
        let stresses = &all_components[..stress_count];
        Self { unknowns: names.0, equations: names.1, velocities, stresses, all_components }
    }

    /// All stress components; the out-of-plane stresses of plane strain, whether unknowns or not, are last.
    pub fn all_stresses(&self) -> impl Iterator<Item = StressComponent> + Clone {
        self.all_components.iter().copied()
    }

    /// This layout with the out-of-plane stresses among the unknowns, needed if plastic flow couples them to the
    /// in-plane stresses.
    pub fn with_out_of_plane(self) -> Self {
        Self { stresses: self.all_components, ..self }
    }

    /// This layout without out-of-plane stresses.
    pub(crate) fn without_out_of_plane(self) -> Self {
        Self { all_components: self.stresses, ..self }
    }

    /// Unknowns: velocities, then stresses.
    pub fn unknowns(&self) -> &'static [Unknown] {
        &self.unknowns[..self.velocities.len() + self.stresses.len()]
    }

    /// Names of the equations: balances, then constitutive laws.
    pub fn equations(&self) -> &'static [&'static str] {
        &self.equations[..self.velocities.len() + self.stresses.len()]
    }

    /// Gradient operator Gⁱ of the strain rates for the axis i = `axis`.
    pub fn gradient(&self, axis: usize) -> DMatrix<f64> {
        DMatrix::from_fn(self.stresses.len(), self.velocities.len(), |s, v| {
            let is_strained = match (self.stresses[s], self.velocities[v]) {
                (Force(i, j), Translation(a)) => a == i && axis == j,
                (Symmetric(i, j), Translation(a)) => (a == i && axis == j) || (a == j && axis == i),
                (Couple(k, j), Spin(a)) => a == k && axis == j,
                _ => false,
            };
            f64::from(u8::from(is_strained))
        })
    }

    /// Operator Z of the strain rates due to the spins themselves, not their gradients.
    pub fn rotation(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.stresses.len(), self.velocities.len(), |s, v| {
            match (self.stresses[s], self.velocities[v]) {
                (Force(i, j), Spin(k)) => permutation_symbol(i, j, k),
                _ => 0.0,
            }
        })
    }

    /// Rate equations with `stiffness` (Pa or N) in the order of [`all_stresses`](Self::all_stresses), `density` in
    /// kg/m³ and `inertia` in kg/m. Rows and columns of stresses that are not among the unknowns are ignored.
    pub fn rates<const D: usize>(
        &self,
        stiffness: &RoundedMatrix,
        density: f64,
        inertia: f64,
    ) -> RateEquations<D> {
        let size = self.stresses.len();
        let inertia_of = |v: &Velocity| match v {
            Translation(_) => Rounded::from_rounded(density),
            Spin(_) => Rounded::from_rounded(inertia),
        };
        RateEquations {
            unknowns: self.unknowns(),
            equations: self.equations(),
            inertia: self.velocities.iter().map(inertia_of).collect(),
            stiffness: stiffness.view((0, 0), (size, size)).into_owned(),
            gradient: std::array::from_fn(|axis| self.gradient(axis)),
            rotation: self.rotation(),
            relaxation: RoundedMatrix::from_element(size, size, Rounded::ZERO),
        }
    }
}

impl Isotropic {
    /// Layout of the unknowns in `D` = 2 (plane strain) or 3 dimensions.
    pub fn layout<const D: usize>(&self) -> UnknownLayout {
        const { assert!(D == 2 || D == 3) };
        if D == 2 { plane_layout(self.theory()) } else { space_layout(self.theory()) }
    }

    /// Stiffness matrix (Hooke's law) between the stress components `stresses`, Pa or N:
    /// σ = λ tr(Λ) δ + 2μ Λˢ + 2α Λᵃ and m = β tr(M) δ + 2γ Mˢ + 2η Mᵃ.
    pub fn stiffness(
        &self,
        stresses: impl Iterator<Item = StressComponent> + Clone,
    ) -> RoundedMatrix {
        let given = Rounded::from_rounded;
        let (lambda, mu) = (given(self.lambda), given(self.mu));
        let alpha = self.microrotation.map_or(Rounded::ZERO, |m| given(m.alpha));
        let [beta, gamma, eta] = self
            .couple()
            .map_or([Rounded::ZERO; 3], |c| [given(c.beta), given(c.gamma), given(c.eta)]);
        let isotropic = |[trace, symmetric, antisymmetric]: [Rounded; 3],
                         (i, j): (usize, usize),
                         (k, l): (usize, usize)| {
            let mut entry = Rounded::ZERO;
            if i == j && k == l {
                entry += trace;
            }
            if (i, j) == (k, l) {
                entry += symmetric + antisymmetric;
            }
            if (i, j) == (l, k) {
                entry += symmetric - antisymmetric;
            }
            entry
        };
        let list: Vec<StressComponent> = stresses.collect();
        RoundedMatrix::from_fn(list.len(), list.len(), |row, column| {
            match (list[row], list[column]) {
                (Force(i, j), Force(k, l)) => isotropic([lambda, mu, alpha], (i, j), (k, l)),
                // For i ≠ j the conjugate strain rate is the engineering shear 2Λ̇ᵢⱼ, so the coefficient is μ, not 2μ.
                (Symmetric(i, j), Symmetric(k, l)) => {
                    isotropic([lambda, mu, Rounded::ZERO], (i, j), (k, l))
                }
                (Couple(i, j), Couple(k, l)) => isotropic([beta, gamma, eta], (i, j), (k, l)),
                _ => Rounded::ZERO,
            }
        })
    }

    /// Rate equations in `D` = 2 (plane strain) or 3 dimensions.
    pub fn rates<const D: usize>(&self) -> RateEquations<D> {
        let layout = self.layout::<D>();
        let inertia = self.microrotation.map_or(0.0, |m| m.inertia);
        layout.rates(&self.stiffness(layout.all_stresses()), self.density, inertia)
    }
}

impl PlaneCompliances {
    /// Layout of the unknowns in plane strain.
    pub fn layout(&self) -> UnknownLayout {
        let layout = plane_layout(Theory::Cosserat);
        UnknownLayout { all_components: layout.stresses, ..layout }
    }

    /// Stiffness matrix, the inverse of the compliances, in the order of the [`layout`](Self::layout), Pa or N.
    pub fn stiffness(&self) -> RoundedMatrix {
        let given = Rounded::from_rounded;
        let inverse = |a: f64, b: f64| {
            let (a, b) = (given(a), given(b));
            let determinant = (a - b) * (a + b);
            (a / determinant, b / determinant)
        };
        let (normal, cross) = inverse(self.a1, self.b1);
        let (shear, transposed) = inverse(self.a2, self.b2);
        let mut stiffness = RoundedMatrix::from_element(6, 6, Rounded::ZERO);
        for ([i, j], own, other) in [([0, 1], normal, cross), ([2, 3], shear, transposed)] {
            stiffness[(i, i)] = own;
            stiffness[(j, j)] = own;
            stiffness[(i, j)] = other;
            stiffness[(j, i)] = other;
        }
        stiffness[(4, 4)] = given(self.alpha2);
        stiffness[(5, 5)] = given(self.alpha2);
        stiffness
    }

    /// Rate equations in plane strain.
    pub fn rates(&self) -> RateEquations<2> {
        self.layout().rates(&self.stiffness(), self.density, self.inertia)
    }
}
