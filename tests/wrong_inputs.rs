//! Wrong inputs of a new user: each message names the place, the key or argument, what was found, and what is allowed
//! or the remedy, in one line.

use crate::program;

use program::*;
use std::fs;
use std::path::Path;

const TEST_FOLDER: &str = "wrong-inputs";

/// A case file with a fault in a known line.
const FILES: [(&str, &str); 13] = [
    (
        "comma.toml",
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1,5e9\nmu = 1e9\ndensity = 1\n",
    ),
    ("quotes.toml", "[model]\nkind = classical\n"),
    ("bracket.toml", "[model\nkind = 'classical'\n"),
    (
        "axis.toml",
        "[model]\nkind = 'harris-grekova'\nfriction_angle_deg = 30\nmoment_of_inertia = 1e-7\nrotational_strength = 0\n\
         [background]\ndensity = 1600\npressure = 1000\nshear_rate = 2\nstress_angle_deg = 0\n[wave]\nnumber = 500\n\
         [map]\nx = 'background.pressure'\ny = 3\n",
    ),
    (
        "points.toml",
        "[model]\nkind = 'harris-grekova'\nfriction_angle_deg = 30\nmoment_of_inertia = 1e-7\nrotational_strength = 0\n\
         [background]\ndensity = 1600\npressure = 1000\nshear_rate = 2\nstress_angle_deg = 0\n[wave]\nnumber = 500\n\
         [map]\nx = { parameter = 'background.spin', from = 0, to = 9 }\n\
         y = { parameter = 'background.pressure', from = 1, to = 9, points = 3 }\n",
    ),
    ("syntax.toml", "[model]\nkind = \n"),
    ("twice.toml", "[model]\nkind = 'classical'\nkind = 'cosserat'\n"),
    ("empty.toml", ""),
    ("kind.toml", "[model]\nkind = 'clasical'\ndimensions = 2\nlambda = 1\nmu = 1\ndensity = 1\n"),
    (
        "section.toml",
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = 1\ndensity = 1\n[yeild]\n",
    ),
    ("missing.toml", "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = 1\n"),
    (
        "negative.toml",
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = -1\ndensity = 1\n",
    ),
    (
        "grid.toml",
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = 1\ndensity = 1\n[grid]\n\
         cells = [4, 4, 4]\nspacing = 1\norigin = [0, 0]\n[time]\nduration = 1\n",
    ),
];

/// Arguments, and parts of the message: place or argument, what was found, what is allowed.
const WRONG_INPUTS: [(&str, &[&str]); 92] = [
    // Files.
    ("point syntax.toml", &["syntax.toml:2: no value in 'kind ='; ", "give a value after '='"]),
    ("point twice.toml", &["twice.toml:3: ", "duplicate key", "give each key once"]),
    (
        "point comma.toml",
        &["comma.toml:4: ", "'lambda = 1,5e9'; ", "write a point for the decimal comma"],
    ),
    ("point quotes.toml", &["quotes.toml:2: ", "'kind = classical'; ", "put the text in quotes"]),
    (
        "point bracket.toml",
        &["bracket.toml:1: ", "'[model'; ", "close the bracket or quotation mark"],
    ),
    (
        "map axis.toml",
        &[
            "axis.toml:14: map.x: found the text 'background.pressure'; ",
            "expected a table x = { parameter = …, from = …",
        ],
    ),
    (
        "map points.toml",
        &[
            "points.toml:14: map.x.points: missing; ",
            "add points to map.x: expected a whole number",
        ],
    ),
    ("point empty.toml", &["empty.toml: model.kind: missing; ", "add a section [model] with kind"]),
    (
        "point kind.toml",
        &["kind.toml:2: model.kind: found 'clasical'; ", "did you mean 'classical'? allowed: "],
    ),
    (
        "point section.toml",
        &["section.toml:7: yeild: unknown key or section; ", "did you mean 'yield'?"],
    ),
    (
        "point missing.toml",
        &["missing.toml:1: model.density: missing; ", "add density to [model]: expected "],
    ),
    ("point negative.toml", &["negative.toml:5: model.mu: found -1; ", "μ > 0, in Pa"]),
    (
        "run grid.toml",
        &[
            "grid.toml:8: grid.cells: found 3 entries for a solid in 2 dimensions; ",
            "expected 2 entries",
        ],
    ),
    (
        "point absent.toml",
        &["absent.toml: no such file", "expected a case file, or the name of a bundled case"],
    ),
    ("point noncoaxialty-bound", &["did you mean 'noncoaxiality-bound'? ", "expected a case file"]),
    ("point .", &[".: a folder, not a file", "expected a case file"]),
    // Options --set.
    (
        "point noncoaxiality-bound --set model.fricton=3",
        &[
            "--set model.fricton=3: model.fricton: unknown key; ",
            "did you mean 'friction_angle_deg'? allowed here: ",
        ],
    ),
    (
        "map noncoaxiality-bound --set map.x.parameter=model.fricton",
        &["map.x.parameter: found 'model.fricton'; ", "did you mean 'model.friction_angle_deg'?"],
    ),
    (
        "map noncoaxiality-bound --set map.x.parameter=background.velocity",
        &[
            "map.x.parameter: found 'background.velocity', not a single number; ",
            "did you mean 'background.velocity[0]'?",
        ],
    ),
    (
        "map noncoaxiality-bound --set map.x.parameter=model.lambda",
        &[
            "map.x.parameter: found 'model.lambda', not used by the model harris-grekova; ",
            "allowed: ",
        ],
    ),
    (
        "map noncoaxiality-bound --set map.x.from=90 --set map.x.to=-90",
        &[
            "--set map.x.from=90: map.x.from: found from = 90 and to = -90; ",
            "expected from < to: exchange them",
        ],
    ),
    (
        "map noncoaxiality-bound --set map.x.to=-90",
        &["map.x.to: found from = -90 and to = -90; ", "expected from < to, or points = 1"],
    ),
    (
        "map noncoaxiality-bound --set map.x.points=1000000000",
        &[
            "map.x.points: found a map of 1000000000 × 161 points; ",
            "expected at most 100000000 points in total",
        ],
    ),
    (
        "point noncoaxiality-bound --set background.pressure",
        &["--set background.pressure: ", "found no '='; ", "expected --set section.key=value"],
    ),
    (
        "point noncoaxiality-bound --set =3",
        &["--set =3: ", "found no key before '='; ", "expected --set section.key=value"],
    ),
    (
        "point noncoaxiality-bound --set background=3",
        &["background: found a section; ", "expected a key inside it: density"],
    ),
    (
        "point noncoaxiality-bound --set background.pressure=[1,",
        &[
            "background.pressure: found '[1,', which is not TOML: unclosed array",
            "close the bracket or quotation mark",
        ],
    ),
    (
        "point noncoaxiality-bound --set background.pressure=high",
        &["background.pressure: found the text 'high'; ", "expected a finite number in Pa"],
    ),
    (
        "point noncoaxiality-bound --set background.pressure=-1",
        &["background.pressure: found -1; ", "expected a pressure above −c cot φ = 0 Pa"],
    ),
    (
        "point noncoaxiality-bound --set model.cohesion=100 --set background.pressure=-1e3",
        &["background.pressure: found -1000; ", "expected a pressure above −c cot φ = -173.205 Pa"],
    ),
    (
        "point noncoaxiality-bound --set background.pressure=1e308",
        &["background.pressure: found 1e308; ", "such as those of bundled cases"],
    ),
    (
        "point noncoaxiality-bound --set model.friction_angle_deg=95",
        &["model.friction_angle_deg: found 95; ", "strictly between 0 and 90 degrees"],
    ),
    (
        "point noncoaxiality-bound --set background.density=-1e300",
        &["background.density: found -1e300; ", "must be positive"],
    ),
    (
        "point noncoaxiality-bound --set name=../x",
        &["name: found '../x'; ", "expected 1 to 255 letters, digits", "--out DIR names any other"],
    ),
    (
        "point double-shearing-against-harris-grekova --set compare.kinds=[\"foo\"]",
        &[
            "compare.kinds: found 'foo'; ",
            "allowed: harris-grekova, double-shearing, plastic-potential, free-rotating",
        ],
    ),
    (
        "point double-shearing-against-harris-grekova --set compare.kinds=[\"classical\"]",
        &["compare.kinds: found 'classical', a solid; ", "allowed: harris-grekova"],
    ),
    (
        "point forbidden-band --set model.lambda=-1e12",
        &["model.lambda: found 3λ + 2μ = -2.9838e12; ", "only for 3λ + 2μ > 0"],
    ),
    (
        "point forbidden-band --set model.dimensions=4",
        &["model.dimensions: found 4; ", "expected 2 (plane strain) or 3"],
    ),
    (
        "point forbidden-band --set wave.number=0",
        &["wave.number: found 0; ", "expected a positive number in 1/m"],
    ),
    (
        "point flutter --set yield.active=[\"foo\"]",
        &["yield.active: found 'foo'; ", "allowed: +sigma21"],
    ),
    (
        "point flutter --set yield.active=[]",
        &["yield.active: found an empty list; ", "expected at least one of +sigma21"],
    ),
    (
        "point flutter --set yield.kind=foo",
        &["yield.kind: found 'foo'; ", "allowed for reduced-cosserat: interlayer"],
    ),
    (
        "check flutter --set model.mu=1e-70",
        &["model.mu: found 1e-70; ", "expected a magnitude from 1e-60 to 1e60, or 0"],
    ),
    (
        "check forbidden-band --set check.cells=[20]",
        &["check.cells: found [20]; ", "expected a list of 2 to 5 ascending whole numbers"],
    ),
    (
        "run point-source --set time.duration=-1",
        &["time.duration: found -1; ", "expected a positive number in s"],
    ),
    (
        "run point-source --set time.splitting=alternating",
        &["time.splitting: unknown key; ", "did you mean 'scheme.splitting'? allowed here: "],
    ),
    (
        "run cracks --set scheme.splitting=alternating",
        &[
            "scheme.splitting: found 'alternating'; ",
            "expected 'two-cyclic': joints between blocks allow no other",
        ],
    ),
    (
        "run strip-load-on-sand --set scheme.order=fourth-order",
        &[
            "scheme.order: found 'fourth-order'; ",
            "expected 'eno2' or 'godunov': granular and porous media",
        ],
    ),
    (
        "run cracks --set scheme.order=eighth-order",
        &[
            "scheme.order: found 'eighth-order'; ",
            "expected 'fourth-order' or 'eno2' or 'godunov': grids of blocks allow no other",
        ],
    ),
    (
        "run point-source --set grid.cells=[10,10,10]",
        &["grid.cells: found 3 entries", "expected 2 entries"],
    ),
    (
        "run point-source --set source[3].at=[0,0]",
        &["source: found the index 3; ", "expected the index 0: the list has one section"],
    ),
    (
        "run decay --set source[0].at=[0,0]",
        &[
            "source: not used by the model harris-grekova, a flow; ",
            "leave it out: it belongs to solids",
        ],
    ),
    (
        "run lamb-2d --set load[0].time.kind=foo",
        &["load[0].time.kind: found 'foo'; ", "allowed: step, triangle"],
    ),
    (
        "run decay --set grid.cells=[3,3]",
        &["grid.cells: found [3, 3]; ", "expected a list of 2 even whole numbers of at least 8"],
    ),
    (
        "shocks foam-open --set porous.porosity=2",
        &["porous.porosity: found 2; ", "expected a number of at least 0 and below 1"],
    ),
    (
        "map noncoaxiality-bound --set map.x.parameter=pressure",
        &["map.x.parameter: found 'pressure'; ", "did you mean 'background.pressure'?"],
    ),
    (
        "run lamb-2d --set grid.cells=[200000,200000]",
        &["grid.cells: found a grid of 200000 × 200000; ", "expected at most 4000000000 cells"],
    ),
    (
        "run point-source --set source[0].at=[1e7,1e-200]",
        &["source[0].at: found [1e7, 1e-200], outside the grid; ", "the grid has x1 from "],
    ),
    (
        "check forbidden-band --set check.numbers=[]",
        &["check.numbers: found an empty list; ", "expected a list of positive numbers in 1/m"],
    ),
    (
        "point heat --set model.parameters.kapa=1",
        &[
            "model.parameters.kapa: used by no equation; ",
            "did you mean 'model.parameters.kappa'? allowed: model.parameters.kappa",
        ],
    ),
    // Verbs that a case does not suit.
    (
        "map forbidden-band",
        &[
            "map: missing; ",
            "{ parameter = \"model.lambda\", from = 4.05e9, to = 1.215e10, ",
            "y = { parameter = \"model.mu\", from = ",
        ],
    ),
    (
        "speeds noncoaxiality-bound",
        &[
            "model.kind: found harris-grekova, a flow; ",
            "expected a solid",
            "wellposed point and map",
        ],
    ),
    (
        "run forbidden-band",
        &[
            "grid: missing; ",
            "add a section [grid], for example with cells = [200, 200]",
            "(wellposed new reduced-cosserat --run writes a whole example)",
        ],
    ),
    ("plot .", &[".: no results; ", "name a folder with results of wellposed map, point, "]),
    (
        "diagram noncoaxiality-bound",
        &[
            "model.kind: found harris-grekova; ",
            "expected a rheological scheme, which wellposed new rheology writes",
        ],
    ),
    (
        "point creep",
        &[
            "rheology: found a rheological scheme; ",
            "expected a flow or a solid; wellposed diagram",
        ],
    ),
    ("run heat", &["model.kind: found equations; ", "wellposed point and map"]),
    (
        "homogenise noncoaxiality-bound",
        &["model.kind: found 'harris-grekova', a flow; ", "expected a blocky medium, "],
    ),
    (
        "homogenise cracks",
        &["joint[0].kind: found cracked; ", "expected elastic, elastic-plastic or breaking: "],
    ),
    (
        "map foam-open",
        &[
            "porous: not used here: this command takes solids without contacts and pores; ",
            "use wellposed shocks",
        ],
    ),
    // Arguments.
    (
        "point noncoaxiality-bound --threads 0",
        &[
            "--threads <N>: found '0'; ",
            "expected a whole number from 1 to 1024",
            "wellposed point --help",
        ],
    ),
    (
        "point noncoaxiality-bound --format xml",
        &["--format <FORMAT>: found 'xml'; ", "allowed: text, json"],
    ),
    (
        "point noncoaxiality-bound --forec",
        &["--forec: unknown option; ", "did you mean '--force'? wellposed point --help"],
    ),
    (
        "point noncoaxiality-bound extra",
        &["extra: found one argument too many; ", "wellposed point --help"],
    ),
    ("point", &["<CASE>: missing; ", "expected wellposed point <CASE>"]),
    ("granite", &["granite: unknown command; ", "allowed: map, point"]),
    (
        "run decay --checkpoint-every -1",
        &[
            "--checkpoint-every <SECONDS>: found '-1'; ",
            "expected a finite number of at least 0, in seconds",
        ],
    ),
    (
        "new harris-grekova --yield von-mises",
        &[
            "--yield: found von-mises with the model harris-grekova; ",
            "leave it out: the model has its own yield condition",
        ],
    ),
    (
        "new free-rotating --run",
        &[
            "--run: free-rotating cannot be run in time: it leaves the spin undetermined; ",
            "leave --run out, or name another kind",
        ],
    ),
    (
        "cases show nothing-like-it",
        &["nothing-like-it: no bundled case; ", "wellposed cases lists them"],
    ),
    ("new rheology --run", &["--run: rheology cannot be run in time; ", "leave --run out"]),
    (
        "new cosserat --shocks porous",
        &[
            "--shocks: not for the medium 'Cosserat solid'; ",
            "name the kind classical, without --yield",
        ],
    ),
    ("cases show", &["<NAME>: missing; ", "expected wellposed cases show <NAME>"]),
    ("cases foo", &["foo: unknown command; ", "allowed: show; ", "wellposed cases --help"]),
    (
        "cases --copy empty.toml",
        &[
            "empty.toml: a file is in the place of a folder; ",
            "name a folder that can be written to with --copy DIR",
        ],
    ),
    (
        "point noncoaxiality-bound --set background.pressure = 3",
        &["=: found one argument too many; ", "write --set KEY=VALUE without spaces around '='"],
    ),
    // Folders.
    ("resume empty.toml", &["empty.toml: a file, not a folder; ", "results of wellposed run"]),
    ("plot nothing", &["nothing: no such folder; ", "results of wellposed map, "]),
    ("verify nothing", &["nothing: no such folder; ", "results of a command, such as out/"]),
    ("compare nothing .", &["nothing: no such folder; ", "results of wellposed run"]),
    (
        "resume nothing",
        &["nothing: no such folder; ", "name a folder with the results of wellposed run"],
    ),
    (
        "point noncoaxiality-bound --out /proc/foo",
        &["/proc/foo: no folder can be created in /proc: ", "--out DIR"],
    ),
];

/// Returns the numbers of a text with more than six significant digits.
fn find_long_numbers(text: &str) -> Vec<&str> {
    let words = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    let digits = |word: &str| {
        let digits: String = word.chars().filter(char::is_ascii_digit).collect();
        digits.trim_start_matches('0').trim_end_matches('0').len()
    };
    words.filter(|word| digits(word) > 6).collect()
}

fn create_input_folder(name: &str) -> std::path::PathBuf {
    let here = create_folder(TEST_FOLDER, name);
    for (file, text) in FILES {
        fs::write(here.join(file), text).unwrap();
    }
    here
}

/// Runs the program, which must exit with code 2 and one error line; returns the message.
pub fn read_error(here: &Path, arguments: &str) -> String {
    let (stdout, stderr) = run_with_exit_code(2, here, arguments);
    assert_eq!(stdout, "", "{arguments}");
    let errors: Vec<&str> =
        stderr.lines().filter_map(|line| line.strip_prefix("error: ")).collect();
    assert_eq!(
        (errors.len(), stderr.lines().last()),
        (1, Some(format!("error: {}", errors[0]).as_str())),
        "{stderr}"
    );
    errors[0].to_owned()
}

#[test]
fn wrong_inputs_are_explained() {
    let here = create_input_folder("all");
    for (arguments, parts) in WRONG_INPUTS {
        let message = read_error(&here, arguments);
        let mut rest = message.as_str();
        for part in parts {
            match rest.find(part) {
                Some(start) => rest = &rest[start + part.len()..],
                None => panic!("wellposed {arguments}\n{message}\nwithout '{part}'"),
            }
        }
        assert_eq!(find_long_numbers(&message), [""; 0], "{message}");
    }
}

#[test]
fn results_of_other_verbs_are_named() {
    let here = create_folder(TEST_FOLDER, "other-results");
    run_with_exit_code(0, &here, "diagram creep --out p");
    let message = read_error(&here, "resume p");
    let expected = "p: holds results of wellposed diagram, but no run; name a folder with the results of wellposed run";
    assert!(message.starts_with(expected), "{message}");
}

/// Verifies that cases are run, printed and copied by name in a folder without them.
#[test]
fn bundled_cases_are_used_by_name() {
    let here = create_folder(TEST_FOLDER, "by-name");
    let arguments = "map noncoaxiality-bound --set map.x.points=3 --set map.y.points=2";
    let (stdout, _) = run_with_exit_code(0, &here, arguments);
    assert!(stdout.ends_with("picture: out/noncoaxiality-bound/map.png\n"), "{stdout}");
    // Paths of the repository are names, too; an error names file and line of the case.
    run_with_exit_code(
        0,
        &here,
        "point cases/granular-flow/noncoaxiality-bound.toml --dry-run --out other",
    );
    let message = read_error(&here, "speeds noncoaxiality-bound");
    assert!(message.starts_with("cases/granular-flow/noncoaxiality-bound.toml:"), "{message}");
    let (text, _) = run_with_exit_code(0, &here, "cases show noncoaxiality-bound");
    let path = "cases/granular-flow/noncoaxiality-bound.toml";
    let bundled = wellposed::CASES.iter().find(|(own, _)| *own == path).unwrap();
    // The schema for editors is above the folders of bundled cases, and beside a file that the reader writes.
    let beside = bundled.1.replace("#:schema ../", "#:schema ./");
    assert!(text == beside && text.starts_with("#:schema ./wellposed.schema.json\n"), "{text}");
    for (path, text) in wellposed::CASES {
        assert!(text.starts_with("#:schema ../wellposed.schema.json\n"), "{path}");
    }
    // A file takes precedence over a bundled case.
    fs::write(here.join("decay"), text.replace("title = ", "title = \"mine\" # ")).unwrap();
    let (stdout, _) = run_with_exit_code(0, &here, "point decay --dry-run --out mine");
    assert!(stdout.contains("analyse mine"), "{stdout}");

    run_with_exit_code(0, &here, "cases --copy copies");
    let copied =
        fs::read_to_string(here.join("copies/granular-flow/noncoaxiality-bound.toml")).unwrap();
    assert_eq!(copied, bundled.1);
    let schema = fs::read_to_string(here.join("copies/wellposed.schema.json")).unwrap();
    assert_eq!(schema, run_with_exit_code(0, &here, "schema").0);
    let changed = here.join("copies/flow/decay.toml");
    fs::write(&changed, "mine").unwrap();
    let message = read_error(&here, "cases --copy copies");
    assert!(
        message.contains("decay.toml: exists already; ") && message.contains("--force"),
        "{message}"
    );
    run_with_exit_code(0, &here, "cases --copy copies --force");
    assert!(fs::read_to_string(&changed).unwrap().len() > 4);
}

/// Verifies that Ctrl-C ends a study with a message and exit code 130, in both formats.
#[cfg(unix)]
#[test]
fn interrupted_studies_say_so() {
    let here = create_folder(TEST_FOLDER, "interrupted");
    let arguments = "map microrotation --set map.x.points=3000 --set map.y.points=3000 --threads 1";
    for format in ["text", "json"] {
        let child = start_program(&here, &format!("{arguments} --format {format}"));
        std::thread::sleep(std::time::Duration::from_secs(2));
        send_signal(&child, "INT");
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{stderr}");
        let last = stderr.lines().last().unwrap_or_default();
        let text = "interrupted before all results were written; run the command again";
        match format {
            "json" => {
                let error: serde_json::Value = serde_json::from_str(last).unwrap();
                assert_eq!(
                    (&error["kind"], &error["message"]),
                    (&"interrupted".into(), &text.into())
                );
            }
            _ => assert_eq!(last, format!("error: {text}")),
        }
        assert!(!here.join("out").exists());
    }
}
