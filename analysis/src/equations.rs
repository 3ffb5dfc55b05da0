//! Analysis of models given as equations in text, in one, two or three dimensions.

use crate::bound::{self, Supremum};
use crate::flows::FlowWorkspace;
use crate::growth::{self, Assessment, Verdict};
use crate::line::assess_line;
use crate::pencil::{Pencil, PencilRoots};
use crate::space::{self, SpaceAssessment, SpaceWorkspace, assess_space};
use crate::{AnalysisError, StateError};
use models::LinearisedSystem;
use models::common::elementary::Elementary;
use models::equations::{TextModel, TextState, TextWorkspace};

/// Reusable memory for assessing states one after another; use one per thread.
#[derive(Clone, Debug, Default)]
pub struct EquationsWorkspace {
    text: TextWorkspace,
    /// Linearised equations without eliminated unknowns, and pencil, of the last state in one or two dimensions.
    pub plane: FlowWorkspace,
    /// Linearised equations of the last state in three dimensions without eliminated unknowns.
    pub space_system: LinearisedSystem<3>,
    space: SpaceWorkspace,
}

/// Verdict on a state of a model given as equations.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationsAssessment {
    /// The verdict with its evidence; in space that of the plane of wave vectors that decides, see [`space`](mod@crate::space).
    pub assessment: Assessment,
    /// Unit wave vector of the fastest growth, with as many components as dimensions; `None` unless ill-posed.
    pub direction: Option<Vec<f64>>,
    /// Unit vectors that span the plane that decides; `None` except in three dimensions.
    pub plane: Option<[[f64; 3]; 2]>,
}

impl EquationsWorkspace {
    /// Determines the background derivatives that `state` asks for, checks that the background satisfies the equations,
    /// and assesses the linearised equations.
    ///
    /// # Errors
    /// See [`StateError`].
    pub fn assess(
        &mut self,
        model: &TextModel,
        state: &mut TextState,
    ) -> Result<EquationsAssessment, StateError> {
        self.linearise(model, state)?;
        if model.dimensions() == 3 {
            let found = assess_space(&self.space_system, &mut self.space)?;
            let direction = found.direction.map(|own| own.to_vec());
            let assessment = count_eliminated(model, found.assessment);
            return Ok(EquationsAssessment { assessment, direction, plane: Some(found.plane) });
        }
        let is_line = model.dimensions() == 1;
        let pencil = &self.plane.pencil;
        let assessment = if is_line { assess_line(pencil) } else { growth::assess(pencil) };
        let direction = match assessment.verdict {
            Verdict::IllPosed { .. } if is_line => Some(vec![1.0]),
            Verdict::IllPosed { direction, .. } => {
                let (sin, cos) = direction.cr_sin_cos();
                Some(vec![cos, sin])
            }
            _ => None,
        };
        let assessment = count_eliminated(model, assessment);
        Ok(EquationsAssessment { assessment, direction, plane: None })
    }

    /// Determines the background derivatives that `state` asks for, checks that the background satisfies the equations,
    /// and linearises them.
    ///
    /// # Errors
    /// See [`StateError`].
    pub fn linearise(
        &mut self,
        model: &TextModel,
        state: &mut TextState,
    ) -> Result<(), StateError> {
        model.solve_background(state, &mut self.text)?;
        model.check_background(state, &mut self.text)?;
        if model.dimensions() == 3 {
            model.linearise_reduced(state, &mut self.text, &mut self.space_system)?;
        } else {
            model.linearise_reduced(state, &mut self.text, &mut self.plane.system)?;
            self.plane.pencil.update(&self.plane.system)?;
        }
        Ok(())
    }

    /// Supremum of Re ς over all waves of the last state, of a well-posed one, and the unit wave vector at which it is
    /// attained or approached, with as many components as dimensions; `None` for other verdicts.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn locate_supremum(
        &self,
        model: &TextModel,
        assessment: &EquationsAssessment,
    ) -> Result<Option<(Supremum, Vec<f64>)>, AnalysisError> {
        let found = &assessment.assessment;
        let pencil = &self.plane.pencil;
        Ok(match (model.dimensions(), &assessment.plane) {
            (1, _) => bound::locate_supremum_on_line(pencil, found, 0.0)
                .map(|supremum| (supremum, vec![1.0])),
            (_, Some(plane)) => {
                let own =
                    SpaceAssessment { assessment: found.clone(), plane: *plane, direction: None };
                space::locate_supremum(&self.space_system, &own)?
                    .map(|(supremum, direction)| (supremum, direction.to_vec()))
            }
            _ => bound::locate_supremum(pencil, found, 0.0).map(|supremum| {
                let (sin, cos) = supremum.direction.cr_sin_cos();
                (supremum, vec![cos, sin])
            }),
        })
    }

    /// Roots of the last state at the wave number `k` (1/m), the direction of the wave vector from x₁ and its elevation
    /// above the x₁x₂ plane (rad); both are 0 in fewer dimensions.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn roots(
        &self,
        model: &TextModel,
        k: f64,
        direction: f64,
        elevation: f64,
    ) -> Result<PencilRoots, AnalysisError> {
        let eliminated = model.eliminated_count();
        let count = |found| match found {
            PencilRoots::Regular { finite, infinite } => {
                PencilRoots::Regular { finite, infinite: infinite + eliminated }
            }
            PencilRoots::Singular { rank } => PencilRoots::Singular { rank: rank + eliminated },
        };
        if model.dimensions() < 3 {
            return Ok(count(self.plane.pencil.roots(k, direction)));
        }
        // The plane through the wave vector and the axis x₃.
        let (sin, cos) = direction.cr_sin_cos();
        let plane = [[cos, sin, 0.0], [0.0, 0.0, 1.0]];
        let (mut system, mut pencil) = (LinearisedSystem::<2>::default(), Pencil::default());
        self.space_system.restrict_to_plane(&plane, &mut system);
        pencil.update(&system)?;
        Ok(count(pencil.roots(k, elevation)))
    }
}

/// An assessment of the reduced equations with rank and number of unknowns of the whole model.
fn count_eliminated(model: &TextModel, mut assessment: Assessment) -> Assessment {
    if let Verdict::Indeterminate { rank, unknowns } = &mut assessment.verdict {
        *rank += model.eliminated_count();
        *unknowns += model.eliminated_count();
    }
    assessment
}
