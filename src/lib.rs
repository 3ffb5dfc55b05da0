//! Well-posedness of continuum models of granular media: from a case file to a verdict.
//!
//! A case file describes a medium and a state. `wellposed` linearises the equations at this state and says whether they
//! are well-posed, and if not how fast short waves grow and in which direction; solves the equations in the time
//! domain; and compares the predicted with the simulated frequencies and growth rates. The program `wellposed` does
//! this on the command line; this library runs the same studies and returns values, without files.
//!
//! # Studies
//!
//! | study | result |
//! |---|---|
//! | [`load`] | a [`Case`], read from a file and checked |
//! | [`analyse_point`] | [`PointResult`](study::PointResult): analysis of one state: background, characteristics, roots, growth, verdict with evidence |
//! | [`compute_map`] | [`MapResult`](study::MapResult): the verdict over two parameters of the case |
//! | [`compute_dispersion`] | [`DispersionResult`](study::DispersionResult): dispersion relation of a solid: frequencies and speeds of its waves by wave number |
//! | [`compute_bloch_waves`](study::compute_bloch_waves) | [`BandStructureResult`](study::BandStructureResult): Bloch waves of a blocky medium, compared with the equivalent continuum |
//! | [`homogenise`](study::homogenise()) | [`HomogeniseResult`](study::HomogeniseResult): the Cosserat continuum that is equivalent to a blocky medium |
//! | [`compare_runs`](study::compare_runs) | [`ComparisonResult`](study::ComparisonResult): differences between two runs of the same load |
//! | [`compute_speeds`] | [`SpeedsResult`](study::SpeedsResult): characteristic speeds of a solid by direction, elastic and yielding |
//! | [`compute_shocks`](study::compute_shocks) | [`ShocksResult`](study::ShocksResult): exact plane waves in a granular or porous medium: waves behind a piston, compaction shocks, spall |
//! | [`simulate`] | [`RunResult`](study::RunResult): time-domain simulation of a solid or a flow: fields, receiver records, energy ledger |
//! | [`compute_diagram`] | [`DiagramResult`](study::DiagramResult): stress against strain of a rheological scheme, energies of its elements |
//! | [`check_agreement`] | [`CheckResult`](study::CheckResult): frequencies and growth rates of waves: predicted by the analysis, measured by a solver |
//!
//! Harris–Grekova (2005) at constant volume is well-posed while the principal axes of stress and deformation rate are
//! less than 45° apart:
//!
//! ```
//! use wellposed::study::ignore_progress;
//!
//! let path = "cases/granular-flow/noncoaxiality-bound.toml";
//! let inside = wellposed::analyse_point(&wellposed::load(path, &["background.noncoaxiality_deg=40"])?, &ignore_progress)?;
//! let outside = wellposed::analyse_point(&wellposed::load(path, &["background.noncoaxiality_deg=50"])?, &ignore_progress)?;
//! assert_eq!(inside.verdict().map(|verdict| verdict.name()), Some("well-posed"));
//! assert_eq!(outside.verdict().map(|verdict| verdict.name()), Some("ill-posed"));
//!
//! // The report that `wellposed point --format json` prints.
//! println!("{:#}", wellposed::report::to_json(&outside)?);
//! # Ok::<(), wellposed::Error>(())
//! ```
//!
//! # Layout
//!
//! An arrow points from a crate or module to one that it uses; transitive dependencies are not drawn, and no arrow
//! points up.
//!
#![doc = include_str!("../docs/crates.svg")]
//!
//! This package contains [`study`], whose functions return values; [`setup`], which creates problems of the crates
//! below from a case; [`report`], which renders values as text, JSON, tables and pictures; and [`cli`], the verbs of
//! the command line. This package contains no physics and no numerics. [`mod@case`] is the crate that reads and writes
//! case files.
//!
//! All crates are re-exported: a program needs no other dependency, and registers its own model with
//! `wellposed::models::registry::register_solid`. [`CASES`] holds the texts of the cases shipped with the program.
//!
//! | crate | contents |
//! |---|---|
//! | [`models`] | physics without discretisation, files or threads: flows, solids, yield sets, and the registry that lists them |
//! | [`analysis`] | linearised equations, dispersion polynomial, roots, growth of short waves, verdict |
//! | [`dynamics`] | time-domain solvers for solids and flows, with energy ledgers |
//! | [`agreement`] | comparison of wave rates predicted by the analysis and measured by the solvers |
//! | [`cases`](mod@case) | case files: one schema for reader, writer, templates, reference page and JSON Schema |
//! | [`figures`] | figures from plain structs |
//! | [`files`] | atomic writing, tables, archives, snapshots |
//!
//! `analysis` and `dynamics` are independent of each other, so that `agreement` compares independent results; `figures`
//! and `files` contain no physics.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod cli;
mod error;
pub mod report;
pub mod setup;
pub mod study;

#[doc(no_inline)]
pub use ::{agreement, analysis, cases, dynamics, figures, files, models};
pub use ::cases as case;
pub use ::cases::CASES;
pub use error::Error;
pub use study::{
    check::check_agreement, diagram::compute_diagram, dispersion::compute_dispersion,
    map::compute_map, point::analyse_point, simulate::simulate, speeds::compute_speeds,
};

use case::Case;
use std::path::Path;

/// Library page of the documentation, whose example is run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
pub struct LibraryPage;

/// Version and, in parentheses, the abbreviated hash of the Git commit: `0.1.0 (abcdef123)`; `unknown` in place of the
/// hash if the package was not built from its repository.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("WELLPOSED_COMMIT"), ")");

/// Empty list of `key=value` settings, for [`load`].
pub const NO_SETTINGS: [&str; 0] = [];

/// Reads a case file and applies `key=value` settings; the last setting of a key takes precedence.
///
/// # Errors
/// The file cannot be read, or the file or a setting is invalid; for an invalid value of a key, the error states its
/// position and the allowed values.
///
/// # Examples
/// ```
/// let path = "cases/cosserat/forbidden-band.toml";
/// let case = wellposed::load(path, ["wave.number=3"])?;
/// assert_eq!(case.number("wave.number"), Some(3.0));
/// for number in [1.0, 2.0] {
///     let case = wellposed::load(path, [format!("wave.number={number}")])?;
///     assert_eq!(case.number("wave.number"), Some(number));
/// }
/// wellposed::load(path, wellposed::NO_SETTINGS)?;
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn load(
    path: impl AsRef<Path>,
    settings: impl IntoIterator<Item: AsRef<str>>,
) -> Result<Case, Error> {
    let settings: Vec<String> =
        settings.into_iter().map(|setting| setting.as_ref().to_owned()).collect();
    Ok(Case::load(path.as_ref(), &settings)?)
}
