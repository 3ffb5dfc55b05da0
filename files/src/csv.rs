//! CSV tables (comma-separated values).

/// One cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Number in the shortest form that reads back to the same bits; not-a-number becomes an empty cell, infinities
    /// become `inf` and `-inf`.
    Number(f64),
    /// Text, quoted where commas, quotes or line breaks require it.
    Text(String),
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

/// Error of a row whose length differs from that of the header.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("row {row} of the table has {found} cells where the header names {expected} columns")]
pub struct RowLength {
    /// Number of the row, counted from 1 for the first row after the header.
    pub row: usize,
    /// Cells found in the row.
    pub found: usize,
    /// Columns named in the header.
    pub expected: usize,
}

/// Formats a CSV table: column names, then one line per row, each ended by a line feed.
pub fn table(
    header: &[&str],
    rows: impl IntoIterator<Item = Vec<Cell>>,
) -> Result<Vec<u8>, RowLength> {
    const IN_MEMORY: &str = "rows of checked length are written into memory";
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).expect(IN_MEMORY);
    for (index, row) in rows.into_iter().enumerate() {
        if row.len() != header.len() {
            return Err(RowLength { row: index + 1, found: row.len(), expected: header.len() });
        }
        let texts = row.into_iter().map(|cell| match cell {
            Cell::Number(number) => shortest(number),
            Cell::Text(text) => text,
        });
        writer.write_record(texts).expect(IN_MEMORY);
    }
    Ok(writer.into_inner().expect(IN_MEMORY))
}

/// Shortest decimal form that reads back to the same bits, with exponent for very large and very small numbers.
pub(crate) fn shortest(number: f64) -> String {
    let size = number.abs();
    if number.is_nan() {
        String::new()
    } else if size.is_finite() && size != 0.0 && !(1e-5..1e16).contains(&size) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(header: &[&str], rows: Vec<Vec<Cell>>) -> String {
        String::from_utf8(table(header, rows).unwrap()).unwrap()
    }

    #[test]
    fn numbers_text_and_gaps() {
        let rows = vec![
            vec![Cell::from(0.1), Cell::from("plain")],
            vec![Cell::from(f64::NAN), Cell::from("comma, \"quote\"\nbreak")],
            vec![Cell::from(f64::NEG_INFINITY), Cell::from("φ")],
        ];
        let expected = "Δ (°),words\n0.1,plain\n,\"comma, \"\"quote\"\"\nbreak\"\n-inf,φ\n";
        assert_eq!(written(&["Δ (°)", "words"], rows), expected);
    }

    #[test]
    fn a_line_that_holds_nothing_is_still_a_line() {
        // Readers skip an empty line, which would shift all later rows up.
        let rows = vec![vec![Cell::from(f64::NAN)], vec![Cell::from(2.0)]];
        assert_eq!(written(&["a"], rows), "a\n\"\"\n2\n");
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let third = 1.0 / 3.0;
        for number in [
            0.0,
            -0.0,
            1.0,
            -12.5,
            third,
            1e15,
            1e16,
            1e-5,
            9.9e-6,
            1e300,
            5e-324,
            f64::MAX,
            f64::INFINITY,
        ] {
            let text = shortest(number);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
            assert!(text.len() <= 25, "{text}");
        }
    }

    #[test]
    fn a_row_of_the_wrong_length_is_refused() {
        let rows = vec![vec![Cell::from(1.0); 2], vec![Cell::from(1.0); 3]];
        let refused = table(&["a", "b"], rows).unwrap_err();
        assert_eq!(refused, RowLength { row: 2, found: 3, expected: 2 });
    }
}
