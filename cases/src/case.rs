//! A case: reading from a case file and writing as TOML.

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

/// Maximum size of a case file, bytes. Larger files are refused unread, since parsing takes up to 70 times the file
/// size in memory.
pub const MAX_FILE: u64 = 16 << 20;

/// Purpose for which a case is read: any, or a time-domain simulation.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Any,
    InTime,
}

/// A case as stated in its case file, with default values filled in.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of the result folder; by default the file name without extension.
    pub name: String,
    /// Title of the case, one line; may be empty.
    pub title: String,
    /// Kind of model, yield set and numbers; in a case with regions the values common to all regions.
    pub material: Material,
    /// Section `[map]`: the sweep of `wellposed map`.
    pub map: Option<Map>,
    /// Section `[compare]`: kinds of model to be compared on the state of the case.
    pub compare: Option<Vec<Kind>>,
    /// Sections of a time-domain simulation of a solid, if present.
    pub dynamics: Option<Dynamics>,
    /// Sections of a time-domain simulation of a flow, if present.
    pub flow: Option<FlowRun>,
    /// Section `[check]`: waves and grids of `wellposed check`, if present.
    pub check: Option<Check>,
    source: Option<PathBuf>,
}

/// Equality of content; positions in the file are ignored.
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

/// Time-domain simulation of a case.
#[derive(Clone, Copy, Debug)]
pub enum InTime<'a> {
    /// Simulation of a solid.
    Solid(&'a Dynamics),
    /// Simulation of a flow.
    Flow(&'a FlowRun),
}

impl Case {
    /// Reads a case file; `--set` options (`key=value`) override its values.
    ///
    /// # Errors
    /// The file or an option is invalid; the error gives position, key, value found and values allowed.
    pub fn load(path: &Path, sets: &[String]) -> Result<Self, CaseError> {
        Self::load_for(path, sets, Use::Any)
    }

    /// Reads the case file of a time-domain simulation.
    ///
    /// # Errors
    /// The case has no section `[grid]` (reported first), or an error of [`load`](Self::load).
    pub fn load_in_time(path: &Path, sets: &[String]) -> Result<Self, CaseError> {
        Self::load_for(path, sets, Use::InTime)
    }

    fn load_for(path: &Path, sets: &[String], purpose: Use) -> Result<Self, CaseError> {
        let unreadable = |cause: String| CaseError::Unreadable { path: path.to_owned(), cause };
        let mut bytes = Vec::new();
        std::fs::File::open(path)
            .and_then(|file| file.take(MAX_FILE + 1).read_to_end(&mut bytes))
            .map_err(|error| unreadable(error.to_string()))?;
        if bytes.len() as u64 > MAX_FILE {
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

    /// Parses the text of a case file with the name `file`; `--set` options override its values.
    ///
    /// # Errors
    /// The text or an option is invalid; the error gives position, key, value found and values allowed.
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

    /// Returns the path of the file from which the case was loaded.
    pub fn source(&self) -> Option<&Path> {
        self.source.as_deref()
    }

    /// Returns the paths of the input files named by the case: sample tables and initial-field archives.
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

    /// Returns the kind of model and the yield set of the case.
    pub fn medium(&self) -> Medium {
        self.material.medium()
    }

    /// Returns the value of the number `name`; `None` if the case has no such number.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.material.get(name)
    }

    /// Sets the number `parameter`, as a map sweep does.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        self.material.set(parameter, value);
    }

    /// Adds the position in the case file to an input error of a model.
    pub fn locate(&self, error: InputError) -> CaseError {
        self.material.locate(error)
    }

    /// Returns the section `[map]`.
    ///
    /// # Errors
    /// The case has no section `[map]`; the message says how to add one.
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

    /// Adds the position to an input error of a model at a point of the map. The value of a swept number is located at
    /// its axis in `[map]`, not at its own key.
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

    /// Returns the time-domain simulation of the case.
    ///
    /// # Errors
    /// The case has no section `[grid]`; the message says how to add one.
    pub fn in_time(&self) -> Result<InTime<'_>, CaseError> {
        let flow = || self.flow.as_ref().map(InTime::Flow);
        let found = self.dynamics.as_ref().map(InTime::Solid).or_else(flow);
        found.ok_or_else(|| no_grid(&self.material.places, self.material.kind))
    }

    /// Returns the case without plot options; cases equal after this call have equal results.
    pub fn without_plot_options(&self) -> Self {
        let mut case = self.clone();
        if let Some(dynamics) = &mut case.dynamics {
            (dynamics.output.picture, dynamics.output.contours) = (Picture::default(), None);
        }
        if let Some(flow) = &mut case.flow {
            (flow.output.picture, flow.output.contours) = (None, None);
        }
        case
    }

    /// Formats the resolved case as TOML: all values used by its kind of model, defaults included. Numbers have the
    /// shortest form that parses to the same double.
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

/// Returns the error of a missing section `[grid]`, with the remedy for the kind of model.
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
