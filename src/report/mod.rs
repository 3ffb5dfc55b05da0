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
use page::{InteractivePicture, PagePicture, PageSection, PageTable};
use serde::Serialize;
use serde_json::{Map, Value};
use std::borrow::Cow;

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

/// Rendered report, ready to be written; its pictures are drawn at writing.
pub struct RenderedReport {
    study_name: &'static str,
    arguments: String,
    json: String,
    text: String,
    pictures: Vec<ReportPicture>,
    tables: Vec<RenderedTable>,
    interactive_picture: Option<InteractivePicture>,
    ends_with_picture_path: bool,
}

/// Data file of a rendered report.
struct RenderedTable {
    name: &'static str,
    bytes: Vec<u8>,
    /// Name and unit of each column of a table; `None` for other files.
    columns: Option<Vec<(String, Cow<'static, str>)>>,
}

impl RenderedTable {
    fn new((name, file): (&'static str, DataFile)) -> Result<Self, Error> {
        let columns = match &file {
            DataFile::Table(table) => Some(table.columns.clone()),
            DataFile::Arrays(_) | DataFile::Encoded(_) => None,
        };
        Ok(Self { name, bytes: file.encode()?, columns })
    }

    fn to_page_table(&self) -> Option<Result<PageTable, Error>> {
        let columns = self.columns.as_ref()?;
        let unit = |name: &str| {
            columns.iter().find(|own| own.0 == name).map_or(String::new(), |own| own.1.to_string())
        };
        Some(PageTable::read(self.name, &self.bytes[..], unit).map_err(Error::from))
    }
}

impl RenderedReport {
    /// Renders text, JSON and tables of a report and prepares its pictures.
    ///
    /// # Errors
    /// The text, the JSON report, a picture or a table cannot be rendered.
    pub fn new<R: Report>(report: &R, case: &Case) -> Result<Self, Error> {
        Ok(Self {
            study_name: R::NAME,
            arguments: report.to_arguments(case),
            json: format!("{:#}\n", to_json(report)?),
            text: report.to_text(case),
            pictures: report.create_pictures(case)?,
            tables: report
                .create_tables(case)?
                .into_iter()
                .map(RenderedTable::new)
                .collect::<Result<_, Error>>()?,
            interactive_picture: report.create_interactive_picture(case)?,
            ends_with_picture_path: R::ENDS_WITH_PICTURE_PATH,
        })
    }

    /// Passes the content of all files to `put` by name, the JSON report last; returns the pictures of the page, none if
    /// there is no page.
    ///
    /// # Errors
    /// A picture cannot be drawn, or `put` fails.
    pub fn write_files<E: From<Error>>(
        &self,
        options: &PictureOptions,
        mut put: impl FnMut(&str, &[u8]) -> Result<(), E>,
    ) -> Result<Vec<PagePicture>, E> {
        let pictures = draw_pictures(&self.pictures, options, &mut put)?;
        for RenderedTable { name, bytes, .. } in &self.tables {
            put(name, bytes)?;
        }
        put(&format!("{}.txt", self.study_name), self.text.as_bytes())?;
        put(&format!("{}.json", self.study_name), self.json.as_bytes())?;
        Ok(pictures)
    }

    /// Creates the section of the page with these pictures.
    ///
    /// # Errors
    /// A table cannot be read.
    pub fn create_page_section(&self, pictures: &[PagePicture]) -> Result<PageSection, Error> {
        let tables: Vec<PageTable> = self
            .tables
            .iter()
            .filter_map(RenderedTable::to_page_table)
            .collect::<Result<_, Error>>()?;
        let verdict = find_verdict(&self.json);
        let words = (self.text.as_str(), verdict.as_deref());
        let interactive = self.interactive_picture.as_ref();
        Ok(PageSection::new(
            self.study_name,
            &self.arguments,
            words,
            pictures,
            interactive,
            &tables,
        ))
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
