//! Stress of a Cosserat solid: force stress and couple stress, their components and invariants.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use crate::common::number::{Number, divide_by_three};

/// Force stress and couple stress in space. The second index is the face normal: σᵢⱼ is the i-th
/// component of the traction on the face with normal j, mₖⱼ the couple about axis k on that face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    /// Force stress σ, Pa; not symmetric in general.
    pub force: [[f64; 3]; 3],
    /// Couple stress m, N/m.
    pub couple: [[f64; 3]; 3],
}

/// A stress component as an unknown; indices from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressComponent {
    /// Force stress σᵢⱼ, work-conjugate to ∂ⱼvᵢ + εᵢⱼₖωₖ.
    Force(usize, usize),
    /// Stress σᵢⱼ = σⱼᵢ of a classical solid, i ≤ j, work-conjugate to ∂ⱼvᵢ + ∂ᵢvⱼ (to ∂ᵢvᵢ for i = j).
    Symmetric(usize, usize),
    /// Couple stress mₖⱼ, work-conjugate to ∂ⱼωₖ.
    Couple(usize, usize),
}

impl StressComponent {
    /// Whether the component is a couple stress, N/m, or else a force stress, Pa.
    pub fn is_couple(self) -> bool {
        matches!(self, Self::Couple(..))
    }

    /// Value of the component in `stress`; of a symmetric component the mean of σᵢⱼ and σⱼᵢ.
    pub fn value_in(self, stress: &Stress) -> f64 {
        match self {
            Self::Force(i, j) => stress.force[i][j],
            Self::Symmetric(i, j) => 0.5 * (stress.force[i][j] + stress.force[j][i]),
            Self::Couple(k, j) => stress.couple[k][j],
        }
    }

    /// Sets the component in `stress` to `value`; of a symmetric stress both σᵢⱼ and σⱼᵢ.
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

    /// Derivative with respect to this component of a function of the stress, from its `gradient` (the derivatives with
    /// respect to all components of σ and m).
    pub fn derivative(self, gradient: &Stress) -> f64 {
        match self {
            Self::Symmetric(i, j) if i != j => gradient.force[i][j] + gradient.force[j][i],
            _ => self.value_in(gradient),
        }
    }
}

/// A second-order tensor in space, by rows.
pub type Tensor<N> = [[N; 3]; 3];

/// Known zeros and symmetries of a stress, which kernels use to skip terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StressShape {
    /// Whether the force stress is bitwise symmetric; [`split`](Self::split) then takes its argument as symmetric.
    pub is_symmetric: bool,
    /// Plane strain: σ₁₃, σ₂₃, σ₃₁, σ₃₂ are zero, and all couple stresses except m₁₃, m₂₃, m₃₁, m₃₂.
    pub is_plane: bool,
    /// Whether the couple stress may be nonzero; if false, it is ignored.
    pub has_couples: bool,
}

impl StressShape {
    /// A general stress without known zeros or symmetry.
    pub const GENERAL: Self = Self { is_symmetric: false, is_plane: false, has_couples: true };

    /// Whether component (i, j) of the force stress (`tensor_index` = 0) or couple stress (1) may be nonzero.
    #[inline(always)]
    pub const fn has_component(self, tensor_index: usize, i: usize, j: usize) -> bool {
        let is_across = (i == 2) != (j == 2);
        match tensor_index {
            0 => !(self.is_plane && is_across),
            _ => self.has_couples && (!self.is_plane || is_across),
        }
    }

    /// Squared Frobenius norm |t|² of (a part of) the force stress (`tensor_index` = 0) or couple stress (1).
    #[inline(always)]
    pub fn squared_norm<N: Number>(self, tensor_index: usize, t: &Tensor<N>) -> N {
        let mut sum = N::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                if self.has_component(tensor_index, i, j) {
                    sum = sum + t[i][j] * t[i][j];
                }
            }
        }
        sum
    }

    /// Squared Frobenius norm |t|² of an antisymmetric tensor t: of the antisymmetric part of the force stress
    /// (`tensor_index` = 0) or couple stress (1).
    #[inline(always)]
    pub fn squared_norm_antisymmetric<N: Number>(self, tensor_index: usize, t: &Tensor<N>) -> N {
        let mut sum = N::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                if i != j && self.has_component(tensor_index, i, j) {
                    sum = sum + t[i][j] * t[i][j];
                }
            }
        }
        sum
    }

    /// Splits a force or couple stress into mean, symmetric deviator and antisymmetric part. The deviator is formed
    /// from differences of the normal stresses, which avoids cancellation if the mean is much larger.
    #[inline(always)]
    pub fn split<N: Number>(self, t: &Tensor<N>) -> (N, Tensor<N>, Tensor<N>) {
        let mean = divide_by_three(t[0][0] + t[1][1] + t[2][2]);
        let (mut deviator, mut antisymmetric) = ([[N::ZERO; 3]; 3], [[N::ZERO; 3]; 3]);
        for i in 0..3 {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            deviator[i][i] = divide_by_three((t[i][i] - t[next][next]) + (t[i][i] - t[last][last]));
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

/// Splits a tensor into mean, symmetric deviator and antisymmetric part.
pub(crate) fn split(t: &Tensor<f64>) -> (f64, Tensor<f64>, Tensor<f64>) {
    StressShape::GENERAL.split(t)
}

/// Squared Frobenius norm |t|² of a tensor.
pub(crate) fn squared_norm(t: &Tensor<f64>) -> f64 {
    StressShape::GENERAL.squared_norm(0, t)
}
