//! Linearised equations of a random incompressible (ν = 0) Harris–Grekova flow, derived from the nonlinear equations.

use crate::errata::comparison::Comparison;
use crate::support::equations::{SPIN_INDEX, linearise};
use crate::support::states::{self, DilatancyKind};
use crate::support::{
    Complex, DifferentiableReal, DoubleDouble, Polynomial, RandomNumbers, complex, dd,
    polynomial_determinant,
};
use testkit::flows::FlowParameters;
use wellposed_models::flow::state::{DeformingFlow, MaterialState};
use wellposed_models::registry;

/// Number of random flows per test.
pub const STATE_COUNT: usize = 250;

/// Calls `check` for [`STATE_COUNT`] random flows of the sequence of `seed`.
pub fn for_random_flows(seed: u64, mut check: impl FnMut(&mut RandomNumbers, IncompressibleFlow)) {
    let mut random = RandomNumbers::new(seed);
    for _ in 0..STATE_COUNT {
        let system = IncompressibleFlow::new_random(&mut random);
        check(&mut random, system);
    }
}

/// Calls `compare` for [`STATE_COUNT`] random flows and asserts that the printed formula is wrong in nearly all of the
/// comparisons that it adds, and the corrected formula right in all.
pub fn compare_random_flows(
    seed: u64,
    mut compare: impl FnMut(&mut RandomNumbers, IncompressibleFlow, &mut Comparison),
) {
    let mut comparison = Comparison::default();
    for_random_flows(seed, |random, system| compare(random, system, &mut comparison));
    comparison.assert_mostly_misprinted();
}

/// An incompressible background and its linearisation, derived from the nonlinear equations.
pub struct IncompressibleFlow {
    pub parameters: FlowParameters,
    pub state: MaterialState,
    pub flow: DeformingFlow,
    /// Matrix A; like B and C with the rows momentum 1, 2, spin, continuity, rotation and columns v₁, v₂, ω, p, ψ.
    pub a: [[DoubleDouble; 5]; 5],
    pub b: [[[DoubleDouble; 5]; 5]; 2],
    pub c: [[DoubleDouble; 5]; 5],
    pub spin: DoubleDouble,
    pub yield_deviator: DoubleDouble,
}

impl IncompressibleFlow {
    pub fn new_random(random: &mut RandomNumbers) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(random, kind, DilatancyKind::Zero);
        let state = states::random_state(random, kind, DilatancyKind::Zero);
        Self::new(random, parameters, state)
    }

    pub fn new(
        random: &mut RandomNumbers,
        parameters: FlowParameters,
        state: MaterialState,
    ) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let model = states::build_model(kind, &parameters);
        let flow = states::complete_flow(&model, &state);
        let (given, fields) =
            states::solve_background_fields(random, &parameters, kind, &state, &flow);
        let full = linearise(&given, &fields);
        // For ν = 0 the volume row (50) is cos φ times the continuity row of eqs (81)–(86).
        let cosine = given.friction_angle.cos();
        let cut = |m: [[DoubleDouble; 6]; 6]| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == 3 { m[i][j] / cosine } else { m[i][j] })
            })
        };
        Self {
            parameters,
            state,
            flow,
            a: cut(full.a),
            b: full.b.map(cut),
            c: cut(full.c),
            spin: fields.z[SPIN_INDEX],
            yield_deviator: given.friction_angle.sin() * fields.z[3] + given.cohesion * cosine,
        }
    }

    /// A random background without gradients except the velocity gradient.
    pub fn new_uniform(random: &mut RandomNumbers) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(random, kind, DilatancyKind::Zero);
        let state =
            states::without_gradients(states::random_state(random, kind, DilatancyKind::Zero));
        Self::new(random, parameters, state)
    }

    pub fn friction_angle(&self) -> DoubleDouble {
        dd(self.parameters.friction_angle)
    }
    pub fn density(&self) -> DoubleDouble {
        dd(self.state.density)
    }
    pub fn inertia(&self) -> DoubleDouble {
        dd(self.parameters.moment_of_inertia.expect("Harris–Grekova has one"))
    }
    /// Cosine cos 2Δ of twice the non-coaxiality.
    pub fn cos_twice_noncoaxiality(&self) -> DoubleDouble {
        let delta = dd(self.flow.noncoaxiality);
        (delta + delta).cos()
    }
    /// Direction (cos θ, sin θ) of the wave vector with β = 2(Ψ_Σ − θ) = `beta`, where Ψ_Σ is the stress angle.
    pub fn wave_direction(&self, beta: DoubleDouble) -> [DoubleDouble; 2] {
        let (s, c) = (dd(self.state.stress_angle) - beta * dd(0.5)).sin_cos();
        [c, s]
    }

    /// Matrix E = i k·B + C (eqs 92, 93).
    pub fn coefficient_matrix(&self, wave: [DoubleDouble; 2]) -> [[Complex; 5]; 5] {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| Complex {
                re: self.c[i][j],
                im: wave[0] * self.b[0][i][j] + wave[1] * self.b[1][i][j],
            })
        })
    }

    /// Determinant det(Aς + E) as a polynomial in ς, expanded in 31 digits (eq. 97).
    pub fn dispersion_polynomial(&self, wave: [DoubleDouble; 2]) -> Polynomial {
        let e = self.coefficient_matrix(wave);
        let matrix: Vec<Vec<Polynomial>> = (0..5)
            .map(|i| {
                (0..5)
                    .map(|j| match (self.a[i][j].high != 0.0, e[i][j].abs() != 0.0) {
                        (true, _) => vec![e[i][j], self.a[i][j].into()],
                        (false, true) => vec![e[i][j]],
                        (false, false) => vec![],
                    })
                    .collect()
            })
            .collect();
        polynomial_determinant(&matrix)
    }
}

pub fn random_wave(random: &mut RandomNumbers) -> [DoubleDouble; 2] {
    [dd(random.signed_uniform(0.3, 5.0)), dd(random.signed_uniform(0.3, 5.0))]
}

pub fn random_complex(random: &mut RandomNumbers) -> Complex {
    complex(random.signed_uniform(0.3, 3.0), random.signed_uniform(0.3, 3.0))
}
