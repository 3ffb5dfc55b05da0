//! Verifies links, paths, commands and command output in the documents.

use crate::program;

use files::npz;
use program::{VERBS_WITH_CASE, run_with_arguments};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use wellposed::CASES;
use wellposed::case::Case;
use wellposed::cli::folder::{is_snapshot_name, result_file_names};

fn repository_root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn read_document(name: &str) -> String {
    fs::read_to_string(repository_root().join(name))
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Returns the paths of all documents, relative to the root.
pub(crate) fn document_paths() -> Vec<String> {
    let docs = fs::read_dir(repository_root().join("docs")).expect("docs");
    let docs = docs.map(|entry| entry.expect("an entry").file_name().into_string().expect("text"));
    let pages = docs.filter(|name| name.ends_with(".md")).map(|name| format!("docs/{name}"));
    let others = ["README.md", "CONTRIBUTING.md", "BENCHMARKS.md", "CHANGELOG.md"];
    others.map(str::to_owned).into_iter().chain(pages).collect()
}

/// Lists the paths of all files and folders of the repository, relative to the root, except `.git`, `target` and `out`
/// in it; folders end with a slash.
fn list_repository_paths() -> BTreeSet<String> {
    fn collect_paths(folder: &Path, prefix: &str, names: &mut BTreeSet<String>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let entry = entry.expect("an entry");
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            if name == ".git" || name == "target" || name == "out" {
                continue;
            }
            if entry.path().is_dir() {
                collect_paths(&entry.path(), &format!("{name}/"), names);
                names.insert(format!("{name}/"));
            } else {
                names.insert(name);
            }
        }
    }
    let mut names = BTreeSet::new();
    collect_paths(repository_root(), "", &mut names);
    names
}

/// Code in a document: blocks with their language, and inline spans.
pub(crate) struct DocumentCode {
    pub(crate) blocks: Vec<(String, String)>,
    pub(crate) spans: Vec<String>,
}

impl DocumentCode {
    pub(crate) fn new(text: &str) -> Self {
        let (mut blocks, mut spans) = (Vec::new(), Vec::new());
        for (index, part) in text.split("```").enumerate() {
            if index % 2 == 1 {
                let (language, block) = part.split_once('\n').unwrap_or((part, ""));
                blocks.push((language.to_owned(), block.to_owned()));
            } else {
                let code = part.split('`').skip(1).step_by(2);
                spans.extend(code.filter(|span| !span.contains("\n\n")).map(str::to_owned));
            }
        }
        Self { blocks, spans }
    }
}

/// Returns the case files that pages show in full under a name: the name in the first line, a comment, and the text.
fn cases_in_documents() -> Vec<(String, String)> {
    let blocks = document_paths()
        .into_iter()
        .flat_map(|path| DocumentCode::new(&read_document(&path)).blocks);
    let named = blocks.filter(|(language, _)| language == "toml").filter_map(|(_, block)| {
        let name = block.lines().next()?.strip_prefix("# ")?;
        name.ends_with(".toml").then(|| (name.to_owned(), block.clone()))
    });
    named.collect()
}

/// Writes a case file that a page shows, that is bundled, or else a template, to a folder.
fn write_own_case(folder: &Path, name: &str) {
    let shown = cases_in_documents().into_iter().find(|(own, _)| own == name);
    let bundled = CASES.iter().find(|(path, _)| path.ends_with(&format!("/{name}")));
    if let Some(text) = shown.map(|own| own.1).or(bundled.map(|own| own.1.to_owned())) {
        return fs::write(folder.join(name), text).expect("a file");
    }
    let written = run_with_arguments(folder, &["new", name.trim_end_matches(".toml")]);
    assert!(written.status.success(), "nothing writes {name}");
}

/// Returns the link anchor of a heading.
fn heading_anchor(headline: &str) -> String {
    let is_anchor_character = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    headline
        .trim()
        .to_lowercase()
        .chars()
        .filter(is_anchor_character)
        .collect::<String>()
        .replace(' ', "-")
}

#[test]
fn relative_links_have_targets() {
    let mut count = 0;
    for document in document_paths() {
        let text = read_document(&document);
        let folder = repository_root().join(&document).parent().expect("a folder").to_owned();
        // Without code, where derivatives such as d[j](s) look like links.
        let text: String = text.split('`').step_by(2).collect();
        let links = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        for link in links.map(|(link, _)| link).filter(|link| !link.starts_with("http")) {
            let (path, fragment) = link.split_once('#').unwrap_or((link, ""));
            let target = match path {
                "" => repository_root().join(&document),
                path => folder.join(path),
            };
            assert!(target.exists(), "{document}: {link}");
            if !fragment.is_empty() {
                let target = fs::read_to_string(&target).expect("a page");
                let mut headlines = target.lines().filter(|line| line.starts_with('#'));
                let is_target =
                    |line: &str| heading_anchor(line.trim_start_matches('#')) == fragment;
                assert!(headlines.any(is_target), "{document}: {link}");
            }
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

/// Verifies that paths and file names are those of the repository or of result files.
#[test]
fn paths_in_documents_exist() {
    const FILE_EXTENSIONS: [&str; 12] =
        ["rs", "toml", "md", "py", "svg", "png", "csv", "json", "txt", "npz", "gif", "pvd"];
    let tree = list_repository_paths();
    let is_file = |word: &str| {
        word.rsplit_once('.').is_some_and(|(_, extension)| FILE_EXTENSIONS.contains(&extension))
    };
    let shown_cases = cases_in_documents();
    let exists = |word: &str| {
        let end = format!("/{word}");
        // Paths are relative to the root or to the folder of cases; a file name without folder may be anywhere.
        let is_named = |path: &&String| match word.trim_end_matches('/').contains('/') {
            true => **path == word || **path == format!("cases/{word}"),
            false => **path == word || path.ends_with(&end),
        };
        let is_result = result_file_names().chain([
            "case.toml",
            "program.json",
            "log.txt",
            "wellposed.schema.json",
        ]);
        tree.iter().any(|path| is_named(&path) || path.trim_end_matches('/') == word)
            || is_result.into_iter().any(|name| name == word)
            || is_snapshot_name(word)
            || shown_cases.iter().any(|(name, _)| name == word)
            || word.starts_with("out/")
    };
    let starts_with_folder = |word: &str| {
        word.split('/').next().is_some_and(|name| repository_root().join(name).is_dir())
    };
    let mut count = 0;
    for document in document_paths().into_iter().filter(|document| document != "CHANGELOG.md") {
        let code = DocumentCode::new(&read_document(&document));
        let is_path = |word: &&str| {
            let is_path_character = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
            word.chars().all(is_path_character)
                && !word.starts_with("..")
                && (word.contains('/') || !word.starts_with('.'))
                && word.chars().any(|c| c.is_ascii_alphabetic())
                && (is_file(word)
                    || word.ends_with('/')
                    || (word.contains('/') && starts_with_folder(word)))
        };
        for word in code.spans.iter().flat_map(|span| span.split_whitespace()).filter(is_path) {
            assert!(exists(word), "{document}: {word}");
            count += 1;
        }
        // Folders in code blocks that show the layout of the repository.
        let plain = code.blocks.iter().filter(|(language, _)| language.is_empty());
        for word in plain.flat_map(|(_, block)| block.split_whitespace()) {
            if let Some(folder) = word.trim_matches([',', ';', ':']).strip_suffix('/') {
                assert!(exists(&format!("{folder}/")), "{document}: {word}");
                count += 1;
            }
        }
    }
    assert!(count > 100, "{count}");
}

/// Arguments of the commands of the program in a block: lines that begin with `wellposed`, with
/// `cargo run --release --`, or with an MPI launcher, joined with their continuation lines.
pub(crate) fn extract_commands(block: &str) -> Vec<String> {
    let joined = block.replace("\\\n", " ");
    let command = |line: &str| {
        let line = line.trim().trim_start_matches("$ ");
        let programs = ["wellposed ", "cargo run --release -- "];
        let launched = || {
            let is_launched = ["mpirun ", "srun "].iter().any(|name| line.starts_with(name));
            line.split_once(" wellposed ").filter(|_| is_launched).map(|(_, arguments)| arguments)
        };
        let own = programs.iter().find_map(|program| line.strip_prefix(program));
        let arguments = own.or_else(launched)?;
        // The comment and the redirection of the output are removed.
        let end = [" #", " >"].iter().filter_map(|mark| arguments.find(mark)).min();
        Some(arguments[..end.unwrap_or(arguments.len())].trim().to_owned())
    };
    joined.lines().filter_map(command).collect()
}

/// Splits a command at spaces outside single quotes, and removes the quotes, as the shell does.
fn split_shell_words(command: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for (index, part) in command.split('\'').enumerate() {
        if index % 2 == 1 {
            words.last_mut().expect("a word").push_str(part);
            continue;
        }
        for (place, piece) in part.split(' ').enumerate() {
            if place > 0 {
                words.push(String::new());
            }
            words.last_mut().expect("a word").push_str(piece);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Checks that the program accepts a command: as a dry run if its verb takes a case; with `--help` if it has
/// placeholders for other arguments.
fn check_command(command: &str) {
    let case = "cases/granular-flow/noncoaxiality-bound.toml";
    let words = split_shell_words(command);
    let arguments: Vec<&str> =
        words.iter().map(String::as_str).filter(|word| *word != "--dry-run").collect();
    let is_placeholder =
        |word: &&str| ["CASE", "DIR", "KIND", "NAME", "SHELL", "FILE", "SET", "…"].contains(word);
    let (verb, rest) = arguments.split_first().expect("a verb");
    let takes_case = VERBS_WITH_CASE.contains(verb);
    let has_placeholder = rest.iter().any(|word| is_placeholder(&word.trim_matches(['[', ']'])));
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let out = scratch.path().join("out");
    let out = out.to_str().expect("text");
    // A file without folder is one that the reader has written: a template, or a bundled case that the page shows.
    let own = rest.first().filter(|word| word.ends_with(".toml") && !word.contains('/'));
    if let Some(own) = own.filter(|_| takes_case) {
        write_own_case(scratch.path(), own);
    }
    let has_out = rest.contains(&"--out");
    let plan = if has_out { vec!["--dry-run"] } else { vec!["--dry-run", "--out", out] };
    let (folder, arguments): (&Path, Vec<&str>) = match *verb {
        _ if takes_case && own.is_some() => {
            (scratch.path(), arguments.iter().copied().chain(["--dry-run"]).collect())
        }
        // Folders of results or of cases do not exist.
        _ if rest.is_empty()
            || ["compare", "resume", "plot", "gather", "verify"].contains(verb)
            || [".", "show"].contains(&rest[0]) && rest.len() == 1
            || (has_placeholder && !takes_case) =>
        {
            (scratch.path(), vec![verb, "--help"])
        }
        // The placeholder `CASE` is replaced by a bundled case that the verb accepts.
        _ if takes_case && has_placeholder => {
            let case = match *verb {
                "map" | "point" => case,
                "split" => "cases/dynamics/lamb-2d.toml",
                "run" => "cases/flow/decay.toml",
                "diagram" => "cases/rheology/porous-plastic.toml",
                "homogenise" | "time" => "cases/blocky/pulse-breaking.toml",
                "shocks" => "cases/porous/foam-collapse.toml",
                _ => "cases/cosserat/forbidden-band.toml",
            };
            let rest = rest.iter().map(|word| if *word == "CASE" { case } else { word });
            let arguments = std::iter::once(*verb).chain(rest);
            (repository_root(), arguments.chain(plan).collect())
        }
        _ if takes_case => (repository_root(), arguments.iter().copied().chain(plan).collect()),
        _ => (scratch.path(), arguments.clone()),
    };
    let output = run_with_arguments(folder, &arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "wellposed {command}\n{errors}");
}

#[test]
fn commands_in_documents_are_accepted() {
    let mut commands = BTreeSet::new();
    for document in document_paths() {
        let text = read_document(&document);
        let code = DocumentCode::new(&text);
        // Blocks indented by four spaces are included.
        let indented: Vec<&str> = text.lines().filter(|line| line.starts_with("    ")).collect();
        let blocks = code.blocks.iter().filter(|(language, _)| language != "bash");
        commands.extend(blocks.flat_map(|(_, block)| extract_commands(block)));
        commands.extend(extract_commands(&indented.join("\n")));
        let spans = code.spans.iter().map(|span| span.replace('\n', " "));
        commands.extend(spans.flat_map(|span| extract_commands(&span)));
    }
    // Commands in the leading comments of cases, which show how to run them.
    for (_, text) in CASES {
        let lines = text.lines().filter_map(|line| line.strip_prefix('#')).map(str::trim);
        let lines = lines.map(|line| line.strip_prefix("Run").unwrap_or(line).trim());
        // The comment continues with the output, separated by two spaces.
        let command = |line: &str| line.split("  ").next().unwrap_or_default().to_owned();
        let program_line = |line: &str| line.starts_with("wellposed ").then(|| command(line));
        commands.extend(lines.filter_map(program_line).flat_map(|line| extract_commands(&line)));
    }
    let is_verb = |command: &&String| {
        !command.starts_with('-') && !command.starts_with('=') && !command.starts_with("COMMAND")
    };
    let commands: Vec<&String> = commands.iter().filter(is_verb).collect();
    assert!(commands.len() > 40, "{commands:#?}");
    commands.iter().for_each(|command| check_command(command));
}

/// Runs the blocks of shell commands with loops or substitutions, marked as `bash`, in an empty folder as home.
#[cfg(unix)]
#[test]
fn bash_blocks_in_documents_run() {
    let program = Path::new(program::PROGRAM_PATH).parent().expect("a folder");
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    let mut count = 0;
    for document in document_paths() {
        let blocks = DocumentCode::new(&read_document(&document)).blocks;
        for (_, block) in blocks.iter().filter(|(language, _)| language == "bash") {
            let scratch = tempfile::tempdir().expect("a scratch folder");
            let mut bash = std::process::Command::new("bash");
            let bash = bash.args(["-euc", block]).current_dir(scratch.path());
            let output = bash.env("PATH", &path).env("HOME", scratch.path()).output();
            let output = output.expect("bash");
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{document}: {block}\n{errors}");
            count += 1;
        }
    }
    assert_eq!(count, 3);
}

/// Returns whether the printed lines are the expected ones, in which a line `…` stands for any lines.
fn matches_transcript(expected: &[&str], printed: &[&str]) -> bool {
    match (expected, printed) {
        ([], _) => printed.is_empty(),
        (["…", rest @ ..], _) => {
            (0..=printed.len()).any(|start| matches_transcript(rest, &printed[start..]))
        }
        ([line, rest @ ..], [first, others @ ..]) => {
            line == first && matches_transcript(rest, others)
        }
        (_, []) => false,
    }
}

/// Verifies that transcripts in the documents equal the output of the commands.
#[test]
fn transcripts_equal_program_output() {
    let codes =
        document_paths().into_iter().map(|document| DocumentCode::new(&read_document(&document)));
    let blocks: Vec<String> = codes.flat_map(|code| code.blocks).map(|(_, block)| block).collect();
    let mut count = 0;
    for block in blocks.iter().filter(|block| block.starts_with("$ wellposed ")) {
        let command = extract_commands(block).remove(0);
        let lines = block.lines().position(|line| !line.ends_with('\\')).expect("a command") + 1;
        let expected: Vec<&str> = block.lines().skip(lines).collect();
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let out: PathBuf = scratch.path().join("out");
        let mut arguments: Vec<&str> = command.split_whitespace().collect();
        let is_own = arguments[1].ends_with(".toml") && !arguments[1].contains('/');
        let folder = if is_own { scratch.path() } else { repository_root() };
        if is_own {
            write_own_case(folder, arguments[1]);
        }
        // Results lie in the scratch folder, also where the page names another.
        arguments
            .truncate(arguments.iter().position(|word| *word == "--out").unwrap_or(usize::MAX));
        arguments.extend(["--pictures", "none", "--out", out.to_str().expect("text")]);
        let printed =
            String::from_utf8(run_with_arguments(folder, &arguments).stdout).expect("text");
        // The line with the path of the results is omitted.
        let is_path = |line: &&str| line.starts_with("picture: ") || line.starts_with("results: ");
        let printed: Vec<&str> = printed.lines().filter(|line| !is_path(line)).collect();
        assert!(
            matches_transcript(&expected, &printed),
            "wellposed {command}\n{block}\n{}",
            printed.join("\n")
        );
        count += 1;
    }
    assert_eq!(count, 9);
}

/// Verifies that the page of commands is that of the parser, and that each command has a section in it and a man page.
#[test]
fn commands_page_and_man_pages_are_complete() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let printed = run_with_arguments(folder.path(), &["manual", "--markdown"]).stdout;
    let page = read_document("docs/commands.md");
    assert!(
        String::from_utf8_lossy(&printed) == page,
        "write it anew: wellposed manual --markdown > docs/commands.md"
    );
    let written = run_with_arguments(folder.path(), &["manual", "man1"]);
    assert!(written.status.success());
    let help = run_with_arguments(folder.path(), &["--help"]).stdout;
    let help = String::from_utf8(help).expect("text");
    let commands = help.split("Commands:\n").nth(1).expect("commands");
    let names = commands.lines().map_while(|line| line.strip_prefix("  ")?.split(' ').next());
    let names: Vec<&str> = names.filter(|name| *name != "help").collect();
    assert_eq!(names.len(), 21, "{help}");
    for name in names {
        assert!(page.contains(&format!("\n## `wellposed {name}`\n")), "{name}");
        let path = folder.path().join(format!("man1/wellposed-{name}.1"));
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        for part in [".TH wellposed", ".SH SYNOPSIS", ".SH EXAMPLES", ".SH \"EXIT STATUS\""] {
            assert!(text.contains(part), "{name}: {part}\n{text}");
        }
    }
    let page = fs::read_to_string(folder.path().join("man1/wellposed.1")).expect("a man page");
    assert!(page.contains("wellposed\\-map(1)"), "{page}");
}

/// Verifies that cargo commands name existing packages, tests, benchmarks and examples.
#[test]
fn cargo_commands_name_existing_targets() {
    let mut count = 0;
    for document in document_paths() {
        let text = read_document(&document);
        let code = DocumentCode::new(&text);
        let blocks = code.blocks.iter().flat_map(|(_, block)| block.lines());
        let spans = code.spans.iter().map(|span| span.replace('\n', " "));
        let indented = text.lines().filter(|line| line.starts_with("    "));
        let lines = blocks.chain(indented).map(|line| line.trim().to_owned()).chain(spans);
        for line in lines.filter(|line| line.starts_with("cargo ")) {
            let words: Vec<&str> =
                line.split_whitespace().take_while(|word| *word != "--" && *word != "#").collect();
            let value =
                |option: &str| words.windows(2).find(|pair| pair[0] == option).map(|pair| pair[1]);
            let package = value("-p").map(|name| {
                name.strip_prefix("wellposed-").unwrap_or_else(|| panic!("{document}: {line}"))
            });
            let folder = repository_root().join(package.unwrap_or("."));
            assert!(folder.join("Cargo.toml").exists(), "{document}: {line}");
            for (option, target_folder) in
                [("--test", "tests"), ("--bench", "benches"), ("--example", "examples")]
            {
                let Some(name) = value(option) else { continue };
                let path = folder.join(target_folder).join(name);
                let exists = path.with_extension("rs").exists() || path.join("main.rs").exists();
                assert!(exists, "{document}: {line}");
                count += 1;
            }
        }
    }
    assert!(count > 10, "{count}");
}

/// Verifies that the README is short, shows six pictures with the command of each, and links to the contents, which link
/// to every page.
#[test]
fn readme_is_short_and_contents_link_every_page() {
    let text = read_document("README.md");
    assert!(text.lines().count() <= 150, "{}", text.lines().count());
    let section = text.split("\n## ").find(|section| section.starts_with("Six pictures"));
    let pictures: Vec<&str> = section.expect("pictures").split("![").skip(1).collect();
    assert_eq!(pictures.len(), 6);
    for picture in pictures {
        let blocks = DocumentCode::new(picture).blocks;
        assert_eq!(
            blocks.iter().flat_map(|(_, block)| extract_commands(block)).count(),
            1,
            "{picture}"
        );
    }
    assert!(text.contains("](docs/SUMMARY.md)"));
    let contents = read_document("docs/SUMMARY.md");
    for page in document_paths() {
        let link = match page.strip_prefix("docs/") {
            Some("SUMMARY.md") => continue,
            Some(name) => name.to_owned(),
            None if page == "README.md" => continue,
            None => format!("../{page}"),
        };
        assert!(contents.contains(&format!("]({link})")), "{page}");
    }
}

/// Verifies that every picture of the gallery is in a document.
#[test]
fn every_gallery_picture_is_shown_in_a_document() {
    let text: String = document_paths().iter().map(|document| read_document(document)).collect();
    for entry in fs::read_dir(repository_root().join("gallery")).expect("a folder") {
        let name = entry.expect("an entry").file_name().into_string().expect("text");
        assert!(text.contains(&format!("gallery/{name})")), "{name}");
    }
}

/// Verifies that the page of cases has a row for every bundled case and no others.
#[test]
fn case_page_lists_every_bundled_case() {
    let page = read_document("docs/cases.md");
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    let rows: BTreeSet<String> = rows.map(|(name, _)| format!("cases/{name}")).collect();
    let bundled: BTreeSet<String> = CASES.iter().map(|(path, _)| (*path).to_owned()).collect();
    assert_eq!(rows, bundled);
}

/// Verifies that TOML blocks are complete, valid cases.
#[test]
fn toml_blocks_in_documents_are_valid_cases() {
    let mut count = 0;
    for document in document_paths() {
        for (language, block) in DocumentCode::new(&read_document(&document)).blocks {
            if language == "toml" {
                let read = Case::parse(&block, &document, &[]);
                read.unwrap_or_else(|error| panic!("{error}\n{block}"));
                count += 1;
            }
        }
    }
    assert_eq!(count, 9);
}

/// Verifies that the arrays used by Python examples exist in the result files.
#[test]
fn python_examples_name_existing_arrays() {
    let mut count = 0;
    for document in document_paths() {
        for (_, block) in DocumentCode::new(&read_document(&document))
            .blocks
            .iter()
            .filter(|(language, _)| language == "python")
        {
            for line in block.lines() {
                let Some((name, rest)) = line.split_once(" = np.load(\"out/") else { continue };
                let path = rest.split_once('"').expect("a path").0;
                let (case, file) = path.split_once('/').expect("a folder");
                let arrays = run_and_list_arrays(case, file);
                let start = format!("{name}[\"");
                for index in block.split(&start).skip(1).filter_map(|rest| rest.split_once('"')) {
                    assert!(arrays.iter().any(|name| name == index.0), "{document}: {}", index.0);
                    count += 1;
                }
            }
        }
    }
    assert!(count >= 10, "{count}");
}

/// Runs a bundled case for a short time and returns the names of the arrays in one of its result files.
fn run_and_list_arrays(case: &str, file: &str) -> Vec<String> {
    let end = format!("/{case}.toml");
    let (path, _) = CASES.iter().find(|(path, _)| path.ends_with(&end)).expect("a bundled case");
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let out = scratch.path().to_str().expect("text");
    let arguments: &[&str] = match file {
        "map.npz" => &["map", path, "--out", out],
        _ => &["run", path, "--set", "time.duration=1e-3", "--out", out],
    };
    let output = run_with_arguments(repository_root(), arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = fs::read(scratch.path().join(file)).expect("a file of results");
    npz::read_arrays(&bytes).expect("arrays").into_iter().map(|array| array.name).collect()
}
