//! Reading of the scalar keys of a case: name, yield set, active conditions, numbers and kinds to compare.

use super::entries::{Entries, allowed, kind};
use super::error::{CaseError, escape};
use super::keys::{Key, Presence, keys};
use super::kind::{Kind, Medium, Yield, names};
use super::numbers::Numbers;
use super::types::is_too_long;
use super::value::{Value, nearest, suggestion};
use models::registry;
use std::path::Path;

/// Reads the name of a case; by default derived from the file name.
pub(super) fn name(entries: &Entries, file: &str) -> Result<String, CaseError> {
    const KEY: &str = "name";
    let may_stand = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    // `.` and `..` are existing folders.
    let is_dots = |name: &str| name.chars().all(|c| c == '.');
    if let Some(Value::Text(name)) = entries.get(KEY) {
        if is_dots(name) || !name.chars().all(may_stand) || is_too_long(name) {
            let allowed = Key::find(KEY).map_or(String::new(), allowed);
            let found = format!("found '{}'", escape(name));
            return Err(entries.places.error(KEY, found, allowed));
        }
        return Ok(name.clone());
    }
    let file = Path::new(file).file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let stem = file.rsplit_once('.').map_or(&*file, |(stem, _)| stem);
    if is_dots(stem) {
        return Ok("case".to_owned());
    }
    // Other characters are replaced, so that the resolved case can be read again.
    Ok(stem.chars().map(|c| if may_stand(c) { c } else { '-' }).collect())
}

/// Reads the yield set named in `[yield]`; the names in `none` stand for no yield set.
pub(super) fn yield_set(
    entries: &Entries,
    kind: Kind,
    none: &[&'static str],
) -> Result<Option<Yield>, CaseError> {
    const KEY: &str = "yield.kind";
    if !entries.has_section("yield") {
        return match entries.has_section("stress") && !kind.yield_sets().is_empty() {
            true => Err(entries.places.error(
                "stress",
                "a stress without a yield set",
                "add a section [yield], or leave this one out: elastic waves do not see the stress",
            )),
            false => Ok(None),
        };
    }
    let sets = kind.yield_sets();
    if sets.is_empty() {
        let found = format!("a yield set for the model {}", kind.name());
        return Err(entries.places.error("yield", found, "leave the section out: flows yield"));
    }
    let name = entries.text(KEY)?;
    if none.contains(&name) {
        return Ok(None);
    }
    let found = registry::yield_set(name).filter(|set| sets.contains(set));
    found.map(Some).ok_or_else(|| {
        let names: Vec<&str> =
            sets.iter().map(|set| set.name).chain(none.iter().copied()).collect();
        let meant = suggestion(nearest(name, names.iter().copied()));
        let found = format!("found '{}'", escape(name));
        let allowed = format!("{meant}allowed for {}: {}", kind.name(), names.join(", "));
        entries.places.error(KEY, found, allowed)
    })
}

/// Reads the indices of the yield conditions named in `yield.active`.
pub(super) fn active(entries: &Entries, medium: Medium) -> Result<Option<Vec<usize>>, CaseError> {
    const KEY: &str = "yield.active";
    let Some(Value::Texts(names)) = entries.get(KEY) else { return Ok(None) };
    if !Key::find(KEY).is_some_and(|key| key.is_used_by(medium)) {
        let found = format!("not used by {}", medium.title());
        let sets = registry::yield_sets();
        let owners: Vec<&str> =
            sets.iter().filter(|set| !set.conditions.is_empty()).map(|set| set.name).collect();
        let allowed = format!("leave it out (it belongs to {})", owners.join(", "));
        return Err(entries.places.error(KEY, found, allowed));
    }
    if entries.has_section("stress") {
        let found = "active conditions beside a section [stress]";
        return Err(entries.places.error(KEY, found, "give one of the two: either decides"));
    }
    let known = medium.condition_names();
    let mut active = Vec::new();
    for name in names {
        let found = format!("found '{}'", escape(name));
        let Some(index) = known.iter().position(|known| *known == name.as_str()) else {
            let meant = suggestion(nearest(name, known.iter().copied()));
            let allowed = format!("{meant}allowed: {}", known.join(", "));
            return Err(entries.places.error(KEY, found, allowed));
        };
        // Both signs of one condition are active only at zero stress and zero strength, an indeterminate case.
        let stress = |index: usize| known[index].trim_start_matches(['+', '-']);
        if active.iter().any(|&other| stress(other) == stress(index)) {
            let allowed = "name each stress once, with one sign";
            return Err(entries.places.error(KEY, found, allowed));
        }
        active.push(index);
    }
    if active.is_empty() {
        let allowed = format!("name at least one of {}", known.join(", "));
        return Err(entries.places.error(KEY, "an empty list", allowed));
    }
    Ok(Some(active))
}

/// Reads the numbers of a case: given values and defaults. Refuses numbers that none of the `media` uses.
pub(super) fn numbers(entries: &Entries, media: &[Medium]) -> Result<Numbers, CaseError> {
    let is_used = |key: &Key| media.iter().any(|&medium| key.is_used_by(medium));
    // An unused key explains the error better than a missing key, so it is reported first.
    if let Some(key) = keys()
        .iter()
        .find(|key| key.field.is_kept() && entries.get(key.name).is_some() && !is_used(key))
    {
        let namesake = keys().iter().find(|k| is_used(k) && k.split().1 == key.split().1);
        let meant = suggestion(namesake.map(|key| key.name));
        let of_kind = media.iter().any(|medium| key.is_for(medium.kind));
        let (user, owners): (_, Vec<&str>) = match (of_kind, media[0].yields) {
            (true, None) => ("an elastic solid".into(), key.set_names()),
            (true, Some(set)) => (format!("the set {}", set.name), key.set_names()),
            (false, _) => {
                let names: Vec<&str> = media.iter().map(|medium| medium.kind.name()).collect();
                (format!("the model {}", names.join(", ")), key.owners())
            }
        };
        return Err(entries.places.error(
            key.name,
            format!("not used by {user}"),
            format!("{meant}leave it out (it belongs to {})", owners.join(", ")),
        ));
    }
    let mut numbers = Numbers::default();
    for key in keys().iter().filter(|key| key.field.is_kept()) {
        let mut own = media.iter().filter(|medium| key.is_used_by(**medium));
        let presence = own.next().map_or(key.presence, |medium| key.presence_for(*medium));
        let is_required = |presence: Presence| matches!(presence, Presence::Required(_));
        key.clear_to(presence, &mut numbers);
        match entries.get(key.name) {
            Some(value) => key.field.store(&mut numbers, value),
            // Required if any medium that uses the key requires it.
            None if is_used(key)
                && (is_required(presence)
                    || own.any(|medium| is_required(key.presence_for(*medium)))) =>
            {
                entries.require(key.name)?;
            }
            None => {}
        }
    }
    if let dimensions @ (1 | 4..) = numbers.dimensions {
        let found = format!("found {dimensions}");
        let allowed = "2 for plane strain or 3 for space";
        return Err(entries.places.error("model.dimensions", found, allowed));
    }
    let elevation = numbers.wave.elevation_deg;
    if numbers.dimensions == 2 && elevation != 0.0 {
        let found = format!("found {elevation:?} in plane strain");
        let allowed = "0: waves stay in the plane, unless model.dimensions = 3";
        return Err(entries.places.error("wave.elevation_deg", found, allowed));
    }
    if let Some(set) = media[0].yields.filter(|set| set.is_plane && numbers.dimensions == 3) {
        let found = format!("found 3 with the yield set {}", set.name);
        let allowed = "2: it is a set of plane strain";
        return Err(entries.places.error("model.dimensions", found, allowed));
    }
    for key in keys().iter().filter(|key| key.split().0 == "wave") {
        if let Some(Value::Number(found)) = key.field.load(&numbers)
            && !key.range.contains(found)
        {
            return Err(wave_number(entries, key.name, found));
        }
    }
    Ok(numbers)
}

pub(super) fn wave_number(entries: &Entries, key: &str, found: f64) -> CaseError {
    entries.places.error(key, format!("found {found:?}"), "a wave number must be positive")
}

/// Reads the kinds of model of `[compare]`.
pub(super) fn compare(entries: &Entries) -> Result<Option<Vec<Kind>>, CaseError> {
    const KEY: &str = "compare.kinds";
    if !entries.has_section("compare") {
        return Ok(None);
    }
    let mut kinds = Vec::new();
    if let Value::Texts(listed) = entries.require(KEY)? {
        for name in listed {
            let kind = kind(name, KEY, &entries.places)?;
            if let Kind::Solid(_) = kind {
                let allowed = format!("flows alone: {}", names(&Kind::flows()));
                return Err(entries.places.error(KEY, format!("found {name}, a solid"), allowed));
            }
            if kinds.contains(&kind) {
                let found = format!("found {name} twice");
                return Err(entries.places.error(KEY, found, "name each kind once"));
            }
            kinds.push(kind);
        }
    }
    if kinds.is_empty() {
        return Err(entries.places.error(KEY, "an empty list", "name at least one kind of model"));
    }
    Ok(Some(kinds))
}
