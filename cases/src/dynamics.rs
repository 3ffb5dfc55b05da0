//! What a case says of a run in time: grid, media, sides, loads, initial state and what is recorded.
//!
//! Each file has the form, the reader and the writer of one section. SI units, angles in degrees; coordinates
//! and lengths in m. Axes are counted from 0 here and from 1 in case files. In plane strain forces are per
//! unit thickness.

/// An enumeration whose variants have names in case files; the first one is the default.
macro_rules! named_enum {
    ($(#[$doc:meta])* $name:ident {
        $(#[$first_doc:meta])* $first:ident = $first_word:literal
        $(, $(#[$other_doc:meta])* $other:ident = $other_word:literal)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            #[default]
            $(#[$first_doc])* $first,
            $($(#[$other_doc])* $other),*
        }

        impl $name {
            /// All of them, the default first.
            pub const ALL: &[Self] = &[Self::$first $(, Self::$other)*];

            /// Name in case files.
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_word,
                    $(Self::$other => $other_word),*
                }
            }
        }
    };
}

// After the macro that they use.
mod boundary;
mod component;
mod function;
mod grid;
mod initial;
mod load;
pub(crate) mod output;
mod plane_pulse;
mod profile;
mod region;
mod shape;
mod source;
pub(crate) mod stress;
mod time;

pub use crate::receivers::Receiver;
pub use boundary::{Condition, Part, Side, SideCondition};
pub use component::Component;
pub use function::{Samples, TimeFunction};
pub use grid::Grid;
pub(crate) use grid::{check_dimensions, check_inside, provide_dimensions};
pub use initial::{Centre, Initial};
pub use load::{Action, Load};
pub use output::{Interpolation, Output, Picture, Recorded};
pub use plane_pulse::{PlanePulse, Polarization};
pub use profile::Profile;
pub use region::Region;
pub use shape::Shape;
pub use source::{Kernel, Source, SourceKind};
pub use stress::Gravity;
pub use time::{COURANT, Correction, Ledger, Order, Precision, Scheme, Splitting, Time};

use super::place::Places;
use super::{Case, CaseError};
use crate::Kind;
use crate::entries::Entries;
use crate::schema::{Form, Scope};
use crate::section::Section;
use boundary::periodic_sides;
use models::solid::parameters::Theory;
use std::path::Path;

/// Most cells of a grid.
pub const MOST_CELLS: usize = 4_000_000_000;

/// Most regions of a case.
pub const MOST_REGIONS: usize = u16::MAX as usize;

/// The sections, in the order in which they are written.
pub(crate) const FORMS: &[&Form] = &[
    &grid::FORM,
    &time::TIME,
    &time::SCHEME,
    &region::FORM,
    &boundary::FORM,
    &load::FORM,
    &source::FORM,
    &initial::FORM,
    &stress::INITIAL_STRESS,
    &stress::GRAVITY,
    &output::RECEIVER,
    &output::OUTPUT,
];

/// The sections of a case that say how it is run in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// The cells.
    pub grid: Grid,
    /// How long, and in which steps.
    pub time: Time,
    /// The choices of the scheme.
    pub scheme: Scheme,
    /// Parts of other media; empty: the case's own is everywhere.
    pub regions: Vec<Region>,
    /// Conditions on sides. What no entry names is free; of two that overlap the later one holds.
    pub sides: Vec<SideCondition>,
    /// Loads on sides; they add up, over the conditions.
    pub loads: Vec<Load>,
    /// Loads inside.
    pub sources: Vec<Source>,
    /// What the initial state is made of; the parts add up.
    pub initial: Vec<Initial>,
    /// Uniform initial stress: all stresses of the case, Pa and N/m.
    pub initial_stress: Vec<(Component, f64)>,
    /// Weight.
    pub gravity: Option<Gravity>,
    /// Points at which the state is recorded.
    pub receivers: Vec<Receiver>,
    /// What else is recorded.
    pub output: Output,
    places: Places,
}

impl Dynamics {
    /// What the sections of the case say besides `[grid]`.
    ///
    /// # Errors
    /// What is wrong, where, and what is allowed.
    pub(crate) fn read(
        grid: Grid,
        case: &Case,
        entries: &Entries,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        check_dimensions(&entries.places, case.kind, case.numbers.dimensions, &grid)?;
        let theory = match case.kind {
            Kind::Solid(solid) => solid.theory,
            Kind::Flow(_) => Theory::Classical, // refused with its grid
        };
        let components = Component::all(theory, grid.dimensions());
        let reader = Reader { grid: &grid, theory, components, folder };
        let root = entries.structured(Scope {
            kind: Some(case.kind),
            dimensions: Some(grid.dimensions()),
            axes: Vec::new(),
        });
        let regions = reader.regions(&root, case, entries)?;
        let sides = reader.sides(&root)?;
        let periodic: Vec<Side> = periodic_sides(&sides).map(|(_, side)| side).collect();
        let (loads, sources) = (reader.loads(&root, &periodic)?, reader.sources(&root)?);
        let yields = match regions.as_slice() {
            [] => case.yields.is_some(),
            regions => regions.iter().any(|region| region.case.yields.is_some()),
        };
        let output = reader.output(&root, yields)?;
        let time = Time::read(&root)?;
        Ok(Self {
            scheme: Scheme::read(&root, time.courant, yields)?,
            time,
            regions,
            sides,
            loads,
            sources,
            initial: reader.initial(&root)?,
            initial_stress: reader.initial_stress(&root)?,
            gravity: Gravity::read(&root)?,
            receivers: reader.receivers(&root, &output.integrals)?,
            output,
            grid: grid.clone(),
            places: entries.places.clone(),
        })
    }

    /// The sections as TOML: every value, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let d = self.grid.dimensions();
        let mut text = self.grid.to_toml() + &self.time.to_toml() + &self.scheme.to_toml();
        text.extend(self.regions.iter().map(|region| region.to_toml(d)));
        text.extend(self.sides.iter().map(SideCondition::to_toml));
        text.extend(self.loads.iter().map(|load| load.to_toml(d)));
        text.extend(self.sources.iter().map(Source::to_toml));
        text.extend(self.initial.iter().map(|part| part.to_toml(d)));
        text += &stress::to_toml(&self.initial_stress);
        text.extend(self.gravity.iter().map(Gravity::to_toml));
        text.extend(self.receivers.iter().map(Receiver::to_toml));
        text + &self.output.to_toml()
    }

    /// An error at a key of these sections, as in `load[0].amplitude`; indices from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }
}

/// What all entries are read with.
struct Reader<'a> {
    grid: &'a Grid,
    theory: Theory,
    /// Those of the case's solid.
    components: Vec<Component>,
    /// The folder of the case file.
    folder: &'a Path,
}

impl Reader<'_> {
    fn dimensions(&self) -> usize {
        self.grid.dimensions()
    }

    /// The point `at`, which must be in the grid.
    fn point_inside(&self, section: &Section) -> Result<Vec<f64>, CaseError> {
        let at: Vec<f64> = section.required("at")?;
        let axes: Vec<usize> = (0..self.dimensions()).collect();
        self.check_inside(section, &at, &axes)?;
        Ok(at)
    }

    /// That a position along some axes is in the grid.
    fn check_inside(
        &self,
        section: &Section,
        position: &[f64],
        axes: &[usize],
    ) -> Result<(), CaseError> {
        let extents: Vec<[f64; 2]> = axes.iter().map(|&axis| self.grid.extent(axis)).collect();
        check_inside(section, "at", position, axes, &extents, "grid")
    }

    /// The component that the key `field` names.
    fn component(&self, section: &Section, among: &[Component]) -> Result<Component, CaseError> {
        let names = names(among);
        let name = section.required_text("field", &names)?;
        Component::find(&name, self.theory, among)
            .ok_or_else(|| section.no_such("field", &name, &names))
    }
}

/// Names in case files.
fn names(components: &[Component]) -> Vec<String> {
    components.iter().map(Component::to_string).collect()
}

/// The components that a solid has, or any where it is not known which.
fn components(scope: &Scope) -> Vec<Component> {
    let theory = match scope.kind {
        Some(Kind::Solid(solid)) => solid.theory,
        _ => Theory::Cosserat,
    };
    Component::all(theory, scope.dimensions.unwrap_or(3))
}
