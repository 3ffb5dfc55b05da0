//! CSV tables (comma-separated values).

use std::io::{self, Write};

/// One cell of a CSV table.
#[derive(Debug, Clone, PartialEq)]
pub enum CsvCell {
    /// Number in the shortest form that reads back to the same bits; not-a-number becomes an empty cell, infinities
    /// become `inf` and `-inf`.
    Number(f64),
    /// Text, quoted where commas, quotes or line breaks require it.
    Text(String),
}

impl CsvCell {
    fn into_text(self) -> String {
        match self {
            Self::Number(number) => format_shortest(number),
            Self::Text(text) => text,
        }
    }
}

impl From<f64> for CsvCell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for CsvCell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

/// Error: a row has another number of cells than the header.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("row {row} of the table has {found} cells where the header names {expected} columns")]
pub struct RowLengthError {
    /// Number of the row, counted from 1 for the first row after the header.
    pub row: usize,
    /// Number of cells in the row.
    pub found: usize,
    /// Number of columns named in the header.
    pub expected: usize,
}

/// Error of writing a CSV table.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// A row has another number of cells than the header.
    #[error(transparent)]
    RowLength(#[from] RowLengthError),
    /// The rows cannot be written.
    #[error("table: {0}")]
    Stream(#[from] io::Error),
}

/// Length of the buffer from which rows are written, bytes.
const BUFFER_LENGTH: usize = 1 << 16;

/// Writes a CSV table row by row: column names, then one line per row, each ended by a line feed. Returns the header, the
/// first `max_rows` rows and the number of all.
///
/// # Errors
/// A row has another number of cells than the header, or the writer fails.
pub fn write_table(
    writer: impl Write,
    header: &[&str],
    rows: impl IntoIterator<Item = Vec<CsvCell>>,
    max_rows: usize,
) -> Result<FirstRows, TableError> {
    let mut writer = csv::WriterBuilder::new().buffer_capacity(BUFFER_LENGTH).from_writer(writer);
    writer.write_record(header).map_err(io::Error::from)?;
    let header = header.iter().map(|name| (*name).to_owned()).collect();
    let mut first = FirstRows { header, rows: Vec::new(), row_count: 0 };
    for row in rows {
        first.row_count += 1;
        if row.len() != first.header.len() {
            let (row, found, expected) = (first.row_count, row.len(), first.header.len());
            return Err(RowLengthError { row, found, expected }.into());
        }
        let texts: Vec<String> = row.into_iter().map(CsvCell::into_text).collect();
        writer.write_record(&texts).map_err(io::Error::from)?;
        if first.rows.len() < max_rows {
            first.rows.push(texts);
        }
    }
    writer.flush()?;
    Ok(first)
}

/// Shortest decimal form that reads back to the same bits, with exponent for very large and very small numbers; empty
/// for not-a-number.
pub(crate) fn format_shortest(number: f64) -> String {
    let size = number.abs();
    if number.is_nan() {
        String::new()
    } else if size.is_finite() && size != 0.0 && !(1e-5..1e16).contains(&size) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}

/// Header and first rows of a CSV table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FirstRows {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells of the first rows.
    pub rows: Vec<Vec<String>>,
    /// Number of all rows, without the header.
    pub row_count: usize,
}

/// Reads the header and the first `max_rows` rows of a CSV table, and counts its rows.
///
/// # Errors
/// The table cannot be read, or is no table in UTF-8.
pub fn read_first_rows(source: impl io::Read, max_rows: usize) -> io::Result<FirstRows> {
    let texts = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(source);
    let mut first = FirstRows { header: texts(reader.headers()?), rows: Vec::new(), row_count: 0 };
    let mut record = csv::StringRecord::new();
    while first.row_count < max_rows && reader.read_record(&mut record)? {
        first.rows.push(texts(&record));
        first.row_count += 1;
    }
    let mut record = csv::ByteRecord::new();
    while reader.read_byte_record(&mut record)? {
        first.row_count += 1;
    }
    Ok(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format_text(header: &[&str], rows: Vec<Vec<CsvCell>>) -> String {
        let mut bytes = Vec::new();
        let first = write_table(&mut bytes, header, rows, 2).unwrap();
        assert_eq!(read_first_rows(&bytes[..], 2).unwrap(), first);
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn numbers_text_and_missing_values_are_formatted() {
        let rows = vec![
            vec![CsvCell::from(0.1), CsvCell::from("plain")],
            vec![CsvCell::from(f64::NAN), CsvCell::from("comma, \"quote\"\nbreak")],
            vec![CsvCell::from(f64::NEG_INFINITY), CsvCell::from("φ")],
        ];
        let expected = "Δ (°),words\n0.1,plain\n,\"comma, \"\"quote\"\"\nbreak\"\n-inf,φ\n";
        assert_eq!(format_text(&["Δ (°)", "words"], rows), expected);
    }

    #[test]
    fn row_with_one_empty_cell_is_quoted() {
        // Readers skip an empty line, which would shift all later rows up.
        let rows = vec![vec![CsvCell::from(f64::NAN)], vec![CsvCell::from(2.0)]];
        assert_eq!(format_text(&["a"], rows), "a\n\"\"\n2\n");
    }

    #[test]
    fn first_rows_are_read_and_all_are_counted() {
        let table = "a,b\n1,\"x, \"\"y\"\"\"\n2,\n3,z\n";
        let found = read_first_rows(table.as_bytes(), 2).unwrap();
        assert_eq!((found.header, found.row_count), (vec!["a".into(), "b".into()], 3));
        assert_eq!(found.rows, [["1", "x, \"y\""], ["2", ""]]);
        assert!(read_first_rows(&b"a\n\xff\n"[..], 2).is_err());
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
            let text = format_shortest(number);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
            assert!(text.len() <= 25, "{text}");
        }
    }

    #[test]
    fn a_row_of_the_wrong_length_is_refused() {
        let rows = vec![vec![CsvCell::from(1.0); 2], vec![CsvCell::from(1.0); 3]];
        let refused = write_table(io::sink(), &["a", "b"], rows, 0).unwrap_err();
        let TableError::RowLength(refused) = refused else { panic!("{refused}") };
        assert_eq!(refused, RowLengthError { row: 2, found: 3, expected: 2 });
    }
}
