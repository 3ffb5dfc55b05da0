//! What a run needs to go on: state, and what its growing files held.

use crate::output::{Growing, OutputError, ResultFolder, not_written};
use dynamics::real::Real;
use dynamics::split::Snapshot;
use files::append::Written;
use files::sealed::{Problem, read_sealed, write_sealed};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// A checkpoint of any precision.
pub(super) struct Checkpoint {
    pub(super) steps: usize,
    /// What stands in the receivers' and the ledger's file.
    pub(super) tables: [Written; 2],
    /// Energy at the beginning, J.
    pub(super) start: f64,
    fields: Vec<Vec<u8>>,
    totals: Vec<u8>,
    sums: Vec<Vec<u8>>,
}

/// The numbers of a section, if it is one of whole numbers.
fn doubles(bytes: &[u8]) -> Option<Vec<f64>> {
    let (numbers, []) = bytes.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

fn bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

impl Checkpoint {
    /// Of a run's state.
    pub(super) fn new<T: Real>(snapshot: &Snapshot<T>, tables: [Written; 2], start: f64) -> Self {
        let narrow = |values: &Vec<T>| values.iter().flat_map(|value| value.bytes()).collect();
        Self {
            steps: snapshot.steps,
            tables,
            start,
            fields: snapshot.fields.iter().map(narrow).collect(),
            totals: bytes(snapshot.totals.as_flattened()),
            sums: snapshot.sums.iter().map(|sums| bytes(sums)).collect(),
        }
    }

    /// The state; `None` where the numbers are not of this kind.
    pub(super) fn snapshot<T: Real>(&self) -> Option<Snapshot<T>> {
        let totals = doubles(&self.totals)?;
        let (totals, []) = totals.as_chunks::<14>() else { return None };
        Some(Snapshot {
            steps: self.steps,
            fields: self.fields.iter().map(|field| T::from_bytes(field)).collect::<Option<_>>()?,
            totals: totals.to_vec(),
            sums: self.sums.iter().map(|sums| doubles(sums)).collect::<Option<_>>()?,
        })
    }

    /// Writes it, whole or not at all.
    pub(super) fn write(&self, folder: &ResultFolder) -> Result<(), OutputError> {
        let about = json!({
            "steps": self.steps,
            "tables": self.tables.map(|table| [table.length, table.checksum.into()]),
            "start": self.start.to_bits(),
        })
        .to_string();
        let mut sections: Vec<(&str, &[u8])> =
            vec![("case", folder.undrawn().as_bytes()), ("about", about.as_bytes())];
        sections.push(("totals", &self.totals));
        let numbered = |name: &str, count: usize| -> Vec<String> {
            (0..count).map(|index| format!("{name}{index}")).collect()
        };
        let names = [numbered("field", self.fields.len()), numbered("sums", self.sums.len())];
        let contents = [&self.fields, &self.sums];
        for (names, contents) in names.iter().zip(contents) {
            let named = names.iter().zip(contents);
            sections.extend(named.map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
        }
        let path = folder.growing(Growing::Checkpoint);
        write_sealed(&path, &sections).map_err(|error| not_written(&path, &error))
    }

    /// The checkpoint of a folder; `None` where there is none: the run had not come so far.
    ///
    /// # Errors
    /// It is damaged, or of another case.
    pub(super) fn read(folder: &ResultFolder) -> Result<Option<Self>, OutputError> {
        let path = folder.growing(Growing::Checkpoint);
        let damaged = |cause: &str| OutputError::unusable(&path, cause);
        let sections = match read_sealed(&path).map_err(|error| error.problem) {
            Err(Problem::Read(error)) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(Problem::Read(error)) => return Err(OutputError::unreadable(&path, &error)),
            Err(problem) => return Err(damaged(&problem.to_string())),
            Ok(sections) => sections,
        };
        let mut sections: BTreeMap<String, Vec<u8>> = sections.into_iter().collect();
        let mut take = |name: &str| sections.remove(name);
        let odd = || damaged("not a checkpoint of this program");
        if take("case").as_deref() != Some(folder.undrawn().as_bytes()) {
            return Err(damaged("a checkpoint of another case"));
        }
        let about: Value =
            take("about").and_then(|own| serde_json::from_slice(&own).ok()).ok_or_else(odd)?;
        let number = |value: &Value| value.as_u64();
        let tables = [0, 1].map(|i| {
            let table = &about["tables"][i];
            let checksum = number(&table[1]).and_then(|own| u32::try_from(own).ok());
            Some(Written { length: number(&table[0])?, checksum: checksum? })
        });
        let ([Some(receivers), Some(ledger)], Some(steps), Some(start), Some(totals)) =
            (tables, number(&about["steps"]), number(&about["start"]), take("totals"))
        else {
            return Err(odd());
        };
        let mut numbered = |name: &str| -> Vec<Vec<u8>> {
            (0..).map_while(|index| take(&format!("{name}{index}"))).collect()
        };
        Ok(Some(Self {
            steps: usize::try_from(steps).map_err(|_| odd())?,
            tables: [receivers, ledger],
            start: f64::from_bits(start),
            fields: numbered("field"),
            totals,
            sums: numbered("sums"),
        }))
    }

    /// That its state is none of this run's.
    pub(super) fn refused(folder: &ResultFolder) -> OutputError {
        let path = folder.growing(Growing::Checkpoint);
        OutputError::unusable(&path, "its fields are not those of the case")
    }
}
