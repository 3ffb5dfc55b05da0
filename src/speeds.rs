//! `wellposed speeds`: characteristic speeds of a solid against the direction, elastic and yielding.

use crate::case::{Case, Wave, radians};
use crate::cli::progress::Progress;
use crate::output::{self, ResultFolder};
use crate::report::format::{case_title, flutter_json, normal_json, normal_words as at, short};
use crate::setup::{self, solid::normal};
use crate::{Error, Format, Options};
use analysis::solids::{
    AcousticTensorCache, DirectionalSpeeds, SolidAssessment, SolidAssessor, angles_deg,
    slowest_speed,
};
use figures::{Response, SpeedCurve, SpeedsFigure, SphereFigure, SphereMark, Vanishing};
use models::elastoplastic::Solid;
use models::elementary::Elementary;
use models::rates::RateEquations;
use num_complex::Complex64;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

/// Degrees between the directions on the sphere.
const SPHERE_STEP: usize = 1;
/// Speeds that differ by less than this part of the greatest are one curve.
const EQUAL: f64 = 1e-6;

/// What was found.
struct Found {
    solid: Solid,
    assessment: SolidAssessment,
    speeds: DirectionalSpeeds,
    /// On the hemisphere, azimuth running fastest: the slowest real speed, NaN where one is complex.
    sphere: Option<Vec<f64>>,
}

/// Runs the verb.
///
/// # Errors
/// The case is wrong, or results cannot be written.
pub fn run(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let solid = setup::solid::solid(&case).map_err(|error| case.locate(error))?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    let has_sphere = solid.dimensions == 3;
    if options.dry_run {
        writeln!(stdout, "would find speeds in {} directions", DirectionalSpeeds::DIRECTIONS)?;
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
    let located = |error| setup::locate(case, error);
    let cache = AcousticTensorCache::default();
    let (assessment, _) = SolidAssessor::new(&cache).assess(&solid).map_err(located)?;
    let elevation = radians(case.numbers.wave.elevation_deg);
    let speeds =
        DirectionalSpeeds::new(&solid, elevation).map_err(|error| located(error.into()))?;
    let sphere = match solid.dimensions {
        2 => None,
        _ => Some(hemisphere(&solid.rates().map_err(|error| located(error.into()))?)),
    };
    Ok(Found { solid, assessment, speeds, sphere })
}

/// The slowest real speed over the hemisphere; NaN where c² is complex or negative.
fn hemisphere(rates: &RateEquations<3>) -> Vec<f64> {
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
                    slowest_speed(rates, [sin * x, sin * y, cos])
                })
                .collect();
            progress.tick(1);
            row
        })
        .collect()
}

fn angles() -> (Vec<f64>, Vec<f64>) {
    let list = |to: usize| (0..to).step_by(SPHERE_STEP).map(|degrees| degrees as f64).collect();
    (list(91), list(360))
}

impl Found {
    /// Whether the slowest wave is as slow in every direction, within what curves show.
    fn slowest_is_everywhere(&self) -> bool {
        let slowest = self.assessment.extremes.slowest.speed_squared.max(0.0).sqrt();
        let is_same = |c: f64| (c - slowest).abs() <= EQUAL * self.speeds.largest.sqrt();
        match &self.sphere {
            Some(values) => values.iter().all(|&c| is_same(c)),
            None => self.speeds.curves.iter().all(|(_, _, yielding)| {
                let least = yielding.iter().map(|c| c.re).fold(f64::INFINITY, f64::min);
                is_same(least.max(0.0).sqrt())
            }),
        }
    }
}

fn is_slowest_of_none(found: &Found) -> bool {
    !found.assessment.extremes.slowest.speed_squared.is_finite()
}

fn report(case: &Case, found: &Found) -> Value {
    let SolidAssessment { verdict, extremes, hyperbolicity, route, .. } = &found.assessment;
    json!({
        "model": case.kind.name(),
        "yield": case.yields.map(|set| set.name),
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
        "flutter_sectors_deg": found.speeds.flutter,
        "imaginary_sectors_deg": found.speeds.imaginary,
        "always_still": found.speeds.is_always_stationary,
        "vanishing": found.speeds.vanishing.iter()
            .map(|(degrees, cause)| json!({ "direction_deg": degrees, "what": cause.name() }))
            .collect::<Vec<_>>(),
        "elevation_deg": case.numbers.wave.elevation_deg,
        "route": route,
    })
}

/// Least and greatest of a speed over the directions in which it is real.
fn range(speeds: &DirectionalSpeeds, squares: impl Iterator<Item = Complex64>) -> Option<[f64; 2]> {
    let real = squares.filter(|c| !speeds.is_complex(c) && speeds.is_not_negative(c));
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
    let waves = found.speeds.curves[0].1.len();
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
    let speeds = &found.speeds;
    table("elastic", &|i| range(speeds, speeds.curves.iter().map(|(_, e, _)| e[i])));
    if found.solid.plastic.is_some() {
        table("yielding", &|i| range(speeds, speeds.curves.iter().map(|(_, _, y)| y[i])));
    }
    let _ = writeln!(text, "\n{}", found.assessment.hyperbolicity.words());
    for [from, to] in &found.speeds.flutter {
        let _ = writeln!(
            text,
            "  complex speeds for normals from {}° to {}°",
            short(*from),
            short(*to)
        );
    }
    for [from, to] in &found.speeds.imaginary {
        let _ = writeln!(
            text,
            "  imaginary speeds for normals from {}° to {}°",
            short(*from),
            short(*to)
        );
    }
    if found.speeds.is_always_stationary {
        let _ = writeln!(text, "  a speed vanishes in all directions");
    }
    for (degrees, cause) in &found.speeds.vanishing {
        let (degrees, cause) = (short(*degrees), cause.name());
        let _ = writeln!(text, "  a speed vanishes for the normal at {degrees}°: {cause}");
    }
    let extremes = &found.assessment.extremes;
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
    let value = match found.assessment.is_stationary() {
        true => "0".to_owned(),
        false => short(slowest.speed_squared),
    };
    let place = match found.slowest_is_everywhere() {
        true => "in all directions".to_owned(),
        false => format!("normal {}", at(slowest.normal)),
    };
    let _ = writeln!(text, "  slowest wave: c² = {value} m²/s², {place}");
    let _ = writeln!(text, "Verdict: {}", found.assessment.verdict.name());
    text
}

fn csv(found: &Found) -> Result<Vec<u8>, Error> {
    let header = ["direction_deg", "response", "wave", "squared_speed", "squared_speed_imaginary"];
    let is_yielding = found.solid.plastic.is_some();
    let rows = found.speeds.curves.iter().flat_map(move |(degrees, elastic, yielding)| {
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
    let largest = found.speeds.largest;
    let speed = |c: Complex64| match found.speeds.is_complex(&c) || found.speeds.is_not_negative(&c)
    {
        true => c.sqrt().re,
        false => f64::NAN,
    };
    let mut curves: Vec<SpeedCurve> = Vec::new();
    for wave in 0..found.speeds.curves[0].1.len() {
        let points: Vec<[f64; 2]> = found
            .speeds
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
        flutter: found.speeds.flutter.clone(),
        imaginary: found.speeds.imaginary.clone(),
        vanishing: found
            .speeds
            .vanishing
            .iter()
            .map(|&(angle_deg, cause)| Vanishing { label: cause.name().into(), angle_deg })
            .collect(),
    }
}

fn sphere_figure(case: &Case, found: &Found, values: &[f64]) -> SphereFigure {
    let (polar_deg, azimuth_deg) = angles();
    let extremes = &found.assessment.extremes;
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
