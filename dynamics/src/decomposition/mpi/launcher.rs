//! Launcher that has started this process, according to the environment.

use std::path::Path;

/// Names of the library of Open MPI.
const OPEN_MPI: [&str; 1] = ["libmpi.so.40"];

/// Names of the libraries with the standard binary interface, and of MPICH and those derived from it.
const MPICH: [&str; 3] = ["libmpi_abi.so.1", "libmpi.so.12", "libmpich.so.12"];

/// MPI launcher that has started this process, such as `mpirun` or `srun`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Launcher {
    /// Number of this process, if the launcher tells it before MPI starts.
    pub rank: Option<usize>,
    /// Number of processes, if the launcher tells it before MPI starts.
    pub size: Option<usize>,
    /// Whether the launcher is that of Open MPI.
    is_open_mpi: bool,
}

impl Launcher {
    /// Returns the launcher of this process; `None` if it was started without one.
    pub fn detect() -> Option<Self> {
        Self::from_variables(|name| std::env::var(name).ok())
    }

    /// Returns the launcher according to environment variables, whose values `variable` returns.
    fn from_variables(variable: impl Fn(&str) -> Option<String>) -> Option<Self> {
        let number = |name: &str| variable(name)?.parse().ok();
        let first = |names: &[&str]| names.iter().find_map(|name| number(name));
        let is_launched = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"]
            .into_iter()
            .any(|name| variable(name).is_some());
        is_launched.then(|| Self {
            rank: first(&["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"]),
            // A PMIx launcher has no variable for the size; that of Slurm has.
            size: first(&["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"]),
            is_open_mpi: variable("OMPI_COMM_WORLD_SIZE").is_some(),
        })
    }

    /// Returns the files of MPI libraries to be tried in order: those of the family of the launcher first.
    pub(super) fn library_names(&self, requested: Option<String>) -> Vec<String> {
        if let Some(name) = requested.filter(|name| !name.is_empty()) {
            return vec![Path::new(&name).display().to_string()];
        }
        let is_mpich = !self.is_open_mpi && self.size.is_some();
        let families: [&[&str]; 2] =
            if is_mpich { [&MPICH, &OPEN_MPI] } else { [&OPEN_MPI, &MPICH] };
        families.concat().into_iter().map(str::to_owned).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Launcher;

    #[test]
    fn launchers_are_told_apart() {
        let launcher = |variables: &[(&str, &str)]| {
            Launcher::from_variables(|name| {
                variables.iter().find(|own| own.0 == name).map(|own| own.1.to_owned())
            })
        };
        assert_eq!(launcher(&[("PATH", "/bin"), ("SLURM_NTASKS", "4")]), None);
        let open_mpi = launcher(&[
            ("OMPI_COMM_WORLD_SIZE", "4"),
            ("OMPI_COMM_WORLD_RANK", "2"),
            ("PMIX_RANK", "2"),
        ])
        .expect("a launcher");
        assert_eq!((open_mpi.rank, open_mpi.size), (Some(2), Some(4)));
        assert_eq!(open_mpi.library_names(None)[0], "libmpi.so.40");
        let mpich = launcher(&[("PMI_SIZE", "3"), ("PMI_RANK", "0")]).expect("a launcher");
        assert_eq!((mpich.rank, mpich.size), (Some(0), Some(3)));
        assert_eq!(
            mpich.library_names(None),
            ["libmpi_abi.so.1", "libmpi.so.12", "libmpich.so.12", "libmpi.so.40"]
        );
        let srun = launcher(&[("PMIX_RANK", "7"), ("SLURM_STEP_NUM_TASKS", "64")]);
        let srun = srun.expect("a launcher");
        assert_eq!((srun.rank, srun.size), (Some(7), Some(64)));
        assert_eq!(srun.library_names(Some("/opt/libmpi.so".to_owned())), ["/opt/libmpi.so"]);
    }
}
