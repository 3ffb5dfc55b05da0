//! Parts that a study needs of a case, with errors that say how to add them.

use super::Case;
use crate::equations::EquationsCase;
use crate::error::CaseError;
use crate::map::MapAxes;
use crate::plane_wave::{ContactMedium, PlaneWaveOptions};
use crate::rheology::RheologyCase;
use models::InputError;

impl Case {
    /// Returns the model given as equations.
    ///
    /// # Errors
    /// The case has a model of another kind.
    pub fn require_equations(&self) -> Result<&EquationsCase, CaseError> {
        self.equations.as_ref().ok_or_else(|| {
            let found = format!("found {}", self.material.kind.name());
            let allowed =
                "this needs a model given as equations: wellposed new equations writes one";
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
            let allowed = "this needs a rheological scheme: a case with the sections [rheology] and \
                           [load_path] in place of [model]; wellposed new rheology writes one";
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
            let axis =
                "{ parameter = \"model.friction_angle_deg\", from = 5, to = 60, points = 56 }";
            self.material.positions.key_error(
                "map",
                "missing",
                format!("add a section [map] with x = {axis} and y"),
            )
        })
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
            self.material.positions.key_error(missing, "missing", allowed)
        })
    }

    /// Returns the contacts of the granular or porous medium of the case.
    ///
    /// # Errors
    /// The case has no such medium; the message says how to add one.
    pub fn require_contacts(&self) -> Result<&ContactMedium, CaseError> {
        self.material.contacts.as_ref().ok_or_else(|| {
            let allowed = "add a section [porous] with porosity and contact_bulk_modulus, or [granular] \
                           with friction";
            self.material.positions.key_error("porous", "missing", allowed)
        })
    }

    /// Checks that the case describes no granular or porous medium, for studies of solids without contacts.
    ///
    /// # Errors
    /// The case has a section `[granular]` or `[porous]`.
    pub fn check_without_contacts(&self) -> Result<(), CaseError> {
        let Some(own) = &self.material.contacts else { return Ok(()) };
        let allowed = "use wellposed shocks, or leave the section out to analyse the elastic solid of \
                       [model]";
        let found = "found; this analyses solids without contacts and pores";
        Err(self.material.positions.key_error(own.section(), found, allowed))
    }
}
