//! The option `--format`.

use clap::ValueEnum;
use wellposed::cli::OutputFormat;

/// Output format of a verb.
#[derive(Clone, Copy, ValueEnum)]
pub enum FormatArgument {
    Text,
    Json,
}

impl From<FormatArgument> for OutputFormat {
    fn from(name: FormatArgument) -> Self {
        match name {
            FormatArgument::Text => Self::Text,
            FormatArgument::Json => Self::Json,
        }
    }
}
