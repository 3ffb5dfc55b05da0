//! Tests of errors as JSON and of exit codes.

use crate::program;

use program::*;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

const TEST_FOLDER: &str = "messages";

fn create_flow_folder(name: &str) -> PathBuf {
    let here = create_case_folder(TEST_FOLDER, name, "");
    run_with_exit_code(0, &here, "new harris-grekova case.toml --force");
    here
}

/// Runs the program, which must fail with `code`, and returns the JSON object of the last line of standard error.
fn read_json_error(code: i32, here: &Path, arguments: &str) -> Value {
    let (stdout, stderr) = run_with_exit_code(code, here, &format!("{arguments} --format json"));
    let line = stderr.lines().last().unwrap_or_default();
    let error: Value =
        serde_json::from_str(line).unwrap_or_else(|_| panic!("{arguments}: {stderr}"));
    let keys = [
        "schema",
        "kind",
        "message",
        "exit_code",
        "file",
        "line",
        "option",
        "key",
        "found",
        "allowed",
    ];
    assert_eq!(error.as_object().unwrap().keys().collect::<Vec<_>>(), keys, "{arguments}");
    assert_eq!((&error["schema"], &error["exit_code"]), (&1.into(), &code.into()), "{arguments}");
    if code == 2 {
        assert_eq!(stdout, "", "{arguments}");
        // The message equals that of the text format, if there is one.
        let (_, text) = run_with_exit_code(code, here, arguments);
        let message = error["message"].as_str().unwrap();
        assert!(text.contains(&format!("error: {message}")), "{arguments}: {text} {message}");
    }
    error
}

#[test]
fn case_errors_state_file_line_and_key() {
    let here = create_flow_folder("cases");
    let case = fs::read_to_string(here.join("case.toml")).unwrap();
    let line = 1 + case.lines().position(|line| line.starts_with("pressure")).unwrap();
    fs::write(here.join("wrong.toml"), case.replace("pressure = ", "pressure = -")).unwrap();
    let error = read_json_error(2, &here, "point wrong.toml");
    assert_eq!(error["kind"], "case");
    assert_eq!(error["file"], "wrong.toml");
    assert_eq!(error["line"], line);
    assert_eq!(error["key"], "background.pressure");
    assert_eq!(error["option"], Value::Null);
    assert!(error["found"].as_str().unwrap().contains("-1000"), "{error}");
    assert!(error["allowed"].as_str().is_some_and(|text| !text.is_empty()), "{error}");

    let error = read_json_error(2, &here, "map case.toml --set background.presure=1");
    assert_eq!(error["option"], "background.presure=1");
    assert_eq!((&error["file"], &error["line"]), (&Value::Null, &Value::Null));
    assert_eq!(error["key"], "background.presure");
    assert!(error["allowed"].as_str().unwrap().contains("did you mean"), "{error}");

    fs::write(here.join("syntax.toml"), "[model]\nkind = \n").unwrap();
    let error = read_json_error(2, &here, "point syntax.toml");
    assert_eq!((&error["file"], &error["line"]), (&"syntax.toml".into(), &2.into()), "{error}");

    let error = read_json_error(2, &here, "point absent.toml");
    assert_eq!((&error["kind"], &error["file"]), (&"case".into(), &"absent.toml".into()));
    fs::write(here.join("empty.toml"), "").unwrap();
    let error = read_json_error(2, &here, "point empty.toml");
    assert_eq!((&error["file"], &error["key"]), (&"empty.toml".into(), &"model.kind".into()));
}

#[test]
fn folder_and_argument_errors_are_json_objects() {
    let here = create_flow_folder("folders");
    fs::create_dir(here.join("full")).unwrap();
    fs::write(here.join("full/notes"), "").unwrap();
    let error = read_json_error(2, &here, "point case.toml --out full");
    assert_eq!((&error["kind"], &error["file"]), (&"output".into(), &"full".into()));
    assert!(error["allowed"].as_str().unwrap().contains("--force"), "{error}");
    for (arguments, kind) in [
        ("resume full", "output"),
        ("verify full", "output"),
        ("point case.toml --threads 0", "usage"),
        ("map case.toml --wrong", "usage"),
        ("granite case.toml", "usage"),
    ] {
        assert_eq!(read_json_error(2, &here, arguments)["kind"], kind, "{arguments}");
    }
    let (_, stderr) = run_with_exit_code(2, &here, "point case.toml --threads 0 --format=json");
    assert!(serde_json::from_str::<Value>(&stderr).is_ok(), "{stderr}");
    // The help text is not an error.
    let (stdout, stderr) = run_with_exit_code(0, &here, "map --format json --help");
    assert!(stdout.contains("Usage:") && stderr.is_empty());
    // The error of an ill-posed flow has a kind of its own.
    let text = fs::read_to_string(here.join("case.toml")).unwrap();
    assert!(text.contains("kind"));
    run_with_exit_code(0, &here, "new harris-grekova flow.toml --run");
    let arguments = "run flow.toml --set background.noncoaxiality_deg=60";
    let error = read_json_error(2, &here, arguments);
    assert_eq!(error["kind"], "ill-posed", "{error}");
}

#[test]
fn damaged_results_exit_with_1() {
    let here = create_flow_folder("damage");
    run_with_exit_code(0, &here, "point case.toml --out out");
    fs::write(here.join("out/point.txt"), "").unwrap();
    let error = read_json_error(1, &here, "verify out");
    assert_eq!(error["kind"], "damage");
}

/// Verifies that `check` refuses a folder without case files.
#[test]
fn check_of_folder_without_cases_is_refused() {
    let here = create_flow_folder("nothing");
    fs::create_dir_all(here.join("empty/below")).unwrap();
    fs::write(here.join("empty/notes.txt"), "").unwrap();
    for more in ["", " --dry-run"] {
        let error = read_json_error(2, &here, &format!("check empty{more}"));
        assert!(error["message"].as_str().unwrap().starts_with("empty: no case file"), "{error}");
    }
}
