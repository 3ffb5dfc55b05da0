//! Memory that is available to the program within the limits of the machine, the process and the control group.

use std::fmt::{Display, Formatter};
use std::path::Path;

/// Amount of memory or storage, bytes.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Bytes(pub f64);

/// Fraction of the available memory that a plan may use; the rest is for allocations that plans do not count.
const USABLE_FRACTION: f64 = 0.9;

/// Available memory, bytes, and a description of the limit that determines it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AvailableMemory {
    bytes: f64,
    limit_description: &'static str,
}

impl Display for AvailableMemory {
    fn fmt(&self, formatter: &mut Formatter) -> std::fmt::Result {
        let Self { bytes, limit_description } = self;
        write!(
            formatter,
            "{:.0} % of {} {limit_description}",
            100.0 * USABLE_FRACTION,
            Bytes(*bytes)
        )
    }
}

impl AvailableMemory {
    /// Returns the available memory if it is too little for `needed`; `None` if it suffices or is unknown.
    pub(super) fn find_shortage(needed: Bytes) -> Option<Self> {
        Self::from_system_files(Path::new("/"))
            .filter(|own| needed > Bytes(USABLE_FRACTION * own.bytes))
    }

    /// Returns the smallest of the free memory, the rest of the address space limit and the rest of the control group
    /// limits, read from the system files under `root`; `None` if none of the three is known.
    fn from_system_files(root: &Path) -> Option<Self> {
        let all = [
            (free_memory(root), "that are free"),
            (
                remaining_address_space(root),
                "that the limit of the address space leaves (ulimit -v)",
            ),
            (
                remaining_control_group_memory(root),
                "that the memory limit of the control group leaves",
            ),
        ];
        let all = all.into_iter().filter_map(|(bytes, limit_description)| {
            Some(Self { bytes: bytes?, limit_description })
        });
        all.min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }
}

/// Finds the first line that starts with `word` in a file, and returns the rest of that line without surrounding
/// spaces.
fn read_value_after_prefix(path: &Path, word: &str) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    text.lines().find_map(|line| line.strip_prefix(word)).map(|rest| rest.trim().to_owned())
}

fn read_kibibytes(path: &Path, word: &str) -> Option<f64> {
    let number: f64 =
        read_value_after_prefix(path, word)?.strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * number)
}

/// Returns the memory of the machine that is available without swapping, bytes.
fn free_memory(root: &Path) -> Option<f64> {
    read_kibibytes(&root.join("proc/meminfo"), "MemAvailable:")
}

/// Returns the remainder of the address space limit RLIMIT_AS, bytes.
fn remaining_address_space(root: &Path) -> Option<f64> {
    let limits = read_value_after_prefix(&root.join("proc/self/limits"), "Max address space")?;
    let limit: f64 = limits.split_whitespace().next()?.parse().ok()?;
    Some((limit - read_kibibytes(&root.join("proc/self/status"), "VmSize:")?).max(0.0))
}

/// Returns the smallest remainder of the memory limits of the control group and its ancestors, bytes; cgroup version 1
/// or 2.
fn remaining_control_group_memory(root: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let group_memory_of_line = |line: &str| {
        let (_, rest) = line.split_once(':')?;
        let (controllers, path) = rest.split_once(':')?;
        let (mount, names): (_, [&str; 3]) = match controllers {
            "" => ("sys/fs/cgroup", ["memory.max", "memory.current", ""]),
            own if own.split(',').any(|own| own == "memory") => {
                let names = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_"];
                ("sys/fs/cgroup/memory", names)
            }
            _ => return None,
        };
        // In a container the path may be that of the host, while the container's group is at the mount point: all
        // ancestors of the path are tried.
        let groups = Path::new(path.trim_start_matches('/')).ancestors();
        groups
            .filter_map(|group| remaining_group_memory(&root.join(mount).join(group), names))
            .reduce(f64::min)
    };
    text.lines().filter_map(group_memory_of_line).reduce(f64::min)
}

/// Returns the remainder of the memory limit of one group, bytes. Pages of the file cache are not counted as used,
/// since they can be reclaimed.
fn remaining_group_memory(group: &Path, [limit, used, prefix]: [&str; 3]) -> Option<f64> {
    let number = |name: &str| -> Option<f64> {
        std::fs::read_to_string(group.join(name)).ok()?.trim().parse().ok()
    };
    let page_cache_bytes = |word: &str| -> f64 {
        let found =
            read_value_after_prefix(&group.join("memory.stat"), &format!("{prefix}{word} "));
        found.and_then(|own| own.parse().ok()).unwrap_or(0.0)
    };
    let used = number(used)? - page_cache_bytes("inactive_file") - page_cache_bytes("active_file");
    Some((number(limit)? - used.max(0.0)).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates system files with about 1 GB of free memory and the given files, and returns the available memory.
    fn read_available_memory(files: &[(&str, &str)]) -> Option<AvailableMemory> {
        let root = tempfile::tempdir().unwrap();
        let memory = ("proc/meminfo", "MemTotal: 9 kB\nMemAvailable:    1000000 kB\n");
        for (path, text) in files.iter().chain([&memory]) {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        AvailableMemory::from_system_files(root.path())
    }

    #[test]
    fn smallest_limit_determines_available_memory() {
        let bytes = |files: &[(&str, &str)]| read_available_memory(files).unwrap().bytes;
        assert_eq!(bytes(&[]), 1_024_000_000.0);
        let limits = |limit: &str| {
            format!("Limit Soft Hard Units\nMax address space         {limit} unlimited bytes\n")
        };
        let status = ("proc/self/status", "Name: x\nVmSize:\t   1000 kB\n");
        let unlimited = limits("unlimited");
        assert_eq!(bytes(&[("proc/self/limits", &unlimited), status]), 1_024_000_000.0);
        let limited = limits("3024000");
        assert_eq!(bytes(&[("proc/self/limits", &limited), status]), 2_000_000.0);
        let version_2 = [
            ("proc/self/cgroup", "0::/a/b\n"),
            ("sys/fs/cgroup/a/b/memory.max", "max\n"),
            ("sys/fs/cgroup/a/b/memory.current", "5000\n"),
            ("sys/fs/cgroup/a/memory.max", "9000\n"),
            ("sys/fs/cgroup/a/memory.current", "7000\n"),
            ("sys/fs/cgroup/a/memory.stat", "anon 1\ninactive_file 300\nactive_file 200\n"),
        ];
        assert_eq!(bytes(&version_2), 2500.0);
        let version_1 = [
            ("proc/self/cgroup", "9:cpu,cpuacct:/x\n4:memory:/docker/1\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "8000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "9000\n"),
            ("sys/fs/cgroup/memory/memory.stat", "cache 8\ntotal_inactive_file 4000\n"),
        ];
        assert_eq!(bytes(&version_1), 3000.0);
    }

    #[test]
    fn plans_exceeding_available_memory_are_refused() {
        let Some(available) = AvailableMemory::from_system_files(Path::new("/")) else { return };
        let part = |part: f64| AvailableMemory::find_shortage(Bytes(part * available.bytes));
        assert!(part(0.5).is_none() && part(1.5).is_some());
    }
}
