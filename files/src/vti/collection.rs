//! PVD collections: files of a time series and their times.

use super::attributes::{check_time, format_attribute, unescape_xml};
use super::error::VtiError;
use crate::csv::format_shortest;

/// Formats a collection (`.pvd`): time (usually s) and path relative to the collection, for each file.
pub fn format_collection(entries: &[(f64, impl AsRef<str>)]) -> Result<Vec<u8>, VtiError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  \
           <Collection>\n",
    );
    for (time, file) in entries {
        let (time, file) = (format_shortest(check_time(*time)?), format_attribute(file.as_ref())?);
        text.push_str(&format!(
            "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>\n"
        ));
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    Ok(text.into_bytes())
}

/// Parses the paths in a collection written by [`format_collection`].
pub fn parse_collection(text: &str) -> Vec<String> {
    let paths = text.lines().filter_map(|line| line.split_once(" file=\"")?.1.split('"').next());
    paths.map(unescape_xml).collect()
}
