//! Verdicts that are proved for all states of a box of two parameters at once.
//!
//! A verdict at a point says nothing about its neighbours. Here every quantity is enclosed over a box by
//! [`TaylorModel`]s, rounding errors included, so that a certain sign holds for
//! all states of the box and all directions. What has no certain sign stays undecided. For slipping layers with spin and for
//! dilatant flows it is the leading symbol that is enclosed.

mod direction_form;
mod drucker_prager;
mod slipping_layers;

pub use direction_form::DirectionForm;
pub use drucker_prager::YieldCone;
pub use slipping_layers::SlippingLayers;

use certificates::{Claim, Directions};
use models::common::taylor_model::TaylorModel;

/// What is proved of all states of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxVerdict {
    /// All states are well-posed.
    WellPosed,
    /// All states are ill-posed.
    IllPosed,
    /// Neither is proved.
    NotDecided,
}

/// A verdict on all states of a box, with the enclosures on which it rests.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxProof {
    /// What is proved.
    pub verdict: BoxVerdict,
    /// Enclosures of the deciding quantities; none if nothing is proved.
    pub claims: Vec<Claim>,
}

impl BoxProof {
    /// Nothing is proved.
    pub const NONE: Self = Self { verdict: BoxVerdict::NotDecided, claims: Vec::new() };

    /// Proof by conditions of a model, with their names: all positive, or one negative, in the whole box.
    pub fn from_conditions(conditions: &[(&'static str, TaylorModel)]) -> Self {
        let sign = |own: &TaylorModel| own.certain_sign();
        let claim = |&(name, own): &(&'static str, TaylorModel)| claim(name, None, own.range());
        if let Some(own) = conditions.iter().find(|own| sign(&own.1) == Some(-1)) {
            Self { verdict: BoxVerdict::IllPosed, claims: vec![claim(own)] }
        } else if conditions.iter().all(|own| sign(&own.1) == Some(1)) {
            let claims = conditions.iter().map(claim).collect();
            Self { verdict: BoxVerdict::WellPosed, claims }
        } else {
            Self::NONE
        }
    }
}

fn claim(name: &'static str, directions: Option<Directions>, range: [f64; 2]) -> Claim {
    Claim { quantity: name.into(), directions, range }
}
