//! Parts that a study needs of a case, with errors that say how to add them.

use super::Case;
use crate::equations::EquationsCase;
use crate::error::CaseError;
use crate::keys::SweepParameter;
use crate::kind::ModelKind;
use crate::map::MapAxes;
use crate::plane_wave::{ContactMedium, PlaneWaveOptions};
use crate::rheology::RheologyCase;
use crate::template::choose_example_axes;
use models::InputError;
use models::common::decimal::format_exact;
use models::registry;

impl Case {
    /// Returns the model given as equations.
    ///
    /// # Errors
    /// The case has a model of another kind.
    pub fn require_equations(&self) -> Result<&EquationsCase, CaseError> {
        self.equations.as_ref().ok_or_else(|| {
            let found = format!("found {}", self.material.kind.name());
            let allowed = "expected a model given as equations: wellposed new equations writes one";
            self.material.positions.key_error("model.kind", found, allowed)
        })
    }

    /// Checks that the case describes a flow or a solid.
    ///
    /// # Errors
    /// The case describes a rheological scheme.
    pub fn require_model(&self) -> Result<(), CaseError> {
        match self.rheology {
            None => Ok(()),
            Some(_) => Err(self.locate_error(self.rheology_error())),
        }
    }

    /// Returns the rheological scheme of the case with its load path.
    ///
    /// # Errors
    /// The case has no sections `[rheology]` and `[load_path]`; the message says how to add them.
    pub fn require_rheology(&self) -> Result<&RheologyCase, CaseError> {
        self.rheology.as_ref().ok_or_else(|| {
            let found = format!("found {}", self.material.kind.name());
            let allowed = "expected a rheological scheme, which wellposed new rheology writes; wellposed point, map and run \
                           are for flows and solids";
            self.material.positions.key_error("model.kind", found, allowed)
        })
    }

    /// Returns the error of a rheological scheme where a flow or a solid is needed.
    pub(crate) fn rheology_error(&self) -> InputError {
        self.material.unsuitable_kind_error()
    }

    /// Returns the section `[map]`.
    ///
    /// # Errors
    /// The case has no section `[map]`; the message says how to add one.
    pub fn require_map(&self) -> Result<&MapAxes, CaseError> {
        self.map.as_ref().ok_or_else(|| {
            let [x, y] = self.example_map_axes();
            let allowed = format!(
                "add a section [map] with the two parameters to vary, each on its line: x = {x} and y = {y}"
            );
            self.material.positions.key_error("map", "missing", allowed)
        })
    }

    /// Returns two axes of a map that suit the case: for an elastic solid or a model given as equations, half to one and
    /// a half times the first two numbers that are not zero.
    fn example_map_axes(&self) -> [String; 2] {
        let medium = self.medium();
        let is_generic = match medium.kind {
            ModelKind::Solid(_) => medium.yield_set.is_none(),
            ModelKind::Flow(_) => false,
            ModelKind::Equations | ModelKind::Rheology => true,
        };
        let own: Vec<(String, f64)> = match &self.equations {
            Some(equations) => equations
                .sweep_keys()
                .zip(&self.material.numbers.equation_numbers)
                .map(|(key, value)| (key.to_owned(), *value))
                .collect(),
            None => SweepParameter::all_parameters()
                .filter(|own| own.key().name.starts_with("model.") && own.key().is_used_by(medium))
                .filter_map(|own| Some((own.name(), own.value(&self.material.numbers)?)))
                .collect(),
        };
        let mut axes = own.iter().filter(|(_, value)| *value != 0.0).map(|(name, value)| {
            let [from, to] = [0.5 * value, 1.5 * value];
            {
                let [from, to] = [from.min(to), from.max(to)].map(format_exact);
                format!("{{ parameter = \"{name}\", from = {from}, to = {to}, points = 41 }}")
            }
        });
        match (is_generic, axes.next(), axes.next()) {
            (true, Some(x), Some(y)) => [x, y],
            _ => choose_example_axes(medium),
        }
    }

    /// Returns the loads of plane waves in the granular or porous medium of the case.
    ///
    /// # Errors
    /// The case has no granular or porous medium, or no load; the message says how to add one.
    pub fn require_plane_wave(&self) -> Result<&PlaneWaveOptions, CaseError> {
        self.plane_wave.as_ref().ok_or_else(|| {
            let allowed = "add a section [porous] with porosity and contact_bulk_modulus, or [granular] \
                           with friction, and [piston] with pressure or speed";
            let missing = if self.material.contacts.is_some() { "piston" } else { "porous" };
            self.solid_section_error(missing, allowed)
        })
    }

    /// Returns the contacts of the granular or porous medium of the case.
    ///
    /// # Errors
    /// The case has no such medium; the message says how to add one.
    pub fn require_contacts(&self) -> Result<&ContactMedium, CaseError> {
        self.material.contacts.as_ref().ok_or_else(|| {
            let kind = self.material.kind;
            if matches!(kind, ModelKind::Solid(own) if own != registry::CLASSICAL) {
                let found = format!("found {}", kind.name());
                let allowed = "expected a classical solid with a section [porous] or [granular], as in \
                               wellposed cases show foam-open";
                return self.material.positions.key_error("model.kind", found, allowed);
            }
            let allowed = "add a section [porous] with porosity and contact_bulk_modulus, or [granular] \
                           with friction";
            self.solid_section_error("porous", allowed)
        })
    }

    /// Creates the error for a missing section of a solid; in a flow, that for its kind, which no section changes.
    pub(crate) fn solid_section_error(&self, section: &str, allowed: &str) -> CaseError {
        match self.medium().kind {
            kind @ ModelKind::Flow(_) => {
                let found = format!("found '{}', a flow", kind.name());
                let allowed = format!("expected a solid such as classical; {allowed}");
                self.material.positions.key_error("model.kind", found, allowed)
            }
            _ => self.material.positions.key_error(section, "missing", allowed),
        }
    }

    /// Checks that the case describes no granular or porous medium, for studies of solids without contacts.
    ///
    /// # Errors
    /// The case has a section `[granular]` or `[porous]`.
    pub fn check_without_contacts(&self) -> Result<(), CaseError> {
        let Some(own) = &self.material.contacts else { return Ok(()) };
        let allowed = "use wellposed shocks or run, or leave the section out to analyse the elastic solid of [model]";
        let found = "not used here: this command takes solids without contacts and pores";
        Err(self.material.positions.key_error(own.section(), found, allowed))
    }
}
