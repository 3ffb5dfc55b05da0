//! Extension module of the Python package `wellposed`: cases, and one function per study.
//!
//! Functions return a `RawResult`, which the classes of the package present. They call the studies of the
//! library and read or write no files, except case files and files named in them.

mod arrays;
mod error;
mod result;
mod studies;
mod supervise;

use pyo3::prelude::*;

/// Extension module: see the package `wellposed`.
#[pymodule(gil_used = false)]
mod _wellposed {
    #[pymodule_export]
    use crate::result::{RawCase, RawResult};
    #[pymodule_export]
    use crate::studies::{
        bundled_cases, check, column_unit, compare, diagram, dispersion, homogenise, map, point,
        run, shocks, speeds,
    };

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("VERSION", ::wellposed::VERSION)
    }
}
