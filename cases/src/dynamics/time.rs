//! The sections `[time]` and `[scheme]` of a solid.

use crate::error::CaseError;
use crate::named_enum::named_enum;
use crate::node::Node;
use crate::schema::{AllowedRange, KeyGroup, KeySchema, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};

/// Schema of the section `[time]`.
pub(super) const TIME_SCHEMA: TableSchema = TableSchema::new_section(
    "time",
    "duration and time step",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "duration",
            ValueType::Number(AllowedRange::Positive),
            "s",
            "0.05",
            "duration of the simulation",
        ),
        KeySchema::new_with_default(
            "courant",
            ValueType::Number(AllowedRange::PositiveUpTo(1.0)),
            "",
            "0.9",
            "Courant number c(Δt/2)/h of the fastest wave in a sweep; at 1 this wave moves exactly one cell per sweep",
        )
        .with_note("Courant number")
        .with_remark(": a sweep is unstable above 1"),
        KeySchema::new_with_default(
            "courant_of",
            ValueType::OneOf(|_| variant_names(CourantWaves::ALL, CourantWaves::name)),
            "",
            "\"fastest\"",
            "waves of the Courant number: fastest, or s: shear waves too, in classical solids whose longitudinal waves are 2 or 3 times as fast and take as many steps for each step of the shear waves; for plane waves along the axes, oblique waves have larger errors",
        ),
        KeySchema::new_with_default(
            "rotation_deg",
            ValueType::Number(AllowedRange::PositiveUpTo(180.0)),
            "deg",
            "30.0",
            "largest rotation of spin and antisymmetric stress per time step",
        )
        .with_remark(": largest rotation of spin and antisymmetric stress per time step"),
    ])],
)
.with_remedy("a section [time] with duration in s");

/// Schema of the section `[scheme]`.
pub(super) const SCHEME_SCHEMA: TableSchema = TableSchema::new_section(
    "scheme",
    "numerical scheme",
    &[KeyGroup::new(&[
        KeySchema::new_optional(
            "order",
            ValueType::OneOf(|_| {
                variant_names(ReconstructionScheme::ALL, ReconstructionScheme::name)
            }),
            "",
            "\"fourth-order\"",
            "spatial reconstruction of characteristic waves: eno2 is limited, for discontinuities, the others are linear; sixth-order and eighth-order need fewer cells per wavelength at a small Courant number, and one solid on a uniform grid without non-reflecting sides; default: eno2 if any medium yields or has contacts, otherwise fourth-order",
        ),
        KeySchema::new_with_default(
            "correction",
            ValueType::OneOf(|_| variant_names(ReturnMappingOrder::ALL, ReturnMappingOrder::name)),
            "",
            "\"first-order\"",
            "time accuracy of the plastic correction; second-order: smooth plastic flow only",
        ),
        KeySchema::new_optional(
            "splitting",
            ValueType::OneOf(|_| {
                variant_names(DimensionalSplitting::ALL, DimensionalSplitting::name)
            }),
            "",
            "\"alternating\"",
            "dimensional splitting; default: two-cyclic if courant is 1 or correction is second-order, otherwise alternating; joints, contacts, polar grids and courant_of = \"s\" need two-cyclic",
        ),
        KeySchema::new_with_default(
            "precision",
            ValueType::OneOf(|_| variant_names(Precision::ALL, Precision::name)),
            "",
            "\"f64\"",
            "floating-point precision of the fields; f32 takes half the memory of f64",
        ),
        KeySchema::new_with_default(
            "ledger",
            ValueType::OneOf(|_| variant_names(LedgerDetail::ALL, LedgerDetail::name)),
            "",
            "\"light\"",
            "energy ledger: light, totals only; full, also the numerical dissipation of each cell, many times slower",
        ),
    ])],
);

/// Returns the names of enumeration variants in case files.
pub(super) fn variant_names<T: Copy>(all: &[T], name: impl Fn(T) -> &'static str) -> Vec<String> {
    all.iter().map(|&own| name(own).to_owned()).collect()
}

/// Duration and time step.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidTime {
    /// Duration, s; positive.
    pub duration: f64,
    /// Maximum Courant number (CFL number) c(Δt/2)/Δx of a sweep along an axis, with the wave speed c, the time step Δt
    /// and the cell spacing Δx; in (0, 1].
    pub courant_number: f64,
    /// Waves to which the Courant number refers.
    pub courant_waves: CourantWaves,
    /// Maximum angle per step of the rotation between spins and antisymmetric stress, degrees; in (0, 180].
    pub max_rotation_deg: f64,
}

named_enum! {
    /// Waves to which the Courant number refers.
    CourantWaves {
        /// The fastest waves.
        Fastest = "fastest",
        /// Shear waves, and longitudinal waves which take several steps for each step of the shear waves.
        Shear = "s"
    }
}

/// Options of the numerical scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SchemeOptions {
    /// Reconstruction of the Riemann invariants.
    pub reconstruction: ReconstructionScheme,
    /// Temporal order of accuracy of the return mapping.
    pub return_mapping_order: ReturnMappingOrder,
    /// Dimensional splitting: order of the sweeps along the axes.
    pub splitting: DimensionalSplitting,
    /// Floating-point precision of the state.
    pub precision: Precision,
    /// Level of detail of the energy ledger.
    pub ledger_detail: LedgerDetail,
}

named_enum! {
    /// Reconstruction of the Riemann invariants.
    ReconstructionScheme {
        /// Fourth-order linear reconstruction, for smooth waves.
        FourthOrder = "fourth-order",
        /// Sixth-order linear reconstruction, for smooth waves in one solid.
        SixthOrder = "sixth-order",
        /// Eighth-order linear reconstruction, for smooth waves in one solid.
        EighthOrder = "eighth-order",
        /// Second-order reconstruction with a TVD limiter, for fronts.
        Eno2 = "eno2",
        /// First-order reconstruction: Godunov's scheme.
        Godunov = "godunov"
    }
}

named_enum! {
    /// Dimensional splitting (Strang 1968): order of the sweeps along the axes.
    DimensionalSplitting {
        /// Alternating: sweeps along one axis x alternate with sweeps along the others (x, y z, x, z y).
        Alternating = "alternating",
        /// Two-cyclic: sweeps along all axes forward and then backward (x y z, z y x).
        TwoCyclic = "two-cyclic"
    }
}

named_enum! {
    /// Temporal order of accuracy of the return mapping.
    ReturnMappingOrder {
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
    LedgerDetail {
        /// Light: totals of energies, work and plastic dissipation.
        Totals = "light",
        /// Full: also the numerical dissipation of each cell.
        TotalsAndDissipation = "full"
    }
}

/// Default Courant number (CFL number). At 1, waves along an axis with a wavelength of two cells are undamped; at 0.9 a
/// simulation takes 11 % more steps than at 1.
pub const DEFAULT_COURANT_NUMBER: f64 = 0.9;

/// Least number of cells along each axis for reconstructions of more than four cells: those that the images beyond a
/// boundary need.
pub(super) const MIN_CELLS_OF_HIGH_ORDER: usize = 4;

impl SolidTime {
    /// Reads the section `[time]`.
    pub(super) fn read(root: &SectionReader) -> Result<Self, CaseError> {
        let section = root.open_required_section(&TIME_SCHEMA)?;
        let duration = section.read_required("duration")?;
        let courant = section.read_or_default("courant")?;
        let waves =
            section.read_optional_choice("courant_of", CourantWaves::ALL, CourantWaves::name)?;
        let rotation_deg = section.read_or_default("rotation_deg")?;
        section.finish()?;
        Ok(Self {
            duration,
            courant_number: courant,
            courant_waves: waves.unwrap_or(CourantWaves::Fastest),
            max_rotation_deg: rotation_deg,
        })
    }

    /// Formats the section `[time]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        TableWriter::default()
            .with_number("duration", self.duration)
            .with_number("courant", self.courant_number)
            .with_text("courant_of", self.courant_waves.name())
            .with_number("rotation_deg", self.max_rotation_deg)
            .to_section_toml(&TIME_SCHEMA)
    }
}

impl SchemeOptions {
    /// Reads the section `[scheme]` beside the section `[time]`; `yields` states whether at least one medium yields,
    /// `two_cyclic_cause` what requires two-cyclic sweeps beside the other two, `has_contacts` whether any medium is granular
    /// or porous, `narrow_cause` what excludes reconstructions of more than four cells.
    ///
    /// Defaults: fourth-order reconstruction for elastic media; limited second-order reconstruction if a medium yields,
    /// since plastic fronts are discontinuous, or has contacts. Alternating sweeps; two-cyclic sweeps for Courant number 1 or a
    /// second-order return mapping.
    pub(super) fn read(
        root: &SectionReader,
        time: &SolidTime,
        (yields, two_cyclic_cause, has_contacts, narrow_cause): (
            bool,
            Option<&str>,
            bool,
            Option<&str>,
        ),
    ) -> Result<Self, CaseError> {
        let can_alternate = two_cyclic_cause.is_none()
            && !has_contacts
            && time.courant_waves == CourantWaves::Fastest;
        let order = match yields || has_contacts {
            true => ReconstructionScheme::Eno2,
            false => ReconstructionScheme::FourthOrder,
        };
        let orders: &[ReconstructionScheme] = match (has_contacts, narrow_cause) {
            (true, _) => &[ReconstructionScheme::Eno2, ReconstructionScheme::Godunov],
            (false, Some(_)) => &[
                ReconstructionScheme::FourthOrder,
                ReconstructionScheme::Eno2,
                ReconstructionScheme::Godunov,
            ],
            (false, None) => ReconstructionScheme::ALL,
        };
        let corrections = match has_contacts {
            true => &[ReturnMappingOrder::FirstOrder],
            false => ReturnMappingOrder::ALL,
        };
        let default = |correction: ReturnMappingOrder| match correction {
            ReturnMappingOrder::FirstOrder if time.courant_number < 1.0 && can_alternate => {
                DimensionalSplitting::Alternating
            }
            _ => DimensionalSplitting::TwoCyclic,
        };
        let Some(section) = root.open_section(&SCHEME_SCHEMA)? else {
            let splitting = default(ReturnMappingOrder::default());
            return Ok(Self { reconstruction: order, splitting, ..Self::default() });
        };
        let cause = match (has_contacts, two_cyclic_cause) {
            (true, _) => "granular and porous media",
            (_, Some(cause)) => cause,
            _ if time.courant_waves == CourantWaves::Shear => "courant_of = \"s\"",
            _ => "correction = \"second-order\"",
        };
        check_choice(
            &section,
            "correction",
            [ReturnMappingOrder::ALL, corrections],
            ReturnMappingOrder::name,
            cause,
        )?;
        check_choice(
            &section,
            "order",
            [ReconstructionScheme::ALL, orders],
            ReconstructionScheme::name,
            if has_contacts { cause } else { narrow_cause.unwrap_or(cause) },
        )?;
        let correction = section
            .read_optional_choice("correction", corrections, ReturnMappingOrder::name)?
            .unwrap_or_default();
        let splittings: &[DimensionalSplitting] = match correction {
            ReturnMappingOrder::FirstOrder if can_alternate => DimensionalSplitting::ALL,
            _ => &[DimensionalSplitting::TwoCyclic],
        };
        check_choice(
            &section,
            "splitting",
            [DimensionalSplitting::ALL, splittings],
            DimensionalSplitting::name,
            cause,
        )?;
        let scheme = Self {
            reconstruction: section
                .read_optional_choice("order", orders, ReconstructionScheme::name)?
                .unwrap_or(order),
            return_mapping_order: correction,
            splitting: section
                .read_optional_choice("splitting", splittings, DimensionalSplitting::name)?
                .unwrap_or(default(correction)),
            precision: section
                .read_optional_choice("precision", Precision::ALL, Precision::name)?
                .unwrap_or_default(),
            ledger_detail: section
                .read_optional_choice("ledger", LedgerDetail::ALL, LedgerDetail::name)?
                .unwrap_or_default(),
        };
        section.finish()?;
        Ok(scheme)
    }

    /// Formats the section `[scheme]` as TOML with all values.
    pub(super) fn to_toml(self) -> String {
        TableWriter::default()
            .with_text("order", self.reconstruction.name())
            .with_text("correction", self.return_mapping_order.name())
            .with_text("splitting", self.splitting.name())
            .with_text("precision", self.precision.name())
            .with_text("ledger", self.ledger_detail.name())
            .to_section_toml(&SCHEME_SCHEMA)
    }
}

/// Checks a choice that exists but that this case does not allow because of `cause`; other texts are not checked.
/// `name_of` returns the name of a choice.
fn check_choice<T: Copy + PartialEq>(
    section: &SectionReader,
    key: &str,
    [all, allowed]: [&[T]; 2],
    name_of: impl Fn(T) -> &'static str,
    cause: &str,
) -> Result<(), CaseError> {
    let found = section.node(key).and_then(Node::as_text).unwrap_or_default();
    let is_refused = |own: &&T| name_of(**own) == found && !allowed.contains(own);
    if !all.iter().any(|own| is_refused(&own)) {
        return Ok(());
    }
    let names: Vec<String> = allowed.iter().map(|own| format!("'{}'", name_of(*own))).collect();
    let expected = format!("expected {}: {cause} allow no other", names.join(" or "));
    Err(section.key_error(key, format!("found '{found}'"), expected))
}
