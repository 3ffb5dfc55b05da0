//! Errors in the text of a model, with their place inside the expression.

use std::fmt;

/// The text in which an error was found.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum TextPlace {
    /// An unknown of this name.
    Unknown(String),
    /// A component of the velocity, counted from 0.
    Velocity(usize),
    /// A parameter of this name.
    Parameter(String),
    /// A definition of this name.
    Definition(String),
    /// An equation of this name.
    Equation(String),
    /// The equation names in the list of driven equations, counted from 0.
    Driven(usize),
    /// The background value or derivative `derivative` (empty for the value) of an unknown.
    Background {
        /// Name of the unknown.
        unknown: String,
        /// Name of the derivative, e.g. `d1`; empty for the value.
        derivative: String,
    },
}

impl fmt::Display for TextPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(formatter, "unknown {name}"),
            Self::Velocity(index) => write!(formatter, "velocity component {}", index + 1),
            Self::Parameter(name) => write!(formatter, "parameter {name}"),
            Self::Definition(name) => write!(formatter, "definition of {name}"),
            Self::Equation(name) => write!(formatter, "equation \"{name}\""),
            Self::Driven(index) => write!(formatter, "driven equation {}", index + 1),
            Self::Background { unknown, derivative } if derivative.is_empty() => {
                write!(formatter, "background value of {unknown}")
            }
            Self::Background { unknown, derivative } => {
                write!(formatter, "background derivative {derivative} of {unknown}")
            }
        }
    }
}

/// A model text that cannot be used: place, what was found, and the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextError {
    /// The text in which the error was found.
    pub place: TextPlace,
    /// Line and column inside the text, both counted from 1; `None` if the error concerns the text as a whole.
    pub position: Option<[usize; 2]>,
    /// What was found.
    pub found: String,
    /// Allowed text, or a correction.
    pub remedy: String,
}

impl fmt::Display for TextError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}; {}", self.place, self.describe_found(), self.remedy)
    }
}

impl std::error::Error for TextError {}

impl TextError {
    /// An error that concerns a text as a whole.
    pub(super) fn new(
        place: TextPlace,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { place, position: None, found: found.into(), remedy: remedy.into() }
    }

    /// What was found, with line and column if known.
    pub fn describe_found(&self) -> String {
        match self.position {
            Some([line, column]) => format!("line {line}, column {column}: {}", self.found),
            None => self.found.clone(),
        }
    }
}

/// Line and column, both counted from 1, of the byte `offset` of a text; columns count characters.
pub(super) fn line_and_column(text: &str, offset: usize) -> [usize; 2] {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    [line, before[start..].chars().count() + 1]
}

/// A state at which a model text cannot be evaluated or does not satisfy the equations.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluationError {
    /// An expression is not differentiable, or not finite.
    #[error("{place}: '{expression}' {problem}: its argument is {value:?}")]
    Undefined {
        /// The text that contains the expression.
        place: TextPlace,
        /// Text of the sub-expression.
        expression: String,
        /// Description of the error, as the end of a sentence.
        problem: &'static str,
        /// Value of the argument that decides.
        value: f64,
    },
    /// A coefficient is not finite, although no sub-expression of the text is to blame.
    #[error(
        "{place}: a coefficient of the linearised equation is not finite; the numbers of the case are too large or \
         too small"
    )]
    NotFinite {
        /// The equation.
        place: TextPlace,
    },
    /// The background does not satisfy an equation.
    #[error(
        "{place}: the background leaves the residual {residual:e}, {relative:.3e} of the largest term {largest_term:e}; \
         change the background, ask for a derivative with \"solve\", or list the equation in driven if a body force \
         balances it"
    )]
    Residual {
        /// The equation.
        place: TextPlace,
        /// Residual, in the unit of the equation.
        residual: f64,
        /// Magnitude of the largest term.
        largest_term: f64,
        /// Residual divided by the largest term.
        relative: f64,
    },
    /// The equations do not determine the background derivatives to be solved for.
    #[error(
        "background: {found} of {count} derivatives to be solved for are determined by the equations that are not \
         driven; give values, or leave \"solve\" out"
    )]
    NotDetermined {
        /// Number of derivatives asked for.
        count: usize,
        /// Number of derivatives that the equations determine.
        found: usize,
    },
    /// Solving for background derivatives did not converge.
    #[error(
        "background: no values of the derivatives to be solved for were found; give values near the solution"
    )]
    NoConvergence,
}
