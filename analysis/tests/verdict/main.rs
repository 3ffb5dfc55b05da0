//! Verdicts against closed forms and against systems whose growth is known by construction.

mod brute_force;
mod closed_forms;
mod known_systems;
mod known_verdicts;
mod singular_pencils;
