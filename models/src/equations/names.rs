//! Names that live as long as the program.
//!
//! Linearised systems refer to static names, since the built-in models have them in their code. Names of text models are
//! kept in one table for the life of the program; equal lists share their memory, so that loading a model again adds
//! nothing.

use crate::common::system::Unknown;
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

/// Lists of names kept so far.
static NAME_LISTS: LazyLock<Mutex<HashMap<Vec<String>, &'static [&'static str]>>> =
    LazyLock::new(Mutex::default);

/// Lists of unknowns kept so far.
static UNKNOWN_LISTS: LazyLock<Mutex<HashMap<Vec<String>, &'static [Unknown]>>> =
    LazyLock::new(Mutex::default);

/// Returns the static list of these names.
pub(super) fn intern_names(names: &[String]) -> &'static [&'static str] {
    let mut lists = NAME_LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(list) = lists.get(names) {
        return list;
    }
    let leaked: Vec<&'static str> = names.iter().map(|name| &*name.clone().leak()).collect();
    let list: &'static [&'static str] = leaked.leak();
    lists.insert(names.to_vec(), list);
    list
}

/// Returns the static list of unknowns of these names; each unknown is its own family.
pub(super) fn intern_unknowns(names: &[String]) -> &'static [Unknown] {
    let statics = intern_names(names);
    let mut lists = UNKNOWN_LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(list) = lists.get(names) {
        return list;
    }
    let unknowns: Vec<Unknown> =
        statics.iter().map(|name| Unknown { name, family: name }).collect();
    let list: &'static [Unknown] = unknowns.leak();
    lists.insert(names.to_vec(), list);
    list
}
