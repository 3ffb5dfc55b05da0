//! The sections `[[source]]`: point sources inside the grid, and the kernels that distribute them over cells.

use super::function::{self, TimeFunction};
use super::reader::Reader;
use crate::error::CaseError;
use crate::schema::{Condition, Form, Group, Item, Length, Range, Type};
use crate::section::{Resolved, Section};
use models::solid::parameters::Theory;

const PLANE: &[Condition] = &[Condition::Plane];
const SPACE: &[Condition] = &[Condition::Space];

/// Key `kernel`: kernel of a point load or point source.
pub(super) const KERNEL: Item = Item::optional(
    "kernel",
    Type::OneOf(|_| Kernel::NAMES.map(str::to_owned).to_vec()),
    "",
    "\"bell\"",
    "over which what acts at a point is spread: spline, smooth, of a few cells; bell, with its radius; cell, the nearest one; default spline, with a radius bell",
);

/// Key `radius`: radius of the bell kernel.
pub(super) const RADIUS: Item = Item::optional(
    "radius",
    Type::Number(Range::NotNegative),
    "m",
    "2.0",
    "radius of the kernel bell; 0: the kernel cell",
)
.note("radius of the bell; 0: one cell");

/// Schema of the sections `[[source]]`.
pub(super) const FORM: Form = Form::list(
    "source",
    "a load inside the grid",
    &[
        Group::always(&[Item::required(
            "kind",
            Type::OneOf(|_| SourceKind::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"force\"",
            "what acts; a couple in Cosserat solids",
        )]),
        Group::when(
            &[Condition::Is("kind", &["force"])],
            &[
                Item::required(
                    "amplitude",
                    Type::Numbers(Length::Axes),
                    "N/m",
                    "[1e4, 0.0]",
                    "the force by components",
                )
                .note("force by components")
                .when(PLANE),
                Item::required(
                    "amplitude",
                    Type::Numbers(Length::Axes),
                    "N",
                    "[1e4, 0.0, 0.0]",
                    "the force by components",
                )
                .note("force by components")
                .when(SPACE),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["couple"])],
            &[Item::required(
                "amplitude",
                Type::Numbers(Length::Spins),
                "N·m",
                "1e4",
                "the couple, in plane strain per m; in space three numbers",
            )
            .note("couple")],
        ),
        Group::when(
            &[Condition::Is("kind", &["moment"])],
            &[Item::required(
                "amplitude",
                Type::Tensor,
                "N·m",
                "[[0.0, 1e4], [1e4, 0.0]]",
                "the moment tensor by rows, in plane strain per m",
            )
            .remark(", by rows")],
        ),
        Group::when(
            &[Condition::Is("kind", &["explosion"])],
            &[Item::required(
                "amplitude",
                Type::Number(Range::Finite),
                "N·m",
                "1e4",
                "the isotropic moment, in plane strain per m",
            )
            .note("isotropic moment")],
        ),
        Group::always(&[
            Item::required(
                "at",
                Type::Numbers(Length::Axes),
                "m",
                "[0.0, -40.0]",
                "where it acts, inside the grid",
            )
            .note("a point of the grid"),
            KERNEL,
            RADIUS,
            function::TIME,
        ]),
    ],
);

/// Point source inside the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Kind and amplitude of the source.
    pub action: SourceKind,
    /// Position, m; inside the grid.
    pub at: Vec<f64>,
    /// Kernel that distributes the source over cells.
    pub kernel: Kernel,
    /// Time function.
    pub time: TimeFunction,
}

/// Kernel that distributes a point source over cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kernel {
    /// Smooth spline kernel over a few cells: reproduces polynomials exactly and excites no two-cell waves.
    #[default]
    Spline,
    /// Cosine-bell kernel.
    Bell {
        /// Radius, m; positive.
        radius: f64,
    },
    /// Nearest cell or face only.
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
    pub(super) fn read(section: &Section) -> Result<Option<Self>, CaseError> {
        let radius: Option<f64> = section.optional("radius")?;
        let name = section.optional_choice("kernel", &Self::NAMES, |name| name)?;
        match (name, radius) {
            (None, None) => Ok(None),
            (Some("spline"), None) => Ok(Some(Self::Spline)),
            (None | Some("cell"), Some(0.0)) | (Some("cell"), None) => Ok(Some(Self::Cell)),
            (None | Some("bell"), Some(radius)) if radius > 0.0 => Ok(Some(Self::Bell { radius })),
            (Some("bell"), found) => {
                let found =
                    found.map_or("missing".to_owned(), |radius| format!("found {radius:?}"));
                let allowed = "expected a positive number in m (radius of the bell)";
                Err(section.error("radius", found, allowed))
            }
            (name, _) => {
                let found = format!("found beside kernel = \"{}\"", name.unwrap_or_default());
                Err(section.error("radius", found, "leave it out, or write kernel = \"bell\""))
            }
        }
    }

    /// Adds the keys of the kernel to a table.
    pub(super) fn resolved(self, resolved: Resolved) -> Resolved {
        let resolved = resolved.text("kernel", self.name());
        match self {
            Self::Bell { radius } => resolved.number("radius", radius),
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

impl Source {
    /// Formats the section `[[source]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let resolved = Resolved::default().text("kind", self.action.name());
        let resolved = match &self.action {
            SourceKind::Couple(couple) if couple.len() == 1 => {
                resolved.number("amplitude", couple[0])
            }
            SourceKind::Force(amplitude) | SourceKind::Couple(amplitude) => {
                resolved.number("amplitude", amplitude)
            }
            SourceKind::Moment(amplitude) => resolved.number("amplitude", amplitude),
            SourceKind::Explosion(amplitude) => resolved.number("amplitude", amplitude),
        };
        let resolved = self.kernel.resolved(resolved.number("at", &self.at));
        resolved.table("time", &self.time.resolved()).under(&FORM)
    }
}

impl Reader<'_> {
    /// Reads all sections `[[source]]`.
    pub(super) fn sources(&self, root: &Section) -> Result<Vec<Source>, CaseError> {
        let mut sources = Vec::new();
        for section in root.list(&FORM)? {
            let action = match section.choice("kind", &SourceKind::NAMES, |name| name)? {
                "force" => SourceKind::Force(section.required("amplitude")?),
                "couple" => {
                    self.need_spin(&section, "kind", "a couple")?;
                    SourceKind::Couple(section.required("amplitude")?)
                }
                "moment" => SourceKind::Moment(section.required("amplitude")?),
                _ => SourceKind::Explosion(section.required("amplitude")?),
            };
            let at = self.point_inside(&section)?;
            let kernel = Kernel::read(&section)?.unwrap_or_default();
            let time = self.function(&section)?;
            section.finish()?;
            sources.push(Source { action, at, kernel, time });
        }
        Ok(sources)
    }

    /// Checks that the solid has spins; `what` names the refused quantity in the message.
    pub(super) fn need_spin(
        &self,
        section: &Section,
        key: &str,
        what: &str,
    ) -> Result<(), CaseError> {
        if self.theory != Theory::Classical {
            return Ok(());
        }
        let found = format!("found {what} in a solid without spin");
        let allowed = "a Cosserat solid in model.kind, or another kind here";
        Err(section.error(key, found, allowed))
    }
}
