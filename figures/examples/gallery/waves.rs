//! Example dispersion relations, wave speeds, and flutter over the sphere.

use crate::sampling::sample_interval;
use wellposed_figures::{
    DispersionBranch, DispersionFigure, FrequencyBand, ReferenceLevel, SolidResponse, SpeedCurve,
    SpeedsFigure, SphereFigure, SphereMark, ZeroSpeedNormal,
};

/// Builds the dispersion relation of an elastic Cosserat medium; with `has_growth` on logarithmic axes and with
/// synthetic growth rates, which are positive for short waves of the slow transverse branch.
pub fn build_dispersion_figure(has_growth: bool) -> DispersionFigure {
    let [rho, lambda, mu, alpha] = [2700.0, 8.1e9, 8.1e9, 1.005e9_f64];
    let [j, beta, gamma, eta] = [2700.0, 7.75e8, 1.5e8, 3e8_f64];
    let longitudinal = ((lambda + 2.0 * mu) / rho).sqrt();
    let cutoff = (4.0 * alpha / j).sqrt();
    let torsion = |k: f64| (((beta + 2.0 * gamma) * k * k + 4.0 * alpha) / j).sqrt();
    let transverse = move |k: f64, upper: bool| {
        let (shear, bending) = ((mu + alpha) * k * k, (gamma + eta) * k * k);
        let half = 0.5 * (rho * (bending + 4.0 * alpha) + j * shear) / (rho * j);
        let product = (shear * bending + 4.0 * alpha * mu * k * k) / (rho * j);
        let root = (half * half - product).max(0.0).sqrt();
        // ω² of the lower branch, half − root, is computed as product/(half + root), without cancellation for long
        // waves.
        if upper { (half + root).sqrt() } else { (product / (half + root)).sqrt() }
    };
    let numbers: Vec<f64> = if has_growth {
        sample_interval(-2.0, 2.0, 401).into_iter().map(|exponent| 10_f64.powf(exponent)).collect()
    } else {
        sample_interval(0.0, 3.0, 401)
    };
    let branch = |label: &str, omega: &dyn Fn(f64) -> f64, growth: &dyn Fn(f64) -> f64| {
        let slope = |k: f64| {
            let step = 1e-4 * k.max(1e-3);
            let below = (k - step).max(0.0);
            (omega(k + step) - omega(below)) / (k + step - below)
        };
        let over = |f: &dyn Fn(f64) -> f64| numbers.iter().map(|&k| [k, f(k)]).collect();
        DispersionBranch {
            label: label.to_owned(),
            frequency: over(omega),
            group_speed: over(&slope),
            measured_frequency: over(omega).into_iter().skip(20).step_by(60).collect(),
            disagreeing_frequency: Vec::new(),
            growth_rate: if has_growth { over(growth) } else { Vec::new() },
        }
    };
    let level = |label: String, value: f64| ReferenceLevel { label, value };
    let speeds = [
        ("cₚ", longitudinal),
        ("√((μ+α)/ρ)", ((mu + alpha) / rho).sqrt()),
        ("cₛ", (mu / rho).sqrt()),
        ("√((γ+η)/j)", ((gamma + eta) / j).sqrt()),
        ("√((β+2γ)/j)", ((beta + 2.0 * gamma) / j).sqrt()),
    ];
    DispersionFigure {
        title: "Plane waves in an elastic Cosserat medium".to_owned(),
        subtitle: "ρ = j = 2700, λ = μ = 8.1×10⁹ Pa, α = 1.005×10⁹ Pa, β = 7.75×10⁸ N, \
                   γ = 1.5×10⁸ N, η = 3×10⁸ N"
            .to_owned(),
        wave_number_label: "wave number k (1/m)".to_owned(),
        frequency_label: "angular frequency ω (rad/s)".to_owned(),
        speed_label: "speed (m/s)".to_owned(),
        growth_label: "growth rate Re ς (1/s)".to_owned(),
        is_wave_number_log: has_growth,
        is_frequency_log: has_growth,
        branches: vec![
            branch("longitudinal", &|k| longitudinal * k, &|_| -2.0),
            branch("torsion", &torsion, &|k| -0.5 * k),
            branch("transverse, slow (double)", &|k| transverse(k, false), &|k| {
                90.0 * k * k / (1.0 + k * k) - 20.0
            }),
            branch("transverse, fast (double)", &|k| transverse(k, true), &|k| -30.0 * k.sqrt()),
        ],
        bands: vec![FrequencyBand {
            label: "band gap of rotational waves".to_owned(),
            low: if has_growth { 600.0 } else { 0.0 },
            high: cutoff,
        }],
        cutoffs: vec![level(format!("ω* = {cutoff:.0} rad/s"), cutoff)],
        speed_limits: speeds.map(|(symbol, value)| level(symbol.to_owned(), value)).to_vec(),
    }
}

/// Builds the speeds of a solid with imaginary speeds in one sector of directions and flutter in another.
pub fn build_speeds_figure() -> SpeedsFigure {
    let angles = sample_interval(0.0, 180.0, 721);
    let curve = |label: &str, response, multiplicity, f: &dyn Fn(f64) -> f64| SpeedCurve {
        label: label.to_owned(),
        points: angles.iter().map(|&angle| [angle, f(angle)]).collect(),
        response,
        multiplicity,
    };
    let wave = |angle: f64| (2.0 * (angle - 12.0)).to_radians().cos();
    // Half the difference of two speeds, in units of 150 m/s; zero where the speeds would be complex.
    let gap = |angle: f64| (0.55 - wave(angle)).max(0.0).sqrt();
    let pair = |angle: f64, sign: f64| 620.0 + 60.0 * wave(angle) + sign * 150.0 * gap(angle);
    let (elastic, yielding) = (SolidResponse::Elastic, SolidResponse::Yielding);
    SpeedsFigure {
        title: "Characteristic speeds in the plane of shear".to_owned(),
        subtitle: "Cosserat solid, ρ = 2700 kg/m³, h = 0.08 μ, φ = 35°, ν = 5°".to_owned(),
        speed_label: "characteristic speed c".to_owned(),
        unit: "m/s".to_owned(),
        curves: vec![
            curve("elastic solid", elastic, 1, &|_| 3000.0),
            curve("elastic solid", elastic, 2, &|_| 1836.0),
            curve("elastic solid", elastic, 1, &|_| 631.0),
            curve("yielding: quasi-longitudinal", yielding, 1, &|a| {
                2750.0 - 190.0 * wave(a + 20.0)
            }),
            curve("yielding: quasi-transverse", yielding, 1, &|a| {
                900.0 * ((2.0 * (a - 90.0)).to_radians().cos() - 57_f64.to_radians().cos()).abs()
            }),
            curve("yielding: out of plane", yielding, 2, &|_| 1650.0),
            curve("yielding: rotational", yielding, 1, &|a| pair(a, 1.0)),
            curve("yielding: rotational", yielding, 1, &|a| pair(a, -1.0)),
        ],
        flutter_sectors: vec![[-16.2, 40.2]],
        imaginary_sectors: vec![[61.5, 118.5]],
        zero_speed_normals: vec![
            ZeroSpeedNormal { label: "shear band".to_owned(), angle_deg: 61.5 },
            ZeroSpeedNormal { label: "shear band".to_owned(), angle_deg: 118.5 },
        ],
    }
}

/// Builds the slowest speed over all wave normals or, with `has_growth`, the growth rate where speeds are complex.
pub fn build_sphere_figure(has_growth: bool) -> SphereFigure {
    let (polar, azimuth) = (sample_interval(0.0, 90.0, 91), sample_interval(0.0, 360.0, 361));
    let band = [0.62_f64, 0.0, 0.785];
    let worst = [0.35_f64, 0.75, 0.561];
    let mut values = Vec::new();
    for theta in &polar {
        for phi in &azimuth {
            let (sin, cos) = theta.to_radians().sin_cos();
            let n = [sin * phi.to_radians().cos(), sin * phi.to_radians().sin(), cos];
            let along = |m: [f64; 3]| m.iter().zip(n).map(|(a, b)| a * b).sum::<f64>().powi(2);
            values.push(if has_growth {
                let level = along(worst) + 0.2 * n[1] * n[1] - 0.75;
                if level > 0.0 { 900.0 * level.sqrt() } else { f64::NAN }
            } else {
                (1.0 - 0.96 * along(band).powi(3) - 0.2 * n[1] * n[1]).max(0.0).sqrt()
            });
        }
    }
    let mark = |label: &str, normal| SphereMark { label: label.to_owned(), normal };
    let mut marks = vec![mark("normal of the shear band", band)];
    if has_growth {
        marks.push(mark("worst flutter", worst));
        marks.push(mark("intermediate stress axis", [0.0, 1.0, 0.0]));
    }
    let label = if has_growth {
        "growth rate per wave number |Im c| (m/s)"
    } else {
        "slowest speed, yielding to elastic c/c₀ (1)"
    };
    SphereFigure {
        title: if has_growth { "Flutter over all wave normals" } else { "Loss of hyperbolicity" }
            .to_owned(),
        subtitle: "Cosserat solid, ρ = 2700 kg/m³, h = 0.08 μ, φ = 35°, ν = 5°".to_owned(),
        polar_angles_deg: polar,
        azimuth_angles_deg: azimuth,
        values,
        value_label: label.to_owned(),
        is_value_log: false,
        is_dark_low: !has_growth,
        missing_label: "all speeds are real".to_owned(),
        marks,
    }
}
