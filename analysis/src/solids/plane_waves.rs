//! Plane waves of a solid, elastic or yielding.

use crate::waves::{self, DirectionalWaves};
use models::elastoplastic::Solid;
use models::yield_set::tangent::NoResponse;
use num_complex::Complex64;

/// Plane waves along the unit vector `normal`, of the elastic solid if `is_elastic`.
///
/// # Errors
/// The rate response of the yielding solid is not defined.
pub fn directional_waves(
    solid: &Solid,
    normal: [f64; 3],
    is_elastic: bool,
) -> Result<DirectionalWaves, NoResponse> {
    if solid.dimensions == 2 {
        let [x, y, _] = normal;
        let rates = if is_elastic { solid.elastic_rates() } else { solid.rates()? };
        Ok(DirectionalWaves::from_equations::<2>(&rates, [x, y]))
    } else {
        let rates = if is_elastic { solid.elastic_rates() } else { solid.rates()? };
        Ok(DirectionalWaves::from_equations::<3>(&rates, normal))
    }
}

/// The roots ς along the unit vector `normal` at the wave number `k` (1/m), 1/s, by descending real part;
/// roots that are zero at all k are omitted.
///
/// # Errors
/// The rate response of the yielding solid is not defined.
pub fn plane_wave_roots(
    solid: &Solid,
    normal: [f64; 3],
    k: f64,
) -> Result<Vec<Complex64>, NoResponse> {
    let [x, y, _] = normal;
    let damped = match solid.dimensions {
        2 => solid.damped_rates::<2>()?.map(|rates| waves::roots(&rates, [x, y], k)),
        _ => solid.damped_rates::<3>()?.map(|rates| waves::roots(&rates, normal, k)),
    };
    let mut all: Vec<Complex64> = match damped {
        Some(roots) => roots,
        None => directional_waves(solid, normal, false)?
            .families
            .iter()
            .flat_map(|family| {
                let squares = family.squared_frequencies(k);
                // With energy conservation a negative ω² is rounding.
                let is_symmetric_hyperbolic = solid.is_symmetric_hyperbolic();
                squares.into_iter().map(move |square| match is_symmetric_hyperbolic {
                    true => Complex64::from(square.re.max(0.0)),
                    false => square,
                })
            })
            .map(|square| square.sqrt() * Complex64::i())
            .flat_map(|root| [root, -root])
            .collect(),
    };
    all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    Ok(all)
}

/// Largest Re ς along the unit vector `normal` at the wave number `k` (1/m), 1/s, including roots that are zero at all
/// k.
///
/// # Errors
/// The rate response of the yielding solid is not defined.
pub fn growth_rate(solid: &Solid, normal: [f64; 3], k: f64) -> Result<f64, NoResponse> {
    Ok(plane_wave_roots(solid, normal, k)?.iter().map(|root| root.re).fold(0.0, f64::max))
}
