//! Arguments of `map` that select what is computed.

use clap::Args;
use wellposed::study::MapOptions;

/// Quantities to be computed besides the verdicts at the points.
#[derive(Args)]
pub(crate) struct MapArguments {
    /// Also compute the largest growth rate over all wave vectors at every point
    #[arg(long = "bound")]
    computes_bound: bool,
    /// Also compute the largest growth rate at the wave number of the case at every point
    #[arg(long = "growth-rate")]
    computes_growth_rate: bool,
    /// Assess every point from the linearised equations, without closed forms of a model
    #[arg(long = "model-blind")]
    is_model_blind: bool,
    /// Prove the verdict for all states of the cells between points, with refinement where that fails
    #[arg(long = "certified")]
    is_certified: bool,
}

impl From<MapArguments> for MapOptions {
    fn from(own: MapArguments) -> Self {
        let MapArguments { computes_bound, computes_growth_rate, is_model_blind, is_certified } =
            own;
        Self { computes_bound, computes_growth_rate, is_model_blind, is_certified }
    }
}
