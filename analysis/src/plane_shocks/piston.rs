//! Waves behind a piston at x = 0 that starts at t = 0.

use super::majorant::least_concave_majorant;
use super::release::Release;
use super::{PlaneState, PlaneWaveError, Wave, WaveKind, check_positive, check_waves};
use models::uniaxial::{DiagramCorner, UniaxialDiagram};

/// Constant load by the piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PistonLoad {
    /// Pressure p₀ on the piston, Pa.
    Pressure(f64),
    /// Speed of the piston, m/s.
    Speed(f64),
}

/// Self-similar solution behind a piston that loads a half-space at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct PistonSolution {
    /// Density ρ, kg/m³.
    pub density: f64,
    /// State at rest.
    pub initial: PlaneState,
    /// State at the piston.
    pub piston: PlaneState,
    /// Waves, the fastest first.
    pub waves: Vec<Wave>,
}

/// State of the half-space at one time: pieces of constant state in ascending order of x.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Time since the start of the piston, s.
    pub time: f64,
    /// Pieces, from the piston to infinity.
    pub pieces: Vec<ProfilePiece>,
}

/// Piece of constant state of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePiece {
    /// Ends of the piece, m; the last end is infinite.
    pub range: [f64; 2],
    /// State.
    pub state: PlaneState,
}

impl PistonSolution {
    /// Solves for the waves in a medium at rest with the strain `initial_strain` (negative: loosened).
    ///
    /// # Errors
    /// A number is not finite or not positive, the load does not compress the medium, or is beyond the diagram.
    pub fn new(
        diagram: &UniaxialDiagram,
        density: f64,
        initial_strain: f64,
        load: PistonLoad,
    ) -> Result<Self, PlaneWaveError> {
        check_positive("the density", density)?;
        if !initial_strain.is_finite() {
            return Err(PlaneWaveError::OutOfRange {
                quantity: "the strain at rest",
                value: initial_strain,
                allowed: "it must be finite",
            });
        }
        let initial = PlaneState {
            strain: initial_strain,
            velocity: 0.0,
            pressure: diagram.pressure(initial_strain),
        };
        let end = match load {
            PistonLoad::Pressure(pressure) => {
                check_positive("the pressure of the piston", pressure)?;
                if pressure <= initial.pressure {
                    let initial = initial.pressure;
                    return Err(PlaneWaveError::NotLoading { pressure, initial });
                }
                let strain = diagram
                    .strain_at_pressure(pressure, initial_strain)
                    .ok_or_else(|| beyond_diagram(diagram))?;
                DiagramCorner { strain, pressure }
            }
            PistonLoad::Speed(speed) => {
                check_positive("the speed of the piston", speed)?;
                find_end_by_speed(diagram, density, initial_strain, speed)?
            }
        };
        let vertices = concave_path(diagram, initial_strain, end);
        let mut waves = Vec::new();
        let mut ahead = initial;
        for pair in vertices.windows(2) {
            let wave = loading_wave(diagram, density, ahead, pair, initial_strain);
            ahead = wave.behind;
            waves.push(wave);
        }
        check_waves(&waves)?;
        Ok(Self { density, initial, piston: ahead, waves })
    }

    /// Returns the speed of the fastest loading wave, m/s.
    pub fn fastest_speed(&self) -> f64 {
        self.waves.first().map_or(1.0, |wave| wave.speed)
    }

    /// Returns the profile at the time `time` ≥ 0 after the start of the piston.
    pub fn profile(&self, time: f64) -> Profile {
        let fronts = self.waves.iter().map(|wave| (wave.speed * time, wave));
        profile_from_fronts(time, self.piston, fronts.rev().collect())
    }

    /// Returns the profile at the time `time` with the waves of the end of the load; `None` after the first of them has
    /// overtaken the last loading wave.
    pub fn profile_with_release(&self, release: &Release, time: f64) -> Option<Profile> {
        if time <= release.duration {
            return Some(self.profile(time));
        }
        if release.overtaking.is_some_and(|own| time > own.time) {
            return None;
        }
        let since = time - release.duration;
        let fronts = release.waves.iter().map(|wave| (wave.speed * since, wave)).rev();
        let loading = self.waves.iter().map(|wave| (wave.speed * time, wave)).rev();
        Some(profile_from_fronts(time, release.piston, fronts.chain(loading).collect()))
    }
}

/// Builds a profile from the positions of fronts in ascending order.
fn profile_from_fronts(time: f64, piston: PlaneState, fronts: Vec<(f64, &Wave)>) -> Profile {
    let mut pieces = Vec::new();
    let (mut from, mut state) = (0.0, piston);
    for (position, wave) in fronts {
        pieces.push(ProfilePiece { range: [from, position], state });
        (from, state) = (position, wave.ahead);
    }
    pieces.push(ProfilePiece { range: [from, f64::INFINITY], state });
    Profile { time, pieces }
}

fn beyond_diagram(diagram: &UniaxialDiagram) -> PlaneWaveError {
    let maximum = diagram.corners().last().map_or(0.0, |corner| corner.pressure);
    PlaneWaveError::BeyondDiagram { maximum }
}

/// Returns the vertices of the least concave majorant from the state at rest to the end.
fn concave_path(
    diagram: &UniaxialDiagram,
    initial_strain: f64,
    end: DiagramCorner,
) -> Vec<DiagramCorner> {
    let mut points = diagram.points_between(initial_strain, end.strain);
    // The given pressure is exact; the computed strain has a rounding error.
    if let Some(last) = points.last_mut() {
        *last = end;
    }
    least_concave_majorant(&points)
}

/// Speed of the piston that leads to the state `end`, m/s: the sum of √([p][ε]/ρ) over the edges of the majorant.
fn piston_speed(
    diagram: &UniaxialDiagram,
    density: f64,
    initial_strain: f64,
    end: DiagramCorner,
) -> f64 {
    let vertices = concave_path(diagram, initial_strain, end);
    let jump = |pair: &[DiagramCorner]| {
        ((pair[1].pressure - pair[0].pressure) * (pair[1].strain - pair[0].strain) / density).sqrt()
    };
    vertices.windows(2).map(jump).sum()
}

/// Finds the state at a piston of the speed `speed`, which grows with the strain: brackets it between corners of the
/// diagram, then bisects to the last bit.
fn find_end_by_speed(
    diagram: &UniaxialDiagram,
    density: f64,
    initial_strain: f64,
    speed: f64,
) -> Result<DiagramCorner, PlaneWaveError> {
    let end = |strain: f64| DiagramCorner { strain, pressure: diagram.pressure(strain) };
    let reaches =
        |strain: f64| piston_speed(diagram, density, initial_strain, end(strain)) >= speed;
    let last = diagram.corners().last().map_or(initial_strain, |corner| corner.strain);
    let mut high = last.max(initial_strain);
    let mut low = initial_strain;
    if !reaches(high) {
        let slope = diagram.segments().last().map_or(0.0, |segment| segment.slope);
        if slope <= 0.0 {
            return Err(beyond_diagram(diagram));
        }
        // Behind the last corner the speed grows at least as fast as in the linear medium.
        low = high;
        high += speed / (slope / density).sqrt();
        while !reaches(high) && high.is_finite() {
            high += (high - low).max(f64::MIN_POSITIVE);
        }
    }
    loop {
        let middle = low + 0.5 * (high - low);
        if !(middle > low && middle < high) {
            return Ok(end(high));
        }
        match reaches(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
}

/// Finds the pressure above which the only wave is a shock from the natural state to a yielding state on the last segment
/// of the diagram (solitary wave), Pa: there the chord from the natural state becomes steeper than the first, elastic
/// segment. `None` if the last segment is not stiffer, or a corner lies above the line of the elastic segment, so that the
/// precursor is a shock itself.
///
/// In a porous medium with the spherical contact the threshold is
/// (k_a + 4μ_a/3)(k_bθ₀ − 4τ_s/3)/(k_b − 4μ_a/3), for k_b > 4μ_a/3.
pub fn find_solitary_threshold(diagram: &UniaxialDiagram) -> Option<f64> {
    let first = diagram.segments()[diagram.segment_index_above(0.0)];
    let (last, corner) = (diagram.segments().last()?, diagram.corners().last()?);
    let is_below = |own: &DiagramCorner| {
        own.strain <= 0.0 || own.pressure <= first.slope * own.strain * (1.0 + 1e-12)
    };
    if !last.state.is_plastic()
        || last.slope <= first.slope
        || !diagram.corners().iter().all(is_below)
    {
        return None;
    }
    // E₀ε = p_c + E(ε − ε_c) on the last segment of the modulus E, which starts at (ε_c, p_c).
    let strain = (last.slope * corner.strain - corner.pressure) / (last.slope - first.slope);
    (strain > corner.strain).then_some(first.slope * strain)
}

fn loading_wave(
    diagram: &UniaxialDiagram,
    density: f64,
    ahead: PlaneState,
    edge: &[DiagramCorner],
    initial_strain: f64,
) -> Wave {
    let [low, high] = [edge[0], edge[1]];
    let [rise, length] = [high.pressure - low.pressure, high.strain - low.strain];
    let speed = (rise / length / density).sqrt();
    let behind = PlaneState {
        strain: high.strain,
        velocity: ahead.velocity + (rise * length / density).sqrt(),
        pressure: high.pressure,
    };
    let first = diagram.segment_index_above(low.strain);
    let last = diagram.segment_index_below(high.strain).max(first);
    let segments = [first, last].map(|index| diagram.segments()[index]);
    let dissipation = front_dissipation(diagram, low, high);
    let is_shock = segments[0].slope != segments[1].slope;
    let kind = match (is_shock, segments[1].state.is_plastic()) {
        (false, false) => WaveKind::Elastic,
        (false, true) => WaveKind::Plastic,
        (true, false) => WaveKind::Compaction,
        // In a loosened medium there is no precursor that the shock could outrun.
        (true, true) if low.strain == initial_strain && segments[0].slope > 0.0 => {
            WaveKind::Solitary
        }
        (true, true) => WaveKind::PlasticCompaction,
    };
    Wave {
        kind,
        speed,
        ahead,
        behind,
        segment_states: segments.map(|own| own.state),
        sound_speeds: segments.map(|own| (own.slope / density).sqrt()),
        dissipation,
        is_shock,
    }
}

/// Area between the chord of a jump and the diagram, J/m³, summed from the corners, so that it is exactly 0 on one
/// segment.
pub(super) fn front_dissipation(
    diagram: &UniaxialDiagram,
    low: DiagramCorner,
    high: DiagramCorner,
) -> f64 {
    let slope = (high.pressure - low.pressure) / (high.strain - low.strain);
    let excess =
        |own: &DiagramCorner| low.pressure + slope * (own.strain - low.strain) - own.pressure;
    let points = diagram.points_between(low.strain, high.strain);
    let count = points.len();
    // The chord meets the diagram at both ends.
    let height = |index: usize| match index {
        0 => 0.0,
        _ if index + 1 == count => 0.0,
        _ => excess(&points[index]),
    };
    (1..count)
        .map(|index| {
            let width = points[index].strain - points[index - 1].strain;
            0.5 * (height(index - 1) + height(index)) * width
        })
        .sum()
}

/// Plastic work per unit volume on a monotone path between two strains of a diagram, J/m³, if yielding particles or a
/// yielding skeleton take the work `rate` per unit of strain, Pa. Where the pressure is constant while the particles
/// yield, they take all of the work.
pub fn plastic_work(diagram: &UniaxialDiagram, strains: [f64; 2], rate: f64) -> f64 {
    let [low, high] = [strains[0].min(strains[1]), strains[0].max(strains[1])];
    let points = diagram.points_between(low, high);
    let work = |pair: &[DiagramCorner]| {
        let segment = diagram.segments()[diagram.segment_index_above(pair[0].strain)];
        let width = pair[1].strain - pair[0].strain;
        match (segment.state.is_plastic(), segment.slope) {
            (false, _) => 0.0,
            (true, 0.0) => pair[0].pressure.abs() * width,
            (true, _) => rate * width,
        }
    };
    points.windows(2).map(work).sum()
}
