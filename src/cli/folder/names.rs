//! Names of the files in results folders.

use crate::case::Case;
use crate::case::dynamics::Blocks;
use crate::report::point::CERTIFICATE_FILE;
use files::checksums::Checksums;

/// Name of the file with the resolved case.
pub const CASE_FILE: &str = "case.toml";
/// Name of the file with name, version and commit of the program, and the checksum of the case.
pub(super) const PROGRAM_FILE: &str = "program.json";

/// Name of the page with the results of all verbs.
pub const REPORT_PAGE_FILE: &str = "report.html";

/// Stem of the name of the temporary file that tests whether a folder is writable.
pub(super) const PROBE_FILE_STEM: &str = "probe";

// Of the pictures, the lists have the default formats; each may also be a PDF.

/// Names of the files of `map`, in addition to
/// [`ResultFolder::COMMON_FILE_NAMES`](super::ResultFolder::COMMON_FILE_NAMES).
pub const MAP_FILES: [&str; 6] =
    ["map.png", "map.svg", "map.csv", "map.npz", "map.json", "map.txt"];

/// Names of further files of `map --certified`.
pub const CERTIFIED_MAP_FILES: [&str; 2] = ["certified.png", "certified.svg"];

/// Names of the files of `point`, in addition to the common files: the first two always, the others depending on the
/// medium and its state.
pub const POINT_FILES: [&str; 12] = [
    "point.json",
    "point.txt",
    "growth.png",
    "growth.svg",
    "polar.png",
    "polar.svg",
    "growth_by_direction.csv",
    "growth_by_wave_number.csv",
    "linearised.npz",
    "directions.png",
    "directions.svg",
    CERTIFICATE_FILE,
];

/// Names of the files of `dispersion` for a solid, in addition to the common files.
pub const DISPERSION_FILES: [&str; 5] =
    ["dispersion.png", "dispersion.svg", "dispersion.csv", "dispersion.json", "dispersion.txt"];

/// Names of the files of `dispersion` for a blocky medium, in addition to the common files.
pub const BLOCH_FILES: [&str; 6] = [
    "dispersion.png",
    "dispersion.svg",
    "dispersion.csv",
    BLOCH_ARCHIVE_FILE,
    "dispersion.json",
    "dispersion.txt",
];

/// Name of the archive that `dispersion` writes for blocky media only.
const BLOCH_ARCHIVE_FILE: &str = "dispersion.npz";

/// Names of the files of `diagram`, in addition to the common files.
pub const DIAGRAM_FILES: [&str; 5] =
    ["diagram.png", "diagram.svg", "diagram.csv", "diagram.json", "diagram.txt"];

/// Names of the files of `speeds`, in addition to the common files; the last three in three dimensions only.
pub const SPEEDS_FILES: [&str; 8] = [
    "speeds.png",
    "speeds.svg",
    "speeds.csv",
    "speeds.json",
    "speeds.txt",
    "sphere.png",
    "sphere.svg",
    "sphere.csv",
];

/// Names of the files of `shocks`, in addition to the common files: those of `spall` only for a pulse at a free end, the
/// others except the last two only for a piston.
pub const SHOCKS_FILES: [&str; 9] = [
    "shocks.png",
    "shocks.svg",
    "shocks.csv",
    "profile.csv",
    "spall.png",
    "spall.svg",
    "spall.csv",
    "shocks.json",
    "shocks.txt",
];

/// Names of the files of `split`, in addition to the common files: the picture `split` in the plane, the others in space.
pub const SPLIT_FILES: [&str; 11] = [
    "split.png",
    "split.svg",
    "split-x1x2.png",
    "split-x1x2.svg",
    "split-x1x3.png",
    "split-x1x3.svg",
    "split-x2x3.png",
    "split-x2x3.svg",
    "split.csv",
    "split.json",
    "split.txt",
];

/// Names of the files of `time`, in addition to the common files.
pub const TIME_FILES: [&str; 5] = ["time.png", "time.svg", "time.csv", "time.json", "time.txt"];

/// Names of the files of `check`, in addition to the common files; the last two only if a perturbation is refined.
pub const CHECK_FILES: [&str; 6] =
    ["check.png", "check.svg", "check.json", "check.txt", "refinement.png", "refinement.svg"];

/// Names of the files of `compare`, in addition to the common files; the last two unless an averaging area has a single cell along an axis.
pub const COMPARISON_FILES: [&str; 11] = [
    "compare.png",
    "compare.svg",
    "compare.csv",
    "compare.json",
    "compare.txt",
    "compare-sigma22.png",
    "compare-sigma22.svg",
    "compare-sigma12.png",
    "compare-sigma12.svg",
    "compare-rotation.png",
    "compare-rotation.svg",
];

/// Names of the files of `run`, in addition to the common files. Those of receivers, joints, snapshots, animation,
/// dissipation, fluid and spectra are written only if the case has such output. Checkpoint and lock exist only until
/// the run finishes. Snapshots have file names with an index, see [`is_snapshot_name`].
pub const RUN_FILES: [&str; 29] = [
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
    "fluid.png",
    "fluid.svg",
    "animation.gif",
    "animation.apng",
    JOINT_ARCHIVE_FILE,
    "joints.csv",
    "joints.vtp",
    JOINT_SNAPSHOT_LIST_FILE,
    "receivers.csv",
    "receivers.npz",
    "ledger.csv",
    "spectrum.csv",
    FIELDS_ARCHIVE_FILE,
    SNAPSHOT_LIST_FILE,
    ZARR_STORE_FILE,
    "checkpoint",
    "lock",
    "run.json",
    "run.txt",
];

/// Name of the archive of the final fields.
pub const FIELDS_ARCHIVE_FILE: &str = "fields.npz";

/// Name of the file that lists the snapshots of a run with their times.
pub const SNAPSHOT_LIST_FILE: &str = "snapshots.pvd";

/// Name of the Zarr store of the snapshots, which `gather` writes if asked.
pub const ZARR_STORE_FILE: &str = "snapshots.zarr.zip";

/// Name of the archive of the final state of joints.
pub const JOINT_ARCHIVE_FILE: &str = "joints.npz";

/// Name of the file that lists the snapshots of joints with their times.
pub const JOINT_SNAPSHOT_LIST_FILE: &str = "joints.pvd";

/// Name of the file of the publication lock, which is held while files are published or removed.
pub(super) const PUBLICATION_LOCK_FILE: &str = ".publishing";

/// Name of the file whose existence marks a run as finished.
pub(super) const FINISHED_RUN_FILE: &str = "run.json";

/// Kind of a file that a run appends to or rewrites.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AppendedFile {
    /// Table of the receiver records.
    Receivers,
    /// Table of the energy ledger.
    Ledger,
    /// Table of the energy spectrum of a flow, by shells of mode numbers.
    Spectrum,
    /// Checkpoint from which a run resumes.
    Checkpoint,
    /// Log of wall times and computing speeds; not a result file.
    Log,
    /// Lock file of a run in progress.
    Lock,
}

impl AppendedFile {
    /// Returns the name of the file in the results folder.
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

/// Returns the file name of a snapshot of a case by its index, from 0.
pub fn snapshot_file_name(case: &Case, index: usize) -> String {
    // Snapshots of flows are on a deformed grid, those of polar grids on a curved one: structured grids (`vts`).
    let is_polar = case.solid_run.as_ref().is_some_and(|run| run.grid.is_polar());
    let extension = if case.flow_run.is_some() || is_polar { "vts" } else { "vti" };
    format!("snapshot-{index:08}.{extension}")
}

/// Returns the file name of the joints in a snapshot by its index, from 0.
pub fn joint_snapshot_file_name(index: usize) -> String {
    format!("joints-{index:08}.vtp")
}

/// Returns whether a run of a case writes files of joints.
pub fn has_joint_files(case: &Case) -> bool {
    let blocks = case.solid_run.as_ref().and_then(|run| run.blocks.as_ref());
    blocks.is_some_and(Blocks::has_joints)
}

/// Returns the names of all files of a snapshot: the fields, and the joints if there are any.
pub fn snapshot_file_names(case: &Case, index: usize) -> Vec<String> {
    let joints = has_joint_files(case).then(|| joint_snapshot_file_name(index));
    std::iter::once(snapshot_file_name(case, index)).chain(joints).collect()
}

/// Returns whether the name is that of a snapshot file: `snapshot-00000012.vti`, for flows and polar grids `.vts`, or
/// `joints-00000012.vtp`.
pub fn is_snapshot_name(name: &str) -> bool {
    let fields = || {
        let inner = name.strip_prefix("snapshot-")?;
        inner.strip_suffix(".vti").or_else(|| inner.strip_suffix(".vts"))
    };
    let joints = || name.strip_prefix("joints-")?.strip_suffix(".vtp");
    let inner = fields().or_else(joints);
    inner.is_some_and(|step| !step.is_empty() && step.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Files that each of several ranks writes for its own cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartFile {
    /// State for the checkpoint after this number of steps.
    Checkpoint(usize),
    /// Fields of the snapshot with this index, for ParaView.
    Snapshot(usize),
    /// Joints of the snapshot with this index.
    SnapshotJoints(usize),
    /// Final fields and joints.
    Fields,
}

impl PartFile {
    /// Returns the name of the file of a rank in the run of a case.
    pub fn name(self, case: &Case, rank: usize) -> String {
        match self {
            Self::Checkpoint(steps) => format!("checkpoint-{steps:012}-{rank:06}.part"),
            Self::Snapshot(index) => {
                let whole = snapshot_file_name(case, index);
                whole.replace('.', &format!("-{rank:06}."))
            }
            Self::SnapshotJoints(index) => format!("joints-{index:08}-{rank:06}.part"),
            Self::Fields => format!("fields-{rank:06}.part"),
        }
    }
}

/// Returns the name of the file that lists the parts of a snapshot for ParaView.
pub fn snapshot_index_name(case: &Case, index: usize) -> String {
    snapshot_file_name(case, index).replace('.', ".p")
}

/// Returns whether the name is that of a [`PartFile`], or of the index of the parts of a snapshot.
pub fn is_part_name(name: &str) -> bool {
    let Some((stem, extension)) = name.split_once('.') else { return false };
    let mut words = stem.split('-');
    let kind = words.next().unwrap_or_default();
    let numbers: Vec<&str> = words.collect();
    let is_number =
        |word: &&str| !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit());
    let count = match (kind, extension) {
        ("checkpoint" | "joints", "part") | ("snapshot", "vti" | "vts") => 2,
        ("fields", "part") | ("snapshot", "pvti" | "pvts") => 1,
        _ => return false,
    };
    numbers.len() == count && numbers.iter().all(is_number)
}

/// Returns whether the name is that of a part of the state for a checkpoint.
pub(super) fn is_checkpoint_part_name(name: &str) -> bool {
    is_part_name(name) && name.starts_with(AppendedFile::Checkpoint.name())
}

/// Iterates over the names of all files that a verb may write, except snapshots, PDF pictures, the log, the resolved case and the
/// program version. `--force` removes files of these names that belong to another case, so that a folder contains
/// results of one case only.
pub fn result_file_names() -> impl Iterator<Item = &'static str> {
    let own = MAP_FILES
        .into_iter()
        .chain(CERTIFIED_MAP_FILES)
        .chain(POINT_FILES)
        .chain(DISPERSION_FILES)
        .chain([BLOCH_ARCHIVE_FILE])
        .chain(DIAGRAM_FILES)
        .chain(SPEEDS_FILES)
        .chain(SHOCKS_FILES)
        .chain(SPLIT_FILES)
        .chain(TIME_FILES)
        .chain(CHECK_FILES)
        .chain(COMPARISON_FILES)
        .chain(RUN_FILES);
    own.chain([REPORT_PAGE_FILE, Checksums::FILE_NAME])
}

/// Returns whether the name is that of a file of a simulation, except for log and lock.
pub(super) fn is_run_file_name(name: &str) -> bool {
    is_snapshot_name(name)
        || is_part_name(name)
        || (is_listed(name, RUN_FILES.into_iter()) && name != AppendedFile::Lock.name())
}

/// Returns whether a file of that name has an entry in the checksum list.
pub(super) fn has_checksum(name: &str) -> bool {
    let is_transient_name =
        [AppendedFile::Lock, AppendedFile::Checkpoint].into_iter().any(|file| file.name() == name);
    (is_result_file_name(name)
        && !is_transient_name
        && !is_checkpoint_part_name(name)
        && name != Checksums::FILE_NAME)
        || [CASE_FILE, PROGRAM_FILE].contains(&name)
}

/// Returns whether a file of that name is temporary or a lock; such files are ignored when the case and program version
/// of the results are determined.
pub(super) fn is_transient_name(name: &str) -> bool {
    is_temporary_name(name) || [AppendedFile::Lock.name(), PUBLICATION_LOCK_FILE].contains(&name)
}

/// Returns whether the name is that of a snapshot or one of the [`result_file_names`].
pub(super) fn is_result_file_name(name: &str) -> bool {
    is_snapshot_name(name) || is_part_name(name) || is_listed(name, result_file_names())
}

/// Returns whether a name is in a list, or that of the PDF of a picture of which the list has the SVG.
fn is_listed(name: &str, mut list: impl Iterator<Item = &'static str>) -> bool {
    let stem = name.strip_suffix(".pdf");
    list.any(|known| {
        known == name || stem.is_some_and(|stem| known.strip_suffix(".svg") == Some(stem))
    })
}

/// Returns whether the name is that of a temporary file of this program: `.<name>.<process id>-<count>.partial`, where
/// `<name>` is that of a file that a verb writes. Other hidden files are left untouched.
pub(super) fn is_temporary_name(name: &str) -> bool {
    let inner = name.strip_prefix('.').and_then(|name| name.strip_suffix(".partial"));
    inner.and_then(|inner| inner.rsplit_once('.')).is_some_and(|(name, process)| {
        let is_number = process.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
        let is_own =
            is_result_file_name(name) || [CASE_FILE, PROGRAM_FILE, PROBE_FILE_STEM].contains(&name);
        is_number && is_own
    })
}
