//! Former names of sections and keys. They are read for one more version, with a hint.

use crate::entries::CaseEntries;
use crate::error::{CaseError, SourcePosition};
use crate::schema::{CaseSchemas, TableSchema};
use std::fmt::{Display, Formatter};

/// Hint that a case uses the former name of a section or key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseHint {
    /// Position of the first use.
    pub position: SourcePosition,
    /// Former name, as found; sections with brackets.
    pub former_name: String,
    /// Current name.
    pub current_name: String,
}

impl Display for CaseHint {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { position, former_name, current_name } = self;
        write!(
            formatter,
            "{position}: {former_name} is now {current_name}; the old name is read for one more version"
        )
    }
}

/// Hints of a case, one for each former name.
#[derive(Debug, Default)]
pub(super) struct HintList(pub(super) Vec<CaseHint>);

impl HintList {
    fn add(&mut self, position: SourcePosition, former_name: String, current_name: String) {
        if self.0.iter().all(|hint| hint.former_name != former_name) {
            self.0.push(CaseHint { position, former_name, current_name });
        }
    }

    fn add_section(
        &mut self,
        position: SourcePosition,
        table_schema: &TableSchema,
        former_name: &str,
    ) {
        self.add(position, table_schema.layout.format_header(former_name), table_schema.header());
    }

    /// Adds the hint of a section of the file with a former name.
    ///
    /// # Errors
    /// The file also has the section with its current name.
    pub(super) fn add_section_of_file(
        &mut self,
        position: SourcePosition,
        table_schema: &TableSchema,
        former_name: &str,
        has_current_name: bool,
    ) -> Result<(), CaseError> {
        if has_current_name {
            let [former, current] =
                [table_schema.layout.format_header(former_name), table_schema.header()];
            return Err(CaseError::Key {
                position,
                key: former_name.to_owned(),
                found: format!("found {former} and {current}"),
                allowed: format!("write {current} alone; {former} is its former name"),
            });
        }
        self.add_section(position, table_schema, former_name);
        Ok(())
    }

    /// Returns the key of an option `--set` with current names, and adds hints for former names in it.
    pub(super) fn resolve_option_key(
        &mut self,
        key: &str,
        schemas: &CaseSchemas,
        option: &str,
    ) -> String {
        let position = || SourcePosition::Option(option.to_owned());
        let (section, rest) = key.split_at(key.find(['.', '[']).unwrap_or(key.len()));
        let former = schemas.find_by_former_name(section);
        if let Some(table_schema) = former {
            self.add_section(position(), table_schema, section);
        }
        let Some(table_schema) =
            former.or_else(|| schemas.all().find(|table_schema| table_schema.name == section))
        else {
            return key.to_owned();
        };
        let (index, name) = rest.split_once('.').unwrap_or((rest, ""));
        let renamed = table_schema.renamed_keys().find(|(former_name, _)| *former_name == name);
        match renamed {
            Some((former_name, current_name)) => {
                self.add(position(), former_name.to_owned(), current_name.to_owned());
                format!("{}{index}.{current_name}", table_schema.name)
            }
            None => format!("{}{rest}", table_schema.name),
        }
    }
}

impl CaseEntries<'_> {
    /// Replaces former names of keys in the structured sections by the current names, and adds hints.
    ///
    /// # Errors
    /// A table has a key with both names.
    pub(super) fn rename_former_keys(&mut self) -> Result<(), CaseError> {
        for table_schema in self.schemas.all() {
            for (former_name, current_name) in table_schema.renamed_keys() {
                self.rename_key(table_schema, former_name, current_name)?;
            }
        }
        Ok(())
    }

    fn rename_key(
        &mut self,
        table_schema: &TableSchema,
        former_name: &str,
        current_name: &str,
    ) -> Result<(), CaseError> {
        let Self { structured_sections, positions, hints, .. } = self;
        for (path, table) in structured_sections.tables_of_section(table_schema.name) {
            let [former, current] =
                [former_name, current_name].map(|name| format!("{path}.{name}"));
            if table.node(former_name).is_none() {
                continue;
            }
            if table.node(current_name).is_some() {
                let found = format!("found {former_name} and {current_name}");
                let allowed =
                    format!("write {current_name} alone; {former_name} is its former name");
                return Err(positions.key_error(&former, found, allowed));
            }
            table.rename(former_name, current_name);
            hints.add(positions.locate(&former), former_name.to_owned(), current_name.to_owned());
            positions.rename_key(&former, current);
        }
        Ok(())
    }
}
