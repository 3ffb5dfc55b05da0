//! Report on the analysis of one state with what is proved of it.

use crate::Error;
use crate::case::Case;
use crate::report::format::{format_count, format_short};
use crate::report::{DataFile, Report, ReportPicture};
use crate::study::{CertifiedState, PointResult};
use certificates::format_number;
use serde::Serialize;

/// Name of the file of the proof.
pub const CERTIFICATE_FILE: &str = "certificate.json";

/// Analysis of a state, and what is proved of it or of the box about it.
#[derive(Serialize)]
pub struct CertifiedPoint {
    /// Analysis of the state.
    #[serde(flatten)]
    pub point: PointResult,
    /// What is proved.
    pub certified: CertifiedState,
}

impl Report for CertifiedPoint {
    const NAME: &'static str = PointResult::NAME;
    const ENDS_WITH_PICTURE_PATH: bool = PointResult::ENDS_WITH_PICTURE_PATH;

    fn to_arguments(&self, case: &Case) -> String {
        let ranges = self.certified.axes.iter();
        ranges.fold(self.point.to_arguments(case) + " --certified", |text, own| {
            format!("{text} --over {}={}..{}", own.key, own.from, own.to)
        })
    }

    fn to_text(&self, case: &Case) -> String {
        self.point.to_text(case) + &format_proof(&self.certified)
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        self.point.create_pictures(case)
    }

    fn absent_file_names(&self) -> Vec<String> {
        match self.certified.certificate {
            Some(_) => Vec::new(),
            None => self.point.absent_file_names(),
        }
    }

    fn create_tables(&self, case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let mut all = self.point.create_tables(case)?;
        if let Some(own) = &self.certified.certificate {
            let text = format!("{}\n", serde_json::to_string_pretty(own)?);
            all.push((CERTIFICATE_FILE, DataFile::Encoded(text.into_bytes())));
        }
        Ok(all)
    }
}

fn format_proof(own: &CertifiedState) -> String {
    let ranges = own.axes.iter();
    let ranges = ranges.map(|axis| {
        format!("{} from {} to {}", axis.key, format_number(axis.from), format_number(axis.to))
    });
    let ranges = ranges.collect::<Vec<_>>().join(" and ");
    let states = match own.axes.len() {
        0 => "this state".to_owned(),
        _ => format!("all states with {ranges}"),
    };
    let mut lines = vec![format!("{} for {states}: {}", own.verdict, own.method)];
    match &own.certificate {
        Some(proof) => {
            lines.push(format!(
                "  {CERTIFICATE_FILE}: {}, least margin {}",
                format_count(proof.parts.len(), "part"),
                format_short(proof.least_margin)
            ));
        }
        None if own.axes.is_empty() => {
            lines.push("  a deciding quantity has no certain sign here".to_owned());
        }
        None => {
            let shares = own.shares.iter().filter(|(_, share)| *share > 0.0);
            let shares =
                shares.map(|(name, share)| format!("{name} {} %", format_short(100.0 * share)));
            lines.push(format!("  of the box: {}", shares.collect::<Vec<_>>().join(", ")));
        }
    }
    if let Some([low, high]) = own.noncoaxiality_bound_deg {
        let (low, high) = ((low * 1e4).floor() / 1e4, (high * 1e4).ceil() / 1e4);
        lines.push(format!("  bound on the non-coaxiality: from {low} to {high}°"));
    }
    let mut text = lines.join("\n") + "\n";
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}
