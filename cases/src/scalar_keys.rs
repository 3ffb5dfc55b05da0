//! Reading of the scalar keys of a case: name, yield set, active conditions, numbers and kinds to compare.

use super::entries::CaseEntries;
use super::error::{CaseError, escape};
use super::key_positions::KeyPositions;
use super::keys::{Key, Presence, keys};
use super::kind::{MediumKind, ModelKind, YieldSetKind, join_names};
use super::numbers::CaseNumbers;
use super::types::{MAX_NAME_LENGTH, is_name_too_long};
use super::value::{CaseValue, find_similar_name, format_allowed};
use models::common::decimal::format_exact;
use models::registry;
use std::path::Path;

/// Reads the name of a case; by default derived from the file name.
pub(super) fn read_name(entries: &CaseEntries, file: &str) -> Result<String, CaseError> {
    const NAME_KEY: &str = "name";
    let may_stand = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    // `.` and `..` are existing folders.
    let is_dots = |name: &str| name.chars().all(|c| c == '.');
    if let Some(CaseValue::Text(name)) = entries.value(NAME_KEY) {
        if is_dots(name) || !name.chars().all(may_stand) || is_name_too_long(name) {
            let allowed = format!(
                "expected 1 to {MAX_NAME_LENGTH} letters, digits, '-', '_' and '.', not only dots: the results go to \
                 the folder out/<name>; --out DIR names any other"
            );
            let found = format!("found '{}'", escape(name));
            return Err(entries.positions.key_error(NAME_KEY, found, allowed));
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

/// Reads the yield set named in `[yield]`; the names in `elastic_names` mean no yield set.
pub(super) fn read_yield_set(
    entries: &CaseEntries,
    kind: ModelKind,
    elastic_names: &[&'static str],
) -> Result<Option<YieldSetKind>, CaseError> {
    const YIELD_KIND_KEY: &str = "yield.kind";
    if !entries.has_section("yield") {
        return match entries.has_section("stress") && !kind.admissible_yield_sets().is_empty() {
            true => Err(entries.positions.key_error(
                "stress",
                "found without a yield set",
                "add a section [yield], or leave this one out: elastic waves do not depend on the stress",
            )),
            false => Ok(None),
        };
    }
    let sets = kind.admissible_yield_sets();
    if sets.is_empty() {
        let found = format!("not used by the model {}", kind.name());
        return Err(entries.positions.key_error(
            "yield",
            found,
            "leave the section out: flow models have a built-in yield condition",
        ));
    }
    let name = entries.require_text(YIELD_KIND_KEY)?;
    if elastic_names.contains(&name) {
        return Ok(None);
    }
    let found = registry::find_yield_set(name).filter(|set| sets.contains(set));
    found.map(Some).ok_or_else(|| {
        let names: Vec<&str> =
            sets.iter().map(|set| set.name).chain(elastic_names.iter().copied()).collect();
        let meant = find_similar_name(name, names.iter().copied());
        let found = format!("found '{}'", escape(name));
        let allowed = format_allowed(&format!("allowed for {}", kind.name()), meant, &names);
        entries.positions.key_error(YIELD_KIND_KEY, found, allowed)
    })
}

/// Reads the indices of the yield conditions named in `yield.active`.
pub(super) fn read_active_conditions(
    entries: &CaseEntries,
    medium: MediumKind,
) -> Result<Option<Vec<usize>>, CaseError> {
    const YIELD_ACTIVE_KEY: &str = "yield.active";
    let Some(CaseValue::TextList(names)) = entries.value(YIELD_ACTIVE_KEY) else { return Ok(None) };
    if !Key::find_by_name(YIELD_ACTIVE_KEY).is_some_and(|key| key.is_used_by(medium)) {
        let found = format!("not used by {}", medium.title());
        let sets = registry::yield_sets();
        let owners: Vec<&str> =
            sets.iter().filter(|set| !set.conditions.is_empty()).map(|set| set.name).collect();
        let allowed = format!("leave it out (it belongs to {})", owners.join(", "));
        return Err(entries.positions.key_error(YIELD_ACTIVE_KEY, found, allowed));
    }
    if entries.has_section("stress") {
        let found = "found beside a section [stress]";
        return Err(entries.positions.key_error(
            YIELD_ACTIVE_KEY,
            found,
            "give either yield.active or [stress], not both",
        ));
    }
    let known = medium.yield_condition_names();
    let mut active = Vec::new();
    for name in names {
        let found = format!("found '{}'", escape(name));
        let Some(index) = known.iter().position(|known| *known == name.as_str()) else {
            let meant = find_similar_name(name, known.iter().copied());
            let allowed = format_allowed("allowed", meant, &known);
            return Err(entries.positions.key_error(YIELD_ACTIVE_KEY, found, allowed));
        };
        // The conditions on the positive and the negative sign of one stress are both active only if stress and
        // strength are zero, an indeterminate case.
        let stress = |index: usize| known[index].trim_start_matches(['+', '-']);
        if active.iter().any(|&other| stress(other) == stress(index)) {
            let allowed = "name each stress once, with one sign";
            return Err(entries.positions.key_error(YIELD_ACTIVE_KEY, found, allowed));
        }
        active.push(index);
    }
    if active.is_empty() {
        let allowed = format!("expected at least one of {}", known.join(", "));
        return Err(entries.positions.key_error(YIELD_ACTIVE_KEY, "found an empty list", allowed));
    }
    Ok(Some(active))
}

/// Reads the numbers of a case: given values and defaults. Refuses numbers that none of the `media` uses.
pub(super) fn read_numbers(
    entries: &CaseEntries,
    media: &[MediumKind],
) -> Result<CaseNumbers, CaseError> {
    let is_used = |key: &Key| media.iter().any(|&medium| key.is_used_by(medium));
    // An unused key explains the error better than a missing key, so it is reported first.
    if let Some(key) = keys()
        .iter()
        .find(|key| key.storage.is_stored() && entries.value(key.name).is_some() && !is_used(key))
    {
        let namesake =
            keys().iter().find(|k| is_used(k) && k.split_section().1 == key.split_section().1);
        let meant = namesake.map(|key| key.name).or_else(|| {
            let section = key.split_section().0;
            let used = keys().iter().filter(|k| is_used(k) && k.split_section().0 == section);
            find_similar_name(key.name, used.map(|key| key.name))
        });
        let of_kind = media.iter().any(|medium| key.is_used_by_kind(medium.kind));
        let (user, owners): (_, Vec<&str>) = match (of_kind, media[0].yield_set) {
            (true, None) => ("an elastic solid".into(), key.yield_set_names()),
            (true, Some(set)) => (format!("the yield set {}", set.name), key.yield_set_names()),
            (false, _) => {
                let names: Vec<&str> = media.iter().map(|medium| medium.kind.name()).collect();
                (format!("the model {}", names.join(", ")), key.model_names())
            }
        };
        return Err(entries.positions.key_error(
            key.name,
            format!("not used by {user}"),
            match meant {
                Some(meant) => {
                    format!(
                        "did you mean '{meant}'? ({} belongs to {})",
                        key.name,
                        owners.join(", ")
                    )
                }
                None => format!("leave it out (it belongs to {})", owners.join(", ")),
            },
        ));
    }
    let mut numbers = CaseNumbers::default();
    for key in keys().iter().filter(|key| key.storage.is_stored()) {
        let mut own = media.iter().filter(|medium| key.is_used_by(**medium));
        let presence = own.next().map_or(key.presence, |medium| key.presence_for(*medium));
        let is_required = |presence: Presence| matches!(presence, Presence::Required(_));
        key.reset_value_to(presence, &mut numbers);
        match entries.value(key.name) {
            Some(value) => key.storage.store_value(&mut numbers, value),
            // Required if any medium that uses the key requires it.
            None if is_used(key)
                && (is_required(presence)
                    || own.any(|medium| is_required(key.presence_for(*medium)))) =>
            {
                entries.require_value(key.name)?;
            }
            None => {}
        }
    }
    if let dimensions @ (1 | 4..) = numbers.dimensions {
        let found = format!("found {dimensions}");
        let allowed = "expected 2 (plane strain) or 3";
        return Err(entries.positions.key_error("model.dimensions", found, allowed));
    }
    let elevation = numbers.wave.elevation_deg;
    if numbers.dimensions == 2 && elevation != 0.0 {
        let found = format!("found {} in plane strain", format_exact(elevation));
        let allowed = "expected 0, or model.dimensions = 3";
        return Err(entries.positions.key_error("wave.elevation_deg", found, allowed));
    }
    if let Some(set) = media[0].yield_set.filter(|set| set.is_plane && numbers.dimensions == 3) {
        let found = format!("found 3 with the yield set {}", set.name);
        let allowed = "expected 2: this yield set requires plane strain";
        return Err(entries.positions.key_error("model.dimensions", found, allowed));
    }
    for key in keys().iter().filter(|key| key.split_section().0 == "wave") {
        if let Some(CaseValue::Number(found)) = key.storage.load_value(&numbers)
            && !key.range.contains(found)
        {
            return Err(wave_number_error(&entries.positions, key.name, found));
        }
    }
    Ok(numbers)
}

pub(super) fn wave_number_error(positions: &KeyPositions, key: &str, found: f64) -> CaseError {
    let found = format!("found {}", format_exact(found));
    positions.key_error(key, found, "expected a positive number in 1/m")
}

/// Reads the kinds of model of `[compare]`.
pub(super) fn read_compared_kinds(
    entries: &CaseEntries,
) -> Result<Option<Vec<ModelKind>>, CaseError> {
    const COMPARE_KINDS_KEY: &str = "compare.kinds";
    if !entries.has_section("compare") {
        return Ok(None);
    }
    let mut kinds = Vec::new();
    if let CaseValue::TextList(listed) = entries.require_value(COMPARE_KINDS_KEY)? {
        for name in listed {
            let flows = ModelKind::flow_kinds();
            let Some(&kind) = flows.iter().find(|kind| kind.name() == name) else {
                let similar = find_similar_name(name, flows.iter().map(|kind| kind.name()));
                let (note, meant) = match ModelKind::from_name(name) {
                    Some(_) => (", a solid", None),
                    None => ("", similar),
                };
                let names: Vec<&str> = flows.iter().map(|kind| kind.name()).collect();
                let allowed = format_allowed("allowed", meant, &names);
                let found = format!("found '{}'{note}", escape(name));
                return Err(entries.positions.key_error(COMPARE_KINDS_KEY, found, allowed));
            };
            if kinds.contains(&kind) {
                let found = format!("found {name} twice");
                return Err(entries.positions.key_error(
                    COMPARE_KINDS_KEY,
                    found,
                    "name each kind once",
                ));
            }
            kinds.push(kind);
        }
    }
    if kinds.is_empty() {
        return Err(entries.positions.key_error(
            COMPARE_KINDS_KEY,
            "found an empty list",
            format!("expected at least one of {}", join_names(&ModelKind::flow_kinds())),
        ));
    }
    Ok(Some(kinds))
}
