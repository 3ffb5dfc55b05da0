//! What a run needs to go on: state, and what its growing files held.

use crate::output::{Growing, OutputError, ResultFolder, not_written};
use dynamics::flow;
use dynamics::real::Real;
use dynamics::split::Snapshot;
use files::append::Written;
use files::sealed::{Problem, read_sealed, write_sealed};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// A checkpoint of a solid or a flow.
pub(super) struct Checkpoint {
    pub(super) steps: usize,
    /// The time that these led to, s.
    pub(super) time: f64,
    /// What stands in the tables.
    pub(super) tables: Vec<Written>,
    /// Energy at the beginning, J or J/m³.
    pub(super) start: f64,
    /// The state, in parts by name.
    state: BTreeMap<String, Vec<u8>>,
}

/// The numbers of a section, if it is one of whole numbers.
fn doubles(bytes: &[u8]) -> Option<Vec<f64>> {
    let (numbers, []) = bytes.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

fn bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Parts under a name with their numbers.
fn numbered(
    name: &str,
    parts: impl Iterator<Item = Vec<u8>>,
) -> impl Iterator<Item = (String, Vec<u8>)> {
    parts.enumerate().map(move |(index, part)| (format!("{name}{index}"), part))
}

impl Checkpoint {
    /// Of a solid's state.
    pub(super) fn of_solid<T: Real>(
        snapshot: &Snapshot<T>,
        time: f64,
        tables: Vec<Written>,
        start: f64,
    ) -> Self {
        let narrow = |values: &Vec<T>| values.iter().flat_map(|value| value.bytes()).collect();
        let fields = numbered("field", snapshot.fields.iter().map(narrow));
        let sums = numbered("sums", snapshot.sums.iter().map(|sums| bytes(sums)));
        let totals = ("totals".to_owned(), bytes(snapshot.totals.as_flattened()));
        let state = [totals].into_iter().chain(fields).chain(sums).collect();
        Self { steps: snapshot.steps, time, tables, start, state }
    }

    /// Of a flow's state.
    pub(super) fn of_flow(
        snapshot: &flow::Snapshot,
        time: f64,
        tables: Vec<Written>,
        start: f64,
    ) -> Self {
        let state = numbered("part", snapshot.parts.iter().map(|part| bytes(part))).collect();
        Self { steps: snapshot.steps, time, tables, start, state }
    }

    /// The parts of that name.
    fn parts(&self, name: &str) -> impl Iterator<Item = &Vec<u8>> {
        (0..).map_while(move |index| self.state.get(&format!("{name}{index}")))
    }

    /// The state of a solid; `None` where the numbers are not of this kind.
    pub(super) fn solid<T: Real>(&self) -> Option<Snapshot<T>> {
        let totals = doubles(self.state.get("totals")?)?;
        let (totals, []) = totals.as_chunks::<12>() else { return None };
        Some(Snapshot {
            steps: self.steps,
            fields: self.parts("field").map(|field| T::from_bytes(field)).collect::<Option<_>>()?,
            totals: totals.to_vec(),
            sums: self.parts("sums").map(|sums| doubles(sums)).collect::<Option<_>>()?,
        })
    }

    /// The state of a flow; `None` where the numbers are not whole.
    pub(super) fn flow(&self) -> Option<flow::Snapshot> {
        let parts = self.parts("part").map(|part| doubles(part)).collect::<Option<_>>()?;
        Some(flow::Snapshot { steps: self.steps, parts })
    }

    /// Writes it, whole or not at all.
    pub(super) fn write(&self, folder: &ResultFolder) -> Result<(), OutputError> {
        let tables: Vec<[u64; 2]> =
            self.tables.iter().map(|table| [table.length, table.checksum.into()]).collect();
        let about = json!({
            "steps": self.steps,
            "time": self.time.to_bits(),
            "tables": tables,
            "start": self.start.to_bits(),
        })
        .to_string();
        let mut sections: Vec<(&str, &[u8])> =
            vec![("case", folder.undrawn().as_bytes()), ("about", about.as_bytes())];
        sections.extend(self.state.iter().map(|(name, part)| (name.as_str(), part.as_slice())));
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
        let table = |table: &Value| {
            let checksum = number(&table[1]).and_then(|own| u32::try_from(own).ok());
            Some(Written { length: number(&table[0])?, checksum: checksum? })
        };
        let tables = about["tables"].as_array().and_then(|all| all.iter().map(table).collect());
        let [steps, time, start] = ["steps", "time", "start"].map(|name| number(&about[name]));
        let (Some(tables), Some(steps), Some(time), Some(start)) = (tables, steps, time, start)
        else {
            return Err(odd());
        };
        Ok(Some(Self {
            steps: usize::try_from(steps).map_err(|_| odd())?,
            time: f64::from_bits(time),
            tables,
            start: f64::from_bits(start),
            state: sections,
        }))
    }

    /// That its state is none of this run's.
    pub(super) fn refused(folder: &ResultFolder) -> OutputError {
        let path = folder.growing(Growing::Checkpoint);
        OutputError::unusable(&path, "its fields are not those of the case")
    }
}
