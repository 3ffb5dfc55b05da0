//! Range checks for the precision of the solver: products of constants neither overflow nor underflow, and loads and
//! initial values exceed the flush-to-zero threshold.

use crate::Error;
use crate::case::Case;
use crate::case::dynamics::{Action, Component, Dynamics, Initial, Load, Precision};
use crate::setup::solid;
use dynamics::medium::Medium;
use models::InputError;
use models::solid::waves::Field;

/// Allowed ranges of constants and drives (loads and initial values) for a precision.
struct Range {
    name: &'static str,
    /// Greatest constant; the least is its inverse. Powers up to the third and products of a few moduli, inertias,
    /// impedances and strengths must be representable.
    constant: f64,
    /// Least amplitude of a drive, far above the threshold below which the solver flushes decaying values to zero.
    drive: f64,
}

impl Range {
    fn of(precision: Precision) -> Self {
        match precision {
            Precision::F64 => Self { name: "f64", constant: 1e90, drive: 1e-280 },
            Precision::F32 => Self { name: "f32", constant: 1e15, drive: 1e-20 },
        }
    }

    fn holds(&self, constant: f64) -> bool {
        constant == 0.0 || (1.0 / self.constant..=self.constant).contains(&constant.abs())
    }
}

/// Checks that the constants of all media are in the range of the precision.
///
/// # Errors
/// A constant is out of range.
pub(super) fn check_constants(case: &Case, dynamics: &Dynamics) -> Result<(), Error> {
    let range = Range::of(dynamics.scheme.precision);
    let own = dynamics.regions.is_empty().then_some(&case.material);
    for material in own.into_iter().chain(dynamics.regions.iter().map(|region| &region.material)) {
        let constants = solid::constants(material).map_err(|error| material.locate(error))?;
        if let Some((input, value)) = constants.into_iter().find(|own| !range.holds(own.1)) {
            let allowed = format!(
                "numbers from {:e} to {:e} in {}, in other units if need be",
                1.0 / range.constant,
                range.constant,
                range.name
            );
            let found = format!("{value:?}");
            let error = InputError { input, found, allowed };
            return Err(material.locate(error).into());
        }
    }
    Ok(())
}

/// Checks that loads and initial values, and the waves that they excite, exceed the flush-to-zero threshold.
///
/// # Errors
/// An amplitude is too small.
pub(super) fn check_drives(dynamics: &Dynamics, media: &[Medium]) -> Result<(), Error> {
    let pairs = || media.iter().flat_map(|medium| medium.pairs.iter().flatten());
    let impedances = || pairs().map(|pair| pair.impedance());
    let (least, greatest) =
        (impedances().fold(f64::INFINITY, f64::min), impedances().fold(0.0, f64::max));
    // The lesser of the amplitude and that of its conjugate: σ = Zv with the impedance Z.
    let smaller = |field: Field, amplitude: f64| {
        let size = amplitude.abs();
        match field {
            Field::Velocity(_) | Field::Spin(_) => size.min(size * least),
            _ => size.min(size / greatest),
        }
    };
    let range = Range::of(dynamics.scheme.precision);
    let check = |key: String, Component(field): Component, amplitude: f64| {
        let size = smaller(field, amplitude);
        if amplitude == 0.0 || size >= range.drive {
            return Ok(());
        }
        let found = format!("found {amplitude:?}: waves of {size:.1e} in SI units");
        let allowed = format!("waves of at least {:e} in {}, or none", range.drive, range.name);
        Err(dynamics.locate(&format!("{key}.amplitude"), found, allowed))
    };
    for (index, load) in dynamics.loads.iter().enumerate() {
        check(format!("load[{index}]"), load.field, on_a_face(dynamics, load))?;
    }
    for (index, initial) in dynamics.initial.iter().enumerate() {
        match initial {
            Initial::Pulse { field, amplitude, .. } | Initial::Uniform { field, amplitude, .. } => {
                check(format!("initial[{index}]"), *field, *amplitude)?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Returns the amplitude of a load per face; that of a point load is an integral over the side, divided by the face
/// area.
fn on_a_face(dynamics: &Dynamics, load: &Load) -> f64 {
    match load.action {
        Action::Point { .. } => {
            let axes = load.side.axes(dynamics.grid.dimensions());
            let area: f64 = axes.into_iter().map(|axis| dynamics.grid.spacing[axis]).product();
            load.amplitude / area
        }
        Action::Whole | Action::Part(_) => load.amplitude,
    }
}
