//! Stress of a Cosserat solid, and lists of its components.

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

/// Trace over 3, symmetric deviator and antisymmetric part. Differences between the normal stresses
/// come first: a deviator far smaller than the mean keeps its digits.
pub(crate) fn split(t: &[[f64; 3]; 3]) -> (f64, [[f64; 3]; 3], [[f64; 3]; 3]) {
    let mean = (t[0][0] + t[1][1] + t[2][2]) / 3.0;
    let entries =
        |f: &dyn Fn(usize, usize) -> f64| std::array::from_fn(|i| std::array::from_fn(|j| f(i, j)));
    let deviator = entries(&|i, j| {
        if i == j {
            ((t[i][i] - t[(i + 1) % 3][(i + 1) % 3]) + (t[i][i] - t[(i + 2) % 3][(i + 2) % 3]))
                / 3.0
        } else {
            0.5 * (t[i][j] + t[j][i])
        }
    });
    (mean, deviator, entries(&|i, j| 0.5 * (t[i][j] - t[j][i])))
}

/// |t|².
pub(crate) fn square(t: &[[f64; 3]; 3]) -> f64 {
    t.iter().flatten().map(|x| x * x).sum()
}
