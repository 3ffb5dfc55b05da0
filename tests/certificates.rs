//! Certificates: proofs of random boxes against their verification in other arithmetic, and false ones.

use crate::program::{create_folder, run_with_exit_code};
use certificates::{Certificate, Directions, Number, ProvedVerdict};
use rayon::prelude::*;
use testkit::random::RandomNumbers;
use wellposed::case::Case;
use wellposed::study::{BoxRange, certify_state};

/// Bundled case, settings, and numbers with their ranges.
type Family = (&'static str, &'static [&'static str], &'static [(&'static str, f64, f64)]);

/// Cases with numbers of which two at a time run over a box.
const FAMILIES: [Family; 7] = [
    (
        "granular-flow/noncoaxiality-bound",
        &[],
        &[("background.noncoaxiality_deg", -85.0, 85.0), ("model.friction_angle_deg", 5.0, 80.0)],
    ),
    (
        "granular-flow/dilatant-domain",
        &["model.friction_angle_deg=40"],
        &[("background.noncoaxiality_deg", -60.0, 60.0), ("model.dilatancy_angle_deg", 1.0, 38.0)],
    ),
    (
        "granular-flow/plastic-potential",
        &[],
        &[("model.friction_angle_deg", 20.0, 60.0), ("model.dilatancy_angle_deg", 0.0, 18.0)],
    ),
    (
        "flow/double-shearing",
        &[],
        &[("model.friction_angle_deg", 20.0, 60.0), ("model.dilatancy_angle_deg", 0.0, 15.0)],
    ),
    (
        "cosserat/flutter",
        &[],
        &[
            ("model.lambda", 0.2, 2.0),
            ("model.mu", 0.5, 2.0),
            ("model.alpha", 0.1, 1.0),
            ("yield.shear_friction", 0.1, 1.0),
            ("yield.shear_dilatancy", -0.2, 1.0),
        ],
    ),
    (
        "cosserat/flutter",
        &["yield.active=['-sigma12']"],
        &[("model.alpha", 0.1, 1.0), ("yield.shear_dilatancy", 0.2, 0.7)],
    ),
    (
        "cosserat/shear-band",
        &[],
        &[
            ("model.lambda", 0.2, 2.0),
            ("yield.friction", 0.0, 0.9),
            ("yield.dilatancy", -0.2, 0.8),
            ("yield.hardening", -0.2, 0.6),
            ("stress.out_of_plane_stress", -1.0, 1.0),
        ],
    ),
];

/// A random box of a share `size` of the ranges of two of these numbers.
fn draw_box(random: &mut RandomNumbers, numbers: &[(&str, f64, f64)], size: f64) -> [BoxRange; 2] {
    let first = random.uniform_index(numbers.len());
    let second = (first + 1 + random.uniform_index(numbers.len() - 1)) % numbers.len();
    [first, second].map(|index| {
        let (key, low, high) = numbers[index];
        let width = size * (high - low);
        let start = random.uniform(low, high - width);
        // Seven decimals, as in files.
        let ends = [start, start + width].map(|own| (own * 1e7).round() / 1e7);
        BoxRange { key: key.to_owned(), ends }
    })
}

/// Certificates of `count` random boxes of each family, of those that are proved.
fn certify_random_boxes(count: usize, size: f64) -> Vec<Certificate> {
    let mut all = Vec::new();
    for (name, settings, numbers) in FAMILIES {
        let case = load(name, settings);
        let certify = |index: u64| {
            let random = &mut RandomNumbers::with_salt(91, index);
            let ranges = draw_box(random, numbers, size);
            certify_state(&case, &ranges).expect("a case with a proof").certificate
        };
        let before = all.len();
        all.extend((0..count as u64).filter_map(certify));
        let found = all.len() - before;
        assert!(4 * found >= count, "{name}: {found} of {count} boxes proved");
    }
    all
}

fn load(name: &str, settings: &[&str]) -> Case {
    let settings: Vec<String> = settings.iter().map(|own| (*own).to_owned()).collect();
    Case::load(format!("cases/{name}.toml").as_ref(), &settings).expect("a bundled case")
}

/// A hundred thousand boxes of four sizes, fewer of those whose polynomials are long: the enclosures contain what exact fractions, or 57 digits where there are angles or
/// directions of stress, give at corners and in the middle, and their signs hold.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn hundred_thousand_boxes_are_verified() {
    let sizes = [0.0003, 0.001, 0.003, 0.01];
    let counts = [36_000, 1500, 36_000, 20_000, 1500, 1500, 20_000];
    let mut total = 0;
    for ((name, settings, numbers), count) in FAMILIES.into_iter().zip(counts) {
        let case = load(name, settings);
        let verify = |index: u64| {
            let random = &mut RandomNumbers::with_salt(92, index);
            let ranges = draw_box(random, numbers, sizes[index as usize % sizes.len()]);
            let proved = certify_state(&case, &ranges).expect("a case with a proof");
            let Some(own) = proved.certificate else { return (0, 0) };
            let found = own.verify();
            assert!(found.is_ok(), "{found:?}: {}", own.describe());
            (1, own.parts.len())
        };
        let counts: Vec<(usize, usize)> = (0..count).into_par_iter().map(verify).collect();
        let boxes: usize = counts.iter().map(|own| own.0).sum();
        let parts: usize = counts.iter().map(|own| own.1).sum();
        println!("{name}: {boxes} of {} boxes proved and verified, {parts} parts", counts.len());
        assert!(10 * boxes > 9 * counts.len(), "{name}: {boxes}");
        total += parts;
    }
    assert!(total > 100_000, "{total}");
}

#[test]
fn proofs_are_verified_in_other_arithmetic() {
    for (size, boxes) in [(1e-4, 8), (0.02, 8), (0.06, 4)] {
        let all = certify_random_boxes(boxes, size);
        let count =
            |verdict: ProvedVerdict| all.iter().filter(|own| own.verdict == verdict).count();
        let counts = [count(ProvedVerdict::WellPosed), count(ProvedVerdict::IllPosed)];
        assert!(counts.iter().all(|&own| own >= 8), "{counts:?}");
        for own in &all {
            let found = own.verify();
            assert!(found.is_ok(), "{found:?}: {}", own.describe());
            // Every number of a certificate survives its file.
            let text = serde_json::to_string(own).expect("JSON");
            assert_eq!(&serde_json::from_str::<Certificate>(&text).expect("a certificate"), own);
        }
    }
}

/// A change of a certificate.
type Forgery = fn(&mut Certificate) -> bool;

fn margin_of(own: &Certificate) -> f64 {
    let claims = own.parts.iter().flat_map(|part| &part.claims);
    claims.map(certificates::Claim::margin).fold(f64::INFINITY, f64::min)
}

/// False certificates, as wrong methods would write them, each applied to all certificates that it changes.
#[test]
fn forgeries_are_refused() {
    let forgeries: [(&str, Forgery); 18] = [
        // Enclosures of half the width.
        ("bounds halved", |own| {
            for range in own.parts.iter_mut().flat_map(|part| &mut part.claims) {
                let [low, high] = range.range;
                let (middle, half) = (0.5 * (low + high), 0.25 * (high - low));
                range.range = [middle - half, middle + half];
            }
            own.least_margin = margin_of(own);
            true
        }),
        ("other verdict", |own| {
            own.verdict = match own.verdict {
                ProvedVerdict::WellPosed => ProvedVerdict::IllPosed,
                ProvedVerdict::IllPosed => ProvedVerdict::WellPosed,
            };
            true
        }),
        ("part left out", |own| {
            let is_divided = own.parts.len() > 1;
            own.parts.truncate(own.parts.len().div_ceil(2));
            own.least_margin = margin_of(own);
            is_divided
        }),
        ("larger box", |own| {
            own.axes[0].to += 1e-9;
            true
        }),
        ("range of directions left out", |own| {
            let claims = &mut own.parts[0].claims;
            let is_range = |place: &Option<Directions>| {
                matches!(place, Some(Directions::AlongNormal(_) | Directions::AlongLayers(_)))
            };
            let found = claims.iter().position(|claim| is_range(&claim.directions));
            found.map(|index| claims.remove(index));
            own.least_margin = margin_of(own);
            found.is_some()
        }),
        ("quantity left out", |own| {
            let claims = &mut own.parts[0].claims;
            let last = claims.last().map(|claim| claim.quantity.clone());
            let count = claims.len();
            claims.retain(|claim| Some(&claim.quantity) != last.as_ref());
            let is_less = !claims.is_empty() && claims.len() < count;
            own.least_margin = margin_of(own);
            is_less
        }),
        // A term lost from the formulas: the claims are those of another number.
        ("other number", |own| {
            let depends = ["yield.shear_friction", "yield.friction", "model.mu", "model.lambda"];
            let number = own.numbers.iter_mut().find(|own| depends.contains(&own.key.as_str()));
            number.map(|own| own.value *= 3.0).is_some()
        }),
        ("part repeated", |own| {
            own.parts.push(own.parts[0].clone());
            true
        }),
        ("axis of one number, part repeated", |own| {
            let from = own.axes[0].from;
            own.axes[0].to = from;
            own.axes[1].to += 1.0;
            own.parts.truncate(1);
            own.parts[0].ends[0] = [from, from];
            own.parts.push(own.parts[0].clone());
            own.least_margin = margin_of(own);
            true
        }),
        ("foreign number", |own| {
            own.numbers.push(Number { key: "model.density".to_owned(), value: 1.0 });
            true
        }),
        ("number twice", |own| {
            let first = own.numbers.first().cloned();
            own.numbers.extend(first);
            !own.numbers.is_empty()
        }),
        ("foreign axis", |own| {
            own.axes[0].key = "model.cohesion".to_owned();
            true
        }),
        ("number out of range", |own| {
            let keys = ["model.mu", "model.friction_angle_deg", "model.dilatancy_angle_deg"];
            let number = own.numbers.iter_mut().find(|own| keys.contains(&own.key.as_str()));
            number.map(|own| own.value = -5.0).is_some()
        }),
        ("angle beyond a right angle", |own| {
            let number = own.numbers.iter_mut().find(|own| own.key == "model.friction_angle_deg");
            number.map(|own| own.value = 140.0).is_some()
        }),
        ("rotational strength", |own| {
            let is_dilatant = own.axes.iter().any(|own| own.key == "model.dilatancy_angle_deg");
            let number = own.numbers.iter_mut().find(|own| own.key == "model.rotational_strength");
            number.map(|own| own.value = 100.0).is_some() && is_dilatant
        }),
        ("directions where there are none", |own| {
            let claim = &mut own.parts[0].claims[0];
            let is_without = claim.directions.is_none();
            claim.directions = Some(Directions::One(vec![1.0, 0.0]));
            is_without
        }),
        ("margin", |own| {
            own.least_margin *= 1.01;
            true
        }),
        ("number left out", |own| own.numbers.pop().is_some()),
    ];
    let all = certify_random_boxes(8, 0.05);
    for (name, forge) in forgeries {
        let (mut count, mut accepted) = (0, 0);
        for own in &all {
            let mut forged = own.clone();
            if forge(&mut forged) && forged != *own {
                count += 1;
                let found = forged.verify();
                accepted += usize::from(found.is_ok());
                let may_be_true = ["bounds halved", "other number"].contains(&name);
                assert!(found.is_err() || may_be_true, "{name}: {}", own.describe());
            }
        }
        println!("{name}: {accepted} of {count} accepted");
        // Some remain true: enclosures may be more than twice as wide as they need be, or hold for the other number.
        assert!(count > 2 && 2 * accepted < count, "{name}: {accepted} of {count}");
    }
}

/// The bound on the non-coaxiality over a box contains that of every state, and is hardly wider.
#[test]
fn bound_on_noncoaxiality_is_enclosed() {
    let ranges =
        [("model.friction_angle_deg", [28.0, 36.0]), ("model.dilatancy_angle_deg", [0.0, 20.0])];
    let ranges = ranges.map(|(key, ends)| BoxRange { key: key.to_owned(), ends });
    let case = load("granular-flow/dilatant-domain", &[]);
    let [low, high] = certify_state(&case, &ranges)
        .expect("a case with a proof")
        .noncoaxiality_bound_deg
        .expect("a model with a bound");
    let random = &mut RandomNumbers::new(5);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for index in 0..400 {
        // The corners, then states inside.
        let place = if index < 4 {
            [f64::from(index % 2), f64::from(index / 2)]
        } else {
            [0; 2].map(|_| random.unit_interval())
        };
        let [phi, nu] = [0, 1].map(|axis| {
            let [low, high] = ranges[axis].ends;
            (low + (high - low) * place[axis]).to_radians()
        });
        // |tan 2Δ| = cot ν √(cos φ cos(φ − 2ν))/cos(φ − ν)
        let tangent = (phi.cos() * (phi - 2.0 * nu).cos()).sqrt() / (nu.tan() * (phi - nu).cos());
        let bound = 0.5 * tangent.atan().to_degrees();
        (least, most) = (least.min(bound), most.max(bound));
    }
    assert!(low <= least && high >= most, "{least} to {most} in {low} to {high}");
    assert!(least - low < 0.05 && high - most < 0.05, "{least} to {most} in {low} to {high}");
}

/// The command line from the proof to its verification, with what goes wrong.
#[test]
fn certificates_are_written_and_verified() {
    let here = create_folder("certificates", "files");
    let (text, _) = run_with_exit_code(
        0,
        &here,
        "point dilatant-domain --certified --over background.noncoaxiality_deg=-20..20 \
         --over model.dilatancy_angle_deg=1..10 --no-pictures --out out",
    );
    assert!(text.contains("Leading symbol proved well-posed for all states"), "{text}");
    let (text, _) = run_with_exit_code(0, &here, "verify out");
    assert!(text.contains("certificate.json: verified (1 part)"), "{text}");
    let (text, _) = run_with_exit_code(0, &here, "verify out/certificate.json --format json");
    let words = "\"verified\": \"Harris-Grekova flow has a well-posed leading symbol in a uniform background for";
    assert!(text.contains(words), "{text}");
    // The pictures, drawn again with the same proof.
    run_with_exit_code(0, &here, "plot out");
    run_with_exit_code(0, &here, "verify out");
    // The certificate of another case, listed as if it belonged here.
    run_with_exit_code(0, &here, "point flutter --certified --no-pictures --out other");
    std::fs::copy(here.join("out/certificate.json"), here.join("kept")).expect("a copy");
    std::fs::copy(here.join("other/certificate.json"), here.join("out/certificate.json"))
        .expect("a copy");
    run_with_exit_code(1, &here, "verify out");
    std::fs::rename(here.join("kept"), here.join("out/certificate.json")).expect("a file");
    // Another verdict in the file, which then is damaged, and by itself proves nothing.
    let file = here.join("out/certificate.json");
    let proof = std::fs::read_to_string(&file).expect("a certificate");
    let forged = proof.replace("\"verdict\": \"well-posed\"", "\"verdict\": \"ill-posed\"");
    std::fs::write(&file, forged).expect("a writable file");
    run_with_exit_code(1, &here, "verify out");
    let (_, error) = run_with_exit_code(1, &here, "verify out/certificate.json");
    assert!(error.contains("proves nothing") && error.contains("is not negative"), "{error}");
    std::fs::write(&file, &proof[..200]).expect("a writable file");
    let (_, error) = run_with_exit_code(2, &here, "verify out/certificate.json");
    assert!(error.contains("not a certificate"), "{error}");
    // Where nothing is proved, the earlier certificate goes.
    let (text, _) = run_with_exit_code(
        0,
        &here,
        "point dilatant-domain --certified --over background.noncoaxiality_deg=0..60 --no-pictures --out out",
    );
    assert!(text.contains("Not decided for all states") && text.contains("of the box"), "{text}");
    assert!(!file.exists());
    run_with_exit_code(0, &here, "verify out");
}

#[test]
fn ranges_without_proof_are_refused() {
    let here = create_folder("certificates", "refusals");
    for (arguments, parts) in [
        ("flutter --certified --over model.mu=2..1", ["--over model.mu", "the least first"]),
        ("flutter --certified --over model.mu=1..nan", ["--over model.mu", "two finite numbers"]),
        ("flutter --certified --over model.density", ["--over", "KEY=LOW..HIGH"]),
        ("flutter --over model.mu=1..2", ["--certified", "missing"]),
        (
            "flutter --certified --over background.pressure=1..2",
            ["--over background.pressure", "model.mu"],
        ),
        (
            "flutter --certified --over yield.hardening=-5..5",
            ["--over yield.hardening", "model.mu"],
        ),
        (
            "noncoaxiality-bound --certified --set background.noncoaxiality_deg=360",
            ["background.noncoaxiality_deg", "between -180 and 180"],
        ),
        (
            "flutter --certified --over model.mu=1..2 --over model.mu=1..3",
            ["--over model.mu", "given twice"],
        ),
        ("mu-of-i --certified", ["model.kind", "a flow or a solid"]),
    ] {
        let (_, error) = run_with_exit_code(2, &here, &format!("point {arguments} --out out"));
        assert!(parts.iter().all(|part| error.contains(part)), "{arguments}: {error}");
        assert!(!here.join("out").exists(), "{arguments}");
    }
}
