//! Text of plans, costs, warnings and stop causes of simulations.

use crate::case::dynamics::StateComponent;
use crate::report::format::{format_short, format_superscript};
use crate::study::simulate::{
    Bytes, Cost, CostAmount, IllPosedness, ProblemSize, SimulationPlan, SimulationWarning,
    StopCause, StopReport, quantity_unit,
};
use analysis::growth::Growth;
use dynamics::simulation::StepLimit;
use models::common::decimal::ToPlainText;
use models::common::elementary::Elementary;
use std::fmt::{Display, Formatter, Result};

impl Display for SimulationPlan {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match &self.problem_size {
            ProblemSize::Solid {
                cell_counts: cells,
                field_count: fields,
                step_count: steps,
                time_step,
                step_limit: limit,
                shear_interval,
            } => {
                let cells: Vec<String> = cells.iter().map(usize::to_string).collect();
                write!(
                    formatter,
                    "{} cells of {fields} fields, {steps} steps of {} s ({})",
                    cells.join(" × "),
                    format_short(*time_step),
                    match limit {
                        StepLimit::Rotation => "limited by the natural rotation",
                        StepLimit::Wave => "limited by the fastest wave",
                    },
                )?;
                match shear_interval {
                    1 => Ok(()),
                    _ => write!(formatter, ", {shear_interval} per step of the shear waves"),
                }
            }
            ProblemSize::Flow {
                point_counts: [first, second],
                model_title: model,
                duration,
                wave_numbers,
            } => {
                let duration = format_short(*duration);
                let [least, greatest] = wave_numbers.map(format_short);
                write!(
                    formatter,
                    "{first} × {second} points, {model}, {duration} s, wave numbers from {least} to {greatest} 1/m",
                )
            }
        }?;
        write!(formatter, ", memory {}", self.required_memory)?;
        if self.rank_count > 1 {
            write!(formatter, " in each of {} processes", self.rank_count)?;
        }
        write!(formatter, "; {}", self.cost)
    }
}

impl Display for Cost {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        let Self {
            single_thread_time: time,
            snapshot_count: snapshots,
            snapshot_bytes,
            table_bytes,
            ..
        } = *self;
        write!(formatter, "about {} of one thread, tables of {table_bytes}", DisplayTime(time))?;
        match snapshots > 0.0 {
            true => write!(formatter, ", {} in {snapshot_bytes}", CostAmount::Snapshots(snapshots)),
            false => Ok(()),
        }
    }
}

impl Display for CostAmount {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match self {
            Self::Steps(steps) => write!(formatter, "{} steps", format_short(*steps)),
            Self::Time(time) => write!(formatter, "{} of one thread", DisplayTime(*time)),
            Self::Snapshots(count) => write!(formatter, "{} snapshots", format_short(*count)),
            Self::SnapshotBytes(bytes) => write!(formatter, "snapshots of {bytes}"),
            Self::TableBytes(bytes) => write!(formatter, "tables of {bytes}"),
        }
    }
}

/// Time in s, displayed in the largest unit of which it has at least two, below 10⁴ units rounded to an integer; less
/// than 1 s as 1 s.
pub struct DisplayTime(pub f64);

impl Display for DisplayTime {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        const TIME_UNITS: [(f64, &str); 5] = [
            (365.25 * 86400.0, "years"),
            (86400.0, "days"),
            (3600.0, "h"),
            (60.0, "min"),
            (1.0, "s"),
        ];
        let Self(time) = *self;
        let (unit, name) =
            TIME_UNITS.into_iter().find(|own| time >= 2.0 * own.0).unwrap_or((1.0, "s"));
        match time / unit {
            few if few < 1.0 => formatter.write_str("1 s"),
            few if few < 1e4 => write!(formatter, "{few:.0} {name}"),
            many => write!(formatter, "{} {name}", format_short(many)),
        }
    }
}

impl Display for Bytes {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        const BYTE_UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
        let Self(bytes) = self;
        let power = (bytes.max(1.0).cr_log2() / 10.0).floor().clamp(1.0, 4.0);
        let unit = BYTE_UNITS[power as usize - 1];
        match bytes / 1024f64.cr_powf(power) {
            many if many >= 1e5 => write!(formatter, "{} {unit}", format_short(many)),
            few => write!(formatter, "{few:.1} {unit}"),
        }
    }
}

impl Display for SimulationWarning {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match self {
            Self::FewSteps { entry_key: entry, steps_per_time_scale: steps } => {
                let steps = format_short(*steps);
                write!(
                    formatter,
                    "{entry}.time varies within {steps} steps: smaller cells resolve it better"
                )
            }
            Self::LedgerResidual { relative_residual: part } => write!(
                formatter,
                "the residual of the energy ledger is {} % of its largest term, more than rounding: numbers may be too \
                 large or too small for scheme.precision",
                format_short(100.0 * part)
            ),
            Self::LargeStrain { strain } => write!(
                formatter,
                "strains of about {} % at the end: the equations of solids hold for small strains; smaller loads or \
                 initial velocities give them",
                format_short((100.0 * strain).round())
            ),
            Self::ObliqueWaves => formatter.write_str(
                "time.courant_of = \"s\" is exact for plane waves along the axes only: waves oblique to them, and waves \
                 scattered by joints, have several times the error of courant_of = \"fastest\"",
            ),
            Self::Sawtooth { entry_key: entry } => write!(
                formatter,
                "{entry} acts on one cell: at Courant number 1 the sawtooth that it excites is not damped; \
                 the kernel \"spline\" excites none"
            ),
        }
    }
}

impl Display for StopReport {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        let Self { cause, detection_time: time, last_valid_time: saved } = self;
        let remedy = match cause {
            StopCause::NonFiniteField { .. } | StopCause::NonFiniteEnergy => {
                "loads or initial values may exceed the floating-point range"
            }
            StopCause::FlowDomainExit { position: Some(_), .. } => {
                "if the state is well-posed, a smaller perturbation can be followed for longer"
            }
            StopCause::FlowDomainExit { position: None, .. } => {
                "if the state is well-posed, a smaller perturbation or larger tolerances can be followed for longer"
            }
        };
        let [time, saved] = [time, saved].map(|own| format_short(*own));
        write!(formatter, "{cause} after {time} s; {remedy}; the state at {saved} s is saved")
    }
}

impl Display for StopCause {
    /// Formats the cause, with the position if it is local.
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        match self {
            Self::NonFiniteField { field, cell_centre } => {
                let field = StateComponent(*field);
                write!(
                    formatter,
                    "{field} is not finite in the cell at {cell_centre} m",
                    cell_centre = cell_centre.to_plain_text()
                )
            }
            Self::NonFiniteEnergy => formatter.write_str("the energy is not finite"),
            Self::FlowDomainExit { description, position: Some(at) } => {
                let [first, second] = at.map(format_short);
                write!(formatter, "{description} at [{first}, {second}] m in the box at t = 0")
            }
            Self::FlowDomainExit { description, position: None } => {
                formatter.write_str(description)
            }
        }
    }
}

impl Display for IllPosedness {
    fn fmt(&self, formatter: &mut Formatter) -> Result {
        let direction = format_short(self.direction_deg);
        formatter.write_str("ill-posed: ")?;
        let Some(Growth { order, coefficient }) = self.growth else {
            return write!(formatter, "waves at {direction}° grow at unbounded rates");
        };
        let order = order.to_f64();
        let tenfold = 10f64.cr_ln() / (coefficient * self.max_wave_number.cr_powf(order));
        write!(
            formatter,
            "short waves grow at the rate {} k{} 1/s, fastest at {direction}°; the shortest waves of the grid, \
             k = {} 1/m, grow tenfold in {} s, and faster on finer grids",
            format_short(coefficient),
            format_superscript(order),
            format_short(self.max_wave_number),
            format_short(tenfold)
        )
    }
}

/// Returns the axis label of a quantity, with symbol and unit, by its name in files.
pub(in crate::report) fn axis_label(name: &str) -> String {
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
        "psi_deg" => return "stress angle ψ (°)".to_owned(),
        "p" => ("pressure", "p"),
        "slip" => return "slip of joints (m)".to_owned(),
        "opening" => return "opening of joints (m)".to_owned(),
        "pressure" => return "pressure of fluid p (Pa)".to_owned(),
        "shear_rate" => ("shear rate", "Q_D"),
        "excess_stress" => ("excess of the conditional stress", "s − σ"),
        "spring_stress" => ("stress of the spring", "b"),
        "plastic_strain" => ("plastic strain", "εᵖ"),
        "volumetric_strain" => return "volumetric strain tr ε".to_owned(),
        "pore_closure" => return "closure of pores min(θ₀ + tr ε, 0)".to_owned(),
        "porosity" => return "porosity θ".to_owned(),
        _ => return "plastic dissipation (J/m³)".to_owned(),
    };
    match quantity_unit(name) {
        "1" => format!("{quantity} {symbol}{index}"),
        unit => format!("{quantity} {symbol}{index} ({unit})"),
    }
}
