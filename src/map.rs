//! `wellposed map`: the verdict over two parameters of a case.

use crate::case::{Case, Kind, Map, Parameter, Sweep, radians};
use crate::cli::progress::Progress;
use crate::output::{self, ResultFolder};
use crate::report::format::{
    CLOSED_FORM, ROUTE, VALIDITY, case_title, coefficient_unit, short, superscript, unit,
};
use crate::setup;
use crate::setup::solid::normal;
use crate::{Error, Format, Options};
use analysis::StateError;
use analysis::bound;
use analysis::flows::{Route, Workspace};
use analysis::growth::Verdict;
use analysis::solids::{
    self, AcousticTensorCache, Hyperbolicity, PLANE_ROUTE, SPACE_ROUTE, SolidAssessor, angles_deg,
};
use figures::{Axis, Category, Curve, Look, VerdictMap};
use models::elementary::Elementary;
use models::granular_flow::Model;
use models::granular_flow::state::Background;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::Write;

/// What is asked of a map besides the verdicts. Growth rates need the dispersion polynomial of every
/// state, so with them no verdict is left to a formula.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// The supremum of the growth rate over all waves at every well-posed point.
    pub bound: bool,
    /// The growth rate at the wave of the case; a map that sweeps the wave has it unasked.
    pub growth_rate: bool,
    /// Every verdict from the linearised equations, none by a formula.
    pub model_blind: bool,
}

impl Extras {
    /// The same for a map that sweeps these parameters.
    fn of_map(self, map: &Map) -> Self {
        let sweeps_wave =
            [map.x, map.y].iter().any(|sweep| sweep.parameter.key().name.starts_with("wave."));
        Self { growth_rate: self.growth_rate || sweeps_wave, ..self }
    }

    fn admits_closed_forms(self) -> bool {
        !(self.bound || self.growth_rate || self.model_blind)
    }
}

/// The verdict at one point of a map; numbers are NaN where there is none.
#[derive(Clone, Copy, Debug)]
struct Point {
    code: Code,
    /// Where there is a verdict.
    route: Option<Route>,
    order: f64,
    coefficient: f64,
    direction_deg: f64,
    /// Of the wave vector above the plane; solids.
    elevation_deg: f64,
    bound: f64,
    /// Greatest Re ς at the wave of the case, 1/s.
    growth_rate: f64,
    noncoaxiality_bound_deg: f64,
    speeds: Option<Speeds>,
}

/// The speeds of a solid.
#[derive(Clone, Copy, Debug)]
struct Speeds {
    hyperbolicity: Hyperbolicity,
    /// Greatest |Im c| of complex c², m/s; 0 without flutter.
    flutter: f64,
    /// Least real c², m²/s²; what rounding may have made of zero is 0.
    least_squared: f64,
    /// Normal of the slowest wave: in the plane, and above it.
    least_normal_deg: [f64; 2],
}

impl Point {
    fn empty(code: Code) -> Self {
        Self {
            code,
            route: None,
            order: f64::NAN,
            coefficient: f64::NAN,
            direction_deg: f64::NAN,
            elevation_deg: f64::NAN,
            bound: f64::NAN,
            growth_rate: f64::NAN,
            noncoaxiality_bound_deg: f64::NAN,
            speeds: None,
        }
    }

    /// Takes a verdict.
    fn decide(&mut self, verdict: Verdict, route: Route) {
        self.route = Some(route);
        self.code = match verdict {
            Verdict::WellPosed => Code::WellPosed,
            Verdict::IllPosed { growth, direction } => {
                self.direction_deg = direction.to_degrees();
                if let Some(growth) = growth {
                    (self.order, self.coefficient) = (growth.order.value(), growth.coefficient);
                }
                Code::IllPosed
            }
            Verdict::Marginal { .. } => Code::Marginal,
            Verdict::Indeterminate { .. } => Code::Indeterminate,
        };
    }
}

/// What can be said of a point; the numbers stand in `map.npz`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Code {
    WellPosed = 0,
    IllPosed = 1,
    Marginal = 2,
    Indeterminate = 3,
    NotFullyDeforming = 4,
    /// Out of the model's range, contradictory, or beyond what doubles hold.
    OutsideModel = 5,
    /// A yielding solid without a rate of response.
    NoResponse = 6,
}

impl Code {
    const ALL: [Self; 7] = [
        Self::WellPosed,
        Self::IllPosed,
        Self::Marginal,
        Self::Indeterminate,
        Self::NotFullyDeforming,
        Self::OutsideModel,
        Self::NoResponse,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::WellPosed => "well-posed",
            Self::IllPosed => "ill-posed",
            Self::Marginal => "marginal",
            Self::Indeterminate => "indeterminate",
            Self::NotFullyDeforming => "not fully deforming",
            Self::OutsideModel => "no such state",
            Self::NoResponse => "no response",
        }
    }

    /// Whether there is a state to judge at all.
    fn is_state(self) -> bool {
        !matches!(self, Self::NotFullyDeforming | Self::OutsideModel | Self::NoResponse)
    }
}

/// Runs the map of a case.
///
/// # Errors
/// The case is wrong everywhere on the map, or results cannot be written.
pub fn run(options: &Options, extras: Extras, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let map = *case.required_map()?;
    let extras = extras.of_map(&map);
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    if options.dry_run {
        // Some state of the map must make sense.
        let cache = AcousticTensorCache::default();
        let mut judge = Judge::new(&case, &map, Extras::default(), &cache);
        let mut first_error = None;
        let some_state = (0..map.y.points).any(|y| {
            (0..map.x.points).any(|x| match judge.point(x, y) {
                Ok(_) => true,
                Err(error) => {
                    first_error.get_or_insert(error);
                    false
                }
            })
        });
        if let (false, Some(error)) = (some_state, first_error) {
            return Err(setup::locate_in_map(&case, error));
        }
        let points = map.x.points * map.y.points;
        writeln!(stdout, "would judge {points} states: {} × {}", map.x, map.y)?;
        for name in output::MAP {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }
    let points = sweep(options, &case, &map, extras)?;
    let figure = figure(&case, &map, &points);
    let summary = Summary::new(&map, &points);
    let words = summary.words(&case, &map);
    let json = format!("{:#}\n", summary.json(&case, &map));

    folder.open()?;
    folder.write("map.png", &figure.draw(figures::Format::Png)?)?;
    folder.write("map.svg", &figure.draw(figures::Format::Svg)?)?;
    folder.write("map.csv", &csv(&case, &map, &points, extras)?)?;
    folder.write("map.npz", &npz(&case, &map, &points, extras)?)?;
    folder.write("map.json", json.as_bytes())?;
    folder.write("map.txt", words.as_bytes())?;
    match options.format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            writeln!(stdout, "picture: {}", folder.path().join("map.png").display())?;
        }
    }
    Ok(())
}

/// Judges one point after another; one per thread. Only the swept numbers of its case change.
struct Judge<'a> {
    case: Case,
    map: &'a Map,
    extras: Extras,
    workspace: Workspace,
    solids: SolidAssessor<'a>,
    /// The model of a flow, whose constants are set for each point, and the list by way of which they are.
    model: Option<Model>,
    constants: Vec<f64>,
}

impl<'a> Judge<'a> {
    fn new(case: &Case, map: &'a Map, extras: Extras, cache: &'a AcousticTensorCache) -> Self {
        let (workspace, solids) = (Workspace::default(), SolidAssessor::new(cache));
        let (model, constants) = (None, Vec::new());
        Self { case: case.clone(), map, extras, workspace, solids, model, constants }
    }

    fn point(&mut self, x: usize, y: usize) -> Result<Point, StateError> {
        self.case.set(self.map.x.parameter, self.map.x.value(x));
        self.case.set(self.map.y.parameter, self.map.y.value(y));
        match self.case.kind {
            Kind::Flow(_) => self.flow(),
            Kind::Solid(_) => match self.solid() {
                Err(StateError::NoResponse(_)) => Ok(Point::empty(Code::NoResponse)),
                judged => judged,
            },
        }
    }

    fn solid(&mut self) -> Result<Point, StateError> {
        let solid = setup::solid::solid(&self.case)?;
        let (assessment, of_polynomial) = self.solids.assess(&solid)?;
        let mut point = Point::empty(Code::WellPosed);
        if self.extras.growth_rate {
            let wave = &self.case.numbers.wave;
            point.growth_rate = solids::growth_rate(&solid, normal(wave), wave.number)?;
        }
        if self.extras.bound && assessment.verdict == Verdict::WellPosed {
            let found = of_polynomial
                .as_ref()
                .and_then(|found| bound::supremum(&self.solids.plane.pencil, found, 0.0));
            point.bound = match found {
                Some(supremum) => supremum.rate,
                None if solid.keeps_energy() => 0.0,
                None => f64::NAN,
            };
        }
        point.speeds = Some(Speeds {
            hyperbolicity: assessment.hyperbolicity,
            flutter: assessment.extremes.flutter.map_or(0.0, |flutter| flutter.growth),
            least_squared: match assessment.is_stationary() {
                true => 0.0,
                false => assessment.extremes.slowest.speed_squared,
            },
            least_normal_deg: angles_deg(assessment.extremes.slowest.normal),
        });
        point.decide(assessment.verdict.clone(), Route::ModelBlind);
        if let Some([direction, elevation]) = assessment.direction_deg() {
            (point.direction_deg, point.elevation_deg) = (direction, elevation);
        }
        Ok(point)
    }

    fn flow(&mut self) -> Result<Point, StateError> {
        let Self { case, extras, workspace, model, constants, .. } = self;
        let mut point = Point::empty(Code::NotFullyDeforming);
        let model = match model {
            Some(model) => {
                case.set_constants(model, constants)?;
                model
            }
            None => model.insert(case.flow_model()?),
        };
        let Background::FullyDeforming(flow) = model.background(&case.state())? else {
            return Ok(point);
        };
        point.noncoaxiality_bound_deg =
            model.noncoaxiality_bound().map_or(f64::NAN, f64::to_degrees);
        let (verdict, route) = if extras.admits_closed_forms() {
            workspace.decide(model, &flow)?
        } else {
            let assessment = workspace.assess(model, &flow)?;
            if extras.growth_rate && !workspace.pencil.is_singular() {
                let wave = case.numbers.wave;
                point.growth_rate = workspace.growth(wave.number, radians(wave.direction_deg));
            }
            if extras.bound && assessment.verdict == Verdict::WellPosed {
                let least = model.gradient_wave_number(&flow);
                point.bound = bound::supremum(&workspace.pencil, &assessment, least)
                    .map_or(f64::NAN, |s| s.rate);
            }
            (assessment.verdict, Route::ModelBlind)
        };
        point.decide(verdict, route);
        Ok(point)
    }
}

/// All points, x running fastest. The same for any number of threads: each point is judged alone.
fn sweep(options: &Options, case: &Case, map: &Map, extras: Extras) -> Result<Vec<Point>, Error> {
    let (nx, ny) = (map.x.points, map.y.points);
    let mut points: Vec<Point> = Vec::new();
    points.try_reserve_exact(nx * ny).map_err(|_| Error::Memory { points: nx * ny })?;
    points.resize(nx * ny, Point::empty(Code::OutsideModel));

    let pool = crate::pool(options.threads)?;
    // What elastic moduli make in space is used again as long as they stay.
    let is_modulus = |sweep: &Sweep| sweep.parameter.name().starts_with("model.");
    let is_transposed = is_modulus(&map.x) && !is_modulus(&map.y) && case.yields.is_some();
    let place = |index: usize| match is_transposed {
        true => [index / ny, index % ny],
        false => [index % nx, index / nx],
    };
    let cache = AcousticTensorCache::default();
    let progress = Progress::new("judging states", (nx * ny) as u64);
    let first_error = pool.install(|| {
        points
            .par_chunks_mut(64)
            .enumerate()
            .map_init(
                || Judge::new(case, map, extras, &cache),
                |judge, (chunk, block)| {
                    let mut first_error = None;
                    for (offset, point) in block.iter_mut().enumerate() {
                        let index = chunk * 64 + offset;
                        let [x, y] = place(index);
                        match judge.point(x, y) {
                            Ok(judged) => *point = judged,
                            Err(error) => {
                                first_error.get_or_insert((index, error));
                            }
                        }
                    }
                    progress.tick(block.len() as u64);
                    first_error
                },
            )
            .flatten()
            .min_by_key(|(index, _)| *index)
    });
    drop(progress);
    if is_transposed {
        let by_column = points.clone();
        for (index, point) in by_column.into_iter().enumerate() {
            let [x, y] = place(index);
            points[y * nx + x] = point;
        }
    }
    // A map may reach beyond the model's range; a map that lies outside altogether is a mistake.
    match first_error {
        Some((_, error)) if points.iter().all(|p| p.code == Code::OutsideModel) => {
            Err(setup::locate_in_map(case, error))
        }
        _ => Ok(points),
    }
}

fn is_solid(case: &Case) -> bool {
    matches!(case.kind, Kind::Solid(_))
}

fn columns(case: &Case, points: &[Point], extras: Extras) -> Vec<(&'static str, Vec<f64>)> {
    let column = |f: fn(&Point) -> f64| points.iter().map(f).collect::<Vec<_>>();
    let mut columns = vec![
        ("order", column(|p| p.order)),
        ("coefficient", column(|p| p.coefficient)),
        ("direction_deg", column(|p| p.direction_deg)),
    ];
    match case.kind {
        Kind::Flow(_) => {
            columns.push(("noncoaxiality_bound_deg", column(|p| p.noncoaxiality_bound_deg)));
        }
        Kind::Solid(_) => {
            let speed = |f: fn(&Speeds) -> f64| {
                points.iter().map(|p| p.speeds.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>()
            };
            columns.extend([
                ("elevation_deg", column(|p| p.elevation_deg)),
                ("flutter", speed(|s| s.flutter)),
                ("least_squared_speed", speed(|s| s.least_squared)),
                ("slowest_direction_deg", speed(|s| s.least_normal_deg[0])),
                ("slowest_elevation_deg", speed(|s| s.least_normal_deg[1])),
            ]);
        }
    }
    if extras.growth_rate {
        columns.push(("growth_rate", column(|p| p.growth_rate)));
    }
    if extras.bound {
        columns.push(("bound", column(|p| p.bound)));
    }
    columns
}

fn values(sweep: &Sweep) -> Vec<f64> {
    (0..sweep.points).map(|i| sweep.value(i)).collect()
}

fn csv(case: &Case, map: &Map, points: &[Point], extras: Extras) -> Result<Vec<u8>, Error> {
    let columns = columns(case, points, extras);
    let (x, y) = (map.x.parameter.name(), map.y.parameter.name());
    let mut header = vec![x.as_str(), y.as_str(), "verdict", "route"];
    header.extend(is_solid(case).then_some("hyperbolicity"));
    header.extend(columns.iter().map(|(name, _)| *name));
    let rows = points.iter().enumerate().map(|(index, point)| {
        let mut row: Vec<files::csv::Cell> = vec![
            map.x.value(index % map.x.points).into(),
            map.y.value(index / map.x.points).into(),
            point.code.name().into(),
            point.route.map_or("", Route::name).into(),
        ];
        if is_solid(case) {
            row.push(point.speeds.map_or("", |speeds| speeds.hyperbolicity.name()).into());
        }
        row.extend(columns.iter().map(|(_, values)| files::csv::Cell::from(values[index])));
        row
    });
    Ok(files::csv::table(&header, rows)?)
}

/// Axes stand under their parameters' names; fields have shape (y, x).
fn npz(case: &Case, map: &Map, points: &[Point], extras: Extras) -> Result<Vec<u8>, Error> {
    let shape = [map.y.points, map.x.points];
    let mut npz = files::npz::Npz::new();
    let (x, y) = (map.x.parameter.name(), map.y.parameter.name());
    npz.add_f64(&x, &[map.x.points], &values(&map.x))?;
    npz.add_f64(&y, &[map.y.points], &values(&map.y))?;
    npz.add_text("axes", &[2], &[&y, &x])?;
    npz.add_text("units", &[2], &[map.y.parameter.unit(), map.x.parameter.unit()])?;
    npz.add_text("verdict_names", &[Code::ALL.len()], &Code::ALL.map(Code::name))?;
    npz.add_i8("verdict", &shape, &points.iter().map(|p| p.code as i8).collect::<Vec<_>>())?;
    let [closed_form, model_blind] = Route::ALL.map(Route::name);
    npz.add_text("route_names", &[3], &["none", closed_form, model_blind])?;
    let route = |p: &Point| match p.route {
        None => 0,
        Some(Route::ClosedForm) => 1,
        Some(Route::ModelBlind) => 2,
    };
    npz.add_i8("route", &shape, &points.iter().map(route).collect::<Vec<_>>())?;
    if is_solid(case) {
        let names = ["none"].into_iter().chain(Hyperbolicity::ALL.map(Hyperbolicity::name));
        npz.add_text("hyperbolicity_names", &[5], &names.collect::<Vec<_>>())?;
        let number = |p: &Point| p.speeds.map_or(0, |speeds| 1 + speeds.hyperbolicity as i8);
        npz.add_i8("hyperbolicity", &shape, &points.iter().map(number).collect::<Vec<_>>())?;
    }
    for (name, values) in columns(case, points, extras) {
        npz.add_f64(name, &shape, &values)?;
    }
    Ok(npz.finish()?)
}

/// What a map says in numbers.
struct Summary {
    /// Points by [`Code`].
    counts: [usize; 7],
    /// Verdicts by route, in the order of [`Route::ALL`].
    routes: [usize; 2],
    /// States of a solid by [`Hyperbolicity`].
    hyperbolicity: [usize; 4],
    /// Ill-posed points without order: unbounded at finite wave numbers.
    unbounded: usize,
    /// Index and point of the worst growth: highest order, then greatest coefficient.
    worst: Option<(usize, Point)>,
    /// For some values of y: the intervals of x that are well-posed.
    intervals: Vec<(f64, Vec<[f64; 2]>)>,
}

impl Summary {
    fn new(map: &Map, points: &[Point]) -> Self {
        let mut counts = [0; 7];
        let mut worst: Option<(usize, Point)> = None;
        for (index, point) in points.iter().enumerate() {
            counts[point.code as usize] += 1;
            let key = |p: &Point| (p.order, p.coefficient);
            if point.order.is_finite() && worst.is_none_or(|(_, w)| key(point) > key(&w)) {
                worst = Some((index, *point));
            }
        }
        let unbounded =
            points.iter().filter(|p| p.code == Code::IllPosed && p.order.is_nan()).count();
        let routes = Route::ALL.map(|r| points.iter().filter(|p| p.route == Some(r)).count());
        let hyperbolicity = Hyperbolicity::ALL.map(|h| {
            points.iter().filter(|p| p.speeds.is_some_and(|s| s.hyperbolicity == h)).count()
        });
        let last = map.y.points - 1;
        let mut rows = vec![0, last / 4, last / 2, 3 * last / 4, last];
        rows.dedup();
        let intervals = rows
            .into_iter()
            .map(|row| {
                let codes = &points[row * map.x.points..][..map.x.points];
                (map.y.value(row), well_posed_intervals(&map.x, codes))
            })
            .collect();
        Self { counts, routes, hyperbolicity, unbounded, worst, intervals }
    }

    fn states(&self) -> usize {
        Code::ALL.iter().filter(|c| c.is_state()).map(|&c| self.counts[c as usize]).sum()
    }

    /// Share of the states that are well-posed.
    fn share(&self) -> Option<f64> {
        let states = self.states();
        (states > 0).then(|| self.counts[Code::WellPosed as usize] as f64 / states as f64)
    }

    fn words(&self, case: &Case, map: &Map) -> String {
        let mut lines = vec![case_title(case)];
        let (x, y) = (map.x.parameter, map.y.parameter);
        lines.push(format!(
            "{}: {} × {} points over {} ({}) and {} ({})",
            case.medium().title(),
            map.x.points,
            map.y.points,
            x.label(),
            x.name(),
            y.label(),
            y.name()
        ));
        for code in Code::ALL {
            let count = self.counts[code as usize];
            if count > 0 {
                let all = (map.x.points * map.y.points) as f64;
                lines.push(format!(
                    "  {:5.1} %  {} ({count} points)",
                    100.0 * count as f64 / all,
                    code.name()
                ));
            }
        }
        for (hyperbolicity, count) in Hyperbolicity::ALL.into_iter().zip(self.hyperbolicity) {
            if count > 0 {
                lines.push(format!("  {count} points: {}", hyperbolicity.words()));
            }
        }
        if let Some(share) = self.share() {
            let which = if is_solid(case) { "states that respond" } else { "states that flow" };
            lines.push(format!("Of the {which}, {} % are well-posed.", short(100.0 * share)));
        }
        if self.unbounded > 0 {
            lines.push(format!(
                "At {} ill-posed points the growth rate is unbounded at finite wave numbers already.",
                self.unbounded
            ));
        }
        let step = if map.x.points > 1 { map.x.value(1) - map.x.value(0) } else { 0.0 };
        lines.push(format!(
            "Where the well-posed states lie, to within a step of {}{} of the grid:",
            short(step.abs()),
            unit(x.unit())
        ));
        for (value, intervals) in &self.intervals {
            let at = format!("  at {} = {}{}:", y.label(), short(*value), unit(y.unit()));
            let list: Vec<String> = intervals
                .iter()
                .map(|[a, b]| format!("{}{u} … {}{u}", short(*a), short(*b), u = unit(x.unit())))
                .collect();
            lines.push(if list.is_empty() {
                format!("{at} nowhere well-posed")
            } else {
                format!("{at} well-posed for {} in {}", x.label(), list.join(" and "))
            });
        }
        if let Some((index, worst)) = self.worst {
            let order = superscript(worst.order);
            lines.push(format!(
                "Worst growth on this grid: Re ς ≈ {} k{order} (1/s, k in 1/m) as k → ∞, for waves at {}°{}, at {} = {}{}, {} = {}{}.",
                short(worst.coefficient),
                short(worst.direction_deg),
                match worst.elevation_deg {
                    up if up.is_nan() || up == 0.0 => String::new(),
                    up => format!(", {}° above the plane", short(up)),
                },
                x.label(),
                short(map.x.value(index % map.x.points)),
                unit(x.unit()),
                y.label(),
                short(map.y.value(index / map.x.points)),
                unit(y.unit()),
            ));
        }
        let blind = match (is_solid(case), case.numbers.dimensions) {
            (false, _) => ROUTE,
            (true, 3) => SPACE_ROUTE,
            (true, _) => PLANE_ROUTE,
        };
        for (count, route) in self.routes.into_iter().zip([CLOSED_FORM, blind]) {
            if count > 0 {
                lines.push(format!("Route of {count} verdicts: {route}"));
            }
        }
        lines.push(VALIDITY.into());
        lines.join("\n") + "\n"
    }

    fn json(&self, case: &Case, map: &Map) -> Value {
        let axis = |s: &Sweep| {
            json!({
                "parameter": s.parameter.name(), "unit": s.parameter.unit(),
                "from": s.from, "to": s.to, "points": s.points,
            })
        };
        let intervals: Vec<Value> =
            self.intervals.iter().map(|(y, intervals)| json!({ "y": y, "x": intervals })).collect();
        let (x, y) = (&map.x, &map.y);
        let mut value = json!({
            "title": case.title,
            "model": case.kind.name(),
            "x": axis(x),
            "y": axis(y),
            "points": Code::ALL.iter().map(|&c| (c.name().to_owned(), self.counts[c as usize].into()))
                .collect::<serde_json::Map<_, _>>(),
            "unbounded_at_finite_wave_number": self.unbounded,
            "well_posed_share": self.share(),
            "well_posed_intervals": intervals,
            "worst": self.worst.map(|(index, p)| json!({
                "x": x.value(index % x.points), "y": y.value(index / x.points),
                "order": p.order, "coefficient": p.coefficient, "direction_deg": p.direction_deg,
            })),
            "route": Route::ALL.iter().zip(self.routes)
                .map(|(route, count)| (route.name().to_owned(), count.into()))
                .collect::<serde_json::Map<_, _>>(),
        });
        if is_solid(case) {
            value["yield"] = case.yields.map(|set| set.name).into();
            value["hyperbolicity"] = Hyperbolicity::ALL
                .iter()
                .zip(self.hyperbolicity)
                .map(|(h, count)| (h.name().to_owned(), count.into()))
                .collect::<serde_json::Map<_, _>>()
                .into();
            if let (Some((_, worst)), false) = (&self.worst, value["worst"].is_null()) {
                value["worst"]["elevation_deg"] = worst.elevation_deg.into();
            }
        }
        value
    }
}

/// First and last value of x of each run of neighbouring well-posed points.
fn well_posed_intervals(x: &Sweep, row: &[Point]) -> Vec<[f64; 2]> {
    let mut intervals: Vec<[f64; 2]> = Vec::new();
    let mut was_well = false;
    for (i, point) in row.iter().enumerate() {
        let is_well = point.code == Code::WellPosed;
        match intervals.last_mut() {
            Some(last) if is_well && was_well => last[1] = x.value(i),
            _ if is_well => intervals.push([x.value(i); 2]),
            _ => {}
        }
        was_well = is_well;
    }
    intervals
}

fn figure(case: &Case, map: &Map, points: &[Point]) -> VerdictMap {
    let axis = |s: &Sweep| Axis {
        label: match s.parameter.unit() {
            "" => s.parameter.label(),
            "deg" => format!("{} (°)", s.parameter.label()),
            unit => format!("{} ({unit})", s.parameter.label()),
        },
        values: values(s),
    };
    // One category per order of growth, and in solids per kind of speeds; highest order first.
    type Growing = (f64, Option<Hyperbolicity>);
    let growing = |p: &Point| -> Growing { (p.order, p.speeds.map(|s| s.hyperbolicity)) };
    let mut kinds: Vec<Growing> =
        points.iter().filter(|p| p.order.is_finite()).map(growing).collect();
    let place = |speeds: &Option<Hyperbolicity>| speeds.map_or(0, |h| h as u8);
    kinds.sort_by(|a, b| b.0.total_cmp(&a.0).then(place(&a.1).cmp(&place(&b.1))));
    kinds.dedup();
    let mut categories = vec![Category { label: "well-posed".into(), look: Look::WellPosed }];
    categories.extend(kinds.iter().map(|(order, speeds)| Category {
        label: format!(
            "ill-posed{}: Re ς grows as k{}",
            speeds.map_or(String::new(), |speeds| format!(" by {}", speeds.cause())),
            superscript(*order)
        ),
        look: Look::IllPosed,
    }));
    let first_other = categories.len();
    categories.extend(
        [
            ("ill-posed: unbounded at finite k", Look::UnboundedAtFiniteWaveNumber),
            ("marginal: no sign asserted", Look::Marginal),
            ("indeterminate", Look::Indeterminate),
            ("not fully deforming", Look::Indeterminate),
            ("no such state", Look::OutsideModel),
            ("no response while yielding", Look::Indeterminate),
        ]
        .map(|(label, look)| Category { label: label.into(), look }),
    );
    let category = points
        .iter()
        .map(|p| {
            let index = match p.code {
                Code::WellPosed => 0,
                Code::IllPosed => match kinds.iter().position(|&kind| kind == growing(p)) {
                    Some(i) => 1 + i,
                    None => first_other,
                },
                Code::Marginal => first_other + 1,
                Code::Indeterminate => first_other + 2,
                Code::NotFullyDeforming => first_other + 3,
                Code::OutsideModel => first_other + 4,
                Code::NoResponse => first_other + 5,
            };
            u8::try_from(index).unwrap_or(u8::MAX)
        })
        .collect();
    let mut orders: Vec<f64> = kinds.iter().map(|(order, _)| *order).collect();
    orders.dedup();
    // Coefficients of different orders do not compare; rates at one wave number do.
    let wave_number = case.numbers.wave.number;
    let (level_label, level): (String, fn(&Point, f64) -> f64) = match orders[..] {
        [] | [_] => {
            let order = orders.first().copied().unwrap_or(1.0);
            let label = format!(
                "growth coefficient lim Re ς / k{} ({})",
                superscript(order),
                coefficient_unit(order)
            );
            (label, |p, _| p.coefficient)
        }
        _ => {
            let label = format!("leading growth rate at k = {} 1/m (1/s)", short(wave_number));
            (label, |p, k| p.coefficient * k.cr_powf(p.order))
        }
    };
    VerdictMap {
        title: case_title(case),
        subtitle: subtitle(case, map),
        x: axis(&map.x),
        y: axis(&map.y),
        categories,
        category,
        level: points.iter().map(|p| level(p, wave_number)).collect(),
        level_label,
        curves: noncoaxiality_curves(map, points),
    }
}

/// The model, and the numbers that the map holds fixed and that matter most for the verdict.
fn subtitle(case: &Case, map: &Map) -> String {
    let fixed = [
        "model.friction_angle_deg",
        "model.dilatancy_angle_deg",
        "model.rotational_strength",
        "background.noncoaxiality_deg",
        "yield.shear_friction",
        "yield.shear_dilatancy",
        "yield.friction",
        "yield.dilatancy",
    ]
    .into_iter()
    .filter_map(Parameter::find)
    .filter(|parameter| parameter.key().is_used_by(case.medium()))
    .filter(|&parameter| parameter != map.x.parameter && parameter != map.y.parameter)
    .filter_map(|parameter| {
        let value = parameter.get(&case.numbers)?;
        Some(format!("{} = {}{}", parameter.label(), short(value), unit(parameter.unit())))
    });
    let space = match (case.kind, case.numbers.dimensions) {
        (Kind::Solid(_), 3) => Some("in space".to_owned()),
        (Kind::Solid(_), _) => Some("plane strain".to_owned()),
        _ => None,
    };
    let active = case.active.iter().map(|active| {
        let all = case.medium().condition_names();
        let names: Vec<&str> = active.iter().map(|&index| all[index]).collect();
        format!("active {}", names.join(" "))
    });
    [case.medium().title()]
        .into_iter()
        .chain(space)
        .chain(active)
        .chain(fixed)
        .collect::<Vec<_>>()
        .join(", ")
}

/// The model's own bound on |Δ|, where Δ is one of the axes.
fn noncoaxiality_curves(map: &Map, points: &[Point]) -> Vec<Curve> {
    const DELTA: &str = "background.noncoaxiality_deg";
    let (nx, ny) = (map.x.points, map.y.points);
    let (along_x, count) = match (map.x.parameter.name(), map.y.parameter.name()) {
        (x, _) if x == DELTA => (true, ny),
        (_, y) if y == DELTA => (false, nx),
        _ => return Vec::new(),
    };
    let curve = |sign: f64| {
        let points: Vec<[f64; 2]> = (0..count)
            .filter_map(|i| {
                let slice: &mut dyn Iterator<Item = &Point> = if along_x {
                    &mut points[i * nx..][..nx].iter()
                } else {
                    &mut points[i..].iter().step_by(nx)
                };
                let bound =
                    slice.map(|p| p.noncoaxiality_bound_deg).find(|b| b.is_finite())? * sign;
                let (range, other) = if along_x { (&map.x, &map.y) } else { (&map.y, &map.x) };
                let inside = bound >= range.from.min(range.to) && bound <= range.from.max(range.to);
                let other = other.value(i);
                inside.then_some(if along_x { [bound, other] } else { [other, bound] })
            })
            .collect();
        Curve { label: "bound on |Δ| for the leading order, closed form".into(), points }
    };
    [curve(-1.0), curve(1.0)].into_iter().filter(|c| c.points.len() > 1).collect()
}
