//! All media on many numbers of ranks and threads: the files are those of one process, also of a run that is interrupted and
//! resumed on another number of ranks.
#![cfg(target_os = "linux")]

use crate::program::*;
use crate::ranks::{Launcher, WITHOUT_PICTURES, find_processes, list_parts, wait_for_end};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

const TEST_FOLDER: &str = "rank-matrix";

/// Numbers of ranks of the whole matrix.
const RANKS: [usize; 6] = [1, 2, 3, 4, 7, 8];

const CLASSICAL: &str = "kind = 'classical'\nlambda = 1e8\nmu = 8e7\ndensity = 1800\n";
const COSSERAT: &str = "kind = 'cosserat'\nlambda = 1.2e8\nmu = 8e7\nalpha = 3e7\nbeta = 2e7\ngamma = 3e7\neta = 1e7\n\
    density = 1900\ninertia = 300\n";

const YIELD: &str = "[yield]\nkind = 'von-mises'\nstrength = 2e4\n";

/// A stiff layer in the lower part, across the last axis.
const LAYERS: &str = "[[region]]\nshape = 'layer'\naxis = 2\nfrom = 0\nto = 4\n\
    model = { lambda = 3e8, mu = 2e8 }\n[[region]]\nshape = 'rest'\n";

const OPEN_SIDES: &str = "[[boundary]]\nside = 'x1-'\nkind = 'non-reflecting'\n\
    [[boundary]]\nside = 'x2-'\nkind = 'non-reflecting'\n";

const PERIODIC: &str = "[[boundary]]\nside = 'x1-'\nkind = 'periodic'\n[[boundary]]\nside = 'x1+'\nkind = 'periodic'\n";

/// Composes a case in `D` dimensions of a model and further sections, with a load, a receiver and snapshots.
fn compose<const D: usize>(model: &str, sections: &str) -> String {
    // Seven ranks cut one axis, and parts need the cells of wide halos.
    let (cells, at, component, position) = match D {
        2 => ("[37, 64]", "[8]", "22", "[8, 12]"),
        _ => ("[10, 12, 112]", "[2, 3]", "33", "[2, 3, 6]"),
    };
    format!(
        "[model]\n{model}dimensions = {D}\n{sections}[grid]\ncells = {cells}\nspacing = 0.5\n[time]\nduration = 0.03\n\
         [[load]]\nside = 'x{D}+'\nfield = 'sigma{component}'\nat = {at}\nradius = 2\namplitude = -1e6\n\
         time = {{ kind = 'pulse', duration = 0.03 }}\n[[receiver]]\nat = {position}\n\
         [output]\nsnapshot_interval = 0.01\n"
    )
}

/// Returns the cases with their names: in the plane and in space, classical and Cosserat, yielding, layered, with contacts,
/// blocky with a fluid, and in all orders.
fn cases() -> Vec<(&'static str, String)> {
    let order = |name: &str| format!("[scheme]\norder = '{name}'\n");
    let granular = "[granular]\nfriction = 0.5\nyield_stress = 1e5\n";
    let porous = "[porous]\nporosity = 0.001\nyield_stress = 1e5\ncontact_bulk_modulus = 1e7\n";
    let alternating = "[scheme]\nsplitting = 'alternating'\n";
    vec![
        ("sixth-order", compose::<2>(COSSERAT, &format!("{PERIODIC}{}", order("sixth-order")))),
        ("eighth-order", compose::<2>(CLASSICAL, &order("eighth-order"))),
        ("classical-space", compose::<3>(CLASSICAL, OPEN_SIDES)),
        ("layered-space", compose::<3>(CLASSICAL, LAYERS)),
        ("yielding-space", compose::<3>(COSSERAT, &format!("{YIELD}{OPEN_SIDES}"))),
        ("sixth-order-space", compose::<3>(COSSERAT, &order("sixth-order"))),
        ("eighth-order-space", compose::<3>(CLASSICAL, &order("eighth-order"))),
        ("classical-plane", compose::<2>(CLASSICAL, OPEN_SIDES)),
        ("cosserat-plane", compose::<2>(COSSERAT, &format!("{PERIODIC}{}", order("fourth-order")))),
        ("yielding-plane", compose::<2>(COSSERAT, &format!("{YIELD}{OPEN_SIDES}"))),
        ("layered-plane", compose::<2>(COSSERAT, &format!("{LAYERS}{alternating}"))),
        ("granular", compose::<2>(CLASSICAL, granular)),
        ("porous", compose::<2>(CLASSICAL, porous)),
        ("joints", JOINT_CASE.replace("duration = 6e-4", "duration = 2e-4")),
        ("fluid", include_str!("data/saturated-joints.toml").to_owned()),
    ]
}

/// Files of a run by name.
type Files = BTreeMap<String, Vec<u8>>;

/// A case in a folder, and the files of its run in one process.
struct Comparison<'a> {
    launcher: &'a Launcher,
    folder: PathBuf,
    expected: Files,
}

impl<'a> Comparison<'a> {
    fn new(launcher: &'a Launcher, name: &str, text: &str) -> Self {
        let folder = create_case_folder(TEST_FOLDER, name, text);
        let arguments = format!("run case.toml --out one --threads 1 {WITHOUT_PICTURES}");
        run_with_exit_code(0, &folder, &arguments);
        let expected = read_result_files(&folder.join("one"));
        Self { launcher, folder, expected }
    }

    /// Joins the parts in the results folder, compares all files and removes them.
    fn check(&self, label: &str) {
        run_with_exit_code(0, &self.folder, &format!("gather out {WITHOUT_PICTURES}"));
        assert!(list_parts(&self.folder.join("out")).is_empty());
        let found = read_result_files(&self.folder.join("out"));
        assert!(found.keys().eq(self.expected.keys()), "{label}");
        for (file, bytes) in found {
            assert!(bytes == self.expected[&file], "{label}: {file}");
        }
        fs::remove_dir_all(self.folder.join("out")).unwrap();
    }

    /// Compares a run on ranks with that of one process.
    fn check_run(&self, ranks: usize, threads: usize) {
        let arguments = format!("run case.toml --out out --threads {threads} {WITHOUT_PICTURES}");
        self.launcher.run_with_exit_code(0, &self.folder, ranks, &arguments);
        self.check(&format!("{}: {ranks} ranks, {threads} threads", self.folder.display()));
    }

    /// Compares a run of which a rank is killed after a checkpoint, and which other numbers of ranks and threads resume.
    /// Returns whether it was interrupted before its end.
    fn check_resumed_run(&self, [ranks, others]: [usize; 2], threads: usize) -> bool {
        let out = self.folder.join("out");
        let arguments = format!("run case.toml --out out --checkpoint-every 0 {WITHOUT_PICTURES}");
        let mut command = self.launcher.create_command(&self.folder, ranks, &arguments);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while !out.join("checkpoint").exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let processes = find_processes(&fs::canonicalize(&self.folder).unwrap());
        if let Some(process) = processes.get(ranks / 2) {
            // The run may have finished meanwhile.
            let _ = Command::new("kill").args(["-KILL", &process.to_string()]).status();
        }
        let _ = wait_for_end(child);
        let is_interrupted = !out.join("run.json").exists();
        if is_interrupted {
            let arguments = format!("resume out --threads {threads} {WITHOUT_PICTURES}");
            self.launcher.run_with_exit_code(0, &self.folder, others, &arguments);
        }
        self.check(&format!("{}: {ranks} ranks, then {others}", self.folder.display()));
        is_interrupted
    }
}

#[test]
fn contacts_and_wide_stencils_on_ranks_are_those_of_one_process() {
    let launchers = Launcher::find_all();
    let Some(launcher) = launchers.first() else { return };
    for (name, text) in cases() {
        let (ranks, threads) = match name {
            "granular" => (3, 2),
            "porous" => (4, 1),
            "eighth-order" => (2, 2),
            _ => continue,
        };
        Comparison::new(launcher, &format!("quick-{name}"), &text).check_run(ranks, threads);
    }
}

#[test]
#[ignore = "fifteen cases on six numbers of ranks, some minutes; part of .ci/long"]
fn all_media_on_all_numbers_of_ranks_are_those_of_one_process() {
    let launchers = Launcher::find_all();
    let Some(launcher) = launchers.first() else { return };
    let mut interrupted = 0;
    for (name, text) in cases() {
        let comparison = Comparison::new(launcher, name, &text);
        for (index, ranks) in RANKS.into_iter().enumerate() {
            comparison.check_run(ranks, 1);
            comparison.check_run(ranks, 2);
            let others = RANKS[(index + 2) % RANKS.len()];
            let is_interrupted = comparison.check_resumed_run([ranks, others], 1 + index % 2);
            interrupted += usize::from(is_interrupted);
        }
        println!("{name}: the same on all numbers of ranks");
    }
    println!("{interrupted} runs resumed");
    // Some runs end before they can be interrupted.
    assert!(interrupted > 0);
}
