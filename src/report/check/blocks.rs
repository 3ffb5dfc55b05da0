//! Check report of a periodic medium of blocks and joints: table.

use super::solid::{column_headers, write_rows};
use super::{format_max_error, format_unmeasured_count};
use crate::report::format::format_count;
use crate::study::check::blocks::BlockyMediumCheck;
use std::fmt::Write as _;

impl BlockyMediumCheck {
    pub(super) fn write_table(&self, text: &mut String) {
        let _ = writeln!(text, "\n{}: {}", self.section_key, self.medium_title);
        if let Some(reason) = &self.unmeasured_reason {
            let _ = writeln!(text, "not measurable: {reason}");
            return;
        }
        let mut grids: Vec<String> = Vec::new();
        for row in self.branch_checks.iter().filter(|row| !row.grid_results.is_empty()) {
            let cells = row.grid_results.iter().filter_map(|grid| grid.cells_per_period);
            let cells: Vec<String> = cells.map(|cells| cells.to_string()).collect();
            let kind = row.branch_label.split(',').next().unwrap_or_default();
            let line = format!("{kind}: {} cells per block", cells.join(", "));
            if !grids.contains(&line) {
                grids.push(line);
            }
        }
        let _ = writeln!(
            text,
            "frequencies ω in rad/s; errors and growth rates γ relative to ω; {}\n",
            grids.join("; ")
        );
        text.push_str(&column_headers("error (coarse)"));
        write_rows(&self.branch_checks, text);
        let failed =
            self.branch_checks.iter().filter(|row| row.is_in_agreement == Some(false)).count();
        let verdict = match (failed, self.is_in_agreement) {
            (_, None) => String::new(),
            (0, _) => ": all agree".to_owned(),
            (some, _) => format!(": {some} DISAGREE"),
        };
        let _ = writeln!(
            text,
            "\n{}, {}{verdict}{}",
            format_count(self.branch_checks.len(), "wave"),
            format_max_error(self.max_relative_difference()),
            format_unmeasured_count(self.unmeasured_count()),
        );
    }
}
