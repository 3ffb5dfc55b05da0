//! Tables of a report page, from CSV.

use super::html::escape;
use crate::report::format::format_count;
use files::csv::{FirstRows, read_first_rows};
use std::fmt::Write as _;
use std::io::Read;

/// First rows of a CSV table.
pub struct PageTable {
    file_name: String,
    /// Unit of each column: `1` if dimensionless, empty if it holds no quantity.
    units: Vec<String>,
    first: FirstRows,
}

impl PageTable {
    /// Number of rows that are shown of a table.
    pub const SHOWN_ROWS: usize = 20;

    /// Creates the table from its first rows. `unit` returns the unit of a column by its name.
    pub fn new(file_name: &str, first: FirstRows, unit: impl Fn(&str) -> String) -> Self {
        let units = first.header.iter().map(|name| unit(name)).collect();
        Self { file_name: file_name.to_owned(), units, first }
    }

    /// Reads the first rows of a CSV table. `unit` returns the unit of a column by its name.
    ///
    /// # Errors
    /// The table cannot be read.
    pub fn read(
        file_name: &str,
        csv: impl Read,
        unit: impl Fn(&str) -> String,
    ) -> std::io::Result<Self> {
        Ok(Self::new(file_name, read_first_rows(csv, Self::SHOWN_ROWS)?, unit))
    }

    pub(super) fn write_html(&self, html: &mut String) {
        let Self { file_name, units, first } = self;
        let (name, rows) = (escape(file_name), first.row_count);
        let columns = format_count(first.header.len(), "column");
        let _ = write!(
            html,
            "<details><summary>{name}: {}, {columns}</summary>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" \
             aria-label=\"{name}\"><table>\n<thead><tr>",
            format_count(rows, "row"),
        );
        for (column, unit) in first.header.iter().zip(units) {
            let unit =
                if unit.is_empty() || unit == "1" { String::new() } else { format!(" ({unit})") };
            let _ = write!(html, "<th scope=\"col\">{}</th>", escape(&format!("{column}{unit}")));
        }
        html.push_str("</tr></thead>\n<tbody>\n");
        for row in &first.rows {
            html.push_str("<tr>");
            for cell in row {
                let _ = write!(html, "<td>{}</td>", escape(cell));
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody></table></div>\n");
        if rows > first.rows.len() {
            let shown = first.rows.len();
            let _ = writeln!(
                html,
                "<p>These are the first {shown} of {rows} rows; {name} holds all.</p>"
            );
        }
        html.push_str("</details>\n");
    }
}
