//! Report on the equivalent continuum of a blocky medium.

use super::format::{case_title, format_short};
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::homogenise::HomogeniseResult;
use std::fmt::Write as _;

impl Report for HomogeniseResult {
    const NAME: &'static str = "homogenise";
    const ENDS_WITH_PICTURE_PATH: bool = false;

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!(
            "{}\nmodel: {}, equivalent to blocks of {} m\n\n",
            case_title(case),
            self.model,
            format_short(self.block_size),
        );
        for row in &self.constants {
            let _ = writeln!(
                text,
                "  {:<8} {:>14}  {:<6} {}",
                row.symbol,
                format!("{:.6e}", row.value),
                row.unit,
                row.validity_description,
            );
        }
        if let Some(own) = &self.yield_set {
            let _ = writeln!(
                text,
                "\nYield set interlayer\n  τ₀ = {} Pa, κ_τ = {}, μ₀ = {} N/m, κ_μ = {} m\n  {}",
                format_short(own.shear_strength),
                format_short(own.shear_friction),
                format_short(own.couple_strength),
                format_short(own.couple_friction),
                own.couple_friction_meaning,
            );
        }
        let speeds = &self.wave_speeds;
        let _ = writeln!(
            text,
            "\nWave speeds in m/s\n  along an axis: P {:.1}, long S {:.1} (sure), short S {:.1} (leading order)",
            speeds.longitudinal_speed, speeds.long_shear_speed, speeds.short_shear_speed,
        );
        let [shear, longitudinal] = speeds.diagonal_speeds;
        let _ = writeln!(text, "  along a diagonal: P {longitudinal:.1}, long S {shear:.1} (sure)");
        let _ = writeln!(
            text,
            "\nNatural frequency of the rotation of blocks: f* = {} Hz (leading order)",
            format_short(self.natural_frequency_hz),
        );
        let _ = writeln!(
            text,
            "Stiffness of joints and blocks: K_t h/μ = {}",
            format_short(self.stiffness_ratio),
        );
        if !self.has_rigid_blocks {
            text.push_str(
                "  warning: not small; constants of leading order are estimates, and short waves and rotations compare\n  \
                 qualitatively only\n",
            );
        }
        for note in &self.differences_from_blocks {
            let _ = writeln!(text, "note: {note}");
        }
        text
    }

    fn create_pictures(&self, _case: &Case) -> Result<Vec<ReportPicture>, Error> {
        Ok(Vec::new())
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        Ok(Vec::new())
    }
}
