//! Evaluation of a text model at a state: the linearised equations, and the residual of the background.

use super::error::{EvaluationError, TextPlace};
use super::graph::{JetVariable, MultiIndex};
use super::model::{Symbol, TextModel};
use super::program::{Fault, Input, Program};
use crate::common::rounding::Rounded;
use crate::common::scalar::Scalar;
use crate::common::system::{HigherTerm, LinearisedSystem};

/// Largest residual of an equation at the background, relative to its largest term.
pub const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// Numbers of a text model: parameters and background.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextState {
    /// Values of the parameters, in the order of the model.
    pub parameters: Vec<f64>,
    /// Values and derivatives of the unknowns at the background in the frame at rest; those not listed are zero.
    pub background: Vec<(JetVariable, Rounded)>,
    /// Derivatives of the background to be determined from the equations.
    pub solved: Vec<JetVariable>,
}

/// Reusable memory for the evaluation of a text model; use one per thread.
#[derive(Clone, Debug, Default)]
pub struct TextWorkspace {
    registers: Vec<Rounded>,
}

/// Residual of an equation at the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Left-hand side minus right-hand side.
    pub residual: Rounded,
    /// Magnitude of the largest term that the equation adds.
    pub largest_term: f64,
    /// Whether a body force balances the equation.
    pub is_driven: bool,
}

impl Residual {
    /// Residual divided by the largest term; 0 for an equation whose terms all vanish.
    pub fn relative(&self) -> f64 {
        let magnitude = self.residual.value.abs();
        if magnitude == 0.0 { 0.0 } else { magnitude / self.largest_term }
    }

    /// Whether the equation holds to within [`RESIDUAL_TOLERANCE`] or the rounding of its terms.
    pub fn is_satisfied(&self) -> bool {
        self.residual.value.abs() <= RESIDUAL_TOLERANCE * self.largest_term + self.residual.bound
    }
}

impl TextState {
    /// The background value of a jet variable in the frame at rest.
    pub(super) fn at_rest(&self, variable: JetVariable) -> Rounded {
        let own = self.background.iter().find(|(own, _)| *own == variable);
        own.map_or(Rounded::ZERO, |(_, value)| *value)
    }

    /// Sets a background value in the frame at rest.
    pub fn set_background(&mut self, variable: JetVariable, value: Rounded) {
        match self.background.iter_mut().find(|(own, _)| *own == variable) {
            Some((_, own)) => *own = value,
            None => self.background.push((variable, value)),
        }
    }
}

/// Value of a jet variable of the frame that moves with the velocity V, from those of the frame at rest:
/// ∂ₜ* = ∂ₜ + V·∇.
fn in_moving_frame<T: Scalar>(
    variable: JetVariable,
    velocity: &[T],
    at_rest: &dyn Fn(JetVariable) -> T,
) -> T {
    fn expand<T: Scalar>(
        time_order: u8,
        variable: JetVariable,
        velocity: &[T],
        at_rest: &dyn Fn(JetVariable) -> T,
    ) -> T {
        if time_order == 0 {
            return at_rest(variable);
        }
        let raised = |axis: usize| {
            let mut orders: MultiIndex = variable.orders;
            orders[axis] += 1;
            JetVariable { orders, ..variable }
        };
        let mut sum = expand(time_order - 1, raised(0), velocity, at_rest);
        for (axis, &component) in velocity.iter().enumerate() {
            sum = sum + component * expand(time_order - 1, raised(axis + 1), velocity, at_rest);
        }
        sum
    }
    let [time_order, ..] = variable.orders;
    let mut orders = variable.orders;
    orders[0] = 0;
    expand(time_order, JetVariable { orders, ..variable }, velocity, at_rest)
}

impl TextModel {
    /// Writes the equations linearised about the background into `system`, in the frame of the background velocity if
    /// the model declares one.
    ///
    /// # Errors
    /// An expression is not differentiable or not finite at the background.
    pub fn linearise<const D: usize>(
        &self,
        state: &TextState,
        workspace: &mut TextWorkspace,
        system: &mut LinearisedSystem<D>,
    ) -> Result<(), EvaluationError> {
        self.write_symbol(&self.symbol, state, workspace, system)
    }

    /// Writes the equations linearised about the background into `system` as [`linearise`](Self::linearise), without the
    /// unknowns that an equation gives, such as a stress `s = …`, and without these equations. The determinant of the
    /// symbol is the same but for a constant factor.
    ///
    /// # Errors
    /// An expression is not differentiable or not finite at the background.
    pub fn linearise_reduced<const D: usize>(
        &self,
        state: &TextState,
        workspace: &mut TextWorkspace,
        system: &mut LinearisedSystem<D>,
    ) -> Result<(), EvaluationError> {
        self.write_symbol(&self.reduced_symbol, state, workspace, system)
    }

    fn write_symbol<const D: usize>(
        &self,
        symbol: &Symbol,
        state: &TextState,
        workspace: &mut TextWorkspace,
        system: &mut LinearisedSystem<D>,
    ) -> Result<(), EvaluationError> {
        let velocity = self.frame_velocity(state);
        let mut frame = [0.0; D];
        for (own, component) in frame.iter_mut().zip(&velocity) {
            *own = component.value;
        }
        system.reset(symbol.unknowns, symbol.equations, frame);
        let registers = &mut workspace.registers;
        if let Err(fault) = self.evaluate_rounded(&symbol.program, state, &velocity, registers) {
            // The equations themselves name the sub-expression, if it is not its derivative alone that is undefined.
            self.residuals(state, workspace)?;
            return Err(self.explain(fault));
        }
        for (index, &(row, column, [time, space @ ..])) in symbol.places.iter().enumerate() {
            let value = symbol.program.output(registers, index);
            if value.is_structural_zero() {
                continue;
            }
            if !Scalar::is_finite(value) {
                let place = self.equation_place(symbol.rows[row]);
                return Err(EvaluationError::NotFinite { place });
            }
            let at = (row, column);
            let space_order: u8 = space.iter().sum();
            match (time, space_order) {
                (0, 0) => system.c[at] = value,
                (1, 0) => system.a[at] = value,
                (0, 1) => {
                    let axis = space.iter().position(|order| *order == 1).unwrap_or(0);
                    system.b[axis][at] = value;
                }
                _ => {
                    let mut space_powers = [0; D];
                    for (own, order) in space_powers.iter_mut().zip(space) {
                        *own = order;
                    }
                    system.higher_terms.push(HigherTerm {
                        row: at.0,
                        column: at.1,
                        time_power: time,
                        space_powers,
                        coefficient: value,
                    });
                }
            }
        }
        Ok(())
    }

    /// Residuals of all equations at the background.
    ///
    /// # Errors
    /// An expression is not differentiable or not finite at the background.
    pub fn residuals(
        &self,
        state: &TextState,
        workspace: &mut TextWorkspace,
    ) -> Result<Vec<Residual>, EvaluationError> {
        let velocity = self.frame_velocity(state);
        let registers = &mut workspace.registers;
        self.evaluate_rounded(&self.residual, state, &velocity, registers)
            .map_err(|fault| self.explain(fault))?;
        let count = self.equations.len();
        let mut first_term = count;
        let mut found = Vec::with_capacity(count);
        for (row, terms) in self.term_counts.iter().enumerate() {
            let term = |index| self.residual.output(registers, index).value.abs();
            let largest_term = (first_term..first_term + terms).map(term).fold(0.0, f64::max);
            first_term += terms;
            let residual = self.residual.output(registers, row);
            found.push(Residual { residual, largest_term, is_driven: self.is_driven[row] });
        }
        Ok(found)
    }

    /// Checks that the background satisfies all equations that are not driven.
    ///
    /// # Errors
    /// An expression is not defined, or an equation is not satisfied: [`EvaluationError::Residual`].
    pub fn check_background(
        &self,
        state: &TextState,
        workspace: &mut TextWorkspace,
    ) -> Result<(), EvaluationError> {
        let residuals = self.residuals(state, workspace)?;
        let violated = residuals.iter().position(|own| !own.is_driven && !own.is_satisfied());
        match violated {
            None => Ok(()),
            Some(row) => Err(EvaluationError::Residual {
                place: self.equation_place(row),
                residual: residuals[row].residual.value,
                largest_term: residuals[row].largest_term,
                relative: residuals[row].relative(),
            }),
        }
    }

    /// The residuals of all equations on a jet in the frame of the background velocity; `jet` returns the value of a jet
    /// variable there, and `relative_velocity` that of v − V.
    ///
    /// # Errors
    /// An expression is not differentiable or not finite on this jet.
    pub fn evaluate_residuals<T: Scalar>(
        &self,
        state: &TextState,
        registers: &mut Vec<T>,
        jet: impl Fn(JetVariable) -> T,
        relative_velocity: impl Fn(usize) -> T,
    ) -> Result<Vec<T>, EvaluationError> {
        let velocity = self.frame_velocity(state);
        self.residual
            .evaluate(registers, |input| match *input {
                Input::Jet(variable) => jet(variable),
                Input::RelativeVelocity(axis) => relative_velocity(axis),
                Input::Parameter(index) => T::from_rounded(state.parameters[index]),
                Input::FrameVelocity(axis) => T::from_rounded(velocity[axis].value),
                Input::Number { .. } | Input::Pi => T::from_exact(0.0),
            })
            .map_err(|fault| self.explain(fault))?;
        Ok((0..self.equations.len()).map(|row| self.residual.output(registers, row)).collect())
    }

    /// The residuals of all equations on a jet, as [`evaluate_residuals`](Self::evaluate_residuals), and the sum of the
    /// magnitudes of the terms of each equation.
    ///
    /// # Errors
    /// An expression is not differentiable or not finite on this jet.
    pub fn evaluate_residuals_and_terms<T: Scalar>(
        &self,
        state: &TextState,
        registers: &mut Vec<T>,
        jet: impl Fn(JetVariable) -> T,
        relative_velocity: impl Fn(usize) -> T,
    ) -> Result<(Vec<T>, Vec<f64>), EvaluationError> {
        let found = self.evaluate_residuals(state, registers, jet, relative_velocity)?;
        let mut first_term = self.equations.len();
        let sum_terms = |&count: &usize| {
            let terms = first_term..first_term + count;
            first_term += count;
            terms.map(|index| self.residual.output(registers, index).value().abs()).sum()
        };
        let sizes = self.term_counts.iter().map(sum_terms).collect();
        Ok((found, sizes))
    }

    /// Index of the unknown that is the velocity along `axis`, if the model declares a velocity.
    pub fn velocity_unknown(&self, axis: usize) -> Option<usize> {
        self.velocity.get(axis).copied()
    }

    /// Value of a jet variable of the background in the frame of the background velocity.
    pub fn background_jet(&self, state: &TextState, variable: JetVariable) -> Rounded {
        in_moving_frame(variable, &self.frame_velocity(state), &|own| state.at_rest(own))
    }

    /// Velocity V of the frame: the background velocity, empty if the model declares none.
    fn frame_velocity(&self, state: &TextState) -> Vec<Rounded> {
        let component = |&unknown: &usize| state.at_rest(JetVariable { unknown, orders: [0; 4] });
        self.velocity.iter().map(component).collect()
    }

    fn evaluate_rounded(
        &self,
        program: &Program,
        state: &TextState,
        velocity: &[Rounded],
        registers: &mut Vec<Rounded>,
    ) -> Result<(), Fault> {
        program.evaluate(registers, |input| match *input {
            Input::Jet(variable) => in_moving_frame(variable, velocity, &|own| state.at_rest(own)),
            Input::Parameter(index) => Rounded::from_rounded(state.parameters[index]),
            Input::FrameVelocity(axis) => velocity[axis],
            Input::RelativeVelocity(_) | Input::Number { .. } | Input::Pi => Rounded::ZERO,
        })
    }

    pub(super) fn equation_place(&self, row: usize) -> TextPlace {
        TextPlace::Equation(self.equations[row].to_owned())
    }

    /// The error of a fault, with the text of the sub-expression.
    pub(super) fn explain(&self, fault: Fault) -> EvaluationError {
        match fault.node.and_then(|node| self.origins.get(&node)) {
            Some(origin) => EvaluationError::Undefined {
                place: origin.place.clone(),
                expression: origin.text.clone(),
                problem: fault.problem,
                value: fault.argument,
            },
            None => EvaluationError::NotFinite { place: self.equation_place(0) },
        }
    }
}
