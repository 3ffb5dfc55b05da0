//! The sections `[[source]]`: point sources inside the grid, and the kernels that distribute them over cells.

use super::reader::SolidReader;
use super::time_function::{self, TimeFunction};
use crate::error::CaseError;
use crate::schema::{
    AllowedRange, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};
use models::common::decimal::ToPlainText;
use models::solid::parameters::Theory;

const PLANE_CONDITION: &[KeyCondition] = &[KeyCondition::PlaneStrain];
const SPACE_CONDITION: &[KeyCondition] = &[KeyCondition::Space];

/// Key `kernel`: kernel of a point load or point source.
pub(super) const KERNEL_KEY: KeySchema = KeySchema::new_optional(
    "kernel",
    ValueType::OneOf(|_| Kernel::NAMES.map(str::to_owned).to_vec()),
    "",
    "\"bell\"",
    "kernel that distributes a point load or source over cells: spline (smooth, a few cells), bell (with radius) or cell (nearest cell); default: bell if radius is given, otherwise spline",
);

/// Key `radius`: radius of the bell kernel.
pub(super) const RADIUS_KEY: KeySchema = KeySchema::new_optional(
    "radius",
    ValueType::Number(AllowedRange::NotNegative),
    "m",
    "2.0",
    "radius of the kernel bell; 0: kernel cell",
)
.with_note("radius of the kernel bell; 0: one cell");

/// Schema of the sections `[[source]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "source",
    "point source inside the grid",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "kind",
            ValueType::OneOf(|_| SourceKind::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"force\"",
            "kind of source; couple: Cosserat solids only",
        )]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["force"])],
            &[
                KeySchema::new_required(
                    "amplitude",
                    ValueType::Numbers(ListLength::GridAxes),
                    "N/m",
                    "[1e4, 0.0]",
                    "force vector",
                )
                .with_note("force vector")
                .with_conditions(PLANE_CONDITION),
                KeySchema::new_required(
                    "amplitude",
                    ValueType::Numbers(ListLength::GridAxes),
                    "N",
                    "[1e4, 0.0, 0.0]",
                    "force vector",
                )
                .with_note("force vector")
                .with_conditions(SPACE_CONDITION),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["couple"])],
            &[KeySchema::new_required(
                "amplitude",
                ValueType::Numbers(ListLength::SpinComponents),
                "N·m",
                "1e4",
                "couple: about x₃ per m of thickness in plane strain, three components in 3D",
            )
            .with_note("couple")],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["moment"])],
            &[KeySchema::new_required(
                "amplitude",
                ValueType::Tensor,
                "N·m",
                "[[0.0, 1e4], [1e4, 0.0]]",
                "moment tensor by rows; in plane strain per m of thickness",
            )
            .with_remark(", by rows")],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["explosion"])],
            &[KeySchema::new_required(
                "amplitude",
                ValueType::Number(AllowedRange::Finite),
                "N·m",
                "1e4",
                "isotropic moment; in plane strain per m of thickness",
            )
            .with_note("isotropic moment")],
        ),
        KeyGroup::new(&[
            KeySchema::new_required(
                "at",
                ValueType::Numbers(ListLength::GridAxes),
                "m",
                "[0.0, -40.0]",
                "position of the source, inside the grid",
            )
            .with_note("point inside the grid"),
            KERNEL_KEY,
            RADIUS_KEY,
            time_function::TIME_KEY,
        ]),
    ],
);

/// Point source inside the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSource {
    /// Kind and amplitude of the source.
    pub kind: SourceKind,
    /// Position, m; inside the grid.
    pub position: Vec<f64>,
    /// Kernel that distributes the source over cells.
    pub kernel: Kernel,
    /// Dimensionless time function that multiplies the amplitude.
    pub time_function: TimeFunction,
}

/// Kernel that distributes a point source over cells, or a point load over the cell faces of a boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kernel {
    /// Smooth spline kernel over a few cells: its moments up to the second order equal the moments of a point source,
    /// and it excites no waves with a wavelength of two cells.
    #[default]
    Spline,
    /// Cosine-bell kernel.
    Bell {
        /// Radius, m; positive.
        radius: f64,
    },
    /// Nearest cell, or cell face, only.
    Cell,
}

impl Kernel {
    /// Names of all kernels in case files.
    pub const NAMES: [&str; 3] = ["spline", "bell", "cell"];

    /// Returns the name of the kernel in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Spline => "spline",
            Self::Bell { .. } => "bell",
            Self::Cell => "cell",
        }
    }

    /// Reads the keys `kernel` and `radius`; `None` if both are absent.
    pub(super) fn read(section: &SectionReader) -> Result<Option<Self>, CaseError> {
        let radius: Option<f64> = section.read_optional("radius")?;
        let name = section.read_optional_choice("kernel", &Self::NAMES, |name| name)?;
        match (name, radius) {
            (None, None) => Ok(None),
            (Some("spline"), None) => Ok(Some(Self::Spline)),
            (None | Some("cell"), Some(0.0)) | (Some("cell"), None) => Ok(Some(Self::Cell)),
            (None | Some("bell"), Some(radius)) if radius > 0.0 => Ok(Some(Self::Bell { radius })),
            (Some("bell"), found) => {
                let found = found.map_or("missing".to_owned(), |radius| {
                    format!("found {radius}", radius = radius.to_plain_text())
                });
                let allowed = "expected a positive number in m (radius of the bell)";
                Err(section.key_error("radius", found, allowed))
            }
            (name, _) => {
                let found = format!("found beside kernel = \"{}\"", name.unwrap_or_default());
                Err(section.key_error("radius", found, "leave it out, or write kernel = \"bell\""))
            }
        }
    }

    /// Adds the keys of the kernel to a table.
    pub(super) fn write_keys(self, resolved: TableWriter) -> TableWriter {
        let resolved = resolved.with_text("kernel", self.name());
        match self {
            Self::Bell { radius } => resolved.with_number("radius", radius),
            Self::Spline | Self::Cell => resolved,
        }
    }
}

/// Kind of a point source with its amplitude, which is multiplied by the time function. Amplitudes in plane strain are
/// per unit thickness.
#[derive(Clone, Debug, PartialEq)]
pub enum SourceKind {
    /// Force, components in N.
    Force(Vec<f64>),
    /// Couple, N·m: one component about x₃ in plane strain, three components in space.
    Couple(Vec<f64>),
    /// Moment tensor (stress glut) by rows, N·m.
    Moment(Vec<Vec<f64>>),
    /// Explosion: isotropic moment, N·m.
    Explosion(f64),
}

impl SourceKind {
    /// Names of all kinds of source in case files.
    pub const NAMES: [&str; 4] = ["force", "couple", "moment", "explosion"];

    /// Returns the name of the kind of source in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Force(_) => "force",
            Self::Couple(_) => "couple",
            Self::Moment(_) => "moment",
            Self::Explosion(_) => "explosion",
        }
    }
}

impl PointSource {
    /// Formats the section `[[source]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let resolved = TableWriter::default().with_text("kind", self.kind.name());
        let resolved = match &self.kind {
            SourceKind::Couple(couple) if couple.len() == 1 => {
                resolved.with_number("amplitude", couple[0])
            }
            SourceKind::Force(amplitude) | SourceKind::Couple(amplitude) => {
                resolved.with_number("amplitude", amplitude)
            }
            SourceKind::Moment(amplitude) => resolved.with_number("amplitude", amplitude),
            SourceKind::Explosion(amplitude) => resolved.with_number("amplitude", amplitude),
        };
        let resolved = self.kernel.write_keys(resolved.with_number("at", &self.position));
        resolved.with_table("time", &self.time_function.to_table()).to_section_toml(&SCHEMA)
    }
}

impl SolidReader<'_> {
    /// Reads all sections `[[source]]`.
    pub(super) fn read_sources(&self, root: &SectionReader) -> Result<Vec<PointSource>, CaseError> {
        let mut sources = Vec::new();
        for section in root.open_list(&SCHEMA)? {
            let action = match section.read_choice("kind", &SourceKind::NAMES, |name| name)? {
                "force" => SourceKind::Force(section.read_required("amplitude")?),
                "couple" => {
                    self.check_spin(&section, "kind", "a couple")?;
                    SourceKind::Couple(section.read_required("amplitude")?)
                }
                "moment" => SourceKind::Moment(section.read_required("amplitude")?),
                _ => SourceKind::Explosion(section.read_required("amplitude")?),
            };
            let at = self.read_point(&section)?;
            let kernel = Kernel::read(&section)?.unwrap_or_default();
            let time = self.read_time_function(&section)?;
            section.finish()?;
            sources.push(PointSource { kind: action, position: at, kernel, time_function: time });
        }
        Ok(sources)
    }

    /// Checks that the solid has spins; `what` names the refused quantity in the message.
    pub(super) fn check_spin(
        &self,
        section: &SectionReader,
        key: &str,
        what: &str,
    ) -> Result<(), CaseError> {
        if self.theory != Theory::Classical {
            return Ok(());
        }
        let found = format!("found {what} in a solid without spin");
        let allowed = "use a Cosserat solid in model.kind, or another kind here";
        Err(section.key_error(key, found, allowed))
    }
}
