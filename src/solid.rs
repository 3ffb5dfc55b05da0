//! A solid: from the numbers of a case to its waves.

use crate::case::{Case, CaseError, Kind, Solid, Wave, radians};
use analysis::waves::Waves;
use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances};
use models::granular_flow::InputError;

/// An elastic solid with checked constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elastic {
    /// By its moduli; waves in space.
    Isotropic(Isotropic),
    /// By its compliances; waves in the plane.
    Compliances(PlaneCompliances),
}

impl Elastic {
    /// The solid of a case.
    ///
    /// # Errors
    /// The constant that is out of range, or that the case is one of a flow; and where it stands.
    pub fn of(case: &Case) -> Result<Self, CaseError> {
        Self::new(case).map_err(|error| case.locate(error))
    }

    fn new(case: &Case) -> Result<Self, InputError> {
        let given = case.numbers.solid;
        let rotation =
            |couple| Microrotation { alpha: given.alpha, inertia: given.inertia, couple };
        let isotropic = |microrotation| {
            Isotropic::new(given.lambda, given.mu, given.density, microrotation)
                .map(Self::Isotropic)
        };
        match case.kind {
            Kind::Solid(Solid::Classical) => isotropic(None),
            Kind::Solid(Solid::ReducedCosserat) => isotropic(Some(rotation(None))),
            Kind::Solid(Solid::Cosserat) => {
                let couple = CoupleModuli { beta: given.beta, gamma: given.gamma, eta: given.eta };
                isotropic(Some(rotation(Some(couple))))
            }
            Kind::Solid(Solid::CosseratCompliances) => PlaneCompliances {
                a1: given.a1,
                b1: given.b1,
                a2: given.a2,
                b2: given.b2,
                alpha2: given.alpha2,
                density: given.density,
                inertia: given.inertia,
            }
            .check()
            .map(Self::Compliances),
            Kind::Flow(_) => Err(InputError {
                key: "model.kind",
                found: format!("{}, a flow", case.kind.name()),
                allowed: format!(
                    "this needs a solid ({}); for flows see wellposed point and map",
                    Kind::SOLIDS.map(Kind::name).join(", ")
                ),
            }),
        }
    }

    /// Unit vector along a wave of the case.
    pub fn normal(wave: &Wave) -> [f64; 3] {
        let (sin, cos) = radians(wave.direction_deg).sin_cos();
        let (up, along) = radians(wave.elevation_deg).sin_cos();
        [along * cos, along * sin, up]
    }

    /// The waves in the direction of the case's wave: in space, by compliances in the plane.
    pub fn waves(&self, wave: &Wave) -> Waves {
        match self {
            Self::Isotropic(solid) => Waves::along(&solid.rates::<3>(), Self::normal(wave)),
            Self::Compliances(solid) => {
                let (sin, cos) = radians(wave.direction_deg).sin_cos();
                Waves::along(&solid.rates(), [cos, sin])
            }
        }
    }

    /// The wave number at which shear waves have the frequency of the natural rotation, 1/m: the
    /// inverse of the solid's own length. `None` in classical solids, which have none.
    pub fn own_wave_number(&self) -> Option<f64> {
        let (frequency, speed) = match self {
            Self::Isotropic(solid) => {
                (solid.microrotation?.natural_frequency(), solid.speeds().shear)
            }
            Self::Compliances(solid) => {
                let PlaneCompliances { a2, b2, density, inertia, .. } = *solid;
                // 4α = 2/(a₂ + b₂), μ + α = a₂/(a₂² − b₂²).
                let frequency = (2.0 / ((a2 + b2) * inertia)).sqrt();
                (frequency, (a2 / ((a2 - b2) * (a2 + b2) * density)).sqrt())
            }
        };
        Some(frequency / speed)
    }
}
