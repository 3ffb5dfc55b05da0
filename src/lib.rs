//! Well-posedness of continuum models of granular media.
//!
//! Describe a medium and a state in a case file; `wellposed` says whether its equations are
//! well-posed. [`load`] reads a case; each question about it is answered by a value: [`point()`], [`map()`],
//! [`dispersion()`], [`speeds()`], [`simulate()`], [`check()`] ([`study`]). Their reports are in [`report`], the verbs of the
//! command line and folders of results in [`cli`];
//! [`mod@case`] reads case files; [`setup`] makes of them what the crates below take. No physics and no numerics here.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod cli;
mod error;
pub mod report;
pub mod setup;
pub mod study;

pub use ::cases as case;
pub use error::Error;
pub use study::{
    check::check, dispersion::dispersion, map::map, point::point, simulate::simulate,
    speeds::speeds,
};

use case::Case;
use std::path::Path;

/// Version, and commit where the program was built from a repository: `0.1.0 (abcdef123)`.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("WELLPOSED_COMMIT"), ")");

/// Reads a case file, with `key=value` settings over it, of which the last one of a key holds.
///
/// # Errors
/// The file cannot be read, or what is wrong in it or in a setting, where, and what is allowed.
///
/// # Examples
/// ```
/// let case = wellposed::load("cases/cosserat/forbidden-band.toml", &["wave.number=3"])?;
/// assert_eq!(case.numbers.wave.number, 3.0);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn load(path: impl AsRef<Path>, settings: &[&str]) -> Result<Case, Error> {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    Ok(Case::load(path.as_ref(), &settings)?)
}
