//! Report on the characteristic speeds of a solid.

use super::format::{case_title, format_angle, format_normal, format_short};
use super::parameters::with_parameters;
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::{Case, WaveNumbers};
use crate::setup::solid::wave_normal;
use crate::study::speeds::{EQUAL_SPEED_TOLERANCE, Hemisphere, SpeedsResult};
use analysis::solids::{DirectionalSpeeds, angles_deg};
use figures::{SolidResponse, SpeedCurve, SpeedsFigure, SphereFigure, SphereMark, ZeroSpeedNormal};
use num_complex::Complex64;
use std::fmt::Write as _;

impl Report for SpeedsResult {
    const NAME: &'static str = "speeds";

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\nmodel: {}, ", case_title(case), case.medium().title());
        text += match (self.dimensions, self.elevation_deg) {
            (2, _) => "plane strain\n".to_owned(),
            (_, 0.0) => "in space; curves in the plane of x₁ and x₂\n".to_owned(),
            (_, up) => {
                format!("in space; curves {}° above the plane of x₁ and x₂\n", format_short(up))
            }
        }
        .as_str();
        let curves = &self.directional_speeds.curves;
        self.write_speed_ranges(
            "elastic",
            &|i| curves.iter().map(|(_, e, _)| e[i]).collect(),
            &mut text,
        );
        if self.solid.plastic_state.is_some() {
            let yielding = |i: usize| curves.iter().map(|(_, _, y)| y[i]).collect();
            self.write_speed_ranges("yielding", &yielding, &mut text);
        }
        self.write_directions(&mut text);
        self.write_extremes(&mut text);
        let _ = writeln!(text, "Verdict: {}", self.verdict);
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let figure = create_figure(case, self);
        let mut pictures = vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))];
        if let Some(hemisphere) = &self.hemisphere {
            let figure = create_sphere_figure(case, self, hemisphere);
            pictures.push(ReportPicture::new("sphere", move |format| figure.draw(format)));
        }
        Ok(pictures)
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let mut tables = vec![("speeds.csv", create_table(self))];
        if let Some(hemisphere) = &self.hemisphere {
            tables.push(("sphere.csv", create_sphere_table(hemisphere)));
        }
        Ok(tables)
    }
}

impl SpeedsResult {
    /// Writes the range of each wave's speed over the sampled directions in which it is real; `of_wave` returns the
    /// squared speeds, m²/s², of the wave of that index by direction.
    fn write_speed_ranges(
        &self,
        name: &str,
        of_wave: &dyn Fn(usize) -> Vec<Complex64>,
        text: &mut String,
    ) {
        let _ = writeln!(text, "\nspeeds {name}, over all sampled directions (m/s)");
        for wave in 0..self.directional_speeds.curves[0].1.len() {
            let number = wave + 1;
            let squares = of_wave(wave);
            let range = compute_speed_range(&self.directional_speeds, squares.iter().copied());
            let range = match range {
                Some([_, 0.0]) => "0: does not propagate".to_owned(),
                Some([low, high]) if high - low <= EQUAL_SPEED_TOLERANCE * high => {
                    format_short(high)
                }
                Some([low, high]) => format!("{} … {}", format_short(low), format_short(high)),
                None => "real in no direction".to_owned(),
            };
            // The range is that of the real speeds alone.
            let is_complex = |c: &Complex64| self.directional_speeds.is_complex(c);
            let is_imaginary =
                |c: &Complex64| !is_complex(c) && !self.directional_speeds.is_nonnegative(c);
            let exceptions = [
                (squares.iter().any(is_complex), "complex"),
                (squares.iter().any(is_imaginary), "imaginary, c² < 0,"),
            ];
            let exceptions = exceptions.into_iter().filter(|(occurs, _)| *occurs);
            let exceptions: String =
                exceptions.map(|(_, kind)| format!("; {kind} in some directions")).collect();
            let _ = writeln!(text, "  {number}  {range}{exceptions}");
        }
    }

    fn write_directions(&self, text: &mut String) {
        let _ = writeln!(text, "\n{}", self.assessment.hyperbolicity.description());
        for (kind, sectors) in
            [("complex", &self.flutter_sectors_deg), ("imaginary", &self.imaginary_sectors_deg)]
        {
            for [from, to] in sectors {
                let (from, to) = (format_angle(*from), format_angle(*to));
                let _ = writeln!(text, "  {kind} speeds for normals from {from} to {to}");
            }
        }
        if self.is_always_stationary {
            let _ = writeln!(text, "  a speed vanishes in all directions");
        }
        for vanishing in &self.vanishing_speeds {
            let (angle, cause) = (format_angle(vanishing.direction_deg), vanishing.cause);
            let _ = writeln!(text, "  a speed vanishes for the normal at {angle}: {cause}");
        }
    }

    fn write_extremes(&self, text: &mut String) {
        if let Some(flutter) = self.strongest_flutter {
            let [real, imaginary] = flutter.squared_speed;
            let _ = writeln!(
                text,
                "  strongest flutter: c² = {} ± {}i m²/s², normal {}; short waves grow as {} k",
                format_short(real),
                format_short(imaginary.abs()),
                format_normal(flutter.wave_normal.vector),
                format_short(flutter.max_imaginary_speed)
            );
        }
        let value = match self.assessment.is_stationary() {
            true => "0".to_owned(),
            false => format_short(self.slowest_wave.squared_speed),
        };
        let place = match self.has_uniform_slowest_speed() {
            true => "in all directions".to_owned(),
            false => format!("normal {}", format_normal(self.slowest_wave.wave_normal.vector)),
        };
        let _ = writeln!(text, "  slowest wave: c² = {value} m²/s², {place}");
    }
}

/// Returns the minimum and maximum of a speed, m/s, over the directions in which it is real; `None` if there are none.
fn compute_speed_range(
    speeds: &DirectionalSpeeds,
    squares: impl Iterator<Item = Complex64>,
) -> Option<[f64; 2]> {
    let real = squares.filter(|c| !speeds.is_complex(c) && speeds.is_nonnegative(c));
    let range = real
        .map(|c| c.re.max(0.0).sqrt())
        .fold([f64::INFINITY, 0.0], |[a, b], c| [f64::min(a, c), f64::max(b, c)]);
    range[0].is_finite().then_some(range)
}

fn create_table(found: &SpeedsResult) -> DataFile<'_> {
    let header = ["direction_deg", "response", "wave", "squared_speed", "squared_speed_imaginary"];
    let is_yielding = found.solid.plastic_state.is_some();
    let rows =
        found.directional_speeds.curves.iter().flat_map(move |(degrees, elastic, yielding)| {
            let of =
                move |name: &'static str, speeds: &[Complex64]| -> Vec<Vec<files::csv::CsvCell>> {
                    let row = |(wave, c): (usize, &Complex64)| -> Vec<files::csv::CsvCell> {
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
    DataFile::table("speeds.csv", header, rows)
}

fn create_sphere_table(hemisphere: &Hemisphere) -> DataFile<'_> {
    let Hemisphere { polar_angles_deg, azimuth_angles_deg, slowest_speeds } = hemisphere;
    let directions =
        polar_angles_deg.iter().flat_map(|&p| azimuth_angles_deg.iter().map(move |&a| (p, a)));
    let rows = directions.zip(slowest_speeds).map(
        |((polar, azimuth), value)| -> Vec<files::csv::CsvCell> {
            vec![polar.into(), azimuth.into(), (*value).into()]
        },
    );
    DataFile::table("sphere.csv", ["polar_deg", "azimuth_deg", "slowest_speed"], rows)
}

/// Creates the speed curves of one response; coincident curves are merged into one with a multiplicity. A point of a
/// curve is Re c, m/s, or NaN for imaginary speeds (c² < 0).
fn create_curves(found: &SpeedsResult, response: SolidResponse) -> Vec<SpeedCurve> {
    let DirectionalSpeeds { curves: directional_speeds, max_squared_speed: largest, .. } =
        &found.directional_speeds;
    let speed = |c: Complex64| match found.directional_speeds.is_complex(&c)
        || found.directional_speeds.is_nonnegative(&c)
    {
        true => c.sqrt().re,
        false => f64::NAN,
    };
    let mut curves: Vec<SpeedCurve> = Vec::new();
    for wave in 0..directional_speeds[0].1.len() {
        let points: Vec<[f64; 2]> = directional_speeds
            .iter()
            .map(|(degrees, elastic, yielding)| match response {
                SolidResponse::Elastic => [*degrees, speed(elastic[wave])],
                SolidResponse::Yielding => [*degrees, speed(yielding[wave])],
            })
            .collect();
        // Waves of zero speed have no curve.
        if points.iter().all(|p| p[1] <= EQUAL_SPEED_TOLERANCE * largest.sqrt()) {
            continue;
        }
        let is_same = |curve: &&mut SpeedCurve| runs_along(curve, &points, largest.sqrt());
        match curves.iter_mut().find(is_same) {
            Some(curve) => curve.multiplicity += 1,
            None => curves.push(SpeedCurve {
                label: match response {
                    SolidResponse::Elastic => "elastic".into(),
                    SolidResponse::Yielding => match curves.len() {
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

/// Returns whether the speeds of a curve equal those of `points` in all directions; `max_speed`, m/s, is the largest speed.
fn runs_along(curve: &SpeedCurve, points: &[[f64; 2]], max_speed: f64) -> bool {
    curve.points.iter().zip(points).all(|(a, b)| {
        (a[1] - b[1]).abs() <= EQUAL_SPEED_TOLERANCE * max_speed || (a[1].is_nan() && b[1].is_nan())
    })
}

fn create_figure(case: &Case, found: &SpeedsResult) -> SpeedsFigure {
    let mut all = create_curves(found, SolidResponse::Elastic);
    if found.solid.plastic_state.is_some() {
        let mut yielding = create_curves(found, SolidResponse::Yielding);
        let max_speed = found.directional_speeds.max_squared_speed.sqrt();
        for curve in &mut yielding {
            if all.iter().any(|elastic| runs_along(elastic, &curve.points, max_speed)) {
                curve.label += ", on an elastic one";
            }
        }
        all.extend(yielding);
    }
    let place = match (found.dimensions, found.elevation_deg) {
        (2, _) => "plane strain".to_owned(),
        (_, 0.0) => "normals in the plane of x₁ and x₂".to_owned(),
        (_, up) => format!("normals {}° above the plane of x₁ and x₂", format_short(up)),
    };
    SpeedsFigure {
        title: case_title(case),
        subtitle: with_parameters(
            &format!(
                "{}, {place}; angle: wave normal, anticlockwise from x₁",
                case.medium().title()
            ),
            case,
        ),
        speed_label: match found.flutter_sectors_deg.is_empty() {
            true => "characteristic speed c".into(),
            false => "Re c of the speeds c".into(),
        },
        unit: "m/s".into(),
        curves: all,
        flutter_sectors: found.flutter_sectors_deg.clone(),
        imaginary_sectors: found.imaginary_sectors_deg.clone(),
        zero_speed_normals: found
            .vanishing_speeds
            .iter()
            .map(|own| ZeroSpeedNormal { label: own.cause.into(), angle_deg: own.direction_deg })
            .collect(),
    }
}

fn create_sphere_figure(
    case: &Case,
    found: &SpeedsResult,
    hemisphere: &Hemisphere,
) -> SphereFigure {
    let extremes = &found.assessment.extremes;
    // Opposite normals have equal speeds; the marked one is that whose angles are printed.
    let mark = |label: &str, of: [f64; 3]| {
        let [direction_deg, elevation_deg] = angles_deg(of);
        let wave = WaveNumbers { direction_deg, elevation_deg, ..case.material.numbers.wave };
        SphereMark { label: label.into(), normal: wave_normal(&wave) }
    };
    let mut marks = Vec::new();
    if let Some(flutter) = extremes.flutter {
        marks.push(mark("strongest flutter", flutter.normal));
    }
    if found.solid.plastic_state.is_some() && !found.has_uniform_slowest_speed() {
        let label = match extremes.slowest.squared_speed < -extremes.slowest.rounding {
            true => "normal of the strongest shear band",
            false => "slowest wave",
        };
        marks.push(mark(label, extremes.slowest.normal));
    }
    SphereFigure {
        title: case_title(case),
        subtitle: with_parameters(
            &format!(
                "{}: slowest wave over all normals; opposite normals are equivalent",
                case.medium().title()
            ),
            case,
        ),
        polar_angles_deg: hemisphere.polar_angles_deg.clone(),
        azimuth_angles_deg: hemisphere.azimuth_angles_deg.clone(),
        values: hemisphere.slowest_speeds.clone(),
        value_label: "slowest speed c (m/s)".into(),
        is_value_log: false,
        is_dark_low: true,
        missing_label: "complex or imaginary speeds".into(),
        marks,
    }
}
