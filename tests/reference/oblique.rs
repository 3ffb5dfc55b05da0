//! Oblique plane pulse incident on the plane interface of two solids.
//!
//! The pulse is wide, receivers are close to the centre of the illuminated part of the interface, and records are
//! compared until the last reflected or transmitted pulse has passed, i.e. before diffraction from the ends of the
//! pulse arrives. The pulse starts in one solid and travels several wavelengths before it reaches the interface.

use super::interface::{Plane, Wave, waves};
use super::run::{Frame, Receiver, Settings, compare, moduli};
use super::{RICKER, Ricker, Row, SOLID, Solid};

/// Solid below the interface; its wave speeds are larger by the factor 1.44, so the shortest waves are those above.
pub const BELOW: Solid = Solid { lambda: 2e8, mu: 2e8, density: 2400.0 };

/// Angles of incidence of P and S waves, degrees; subcritical.
const ANGLES: [f64; 2] = [12.0, 10.0];

/// Width of constant amplitude, in wavelengths.
const WIDTH: f64 = 24.0;

/// Half-length of the Ricker function in periods: at this distance from its peak it is below 10⁻⁶.
const PERIODS: f64 = 1.36;

/// Names and coordinates (x, upwards) of receivers, in wavelengths of the S wave above the interface.
const RECEIVERS: [(&str, [f64; 2]); 7] = [
    ("above1", [0.2, 1.0]),
    ("above2", [0.4, 2.0]),
    ("above3", [0.6, 3.0]),
    ("interface", [0.0, 0.0]),
    ("below1", [0.3, -1.0]),
    ("below2", [0.6, -2.0]),
    ("below3", [0.9, -3.0]),
];

/// Relative errors of the velocities for an incident P or S wave; distances are measured from the interface.
pub fn rows(settings: &Settings, incident: Wave) -> Vec<Row> {
    let wavelength = SOLID.shear_speed() / RICKER.frequency;
    let h = wavelength / settings.cells;
    let frame = Frame::new(2, settings);
    let (speed, angle) = match incident {
        Wave::P => (SOLID.pressure_speed(), ANGLES[0].to_radians()),
        Wave::S => (SOLID.shear_speed(), ANGLES[1].to_radians()),
    };
    let waves = waves(&SOLID, &BELOW, incident, angle).expect("all waves travel");
    // In the initial state the pulse, including its tapers of half its width on both sides, just touches the
    // interface.
    let length = PERIODS * speed / SOLID.shear_speed();
    let distance = WIDTH * angle.tan() + length;
    let travel = distance * SOLID.shear_speed() / speed;
    let duration = (travel + 3.0 + 1.5) / RICKER.frequency;
    let n = waves.above[0].direction;
    let from = n.map(|n| -distance * n);
    // In wavelengths: extent of the pulse above the interface, and a depth from which no wave returns within the
    // duration.
    let aside = WIDTH + 1.0;
    let top = from[1] + WIDTH * angle.sin() + length + 1.0;
    let bottom = 8.0;
    let cells = |x: f64| (x * settings.cells).ceil();
    let low = [-cells(aside - from[0]), -cells(bottom)];
    let count = [cells(aside) - low[0], cells(top) - low[1]];
    let mut case = frame.begin(&SOLID, h, &count, &low, duration);
    case += &frame.sides("non-reflecting", &[(0, false), (0, true), (1, false), (1, true)]);
    case += &format!(
        "[[region]]\nshape = \"layer\"\naxis = {}\nfrom = {}\nto = 0\nmodel = {{ {} }}\n\
         [[region]]\nshape = \"rest\"\n",
        frame.place(&[0, 1]).iter().position(|own| *own == 1).expect("the upward axis") + 1,
        low[1] * h,
        moduli(&BELOW, ", "),
    );
    let direction = frame.place(&n);
    // If the case axes have opposite handedness, the sign of the S polarisation is reversed.
    let sign = if frame.is_mirrored() && incident == Wave::S { -1.0 } else { 1.0 };
    case += &format!(
        "[[initial]]\nkind = \"plane-pulse\"\nwave = \"{incident:?}\"\ndirection_deg = {}\n\
         at = {:?}\namplitude = {sign:?}\nwidth = {}\n\
         time = {{ kind = \"ricker\", frequency = {}, delay = 0 }}\n",
        direction[1].atan2(direction[0]).to_degrees(),
        frame.place(&from.map(|x| x * wavelength)),
        WIDTH * wavelength,
        RICKER.frequency,
    );
    let on_side =
        |at: [f64; 2]| -> &[Plane] { if at[1] >= 0.0 { &waves.above } else { &waves.below } };
    let receivers = RECEIVERS.map(|(name, at)| {
        let own = Receiver::new(name, &at, at[1].abs(), wavelength, (settings, &[0.0; 2]));
        let point = [own.at[0], own.at[1]];
        let last = on_side(point).iter().map(|wave| wave.arrival(point)).fold(0.0, f64::max);
        Receiver { until: last + (travel + PERIODS) / RICKER.frequency, ..own }
    });
    let centred = |t: f64| Ricker::real(&RICKER, t + 1.5 / RICKER.frequency, 0);
    compare(settings, frame, case, &receivers, |receiver, time| {
        let at = [receiver.at[0], receiver.at[1]];
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
