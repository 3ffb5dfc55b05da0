//! Errors of the command line in one line: argument, value found, values allowed.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, CommandFactory, Error};
use std::error::Error as _;
use std::io::Write;
use std::process::ExitCode;
use wellposed::case::find_similar_name;
use wellposed::cli::{CommandError, UsageError, ranks};

/// Prints the usage error, with exit code 2, or the requested help or version, with exit code 0.
pub fn report_usage_error<C: CommandFactory>(error: &Error) -> ExitCode {
    if ranks::is_silent() {
        ranks::wait_for_root_message();
        return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
    }
    let arguments: Vec<String> = std::env::args_os()
        .skip(1)
        .map(|argument| argument.to_string_lossy().into_owned())
        .collect();
    let wants_json = arguments.windows(2).any(|pair| pair == ["--format", "json"])
        || arguments.iter().any(|argument| argument == "--format=json");
    if wants_json && error.use_stderr() {
        let error = CommandError::Usage(describe_usage_error::<C>(error, &arguments));
        let _ = writeln!(std::io::stderr(), "{}", error.to_json());
    } else if error.use_stderr()
        && error.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    {
        let error = describe_usage_error::<C>(error, &arguments);
        let _ = writeln!(std::io::stderr(), "error: {error}");
    } else {
        let _ = error.print();
    }
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

/// Describes an error of the argument parser; `arguments` are those of the program, without its name.
fn describe_usage_error<C: CommandFactory>(error: &Error, arguments: &[String]) -> UsageError {
    let verb = find_verb(&C::command(), arguments);
    let help = match &verb {
        Some(verb) => format!("wellposed {verb} --help lists the arguments"),
        None => "wellposed --help lists the commands".to_owned(),
    };
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(texts)) => texts.join(", "),
        _ => String::new(),
    };
    let argument = text(ContextKind::InvalidArg);
    let meant = |kind| match text(kind) {
        similar if similar.is_empty() => String::new(),
        similar => format!("did you mean '{similar}'? "),
    };
    let usage_error = |argument: String, found: String, allowed: String| UsageError {
        argument,
        found,
        allowed: match allowed.ends_with(' ') {
            true => format!("{allowed}{help}"),
            false => format!("{allowed}; {help}"),
        },
    };
    match error.kind() {
        ErrorKind::InvalidValue => {
            let found = match text(ContextKind::InvalidValue) {
                value if value.is_empty() => "found no value".to_owned(),
                value => format!("found '{value}'"),
            };
            let allowed = match text(ContextKind::ValidValue) {
                values if values.is_empty() => format!("expected {argument}"),
                values => format!("{}allowed: {values}", meant(ContextKind::SuggestedValue)),
            };
            usage_error(argument, found, allowed)
        }
        ErrorKind::ValueValidation => {
            let found = format!("found '{}'", text(ContextKind::InvalidValue));
            let allowed =
                error.source().map_or(format!("expected {argument}"), ToString::to_string);
            usage_error(argument, found, allowed)
        }
        ErrorKind::UnknownArgument => {
            let allowed = match meant(ContextKind::SuggestedArg) {
                _ if argument.starts_with('=') => {
                    "write --set KEY=VALUE without spaces around '='".to_owned()
                }
                suggestion if suggestion.is_empty() => {
                    let command = C::command();
                    let verb = verb.as_deref().and_then(|verb| command.find_subcommand(verb));
                    let options = verb.iter().flat_map(|own| own.get_arguments());
                    let options = options.filter_map(|own| Some(format!("--{}", own.get_long()?)));
                    match options.collect::<Vec<_>>() {
                        few if (1..=4).contains(&few.len()) => {
                            format!("leave it out; allowed: {}", few.join(", "))
                        }
                        _ => "leave it out".to_owned(),
                    }
                }
                suggestion => suggestion,
            };
            let found = match argument.starts_with('-') {
                true => "unknown option",
                false => "found one argument too many",
            };
            usage_error(argument, found.to_owned(), allowed)
        }
        ErrorKind::InvalidSubcommand => {
            let command = C::command();
            let parent = verb.as_deref().and_then(|verb| command.find_subcommand(verb));
            let found = text(ContextKind::InvalidSubcommand);
            let names = parent.unwrap_or(&command).get_subcommands().map(Command::get_name);
            let meant = find_similar_name(&found, names)
                .map_or(String::new(), |similar| format!("did you mean '{similar}'? "));
            let allowed = format!("{meant}allowed: {}", list_verbs(parent.unwrap_or(&command)));
            usage_error(found, "unknown command".to_owned(), allowed)
        }
        ErrorKind::MissingRequiredArgument => {
            // Options have their forms only in a command that is built.
            let mut command = C::command();
            command.build();
            let inner = verb.as_deref().and_then(|verb| command.find_subcommand(verb));
            // The subcommand of a verb, such as `show` of `cases`.
            let inner = inner.and_then(|own| find_verb(own, arguments));
            let verbs: Vec<&str> = verb.iter().chain(&inner).map(String::as_str).collect();
            let command = verbs.iter().try_fold(&command, |own, verb| own.find_subcommand(verb));
            let required: Vec<&Arg> = command
                .iter()
                .flat_map(|own| own.get_arguments())
                .filter(|own| own.is_required_set())
                .collect();
            let names: Vec<String> = required.iter().map(ToString::to_string).collect();
            let about = required.iter().find(|own| own.to_string() == argument);
            let about = about.and_then(|own| own.get_help());
            let about = about.map_or(String::new(), |about| format!(" ({argument}: {about})"));
            let usage =
                format!("expected wellposed {} {}{about}", verbs.join(" "), names.join(" "));
            usage_error(argument, "missing".to_owned(), usage)
        }
        ErrorKind::TooManyValues => {
            let found = format!("found '{}'", text(ContextKind::InvalidValue));
            usage_error(argument, found, "give it without a value".to_owned())
        }
        ErrorKind::ArgumentConflict => {
            let other = text(ContextKind::PriorArg);
            match other == argument {
                true => usage_error(argument, "found twice".to_owned(), "give it once".to_owned()),
                false => usage_error(
                    argument,
                    format!("found beside {other}"),
                    "give one of them".to_owned(),
                ),
            }
        }
        _ => {
            let rendered = error.render().to_string();
            let paragraph = rendered.split("\n\n").next().unwrap_or_default();
            let found = paragraph.lines().map(str::trim).collect::<Vec<_>>().join(" ");
            let found = found.trim_start_matches("error: ").to_owned();
            let name = verb.clone().unwrap_or("command line".to_owned());
            usage_error(name, found, "expected other arguments".to_owned())
        }
    }
}

/// Returns the verb among the arguments, if one is given.
fn find_verb(command: &Command, arguments: &[String]) -> Option<String> {
    let is_verb = |word: &&String| command.get_subcommands().any(|verb| verb.get_name() == **word);
    arguments.iter().find(is_verb).cloned()
}

fn list_verbs(command: &Command) -> String {
    command.get_subcommands().map(Command::get_name).collect::<Vec<_>>().join(", ")
}
