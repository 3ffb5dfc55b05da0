//! Damaged model texts: no panic, and every error names line, column and a remedy.

use crate::equations::text_models::granular_rheology;
use crate::support::RandomNumbers;
use wellposed_models::equations::{TextModel, TextPlace};

const PIECES: [&str; 46] = [
    "(", ")", "+", "-", "*", "/", "^", "=", ",", " ", "\n", "d1(", "d3(", "D(", "dt(", "sqrt(",
    "v1", "p", "rate", "1e999", "1.2.3", "1e", "..", "$", "é", "μ", "\u{0}", "atan2(", "min(p",
    "0", "d1", "**", "2x", "_", "\\", "\"", "[", "}", "sin", "I0", "sum(j, ", "sum(", "d[j](",
    "v[j]", "j", "]",
];

/// 10,000 equations and definitions with random insertions, deletions, replacements and exchanges.
#[test]
fn damaged_texts_are_refused_with_place_and_remedy() {
    let mut random = RandomNumbers::new(10);
    let original = granular_rheology();
    let (mut refused, mut accepted) = (0, 0);
    for _ in 0..10_000 {
        let mut text = original.clone();
        let (definitions, equations) = (text.definitions.len(), text.equations.len());
        let index = random.uniform_index(definitions + equations);
        let (own, place) = if index < definitions {
            let own = &mut text.definitions[index];
            let place = TextPlace::Definition(own.name.clone());
            (&mut own.text, place)
        } else {
            let own = &mut text.equations[index - definitions];
            let place = TextPlace::Equation(own.name.clone());
            (&mut own.text, place)
        };
        let mut characters: Vec<char> = own.chars().collect();
        for _ in 0..1 + random.uniform_index(3) {
            let at = random.uniform_index(characters.len() + 1);
            let piece = PIECES[random.uniform_index(PIECES.len())].chars();
            match random.uniform_index(5) {
                0 => drop(characters.splice(at..at, piece)),
                1 if at < characters.len() => drop(characters.remove(at)),
                2 if at < characters.len() => drop(characters.splice(at..=at, piece)),
                3 => characters.truncate(at),
                _ if characters.len() > 1 => {
                    let (a, b) =
                        (at.min(characters.len() - 1), random.uniform_index(characters.len()));
                    characters.swap(a, b);
                }
                _ => {}
            }
        }
        *own = characters.into_iter().collect();
        let damaged = own.clone();
        match TextModel::new(&text) {
            Ok(_) => accepted += 1,
            Err(error) => {
                refused += 1;
                assert!(!error.remedy.is_empty() && !error.found.is_empty(), "{damaged}: {error}");
                // A text in which an unknown or a cycle is missed concerns the model as a whole.
                let is_whole = matches!(error.place, TextPlace::Unknown(_));
                match error.position {
                    Some([line, column]) => {
                        let lines: Vec<&str> = match &error.place {
                            own if *own == place => damaged.split('\n').collect(),
                            // The damage may show elsewhere: in the unit of another text.
                            _ => continue,
                        };
                        let width = lines[line - 1].chars().count();
                        assert!(column >= 1 && column <= width + 1, "{damaged}: {error}");
                    }
                    None => assert!(is_whole, "{damaged}: {error}"),
                }
            }
        }
    }
    assert!(refused > 6_000 && accepted > 100, "{refused} refused, {accepted} accepted");
}

/// Long, deep and empty texts.
#[test]
fn extreme_texts_are_refused() {
    let cases = [
        String::new(),
        " ".into(),
        "(".repeat(5_000),
        "-".repeat(9_000),
        format!("{}p{}", "(".repeat(200), ")".repeat(200)),
        "p+".repeat(4_000),
        "p^".repeat(3_000),
        "sin(".repeat(2_000),
        "p*".repeat(20_000),
        "1".repeat(400),
        "d1(d1(d1(d1(d1(p)))))".into(),
    ];
    for case in cases {
        let mut text = granular_rheology();
        text.definitions[0].text = case.clone();
        let error = TextModel::new(&text).expect_err(&case);
        assert!(error.position.is_some(), "{error}");
    }
}
