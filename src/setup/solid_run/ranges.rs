//! Range checks for the precision of the solver: products of constants neither overflow nor underflow; loads, sources
//! and initial values other than rotations exceed the flush-to-zero threshold, and their energies do not underflow.

use crate::Error;
use crate::case::Case;
use crate::case::dynamics::{
    FaceLoad, InitialStateTerm, LoadedArea, PlanePulseInput, Precision, SolidRun, SourceKind,
};
use crate::setup::solid;
use dynamics::medium::Medium;
use models::InputError;
use models::solid::waves::SolidField;

/// Allowed ranges of constants and drives (loads, sources and initial values) for a precision.
struct PrecisionRange {
    name: &'static str,
    /// Largest magnitude of a constant; the smallest nonzero magnitude is its inverse. Powers up to the third and
    /// products of a few moduli, inertias, impedances and strengths must be representable.
    max_constant: f64,
    /// Smallest nonzero and largest amplitude of a drive, in SI units. The smallest is far above the threshold below which
    /// the solver flushes decaying values to zero, and its square is a normal number: energies are summed in `f64`.
    /// The cube of the largest is finite: the return mapping multiplies stresses.
    amplitudes: [f64; 2],
}

impl PrecisionRange {
    fn from_precision(precision: Precision) -> Self {
        match precision {
            Precision::F64 => Self { name: "f64", max_constant: 1e90, amplitudes: [1e-140, 1e90] },
            Precision::F32 => Self { name: "f32", max_constant: 1e15, amplitudes: [1e-20, 1e12] },
        }
    }

    fn contains(&self, constant: f64) -> bool {
        constant == 0.0 || (1.0 / self.max_constant..=self.max_constant).contains(&constant.abs())
    }
}

/// Checks that the constants of all media are in the range of the precision.
///
/// # Errors
/// A constant is out of range.
pub(super) fn check_constants(case: &Case, dynamics: &SolidRun) -> Result<(), Error> {
    let range = PrecisionRange::from_precision(dynamics.scheme.precision);
    let materials = dynamics.materials();
    let own = materials.is_empty().then_some(&case.material);
    for material in own.into_iter().chain(materials) {
        let constants =
            solid::constants_by_name(material).map_err(|error| material.locate_error(error))?;
        if let Some((input, value)) = constants.into_iter().find(|own| !range.contains(own.1)) {
            let allowed = format!(
                "numbers from {:e} to {:e} in {}, in other units if need be",
                1.0 / range.max_constant,
                range.max_constant,
                range.name
            );
            let found = format!("{value:?}");
            let error = InputError { input, rejected_value: found, allowed_values: allowed };
            return Err(material.locate_error(error).into());
        }
    }
    Ok(())
}

/// Checks that the amplitudes of loads, sources and initial values other than rotations, and of the waves that they
/// excite, are 0 or within [`PrecisionRange::amplitudes`].
///
/// # Errors
/// An amplitude is too small or too large.
pub(super) fn check_amplitudes(dynamics: &SolidRun, media: &[Medium]) -> Result<(), Error> {
    let pairs = || media.iter().flat_map(|medium| medium.pairs.iter().flatten());
    let impedances = || pairs().map(|pair| pair.impedance());
    let (least, greatest) =
        (impedances().fold(f64::INFINITY, f64::min), impedances().fold(0.0, f64::max));
    // Returns the smallest amplitude of |amplitude| and of the conjugate quantity in a wave, σ = Zv with the impedances Z
    // of all media, and the largest amplitude of the stress.
    let range_in_waves = |field: SolidField, amplitude: f64| {
        let size = amplitude.abs();
        let [low, high] = match field {
            SolidField::Velocity(_) | SolidField::Spin(_) => [size * least, size * greatest],
            _ => [size / greatest, size],
        };
        [size.min(low), size.max(high)]
    };
    let range = PrecisionRange::from_precision(dynamics.scheme.precision);
    let check = |key: String, field: SolidField, amplitude: f64| {
        let [min, max] = range.amplitudes;
        let [low, high] = range_in_waves(field, amplitude);
        if amplitude == 0.0 || (low >= min && high <= max) {
            return Ok(());
        }
        let size = if low < min { low } else { high };
        let found = format!("found {amplitude:?}: waves of {size:.1e} in SI units");
        let allowed = format!("waves from {min:e} to {max:e} in {}, or none", range.name);
        Err(dynamics.error_at(&format!("{key}.amplitude"), found, allowed))
    };
    for (index, load) in dynamics.loads.iter().enumerate() {
        check(format!("load[{index}]"), load.component.0, amplitude_per_face(dynamics, load))?;
    }
    for (index, source) in dynamics.sources.iter().enumerate() {
        let amplitude = compute_source_stress(&source.kind, &dynamics.grid.spacing);
        check(format!("source[{index}]"), SolidField::Stress(0, 0), amplitude)?;
    }
    for (index, initial) in dynamics.initial_terms.iter().enumerate() {
        match initial {
            InitialStateTerm::Pulse { component: field, amplitude, .. }
            | InitialStateTerm::Uniform { component: field, amplitude, .. } => {
                check(format!("initial[{index}]"), field.0, *amplitude)?;
            }
            InitialStateTerm::PlaneWave { amplitude, .. }
            | InitialStateTerm::PlanePulse(PlanePulseInput { amplitude, .. }) => {
                check(format!("initial[{index}]"), SolidField::Velocity(0), *amplitude)?;
            }
            InitialStateTerm::Rotation { .. } | InitialStateTerm::RigidRotation { .. } => {}
        }
    }
    Ok(())
}

/// Returns the largest component of a source as a stress, Pa, or couple stress, N/m, if one cell takes the whole
/// source: moments are divided by the cell volume, forces and couples by the largest face area.
fn compute_source_stress(kind: &SourceKind, spacing: &[f64]) -> f64 {
    let max_abs = |values: &[f64]| values.iter().fold(0.0f64, |max, value| max.max(value.abs()));
    let volume: f64 = spacing.iter().product();
    let min_spacing = spacing.iter().copied().fold(f64::INFINITY, f64::min);
    match kind {
        SourceKind::Force(values) | SourceKind::Couple(values) => {
            max_abs(values) * min_spacing / volume
        }
        SourceKind::Moment(rows) => {
            rows.iter().map(|row| max_abs(row)).fold(0.0, f64::max) / volume
        }
        SourceKind::Explosion(moment) => moment.abs() / volume,
    }
}

/// Returns the amplitude of a load on one face. The amplitude of a point load is an integral over the boundary, which
/// is divided by the face area.
fn amplitude_per_face(dynamics: &SolidRun, load: &FaceLoad) -> f64 {
    match load.loaded_area {
        LoadedArea::Point { .. } => {
            let axes = load.face.tangential_axes(dynamics.grid.dimensions());
            let area: f64 = axes.into_iter().map(|axis| dynamics.grid.spacing[axis]).product();
            load.amplitude / area
        }
        LoadedArea::WholeFace | LoadedArea::Rectangle(_) => load.amplitude,
    }
}
