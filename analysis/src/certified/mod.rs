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

impl BoxVerdict {
    /// Verdict from the conditions of a model: all positive, or one negative, in the whole box.
    pub fn from_conditions(conditions: &[TaylorModel]) -> Self {
        let signs = || conditions.iter().map(|own| own.certain_sign());
        if signs().any(|sign| sign == Some(-1)) {
            Self::IllPosed
        } else if signs().all(|sign| sign == Some(1)) {
            Self::WellPosed
        } else {
            Self::NotDecided
        }
    }
}
