//! Material of a case or of a region.

use super::entries::{CaseEntries, find_model_kind};
use super::error::CaseError;
use super::key_positions::KeyPositions;
use super::keys::{Key, SweepParameter, keys};
use super::kind::{MediumKind, ModelKind, NO_YIELD_NAME, YieldSetKind, join_names};
use super::numbers::CaseNumbers;
use super::plane_wave::ContactMedium;
use super::scalar_keys;
use super::section::SectionReader;
use super::value::CaseValue;
use crate::node::Node;
use crate::schema::SchemaScope;
use models::InputError;

/// Kind of model, yield set and numbers of a medium, with the positions of their keys in the case file.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Kind of model.
    pub kind: ModelKind,
    /// Yield set; `None` in flows and elastic solids.
    pub yield_set: Option<YieldSetKind>,
    /// Active yield conditions, as indices into [`MediumKind::yield_condition_names`]; `None` if they follow from the
    /// stress.
    pub active_conditions: Option<Vec<usize>>,
    /// Contacts of a granular or porous medium, whose particles or skeleton the model describes.
    pub contacts: Option<ContactMedium>,
    /// Numbers in SI units, angles in degrees.
    pub numbers: CaseNumbers,
    /// Positions of the keys in the case file; ignored in comparisons.
    pub(super) positions: KeyPositions,
}

impl Material {
    /// Builds the material of a region: this material, overridden by kind, yield set and numbers of the region.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value is invalid.
    pub(super) fn override_for_region(
        &self,
        entries: &CaseEntries,
        region: &SectionReader,
        dimensions: usize,
    ) -> Result<Self, CaseError> {
        const MODEL_KIND_KEY: &str = "model.kind";
        let mut entries = entries.to_region_entries(region)?;
        let kind = find_model_kind(
            entries.require_text(MODEL_KIND_KEY)?,
            MODEL_KIND_KEY,
            &entries.positions,
        )?;
        let ModelKind::Solid(_) = kind else {
            let allowed = format!("expected one of {}", join_names(&ModelKind::solid_kinds()));
            return Err(entries.positions.key_error(
                MODEL_KIND_KEY,
                format!("found {}, a flow", kind.name()),
                allowed,
            ));
        };
        if let Some(set) = self.yield_set.filter(|set| !kind.admissible_yield_sets().contains(set))
            && entries.is_inherited("yield.kind")
        {
            let names: Vec<&str> =
                kind.admissible_yield_sets().iter().map(|set| set.name).collect();
            return Err(entries.positions.key_error(
                MODEL_KIND_KEY,
                format!("found {}, which does not admit the yield set {}", kind.name(), set.name),
                format!("add yield = {{ kind = ... }} with one of none, {}", names.join(", ")),
            ));
        }
        set_default_dimensions(&mut entries, kind, dimensions);
        let yields = scalar_keys::read_yield_set(&entries, kind, &[NO_YIELD_NAME])?;
        let medium = MediumKind { kind, yield_set: yields };
        if kind != self.kind {
            // Values for keys used by the kind of the case but not by the kind of the region are not inherited.
            entries.remove_unused_inherited(|name| {
                Key::find_by_name(name)
                    .is_some_and(|key| key.is_used_by(medium) && key.storage.is_stored())
            });
        }
        let mut numbers = scalar_keys::read_numbers(&entries, &[medium])?;
        check_dimensions(&entries.positions, kind, numbers.dimensions, dimensions)?;
        let active = scalar_keys::read_active_conditions(&entries, medium)?;
        (numbers.stress, numbers.wave) = (self.numbers.stress, self.numbers.wave);
        for key in keys().iter().filter(|key| !key.is_used_by(medium)) {
            key.reset_value(&mut numbers);
        }
        Ok(Self {
            kind,
            yield_set: yields,
            active_conditions: active,
            contacts: self.contacts.clone(),
            numbers,
            positions: entries.positions,
        })
    }

    /// Returns the error of a rheological scheme or a model given as equations where a flow or a solid is needed.
    pub fn unsuitable_kind_error(&self) -> InputError {
        if self.kind == ModelKind::Equations {
            return InputError {
                input: "kind",
                rejected_value: "a model given as equations".to_owned(),
                allowed_values: "expected a flow or a solid of the program; wellposed point, map and check take models \
                                 given as equations"
                    .to_owned(),
            };
        }
        InputError {
            input: "rheology",
            rejected_value: "a rheological scheme".to_owned(),
            allowed_values:
                "expected a flow or a solid; wellposed diagram computes the response of a \
                             scheme"
                    .to_owned(),
        }
    }

    /// Whether the medium can flow plastically: by a yield set, or by the yield stress of particles or of a skeleton.
    pub fn is_plastic(&self) -> bool {
        self.yield_set.is_some() || self.contacts.as_ref().is_some_and(ContactMedium::is_plastic)
    }

    /// Returns the kind of model and the yield set.
    pub fn medium(&self) -> MediumKind {
        MediumKind { kind: self.kind, yield_set: self.yield_set }
    }

    /// Returns the value of the number `name`; `None` if absent.
    pub fn number(&self, name: &str) -> Option<f64> {
        SweepParameter::find_by_name(name)?.value(&self.numbers)
    }

    /// Sets the number `parameter`, as a map sweep does.
    pub fn set_number(&mut self, parameter: SweepParameter, value: f64) {
        parameter.set_value(&mut self.numbers, value);
    }

    /// Adds the position in the case file to an input error of a model.
    pub fn locate_error(&self, error: InputError) -> CaseError {
        let key = self.case_key(error.input);
        self.positions.key_error(
            key,
            format!("found {}", error.rejected_value),
            error.allowed_values,
        )
    }

    /// Adds the position in the case file to an input error of the granular or porous medium.
    pub fn locate_medium_error(&self, error: InputError) -> CaseError {
        let section = self.contacts.as_ref().map_or("model", ContactMedium::section);
        let key = match error.input {
            "density" => "model.density".to_owned(),
            "bulk_modulus" => "model.lambda".to_owned(),
            "shear_modulus" => "model.mu".to_owned(),
            input => format!("{section}.{input}"),
        };
        let found = format!("found {}", error.rejected_value);
        self.positions.key_error(&key, found, error.allowed_values)
    }

    /// Returns the case key of an input of the model, yield set or state; other names are returned unchanged.
    pub(super) fn case_key(&self, input: &'static str) -> &'static str {
        const INPUT_SECTIONS: [&str; 4] = ["model", "background", "yield", "stress"];
        let medium = self.medium();
        let is_input = |key: &&Key| {
            let (section, name) = key.split_section();
            let name = name.strip_suffix("_deg").unwrap_or(name);
            INPUT_SECTIONS.contains(&section) && name == input
        };
        let all = || keys().iter().filter(is_input);
        let found = all().find(|key| key.is_used_by(medium)).or_else(|| all().next());
        found.map_or(input, |key| key.name)
    }

    /// Returns the keys used by this medium or by the kinds `compared`, with their values.
    pub(super) fn key_values(
        &self,
        compared: &[ModelKind],
    ) -> impl Iterator<Item = (&'static Key, CaseValue)> {
        keys().iter().filter_map(|key| {
            let value = match key.name {
                "model.kind" => Some(CaseValue::Text(self.kind.name().to_owned())),
                "yield.kind" => self.yield_set.map(|set| CaseValue::Text(set.name.to_owned())),
                "yield.active" => self.active_conditions.as_ref().map(|active| {
                    let names = self.medium().yield_condition_names();
                    CaseValue::TextList(
                        active.iter().map(|&index| names[index].to_owned()).collect(),
                    )
                }),
                // `yield.active` replaces the section `[stress]`.
                name if name.starts_with("stress.") && self.active_conditions.is_some() => None,
                _ if key.is_used_by(self.medium())
                    || compared.iter().any(|&kind| key.is_used_by(kind)) =>
                {
                    key.storage.load_value(&self.numbers)
                }
                _ => None,
            };
            value.map(|value| (key, value))
        })
    }
}

/// Supplies the dimensions of a solid from the grid if they are not given.
pub(super) fn set_default_dimensions(
    entries: &mut CaseEntries,
    kind: ModelKind,
    grid_dimensions: usize,
) {
    const DIMENSIONS_KEY: &str = "model.dimensions";
    if Key::find_by_name(DIMENSIONS_KEY).is_some_and(|key| key.is_used_by(kind)) {
        entries.set_default(DIMENSIONS_KEY, CaseValue::Count(grid_dimensions));
    }
}

/// Checks that `grid.cells` has as many entries as `model.dimensions` states.
pub(super) fn check_cell_counts(entries: &CaseEntries, kind: ModelKind) -> Result<(), CaseError> {
    let root = entries.structured_reader(SchemaScope::default());
    let Some(Node::Table(grid)) = root.node("grid") else { return Ok(()) };
    let cells = grid.node("cells").and_then(Node::as_value).and_then(|value| value.as_array());
    let Some(count) = cells.map(|cells| cells.len()).filter(|count| [2, 3].contains(count)) else {
        return Ok(());
    };
    let stated = match (kind, entries.value("model.dimensions")) {
        (ModelKind::Solid(solid), _) if solid.is_plane => 2,
        (_, Some(&CaseValue::Count(stated))) => stated,
        _ => return Ok(()),
    };
    if stated == count || entries.positions.has_option("model.dimensions") {
        return Ok(());
    }
    let found = format!("found {count} entries for a solid in {stated} dimensions");
    let allowed = match stated {
        2 => {
            "expected 2 entries, such as [200, 200]; for a solid in space set model.dimensions = 3, and give \
             grid.spacing, grid.origin and all points three entries too"
        }
        _ => "expected 3 entries, as model.dimensions states; or set model.dimensions = 2",
    };
    Err(entries.positions.key_error("grid.cells", found, allowed))
}

/// Checks that a solid has as many dimensions as the grid.
pub(super) fn check_dimensions(
    positions: &KeyPositions,
    kind: ModelKind,
    dimensions: usize,
    grid_dimensions: usize,
) -> Result<(), CaseError> {
    let d = grid_dimensions;
    if matches!(kind, ModelKind::Solid(solid) if solid.is_plane) {
        let found = format!("found {} in a grid of {d} dimensions", kind.name());
        let allowed = "expected 2 entries of grid.cells: this is a solid in plane strain";
        return if d == 2 {
            Ok(())
        } else {
            Err(positions.key_error("model.kind", found, allowed))
        };
    }
    if dimensions != d {
        let found = format!("found {dimensions} in a grid of {d} dimensions");
        let allowed =
            format!("expected {d}, the number of entries of grid.cells; or leave the key out");
        return Err(positions.key_error("model.dimensions", found, allowed));
    }
    Ok(())
}
