//! Report on the analysis of one state.

mod flow;
mod flow_figures;
mod solid;

use super::{Picture, Report};
use crate::Error;
use crate::case::Case;
use crate::study::PointResult;

impl Report for PointResult {
    const NAME: &'static str = "point";
    const ENDS_WITH_PICTURE: bool = false;

    fn text(&self, case: &Case) -> String {
        match self {
            Self::Flow(found) => flow::text(case, found),
            Self::Solid(found) => solid::text(case, found),
        }
    }

    fn pictures(&self, case: &Case) -> Result<Vec<Picture>, Error> {
        Ok(match self {
            Self::Flow(found) => flow_figures::pictures(case, found),
            Self::Solid(found) => solid::pictures(case, found),
        })
    }

    fn tables(&self, _case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        match self {
            Self::Flow(found) => flow::tables(found),
            Self::Solid(_) => Ok(Vec::new()),
        }
    }
}
