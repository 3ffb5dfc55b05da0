//! Names of the files of results.

use crate::case::Case;
use files::checksums::Checksums;

/// The resolved case of a folder.
pub(super) const CASE: &str = "case.toml";
/// Name, version and commit of the program that wrote a folder, and the checksum of what it computed.
pub(super) const PROGRAM: &str = "program.json";

/// File of a moment that tells whether a folder takes files.
pub(super) const PROBE: &str = "probe";

/// What `map` writes besides.
pub const MAP: [&str; 6] = ["map.png", "map.svg", "map.csv", "map.npz", "map.json", "map.txt"];

/// What `point` writes besides: the first two always, the others where there is a flow.
pub const POINT: [&str; 10] = [
    "point.json",
    "point.txt",
    "growth.png",
    "growth.svg",
    "polar.png",
    "polar.svg",
    "growth_by_direction.csv",
    "growth_by_wave_number.csv",
    "directions.png",
    "directions.svg",
];

/// What `dispersion` writes besides.
pub const DISPERSION: [&str; 5] =
    ["dispersion.png", "dispersion.svg", "dispersion.csv", "dispersion.json", "dispersion.txt"];

/// What `speeds` writes besides: the last three in space alone.
pub const SPEEDS: [&str; 8] = [
    "speeds.png",
    "speeds.svg",
    "speeds.csv",
    "speeds.json",
    "speeds.txt",
    "sphere.png",
    "sphere.svg",
    "sphere.csv",
];

/// What `check` writes besides: the last two where a perturbation is refined.
pub const CHECK: [&str; 6] =
    ["check.png", "check.svg", "check.json", "check.txt", "refinement.png", "refinement.svg"];

/// What `run` writes besides: receivers and their pictures where there are any, snapshots and their animation
/// where they are asked for, spectra of flows, and every snapshot by its own name.
pub const RUN: [&str; 21] = [
    "run.png",
    "run.svg",
    "seismograms.png",
    "seismograms.svg",
    "ledger.png",
    "ledger.svg",
    "spectrum.png",
    "spectrum.svg",
    "dissipation.png",
    "dissipation.svg",
    "animation.gif",
    "receivers.csv",
    "receivers.npz",
    "ledger.csv",
    "spectrum.csv",
    "fields.npz",
    SNAPSHOTS,
    "checkpoint",
    "lock",
    "run.json",
    "run.txt",
];

/// The list of the snapshots of a run.
pub const SNAPSHOTS: &str = "snapshots.pvd";

/// Held for a moment by whoever puts files into a folder or removes some.
pub(super) const BRIEF_LOCK: &str = ".publishing";

/// What says that a run is finished.
pub(super) const FINISHED: &str = "run.json";

/// A file that a run appends to, or writes again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AppendedFile {
    /// What receivers saw.
    Receivers,
    /// The ledger of energy.
    Ledger,
    /// Energies of the shells of modes of a flow.
    Spectrum,
    /// What resumes a run.
    Checkpoint,
    /// Wall times and speeds: no result.
    Log,
    /// Held while a run writes here.
    Lock,
}

impl AppendedFile {
    /// The name of the file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Receivers => "receivers.csv",
            Self::Ledger => "ledger.csv",
            Self::Spectrum => "spectrum.csv",
            Self::Checkpoint => "checkpoint",
            Self::Log => "log.txt",
            Self::Lock => "lock",
        }
    }
}

/// The name of the file of a snapshot of a case, by its place among all, from 0 on.
pub fn snapshot_name(case: &Case, index: usize) -> String {
    // Those of flows are in a box that deforms.
    let extension = if case.flow.is_some() { "vts" } else { "vti" };
    format!("snapshot-{index:08}.{extension}")
}

/// Whether the name is that of a snapshot: `snapshot-00000012.vti`, of a flow `.vts`.
pub fn is_snapshot(name: &str) -> bool {
    let inner = name
        .strip_prefix("snapshot-")
        .and_then(|name| name.strip_suffix(".vti").or_else(|| name.strip_suffix(".vts")));
    inner.is_some_and(|step| !step.is_empty() && step.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Every file that a verb may write. `--force` removes the ones of another case, so that no result
/// ever stands beside a case that it does not belong to.
pub fn results() -> impl Iterator<Item = &'static str> {
    let own = MAP.into_iter().chain(POINT).chain(DISPERSION).chain(SPEEDS).chain(CHECK).chain(RUN);
    own.chain([Checksums::NAME])
}

/// Whether the name is that of a file of a run in time, but for its log and its lock.
pub(super) fn is_of_run(name: &str) -> bool {
    is_snapshot(name) || (RUN.contains(&name) && name != AppendedFile::Lock.name())
}

/// Whether a file of that name has a line in the list of checksums.
pub(super) fn is_listed(name: &str) -> bool {
    let is_passing =
        [AppendedFile::Lock, AppendedFile::Checkpoint].into_iter().any(|file| file.name() == name);
    (is_result(name) && !is_passing && name != Checksums::NAME) || [CASE, PROGRAM].contains(&name)
}

/// Whether a file of that name says nothing of whose folder it stands in.
pub(super) fn is_passing(name: &str) -> bool {
    is_half_written(name) || [AppendedFile::Lock.name(), BRIEF_LOCK].contains(&name)
}

/// Whether a verb may write a file of that name.
pub(super) fn is_result(name: &str) -> bool {
    is_snapshot(name) || results().any(|known| known == name)
}

/// Whether the file is one that this program writes, or a killed one left: `.NAME.PROCESS-COUNT.partial`. Hidden files
/// of anyone else are none of its business.
pub(super) fn is_half_written(name: &str) -> bool {
    let inner = name.strip_prefix('.').and_then(|name| name.strip_suffix(".partial"));
    inner.and_then(|inner| inner.rsplit_once('.')).is_some_and(|(name, process)| {
        let is_number = process.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
        let is_own = is_result(name) || [CASE, PROGRAM, PROBE].contains(&name);
        is_number && is_own
    })
}
