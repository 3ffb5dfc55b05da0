//! Data files of a report before they are encoded: tables and arrays with names, axes and units.
//!
//! CSV tables and NPZ archives are encoded from these values, and programs that use the library read the same values
//! without files.

use crate::Error;
use files::SeekableWriter;
use files::csv::{CsvCell, FirstRows, write_table};
use files::npz::NpzWriter;
use std::borrow::Cow;
use std::io::{Cursor, Seek, Write};

/// Content of a data file.
pub enum DataFile<'a> {
    /// Table, encoded as CSV.
    Table(DataTable<'a>),
    /// Arrays, encoded as NPZ archive.
    Arrays(Vec<DataArray<'a>>),
    /// File in a format of other programs.
    Encoded(Vec<u8>),
}

/// Table whose rows are computed when they are read.
pub struct DataTable<'a> {
    /// Columns: name and unit.
    pub columns: Vec<(String, Cow<'static, str>)>,
    /// Rows with one cell per column.
    pub rows: Box<dyn Iterator<Item = Vec<CsvCell>> + 'a>,
}

/// Array of a data file.
pub struct DataArray<'a> {
    /// Name of the array.
    pub name: Cow<'a, str>,
    /// Name and length of each axis, slowest first; none for a single number.
    pub axes: Vec<(Cow<'a, str>, usize)>,
    /// Unit of the values: `1` if dimensionless, empty if the values are no quantities.
    pub unit: Cow<'a, str>,
    /// Values in row-major order.
    pub values: ArrayData<'a>,
}

/// Values of an array in row-major order.
pub enum ArrayData<'a> {
    /// Double-precision numbers.
    F64(Cow<'a, [f64]>),
    /// 8-bit integers.
    I8(Cow<'a, [i8]>),
    /// 32-bit integers.
    I32(Vec<i32>),
    /// Texts.
    Text(Vec<String>),
}

impl<'a> DataFile<'a> {
    /// Creates the table of the file `file`, whose name determines the units of its columns.
    pub(super) fn table<H: AsRef<str>>(
        file: &str,
        header: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = Vec<CsvCell>, IntoIter: 'a>,
    ) -> Self {
        let column = |name: H| {
            let name = name.as_ref();
            (name.to_owned(), column_unit(file, name).unwrap_or_default().into())
        };
        let columns = header.into_iter().map(column).collect();
        Self::Table(DataTable { columns, rows: Box::new(rows.into_iter()) })
    }

    /// Encodes the file in memory.
    ///
    /// # Errors
    /// Those of [`write_to`](Self::write_to).
    pub fn encode(self) -> Result<Vec<u8>, Error> {
        let mut bytes = Cursor::new(Vec::new());
        self.write_to(&mut bytes, 0)?;
        Ok(bytes.into_inner())
    }

    /// Encodes the file row by row and array by array into a writer, which is at its beginning. Returns the first
    /// `max_rows` rows of a table; `None` for other files.
    ///
    /// # Errors
    /// A row has another length than the header, an array does not fill its axes, two arrays have the same name, or the
    /// writer fails.
    pub fn write_to(
        self,
        mut writer: &mut dyn SeekableWriter,
        max_rows: usize,
    ) -> Result<Option<FirstRows>, Error> {
        match self {
            Self::Table(DataTable { columns, rows }) => {
                let header: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
                return Ok(Some(write_table(writer, &header, rows, max_rows)?));
            }
            Self::Arrays(arrays) => {
                let mut archive = NpzWriter::new(&mut writer);
                for array in arrays {
                    array.add_to(&mut archive)?;
                }
                archive.finish()?;
            }
            Self::Encoded(bytes) => writer.write_all(&bytes)?,
        }
        Ok(None)
    }
}

impl<'a> DataArray<'a> {
    /// Creates an array of numbers.
    pub(super) fn numbers(
        name: impl Into<Cow<'a, str>>,
        axes: &[(&'a str, usize)],
        unit: &'a str,
        values: impl Into<Cow<'a, [f64]>>,
    ) -> Self {
        Self::new(name, axes, unit, ArrayData::F64(values.into()))
    }

    /// Creates a list of texts along the axis `axis`.
    pub(super) fn texts<T: AsRef<str>>(name: &'a str, axis: &'a str, texts: &[T]) -> Self {
        let values = texts.iter().map(|text| text.as_ref().to_owned()).collect();
        Self::new(name, &[(axis, texts.len())], "", ArrayData::Text(values))
    }

    /// Creates an array.
    pub(super) fn new(
        name: impl Into<Cow<'a, str>>,
        axes: &[(&'a str, usize)],
        unit: &'a str,
        values: ArrayData<'a>,
    ) -> Self {
        let axes = axes.iter().map(|&(name, length)| (name.into(), length)).collect();
        Self { name: name.into(), axes, unit: unit.into(), values }
    }

    /// Adds the array to an archive.
    ///
    /// # Errors
    /// The array does not fill its axes, or another array has its name.
    pub(crate) fn add_to<W: Write + Seek>(&self, archive: &mut NpzWriter<W>) -> Result<(), Error> {
        let shape: Vec<usize> = self.axes.iter().map(|(_, length)| *length).collect();
        match &self.values {
            ArrayData::F64(values) => archive.add_f64(&self.name, &shape, values)?,
            ArrayData::I8(values) => archive.add_i8(&self.name, &shape, values)?,
            ArrayData::I32(values) => archive.add_i32(&self.name, &shape, values)?,
            ArrayData::Text(values) => archive.add_text(&self.name, &shape, values)?,
        }
        Ok(())
    }
}

/// Returns the unit of a column of the table, or of an array of the archive, `file` of a report: `1` for dimensionless
/// quantities, empty for columns that hold no quantity; `None` for a column whose unit depends on the case: a swept
/// parameter, or a column of a run.
pub fn column_unit(file: &str, column: &str) -> Option<&'static str> {
    // Names that have different units in different files.
    match (file, column) {
        ("split.csv", "memory_bytes" | "bytes_per_step") => return Some("byte"),
        ("time.csv", "step_time" | "model_time" | "crossing_time") => return Some("s"),
        ("time.csv", _) => return Some("1"),
        ("split.csv", _) => return Some("1"),
        ("spall.csv", "distance") => return Some("m"),
        ("shocks.csv" | "fields.npz", "dissipation") => return Some("J/m3"),
        ("compare.csv", "sigma22" | "sigma12" | "rotation_rate") => return Some("1"),
        ("compare.csv", "dissipated_first" | "dissipated_second") => return Some("J/m"),
        ("compare.csv", "front_0_first" | "front_0_second") => return Some("m"),
        ("compare.csv", "front_45_first" | "front_45_second") => return Some("m"),
        _ => {}
    }
    Some(match column {
        "model" | "branch" | "family" | "response" | "wave" | "stage" | "verdict" | "route"
        | "hyperbolicity" => "",
        "order" | "longitudinal_share" => "1",
        "coefficient" => "m^order/s",
        "growth_rate" | "greatest_growth_rate" | "bound" | "decay_rate" => "1/s",
        "number" | "number_1" | "number_2" | "distance" => "1/m",
        "frequency" => "rad/s",
        "flutter" | "speed" | "phase_speed" | "group_speed" | "slowest_speed" | "velocity"
        | "velocity_ahead" | "velocity_behind" | "sound_ahead" | "sound_behind" => "m/s",
        "squared_speed" | "squared_speed_imaginary" | "least_squared_speed" => "m2/s2",
        "position" | "x1" | "x2" | "x3" => "m",
        "deformation" => "1",
        "time" => "s",
        "pressure" | "pressure_ahead" | "pressure_behind" => "Pa",
        "work" | "stored_energy" | "dissipated_energy" | "step_loss" => "J/m3",
        _ if column.ends_with("_deg") && !column.contains('.') => "deg",
        _ if column == "stress" || column.ends_with("_stress") => "Pa",
        _ if column.starts_with("strain") || column.ends_with("_strain") => "1",
        _ if column.ends_with("_energy") => "J/m3",
        _ => return None,
    })
}
