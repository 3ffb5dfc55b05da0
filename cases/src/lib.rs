//! Case files: parsing, `--set`, diagnostics with place and remedy, and conversion to the checked
//! structs of the models.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod check;
pub mod dynamics;
mod error;
pub mod flow;
mod keys;
mod kind;
mod place;
mod read;
mod receivers;
mod section;
mod value;

pub use check::Check;
pub use dynamics::Dynamics;
pub use error::{CaseError, Place};
pub use flow::FlowRun;
pub use keys::{
    BackgroundNumbers, Constants, Key, Numbers, Parameter, Presence, StressNumbers, Wave, keys,
};
pub use kind::{Kind, Medium, NoSuchMedium, Solid, Yield, names};

use dynamics::{Grid, Picture};
use keys::Value;
use models::granular_flow::state::State;
use models::granular_flow::{InputError, Kind as Flow, Model, RotationKind};
use models::registry;
use place::Places;
use read::Entries;
use section::Section;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};
use value::{nearest, suggestion};

/// Largest number of points of a map.
pub const MOST_POINTS: usize = 100_000_000;

/// What stands for a yield set in a region that stays elastic.
const NO_YIELD: &str = "none";

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
    /// The conditions of the yield set that hold with equality, by their places in
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
    places: Places,
    source: Option<PathBuf>,
}

/// The state of a case for another kind of model.
#[derive(Clone, Debug, PartialEq)]
pub struct Converted {
    /// The state, as far as that kind can take it.
    pub case: Case,
    /// The non-coaxiality of the state, degrees, where that kind cannot take it and has 0 instead.
    pub lost_noncoaxiality_deg: Option<f64>,
}

/// An angle in radians. Whole turns are taken off in degrees, where that is exact: the sine of
/// 1e308° means something, that of 1.7e306 rad is noise. Angles below a turn keep every bit.
pub fn radians(degrees: f64) -> f64 {
    (degrees % 360.0).to_radians()
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

/// The two parameters of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Along the horizontal axis.
    pub x: Sweep,
    /// Along the vertical axis.
    pub y: Sweep,
}

/// One axis of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// What is swept.
    pub parameter: Parameter,
    /// First value, in the parameter's unit.
    pub from: f64,
    /// Last value, in the parameter's unit.
    pub to: f64,
    /// Number of values; at least 1, and 2 values differ.
    pub points: usize,
}

impl Sweep {
    /// The value at `index` < `points`, evenly spaced from `from` to `to`.
    ///
    /// One division, last: ends that are whole numbers give whole numbers where they should.
    pub fn value(&self, index: usize) -> f64 {
        if index == 0 || self.points < 2 {
            return self.from;
        }
        let (last, index) = ((self.points - 1) as f64, index as f64);
        let value = (self.from * (last - index) + self.to * index) / last;
        if value.is_finite() {
            value
        } else {
            // The products of huge ends overflow; the ends themselves do not.
            self.from * ((last - index) / last) + self.to * (index / last)
        }
    }
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
        let kind = read::kind(entries.text("model.kind")?, "model.kind", &entries.places)?;
        let is_in_time = entries.is_run_in_time(kind)?;
        if !is_in_time && purpose == Use::InTime {
            return Err(no_grid(&entries.places, kind));
        }
        let rotation = kind.rotation_in_time().filter(|_| is_in_time);
        let is_solid = is_in_time && rotation.is_none();
        let grid = is_solid.then(|| dynamics::read::grid(&entries)).transpose()?;
        if let Some(grid) = &grid {
            dynamics::read::provide_dimensions(&mut entries, kind, grid);
        }
        let compare = compare(&entries)?;
        let kinds: Vec<Kind> =
            [kind].into_iter().chain(compare.iter().flatten().copied()).collect();
        let yields = yield_set(&entries, kind, &[])?;
        let media: Vec<Medium> = kinds.iter().map(|&kind| Medium { kind, yields }).collect();
        let numbers = numbers(&entries, &media)?;
        let active = active(&entries, media[0])?;
        let map = entries.has_section("map").then(|| map(&entries, media[0])).transpose()?;
        let swept = map.iter().flat_map(|map| [("map.x", map.x), ("map.y", map.y)]);
        let of_stress = |sweep: &Sweep| sweep.parameter.key().name.starts_with("stress.");
        if let (Some((axis, sweep)), true) =
            (swept.into_iter().find(|s| of_stress(&s.1)), active.is_some())
        {
            let found = format!("a sweep of {} beside yield.active", sweep.parameter.name());
            let allowed = "leave yield.active out: either decides what yields";
            return Err(entries.places.error(axis, found, allowed));
        }
        let sweeps_elevation = map.is_some_and(|map| {
            [map.x, map.y].iter().any(|sweep| sweep.parameter.name() == "wave.elevation_deg")
        });
        if sweeps_elevation && numbers.dimensions == 2 {
            let allowed = "waves stay in the plane, unless model.dimensions = 3";
            let found = "a sweep of wave.elevation_deg in plane strain";
            return Err(entries.places.error("map", found, allowed));
        }
        let title = match entries.get("title") {
            Some(Value::Text(title)) => title.clone(),
            _ => String::new(),
        };
        let name = name(&entries, file)?;
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
            grid.map(|grid| dynamics::read::read(grid, &case, &entries, folder)).transpose()?;
        let flow = rotation.map(|own| flow::read::read(own, &entries, folder)).transpose()?;
        Ok(Self { dynamics, flow, ..case })
    }

    /// The case of a region: this one but for the kind, yield set and numbers that the region has
    /// of its own.
    fn of_region(
        &self,
        entries: &Entries,
        region: &mut Section,
        grid: &Grid,
    ) -> Result<Self, CaseError> {
        const KIND: &str = "model.kind";
        let mut entries = entries.of_region(region)?;
        let kind = read::kind(entries.text(KIND)?, KIND, &entries.places)?;
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
        dynamics::read::provide_dimensions(&mut entries, kind, grid);
        let yields = yield_set(&entries, kind, &[NO_YIELD])?;
        let medium = Medium { kind, yields };
        if kind != self.kind {
            // What the case's own kind uses and this one does not was not meant for it.
            entries.keep_inherited(|name| {
                Key::find(name).is_some_and(|key| key.is_used_by(medium) && key.field.is_kept())
            });
        }
        let mut numbers = numbers(&entries, &[medium])?;
        dynamics::read::check_dimensions(&entries.places, kind, numbers.dimensions, grid)?;
        let active = active(&entries, medium)?;
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

    /// The same state for another kind of model, without what that kind does not use.
    pub fn for_kind(&self, kind: Kind) -> Self {
        let yields = self.yields.filter(|set| kind.yield_sets().contains(set));
        let mut case = Self { kind, yields, compare: None, ..self.clone() };
        if kind != self.kind {
            (case.dynamics, case.flow) = (None, None);
        }
        let medium = case.medium();
        for key in keys().iter().filter(|key| !key.is_used_by(medium)) {
            key.clear(&mut case.numbers);
        }
        case
    }

    /// The same state for another kind of model, with the non-coaxiality that a given spin stands
    /// for: `noncoaxiality_deg` is what the case's own model made of it, in degrees.
    ///
    /// A kind without spin would otherwise be given another state, coaxial by default. The plastic
    /// potential is coaxial by definition: what it loses is handed back, to be told the reader.
    pub fn for_kind_with(&self, kind: Kind, noncoaxiality_deg: Option<f64>) -> Converted {
        let mut case = self.for_kind(kind);
        let mut lost_noncoaxiality_deg = None;
        let state = self.numbers.background.noncoaxiality_deg.or(noncoaxiality_deg);
        let other = &mut case.numbers.background;
        if matches!(kind, Kind::Flow(flow) if flow.is_coaxial()) && kind != self.kind {
            // Axes have no sense: half a turn apart they are the same.
            lost_noncoaxiality_deg = state.filter(|delta| delta % 180.0 != 0.0);
            other.noncoaxiality_deg = Some(0.0);
        } else if self.numbers.background.spin.is_some() && other.spin.is_none() {
            other.noncoaxiality_deg = state;
        }
        Converted { case, lost_noncoaxiality_deg }
    }

    /// The state in the units of the models.
    pub fn state(&self) -> State {
        let given = &self.numbers.background;
        State {
            density: given.density,
            pressure: given.pressure,
            deviatoric_stress: given.deviatoric_stress,
            rotational_stress: given.rotational_stress,
            stress_angle: radians(given.stress_angle_deg),
            shear_rate: given.shear_rate,
            velocity: given.velocity,
            half_vorticity: given.half_vorticity,
            noncoaxiality: given.noncoaxiality_deg.map(radians),
            spin: given.spin,
            pressure_gradient: given.pressure_gradient,
            stress_angle_gradient: given.stress_angle_gradient_deg.map(f64::to_radians),
            spin_gradient: given.spin_gradient,
            density_gradient: given.density_gradient,
            spin_acceleration: given.spin_acceleration,
            inertia_rate: given.inertia_rate,
            inertia_gradient: given.inertia_gradient,
            velocity_gradient: given.velocity_gradient,
            acceleration: given.acceleration,
            body_moment: given.body_moment,
            stress_angle_rate: given.stress_angle_rate_deg.map(f64::to_radians),
        }
    }

    /// The model, with its constants checked.
    ///
    /// # Errors
    /// The constant that is out of range, and where it stands.
    pub fn model(&self) -> Result<Model, CaseError> {
        self.flow_model().map_err(|error| self.locate(error))
    }

    /// The same without the place.
    ///
    /// # Errors
    /// The constant that is out of range, or that the case is one of a solid.
    pub fn flow_model(&self) -> Result<Model, InputError> {
        let flow = self.flow_kind()?;
        let mut constants = Vec::new();
        self.numbers.model.in_order(flow.parameters(), &mut constants);
        Model::new(flow, &constants)
    }

    /// Gives the case's constants to a model of its kind, by way of a list that is kept; no memory is
    /// taken.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn set_constants(
        &self,
        model: &mut Model,
        constants: &mut Vec<f64>,
    ) -> Result<(), InputError> {
        self.numbers.model.in_order(model.kind().parameters(), constants);
        model.set(constants)
    }

    fn flow_kind(&self) -> Result<Flow, InputError> {
        match self.kind {
            Kind::Flow(flow) => Ok(flow),
            Kind::Solid(_) => Err(InputError {
                key: "kind",
                found: format!("{}, a solid", self.kind.name()),
                allowed: format!(
                    "this needs a flow ({}); for solids see wellposed dispersion and speeds",
                    names(&Kind::flows())
                ),
            }),
        }
    }

    /// The map that the case asks for.
    ///
    /// # Errors
    /// That the case has none, and how to add one.
    pub fn required_map(&self) -> Result<&Map, CaseError> {
        self.map.as_ref().ok_or_else(|| {
            let axis =
                "{ parameter = \"model.friction_angle_deg\", from = 5, to = 60, points = 56 }";
            self.places.error(
                "map",
                "missing",
                format!("add a section [map] with x = {axis} and y"),
            )
        })
    }

    /// Adds the place to an error that a model found.
    pub fn locate(&self, error: InputError) -> CaseError {
        let key = self.key_of(error.key);
        self.places.error(key, format!("found {}", error.found), error.allowed)
    }

    /// The key of an input of the case's model, yield set or state; a name that is none of these
    /// stands for itself.
    fn key_of(&self, input: &'static str) -> &'static str {
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

    /// Adds the place to an error that a model found at a point of the map: a number that is swept
    /// has its value from `[map]`, not from where its key stands.
    pub fn locate_in_map(&self, error: InputError) -> CaseError {
        let axes = self.map.iter().flat_map(|map| [("map.x", &map.x), ("map.y", &map.y)]);
        let key = self.key_of(error.key);
        let swept = |(_, sweep): &(&str, &Sweep)| sweep.parameter.key().name == key;
        match axes.into_iter().find(swept) {
            Some((axis, _)) => CaseError::Key {
                place: self.places.of_axis(axis),
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
        found.ok_or_else(|| no_grid(&self.places, self.kind))
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
    fn values(&self) -> impl Iterator<Item = (&'static Key, Value)> {
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
}

/// As TOML.
impl std::fmt::Display for Sweep {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, points) = (Value::Text(self.parameter.name()), self.points);
        let (from, to) = (Value::Number(self.from), Value::Number(self.to));
        write!(formatter, "{{ parameter = {name}, from = {from}, to = {to}, points = {points} }}")
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

/// The name of a case: given, or else from its file.
fn name(entries: &Entries, file: &str) -> Result<String, CaseError> {
    const KEY: &str = "name";
    let may_stand = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    // `.` and `..` are folders already.
    let is_dots = |name: &str| name.chars().all(|c| c == '.');
    if let Some(Value::Text(name)) = entries.get(KEY) {
        if is_dots(name) || !name.chars().all(may_stand) {
            let allowed = Key::find(KEY).map_or(String::new(), read::allowed);
            let found = format!("found '{}'", error::shown(name));
            return Err(entries.places.error(KEY, found, allowed));
        }
        return Ok(name.clone());
    }
    let file = Path::new(file).file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let stem = file.rsplit_once('.').map_or(&*file, |(stem, _)| stem);
    if is_dots(stem) {
        return Ok("case".to_owned());
    }
    // What a resolved case states must read back.
    Ok(stem.chars().map(|c| if may_stand(c) { c } else { '-' }).collect())
}

/// The yield set that `[yield]` names; a name among `none` stands for none.
fn yield_set(
    entries: &Entries,
    kind: Kind,
    none: &[&'static str],
) -> Result<Option<Yield>, CaseError> {
    const KEY: &str = "yield.kind";
    if !entries.has_section("yield") {
        return match entries.has_section("stress") && !kind.yield_sets().is_empty() {
            true => Err(entries.places.error(
                "stress",
                "a stress without a yield set",
                "add a section [yield], or leave this one out: elastic waves do not see the stress",
            )),
            false => Ok(None),
        };
    }
    let sets = kind.yield_sets();
    if sets.is_empty() {
        let found = format!("a yield set for the model {}", kind.name());
        return Err(entries.places.error("yield", found, "leave the section out: flows yield"));
    }
    let name = entries.text(KEY)?;
    if none.contains(&name) {
        return Ok(None);
    }
    let found = registry::yield_set(name).filter(|set| sets.contains(set));
    found.map(Some).ok_or_else(|| {
        let names: Vec<&str> =
            sets.iter().map(|set| set.name).chain(none.iter().copied()).collect();
        let meant = suggestion(nearest(name, names.iter().copied()));
        let found = format!("found '{}'", error::shown(name));
        let allowed = format!("{meant}allowed for {}: {}", kind.name(), names.join(", "));
        entries.places.error(KEY, found, allowed)
    })
}

/// The conditions of `yield.active`.
fn active(entries: &Entries, medium: Medium) -> Result<Option<Vec<usize>>, CaseError> {
    const KEY: &str = "yield.active";
    let Some(Value::Texts(names)) = entries.get(KEY) else { return Ok(None) };
    if !Key::find(KEY).is_some_and(|key| key.is_used_by(medium)) {
        let found = format!("not used by {}", medium.title());
        return Err(entries.places.error(KEY, found, "leave it out (it belongs to interlayer)"));
    }
    if entries.has_section("stress") {
        let found = "active conditions beside a section [stress]";
        return Err(entries.places.error(KEY, found, "give one of the two: either decides"));
    }
    let known = medium.condition_names();
    let mut active = Vec::new();
    for name in names {
        let found = format!("found '{}'", error::shown(name));
        let Some(index) = known.iter().position(|known| *known == name.as_str()) else {
            let meant = suggestion(nearest(name, known.iter().copied()));
            let allowed = format!("{meant}allowed: {}", known.join(", "));
            return Err(entries.places.error(KEY, found, allowed));
        };
        // Both signs at once: a stress of zero and a strength of zero, where nothing is decided.
        let stress = |index: usize| known[index].trim_start_matches(['+', '-']);
        if active.iter().any(|&other| stress(other) == stress(index)) {
            let allowed = "name each stress once, with one sign";
            return Err(entries.places.error(KEY, found, allowed));
        }
        active.push(index);
    }
    if active.is_empty() {
        let allowed = format!("name at least one of {}", known.join(", "));
        return Err(entries.places.error(KEY, "an empty list", allowed));
    }
    Ok(Some(active))
}

/// The numbers of a case: defaults, what was given, and nothing that no medium uses.
fn numbers(entries: &Entries, media: &[Medium]) -> Result<Numbers, CaseError> {
    let is_used = |key: &Key| media.iter().any(|&medium| key.is_used_by(medium));
    // What is too much says more of a mistake than what is missing.
    if let Some(key) = keys()
        .iter()
        .find(|key| key.field.is_kept() && entries.get(key.name).is_some() && !is_used(key))
    {
        let namesake = keys().iter().find(|k| is_used(k) && k.split().1 == key.split().1);
        let meant = suggestion(namesake.map(|key| key.name));
        let of_kind = media.iter().any(|medium| key.is_for(medium.kind));
        let (user, owners): (_, Vec<&str>) = match (of_kind, media[0].yields) {
            (true, None) => ("an elastic solid".into(), key.set_names()),
            (true, Some(set)) => (format!("the set {}", set.name), key.set_names()),
            (false, _) => {
                let names: Vec<&str> = media.iter().map(|medium| medium.kind.name()).collect();
                (format!("the model {}", names.join(", ")), key.owners())
            }
        };
        return Err(entries.places.error(
            key.name,
            format!("not used by {user}"),
            format!("{meant}leave it out (it belongs to {})", owners.join(", ")),
        ));
    }
    let mut numbers = Numbers::default();
    for key in keys().iter().filter(|key| key.field.is_kept()) {
        key.clear(&mut numbers);
        match entries.get(key.name) {
            Some(value) => key.field.store(&mut numbers, value),
            None if is_used(key) && matches!(key.presence, Presence::Required(_)) => {
                entries.require(key.name)?;
            }
            None => {}
        }
    }
    if let dimensions @ (1 | 4..) = numbers.dimensions {
        let found = format!("found {dimensions}");
        let allowed = "2 for plane strain or 3 for space";
        return Err(entries.places.error("model.dimensions", found, allowed));
    }
    let elevation = numbers.wave.elevation_deg;
    if numbers.dimensions == 2 && elevation != 0.0 {
        let found = format!("found {elevation:?} in plane strain");
        let allowed = "0: waves stay in the plane, unless model.dimensions = 3";
        return Err(entries.places.error("wave.elevation_deg", found, allowed));
    }
    if numbers.dimensions == 3 && media[0].yields.is_some_and(|set| set.is_plane) {
        let found = "found 3 with the yield set interlayer";
        let allowed = "2: its layers are normal to x1 and x2, in plane strain";
        return Err(entries.places.error("model.dimensions", found, allowed));
    }
    let number = numbers.wave.number;
    if number <= 0.0 {
        return Err(wave_number(entries, "wave.number", number));
    }
    let greatest = numbers.wave.greatest_number;
    if greatest < 0.0 {
        return Err(wave_number(entries, "wave.greatest_number", greatest));
    }
    Ok(numbers)
}

fn wave_number(entries: &Entries, key: &str, found: f64) -> CaseError {
    entries.places.error(key, format!("found {found:?}"), "a wave number must be positive")
}

/// The kinds of `[compare]`.
fn compare(entries: &Entries) -> Result<Option<Vec<Kind>>, CaseError> {
    const KEY: &str = "compare.kinds";
    if !entries.has_section("compare") {
        return Ok(None);
    }
    let mut kinds = Vec::new();
    if let Value::Texts(names) = entries.require(KEY)? {
        for name in names {
            let kind = read::kind(name, KEY, &entries.places)?;
            if let Kind::Solid(_) = kind {
                let allowed = format!("flows alone: {}", self::names(&Kind::flows()));
                return Err(entries.places.error(KEY, format!("found {name}, a solid"), allowed));
            }
            if kinds.contains(&kind) {
                let found = format!("found {name} twice");
                return Err(entries.places.error(KEY, found, "name each kind once"));
            }
            kinds.push(kind);
        }
    }
    if kinds.is_empty() {
        return Err(entries.places.error(KEY, "an empty list", "name at least one kind of model"));
    }
    Ok(Some(kinds))
}

/// The axes of `[map]`.
fn map(entries: &Entries, medium: Medium) -> Result<Map, CaseError> {
    let x = sweep(entries, medium, ["map.x.parameter", "map.x.from", "map.x.to", "map.x.points"])?;
    let y = sweep(entries, medium, ["map.y.parameter", "map.y.from", "map.y.to", "map.y.points"])?;
    if x.parameter == y.parameter {
        return Err(entries.places.error(
            "map.y.parameter",
            format!("found {} on both axes", y.parameter.name()),
            "sweep two different parameters",
        ));
    }
    if x.points.checked_mul(y.points).is_none_or(|points| points > MOST_POINTS) {
        let larger = if x.points > y.points { "map.x.points" } else { "map.y.points" };
        return Err(entries.places.error(
            larger,
            format!("a grid of {} × {} points", x.points, y.points),
            format!("expected at most {MOST_POINTS} points in all"),
        ));
    }
    Ok(Map { x, y })
}

fn sweep(
    entries: &Entries,
    medium: Medium,
    [parameter_key, from_key, to_key, points_key]: [&'static str; 4],
) -> Result<Sweep, CaseError> {
    let name = entries.text(parameter_key)?;
    let found = Parameter::find(name).filter(|parameter| parameter.key().is_used_by(medium));
    let Some(parameter) = found else {
        return Err(no_parameter(entries, medium, parameter_key, name));
    };
    let (from, to) = (entries.number(from_key)?, entries.number(to_key)?);
    let points = match entries.require(points_key)? {
        Value::Count(points) => *points,
        _ => 1, // the table says that it is a count
    };
    if points > 1 && from == to {
        let found = format!("found {to:?} at both ends");
        return Err(entries.places.error(to_key, found, "give two different ends, or 1 point"));
    }
    // More points than any map may have are answered for as a grid.
    if (2..=MOST_POINTS).contains(&points) {
        check_step(entries, [from_key, to_key, points_key], from, to, points)?;
    }
    if parameter.key().name.starts_with("wave.")
        && parameter.key().unit == "1/m"
        && from.min(to) <= 0.0
    {
        let key = if from <= 0.0 { from_key } else { to_key };
        return Err(wave_number(entries, key, from.min(to)));
    }
    Ok(Sweep { parameter, from, to, points })
}

/// That neighbouring values of a sweep of at least 2 points differ.
fn check_step(
    entries: &Entries,
    [from_key, to_key, points_key]: [&'static str; 3],
    from: f64,
    to: f64,
    points: usize,
) -> Result<(), CaseError> {
    let range = to - from;
    let largest = from.abs().max(to.abs());
    if !range.is_finite() {
        // Either end may be the huge one; the greater answers for both.
        let key = if from.abs() > to.abs() { from_key } else { to_key };
        let found = format!("found {from:?} … {to:?}, whose difference overflows");
        return Err(entries.places.error(key, found, "give ends whose difference is finite"));
    }
    // Rounding moves a value of the sweep by at most three halves of this, or one smallest double.
    let unit = (f64::EPSILON * largest).max(f64::from_bits(1));
    if range.abs() / (points - 1) as f64 <= 4.0 * unit {
        let found =
            format!("found {points} points between {from:?} and {to:?}, too close to differ");
        return Err(entries.places.error(points_key, found, "give fewer points, or a wider range"));
    }
    Ok(())
}

/// Why a name is no parameter to sweep.
fn no_parameter(entries: &Entries, medium: Medium, place: &str, name: &str) -> CaseError {
    let names: Vec<String> = Parameter::all()
        .filter(|parameter| parameter.key().is_used_by(medium))
        .map(Parameter::name)
        .collect();
    let shown = error::shown(name);
    let component = Parameter::find(name).map(Parameter::key);
    let mut meant = String::new();
    let found = match Key::find(name).or(component) {
        Some(key) if !key.is_for(medium.kind) => {
            format!("'{shown}' is not used by the model {}", medium.kind.name())
        }
        Some(key) if !key.is_used_by(medium) => {
            format!("'{shown}' is not used by {}", medium.title())
        }
        Some(_) => format!("'{shown}' is no single number"),
        None => {
            meant = suggestion(nearest(name, names.iter().map(String::as_str)));
            format!("there is no '{shown}' to sweep")
        }
    };
    entries.places.error(place, found, format!("{meant}allowed: {}", names.join(", ")))
}
