//! Names of the files that a run will write.

use super::animation::animation_file_name;
use crate::case::{Case, TimeDomainRun};
use crate::cli::folder::{
    AppendedFile, JOINT_SNAPSHOT_LIST_FILE, SNAPSHOT_LIST_FILE, has_joint_files,
    joint_snapshot_file_name, snapshot_file_name,
};
use crate::report::PictureOptions;
use crate::{Error, case::dynamics::PlottedQuantity};
use dynamics::simulation::RegularTimes;
use models::interface::parameters::LayerMaterial;

/// Returns the names of the files of a complete run besides those of every results folder; more than two snapshots are
/// abbreviated to the first and the last. The animation is listed although none is drawn if the plotted quantity is
/// zero in all snapshots.
///
/// # Errors
/// The case has no simulation.
pub(super) fn list_planned_file_names(
    case: &Case,
    pictures: &PictureOptions,
) -> Result<Vec<String>, Error> {
    let (has_receivers, interval, duration) = match case.time_domain_run()? {
        TimeDomainRun::Solid(own) => {
            (!own.receivers.is_empty(), own.output.snapshot_interval, own.time.duration)
        }
        TimeDomainRun::Flow(own) => {
            (!own.receivers.is_empty(), own.output.snapshot_interval, own.time.duration)
        }
    };
    let shows_dissipation = case.solid_run.as_ref().is_some_and(|own| {
        let materials = own.materials();
        let yields = match materials.is_empty() {
            true => case.material.is_plastic(),
            false => materials.iter().any(|material| material.is_plastic()),
        };
        yields && own.output.plotted_quantity != PlottedQuantity::Dissipation
    });
    let mut names: Vec<String> = Vec::new();
    let mut add = |stem: &str, endings: &[&str]| {
        names.extend(endings.iter().map(|ending| format!("{stem}.{ending}")));
    };
    add("run", &["png", "svg"]);
    if has_receivers {
        add("seismograms", &["png", "svg"]);
    }
    add("ledger", &["png", "svg"]);
    if shows_dissipation {
        add("dissipation", &["png", "svg"]);
    }
    if has_saturated_joints(case) {
        add("fluid", &["png", "svg"]);
    }
    if case.flow_run.is_some() {
        add("spectrum", &["png", "svg", "csv"]);
    }
    if has_receivers {
        add("receivers", &["csv", "npz"]);
    }
    let has_joints = has_joint_files(case);
    if has_joints {
        add("joints", &["csv", "npz", "vtp"]);
    }
    add("ledger", &["csv"]);
    add("fields", &["npz"]);
    add("run", &["txt", "json"]);
    names.push(AppendedFile::Log.name().to_owned());
    if interval > 0.0 {
        let last = RegularTimes::new(interval, duration).count_until(duration).saturating_sub(1);
        names.extend(pictures.animation_formats().iter().copied().map(animation_file_name));
        let mut add_series = |list: &str, name: &dyn Fn(usize) -> String| {
            names.push(list.to_owned());
            match last {
                0 => names.push(name(0)),
                1 => names.extend([name(0), name(1)]),
                _ => names.push(format!("{} to {}", name(0), name(last))),
            }
        };
        add_series(SNAPSHOT_LIST_FILE, &|index| snapshot_file_name(case, index));
        if has_joints {
            add_series(JOINT_SNAPSHOT_LIST_FILE, &joint_snapshot_file_name);
        }
    }
    Ok(names)
}

/// Returns whether a joint between two blocks of the case is saturated.
fn has_saturated_joints(case: &Case) -> bool {
    let Some(blocks) = case.solid_run.as_ref().and_then(|run| run.blocks.as_ref()) else {
        return false;
    };
    let mut joints = blocks.contacts.iter().filter_map(|contact| contact.joint_index);
    joints.any(|joint| {
        let entry = blocks.joints.get(usize::from(joint));
        entry.is_some_and(|own| matches!(own.law.material, LayerMaterial::Saturated(_)))
    })
}
