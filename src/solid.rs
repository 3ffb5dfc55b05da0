//! A solid: from the numbers of a case to its rate equations, elastic and yielding.

use crate::case::{Case, Kind, Medium, Solid as SolidKind, Wave, Yield, radians};
use crate::frozen::StateError;
use crate::words::short;
use analysis::sphere::Flutter;
use analysis::waves::{Waves, roots};
use models::Rounded;
use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances};
use models::cosserat::stress::{Component, Stress};
use models::elementary::Elementary;
use models::granular_flow::InputError;
use models::plasticity::parameters::{
    ActiveCondition, Interlayer, InterlayerCouple, Mises, YieldSet, contract, mean,
};
use models::plasticity::symbol::tangent;
use models::rates::RateEquations;
use models::solid::ElasticLaw;
use num_complex::Complex64;
use serde_json::{Value, json};

/// Conditions that the scaled stress meets to within this, relative to the terms that they compare,
/// hold with equality.
const ON_YIELD: f64 = 1e-9;

/// A solid with checked constants: elastic, or yielding at some stress.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its elasticity.
    pub elastic: ElasticLaw,
    /// 2 for plane strain, 3 for space.
    pub dimensions: usize,
    /// What yields; `None` in an elastic solid.
    pub plastic: Option<Plastic>,
}

/// What a solid does that yields.
#[derive(Clone, Debug, PartialEq)]
pub struct Plastic {
    /// Its yield set.
    pub set: YieldSet,
    /// The stress, scaled onto yield; `None` where the case names the active conditions instead.
    pub stress: Option<Stress>,
    /// The conditions that hold with equality; at least one.
    pub active: Vec<ActiveCondition>,
    /// Rate Λ at which the background flows, 1/s; 0 of layers, whose conditions are not curved.
    pub rate: f64,
}

impl Solid {
    /// The solid of a case.
    ///
    /// # Errors
    /// The constant that is out of range; that the stress never yields; that the case is one of a flow.
    pub fn of(case: &Case) -> Result<Self, InputError> {
        let elastic = elastic_law(case)?;
        let dimensions = match elastic {
            ElasticLaw::Isotropic(_) => case.numbers.solid.dimensions,
            ElasticLaw::Compliances(_) => 2,
        };
        let plastic = case.yields.map(|set| Plastic::of(case, set)).transpose()?;
        Ok(Self { elastic, dimensions, plastic })
    }

    /// The rate equations in `D` dimensions of the solid while it stays elastic.
    pub fn elastic_rates<const D: usize>(&self) -> RateEquations<D> {
        self.elastic.rates()
    }

    /// The rate equations in `D` dimensions; of a yielding solid while its active conditions stay
    /// active.
    ///
    /// # Errors
    /// There is no rate of response.
    pub fn rates<const D: usize>(&self) -> Result<RateEquations<D>, StateError> {
        let (layout, stiffness) = self.elastic.layout_and_stiffness::<D>();
        let Some(plastic) = &self.plastic else {
            return Ok(self.elastic.rates_with_stiffness(&layout, &stiffness));
        };
        let stresses: Vec<_> = layout.all_stresses().collect();
        Ok(self
            .elastic
            .rates_with_stiffness(&layout, &tangent(&stiffness, &stresses, &plastic.active)?))
    }

    /// The rate equations with what the flow of the background adds, carried stresses among the
    /// unknowns; `None` where it adds nothing.
    ///
    /// # Errors
    /// There is no rate of response.
    pub fn damped_rates<const D: usize>(&self) -> Result<Option<RateEquations<D>>, StateError> {
        let Some(Plastic { set: YieldSet::Mises(set), stress: Some(stress), active, rate }) =
            &self.plastic
        else {
            return Ok(None);
        };
        let (layout, stiffness) = self.elastic.layout_and_stiffness::<D>();
        let stresses: Vec<_> = layout.all_stresses().collect();
        let Some(curvature) = set.curvature(stress, &stresses).filter(|_| *rate > 0.0) else {
            return Ok(None);
        };
        let plastic = tangent(&stiffness, &stresses, active)?;
        let relaxation = (curvature * *rate).map(Rounded::given);
        let rates = self.elastic.rates_with_stiffness(&layout.carrying(), &plastic);
        Ok(Some(RateEquations { relaxation, ..rates }))
    }

    /// The roots ς along a wave, 1/s, by descending real part; those that are always zero left out.
    ///
    /// # Errors
    /// There is no rate of response.
    pub fn roots(&self, wave: &Wave) -> Result<Vec<Complex64>, StateError> {
        let [x, y, z] = normal(wave);
        let damped = match self.dimensions {
            2 => self.damped_rates::<2>()?.map(|rates| roots(&rates, [x, y], wave.number)),
            _ => self.damped_rates::<3>()?.map(|rates| roots(&rates, [x, y, z], wave.number)),
        };
        let mut all: Vec<Complex64> = match damped {
            Some(roots) => roots,
            None => self
                .waves(wave, false)?
                .families
                .iter()
                .flat_map(|family| {
                    let squares = family.squared_frequencies(wave.number);
                    // What is below zero while energy is kept is rounding.
                    let is_kept = self.keeps_energy();
                    squares.into_iter().map(move |square| match is_kept {
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

    /// Greatest Re ς along a wave, 1/s; those that are always zero included.
    ///
    /// # Errors
    /// There is no rate of response.
    pub fn growth_rate(&self, wave: &Wave) -> Result<f64, StateError> {
        Ok(self.roots(wave)?.iter().map(|root| root.re).fold(0.0, f64::max))
    }

    /// The stresses of [`ElasticLaw::carried_rates`] in `D` dimensions.
    pub fn carried_stresses<const D: usize>(&self) -> Vec<Component> {
        self.elastic.layout_and_stiffness::<D>().0.all_stresses().collect()
    }

    /// The stresses in the rate equations in `D` dimensions.
    pub fn stresses<const D: usize>(&self) -> &'static [Component] {
        self.elastic.layout_and_stiffness::<D>().0.stresses
    }

    /// The waves along the case's wave, and those of the elastic solid if `stays_elastic`.
    ///
    /// # Errors
    /// There is no rate of response.
    pub fn waves(&self, wave: &Wave, stays_elastic: bool) -> Result<Waves, StateError> {
        if self.dimensions == 2 {
            let [x, y, _] = normal(wave);
            let rates = if stays_elastic { self.elastic_rates() } else { self.rates()? };
            Ok(Waves::along::<2>(&rates, [x, y]))
        } else {
            let rates = if stays_elastic { self.elastic_rates() } else { self.rates()? };
            Ok(Waves::along::<3>(&rates, normal(wave)))
        }
    }

    /// Whether plastic flow, if any, is along the normals.
    pub fn is_associated(&self) -> bool {
        self.active().iter().all(|active| active.normal == active.flow)
    }

    /// Whether the tangent stiffness is symmetric and not negative, the rate equations
    /// symmetric-hyperbolic: elastic, or associated without softening.
    pub fn keeps_energy(&self) -> bool {
        self.is_associated() && self.active().iter().all(|active| active.hardening >= 0.0)
    }

    fn active(&self) -> &[ActiveCondition] {
        self.plastic.as_ref().map_or(&[], |plastic| &plastic.active)
    }
}

/// The elasticity of a case and its yield set, whatever the stress.
///
/// # Errors
/// The constant that is out of range; that the case is one of a flow.
pub fn elastic_and_set(case: &Case) -> Result<(ElasticLaw, Option<YieldSet>), InputError> {
    let set = case.yields.map(|set| yield_set(case, set)).transpose()?;
    Ok((elastic_law(case)?, set))
}

/// Unit vector along a wave.
pub fn normal(wave: &Wave) -> [f64; 3] {
    let (sin, cos) = radians(wave.direction_deg).cr_sin_cos();
    let (up, along) = radians(wave.elevation_deg).cr_sin_cos();
    [along * cos, along * sin, up]
}

/// Direction in the plane, in [0, 180), and angle above it, of a normal; degrees. Opposite normals are
/// the same.
pub fn angles_deg([x, y, z]: [f64; 3]) -> [f64; 2] {
    // Where a direction was found by search its last digits are noise.
    const NOISE: f64 = 1e-7;
    let clean = |degrees: f64| if degrees.abs() < NOISE { 0.0 } else { degrees };
    let elevation = clean(z.cr_atan2(x.root_sum_square(y)).to_degrees());
    let direction = clean(y.cr_atan2(x).to_degrees());
    // Half a turn in the plane goes with the opposite elevation.
    match direction {
        d if d < 0.0 => [clean(d + 180.0), -elevation + 0.0],
        d if d >= 180.0 - NOISE => [0.0, -elevation + 0.0],
        d => [d, elevation],
    }
}

/// A normal for a reader: `at 30°, 12° above the plane`.
pub fn normal_words(normal: [f64; 3]) -> String {
    let [direction, elevation] = angles_deg(normal);
    match elevation {
        0.0 => format!("at {}°", short(direction)),
        up => format!("at {}°, {}° above the plane", short(direction), short(up)),
    }
}

/// A normal as JSON: its components and angles.
pub fn normal_json(normal: [f64; 3]) -> Value {
    let [direction, elevation] = angles_deg(normal);
    json!({ "vector": normal, "direction_deg": direction, "elevation_deg": elevation })
}

/// Flutter as JSON; null without.
pub fn flutter_json(flutter: Option<Flutter>) -> Value {
    flutter.map_or(Value::Null, |flutter| {
        json!({
            "growth": flutter.growth,
            "squared_speed": [flutter.speed_squared.re, flutter.speed_squared.im],
            "normal": normal_json(flutter.normal),
        })
    })
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
            key: "model.kind",
            found: format!("{}, a flow", case.kind.name()),
            allowed: format!(
                "this needs a solid ({}); for flows see wellposed point and map",
                Kind::SOLIDS.map(Kind::name).join(", ")
            ),
        }),
    }
}

impl Plastic {
    fn of(case: &Case, kind: Yield) -> Result<Self, InputError> {
        let set = yield_set(case, kind)?;
        if let (YieldSet::Interlayer(layers), Some(active)) = (&set, &case.active) {
            let all: Vec<ActiveCondition> = layers.half_spaces().map(|(c, _)| c).collect();
            let active = active.iter().map(|&index| all[index]).collect();
            return Ok(Self { set, stress: None, active, rate: 0.0 });
        }
        let stress = on_yield(&set, case)?;
        let active = set.active(&stress, ON_YIELD);
        if active.is_empty() {
            return Err(never_yields("a stress on the axis of the cone"));
        }
        let rate = case.numbers.yields.plastic_rate;
        if rate < 0.0 {
            return Err(InputError {
                key: "yield.plastic_rate",
                found: format!("{rate:?}"),
                allowed: "the plastic rate must be Λ ≥ 0, in 1/s".into(),
            });
        }
        Ok(Self { set, stress: Some(stress), active, rate })
    }
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

/// The stress of a case: its pressure, and the rest multiplied until it yields.
fn on_yield(set: &YieldSet, case: &Case) -> Result<Stress, InputError> {
    let given = case.numbers.stress;
    let (sin, cos) = (2.0 * radians(given.stress_angle_deg)).cr_sin_cos();
    let [q, r] = [given.deviatoric_stress, given.rotational_stress];
    let mut pressure = Stress::default();
    for i in 0..3 {
        pressure.force[i][i] = -given.pressure;
    }
    let mut rest = Stress::default();
    rest.force[0] = [q * cos, q * sin - r, 0.0];
    rest.force[1] = [q * sin + r, -q * cos, 0.0];
    rest.force[2][2] = given.out_of_plane_stress;
    rest.couple[2] = [given.couple_stress[0], given.couple_stress[1], 0.0];
    // How far each condition lets the rest be multiplied; as linear as the set is along its rays.
    let room = |used: f64, strength: f64, rate: f64| match strength - used {
        room if room > 0.0 => Ok(if rate > 0.0 { room / rate } else { f64::INFINITY }),
        _ if used <= 0.0 => Err(InputError {
            key: "yield",
            found: "no strength under this pressure".into(),
            allowed: "strength or friction that a stress can grow to; yield.active may name the \
                      conditions instead"
                .into(),
        }),
        _ => Err(InputError {
            key: "stress.pressure",
            found: format!("{:?}", given.pressure),
            allowed: "a pressure within the yield set: greater than −strength/friction".into(),
        }),
    };
    let scale = match set {
        YieldSet::Interlayer(layers) => {
            let mut scale = f64::INFINITY;
            for (condition, strength) in layers.half_spaces() {
                let used = contract(&condition.normal, &pressure);
                scale = scale.min(room(used, strength, contract(&condition.normal, &rest))?);
            }
            scale
        }
        YieldSet::Mises(cone) => room(
            cone.friction * mean(&pressure),
            cone.strength,
            cone.equivalent_shear(&rest) + cone.friction * mean(&rest),
        )?,
    };
    if !scale.is_finite() {
        return Err(never_yields("stresses that never yield, however large"));
    }
    let mut stress = pressure;
    let add = |sum: &mut [[f64; 3]; 3], part: &[[f64; 3]; 3]| {
        for (sum, part) in sum.iter_mut().flatten().zip(part.iter().flatten()) {
            *sum += scale * part;
        }
    };
    add(&mut stress.force, &rest.force);
    add(&mut stress.couple, &rest.couple);
    Ok(stress)
}

fn never_yields(found: &str) -> InputError {
    InputError {
        key: "stress",
        found: found.into(),
        allowed: "a deviatoric, rotational or couple stress that reaches the yield set; for \
                  interlayer, yield.active may name the conditions instead"
            .into(),
    }
}
