//! Tests of the page of a results folder: its structure, its data, and its behaviour in a browser.

use crate::program::*;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

const TEST_FOLDER: &str = "report_page";

const STATE_CASE: &str = include_str!("data/state.toml");

/// Largest length of a page with a map, bytes.
const MAX_LENGTH: usize = 3_000_000;

/// Text that would end elements, comments and sections of a page if it were not escaped.
const HOSTILE_TEXT: &str = "</title></pre></script><script>alert(1)</script><!-- end of section map --> ]]> & \\\" ' <img src=x>";

fn read_page(folder: &Path) -> String {
    String::from_utf8(fs::read(folder.join("out/report.html")).unwrap()).unwrap()
}

/// Start tag of an element with its attributes.
struct StartTag {
    name: String,
    attributes: Vec<(String, String)>,
}

/// Splits a page into its start tags and checks that elements are closed in the order in which they are opened, that values
/// of attributes are in quotes and that identifiers are unique.
fn parse_page(page: &str) -> Vec<StartTag> {
    let (mut tags, mut open, mut ids) = (Vec::<StartTag>::new(), Vec::<String>::new(), Vec::new());
    let mut rest = page.strip_prefix("<!DOCTYPE html>\n").expect("a document type");
    while let Some((text, after)) = rest.split_once('<') {
        assert!(!text.contains('>'), "{text}");
        if let Some(comment) = after.strip_prefix("!--") {
            rest = comment.split_once("-->").expect("the end of a comment").1;
            continue;
        }
        let (tag, after) = after.split_once('>').expect("the end of a tag");
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "{tag}");
            continue;
        }
        let (tag, is_empty) = match tag.strip_suffix('/') {
            Some(tag) => (tag, true),
            None => (tag, false),
        };
        let (name, mut list) = tag.split_once(char::is_whitespace).unwrap_or((tag, ""));
        let mut attributes = Vec::new();
        while !list.trim().is_empty() {
            let (key, value) = list.split_once("=\"").unwrap_or_else(|| panic!("{tag}"));
            let (value, after) = value.split_once('"').unwrap_or_else(|| panic!("{tag}"));
            let key = key.trim();
            assert!(key.chars().all(|c| c.is_ascii_alphabetic() || "-:".contains(c)), "{tag}");
            if key == "id" {
                assert!(!ids.contains(&value), "{value} twice");
                ids.push(value);
            }
            attributes.push((key.to_owned(), value.to_owned()));
            list = after;
        }
        tags.push(StartTag { name: name.to_owned(), attributes });
        if is_empty {
            continue;
        }
        if ["script", "style"].contains(&name) {
            rest = rest.split_once(&format!("</{name}>")).expect("the end of a script").1;
            continue;
        }
        open.push(name.to_owned());
    }
    assert!(open.is_empty(), "{open:?}");
    tags
}

/// Checks the structure of a page, which refers to nothing outside it; returns the number of its scripts.
fn check_page(page: &str) -> usize {
    let tags = parse_page(page);
    for StartTag { name, attributes } in &tags {
        for (key, value) in attributes {
            let is_inside = value.starts_with('#') || value.starts_with("data:image/png;base64,");
            assert!(!["href", "src", "xlink:href"].contains(&key.as_str()) || is_inside, "{value}");
            assert!(!key.starts_with("on"), "{name} {key}");
        }
        let is_permitted = !["link", "iframe", "object", "embed", "base"].contains(&name.as_str());
        assert!(is_permitted, "{name}");
    }
    let style = page.split_once("<style>").unwrap().1.split_once("</style>").unwrap().0;
    assert!(!style.contains("url(") && !style.contains("@import"));
    let count = |name: &str| tags.iter().filter(|tag| tag.name == name).count();
    assert_eq!(count("h1"), 1);
    tags.iter().filter(|tag| tag.name == "script").count()
}

/// Returns the data of the map of a page.
fn read_map_data(page: &str) -> Value {
    let (_, rest) = page.split_once("<script type=\"application/json\">").expect("data");
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Verifies that the command of a section, given in the folder of the results, computes the same page and report again; and
/// that `plot` does.
fn check_command(here: &Path, study: &str, arguments: &str) {
    let page = read_page(here);
    let command =
        format!("<p class=\"command\">Command: <code>wellposed {study} {arguments}</code></p>");
    assert!(page.contains(&command), "{command}");
    let out = here.join("out");
    run_with_exit_code(0, &out, &format!("{study} {arguments} --out again --pictures html"));
    assert!(fs::read(out.join("again/report.html")).unwrap() == page.as_bytes());
    let report = format!("{study}.json");
    assert_eq!(
        fs::read(out.join("again").join(&report)).unwrap(),
        fs::read(out.join(&report)).unwrap()
    );
    run_with_exit_code(0, here, "plot out --pictures html");
    assert!(read_page(here) == page, "{command}");
}

/// Verifies that each section names the command that computes it, with the options that change results.
#[test]
fn commands_of_the_page_repeat_its_results() {
    for (name, options, arguments) in [
        ("plain", "", "case.toml"),
        ("bound", "--bound --growth-rate --threads 1", "case.toml --bound --growth-rate"),
        ("blind", "--model-blind --set background.pressure=2000", "case.toml --model-blind"),
    ] {
        let here = create_case_folder(TEST_FOLDER, &format!("command-{name}"), STATE_CASE);
        run_with_exit_code(0, &here, &format!("map case.toml --out out --pictures html {options}"));
        check_command(&here, "map", arguments);
    }
    let here = create_folder(TEST_FOLDER, "command-run");
    let arguments = "run plastic-potential-in-time --out out --pictures html --accept-ill-posed --threads 2 \
                     --set grid.cells=[36,36] --set initial[0].to=8 --set time.duration=1e-6";
    run_with_exit_code(0, &here, arguments);
    check_command(&here, "run", "case.toml --accept-ill-posed");
    let here = create_case_folder(TEST_FOLDER, "command-split", SOLID_CASE);
    run_with_exit_code(0, &here, "split case.toml --ranks 3 --threads 2 --out out --pictures html");
    check_command(&here, "split", "case.toml --ranks 3 --threads 2");
}

/// Returns the columns of a CSV table whose cells have no commas.
fn read_columns(path: &Path) -> Vec<(String, Vec<String>)> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(','));
    let mut columns: Vec<(String, Vec<String>)> =
        lines.next().unwrap().map(|name| (name.to_owned(), Vec::new())).collect();
    for line in lines {
        columns.iter_mut().zip(line).for_each(|(column, cell)| column.1.push(cell.to_owned()));
    }
    columns
}

fn find_column<'a>(columns: &'a [(String, Vec<String>)], name: &str) -> &'a [String] {
    &columns.iter().find(|own| own.0 == name).unwrap_or_else(|| panic!("{name}")).1
}

/// Verifies that the data of the map has the numbers of the table, and the samples those of `point`.
#[test]
fn map_of_the_page_has_the_numbers_of_table_and_point() {
    let here = create_case_folder(TEST_FOLDER, "map", STATE_CASE);
    run_with_exit_code(0, &here, "map case.toml --out out --pictures html --growth-rate");
    let page = read_page(&here);
    assert_eq!(check_page(&page), 2);
    let data = read_map_data(&page);
    let columns = read_columns(&here.join("out/map.csv"));
    let verdicts: Vec<&str> =
        data["verdicts"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let found = data["verdict"].as_str().unwrap().bytes();
    let found: Vec<&str> = found.map(|digit| verdicts[usize::from(digit - b'0')]).collect();
    assert_eq!(found, find_column(&columns, "verdict"));
    let fields = data["fields"].as_array().unwrap();
    let names: Vec<&str> = fields.iter().map(|field| field["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["order", "coefficient", "direction_deg", "growth_rate"]);
    for (name, field) in names.into_iter().zip(fields) {
        let values = field["values"].as_array().unwrap().iter();
        let values: Vec<u64> = values.map(|v| v.as_f64().unwrap_or(f64::NAN).to_bits()).collect();
        let cells = find_column(&columns, name).iter();
        let cells: Vec<u64> = cells.map(|c| c.parse().unwrap_or(f64::NAN).to_bits()).collect();
        assert_eq!(values.len(), cells.len(), "{name}");
        // The reader of JSON may be one unit in the last place off.
        let is_equal = |(value, cell): (&u64, &u64)| value.abs_diff(*cell) <= 1;
        assert!(values.iter().zip(&cells).all(is_equal), "{name}: {values:?}\n{cells:?}");
    }
    // The samples of all points, and one of them by `point`.
    let samples = &data["samples"];
    let [rows, sampled] = ["rows", "columns"].map(|key| samples[key].as_array().unwrap().len());
    assert_eq!((sampled, rows), (25, 9));
    let (column, row) = (20, 3);
    let sample = &samples["points"][row * 25 + column];
    let value = |axis: &str, index: usize| data[axis]["values"][index].to_string();
    let (x, y) = (value("x", column), value("y", row));
    let set = format!(
        "point case.toml --out point --pictures none --set background.noncoaxiality_deg={x} --set model.dilatancy_angle_deg={y}"
    );
    run_with_exit_code(0, &here, &set);
    let curve = read_columns(&here.join("point/growth_by_direction.csv"));
    let [directions, rates] = ["direction_deg", "growth_rate"].map(|name| {
        let cells = find_column(&curve, name).iter();
        cells.map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<f64>>()
    });
    let largest = rates.iter().fold(0.0, |max: f64, rate| max.max(rate.abs()));
    for (index, direction) in samples["directions"].as_array().unwrap().iter().enumerate() {
        let at = directions.iter().position(|own| *own == direction.as_f64().unwrap()).unwrap();
        let found = sample["g"][index].as_f64().unwrap();
        // Half a unit of four digits, and rounding of rates that are zero.
        let tolerance = 5e-4 * rates[at].abs() + 1e-9 * largest;
        assert!((found - rates[at]).abs() <= tolerance, "{direction}: {found}, {}", rates[at]);
    }
    let report: Value =
        serde_json::from_slice(&fs::read(here.join("point/point.json")).unwrap()).unwrap();
    let [found, expected] = [&sample["r"], &report["roots"]].map(|roots| {
        let roots = roots.as_array().unwrap().iter();
        roots.map(|root| [0, 1].map(|part| root[part].as_f64().unwrap())).collect::<Vec<_>>()
    });
    assert!(!expected.is_empty() && found.len() == expected.len(), "{found:?}, {expected:?}");
    for (found, expected) in found.iter().zip(&expected) {
        let size = expected[0].hypot(expected[1]);
        assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) <= 1e-3 * size.max(1e-9));
    }
}

/// Verifies that no text of a case becomes part of the structure of the page.
#[test]
fn texts_of_the_case_stay_texts() {
    let case = format!("title = \"{HOSTILE_TEXT}\"\n{STATE_CASE}");
    let here = create_case_folder(TEST_FOLDER, "hostile", &case);
    run_with_exit_code(0, &here, "map case.toml --out out --pictures html");
    run_with_exit_code(0, &here, "point case.toml --out out --pictures html");
    let page = read_page(&here);
    assert_eq!(check_page(&page), 2);
    assert!(!page.contains("alert(1)</script>") && page.contains("&lt;script&gt;alert(1)"));
    // Both sections are found again, although the text contains the mark of an end.
    let before = page.clone();
    run_with_exit_code(0, &here, "map case.toml --out out --pictures html");
    assert_eq!(read_page(&here), before);
}

/// Verifies that the page has the sections of all verbs in a fixed order, whatever the order of the verbs; and that it is
/// written, removed and verified like other files.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn page_has_a_section_for_each_verb() {
    let [one, other] =
        ["one", "other"].map(|name| create_case_folder(TEST_FOLDER, name, SOLID_CASE));
    let verbs = ["speeds", "dispersion", "point", "run"];
    for verb in verbs {
        run_with_exit_code(0, &one, &format!("{verb} case.toml --out out --threads 1"));
    }
    for verb in verbs.iter().rev() {
        run_with_exit_code(0, &other, &format!("{verb} case.toml --out out --threads 1"));
    }
    let page = read_page(&one);
    assert_eq!(check_page(&page), 1);
    assert!(page == read_page(&other));
    let places = ["point", "dispersion", "speeds", "run"].map(|verb| {
        page.find(&format!("<section id=\"{verb}\"")).unwrap_or_else(|| panic!("{verb}"))
    });
    assert!(places.is_sorted());
    // Tables are cut with a word, and the case is there.
    for part in
        ["ledger.csv: ", "These are the first 20 of ", "case.toml, with all defaults", "CRC-32"]
    {
        assert!(page.contains(part), "{part}");
    }
    // Damaged sections are left out, until `plot` creates them again.
    let path = one.join("out/report.html");
    fs::write(&path, page.replacen("wellposed speeds", "wellposed speedz", 1)).unwrap();
    let (stdout, _) = run_with_exit_code(1, &one, "verify out");
    assert!(stdout.contains("report.html: has other content"), "{stdout}");
    run_with_exit_code(0, &one, "point case.toml --out out --threads 1");
    assert!(!read_page(&one).contains("wellposed speed") && read_page(&one).contains("id=\"run\""));
    run_with_exit_code(0, &one, "verify out");
    fs::remove_file(&path).unwrap();
    let (stdout, _) = run_with_exit_code(0, &one, "plot out --pictures html");
    assert!(stdout.contains("report.html"), "{stdout}");
    assert!(page == read_page(&one));
    run_with_exit_code(0, &one, "verify out");
    // A page that is not asked for is left as it is; that of another case is removed with its other results.
    run_with_exit_code(0, &one, "speeds case.toml --out out --pictures png");
    assert!(page == read_page(&one));
    let arguments = "point case.toml --out out --pictures png --force --set yield.strength=3e4";
    run_with_exit_code(0, &one, arguments);
    assert!(!path.exists());
    // A new run begins without the section of the last one.
    let arguments = "run case.toml --out out --force --pictures none";
    run_with_exit_code(0, &other, arguments);
    let page = read_page(&other);
    assert!(!page.contains("id=\"run\"") && page.contains("id=\"speeds\""));
    run_with_exit_code(0, &other, "verify out");
}

/// Verifies that the page of a large map with fields of many digits remains small enough to be opened.
#[test]
fn page_of_a_large_map_is_bounded() {
    let case =
        STATE_CASE.replace("points = 25", "points = 150").replace("points = 9", "points = 100");
    let here = create_case_folder(TEST_FOLDER, "large", &case);
    run_with_exit_code(0, &here, "map case.toml --out out --pictures html --growth-rate");
    let page = read_page(&here);
    check_page(&page);
    assert!(page.len() < MAX_LENGTH, "{} bytes", page.len());
    let data = read_map_data(&page);
    assert_eq!(data["step"], 2);
    assert_eq!(data["verdict"].as_str().unwrap().len(), 75 * 50);
    let samples = &data["samples"];
    let counts = ["rows", "columns"].map(|key| samples[key].as_array().unwrap().len());
    assert!(counts.iter().all(|count| (20..=41).contains(count)), "{counts:?}");
    assert_eq!(samples["points"].as_array().unwrap().len(), counts[0] * counts[1]);
}

/// Script that a reader's movements replace: hovers, clicks, and moves by the keyboard.
const MOVEMENTS: &str = "<script>
const overlay = document.querySelector('.overlay'), box = overlay.getBoundingClientRect();
const at = { bubbles: true, clientX: box.left + box.width * 20 / 24, clientY: box.top + box.height * 5 / 8 };
const note = key => document.body.dataset[key] =
  document.querySelector(key === 'clicked' || key === 'entered' ? '.detail h3' : '.readout').textContent;
overlay.dispatchEvent(new PointerEvent('pointermove', at));
note('hovered');
overlay.dispatchEvent(new MouseEvent('click', at));
note('clicked');
const press = key => overlay.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
['ArrowLeft', 'ArrowUp', 'ArrowUp'].forEach(press);
note('moved');
press('Enter');
note('entered');
document.body.dataset.rows = document.querySelectorAll('.detail tbody tr').length;
document.body.dataset.curve = document.querySelector('.detail path').getAttribute('d').length > 100;
document.body.dataset.width = document.documentElement.scrollWidth <= window.innerWidth;
</script></body>";

/// Verifies in a browser that the map answers to pointer and keyboard.
#[test]
fn map_answers_in_a_browser() {
    let browsers = ["chromium", "chromium-browser", "google-chrome"];
    let has_browser = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|found| found.status.success())
    };
    let Some(browser) = browsers.into_iter().find(has_browser) else {
        eprintln!("no browser: {} not found; the page is not opened", browsers.join(", "));
        return;
    };
    let here = create_case_folder(TEST_FOLDER, "browser", STATE_CASE);
    run_with_exit_code(0, &here, "map case.toml --out out --pictures html");
    let page = read_page(&here).replace("</body>", MOVEMENTS);
    fs::write(here.join("moved.html"), page).unwrap();
    let address = format!("file://{}", here.join("moved.html").display());
    let profile = format!("--user-data-dir={}", here.join("profile").display());
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=390,844", &profile])
        .args(["--dump-dom", &address])
        .output()
        .unwrap();
    let page = String::from_utf8_lossy(&output.stdout);
    let body = page.split_once("<body").expect("a page").1.split_once('>').unwrap().0;
    for (key, parts) in [
        ("hovered", &["Δ = 60°", "ν = 15°", "growth rate of short waves", "fastest at"][..]),
        ("clicked", &["Δ = 60°", "ν = 15°"]),
        ("moved", &["Δ = 52.5°", "ν = 25°"]),
        ("entered", &["Δ = 52.5°", "ν = 25°"]),
        ("curve", &["true"]),
        ("width", &["true"]),
    ] {
        let value =
            body.split_once(&format!("data-{key}=\"")).unwrap_or_else(|| panic!("{key}: {body}"));
        let value = value.1.split_once('"').unwrap().0;
        assert!(parts.iter().all(|part| value.contains(part)), "{key}: {value}");
    }
    assert!(body.contains("data-rows=\"2\"") || body.contains("data-rows=\"3\""), "{body}");
}
