//! Lamb's problem in plane strain: a line force on the surface of a half-plane.

use super::comparison::{AxisMapping, ReferenceReceiver, ReferenceSettings, run_and_compare};
use super::{ComponentError, REFERENCE_SOLID, RICKER, half_plane};

const FORCE_AMPLITUDE: f64 = 1e5;

/// Names and coordinates (x, upwards) of receivers, in wavelengths of the Rayleigh wave.
const RECEIVER_POSITIONS: [(&str, [f64; 2]); 7] = [
    ("surface1", [1.0, 0.0]),
    ("surface2", [2.0, 0.0]),
    ("surface3", [3.0, 0.0]),
    ("oblique1", [0.6, -0.8]),
    ("below2", [0.0, -2.0]),
    ("oblique2", [1.5, -1.3]),
    ("shallow2", [2.0, -0.5]),
];

/// Positions (in cells, relative to a point on the face between two cells) and weights of the default kernel
/// w(u) = (7/4) K(u) − ⅜ (K(u − 1) + K(u + 1)), K(u) = ¼ (B(u − 1) + 2 B(u) + B(u + 1)), with the quadratic B-spline B.
pub fn default_kernel() -> impl Iterator<Item = (f64, f64)> {
    let spline = |u: f64| match u.abs() {
        u if u <= 0.5 => 0.75 - u * u,
        u if u < 1.5 => 0.5 * (1.5 - u).powi(2),
        _ => 0.0,
    };
    let wide = move |u: f64| 0.25 * (spline(u - 1.0) + 2.0 * spline(u) + spline(u + 1.0));
    let share = move |u: f64| 1.75 * wide(u) - 0.375 * (wide(u - 1.0) + wide(u + 1.0));
    (-4..4).map(|cell| f64::from(cell) + 0.5).map(move |u| (u, share(u)))
}

/// Relative errors of the velocities for a vertical or a horizontal force.
pub fn compute_errors(settings: &ReferenceSettings, is_vertical: bool) -> Vec<ComponentError> {
    let wavelength = REFERENCE_SOLID.rayleigh_speed() / RICKER.frequency;
    let h = wavelength / settings.cells_per_wavelength;
    let axes = AxisMapping::new(2, settings);
    // The Rayleigh wave passes the farthest receiver; waves reflected from the boundaries arrive later.
    let duration = 6.0 / RICKER.frequency;
    let reach = REFERENCE_SOLID.pressure_speed() * duration / wavelength;
    let half_width = (0.5 * (reach + 3.0) * settings.cells_per_wavelength).ceil();
    let depth = (0.5 * (reach + 2.0) * settings.cells_per_wavelength).ceil();
    let mut case = axes.format_leading_sections(
        &REFERENCE_SOLID,
        h,
        &[2.0 * half_width, depth],
        &[-half_width - settings.grid_shift(), -depth],
        duration,
    );
    case += &axes.format_boundaries("non-reflecting", &[(0, false), (0, true), (1, false)]);
    let field = axes.traction_name(usize::from(is_vertical));
    case += &format!(
        "[[load]]\nside = \"{}\"\nfield = \"{field}\"\nat = 0\namplitude = {FORCE_AMPLITUDE}\n{}\
         time = {{ kind = \"ricker\", frequency = {} }}\n",
        axes.boundary_name(1, true),
        settings.format_kernel(),
        RICKER.frequency
    );
    let receivers = RECEIVER_POSITIONS.map(|(name, at)| {
        ReferenceReceiver::new(
            name,
            &at,
            at[0].hypot(at[1]),
            wavelength,
            (settings, &[settings.grid_shift(), 0.0]),
        )
    });
    // A positive stress on the upper boundary pulls upwards; the exact solution counts depths downwards.
    let force = if is_vertical { [0.0, -FORCE_AMPLITUDE] } else { [FORCE_AMPLITUDE, 0.0] };
    run_and_compare(settings, axes, case, &receivers, |receiver, time| {
        let field = |x: f64| {
            let at = [x.abs(), -receiver.position[1]];
            let [along, down] =
                half_plane::lamb_motion(&REFERENCE_SOLID, force, at, time, RICKER, 1);
            // Reflection x → −x reverses the velocity along x for a vertical force, and the vertical velocity for a
            // horizontal force.
            let signs = match (x < 0.0, is_vertical) {
                (false, _) => [1.0, -1.0],
                (true, true) => [-1.0, -1.0],
                (true, false) => [1.0, 1.0],
            };
            [along, down].into_iter().zip(signs)
        };
        let points: Vec<(f64, f64)> = if settings.has_kernel_convolution {
            default_kernel().collect()
        } else {
            vec![(0.0, 1.0)]
        };
        let mut sums = vec![vec![0.0; time.len()]; 2];
        for (cells, share) in points {
            for (sum, (values, sign)) in
                sums.iter_mut().zip(field(receiver.position[0] - cells * h))
            {
                sum.iter_mut().zip(values).for_each(|(sum, v)| *sum += sign * share * v);
            }
        }
        sums
    })
}
