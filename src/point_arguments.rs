//! Arguments of `point` that select what is proved.

use clap::Args;
use std::io::Write;
use wellposed::cli::{self, CommandError, Options};
use wellposed::study::BoxRange;

/// What is proved of the state.
#[derive(Args)]
pub(crate) struct PointArguments {
    /// Also prove the verdict, and write the proof to certificate.json, which wellposed verify checks
    #[arg(long = "certified")]
    is_certified: bool,
    /// Prove it for all states with this number in a range, e.g. model.friction_angle_deg=29..31; at most two numbers
    #[arg(long = "over", value_name = "KEY=LOW..HIGH", requires = "is_certified", value_parser = parse_range)]
    ranges: Vec<BoxRange>,
}

impl PointArguments {
    /// Runs the verb `point`, with a proof if it is asked for.
    pub(crate) fn run(self, options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
        match self.is_certified {
            true => cli::run_certified_point(options, &self.ranges, stdout),
            false => cli::run_point(options, stdout),
        }
    }
}

fn parse_range(text: &str) -> Result<BoxRange, String> {
    let parse = || {
        let (key, ends) = text.split_once('=')?;
        let (low, high) = ends.split_once("..")?;
        let ends = [low.trim().parse().ok()?, high.trim().parse().ok()?];
        Some(BoxRange { key: key.trim().to_owned(), ends })
    };
    parse().ok_or_else(|| "expected KEY=LOW..HIGH with two numbers".to_owned())
}
