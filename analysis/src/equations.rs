//! Analysis of models given as equations in text, in one, two or three dimensions.

use crate::bound::{self, Supremum};
use crate::flows::FlowWorkspace;
use crate::growth::{self, Assessment, Verdict};
use crate::line::assess_line;
use crate::pencil::{Pencil, PencilRoots};
use crate::space::{SpaceWorkspace, assess_space};
use crate::{AnalysisError, StateError};
use models::LinearisedSystem;
use models::common::elementary::Elementary;
use models::equations::{TextModel, TextState, TextWorkspace};

/// Reusable memory for assessing states one after another; use one per thread.
#[derive(Clone, Debug, Default)]
pub struct EquationsWorkspace {
    text: TextWorkspace,
    /// Linearised equations and pencil of the last state in one or two dimensions.
    pub plane: FlowWorkspace,
    /// Linearised equations of the last state in three dimensions.
    pub space_system: LinearisedSystem<3>,
    space: SpaceWorkspace,
}

/// Verdict on a state of a model given as equations.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationsAssessment {
    /// The verdict with its evidence; in space that of the plane of wave vectors that decides, see [`space`](crate::space).
    pub assessment: Assessment,
    /// Unit wave vector of the fastest growth, with as many components as dimensions; `None` unless ill-posed.
    pub direction: Option<Vec<f64>>,
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
        model.solve_background(state, &mut self.text)?;
        model.check_background(state, &mut self.text)?;
        if model.dimensions() == 3 {
            model.linearise(state, &mut self.text, &mut self.space_system)?;
            let found = assess_space(&self.space_system, &mut self.space)?;
            let direction = found.direction.map(|own| own.to_vec());
            return Ok(EquationsAssessment { assessment: found.assessment, direction });
        }
        model.linearise(state, &mut self.text, &mut self.plane.system)?;
        self.plane.pencil.update(&self.plane.system)?;
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
        Ok(EquationsAssessment { assessment, direction })
    }

    /// Supremum of Re ς over all waves of the last state, of a well-posed one; in space over the waves in the plane that
    /// decides, with the direction inside it. `None` for other verdicts.
    pub fn locate_supremum(
        &self,
        model: &TextModel,
        assessment: &EquationsAssessment,
    ) -> Option<Supremum> {
        let found = &assessment.assessment;
        match model.dimensions() {
            1 => bound::locate_supremum_on_line(&self.plane.pencil, found, 0.0),
            2 => bound::locate_supremum(&self.plane.pencil, found, 0.0),
            _ => bound::locate_supremum(&self.space.pencil, found, 0.0),
        }
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
        if model.dimensions() < 3 {
            return Ok(self.plane.pencil.roots(k, direction));
        }
        // The plane through the wave vector and the axis x₃.
        let (sin, cos) = direction.cr_sin_cos();
        let plane = [[cos, sin, 0.0], [0.0, 0.0, 1.0]];
        let (mut system, mut pencil) = (LinearisedSystem::<2>::default(), Pencil::default());
        self.space_system.restrict_to_plane(&plane, &mut system);
        pencil.update(&system)?;
        Ok(pencil.roots(k, elevation))
    }
}
