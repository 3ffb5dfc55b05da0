//! Radial flow in a hopper: an exact solution of double shearing and of the Harris–Grekova model with zero spin.
//!
//! Plane steady flow towards the apex of a wedge |θ| ≤ θ_w, ν = 0, c = 0, inertia neglected. The axis of the hopper is
//! x₁ from the apex upwards, gravity is −g e₁, and (r, θ) are polar coordinates. Velocity, stress angle and pressure are
//!
//! ```text
//! v = −(f(θ)/r) e_r,   ψ = θ + γ(θ),   p = ρ g r χ(θ).
//! ```
//!
//! The axes of stress do not rotate along streamlines, Dψ/Dt = 0: the solution of double shearing is one of
//! Harris–Grekova with spin ω = 0 and rotational stress r = 0 (Harris & Grekova 2005, section 8). With s = sin φ the
//! balance of momentum and the flow rule are (Jenike 1964, *J. Appl. Mech.* 31, 5–11, for the stress)
//!
//! ```text
//!  s sin 2γ χ′ + 2χs cos 2γ γ′       = cos θ + χ (1 − 3s cos 2γ)
//! −(1 + s cos 2γ) χ′ + 2χs sin 2γ γ′ = −sin θ − 3χs sin 2γ
//!  f′/f                              = −2 sin 2γ/(s + cos 2γ)
//! ```
//!
//! with γ(0) = 0 on the axis, and the shear traction of the wall equal to tan δ_w times its pressure,
//! s sin 2γ = tan δ_w (1 + s cos 2γ) at θ_w. The equations are singular where cos 2γ = −s, where the ray through the
//! apex is a slip line.
//!
//! The friction angle δ that is mobilised on a ray, tan δ = s sin 2γ/(1 + s cos 2γ), is −2Δ: by the flow rule
//! tan 2Δ = −tan δ with cos 2Δ > 0. Since |δ| ≤ φ, the non-coaxiality is at most φ/2, and −δ_w/2 at the wall.
//!
//! Method: shooting. The pressure on the axis χ(0) is found by bisection, and the initial-value problem is solved by
//! extrapolation of the modified midpoint rule (Gragg 1965; Bulirsch & Stoer 1966) with adaptive steps.

use super::parameters::FRICTION_ANGLE;
use super::state::MaterialState;
use crate::common::elementary::Elementary;
use crate::common::input::{InputError, ensure, to_rounded_degrees};
use std::f64::consts::FRAC_PI_2;

/// Numbers of substeps of the modified midpoint rule that a step extrapolates.
const SUBSTEPS: [usize; 8] = [2, 4, 6, 8, 10, 12, 14, 16];

/// Tolerance of a step: difference of the last two extrapolated values of ln χ, γ and ln f.
const STEP_TOLERANCE: f64 = 1e-13;

/// Least step relative to the integrated angle; a smaller one means that the solution becomes singular.
const LEAST_STEP: f64 = 1e-7;

/// Largest pressure χ(0) on the axis.
const MAX_AXIS_PRESSURE: f64 = 1e6;

/// Tolerance of the wall friction, rad, by which the search tells a solution from the boundary of singular ones.
const WALL_TOLERANCE: f64 = 1e-9;

/// Radial flow in a hopper with rough walls. All angles in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialFlow {
    sin_phi: f64,
    wall_angle: f64,
    axis_pressure: f64,
}

/// Fields of a [`RadialFlow`] on one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialFields {
    /// Angle θ of the ray from the axis, rad.
    pub angle: f64,
    /// Pressure χ = p/(ρ g r) and its derivative χ′ by θ.
    pub pressure: [f64; 2],
    /// Angle γ from the ray to the most tensile principal stress, rad, and its derivative γ′ by θ.
    pub stress_angle: [f64; 2],
    /// Speed f/f(0) = r |v|/f(0) and its derivative by θ.
    pub speed: [f64; 2],
}

/// Dimensions of a radial flow at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialScales {
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Gravity g, m/s².
    pub gravity: f64,
    /// Distance r from the apex, m.
    pub radius: f64,
    /// Speed times distance from the apex on the axis, f(0) = r |v|, m²/s.
    pub axis_flow: f64,
}

impl RadialFlow {
    /// Solves for the flow of a material of friction angle φ in a hopper of half opening angle θ_w = `wall_angle` with
    /// the wall friction angle δ_w = `wall_friction_angle`, in which the stress is passive (largest compression across
    /// the axis). Relative errors of the fields are near 1e-13.
    ///
    /// # Errors
    /// 0 < φ < 90°, 0 < θ_w < 90° or 0 ≤ δ_w < φ is violated; or there is no such flow with χ(0) < 10⁶, as in a
    /// wide hopper with smooth walls for φ < 19.5° (sin φ < 1/3).
    pub fn new(
        friction_angle: f64,
        wall_angle: f64,
        wall_friction_angle: f64,
    ) -> Result<Self, InputError> {
        let degrees = to_rounded_degrees;
        FRICTION_ANGLE
            .check(friction_angle, "the friction angle must lie between 0 and 90 degrees")?;
        ensure(
            wall_angle > 0.0 && wall_angle < FRAC_PI_2,
            "wall_angle",
            degrees(wall_angle),
            "the angle from the axis to the wall must lie between 0 and 90 degrees",
        )?;
        ensure(
            (0.0..friction_angle).contains(&wall_friction_angle),
            "wall_friction_angle",
            degrees(wall_friction_angle),
            "the wall friction angle must be at least 0 and below the friction angle",
        )?;
        let with_pressure =
            |axis_pressure| Self { sin_phi: friction_angle.cr_sin(), wall_angle, axis_pressure };
        let wall_friction = |flow: &Self| {
            let (sin, cos) = (2.0 * flow.fields_at(wall_angle)?.stress_angle[0]).cr_sin_cos();
            Some((flow.sin_phi * sin).cr_atan2(1.0 + flow.sin_phi * cos))
        };
        // The larger χ(0), the smaller the friction at the wall; for a small χ(0) the solution becomes singular.
        let [mut low, mut high] = [1e-2 * wall_angle, MAX_AXIS_PRESSURE].map(with_pressure);
        loop {
            let middle = with_pressure((low.axis_pressure * high.axis_pressure).sqrt());
            if middle.axis_pressure <= low.axis_pressure
                || middle.axis_pressure >= high.axis_pressure
            {
                break;
            }
            match wall_friction(&middle) {
                Some(friction) if friction <= wall_friction_angle => high = middle,
                _ => low = middle,
            }
        }
        ensure(
            wall_friction(&high)
                .is_some_and(|found| (found - wall_friction_angle).abs() <= WALL_TOLERANCE),
            "wall_friction_angle",
            degrees(wall_friction_angle),
            format_args!(
                "there is no radial flow in a hopper with walls at {}° from the axis for this friction",
                degrees(wall_angle)
            ),
        )?;
        Ok(high)
    }

    /// Half opening angle θ_w of the hopper, rad.
    pub fn wall_angle(&self) -> f64 {
        self.wall_angle
    }

    /// The fields on the ray at `angle` θ from the axis, rad, |θ| ≤ θ_w; `None` if the solution is singular before, which
    /// can only be beyond the wall.
    pub fn fields_at(&self, angle: f64) -> Option<RadialFields> {
        let mut at = 0.0;
        let mut fields = [self.axis_pressure.cr_ln(), 0.0, 0.0];
        let mut step = 0.25 * angle;
        while at != angle {
            let is_last = step.abs() >= (angle - at).abs();
            let length = if is_last { angle - at } else { step };
            if let Some(next) = self.extrapolate(at, fields, length) {
                fields = next;
                at = if is_last { angle } else { at + length };
                step = 1.5 * length;
            } else {
                step = 0.5 * length;
                if step.abs() < LEAST_STEP * angle.abs() {
                    return None;
                }
            }
        }
        let rates = self.rates(at, fields);
        let [pressure, speed] = [fields[0].cr_exp(), fields[2].cr_exp()];
        Some(RadialFields {
            angle,
            pressure: [pressure, pressure * rates[0]],
            stress_angle: [fields[1], rates[1]],
            speed: [speed, speed * rates[2]],
        })
    }

    /// Derivatives by θ of ln χ, γ and ln f at the angle `at`.
    fn rates(&self, at: f64, [log_pressure, gamma, _]: [f64; 3]) -> [f64; 3] {
        let s = self.sin_phi;
        let weight = (-log_pressure).cr_exp();
        let (sin, cos) = (2.0 * gamma).cr_sin_cos();
        let (radial, transverse) = {
            let (sin_at, cos_at) = at.cr_sin_cos();
            (weight * cos_at + 1.0 - 3.0 * s * cos, -weight * sin_at - 3.0 * s * sin)
        };
        let determinant = s + cos;
        [
            (sin * radial - cos * transverse) / determinant,
            ((1.0 + s * cos) * radial + s * sin * transverse) / (2.0 * s * determinant),
            -2.0 * sin / determinant,
        ]
    }

    /// Advances `fields` from the angle `at` by `step` by extrapolating the modified midpoint rule to zero substep
    /// (Aitken–Neville, in the square of the substep). `None` if the tolerance is not met or the result is singular.
    fn extrapolate(&self, at: f64, fields: [f64; 3], step: f64) -> Option<[f64; 3]> {
        let add = |one: [f64; 3], factor: f64, other: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| one[i] + factor * other[i])
        };
        let mut row: Vec<[f64; 3]> = Vec::with_capacity(SUBSTEPS.len());
        let mut change = f64::INFINITY;
        for (last, &count) in SUBSTEPS.iter().enumerate() {
            let substep = step / count as f64;
            let (mut before, mut now) = (fields, add(fields, substep, self.rates(at, fields)));
            for index in 1..count {
                let rates = self.rates(at + index as f64 * substep, now);
                (before, now) = (now, add(before, 2.0 * substep, rates));
            }
            let end = self.rates(at + step, now);
            let smoothed = add(add(now, 1.0, before), substep, end).map(|sum| 0.5 * sum);
            let mut next = vec![smoothed];
            for column in 0..last {
                let ratio = count as f64 / SUBSTEPS[last - 1 - column] as f64;
                let difference = add(next[column], -1.0, row[column]);
                next.push(add(next[column], 1.0 / (ratio * ratio - 1.0), difference));
            }
            if let [.., previous, own] = next[..] {
                change = add(own, -1.0, previous).into_iter().fold(0.0, |a, d| d.abs().max(a));
            }
            row = next;
        }
        let result = *row.last()?;
        let is_regular = self.sin_phi + (2.0 * result[1]).cr_cos() > 0.0
            && result[1].abs() < FRAC_PI_2
            && result.iter().all(|field| field.is_finite());
        (is_regular && change <= STEP_TOLERANCE).then_some(result)
    }
}

impl RadialFields {
    /// Angle from the ray to the greater principal deformation rate, ψ_D − θ, rad.
    fn rate_angle(&self) -> f64 {
        0.5 * (-self.speed[1]).cr_atan2(2.0 * self.speed[0])
    }

    /// Non-coaxiality Δ = ψ_D − ψ, rad.
    pub fn noncoaxiality(&self) -> f64 {
        self.rate_angle() - self.stress_angle[0]
    }

    /// The state of the flow at a point of the ray, with the non-coaxiality, in the frame of x₁ along the axis.
    pub fn to_state(&self, scales: &RadialScales) -> MaterialState {
        let RadialScales { density, gravity, radius, axis_flow } = *scales;
        let (sin, cos) = self.angle.cr_sin_cos();
        let to_frame = |[radial, transverse]: [f64; 2]| {
            [radial * cos - transverse * sin, radial * sin + transverse * cos]
        };
        let [speed, speed_slope] = self.speed.map(|speed| axis_flow * speed);
        let squared_radius = radius * radius;
        MaterialState {
            density,
            pressure: density * gravity * radius * self.pressure[0],
            stress_angle: self.angle + self.stress_angle[0],
            shear_rate: (2.0 * speed).root_sum_square(speed_slope) / (2.0 * squared_radius),
            velocity: to_frame([-speed / radius, 0.0]),
            half_vorticity: speed_slope / (2.0 * squared_radius),
            noncoaxiality: Some(self.noncoaxiality()),
            pressure_gradient: to_frame(self.pressure).map(|slope| density * gravity * slope),
            stress_angle_gradient: to_frame([0.0, (1.0 + self.stress_angle[1]) / radius]),
            ..MaterialState::default()
        }
    }
}
