//! From the value of a study to what people and programs read: text, JSON, tables, pictures. One way for all studies.

pub mod check;
pub mod dispersion;
pub mod format;
pub mod map;
pub mod point;
pub mod run;
pub mod speeds;

use crate::Error;
use crate::case::Case;
use figures::FigureError;
use serde::Serialize;
use serde_json::{Map, Value};

/// Version of the JSON reports: raised when a key changes its name or its meaning.
pub const SCHEMA: u64 = 1;

/// A value that can be reported. Its serialisation is the JSON report.
pub trait Report: Serialize {
    /// Name of the study, and of its files: `dispersion.json`.
    const NAME: &'static str;

    /// Units by quantity, which stand last in the JSON report.
    const UNITS: &'static [(&'static str, &'static str)] = &[];

    /// Whether what is printed as text ends with the path of the first picture; else with that of the folder.
    const ENDS_WITH_PICTURE: bool = true;

    /// The same where they depend on the value.
    fn units(&self) -> &'static [(&'static str, &'static str)] {
        Self::UNITS
    }

    /// The report in words and numbers for a reader.
    fn text(&self, case: &Case) -> String;

    /// The pictures, the first of which is named to the reader.
    ///
    /// # Errors
    /// One cannot be made.
    fn pictures(&self, case: &Case) -> Result<Vec<Picture>, Error>;

    /// Tables and archives by the names of their files.
    ///
    /// # Errors
    /// One cannot be made.
    fn tables(&self, case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error>;
}

/// Draws a picture as a file of some format.
type Draw = Box<dyn Fn(figures::Format) -> Result<Vec<u8>, FigureError>>;

/// A picture: two files.
pub struct Picture {
    /// Their names but for the endings.
    stem: &'static str,
    draw: Draw,
}

impl Picture {
    /// From a figure's own method.
    pub fn new(
        stem: &'static str,
        draw: impl Fn(figures::Format) -> Result<Vec<u8>, FigureError> + 'static,
    ) -> Self {
        Self { stem, draw: Box::new(draw) }
    }
}

/// The JSON report: the version of its form, the value, its units.
///
/// # Errors
/// The value cannot be serialised.
pub fn json<R: Report>(report: &R) -> Result<Value, Error> {
    let mut all = Map::from_iter([("schema".to_owned(), SCHEMA.into())]);
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

/// Names of the files that [`Rendered::write`] writes, in no order.
///
/// # Errors
/// One cannot be made.
pub fn file_names<R: Report>(report: &R, case: &Case) -> Result<Vec<String>, Error> {
    let mut names = vec![format!("{}.json", R::NAME), format!("{}.txt", R::NAME)];
    for Picture { stem, .. } in report.pictures(case)? {
        names.extend([format!("{stem}.png"), format!("{stem}.svg")]);
    }
    names.extend(report.tables(case)?.into_iter().map(|(name, _)| name.to_owned()));
    Ok(names)
}

/// A report that stands ready to be written.
pub struct Rendered {
    name: &'static str,
    json: String,
    text: String,
    pictures: Vec<Picture>,
    tables: Vec<(&'static str, Vec<u8>)>,
    ends_with_picture: bool,
}

impl Rendered {
    /// All of a report but for the drawing of its pictures.
    ///
    /// # Errors
    /// Something cannot be made.
    pub fn new<R: Report>(report: &R, case: &Case) -> Result<Self, Error> {
        Ok(Self {
            name: R::NAME,
            json: format!("{:#}\n", json(report)?),
            text: report.text(case),
            pictures: report.pictures(case)?,
            tables: report.tables(case)?,
            ends_with_picture: R::ENDS_WITH_PICTURE,
        })
    }

    /// Hands all files over by their names, the JSON report last.
    ///
    /// # Errors
    /// Something cannot be drawn, or is refused.
    pub fn write<E: From<Error>>(
        &self,
        mut put: impl FnMut(&str, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        draw(&self.pictures, &mut put)?;
        for (name, table) in &self.tables {
            put(name, table)?;
        }
        put(&format!("{}.txt", self.name), self.text.as_bytes())?;
        put(&format!("{}.json", self.name), self.json.as_bytes())
    }

    /// The report in words.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The JSON report.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// The file of the picture that a reader is to see first; `None`: the text does not end with one.
    pub fn shown_picture(&self) -> Option<String> {
        let first = self.pictures.first().filter(|_| self.ends_with_picture);
        first.map(|Picture { stem, .. }| format!("{stem}.png"))
    }
}

/// Draws pictures and hands their files over by name.
///
/// # Errors
/// One cannot be drawn, or is refused.
pub fn draw<E: From<Error>>(
    pictures: &[Picture],
    mut put: impl FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<(), E> {
    use figures::Format::{Png, Svg};
    for Picture { stem, draw } in pictures {
        for (format, ending) in [(Png, "png"), (Svg, "svg")] {
            put(&format!("{stem}.{ending}"), &draw(format).map_err(Error::from)?)?;
        }
    }
    Ok(())
}
