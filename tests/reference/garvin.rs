//! Garvin's problem: a line explosion inside a half-plane.

use super::comparison::{AxisMapping, ReferenceReceiver, ReferenceSettings, run_and_compare};
use super::{ComponentError, REFERENCE_SOLID, RICKER, half_plane};

const SOURCE_MOMENT: f64 = 1e5;

/// Depth of the explosion, in wavelengths of the Rayleigh wave.
const SOURCE_DEPTH: f64 = 0.5;

/// Names and coordinates (x, upwards) of receivers, in wavelengths of the Rayleigh wave.
const RECEIVER_POSITIONS: [(&str, [f64; 2]); 6] = [
    ("surface1", [0.87, 0.0]),
    ("surface2", [1.94, 0.0]),
    ("surface3", [2.95, 0.0]),
    ("below1", [0.0, -1.5]),
    ("oblique2", [1.6, -1.6]),
    ("shallow3", [2.9, -0.7]),
];

/// Relative errors of the velocities at all receivers.
pub fn compute_errors(settings: &ReferenceSettings) -> Vec<ComponentError> {
    let wavelength = REFERENCE_SOLID.rayleigh_speed() / RICKER.frequency;
    let h = wavelength / settings.cells_per_wavelength;
    let axes = AxisMapping::new(2, settings);
    let shift = settings.grid_shift();
    let depth = match shift {
        0.0 => SOURCE_DEPTH * wavelength,
        _ => ((SOURCE_DEPTH * settings.cells_per_wavelength).round() + shift) * h,
    };
    // The Rayleigh wave passes the farthest receiver; waves reflected from the boundaries arrive later.
    let duration = 6.2 / RICKER.frequency;
    let reach = REFERENCE_SOLID.pressure_speed() * duration / wavelength;
    let half_width = (0.5 * (reach + 3.0) * settings.cells_per_wavelength).ceil();
    let bottom = (0.5 * (reach + 2.0 + SOURCE_DEPTH) * settings.cells_per_wavelength).ceil();
    let mut case = axes.format_leading_sections(
        &REFERENCE_SOLID,
        h,
        &[2.0 * half_width, bottom],
        &[-half_width - shift, -bottom],
        duration,
    );
    case += &axes.format_boundaries("non-reflecting", &[(0, false), (0, true), (1, false)]);
    case += &format!(
        "[[source]]\nkind = \"explosion\"\namplitude = {SOURCE_MOMENT}\nat = {:?}\n{}\
         time = {{ kind = \"ricker\", frequency = {} }}\n",
        axes.to_axis_order(&[0.0, -depth]),
        settings.format_kernel(),
        RICKER.frequency
    );
    let receivers = RECEIVER_POSITIONS.map(|(name, at)| {
        ReferenceReceiver::new(
            name,
            &at,
            at[0].hypot(at[1] + SOURCE_DEPTH),
            wavelength,
            (settings, &[shift, 0.0]),
        )
    });
    run_and_compare(settings, axes, case, &receivers, |receiver, time| {
        let at = [receiver.position[0], -receiver.position[1]];
        let [along, down] =
            half_plane::garvin_motion(&REFERENCE_SOLID, SOURCE_MOMENT, depth, at, time, RICKER, 1);
        vec![along, down.into_iter().map(|v| -v).collect()]
    })
}
