//! Oblique plane pulse incident on the plane interface of two solids.
//!
//! The pulse is wide, receivers are close to the centre of the illuminated part of the interface, and records are
//! compared until the last reflected or transmitted pulse has passed, i.e. before diffraction from the ends of the
//! pulse arrives. The pulse starts in one solid and travels several wavelengths before it reaches the interface.

use super::comparison::{
    AxisMapping, ReferenceReceiver, ReferenceSettings, format_moduli, run_and_compare,
};
use super::interface::{BodyWave, InterfaceWave, solve_interface_waves};
use super::{ComponentError, IsotropicSolid, REFERENCE_SOLID, RICKER, Ricker};

/// Solid below the interface; its wave speeds are larger by the factor 1.44, so the shortest waves are those above.
pub const LOWER_SOLID: IsotropicSolid = IsotropicSolid { lambda: 2e8, mu: 2e8, density: 2400.0 };

/// Angles of incidence of P and S waves, degrees; subcritical.
const INCIDENCE_ANGLES: [f64; 2] = [12.0, 10.0];

/// Width of the pulse over which its amplitude is constant, in wavelengths of the S wave above the interface.
const PULSE_WIDTH: f64 = 24.0;

/// Half-length of the Ricker function in periods: at this distance from its peak it is below 10⁻⁶.
const RICKER_HALF_LENGTH: f64 = 1.36;

/// Names and coordinates (x, upwards) of receivers, in wavelengths of the S wave above the interface.
const RECEIVER_POSITIONS: [(&str, [f64; 2]); 7] = [
    ("above1", [0.2, 1.0]),
    ("above2", [0.4, 2.0]),
    ("above3", [0.6, 3.0]),
    ("interface", [0.0, 0.0]),
    ("below1", [0.3, -1.0]),
    ("below2", [0.6, -2.0]),
    ("below3", [0.9, -3.0]),
];

/// Relative errors of the velocities for an incident P or S wave; distances are measured from the interface.
pub fn compute_errors(settings: &ReferenceSettings, incident: BodyWave) -> Vec<ComponentError> {
    let wavelength = REFERENCE_SOLID.shear_speed() / RICKER.frequency;
    let h = wavelength / settings.cells_per_wavelength;
    let axes = AxisMapping::new(2, settings);
    let (speed, angle) = match incident {
        BodyWave::P => (REFERENCE_SOLID.pressure_speed(), INCIDENCE_ANGLES[0].to_radians()),
        BodyWave::S => (REFERENCE_SOLID.shear_speed(), INCIDENCE_ANGLES[1].to_radians()),
    };
    let waves = solve_interface_waves(&REFERENCE_SOLID, &LOWER_SOLID, incident, angle)
        .expect("all waves travel");
    // In the initial state the pulse, including its tapers of half its width on both sides, just touches the
    // interface.
    let length = RICKER_HALF_LENGTH * speed / REFERENCE_SOLID.shear_speed();
    let distance = PULSE_WIDTH * angle.tan() + length;
    let travel = distance * REFERENCE_SOLID.shear_speed() / speed;
    let duration = (travel + 3.0 + 1.5) / RICKER.frequency;
    let n = waves.above[0].direction;
    let from = n.map(|n| -distance * n);
    // In wavelengths: extent of the pulse above the interface, and a depth from which no wave returns within the
    // duration.
    let aside = PULSE_WIDTH + 1.0;
    let top = from[1] + PULSE_WIDTH * angle.sin() + length + 1.0;
    let bottom = 8.0;
    let cells = |x: f64| (x * settings.cells_per_wavelength).ceil();
    let low = [-cells(aside - from[0]), -cells(bottom)];
    let count = [cells(aside) - low[0], cells(top) - low[1]];
    let mut case = axes.format_leading_sections(&REFERENCE_SOLID, h, &count, &low, duration);
    case +=
        &axes.format_boundaries("non-reflecting", &[(0, false), (0, true), (1, false), (1, true)]);
    case += &format!(
        "[[region]]\nshape = \"layer\"\naxis = {}\nfrom = {}\nto = 0\nmodel = {{ {} }}\n\
         [[region]]\nshape = \"rest\"\n",
        axes.to_axis_order(&[0, 1])
            .iter()
            .position(|coordinate| *coordinate == 1)
            .expect("the upward axis")
            + 1,
        low[1] * h,
        format_moduli(&LOWER_SOLID, ", "),
    );
    let direction = axes.to_axis_order(&n);
    // If the case axes have opposite handedness, the sign of the S polarisation is reversed.
    let sign = if axes.is_mirrored() && incident == BodyWave::S { -1.0 } else { 1.0 };
    case += &format!(
        "[[initial]]\nkind = \"plane-pulse\"\nwave = \"{incident:?}\"\ndirection_deg = {}\n\
         at = {:?}\namplitude = {sign:?}\nwidth = {}\n\
         time = {{ kind = \"ricker\", frequency = {}, delay = 0 }}\n",
        direction[1].atan2(direction[0]).to_degrees(),
        axes.to_axis_order(&from.map(|x| x * wavelength)),
        PULSE_WIDTH * wavelength,
        RICKER.frequency,
    );
    let on_side = |at: [f64; 2]| -> &[InterfaceWave] {
        if at[1] >= 0.0 { &waves.above } else { &waves.below }
    };
    let receivers = RECEIVER_POSITIONS.map(|(name, at)| {
        let receiver =
            ReferenceReceiver::new(name, &at, at[1].abs(), wavelength, (settings, &[0.0; 2]));
        let point = [receiver.position[0], receiver.position[1]];
        let last = on_side(point).iter().map(|wave| wave.arrival_time(point)).fold(0.0, f64::max);
        ReferenceReceiver {
            end_time: last + (travel + RICKER_HALF_LENGTH) / RICKER.frequency,
            ..receiver
        }
    });
    let centred = |t: f64| Ricker::derivative_at(&RICKER, t + 1.5 / RICKER.frequency, 0);
    run_and_compare(settings, axes, case, &receivers, |receiver, time| {
        let at = [receiver.position[0], receiver.position[1]];
        let mut sums = vec![vec![0.0; time.len()]; 2];
        for (index, t) in time.iter().enumerate() {
            for wave in on_side(at) {
                let v = wave.velocity(at, t - travel / RICKER.frequency, centred);
                sums.iter_mut().zip(v).for_each(|(sum, v)| sum[index] += v);
            }
        }
        sums
    })
}
