//! From the sections of a case to what it says of a run in time.

use super::{
    Action, Centre, Component, Condition, Correction, Dynamics, Gravity, Grid, Initial, Kernel,
    Ledger, Load, MOST_CELLS, MOST_REGIONS, Order, Output, Part, Picture, PlanePulse, Precision,
    Profile, Receiver, Recorded, Region, Samples, Scheme, Shape, Side, SideCondition, Source,
    SourceKind, Splitting, Time, TimeFunction,
};
use crate::error::{CaseError, Place, shown};
use crate::keys::{Key, Value};
use crate::place::Places;
use crate::read::Entries;
use crate::receivers::{Domain, receivers};
use crate::section::{
    Node, Section, any_numbers, cells, count, joined, matrix, not_negative, number, numbers,
    positive, rows, spacing, text, texts, truth,
};
use crate::{Case, Kind};
use models::cosserat::parameters::Theory;
use models::cosserat::waves::Field;
use std::io::Read;
use std::path::Path;

/// Largest table of a function of time, bytes.
const LARGEST_TABLE: u64 = 64 << 20;

const DURATION: &str = "a positive number in s (how long it lasts)";
const START: &str = "a finite number in s (when it begins)";
const FREQUENCY: &str = "a positive number in Hz (frequency)";

/// The section `[grid]` of a solid.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn grid(entries: &Entries) -> Result<Grid, CaseError> {
    let mut root = entries.structured();
    let mut section = root.required_table("grid", "a section [grid] with cells and spacing")?;
    if section.node("length").is_some() {
        let allowed = "give spacing, the edges of a cell in m, in its place";
        return Err(section.error("length", "found for a solid", allowed));
    }
    let expected = "a list of 2 or 3 whole numbers of at least 1 (cells along each axis)";
    let cells = section.required("cells", expected, cells)?;
    let d = cells.len();
    let total = cells.iter().try_fold(1usize, |total, &cells| total.checked_mul(cells));
    if total.is_none_or(|total| total > MOST_CELLS) {
        let found = format!("a grid of {}", joined_by(&cells, " × "));
        let allowed = format!("expected at most {MOST_CELLS} cells in all");
        return Err(section.error("cells", found, allowed));
    }
    let expected =
        format!("a positive number or a list of {d} positive numbers in m (edges of a cell)");
    let spacing = section.required("spacing", &expected, spacing(d))?;
    let expected = format!("a list of {d} finite numbers in m (corner of least coordinates)");
    let origin = section.optional("origin", &expected, numbers(d))?.unwrap_or(vec![0.0; d]);
    let grid = Grid { cells, spacing, origin };
    for axis in 0..d {
        let [first, last] = grid.extent(axis);
        let largest = first.abs().max(last.abs());
        // Centres of neighbours must differ, and halves of cells as well.
        if !largest.is_finite() || grid.spacing[axis] <= 8.0 * f64::EPSILON * largest {
            let found = format!("cells of {:?} m from {first:?} to {last:?}", grid.spacing[axis]);
            let allowed = format!("expected coordinates that tell cells apart along x{}", axis + 1);
            return Err(section.error("spacing", found, allowed));
        }
    }
    section.finish()?;
    Ok(grid)
}

fn joined_by(numbers: &[usize], between: &str) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(between)
}

/// Gives a solid the dimensions of the grid if it has none of its own.
pub(crate) fn provide_dimensions(entries: &mut Entries, kind: Kind, grid: &Grid) {
    const KEY: &str = "model.dimensions";
    if Key::find(KEY).is_some_and(|key| key.is_used_by(kind)) {
        entries.provide(KEY, Value::Count(grid.dimensions()));
    }
}

/// That a solid has the dimensions of the grid.
pub(crate) fn check_dimensions(
    places: &Places,
    kind: Kind,
    dimensions: usize,
    grid: &Grid,
) -> Result<(), CaseError> {
    let d = grid.dimensions();
    if matches!(kind, Kind::Solid(solid) if solid.is_plane) {
        let found = format!("found {} in a grid of {d} dimensions", kind.name());
        let allowed = "it is a solid in plane strain: grid.cells must have 2 entries";
        return if d == 2 { Ok(()) } else { Err(places.error("model.kind", found, allowed)) };
    }
    if dimensions != d {
        let found = format!("found {dimensions} in a grid of {d} dimensions");
        let allowed = format!("give as many as entries of grid.cells, {d}, or leave it out");
        return Err(places.error("model.dimensions", found, allowed));
    }
    Ok(())
}

/// What the sections of the case say besides `[grid]`.
///
/// # Errors
/// What is wrong, where, and what is allowed.
pub(crate) fn read(
    grid: Grid,
    case: &Case,
    entries: &Entries,
    folder: &Path,
) -> Result<Dynamics, CaseError> {
    check_dimensions(&entries.places, case.kind, case.numbers.dimensions, &grid)?;
    let theory = match case.kind {
        Kind::Solid(solid) => solid.theory,
        Kind::Flow(_) => Theory::Classical, // refused with its grid
    };
    let components = Component::all(theory, grid.dimensions());
    let reader = Reader { grid: &grid, theory, components, folder };
    let mut root = entries.structured();
    let regions = reader.regions(&mut root, case, entries)?;
    let sides = reader.sides(&mut root)?;
    let periodic: Vec<Side> = periodic_sides(&sides).map(|(_, side)| side).collect();
    let (loads, sources) = (reader.loads(&mut root, &periodic)?, reader.sources(&mut root)?);
    let yields = match regions.as_slice() {
        [] => case.yields.is_some(),
        regions => regions.iter().any(|region| region.case.yields.is_some()),
    };
    let output = reader.output(&mut root, yields)?;
    let time = time(&mut root)?;
    let dynamics = Dynamics {
        scheme: scheme(&mut root, time.courant, yields)?,
        time,
        regions,
        sides,
        loads,
        sources,
        initial: reader.initial(&mut root)?,
        initial_stress: reader.initial_stress(&mut root)?,
        gravity: reader.gravity(&mut root)?,
        receivers: reader.receivers(&mut root, &output.integrals)?,
        output,
        grid: grid.clone(),
        places: entries.places.clone(),
    };
    Ok(dynamics)
}

fn time(root: &mut Section) -> Result<Time, CaseError> {
    let expected = "a section [time] with duration in s";
    let mut section = root.required_table("time", expected)?;
    let duration = section.required("duration", "a positive number in s", positive)?;
    let is_stable = |node: &Node| positive(node).filter(|courant| *courant <= 1.0);
    let expected = "a number above 0 and at most 1 (Courant number): a sweep is unstable above 1";
    let courant = section.optional("courant", expected, is_stable)?.unwrap_or(COURANT);
    let is_turn = |node: &Node| positive(node).filter(|angle| *angle <= 180.0);
    let expected = "a number above 0 and at most 180 in degrees: by how much a step may turn spins \
                    against antisymmetric stress";
    let rotation_deg = section.optional("rotation_deg", expected, is_turn)?.unwrap_or(30.0);
    section.finish()?;
    Ok(Time { duration, courant, rotation_deg })
}

/// The default Courant number: at 1 nothing damps waves of two cells along an axis; below 0.87 a run would cost more
/// than 15 % more.
pub const COURANT: f64 = 0.9;

/// By default waves are reconstructed to fourth order, but where something yields, as plastic fronts are steps. Sweeps
/// alternate, but where waves are to move by whole cells exactly, or a correction in the middle of the step needs one.
fn scheme(root: &mut Section, courant: f64, yields: bool) -> Result<Scheme, CaseError> {
    let order = if yields { Order::Eno2 } else { Order::FourthOrder };
    let default = |correction: Correction| match correction {
        Correction::FirstOrder if courant < 1.0 => Splitting::Alternating,
        _ => Splitting::TwoCyclic,
    };
    let Some(mut section) = root.table("scheme")? else {
        let splitting = default(Correction::default());
        return Ok(Scheme { order, splitting, ..Scheme::default() });
    };
    let correction = section
        .optional_choice("correction", Correction::ALL, Correction::name)?
        .unwrap_or_default();
    let splittings: &[Splitting] = match correction {
        Correction::FirstOrder => Splitting::ALL,
        Correction::SecondOrder => &[Splitting::TwoCyclic],
    };
    let scheme = Scheme {
        order: section.optional_choice("order", Order::ALL, Order::name)?.unwrap_or(order),
        correction,
        splitting: section
            .optional_choice("splitting", splittings, Splitting::name)?
            .unwrap_or(default(correction)),
        precision: section
            .optional_choice("precision", Precision::ALL, Precision::name)?
            .unwrap_or_default(),
        ledger: section.optional_choice("ledger", Ledger::ALL, Ledger::name)?.unwrap_or_default(),
    };
    section.finish()?;
    Ok(scheme)
}

/// Sides that are periodic when all entries are read, with the entry that says so.
fn periodic_sides(sides: &[SideCondition]) -> impl Iterator<Item = (usize, Side)> {
    let is_last_whole = |index: usize, side: Side| {
        !sides[index + 1..].iter().any(|later| later.side == side && later.part.is_none())
    };
    sides
        .iter()
        .enumerate()
        .filter(move |(index, entry)| {
            entry.condition == Condition::Periodic && is_last_whole(*index, entry.side)
        })
        .map(|(index, entry)| (index, entry.side))
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

    /// A point in the whole space.
    fn point(
        &self,
        section: &mut Section,
        name: &'static str,
        meaning: &str,
    ) -> Result<Vec<f64>, CaseError> {
        let d = self.dimensions();
        let expected = format!("a list of {d} finite numbers in m ({meaning})");
        section.required(name, &expected, numbers(d))
    }

    /// The point `at`, which must be in the grid.
    fn point_inside(&self, section: &mut Section, meaning: &str) -> Result<Vec<f64>, CaseError> {
        let at = self.point(section, "at", meaning)?;
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

    /// An axis by its number in the file; from 0.
    fn axis(&self, section: &mut Section) -> Result<usize, CaseError> {
        let d = self.dimensions();
        let expected = format!("a whole number from 1 to {d} (an axis)");
        let axis = |node: &Node| count(node).filter(|axis| *axis <= d);
        Ok(section.required("axis", &expected, axis)? - 1)
    }

    fn component(
        &self,
        section: &mut Section,
        among: &[Component],
    ) -> Result<Component, CaseError> {
        let names = names(among);
        let expected = format!("one of {}", joined(&names));
        let name = section.required("field", &expected, text)?;
        self.find(section, "field", &name, among)
    }

    fn find(
        &self,
        section: &Section,
        key: &str,
        name: &str,
        among: &[Component],
    ) -> Result<Component, CaseError> {
        Component::find(name, self.theory, among)
            .ok_or_else(|| section.no_such(key, name, &names(among)))
    }

    /// A shape; `extra` is the one without keys that is allowed here.
    fn shape(&self, section: &mut Section, extra: &Shape) -> Result<Shape, CaseError> {
        let d = self.dimensions();
        let named = |d: usize| match d {
            2 => ["box", "circle", "layer", "half-plane", extra.name(d)],
            _ => ["box", "sphere", "layer", "half-space", extra.name(d)],
        };
        let (names, others) = (named(d), named(5 - d));
        let found = section.node("shape").and_then(text).unwrap_or_default();
        if let Some(index) = others.iter().position(|other| *other == found)
            && names[index] != found
        {
            let found = format!("found '{found}' in a grid of {d} dimensions");
            return Err(section.error("shape", found, format!("write {}", names[index])));
        }
        let index = section.choice("shape", &[0, 1, 2, 3, 4], |index: usize| names[index])?;
        Ok(match index {
            0 => {
                let from = self.point(section, "from", "corner of least coordinates")?;
                let to = self.point(section, "to", "corner of greatest coordinates")?;
                check_order(section, &from, &to)?;
                Shape::Box { from, to }
            }
            1 => Shape::Ball {
                center: self.point(section, "center", "centre")?,
                radius: section.required("radius", "a positive number in m", positive)?,
            },
            2 => {
                let axis = self.axis(section)?;
                let expected = "a finite number in m (a coordinate along the axis)";
                let from = section.required("from", expected, number)?;
                let to = section.required("to", expected, number)?;
                check_order(section, &[from], &[to])?;
                Shape::Layer { axis, from, to }
            }
            3 => {
                let point = self.point(section, "point", "a point of the edge")?;
                let expected = format!("a list of {d} numbers, not all 0 (points into the shape)");
                let is_normal =
                    |node: &Node| numbers(d)(node).filter(|n| n.iter().any(|n| *n != 0.0));
                Shape::HalfSpace {
                    point,
                    normal: section.required("normal", &expected, is_normal)?,
                }
            }
            _ => extra.clone(),
        })
    }

    fn regions(
        &self,
        root: &mut Section,
        case: &Case,
        entries: &Entries,
    ) -> Result<Vec<Region>, CaseError> {
        let sections = root.tables("region")?;
        if sections.len() > MOST_REGIONS {
            let allowed = format!("expected at most {MOST_REGIONS}");
            return Err(root.error("region", format!("{} regions", sections.len()), allowed));
        }
        let mut regions: Vec<Region> = Vec::new();
        let mut rest: Option<usize> = None;
        for (index, mut section) in sections.into_iter().enumerate() {
            let shape = self.shape(&mut section, &Shape::Rest)?;
            if shape == Shape::Rest
                && let Some(first) = rest.replace(index)
            {
                let place = entries.places.of(&format!("region[{first}]"));
                let found = format!("a second rest besides region[{first}] ({place})");
                return Err(section.error("shape", found, "give one region the rest"));
            }
            let case = case.of_region(entries, &mut section, self.grid)?;
            section.finish()?;
            regions.push(Region { shape, case });
        }
        Ok(regions)
    }

    fn side(&self, section: &mut Section) -> Result<Side, CaseError> {
        section.choice("side", &Side::all(self.dimensions()), Side::name)
    }

    /// The part of a side between `from` and `to`, if they are given.
    fn part(&self, section: &mut Section, side: Side) -> Result<Option<Part>, CaseError> {
        let axes = side.axes(self.dimensions());
        let expected = along(&axes, "an end of the part");
        let ends = ["from", "to"];
        let [from, to] = ends.map(|end| section.optional(end, &expected, numbers(axes.len())));
        match (from?, to?) {
            (Some(from), Some(to)) => {
                check_order(section, &from, &to)?;
                Ok(Some(Part { from, to }))
            }
            (None, None) => Ok(None),
            (from, _) => {
                let absent = if from.is_none() { "from" } else { "to" };
                Err(section.error(absent, "missing", "give both ends of a part, from and to"))
            }
        }
    }

    fn sides(&self, root: &mut Section) -> Result<Vec<SideCondition>, CaseError> {
        let mut sides = Vec::new();
        for mut section in root.tables("side")? {
            let side = self.side(&mut section)?;
            let condition = match section.choice("kind", &Condition::NAMES, |name| name)? {
                "free" => Condition::Free,
                "fixed" => Condition::Fixed,
                "symmetry" => Condition::Symmetry,
                "antisymmetry" => Condition::Antisymmetry,
                "periodic" => Condition::Periodic,
                "non-reflecting" => Condition::NonReflecting,
                _ => Condition::Mixed { held: self.held(&mut section, side)? },
            };
            let part = match condition {
                Condition::Periodic => None,
                _ => self.part(&mut section, side)?,
            };
            section.finish()?;
            sides.push(SideCondition { side, condition, part });
        }
        let periodic: Vec<(usize, Side)> = periodic_sides(&sides).collect();
        let is_periodic = |side: Side| periodic.iter().any(|(_, own)| *own == side);
        for (index, side) in &periodic {
            let (own, across) = (side.name(), side.opposite().name());
            if !is_periodic(side.opposite()) {
                let found = format!("found periodic on {own} alone");
                let allowed = format!("add [[side]] with side = \"{across}\", kind = \"periodic\"");
                return Err(root.error(&format!("side[{index}].kind"), found, allowed));
            }
        }
        let is_part = |entry: &SideCondition| entry.part.is_some() && is_periodic(entry.side);
        if let Some(index) = sides.iter().position(is_part) {
            let found = format!("found a part of {}, which is periodic", sides[index].side.name());
            let allowed = "leave the part out: a side is periodic as a whole";
            return Err(root.error(&format!("side[{index}].side"), found, allowed));
        }
        Ok(sides)
    }

    /// The velocities and spins that vanish on a mixed side.
    fn held(&self, section: &mut Section, side: Side) -> Result<Vec<Component>, CaseError> {
        let mut among = Component::on_side(self.theory, self.dimensions(), side.axis);
        among.retain(|component| component.is_velocity());
        let names = names(&among);
        let find = |name: &str| Component::find(name, self.theory, &among);
        different(section, "held", &names, find)?.ok_or_else(|| {
            let allowed = format!("add held, a list with any of {}", joined(&names));
            section.error("held", "missing", allowed)
        })
    }

    fn loads(&self, root: &mut Section, periodic: &[Side]) -> Result<Vec<Load>, CaseError> {
        let mut loads = Vec::new();
        for mut section in root.tables("load")? {
            let side = self.side(&mut section)?;
            if periodic.contains(&side) {
                let found = format!("found {}, which is periodic", side.name());
                let allowed = "a periodic side has no load; give [[source]], or another side";
                return Err(section.error("side", found, allowed));
            }
            let among = Component::on_side(self.theory, self.dimensions(), side.axis);
            let field = self.component(&mut section, &among)?;
            let expected = "a finite number in m/s, rad/s, Pa or N/m (what time is multiplied by)";
            let amplitude = section.required("amplitude", expected, number)?;
            let action = self.action(&mut section, side, field)?;
            let profile = match action {
                Action::Point { .. } if section.get("profile").is_some() => {
                    let allowed = "leave it out: what acts at a point has a kernel; a profile goes \
                                   with from and to, or with all of the side";
                    return Err(section.error("profile", "found beside at", allowed));
                }
                Action::Point { .. } => None,
                _ => Profile::read(&mut section, &side.axes(self.dimensions()))?,
            };
            let time = self.function(&mut section)?;
            section.finish()?;
            loads.push(Load { side, field, amplitude, action, profile, time });
        }
        Ok(loads)
    }

    /// Where a load acts.
    fn action(
        &self,
        section: &mut Section,
        side: Side,
        field: Component,
    ) -> Result<Action, CaseError> {
        let part = self.part(section, side)?;
        let axes = side.axes(self.dimensions());
        let expected = along(&axes, "a point of the side");
        let at = section.optional("at", &expected, numbers(axes.len()))?;
        let kernel = kernel(section)?;
        match (part, at) {
            (Some(_), Some(_)) => {
                let allowed = "give one of the two, a part or a point of the side";
                Err(section.error("at", "found beside from and to", allowed))
            }
            (_, Some(_)) if field.is_velocity() => {
                let allowed = "a stress or couple stress, or from and to in place of at";
                Err(section.error("at", format!("found for the velocity {field}"), allowed))
            }
            (None, Some(at)) => {
                self.check_inside(section, &at, &axes)?;
                Ok(Action::Point { at, kernel: kernel.unwrap_or_default() })
            }
            (_, None) if kernel.is_some() => {
                let key = if section.node("radius").is_some() { "radius" } else { "kernel" };
                let allowed = "add at, the point that it is about, or leave it out";
                Err(section.error(key, "found without at", allowed))
            }
            (Some(part), None) => Ok(Action::Part(part)),
            (None, None) => Ok(Action::Whole),
        }
    }

    fn sources(&self, root: &mut Section) -> Result<Vec<Source>, CaseError> {
        let mut sources = Vec::new();
        for mut section in root.tables("source")? {
            let action = self.source_kind(&mut section)?;
            let at = self.point_inside(&mut section, "a point of the grid")?;
            let kernel = kernel(&mut section)?.unwrap_or_default();
            let time = self.function(&mut section)?;
            section.finish()?;
            sources.push(Source { action, at, kernel, time });
        }
        Ok(sources)
    }

    fn source_kind(&self, section: &mut Section) -> Result<SourceKind, CaseError> {
        let d = self.dimensions();
        let kind = section.choice("kind", &SourceKind::NAMES, |name| name)?;
        if kind == "couple" {
            self.need_spin(section, "kind", "a couple")?;
        }
        let mut amplitude = |length: usize, meaning: &str| {
            let expected = format!("{} in {meaning}", list_of(length));
            section.required("amplitude", &expected, numbers(length))
        };
        Ok(match kind {
            "force" if d == 2 => SourceKind::Force(amplitude(d, "N/m (force by components)")?),
            "force" => SourceKind::Force(amplitude(d, "N (force by components)")?),
            "couple" => SourceKind::Couple(amplitude(if d == 2 { 1 } else { 3 }, "N·m (couple)")?),
            "moment" => {
                let expected = format!("a matrix of {d} by {d} finite numbers in N·m, by rows");
                SourceKind::Moment(section.required("amplitude", &expected, matrix(d))?)
            }
            _ => {
                let expected = "a finite number in N·m (isotropic moment)";
                SourceKind::Explosion(section.required("amplitude", expected, number)?)
            }
        })
    }

    /// That the solid has spins.
    fn need_spin(&self, section: &Section, key: &str, what: &str) -> Result<(), CaseError> {
        if self.theory != Theory::Classical {
            return Ok(());
        }
        let found = format!("found {what} in a solid without spin");
        let allowed = "a Cosserat solid in model.kind, or another kind here";
        Err(section.error(key, found, allowed))
    }

    fn initial(&self, root: &mut Section) -> Result<Vec<Initial>, CaseError> {
        let mut parts = Vec::new();
        for mut section in root.tables("initial")? {
            let part = match section.choice("kind", &Initial::NAMES, |name| name)? {
                "pulse" => self.pulse(&mut section)?,
                "plane-wave" => self.plane_wave(&mut section)?,
                "plane-pulse" => {
                    let at = self.point_inside(&mut section, "a point of the grid")?;
                    let time = self.function(&mut section)?;
                    let d = self.dimensions();
                    Initial::PlanePulse(PlanePulse::read(&mut section, d, at, time)?)
                }
                "rotation" => self.rotation(&mut section)?,
                _ => Initial::Uniform {
                    shape: self.shape(&mut section, &Shape::Everywhere)?,
                    field: self.component(&mut section, &self.components)?,
                    amplitude: amplitude_of_field(&mut section)?,
                },
            };
            section.finish()?;
            parts.push(part);
        }
        Ok(parts)
    }

    fn pulse(&self, section: &mut Section) -> Result<Initial, CaseError> {
        let field = self.component(section, &self.components)?;
        let amplitude = amplitude_of_field(section)?;
        let centre = if section.node("axis").is_some() {
            let axis = self.axis(section)?;
            let expected = "a finite number in m (the plane, along the axis)";
            Centre::Plane { axis, at: section.required("at", expected, number)? }
        } else {
            section.get("axis");
            Centre::Point(self.point(section, "at", "where it is greatest")?)
        };
        let radius = section.required("radius", "a positive number in m", positive)?;
        Ok(Initial::Pulse { field, amplitude, centre, radius })
    }

    fn plane_wave(&self, section: &mut Section) -> Result<Initial, CaseError> {
        // As many as velocities and spins.
        let branches = self.components.iter().filter(|c| c.is_velocity()).count();
        let expected = format!("a whole number from 1 to {branches} (1 is the greatest frequency)");
        let is_branch = |node: &Node| count(node).filter(|branch| *branch <= branches);
        let branch = section.required("branch", &expected, is_branch)?;
        let expected = "a finite number in degrees";
        let direction_deg = section.optional("direction_deg", expected, number)?.unwrap_or(0.0);
        let elevation_deg = match self.dimensions() {
            2 => 0.0,
            _ => section.optional("elevation_deg", expected, number)?.unwrap_or(0.0),
        };
        Ok(Initial::PlaneWave {
            branch,
            direction_deg,
            elevation_deg,
            wavelength: section.required("wavelength", "a positive number in m", positive)?,
            amplitude: section.required("amplitude", "a finite number in m/s", number)?,
        })
    }

    fn rotation(&self, section: &mut Section) -> Result<Initial, CaseError> {
        self.need_spin(section, "kind", "a microrotation")?;
        let shape = self.shape(section, &Shape::Everywhere)?;
        let angle_deg = section.required("angle_deg", "a finite number in degrees", number)?;
        let is_axis = |node: &Node| count(node).filter(|axis| *axis <= 3);
        let axis = match self.dimensions() {
            2 => None,
            _ => section.optional("about", "1, 2 or 3 (axis of the rotation)", is_axis)?,
        };
        Ok(Initial::Rotation { shape, angle_deg, axis: axis.map_or(2, |axis| axis - 1) })
    }

    fn initial_stress(&self, root: &mut Section) -> Result<Vec<(Component, f64)>, CaseError> {
        let is_stress = |component: &&Component| !component.is_velocity();
        let stresses: Vec<Component> = self.components.iter().filter(is_stress).copied().collect();
        let mut values: Vec<(Component, Option<f64>)> =
            stresses.iter().map(|&component| (component, None)).collect();
        if let Some(section) = root.table("initial_stress")? {
            for (name, node) in section.entries() {
                let Some(component) = Component::find(name, self.theory, &stresses) else {
                    return Err(section.unknown(name, &names(&stresses)));
                };
                let Some(value) = number(node) else {
                    let unit = if matches!(component.0, Field::Couple(..)) { "N/m" } else { "Pa" };
                    let allowed = format!("expected a finite number in {unit}");
                    return Err(section.error(name, format!("found {}", node.words()), allowed));
                };
                for (_, slot) in values.iter_mut().filter(|(own, _)| *own == component) {
                    if slot.replace(value).is_some() {
                        let found = format!("a second value of {component}");
                        let allowed = "give one: shear stresses of a classical solid are equal";
                        return Err(section.error(name, found, allowed));
                    }
                }
            }
        }
        Ok(values.into_iter().map(|(stress, value)| (stress, value.unwrap_or(0.0))).collect())
    }

    fn gravity(&self, root: &mut Section) -> Result<Option<Gravity>, CaseError> {
        let Some(mut section) = root.table("gravity")? else { return Ok(None) };
        let d = self.dimensions();
        let expected = format!("a list of {d} finite numbers in m/s²");
        let acceleration = section.required("acceleration", &expected, numbers(d))?;
        let given = section.optional("balanced", "true or false", truth)?;
        let axes = acceleration.iter().filter(|a| **a != 0.0).count();
        let is_balanced = given.unwrap_or(true);
        if is_balanced && axes != 1 {
            let stated = if given.is_none() { ", the default," } else { "" };
            let found = format!("found true{stated} with the acceleration {acceleration:?}");
            let allowed = "give an acceleration along one axis, or set balanced = false";
            return Err(section.error("balanced", found, allowed));
        }
        let expected = "a number of at least 0 (stress across the weight over that along it)";
        let lateral_ratio =
            section.optional("lateral_ratio", expected, not_negative)?.unwrap_or(1.0);
        section.finish()?;
        Ok(Some(Gravity { acceleration, is_balanced, lateral_ratio }))
    }

    fn receivers(
        &self,
        root: &mut Section,
        integrals: &[Component],
    ) -> Result<Vec<Receiver>, CaseError> {
        let all: Vec<Recorded> = (self.components.iter().copied().map(Recorded::Component))
            .chain(integrals.iter().copied().map(Recorded::Integral))
            .collect();
        let find = |name: &str| {
            let component = Component::find(name, self.theory, &self.components);
            let integral = || all.iter().copied().find(|own| own.to_string() == name);
            component.map(Recorded::Component).or_else(integral)
        };
        let extents: Vec<[f64; 2]> = (0..self.dimensions()).map(|a| self.grid.extent(a)).collect();
        receivers(root, &all, find, &Domain { extents, whole: "grid", interpolates: true })
    }

    /// What is recorded and drawn, of media of which one `yields` or none.
    fn output(&self, root: &mut Section, yields: bool) -> Result<Output, CaseError> {
        let mut output = Output {
            ledger_interval: 0.0,
            snapshot_interval: 0.0,
            integrals: Vec::new(),
            picture: Picture::Speed,
            contours: None,
        };
        let Some(mut section) = root.table("output")? else { return Ok(output) };
        [output.ledger_interval, output.snapshot_interval] =
            intervals(&mut section, "0: at most 1000 lines")?;
        let possible: Vec<(String, Component)> = self
            .components
            .iter()
            .filter_map(|component| Some((component.integral()?, *component)))
            .collect();
        let words: Vec<String> = possible.iter().map(|own| own.0.clone()).collect();
        let find = |name: &str| possible.iter().find(|own| own.0 == name).map(|own| own.1);
        output.integrals = different(&mut section, "integrals", &words, find)?.unwrap_or_default();
        let mut pictures = vec![Picture::Speed];
        pictures.extend(self.components.iter().copied().map(Picture::Component));
        pictures.extend(output.integrals.iter().copied().map(Picture::Integral));
        pictures.push(Picture::Dissipation);
        let words: Vec<String> = pictures.iter().map(|picture| picture.name()).collect();
        let expected = format!("one of {}", joined(&words));
        if let Some(name) = section.optional("picture", &expected, text)? {
            let own = pictures.iter().copied().find(|picture| picture.name() == name);
            let component = Component::find(&name, self.theory, &self.components);
            let own = own.or(component.map(Picture::Component));
            output.picture = own.ok_or_else(|| section.no_such("picture", &name, &words))?;
        }
        if output.picture == Picture::Dissipation && !yields {
            let allowed = "another picture, or a section [yield]";
            return Err(section.error("picture", "found 'dissipation' in elastic media", allowed));
        }
        let expected = "a list of finite numbers in the unit of the picture (lines of equal value)";
        output.contours = section.optional("contours", expected, any_numbers)?;
        section.finish()?;
        Ok(output)
    }

    /// The table `time` of a load or source.
    fn function(&self, section: &mut Section) -> Result<TimeFunction, CaseError> {
        let expected =
            format!("a table {{ kind = ..., ... }} (kind: {})", TimeFunction::NAMES.join(", "));
        let mut section = section.required_table("time", &expected)?;
        let kind = section.choice("kind", &TimeFunction::NAMES, |name| name)?;
        let start = |section: &mut Section| {
            section.optional("start", START, number).map(|start| start.unwrap_or(0.0))
        };
        let function = match kind {
            "step" => TimeFunction::Step {
                start: start(&mut section)?,
                duration: section.optional("duration", DURATION, positive)?,
            },
            "triangle" => TimeFunction::Triangle {
                start: start(&mut section)?,
                duration: section.required("duration", DURATION, positive)?,
            },
            "pulse" => TimeFunction::Pulse {
                start: start(&mut section)?,
                duration: section.required("duration", DURATION, positive)?,
            },
            "ricker" => {
                // The delay that follows from it must be a number as well.
                let is_usable = |node: &Node| positive(node).filter(|f| (1.5 / f).is_finite());
                let frequency = section.required("frequency", FREQUENCY, is_usable)?;
                let expected = "a finite number in s (when it is greatest)";
                let delay = section.optional("delay", expected, number)?;
                TimeFunction::Ricker { frequency, delay: delay.unwrap_or(1.5 / frequency) }
            }
            "sine" => TimeFunction::Sine {
                frequency: section.required("frequency", FREQUENCY, positive)?,
                start: start(&mut section)?,
            },
            _ => TimeFunction::Table(self.samples(&mut section)?),
        };
        section.finish()?;
        Ok(function)
    }

    /// The samples of a table, or of the file that it names.
    fn samples(&self, section: &mut Section) -> Result<Samples, CaseError> {
        const NEEDS: &str = "name a CSV file of two columns, time in s and value, in a folder as \
                             seen from that of the case";
        const FEW: &str = "expected at least two lines of a time in s and a value";
        const BESIDE: &str = "a list of at least two pairs [time in s, value], times increasing";
        let usable = |node: &Node| {
            let pairs = rows(node)?;
            Samples::new(pairs)
        };
        if let Some(samples) = section.optional("samples", BESIDE, usable)? {
            return Ok(samples);
        }
        let expected = format!("text in quotes ({NEEDS}), or samples = [[t, value], ...]");
        let file = section.required("file", &expected, text)?;
        let path = self.folder.join(&file);
        let unreadable =
            |cause: &str| section.error("file", format!("'{}': {cause}", shown(&file)), NEEDS);
        // A pipe that nobody writes to would be waited for.
        if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
            return Err(unreadable("not a regular file"));
        }
        let mut bytes = Vec::new();
        std::fs::File::open(&path)
            .and_then(|file| file.take(LARGEST_TABLE + 1).read_to_end(&mut bytes))
            .map_err(|error| unreadable(&error.to_string()))?;
        if bytes.len() as u64 > LARGEST_TABLE {
            return Err(unreadable("larger than 64 MiB"));
        }
        let text = std::str::from_utf8(&bytes).map_err(|_| unreadable("not UTF-8 text"))?;
        let samples = parse_samples(text).map_err(|(line, found, allowed)| CaseError::Key {
            place: Place::Line { file: path.display().to_string(), line },
            key: section.key("file"),
            found,
            allowed: allowed.to_owned(),
        })?;
        let found = format!("'{}' has {}", shown(&file), plural(samples.len(), "sample"));
        Samples::new(samples).ok_or_else(|| section.error("file", found, FEW))
    }
}

/// What a coordinate may lie beyond a side, over the length of the grid: cells × spacing + origin misses the decimal that
/// is meant by rounding (100 × 0.29 is less than 29).
pub(crate) const SLACK: f64 = 1e-12;

/// That a position along some axes, the value of a key, is between first and last coordinates, those of the
/// grid or box.
pub(crate) fn check_inside(
    section: &Section,
    key: &str,
    position: &[f64],
    axes: &[usize],
    extents: &[[f64; 2]],
    whole: &str,
) -> Result<(), CaseError> {
    let is_inside = |(x, [first, last]): (&f64, &[f64; 2])| {
        let slack = SLACK * (last - first);
        (first - slack..=last + slack).contains(x)
    };
    if position.iter().zip(extents).all(is_inside) {
        return Ok(());
    }
    // Without what rounding left.
    let tidy = |x: f64, length: f64| match x.abs() < SLACK * length {
        true => 0.0,
        false => format!("{x:.11e}").parse().unwrap_or(x),
    };
    let words: Vec<String> = axes
        .iter()
        .zip(extents)
        .map(|(axis, [first, last])| {
            let [from, to] = [first, last].map(|x| tidy(*x, last - first));
            format!("x{} from {from:?} to {to:?} m", axis + 1)
        })
        .collect();
    let found = format!("found {position:?}, outside the {whole}");
    Err(section.error(key, found, format!("the {whole} has {}", words.join(", "))))
}

/// A list of different quantities, whose names are `among`; `None` where it is absent.
pub(crate) fn different<T: PartialEq>(
    section: &mut Section,
    key: &'static str,
    among: &[String],
    find: impl Fn(&str) -> Option<T>,
) -> Result<Option<Vec<T>>, CaseError> {
    let expected = format!("a list with any of {}", joined(among));
    let Some(given) = section.optional(key, &expected, texts)? else { return Ok(None) };
    let mut all = Vec::new();
    for name in given {
        let own = find(&name).ok_or_else(|| section.no_such(key, &name, among))?;
        if all.contains(&own) {
            let found = format!("found '{name}' twice");
            return Err(section.error(key, found, "name each once"));
        }
        all.push(own);
    }
    Ok(Some(all))
}

/// Time between two lines of the ledger, where `zero` says what 0 means, and between two snapshots, s.
pub(crate) fn intervals(section: &mut Section, zero: &str) -> Result<[f64; 2], CaseError> {
    let expected = format!("a number of at least 0 in s ({zero})");
    let ledger = section.optional("ledger_interval", &expected, not_negative)?;
    let expected = "a number of at least 0 in s (0: none)";
    let snapshots = section.optional("snapshot_interval", expected, not_negative)?;
    Ok([ledger.unwrap_or(0.0), snapshots.unwrap_or(0.0)])
}

/// Names in case files.
fn names(components: &[Component]) -> Vec<String> {
    components.iter().map(Component::to_string).collect()
}

/// `1 number`, `2 numbers`.
fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// So many numbers, as they are asked for.
fn list_of(length: usize) -> String {
    match length {
        1 => "a finite number".to_owned(),
        _ => format!("a list of {length} finite numbers"),
    }
}

/// Coordinates along some axes, as they are asked for.
pub(super) fn along(axes: &[usize], meaning: &str) -> String {
    let along: Vec<String> = axes.iter().map(|axis| format!("x{}", axis + 1)).collect();
    format!("{} in m ({meaning}, along {})", list_of(axes.len()), along.join(", "))
}

/// The kernel of what acts at a point, if anything is said of it.
fn kernel(section: &mut Section) -> Result<Option<Kernel>, CaseError> {
    let expected = "a number of at least 0 in m (radius of the bell; 0: one cell)";
    let radius = section.optional("radius", expected, not_negative)?;
    let name = section.optional_choice("kernel", &Kernel::NAMES, |name| name)?;
    match (name, radius) {
        (None, None) => Ok(None),
        (Some("spline"), None) => Ok(Some(Kernel::Spline)),
        (None | Some("cell"), Some(0.0)) | (Some("cell"), None) => Ok(Some(Kernel::Cell)),
        (None | Some("bell"), Some(radius)) if radius > 0.0 => Ok(Some(Kernel::Bell { radius })),
        (Some("bell"), found) => {
            let found = found.map_or("missing".to_owned(), |radius| format!("found {radius:?}"));
            let allowed = "expected a positive number in m (radius of the bell)";
            Err(section.error("radius", found, allowed))
        }
        (name, _) => {
            let found = format!("found beside kernel = \"{}\"", name.unwrap_or_default());
            Err(section.error("radius", found, "leave it out, or write kernel = \"bell\""))
        }
    }
}

fn amplitude_of_field(section: &mut Section) -> Result<f64, CaseError> {
    section.required("amplitude", "a finite number in the unit of the field", number)
}

/// That `from` is below `to` along each axis.
fn check_order(section: &Section, from: &[f64], to: &[f64]) -> Result<(), CaseError> {
    if from.iter().zip(to).all(|(from, to)| from < to) {
        return Ok(());
    }
    let [from, to] = [from, to].map(|end| match end {
        [one] => format!("{one:?}"),
        all => format!("{all:?}"),
    });
    let found = format!("found {to} with from = {from}");
    Err(section.error("to", found, "to must be greater than from along each axis"))
}

/// The samples of a CSV file, or the line that is none, what was found there and what is allowed.
fn parse_samples(text: &str) -> Result<Vec<[f64; 2]>, (usize, String, &'static str)> {
    const LINE: &str = "expected two finite numbers with a comma between them, time in s and value";
    let mut samples: Vec<[f64; 2]> = Vec::new();
    let mut may_be_header = true;
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Vec<Option<f64>> =
            line.split(',').map(|field| field.trim().parse().ok()).collect();
        let is_header = may_be_header && numbers.iter().all(Option::is_none);
        may_be_header = false;
        match numbers[..] {
            [Some(time), Some(value)] if time.is_finite() && value.is_finite() => {
                if let Some([before, _]) = samples.last().filter(|[before, _]| *before >= time) {
                    let found = format!("found the time {time:?} after {before:?}");
                    return Err((index + 1, found, "times must increase"));
                }
                samples.push([time, value]);
            }
            _ if is_header => {}
            _ => return Err((index + 1, format!("found '{}'", shown(line)), LINE)),
        }
    }
    Ok(samples)
}
