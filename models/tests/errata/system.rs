//! Linearised equations of a random incompressible flow, derived from the nonlinear equations.

use crate::support::equations::{SPIN, linearised};
use crate::support::states::{self, Dilatancy};
use crate::support::{Complex, Polynomial, Random, Real, Wide, complex, determinant, wide};
use testkit::flows::Parameters;
use wellposed_models::flow::state::{Flow, State};
use wellposed_models::registry;

pub const STATES: usize = 250;

/// An incompressible background and its linearisation, derived from the nonlinear equations.
pub struct Incompressible {
    pub parameters: Parameters,
    pub state: State,
    pub flow: Flow,
    /// Matrix A; columns v₁, v₂, ω, p, ψ.
    pub a: [[Wide; 5]; 5],
    pub b: [[[Wide; 5]; 5]; 2],
    pub c: [[Wide; 5]; 5],
    pub spin: Wide,
    pub q: Wide,
}

impl Incompressible {
    pub fn random(random: &mut Random) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(random, kind, Dilatancy::Zero);
        let state = states::random_state(random, kind, Dilatancy::Zero);
        Self::new(random, parameters, state)
    }

    pub fn new(random: &mut Random, parameters: Parameters, state: State) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let model = states::model(kind, &parameters);
        let flow = states::flow(&model, &state);
        let (given, fields) = states::exact_point(random, &parameters, kind, &state, &flow);
        let full = linearised(&given, &fields);
        // For ν = 0 the volume row (50) is cos φ times the continuity row of eqs (81)–(86).
        let cosine = given.friction_angle.cos();
        let cut = |m: [[Wide; 6]; 6]| {
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
            spin: fields.z[SPIN],
            q: given.friction_angle.sin() * fields.z[3] + given.cohesion * cosine,
        }
    }

    /// A random background without gradients except the velocity gradient.
    pub fn uniform(random: &mut Random) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(random, kind, Dilatancy::Zero);
        let state = State {
            pressure_gradient: [0.0; 2],
            stress_angle_gradient: [0.0; 2],
            spin_gradient: [0.0; 2],
            inertia_gradient: [0.0; 2],
            inertia_rate: 0.0,
            ..states::random_state(random, kind, Dilatancy::Zero)
        };
        Self::new(random, parameters, state)
    }

    pub fn phi(&self) -> Wide {
        wide(self.parameters.friction_angle)
    }
    pub fn density(&self) -> Wide {
        wide(self.state.density)
    }
    pub fn inertia(&self) -> Wide {
        wide(self.parameters.moment_of_inertia.expect("Harris–Grekova has one"))
    }
    /// Cosine cos 2Δ of twice the non-coaxiality.
    pub fn coaxiality(&self) -> Wide {
        let delta = wide(self.flow.noncoaxiality);
        (delta + delta).cos()
    }
    /// Direction (cos θ, sin θ) with β = 2(Ψ_Σ − θ).
    pub fn direction(&self, beta: Wide) -> [Wide; 2] {
        let (s, c) = (wide(self.state.stress_angle) - beta * wide(0.5)).sin_cos();
        [c, s]
    }

    /// Matrix E = i k·B + C (eqs 92, 93).
    pub fn e(&self, wave: [Wide; 2]) -> [[Complex; 5]; 5] {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| Complex {
                re: self.c[i][j],
                im: wave[0] * self.b[0][i][j] + wave[1] * self.b[1][i][j],
            })
        })
    }

    /// Determinant det(Aς + E) as a polynomial in ς, expanded in 31 digits (eq. 97).
    pub fn dispersion(&self, wave: [Wide; 2]) -> Polynomial {
        let e = self.e(wave);
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
        determinant(&matrix)
    }
}

pub fn random_wave(random: &mut Random) -> [Wide; 2] {
    [wide(random.generic(0.3, 5.0)), wide(random.generic(0.3, 5.0))]
}

pub fn random_complex(random: &mut Random) -> Complex {
    complex(random.generic(0.3, 3.0), random.generic(0.3, 3.0))
}
