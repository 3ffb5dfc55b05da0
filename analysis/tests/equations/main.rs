//! Models given as equations: the published answers to the bundled cases, and the built-in models typed in.

mod brute_force;
mod built_in;
mod forms;
mod known_answers;
mod linearised;
