//! Numbers among the arguments.

/// Parses a number of threads.
pub fn parse_thread_count(text: &str) -> Result<u16, String> {
    parse_count(text, 1024)
}

/// Parses a number of ranks.
pub fn parse_rank_count(text: &str) -> Result<u32, String> {
    const MAX_RANKS: u32 = 1_000_000;
    let count = text.parse().ok().filter(|count| (1..=MAX_RANKS).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {MAX_RANKS}"))
}

/// Parses a number of cells per block.
pub fn parse_cells_per_block(text: &str) -> Result<u16, String> {
    parse_count(text, 1000)
}

/// Parses a whole number from 1 to `most`.
fn parse_count(text: &str, most: u16) -> Result<u16, String> {
    let count = text.parse().ok().filter(|count| (1..=most).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {most}"))
}

/// Parses the smallest wall time between two checkpoints, s, at least 0; with 0 a checkpoint is written after every
/// batch of steps.
pub fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds >= 0.0);
    seconds.ok_or_else(|| "expected a finite number of at least 0, in seconds".to_owned())
}

/// Parses a number of blocks along each axis.
pub fn parse_block_count(text: &str) -> Result<u16, String> {
    parse_count(text, 10_000)
}

/// Parses a number of steps.
pub fn parse_step_count(text: &str) -> Result<u16, String> {
    parse_count(text, 10_000)
}
