//! Models given as equations in text: parsed, differentiated and linearised.
//!
//! A model is a list of unknowns, parameters, definitions and equations as text ([`ModelText`]). An expression is a
//! function of the jet of the unknowns, i.e. of their values and derivatives in t and x. With z = Z + z′ about a
//! background Z the linearised equation F′ = Σ ∂F/∂J J′ has the coefficients ∂F/∂J at the jet of Z, frozen; with
//! ∂ₜ → ς and ∂ᵢ → κᵢ = ikᵢ they form the symbol, a matrix of polynomials in ς and κ.
//!
//! | module | holds |
//! |---|---|
//! | `syntax` | grammar and parser |
//! | `check`, `units` | names, cycles, dimensional analysis |
//! | `graph` | expressions with shared sub-expressions, total derivatives, derivatives by jet variables |
//! | `elimination` | algebraic unknowns that an equation gives |
//! | `program` | compiled expressions, without tree walk |
//! | `model`, `state`, `solve` | compiled models, their evaluation at a state, background derivatives |

mod check;
mod elimination;
mod error;
mod graph;
mod model;
mod names;
mod printer;
mod program;
mod solve;
mod state;
mod syntax;
mod units;

pub use crate::common::scalar::Function;
pub use error::{EvaluationError, TextError, TextPlace};
pub use graph::{JetVariable, MAX_ORDER, MultiIndex};
pub use model::{
    MAX_DIFFERENTIAL_UNKNOWNS, MAX_UNKNOWNS, ModelText, NamedText, Quantity, SymbolEntry, TextModel,
};
pub use state::{RESIDUAL_TOLERANCE, Residual, TextState, TextWorkspace};
