//! Image data in several files, one per piece: the index for viewers (`.pvti`, `.pvts`), and the file of the whole.

use std::ops::Range;

use super::arrays::ArrayDeclaration;
use super::attributes::{escape_xml, unescape_xml};
use super::grid::{format_cell_extent, format_triple, parse_cell_extent};
use super::image_data::ImageData;

/// Piece of image data: its cells along each axis of the grid, and its file relative to the index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PieceFile {
    /// Cells along each axis.
    pub cells: Vec<Range<usize>>,
    /// Path of the file.
    pub file: String,
}

impl ImageData {
    /// Formats the index of pieces with the same arrays as this one.
    pub fn format_index(&self, pieces: &[PieceFile]) -> Vec<u8> {
        let extent = self.grid.format_extent();
        let (kind, geometry) = match &self.nodes {
            None => {
                let origin = format_triple(&self.grid.origin, 0.0);
                let spacing = format_triple(&self.grid.spacing, 1.0);
                ("PImageData", format!(" Origin=\"{origin}\" Spacing=\"{spacing}\""))
            }
            Some(_) => ("PStructuredGrid", String::new()),
        };
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n  \
               <{kind} WholeExtent=\"{extent}\" GhostLevel=\"0\"{geometry}>\n    \
                 <PCellData>\n"
        );
        for ArrayDeclaration { name, vtk_type, components } in self.arrays.declarations() {
            let name = escape_xml(&name);
            text.push_str(&format!(
                "      <PDataArray type=\"{vtk_type}\" Name=\"{name}\" \
                 NumberOfComponents=\"{components}\"/>\n"
            ));
        }
        text.push_str("    </PCellData>\n");
        if self.nodes.is_some() {
            text.push_str(
                "    <PPoints>\n      <PDataArray type=\"Float64\" NumberOfComponents=\"3\"/>\n    \
                 </PPoints>\n",
            );
        }
        for PieceFile { cells, file } in pieces {
            let (extent, file) = (format_cell_extent(cells), escape_xml(file));
            text.push_str(&format!("    <Piece Extent=\"{extent}\" Source=\"{file}\"/>\n"));
        }
        text.push_str(&format!("  </{kind}>\n</VTKFile>\n"));
        text.into_bytes()
    }
}

/// Parses the pieces in an index of image data of `axes` axes that [`ImageData::format_index`] has formatted; `None` if it
/// is another text.
pub fn parse_index(text: &str, axes: usize) -> Option<Vec<PieceFile>> {
    let piece = |line: &str| {
        let (extent, file) = line.split_once("\" Source=\"")?;
        let cells = parse_cell_extent(extent, axes)?;
        Some(PieceFile { cells, file: unescape_xml(file.split('"').next()?) })
    };
    let lines = text.lines().filter_map(|line| line.split_once("<Piece Extent=\""));
    lines.map(|(_, line)| piece(line)).collect()
}
