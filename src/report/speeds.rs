//! Report on the characteristic speeds of a solid.

use super::format::{case_title, normal_words as at, short};
use super::{Picture, Report};
use crate::Error;
use crate::case::{Case, Wave};
use crate::setup::solid::normal;
use crate::study::speeds::{EQUAL, Hemisphere, Speeds};
use analysis::solids::{DirectionalSpeeds, angles_deg};
use figures::{Response, SpeedCurve, SpeedsFigure, SphereFigure, SphereMark, Vanishing};
use num_complex::Complex64;
use std::fmt::Write as _;

impl Report for Speeds {
    const NAME: &'static str = "speeds";

    fn text(&self, case: &Case) -> String {
        let mut text = format!("{}\nmodel: {}, ", case_title(case), case.medium().title());
        text += match (self.dimensions, self.elevation_deg) {
            (2, _) => "plane strain\n".to_owned(),
            (_, 0.0) => "in space; curves in the plane of x₁ and x₂\n".to_owned(),
            (_, up) => format!("in space; curves {}° above the plane of x₁ and x₂\n", short(up)),
        }
        .as_str();
        let curves = &self.by_direction.curves;
        self.write_ranges("elastic", &|i| curves.iter().map(|(_, e, _)| e[i]).collect(), &mut text);
        if self.solid.plastic.is_some() {
            let yielding = |i: usize| curves.iter().map(|(_, _, y)| y[i]).collect();
            self.write_ranges("yielding", &yielding, &mut text);
        }
        self.write_directions(&mut text);
        self.write_extremes(&mut text);
        let _ = writeln!(text, "Verdict: {}", self.verdict);
        text
    }

    fn pictures(&self, case: &Case) -> Result<Vec<Picture>, Error> {
        let figure = figure(case, self);
        let mut pictures = vec![Picture::new(Self::NAME, move |format| figure.draw(format))];
        if let Some(hemisphere) = &self.hemisphere {
            let figure = sphere_figure(case, self, hemisphere);
            pictures.push(Picture::new("sphere", move |format| figure.draw(format)));
        }
        Ok(pictures)
    }

    fn tables(&self, _case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        let mut tables = vec![("speeds.csv", csv(self)?)];
        if let Some(hemisphere) = &self.hemisphere {
            tables.push(("sphere.csv", sphere_csv(hemisphere)?));
        }
        Ok(tables)
    }
}

impl Speeds {
    /// Writes the range of each speed over all directions; `of_wave` returns the squared speeds of a wave by direction,
    /// m²/s².
    fn write_ranges(
        &self,
        name: &str,
        of_wave: &dyn Fn(usize) -> Vec<Complex64>,
        text: &mut String,
    ) {
        let _ = writeln!(text, "\nspeeds {name}, over all these directions (m/s)");
        for wave in 0..self.by_direction.curves[0].1.len() {
            let number = wave + 1;
            let _ = match range(&self.by_direction, of_wave(wave).into_iter()) {
                Some([_, 0.0]) => writeln!(text, "  {number}  0: does not travel"),
                Some([low, high]) if high - low <= EQUAL * high => {
                    writeln!(text, "  {number}  {}", short(high))
                }
                Some([low, high]) => {
                    writeln!(text, "  {number}  {} … {}", short(low), short(high))
                }
                None => writeln!(text, "  {number}  never real"),
            };
        }
    }

    fn write_directions(&self, text: &mut String) {
        let _ = writeln!(text, "\n{}", self.assessment.hyperbolicity.words());
        for (kind, sectors) in
            [("complex", &self.flutter_sectors_deg), ("imaginary", &self.imaginary_sectors_deg)]
        {
            for [from, to] in sectors {
                let (from, to) = (short(*from), short(*to));
                let _ = writeln!(text, "  {kind} speeds for normals from {from}° to {to}°");
            }
        }
        if self.always_still {
            let _ = writeln!(text, "  a speed vanishes in all directions");
        }
        for vanishing in &self.vanishing {
            let (degrees, cause) = (short(vanishing.direction_deg), vanishing.what);
            let _ = writeln!(text, "  a speed vanishes for the normal at {degrees}°: {cause}");
        }
    }

    fn write_extremes(&self, text: &mut String) {
        if let Some(flutter) = self.flutter {
            let [real, imaginary] = flutter.squared_speed;
            let _ = writeln!(
                text,
                "  strongest flutter: c² = {} ± {}i m²/s², normal {}; short waves grow as {} k",
                short(real),
                short(imaginary.abs()),
                at(flutter.normal.vector),
                short(flutter.growth)
            );
        }
        let value = match self.assessment.is_stationary() {
            true => "0".to_owned(),
            false => short(self.slowest.squared_speed),
        };
        let place = match self.slowest_is_everywhere() {
            true => "in all directions".to_owned(),
            false => format!("normal {}", at(self.slowest.normal.vector)),
        };
        let _ = writeln!(text, "  slowest wave: c² = {value} m²/s², {place}");
    }
}

/// Returns the minimum and maximum of a speed, m/s, over the directions in which it is real; `None` if there are none.
fn range(speeds: &DirectionalSpeeds, squares: impl Iterator<Item = Complex64>) -> Option<[f64; 2]> {
    let real = squares.filter(|c| !speeds.is_complex(c) && speeds.is_not_negative(c));
    let range = real
        .map(|c| c.re.max(0.0).sqrt())
        .fold([f64::INFINITY, 0.0], |[a, b], c| [f64::min(a, c), f64::max(b, c)]);
    range[0].is_finite().then_some(range)
}

fn csv(found: &Speeds) -> Result<Vec<u8>, Error> {
    let header = ["direction_deg", "response", "wave", "squared_speed", "squared_speed_imaginary"];
    let is_yielding = found.solid.plastic.is_some();
    let rows = found.by_direction.curves.iter().flat_map(move |(degrees, elastic, yielding)| {
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

fn sphere_csv(hemisphere: &Hemisphere) -> Result<Vec<u8>, Error> {
    let Hemisphere { polar_deg, azimuth_deg, slowest } = hemisphere;
    let directions = polar_deg.iter().flat_map(|&p| azimuth_deg.iter().map(move |&a| (p, a)));
    let rows = directions.zip(slowest).map(|((polar, azimuth), value)| -> Vec<files::csv::Cell> {
        vec![polar.into(), azimuth.into(), (*value).into()]
    });
    Ok(files::csv::table(&["polar_deg", "azimuth_deg", "slowest_speed"], rows)?)
}

/// Returns the curves of one response; coincident curves are merged with their multiplicity.
fn curves(found: &Speeds, response: Response) -> Vec<SpeedCurve> {
    let DirectionalSpeeds { curves: by_direction, largest, .. } = &found.by_direction;
    let speed = |c: Complex64| match found.by_direction.is_complex(&c)
        || found.by_direction.is_not_negative(&c)
    {
        true => c.sqrt().re,
        false => f64::NAN,
    };
    let mut curves: Vec<SpeedCurve> = Vec::new();
    for wave in 0..by_direction[0].1.len() {
        let points: Vec<[f64; 2]> = by_direction
            .iter()
            .map(|(degrees, elastic, yielding)| match response {
                Response::Elastic => [*degrees, speed(elastic[wave])],
                Response::Yielding => [*degrees, speed(yielding[wave])],
            })
            .collect();
        // Waves of zero speed have no curve.
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

fn figure(case: &Case, found: &Speeds) -> SpeedsFigure {
    let mut all = curves(found, Response::Elastic);
    if found.solid.plastic.is_some() {
        all.extend(curves(found, Response::Yielding));
    }
    let place = match (found.dimensions, found.elevation_deg) {
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
        flutter: found.flutter_sectors_deg.clone(),
        imaginary: found.imaginary_sectors_deg.clone(),
        vanishing: found
            .vanishing
            .iter()
            .map(|own| Vanishing { label: own.what.into(), angle_deg: own.direction_deg })
            .collect(),
    }
}

fn sphere_figure(case: &Case, found: &Speeds, hemisphere: &Hemisphere) -> SphereFigure {
    let extremes = &found.assessment.extremes;
    // Of two opposite normals, the one whose angles are printed is marked.
    let mark = |label: &str, of: [f64; 3]| {
        let [direction_deg, elevation_deg] = angles_deg(of);
        let wave = Wave { direction_deg, elevation_deg, ..case.material.numbers.wave };
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
        polar_deg: hemisphere.polar_deg.clone(),
        azimuth_deg: hemisphere.azimuth_deg.clone(),
        values: hemisphere.slowest.clone(),
        value_label: "slowest speed c (m/s)".into(),
        value_log: false,
        dark_is_low: true,
        missing_label: "complex or imaginary speeds".into(),
        marks,
    }
}
