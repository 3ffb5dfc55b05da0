//! Cases and results as Python objects.

use crate::arrays::{convert_arrays, convert_fields, convert_file};
use crate::error::{TEXT_NAME, to_case_exception, to_exception};
use crate::supervise::Supervision;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use std::borrow::Cow;
use std::path::PathBuf;
use wellposed::case::{Case, CaseError};
use wellposed::figures::FigureFormat;
use wellposed::report::run::create_record_arrays;
use wellposed::report::{PictureOptions, Report, ReportPicture, draw_pictures, to_json};
use wellposed::study::{ProgressCallback, RunResult};
use wellposed::{Error, report};

/// Case of a study, read and checked.
#[pyclass(frozen, name = "RawCase")]
pub struct RawCase {
    /// The case.
    pub case: Case,
    /// Whether errors state lines; those of a text generated from a `dict` mean nothing.
    has_lines: bool,
}

impl RawCase {
    fn new(py: Python<'_>, read: Result<Case, CaseError>, has_lines: bool) -> PyResult<Self> {
        match read {
            Ok(case) => Ok(Self { case, has_lines }),
            Err(error) => Err(to_case_exception(py, &error, has_lines)),
        }
    }

    /// Computes a study of this case without the lock of the interpreter and converts its result.
    ///
    /// # Errors
    /// As [`Supervision::run`] and [`RawResult::new`].
    pub fn compute<R: Report + Send>(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        threads: Option<usize>,
        study: impl FnOnce(&Case, ProgressCallback) -> Result<R, Error> + Send,
    ) -> PyResult<RawResult> {
        let case = &self.case;
        let found = self.supervise(progress, threads).run(py, |progress| study(case, progress))?;
        RawResult::new(py, &found, case)
    }

    /// Returns the supervision of a study of this case.
    pub fn supervise<'a, 'py>(
        &self,
        progress: Option<&'a Bound<'py, PyAny>>,
        threads: Option<usize>,
    ) -> Supervision<'a, 'py> {
        Supervision { progress, threads, has_lines: self.has_lines }
    }
}

#[pymethods]
impl RawCase {
    /// Reads a case file or a bundled case.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, settings: Vec<String>) -> PyResult<Self> {
        Self::new(py, Case::load(&path, &settings), true)
    }

    /// Reads the text of a case file; if `has_lines` is not set, errors state no lines.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, settings: Vec<String>, has_lines: bool) -> PyResult<Self> {
        // The file name in messages; files named in the text are relative to the working directory.
        Self::new(py, Case::parse(text, TEXT_NAME, &settings), has_lines)
    }

    /// Name of the case.
    #[getter]
    fn name(&self) -> &str {
        &self.case.name
    }

    /// Title of the case; empty if it has none.
    #[getter]
    fn title(&self) -> &str {
        &self.case.title
    }

    /// Hints on former names that the case uses.
    #[getter]
    fn hints(&self) -> Vec<String> {
        self.case.hints().iter().map(ToString::to_string).collect()
    }

    /// Formats the resolved case as TOML.
    fn to_toml(&self) -> String {
        self.case.to_toml()
    }
}

/// Result of a study: report as text and JSON, pictures to be drawn, and arrays.
#[pyclass(frozen, name = "RawResult")]
pub struct RawResult {
    /// Name of the study, such as `map`.
    #[pyo3(get)]
    name: &'static str,
    /// Report as text.
    #[pyo3(get)]
    text: String,
    /// Report as JSON.
    #[pyo3(get)]
    json: String,
    /// Arrays by table: a list of (name, axes, unit, array).
    #[pyo3(get)]
    tables: Py<PyDict>,
    /// Arrays of the snapshots kept in memory.
    #[pyo3(get)]
    snapshots: Py<PyList>,
    pictures: Vec<ReportPicture>,
}

#[pymethods]
impl RawResult {
    /// Names of the pictures.
    #[getter]
    fn picture_names(&self) -> Vec<&'static str> {
        self.pictures.iter().map(ReportPicture::file_stem).collect()
    }

    /// Draws a picture; the result is the content of its file.
    fn draw<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        format: &str,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let formats = [FigureFormat::Png, FigureFormat::Svg, FigureFormat::Pdf];
        let Some(format) = formats.into_iter().find(|own| own.extension() == format) else {
            let message = format!("picture format: found '{format}'; expected png, svg or pdf");
            return Err(PyValueError::new_err(message));
        };
        let Some(index) = self.pictures.iter().position(|own| own.file_stem() == name) else {
            let allowed = self.picture_names().join(", ");
            let message = format!("picture: found '{name}'; expected one of: {allowed}");
            return Err(PyValueError::new_err(message));
        };
        let options = PictureOptions { formats: vec![format], ..PictureOptions::no_pictures() };
        let mut drawn = Vec::new();
        py.detach(|| {
            draw_pictures(&self.pictures[index..=index], &options, |_, bytes| {
                drawn.extend_from_slice(bytes);
                Ok::<(), Error>(())
            })
        })
        .map_err(|error| to_exception(py, &error, true))?;
        Ok(PyBytes::new(py, &drawn))
    }
}

impl RawResult {
    /// Converts the report of a study.
    ///
    /// # Errors
    /// The report, a picture or a table cannot be created.
    pub fn new<R: Report>(py: Python<'_>, found: &R, case: &Case) -> PyResult<Self> {
        Self::with_tables(py, found, case, PyDict::new(py))
    }

    /// Converts the result of a simulation; fields and records are moved.
    ///
    /// # Errors
    /// The report, a picture or a table cannot be created.
    pub fn from_run(py: Python<'_>, found: RunResult, case: &Case) -> PyResult<Self> {
        let tables = PyDict::new(py);
        // Tables of these names are not created from the report, which would copy them.
        tables.set_item("fields", PyList::empty(py))?;
        tables.set_item("receivers", PyList::empty(py))?;
        let raw = Self::with_tables(py, &found, case, tables)?;
        let tables = raw.tables.bind(py);
        tables.del_item("receivers")?;
        let RunResult { fields, records, .. } = found;
        tables.set_item("fields", convert_fields(py, fields)?)?;
        let records_by_name = [
            ("receivers", records.receivers),
            ("ledger", Some(records.ledger)),
            ("spectrum", records.spectrum),
        ];
        for (name, table) in records_by_name {
            if let Some(table) = table {
                let arrays = create_record_arrays(Cow::Owned(table));
                tables.set_item(name, convert_arrays(py, arrays)?)?;
            }
        }
        for fields in records.snapshots {
            raw.snapshots.bind(py).append(convert_fields(py, fields)?)?;
        }
        Ok(raw)
    }

    /// Converts the report of a study and adds its data files to `tables` by their names without extension. Of a table and
    /// an archive of the same name the archive is taken, and what `tables` already contains is left.
    fn with_tables(
        py: Python<'_>,
        found: &impl Report,
        case: &Case,
        tables: Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let raise = |error: Error| to_exception(py, &error, true);
        let mut files = found.create_tables(case).map_err(raise)?;
        files.sort_by_key(|(_, file)| matches!(file, report::DataFile::Table(_)));
        for (file_name, file) in files {
            let stem = file_name.rsplit_once('.').map_or(file_name, |(stem, _)| stem);
            if tables.contains(stem)? {
                continue;
            }
            if let Some(arrays) = convert_file(py, file)? {
                tables.set_item(stem, arrays)?;
            }
        }
        let json = to_json(found).map_err(raise)?.to_string();
        Ok(Self {
            name: name_of(found),
            text: found.to_text(case),
            json,
            tables: tables.unbind(),
            snapshots: PyList::empty(py).unbind(),
            pictures: found.create_pictures(case).map_err(raise)?,
        })
    }
}

fn name_of<R: Report>(_: &R) -> &'static str {
    R::NAME
}
