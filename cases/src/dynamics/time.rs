//! The sections `[time]` and `[scheme]` of a solid.

use crate::error::CaseError;
use crate::named_enum::named_enum;
use crate::schema::{Form, Group, Item, Range, Type};
use crate::section::{Resolved, Section};

/// Schema of the section `[time]`.
pub(super) const TIME: Form = Form::section(
    "time",
    "how long the run lasts, and in which steps",
    &[Group::always(&[
        Item::required(
            "duration",
            Type::Number(Range::Positive),
            "s",
            "0.05",
            "how long the run lasts",
        ),
        Item::with_default(
            "courant",
            Type::Number(Range::UpTo(1.0)),
            "",
            "0.9",
            "Courant number c(Δt/2)/h of the fastest wave in a sweep; at 1 it moves by whole cells",
        )
        .note("Courant number")
        .remark(": a sweep is unstable above 1"),
        Item::with_default(
            "rotation_deg",
            Type::Number(Range::UpTo(180.0)),
            "deg",
            "30.0",
            "by which a step turns spins against antisymmetric stress, at most",
        )
        .remark(": by how much a step may turn spins against antisymmetric stress"),
    ])],
)
.required("a section [time] with duration in s");

/// Schema of the section `[scheme]`.
pub(super) const SCHEME: Form = Form::section(
    "scheme",
    "the choices of the scheme",
    &[Group::always(&[
        Item::optional(
            "order",
            Type::OneOf(|_| names(Order::ALL, Order::name)),
            "",
            "\"fourth-order\"",
            "reconstruction of waves: linear; eno2 is limited, for fronts, and the default where something yields",
        ),
        Item::with_default(
            "correction",
            Type::OneOf(|_| names(Correction::ALL, Correction::name)),
            "",
            "\"first-order\"",
            "accuracy in time of plastic flow; second-order is for smooth flow alone",
        ),
        Item::optional(
            "splitting",
            Type::OneOf(|_| names(Splitting::ALL, Splitting::name)),
            "",
            "\"alternating\"",
            "order of the sweeps; default two-cyclic with courant = 1 or second-order correction",
        ),
        Item::with_default(
            "precision",
            Type::OneOf(|_| names(Precision::ALL, Precision::name)),
            "",
            "\"f64\"",
            "numbers of the state; f32 takes half the memory",
        ),
        Item::with_default(
            "ledger",
            Type::OneOf(|_| names(Ledger::ALL, Ledger::name)),
            "",
            "\"light\"",
            "what is kept of the energy; full counts what the scheme dissipates, many times slower",
        ),
    ])],
);

/// Returns the names of enumeration variants in case files.
pub(super) fn names<T: Copy>(all: &[T], name: impl Fn(T) -> &'static str) -> Vec<String> {
    all.iter().map(|&own| name(own).to_owned()).collect()
}

/// Duration and time step.
#[derive(Clone, Debug, PartialEq)]
pub struct Time {
    /// Duration, s; positive.
    pub duration: f64,
    /// Maximum Courant number (CFL number) c(Δt/2)/Δx of a sweep along an axis; in (0, 1].
    pub courant: f64,
    /// Maximum angle per step of the rotation between spins and antisymmetric stress, degrees; in (0, 180].
    pub rotation_deg: f64,
}

/// Options of the numerical scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scheme {
    /// Reconstruction of the Riemann invariants.
    pub order: Order,
    /// Temporal order of accuracy of the return mapping.
    pub correction: Correction,
    /// Dimensional splitting: order of the sweeps along the axes.
    pub splitting: Splitting,
    /// Floating-point precision of the state.
    pub precision: Precision,
    /// Level of detail of the energy ledger.
    pub ledger: Ledger,
}

named_enum! {
    /// Reconstruction of the Riemann invariants.
    Order {
        /// Fourth-order linear reconstruction, for smooth waves.
        FourthOrder = "fourth-order",
        /// Second-order reconstruction with a TVD limiter, for fronts.
        Eno2 = "eno2",
        /// First-order reconstruction: Godunov's scheme.
        Godunov = "godunov"
    }
}

named_enum! {
    /// Dimensional splitting (Strang 1968): order of the sweeps along the axes.
    Splitting {
        /// Alternating: sweeps along one axis x alternate with sweeps along the others (x, y z, x, z y).
        Alternating = "alternating",
        /// Two-cyclic: sweeps along all axes forward and then backward (x y z, z y x).
        TwoCyclic = "two-cyclic"
    }
}

named_enum! {
    /// Temporal order of accuracy of the return mapping.
    Correction {
        /// First order: return mapping after each step.
        FirstOrder = "first-order",
        /// Second order: midpoint reflection in the middle of each step.
        SecondOrder = "second-order"
    }
}

named_enum! {
    /// Floating-point precision of the state.
    Precision {
        /// Double precision, 64 bits.
        F64 = "f64",
        /// Single precision, 32 bits: half the memory.
        F32 = "f32"
    }
}

named_enum! {
    /// Level of detail of the energy ledger.
    Ledger {
        /// Light: total energies only.
        Light = "light",
        /// Full: also numerical and plastic dissipation.
        Full = "full"
    }
}

/// Default Courant number (CFL number). At 1 two-cell waves along an axis are undamped; below 0.87 a run costs over 15
/// % more.
pub const COURANT: f64 = 0.9;

impl Time {
    /// Reads the section `[time]`.
    pub(super) fn read(root: &Section) -> Result<Self, CaseError> {
        let section = root.required_section(&TIME)?;
        let duration = section.required("duration")?;
        let courant = section.or_default("courant")?;
        let rotation_deg = section.or_default("rotation_deg")?;
        section.finish()?;
        Ok(Self { duration, courant, rotation_deg })
    }

    /// Formats the section `[time]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        Resolved::default()
            .number("duration", self.duration)
            .number("courant", self.courant)
            .number("rotation_deg", self.rotation_deg)
            .under(&TIME)
    }
}

impl Scheme {
    /// Reads the section `[scheme]`.
    ///
    /// Defaults: fourth-order reconstruction for elastic media; limited second-order reconstruction if a medium yields,
    /// since plastic fronts are discontinuous. Alternating sweeps; two-cyclic sweeps for Courant number 1 or a
    /// second-order return mapping.
    pub(super) fn read(root: &Section, courant: f64, yields: bool) -> Result<Self, CaseError> {
        let order = if yields { Order::Eno2 } else { Order::FourthOrder };
        let default = |correction: Correction| match correction {
            Correction::FirstOrder if courant < 1.0 => Splitting::Alternating,
            _ => Splitting::TwoCyclic,
        };
        let Some(section) = root.section(&SCHEME)? else {
            let splitting = default(Correction::default());
            return Ok(Self { order, splitting, ..Self::default() });
        };
        let correction = section
            .optional_choice("correction", Correction::ALL, Correction::name)?
            .unwrap_or_default();
        let splittings: &[Splitting] = match correction {
            Correction::FirstOrder => Splitting::ALL,
            Correction::SecondOrder => &[Splitting::TwoCyclic],
        };
        let scheme = Self {
            order: section.optional_choice("order", Order::ALL, Order::name)?.unwrap_or(order),
            correction,
            splitting: section
                .optional_choice("splitting", splittings, Splitting::name)?
                .unwrap_or(default(correction)),
            precision: section
                .optional_choice("precision", Precision::ALL, Precision::name)?
                .unwrap_or_default(),
            ledger: section
                .optional_choice("ledger", Ledger::ALL, Ledger::name)?
                .unwrap_or_default(),
        };
        section.finish()?;
        Ok(scheme)
    }

    /// Formats the section `[scheme]` as TOML with all values.
    pub(super) fn to_toml(self) -> String {
        Resolved::default()
            .text("order", self.order.name())
            .text("correction", self.correction.name())
            .text("splitting", self.splitting.name())
            .text("precision", self.precision.name())
            .text("ledger", self.ledger.name())
            .under(&SCHEME)
    }
}
