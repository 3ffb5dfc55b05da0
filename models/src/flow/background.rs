//! Background of a granular flow: completes a state by the flow rule and the balance laws, and rejects contradictions.

use super::state::{
    Background, DeformingFlow, FlowRule, MaterialRotation, MaterialState, MohrCoulomb,
    PlanarStress, YieldRegion,
};
use crate::common::decimal::ShortNumber;
use crate::common::elementary::Elementary;
use crate::common::input::{InputError, ensure, to_rounded_degrees};
use crate::common::rounding::Rounded;

/// Tolerance of the difference between a redundant input and its derived value, relative to the size of the terms.
const REDUNDANCY_TOLERANCE: f64 = 1e-9;

/// Distance within which a stress counts as on yield: |q − q_y| relative to q_y, the deviatoric stress on yield, and
/// |r − 0| or |r ∓ m| relative to the rotational strength m.
const YIELD_TOLERANCE: f64 = 1e-12;

/// Completes `state` to a background by the yield condition, the flow rule and the balance laws.
pub(super) fn complete_background(
    coulomb: &MohrCoulomb,
    rule: &FlowRule,
    rotation: MaterialRotation,
    state: &MaterialState,
) -> Result<Background, InputError> {
    check_ranges(coulomb, rule, rotation, state)?;
    let noncoaxiality = compute_noncoaxiality(rule, state)?;

    // Relative rotation ω − s₂₁ from the second line of the flow rule, where
    // (d₁₁ − d₂₂) sin 2ψ − 2 d₁₂ cos 2ψ = −2 Q_D sin 2Δ with the shear rate Q_D and the non-coaxiality Δ.
    let twice = 2.0 * noncoaxiality;
    let shear_rate = Rounded::from_rounded(state.shear_rate);
    let relative_rotation = if rotation == MaterialRotation::None {
        Rounded::ZERO
    } else {
        -(rule.shear_coefficient / rule.rotation_coefficient * shear_rate * twice.sin())
    };

    let (stress, region) = compute_stress_and_region(coulomb, rotation, state, relative_rotation)?;
    if region != YieldRegion::FullyDeforming {
        return Ok(Background::NotDeforming { region, stress });
    }

    let velocity_gradient = compute_velocity_gradient(rule, state, noncoaxiality);
    let acceleration = compute_acceleration(coulomb, state, &stress);
    let mut flow = DeformingFlow {
        density: state.density,
        stress,
        shear_rate: state.shear_rate,
        noncoaxiality: noncoaxiality.value,
        noncoaxiality_rounding: noncoaxiality.bound,
        velocity: state.velocity,
        velocity_gradient,
        relative_rotation,
        half_vorticity: state.half_vorticity,
        spin: match rotation {
            MaterialRotation::IntrinsicSpin { .. } | MaterialRotation::Free => {
                Some(relative_rotation + Rounded::from_rounded(state.half_vorticity))
            }
            MaterialRotation::StressAxes | MaterialRotation::None => None,
        },
        acceleration,
        body_moment: None,
        stress_angle_rate: (rotation == MaterialRotation::StressAxes)
            .then(|| (relative_rotation + Rounded::from_rounded(state.half_vorticity)).value),
        pressure_gradient: state.pressure_gradient,
        stress_angle_gradient: state.stress_angle_gradient,
        spin_gradient: state.spin_gradient,
        density_gradient: state.density_gradient,
        inertia_rate: state.inertia_rate,
        inertia_gradient: state.inertia_gradient,
        internal_power: 0.0,
    };
    if let MaterialRotation::IntrinsicSpin { moment_of_inertia, .. } = rotation {
        // Body moment from the balance of spin (Harris & Grekova 2005, eq. 9) with a uniform rotational stress r.
        let spin = flow.spin.unwrap_or_default().value;
        flow.body_moment = Some(
            moment_of_inertia * state.spin_acceleration + state.inertia_rate * spin
                - 2.0 * stress.rotational_stress / state.density,
        );
    }
    flow.internal_power = compute_internal_power(rule, &flow);
    check_redundant_inputs(rotation, state, &flow)?;
    Ok(Background::FullyDeforming(flow))
}

/// Iterates over all given numbers of a state, each with its input key.
fn keyed_quantities(state: &MaterialState) -> impl Iterator<Item = (&'static str, f64)> {
    let pairs = [
        ("velocity", Some(state.velocity)),
        ("pressure_gradient", Some(state.pressure_gradient)),
        ("stress_angle_gradient", Some(state.stress_angle_gradient)),
        ("spin_gradient", Some(state.spin_gradient)),
        ("density_gradient", Some(state.density_gradient)),
        ("inertia_gradient", Some(state.inertia_gradient)),
        ("acceleration", state.acceleration),
        ("velocity_gradient", state.velocity_gradient.map(|g| g[0])),
        ("velocity_gradient", state.velocity_gradient.map(|g| g[1])),
    ];
    let single = [
        ("density", Some(state.density)),
        ("pressure", Some(state.pressure)),
        ("deviatoric_stress", state.deviatoric_stress),
        ("rotational_stress", state.rotational_stress),
        ("stress_angle", Some(state.stress_angle)),
        ("shear_rate", Some(state.shear_rate)),
        ("half_vorticity", Some(state.half_vorticity)),
        ("noncoaxiality", state.noncoaxiality),
        ("spin", state.spin),
        ("spin_acceleration", Some(state.spin_acceleration)),
        ("inertia_rate", Some(state.inertia_rate)),
        ("body_moment", state.body_moment),
        ("stress_angle_rate", state.stress_angle_rate),
    ];
    let pairs =
        pairs.into_iter().flat_map(|(key, pair)| pair.into_iter().flatten().map(move |x| (key, x)));
    pairs.chain(single.into_iter().filter_map(|(key, x)| Some((key, x?))))
}

/// Checks that all given numbers of `state` are finite, that density, shear rate and pressure are in range, and that in
/// a model that does not use them spin, body moment and rate of the stress angle are absent, non-coaxiality and density
/// gradient absent or zero.
fn check_ranges(
    coulomb: &MohrCoulomb,
    rule: &FlowRule,
    rotation: MaterialRotation,
    state: &MaterialState,
) -> Result<(), InputError> {
    for (key, x) in keyed_quantities(state) {
        ensure(x.is_finite(), key, x, "a finite number is needed")?;
    }
    let has_balance = matches!(rotation, MaterialRotation::IntrinsicSpin { .. });
    ensure(
        state.spin.is_none() || has_balance || rotation == MaterialRotation::Free,
        "spin",
        state.spin.unwrap_or_default(),
        "this model has no spin of its own: leave the key out",
    )?;
    ensure(
        state.body_moment.is_none() || has_balance,
        "body_moment",
        state.body_moment.unwrap_or_default(),
        "this model has no balance of spin: leave the key out",
    )?;
    ensure(
        MaterialState::DENSITY.contains(state.density),
        "density",
        state.density,
        "the density must be positive",
    )?;
    ensure(
        MaterialState::SHEAR_RATE.contains(state.shear_rate),
        "shear_rate",
        state.shear_rate,
        "the shear rate Q_D must be positive",
    )?;
    let on_yield = coulomb.yield_deviator(state.pressure);
    ensure(
        on_yield.value > 0.0 && on_yield.value.is_finite(),
        "pressure",
        state.pressure,
        format_args!(
            "expected a pressure above −c cot φ = {} Pa, where the material has no strength left",
            ShortNumber(-coulomb.cohesion / coulomb.friction_angle.cr_tan())
        ),
    )?;
    ensure(
        state.noncoaxiality.is_none_or(|delta| delta == 0.0) || rotation != MaterialRotation::None,
        "noncoaxiality",
        to_rounded_degrees(state.noncoaxiality.unwrap_or_default()),
        "the plastic potential is coaxial: leave the key out or set it to 0",
    )?;
    ensure(
        rule.is_dilatant || state.density_gradient == [0.0; 2],
        "density_gradient",
        format_args!(
            "[{}, {}]",
            ShortNumber(state.density_gradient[0]),
            ShortNumber(state.density_gradient[1])
        ),
        "the density is constant when the dilatancy angle is 0: leave the key out or set it to 0",
    )?;
    ensure(
        state.stress_angle_rate.is_none() || rotation == MaterialRotation::StressAxes,
        "stress_angle_rate",
        to_rounded_degrees(state.stress_angle_rate.unwrap_or_default()),
        "this model does not determine the rate of the stress angle: leave the key out",
    )
}

/// Returns the non-coaxiality Δ, rad: the given value, which must agree with the spin if both are given; else the
/// solution of the flow rule with cos 2Δ ≥ 0 for a given spin; else 0.
fn compute_noncoaxiality(rule: &FlowRule, state: &MaterialState) -> Result<Rounded, InputError> {
    let given = Rounded::from_angle(state.noncoaxiality.unwrap_or(0.0));
    let Some(spin) = state.spin else { return Ok(given) };
    // sin 2Δ = −(ω − s₂₁) sin(φ − ν) / (Q_D cos ν)
    let factor = rule.rotation_coefficient
        / rule.shear_coefficient
        / Rounded::from_rounded(state.shear_rate);
    let sine = (Rounded::from_rounded(state.half_vorticity) - Rounded::from_rounded(spin)) * factor;
    if state.noncoaxiality.is_some() {
        let residual = sine.value - (2.0 * given.value).cr_sin();
        let size = 1.0f64.max((spin.abs() + state.half_vorticity.abs()) * factor.value);
        return ensure(
            residual.abs() <= REDUNDANCY_TOLERANCE * size,
            "spin",
            spin,
            format_args!(
                "spin and non-coaxiality contradict each other: the flow rule leaves the residual \
                 {} in sin 2Δ; give one of them",
                ShortNumber(residual)
            ),
        )
        .map(|()| given);
    }
    ensure(
        sine.value.abs() <= 1.0,
        "spin",
        spin,
        format_args!(
            "expected a spin within {} rad/s of half_vorticity: the flow rule allows no other",
            ShortNumber(1.0 / factor.value)
        ),
    )?;
    Ok(0.5 * sine.asin())
}

/// Completes the stress by default values of the deviatoric stress q and the rotational stress r, and finds its
/// position relative to the yield conditions. Within [`YIELD_TOLERANCE`], q is replaced by its value on yield and r by
/// 0 or ±m with the rotational strength m.
fn compute_stress_and_region(
    coulomb: &MohrCoulomb,
    rotation: MaterialRotation,
    state: &MaterialState,
    relative_rotation: Rounded,
) -> Result<(PlanarStress, YieldRegion), InputError> {
    let on_yield = coulomb.yield_deviator(state.pressure);
    let strength = match rotation {
        MaterialRotation::IntrinsicSpin { strength, .. } => strength,
        _ => 0.0,
    };
    let mut region = YieldRegion::FullyDeforming;

    let deviator = match state.deviatoric_stress {
        None => on_yield,
        Some(q) => {
            ensure(
                MaterialState::DEVIATORIC_STRESS.contains(q),
                "deviatoric_stress",
                q,
                "the deviatoric stress q is a magnitude of at least 0 Pa",
            )?;
            if (q - on_yield.value).abs() <= YIELD_TOLERANCE * on_yield.value {
                on_yield
            } else {
                region = if q > on_yield.value {
                    YieldRegion::OutsideYield
                } else {
                    YieldRegion::RigidOrIndeterminate
                };
                Rounded::from_rounded(q)
            }
        }
    };
    let rotational = match state.rotational_stress {
        None => -strength * f64::from(relative_rotation.sign().unwrap_or(0)),
        Some(r) => {
            let is_near = |target: f64| (r - target).abs() <= YIELD_TOLERANCE * strength;
            match [0.0, strength, -strength].into_iter().find(|&target| is_near(target)) {
                Some(target) => target,
                None => {
                    if r.abs() > strength {
                        region = YieldRegion::OutsideYield;
                    } else if region == YieldRegion::FullyDeforming {
                        region = YieldRegion::RigidOrIndeterminate;
                    }
                    r
                }
            }
        }
    };
    // Adding +0 turns −0 into 0 for output.
    let rotational = rotational + 0.0;
    let stress = PlanarStress {
        pressure: state.pressure,
        deviator,
        rotational_stress: rotational,
        angle: state.stress_angle,
    };
    Ok((stress, region))
}

/// Computes the velocity gradient ∂ⱼVᵢ, 1/s, from the magnitude Q_D and the angle Ψ_D = Ψ_Σ + Δ of the deviatoric
/// deformation rate, the dilatation tr d of the flow rule and the half vorticity s₂₁; `delta` is Δ, rad.
fn compute_velocity_gradient(
    rule: &FlowRule,
    state: &MaterialState,
    delta: Rounded,
) -> [[Rounded; 2]; 2] {
    let rate = Rounded::from_rounded(state.shear_rate);
    let angle = 2.0 * (Rounded::from_angle(state.stress_angle) + delta);
    let half_trace = if rule.is_dilatant {
        rule.dilatation() * rate * (2.0 * delta).cos()
    } else {
        Rounded::ZERO
    };
    let (normal, shear) = (rate * angle.cos(), rate * angle.sin());
    let spin = Rounded::from_rounded(state.half_vorticity);
    [[half_trace + normal, shear - spin], [shear + spin, half_trace - normal]]
}

/// Computes acceleration minus body force, DV/Dt − F, m/s², from the balance of momentum (Harris & Grekova 2005,
/// eqs 16, 17).
fn compute_acceleration(
    coulomb: &MohrCoulomb,
    state: &MaterialState,
    stress: &PlanarStress,
) -> [Rounded; 2] {
    let angle = 2.0 * Rounded::from_angle(stress.angle);
    let (s2, c2) = (angle.sin(), angle.cos());
    let sin_phi = Rounded::from_angle(coulomb.friction_angle).sin();
    let [p1, p2] = state.pressure_gradient.map(Rounded::from_rounded);
    let [a1, a2] = state.stress_angle_gradient.map(Rounded::from_angle);
    let q = stress.deviator;
    let force = [
        (Rounded::ONE - sin_phi * c2) * p1 - sin_phi * s2 * p2 + 2.0 * (q * (s2 * a1 - c2 * a2)),
        (Rounded::ONE + sin_phi * c2) * p2 - sin_phi * s2 * p1 - 2.0 * (q * (c2 * a1 + s2 * a2)),
    ];
    force.map(|f| -(f / Rounded::from_rounded(state.density)))
}

/// Internal power `2 Q_D cos 2Δ (q − p tr d/(2 Q_D cos 2Δ)) − 2 r (ω − s₂₁)`, W/m³; symbols as in [`MaterialState`] and
/// [`FlowRule`].
fn compute_internal_power(rule: &FlowRule, flow: &DeformingFlow) -> f64 {
    let cosine = (2.0 * flow.rounded_noncoaxiality()).cos().value;
    let dilatation = if rule.is_dilatant { rule.dilatation().value } else { 0.0 };
    2.0 * flow.shear_rate
        * cosine
        * (flow.stress.deviator.value - flow.stress.pressure * dilatation)
        - 2.0 * flow.stress.rotational_stress * flow.relative_rotation.value
}

/// Checks redundant inputs (velocity gradient, acceleration, body moment, rate of the stress angle) against the derived
/// background.
fn check_redundant_inputs(
    rotation: MaterialRotation,
    state: &MaterialState,
    flow: &DeformingFlow,
) -> Result<(), InputError> {
    let ensure_agreement = |key, equation: &str, given: f64, derived: f64, size: f64| {
        ensure(
            (given - derived).abs() <= REDUNDANCY_TOLERANCE * size,
            key,
            given,
            format_args!(
                "expected {}, the value of {equation} (residual {}); or leave the key out",
                ShortNumber(derived),
                ShortNumber(given - derived)
            ),
        )
    };
    if let Some(given) = state.velocity_gradient {
        let derived = flow.velocity_gradient.map(|row| row.map(|x| x.value));
        let key = "velocity_gradient";
        let size = state.shear_rate + state.half_vorticity.abs();
        let parts = |g: [[f64; 2]; 2]| {
            [
                ("the flow rule for the volume (tr d)", g[0][0] + g[1][1]),
                (
                    "shear_rate with the angle of the deformation rate (d₁₁ − d₂₂)",
                    g[0][0] - g[1][1],
                ),
                ("shear_rate with the angle of the deformation rate (2 d₁₂)", g[0][1] + g[1][0]),
                ("half_vorticity (∂₁V₂ − ∂₂V₁)", g[1][0] - g[0][1]),
            ]
        };
        for ((equation, given), (_, derived)) in parts(given).into_iter().zip(parts(derived)) {
            ensure_agreement(key, equation, given, derived, size)?;
        }
    }
    if let Some(given) = state.acceleration {
        let size = |i: usize| flow.acceleration[i].value.abs() + 1e3 * flow.acceleration[i].bound;
        let size = size(0).max(size(1));
        for (equation, (given, derived)) in [
            "the first component of the balance of momentum",
            "the second component of the balance of momentum",
        ]
        .into_iter()
        .zip(given.into_iter().zip(flow.acceleration))
        {
            ensure_agreement("acceleration", equation, given, derived.value, size)?;
        }
    }
    if let (Some(given), Some(derived), MaterialRotation::IntrinsicSpin { moment_of_inertia, .. }) =
        (state.body_moment, flow.body_moment, rotation)
    {
        let spin = flow.spin.unwrap_or_default().value;
        let size = (moment_of_inertia * state.spin_acceleration).abs()
            + (state.inertia_rate * spin).abs()
            + (2.0 * flow.stress.rotational_stress / flow.density).abs();
        ensure_agreement("body_moment", "the balance of spin", given, derived, size)?;
    }
    if let (Some(given), Some(derived)) = (state.stress_angle_rate, flow.stress_angle_rate) {
        let size = flow.relative_rotation.value.abs() + state.half_vorticity.abs();
        let key = "stress_angle_rate";
        let equation = "the flow rule, in degrees per second,";
        ensure_agreement(
            key,
            equation,
            to_rounded_degrees(given),
            to_rounded_degrees(derived),
            to_rounded_degrees(size),
        )?;
    }
    Ok(())
}
