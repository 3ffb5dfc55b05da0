//! Conversion of tables and arrays of reports to NumPy arrays.
//!
//! NumPy's array interface needs no crate besides `pyo3`: others change features of numerical crates, whose dependents would
//! be compiled once more.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use std::any::Any;
use std::borrow::Cow;
use wellposed::files::csv::CsvCell;
use wellposed::report::run::create_field_arrays;
use wellposed::report::{ArrayData, DataArray, DataFile, DataTable};
use wellposed::study::simulate::OutputFields;

const F64_CODE: &str = if cfg!(target_endian = "big") { ">f8" } else { "<f8" };
const I32_CODE: &str = if cfg!(target_endian = "big") { ">i4" } else { "<i4" };

/// Converts a data file to a list of (name, axes, unit, array); columns of tables have no named axes, and files in
/// formats of other programs give `None`.
pub fn convert_file<'py>(
    py: Python<'py>,
    file: DataFile<'_>,
) -> PyResult<Option<Bound<'py, PyList>>> {
    match file {
        DataFile::Table(table) => convert_table(py, table).map(Some),
        DataFile::Arrays(arrays) => convert_arrays(py, arrays).map(Some),
        DataFile::Encoded(_) => Ok(None),
    }
}

/// Converts arrays to a list of (name, axes, unit, array); owned numbers are moved.
pub fn convert_arrays<'py>(
    py: Python<'py>,
    arrays: Vec<DataArray<'_>>,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for DataArray { name, axes, unit, values } in arrays {
        let shape: Vec<usize> = axes.iter().map(|(_, length)| *length).collect();
        let names = PyTuple::new(py, axes.iter().map(|(axis, _)| axis.as_ref()))?;
        let values = match values {
            ArrayData::F64(values) => convert_values(py, shape, F64_CODE, values.into_owned())?,
            ArrayData::I8(values) => convert_values(py, shape, "|i1", values.into_owned())?,
            ArrayData::I32(values) => convert_values(py, shape, I32_CODE, values)?,
            ArrayData::Text(values) => convert_texts(py, values)?,
        };
        list.append((name.as_ref(), names, unit.as_ref(), values))?;
    }
    Ok(list)
}

/// Converts the fields of a simulation to a list of (name, axes, unit, array); the numbers are moved.
pub fn convert_fields(py: Python<'_>, fields: OutputFields) -> PyResult<Bound<'_, PyList>> {
    convert_arrays(py, create_field_arrays(Cow::Owned(fields)))
}

fn convert_table<'py>(py: Python<'py>, table: DataTable<'_>) -> PyResult<Bound<'py, PyList>> {
    let DataTable { columns, rows } = table;
    let mut values: Vec<Column> = columns.iter().map(|_| Column::Empty).collect();
    for row in rows {
        values.iter_mut().zip(row).for_each(|(column, cell)| column.push(cell));
    }
    let list = PyList::empty(py);
    for ((name, unit), column) in columns.into_iter().zip(values) {
        let array = match column {
            Column::Empty => convert_values(py, vec![0], F64_CODE, Vec::<f64>::new())?,
            Column::Numbers(numbers) => convert_values(py, vec![numbers.len()], F64_CODE, numbers)?,
            Column::Texts(texts) => convert_texts(py, texts)?,
        };
        list.append((name, py.None(), unit.as_ref(), array))?;
    }
    Ok(list)
}

/// Values of a column, whose first cell determines their type.
enum Column {
    Empty,
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

impl Column {
    fn push(&mut self, cell: CsvCell) {
        match (self, cell) {
            (Self::Numbers(numbers), CsvCell::Number(number)) => numbers.push(number),
            (Self::Texts(texts), CsvCell::Text(text)) => texts.push(text),
            (own, CsvCell::Number(number)) => *own = Self::Numbers(vec![number]),
            (own, CsvCell::Text(text)) => *own = Self::Texts(vec![text]),
        }
    }
}

fn convert_values<'py, T: Send + Sync + 'static>(
    py: Python<'py>,
    shape: Vec<usize>,
    type_code: &'static str,
    mut values: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    if shape.iter().product::<usize>() != values.len() {
        let message = format!("{} values do not fill the shape {shape:?}", values.len());
        return Err(PyValueError::new_err(message));
    }
    // The address of the elements remains when the vector is moved.
    let address = values.as_mut_ptr() as usize;
    let memory = ArrayMemory { shape, type_code, address, _values: Box::new(values) };
    py.import("numpy")?.getattr("asarray")?.call1((memory,))
}

/// Memory of a NumPy array, which keeps this object alive. The memory is shared by NumPy's array interface, version 3; the
/// values are not accessed here.
#[pyclass(frozen)]
struct ArrayMemory {
    shape: Vec<usize>,
    /// Type of the values as in NPZ files, e.g. `<f8`.
    type_code: &'static str,
    address: usize,
    _values: Box<dyn Any + Send + Sync>,
}

#[pymethods]
impl ArrayMemory {
    #[getter(__array_interface__)]
    fn array_interface<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", PyTuple::new(py, &self.shape)?)?;
        interface.set_item("typestr", self.type_code)?;
        let is_read_only = false;
        interface.set_item("data", (self.address, is_read_only))?;
        Ok(interface)
    }
}

fn convert_texts<'py>(py: Python<'py>, texts: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
    py.import("numpy")?.getattr("array")?.call1((texts, "str"))
}
