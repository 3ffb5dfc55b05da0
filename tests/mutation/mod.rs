//! Reproducible random mutations of case files.

use testkit::random::RandomNumbers;
use wellposed::CASES;
use wellposed::case::Case;

/// Replacement values of a number: limits, extremes, other types.
pub const REPLACEMENT_VALUES: &[&str] = &[
    "0",
    "-0.0",
    "1",
    "-1",
    "0.5",
    "7",
    "45",
    "90",
    "180",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-300",
    "1e200",
    "1e999",
    "inf",
    "-inf",
    "nan",
    "29.999999999999996",
    "30.000000000000004",
    "89.99999999999999",
    "9007199254740993",
    "99999999999999999999",
    "0xffff",
    "1_000",
    "true",
    "\"text\"",
    "[1, 2]",
    "[]",
    "[[1, 0], [0, -1]]",
    "{}",
    "2026-11-21",
];

/// Strings inserted at random positions.
const INSERTED_STRINGS: &[&str] = &[
    "\"",
    "'",
    "'''",
    "[",
    "]",
    "[[",
    "{",
    "}",
    "=",
    ".",
    ",",
    "#",
    "\n",
    "\r",
    "\t",
    "\0",
    "-",
    "e",
    "\\u0000",
    "é",
    "Ψ",
    "\u{feff}",
    "\u{2028}",
    "title",
    "[model]\n",
    "[map.x]\n",
    "a.b.c = 1\n",
];

/// Returns a uniformly distributed index below `count`; 0 for `count` = 0.
fn choose_index(random: &mut RandomNumbers, count: usize) -> usize {
    (random.next_bits() % count.max(1) as u64) as usize
}

/// Returns a random item of a list; an empty string for an empty list.
fn choose_string(random: &mut RandomNumbers, items: &[&'static str]) -> &'static str {
    items.get(choose_index(random, items.len())).copied().unwrap_or_default()
}

/// Generates an endless sequence of mutants of the bundled cases and of the templates of `wellposed new`, with the
/// grids of maps reduced to a few points.
pub fn generate_mutants(seed: u64) -> impl Iterator<Item = Vec<u8>> {
    let originals = create_original_cases();
    let mut random = RandomNumbers::with_salt(0, seed);
    std::iter::from_fn(move || {
        let random = &mut random;
        loop {
            let original = &originals[choose_index(random, originals.len())];
            let mut bytes = original.clone().into_bytes();
            for _ in 0..1 + choose_index(random, 2) * choose_index(random, 3) {
                bytes = mutate(bytes, random);
            }
            if has_small_grid(&bytes) {
                return Some(bytes);
            }
        }
    })
}

/// Creates the cases to be mutated: each key is on its own line, and maps have three or four points along each axis.
fn create_original_cases() -> Vec<String> {
    let templates: Vec<String> = wellposed::case::MediumKind::all_media()
        .map(wellposed::cli::new::generate_state_template)
        .collect();
    let bundled = CASES.iter().map(|(_, text)| (*text).to_owned());
    let originals = bundled.chain(templates.clone()).map(|text| shrink_map_grid(&text));
    let originals = originals.collect::<Vec<_>>();
    // Optional keys are uncommented, so that they are mutated as well.
    let uncommented = templates.iter().map(|text| shrink_map_grid(&uncomment_optional_keys(text)));
    originals.into_iter().chain(uncommented).collect()
}

/// Uncomments every optional key.
pub fn uncomment_optional_keys(text: &str) -> String {
    let line = |line: &str| match line.strip_prefix("# ") {
        Some(rest) if rest.split_once(" = ").is_some_and(|(key, _)| !key.contains(' ')) => {
            rest.to_owned()
        }
        _ => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Returns the case text with a small map grid, and with the axes of the map written as sections with one key per line.
pub fn shrink_map_grid(text: &str) -> String {
    let mut lines = Vec::new();
    for line in text.lines() {
        match line.split_once(" = { ") {
            Some((axis @ ("x" | "y"), rest)) => {
                lines.push(format!("[map.{axis}]"));
                for pair in rest.trim_end_matches([' ', '}']).split(", ") {
                    let points = if axis == "x" { "points = 4" } else { "points = 3" };
                    let pair = if pair.starts_with("points") { points } else { pair };
                    lines.push(pair.to_owned());
                }
            }
            _ => lines.push(line.to_owned()),
        }
    }
    lines.join("\n") + "\n"
}

/// Returns whether the map of a mutant has at most 100 points, since larger maps would take too long; true also without
/// a map and for an invalid case.
fn has_small_grid(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    match Case::parse(&text, "mutant.toml", &[]).map(|case| case.map) {
        Ok(Some(map)) => map.x.point_count * map.y.point_count <= 100,
        _ => true,
    }
}

fn mutate(bytes: Vec<u8>, random: &mut RandomNumbers) -> Vec<u8> {
    match choose_index(random, 10) {
        0..=2 => mutate_bytes(bytes, random),
        _ => mutate_text(&String::from_utf8_lossy(&bytes), random).into_bytes(),
    }
}

fn mutate_bytes(mut bytes: Vec<u8>, random: &mut RandomNumbers) -> Vec<u8> {
    let at = choose_index(random, bytes.len());
    match choose_index(random, 4) {
        0 if !bytes.is_empty() => bytes[at] = random.next_bits() as u8,
        1 => {
            let end = (at + 1 + choose_index(random, 12)).min(bytes.len());
            bytes.drain(at..end);
        }
        2 => bytes.truncate(at),
        _ => {
            let piece = choose_string(random, INSERTED_STRINGS);
            bytes.splice(at..at, piece.bytes());
        }
    }
    bytes
}

fn mutate_text(text: &str, random: &mut RandomNumbers) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    // Mutate lines other than comments, which have no effect.
    let candidates: Vec<usize> = (0..lines.len())
        .filter(|&i| !lines[i].trim_start().starts_with('#') && !lines[i].trim().is_empty())
        .collect();
    let Some(&at) = candidates.get(choose_index(random, candidates.len())) else {
        return text.to_owned();
    };
    let other = candidates[choose_index(random, candidates.len())];
    let replaced;
    match choose_index(random, 8) {
        0 => {
            lines.remove(at);
        }
        1 => lines.insert(other, lines[at]),
        2 => lines.swap(at, other),
        3 => return mutate_sections(text, random),
        4 | 5 => {
            let Some((key, _)) = lines[at].split_once(" = ") else { return text.to_owned() };
            replaced = format!("{key} = {}", choose_string(random, REPLACEMENT_VALUES));
            lines[at] = &replaced;
        }
        6 => {
            // Replace the key by that of another line.
            let (Some((key, _)), Some((_, value))) =
                (lines[other].split_once(" = "), lines[at].split_once(" = "))
            else {
                return text.to_owned();
            };
            replaced = format!("{key} = {value}");
            lines[at] = &replaced;
        }
        _ => {
            // Typing error: a repeated or a missing letter.
            let line = lines[at];
            let starts: Vec<usize> = line.char_indices().map(|(i, _)| i).collect();
            let start = starts[choose_index(random, starts.len())];
            let end = start + line[start..].chars().next().map_or(0, char::len_utf8);
            let (head, letter, tail) = (&line[..start], &line[start..end], &line[end..]);
            replaced = match choose_index(random, 2) {
                0 => format!("{head}{letter}{letter}{tail}"),
                _ => format!("{head}{tail}"),
            };
            lines[at] = &replaced;
        }
    }
    lines.join("\n") + "\n"
}

/// Deletes a random section, inserts a copy of it, or swaps two sections.
fn mutate_sections(text: &str, random: &mut RandomNumbers) -> String {
    let mut sections: Vec<String> =
        text.split("\n[").map(|section| format!("{section}\n[")).collect();
    let (at, to) = (choose_index(random, sections.len()), choose_index(random, sections.len()));
    let section = sections[at].clone();
    match choose_index(random, 3) {
        0 => {
            sections.remove(at);
        }
        1 => sections.insert(to, section),
        _ => sections.swap(at, to),
    }
    sections.concat().trim_end_matches('[').to_owned()
}
