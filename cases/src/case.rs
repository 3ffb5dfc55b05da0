//! A case: reading from a case file and writing as TOML.

mod requirements;

use super::bundled::find_bundled_case;
use super::check::{self, CheckOptions};
use super::dynamics::{PlottedQuantity, SolidGrid, SolidRun, TimeFunction};
use super::entries::{CaseEntries, find_model_kind};
use super::equations::EquationsCase;
use super::error::{CaseError, SourcePosition};
use super::flow::{FlowPerturbation, FlowRun};
use super::former_names::CaseHint;
use super::keys::SweepParameter;
use super::kind::{MediumKind, ModelKind};
use super::map::{MapAxes, ParameterSweep};
use super::material::{Material, check_cell_counts, check_dimensions, set_default_dimensions};
use super::missing_grid::missing_grid_error;
use super::numbers::CaseNumbers;
use super::plane_wave::{self, PlaneWaveOptions};
use super::rheology::RheologyCase;
use super::scalar_keys;
use super::schema::SchemaScope;
use super::section::SectionReader;
use super::section_schemas::{CASE_SCHEMAS, has_simulation};
use super::value::CaseValue;
use models::InputError;
use models::common::elementary::Elementary;
use std::fmt::Write;
use std::io::ErrorKind;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Maximum size of a case file, bytes. Larger files are refused unread, since parsing takes up to 70 times the file
/// size in memory.
pub const MAX_FILE_SIZE: u64 = 16 << 20;

/// Purpose for which a case is read: analysis, or a time-domain simulation, which needs a section `[grid]`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Analysis,
    Simulation,
}

/// A case as stated in its case file, with default values filled in.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of the result folder: letters, digits, `-`, `_` and `.`; by default derived from the name of the case file.
    pub name: String,
    /// Title of the case, one line; may be empty.
    pub title: String,
    /// Kind of model, yield set and numbers; in a case with regions the values that the regions inherit.
    pub material: Material,
    /// Section `[map]`: the sweep of `wellposed map`.
    pub map: Option<MapAxes>,
    /// Section `[compare]`: kinds of model to be compared on the state of the case.
    pub compared_kinds: Option<Vec<ModelKind>>,
    /// Sections of a time-domain simulation of a solid, if present.
    pub solid_run: Option<SolidRun>,
    /// Sections of a time-domain simulation of a flow, if present.
    pub flow_run: Option<FlowRun>,
    /// Section `[check]`: waves and grids of `wellposed check`, if present.
    pub check_options: Option<CheckOptions>,
    /// Loads of plane waves in a granular or porous medium, if present.
    pub plane_wave: Option<PlaneWaveOptions>,
    /// Sections of a rheological scheme; the case then has no `[model]`, and the kind of its material is
    /// [`ModelKind::Rheology`].
    pub rheology: Option<RheologyCase>,
    /// Model given as equations; the kind of the material is then [`ModelKind::Equations`].
    pub equations: Option<EquationsCase>,
    hints: Vec<CaseHint>,
    source_path: Option<PathBuf>,
}

/// Equality of content; positions in the file are ignored.
impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && self.title == other.title
            && self.material == other.material
            && self.map == other.map
            && self.compared_kinds == other.compared_kinds
            && self.solid_run == other.solid_run
            && self.flow_run == other.flow_run
            && self.check_options == other.check_options
            && self.plane_wave == other.plane_wave
            && self.rheology == other.rheology
            && self.equations == other.equations
    }
}

/// Time-domain simulation of a case.
#[derive(Clone, Copy, Debug)]
pub enum TimeDomainRun<'a> {
    /// Simulation of a solid.
    Solid(&'a SolidRun),
    /// Simulation of a flow.
    Flow(&'a FlowRun),
}

impl Case {
    /// Reads a case file, or, if no file has this path, the [bundled case](find_bundled_case) of this name, which a folder
    /// does not hide; `sets` are the `--set` options (`key=value`), which override its values.
    ///
    /// # Errors
    /// The file cannot be read, is larger than [`MAX_FILE_SIZE`] or is not TOML, or a key of the file or of an option
    /// is unknown, missing or unused or has an invalid value.
    pub fn load(path: &Path, sets: &[String]) -> Result<Self, CaseError> {
        Self::load_for_purpose(path, sets, Purpose::Analysis)
    }

    /// Reads the case file of a time-domain simulation; `sets` as in [`load`](Self::load).
    ///
    /// # Errors
    /// The case has no section `[grid]`, or an error of [`load`](Self::load).
    pub fn load_simulation(path: &Path, sets: &[String]) -> Result<Self, CaseError> {
        Self::load_for_purpose(path, sets, Purpose::Simulation)
    }

    fn load_for_purpose(path: &Path, sets: &[String], purpose: Purpose) -> Result<Self, CaseError> {
        let unreadable = |cause: String| CaseError::Unreadable { path: path.to_owned(), cause };
        // A folder of the same name, such as one of results, does not hide a bundled case.
        if (path.symlink_metadata().is_err() || path.is_dir())
            && let Some((bundled, text)) = find_bundled_case(&path.to_string_lossy())
        {
            return Self::parse_for_purpose(text, bundled, sets, purpose);
        }
        let mut bytes = Vec::new();
        std::fs::File::open(path)
            .and_then(|file| file.take(MAX_FILE_SIZE + 1).read_to_end(&mut bytes))
            .map_err(|error| match error.kind() {
                ErrorKind::NotFound => unreadable("no such file".to_owned()),
                ErrorKind::IsADirectory => unreadable("a folder, not a file".to_owned()),
                _ => unreadable(error.to_string()),
            })?;
        if bytes.len() as u64 > MAX_FILE_SIZE {
            return Err(unreadable("larger than 16 MiB, the maximum size of a case file".into()));
        }
        let file = path.display().to_string();
        match std::str::from_utf8(&bytes) {
            Ok(text) => {
                let case = Self::parse_for_purpose(text, &file, sets, purpose)?;
                Ok(Self { source_path: Some(path.to_owned()), ..case })
            }
            Err(error) => {
                let before = &bytes[..error.valid_up_to()];
                let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
                let cause = "a byte that is not UTF-8 text".to_owned();
                let position = SourcePosition::Line { file, line };
                Err(CaseError::Syntax { position, cause, remedy: "save the file as UTF-8 text" })
            }
        }
    }

    /// Parses the text of a case file with the name `file`; `sets` are the `--set` options (`key=value`), which
    /// override its values.
    ///
    /// # Errors
    /// The text is not TOML or has too many tables or keys, or a key of the text or of an option is unknown, missing or
    /// unused or has an invalid value.
    pub fn parse(text: &str, file: &str, sets: &[String]) -> Result<Self, CaseError> {
        Self::parse_for_purpose(text, file, sets, Purpose::Analysis)
    }

    fn parse_for_purpose(
        text: &str,
        file: &str,
        sets: &[String],
        purpose: Purpose,
    ) -> Result<Self, CaseError> {
        let mut entries = CaseEntries::parse(text, file, sets, &CASE_SCHEMAS)?;
        if !entries.schemas.equations.is_empty() {
            return Self::parse_equations(&entries, file, purpose);
        }
        if RheologyCase::is_present(&entries.structured_reader(SchemaScope::default())) {
            return Self::parse_rheology(&entries, file, purpose);
        }
        let kind =
            find_model_kind(entries.require_text("model.kind")?, "model.kind", &entries.positions)?;
        let is_in_time = has_simulation(&entries.structured_reader(SchemaScope::default()), kind)?;
        if !is_in_time && purpose == Purpose::Simulation {
            return Err(missing_grid_error(&entries.positions, kind));
        }
        let rotation = kind.simulation_rotation().filter(|_| is_in_time);
        let is_solid = is_in_time && rotation.is_none();
        let read_grid = || SolidGrid::read(&entries.structured_reader(SchemaScope::default()));
        let grid = is_solid.then(read_grid).transpose();
        // A list of the grid with another length than `grid.cells` may be right, and the cells wrong.
        let is_list = |error: &CaseError| matches!(error, CaseError::Key { key, .. } if ["grid.spacing", "grid.origin"].contains(&key.as_str()));
        let grid = grid.or_else(|error| match is_list(&error) {
            true => check_cell_counts(&entries, kind).and(Err(error)),
            false => Err(error),
        })?;
        if let Some(grid) = &grid {
            set_default_dimensions(&mut entries, kind, grid.dimensions());
        }
        let compare = scalar_keys::read_compared_kinds(&entries)?;
        let kinds: Vec<ModelKind> =
            [kind].into_iter().chain(compare.iter().flatten().copied()).collect();
        let yields = scalar_keys::read_yield_set(&entries, kind, &[])?;
        let media: Vec<MediumKind> =
            kinds.iter().map(|&kind| MediumKind { kind, yield_set: yields }).collect();
        let numbers = scalar_keys::read_numbers(&entries, &media)?;
        let active = scalar_keys::read_active_conditions(&entries, media[0])?;
        let map = MapAxes::read(&entries, media[0], &numbers, active.is_some())?;
        let title = read_title(&entries);
        let name = scalar_keys::read_name(&entries, file)?;
        let check = check::read_check(&entries.structured_reader(SchemaScope::default()))?;
        let root = entries.structured_reader(SchemaScope::default());
        let contacts = plane_wave::read_contacts(&root, &entries.positions, media[0])?;
        let plane_wave = plane_wave::read_loads(&root, contacts.as_ref(), is_in_time)?;
        let material = Material {
            kind,
            yield_set: yields,
            active_conditions: active,
            contacts,
            numbers,
            positions: entries.positions.clone(),
        };
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        let scope = |dimensions: usize| SchemaScope {
            kind: Some(kind),
            dimensions: Some(dimensions),
            face_axes: Vec::new(),
        };
        let read_dynamics = |grid: SolidGrid| {
            let d = grid.dimensions();
            check_dimensions(&entries.positions, kind, material.numbers.dimensions, d)?;
            let own = |region: &SectionReader| material.override_for_region(&entries, region, d);
            SolidRun::read(&entries.structured_reader(scope(d)), grid, &material, own, folder)
        };
        let dynamics = grid.map(read_dynamics).transpose()?;
        let read_flow = |own| FlowRun::read(&entries.structured_reader(scope(2)), own, folder);
        let flow = rotation.map(read_flow).transpose()?;
        Ok(Self {
            name,
            title,
            material,
            map,
            compared_kinds: compare,
            solid_run: dynamics,
            flow_run: flow,
            check_options: check,
            plane_wave,
            rheology: None,
            equations: None,
            hints: entries.hints.0.clone(),
            source_path: None,
        })
    }

    /// Reads a case with a rheological scheme, which has no other sections.
    fn parse_rheology(
        entries: &CaseEntries,
        file: &str,
        purpose: Purpose,
    ) -> Result<Self, CaseError> {
        let foreign = |key: &str| {
            let allowed = "leave it out: a rheological scheme has [rheology] and [load_path] only";
            entries.positions.key_error(key, "not used by a rheological scheme", allowed)
        };
        const SCALAR_SECTIONS: [&str; 7] =
            ["model", "background", "yield", "stress", "wave", "map", "compare"];
        if let Some(section) = SCALAR_SECTIONS.into_iter().find(|own| entries.has_section(own)) {
            return Err(foreign(section));
        }
        let root = entries.structured_reader(SchemaScope::default());
        let is_own = |name: &str| CASE_SCHEMAS.rheology.iter().any(|own| own.name == name);
        if let Some((name, _)) = root.entries().find(|(name, _)| !is_own(name)) {
            return Err(foreign(name));
        }
        let rheology = RheologyCase::read(&root)?;
        let material = Material {
            kind: ModelKind::Rheology,
            yield_set: None,
            active_conditions: None,
            contacts: None,
            numbers: CaseNumbers::default(),
            positions: entries.positions.clone(),
        };
        if purpose == Purpose::Simulation {
            return Err(missing_grid_error(&material.positions, material.kind));
        }
        Ok(Self {
            name: scalar_keys::read_name(entries, file)?,
            title: read_title(entries),
            material,
            map: None,
            compared_kinds: None,
            solid_run: None,
            flow_run: None,
            check_options: None,
            plane_wave: None,
            rheology: Some(rheology),
            equations: None,
            hints: entries.hints.0.clone(),
            source_path: None,
        })
    }

    /// Reads a case whose model is given as equations.
    fn parse_equations(
        entries: &CaseEntries,
        file: &str,
        purpose: Purpose,
    ) -> Result<Self, CaseError> {
        let root = entries.structured_reader(SchemaScope::default());
        const FOREIGN_SECTIONS: [&str; 3] = ["yield", "stress", "compare"];
        if let Some(section) = FOREIGN_SECTIONS.into_iter().find(|own| entries.has_section(own)) {
            let allowed = "leave it out: a model given as equations has [model], [background], [wave], [map] and \
                           [check]";
            let found = "not used by a model given as equations";
            return Err(entries.positions.key_error(section, found, allowed));
        }
        let (equations, numbers) = EquationsCase::read(&root)?;
        let map = equations.read_map(&root)?;
        let material = Material {
            kind: ModelKind::Equations,
            yield_set: None,
            active_conditions: None,
            contacts: None,
            numbers,
            positions: entries.positions.clone(),
        };
        if purpose == Purpose::Simulation {
            return Err(missing_grid_error(&material.positions, material.kind));
        }
        let title = read_title(entries);
        Ok(Self {
            name: scalar_keys::read_name(entries, file)?,
            title: if title.is_empty() { equations.title.clone() } else { title },
            material,
            map,
            compared_kinds: None,
            solid_run: None,
            flow_run: None,
            check_options: check::read_check(&root)?,
            plane_wave: None,
            rheology: None,
            equations: Some(equations),
            hints: entries.hints.0.clone(),
            source_path: None,
        })
    }

    /// Returns the path of the file from which the case was loaded.
    pub fn source_path(&self) -> Option<&Path> {
        self.source_path.as_deref()
    }

    /// Returns hints on former names that the case file or an option uses.
    pub fn hints(&self) -> &[CaseHint] {
        &self.hints
    }

    /// Returns the paths of the input files named by the case: sample tables and initial-field archives.
    pub fn input_files(&self) -> impl Iterator<Item = &Path> {
        let parts = self.flow_run.iter().flat_map(|flow| &flow.perturbation_terms);
        let archives = parts.filter_map(|part| match part {
            FlowPerturbation::File { path, .. } => Some(Path::new(path)),
            _ => None,
        });
        let tables =
            self.solid_run.iter().flat_map(SolidRun::time_functions).filter_map(
                |time| match time {
                    TimeFunction::Table(samples) => samples.source_file(),
                    _ => None,
                },
            );
        archives.chain(tables)
    }

    /// Returns the kind of model and the yield set of the case.
    pub fn medium(&self) -> MediumKind {
        self.material.medium()
    }

    /// Returns the value of the number `name`; `None` if the case has no number of this name.
    pub fn number(&self, name: &str) -> Option<f64> {
        if let Some(index) = self.equations.as_ref().and_then(|own| own.find_number(name)) {
            return self.material.numbers.equation_numbers.get(index).copied();
        }
        self.material.number(name)
    }

    /// Sets the number `parameter`, as a map sweep does.
    pub fn set_number(&mut self, parameter: SweepParameter, value: f64) {
        self.material.set_number(parameter, value);
    }

    /// Adds the position in the case file, or the option, to an input error of a model.
    pub fn locate_error(&self, error: InputError) -> CaseError {
        self.material.locate_error(error)
    }

    /// Adds the position to an input error of a model at a point of the map. An error of a swept number is reported at
    /// its axis in `[map]`, not at the key of the number.
    pub fn locate_error_in_map(&self, error: InputError) -> CaseError {
        let axes = self.map.iter().flat_map(|map| [("map.x", &map.x), ("map.y", &map.y)]);
        let key = self.material.case_key(error.input);
        let swept = |(_, sweep): &(&str, &ParameterSweep)| sweep.parameter.key().name == key;
        match axes.into_iter().find(swept) {
            Some((axis, _)) => CaseError::Key {
                position: self.material.positions.locate_axis(axis),
                key: key.to_owned(),
                found: format!("found {}, a value of the sweep {axis}", error.rejected_value),
                allowed: error.allowed_values,
            },
            None => self.locate_error(error),
        }
    }

    /// Returns the time-domain simulation of the case.
    ///
    /// # Errors
    /// The case has no section `[grid]`; the message says how to add one.
    pub fn time_domain_run(&self) -> Result<TimeDomainRun<'_>, CaseError> {
        let flow = || self.flow_run.as_ref().map(TimeDomainRun::Flow);
        let found = self.solid_run.as_ref().map(TimeDomainRun::Solid).or_else(flow);
        found.ok_or_else(|| missing_grid_error(&self.material.positions, self.material.kind))
    }

    /// Returns an error at a key of the plane wave problem.
    pub fn plane_wave_error(&self, key: &str, found: String, allowed: String) -> CaseError {
        self.material.positions.key_error(key, found, allowed)
    }

    /// Returns the key of the number whose magnitude is farthest from 1, as the likely cause of an overflow; `None` if all
    /// magnitudes are between 10⁻¹⁰⁰ and 10¹⁰⁰.
    pub fn find_extreme_number(&self) -> Option<(String, f64)> {
        const MAX_EXPONENT: f64 = 100.0;
        let mut section = String::new();
        let mut extreme: Option<(String, f64)> = None;
        let exponent = |value: f64| value.abs().cr_log10().abs();
        for line in self.to_toml().lines() {
            if let Some(name) = line.strip_prefix('[').and_then(|own| own.strip_suffix(']')) {
                name.clone_into(&mut section);
                continue;
            }
            let Some((key, value)) = line.split_once(" = ") else { continue };
            let Some(value) = value.parse().ok().filter(|value: &f64| *value != 0.0) else {
                continue;
            };
            let most = extreme.as_ref().map_or(MAX_EXPONENT, |(_, own)| exponent(*own));
            if exponent(value) > most {
                extreme = Some((format!("{section}.{key}"), value));
            }
        }
        extreme
    }

    /// Returns the case without plot options; cases equal after this call have equal results.
    pub fn without_plot_options(&self) -> Self {
        let mut case = self.clone();
        if let Some(dynamics) = &mut case.solid_run {
            (dynamics.output.plotted_quantity, dynamics.output.contour_levels) =
                (PlottedQuantity::default(), None);
        }
        if let Some(flow) = &mut case.flow_run {
            (flow.output.plotted_field, flow.output.contour_levels) = (None, None);
        }
        case
    }

    /// Formats the resolved case as TOML: all values used by its kind of model or by the kinds of `[compare]`, defaults
    /// included. Numbers have the shortest form that parses to the same double.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        if !self.title.is_empty() {
            let _ = writeln!(text, "title = {}", toml::Value::from(self.title.as_str()));
        }
        let _ = writeln!(text, "name = {}", toml::Value::from(self.name.as_str()));
        if let Some(rheology) = &self.rheology {
            return text + &rheology.to_toml();
        }
        if let Some(equations) = &self.equations {
            text.push_str(&equations.to_toml(&self.material.numbers));
            if let Some(map) = &self.map {
                let _ = write!(text, "\n[map]\nx = {}\ny = {}\n", map.x, map.y);
            }
            if let Some(check) = &self.check_options {
                text.push_str(&check.to_toml());
            }
            return text;
        }
        let mut section = "";
        let compared = self.compared_kinds.as_deref().unwrap_or_default();
        for (key, value) in self.material.key_values(compared) {
            let (own, name) = key.split_section();
            if own != section {
                let _ = write!(text, "\n[{own}]\n");
                section = own;
            }
            let _ = writeln!(text, "{name} = {value}");
        }
        if let Some(map) = &self.map {
            let _ = write!(text, "\n[map]\nx = {}\ny = {}\n", map.x, map.y);
        }
        if let Some(kinds) = &self.compared_kinds {
            let names = kinds.iter().map(|kind| kind.name().to_owned()).collect();
            let _ = write!(text, "\n[compare]\nkinds = {}\n", CaseValue::TextList(names));
        }
        if let Some(dynamics) = &self.solid_run {
            text.push_str(&dynamics.to_toml());
        }
        if let Some(flow) = &self.flow_run {
            text.push_str(&flow.to_toml());
        }
        if let Some(contacts) = &self.material.contacts {
            text.push_str(&contacts.to_toml());
        }
        if let Some(plane_wave) = &self.plane_wave {
            text.push_str(&plane_wave.to_toml());
        }
        if let Some(check) = &self.check_options {
            text.push_str(&check.to_toml());
        }
        text
    }
}

fn read_title(entries: &CaseEntries) -> String {
    let title = entries.value("title").and_then(CaseValue::as_text);
    title.unwrap_or_default().to_owned()
}
