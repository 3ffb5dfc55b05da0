//! Example verdict maps.

use crate::sampling::sample_interval;
use wellposed_figures::{
    FillStyle, Hatching, MapCurve, VerdictCategory, VerdictMap, VerdictMapAxis,
};

fn build_categories<const N: usize>(entries: [(&str, FillStyle); N]) -> Vec<VerdictCategory> {
    let categories = entries.map(|(label, fill_style)| VerdictCategory {
        label: label.to_owned(),
        fill_style,
        level_factor: 1.0,
    });
    categories.to_vec()
}

/// Builds a map over non-coaxiality and friction angle that is ill-posed beyond the bounds ±45° of the non-coaxiality,
/// towards which the growth coefficient increases.
pub fn build_noncoaxiality_map() -> VerdictMap {
    let (x, y) = (sample_interval(-90.0, 90.0, 361), sample_interval(1.0, 60.0, 237));
    let (mut cells, mut level) = (Vec::new(), Vec::new());
    for friction in &y {
        for delta in &x {
            let cos = (2.0 * delta).to_radians().cos();
            let sin = friction.to_radians().sin();
            cells.push(if delta.abs() == 45.0 { 2 } else { u8::from(delta.abs() > 45.0) });
            level.push(if delta.abs() > 45.0 {
                12.0 * (1.0 + 8.0 * sin) / cos.abs()
            } else {
                f64::NAN
            });
        }
    }
    let bound = |at: f64| MapCurve {
        label: "bound |Δ| = 45°".to_owned(),
        points: vec![[at, -10.0], [at, 100.0]],
    };
    VerdictMap {
        title: "Harris–Grekova model, ν = 0: where is it well-posed?".to_owned(),
        subtitle: "p = 10 kPa, ρ = 1600 kg/m³, Q = 1 s⁻¹, ψ = 30°, m/p = 0.1".to_owned(),
        x: VerdictMapAxis { label: "non-coaxiality Δ (°)".to_owned(), values: x, is_log: false },
        y: VerdictMapAxis { label: "friction angle φ (°)".to_owned(), values: y, is_log: false },
        categories: build_categories([
            ("well-posed", FillStyle::WellPosed),
            ("ill-posed, order 1", FillStyle::IllPosed(Hatching::Plain)),
            ("marginal", FillStyle::Marginal),
        ]),
        category_indices: cells,
        growth_levels: level.into(),
        level_label: "growth coefficient lim Re ς / k (m/s)".to_owned(),
        boundaries: Default::default(),
        is_line: Default::default(),
        curves: vec![bound(-45.0), bound(45.0)],
    }
}

/// Builds a map with all fill styles, two ill-posed categories of different growth order, and growth levels over many
/// decades.
pub fn build_all_verdicts_map() -> VerdictMap {
    let (x, y) = (sample_interval(-90.0, 90.0, 241), sample_interval(0.0, 40.0, 161));
    let (mut cells, mut level) = (Vec::new(), Vec::new());
    for dilatancy in &y {
        for delta in &x {
            let radius = (delta / 60.0).hypot((dilatancy - 14.0) / 12.0);
            let (cell, value) = match () {
                () if *dilatancy > 34.0 => (6, f64::NAN),
                () if *delta > 62.0 => (4, f64::NAN),
                () if *delta < -66.0 => (5, f64::NAN),
                () if radius < 0.6 => (0, f64::NAN),
                () if radius < 0.63 => (3, f64::NAN),
                () if *delta > 0.0 => (1, 1e-2 * (9.0 * radius).exp()),
                () if radius > 1.7 => (2, f64::INFINITY),
                () => (2, 3.0 * (4.0 * radius).exp() * (1.2 + (0.1 * dilatancy).sin())),
            };
            cells.push(cell);
            level.push(value);
        }
    }
    let bound = |scale: f64, label: &str| {
        let point = |t: f64| {
            let (sin, cos) = t.to_radians().sin_cos();
            [60.0 * scale * cos, 14.0 + 12.0 * scale * sin]
        };
        let points = sample_interval(0.0, 360.0, 181).into_iter().map(point).collect();
        MapCurve { label: label.to_owned(), points }
    };
    VerdictMap {
        title: "Dilatant domain: every answer the program can give".to_owned(),
        subtitle: "Made-up verdicts over non-coaxiality and dilatancy angle; φ = 35°, \
                   p = 10 kPa, ρ = 1600 kg/m³, Q = 1 s⁻¹"
            .to_owned(),
        x: VerdictMapAxis { label: "non-coaxiality Δ (°)".to_owned(), values: x, is_log: false },
        y: VerdictMapAxis { label: "dilatancy angle ν (°)".to_owned(), values: y, is_log: false },
        categories: build_categories([
            ("well-posed", FillStyle::WellPosed),
            ("ill-posed, order 1", FillStyle::IllPosed(Hatching::Plain)),
            ("ill-posed, order ½", FillStyle::IllPosed(Hatching::Rising)),
            ("marginal", FillStyle::Marginal),
            ("unbounded at finite k", FillStyle::UnboundedAtFiniteWaveNumber),
            ("indeterminate", FillStyle::Indeterminate),
            ("outside the model", FillStyle::OutsideModel),
        ]),
        category_indices: cells,
        growth_levels: level.into(),
        level_label: "growth coefficient lim Re ς / kᵐ (mᵐ/s)".to_owned(),
        boundaries: Default::default(),
        is_line: Default::default(),
        curves: vec![bound(0.615, "bound in closed form"), bound(1.05, "sufficient condition")],
    }
}
