//! Sections of a model given as equations: `[model]` with its tables, `[background]`, `[wave]` and `[map]`.
//!
//! Parameters and background numbers are slots: each has a key, which `--set` and `[map]` name, and an index into
//! [`CaseNumbers::equation_numbers`].

mod background;
mod keys;

pub use background::derivative_name;
pub(crate) use keys::EQUATIONS_KIND;

use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::keys::SweepParameter;
use crate::map::{MapAxes, ParameterSweep, SweepSpacing};
use crate::node::{Node, NodeTable, format_segment};
use crate::numbers::CaseNumbers;
use crate::schema::TableSchema;
use crate::section::{SectionReader, TableWriter};
use crate::value::{find_similar_name, format_allowed, parse_number};
use background::BackgroundReader;
use keys::{
    BACKGROUND_SCHEMA, DEFINITIONS_KEY, DIMENSIONS_KEY, DRIVEN_KEY, EQUATIONS_KEY, KIND_KEY,
    MAP_SCHEMA, MODEL_SCHEMA, PARAMETERS_KEY, TITLE_KEY, UNKNOWNS_KEY, VELOCITY_KEY, WAVE_SCHEMA,
};
use models::Rounded;
use models::equations::{
    EvaluationError, JetVariable, ModelText, NamedText, Quantity, TextError, TextModel, TextPlace,
    TextState,
};
use std::sync::Arc;

/// Schemas of the sections of a model given as equations, in the order of writing.
pub(crate) const EQUATION_SCHEMAS: &[&TableSchema] =
    &[&MODEL_SCHEMA, &BACKGROUND_SCHEMA, &WAVE_SCHEMA, &MAP_SCHEMA];

/// Value of a background derivative that the equations determine.
const SOLVE: &str = "solve";

/// Model given as equations, with the numbers that can be swept.
#[derive(Clone, Debug)]
pub struct EquationsCase {
    /// The compiled model.
    pub model: Arc<TextModel>,
    /// Title of the model; may be empty.
    pub title: String,
    slots: Vec<NumberSlot>,
    /// Background derivatives to be determined from the equations.
    solved: Vec<JetVariable>,
    positions: KeyPositions,
}

/// Equality of content; positions in the file are ignored.
impl PartialEq for EquationsCase {
    fn eq(&self, other: &Self) -> bool {
        self.model.text() == other.model.text()
            && self.title == other.title
            && self.slots == other.slots
            && self.solved == other.solved
    }
}

/// A parameter or a number of the background.
#[derive(Clone, Debug, PartialEq)]
struct NumberSlot {
    /// Key in the case file, e.g. `background.v1.d2`.
    key: String,
    /// Name for axes of maps.
    label: String,
    unit: String,
    target: SlotTarget,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum SlotTarget {
    /// Parameter, by index.
    Parameter(usize),
    Background(JetVariable),
}

impl EquationsCase {
    /// Reads the sections in `root` and the numbers of the case.
    pub(crate) fn read(root: &SectionReader) -> Result<(Self, CaseNumbers), CaseError> {
        let section = root.open_required_section(&MODEL_SCHEMA)?;
        section.read_choice(KIND_KEY, &[EQUATIONS_KIND], |name| name)?;
        let title = section.read_optional::<String>(TITLE_KEY)?.unwrap_or_default();
        let dimensions = section.read_or_default::<usize>(DIMENSIONS_KEY)?;
        if dimensions > 3 {
            let found = format!("found {dimensions}");
            return Err(section.key_error(DIMENSIONS_KEY, found, "expected 1, 2 or 3"));
        }
        let unknowns = read_unknowns(&section)?;
        let velocity = section.read_optional(VELOCITY_KEY)?.unwrap_or_default();
        let driven = section.read_optional(DRIVEN_KEY)?.unwrap_or_default();
        let (parameters, values) = read_parameters(&section)?;
        let definitions = read_texts(&section, DEFINITIONS_KEY)?;
        let equations = read_texts(&section, EQUATIONS_KEY)?;
        if equations.is_empty() {
            let allowed = "add a section [model.equations] with name = \"left = right\"";
            return Err(section.key_error(EQUATIONS_KEY, "missing", allowed));
        }
        section.finish()?;
        let text = ModelText {
            dimensions,
            unknowns,
            velocity,
            parameters,
            definitions,
            equations,
            driven,
        };
        let positions = root.positions().clone();
        let model = TextModel::new(&text).map_err(|error| locate_text_error(&positions, &error))?;
        let mut slots: Vec<NumberSlot> = text
            .parameters
            .iter()
            .enumerate()
            .map(|(index, own)| NumberSlot {
                key: format!("model.{PARAMETERS_KEY}.{}", own.name),
                label: own.name.clone(),
                unit: own.unit.clone().unwrap_or_default(),
                target: SlotTarget::Parameter(index),
            })
            .collect();
        refuse_unused_options(&model, &slots, &positions)?;
        let mut numbers = CaseNumbers { equation_numbers: values, ..CaseNumbers::default() };
        let mut solved = Vec::new();
        if let Some(background) = root.open_section(&BACKGROUND_SCHEMA)? {
            let mut reader = BackgroundReader {
                section: &background,
                model: &model,
                slots: &mut slots,
                values: &mut numbers.equation_numbers,
                solved: &mut solved,
            };
            reader.read()?;
        }
        numbers.dimensions = text.dimensions;
        read_wave(root, text.dimensions, &mut numbers)?;
        Ok((Self { model: Arc::new(model), title, slots, solved, positions }, numbers))
    }

    /// Reads the section `[map]`.
    pub(crate) fn read_map(&self, root: &SectionReader) -> Result<Option<MapAxes>, CaseError> {
        let Some(section) = root.open_section(&MAP_SCHEMA)? else { return Ok(None) };
        let axis = |name: &str| -> Result<ParameterSweep, CaseError> {
            let table = section.open_required_table(name)?;
            let parameter: String = table.read_required("parameter")?;
            let (from, to) = (table.read_required("from")?, table.read_required("to")?);
            let points = table.read_required("points")?;
            let spacing = table
                .read_optional_choice("spacing", SweepSpacing::ALL, SweepSpacing::name)?
                .unwrap_or_default();
            let parameter = self.find_sweep_parameter(&parameter).ok_or_else(|| {
                let names = self.sweep_names();
                let near = find_similar_name(&parameter, names.iter().map(String::as_str));
                let found = format!("found '{}'", crate::error::escape(&parameter));
                let allowed = format_allowed("allowed", near, &names);
                table.key_error("parameter", found, allowed)
            })?;
            table.finish()?;
            let [first_value, last_value] = [from, to];
            Ok(ParameterSweep { parameter, first_value, last_value, point_count: points, spacing })
        };
        let map = MapAxes { x: axis("x")?, y: axis("y")? };
        section.finish()?;
        map.check(root.positions())?;
        Ok(Some(map))
    }

    /// Names of all numbers that a map can sweep.
    fn sweep_names(&self) -> Vec<String> {
        let wave = self.wave_keys().iter().map(|key| format!("wave.{key}"));
        self.slots.iter().map(|slot| slot.key.clone()).chain(wave).collect()
    }

    /// Keys of the section `[wave]` that matter in as many dimensions as the model has.
    fn wave_keys(&self) -> &'static [&'static str] {
        &["number", "direction_deg", "elevation_deg"][..self.model.dimensions()]
    }

    /// Returns the keys of the parameters and of the numbers of the background, in the order of their values in
    /// [`CaseNumbers::equation_numbers`].
    pub(crate) fn sweep_keys(&self) -> impl Iterator<Item = &str> {
        self.slots.iter().map(|slot| slot.key.as_str())
    }

    /// Iterates over the parameters and the numbers of the background: key in the case file, name for axes and unit, in
    /// the order of their values in [`CaseNumbers::equation_numbers`].
    pub fn number_names(&self) -> impl Iterator<Item = [&str; 3]> {
        self.slots.iter().map(|slot| [&slot.key, &slot.label, &slot.unit].map(String::as_str))
    }

    fn find_sweep_parameter(&self, name: &str) -> Option<SweepParameter> {
        match self.slots.iter().position(|slot| slot.key == name) {
            Some(index) => {
                let NumberSlot { key, label, unit, .. } = &self.slots[index];
                Some(SweepParameter::from_equation_number(index, [key, label, unit]))
            }
            None => {
                let key = name.strip_prefix("wave.")?;
                self.wave_keys().contains(&key).then(|| SweepParameter::find_by_name(name))?
            }
        }
    }

    /// Index and name of the number `key` in [`CaseNumbers::equation_numbers`].
    pub(crate) fn find_number(&self, key: &str) -> Option<usize> {
        self.slots.iter().position(|slot| slot.key == key)
    }

    /// The state of the model at the numbers of a case.
    pub fn state(&self, numbers: &CaseNumbers) -> TextState {
        let mut state = TextState { solved: self.solved.clone(), ..TextState::default() };
        for (slot, &value) in self.slots.iter().zip(&numbers.equation_numbers) {
            match slot.target {
                SlotTarget::Parameter(_) => state.parameters.push(value),
                SlotTarget::Background(variable) => {
                    state.background.push((variable, Rounded::from_rounded(value)));
                }
            }
        }
        state
    }

    /// Adds the position in the case file to an error at a state of the model.
    pub fn locate_evaluation_error(&self, error: &EvaluationError) -> CaseError {
        let key = match error {
            EvaluationError::Undefined { place, .. }
            | EvaluationError::NotFinite { place }
            | EvaluationError::Residual { place, .. } => key_of(place),
            EvaluationError::NotDetermined { .. } | EvaluationError::NoConvergence => {
                "background".to_owned()
            }
        };
        let message = error.to_string();
        let (found, allowed) = message.rsplit_once("; ").unwrap_or((&message, ""));
        let allowed = if allowed.is_empty() {
            "choose a background and parameters at which all expressions are smooth".to_owned()
        } else {
            allowed.to_owned()
        };
        self.positions.key_error(&key, found, allowed)
    }

    /// Formats the sections as TOML with all values, defaults included.
    pub(crate) fn to_toml(&self, numbers: &CaseNumbers) -> String {
        let text = self.model.text();
        let quoted = |name: &str| toml::Value::from(name).to_string();
        let units = |list: &[Quantity]| {
            let pairs = list.iter().map(|own| match &own.unit {
                Some(unit) => format!("{} = {}", quoted(&own.name), quoted(unit)),
                None => quoted(&own.name),
            });
            let pairs = pairs.collect::<Vec<_>>().join(", ");
            if list.iter().all(|own| own.unit.is_some()) {
                format!("{{ {pairs} }}")
            } else {
                format!("[{pairs}]")
            }
        };
        let mut model = TableWriter::default().with_text(KIND_KEY, EQUATIONS_KIND);
        if !self.title.is_empty() {
            model = model.with_text(TITLE_KEY, &self.title);
        }
        model = model
            .with_number(DIMENSIONS_KEY, text.dimensions)
            .with_toml(UNKNOWNS_KEY, units(&text.unknowns));
        if !text.velocity.is_empty() {
            model = model.with_text_list(VELOCITY_KEY, &text.velocity);
        }
        if !text.driven.is_empty() {
            model = model.with_text_list(DRIVEN_KEY, &text.driven);
        }
        let mut out = model.to_section_toml(&MODEL_SCHEMA);
        let mut append = |header: &str, lines: Vec<String>| {
            if !lines.is_empty() {
                out.push_str(&format!("\n[{header}]\n{}\n", lines.join("\n")));
            }
        };
        let parameters = text.parameters.iter().zip(&numbers.equation_numbers);
        append(
            "model.parameters",
            parameters
                .map(|(own, value)| match &own.unit {
                    Some(unit) => format!(
                        "{} = {{ value = {value:?}, unit = {} }}",
                        quoted(&own.name),
                        quoted(unit)
                    ),
                    None => format!("{} = {value:?}", quoted(&own.name)),
                })
                .collect(),
        );
        let texts = |list: &[NamedText]| {
            let line = |own: &NamedText| format!("{} = {}", quoted(&own.name), quoted(&own.text));
            list.iter().map(line).collect::<Vec<_>>()
        };
        append("model.define", texts(&text.definitions));
        append("model.equations", texts(&text.equations));
        append("background", self.background_lines(numbers));
        let wave = &numbers.wave;
        append(
            "wave",
            vec![
                format!("number = {:?}", wave.wave_number),
                format!("direction_deg = {:?}", wave.direction_deg),
                format!("elevation_deg = {:?}", wave.elevation_deg),
            ],
        );
        out
    }

    fn background_lines(&self, numbers: &CaseNumbers) -> Vec<String> {
        let text = self.model.text();
        let mut lines = Vec::new();
        for (unknown, own) in text.unknowns.iter().enumerate() {
            let mut entries: Vec<String> = Vec::new();
            for (slot, value) in self.slots.iter().zip(&numbers.equation_numbers) {
                if let SlotTarget::Background(variable) = slot.target
                    && variable.unknown == unknown
                {
                    entries.push(format!("{} = {value:?}", derivative_name(variable)));
                }
            }
            let solved = self.solved.iter().filter(|variable| variable.unknown == unknown);
            entries.extend(
                solved.map(|variable| format!("{} = \"{SOLVE}\"", derivative_name(*variable))),
            );
            if !entries.is_empty() {
                let name = toml::Value::from(own.name.as_str());
                lines.push(format!("{name} = {{ {} }}", entries.join(", ")));
            }
        }
        lines
    }
}

/// Key of the text in which an error was found.
fn key_of(place: &TextPlace) -> String {
    match place {
        TextPlace::Unknown(name) => format!("model.{UNKNOWNS_KEY}.{}", format_segment(name)),
        TextPlace::Velocity(_) => format!("model.{VELOCITY_KEY}"),
        TextPlace::Parameter(name) => format!("model.{PARAMETERS_KEY}.{}", format_segment(name)),
        TextPlace::Definition(name) => format!("model.{DEFINITIONS_KEY}.{}", format_segment(name)),
        TextPlace::Equation(name) => format!("model.{EQUATIONS_KEY}.{}", format_segment(name)),
        TextPlace::Driven(_) => format!("model.{DRIVEN_KEY}"),
        TextPlace::Background { unknown, derivative } if derivative.is_empty() => {
            format!("background.{}", format_segment(unknown))
        }
        TextPlace::Background { unknown, derivative } => {
            format!("background.{}.{derivative}", format_segment(unknown))
        }
    }
}

fn locate_text_error(positions: &KeyPositions, error: &TextError) -> CaseError {
    let found = format!("found {}", error.describe_found());
    positions.key_error(&key_of(&error.place), found, error.remedy.clone())
}

/// Text of a node; control characters of texts in several lines are allowed.
fn text_of(node: &Node) -> Option<String> {
    node.as_value()?.as_str().map(str::to_owned)
}

fn read_unknowns(section: &SectionReader) -> Result<Vec<Quantity>, CaseError> {
    let allowed = "expected a table with the unit of each unknown, e.g. { v1 = \"m/s\", p = \"Pa\" }, or a list of names";
    let quantity = |name: String, unit: Option<String>| Quantity { name, unit };
    let unknowns: Vec<Quantity> = match section.node(UNKNOWNS_KEY) {
        Some(Node::Table(table)) => table
            .entries()
            .map(|(name, node)| match text_of(node) {
                Some(unit) => Ok(quantity(name.to_owned(), Some(unit))),
                None => {
                    let key = format!("{UNKNOWNS_KEY}.{}", format_segment(name));
                    let found = format!("found {}", node.describe());
                    Err(section.key_error(&key, found, "expected a unit in quotes, e.g. \"m/s\""))
                }
            })
            .collect::<Result<_, _>>()?,
        Some(node) => {
            let names = node.as_value().and_then(crate::value::parse_text_list);
            let Some(names) = names else {
                let found = format!("found {}", node.describe());
                return Err(section.key_error(UNKNOWNS_KEY, found, allowed));
            };
            names.into_iter().map(|name| quantity(name, None)).collect()
        }
        None => return Err(section.key_error(UNKNOWNS_KEY, "missing", allowed)),
    };
    match unknowns.is_empty() {
        true => Err(section.key_error(UNKNOWNS_KEY, "found no unknown", allowed)),
        false => Ok(unknowns),
    }
}

/// Entries of a table with free names; empty if absent.
fn named_entries<'r, 'a>(
    section: &'r SectionReader<'a>,
    key: &str,
) -> Result<Option<&'r NodeTable<'a>>, CaseError> {
    match section.node(key) {
        None => Ok(None),
        Some(Node::Table(table)) => Ok(Some(table)),
        Some(node) => {
            let found = format!("found {}", node.describe());
            Err(section.key_error(key, found, format!("expected a section [model.{key}]")))
        }
    }
}

fn read_texts(section: &SectionReader, key: &str) -> Result<Vec<NamedText>, CaseError> {
    let Some(table) = named_entries(section, key)? else { return Ok(Vec::new()) };
    let read = |(name, node): (&str, &Node)| match text_of(node) {
        Some(text) => Ok(NamedText { name: name.to_owned(), text }),
        None => {
            let found = format!("found {}", node.describe());
            let full = format!("{key}.{}", format_segment(name));
            Err(section.key_error(
                &full,
                found,
                "expected an expression in double quotes (in a shell: --set 'KEY=\"…\"')",
            ))
        }
    };
    table.entries().map(read).collect()
}

fn read_parameters(section: &SectionReader) -> Result<(Vec<Quantity>, Vec<f64>), CaseError> {
    let Some(table) = named_entries(section, PARAMETERS_KEY)? else {
        return Ok((Vec::new(), Vec::new()));
    };
    let allowed = "expected a number, or { value = number, unit = \"...\" }";
    let (mut quantities, mut values) = (Vec::new(), Vec::new());
    for (name, node) in table.entries() {
        let key = format!("{PARAMETERS_KEY}.{}", format_segment(name));
        let refuse = |key: &str, node: &Node| {
            section.key_error(key, format!("found {}", node.describe()), allowed)
        };
        let (value, unit) = match node {
            Node::Table(inner) => {
                if let Some((other, _)) =
                    inner.entries().find(|(own, _)| !matches!(*own, "value" | "unit"))
                {
                    let full = format!("{key}.{}", format_segment(other));
                    return Err(section.key_error(
                        &full,
                        "unknown key",
                        "allowed here: value, unit",
                    ));
                }
                let value = inner.node("value").and_then(Node::as_value).and_then(parse_number);
                let unit = match inner.node("unit") {
                    None => None,
                    Some(own) => {
                        Some(text_of(own).ok_or_else(|| refuse(&format!("{key}.unit"), own))?)
                    }
                };
                (value, unit)
            }
            Node::Value(value) => (parse_number(value), None),
            Node::Tables(_) => (None, None),
        };
        values.push(value.ok_or_else(|| refuse(&key, node))?);
        quantities.push(Quantity { name: name.to_owned(), unit });
    }
    Ok((quantities, values))
}

/// Refuses options that set a parameter which no equation uses, such as one with a mistyped name.
fn refuse_unused_options(
    model: &TextModel,
    slots: &[NumberSlot],
    positions: &KeyPositions,
) -> Result<(), CaseError> {
    let unused = model.unused_parameters();
    let is_used = |slot: &&NumberSlot| !unused.contains(&slot.label);
    match slots.iter().find(|slot| !is_used(slot) && positions.has_option(&slot.key)) {
        Some(slot) => {
            let names: Vec<&str> =
                slots.iter().filter(is_used).map(|own| own.key.as_str()).collect();
            let near = find_similar_name(&slot.key, names.iter().copied());
            let allowed = match names.is_empty() {
                true => "leave it out: no equation has a parameter".to_owned(),
                false => format_allowed("allowed", near, &names),
            };
            Err(positions.key_error(&slot.key, "used by no equation", allowed))
        }
        None => Ok(()),
    }
}

fn read_wave(
    root: &SectionReader,
    dimensions: usize,
    numbers: &mut CaseNumbers,
) -> Result<(), CaseError> {
    numbers.wave.wave_number = 1000.0;
    let Some(section) = root.open_section(&WAVE_SCHEMA)? else { return Ok(()) };
    let wave = &mut numbers.wave;
    wave.wave_number = section.read_or_default("number")?;
    wave.direction_deg = section.read_or_default("direction_deg")?;
    wave.elevation_deg = section.read_or_default("elevation_deg")?;
    for (key, value, least) in
        [("direction_deg", wave.direction_deg, 2), ("elevation_deg", wave.elevation_deg, 3)]
    {
        if value != 0.0 && dimensions < least {
            let found = format!("found {value:?} in {dimensions} dimensions");
            return Err(section.key_error(key, found, "expected 0"));
        }
    }
    section.finish()
}

/// Whether a case with this `model.kind` is given as equations.
pub(crate) fn is_equations_kind(kind: Option<&str>) -> bool {
    kind == Some(EQUATIONS_KIND)
}
