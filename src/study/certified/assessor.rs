//! Proof of a verdict for all states of a box of numbers of a case.

use super::{CellVerdict, Proof};
use crate::case::{Case, ModelKind, SweepParameter};
use crate::setup;
use analysis::certified::{BoxProof, SlippingLayers, YieldCone};
use certificates::Claim;
use models::common::parameter::ANGLE_UNIT;
use models::common::rounding::Rounded;
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;
use models::elastoplastic::Solid;
use models::flow::state::{Background, DeformingFlow};
use models::flow::{FlowKind, Model};
use std::f64::consts::PI;

/// The parameter of an axis that runs between these ends.
fn enclose_axis(axis: usize, [first, last]: [f64; 2]) -> TaylorModel {
    TaylorModel::parameter(axis, first, last)
}

fn radians(degrees: TaylorModel) -> TaylorModel {
    degrees * TaylorModel::from_rounded(PI / 180.0)
}

/// Assessor of boxes, one per thread.
pub(in crate::study) struct BoxAssessor {
    case: Case,
    /// Numbers that run over a box, by axis.
    axes: [Option<SweepParameter>; 2],
    proof: Proof,
    /// Numbers of the case on which the verdict depends.
    named: Vec<(&'static str, SweepParameter)>,
}

/// What is known of a box, and the enclosures by which it is proved.
pub(in crate::study) struct AssessedBox {
    pub(in crate::study) verdict: CellVerdict,
    pub(in crate::study) claims: Vec<Claim>,
}

impl AssessedBox {
    fn without_proof(verdict: CellVerdict) -> Self {
        Self { verdict, claims: Vec::new() }
    }
}

impl From<BoxProof> for AssessedBox {
    fn from(own: BoxProof) -> Self {
        Self { verdict: own.verdict.into(), claims: own.claims }
    }
}

/// What the corners of a box hold.
enum Corners {
    /// A state at each corner; of flows the last one.
    All(Option<Box<DeformingFlow>>),
    Some,
    None,
}

impl BoxAssessor {
    pub(in crate::study) fn new(
        case: &Case,
        axes: [Option<SweepParameter>; 2],
        proof: Proof,
    ) -> Self {
        let find = |&name: &&'static str| Some((name, SweepParameter::find_by_name(name)?));
        let named = proof.test().keys().iter().filter_map(find).collect();
        Self { case: case.clone(), axes, proof, named }
    }

    /// Assesses the box between the ends of both axes; those of an axis without a number do not matter.
    pub(in crate::study) fn assess(&mut self, ends: &[[f64; 2]; 2]) -> AssessedBox {
        match self.check_corners(ends) {
            Corners::None => AssessedBox::without_proof(CellVerdict::NoState),
            Corners::Some => AssessedBox::without_proof(CellVerdict::NotDecided),
            Corners::All(flow) => match self.proof {
                Proof::Flow(kind) => self.prove_flow(kind, flow, ends).into(),
                Proof::Layers { is_positive, .. } => self.prove_layers(is_positive, ends).into(),
                Proof::Cone => self.prove_cone(ends).into(),
            },
        }
    }

    /// Checks whether the corners of a box have states. Without redundant numbers these form a convex set, or, under tension,
    /// one whose condition p sin φ + c cos φ > 0 is monotone in each number; so all states between corners exist, too.
    fn check_corners(&mut self, ends: &[[f64; 2]; 2]) -> Corners {
        let (mut count, mut last) = (0, None);
        for corner in 0..4 {
            let values = [ends[0][corner % 2], ends[1][corner / 2]];
            for (parameter, value) in self.axes.into_iter().zip(values) {
                if let Some(parameter) = parameter {
                    self.case.set_number(parameter, value);
                }
            }
            let is_state = match self.proof {
                Proof::Flow(kind) => {
                    let background = Model::new(kind, &self.case.model_constants())
                        .and_then(|model| model.background(&self.case.to_flow_state()));
                    match background {
                        Ok(Background::FullyDeforming(flow)) => {
                            last = Some(Box::new(flow));
                            true
                        }
                        _ => false,
                    }
                }
                Proof::Layers { .. } => self.has_response(|solid| solid.rates::<2>().is_ok()),
                Proof::Cone => self.has_response(|solid| solid.rates::<3>().is_ok()),
            };
            count += usize::from(is_state);
        }
        match count {
            4 => Corners::All(last),
            0 => Corners::None,
            _ => Corners::Some,
        }
    }

    /// Whether the present state of the solid yields and has a response.
    fn has_response(&self, has_rates: impl Fn(&Solid) -> bool) -> bool {
        setup::solid::create_solid(&self.case.material)
            .is_ok_and(|solid| solid.plastic_state.is_some() && has_rates(&solid))
    }

    /// Enclosure of a number of the case in the unit of its file; `None` if it is absent.
    fn enclose(&self, name: &str, ends: &[[f64; 2]; 2]) -> Option<TaylorModel> {
        let parameter = self.named.iter().find(|own| own.0 == name)?.1;
        if let Some(axis) = self.axes.iter().position(|own| *own == Some(parameter)) {
            return Some(enclose_axis(axis, ends[axis]));
        }
        let value = parameter.value(&self.case.material.numbers).filter(|own| !own.is_nan())?;
        Some(if value == 0.0 { TaylorModel::ZERO } else { TaylorModel::from_rounded(value) })
    }

    fn prove_flow(
        &self,
        kind: FlowKind,
        flow: Option<Box<DeformingFlow>>,
        ends: &[[f64; 2]; 2],
    ) -> BoxProof {
        let noncoaxiality =
            self.enclose("background.noncoaxiality_deg", ends).map_or(TaylorModel::ZERO, radians);
        let model = Model::new(kind, &self.case.model_constants()).ok();
        let enclosures = self.enclose_constants(kind, ends);
        let conditions = model
            .zip(flow)
            .and_then(|(model, flow)| model.box_conditions(&flow, &enclosures, noncoaxiality));
        conditions.map_or(BoxProof::NONE, |own| BoxProof::from_conditions(&own))
    }

    /// Lower and upper bound on the bound on the non-coaxiality of a flow, degrees, over the box between these ends; `None` of
    /// a material without it, or if one corner has no state.
    pub(in crate::study) fn bound_noncoaxiality(
        &mut self,
        ends: &[[f64; 2]; 2],
    ) -> Option<[f64; 2]> {
        let (Proof::Flow(kind), Corners::All(_)) = (self.proof, self.check_corners(ends)) else {
            return None;
        };
        let model = Model::new(kind, &self.case.model_constants()).ok()?;
        let found = model.box_noncoaxiality_bound(&self.enclose_constants(kind, ends))?;
        Some((found * TaylorModel::from_rounded(180.0 / PI)).range())
    }

    /// Enclosures of the constants of a flow model, in SI units and rad.
    fn enclose_constants(&self, kind: FlowKind, ends: &[[f64; 2]; 2]) -> Vec<TaylorModel> {
        let constants = self.case.model_constants();
        let mut enclosures: Vec<TaylorModel> =
            constants.iter().map(|&own| Rounded::from_angle(own).into()).collect();
        for (axis, parameter) in self.axes.into_iter().enumerate() {
            let constant = parameter.and_then(|own| own.model_constant(ModelKind::Flow(kind)));
            let Some((index, constant)) = constant else { continue };
            let own = enclose_axis(axis, ends[axis]);
            enclosures[index] = if constant.unit == ANGLE_UNIT { radians(own) } else { own };
        }
        enclosures
    }

    fn prove_layers(&self, is_positive: bool, ends: &[[f64; 2]; 2]) -> BoxProof {
        let number = |name: &str| self.enclose(name, ends);
        let alpha = number("model.alpha").unwrap_or(TaylorModel::ZERO);
        let layers = || {
            Some(SlippingLayers {
                lambda: number("model.lambda")?,
                mu: number("model.mu")?,
                alpha,
                friction: number("yield.shear_friction")?,
                dilatancy: number("yield.shear_dilatancy")?,
                is_positive,
            })
        };
        layers().map_or(BoxProof::NONE, |own| own.prove())
    }

    fn prove_cone(&self, ends: &[[f64; 2]; 2]) -> BoxProof {
        let number = |name: &str| self.enclose(name, ends);
        let or_zero = |name: &str| number(name).unwrap_or(TaylorModel::ZERO);
        let cone = || {
            let deviatoric = number("stress.deviatoric_stress")?;
            Some(YieldCone {
                lambda: number("model.lambda")?,
                mu: number("model.mu")?,
                friction: or_zero("yield.friction"),
                dilatancy: or_zero("yield.dilatancy"),
                hardening: or_zero("yield.hardening"),
                principal_stresses: [
                    deviatoric,
                    -deviatoric,
                    or_zero("stress.out_of_plane_stress"),
                ],
            })
        };
        cone().map_or(BoxProof::NONE, |own| own.prove())
    }
}
