//! Reproducible random mutations of case files.

use wellposed::CASES;
use wellposed::case::Case;

/// Replacement values of a number: limits, extremes, other types.
const VALUES: &[&str] = &[
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
const PIECES: &[&str] = &[
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

/// Pseudo-random generator SplitMix64, so that all runs use the same mutants.
pub struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform number below `end`; 0 for `end` = 0.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn choose<'a, T: ?Sized>(&mut self, from: &[&'a T]) -> Option<&'a T> {
        from.get(self.below(from.len())).copied()
    }
}

/// Endless sequence of mutants of the bundled cases and of the templates of `wellposed new`, with grids reduced to a
/// few points.
pub fn mutants(seed: u64) -> impl Iterator<Item = Vec<u8>> {
    let originals = originals();
    let mut random = Random(seed);
    std::iter::from_fn(move || {
        loop {
            let original = &originals[random.below(originals.len())];
            let mut bytes = original.clone().into_bytes();
            for _ in 0..1 + random.below(2) * random.below(3) {
                bytes = mutate(bytes, &mut random);
            }
            if has_small_grid(&bytes) {
                return Some(bytes);
            }
        }
    })
}

/// Cases to be mutated: each key on its own line, two to four points along each axis.
fn originals() -> Vec<String> {
    let new: Vec<String> = wellposed::case::Medium::all().map(wellposed::cli::new::text).collect();
    let bundled = CASES.iter().map(|(_, text)| (*text).to_owned());
    let everything = bundled.chain(new.clone()).map(|text| shrunk(&text)).collect::<Vec<_>>();
    // With the optional keys uncommented, so that they are mutated as well.
    let full = new.iter().map(|text| shrunk(&without_marks(text)));
    everything.into_iter().chain(full).collect()
}

/// Uncomments every optional key.
pub fn without_marks(text: &str) -> String {
    let line = |line: &str| match line.strip_prefix("# ") {
        Some(rest) if rest.split_once(" = ").is_some_and(|(key, _)| !key.contains(' ')) => {
            rest.to_owned()
        }
        _ => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Case with a small grid, its axes written as sections with one key per line.
pub fn shrunk(text: &str) -> String {
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

/// Whether the grid of a mutant is small; mutants with too large a grid are refused, but slow ones are not wanted.
fn has_small_grid(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    match Case::parse(&text, "mutant.toml", &[]).map(|case| case.map) {
        Ok(Some(map)) => map.x.points * map.y.points <= 100,
        _ => true,
    }
}

fn mutate(bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    match random.below(10) {
        0..=2 => mutate_bytes(bytes, random),
        _ => mutate_text(&String::from_utf8_lossy(&bytes), random).into_bytes(),
    }
}

fn mutate_bytes(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let at = random.below(bytes.len());
    match random.below(4) {
        0 if !bytes.is_empty() => bytes[at] = random.next() as u8,
        1 => {
            let end = (at + 1 + random.below(12)).min(bytes.len());
            bytes.drain(at..end);
        }
        2 => bytes.truncate(at),
        _ => {
            let piece = random.choose(PIECES).unwrap_or_default();
            bytes.splice(at..at, piece.bytes());
        }
    }
    bytes
}

fn mutate_text(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    // Mutate lines other than comments, which have no effect.
    let aims: Vec<usize> = (0..lines.len())
        .filter(|&i| !lines[i].trim_start().starts_with('#') && !lines[i].trim().is_empty())
        .collect();
    let Some(&at) = aims.get(random.below(aims.len())) else { return text.to_owned() };
    let other = aims[random.below(aims.len())];
    let replaced;
    match random.below(8) {
        0 => {
            lines.remove(at);
        }
        1 => lines.insert(other, lines[at]),
        2 => lines.swap(at, other),
        3 => return move_section(text, random),
        4 | 5 => {
            let Some((key, _)) = lines[at].split_once(" = ") else { return text.to_owned() };
            replaced = format!("{key} = {}", random.choose(VALUES).unwrap_or_default());
            lines[at] = &replaced;
        }
        6 => {
            // Name of another key.
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
            let slips: Vec<usize> = line.char_indices().map(|(i, _)| i).collect();
            let start = slips[random.below(slips.len())];
            let end = start + line[start..].chars().next().map_or(0, char::len_utf8);
            let (head, letter, tail) = (&line[..start], &line[start..end], &line[end..]);
            replaced = match random.below(2) {
                0 => format!("{head}{letter}{letter}{tail}"),
                _ => format!("{head}{tail}"),
            };
            lines[at] = &replaced;
        }
    }
    lines.join("\n") + "\n"
}

/// Deletes, repeats or moves a random section.
fn move_section(text: &str, random: &mut Random) -> String {
    let mut sections: Vec<String> =
        text.split("\n[").map(|section| format!("{section}\n[")).collect();
    let (at, to) = (random.below(sections.len()), random.below(sections.len()));
    let section = sections[at].clone();
    match random.below(3) {
        0 => {
            sections.remove(at);
        }
        1 => sections.insert(to, section),
        _ => sections.swap(at, to),
    }
    sections.concat().trim_end_matches('[').to_owned()
}
