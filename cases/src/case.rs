//! A case: read from its file, and as the problems of its models.

use super::check::{self, Check};
use super::dynamics::{Dynamics, Grid, Picture, TimeFunction};
use super::entries::{Entries, kind};
use super::error::{CaseError, Place};
use super::flat;
use super::flow::{FlowRun, Initial};
use super::forms::{FORMS, is_run_in_time};
use super::keys::Parameter;
use super::kind::{Kind, Medium};
use super::map::{Map, Sweep};
use super::material::{Material, check_dimensions, provide_dimensions};
use super::place::Places;
use super::schema::Scope;
use super::section::Section;
use super::value::Value;
use models::InputError;
use models::flow::RotationKind;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest case file, bytes. A larger one is refused before it is read: parsing takes up to 70 times its size in memory.
pub const LARGEST_FILE: u64 = 16 << 20;

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
    /// Kind of model, yield set and numbers; of a case with regions those that regions have in common.
    pub material: Material,
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
    source: Option<PathBuf>,
}

/// Equal content; where it stands in the file does not matter.
impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && self.title == other.title
            && self.material == other.material
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
            return Err(unreadable("larger than 16 MiB, so no case file".into()));
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
        let mut entries = Entries::read(text, file, sets, &FORMS)?;
        let kind = kind(entries.text("model.kind")?, "model.kind", &entries.places)?;
        let is_in_time = is_run_in_time(&entries.structured(Scope::default()), kind)?;
        if !is_in_time && purpose == Use::InTime {
            return Err(no_grid(&entries.places, kind));
        }
        let rotation = kind.rotation_in_time().filter(|_| is_in_time);
        let is_solid = is_in_time && rotation.is_none();
        let read_grid = || Grid::read(&entries.structured(Scope::default()));
        let grid = is_solid.then(read_grid).transpose()?;
        if let Some(grid) = &grid {
            provide_dimensions(&mut entries, kind, grid.dimensions());
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
        let check = check::read(&entries.structured(Scope::default()))?;
        let material = Material { kind, yields, active, numbers, places: entries.places.clone() };
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        let scope = |dimensions: usize| Scope {
            kind: Some(kind),
            dimensions: Some(dimensions),
            axes: Vec::new(),
        };
        let read_dynamics = |grid: Grid| {
            let d = grid.dimensions();
            check_dimensions(&entries.places, kind, material.numbers.dimensions, d)?;
            let own = |region: &Section| material.of_region(&entries, region, d);
            Dynamics::read(&entries.structured(scope(d)), grid, &material, own, folder)
        };
        let dynamics = grid.map(read_dynamics).transpose()?;
        let read_flow = |own| FlowRun::read(&entries.structured(scope(2)), own, folder);
        let flow = rotation.map(read_flow).transpose()?;
        let source = None;
        Ok(Self { name, title, material, map, compare, dynamics, flow, check, source })
    }

    /// The file that the case was loaded from.
    pub fn source(&self) -> Option<&Path> {
        self.source.as_deref()
    }

    /// Other files that the case was read from, and that a run of it begins with.
    pub fn input_files(&self) -> impl Iterator<Item = &Path> {
        let parts = self.flow.iter().flat_map(|flow| &flow.initial);
        let archives = parts.filter_map(|part| match part {
            Initial::File { path, .. } => Some(Path::new(path)),
            _ => None,
        });
        let tables = self.dynamics.iter().flat_map(Dynamics::times).filter_map(|time| match time {
            TimeFunction::Table(samples) => samples.source(),
            _ => None,
        });
        archives.chain(tables)
    }

    /// Kind of model and yield set.
    pub fn medium(&self) -> Medium {
        self.material.medium()
    }

    /// The number of that name, if the case has one.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.material.get(name)
    }

    /// Sets a number, as a sweep does.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        self.material.set(parameter, value);
    }

    /// Adds the place to an error that a model found.
    pub fn locate(&self, error: InputError) -> CaseError {
        self.material.locate(error)
    }

    /// The map that the case asks for.
    ///
    /// # Errors
    /// That the case has none, and how to add one.
    pub fn required_map(&self) -> Result<&Map, CaseError> {
        self.map.as_ref().ok_or_else(|| {
            let axis =
                "{ parameter = \"model.friction_angle_deg\", from = 5, to = 60, points = 56 }";
            self.material.places.error(
                "map",
                "missing",
                format!("add a section [map] with x = {axis} and y"),
            )
        })
    }

    /// Adds the place to an error that a model found at a point of the map: a number that is swept
    /// has its value from `[map]`, not from where its key stands.
    pub fn locate_in_map(&self, error: InputError) -> CaseError {
        let axes = self.map.iter().flat_map(|map| [("map.x", &map.x), ("map.y", &map.y)]);
        let key = self.material.key_of(error.input);
        let swept = |(_, sweep): &(&str, &Sweep)| sweep.parameter.key().name == key;
        match axes.into_iter().find(swept) {
            Some((axis, _)) => CaseError::Key {
                place: self.material.places.of_axis(axis),
                key: key.to_owned(),
                found: format!("found {}, a value of the sweep {axis}", error.found),
                allowed: error.allowed,
            },
            None => self.locate(error),
        }
    }

    /// How the case is run in time.
    ///
    /// # Errors
    /// That the case does not say, and how to.
    pub fn in_time(&self) -> Result<InTime<'_>, CaseError> {
        let flow = || self.flow.as_ref().map(InTime::Flow);
        let found = self.dynamics.as_ref().map(InTime::Solid).or_else(flow);
        found.ok_or_else(|| no_grid(&self.material.places, self.material.kind))
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

    /// The resolved case as TOML: every value that the kind uses, defaults included, numbers in
    /// their shortest form that reads back to the same double.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        if !self.title.is_empty() {
            let _ = writeln!(text, "title = {}", toml::Value::from(self.title.as_str()));
        }
        let _ = writeln!(text, "name = {}", toml::Value::from(self.name.as_str()));
        let mut section = "";
        let compared = self.compare.as_deref().unwrap_or_default();
        for (key, value) in self.material.values(compared) {
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
