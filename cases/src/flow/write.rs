//! What a case says of a flow in time, back as TOML: every value, defaults included.

use super::{FlowRun, Initial, Quantity, Wave};
use crate::section::Resolved;
use models::granular_flow::RotationKind;

impl FlowRun {
    /// The sections as TOML.
    pub(crate) fn to_toml(&self) -> String {
        let mut text = Resolved::default()
            .number("cells", self.grid.cells)
            .number("length", self.grid.lengths)
            .under("[grid]");
        text += &Resolved::default()
            .number("duration", self.time.duration)
            .number("tolerance", self.time.tolerance)
            .number("pressure_tolerance", self.time.pressure_tolerance)
            .under("[time]");
        if self.rotation == RotationKind::None {
            text +=
                &Resolved::default().number("shear_rate", self.least_shear_rate).under("[limits]");
        }
        text.extend(self.initial.iter().map(|part| initial(part).under("[[initial]]")));
        text.extend(
            self.receivers.iter().map(|receiver| receiver.resolved().under("[[receiver]]")),
        );
        let output = Resolved::default()
            .number("ledger_interval", self.output.ledger_interval)
            .number("snapshot_interval", self.output.snapshot_interval)
            .text("picture", self.output.picture.map_or("speed", Quantity::name));
        let output = match &self.output.contours {
            Some(contours) => output.number("contours", contours),
            None => output,
        };
        text + &output.under("[output]")
    }
}

fn wave(resolved: Resolved, wave: &Wave) -> Resolved {
    resolved
        .number("mode", wave.mode)
        .text("field", wave.field.name())
        .number("amplitude", wave.amplitude)
        .number("phase_deg", wave.phase_deg)
}

fn initial(initial: &Initial) -> Resolved {
    let resolved = Resolved::default().text("kind", initial.name());
    match initial {
        Initial::Mode(own) => wave(resolved, own),
        Initial::Packet { wave: own, at, radius } => {
            wave(resolved, own).number("at", at).number("radius", radius)
        }
        Initial::Noise { field, from, to, amplitude, seed } => resolved
            .text("field", field.name())
            .number("from", from)
            .number("to", to)
            .number("amplitude", amplitude)
            .number("seed", seed),
        Initial::Uniform { field, amplitude } => {
            resolved.text("field", field.name()).number("amplitude", amplitude)
        }
        Initial::File { path, checksum } => {
            resolved.text("path", path).text("checksum", format!("{checksum:08x}"))
        }
    }
}
