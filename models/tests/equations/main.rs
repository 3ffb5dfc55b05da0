//! Models as text: expressions against another method of differentiation in 31 digits, errors of damaged texts, and
//! linearised equations against hand calculation. Built-in models typed in are compared in crate `analysis`.

mod expressions;
mod mutations;
mod semantics;
mod text_models;
