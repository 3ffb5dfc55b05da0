//! Material of a case or of a region.

use super::entries::{Entries, kind};
use super::error::CaseError;
use super::flat;
use super::keys::{Key, Parameter, keys};
use super::kind::{Kind, Medium, NO_YIELD, Yield, names};
use super::numbers::Numbers;
use super::place::Places;
use super::section::Section;
use super::value::Value;
use models::InputError;

/// Kind of model, yield set and numbers of a medium, with the positions of their keys in the case file.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Kind of model.
    pub kind: Kind,
    /// Yield set; `None` in flows and elastic solids.
    pub yields: Option<Yield>,
    /// Active yield conditions, as indices into [`Medium::condition_names`]; `None` if they follow from the stress.
    pub active: Option<Vec<usize>>,
    /// Numbers in SI units, angles in degrees.
    pub numbers: Numbers,
    /// Positions of the keys in the case file; ignored in comparisons.
    pub(super) places: Places,
}

impl Material {
    /// Builds the material of a region: this material, overridden by kind, yield set and numbers of the region.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value is invalid.
    pub(super) fn of_region(
        &self,
        entries: &Entries,
        region: &Section,
        dimensions: usize,
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
        provide_dimensions(&mut entries, kind, dimensions);
        let yields = flat::yield_set(&entries, kind, &[NO_YIELD])?;
        let medium = Medium { kind, yields };
        if kind != self.kind {
            // Values for keys used by the kind of the case but not by the kind of the region are not inherited.
            entries.keep_inherited(|name| {
                Key::find(name).is_some_and(|key| key.is_used_by(medium) && key.field.is_kept())
            });
        }
        let mut numbers = flat::numbers(&entries, &[medium])?;
        check_dimensions(&entries.places, kind, numbers.dimensions, dimensions)?;
        let active = flat::active(&entries, medium)?;
        (numbers.stress, numbers.wave) = (self.numbers.stress, self.numbers.wave);
        for key in keys().iter().filter(|key| !key.is_used_by(medium)) {
            key.clear(&mut numbers);
        }
        Ok(Self { kind, yields, active, numbers, places: entries.places })
    }

    /// Returns the kind of model and the yield set.
    pub fn medium(&self) -> Medium {
        Medium { kind: self.kind, yields: self.yields }
    }

    /// Returns the value of the number `name`; `None` if absent.
    pub fn get(&self, name: &str) -> Option<f64> {
        Parameter::find(name)?.get(&self.numbers)
    }

    /// Sets the number `parameter`, as a map sweep does.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        parameter.set(&mut self.numbers, value);
    }

    /// Adds the position in the case file to an input error of a model.
    pub fn locate(&self, error: InputError) -> CaseError {
        let key = self.key_of(error.input);
        self.places.error(key, format!("found {}", error.found), error.allowed)
    }

    /// Returns the case key of an input of the model, yield set or state; other names are returned unchanged.
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

    /// Returns the keys used by this medium or by the kinds `compared`, with their values.
    pub(super) fn values(&self, compared: &[Kind]) -> impl Iterator<Item = (&'static Key, Value)> {
        keys().iter().filter_map(|key| {
            let value = match key.name {
                "model.kind" => Some(Value::Text(self.kind.name().to_owned())),
                "yield.kind" => self.yields.map(|set| Value::Text(set.name.to_owned())),
                "yield.active" => self.active.as_ref().map(|active| {
                    let names = self.medium().condition_names();
                    Value::Texts(active.iter().map(|&index| names[index].to_owned()).collect())
                }),
                // `yield.active` replaces the section `[stress]`.
                name if name.starts_with("stress.") && self.active.is_some() => None,
                _ if key.is_used_by(self.medium())
                    || compared.iter().any(|&kind| key.is_used_by(kind)) =>
                {
                    key.field.load(&self.numbers)
                }
                _ => None,
            };
            value.map(|value| (key, value))
        })
    }
}

/// Supplies the dimensions of a solid from the grid if they are not given.
pub(super) fn provide_dimensions(entries: &mut Entries, kind: Kind, of_grid: usize) {
    const KEY: &str = "model.dimensions";
    if Key::find(KEY).is_some_and(|key| key.is_used_by(kind)) {
        entries.provide(KEY, Value::Count(of_grid));
    }
}

/// Checks that a solid has as many dimensions as the grid.
pub(super) fn check_dimensions(
    places: &Places,
    kind: Kind,
    dimensions: usize,
    of_grid: usize,
) -> Result<(), CaseError> {
    let d = of_grid;
    if matches!(kind, Kind::Solid(solid) if solid.is_plane) {
        let found = format!("found {} in a grid of {d} dimensions", kind.name());
        let allowed = "it is a solid in plane strain: grid.cells must have 2 entries";
        return if d == 2 { Ok(()) } else { Err(places.error("model.kind", found, allowed)) };
    }
    if dimensions != d {
        let found = format!("found {dimensions} in a grid of {d} dimensions");
        let allowed = format!("give as many as entries of grid.cells, {d}, or leave it out");
        return Err(places.error("model.dimensions", found, allowed));
    }
    Ok(())
}
