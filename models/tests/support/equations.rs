//! Nonlinear equations of the granular-flow models, written with the tensors of Harris & Grekova (2005).
//!
//! Their equations are: stress (6) with the yield condition (13) at equality, momentum (7), spin (9), mass (18);
//! kinematics as the sum of two dilatant shears and a rotation (32)–(36), where the two shear rates are computed and
//! eliminated. For the plastic-potential model the potential is differentiated. No formula is copied from the crate
//! under test, only the documented order and scaling of its equations: eqs (50), (51) multiplied out.

use super::{DifferentiableReal, Dual};

/// Unknowns in the order of the arrays of [`PointFields`] and [`Linearisation`].
pub const UNKNOWNS: [&str; 6] =
    ["velocity 1", "velocity 2", "spin", "pressure", "stress angle", "density"];
pub const SPIN_INDEX: usize = 2;
pub const PRESSURE_INDEX: usize = 3;
pub const STRESS_ANGLE_INDEX: usize = 4;
pub const DENSITY_INDEX: usize = 5;

/// Equations in the order of [`residuals`].
pub const EQUATIONS: [&str; 6] = ["momentum 1", "momentum 2", "spin", "volume", "rotation", "mass"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationLaw {
    /// Material rotation equal to the intrinsic spin.
    IntrinsicSpin,
    /// Material rotation equal to the rotation rate of the principal stress axes.
    StressAxes,
    /// No material rotation: flow rule from a plastic potential.
    PlasticPotential,
}

/// Constants and prescribed fields, which are not perturbed.
#[derive(Clone, Copy, Debug)]
pub struct PrescribedFields<T> {
    pub rotation: RotationLaw,
    pub friction_angle: T,
    pub dilatancy_angle: T,
    pub cohesion: T,
    pub inertia: T,
    pub inertia_time_derivative: T,
    pub inertia_gradient: [T; 2],
    pub rotational_stress: T,
    pub body_force: [T; 2],
    pub body_moment: T,
}

/// Unknowns, their time derivatives and their gradients at a point.
#[derive(Clone, Copy, Debug)]
pub struct PointFields<T> {
    pub z: [T; 6],
    pub time_derivatives: [T; 6],
    pub space_derivatives: [[T; 6]; 2],
}

impl<T: DifferentiableReal> PrescribedFields<T> {
    pub fn to_dual(self) -> PrescribedFields<Dual<T>> {
        PrescribedFields {
            rotation: self.rotation,
            friction_angle: Dual::from_value(self.friction_angle),
            dilatancy_angle: Dual::from_value(self.dilatancy_angle),
            cohesion: Dual::from_value(self.cohesion),
            inertia: Dual::from_value(self.inertia),
            inertia_time_derivative: Dual::from_value(self.inertia_time_derivative),
            inertia_gradient: self.inertia_gradient.map(Dual::from_value),
            rotational_stress: Dual::from_value(self.rotational_stress),
            body_force: self.body_force.map(Dual::from_value),
            body_moment: Dual::from_value(self.body_moment),
        }
    }
}

impl<T: DifferentiableReal> PointFields<T> {
    pub fn to_dual(self) -> PointFields<Dual<T>> {
        PointFields {
            z: self.z.map(Dual::from_value),
            time_derivatives: self.time_derivatives.map(Dual::from_value),
            space_derivatives: self.space_derivatives.map(|row| row.map(Dual::from_value)),
        }
    }

    /// Material derivative ∂ₜ + v·∇ of an unknown.
    pub fn material_derivative(&self, unknown: usize) -> T {
        self.time_derivatives[unknown]
            + self.z[0] * self.space_derivatives[0][unknown]
            + self.z[1] * self.space_derivatives[1][unknown]
    }
}

/// Stress tensor on yield, eq. (6); first index = face normal, as in Harris & Grekova (2005).
pub fn stress_on_yield<T: DifferentiableReal>(
    given: &PrescribedFields<T>,
    pressure: T,
    angle: T,
) -> [[T; 2]; 2] {
    let phi = given.friction_angle;
    let q = pressure * phi.sin() + given.cohesion * phi.cos();
    let r = given.rotational_stress;
    let twice = angle + angle;
    let (s, c) = twice.sin_cos();
    [[-pressure + q * c, r + q * s], [-r + q * s, -pressure - q * c]]
}

/// Divergence ∂₁σ₁ᵢ + ∂₂σ₂ᵢ of the stress, by automatic differentiation of the tensor along both axes.
fn stress_divergence<T: DifferentiableReal>(
    given: &PrescribedFields<T>,
    fields: &PointFields<T>,
) -> [T; 2] {
    let to_dual = given.to_dual();
    let along = |axis: usize| {
        let field = |unknown: usize| Dual {
            value: fields.z[unknown],
            derivative: fields.space_derivatives[axis][unknown],
        };
        stress_on_yield(&to_dual, field(PRESSURE_INDEX), field(STRESS_ANGLE_INDEX))
    };
    let (by_first, by_second) = (along(0), along(1));
    [0, 1].map(|i| by_first[0][i].derivative + by_second[1][i].derivative)
}

/// Velocity gradient Γᵢⱼ = ∂ⱼvᵢ.
fn velocity_gradient<T: DifferentiableReal>(fields: &PointFields<T>) -> [[T; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| fields.space_derivatives[j][i]))
}

fn outer_product<T: DifferentiableReal>(a: [T; 2], b: [T; 2]) -> [[T; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i] * b[j]))
}

/// Combinations of the components of a tensor Γ: trace, Γ₁₁ − Γ₂₂, Γ₁₂ + Γ₂₁, Γ₁₂ − Γ₂₁.
fn tensor_components<T: DifferentiableReal>(g: [[T; 2]; 2]) -> [T; 4] {
    [g[0][0] + g[1][1], g[0][0] - g[1][1], g[0][1] + g[1][0], g[0][1] - g[1][0]]
}

/// Residuals of the kinematics Γ = k₁ t_β₁⊗n_α₂ − k₂ t_β₂⊗n_α₁ + Ω (eq. 32), with the unit tangents t and unit normals
/// n of the slip lines and the rotation Ω. The shear rates k₁ and k₂ are computed from the deviatoric symmetric part;
/// the residuals of the trace and of the antisymmetric part are multiplied by cos(φ − ν) and sin(φ − ν), the scaling of
/// eqs (50), (51).
fn shear_kinematics_residuals<T: DifferentiableReal>(
    given: &PrescribedFields<T>,
    fields: &PointFields<T>,
    rotation: T,
) -> [T; 2] {
    let (phi, nu, psi) =
        (given.friction_angle, given.dilatancy_angle, fields.z[STRESS_ANGLE_INDEX]);
    let half = T::from_f64(0.5);
    // ε = π/4 + φ/2, and sin π/4 = cos π/4 = √½.
    let quarter = T::sqrt_half();
    let unit_vector = |angle: T, sign: f64| {
        // (cos, sin) of `angle` ± π/4, with the sign of `sign`.
        let (s, c) = angle.sin_cos();
        let sign = T::from_f64(sign);
        [quarter * (c - sign * s), quarter * (s + sign * c)]
    };
    let half_phi = phi * half;
    let beta_1 = unit_vector(psi - half_phi + nu, -1.0);
    let beta_2 = unit_vector(psi + half_phi - nu, 1.0);
    let alpha_1 = unit_vector(psi + half_phi, 1.0);
    let alpha_2 = unit_vector(psi - half_phi, -1.0);
    let normal = |t: [T; 2]| [-t[1], t[0]];
    let first = tensor_components(outer_product(beta_1, normal(alpha_2)));
    let second = tensor_components(outer_product(beta_2, normal(alpha_1))).map(|x| -x);
    let [trace, normal_part, shear_part, antisymmetric_part] =
        tensor_components(velocity_gradient(fields));

    let determinant = first[1] * second[2] - first[2] * second[1];
    let k1 = (normal_part * second[2] - shear_part * second[1]) / determinant;
    let k2 = (first[1] * shear_part - first[2] * normal_part) / determinant;
    let difference = phi - nu;
    [
        difference.cos() * (trace - k1 * first[0] - k2 * second[0]),
        // Ω₁₂ − Ω₂₁ = −2ω with the material rotation ω (eq. 33).
        difference.sin()
            * (antisymmetric_part - k1 * first[3] - k2 * second[3] + rotation + rotation),
    ]
}

/// Residuals of the flow rule d = λ ∂g/∂σ with the plastic potential
/// g = ½√((σ₁₁ − σ₂₂)² + (σ₁₂ + σ₂₁)²) + ½ (σ₁₁ + σ₂₂) sin ν: the multiplier λ is computed from the deviators; the
/// residuals are the trace of d − λ ∂g/∂σ and the cross product of the deviators of d and ∂g/∂σ.
fn plastic_potential_residuals<T: DifferentiableReal>(
    given: &PrescribedFields<T>,
    fields: &PointFields<T>,
) -> [T; 2] {
    let stress = stress_on_yield(given, fields.z[PRESSURE_INDEX], fields.z[STRESS_ANGLE_INDEX]);
    let [_, difference, shear, _] = tensor_components(stress);
    // Gradient ∂q/∂σ from q² = ¼(difference² + shear²), with q from the yield condition.
    let phi = given.friction_angle;
    let q = fields.z[PRESSURE_INDEX] * phi.sin() + given.cohesion * phi.cos();
    let quarter = T::from_f64(0.25);
    let (by_difference, by_shear) = (quarter * difference / q, quarter * shear / q);
    let half_sine = T::from_f64(0.5) * given.dilatancy_angle.sin();
    let gradient = [[by_difference + half_sine, by_shear], [by_shear, half_sine - by_difference]];
    let [m_trace, m_normal, m_shear, _] = tensor_components(gradient);
    let [trace, normal, shear, _] = tensor_components(velocity_gradient(fields));
    let lambda = (normal * m_normal + shear * m_shear) / (m_normal * m_normal + m_shear * m_shear);
    [trace - lambda * m_trace, shear * m_normal - normal * m_shear]
}

/// Residuals of the six nonlinear equations, in the order of [`EQUATIONS`], including body force and body moment.
pub fn residuals<T: DifferentiableReal>(
    given: &PrescribedFields<T>,
    fields: &PointFields<T>,
) -> [T; 6] {
    let density = fields.z[DENSITY_INDEX];
    let forces = stress_divergence(given, fields);
    let momentum = [0, 1].map(|i| {
        density * fields.material_derivative(i) - forces[i] - density * given.body_force[i]
    });

    let inertia_rate = given.inertia_time_derivative
        + fields.z[0] * given.inertia_gradient[0]
        + fields.z[1] * given.inertia_gradient[1];
    let r = given.rotational_stress;
    let spin = density * given.inertia * fields.material_derivative(SPIN_INDEX)
        + density * inertia_rate * fields.z[SPIN_INDEX]
        - r
        - r
        - density * given.body_moment;

    let [volume, rotation] = match given.rotation {
        RotationLaw::IntrinsicSpin => {
            shear_kinematics_residuals(given, fields, fields.z[SPIN_INDEX])
        }
        RotationLaw::StressAxes => shear_kinematics_residuals(
            given,
            fields,
            fields.material_derivative(STRESS_ANGLE_INDEX),
        ),
        RotationLaw::PlasticPotential => plastic_potential_residuals(given, fields),
    };
    let gradient = velocity_gradient(fields);
    let mass =
        fields.material_derivative(DENSITY_INDEX) + density * (gradient[0][0] + gradient[1][1]);
    [momentum[0], momentum[1], spin, volume, rotation, mass]
}

/// Derivatives of the residuals of the six equations at a point, entry \[equation\]\[unknown\].
pub struct Linearisation<T> {
    /// Derivatives A with respect to ∂ₜz.
    pub a: [[T; 6]; 6],
    /// Derivatives Bⁱ + VᵢA with respect to ∂ᵢz.
    pub b: [[[T; 6]; 6]; 2],
    /// Derivatives C with respect to z.
    pub c: [[T; 6]; 6],
}

pub fn linearise<T: DifferentiableReal>(
    given: &PrescribedFields<T>,
    fields: &PointFields<T>,
) -> Linearisation<T> {
    let to_dual = given.to_dual();
    let derivative = |seed: &dyn Fn(&mut PointFields<Dual<T>>, usize)| {
        let mut matrix = [[T::from_f64(0.0); 6]; 6];
        for unknown in 0..6 {
            let mut seeded = fields.to_dual();
            seed(&mut seeded, unknown);
            for (row, residual) in matrix.iter_mut().zip(residuals(&to_dual, &seeded)) {
                row[unknown] = residual.derivative;
            }
        }
        matrix
    };
    let one = T::from_f64(1.0);
    Linearisation {
        a: derivative(&|f, u| f.time_derivatives[u].derivative = one),
        b: [
            derivative(&|f, u| f.space_derivatives[0][u].derivative = one),
            derivative(&|f, u| f.space_derivatives[1][u].derivative = one),
        ],
        c: derivative(&|f, u| f.z[u].derivative = one),
    }
}
