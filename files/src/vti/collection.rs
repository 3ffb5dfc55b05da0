//! PVD collections: files of a time series and their times.

use super::attributes::{attribute, finite};
use super::error::VtiError;
use crate::csv::shortest;

/// Formats a collection (`.pvd`): time (usually s) and path relative to the collection, for each file.
pub fn collection(entries: &[(f64, impl AsRef<str>)]) -> Result<Vec<u8>, VtiError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  \
           <Collection>\n",
    );
    for (time, file) in entries {
        let (time, file) = (shortest(finite(*time)?), attribute(file.as_ref())?);
        text.push_str(&format!(
            "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>\n"
        ));
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    Ok(text.into_bytes())
}

/// Paths in a collection written by [`collection`].
pub fn collected(text: &str) -> Vec<String> {
    let paths = text.lines().filter_map(|line| line.split_once(" file=\"")?.1.split('"').next());
    let unescaped = |path: &str| {
        let path = path.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">");
        path.replace("&amp;", "&")
    };
    paths.map(unescaped).collect()
}
