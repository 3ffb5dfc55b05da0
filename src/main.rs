//! Command line: parses the arguments and calls the verbs of [`wellposed::cli`].

#[cfg(unix)]
mod allocator;
mod format_argument;
mod help;
mod manual;
mod map_arguments;
mod number_arguments;
mod picture_arguments;
mod point_arguments;
mod usage;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use dynamics::decomposition::communicator::Communicator;
use format_argument::FormatArgument;
use map_arguments::MapArguments;
use models::interface::continuum::OpeningLimit;
use models::registry;
use number_arguments::{
    parse_block_count, parse_cells_per_block, parse_rank_count, parse_seconds, parse_step_count,
    parse_thread_count,
};
use picture_arguments::PictureArguments;
use point_arguments::PointArguments;
use std::io::Write;
use std::num::NonZero;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use wellposed::VERSION;
use wellposed::case::{ContinuumOptions, MediumKind, ModelKind, YieldSetKind};
use wellposed::cli::new::{self, TemplateKind};
use wellposed::cli::{
    self, CheckpointSettings, CommandError, Options, OutputFormat, cases, ranks, signals,
};
use wellposed::report::PictureOptions;

#[cfg(unix)]
#[global_allocator]
static ALLOCATOR: allocator::ReportingAllocator = allocator::ReportingAllocator;

/// Well-posedness of continuum models of granular media.
#[derive(Parser)]
#[command(name = "wellposed", bin_name = "wellposed", version = VERSION)]
struct CommandLine {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Map the verdict over two parameters of a case: picture, data and summary
    Map {
        #[command(flatten)]
        quantities: MapArguments,
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Analyse one state: background, characteristics, dispersion roots, growth, verdict
    Point {
        #[command(flatten)]
        proof: PointArguments,
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Compute the dispersion relation of a solid, or Bloch waves of a blocky medium, against wave number
    Dispersion {
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Compute the stress-strain diagram of a rheological scheme, and the energies of its elements
    Diagram {
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Write the case of the Cosserat continuum that is equivalent to a blocky medium
    Homogenise {
        /// Case file of a blocky medium, or name of a bundled case
        #[arg(id = "case", value_name = "CASE")]
        case_path: PathBuf,
        /// Override a key of the case, e.g. joint[0].thickness=5e-3; may be repeated
        #[arg(long = "set", value_name = "KEY=VALUE")]
        settings: Vec<String>,
        /// File to write, or folder for it [default: <name of the case>-continuum.toml]
        #[arg(long = "out", value_name = "FILE|DIR")]
        output_path: Option<PathBuf>,
        /// Cells of the grid per block along each axis
        #[arg(long, value_name = "N", default_value_t = 1,
            value_parser = parse_cells_per_block)]
        cells_per_block: u16,
        /// Take the overturning of blocks of side h as the limit of the couple stress (couple friction κ_μ = h/2),
        /// instead of the first opening of their faces (κ_μ = h/6)
        #[arg(long)]
        overturning: bool,
        /// Output format
        #[arg(long, value_enum, default_value = "text")]
        format: FormatArgument,
        /// Overwrite the file if it exists
        #[arg(long)]
        force: bool,
        /// Validate the case and print the plan; write nothing
        #[arg(long = "dry-run")]
        is_dry_run: bool,
    },
    /// Compute the characteristic speeds of a solid against direction, elastic and yielding
    Speeds {
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Compute plane waves in a granular or porous medium exactly: waves behind a piston, compaction shocks, spall
    Shocks {
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Plan the parts of a grid for several processes: cells, memory and messages of each, picture
    Split {
        /// Number of processes ("ranks")
        #[arg(long = "ranks", value_name = "N", value_parser = parse_rank_count)]
        rank_count: u32,
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Measure the time of a step of a blocky medium against the number of blocks, beside a model
    Time {
        /// Numbers of blocks along each axis
        #[arg(long = "blocks", value_name = "N,…", value_delimiter = ',', default_value = "25,50,100,200,400",
            value_parser = parse_block_count)]
        block_counts: Vec<u16>,
        /// Numbers of ranks on threads of this process, 1 unless given; a launcher gives its own
        #[arg(long = "ranks", value_name = "N,…", value_delimiter = ',',
            value_parser = parse_thread_count)]
        rank_counts: Vec<u16>,
        /// Number of steps of a round
        #[arg(long, value_name = "N", default_value_t = 20, value_parser = parse_step_count)]
        steps: u16,
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Simulate a solid or flow in the time domain: fields, receivers, energy ledger, picture
    Run {
        /// Wall time between two checkpoints, from which an interrupted run resumes, s
        #[arg(long = "checkpoint-every", value_name = "SECONDS", default_value_t = cli::DEFAULT_CHECKPOINT_INTERVAL,
            allow_negative_numbers = true, value_parser = parse_seconds)]
        checkpoint_interval: f64,
        /// Simulate a flow although its equations are ill-posed and its solution depends on the grid
        #[arg(long)]
        accept_ill_posed: bool,
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Compare predicted complex frequencies with simulated ones: table, picture; exit code 1 on disagreement
    Check {
        /// Print only rows, and of a folder only cases, that disagree; files of results have all rows
        #[arg(long = "disagreeing")]
        only_disagreeing: bool,
        #[command(flatten)]
        arguments: CaseArguments,
    },
    /// Compare two finished runs of the same load, such as a blocky medium and its equivalent continuum: means over blocks,
    /// fronts, dissipated energy
    Compare {
        /// Results folder of the first run, to which relative differences refer
        first: PathBuf,
        /// Results folder of the second run
        second: PathBuf,
        /// Results folder [default: out/<name of the first>-<name of the second>]
        #[arg(long = "out", value_name = "DIR")]
        output_folder: Option<PathBuf>,
        /// Output format
        #[arg(long, value_enum, default_value = "text")]
        format: FormatArgument,
        /// Overwrite results of another case
        #[arg(long)]
        force: bool,
        /// Check the folders and print the plan; write nothing
        #[arg(long = "dry-run")]
        is_dry_run: bool,
        #[command(flatten)]
        pictures: PictureArguments,
    },
    /// Resume an interrupted or killed run; results are bit-identical to those of an uninterrupted run
    Resume {
        /// Results folder
        folder: PathBuf,
        /// Number of threads [default: one per core]; results do not depend on it
        #[arg(long, value_name = "N", value_parser = parse_thread_count)]
        threads: Option<u16>,
        /// Wall time between two checkpoints, s
        #[arg(long = "checkpoint-every", value_name = "SECONDS", default_value_t = cli::DEFAULT_CHECKPOINT_INTERVAL,
            allow_negative_numbers = true, value_parser = parse_seconds)]
        checkpoint_interval: f64,
        /// Output format
        #[arg(long, value_enum, default_value = "text")]
        format: FormatArgument,
        #[command(flatten)]
        pictures: PictureArguments,
    },
    /// Redraw the pictures of a results folder
    Plot {
        /// Results folder
        folder: PathBuf,
        #[command(flatten)]
        pictures: PictureArguments,
    },
    /// Join the files that several ranks have written for their cells, and draw the pictures of the run
    Gather {
        /// Results folder of a finished run
        folder: PathBuf,
        /// Write the snapshots as a Zarr store for xarray too, snapshots.zarr.zip, in chunks of at most N cells along each axis
        #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "128", require_equals = true, value_parser = clap::value_parser!(u16).range(8..=1024))]
        zarr: Option<u16>,
        #[command(flatten)]
        pictures: PictureArguments,
    },
    /// Compare the files of a results folder with their checksums, and check the proof of a certificate; exit code 1 if a
    /// file is damaged or a certificate proves nothing
    Verify {
        /// Results folder, or a certificate of wellposed point --certified
        #[arg(value_name = "DIR|FILE")]
        path: PathBuf,
        /// Output format
        #[arg(long, value_enum, default_value = "text")]
        format: FormatArgument,
    },
    /// List the bundled cases, which every command takes by their names; print or copy them
    #[command(args_conflicts_with_subcommands = true)]
    Cases {
        /// Copy all cases to this folder, with their schema for editors
        #[arg(long = "copy", value_name = "DIR")]
        copy_folder: Option<PathBuf>,
        /// Overwrite files that exist with another text
        #[arg(long, requires = "copy_folder")]
        force: bool,
        #[command(subcommand)]
        action: Option<CasesAction>,
    },
    /// List the models: names, equations, references
    Models {
        /// Output format
        #[arg(long, value_enum, default_value = "text")]
        format: FormatArgument,
    },
    /// Write a commented template of a case file, with the schema for editors beside it
    New {
        /// Kind of model, or a rheological scheme
        #[arg(value_parser = PossibleValuesParser::new(template_kinds().map(ModelKind::name)).try_map(parse_kind))]
        kind: ModelKind,
        /// Yield set of the solid
        #[arg(long = "yield", value_name = "SET", value_parser =
            PossibleValuesParser::new(registry::yield_sets().into_iter().map(|set| set.name))
                .try_map(parse_yield_set))]
        yield_set: Option<YieldSetKind>,
        /// Template of a time-domain simulation, for wellposed run
        #[arg(long = "run")]
        is_simulation: bool,
        /// Template of plane waves in a granular or porous medium, for wellposed shocks; for the kind classical
        #[arg(long = "shocks", value_enum, conflicts_with_all = ["is_simulation", "yield_set"])]
        plane_wave: Option<PlaneWaveArgument>,
        /// File to write [default: <KIND>.toml; with --shocks, granular.toml or porous.toml]
        file: Option<PathBuf>,
        /// Overwrite the file if it exists
        #[arg(long)]
        force: bool,
    },
    /// Print the schema of case files: JSON Schema for editors, or the reference page
    Schema {
        /// Print the reference page in Markdown
        #[arg(long = "markdown")]
        is_markdown: bool,
    },
    /// Print completions for a shell
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
    /// Write man pages of the program and of its commands, or print them as one page in Markdown
    #[command(hide = true)]
    Manual {
        /// Folder to write to, e.g. ~/.local/share/man/man1; files of an earlier version are overwritten
        #[arg(value_name = "DIR", required_unless_present = "is_markdown")]
        folder: Option<PathBuf>,
        /// Print one page in Markdown
        #[arg(long = "markdown", conflicts_with = "folder")]
        is_markdown: bool,
    },
}

#[derive(Subcommand)]
enum CasesAction {
    /// Print the text of a case
    Show {
        /// Name or path of the case, as listed
        name: String,
    },
}

/// Arguments of all verbs that run a case.
#[derive(Args)]
struct CaseArguments {
    /// Case file, or name of a bundled case
    #[arg(id = "case", value_name = "CASE")]
    case_path: PathBuf,
    /// Override a key of the case, e.g. background.pressure=500; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Output format
    #[arg(long, value_enum, default_value = "text")]
    format: FormatArgument,
    /// Results folder [default: out/<name of the case>]
    #[arg(long = "out", value_name = "DIR")]
    output_folder: Option<PathBuf>,
    /// Overwrite results of another case
    #[arg(long)]
    force: bool,
    /// Validate the case and print the plan; write nothing
    #[arg(long = "dry-run")]
    is_dry_run: bool,
    /// Number of threads [default: one per core]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_thread_count)]
    threads: Option<u16>,
    #[command(flatten)]
    pictures: PictureArguments,
}

/// Medium of a template of plane waves.
#[derive(Clone, Copy, ValueEnum)]
enum PlaneWaveArgument {
    Granular,
    Porous,
}

/// Kinds of which there are templates.
fn template_kinds() -> impl Iterator<Item = ModelKind> {
    ModelKind::all_kinds().into_iter().chain(ModelKind::WITHOUT_ENTRY)
}

fn parse_kind(name: String) -> Result<ModelKind, String> {
    template_kinds()
        .find(|kind| kind.name() == name)
        .ok_or_else(|| format!("no kind of model is called {name}"))
}

fn parse_yield_set(name: String) -> Result<YieldSetKind, String> {
    registry::find_yield_set(&name).ok_or_else(|| format!("no yield set is called {name}"))
}

impl From<CaseArguments> for Options {
    fn from(arguments: CaseArguments) -> Self {
        let thread_count = arguments.threads.map(usize::from);
        let drawing_threads = thread_count
            .and_then(NonZero::new)
            .or_else(|| std::thread::available_parallelism().ok())
            .unwrap_or(NonZero::<usize>::MIN);
        Self {
            case_path: arguments.case_path,
            settings: arguments.settings,
            format: arguments.format.into(),
            output_folder: arguments.output_folder,
            force: arguments.force,
            is_dry_run: arguments.is_dry_run,
            thread_count,
            accept_ill_posed: false,
            only_disagreeing: false,
            pictures: PictureOptions { thread_count: drawing_threads, ..arguments.pictures.into() },
        }
    }
}

fn main() -> ExitCode {
    signals::set_silence(ranks::is_silent());
    signals::install_signal_handlers();
    let command = help::add_examples(CommandLine::command());
    let line = command.try_get_matches().and_then(|own| CommandLine::from_arg_matches(&own));
    let verb = match line {
        Ok(line) => line.verb,
        Err(error) => return usage::report_usage_error::<CommandLine>(&error),
    };
    let format = verb.output_format();
    signals::set_error_format(format);
    #[cfg(unix)]
    allocator::PRINTS_JSON_ERRORS
        .store(format == OutputFormat::Json, std::sync::atomic::Ordering::Relaxed);
    match execute_verb(verb) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.exit_code() != 0 && ranks::is_silent() {
                ranks::wait_for_root_message();
            } else if error.exit_code() != 0 {
                // A closed standard error is ignored.
                let _ = match format {
                    OutputFormat::Text => writeln!(std::io::stderr(), "error: {error}"),
                    OutputFormat::Json => writeln!(std::io::stderr(), "{}", error.to_json()),
                };
            }
            ExitCode::from(error.exit_code())
        }
    }
}

impl Verb {
    /// Returns the output format of the verb.
    fn output_format(&self) -> OutputFormat {
        match self {
            Self::Map { arguments, .. }
            | Self::Point { arguments, .. }
            | Self::Dispersion { arguments }
            | Self::Diagram { arguments }
            | Self::Speeds { arguments }
            | Self::Shocks { arguments }
            | Self::Split { arguments, .. }
            | Self::Time { arguments, .. }
            | Self::Run { arguments, .. }
            | Self::Check { arguments, .. } => arguments.format.into(),
            Self::Resume { format, .. }
            | Self::Verify { format, .. }
            | Self::Compare { format, .. }
            | Self::Homogenise { format, .. }
            | Self::Models { format } => (*format).into(),
            _ => OutputFormat::Text,
        }
    }
}

/// Executes a verb in this process alone, or, under a launcher of several, on ranks, whose communication it ends.
fn execute_on_ranks(
    stdout: &mut dyn Write,
    alone: impl FnOnce(&mut dyn Write) -> Result<(), CommandError>,
    on_ranks: impl FnOnce(&Arc<dyn Communicator>, &mut dyn Write) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    let Some(communicator) = ranks::start_ranks()? else { return alone(stdout) };
    let result = on_ranks(&communicator, stdout);
    communicator.finish();
    result
}

fn execute_verb(verb: Verb) -> Result<(), CommandError> {
    let mut stdout = std::io::stdout().lock();
    match &verb {
        Verb::Run { .. } | Verb::Resume { .. } | Verb::Map { .. } => {}
        Verb::Time { .. } | Verb::Check { .. } => {}
        _ => ranks::require_single_process()?,
    }
    match verb {
        Verb::Map { quantities, arguments } => {
            let (options, map_options) = (arguments.into(), quantities.into());
            execute_on_ranks(
                &mut stdout,
                |stdout| cli::run_map(&options, map_options, stdout),
                |communicator, stdout| {
                    ranks::run_map_on_ranks(&options, map_options, communicator, stdout)
                },
            )?;
        }
        Verb::Point { proof, arguments } => proof.run(&arguments.into(), &mut stdout)?,
        Verb::Dispersion { arguments } => cli::run_dispersion(&arguments.into(), &mut stdout)?,
        Verb::Diagram { arguments } => cli::run_diagram(&arguments.into(), &mut stdout)?,
        Verb::Homogenise {
            case_path,
            settings,
            output_path,
            cells_per_block,
            overturning,
            format,
            force,
            is_dry_run,
        } => {
            let options = Options {
                case_path,
                settings,
                format: format.into(),
                output_folder: output_path,
                force,
                is_dry_run,
                ..Options::default()
            };
            let opening_limit = match overturning {
                true => OpeningLimit::Overturning,
                false => OpeningLimit::FirstOpening,
            };
            let continuum =
                ContinuumOptions { cells_per_block: cells_per_block.into(), opening_limit };
            cli::run_homogenise(&options, &continuum, &mut stdout)?;
        }
        Verb::Speeds { arguments } => cli::run_speeds(&arguments.into(), &mut stdout)?,
        Verb::Shocks { arguments } => cli::run_shocks(&arguments.into(), &mut stdout)?,
        Verb::Split { rank_count, arguments } => {
            cli::run_split(&arguments.into(), rank_count as usize, &mut stdout)?;
        }
        Verb::Time { block_counts, rank_counts, steps, arguments } => {
            let settings = cli::TimingSettings {
                block_counts: block_counts.into_iter().map(usize::from).collect(),
                rank_counts: rank_counts.into_iter().map(usize::from).collect(),
                steps: steps.into(),
            };
            let options = arguments.into();
            execute_on_ranks(
                &mut stdout,
                |stdout| cli::run_time(&options, &settings, stdout),
                |communicator, stdout| {
                    ranks::run_time_on_ranks(&options, &settings, communicator, stdout)
                },
            )?;
        }
        Verb::Run { arguments, checkpoint_interval, accept_ill_posed } => {
            let options = Options { accept_ill_posed, ..arguments.into() };
            let settings = CheckpointSettings { interval: checkpoint_interval };
            execute_on_ranks(
                &mut stdout,
                |stdout| cli::run_simulation(&options, settings, stdout),
                |communicator, stdout| {
                    ranks::run_simulation_on_ranks(&options, settings, communicator, stdout)
                },
            )?;
        }
        Verb::Check { arguments, only_disagreeing } => {
            let options = Options { only_disagreeing, ..arguments.into() };
            execute_on_ranks(
                &mut stdout,
                |stdout| cli::run_check(&options, stdout),
                |communicator, stdout| ranks::run_check_on_ranks(&options, communicator, stdout),
            )?;
        }
        Verb::Compare { first, second, output_folder, format, force, is_dry_run, pictures } => {
            let options = cli::CompareOptions {
                folders: [first, second],
                format: format.into(),
                output_folder,
                force,
                is_dry_run,
                pictures: pictures.into(),
            };
            cli::run_compare(&options, &mut stdout)?;
        }
        Verb::Resume { folder, threads, checkpoint_interval, format, pictures } => {
            let threads = threads.map(usize::from);
            let settings = CheckpointSettings { interval: checkpoint_interval };
            let (format, pictures) = (format.into(), pictures.into());
            execute_on_ranks(
                &mut stdout,
                |stdout| cli::resume(&folder, threads, settings, format, &pictures, stdout),
                |ranks, stdout| {
                    let form = (format, &pictures);
                    ranks::resume_on_ranks(&folder, threads, settings, ranks, form, stdout)
                },
            )?;
        }
        Verb::Plot { folder, pictures } => cli::plot(&folder, &pictures.into(), &mut stdout)?,
        Verb::Gather { folder, zarr, pictures } => {
            cli::gather(&folder, zarr.map(usize::from), &pictures.into(), &mut stdout)?;
        }
        Verb::Verify { path, format } => cli::verify(&path, format.into(), &mut stdout)?,
        Verb::Cases { action: Some(CasesAction::Show { name }), .. } => {
            cases::show_case(&name, &mut stdout)?;
        }
        Verb::Cases { copy_folder: Some(folder), force, .. } => {
            cases::copy_cases(&folder, force, &mut stdout)?;
        }
        Verb::Cases { .. } => cases::list_cases(&mut stdout)?,
        Verb::Models { format } => cli::list_models(format.into(), &mut stdout)?,
        Verb::New { kind, yield_set, is_simulation, plane_wave, file, force } => {
            let medium = MediumKind::new(kind, yield_set)?;
            let purpose = match plane_wave {
                Some(PlaneWaveArgument::Granular) => TemplateKind::GranularPlaneWave,
                Some(PlaneWaveArgument::Porous) => TemplateKind::PorousPlaneWave,
                None if is_simulation => TemplateKind::Simulation,
                None => TemplateKind::SingleState,
            };
            let path = new::write_template(medium, purpose, file.as_deref(), force)?;
            let _ = writeln!(
                std::io::stderr(),
                "wrote {} (its schema for editors: {})",
                path.display(),
                new::SCHEMA_FILE
            );
        }
        Verb::Schema { is_markdown: true } => {
            write!(stdout, "{}", wellposed::case::generate_reference())?
        }
        Verb::Schema { is_markdown: false } => {
            write!(stdout, "{}", new::format_schema())?;
        }
        Verb::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut CommandLine::command(), "wellposed", &mut text);
            stdout.write_all(&text)?;
        }
        Verb::Manual { folder, .. } => {
            let command = help::add_examples(CommandLine::command());
            match folder {
                Some(folder) => manual::write_man_pages(command, &folder, &mut stdout)?,
                None => write!(stdout, "{}", manual::generate_commands_page(command))?,
            }
        }
    }
    Ok(stdout.flush()?)
}
