//! Exact plane waves behind a piston in media with piecewise-linear uniaxial diagrams.
//!
//! In uniaxial strain with the compression strain ε, the pressure p on the front and the velocity v along x,
//!
//! ```text
//! ρ v̇ + ∂ₓp = 0,    ε̇ + ∂ₓv = 0,    p = p(ε) along a monotone path.
//! ```
//!
//! A constant load on a half-space at rest gives a self-similar solution: waves of constant speed between constant
//! states. The waves are the edges of the least concave majorant of p(ε) between the state at rest and that at the
//! piston (Oleinik 1959, Liu 1975): a softening corner separates two waves, stiffening corners are merged into a shock.
//! An edge of the slope S has the speed √(S/ρ), and the jumps obey ρc\[v\] = \[p\], c\[ε\] = \[v\]. Unloading uses the greatest
//! convex minorant of the unloading diagram.
//!
//! Coordinates are those of the undeformed medium; strains are small.
//!
//! - [`PistonSolution`]: waves behind a piston of given pressure or speed, with its profiles;
//! - [`Release`]: end of the load after a finite duration, overtaking of the last wave;
//! - [`mod@column`]: columns of a granular medium: spall at a free end, compaction of a loosened column.

pub mod column;
mod majorant;
mod piston;
mod release;

pub use piston::{
    PistonLoad, PistonSolution, Profile, ProfilePiece, find_solitary_threshold, plastic_work,
};
pub use release::{Overtaking, Release};

use models::uniaxial::SegmentState;

/// State of a plane wave: compression strain, velocity and pressure on the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneState {
    /// Compression strain ε.
    pub strain: f64,
    /// Velocity v along x, m/s.
    pub velocity: f64,
    /// Pressure p = −σ₁₁, Pa.
    pub pressure: f64,
}

/// Kind of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveKind {
    /// Loading wave of the elastic medium.
    Elastic,
    /// Loading wave of the yielding medium.
    Plastic,
    /// Shock across stiffening corners, with an elastic state behind.
    Compaction,
    /// Other shock across stiffening corners with a yielding state behind.
    PlasticCompaction,
    /// Shock from the state at rest to a yielding state, which is faster than an elastic precursor would be.
    Solitary,
    /// Unloading wave.
    Release,
}

impl WaveKind {
    /// Returns the name for tables and legends.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic wave",
            Self::Plastic => "plastic wave",
            Self::Compaction => "compaction shock",
            Self::PlasticCompaction => "plastic compaction shock",
            Self::Solitary => "solitary wave",
            Self::Release => "release wave",
        }
    }
}

/// Wave between two constant states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Kind of the wave.
    pub kind: WaveKind,
    /// Speed, m/s, in coordinates of the undeformed medium.
    pub speed: f64,
    /// State ahead of the wave.
    pub ahead: PlaneState,
    /// State behind the wave.
    pub behind: PlaneState,
    /// Medium just ahead and just behind of the wave, on the segments of the diagram inside the jump.
    pub segment_states: [SegmentState; 2],
    /// Speeds of sound ahead and behind, m/s: √(dp/dε / ρ) on these segments. A wave obeys the condition of Lax:
    /// ahead ≤ speed ≤ behind for a shock, both equal for a linear wave.
    pub sound_speeds: [f64; 2],
    /// Energy dissipated at the front per unit volume swept, J/m³: ½(p⁺ + p⁻)(ε⁺ − ε⁻) − ∫p dε. Plastic work along the
    /// diagram is not part of it.
    pub dissipation: f64,
    /// Whether the wave crosses corners of the diagram: a shock.
    pub is_shock: bool,
}

/// Error of a problem of plane waves.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaneWaveError {
    /// A number is out of range.
    #[error("{quantity} is {value}; {allowed}")]
    OutOfRange {
        /// Meaning of the number.
        quantity: &'static str,
        /// Value found.
        value: f64,
        /// Values allowed.
        allowed: &'static str,
    },
    /// The diagram never reaches the load.
    #[error(
        "the load is beyond the diagram, whose pressure is at most {maximum} Pa: reduce the load"
    )]
    BeyondDiagram {
        /// Greatest pressure of the diagram, Pa.
        maximum: f64,
    },
    /// A speed or a state is not finite, or there is no wave.
    #[error(
        "speeds or states of the waves are not finite: the numbers are too large, too small or too \
         different"
    )]
    NotFinite,
    /// The load does not compress the medium.
    #[error(
        "the pressure {pressure} Pa is not above {initial} Pa, that at rest: only loading is solved"
    )]
    NotLoading {
        /// Pressure of the load, Pa.
        pressure: f64,
        /// Pressure at rest, Pa.
        initial: f64,
    },
}

impl PlaneState {
    fn is_finite(&self) -> bool {
        self.strain.is_finite() && self.velocity.is_finite() && self.pressure.is_finite()
    }
}

/// Checks that speeds and states of waves are finite and that no wave has vanished by underflow.
fn check_waves(waves: &[Wave]) -> Result<(), PlaneWaveError> {
    let is_sound = |wave: &Wave| {
        wave.speed.is_finite()
            && wave.speed > 0.0
            && wave.behind.is_finite()
            && wave.dissipation.is_finite()
    };
    match !waves.is_empty() && waves.iter().all(is_sound) {
        true => Ok(()),
        false => Err(PlaneWaveError::NotFinite),
    }
}

/// Checks that a number is finite and positive.
fn check_positive(quantity: &'static str, value: f64) -> Result<f64, PlaneWaveError> {
    match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err(PlaneWaveError::OutOfRange {
            quantity,
            value,
            allowed: "it must be finite and above 0",
        }),
    }
}
