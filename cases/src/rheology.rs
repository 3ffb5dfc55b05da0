//! Sections of a rheological scheme: `[rheology]`, the scheme, and `[load_path]`, the path of strain or stress.
//!
//! A case has either these sections or a `[model]`. A scheme is one of the named schemes with its constants, or a tree of
//! named elements. The tree is one line of text, e.g. `"(skeleton - hinge) | (particles - contact)"`, beside a flat list
//! of the elements: nested tables would hide at which level two branches are joined.

mod keys;
mod load_path;

pub use load_path::LoadHistory;

use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::schema::TableSchema;
use crate::section::{SectionReader, TableWriter};
use keys::{ELEMENT_KEY, ELEMENT_SCHEMA, KIND_KEY, TREE_KEY};
use models::rheology::element::{self, Element};
use models::rheology::load_path::{LoadPath, ResponseError};
use models::rheology::named::{NamedSchemeError, find_named_scheme};
use models::rheology::scheme::{NamedElement, RheologicalScheme, SchemeError};

/// Schemas of the sections of a rheological scheme, in the order of writing.
pub(crate) const RHEOLOGY_SCHEMAS: &[&TableSchema] =
    &[&keys::RHEOLOGY_SCHEMA, &load_path::LOAD_PATH_SCHEMA];

/// Kind in case files of a scheme that is given by a tree of elements.
pub const TREE_KIND: &str = "tree";

/// Rheological scheme of a case with its load path.
#[derive(Clone, Debug, PartialEq)]
pub struct RheologyCase {
    /// Name of the scheme, or [`TREE_KIND`].
    pub kind: &'static str,
    /// Name for titles.
    pub title: &'static str,
    /// Constants of a named scheme by name; empty for a tree of elements.
    pub constants: Vec<(&'static str, f64)>,
    /// The scheme.
    pub scheme: RheologicalScheme,
    /// Load path as given.
    pub history: LoadHistory,
    /// Load path.
    pub path: LoadPath,
    positions: KeyPositions,
}

impl RheologyCase {
    /// Returns whether the case describes a rheological scheme.
    pub(crate) fn is_present(root: &SectionReader) -> bool {
        RHEOLOGY_SCHEMAS.iter().any(|table_schema| root.has_key(table_schema.name))
    }

    /// Reads the sections in `root`.
    ///
    /// # Errors
    /// A section or key is missing or unknown, a value is invalid, or the load path does not determine the response of
    /// the scheme.
    pub(crate) fn read(root: &SectionReader) -> Result<Self, CaseError> {
        let section = root.open_required_section(&keys::RHEOLOGY_SCHEMA)?;
        let names = keys::kind_names();
        let name = section.read_required_text(KIND_KEY, &names)?;
        let (kind, title, constants, scheme) = match find_named_scheme(&name) {
            Some(own) => {
                let read = |parameter: &models::common::parameter::Parameter| {
                    Ok((parameter.name, section.read_required::<f64>(parameter.name)?))
                };
                let constants: Vec<(&'static str, f64)> =
                    own.parameters.iter().map(read).collect::<Result<_, CaseError>>()?;
                let values: Vec<f64> = constants.iter().map(|constant| constant.1).collect();
                let scheme = own.build(&values).map_err(|error| match error {
                    NamedSchemeError::Constant(error) => section.key_error(
                        error.input,
                        format!("found {}", error.rejected_value),
                        error.allowed_values,
                    ),
                    NamedSchemeError::Scheme(error) => locate_scheme_error(&section, &[], &error),
                })?;
                (own.name, own.title, constants, scheme)
            }
            None if name == TREE_KIND => {
                let scheme = read_tree(&section)?;
                (TREE_KIND, "rheological scheme", Vec::new(), scheme)
            }
            None => return Err(section.unknown_name_error(KIND_KEY, &name, &names)),
        };
        section.finish()?;
        let (history, path) = load_path::read(root)?;
        let positions = root.positions().clone();
        let own = Self { kind, title, constants, scheme, history, path, positions };
        match own.scheme.check_control(own.path.control()) {
            Ok(()) => Ok(own),
            Err(error) => Err(own.locate_response_error(&error.into())),
        }
    }

    /// Formats the sections as TOML with all values, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let mut section = TableWriter::default().with_text(KIND_KEY, self.kind);
        for (name, value) in &self.constants {
            section = section.with_number(*name, value);
        }
        if self.kind == TREE_KIND {
            let table = |own: &NamedElement| {
                let table = TableWriter::default()
                    .with_text(keys::NAME_KEY, &own.name)
                    .with_text(KIND_KEY, own.element.kind());
                own.element
                    .constants()
                    .into_iter()
                    .fold(table, |table, (name, value)| table.with_number(name, value))
            };
            let tables: Vec<TableWriter> = self.scheme.elements().iter().map(table).collect();
            section = section
                .with_text(TREE_KEY, self.scheme.notation())
                .with_table_list(ELEMENT_KEY, &tables);
        }
        section.to_section_toml(&keys::RHEOLOGY_SCHEMA) + &self.history.to_toml(&self.path)
    }

    /// Adds the position in the case file to the error of a diagram.
    pub fn locate_response_error(&self, error: &ResponseError) -> CaseError {
        match error {
            ResponseError::Scheme(error) => {
                let key = if self.kind == TREE_KIND { TREE_KEY } else { KIND_KEY };
                let found = format!("found {}", self.scheme.notation());
                self.positions.key_error(&format!("rheology.{key}"), found, error.to_string())
            }
            ResponseError::Step { .. } => {
                let key = format!("load_path.{}", self.history.values_key());
                let allowed = "give values that the scheme can reach";
                self.positions.key_error(&key, error.to_string(), allowed)
            }
        }
    }
}

/// Reads a tree of elements.
fn read_tree(section: &SectionReader) -> Result<RheologicalScheme, CaseError> {
    let notation: String = section.read_required(TREE_KEY)?;
    let tables = section.open_list(&ELEMENT_SCHEMA)?;
    if tables.is_empty() {
        let allowed = format!(
            "add a section [[rheology.{ELEMENT_KEY}]] with name, kind and constants for each element of the tree"
        );
        return Err(section.key_error(ELEMENT_KEY, "missing", allowed));
    }
    let mut elements = Vec::with_capacity(tables.len());
    for table in &tables {
        elements.push(read_element(table)?);
    }
    let scheme = RheologicalScheme::parse(elements.clone(), &notation)
        .map_err(|error| locate_scheme_error(section, &elements, &error))?;
    for table in tables {
        table.finish()?;
    }
    Ok(scheme)
}

fn read_element(table: &SectionReader) -> Result<NamedElement, CaseError> {
    let name: String = table.read_required(keys::NAME_KEY)?;
    let kinds = keys::element_kind_names();
    let kind = table.read_required_text(KIND_KEY, &kinds)?;
    let element = match kind.as_str() {
        element::SPRING => Element::Spring { modulus: table.read_required(element::MODULUS.name)? },
        element::DAMPER => {
            Element::Damper { viscosity: table.read_required(element::VISCOSITY.name)? }
        }
        element::HINGE => Element::Hinge {
            compressive_yield_stress: table
                .read_required(element::COMPRESSIVE_YIELD_STRESS.name)?,
            tensile_yield_stress: table.read_required(element::TENSILE_YIELD_STRESS.name)?,
        },
        element::CONTACT => Element::Contact { gap: table.read_or_default(element::GAP.name)? },
        _ => return Err(table.unknown_name_error(KIND_KEY, &kind, &kinds)),
    };
    Ok(NamedElement { name, element })
}

/// Converts the error of a scheme to an error at the key of the tree or of the element.
fn locate_scheme_error(
    section: &SectionReader,
    elements: &[NamedElement],
    error: &SchemeError,
) -> CaseError {
    // The last element of a name: of two elements with the same name the second one.
    let at = |name: &str, key: &str| {
        let index = elements.iter().rposition(|own| own.name == *name);
        format!("{ELEMENT_KEY}[{}].{key}", index.unwrap_or(0))
    };
    match error {
        SchemeError::InvalidName(name)
        | SchemeError::DuplicateName(name)
        | SchemeError::UnusedElement(name) => {
            let found = format!("found '{}'", crate::error::escape(name));
            section.key_error(&at(name, keys::NAME_KEY), found, error.to_string())
        }
        SchemeError::Constant { name, error } => {
            let found = format!("found {}", error.rejected_value);
            section.key_error(&at(name, error.input), found, error.allowed_values.clone())
        }
        error => {
            let found = section.node(TREE_KEY).map_or_else(String::new, |node| node.describe());
            section.key_error(TREE_KEY, format!("found {found}"), error.to_string())
        }
    }
}
