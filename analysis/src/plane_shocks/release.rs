//! End of the load: release waves, and the overtaking of the last loading wave.

use super::majorant::greatest_convex_minorant;
use super::piston::{PistonSolution, front_dissipation};
use super::{PlaneState, PlaneWaveError, Wave, WaveKind, check_positive, check_waves};
use models::uniaxial::{DiagramCorner, UniaxialDiagram};

/// Release of the pressure on the piston after a finite duration.
#[derive(Clone, Debug, PartialEq)]
pub struct Release {
    /// Duration t₀ of the load, s.
    pub duration: f64,
    /// State at the free surface after the release.
    pub piston: PlaneState,
    /// Release waves, the fastest first. They start at the time t₀.
    pub waves: Vec<Wave>,
    /// Overtaking of the last loading wave by the first release wave; `None` if that wave is not faster.
    pub overtaking: Option<Overtaking>,
}

/// The first release wave overtakes the last loading wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overtaking {
    /// Position x*, m.
    pub position: f64,
    /// Time since the start of the load, s.
    pub time: f64,
    /// Pressure of the loading wave after the overtaking, Pa. Known if the only loading wave is a shock into the medium
    /// at rest and the release wave is on the last segment of that shock, as in an elastic skeleton.
    pub pressure: Option<f64>,
}

impl Release {
    /// Solves for the release waves of a load that ends after `duration`; `unloading` is the diagram of unloading from
    /// the state at the piston.
    ///
    /// # Errors
    /// The duration is not positive, or the unloading diagram does not fall to the pressure 0.
    pub fn new(
        loading: &PistonSolution,
        unloading: &UniaxialDiagram,
        duration: f64,
    ) -> Result<Self, PlaneWaveError> {
        check_positive("the duration of the load", duration)?;
        let (start, density) = (loading.piston, loading.density);
        let end = unloading.strain_at_pressure_below(0.0, start.strain);
        let end =
            end.ok_or(PlaneWaveError::NotLoading { pressure: start.pressure, initial: 0.0 })?;
        let mut points = unloading.points_between(end, start.strain);
        // Both ends are known exactly.
        points[0].pressure = 0.0;
        if let Some(last) = points.last_mut() {
            last.pressure = start.pressure;
        }
        let vertices = greatest_convex_minorant(&points);
        let mut waves = Vec::new();
        let mut ahead = start;
        for pair in vertices.windows(2).rev() {
            let wave = release_wave(unloading, density, ahead, pair);
            ahead = wave.behind;
            waves.push(wave);
        }
        check_waves(&waves)?;
        let overtaking = find_overtaking(loading, &waves, duration);
        Ok(Self { duration, piston: ahead, waves, overtaking })
    }
}

fn release_wave(
    diagram: &UniaxialDiagram,
    density: f64,
    ahead: PlaneState,
    edge: &[DiagramCorner],
) -> Wave {
    let [low, high] = [edge[0], edge[1]];
    let [fall, length] = [high.pressure - low.pressure, high.strain - low.strain];
    let first = diagram.segment_index_below(high.strain);
    let last = diagram.segment_index_above(low.strain).min(first);
    let segments = [first, last].map(|index| diagram.segments()[index]);
    Wave {
        kind: WaveKind::Release,
        speed: (fall / length / density).sqrt(),
        ahead,
        behind: PlaneState {
            strain: low.strain,
            velocity: ahead.velocity - (fall * length / density).sqrt(),
            pressure: low.pressure,
        },
        segment_states: segments.map(|own| own.state),
        sound_speeds: segments.map(|own| (own.slope / density).sqrt()),
        // Unloading runs along the diagram in the opposite direction.
        dissipation: -front_dissipation(diagram, low, high),
        is_shock: segments[0].slope != segments[1].slope,
    }
}

fn find_overtaking(loading: &PistonSolution, waves: &[Wave], duration: f64) -> Option<Overtaking> {
    let (last, first) = (loading.waves.last()?, waves.first()?);
    let (c, d) = (first.speed, last.speed);
    // Equal speeds are one wave of the same medium: rounding must not let one overtake the other.
    if c <= d * (1.0 + 1e-12) {
        return None;
    }
    let time = duration * c / (c - d);
    Some(Overtaking { position: d * time, time, pressure: pressure_after(loading, last, first) })
}

/// Pressure p behind a shock into the medium at rest after a release wave p₀ → p_θ has overtaken it.
///
/// The shock ends on a segment E₁ε = p + p_b of the diagram (p_b = k_bθ₀ in a porous medium), so that it has the
/// velocity p/(ρD(p)) = √(p(p + p_b)/(ρE₁)) behind. A wave of the speed c, ρc² = E₁, runs back into the state p_θ, v_l:
///
/// ```text
/// p/(ρD(p)) = v_l − (p − p_θ)/(ρc)    with    A = ρc v_l + p_θ:    p = A²/(p_b + 2A).
/// ```
fn pressure_after(loading: &PistonSolution, shock: &Wave, release: &Wave) -> Option<f64> {
    let stiffness = loading.density * release.speed * release.speed;
    let is_one_segment = (shock.sound_speeds[1] - release.speed).abs() <= 1e-12 * release.speed;
    let is_from_rest = loading.waves.len() == 1 && loading.initial.pressure == 0.0;
    if !shock.is_shock || release.is_shock || !is_one_segment || !is_from_rest {
        return None;
    }
    let rise = shock.behind.strain - shock.ahead.strain;
    let offset = stiffness * rise - shock.behind.pressure;
    let impedance = loading.density * release.speed;
    let sum = impedance * release.behind.velocity + release.behind.pressure;
    let pressure = sum * sum / (offset + 2.0 * sum);
    (pressure >= release.behind.pressure).then_some(pressure)
}
