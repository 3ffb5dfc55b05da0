//! From a case to the problem that the solver takes.

use super::pulse::Incident;
use super::spread::shares;
use crate::Error;
use crate::case::dynamics::{
    Action, Centre, Component, Condition as SideKind, Correction, Dynamics, Initial, Kernel,
    Ledger as LedgerKind, Load as SideLoad, Order, Side, SideCondition, Source as Inside,
    SourceKind, Splitting as Sweeps,
};
use crate::case::{Case, CaseError, Wave};
use crate::setup::solid::{elastic_law_and_set, normal};
use analysis::waves::plane_waves;
use dynamics::boundary::{Boundary, Condition, Load, Signal, Source};
use dynamics::line::Slopes;
use dynamics::medium::Medium;
use dynamics::problem::{Detail, DomainError, Grid, Placement, Problem, Scheme, Splitting};
use models::cosserat::stress::Stress;
use models::cosserat::waves::Field;
use models::elementary::{Elementary, cr_cis};
use models::granular_flow::InputError;
use models::plasticity::parameters::YieldSet;
use num_complex::Complex64;
use std::sync::Arc;

/// Most steps of a run.
const MOST_STEPS: f64 = 1e12;

/// What a case comes to: a problem and the state at its beginning.
pub(super) struct Setup<const D: usize> {
    pub(super) problem: Problem<D>,
    pub(super) steps: Steps,
    /// Values of the fields that are not zero, by cell.
    pub(super) initial: Vec<(Field, Vec<f64>)>,
}

/// The media of a case in their order, with the cases that describe them.
pub(super) fn media(case: &Case, dynamics: &Dynamics) -> Result<Vec<Medium>, Error> {
    let dimensions = dynamics.grid.dimensions();
    let medium = |own: &Case| medium(own, dimensions).map_err(|error| own.locate(error).into());
    if dynamics.regions.is_empty() {
        return medium(case).map(|medium| vec![medium]);
    }
    let all: Vec<Medium> =
        dynamics.regions.iter().map(|region| medium(&region.case)).collect::<Result<_, Error>>()?;
    if let Some(odd) = all.iter().position(|medium| medium.fields != all[0].fields) {
        let kinds = [odd, 0].map(|index| dynamics.regions[index].case.kind.name());
        let found = format!("found {}, beside {} in region[0]", kinds[0], kinds[1]);
        let allowed = "all regions of a run need the same fields: solids of one theory";
        return Err(dynamics.locate(&format!("region[{odd}].model.kind"), found, allowed).into());
    }
    Ok(all)
}

/// What a case's solid is to the solver.
///
/// # Errors
/// The constant that is out of range; that the flow is not one that a run knows; that the case is one of a
/// flow.
pub(crate) fn medium(case: &Case, dimensions: usize) -> Result<Medium, InputError> {
    let (elastic, set) = elastic_law_and_set(case)?;
    let medium = Medium::new(elastic, dimensions);
    check_flow(set.as_ref())?;
    Ok(match set {
        Some(set) => medium.yielding(set),
        None => medium,
    })
}

/// The name of a field among the unknowns of the analysis.
pub(crate) fn unknown_name(field: Field) -> String {
    Component(field).to_string().replace("sigma", "σ").replace('w', "ω")
}

/// That flow is ideal and associated: a run knows no other.
fn check_flow(set: Option<&YieldSet>) -> Result<(), InputError> {
    let refused = |key, found: f64, allowed: String| {
        Err(InputError { key, found: format!("{found:?}"), allowed })
    };
    let associated =
        |friction: f64| format!("runs have associated flow: {friction:?}, as the friction");
    match set {
        Some(YieldSet::Mises(set)) if set.hardening != 0.0 => {
            let allowed = "runs have ideal plasticity: leave it out, or 0";
            refused("yield.hardening", set.hardening, allowed.to_owned())
        }
        Some(YieldSet::Mises(set)) if set.dilatancy != set.friction => {
            refused("yield.dilatancy", set.dilatancy, associated(set.friction))
        }
        Some(YieldSet::Interlayer(set)) if set.shear_dilatancy != set.shear_friction => {
            refused("yield.shear_dilatancy", set.shear_dilatancy, associated(set.shear_friction))
        }
        Some(YieldSet::Interlayer(set)) => match set.couple {
            Some(couple) if couple.dilatancy != couple.friction => {
                refused("yield.couple_dilatancy", couple.dilatancy, associated(couple.friction))
            }
            _ => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The steps of a run.
#[derive(Clone, Copy)]
pub(super) struct Steps {
    pub(super) count: usize,
    /// Δt, s.
    pub(super) step: f64,
    /// Whether it is the natural rotation that asks for so many.
    pub(super) by_rotation: bool,
    /// Of all steps, s.
    duration: f64,
}

impl Steps {
    /// The time after so many steps, s: after the last one the duration to the last bit, which a sum of
    /// steps misses.
    pub(super) fn time(&self, done: usize) -> f64 {
        done as f64 / self.count as f64 * self.duration
    }
}

/// The longest steps that the case lets waves and the natural rotation have, shortened until they end with
/// the run.
pub(super) fn steps(dynamics: &Dynamics, media: &[Medium]) -> Result<Steps, CaseError> {
    let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let rates = (0..dynamics.grid.dimensions()).map(|axis| {
        let pairs = media.iter().flat_map(|m| &m.pairs[axis]);
        greatest(&mut pairs.map(|pair| pair.speed())) / dynamics.grid.spacing[axis]
    });
    // A step is two sweeps along each axis.
    let by_waves = 2.0 * dynamics.time.courant / greatest(&mut rates.into_iter());
    let frequencies = media.iter().filter_map(|m| Some(m.rotation?.frequency));
    let by_rotation =
        dynamics.time.rotation_deg.to_radians() / greatest(&mut frequencies.into_iter());
    let longest = by_waves.min(by_rotation);
    let count = (dynamics.time.duration / longest * (1.0 - 1e-12)).ceil().max(1.0);
    if count > MOST_STEPS {
        let found = format!("{count:.3e} steps of {longest:.3e} s");
        let allowed = "at most 10¹² steps: give a shorter duration, or larger cells";
        return Err(dynamics.locate("time.duration", found, allowed));
    }
    Ok(Steps {
        count: count as usize,
        step: dynamics.time.duration / count,
        by_rotation: by_rotation < by_waves,
        duration: dynamics.time.duration,
    })
}

impl<const D: usize> Setup<D> {
    pub(super) fn new(case: &Case, dynamics: &Dynamics, media: Vec<Medium>) -> Result<Self, Error> {
        let cells = std::array::from_fn(|axis| dynamics.grid.cells[axis]);
        let spacing = std::array::from_fn(|axis| dynamics.grid.spacing[axis]);
        let steps = steps(dynamics, &media)?;
        let of_cell = dynamics.media_of_cells()?;
        let scheme = Scheme {
            slopes: match dynamics.scheme.order {
                Order::FourthOrder => Slopes::FourthOrder,
                Order::Eno2 => Slopes::Limited,
                Order::Godunov => Slopes::Godunov,
            },
            placement: match dynamics.scheme.correction {
                Correction::SecondOrder => Placement::Middle,
                Correction::FirstOrder => Placement::Last,
            },
            splitting: match dynamics.scheme.splitting {
                Sweeps::Alternating => Splitting::Alternating,
                Sweeps::TwoCyclic => Splitting::TwoCyclic,
            },
            detail: match dynamics.scheme.ledger {
                LedgerKind::Light => Detail::Light,
                LedgerKind::Full => Detail::Full,
            },
        };
        let place = Place { dynamics, medium: media[0].clone() };
        let boundaries: [[Boundary; 2]; D] = {
            let mut all = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
            for (axis, sides) in all.iter_mut().enumerate() {
                for (end, side) in sides.iter_mut().enumerate() {
                    *side = place.boundary(Side { axis, is_upper: end == 1 })?;
                }
            }
            all
        };
        let mut loads = Vec::new();
        for (index, load) in dynamics.loads.iter().enumerate() {
            loads.push(place.load(index, load)?);
        }
        let mut sources = Vec::new();
        for (index, source) in dynamics.sources.iter().enumerate() {
            sources.extend(place.source(index, source)?);
        }
        let (acceleration, initial_stress) = place.weight::<D>(&media, &of_cell)?;
        let initial = place.initial::<D>(case, media.len())?;
        let problem = Problem {
            loads,
            sources,
            acceleration,
            initial_stress,
            integrals: dynamics.output.integrals.iter().map(|component| component.0).collect(),
            ..Problem::new(Grid { cells, spacing }, media, of_cell, boundaries, steps.step, scheme)
        };
        problem.check().map_err(|error| refused(dynamics, &error))?;
        check_initial_stress(dynamics, &problem)?;
        Ok(Self { problem, steps, initial })
    }
}

/// What the solver refuses though the case was read: each of these the reader should have found.
fn refused(dynamics: &Dynamics, error: &DomainError) -> CaseError {
    let key = match error {
        DomainError::Courant { .. } => "time.courant",
        DomainError::Conditions { .. } | DomainError::Periodic(_) => "side",
        DomainError::Load(_) => "load",
        DomainError::Source(_) => "source",
        DomainError::InitialStress => "initial_stress",
        _ => "grid",
    };
    dynamics.locate(key, error.to_string(), "the README lists what there is under Solids in time")
}

/// That the initial stress is in the yield sets: else the first step would release it.
fn check_initial_stress<const D: usize>(
    dynamics: &Dynamics,
    problem: &Problem<D>,
) -> Result<(), CaseError> {
    let Some((axis, layers)) = &problem.initial_stress else { return Ok(()) };
    let stride: usize = problem.grid.cells[..*axis].iter().product();
    for (cell, &medium) in problem.of_cell.iter().enumerate() {
        let stress = layers[cell / stride % problem.grid.cells[*axis]];
        if problem.media[usize::from(medium)].project(&stress).stress != stress {
            let key = if dynamics.gravity.is_some() { "gravity" } else { "initial_stress" };
            let found = format!("beyond yield in the cell at {:?}", centre(dynamics, cell));
            let allowed = "an initial stress within the yield set";
            return Err(dynamics.locate(key, found, allowed));
        }
    }
    Ok(())
}

/// The middle of a cell, m.
pub(super) fn centre(dynamics: &Dynamics, cell: usize) -> Vec<f64> {
    let mut rest = cell;
    let along = dynamics.grid.cells.iter().enumerate();
    along
        .map(|(axis, &count)| {
            let index = rest % count;
            rest /= count;
            dynamics.grid.centre(axis, index)
        })
        .collect()
}

/// The cell that holds a point; of points on a joint the cell behind it, of those on a side the one there.
pub(super) fn cell_at(dynamics: &Dynamics, point: &[f64]) -> usize {
    let mut cell = 0;
    for (axis, x) in point.iter().enumerate().rev() {
        let grid = &dynamics.grid;
        let index = ((x - grid.origin[axis]) / grid.spacing[axis]).floor().max(0.0) as usize;
        cell = cell * grid.cells[axis] + index.min(grid.cells[axis] - 1);
    }
    cell
}

/// The distance along an axis; round the grid where that is periodic and shorter.
fn along(dynamics: &Dynamics, axis: usize, a: f64, b: f64) -> f64 {
    let [first, last] = dynamics.grid.extent(axis);
    match is_periodic(dynamics, axis) {
        true => (a - b) - ((a - b) / (last - first)).round() * (last - first),
        false => a - b,
    }
}

fn distance(dynamics: &Dynamics, axes: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let parts = axes.iter().zip(a.iter().zip(b));
    parts.fold(0.0, |sum, (axis, (a, b))| {
        Elementary::root_sum_square(sum, along(dynamics, *axis, *a, *b))
    })
}

/// Whether the grid comes round along an axis.
pub(super) fn is_periodic(dynamics: &Dynamics, axis: usize) -> bool {
    whole_side(dynamics, Side { axis, is_upper: false })
        .is_some_and(|entry| entry.condition == SideKind::Periodic)
}

/// The last entry of a whole side.
fn whole_side(dynamics: &Dynamics, side: Side) -> Option<&SideCondition> {
    dynamics.sides.iter().rev().find(|entry| entry.side == side && entry.part.is_none())
}

/// What finds the places of a case in its grid.
struct Place<'a> {
    dynamics: &'a Dynamics,
    medium: Medium,
}

impl Place<'_> {
    /// The middles of the faces of a side along its axes, the first fastest.
    fn faces(&self, side: Side) -> Vec<Vec<f64>> {
        let grid = &self.dynamics.grid;
        let mut faces = vec![Vec::new()];
        for axis in side.axes(grid.dimensions()).into_iter().rev() {
            faces = faces
                .iter()
                .flat_map(|face| (0..grid.cells[axis]).map(move |index| (face, index)))
                .map(|(face, index)| {
                    let mut face = face.clone();
                    face.insert(0, grid.centre(axis, index));
                    face
                })
                .collect();
        }
        faces
    }

    fn boundary(&self, side: Side) -> Result<Boundary, Error> {
        let pairs = &self.medium.pairs[side.axis];
        let last = whole_side(self.dynamics, side);
        if last.is_some_and(|entry| entry.condition == SideKind::Periodic) {
            return Ok(Boundary::Periodic);
        }
        let faces = self.faces(side);
        let mut by_face = vec![vec![Condition::Traction(0.0); faces.len()]; pairs.len()];
        let own = |entry: &(usize, &SideCondition)| entry.1.side == side;
        for (index, entry) in self.dynamics.sides.iter().enumerate().filter(own) {
            let of_pair: Vec<Condition> = match &entry.condition {
                // A later entry holds.
                SideKind::Periodic => continue,
                SideKind::Free => vec![Condition::Traction(0.0); pairs.len()],
                SideKind::Fixed => vec![Condition::Velocity(0.0); pairs.len()],
                SideKind::NonReflecting => vec![Condition::NonReflecting; pairs.len()],
                SideKind::Symmetry | SideKind::Antisymmetry => {
                    let mirror = match entry.condition {
                        SideKind::Symmetry => Boundary::symmetry(&self.medium, side.axis),
                        _ => Boundary::antisymmetry(&self.medium, side.axis),
                    };
                    match mirror {
                        Boundary::Given(conditions) => conditions,
                        _ => Vec::new(),
                    }
                }
                SideKind::Mixed { held } => pairs
                    .iter()
                    .map(|pair| match held.contains(&Component(pair.velocity)) {
                        true => Condition::Velocity(0.0),
                        false => Condition::Traction(0.0),
                    })
                    .collect(),
            };
            let mut is_empty = true;
            for (face, middle) in faces.iter().enumerate() {
                if entry.part.as_ref().is_none_or(|part| part.contains(middle)) {
                    is_empty = false;
                    for (own, condition) in by_face.iter_mut().zip(&of_pair) {
                        own[face] = *condition;
                    }
                }
            }
            self.refuse_empty(is_empty, &format!("side[{index}]"))?;
        }
        // A load says what is given on its faces; two must not say different things.
        let mut said = vec![vec![None; faces.len()]; pairs.len()];
        for (index, load) in self.dynamics.loads.iter().enumerate() {
            if load.side == side {
                let (pair, condition) = self.pair_of(index, load)?;
                for (face, _) in self.loaded(index, load)? {
                    if said[pair][face].replace(condition).is_some_and(|own| own != condition) {
                        let found = format!("{} on faces with another load", load.field);
                        let allowed = "either the velocity or the stress of a wave on a face";
                        let key = format!("load[{index}].field");
                        return Err(self.dynamics.locate(&key, found, allowed).into());
                    }
                    by_face[pair][face] = condition;
                }
            }
        }
        Ok(Boundary::ByFace(by_face))
    }

    fn refuse_empty(&self, is_empty: bool, key: &str) -> Result<(), Error> {
        match is_empty {
            true => {
                let found = "no face of the side has its middle in it";
                let allowed = "make it larger than a cell, or move it onto the side";
                Err(self.dynamics.locate(key, found, allowed).into())
            }
            false => Ok(()),
        }
    }

    /// The pair of waves that a load drives, and how.
    fn pair_of(&self, index: usize, load: &SideLoad) -> Result<(usize, Condition), Error> {
        let pairs = self.medium.pairs[load.side.axis].iter().enumerate();
        for (place, pair) in pairs {
            if pair.velocity == load.field.0 {
                return Ok((place, Condition::Velocity(0.0)));
            }
            if pair.stress == load.field.0 {
                return Ok((place, Condition::Traction(0.0)));
            }
        }
        let found = format!("{} does not act on {}", load.field, load.side.name());
        let allowed = "a velocity or spin of the side, or a stress whose second index is its axis";
        Err(self.dynamics.locate(&format!("load[{index}].field"), found, allowed).into())
    }

    /// The faces of a load and their amplitudes.
    fn loaded(&self, index: usize, load: &SideLoad) -> Result<Vec<(usize, f64)>, Error> {
        let faces = self.faces(load.side).into_iter().enumerate();
        let axes = load.side.axes(self.dynamics.grid.dimensions());
        let to = |a: &[f64], b: &[f64]| distance(self.dynamics, &axes, a, b);
        let amplitude = |middle: &[f64]| match &load.profile {
            Some(profile) => load.amplitude * profile.value(&axes, middle, to),
            None => load.amplitude,
        };
        let found: Vec<(usize, f64)> = match &load.action {
            Action::Whole => faces.map(|(face, middle)| (face, amplitude(&middle))).collect(),
            Action::Part(part) => faces
                .filter(|(_, middle)| part.contains(middle))
                .map(|(face, middle)| (face, amplitude(&middle)))
                .collect(),
            Action::Point { at, kernel } => {
                let area: f64 = axes.iter().map(|&axis| self.dynamics.grid.spacing[axis]).product();
                let mut point = at.clone();
                let end = self.dynamics.grid.extent(load.side.axis);
                point.insert(load.side.axis, end[usize::from(load.side.is_upper)]);
                let key = format!("load[{index}]");
                let shares = self.shares(&axes, &point, *kernel, load.field.0, &key)?.into_iter();
                shares.map(|(face, share)| (face, load.amplitude * share / area)).collect()
            }
        };
        self.refuse_empty(found.is_empty(), &format!("load[{index}]"))?;
        if load.amplitude != 0.0 && load.profile.is_some() && found.iter().all(|own| own.1 == 0.0) {
            let key = format!("load[{index}].profile");
            let found = "0 in the middle of every face that the load is on";
            let allowed =
                "one that is not 0 there: move it onto the side, or make it wider than a cell";
            return Err(self.dynamics.locate(&key, found, allowed).into());
        }
        Ok(found)
    }

    fn load(&self, index: usize, load: &SideLoad) -> Result<Load, Error> {
        let (pair, _) = self.pair_of(index, load)?;
        let time = load.time.clone();
        Ok(Load {
            axis: load.side.axis,
            end: usize::from(load.side.is_upper),
            pair,
            faces: self.loaded(index, load)?,
            signal: Arc::new(move |t| time.value(t)),
        })
    }

    /// Shares of cells or faces in what acts at a point.
    fn shares(
        &self,
        axes: &[usize],
        point: &[f64],
        kernel: Kernel,
        field: Field,
        key: &str,
    ) -> Result<Vec<(usize, f64)>, Error> {
        let shares = shares(self.dynamics, axes, point, kernel, field);
        if shares.iter().all(|own| own.1.abs() < 1e-12) {
            let found = format!("what drives {} is on a plane of symmetry", Component(field));
            let allowed = "its mirror image takes it away: leave that component out, or move it";
            return Err(self.dynamics.locate(&format!("{key}.at"), found, allowed).into());
        }
        Ok(shares)
    }

    /// A source, in parts whose mirror images have the same sign.
    fn source(&self, index: usize, source: &Inside) -> Result<Vec<Source>, Error> {
        let amplitudes: Vec<(Field, f64)> = match &source.action {
            SourceKind::Force(force) => {
                force.iter().enumerate().map(|(i, f)| (Field::Velocity(i), *f)).collect()
            }
            SourceKind::Couple(couple) => {
                let first = 3 - couple.len();
                couple.iter().enumerate().map(|(k, m)| (Field::Spin(first + k), *m)).collect()
            }
            SourceKind::Moment(moment) => {
                let entries = moment.iter().enumerate().flat_map(|(i, row)| {
                    row.iter().enumerate().map(move |(j, m)| (Field::Stress(i, j), *m))
                });
                let is_classical = self.medium.rotation.is_none();
                let transposed = |i: usize, j: usize| moment[j][i];
                if is_classical
                    && entries.clone().any(|(field, m)| match field {
                        Field::Stress(i, j) => transposed(i, j) != m,
                        _ => false,
                    })
                {
                    let found = "a moment tensor that is not symmetric in a classical solid";
                    let allowed = "a symmetric one; couples need a solid with spin";
                    let key = format!("source[{index}].amplitude");
                    return Err(self.dynamics.locate(&key, found, allowed).into());
                }
                entries.filter(|(field, _)| self.medium.fields.contains(field)).collect()
            }
            // In plane strain across the plane as well.
            SourceKind::Explosion(moment) => {
                (0..3).map(|i| (Field::Stress(i, i), *moment)).collect()
            }
        };
        let time = source.time.clone();
        let signal: Signal = Arc::new(move |t| time.value(t));
        let axes: Vec<usize> = (0..self.dynamics.grid.dimensions()).collect();
        let key = format!("source[{index}]");
        let mut parts: Vec<Source> = Vec::new();
        for own in amplitudes.into_iter().filter(|(_, amplitude)| *amplitude != 0.0) {
            let cells = self.shares(&axes, &source.at, source.kernel, own.0, &key)?;
            match parts.iter_mut().find(|part| part.cells == cells) {
                Some(part) => part.amplitudes.push(own),
                None => {
                    parts.push(Source { cells, amplitudes: vec![own], signal: signal.clone() });
                }
            }
        }
        Ok(parts)
    }

    /// What gravity does: an acceleration, or an initial stress that balances it, to which the uniform one
    /// is added.
    #[allow(clippy::type_complexity, reason = "two fields of the problem")]
    fn weight<const D: usize>(
        &self,
        media: &[Medium],
        of_cell: &[u16],
    ) -> Result<([f64; D], Option<(usize, Vec<Stress>)>), Error> {
        let mut uniform = Stress::default();
        for (component, value) in &self.dynamics.initial_stress {
            match component.0 {
                Field::Stress(i, j) => {
                    uniform.force[i][j] = *value;
                    if self.medium.rotation.is_none() {
                        uniform.force[j][i] = *value;
                    }
                }
                Field::Couple(k, j) => uniform.couple[k][j] = *value,
                Field::Velocity(_) | Field::Spin(_) => {}
            }
        }
        let grid = &self.dynamics.grid;
        let mut acceleration = [0.0; D];
        let mut layers = (D - 1, vec![uniform; grid.cells[D - 1]]);
        if let Some(gravity) = &self.dynamics.gravity {
            let along = gravity.acceleration.iter().position(|a| *a != 0.0);
            match along.filter(|_| gravity.is_balanced) {
                None => acceleration.copy_from_slice(&gravity.acceleration),
                Some(axis) => {
                    let densities = self.densities(axis, media, of_cell)?;
                    layers = (axis, vec![uniform; grid.cells[axis]]);
                    // ∂σ + ρg = 0 from the side against which the weight acts, where σ = 0.
                    let (mut above, pull) = (0.0, gravity.acceleration[axis]);
                    let from_upper = pull < 0.0;
                    for step in 0..densities.len() {
                        let index = if from_upper { densities.len() - 1 - step } else { step };
                        let weight = densities[index] * pull.abs() * grid.spacing[axis];
                        let normal = -(above + 0.5 * weight);
                        above += weight;
                        for i in 0..3 {
                            let share = if i == axis { 1.0 } else { gravity.lateral_ratio };
                            layers.1[index].force[i][i] += share * normal;
                        }
                    }
                }
            }
        }
        let is_zero = layers.1.iter().all(|stress| *stress == Stress::default());
        Ok((acceleration, (!is_zero).then_some(layers)))
    }

    /// Densities of the layers across an axis.
    fn densities(&self, axis: usize, media: &[Medium], of_cell: &[u16]) -> Result<Vec<f64>, Error> {
        let cells = &self.dynamics.grid.cells;
        let stride: usize = cells[..axis].iter().product();
        let mut densities = vec![f64::NAN; cells[axis]];
        for (cell, &medium) in of_cell.iter().enumerate() {
            let density = media[usize::from(medium)].inertia(Field::Velocity(axis));
            let own = &mut densities[cell / stride % cells[axis]];
            if own.is_nan() {
                *own = density;
            } else if *own != density {
                let found = format!(
                    "densities {own:?} and {density:?} side by side, at x{} = {:?}",
                    axis + 1,
                    centre(self.dynamics, cell)[axis]
                );
                let allowed = "densities that change along gravity alone; balanced = false lets \
                               the weight act from the start";
                return Err(self.dynamics.locate("gravity.balanced", found, allowed).into());
            }
        }
        Ok(densities)
    }

    /// The initial values of the fields that have any.
    fn initial<const D: usize>(
        &self,
        case: &Case,
        media: usize,
    ) -> Result<Vec<(Field, Vec<f64>)>, Error> {
        let count = self.dynamics.grid.count();
        let mut all: Vec<(Field, Vec<f64>)> = Vec::new();
        let mut add = |field: Field, value: &mut dyn FnMut(&[f64]) -> f64| {
            let place = all.iter().position(|own| own.0 == field).unwrap_or_else(|| {
                all.push((field, vec![0.0; count]));
                all.len() - 1
            });
            for (cell, own) in all[place].1.iter_mut().enumerate() {
                *own += value(&centre(self.dynamics, cell));
            }
        };
        for (index, part) in self.dynamics.initial.iter().enumerate() {
            match part {
                Initial::Pulse { field, amplitude, centre, radius } => {
                    let axes: Vec<usize> = (0..D).collect();
                    add(field.0, &mut |x| {
                        let r = match centre {
                            Centre::Point(at) => distance(self.dynamics, &axes, x, at),
                            Centre::Plane { axis, at } => {
                                along(self.dynamics, *axis, x[*axis], *at)
                            }
                        };
                        amplitude * (-(r / radius).powi(2)).cr_exp()
                    });
                }
                Initial::Uniform { shape, field, amplitude } => {
                    add(field.0, &mut |x| if shape.contains(x) { *amplitude } else { 0.0 });
                }
                Initial::Rotation { shape, angle_deg, axis } => {
                    // Λ = −φ× without displacement: a = 2αφ of each medium, σ = ±a.
                    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                    let alphas = self.alphas(case)?;
                    let of_cell = self.dynamics.media_of_cells()?;
                    for (field, sign) in [(Field::Stress(i, j), 1.0), (Field::Stress(j, i), -1.0)] {
                        let mut cell = 0;
                        add(field, &mut |x| {
                            let alpha = alphas[usize::from(of_cell[cell])];
                            cell += 1;
                            match shape.contains(x) {
                                true => sign * 2.0 * alpha * angle_deg.to_radians(),
                                false => 0.0,
                            }
                        });
                    }
                }
                Initial::PlanePulse(pulse) => {
                    let of_cell = self.dynamics.media_of_cells()?;
                    let key = format!("initial[{index}]");
                    let wave = Incident::new(case, self.dynamics, &of_cell, pulse, &key)?;
                    for &field in &self.medium.fields {
                        let mut media = of_cell.iter();
                        add(field, &mut |x| {
                            media.next().map_or(0.0, |medium| wave.value(field, x, *medium))
                        });
                    }
                }
                Initial::PlaneWave {
                    branch,
                    direction_deg,
                    elevation_deg,
                    wavelength,
                    amplitude,
                } => {
                    let key = format!("initial[{index}]");
                    if media > 1 {
                        let found = "a plane wave in several media";
                        let allowed = "one medium: leave the regions out";
                        return Err(self.dynamics.locate(&key, found, allowed).into());
                    }
                    let wave = Wave {
                        number: 2.0 * std::f64::consts::PI / wavelength,
                        direction_deg: *direction_deg,
                        elevation_deg: *elevation_deg,
                        greatest_number: 0.0,
                    };
                    for (field, factor) in self.plane_wave::<D>(case, &wave, *branch, &key)? {
                        let direction = normal(&wave);
                        add(field, &mut |x| {
                            let along: f64 = x.iter().zip(direction).map(|(x, n)| x * n).sum();
                            (amplitude * factor * cr_cis(wave.number * along)).re
                        });
                    }
                }
            }
        }
        Ok(all)
    }

    /// α of each medium.
    fn alphas(&self, case: &Case) -> Result<Vec<f64>, Error> {
        let alpha = |own: &Case| -> Result<f64, Error> {
            let (elastic, _) = elastic_law_and_set(own).map_err(|error| own.locate(error))?;
            Ok(elastic.antisymmetric_modulus())
        };
        match self.dynamics.regions.as_slice() {
            [] => Ok(vec![alpha(case)?]),
            regions => regions.iter().map(|region| alpha(&region.case)).collect(),
        }
    }

    /// The amplitudes of a plane wave, of which the greatest velocity is 1.
    fn plane_wave<const D: usize>(
        &self,
        case: &Case,
        wave: &Wave,
        branch: usize,
        key: &str,
    ) -> Result<Vec<(Field, Complex64)>, Error> {
        let own = match self.dynamics.regions.as_slice() {
            [region] => &region.case,
            _ => case,
        };
        let (elastic, _) = elastic_law_and_set(own).map_err(|error| own.locate(error))?;
        let rates = elastic.carried_rates::<D>();
        let direction = normal(wave);
        let vector = std::array::from_fn(|axis| wave.number * direction[axis]);
        let waves = plane_waves(&rates, vector);
        // By descending frequency; those that stand still are none.
        let Some((_, amplitudes)) = branch.checked_sub(1).and_then(|i| waves.get(i)) else {
            let found = format!("found branch {branch}");
            let allowed = format!("1 to {} at this wavelength", waves.len());
            return Err(self.dynamics.locate(&format!("{key}.branch"), found, allowed).into());
        };
        let of = |field: Field| {
            let name = unknown_name(field);
            rates.unknowns.iter().position(|unknown| unknown.name == name)
        };
        let found: Vec<(Field, Complex64)> = self
            .medium
            .fields
            .iter()
            .filter_map(|&field| Some((field, amplitudes[of(field)?])))
            .collect();
        // |v| and the phase of its greatest component; in units of energy, of which the wave has one.
        let velocities = || found.iter().filter(|(f, _)| matches!(f, Field::Velocity(_)));
        let speed = velocities().map(|own| own.1.norm_sqr()).sum::<f64>().sqrt();
        let density = self.medium.inertia(Field::Velocity(0));
        let greatest = velocities()
            .map(|(_, amplitude)| *amplitude)
            .max_by(|a, b| a.norm().total_cmp(&b.norm()))
            .filter(|_| density.sqrt() * speed > 1e-6)
            .map(|amplitude| amplitude.unscale(amplitude.norm()).scale(speed));
        let Some(greatest) = greatest else {
            let found = "a branch that moves nothing but spins";
            let allowed = "a wave whose velocity can have an amplitude: another branch";
            return Err(self.dynamics.locate(&format!("{key}.branch"), found, allowed).into());
        };
        Ok(found.into_iter().map(|(field, amplitude)| (field, amplitude / greatest)).collect())
    }
}
