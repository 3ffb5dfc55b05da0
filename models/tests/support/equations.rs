//! Nonlinear equations of the granular-flow models, written with the tensors of the papers.
//!
//! Harris & Grekova (2005): stress (6) with the yield condition (13) at equality, momentum (7), spin (9), mass (18);
//! kinematics as the sum of two dilatant shears and a rotation (32)–(36), where the two shear strengths are computed
//! and eliminated. The plastic potential is differentiated. No formula is copied from the crate under test, only the
//! documented order and scaling of its equations: eqs (50), (51) multiplied out.

use super::{Dual, Real};

/// Unknowns in the order of the arrays below.
pub const UNKNOWNS: [&str; 6] =
    ["velocity 1", "velocity 2", "spin", "pressure", "stress angle", "density"];
pub const SPIN: usize = 2;
pub const PRESSURE: usize = 3;
pub const ANGLE: usize = 4;
pub const DENSITY: usize = 5;

/// Equations in the order of [`residuals`].
pub const EQUATIONS: [&str; 6] = ["momentum 1", "momentum 2", "spin", "volume", "rotation", "mass"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    /// Intrinsic spin.
    Intrinsic,
    /// Rotation rate of the principal stress axes.
    StressAxes,
    /// No rotation: flow rule from a plastic potential.
    Potential,
}

/// Constants and prescribed fields, which are not perturbed.
#[derive(Clone, Copy, Debug)]
pub struct Prescribed<T> {
    pub rotation: Rotation,
    pub friction_angle: T,
    pub dilatancy_angle: T,
    pub cohesion: T,
    pub inertia: T,
    pub inertia_by_time: T,
    pub inertia_gradient: [T; 2],
    pub rotational_stress: T,
    pub body_force: [T; 2],
    pub body_moment: T,
}

/// Unknowns, their time derivatives and their gradients at a point.
#[derive(Clone, Copy, Debug)]
pub struct Fields<T> {
    pub z: [T; 6],
    pub by_time: [T; 6],
    pub by_space: [[T; 6]; 2],
}

impl<T: Real> Prescribed<T> {
    pub fn lifted(&self) -> Prescribed<Dual<T>> {
        Prescribed {
            rotation: self.rotation,
            friction_angle: Dual::of(self.friction_angle),
            dilatancy_angle: Dual::of(self.dilatancy_angle),
            cohesion: Dual::of(self.cohesion),
            inertia: Dual::of(self.inertia),
            inertia_by_time: Dual::of(self.inertia_by_time),
            inertia_gradient: self.inertia_gradient.map(Dual::of),
            rotational_stress: Dual::of(self.rotational_stress),
            body_force: self.body_force.map(Dual::of),
            body_moment: Dual::of(self.body_moment),
        }
    }
}

impl<T: Real> Fields<T> {
    pub fn lifted(&self) -> Fields<Dual<T>> {
        Fields {
            z: self.z.map(Dual::of),
            by_time: self.by_time.map(Dual::of),
            by_space: self.by_space.map(|row| row.map(Dual::of)),
        }
    }

    /// Material derivative ∂ₜ + v·∇ of an unknown.
    pub fn material(&self, unknown: usize) -> T {
        self.by_time[unknown]
            + self.z[0] * self.by_space[0][unknown]
            + self.z[1] * self.by_space[1][unknown]
    }
}

/// Stress tensor on yield, eq. (6); first index = face normal, as in the paper.
pub fn paper_stress<T: Real>(given: &Prescribed<T>, pressure: T, angle: T) -> [[T; 2]; 2] {
    let phi = given.friction_angle;
    let q = pressure * phi.sin() + given.cohesion * phi.cos();
    let r = given.rotational_stress;
    let twice = angle + angle;
    let (s, c) = twice.sin_cos();
    [[-pressure + q * c, r + q * s], [-r + q * s, -pressure - q * c]]
}

/// Divergence ∂₁σ₁ᵢ + ∂₂σ₂ᵢ of the stress, by automatic differentiation of the tensor along both axes.
fn divergence<T: Real>(given: &Prescribed<T>, fields: &Fields<T>) -> [T; 2] {
    let lifted = given.lifted();
    let along = |axis: usize| {
        let field = |unknown: usize| Dual {
            value: fields.z[unknown],
            slope: fields.by_space[axis][unknown],
        };
        paper_stress(&lifted, field(PRESSURE), field(ANGLE))
    };
    let (by_first, by_second) = (along(0), along(1));
    [0, 1].map(|i| by_first[0][i].slope + by_second[1][i].slope)
}

/// Velocity gradient Γᵢⱼ = ∂ⱼvᵢ.
fn velocity_gradient<T: Real>(fields: &Fields<T>) -> [[T; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| fields.by_space[j][i]))
}

fn outer<T: Real>(a: [T; 2], b: [T; 2]) -> [[T; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i] * b[j]))
}

/// Parts of a tensor Γ: trace, Γ₁₁ − Γ₂₂, Γ₁₂ + Γ₂₁, Γ₁₂ − Γ₂₁.
fn parts<T: Real>(g: [[T; 2]; 2]) -> [T; 4] {
    [g[0][0] + g[1][1], g[0][0] - g[1][1], g[0][1] + g[1][0], g[0][1] - g[1][0]]
}

/// Residuals of the kinematics Γ = k₁ t_β₁⊗n_α₂ − k₂ t_β₂⊗n_α₁ + Ω (eq. 32): the shear strengths k₁, k₂ are computed
/// from the deviatoric symmetric part; the residuals of the trace and of the antisymmetric part are multiplied by cos(φ
/// − ν) and sin(φ − ν), the scaling of eqs (50), (51).
fn shears<T: Real>(given: &Prescribed<T>, fields: &Fields<T>, rotation: T) -> [T; 2] {
    let (phi, nu, psi) = (given.friction_angle, given.dilatancy_angle, fields.z[ANGLE]);
    let half = T::constant(0.5);
    // ε = π/4 + φ/2, and sin π/4 = cos π/4 = √½.
    let quarter = T::root_of_half();
    let turned = |angle: T, sign: f64| {
        // cos and sin of angle ± π/4.
        let (s, c) = angle.sin_cos();
        let sign = T::constant(sign);
        [quarter * (c - sign * s), quarter * (s + sign * c)]
    };
    let half_phi = phi * half;
    let beta_1 = turned(psi - half_phi + nu, -1.0);
    let beta_2 = turned(psi + half_phi - nu, 1.0);
    let alpha_1 = turned(psi + half_phi, 1.0);
    let alpha_2 = turned(psi - half_phi, -1.0);
    let normal = |t: [T; 2]| [-t[1], t[0]];
    let first = parts(outer(beta_1, normal(alpha_2)));
    let second = parts(outer(beta_2, normal(alpha_1))).map(|x| -x);
    let [trace, normal_part, shear_part, turn] = parts(velocity_gradient(fields));

    let determinant = first[1] * second[2] - first[2] * second[1];
    let k1 = (normal_part * second[2] - shear_part * second[1]) / determinant;
    let k2 = (first[1] * shear_part - first[2] * normal_part) / determinant;
    let difference = phi - nu;
    [
        difference.cos() * (trace - k1 * first[0] - k2 * second[0]),
        // Ω₁₂ − Ω₂₁ = −2ω (eq. 33)
        difference.sin() * (turn - k1 * first[3] - k2 * second[3] + rotation + rotation),
    ]
}

/// Residuals of the flow rule d = λ ∂g/∂σ with g = ½√((σ₁₁ − σ₂₂)² + (σ₁₂ + σ₂₁)²) + ½ (σ₁₁ + σ₂₂) sin ν: λ is computed
/// from the deviator; the residuals are the trace of d − λ ∂g/∂σ and the cross product of the deviators of d and ∂g/∂σ.
fn potential<T: Real>(given: &Prescribed<T>, fields: &Fields<T>) -> [T; 2] {
    let stress = paper_stress(given, fields.z[PRESSURE], fields.z[ANGLE]);
    let [_, difference, shear, _] = parts(stress);
    // ∂q/∂σ from q² = ¼(difference² + shear²), with q from the yield condition.
    let phi = given.friction_angle;
    let q = fields.z[PRESSURE] * phi.sin() + given.cohesion * phi.cos();
    let quarter = T::constant(0.25);
    let (by_difference, by_shear) = (quarter * difference / q, quarter * shear / q);
    let half_sine = T::constant(0.5) * given.dilatancy_angle.sin();
    let gradient = [[by_difference + half_sine, by_shear], [by_shear, half_sine - by_difference]];
    let [m_trace, m_normal, m_shear, _] = parts(gradient);
    let [trace, normal, shear, _] = parts(velocity_gradient(fields));
    let lambda = (normal * m_normal + shear * m_shear) / (m_normal * m_normal + m_shear * m_shear);
    [trace - lambda * m_trace, shear * m_normal - normal * m_shear]
}

/// Residuals of all six equations, including body force and body moment.
pub fn residuals<T: Real>(given: &Prescribed<T>, fields: &Fields<T>) -> [T; 6] {
    let density = fields.z[DENSITY];
    let forces = divergence(given, fields);
    let momentum =
        [0, 1].map(|i| density * fields.material(i) - forces[i] - density * given.body_force[i]);

    let inertia_rate = given.inertia_by_time
        + fields.z[0] * given.inertia_gradient[0]
        + fields.z[1] * given.inertia_gradient[1];
    let r = given.rotational_stress;
    let spin = density * given.inertia * fields.material(SPIN)
        + density * inertia_rate * fields.z[SPIN]
        - r
        - r
        - density * given.body_moment;

    let [volume, rotation] = match given.rotation {
        Rotation::Intrinsic => shears(given, fields, fields.z[SPIN]),
        Rotation::StressAxes => shears(given, fields, fields.material(ANGLE)),
        Rotation::Potential => potential(given, fields),
    };
    let gradient = velocity_gradient(fields);
    let mass = fields.material(DENSITY) + density * (gradient[0][0] + gradient[1][1]);
    [momentum[0], momentum[1], spin, volume, rotation, mass]
}

/// Derivatives of the six equations at a point, entry \[equation\]\[unknown\].
pub struct Linearised<T> {
    /// Derivatives A with respect to ∂ₜz.
    pub a: [[T; 6]; 6],
    /// Derivatives Bⁱ + VᵢA with respect to ∂ᵢz.
    pub b: [[[T; 6]; 6]; 2],
    /// Derivatives C with respect to z.
    pub c: [[T; 6]; 6],
}

pub fn linearised<T: Real>(given: &Prescribed<T>, fields: &Fields<T>) -> Linearised<T> {
    let lifted = given.lifted();
    let derivative = |mark: &dyn Fn(&mut Fields<Dual<T>>, usize)| {
        let mut matrix = [[T::constant(0.0); 6]; 6];
        for unknown in 0..6 {
            let mut marked = fields.lifted();
            mark(&mut marked, unknown);
            for (row, residual) in matrix.iter_mut().zip(residuals(&lifted, &marked)) {
                row[unknown] = residual.slope;
            }
        }
        matrix
    };
    let one = T::constant(1.0);
    Linearised {
        a: derivative(&|f, u| f.by_time[u].slope = one),
        b: [
            derivative(&|f, u| f.by_space[0][u].slope = one),
            derivative(&|f, u| f.by_space[1][u].slope = one),
        ],
        c: derivative(&|f, u| f.z[u].slope = one),
    }
}
