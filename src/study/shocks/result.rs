//! Results of the study of plane waves.

use analysis::plane_shocks::{PlaneState, Release, Wave};
use models::uniaxial::UniaxialDiagram;
use serde::Serialize;

/// Exact plane waves of a case.
#[derive(Clone, Debug, Serialize)]
pub struct ShocksResult {
    /// Medium: `granular` or `porous`.
    pub medium: &'static str,
    /// Density, kg/m³.
    pub density: f64,
    /// Segments of the diagram of loading, in ascending order of strain.
    pub diagram: Vec<DiagramRow>,
    /// Whether the modulus is positive on all segments, so that the equations are strictly hyperbolic in each state.
    pub is_strictly_hyperbolic: bool,
    /// Remarks on states in which the equations are not strictly hyperbolic.
    pub notes: Vec<String>,
    /// Pressure above which the only wave is a shock from rest to the collapsed, yielding state (solitary wave), Pa;
    /// `None` if there is none at any pressure.
    pub solitary_threshold: Option<f64>,
    /// Waves behind the piston.
    pub piston: Option<PistonResult>,
    /// Reflection of a pulse at a free end.
    pub spall: Option<SpallResult>,
    /// Diagram of loading.
    #[serde(skip)]
    pub loading_diagram: UniaxialDiagram,
}

/// Segment of a diagram.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DiagramRow {
    /// State of the medium.
    pub state: &'static str,
    /// Least compression strain; `None` for the first segment, which has no lower end.
    pub from_strain: Option<f64>,
    /// Pressure at that strain, Pa.
    pub from_pressure: Option<f64>,
    /// Tangent modulus, Pa.
    pub modulus: f64,
    /// Speed of sound, m/s.
    pub sound_speed: f64,
}

/// State at one side of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrontState {
    /// Compression strain ε.
    pub strain: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// Pressure p = −σ₁₁, Pa.
    pub pressure: f64,
}

/// A wave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaveRow {
    /// Kind of the wave.
    pub kind: &'static str,
    /// Whether the wave is a shock.
    pub is_shock: bool,
    /// Speed in coordinates of the undeformed medium, m/s.
    pub speed: f64,
    /// State ahead.
    pub ahead: FrontState,
    /// State behind.
    pub behind: FrontState,
    /// Medium just inside the jump, ahead and behind.
    pub states: [&'static str; 2],
    /// Speeds of sound ahead and behind, m/s.
    pub sound_speeds: [f64; 2],
    /// Energy dissipated at the front per unit volume swept, J/m³; plastic work is not part of it.
    pub dissipation: f64,
}

impl From<&Wave> for WaveRow {
    fn from(wave: &Wave) -> Self {
        Self {
            kind: wave.kind.name(),
            is_shock: wave.is_shock,
            speed: wave.speed,
            ahead: wave.ahead.into(),
            behind: wave.behind.into(),
            states: wave.segment_states.map(|own| own.name()),
            sound_speeds: wave.sound_speeds,
            dissipation: wave.dissipation,
        }
    }
}

/// Waves behind a piston.
#[derive(Clone, Debug, Serialize)]
pub struct PistonResult {
    /// Pressure on the piston, Pa.
    pub pressure: f64,
    /// Speed of the piston, m/s.
    pub speed: f64,
    /// Compression strain at the piston.
    pub strain: f64,
    /// Compression strain at rest; negative in a loosened medium.
    pub initial_strain: f64,
    /// Waves, the fastest first.
    pub waves: Vec<WaveRow>,
    /// Waves after the end of the load.
    pub release: Option<ReleaseResult>,
    /// Time of the profile, s.
    pub profile_time: f64,
    /// Profile: both sides of every front.
    #[serde(skip)]
    pub profile: Vec<ProfilePoint>,
    /// Diagram of unloading from the state at the piston, if the load ends.
    #[serde(skip)]
    pub unloading_diagram: Option<UniaxialDiagram>,
}

/// Waves after the end of the load.
#[derive(Clone, Debug, Serialize)]
pub struct ReleaseResult {
    /// Duration of the load, s.
    pub duration: f64,
    /// Compression strain that remains at the free surface.
    pub residual_strain: f64,
    /// Velocity of the free surface, m/s.
    pub surface_velocity: f64,
    /// Release waves, the fastest first.
    pub waves: Vec<WaveRow>,
    /// Overtaking of the last loading wave; `None` if the release waves are not faster.
    pub overtaking: Option<OvertakingResult>,
}

/// Overtaking of the last loading wave by the first release wave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OvertakingResult {
    /// Position, m.
    pub position: f64,
    /// Time since the start of the load, s.
    pub time: f64,
    /// Pressure after it, Pa, where a closed form holds: one shock into the medium at rest, without plastic flow.
    pub pressure: Option<f64>,
}

impl From<&Release> for ReleaseResult {
    fn from(release: &Release) -> Self {
        Self {
            duration: release.duration,
            residual_strain: release.piston.strain,
            surface_velocity: release.piston.velocity,
            waves: release.waves.iter().map(WaveRow::from).collect(),
            overtaking: release.overtaking.map(|own| OvertakingResult {
                position: own.position,
                time: own.time,
                pressure: own.pressure,
            }),
        }
    }
}

/// Reflection of a compressive pulse at the free end of a granular column.
#[derive(Clone, Debug, Serialize)]
pub struct SpallResult {
    /// Shape of the pulse in time.
    pub shape: &'static str,
    /// Particle velocity behind the front of the pulse, m/s.
    pub pulse_velocity: f64,
    /// Duration of the pulse, s.
    pub duration: f64,
    /// Speed of sound in the compressed column, m/s.
    pub sound_speed: f64,
    /// Pressure behind the front of the pulse, Pa.
    pub pressure: f64,
    /// Thickness of the layer that leaves the column, m.
    pub thickness: f64,
    /// Velocity of the layer at the free end, m/s.
    pub layer_velocity: f64,
    /// Time of the profile after the front has met the end, s.
    pub profile_time: f64,
    /// Width of the gap between layer and column at that time, m.
    pub gap: f64,
    /// Profiles against the distance from the end, with their times, s: one before the layer has formed, and one at
    /// `profile_time`.
    #[serde(skip)]
    pub profiles: Vec<(f64, Vec<ProfilePoint>)>,
}

/// Point of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Position, m.
    pub position: f64,
    /// State.
    pub state: FrontState,
}

impl ProfilePoint {
    pub(super) fn new(position: f64, state: PlaneState) -> Self {
        Self { position, state: state.into() }
    }
}
