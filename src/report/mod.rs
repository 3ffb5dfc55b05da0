//! Rendering of study results as text, JSON, tables and pictures; the parts common to all studies.

pub mod bloch;
pub mod check;
pub mod compare;
mod data_file;
pub mod diagram;
pub mod dispersion;
pub mod format;
pub mod homogenise;
pub mod map;
pub mod page;
mod parameters;
mod picture;
pub mod point;
pub mod run;
pub mod shocks;
pub mod speeds;
mod split;
mod symbols;
mod timing;

use crate::Error;
use crate::case::Case;
use files::SeekableWriter;
use page::{InteractivePicture, PagePicture, PageSection, PageTable};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::HashMap;
use std::io;

pub use data_file::{ArrayData, DataArray, DataFile, DataTable, column_unit};
pub use picture::{PictureOptions, ReportPicture, draw_pictures};

/// Version of the JSON reports; raised when a key changes its name or meaning.
pub const SCHEMA_VERSION: u64 = 1;

/// Study result that can be reported; its serialisation is the JSON report.
pub trait Report: Serialize {
    /// Name of the study and stem of its files: `dispersion.json`.
    const NAME: &'static str;

    /// Pairs of a quantity and its unit, which form the last entry of the JSON report; the entry is omitted if there
    /// are no pairs.
    const UNITS: &'static [(&'static str, &'static str)] = &[];

    /// Whether the printed text ends with the path of the first picture; if not, it ends with that of the results
    /// folder.
    const ENDS_WITH_PICTURE_PATH: bool = true;

    /// Returns the pairs of a quantity and its unit; overridden if they depend on the result.
    fn units(&self) -> &'static [(&'static str, &'static str)] {
        Self::UNITS
    }

    /// Returns the arguments of the command that computes the report from the `case.toml` of its folder, which has all
    /// overrides. Options that no result depends on, such as the number of threads, are omitted.
    fn to_arguments(&self, _case: &Case) -> String {
        "case.toml".to_owned()
    }

    /// Renders the report as text.
    fn to_text(&self, case: &Case) -> String;

    /// Creates the pictures of the report.
    ///
    /// # Errors
    /// The pictures cannot be created, for example since the case has no simulation.
    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error>;

    /// Creates the data files, by file name.
    ///
    /// # Errors
    /// A table or archive cannot be created.
    fn create_tables(&self, case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error>;

    /// Names of files that earlier results of this study in the folder may have and that these results do not have.
    fn absent_file_names(&self) -> Vec<String> {
        Vec::new()
    }

    /// Creates the data of a picture whose points can be selected on the page of the results folder; `None` if there is
    /// no such picture.
    ///
    /// # Errors
    /// The picture cannot be laid out.
    fn create_interactive_picture(
        &self,
        _case: &Case,
    ) -> Result<Option<InteractivePicture>, Error> {
        Ok(None)
    }
}

/// Creates the JSON report: schema version, value and units.
///
/// # Errors
/// The value cannot be serialised.
pub fn to_json<R: Report>(report: &R) -> Result<Value, Error> {
    let mut all = Map::from_iter([("schema".to_owned(), SCHEMA_VERSION.into())]);
    match serde_json::to_value(report)? {
        Value::Object(own) => all.extend(own),
        own => _ = all.insert(R::NAME.to_owned(), own),
    }
    let units = report.units();
    if !units.is_empty() {
        let units = units.iter().map(|(name, unit)| ((*name).to_owned(), (*unit).into()));
        all.insert("units".to_owned(), Map::from_iter(units).into());
    }
    Ok(all.into())
}

/// Returns the verdict that a JSON report states; `None` if it states none.
pub fn find_verdict(json: &str) -> Option<String> {
    let report: Value = serde_json::from_str(json).ok()?;
    report["verdict"].as_str().map(str::to_owned)
}

/// Returns the names of the files that [`RenderedReport::write_files`] writes, unordered.
///
/// # Errors
/// A picture or table cannot be created.
pub fn file_names<R: Report>(
    report: &R,
    case: &Case,
    options: &PictureOptions,
) -> Result<Vec<String>, Error> {
    let mut names = vec![format!("{}.json", R::NAME), format!("{}.txt", R::NAME)];
    for picture in report.create_pictures(case)? {
        names.extend(options.file_names(picture.file_stem()));
    }
    names.extend(report.create_tables(case)?.into_iter().map(|(name, _)| name.to_owned()));
    Ok(names)
}

/// Function that writes the content of a file.
pub type WriteContent<'a> = dyn FnMut(&mut dyn SeekableWriter) -> io::Result<()> + 'a;

/// Rendered report, ready to be written; its pictures are drawn, and its data files encoded, at writing.
pub struct RenderedReport<'r> {
    study_name: &'static str,
    arguments: String,
    json: String,
    text: String,
    pictures: Vec<ReportPicture>,
    tables: Vec<(&'static str, DataFile<'r>)>,
    /// Tables of the page, which are known when the data files have been written.
    page_tables: Vec<PageTable>,
    interactive_picture: Option<InteractivePicture>,
    ends_with_picture_path: bool,
}

/// Writes a data file; returns the table of the page if it is a table.
fn write_data_file(
    name: &str,
    file: DataFile,
    writer: &mut dyn SeekableWriter,
) -> Result<Option<PageTable>, Error> {
    let units: HashMap<String, String> = match &file {
        DataFile::Table(DataTable { columns, .. }) => {
            columns.iter().map(|(name, unit)| (name.clone(), unit.to_string())).collect()
        }
        DataFile::Arrays(_) | DataFile::Encoded(_) => HashMap::new(),
    };
    let unit = |name: &str| units.get(name).cloned().unwrap_or_default();
    let first_rows = file.write_to(writer, PageTable::SHOWN_ROWS)?;
    Ok(first_rows.map(|rows| PageTable::new(name, rows, unit)))
}

impl<'r> RenderedReport<'r> {
    /// Renders text and JSON of a report and prepares its pictures and data files.
    ///
    /// # Errors
    /// The text, the JSON report, a picture or a table cannot be rendered.
    pub fn new<R: Report>(report: &'r R, case: &Case) -> Result<Self, Error> {
        Ok(Self {
            study_name: R::NAME,
            arguments: report.to_arguments(case),
            json: format!("{:#}\n", to_json(report)?),
            text: report.to_text(case),
            pictures: report.create_pictures(case)?,
            tables: report.create_tables(case)?,
            page_tables: Vec::new(),
            interactive_picture: report.create_interactive_picture(case)?,
            ends_with_picture_path: R::ENDS_WITH_PICTURE_PATH,
        })
    }

    /// Passes the content of all files to `put` by name, the JSON report last; returns the pictures of the page, none if
    /// there is no page. Data files are not kept, so that they can be written once.
    ///
    /// # Errors
    /// A picture cannot be drawn, or `put` fails.
    pub fn write_files<E: From<Error>>(
        &mut self,
        options: &PictureOptions,
        mut put: impl FnMut(&str, &mut WriteContent) -> Result<(), E>,
    ) -> Result<Vec<PagePicture>, E> {
        let mut put_bytes = |name: &str, bytes: &[u8]| put(name, &mut |file| file.write_all(bytes));
        let pictures = draw_pictures(&self.pictures, options, &mut put_bytes)?;
        for (name, file) in self.tables.drain(..) {
            let (mut file, mut page_table) = (Some(file), None);
            put(name, &mut |writer| {
                let Some(file) = file.take() else {
                    return Err(io::Error::other("a table is written once"));
                };
                page_table = write_data_file(name, file, writer).map_err(io::Error::other)?;
                Ok(())
            })?;
            self.page_tables.extend(page_table);
        }
        let mut put_text =
            |name: String, text: &str| put(&name, &mut |file| file.write_all(text.as_bytes()));
        put_text(format!("{}.txt", self.study_name), &self.text)?;
        put_text(format!("{}.json", self.study_name), &self.json)?;
        Ok(pictures)
    }

    /// Creates the section of the page with these pictures.
    ///
    /// # Errors
    /// A table that has not been written cannot be encoded.
    pub fn create_page_section(&mut self, pictures: &[PagePicture]) -> Result<PageSection, Error> {
        for (name, file) in self.tables.drain(..) {
            if let DataFile::Table(_) = file {
                self.page_tables.extend(write_data_file(name, file, &mut io::empty())?);
            }
        }
        let verdict = find_verdict(&self.json);
        let words = (self.text.as_str(), verdict.as_deref());
        let interactive = self.interactive_picture.as_ref();
        let (name, arguments) = (self.study_name, &self.arguments);
        Ok(PageSection::new(name, arguments, words, pictures, interactive, &self.page_tables))
    }

    /// Returns the text report.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the JSON report.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// Returns the pictures of the report.
    pub fn pictures(&self) -> &[ReportPicture] {
        &self.pictures
    }

    /// Returns the file name of the first picture; `None` if the text does not end with its path or none is drawn.
    pub fn first_picture_name(&self, options: &PictureOptions) -> Option<String> {
        let first = self.pictures.first().filter(|_| self.ends_with_picture_path)?;
        options.file_names(first.file_stem()).next()
    }
}
