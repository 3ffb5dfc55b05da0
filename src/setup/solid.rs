//! From a case to a solid.

use crate::case::{Case, Kind, Medium, Solid as SolidKind, Wave, Yield, names, radians};
use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances};
use models::cosserat::stress::Stress;
use models::elementary::Elementary;
use models::granular_flow::InputError;
use models::plasticity::parameters::{Interlayer, InterlayerCouple, Mises, YieldSet};
use models::solid::{ElasticLaw, Plastic, Solid};

/// The solid of a case.
///
/// # Errors
/// The constant that is out of range; that the stress never yields; that the case is one of a flow.
pub fn solid(case: &Case) -> Result<Solid, InputError> {
    let elastic = elastic_law(case)?;
    let plastic = case.yields.map(|set| plastic(case, set)).transpose()?;
    Ok(Solid::new(elastic, case.numbers.solid.dimensions, plastic))
}

/// The elastic law of a case and its yield set, whatever the stress.
///
/// # Errors
/// The constant that is out of range; that the case is one of a flow.
pub fn elastic_law_and_set(case: &Case) -> Result<(ElasticLaw, Option<YieldSet>), InputError> {
    let set = case.yields.map(|set| yield_set(case, set)).transpose()?;
    Ok((elastic_law(case)?, set))
}

/// Unit vector along a wave.
pub fn normal(wave: &Wave) -> [f64; 3] {
    let (sin, cos) = radians(wave.direction_deg).cr_sin_cos();
    let (up, along) = radians(wave.elevation_deg).cr_sin_cos();
    [along * cos, along * sin, up]
}

/// The elastic law of a case.
fn elastic_law(case: &Case) -> Result<ElasticLaw, InputError> {
    let given = case.numbers.solid;
    let rotation = |couple| Microrotation { alpha: given.alpha, inertia: given.inertia, couple };
    let isotropic = |microrotation| {
        Isotropic::new(given.lambda, given.mu, given.density, microrotation)
            .map(ElasticLaw::Isotropic)
    };
    match case.kind {
        Kind::Solid(SolidKind::Classical) => isotropic(None),
        Kind::Solid(SolidKind::ReducedCosserat) => isotropic(Some(rotation(None))),
        Kind::Solid(SolidKind::Cosserat) => {
            let couple = CoupleModuli { beta: given.beta, gamma: given.gamma, eta: given.eta };
            isotropic(Some(rotation(Some(couple))))
        }
        Kind::Solid(SolidKind::CosseratCompliances) => PlaneCompliances {
            a1: given.a1,
            b1: given.b1,
            a2: given.a2,
            b2: given.b2,
            alpha2: given.alpha2,
            density: given.density,
            inertia: given.inertia,
        }
        .check()
        .map(ElasticLaw::Compliances),
        Kind::Flow(_) => Err(InputError {
            key: "kind",
            found: format!("{}, a flow", case.kind.name()),
            allowed: format!(
                "this needs a solid ({}); for flows see wellposed point and map",
                names(&Kind::solids())
            ),
        }),
    }
}

fn plastic(case: &Case, kind: Yield) -> Result<Plastic, InputError> {
    let set = yield_set(case, kind)?;
    if let (YieldSet::Interlayer(layers), Some(active)) = (set, &case.active) {
        return Plastic::with_active(layers, active);
    }
    let pressure = case.numbers.stress.pressure;
    Plastic::at_stress(set, pressure, &direction(case), case.numbers.yields.plastic_rate)
}

/// The stress of a case but for its pressure.
fn direction(case: &Case) -> Stress {
    let given = case.numbers.stress;
    let (sin, cos) = (2.0 * radians(given.stress_angle_deg)).cr_sin_cos();
    let [q, r] = [given.deviatoric_stress, given.rotational_stress];
    let mut stress = Stress::default();
    stress.force[0] = [q * cos, q * sin - r, 0.0];
    stress.force[1] = [q * sin + r, -q * cos, 0.0];
    stress.force[2][2] = given.out_of_plane_stress;
    stress.couple[2] = [given.couple_stress[0], given.couple_stress[1], 0.0];
    stress
}

fn yield_set(case: &Case, kind: Yield) -> Result<YieldSet, InputError> {
    let given = case.numbers.yields;
    let von_mises = Mises { hardening: given.hardening, ..Mises::von_mises(given.strength) };
    let cone = Mises { friction: given.friction, dilatancy: given.dilatancy, ..von_mises };
    let limit = |length: f64| (length != 0.0).then_some(length);
    let mises = |set: Mises| set.check().map(YieldSet::Mises);
    match kind {
        Yield::Interlayer => {
            let has_couples = matches!(
                case.medium(),
                Medium {
                    kind: Kind::Solid(SolidKind::Cosserat | SolidKind::CosseratCompliances),
                    ..
                }
            );
            let couple = InterlayerCouple {
                strength: given.couple_strength,
                friction: given.couple_friction,
                dilatancy: given.couple_dilatancy,
            };
            Interlayer {
                shear_strength: given.shear_strength,
                shear_friction: given.shear_friction,
                shear_dilatancy: given.shear_dilatancy,
                couple: has_couples.then_some(couple),
            }
            .check()
            .map(YieldSet::Interlayer)
        }
        Yield::VonMises => mises(von_mises),
        Yield::DruckerPrager => mises(cone),
        Yield::CosseratMises => mises(Mises {
            antisymmetric_weight: given.antisymmetric_weight,
            symmetric_length: limit(given.symmetric_length),
            antisymmetric_length: limit(given.antisymmetric_length),
            ..cone
        }),
    }
}
