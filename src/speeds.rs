//! `wellposed speeds`: characteristic speeds of a solid against the direction, elastic and yielding.

use crate::case::{Case, Wave, Yield};
use crate::hyperbolicity::{Judge, Judged, Spheres};
use crate::output::{self, ResultFolder};
use crate::progress::Progress;
use crate::solid::{Solid, angles_deg, flutter_json, normal, normal_json, normal_words as at};
use crate::words::{case_title, short};
use crate::{Error, Format, Options};
use analysis::circle::Circle;
use analysis::waves::squared_speeds;
use figures::{Response, SpeedCurve, SpeedsFigure, SphereFigure, SphereMark, Vanishing};
use models::elementary::Elementary;
use num_complex::Complex64;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

/// Directions of the curves over half a turn, both ends included.
const DIRECTIONS: usize = 721;
/// Degrees between the directions on the sphere.
const SPHERE_STEP: usize = 1;
/// Speeds that differ by less than this part of the greatest are one curve.
const EQUAL: f64 = 1e-6;
/// Parts of the greatest c² that count as zero: of a real part, and of an imaginary one, which a double
/// root has by the square root of the rounding.
const ZERO: f64 = 1e-12;
const REAL: f64 = 1e-6;

/// The squared speeds in one direction, by descending real part.
type Speeds = Vec<Complex64>;

/// Elastic speeds and those while yielding, at an angle in degrees.
type Responses = dyn Fn(f64) -> (Speeds, Speeds);

/// What was found.
struct Found {
    solid: Solid,
    judged: Judged,
    /// Directions, degrees, with elastic speeds and those while yielding.
    curves: Vec<(f64, Speeds, Speeds)>,
    /// Sectors of flutter in the plane of the curves, degrees.
    flutter: Vec<[f64; 2]>,
    /// Sectors of imaginary speeds, c² < 0, likewise.
    imaginary: Vec<[f64; 2]>,
    /// Directions of vanishing speeds in that plane, degrees, and what they are.
    vanishing: Vec<(f64, &'static str)>,
    /// Whether a speed vanishes in all directions.
    always_still: bool,
    /// On the hemisphere, azimuth running fastest: the slowest real speed, NaN where one is complex.
    sphere: Option<Vec<f64>>,
    /// Greatest c², m²/s².
    largest: f64,
}

/// Runs the verb.
///
/// # Errors
/// The case is wrong, or results cannot be written.
pub fn run(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let solid = Solid::of(&case).map_err(|error| case.locate(error))?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    let has_sphere = solid.dimensions == 3;
    if options.dry_run {
        writeln!(stdout, "would find speeds in {DIRECTIONS} directions")?;
        for name in output::SPEEDS.iter().filter(|name| has_sphere || !name.starts_with("sphere")) {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }
    let pool = crate::pool(options.threads)?;
    let found = pool.install(|| find(&case, solid))?;
    let json = format!("{:#}\n", report(&case, &found));
    let words = words(&case, &found);
    let figure = figure(&case, &found);

    folder.open()?;
    folder.write("speeds.png", &figure.draw(figures::Format::Png)?)?;
    folder.write("speeds.svg", &figure.draw(figures::Format::Svg)?)?;
    folder.write("speeds.csv", &csv(&found)?)?;
    folder.write("speeds.json", json.as_bytes())?;
    folder.write("speeds.txt", words.as_bytes())?;
    if let Some(values) = &found.sphere {
        let figure = sphere_figure(&case, &found, values);
        folder.write("sphere.png", &figure.draw(figures::Format::Png)?)?;
        folder.write("sphere.svg", &figure.draw(figures::Format::Svg)?)?;
        folder.write("sphere.csv", &sphere_csv(values)?)?;
    }
    match options.format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            writeln!(stdout, "picture: {}", folder.path().join("speeds.png").display())?;
        }
    }
    Ok(())
}

fn find(case: &Case, solid: Solid) -> Result<Found, Error> {
    let located = |error: crate::frozen::StateError| error.locate(case);
    let wave = case.numbers.wave;
    let spheres = Spheres::default();
    let (judged, _) = Judge::new(&spheres).judge(&solid).map_err(located)?;
    let directions = (0..DIRECTIONS).map(|i| 180.0 * i as f64 / (DIRECTIONS - 1) as f64);
    // Both responses at an angle in degrees.
    let (at, sphere, circle): (Box<Responses>, _, _) = if solid.dimensions == 2 {
        let rates = solid.rates().map_err(located)?;
        let (elastic, circle) = (Circle::new(&solid.elastic_rates()), Circle::new(&rates));
        let yielding = circle.clone();
        let at = move |degrees: f64| {
            let angle = degrees.to_radians();
            (elastic.squared_speeds(angle), yielding.squared_speeds(angle))
        };
        (Box::new(at), None, Some(circle))
    } else {
        let (elastic, rates) = (solid.elastic_rates::<3>(), solid.rates::<3>().map_err(located)?);
        let sphere = hemisphere(&rates);
        let at = move |direction_deg: f64| {
            let normal = normal(&Wave { direction_deg, ..wave });
            (squared_speeds(&elastic, normal), squared_speeds(&rates, normal))
        };
        (Box::new(at), Some(sphere), None)
    };
    let curves: Vec<(f64, Speeds, Speeds)> = directions
        .map(|degrees| {
            let (elastic, yielding) = at(degrees);
            (degrees, elastic, yielding)
        })
        .collect();
    let largest = curves.iter().flat_map(|(_, e, _)| e).map(|c| c.re).fold(0.0, f64::max);
    let is_complex = |c: &Complex64| c.im.abs() > REAL * largest;
    let is_imaginary = |c: &Complex64| !is_complex(c) && c.re < -ZERO * largest;
    let holds =
        |is_such: &dyn Fn(&Complex64) -> bool, degrees: f64| at(degrees).1.iter().any(is_such);
    let flutter = match &circle {
        Some(circle) => {
            circle.flutter_sectors().into_iter().map(|s| s.map(f64::to_degrees)).collect()
        }
        None => sectors(|degrees| holds(&is_complex, degrees)),
    };
    let imaginary = sectors(|degrees| holds(&is_imaginary, degrees));
    let vanishing = match &circle {
        Some(circle) => circle
            .vanishing()
            .into_iter()
            .map(|angle| (angle.to_degrees(), standstill(&solid, angle)))
            .collect(),
        // Between real and imaginary speeds.
        None => {
            let ends = imaginary.iter().flatten().map(|end| end.rem_euclid(180.0));
            ends.map(|end| (end, "stationary discontinuity")).collect()
        }
    };
    let always_still = circle.is_some_and(|circle| circle.is_always_still());
    Ok(Found {
        solid,
        judged,
        curves,
        flutter,
        imaginary,
        vanishing,
        always_still,
        sphere,
        largest,
    })
}

/// Why a wave stands still whose normal has that angle (rad).
fn standstill(solid: &Solid, angle: f64) -> &'static str {
    const NEAR: f64 = 1e-5; // a zero that is touched is known to the square root of the rounding
    let active = solid.plastic.iter().flat_map(|plastic| &plastic.active);
    let (sin, cos) = angle.cr_sin_cos();
    let slips = |normal: &models::cosserat::stress::Stress| {
        // The layers normal to x₁ slip where σ₂₁ is limited, those normal to x₂ where σ₁₂ is.
        let sheared = |i: usize, j: usize| normal.force[i][j] != 0.0 || normal.couple[2][j] != 0.0;
        (sin.abs() < NEAR && sheared(1, 0)) || (cos.abs() < NEAR && sheared(0, 1))
    };
    let is_layered = solid.plastic.as_ref().is_some_and(|plastic| {
        matches!(plastic.set, models::plasticity::parameters::YieldSet::Interlayer(_))
    });
    match is_layered && active.map(|condition| &condition.normal).any(slips) {
        true => "slip along the layer",
        false => "stationary discontinuity",
    }
}

/// The slowest real speed over the hemisphere; NaN where c² is complex or negative.
fn hemisphere(rates: &models::rates::RateEquations<3>) -> Vec<f64> {
    let (polar, azimuth) = angles();
    let progress = Progress::new("speeds over the sphere", polar.len() as u64);
    polar
        .par_iter()
        .flat_map_iter(|&polar| {
            let (sin, cos) = polar.to_radians().cr_sin_cos();
            let row: Vec<f64> = azimuth
                .iter()
                .map(|azimuth| {
                    let (y, x) = azimuth.to_radians().cr_sin_cos();
                    slowest(&squared_speeds(rates, [sin * x, sin * y, cos]))
                })
                .collect();
            progress.tick(1);
            row
        })
        .collect()
}

/// The slowest of the waves that travel; NaN where some c² is complex or negative.
fn slowest(squares: &[Complex64]) -> f64 {
    let largest = squares.iter().map(|c| c.norm()).fold(0.0, f64::max);
    if squares.iter().any(|c| c.im.abs() > REAL * largest || c.re < -ZERO * largest) {
        return f64::NAN;
    }
    let travelling = squares.iter().map(|c| c.re).filter(|&c| c > ZERO * largest);
    travelling.fold(f64::INFINITY, f64::min).sqrt()
}

fn angles() -> (Vec<f64>, Vec<f64>) {
    let list = |to: usize| (0..to).step_by(SPHERE_STEP).map(|degrees| degrees as f64).collect();
    (list(91), list(360))
}

/// Sectors of directions, degrees, in which something holds; ends by halving. `[0, 180]` where it does
/// all around.
fn sectors(holds: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let step = 180.0 / (DIRECTIONS - 1) as f64;
    let angles = (0..DIRECTIONS - 1).map(|i| step * i as f64);
    let is_edge = |&angle: &f64| holds(angle) != holds(angle + step);
    let edge = |angle: f64| {
        let (mut low, mut high) = (angle, angle + step);
        let was = holds(low);
        for _ in 0..45 {
            let middle = 0.5 * (low + high);
            if holds(middle) == was { low = middle } else { high = middle }
        }
        (0.5 * (low + high), !was)
    };
    let edges: Vec<(f64, bool)> = angles.filter(is_edge).map(edge).collect();
    let Some(first) = edges.first() else {
        return if holds(0.0) { vec![[0.0, 180.0]] } else { Vec::new() };
    };
    let after = edges.iter().skip(1).map(|edge| edge.0).chain([first.0 + 180.0]);
    let sectors = edges.iter().zip(after).filter(|((_, begins), _)| *begins);
    sectors.map(|(&(from, _), to)| [from, to]).collect()
}

impl Found {
    /// Whether the slowest wave is as slow in every direction, within what curves show.
    fn slowest_is_everywhere(&self) -> bool {
        let slowest = self.judged.extremes.slowest.speed_squared.max(0.0).sqrt();
        let is_same = |c: f64| (c - slowest).abs() <= EQUAL * self.largest.sqrt();
        match &self.sphere {
            Some(values) => values.iter().all(|&c| is_same(c)),
            None => self.curves.iter().all(|(_, _, yielding)| {
                let least = yielding.iter().map(|c| c.re).fold(f64::INFINITY, f64::min);
                is_same(least.max(0.0).sqrt())
            }),
        }
    }
}

fn is_slowest_of_none(found: &Found) -> bool {
    !found.judged.extremes.slowest.speed_squared.is_finite()
}

fn report(case: &Case, found: &Found) -> Value {
    let Judged { verdict, extremes, hyperbolicity, route, .. } = &found.judged;
    json!({
        "model": case.kind.name(),
        "yield": case.yields.map(Yield::name),
        "dimensions": found.solid.dimensions,
        "verdict": verdict.name(),
        "hyperbolicity": hyperbolicity.name(),
        "flutter": flutter_json(extremes.flutter),
        "slowest": {
            "squared_speed": match is_slowest_of_none(found) {
                true => Value::Null,
                false => extremes.slowest.speed_squared.into(),
            },
            "rounding": extremes.slowest.rounding,
            "normal": normal_json(extremes.slowest.normal),
        },
        "flutter_sectors_deg": found.flutter,
        "imaginary_sectors_deg": found.imaginary,
        "always_still": found.always_still,
        "vanishing": found.vanishing.iter()
            .map(|(degrees, what)| json!({ "direction_deg": degrees, "what": what }))
            .collect::<Vec<_>>(),
        "elevation_deg": case.numbers.wave.elevation_deg,
        "route": route,
    })
}

/// Least and greatest of a speed over the directions in which it is real.
fn range(speeds: impl Iterator<Item = Complex64>, largest: f64) -> Option<[f64; 2]> {
    let real = speeds.filter(|c| c.im.abs() <= REAL * largest && c.re >= -ZERO * largest);
    let range = real
        .map(|c| c.re.max(0.0).sqrt())
        .fold([f64::INFINITY, 0.0], |[a, b], c| [f64::min(a, c), f64::max(b, c)]);
    range[0].is_finite().then_some(range)
}

fn words(case: &Case, found: &Found) -> String {
    let mut text = format!("{}\nmodel: {}, ", case_title(case), case.medium().title());
    text += match (found.solid.dimensions, case.numbers.wave.elevation_deg) {
        (2, _) => "plane strain\n".to_owned(),
        (_, 0.0) => "in space; curves in the plane of x₁ and x₂\n".to_owned(),
        (_, up) => format!("in space; curves {}° above the plane of x₁ and x₂\n", short(up)),
    }
    .as_str();
    let waves = found.curves[0].1.len();
    let mut table = |name: &str, speeds: &dyn Fn(usize) -> Option<[f64; 2]>| {
        let _ = writeln!(text, "\nspeeds {name}, over all these directions (m/s)");
        for wave in 0..waves {
            let _ = match speeds(wave) {
                Some([_, 0.0]) => writeln!(text, "  {}  0: does not travel", wave + 1),
                Some([low, high]) if high - low <= EQUAL * high => {
                    writeln!(text, "  {}  {}", wave + 1, short(high))
                }
                Some([low, high]) => {
                    writeln!(text, "  {}  {} … {}", wave + 1, short(low), short(high))
                }
                None => writeln!(text, "  {}  never real", wave + 1),
            };
        }
    };
    let largest = found.largest;
    table("elastic", &|i| range(found.curves.iter().map(|(_, e, _)| e[i]), largest));
    if found.solid.plastic.is_some() {
        table("yielding", &|i| range(found.curves.iter().map(|(_, _, y)| y[i]), largest));
    }
    let _ = writeln!(text, "\n{}", found.judged.hyperbolicity.words());
    for [from, to] in &found.flutter {
        let _ = writeln!(
            text,
            "  complex speeds for normals from {}° to {}°",
            short(*from),
            short(*to)
        );
    }
    for [from, to] in &found.imaginary {
        let _ = writeln!(
            text,
            "  imaginary speeds for normals from {}° to {}°",
            short(*from),
            short(*to)
        );
    }
    if found.always_still {
        let _ = writeln!(text, "  a speed vanishes in all directions");
    }
    for (degrees, what) in &found.vanishing {
        let _ = writeln!(text, "  a speed vanishes for the normal at {}°: {what}", short(*degrees));
    }
    let extremes = &found.judged.extremes;
    if let Some(flutter) = extremes.flutter {
        let _ = writeln!(
            text,
            "  strongest flutter: c² = {} ± {}i m²/s², normal {}; short waves grow as {} k",
            short(flutter.speed_squared.re),
            short(flutter.speed_squared.im.abs()),
            at(flutter.normal),
            short(flutter.growth)
        );
    }
    let slowest = extremes.slowest;
    let value = match found.judged.stands_still() {
        true => "0".to_owned(),
        false => short(slowest.speed_squared),
    };
    let place = match found.slowest_is_everywhere() {
        true => "in all directions".to_owned(),
        false => format!("normal {}", at(slowest.normal)),
    };
    let _ = writeln!(text, "  slowest wave: c² = {value} m²/s², {place}");
    let _ = writeln!(text, "Verdict: {}", found.judged.verdict.name());
    text
}

fn csv(found: &Found) -> Result<Vec<u8>, Error> {
    let header = ["direction_deg", "response", "wave", "squared_speed", "squared_speed_imaginary"];
    let is_yielding = found.solid.plastic.is_some();
    let rows = found.curves.iter().flat_map(move |(degrees, elastic, yielding)| {
        let of = move |name: &'static str, speeds: &[Complex64]| -> Vec<Vec<files::csv::Cell>> {
            let row = |(wave, c): (usize, &Complex64)| -> Vec<files::csv::Cell> {
                let wave = (wave + 1) as f64;
                vec![(*degrees).into(), name.into(), wave.into(), c.re.into(), c.im.into()]
            };
            speeds.iter().enumerate().map(row).collect()
        };
        let mut rows = of("elastic", elastic);
        if is_yielding {
            rows.extend(of("yielding", yielding));
        }
        rows
    });
    Ok(files::csv::table(&header, rows)?)
}

fn sphere_csv(values: &[f64]) -> Result<Vec<u8>, Error> {
    let (polar, azimuth) = angles();
    let directions = polar.iter().flat_map(|&p| azimuth.iter().map(move |&a| (p, a)));
    let rows = directions.zip(values).map(|((polar, azimuth), value)| -> Vec<files::csv::Cell> {
        vec![polar.into(), azimuth.into(), (*value).into()]
    });
    Ok(files::csv::table(&["polar_deg", "azimuth_deg", "slowest_speed"], rows)?)
}

/// The curves of one response, those that run together as one.
fn curves(found: &Found, response: Response) -> Vec<SpeedCurve> {
    let largest = found.largest;
    let speed = |c: Complex64| match c.im.abs() > REAL * largest || c.re >= -ZERO * largest {
        true => c.sqrt().re,
        false => f64::NAN,
    };
    let mut curves: Vec<SpeedCurve> = Vec::new();
    for wave in 0..found.curves[0].1.len() {
        let points: Vec<[f64; 2]> = found
            .curves
            .iter()
            .map(|(degrees, elastic, yielding)| match response {
                Response::Elastic => [*degrees, speed(elastic[wave])],
                Response::Yielding => [*degrees, speed(yielding[wave])],
            })
            .collect();
        // What does not travel has no curve.
        if points.iter().all(|p| p[1] <= EQUAL * largest.sqrt()) {
            continue;
        }
        let runs_along = |curve: &SpeedCurve| {
            curve.points.iter().zip(&points).all(|(a, b)| {
                (a[1] - b[1]).abs() <= EQUAL * largest.sqrt() || (a[1].is_nan() && b[1].is_nan())
            })
        };
        match curves.iter_mut().find(|curve| runs_along(curve)) {
            Some(curve) => curve.multiplicity += 1,
            None => curves.push(SpeedCurve {
                label: match response {
                    Response::Elastic => "elastic".into(),
                    Response::Yielding => match curves.len() {
                        0 => "yielding, fastest".into(),
                        n => format!("yielding, no. {}", n + 1),
                    },
                },
                points,
                response,
                multiplicity: 1,
            }),
        }
    }
    curves
}

fn figure(case: &Case, found: &Found) -> SpeedsFigure {
    let mut all = curves(found, Response::Elastic);
    if found.solid.plastic.is_some() {
        all.extend(curves(found, Response::Yielding));
    }
    let place = match (found.solid.dimensions, case.numbers.wave.elevation_deg) {
        (2, _) => "plane strain".to_owned(),
        (_, 0.0) => "normals in the plane of x₁ and x₂".to_owned(),
        (_, up) => format!("normals {}° above the plane of x₁ and x₂", short(up)),
    };
    SpeedsFigure {
        title: case_title(case),
        subtitle: format!(
            "{}, {place}; angle: wave normal, anticlockwise from x₁",
            case.medium().title()
        ),
        speed_label: "characteristic speed c".into(),
        unit: "m/s".into(),
        curves: all,
        flutter: found.flutter.clone(),
        imaginary: found.imaginary.clone(),
        vanishing: found
            .vanishing
            .iter()
            .map(|&(angle_deg, what)| Vanishing { label: what.into(), angle_deg })
            .collect(),
    }
}

fn sphere_figure(case: &Case, found: &Found, values: &[f64]) -> SphereFigure {
    let (polar_deg, azimuth_deg) = angles();
    let extremes = &found.judged.extremes;
    // Of two opposite normals the one whose angles are printed.
    let mark = |label: &str, of: [f64; 3]| {
        let [direction_deg, elevation_deg] = angles_deg(of);
        let wave = Wave { direction_deg, elevation_deg, ..case.numbers.wave };
        SphereMark { label: label.into(), normal: normal(&wave) }
    };
    let mut marks = Vec::new();
    if let Some(flutter) = extremes.flutter {
        marks.push(mark("strongest flutter", flutter.normal));
    }
    if found.solid.plastic.is_some() && !found.slowest_is_everywhere() {
        let label = match extremes.slowest.speed_squared < -extremes.slowest.rounding {
            true => "normal of the strongest shear band",
            false => "slowest wave",
        };
        marks.push(mark(label, extremes.slowest.normal));
    }
    SphereFigure {
        title: case_title(case),
        subtitle: format!(
            "{}: slowest wave over all normals, opposite ones alike",
            case.medium().title()
        ),
        polar_deg,
        azimuth_deg,
        values: values.to_vec(),
        value_label: "slowest speed c (m/s)".into(),
        value_log: false,
        dark_is_low: true,
        missing_label: "complex or imaginary speeds".into(),
        marks,
    }
}
