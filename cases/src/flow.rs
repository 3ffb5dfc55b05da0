//! What a case says of a flow in time: the box and its points, the perturbation of the uniform flow,
//! and what is recorded.
//!
//! SI units, angles in degrees. The box moves with the mean flow; positions are those that its points
//! have at the beginning, from 0 to its edges, m. Axes are counted from 0.

pub(super) mod read;
mod write;

use super::dynamics::Receiver;
use super::keys::{Key, Value};
use super::place::Places;
use super::{Case, CaseError};
use models::fourier::greatest_modes;
use models::granular_flow::RotationKind;
use models::granular_flow::state::{Background, Flow, Region};
use std::fmt;

/// Most points of a box.
pub const MOST_POINTS: usize = 1 << 28;

/// Least number of points along an axis.
pub const LEAST_POINTS: usize = 8;

/// Keys of a state that are 0 in a flow that is uniform and whose box moves with it.
pub const UNIFORM: [&str; 9] = [
    "model.dilatancy_angle_deg",
    "background.velocity",
    "background.pressure_gradient",
    "background.stress_angle_gradient_deg",
    "background.density_gradient",
    "background.spin_gradient",
    "background.inertia_rate",
    "background.inertia_gradient",
    "background.acceleration",
];

/// The sections of a case that say how a flow is run in time.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowRun {
    /// What rotates: it says which field evolves beside the velocity. Never [`RotationKind::Free`].
    pub rotation: RotationKind,
    /// The box.
    pub grid: Grid,
    /// How long, and how accurately.
    pub time: Time,
    /// Least Q_D relative to that of the mean flow, at which a run is stopped (plastic potential alone).
    pub least_shear_rate: f64,
    /// What the perturbation is made of at the beginning; the parts add up. At least one.
    pub initial: Vec<Initial>,
    /// Points of the box at which fields are recorded.
    pub receivers: Vec<Receiver<Quantity>>,
    /// What else is recorded.
    pub output: Output,
    places: Places,
}

/// A box that moves with the mean flow, and its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Points along each axis; even, at least [`LEAST_POINTS`].
    pub cells: [usize; 2],
    /// Edges at the beginning, m; positive.
    pub lengths: [f64; 2],
}

impl FlowRun {
    /// The same in another box.
    pub fn on(&self, grid: Grid) -> Self {
        Self { grid, ..self.clone() }
    }
}

impl Grid {
    /// Number of points.
    pub fn count(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Greatest m₁ and m₂ of the waves exp(2πi(m₁y₁/L₁ + m₂y₂/L₂)) that the points hold without mistaking
    /// products of two of them for others.
    pub fn greatest_modes(&self) -> [usize; 2] {
        greatest_modes(self.cells)
    }

    /// Coordinate at the beginning of the point of that index along an axis, m.
    pub fn position(&self, axis: usize, index: usize) -> f64 {
        (index as f64 + 0.5) * self.lengths[axis] / self.cells[axis] as f64
    }

    /// The point nearest to a position in the box, the first axis running fastest.
    pub fn nearest(&self, at: &[f64]) -> usize {
        let index = |axis: usize| {
            let index = (at[axis] / self.lengths[axis] * self.cells[axis] as f64).floor();
            (index.max(0.0) as usize).min(self.cells[axis] - 1)
        };
        index(1) * self.cells[0] + index(0)
    }
}

/// Duration and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// Duration, s; positive.
    pub duration: f64,
    /// Error of a step relative to the perturbation; in (0, 1).
    pub tolerance: f64,
    /// Residual of the equation of the pressure relative to its right-hand side; in (0, 1).
    pub pressure_tolerance: f64,
}

/// A field of the flow, by its name in case files and tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A component of the velocity: 0 or 1.
    Velocity(usize),
    /// The spin ω.
    Spin,
    /// The stress angle ψ.
    StressAngle,
    /// The pressure.
    Pressure,
    /// The shear rate Q_D.
    ShearRate,
}

impl Quantity {
    /// Those that a flow has, velocities first.
    pub fn all(rotation: RotationKind) -> Vec<Self> {
        let spin = (rotation == RotationKind::IntrinsicSpin).then_some(Self::Spin);
        [Self::Velocity(0), Self::Velocity(1)]
            .into_iter()
            .chain(spin)
            .chain([Self::StressAngle, Self::Pressure, Self::ShearRate])
            .collect()
    }

    /// Name in case files, tables and pictures, where angles are in degrees.
    pub const fn name(self) -> &'static str {
        match self {
            Self::StressAngle => "psi_deg",
            _ => self.array(),
        }
    }

    /// Name in archives and snapshots, where angles are in radians.
    pub const fn array(self) -> &'static str {
        match self {
            Self::Velocity(0) => "v1",
            Self::Velocity(_) => "v2",
            Self::Spin => "w",
            Self::StressAngle => "psi",
            Self::Pressure => "p",
            Self::ShearRate => "shear_rate",
        }
    }

    /// A value in SI units as it stands under the [`name`](Self::name).
    pub fn shown(self, value: f64) -> f64 {
        if self == Self::StressAngle { value.to_degrees() } else { value }
    }
}

/// The name in case files.
impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A field that a perturbation is given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbed {
    /// The velocity across the wave vector, m/s.
    Velocity,
    /// The spin ω, rad/s (Harris–Grekova alone).
    Spin,
    /// The stress angle ψ, degrees (double shearing alone).
    StressAngle,
}

impl Disturbed {
    /// Those that evolve in a flow.
    pub const fn all(rotation: RotationKind) -> &'static [Self] {
        match rotation {
            RotationKind::IntrinsicSpin => &[Self::Velocity, Self::Spin],
            RotationKind::StressAxes => &[Self::Velocity, Self::StressAngle],
            RotationKind::None | RotationKind::Free => &[Self::Velocity],
        }
    }

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "v",
            Self::Spin => "w",
            Self::StressAngle => "psi_deg",
        }
    }
}

/// A wave A cos(k·y + phase) with k = 2π(m₁/L₁, m₂/L₂).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Numbers of wavelengths along the axes, m₁ and m₂; not both 0.
    pub mode: [i64; 2],
    /// The field.
    pub field: Disturbed,
    /// A, in the unit of the field.
    pub amplitude: f64,
    /// Phase, degrees.
    pub phase_deg: f64,
}

/// A part of the perturbation.
#[derive(Clone, Debug, PartialEq)]
pub enum Initial {
    /// A wave.
    Mode(Wave),
    /// A wave under a bell exp(−(r/radius)²).
    Packet {
        /// The wave.
        wave: Wave,
        /// The middle of the bell, m.
        at: [f64; 2],
        /// Radius, m; positive.
        radius: f64,
    },
    /// All waves of a band with the same amplitude and random phases, which are those of the seed on
    /// whatever points.
    Noise {
        /// The field.
        field: Disturbed,
        /// Least √(m₁² + m₂²).
        from: f64,
        /// Greatest √(m₁² + m₂²).
        to: f64,
        /// Root mean square, in the unit of the field.
        amplitude: f64,
        /// What the phases follow from.
        seed: u64,
    },
    /// A uniform value.
    Uniform {
        /// The field; not the velocity.
        field: Disturbed,
        /// The value, in the unit of the field.
        amplitude: f64,
    },
    /// Fields of an archive such as an earlier run's.
    File {
        /// Where it is, from the root.
        path: String,
        /// Checksum of its bytes, which are part of the case.
        checksum: u32,
    },
}

impl Initial {
    /// All names in case files.
    pub const NAMES: [&str; 5] = ["mode", "packet", "noise", "uniform", "file"];

    /// Name in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Mode(_) => "mode",
            Self::Packet { .. } => "packet",
            Self::Noise { .. } => "noise",
            Self::Uniform { .. } => "uniform",
            Self::File { .. } => "file",
        }
    }
}

/// What else is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Time between two lines of the ledger and of the spectrum, s; 0: a two-hundredth of the duration.
    pub ledger_interval: f64,
    /// Time between two snapshots of all fields, s; 0: none.
    pub snapshot_interval: f64,
    /// What pictures show; `None`: the magnitude of the perturbation of the velocity.
    pub picture: Option<Quantity>,
    /// Values of it on which lines are drawn, in its unit; `None`: as suits the picture.
    pub contours: Option<Vec<f64>>,
}

impl FlowRun {
    /// An error at a key of these sections, as in `initial[0].amplitude`; indices from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }
}

impl Case {
    /// What rotates in the case's flow in time, and with it what determines the stress angle.
    ///
    /// # Errors
    /// The model is none of a flow that can be run in time.
    pub fn rotation_in_time(&self) -> Result<RotationKind, CaseError> {
        self.kind.rotation_in_time().ok_or_else(|| {
            let found = format!("found {}", self.kind.name());
            let allowed = "a flow whose stress angle is determined: nothing determines it here";
            self.places.error("model.kind", found, allowed)
        })
    }

    /// The uniform flow that a run in time perturbs.
    ///
    /// # Errors
    /// The state is none of a uniform, fully deforming flow of constant volume in its own frame.
    pub fn mean_flow(&self) -> Result<Flow, CaseError> {
        for name in UNIFORM {
            let Some(value) = Key::find(name).and_then(|key| key.field.load(&self.numbers)) else {
                continue;
            };
            if matches!(value, Value::Number(0.0) | Value::Pair([0.0, 0.0])) {
                continue;
            }
            let allowed = match name {
                "model.dilatancy_angle_deg" => "flows are run in time at constant volume: 0",
                "background.velocity" => "leave it out: the box moves with the mean flow",
                _ => "leave it out: the flow that is run in time is uniform",
            };
            return Err(self.places.error(name, format!("found {value}"), allowed));
        }
        let state = self.state();
        let background = self.model()?.background(&state).map_err(|error| self.locate(error))?;
        let flow = match background {
            Background::FullyDeforming(flow) => flow,
            Background::Elsewhere { region, stress } => {
                let (q, r) = (stress.deviator.value, stress.rotational);
                let on_yield = self.model()?.coulomb().yield_deviator(state.pressure).value;
                let is_on_yield = (q - on_yield).abs() <= 1e-9 * on_yield;
                let (key, value) = match is_on_yield {
                    true => ("background.rotational_stress", r),
                    false => ("background.deviatoric_stress", q),
                };
                let place = if region == Region::OutsideYield { "outside" } else { "inside" };
                let found = format!("found {value:?}, {place} yield");
                let allowed = "leave it out: what is run in time deforms, on yield";
                return Err(self.places.error(key, found, allowed));
            }
        };
        let is_undecided = (2.0 * flow.rounded_noncoaxiality()).cos().sign().is_none();
        if flow.spin.is_some() && is_undecided {
            let found = format!("found |Δ| = {:?}°", flow.noncoaxiality.abs().to_degrees());
            let allowed = "another one: on the bound the spin determines no stress angle";
            return Err(self.places.error("background.noncoaxiality_deg", found, allowed));
        }
        Ok(flow)
    }
}
