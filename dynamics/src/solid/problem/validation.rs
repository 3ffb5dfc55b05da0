//! Consistency of a problem, and the stability limit of its time step.

use super::{DomainError, PlasticStep, Problem, SHEAR_INTERVALS};
use crate::solid::boundary::{Boundary, Load, Source};
use crate::solid::interlayers::Interlayers;
use crate::solid::medium::Medium;
use crate::solid::reconstruction::Slopes;
use crate::solid::region::Region;
use crate::solid::shear_steps::ShearSteps;
use models::solid::waves::SolidField;

impl<const D: usize> Problem<D> {
    /// Checks that all parts of the problem are consistent, and the stability limit of the time step.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn validate(&self) -> Result<(), DomainError> {
        self.validate_in_region(&Region::from_grid(self.grid.cells))
    }

    /// Checks the problem of a region (see [`Self::restrict_to`]) as [`Self::validate`] does.
    pub(crate) fn validate_in_region(&self, region: &Region<D>) -> Result<(), DomainError> {
        let expected = region.count();
        let stored = if self.medium_function.is_some() { 0 } else { expected };
        if expected == 0 || self.cell_media.len() != stored {
            return Err(DomainError::CellCount { actual: self.cell_media.len(), expected });
        }
        let Some(first) = self.media.first() else { return Err(DomainError::Media) };
        let is_admissible = |own: &Medium| own.fields == first.fields && own.pairs.len() == D;
        if !self.media.iter().all(is_admissible) {
            return Err(DomainError::Media);
        }
        let count = self.media.len();
        if let Some(cell) = self.cell_media.iter().position(|&m| usize::from(m) >= count) {
            let medium = usize::from(self.cell_media[cell]);
            return Err(DomainError::UnknownMedium { cell, medium, count });
        }
        self.check_metric()?;
        self.check_contacts()?;
        self.check_overstress()?;
        self.check_shear_interval()?;
        self.check_wide_stencil()?;
        let steps = ShearSteps::new(self);
        for (axis, boundaries_of_axis) in self.boundaries.iter().enumerate() {
            let pairs = self.media.iter().flat_map(|m| &m.pairs[axis]);
            let speeds = pairs.map(|pair| 2.0 * steps.sweep_fractions(pair)[0] * pair.speed());
            let spacing = match &self.metric {
                Some(metric) if axis == 0 => metric.min_spacing(),
                _ => self.grid.spacing[axis],
            };
            let courant = 0.5 * self.step * speeds.fold(0.0, f64::max) / spacing;
            // A step computed from the Courant number may exceed it by rounding.
            if courant.is_nan() || courant > 1.0 + 1e-11 {
                return Err(DomainError::Courant { axis, courant });
            }
            for condition in boundaries_of_axis {
                let actual = match condition {
                    Boundary::ByPair(conditions) => conditions.len(),
                    Boundary::ByFace(conditions)
                        if conditions.iter().any(|own| own.len() != region.faces(axis)) =>
                    {
                        0
                    }
                    Boundary::ByFace(conditions) => conditions.len(),
                    _ => continue,
                };
                let expected = first.pairs[axis].len();
                if actual != expected {
                    return Err(DomainError::ConditionCount { axis, actual, expected });
                }
            }
            let [one, other] =
                boundaries_of_axis.each_ref().map(|condition| *condition == Boundary::Periodic);
            if one != other {
                return Err(DomainError::Periodic(axis));
            }
        }
        self.check_interlayers()?;
        self.check_loads_and_sources(region)
    }

    /// Checks that the problem is plane if it has a metric, that the metric has values for all layers, and that the
    /// problem has nothing that requires a uniform metric.
    fn check_metric(&self) -> Result<(), DomainError> {
        let Some(metric) = &self.metric else { return Ok(()) };
        let is_curved = !metric.curvature.is_empty();
        let refuse = |reason| Err(DomainError::Metric(reason));
        if D != 2 {
            return refuse("it is for blocks in the plane");
        }
        if !metric.is_valid(self.grid.cells[D - 1]) {
            return refuse("every layer needs a positive spacing, and a curvature if any has one");
        }
        if self.scheme.is_alternating() || !self.interlayers.is_empty() {
            return refuse("sweeps must not alternate, and there must be no interlayers");
        }
        if (is_curved || !metric.field_factors.is_empty()) && self.initial_stress.is_some() {
            return refuse("there must be no initial stress in a curved block");
        }
        if !metric.field_factors.is_empty() && self.boundaries[D - 1][0] == Boundary::Periodic {
            return refuse("boundaries across the layers of a polar block cannot be periodic");
        }
        if is_curved && self.acceleration != [0.0; D] {
            return refuse("an acceleration has no one direction in a curved block");
        }
        Ok(())
    }

    /// Checks that a problem with a wide stencil has nothing that would change the medium or the cell length within a
    /// stencil, that lines are as long as their ghosts, and that all sides have mirror images: zeros beyond a
    /// non-reflecting side would return short waves, since a wide stencil reads the outgoing wave there too.
    fn check_wide_stencil(&self) -> Result<(), DomainError> {
        let slopes = self.scheme.slopes;
        if !slopes.is_wide() {
            return Ok(());
        }
        let refuse = |reason| Err(DomainError::WideStencil(reason));
        if self.media.len() > 1 || !self.interlayers.is_empty() || self.metric.is_some() {
            return refuse("it is for one medium on a uniform grid without interlayers");
        }
        if self.grid.cells.iter().any(|cells| *cells < slopes.ghosts()) {
            return refuse("an axis has fewer cells than its stencil beside a boundary");
        }
        if self.boundaries.iter().flatten().any(Boundary::has_open_faces) {
            return refuse("a side is non-reflecting");
        }
        Ok(())
    }

    /// Checks that a problem with contacts has nothing that the laws of contacts exclude.
    fn check_contacts(&self) -> Result<(), DomainError> {
        if !self.has_contacts() {
            return Ok(());
        }
        let refuse = |reason| Err(DomainError::Contacts(reason));
        if self.scheme.is_alternating() || self.shear_interval > 1 {
            return refuse("sweeps must not alternate, and all waves must have the same step");
        }
        if self.scheme.plastic_step == PlasticStep::MidpointReflection {
            return refuse("the return mapping must be at the end of the step");
        }
        if !matches!(self.scheme.slopes, Slopes::Godunov | Slopes::Limited) {
            return refuse("the reconstruction must be limited or of first order");
        }
        if self.initial_stress.is_some() || !self.interlayers.is_empty() {
            return refuse("there must be no initial stress and no interlayers");
        }
        let steps = self.media.iter().filter_map(|medium| medium.contact?.damped_spring());
        if steps.map(|own| own.0).any(|step| (step - self.step).abs() > 1e-9 * self.step) {
            return refuse("parallel dashpots must be those of this time step");
        }
        let is_velocity = |field: &SolidField| matches!(field, SolidField::Velocity(_));
        let mut amplitudes = self.sources.iter().flat_map(|source| &source.amplitudes);
        if !amplitudes.all(|(field, _)| is_velocity(field)) {
            return refuse("sources must be forces");
        }
        Ok(())
    }

    /// Checks that the relaxation times of overstresses are positive and that the return mapping is not a reflection.
    fn check_overstress(&self) -> Result<(), DomainError> {
        let mut times = self.media.iter().filter_map(|medium| medium.overstress_time).peekable();
        let is_reflection = self.scheme.plastic_step == PlasticStep::MidpointReflection;
        if times.peek().is_some() && is_reflection {
            return Err(DomainError::Overstress(
                "the return mapping must be at the end of the step",
            ));
        }
        match times.all(|time| time > 0.0 && time.is_finite()) {
            true => Ok(()),
            false => Err(DomainError::Overstress("it must be positive and finite")),
        }
    }

    /// Checks that shear waves may have steps of their own, if they have.
    fn check_shear_interval(&self) -> Result<(), DomainError> {
        let refuse = |reason| Err(DomainError::ShearInterval(reason));
        if !SHEAR_INTERVALS.contains(&self.shear_interval) {
            return refuse("it must be 1, 2 or 3");
        }
        if self.shear_interval == 1 {
            return Ok(());
        }
        if self.scheme.is_alternating() || self.metric.is_some() {
            return refuse("it needs a rectangular block and two-cyclic sweeps");
        }
        let has_independent_components =
            |own: &Interlayers| own.laws.iter().all(|law| law.normal_variable_count().is_some());
        if !self.interlayers.iter().all(has_independent_components) {
            return refuse("interlayers must have independent normal and tangential components");
        }
        Ok(())
    }

    /// Checks that loads, sources and the initial stress refer to existing faces, wave pairs, cells, fields and layers,
    /// and that no load acts on a periodic boundary.
    fn check_loads_and_sources(&self, region: &Region<D>) -> Result<(), DomainError> {
        let is_invalid = |load: &Load| {
            load.axis >= D
                || load.end > 1
                || load.pair >= self.media[0].pairs[load.axis].len()
                || load.faces.iter().any(|&(face, _)| face >= region.faces(load.axis))
                || self.boundaries[load.axis][load.end] == Boundary::Periodic
        };
        if let Some(index) = self.loads.iter().position(is_invalid) {
            return Err(DomainError::Load(index));
        }
        let fields = &self.media[0].fields;
        let is_invalid = |source: &Source| {
            source.cells.iter().any(|&(cell, _)| cell >= region.count())
                || source.amplitudes.iter().any(|(field, _)| !fields.contains(field))
        };
        if let Some(index) = self.sources.iter().position(is_invalid) {
            return Err(DomainError::Source(index));
        }
        match &self.initial_stress {
            Some((axis, stress)) if self.grid.cells.get(*axis) != Some(&stress.len()) => {
                Err(DomainError::InitialStress)
            }
            _ => Ok(()),
        }
    }
}
