//! Report on the analysis of one state.

mod certified;
mod equations;
mod flow;
mod flow_figures;
mod solid;

pub use certified::{CERTIFICATE_FILE, CertifiedPoint};

use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::PointResult;

impl Report for PointResult {
    const NAME: &'static str = "point";
    const ENDS_WITH_PICTURE_PATH: bool = false;

    fn to_text(&self, case: &Case) -> String {
        match self {
            Self::Flow(found) => flow::format_text(case, found),
            Self::Solid(found) => solid::format_text(case, found),
            Self::Equations(found) => equations::format_text(case, found),
        }
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        Ok(match self {
            Self::Flow(found) => flow_figures::create_pictures(case, found),
            Self::Solid(found) => solid::create_pictures(case, found),
            Self::Equations(_) => Vec::new(),
        })
    }

    fn absent_file_names(&self) -> Vec<String> {
        vec![CERTIFICATE_FILE.to_owned()]
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        match self {
            Self::Flow(found) => flow::create_tables(found),
            Self::Solid(_) => Ok(Vec::new()),
            Self::Equations(found) => equations::create_tables(found),
        }
    }
}
