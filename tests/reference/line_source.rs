//! Line force or line explosion in an unbounded plane.

use super::comparison::{AxisMapping, ReferenceReceiver, ReferenceSettings, run_and_compare};
use super::{ComponentError, REFERENCE_SOLID, RICKER, full_plane};

const SOURCE_AMPLITUDE: f64 = 1e5;

/// Position of the source relative to a corner of the grid cells, in cells; it has no symmetry in its cell.
const SOURCE_OFFSET: [f64; 2] = [0.2, 0.35];

/// Names, distances (in wavelengths of the S wave) and directions (degrees) of receivers.
const RECEIVER_POSITIONS: [(&str, f64, f64); 6] = [
    ("axis1", 1.0, 0.0),
    ("oblique1", 1.0, 35.0),
    ("diagonal2", 2.0, 45.0),
    ("steep2", 2.0, 65.0),
    ("oblique3", 3.0, 25.0),
    ("across3", 3.0, 90.0),
];

/// Relative errors of the velocities for a force along the first coordinate, or for an explosion.
pub fn compute_errors(settings: &ReferenceSettings, is_explosion: bool) -> Vec<ComponentError> {
    let wavelength = REFERENCE_SOLID.shear_speed() / RICKER.frequency;
    let h = wavelength / settings.cells_per_wavelength;
    let axes = AxisMapping::new(2, settings);
    // The S wave passes the farthest receiver; waves reflected from the boundaries arrive later.
    let duration = 5.9 / RICKER.frequency;
    let reach = REFERENCE_SOLID.pressure_speed() * duration / wavelength;
    let half = (0.5 * (reach + 3.0) * settings.cells_per_wavelength).ceil();
    let source = match settings.grid_shift() {
        0.0 => SOURCE_OFFSET,
        _ => [0.5; 2],
    };
    let low = source.map(|offset| -half - offset);
    let mut case =
        axes.format_leading_sections(&REFERENCE_SOLID, h, &[2.0 * half; 2], &low, duration);
    case +=
        &axes.format_boundaries("non-reflecting", &[(0, false), (0, true), (1, false), (1, true)]);
    case += &match is_explosion {
        true => format!("[[source]]\nkind = \"explosion\"\namplitude = {SOURCE_AMPLITUDE}\n"),
        false => format!(
            "[[source]]\nkind = \"force\"\namplitude = {:?}\n",
            axes.to_axis_order(&[SOURCE_AMPLITUDE, 0.0])
        ),
    };
    case += &format!(
        "at = [0, 0]\n{}time = {{ kind = \"ricker\", frequency = {} }}\n",
        settings.format_kernel(),
        RICKER.frequency
    );
    let receivers = RECEIVER_POSITIONS.map(|(name, distance, direction)| {
        let (sin, cos) = f64::to_radians(direction).sin_cos();
        let at = [distance * cos, distance * sin];
        ReferenceReceiver::new(name, &at, distance, wavelength, (settings, &source))
    });
    run_and_compare(settings, axes, case, &receivers, |receiver, time| {
        let at = [receiver.position[0], receiver.position[1]];
        let exact = match is_explosion {
            true => full_plane::explosion_motion(
                &REFERENCE_SOLID,
                SOURCE_AMPLITUDE,
                at,
                time,
                RICKER,
                1,
            ),
            false => full_plane::force_motion(
                &REFERENCE_SOLID,
                [SOURCE_AMPLITUDE, 0.0],
                at,
                time,
                RICKER,
                1,
            ),
        };
        exact.to_vec()
    })
}
