//! A case: read from its file, and as the problems of its models.

use super::NO_YIELD;
use super::check::{self, Check};
use super::dynamics::{self, Dynamics, Grid, Picture};
use super::entries::{Entries, kind};
use super::error::{CaseError, Place};
use super::flat;
use super::flow::FlowRun;
use super::keys::Parameter;
use super::keys::{Key, keys};
use super::kind::{Kind, Medium, Yield, names};
use super::map::Map;
use super::numbers::Numbers;
use super::place::Places;
use super::section::Section;
use super::value::Value;
use models::InputError;
use models::flow::RotationKind;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest case file, bytes: more is no case, and is not read into memory. Tables of loads take room.
const LARGEST_FILE: u64 = 1 << 28;

/// What a case is read for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Any,
    InTime,
}

/// A case as its file states it, with defaults filled in.
#[derive(Clone, Debug)]
pub struct Case {
    /// Names the folder of results; by default the stem of the file's name.
    pub name: String,
    /// One line that says what the case is; may be empty.
    pub title: String,
    /// Kind of model.
    pub kind: Kind,
    /// The yield set of a solid that has one.
    pub yields: Option<Yield>,
    /// The conditions of an interlayer set that hold with equality, by their places in
    /// [`Medium::condition_names`]; absent: as the stress decides.
    pub active: Option<Vec<usize>>,
    /// The numbers; SI units, angles in degrees.
    pub numbers: Numbers,
    /// What `wellposed map` sweeps.
    pub map: Option<Map>,
    /// Kinds of model to compare on this state.
    pub compare: Option<Vec<Kind>>,
    /// How a solid is run in time, if the case says so.
    pub dynamics: Option<Dynamics>,
    /// How a flow is run in time, if the case says so.
    pub flow: Option<FlowRun>,
    /// What `wellposed check` sends, if the case says so.
    pub check: Option<Check>,
    pub(super) places: Places,
    source: Option<PathBuf>,
}

/// Equal content; where it stands in the file does not matter.
impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && self.title == other.title
            && self.medium() == other.medium()
            && self.active == other.active
            && self.numbers == other.numbers
            && self.map == other.map
            && self.compare == other.compare
            && self.dynamics == other.dynamics
            && self.flow == other.flow
            && self.check == other.check
    }
}

/// How a case is run in time.
#[derive(Clone, Copy, Debug)]
pub enum InTime<'a> {
    /// As a solid.
    Solid(&'a Dynamics),
    /// As a flow.
    Flow(&'a FlowRun),
}

impl Case {
    /// Reads a case file, with `--set` options (`key=value`) over it.
    ///
    /// # Errors
    /// What is wrong, where, and what is allowed.
    pub fn load(path: &Path, sets: &[String]) -> Result<Self, CaseError> {
        Self::load_for(path, sets, Use::Any)
    }

    /// Reads the file of a case that is to be run in time.
    ///
    /// # Errors
    /// First of all that the case does not say how it is run in time; else as [`load`](Self::load).
    pub fn load_in_time(path: &Path, sets: &[String]) -> Result<Self, CaseError> {
        Self::load_for(path, sets, Use::InTime)
    }

    fn load_for(path: &Path, sets: &[String], purpose: Use) -> Result<Self, CaseError> {
        let unreadable = |cause: String| CaseError::Unreadable { path: path.to_owned(), cause };
        let mut bytes = Vec::new();
        std::fs::File::open(path)
            .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes))
            .map_err(|error| unreadable(error.to_string()))?;
        if bytes.len() as u64 > LARGEST_FILE {
            return Err(unreadable("larger than 256 MiB, so no case file".into()));
        }
        let file = path.display().to_string();
        match std::str::from_utf8(&bytes) {
            Ok(text) => {
                let case = Self::parse_for(text, &file, sets, purpose)?;
                Ok(Self { source: Some(path.to_owned()), ..case })
            }
            Err(error) => {
                let before = &bytes[..error.valid_up_to()];
                let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
                let cause = "a byte that is not UTF-8 text".to_owned();
                Err(CaseError::Syntax { place: Place::Line { file, line }, cause })
            }
        }
    }

    /// Reads the text of a case file called `file`, with `--set` options over it.
    ///
    /// # Errors
    /// What is wrong, where, and what is allowed.
    pub fn parse(text: &str, file: &str, sets: &[String]) -> Result<Self, CaseError> {
        Self::parse_for(text, file, sets, Use::Any)
    }

    fn parse_for(text: &str, file: &str, sets: &[String], purpose: Use) -> Result<Self, CaseError> {
        let mut entries = Entries::read(text, file, sets)?;
        let kind = kind(entries.text("model.kind")?, "model.kind", &entries.places)?;
        let is_in_time = entries.is_run_in_time(kind)?;
        if !is_in_time && purpose == Use::InTime {
            return Err(no_grid(&entries.places, kind));
        }
        let rotation = kind.rotation_in_time().filter(|_| is_in_time);
        let is_solid = is_in_time && rotation.is_none();
        let grid = is_solid.then(|| Grid::read(&entries)).transpose()?;
        if let Some(grid) = &grid {
            dynamics::provide_dimensions(&mut entries, kind, grid);
        }
        let compare = flat::compare(&entries)?;
        let kinds: Vec<Kind> =
            [kind].into_iter().chain(compare.iter().flatten().copied()).collect();
        let yields = flat::yield_set(&entries, kind, &[])?;
        let media: Vec<Medium> = kinds.iter().map(|&kind| Medium { kind, yields }).collect();
        let numbers = flat::numbers(&entries, &media)?;
        let active = flat::active(&entries, media[0])?;
        let map = Map::read(&entries, media[0], &numbers, active.is_some())?;
        let title = match entries.get("title") {
            Some(Value::Text(title)) => title.clone(),
            _ => String::new(),
        };
        let name = flat::name(&entries, file)?;
        let check = check::read(&entries)?;
        let places = entries.places.clone();
        let (dynamics, flow, source) = (None, None, None);
        let case = Self {
            name,
            title,
            kind,
            yields,
            active,
            numbers,
            map,
            compare,
            dynamics,
            flow,
            check,
            places,
            source,
        };
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        let dynamics =
            grid.map(|grid| Dynamics::read(grid, &case, &entries, folder)).transpose()?;
        let flow = rotation.map(|own| FlowRun::read(kind, own, &entries, folder)).transpose()?;
        Ok(Self { dynamics, flow, ..case })
    }

    /// The case of a region: this one but for the kind, yield set and numbers that the region has
    /// of its own.
    pub(super) fn of_region(
        &self,
        entries: &Entries,
        region: &Section,
        grid: &Grid,
    ) -> Result<Self, CaseError> {
        const KIND: &str = "model.kind";
        let mut entries = entries.of_region(region)?;
        let kind = kind(entries.text(KIND)?, KIND, &entries.places)?;
        let Kind::Solid(_) = kind else {
            let allowed = format!("solids alone: {}", names(&Kind::solids()));
            return Err(entries.places.error(
                KIND,
                format!("found {}, a flow", kind.name()),
                allowed,
            ));
        };
        if let Some(set) = self.yields.filter(|set| !kind.yield_sets().contains(set))
            && entries.is_inherited("yield.kind")
        {
            let names: Vec<&str> = kind.yield_sets().iter().map(|set| set.name).collect();
            return Err(entries.places.error(
                KIND,
                format!("found {}, which cannot yield by {}", kind.name(), set.name),
                format!("add yield = {{ kind = ... }} with one of none, {}", names.join(", ")),
            ));
        }
        dynamics::provide_dimensions(&mut entries, kind, grid);
        let yields = flat::yield_set(&entries, kind, &[NO_YIELD])?;
        let medium = Medium { kind, yields };
        if kind != self.kind {
            // What the case's own kind uses and this one does not was not meant for it.
            entries.keep_inherited(|name| {
                Key::find(name).is_some_and(|key| key.is_used_by(medium) && key.field.is_kept())
            });
        }
        let mut numbers = flat::numbers(&entries, &[medium])?;
        dynamics::check_dimensions(&entries.places, kind, numbers.dimensions, grid)?;
        let active = flat::active(&entries, medium)?;
        (numbers.stress, numbers.wave) = (self.numbers.stress, self.numbers.wave);
        for key in keys().iter().filter(|key| !key.is_used_by(medium)) {
            key.clear(&mut numbers);
        }
        let (map, compare, dynamics, places) = (None, None, None, entries.places);
        Ok(Self { kind, yields, active, numbers, map, compare, dynamics, places, ..self.clone() })
    }

    /// Kind of model and yield set.
    pub fn medium(&self) -> Medium {
        Medium { kind: self.kind, yields: self.yields }
    }

    /// The file that the case was loaded from.
    pub fn source(&self) -> Option<&Path> {
        self.source.as_deref()
    }

    /// The number of that name, if the case has one.
    pub fn get(&self, name: &str) -> Option<f64> {
        Parameter::find(name)?.get(&self.numbers)
    }

    /// Sets a number, as a sweep does.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        parameter.set(&mut self.numbers, value);
    }

    /// Adds the place to an error that a model found.
    pub fn locate(&self, error: InputError) -> CaseError {
        let key = self.key_of(error.input);
        self.places.error(key, format!("found {}", error.found), error.allowed)
    }

    /// The key of an input of the case's model, yield set or state; a name that is none of these
    /// stands for itself.
    pub(super) fn key_of(&self, input: &'static str) -> &'static str {
        const SECTIONS: [&str; 4] = ["model", "background", "yield", "stress"];
        let medium = self.medium();
        let is_input = |key: &&Key| {
            let (section, name) = key.split();
            let name = name.strip_suffix("_deg").unwrap_or(name);
            SECTIONS.contains(&section) && name == input
        };
        let all = || keys().iter().filter(is_input);
        let found = all().find(|key| key.is_used_by(medium)).or_else(|| all().next());
        found.map_or(input, |key| key.name)
    }

    /// How the case is run in time.
    ///
    /// # Errors
    /// That the case does not say, and how to.
    pub fn in_time(&self) -> Result<InTime<'_>, CaseError> {
        let flow = || self.flow.as_ref().map(InTime::Flow);
        let found = self.dynamics.as_ref().map(InTime::Solid).or_else(flow);
        found.ok_or_else(|| no_grid(&self.places, self.kind))
    }

    /// The case without what decides over its pictures alone: where this is the same, results are.
    pub fn undrawn(&self) -> Self {
        let mut case = self.clone();
        if let Some(dynamics) = &mut case.dynamics {
            (dynamics.output.picture, dynamics.output.contours) = (Picture::default(), None);
        }
        if let Some(flow) = &mut case.flow {
            (flow.output.picture, flow.output.contours) = (None, None);
        }
        case
    }

    /// The keys that the case uses and their values, without those of `[map]` and `[compare]`.
    pub(super) fn values(&self) -> impl Iterator<Item = (&'static Key, Value)> {
        keys().iter().filter_map(|key| {
            let value = match key.name {
                "model.kind" => Some(Value::Text(self.kind.name().to_owned())),
                "yield.kind" => self.yields.map(|set| Value::Text(set.name.to_owned())),
                "yield.active" => self.active.as_ref().map(|active| {
                    let names = self.medium().condition_names();
                    Value::Texts(active.iter().map(|&index| names[index].to_owned()).collect())
                }),
                // Of the two ways to say what is active.
                name if name.starts_with("stress.") && self.active.is_some() => None,
                _ if self.media().any(|medium| key.is_used_by(medium)) => {
                    key.field.load(&self.numbers)
                }
                _ => None,
            };
            value.map(|value| (key, value))
        })
    }

    /// The medium, and those to compare.
    fn media(&self) -> impl Iterator<Item = Medium> {
        let compared = self.compare.iter().flatten().map(|&kind| kind.into());
        [self.medium()].into_iter().chain(compared)
    }

    /// The resolved case as TOML: every value that the kind uses, defaults included, numbers in
    /// their shortest form that reads back to the same double.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        if !self.title.is_empty() {
            let _ = writeln!(text, "title = {}", toml::Value::from(self.title.as_str()));
        }
        let _ = writeln!(text, "name = {}", toml::Value::from(self.name.as_str()));
        let mut section = "";
        for (key, value) in self.values() {
            let (own, name) = key.split();
            if own != section {
                let _ = write!(text, "\n[{own}]\n");
                section = own;
            }
            let _ = writeln!(text, "{name} = {value}");
        }
        if let Some(map) = &self.map {
            let _ = write!(text, "\n[map]\nx = {}\ny = {}\n", map.x, map.y);
        }
        if let Some(kinds) = &self.compare {
            let names = kinds.iter().map(|kind| kind.name().to_owned()).collect();
            let _ = write!(text, "\n[compare]\nkinds = {}\n", Value::Texts(names));
        }
        if let Some(dynamics) = &self.dynamics {
            text.push_str(&dynamics.to_toml());
        }
        if let Some(flow) = &self.flow {
            text.push_str(&flow.to_toml());
        }
        if let Some(check) = &self.check {
            text.push_str(&check.to_toml());
        }
        text
    }
}

/// That a case does not say how it is run in time, and how to.
fn no_grid(places: &Places, kind: Kind) -> CaseError {
    match kind {
        Kind::Flow(flow) if flow.rotation() == RotationKind::Free => {
            let found = format!("found {}", kind.name());
            let allowed = "another model: nothing determines the spin of this one, so that it \
                           cannot be run in time";
            places.error("model.kind", found, allowed)
        }
        Kind::Flow(_) => {
            let allowed = "add a section [grid] with cells = [64, 64] and length = 0.1, [time] with \
                           duration, and [[initial]]";
            places.error("grid", "missing", allowed)
        }
        Kind::Solid(_) => {
            let allowed = "add a section [grid] with cells = [200, 200] and spacing = 1.0, and [time] \
                           with duration";
            places.error("grid", "missing", allowed)
        }
    }
}
