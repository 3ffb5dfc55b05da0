//! Plane waves of a solid, elastic or yielding.

use crate::waves::{self, DirectionalWaves, DispersionForms};
use models::common::rates::RateEquations;
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

/// Plane waves of a solid along any direction, elastic or yielding; what the directions have in common is computed once.
#[derive(Clone, Debug)]
pub struct PlaneWaves {
    equations: WaveEquations,
    is_symmetric_hyperbolic: bool,
}

/// Equations of the waves in a plane and in space, without and with relaxation.
#[derive(Clone, Debug)]
enum WaveEquations {
    Plane(DispersionForms<2>),
    Space(Box<DispersionForms<3>>),
    DampedPlane(RateEquations<2>),
    DampedSpace(RateEquations<3>),
}

impl PlaneWaves {
    /// Linearises the equations of a solid.
    ///
    /// # Errors
    /// The rate response of the yielding solid is not defined.
    pub fn new(solid: &Solid) -> Result<Self, NoResponse> {
        let equations = match solid.dimensions {
            2 => match solid.damped_rates()? {
                Some(rates) => WaveEquations::DampedPlane(rates),
                None => WaveEquations::Plane(DispersionForms::new(&solid.rates()?)),
            },
            _ => match solid.damped_rates()? {
                Some(rates) => WaveEquations::DampedSpace(rates),
                None => WaveEquations::Space(Box::new(DispersionForms::new(&solid.rates()?))),
            },
        };
        Ok(Self { equations, is_symmetric_hyperbolic: solid.is_symmetric_hyperbolic() })
    }

    /// The roots ς along the unit vector `normal` at the wave number `k` (1/m), 1/s, by descending real part; roots that
    /// are zero at all k are omitted.
    pub fn roots(&self, normal: [f64; 3], k: f64) -> Vec<Complex64> {
        let [x, y, _] = normal;
        let mut all = match &self.equations {
            WaveEquations::Plane(forms) => self.undamped_roots(&forms.waves_along([x, y]), k),
            WaveEquations::Space(forms) => self.undamped_roots(&forms.waves_along(normal), k),
            WaveEquations::DampedPlane(rates) => waves::roots(rates, [x, y], k),
            WaveEquations::DampedSpace(rates) => waves::roots(rates, normal, k),
        };
        all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        all
    }

    fn undamped_roots(&self, waves: &DirectionalWaves, k: f64) -> Vec<Complex64> {
        let squares = waves.families.iter().flat_map(|family| family.squared_frequencies(k));
        squares
            // With energy conservation a negative ω² is rounding.
            .map(|square| match self.is_symmetric_hyperbolic {
                true => Complex64::from(square.re.max(0.0)),
                false => square,
            })
            .map(|square| square.sqrt() * Complex64::i())
            .flat_map(|root| [root, -root])
            .collect()
    }

    /// Largest Re ς along the unit vector `normal` at the wave number `k` (1/m), 1/s, including roots that are zero at
    /// all k.
    pub fn growth_rate(&self, normal: [f64; 3], k: f64) -> f64 {
        self.roots(normal, k).iter().map(|root| root.re).fold(0.0, f64::max)
    }
}
