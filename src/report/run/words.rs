//! Plans, warnings and ends of simulations as words.

use crate::case::dynamics::Component;
use crate::report::format::{short, superscript};
use crate::study::simulate::{Bytes, IllPosed, Plan, StopCause, Stopped, Warning, Work, unit_of};
use analysis::growth::Growth;
use dynamics::simulation::StepLimit;
use models::common::elementary::Elementary;
use std::fmt::{Display, Formatter, Result};

impl Display for Plan {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match &self.work {
            Work::Solid { cells, fields, steps, step, limit } => {
                let cells: Vec<String> = cells.iter().map(usize::to_string).collect();
                write!(
                    formatter,
                    "{} cells of {fields} fields, {steps} steps of {} s ({})",
                    cells.join(" × "),
                    short(*step),
                    match limit {
                        StepLimit::Rotation => "for the natural rotation",
                        StepLimit::Wave => "for the fastest wave",
                    },
                )
            }
            Work::Flow { points: [first, second], model, duration, wave_numbers } => {
                let duration = short(*duration);
                let [least, greatest] = wave_numbers.map(short);
                write!(
                    formatter,
                    "{first} × {second} points, {model}, {duration} s, wave numbers from {least} to {greatest} 1/m",
                )
            }
        }?;
        write!(formatter, ", memory {}", self.memory)
    }
}

impl Display for Bytes {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
        let Self(bytes) = self;
        let power = (bytes.max(1.0).cr_log2() / 10.0).floor().clamp(1.0, 4.0);
        write!(formatter, "{:.1} {}", bytes / 1024f64.cr_powf(power), UNITS[power as usize - 1])
    }
}

impl Display for Warning {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match self {
            Self::FewSteps { entry, steps } => {
                let steps = short(*steps);
                write!(
                    formatter,
                    "{entry}.time changes within {steps} steps: smaller cells see more of it"
                )
            }
            Self::Sawtooth { entry } => write!(
                formatter,
                "{entry} acts on one cell: at Courant number 1 nothing damps the sawtooth that it makes; \
                 the kernel \"spline\" makes none"
            ),
        }
    }
}

impl Display for Stopped {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        let Self { cause, time, saved } = self;
        let remedy = match cause {
            StopCause::Field { .. } | StopCause::Energy => {
                "loads or initial values may be too large for the numbers"
            }
            StopCause::Flow { at: Some(_), .. } => {
                "a smaller perturbation goes on for longer if the state is well-posed"
            }
            StopCause::Flow { at: None, .. } => {
                "a smaller perturbation or greater tolerances go on for longer if the state is well-posed"
            }
        };
        let [time, saved] = [time, saved].map(|own| short(*own));
        write!(formatter, "{cause} after {time} s; {remedy}; the state at {saved} s is saved")
    }
}

impl Display for StopCause {
    /// What happened, and where if it is one place.
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match self {
            Self::Field { field, place } => {
                let field = Component(*field);
                write!(formatter, "{field} is not finite in the cell at {place:?} m")
            }
            Self::Energy => formatter.write_str("the energy is not finite"),
            Self::Flow { what, at: Some(at) } => {
                let [first, second] = at.map(short);
                write!(formatter, "{what} at [{first}, {second}] m in the box at the beginning")
            }
            Self::Flow { what, at: None } => formatter.write_str(what),
        }
    }
}

impl Display for IllPosed {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        let direction = short(self.direction_deg);
        formatter.write_str("ill-posed: ")?;
        let Some(Growth { order, coefficient }) = self.growth else {
            return write!(formatter, "waves at {direction}° grow at unbounded rates");
        };
        let order = order.value();
        let tenfold = 10f64.cr_ln() / (coefficient * self.number.cr_powf(order));
        write!(
            formatter,
            "short waves grow at the rate {} k{} 1/s, fastest at {direction}°; those of the grid, \
             k = {} 1/m, tenfold in {} s, and finer grids faster",
            short(coefficient),
            superscript(order),
            short(self.number),
            short(tenfold)
        )
    }
}

/// A quantity with its symbol and unit, by its name in files.
pub(super) fn label(name: &str) -> String {
    let digits: String = name.chars().filter(char::is_ascii_digit).collect();
    let subscript = |c: char| match c {
        '1'..='3' => char::from_u32('₀' as u32 + (c as u32 - '0' as u32)).unwrap_or(c),
        c => c,
    };
    let index: String = digits.chars().map(subscript).collect();
    let (quantity, symbol) = match name.trim_end_matches(|c: char| c.is_ascii_digit()) {
        "v" => ("velocity", "v"),
        "w" => ("spin", "ω"),
        "sigma" => ("stress", "σ"),
        "m" => ("couple stress", "m"),
        "u" => ("displacement", "u"),
        "phi" => ("rotation", "φ"),
        "psi_deg" => return "stress angle ψ, °".to_owned(),
        "p" => ("pressure", "p"),
        "shear_rate" => ("shear rate", "Q_D"),
        _ => return "plastic dissipation, J/m³".to_owned(),
    };
    format!("{quantity} {symbol}{index}, {}", unit_of(name))
}
