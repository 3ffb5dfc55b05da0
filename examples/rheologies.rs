//! Draws `gallery/rheologies.png`: growth of short waves in granular rheologies against the inertial number.
//!
//! `cargo run --release --example rheologies -- gallery/rheologies.png`
//!
//! Simple shear at a pressure of 1 kPa, of the incompressible μ(I) rheology, its regularisation by Barker & Gray (2017) and
//! compressible I-dependent rheologies (Barker, Schaeffer, Shearer & Gray 2017), from the cases in `cases/equations`. The
//! growth coefficient lim Re ς/k² is drawn in units of the square of the particle diameter times the shear rate; a rheology
//! has no curve where it is well-posed.

use std::error::Error;
use std::path::Path;
use wellposed::analysis::growth::Verdict;
use wellposed::figures::{FigureFormat, LabelledCurve, SpectrumFigure};
use wellposed::study::ignore_progress;

/// Diameter of the particles, m, and factor I/γ̇ = d √(ρ_s/p), s, of the cases.
const DIAMETER: f64 = 5e-4;
const TIME: f64 = DIAMETER * 1.581_138_830_084_189_7;

/// Number of inertial numbers from 10⁻⁴ to 10.
const POINT_COUNT: usize = 401;

/// Number of bisections of a step in which the curve ends, which give it as many further points.
const BISECTION_COUNT: usize = 10;

/// Growth coefficient in units of d² γ̇ against the inertial number; NaN where the case is well-posed or has no state.
fn compute_curve(
    case: &str,
    settings: &[&str],
    label: &str,
) -> Result<LabelledCurve, Box<dyn Error>> {
    let path = format!("cases/equations/{case}.toml");
    let compute_point = |exponent: f64| -> Result<[f64; 2], Box<dyn Error>> {
        let inertial = 10f64.powf(exponent);
        let rate = inertial / TIME;
        let shear = format!("background.v1.d2={rate:?}");
        let case = wellposed::load(&path, settings.iter().copied().chain([shear.as_str()]))?;
        let growth = match wellposed::analyse_point(&case, &ignore_progress) {
            Ok(found) => match found.verdict() {
                Some(Verdict::IllPosed { growth: Some(growth), .. }) => growth.coefficient,
                _ => f64::NAN,
            },
            Err(_) => f64::NAN,
        };
        Ok([inertial, growth / (DIAMETER * DIAMETER * rate)])
    };
    let exponents: Vec<f64> = (0..POINT_COUNT)
        .map(|index| -4.0 + 5.0 * index as f64 / (POINT_COUNT - 1) as f64)
        .collect();
    let mut points =
        exponents.iter().map(|&exponent| compute_point(exponent)).collect::<Result<Vec<_>, _>>()?;
    let is_drawn = |point: &[f64; 2]| point[1].is_finite();
    let drawn = points.iter().filter(|point| is_drawn(point)).count();
    for index in 1..POINT_COUNT {
        let [mut inside, mut outside] = [index - 1, index].map(|index| exponents[index]);
        match [index - 1, index].map(|index| is_drawn(&points[index])) {
            [true, false] => {}
            [false, true] => (inside, outside) = (outside, inside),
            _ => continue,
        }
        for _ in 0..BISECTION_COUNT {
            let middle = 0.5 * (inside + outside);
            let point = compute_point(middle)?;
            *(if is_drawn(&point) { &mut inside } else { &mut outside }) = middle;
            points.extend(is_drawn(&point).then_some(point));
        }
    }
    points.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let label = if drawn == 0 { format!("{label}: well-posed") } else { label.to_owned() };
    println!("{label}: ill-posed of order 2 at {drawn} of {POINT_COUNT} inertial numbers");
    Ok(LabelledCurve { label, points })
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "rheologies.png".into());
    let figure = SpectrumFigure {
        title: "Growth of short waves in granular rheologies".into(),
        subtitle: "simple shear; no curve where well-posed".into(),
        x_label: "inertial number I".into(),
        y_label: "growth coefficient, in units of d² γ̇".into(),
        spectra: vec![
            compute_curve("mu-of-i", &[], "μ(I)")?,
            compute_curve("barker-gray", &[], "Barker & Gray 2017")?,
            compute_curve("compressible-i-dependent", &[], "compressible, three conditions")?,
            compute_curve(
                "compressible-i-dependent",
                &["model.parameters.alpha1=-0.2", "model.parameters.beta1=-0.05"],
                "compressible, ∂Y/∂I < 0",
            )?,
        ],
        measured_points: Vec::new(),
        disagreeing_points: Vec::new(),
        remarks: Vec::new(),
    };
    std::fs::write(Path::new(&path), figure.draw(FigureFormat::Png)?)?;
    Ok(())
}
