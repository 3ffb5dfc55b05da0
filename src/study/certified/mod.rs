//! Verdicts proved for all states of a box of two parameters: over the cells of a map, or as a certificate.

mod assessor;
mod certificate;

pub use certificate::{BoxRange, BoxRangeError, CertifiedState, certify_state, is_certificate_of};

pub(in crate::study) use assessor::BoxAssessor;

use crate::case::{Case, ModelKind, SweepParameter};
use analysis::certified::BoxVerdict;
use certificates::Test;
use models::InputError;
use models::common::rounding::Rounded;
use models::common::taylor_model::TaylorModel;
use models::flow::state::Background;
use models::flow::{FlowKind, Model};
use models::registry::{DOUBLE_SHEARING, HARRIS_GREKOVA};
use models::solid::isotropic::{CLASSICAL, REDUCED_COSSERAT};
use models::yield_set::interlayer::INTERLAYER;
use models::yield_set::mises::{DRUCKER_PRAGER, VON_MISES};

/// What is known of a part of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellVerdict {
    /// All states are proved well-posed.
    WellPosed = 0,
    /// All states are proved ill-posed.
    IllPosed = 1,
    /// Neither is proved.
    NotDecided = 2,
    /// No corner of the part has a fully deforming flow or a yielding solid with a response.
    NoState = 3,
}

impl CellVerdict {
    /// All values, in the order of their codes.
    pub const ALL: [Self; 4] = [Self::WellPosed, Self::IllPosed, Self::NotDecided, Self::NoState];
}

impl From<BoxVerdict> for CellVerdict {
    fn from(own: BoxVerdict) -> Self {
        match own {
            BoxVerdict::WellPosed => Self::WellPosed,
            BoxVerdict::IllPosed => Self::IllPosed,
            BoxVerdict::NotDecided => Self::NotDecided,
        }
    }
}

/// A proof that is known for a material.
#[derive(Clone, Copy)]
pub(in crate::study) enum Proof {
    Flow(FlowKind),
    Layers { is_positive: bool, has_spin: bool },
    Cone,
}

impl Proof {
    pub(in crate::study) fn find(case: &Case) -> Result<Self, InputError> {
        let material = &case.material;
        let refuse = |input, rejected_value: String, allowed_values: &str| InputError {
            input,
            rejected_value,
            allowed_values: allowed_values.into(),
        };
        match material.kind {
            ModelKind::Flow(kind) => {
                Self::check_flow(case, kind)?;
                Ok(Self::Flow(kind))
            }
            ModelKind::Solid(solid) => {
                let (set, dimensions) = (material.yield_set, material.numbers.dimensions);
                let active = material.active_conditions.as_deref();
                let is_set = |model: &models::yield_set::YieldSetModel| {
                    set.is_some_and(|own| own.name == model.name)
                };
                let is_solid = |model: &models::solid::SolidModel| solid.name == model.name;
                let is_classical = is_solid(&CLASSICAL);
                match active {
                    Some(&[index @ 0..4])
                        if is_set(&INTERLAYER) && (is_classical || is_solid(&REDUCED_COSSERAT)) =>
                    {
                        Ok(Self::Layers { is_positive: index % 2 == 0, has_spin: !is_classical })
                    }
                    None if (is_set(&DRUCKER_PRAGER) || is_set(&VON_MISES))
                        && material.numbers.stress.rotational_stress == 0.0
                        && material.numbers.stress.couple_stress == [0.0; 2]
                        && is_classical
                        && dimensions == 3 =>
                    {
                        Ok(Self::Cone)
                    }
                    _ => Err(refuse(
                        "kind",
                        format!(
                            "{} in {dimensions} dimensions, with the rest of the case",
                            solid.name
                        ),
                        "nothing is proved over boxes of this solid; proofs are known for classical and reduced-cosserat with \
                         the yield set interlayer and yield.active = one of +sigma21, -sigma21, +sigma12, -sigma12; and for \
                         classical in 3 dimensions with the yield set drucker-prager or von-mises, without yield.active, \
                         stress.rotational_stress and stress.couple_stress",
                    )),
                }
            }
            kind => Err(refuse(
                "kind",
                kind.name().to_owned(),
                "nothing is proved over boxes of this model: a proof takes a flow or a solid",
            )),
        }
    }

    /// Checks that conditions are known for the background of a flow, and that its file has no numbers that a background
    /// determines: states that satisfy them at the corners of a box need not exist inside.
    fn check_flow(case: &Case, kind: FlowKind) -> Result<(), InputError> {
        let given = &case.material.numbers.background;
        let redundant = [
            ("spin", given.spin.is_some()),
            ("deviatoric_stress", given.deviatoric_stress.is_some()),
            ("rotational_stress", given.rotational_stress.is_some()),
            ("velocity_gradient", given.velocity_gradient.is_some()),
            ("acceleration", given.acceleration.is_some()),
            ("body_moment", given.body_moment.is_some()),
            ("stress_angle_rate", given.stress_angle_rate_deg.is_some()),
        ];
        if let Some((input, _)) = redundant.into_iter().find(|own| own.1) {
            return Err(InputError {
                input,
                rejected_value: "this key".into(),
                allowed_values: "a proof takes backgrounds without numbers that follow from others; leave it out"
                    .into(),
            });
        }
        let constants = case.model_constants();
        let Ok(model) = Model::new(kind, &constants) else { return Ok(()) };
        let Ok(Background::FullyDeforming(flow)) = model.background(&case.to_flow_state()) else {
            // The map may vary the numbers that are out of range.
            return Ok(());
        };
        let enclosures: Vec<TaylorModel> =
            constants.iter().map(|&own| Rounded::from_angle(own).into()).collect();
        match model.box_conditions(&flow, &enclosures, TaylorModel::ZERO) {
            Some(_) => Ok(()),
            None => Err(InputError {
                input: "kind",
                rejected_value: format!("{} about this background", kind.name()),
                allowed_values: "nothing is proved over boxes of it; harris-grekova with dilatancy takes a uniform \
                                 background and rotational_strength = 0, double-shearing and plastic-potential any"
                    .into(),
            }),
        }
    }

    /// The test of a certificate.
    pub(in crate::study) fn test(self) -> Test {
        match self {
            Self::Flow(kind) if kind == HARRIS_GREKOVA => Test::HarrisGrekova,
            Self::Flow(kind) if kind == DOUBLE_SHEARING => Test::DoubleShearing,
            Self::Flow(_) => Test::PlasticPotential,
            Self::Layers { is_positive: true, .. } => Test::SlippingLayersPositive,
            Self::Layers { is_positive: false, .. } => Test::SlippingLayersNegative,
            Self::Cone => Test::YieldCone,
        }
    }

    /// Names of the verdicts, in the order of [`CellVerdict::ALL`].
    pub(in crate::study) fn verdict_names(
        self,
        case: &Case,
        axes: &[SweepParameter],
    ) -> [&'static str; 4] {
        let well_posed = match self.is_leading_symbol(case, axes) {
            true => "leading symbol proved well-posed",
            false => "proved well-posed",
        };
        [well_posed, "proved ill-posed", "not decided", "no state"]
    }

    /// Whether well-posedness is proved of the leading symbol only.
    fn is_leading_symbol(self, case: &Case, axes: &[SweepParameter]) -> bool {
        match self {
            Self::Flow(_) => {
                let mut names = axes.iter().map(|own| own.name());
                let key = "model.dilatancy_angle_deg";
                let value = SweepParameter::find_by_name(key)
                    .and_then(|own| own.value(&case.material.numbers));
                names.any(|own| own == key) || value.is_some_and(|own| own > 0.0)
            }
            Self::Layers { has_spin, .. } => has_spin,
            Self::Cone => false,
        }
    }

    /// Sections of numbers over which the proof holds, and single numbers.
    fn allowed(self) -> (&'static [&'static str], &'static [&'static str]) {
        match self {
            Self::Flow(_) => (
                &["model.", "wave."],
                &[
                    "background.noncoaxiality_deg",
                    "background.density",
                    "background.pressure",
                    "background.shear_rate",
                    "background.stress_angle_deg",
                ],
            ),
            Self::Layers { .. } => (&["model.", "yield.", "wave."], &[]),
            Self::Cone => (
                &["model.", "yield.", "wave."],
                &["stress.deviatoric_stress", "stress.out_of_plane_stress"],
            ),
        }
    }

    pub(in crate::study) fn allows(self, name: &str) -> bool {
        let (sections, numbers) = self.allowed();
        numbers.contains(&name) || sections.iter().any(|own| name.starts_with(own))
    }

    pub(in crate::study) fn allowed_names(self) -> String {
        let (sections, numbers) = self.allowed();
        let sections =
            sections.iter().map(|own| format!("numbers of [{}]", own.trim_end_matches('.')));
        let numbers = numbers.iter().map(|own| (*own).to_owned());
        sections.chain(numbers).collect::<Vec<_>>().join(", ")
    }

    /// Method of the proof.
    pub(in crate::study) fn method(self) -> String {
        let of = match self {
            Self::Flow(_) => "signs of conditions in closed form",
            Self::Layers { .. } => {
                "signs of sum, product and discriminant of both squared speeds for all wave normals, by Bernstein coefficients"
            }
            Self::Cone => {
                "strict copositivity of the quadratic form of the determinant of the acoustic tensor"
            }
        };
        format!("{of}, enclosed by Taylor models in both parameters")
    }

    /// What a well-posed verdict leaves out; empty if nothing.
    pub(in crate::study) fn scope(self, case: &Case, axes: &[SweepParameter]) -> &'static str {
        match self.is_leading_symbol(case, axes) {
            true => "; terms of lower order are not enclosed",
            false => "",
        }
    }
}
