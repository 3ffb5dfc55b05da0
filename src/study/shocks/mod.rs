//! Exact plane waves in granular and porous media: waves behind a piston, release, spall.

mod result;

pub use result::{
    DiagramRow, FrontState, OvertakingResult, PistonResult, ProfilePoint, ReleaseResult,
    ShocksResult, SpallResult, WaveRow,
};

use crate::Error;
use crate::case::plane_wave::{Piston, PistonLoadValue, SpallPulse, SpallShape};
use crate::case::{Case, CaseError};
use crate::setup::plane_wave::{PlaneWaveMedium, create_medium, locate_plane_wave_error};
use analysis::plane_shocks::column::{PulseShape, Spall};
use analysis::plane_shocks::{
    PistonLoad, PistonSolution, PlaneState, Profile, ProfilePiece, Release, find_solitary_threshold,
};
use models::common::decimal::ToPlainText;
use models::uniaxial::{ContactState, DiagramSegment, SegmentState, UniaxialDiagram};

/// Computes the plane waves of a case exactly; writes nothing.
///
/// # Errors
/// The case has no granular or porous medium, a constant or load is out of range, or the time of the profile is after
/// waves of the case have met.
///
/// # Examples
/// ```no_run
/// let case = wellposed::load("cases/porous/foam-collapse.toml", wellposed::NO_SETTINGS)?;
/// let found = wellposed::study::compute_shocks(&case)?;
/// for wave in &found.piston.expect("a piston").waves {
///     println!("{} {} m/s", wave.kind, wave.speed);
/// }
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn compute_shocks(case: &Case) -> Result<ShocksResult, Error> {
    let medium = create_medium(case)?;
    let options = case.require_plane_wave()?;
    let diagram = medium.loading_diagram();
    let density = medium.density();
    let piston = match &options.piston {
        Some(own) => Some(PistonWaves::new(case, &medium, &diagram, own)?.to_result()),
        None => None,
    };
    let spall = match &options.spall {
        Some(own) => Some(solve_spall(case, &medium, &diagram, own)?),
        None => None,
    };
    let solitary_threshold = match medium {
        PlaneWaveMedium::Porous(_) => find_solitary_threshold(&diagram),
        PlaneWaveMedium::Granular(_) => None,
    };
    let rows = diagram_rows(&diagram, density);
    let notes = describe_hyperbolicity(&diagram, &medium);
    let is_strictly_hyperbolic = diagram.segments().iter().all(|segment| segment.slope > 0.0);
    Ok(ShocksResult {
        medium: case.require_contacts()?.section(),
        density,
        diagram: rows,
        is_strictly_hyperbolic,
        notes,
        solitary_threshold,
        piston,
        spall,
        loading_diagram: diagram,
    })
}

/// Returns the segments of a diagram, in ascending order of strain.
fn diagram_rows(diagram: &UniaxialDiagram, density: f64) -> Vec<DiagramRow> {
    let segments = diagram.segments().iter().enumerate();
    let row = |(index, segment): (usize, &DiagramSegment)| {
        let corner = index.checked_sub(1).map(|below| diagram.corners()[below]);
        DiagramRow {
            state: segment.state.name(),
            from_strain: corner.map(|own| own.strain),
            from_pressure: corner.map(|own| own.pressure),
            modulus: segment.slope,
            sound_speed: (segment.slope / density).sqrt(),
        }
    };
    segments.map(row).collect()
}

/// States the loss of strict hyperbolicity of segments with modulus zero.
fn describe_hyperbolicity(diagram: &UniaxialDiagram, medium: &PlaneWaveMedium) -> Vec<String> {
    let mut notes = Vec::new();
    let has_zero = |is_open: bool| {
        let open = |state: SegmentState| state.contact == Some(ContactState::Open);
        diagram.segments().iter().any(|own| own.slope == 0.0 && open(own.state) == is_open)
    };
    if has_zero(true) {
        notes.push(
            "open: speed of sound zero; both characteristic speeds coincide, without a full set of eigenvectors"
                .to_owned(),
        );
        notes.push(
            "weakly hyperbolic: strains grow like kt with the wave number k, not exponentially; fronts obey the jumps"
                .to_owned(),
        );
    }
    if has_zero(false) {
        notes.push(
            "yielding on the cone: speed of sound zero; stiffer states beyond it are reached by a shock"
                .to_owned(),
        );
    }
    if let PlaneWaveMedium::Granular(own) = medium
        && own.transmits_tension()
    {
        notes.push(
            "friction above √(3c²/2): the cone admits tension under lateral pressure".to_owned(),
        );
    }
    notes
}

/// Waves behind the piston of a case.
#[derive(Clone, Debug)]
pub(crate) struct PistonWaves {
    /// Load.
    pub(crate) load: PistonLoad,
    /// Waves of the load.
    pub(crate) solution: PistonSolution,
    /// Waves of the end of the load.
    pub(crate) release: Option<Release>,
    /// Diagram of unloading from the state at the piston.
    pub(crate) unloading: UniaxialDiagram,
    /// Profile at the time of the case, or at one chosen by the program.
    pub(crate) profile: Profile,
}

impl PistonWaves {
    /// Solves for the waves behind a piston.
    ///
    /// # Errors
    /// The load is out of range, or the time of the profile is after waves of the case have met.
    pub(crate) fn new(
        case: &Case,
        medium: &PlaneWaveMedium,
        diagram: &UniaxialDiagram,
        own: &Piston,
    ) -> Result<Self, CaseError> {
        let (load, key) = match own.load {
            PistonLoadValue::Pressure(pressure) => {
                (PistonLoad::Pressure(pressure), "piston.pressure")
            }
            PistonLoadValue::Speed(speed) => (PistonLoad::Speed(speed), "piston.speed"),
        };
        // Not −0.0, which the report would print.
        let initial_strain = 0.0 - own.loosening;
        let solution = PistonSolution::new(diagram, medium.density(), initial_strain, load)
            .map_err(|error| locate_plane_wave_error(case, key, error))?;
        let unloading = medium.unloading_diagram(solution.piston.strain);
        let release = own.duration.map(|duration| Release::new(&solution, &unloading, duration));
        let release = release
            .transpose()
            .map_err(|error| locate_plane_wave_error(case, "piston.duration", error))?;
        let time = own.profile_time.unwrap_or_else(|| match &release {
            // Between the end of the load and the overtaking, or a path of 1 m of the fastest wave.
            Some(Release { duration, overtaking: Some(own), .. }) => 0.5 * (duration + own.time),
            Some(release) => 2.0 * release.duration,
            None => 1.0 / solution.fastest_speed(),
        });
        let profile = match &release {
            Some(release) => solution.profile_with_release(release, time),
            None => Some(solution.profile(time)),
        };
        let profile = profile.ok_or_else(|| {
            let latest =
                release.as_ref().and_then(|own| own.overtaking).map_or(0.0, |own| own.time);
            let found = format!("found {time}", time = time.to_plain_text());
            let allowed = format!(
                "expected at most {latest} s: then the release wave overtakes the last loading wave", latest = latest.to_plain_text()
            );
            case.plane_wave_error("piston.profile_time", found, allowed)
        })?;
        Ok(Self { load, solution, release, unloading, profile })
    }

    fn to_result(&self) -> PistonResult {
        let Self { solution, release, profile, .. } = self;
        PistonResult {
            pressure: solution.piston.pressure,
            speed: solution.piston.velocity,
            strain: solution.piston.strain,
            initial_strain: solution.initial.strain,
            waves: solution.waves.iter().map(WaveRow::from).collect(),
            profile_time: profile.time,
            profile: list_profile_points(profile, solution.fastest_speed()),
            release: release.as_ref().map(ReleaseResult::from),
            unloading_diagram: release.is_some().then(|| self.unloading.clone()),
        }
    }
}

/// Lists the ends of the pieces of a profile; the last piece is cut at a fifth beyond the fastest wave.
pub(crate) fn list_profile_points(profile: &Profile, fastest: f64) -> Vec<ProfilePoint> {
    let end = 1.2 * fastest * profile.time;
    let pieces = profile.pieces.iter();
    let points = |piece: &ProfilePiece| {
        piece.range.map(|position| ProfilePoint::new(position.min(end), piece.state))
    };
    pieces.flat_map(points).collect()
}

/// Creates the exact reflection of the pulse of a case at a free end.
///
/// # Errors
/// The medium transmits tension, or the pulse is out of range.
pub(crate) fn create_spall(
    case: &Case,
    medium: &PlaneWaveMedium,
    diagram: &UniaxialDiagram,
    own: &SpallPulse,
) -> Result<Spall, CaseError> {
    if let PlaneWaveMedium::Granular(medium) = medium
        && medium.transmits_tension()
    {
        let found = format!("found {}", medium.parameters().friction);
        let allowed = "expected at most √(3c²/2) for a spall: with more friction the medium transmits tension";
        return Err(case.plane_wave_error("granular.friction", found, allowed.to_owned()));
    }
    let shape = match own.shape {
        SpallShape::Rectangle => PulseShape::Rectangle,
        SpallShape::Triangle => PulseShape::Triangle,
    };
    // The first segment above the natural state; the pulse must stay on it.
    let index = diagram.segment_index_above(0.0);
    let modulus = diagram.segments()[index].slope;
    let spall = Spall::new(medium.density(), modulus, own.speed, own.duration, shape)
        .map_err(|error| locate_plane_wave_error(case, "spall", error))?;
    if let Some(corner) = diagram.corners().get(index)
        && spall.pressure() > corner.pressure
    {
        let limit = corner.pressure / (medium.density() * spall.sound_speed());
        let found = format!("found {}", own.speed.to_plain_text());
        let allowed = format!(
            "expected at most {limit} m/s: the particles of a stronger pulse yield, or their contacts close",
            limit = limit.to_plain_text()
        );
        return Err(case.plane_wave_error("spall.speed", found, allowed));
    }
    Ok(spall)
}

fn solve_spall(
    case: &Case,
    medium: &PlaneWaveMedium,
    diagram: &UniaxialDiagram,
    own: &SpallPulse,
) -> Result<SpallResult, CaseError> {
    let spall = create_spall(case, medium, diagram, own)?;
    let time = own.profile_time.unwrap_or(own.duration);
    let (c, thickness) = (spall.sound_speed(), spall.thickness());
    // A profile before the layer has formed, and one at the time of the case.
    let mut times = vec![0.25 * own.duration, time];
    times.dedup();
    let profiles = times.into_iter().map(|time| (time, list_spall_points(&spall, time)));
    Ok(SpallResult {
        shape: own.shape.name(),
        pulse_velocity: own.speed,
        duration: own.duration,
        sound_speed: c,
        pressure: spall.pressure(),
        thickness,
        layer_velocity: spall.spall_velocity(0.0),
        profile_time: time,
        gap: spall.gap(time),
        profiles: profiles.collect(),
    })
}

/// Lists both sides of every front of a profile, and points between for the triangle.
pub(crate) fn list_spall_points(spall: &Spall, time: f64) -> Vec<ProfilePoint> {
    let (c, thickness) = (spall.sound_speed(), spall.thickness());
    let mut positions: Vec<f64> = [0.0, c * time, thickness, c * (spall.duration() - time)]
        .into_iter()
        .filter(|position| *position >= 0.0 && *position <= 2.0 * thickness)
        .flat_map(|position| [position * (1.0 - 1e-12), position * (1.0 + 1e-12)])
        .chain((0..=80).map(|step| 2.0 * thickness * f64::from(step) / 80.0))
        .collect();
    positions.sort_by(f64::total_cmp);
    positions.dedup();
    let point = |position: f64| ProfilePoint::new(position, spall.state(position, time));
    positions.into_iter().map(point).collect()
}

impl From<PlaneState> for FrontState {
    fn from(state: PlaneState) -> Self {
        let PlaneState { strain, velocity, pressure } = state;
        Self { strain, velocity, pressure }
    }
}
