//! Lamb's problem in three dimensions: a vertical point force on the surface of a half-space, Poisson's ratio ¼
//! (Pekeris 1955). One quarter is simulated, with two planes of symmetry.

use super::comparison::{AxisMapping, ReferenceReceiver, ReferenceSettings, run_and_compare};
use super::{ComponentError, REFERENCE_SOLID, RICKER, half_space};

const FORCE_AMPLITUDE: f64 = 1e6;

/// Names and coordinates (two horizontal, upwards) of receivers, in wavelengths of the Rayleigh wave.
const RECEIVER_POSITIONS: [(&str, [f64; 3]); 7] = [
    ("surface1", [1.0, 0.0, 0.0]),
    ("diagonal2", [1.4, 1.4, 0.0]),
    ("surface3", [3.0, 0.0, 0.0]),
    ("across3", [0.0, 3.0, 0.0]),
    ("oblique1", [0.6, 0.0, -0.8]),
    ("oblique2", [1.0, 1.0, -1.4]),
    ("shallow3", [2.8, 0.6, -0.6]),
];

/// Relative errors of the velocities at all receivers.
pub fn compute_errors(settings: &ReferenceSettings) -> Vec<ComponentError> {
    let wavelength = REFERENCE_SOLID.rayleigh_speed() / RICKER.frequency;
    let h = wavelength / settings.cells_per_wavelength;
    let axes = AxisMapping::new(3, settings);
    // The Rayleigh wave passes the farthest receiver; waves reflected from the boundaries arrive later.
    let duration = 6.0 / RICKER.frequency;
    let reach = REFERENCE_SOLID.pressure_speed() * duration / wavelength;
    let width = (0.5 * (reach + 3.0) * settings.cells_per_wavelength).ceil();
    let depth = (0.5 * (reach + 1.5) * settings.cells_per_wavelength).ceil();
    let mut case = axes.format_leading_sections(
        &REFERENCE_SOLID,
        h,
        &[width, width, depth],
        &[0.0, 0.0, -depth],
        duration,
    );
    case += &axes.format_boundaries("symmetry", &[(0, false), (1, false)]);
    case += &axes.format_boundaries("non-reflecting", &[(0, true), (1, true), (2, false)]);
    case += &format!(
        "[[load]]\nside = \"{}\"\nfield = \"{}\"\nat = [0, 0]\namplitude = {}\n{}\
         time = {{ kind = \"ricker\", frequency = {} }}\n",
        axes.boundary_name(2, true),
        axes.traction_name(2),
        -FORCE_AMPLITUDE,
        settings.format_kernel(),
        RICKER.frequency
    );
    let receivers = RECEIVER_POSITIONS.map(|(name, at)| {
        let distance = at.iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
        let mut receiver =
            ReferenceReceiver::new(name, &at, distance, wavelength, (settings, &[0.0; 3]));
        // A receiver outside the simulated quarter is replaced by its mirror image.
        receiver.position[..2].iter_mut().for_each(|x| *x = x.abs());
        receiver
    });
    run_and_compare(settings, axes, case, &receivers, |receiver, time| {
        let [x, y, up] = [receiver.position[0], receiver.position[1], receiver.position[2]];
        let r = x.hypot(y);
        let at = [r, -up];
        let [radial, down] = half_space::point_force_motion(
            &REFERENCE_SOLID,
            FORCE_AMPLITUDE,
            at,
            time,
            (RICKER, 1),
            [80, 400],
        );
        let along = |x: f64| radial.iter().map(|v| v * x / r).collect();
        vec![along(x), along(y), down.iter().map(|v| -v).collect()]
    })
}
