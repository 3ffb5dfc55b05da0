//! Command line: parses the arguments and calls the verbs of [`wellposed::cli`].

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use models::registry;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use wellposed::VERSION;
use wellposed::case::{Kind, Medium, Yield};
use wellposed::cli::new::{self, Purpose};
use wellposed::cli::{self, Control, Error, Format, Options, cases, signals};
use wellposed::study::MapOptions;

/// Well-posedness of continuum models of granular media.
#[derive(Parser)]
#[command(name = "wellposed", version = VERSION)]
struct CommandLine {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Verdict over two parameters of a case: picture, data and a summary in words
    Map {
        #[command(flatten)]
        run: Common,
        /// Also locate the greatest growth rate over all waves at every point
        #[arg(long)]
        bound: bool,
        /// Also give the greatest growth rate at the wave of the case at every point
        #[arg(long)]
        growth_rate: bool,
        /// Decide every point from the linearised equations, none by a model's closed form
        #[arg(long)]
        model_blind: bool,
    },
    /// Everything about one state: background, characteristics, roots, growth, verdict
    Point {
        #[command(flatten)]
        run: Common,
    },
    /// Frequencies and speeds of the waves of a solid against the wave number
    Dispersion {
        #[command(flatten)]
        run: Common,
    },
    /// Characteristic speeds of a solid against the direction, elastic and yielding
    Speeds {
        #[command(flatten)]
        run: Common,
    },
    /// Solve a solid or a flow in time: fields, receivers, energy ledger and a picture
    Run {
        #[command(flatten)]
        run: Common,
        /// Seconds between two checkpoints, from which an interrupted run resumes
        #[arg(long, value_name = "SECONDS", default_value_t = cli::CHECKPOINT_EVERY,
            value_parser = seconds)]
        checkpoint_every: f64,
        /// Run a flow although its equations are ill-posed: finer grids give other solutions
        #[arg(long)]
        accept_ill_posed: bool,
    },
    /// Predict complex frequencies and measure them in time: table, picture; exit code 1 where both disagree
    Check {
        #[command(flatten)]
        run: Common,
    },
    /// Go on with a run that was interrupted or killed; its results are the same bits
    Resume {
        /// The folder of its results
        folder: PathBuf,
        /// Number of threads [default: one per core]; results do not depend on it
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: Option<u16>,
        /// Seconds between two checkpoints
        #[arg(long, value_name = "SECONDS", default_value_t = cli::CHECKPOINT_EVERY,
            value_parser = seconds)]
        checkpoint_every: f64,
        /// Form of what is printed
        #[arg(long, value_enum, default_value = "text")]
        format: FormatName,
    },
    /// Draw the pictures of a finished run again
    Plot {
        /// The folder of its results
        folder: PathBuf,
    },
    /// Compare the files of a folder of results with their checksums; exit code 1 where one is damaged
    Verify {
        /// The folder of results
        folder: PathBuf,
        /// Form of what is printed
        #[arg(long, value_enum, default_value = "text")]
        format: FormatName,
    },
    /// List the cases that come with the program
    Cases,
    /// Write a commented case to start from
    New {
        /// Kind of model
        #[arg(value_parser = PossibleValuesParser::new(Kind::all().into_iter().map(Kind::name)).try_map(kind))]
        kind: Kind,
        /// Yield set of a solid that yields
        #[arg(long = "yield", value_name = "SET", value_parser =
            PossibleValuesParser::new(registry::yield_sets().into_iter().map(|set| set.name))
                .try_map(yield_set))]
        yields: Option<Yield>,
        /// A solid or a flow in time, for wellposed run
        #[arg(long = "run")]
        runs: bool,
        /// File to write [default: <KIND>.toml]
        file: Option<PathBuf>,
        /// Overwrite the file if it exists
        #[arg(long)]
        force: bool,
    },
    /// Print the schema of case files: JSON Schema for editors, or the reference page
    Schema {
        /// The reference page, in Markdown
        #[arg(long)]
        markdown: bool,
    },
    /// Print completions for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// What all verbs take that run a case.
#[derive(Args)]
struct Common {
    /// The case file
    case: PathBuf,
    /// Set a key of the case, as in background.pressure=500; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Form of what is printed
    #[arg(long, value_enum, default_value = "text")]
    format: FormatName,
    /// Folder for the results [default: out/<name of the case>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite results of another case
    #[arg(long)]
    force: bool,
    /// Check everything and say what would be done; write nothing
    #[arg(long)]
    dry_run: bool,
    /// Number of threads [default: one per core]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(Clone, Copy, ValueEnum)]
enum FormatName {
    Text,
    Json,
}

impl From<FormatName> for Format {
    fn from(name: FormatName) -> Self {
        match name {
            FormatName::Text => Self::Text,
            FormatName::Json => Self::Json,
        }
    }
}

fn kind(name: String) -> Result<Kind, String> {
    Kind::from_name(&name).ok_or_else(|| format!("no kind of model is called {name}"))
}

fn yield_set(name: String) -> Result<Yield, String> {
    registry::yield_set(&name).ok_or_else(|| format!("no yield set is called {name}"))
}

/// Parses the wall time between checkpoints, s; with 0 a checkpoint is written after every batch of steps.
fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds >= 0.0);
    seconds.ok_or_else(|| "expected a finite number of at least 0, in seconds".to_owned())
}

impl From<Common> for Options {
    fn from(run: Common) -> Self {
        Self {
            case: run.case,
            sets: run.sets,
            format: run.format.into(),
            out: run.out,
            force: run.force,
            dry_run: run.dry_run,
            threads: run.threads.map(usize::from),
            accept_ill_posed: false,
        }
    }
}

fn main() -> ExitCode {
    signals::install();
    let verb = match CommandLine::try_parse() {
        Ok(line) => line.verb,
        Err(error) => return refuse_usage(&error),
    };
    let format = verb.format();
    match carry_out(verb) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.exit_code() != 0 {
                // A closed standard error is ignored.
                let _ = match format {
                    Format::Text => writeln!(std::io::stderr(), "error: {error}"),
                    Format::Json => writeln!(std::io::stderr(), "{}", error.to_json()),
                };
            }
            ExitCode::from(error.exit_code())
        }
    }
}

/// Prints the usage error, or the requested help.
fn refuse_usage(error: &clap::Error) -> ExitCode {
    let arguments: Vec<String> =
        std::env::args_os().map(|own| own.to_string_lossy().into_owned()).collect();
    let wants_json = arguments.windows(2).any(|pair| pair == ["--format", "json"])
        || arguments.iter().any(|own| own == "--format=json");
    if wants_json && error.use_stderr() {
        let text = error.render().to_string();
        let message = text.lines().next().unwrap_or_default().trim_start_matches("error: ");
        let _ = writeln!(std::io::stderr(), "{}", Error::usage_to_json(message));
    } else {
        let _ = error.print();
    }
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

impl Verb {
    /// Returns the output format of the verb.
    fn format(&self) -> Format {
        match self {
            Self::Map { run, .. }
            | Self::Point { run }
            | Self::Dispersion { run }
            | Self::Speeds { run }
            | Self::Run { run, .. }
            | Self::Check { run } => run.format.into(),
            Self::Resume { format, .. } | Self::Verify { format, .. } => (*format).into(),
            _ => Format::Text,
        }
    }
}

fn carry_out(verb: Verb) -> Result<(), Error> {
    let mut stdout = std::io::stdout().lock();
    match verb {
        Verb::Map { run, bound, growth_rate, model_blind } => {
            let asked = MapOptions { bound, growth_rate, model_blind };
            cli::map(&run.into(), asked, &mut stdout)?;
        }
        Verb::Point { run } => cli::point(&run.into(), &mut stdout)?,
        Verb::Dispersion { run } => cli::dispersion(&run.into(), &mut stdout)?,
        Verb::Speeds { run } => cli::speeds(&run.into(), &mut stdout)?,
        Verb::Run { run, checkpoint_every, accept_ill_posed } => {
            let options = Options { accept_ill_posed, ..run.into() };
            cli::run(&options, Control { checkpoint_every }, &mut stdout)?;
        }
        Verb::Check { run } => cli::check(&run.into(), &mut stdout)?,
        Verb::Resume { folder, threads, checkpoint_every, format } => {
            let threads = threads.map(usize::from);
            let control = Control { checkpoint_every };
            cli::resume(&folder, threads, control, format.into(), &mut stdout)?;
        }
        Verb::Plot { folder } => cli::plot(&folder, &mut stdout)?,
        Verb::Verify { folder, format } => cli::verify(&folder, format.into(), &mut stdout)?,
        Verb::Cases => cases::run(&mut stdout)?,
        Verb::New { kind, yields, runs, file, force } => {
            let medium = Medium::new(kind, yields)?;
            let purpose = if runs { Purpose::Run } else { Purpose::State };
            let path = new::run(medium, purpose, file.as_deref(), force)?;
            let _ = writeln!(std::io::stderr(), "wrote {}", path.display());
        }
        Verb::Schema { markdown: true } => write!(stdout, "{}", wellposed::case::reference())?,
        Verb::Schema { markdown: false } => {
            writeln!(stdout, "{:#}", wellposed::case::json_schema())?;
        }
        Verb::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut CommandLine::command(), "wellposed", &mut text);
            stdout.write_all(&text)?;
        }
    }
    Ok(stdout.flush()?)
}
