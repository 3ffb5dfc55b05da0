//! Keys of `[output]` that limit the size of snapshots.

use super::component::{StateComponent, component_names, components_in_scope};
use super::output::{PlottedQuantity, integral_names};
use super::time::{self, Precision};
use crate::error::CaseError;
use crate::schema::{KeySchema, ValueType};
use crate::section::{SectionReader, TableWriter};
use models::solid::waves::SolidField;

/// Largest number of digits, at which doubles are hardly rounded.
const MAX_DIGITS: usize = 15;

/// Key `snapshot_fields`.
pub(super) const FIELDS_KEY: KeySchema = KeySchema::new_optional(
    "snapshot_fields",
    ValueType::AnyOf(|scope| {
        let mut names = component_names(&components_in_scope(scope));
        names.extend(component_names(&StateComponent::CONTACT_COMPONENTS));
        names.push("porosity".to_owned());
        names.extend(integral_names(scope));
        names.push("dissipation".to_owned());
        names
    }),
    "",
    "[\"v1\", \"v2\"]",
    "fields in snapshots, among them those of the picture; default: all",
);

/// Key `snapshot_precision`.
pub(super) const PRECISION_KEY: KeySchema = KeySchema::new_with_default(
    "snapshot_precision",
    ValueType::OneOf(|_| time::variant_names(Precision::ALL, Precision::name)),
    "",
    "\"f64\"",
    "numbers in snapshots: f64 (doubles) or f32, which are compressed",
);

/// Key `snapshot_digits`.
pub(super) const DIGITS_KEY: KeySchema = KeySchema::new_optional(
    "snapshot_digits",
    ValueType::WholeNumber(1),
    "",
    "4",
    "significant decimal digits of the numbers in snapshots, from 1 to 15, which are compressed; default: all",
);

/// Content of the snapshots of a solid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SnapshotOptions {
    /// Names of the fields; `None` for all.
    pub field_names: Option<Vec<String>>,
    /// Precision of the numbers.
    pub precision: Precision,
    /// Number of significant decimal digits; `None` for all.
    pub digits: Option<usize>,
}

impl SnapshotOptions {
    /// Whether snapshots have the field of this name.
    pub fn contains(&self, name: &str) -> bool {
        self.field_names.as_ref().is_none_or(|names| names.iter().any(|own| own == name))
    }

    /// Adds the keys that differ from their defaults.
    pub(super) fn append_to(&self, mut table: TableWriter) -> TableWriter {
        if let Some(names) = &self.field_names {
            table = table.with_text_list(FIELDS_KEY.name, names);
        }
        if self.precision != Precision::default() {
            table = table.with_text(PRECISION_KEY.name, self.precision.name());
        }
        match self.digits {
            Some(digits) => table.with_number(DIGITS_KEY.name, digits),
            None => table,
        }
    }

    /// Reads the keys; `names`: fields that snapshots of the case can have, `picture`: quantity of the animation.
    pub(super) fn read(
        section: &SectionReader,
        names: &[String],
        (picture, dimensions): (PlottedQuantity, usize),
    ) -> Result<Self, CaseError> {
        let find = |name: &str| names.iter().find(|own| *own == name).cloned();
        let field_names: Option<Vec<String>> =
            section.read_distinct_list(FIELDS_KEY.name, names, find)?;
        let precision = section
            .read_optional_choice(PRECISION_KEY.name, Precision::ALL, Precision::name)?
            .unwrap_or_default();
        let digits: Option<usize> = section.read_optional(DIGITS_KEY.name)?;
        if let Some(found) = digits.filter(|digits| *digits > MAX_DIGITS) {
            let allowed = format!("expected a whole number from 1 to {MAX_DIGITS}");
            return Err(section.key_error(DIGITS_KEY.name, format!("found {found}"), allowed));
        }
        let own = Self { field_names, precision, digits };
        let shown: Vec<String> = match picture {
            PlottedQuantity::Speed => (0..dimensions)
                .map(|axis| StateComponent(SolidField::Velocity(axis)).to_string())
                .collect(),
            PlottedQuantity::Face(_) => Vec::new(),
            other => vec![other.name()],
        };
        match shown.iter().find(|name| !own.contains(name)) {
            Some(missing) => {
                let found = format!("without {missing}, which the animation shows");
                let allowed = "add it, or choose another picture";
                Err(section.key_error(FIELDS_KEY.name, found, allowed))
            }
            None => Ok(own),
        }
    }
}
