//! Error of a case without time-domain simulation.

use super::error::CaseError;
use super::key_positions::KeyPositions;
use super::kind::ModelKind;
use models::flow::RotationKind;

/// Returns the error of a case without simulation: a missing section `[grid]`, or a kind of flow that cannot be
/// simulated.
pub(super) fn missing_grid_error(positions: &KeyPositions, kind: ModelKind) -> CaseError {
    match kind {
        ModelKind::Flow(flow) if flow.rotation() == RotationKind::Free => {
            let found = format!("found {}", kind.name());
            let allowed = "use another model: this one does not determine the spin, so that it \
                           cannot be simulated";
            positions.key_error("model.kind", found, allowed)
        }
        ModelKind::Flow(_) | ModelKind::Solid(_) => {
            let sections = match kind {
                ModelKind::Flow(_) => {
                    "cells = [64, 64] and length = 0.1, [time] with a duration, and [[initial]]"
                }
                _ => "cells = [200, 200] and spacing = 1.0, and [time] with a duration",
            };
            let allowed = format!(
                "add a section [grid], for example with {sections} (wellposed new {} --run writes a whole example)",
                kind.name()
            );
            positions.key_error("grid", "missing", allowed)
        }
        ModelKind::Equations => {
            let allowed = "analyse it with wellposed point and map: models given as equations have no solver in time";
            positions.key_error("model.kind", "found equations", allowed)
        }
        ModelKind::Rheology => {
            let allowed = "compute its response with wellposed diagram: schemes have no grid";
            positions.key_error("rheology", "found a rheological scheme", allowed)
        }
    }
}
