//! Examples and exit codes below the help text of each command.

use clap::Command;

/// Meaning of the exit codes, below the help text of the program.
const EXIT_CODES: [(u8, &str); 5] = [
    (0, "done"),
    (1, "done, but a check disagrees or a file is damaged"),
    (2, "cannot be carried out: arguments, case, files, memory"),
    (3, "a run stopped because of its state; the last valid state is saved"),
    (130, "interrupted; a run has written a checkpoint (wellposed resume DIR)"),
];

/// Meaning of exit code 130 for commands without checkpoints.
const INTERRUPTED: &str = "interrupted before all results were written";

/// Help of a command: its name, examples, and exit codes.
pub struct CommandHelp {
    name: &'static str,
    /// Command lines and their meanings.
    pub examples: &'static [(&'static str, &'static str)],
    exit_codes: &'static [u8],
}

/// Help of the program.
const PROGRAM: CommandHelp = CommandHelp {
    name: "wellposed",
    examples: &[
        (
            "wellposed map noncoaxiality-bound",
            "map of a bundled case: out/noncoaxiality-bound/map.png",
        ),
        ("wellposed cases", "list of the bundled cases"),
        ("wellposed new harris-grekova", "a commented case to start from: harris-grekova.toml"),
        (
            "wellposed point harris-grekova.toml --set background.pressure=500",
            "one state of this case",
        ),
        ("wellposed run lamb-2d --dry-run", "size, time, memory and files of a run"),
    ],
    exit_codes: &[0, 1, 2, 3, 130],
};

/// Help of all commands.
const COMMANDS: [CommandHelp; 22] = [
    CommandHelp {
        name: "map",
        examples: &[
            ("wellposed map noncoaxiality-bound", "the map of a bundled case"),
            (
                "wellposed map noncoaxiality-bound --set map.x.points=41 --out coarse",
                "fewer points",
            ),
            (
                "wellposed map noncoaxiality-bound --growth-rate --dry-run",
                "time and files, no results",
            ),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "point",
        examples: &[
            ("wellposed point noncoaxiality-bound", "the state of a bundled case"),
            (
                "wellposed point noncoaxiality-bound --set background.pressure=500",
                "another pressure",
            ),
            ("wellposed point flutter --format json", "the results as JSON"),
            (
                "wellposed point flutter --certified --over model.mu=0.9..1.1",
                "the verdict proved for all these shear moduli",
            ),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "dispersion",
        examples: &[
            ("wellposed dispersion forbidden-band", "frequencies and speeds of a solid"),
            ("wellposed dispersion pulse-breaking", "Bloch waves of a blocky medium"),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "diagram",
        examples: &[
            ("wellposed diagram creep", "strain under constant stress"),
            ("wellposed new rheology scheme.toml", "a commented scheme to start from"),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "homogenise",
        examples: &[
            ("wellposed homogenise pulse-breaking", "writes pulse-breaking-continuum.toml"),
            (
                "wellposed homogenise pulse-breaking --out continuum.toml --cells-per-block 2",
                "a finer grid",
            ),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "speeds",
        examples: &[
            ("wellposed speeds flutter", "speeds in the plane, elastic and yielding"),
            ("wellposed speeds shear-band", "speeds over the sphere of directions"),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "shocks",
        examples: &[
            ("wellposed shocks foam-collapse", "waves in foam behind a piston"),
            ("wellposed shocks sand-spall", "spall of sand at a free end"),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "split",
        examples: &[
            (
                "wellposed split lamb-3d --ranks 8",
                "as mpirun -n 8 wellposed run lamb-3d cuts the grid",
            ),
            ("wellposed split lamb-2d --ranks 8 --set parallel.parts=[2,4]", "with other parts"),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "time",
        examples: &[
            ("wellposed time pulse-breaking --blocks 25,50,100", "on one rank"),
            ("wellposed time pulse-breaking --blocks 100 --ranks 1,2", "on one and two ranks"),
        ],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "run",
        examples: &[
            ("wellposed run lamb-2d --dry-run", "size, time, memory and files"),
            (
                "wellposed run lamb-2d --threads 2 --checkpoint-every 60",
                "a checkpoint every minute",
            ),
            ("wellposed run lamb-2d --set time.duration=0.1 --out short", "a shorter run"),
        ],
        exit_codes: &[0, 2, 3, 130],
    },
    CommandHelp {
        name: "check",
        examples: &[
            ("wellposed check forbidden-band", "all waves of a case"),
            ("wellposed check forbidden-band --disagreeing", "only those that disagree"),
            ("wellposed check .", "all cases in this folder and below, briefly"),
        ],
        exit_codes: &[0, 1, 2, 130],
    },
    CommandHelp {
        name: "compare",
        examples: &[(
            "wellposed compare out/comparison-breaking out/comparison-continuum",
            "after wellposed run of both cases",
        )],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "resume",
        examples: &[(
            "wellposed resume out/lamb-2d",
            "after wellposed run lamb-2d was interrupted",
        )],
        exit_codes: &[0, 2, 3, 130],
    },
    CommandHelp {
        name: "plot",
        examples: &[(
            "wellposed plot out/lamb-2d",
            "after output.picture in out/lamb-2d/case.toml was changed",
        )],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "gather",
        examples: &[("wellposed gather out/lamb-3d", "after mpirun -n 4 wellposed run lamb-3d")],
        exit_codes: &[0, 2, 130],
    },
    CommandHelp {
        name: "verify",
        examples: &[("wellposed verify out/lamb-2d", "the results of wellposed run lamb-2d")],
        exit_codes: &[0, 1, 2],
    },
    CommandHelp {
        name: "cases",
        examples: &[
            ("wellposed cases", "names and titles"),
            ("wellposed cases show lamb-2d", "the text of a case"),
            ("wellposed cases --copy mine", "all cases as files in the folder mine"),
        ],
        exit_codes: &[0, 2],
    },
    CommandHelp {
        name: "models",
        examples: &[
            ("wellposed models", "names, equations, references"),
            ("wellposed models --format json", "the same for programs"),
        ],
        exit_codes: &[0, 2],
    },
    CommandHelp {
        name: "new",
        examples: &[
            ("wellposed new harris-grekova", "writes harris-grekova.toml"),
            ("wellposed new cosserat --yield interlayer layers.toml", "a solid with a yield set"),
            ("wellposed new classical --run pulse.toml", "for wellposed run"),
        ],
        exit_codes: &[0, 2],
    },
    CommandHelp {
        name: "schema",
        examples: &[
            ("wellposed schema", "JSON Schema, for completion in editors"),
            ("wellposed schema --markdown", "all keys with units, ranges and defaults"),
        ],
        exit_codes: &[0, 2],
    },
    CommandHelp {
        name: "completions",
        examples: &[("wellposed completions bash", "source its output in ~/.bashrc")],
        exit_codes: &[0, 2],
    },
    CommandHelp {
        name: "manual",
        examples: &[
            ("wellposed manual man1", "writes man1/wellposed.1, man1/wellposed-map.1, …"),
            ("wellposed manual --markdown", "the same as one page in Markdown"),
        ],
        exit_codes: &[0, 2],
    },
];

impl CommandHelp {
    /// Returns the help of a command of the program, or of the program itself.
    pub fn find(name: &str) -> Option<&'static Self> {
        std::iter::once(&PROGRAM).chain(&COMMANDS).find(|help| help.name == name)
    }

    /// Lists the exit codes with their meanings.
    pub fn exit_codes(&self) -> impl Iterator<Item = (u8, &'static str)> {
        let has_checkpoints = self.exit_codes.contains(&3);
        let codes = EXIT_CODES.iter().filter(|(code, _)| self.exit_codes.contains(code));
        codes.map(move |(code, meaning)| match code {
            130 if !has_checkpoints => (130, INTERRUPTED),
            _ => (*code, *meaning),
        })
    }

    /// Formats the examples, aligned if they fit, and the exit codes.
    fn format(&self) -> String {
        let width = self.examples.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
        let mut text = "Examples:".to_owned();
        for (line, meaning) in self.examples {
            text += &format!("\n  {line:width$}  {meaning}");
        }
        text += "\n\nExit codes:";
        for (code, meaning) in self.exit_codes() {
            text += &format!("\n  {code:<3}  {meaning}");
        }
        text
    }
}

/// Adds examples and exit codes to the help texts of the program and of its commands.
pub fn add_examples(command: Command) -> Command {
    let text = format!(
        "{}\n\nwellposed COMMAND --help lists the arguments of a command.",
        PROGRAM.format()
    );
    command.after_help(text).mut_subcommands(|own| match CommandHelp::find(own.get_name()) {
        Some(help) => own.after_help(help.format()),
        None => own,
    })
}
