//! What a case says of a run in time, back as TOML: every value, defaults included.

use super::{
    Action, Centre, Component, Condition, Dynamics, Initial, Kernel, Load, Part, Receiver, Region,
    Shape, SideCondition, Source, SourceKind, TimeFunction,
};
use crate::section::Resolved;
use crate::{Case, NO_YIELD};
use std::fmt::Display;

impl Dynamics {
    /// The sections as TOML.
    pub(crate) fn to_toml(&self) -> String {
        let d = self.grid.dimensions();
        let mut text = Resolved::default()
            .number("cells", &self.grid.cells)
            .number("spacing", &self.grid.spacing)
            .number("origin", &self.grid.origin)
            .under("[grid]");
        text += &Resolved::default()
            .number("duration", self.time.duration)
            .number("courant", self.time.courant)
            .number("rotation_deg", self.time.rotation_deg)
            .under("[time]");
        text += &Resolved::default()
            .text("order", self.scheme.order.name())
            .text("correction", self.scheme.correction.name())
            .text("splitting", self.scheme.splitting.name())
            .text("precision", self.scheme.precision.name())
            .text("ledger", self.scheme.ledger.name())
            .under("[scheme]");
        text.extend(self.regions.iter().map(|entry| region(entry, d).under("[[region]]")));
        text.extend(self.sides.iter().map(|entry| side(entry).under("[[side]]")));
        text.extend(self.loads.iter().map(|entry| load(entry, d).under("[[load]]")));
        text.extend(self.sources.iter().map(|entry| source(entry).under("[[source]]")));
        text.extend(self.initial.iter().map(|entry| initial(entry, d).under("[[initial]]")));
        let stress = |all: Resolved, (component, value): &(Component, f64)| {
            all.number(component.to_string(), value)
        };
        text +=
            &self.initial_stress.iter().fold(Resolved::default(), stress).under("[initial_stress]");
        if let Some(gravity) = &self.gravity {
            text += &Resolved::default()
                .number("acceleration", &gravity.acceleration)
                .literal("balanced", gravity.is_balanced)
                .number("lateral_ratio", gravity.lateral_ratio)
                .under("[gravity]");
        }
        text.extend(self.receivers.iter().map(|receiver| {
            let resolved = receiver.resolved().text("interpolation", receiver.interpolation.name());
            resolved.under("[[receiver]]")
        }));
        let integrals: Vec<String> =
            self.output.integrals.iter().filter_map(|own| own.integral()).collect();
        let output = Resolved::default()
            .number("ledger_interval", self.output.ledger_interval)
            .number("snapshot_interval", self.output.snapshot_interval)
            .texts("integrals", &integrals)
            .text("picture", self.output.picture.name());
        let output = match &self.output.contours {
            Some(contours) => output.number("contours", contours),
            None => output,
        };
        text + &output.under("[output]")
    }
}

impl<F: Display> Receiver<F> {
    /// The entry without what only solids have.
    pub(crate) fn resolved(&self) -> Resolved {
        Resolved::default()
            .text("name", &self.name)
            .number("at", &self.at)
            .texts("fields", &self.fields)
    }
}

fn region(region: &Region, dimensions: usize) -> Resolved {
    let resolved = shape(Resolved::default(), &region.shape, dimensions);
    let resolved = resolved.table("model", &section(&region.case, "model"));
    match region.case.yields {
        Some(_) => resolved.table("yield", &section(&region.case, "yield")),
        None => resolved.table("yield", &Resolved::default().text("kind", NO_YIELD)),
    }
}

/// What a case has in one section.
fn section(case: &Case, section: &str) -> Resolved {
    let own = case.values().filter(|(key, _)| key.split().0 == section);
    own.fold(Resolved::default(), |all, (key, value)| all.literal(key.split().1, value))
}

fn shape(resolved: Resolved, shape: &Shape, dimensions: usize) -> Resolved {
    let resolved = resolved.text("shape", shape.name(dimensions));
    match shape {
        Shape::Box { from, to } => resolved.number("from", from).number("to", to),
        Shape::Ball { center, radius } => {
            resolved.number("center", center).number("radius", radius)
        }
        Shape::Layer { axis, from, to } => {
            resolved.number("axis", axis + 1).number("from", from).number("to", to)
        }
        Shape::HalfSpace { point, normal } => {
            resolved.number("point", point).number("normal", normal)
        }
        Shape::Rest | Shape::Everywhere => resolved,
    }
}

fn part(resolved: Resolved, part: &Part) -> Resolved {
    resolved.number("from", &part.from).number("to", &part.to)
}

fn side(entry: &SideCondition) -> Resolved {
    let mut resolved =
        Resolved::default().text("side", entry.side.name()).text("kind", entry.condition.name());
    if let Condition::Mixed { held } = &entry.condition {
        resolved = resolved.texts("held", held);
    }
    match &entry.part {
        Some(own) => part(resolved, own),
        None => resolved,
    }
}

fn load(load: &Load, dimensions: usize) -> Resolved {
    let resolved = Resolved::default()
        .text("side", load.side.name())
        .text("field", load.field.to_string())
        .number("amplitude", load.amplitude);
    let resolved = match &load.action {
        Action::Whole => resolved,
        Action::Part(own) => part(resolved, own),
        Action::Point { at, kernel } => spread(resolved.number("at", at), *kernel),
    };
    let resolved = match &load.profile {
        Some(profile) => resolved.table("profile", &profile.resolved(dimensions)),
        None => resolved,
    };
    resolved.table("time", &function(&load.time))
}

fn source(source: &Source) -> Resolved {
    let resolved = Resolved::default().text("kind", source.action.name());
    let resolved = match &source.action {
        SourceKind::Couple(couple) if couple.len() == 1 => resolved.number("amplitude", couple[0]),
        SourceKind::Force(amplitude) | SourceKind::Couple(amplitude) => {
            resolved.number("amplitude", amplitude)
        }
        SourceKind::Moment(amplitude) => resolved.number("amplitude", amplitude),
        SourceKind::Explosion(amplitude) => resolved.number("amplitude", amplitude),
    };
    spread(resolved.number("at", &source.at), source.kernel).table("time", &function(&source.time))
}

fn spread(resolved: Resolved, kernel: Kernel) -> Resolved {
    let resolved = resolved.text("kernel", kernel.name());
    match kernel {
        Kernel::Bell { radius } => resolved.number("radius", radius),
        Kernel::Spline | Kernel::Cell => resolved,
    }
}

fn initial(initial: &Initial, dimensions: usize) -> Resolved {
    let resolved = Resolved::default().text("kind", initial.name());
    match initial {
        Initial::Pulse { field, amplitude, centre, radius } => {
            let resolved = resolved.text("field", field.to_string()).number("amplitude", amplitude);
            match centre {
                Centre::Point(at) => resolved.number("at", at),
                Centre::Plane { axis, at } => resolved.number("axis", axis + 1).number("at", at),
            }
            .number("radius", radius)
        }
        Initial::PlaneWave { branch, direction_deg, elevation_deg, wavelength, amplitude } => {
            let resolved = resolved.number("branch", branch).number("direction_deg", direction_deg);
            match dimensions {
                2 => resolved,
                _ => resolved.number("elevation_deg", elevation_deg),
            }
            .number("wavelength", wavelength)
            .number("amplitude", amplitude)
        }
        Initial::PlanePulse(pulse) => {
            pulse.resolved(resolved, dimensions).table("time", &function(&pulse.time))
        }
        Initial::Rotation { shape: own, angle_deg, axis } => {
            let resolved = shape(resolved, own, dimensions).number("angle_deg", angle_deg);
            match dimensions {
                2 => resolved,
                _ => resolved.number("about", axis + 1),
            }
        }
        Initial::Uniform { shape: own, field, amplitude } => shape(resolved, own, dimensions)
            .text("field", field.to_string())
            .number("amplitude", amplitude),
    }
}

fn function(function: &TimeFunction) -> Resolved {
    let resolved = Resolved::default().text("kind", function.name());
    match function {
        TimeFunction::Step { start, duration: None } => resolved.number("start", start),
        TimeFunction::Step { start, duration: Some(duration) }
        | TimeFunction::Triangle { start, duration }
        | TimeFunction::Pulse { start, duration } => {
            resolved.number("start", start).number("duration", duration)
        }
        TimeFunction::Ricker { frequency, delay } => {
            resolved.number("frequency", frequency).number("delay", delay)
        }
        TimeFunction::Sine { frequency, start } => {
            resolved.number("frequency", frequency).number("start", start)
        }
        TimeFunction::Table(samples) => resolved.number("samples", samples.samples()),
    }
}
