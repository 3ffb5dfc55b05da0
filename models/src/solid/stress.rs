//! Stress of a Cosserat solid, and lists of its components.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use crate::common::number::{Number, third};

/// Force stress and couple stress in space. The second index is the face normal: σᵢⱼ is the i-th
/// component of the traction on the face with normal j, mₖⱼ the couple about axis k on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    /// σ, Pa; not symmetric in general.
    pub force: [[f64; 3]; 3],
    /// m, N/m.
    pub couple: [[f64; 3]; 3],
}

/// A component of the stress as an unknown; indices from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// σᵢⱼ, worked on by ∂ⱼvᵢ + εᵢⱼₖωₖ.
    Force(usize, usize),
    /// σᵢⱼ = σⱼᵢ of a classical solid, i ≤ j, worked on by ∂ⱼvᵢ + ∂ᵢvⱼ (for i = j by ∂ᵢvᵢ).
    Symmetric(usize, usize),
    /// mₖⱼ, worked on by ∂ⱼωₖ.
    Couple(usize, usize),
}

impl Component {
    /// Its value.
    pub fn of(self, stress: &Stress) -> f64 {
        match self {
            Self::Force(i, j) => stress.force[i][j],
            Self::Symmetric(i, j) => 0.5 * (stress.force[i][j] + stress.force[j][i]),
            Self::Couple(k, j) => stress.couple[k][j],
        }
    }

    /// Sets it.
    pub fn set(self, stress: &mut Stress, value: f64) {
        match self {
            Self::Force(i, j) => stress.force[i][j] = value,
            Self::Symmetric(i, j) => {
                stress.force[i][j] = value;
                stress.force[j][i] = value;
            }
            Self::Couple(k, j) => stress.couple[k][j] = value,
        }
    }

    /// The derivative by it of a function of the stress whose derivatives by all components of σ and
    /// m are `gradient`.
    pub fn derivative(self, gradient: &Stress) -> f64 {
        match self {
            Self::Symmetric(i, j) if i != j => gradient.force[i][j] + gradient.force[j][i],
            _ => self.of(gradient),
        }
    }
}

/// The nine components of a tensor, by rows.
pub type Tensor<N> = [[N; 3]; 3];

/// What is known of a stress beforehand, so that nothing is computed of what is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// The force stress is symmetric, to the bit.
    pub is_symmetric: bool,
    /// Of the force stress σ₁₃, σ₂₃, σ₃₁ and σ₃₂ are zero, of the couple stress all but m₁₃, m₂₃, m₃₁ and m₃₂.
    pub is_plane: bool,
    /// There is couple stress.
    pub has_couples: bool,
}

impl Shape {
    /// Nothing is known.
    pub const ANY: Self = Self { is_symmetric: false, is_plane: false, has_couples: true };

    /// Whether a component of the force stress (0) or the couple stress (1) may be other than zero.
    #[inline(always)]
    pub const fn has(self, which: usize, i: usize, j: usize) -> bool {
        let is_across = (i == 2) != (j == 2);
        match which {
            0 => !(self.is_plane && is_across),
            _ => self.has_couples && (!self.is_plane || is_across),
        }
    }

    /// |t|² of the force stress (0) or the couple stress (1), or of a part of it.
    #[inline(always)]
    pub fn square<N: Number>(self, which: usize, t: &Tensor<N>) -> N {
        let mut sum = N::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                if self.has(which, i, j) {
                    sum = sum + t[i][j] * t[i][j];
                }
            }
        }
        sum
    }

    /// The same of an antisymmetric part.
    #[inline(always)]
    pub fn square_antisymmetric<N: Number>(self, which: usize, t: &Tensor<N>) -> N {
        let mut sum = N::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                if i != j && self.has(which, i, j) {
                    sum = sum + t[i][j] * t[i][j];
                }
            }
        }
        sum
    }

    /// Mean, symmetric deviator and antisymmetric part of a force stress or, if there is one, of the couple stress.
    /// Differences between the normal stresses come first: a deviator far smaller than the mean keeps its digits.
    #[inline(always)]
    pub fn split<N: Number>(self, t: &Tensor<N>) -> (N, Tensor<N>, Tensor<N>) {
        let mean = third(t[0][0] + t[1][1] + t[2][2]);
        let (mut deviator, mut antisymmetric) = ([[N::ZERO; 3]; 3], [[N::ZERO; 3]; 3]);
        for i in 0..3 {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            deviator[i][i] = third((t[i][i] - t[next][next]) + (t[i][i] - t[last][last]));
            for j in [next, last] {
                if self.is_symmetric {
                    deviator[i][j] = t[i][j];
                } else {
                    deviator[i][j] = N::HALF * (t[i][j] + t[j][i]);
                    antisymmetric[i][j] = N::HALF * (t[i][j] - t[j][i]);
                }
            }
        }
        (mean, deviator, antisymmetric)
    }
}

/// Mean, symmetric deviator and antisymmetric part.
pub(crate) fn split(t: &Tensor<f64>) -> (f64, Tensor<f64>, Tensor<f64>) {
    Shape::ANY.split(t)
}

/// |t|².
pub(crate) fn square(t: &Tensor<f64>) -> f64 {
    Shape::ANY.square(0, t)
}
