//! `wellposed dispersion`: frequencies and speeds of the waves of a solid against the wave number.

use crate::case::Case;
use crate::output::{self, ResultFolder};
use crate::setup;
use crate::words::{case_title, short};
use crate::{Error, Format, Options};
use analysis::solids::{BranchGroup, BranchPoint, branches};
use analysis::waves::ForbiddenBand;
use figures::{Band, Branch, DispersionFigure, Level};
use models::cosserat::parameters::Isotropic;
use models::elastoplastic::Solid;
use models::granular_flow::InputError;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

/// Runs the verb.
///
/// # Errors
/// The case is wrong, or results cannot be written.
pub fn run(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let solid = setup::solid::solid(&case).map_err(|error| case.locate(error))?;
    if solid.plastic.as_ref().is_some_and(|plastic| plastic.rate > 0.0) {
        let error = InputError {
            key: "yield.plastic_rate",
            found: format!("{:?}", case.numbers.plastic_rate),
            allowed: "0: branches are followed of waves that nothing damps; wellposed point has \
                      the roots of damped ones"
                .into(),
        };
        return Err(case.locate(error).into());
    }
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    let wave = case.numbers.wave;
    let greatest = match wave.greatest_number {
        0.0 => solid.elastic.characteristic_wave_number().map_or(wave.number, |own| 4.0 * own),
        given => given,
    };
    let kinds = branches(&solid, setup::solid::normal(&wave), greatest, false)
        .map_err(|error| setup::locate(&case, error.into()))?;
    let is_finite = |p: &BranchPoint| p.frequency.is_finite() && p.growth_rate.is_finite();
    let ends = [wave.number, greatest];
    if !ends.iter().all(|&k| kinds.iter().all(|kind| kind.at(k).iter().all(is_finite))) {
        let error = InputError {
            key: "model",
            found: "numbers whose waves cannot be followed".into(),
            allowed: "moduli, inertias and wave numbers whose frequencies are finite".into(),
        };
        return Err(case.locate(error).into());
    }
    if options.dry_run {
        writeln!(stdout, "would follow the waves up to k = {} 1/m", short(greatest))?;
        for name in output::DISPERSION {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }
    let json = format!("{:#}\n", report(&case, &kinds, greatest));
    let words = words(&case, &kinds);
    let figure = figure(&case, &solid, &kinds, greatest);

    folder.open()?;
    folder.write("dispersion.png", &figure.draw(figures::Format::Png)?)?;
    folder.write("dispersion.svg", &figure.draw(figures::Format::Svg)?)?;
    folder.write("dispersion.csv", &csv(&kinds, greatest)?)?;
    folder.write("dispersion.json", json.as_bytes())?;
    folder.write("dispersion.txt", words.as_bytes())?;
    match options.format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            writeln!(stdout, "picture: {}", folder.path().join("dispersion.png").display())?;
        }
    }
    Ok(())
}

fn report(case: &Case, kinds: &[BranchGroup], greatest: f64) -> Value {
    let wave = case.numbers.wave;
    let finite = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    let families = kinds.iter().map(|kind| {
        json!({
            "polarisation": kind.family.polarisation.name(),
            "count": kind.count,
            "characteristic_speeds": kind.speeds().iter().map(|c| c[0]).collect::<Vec<_>>(),
            "characteristic_growth": kind.speeds().iter().map(|c| c[1]).collect::<Vec<_>>(),
            "cut_off_frequencies": kind.cut_offs(),
            "short_wave_limits": kind.short_wave_limits(),
            "forbidden_bands": kind
                .bands
                .iter()
                .map(|band| json!([band.from, finite(band.to)]))
                .collect::<Vec<_>>(),
            "at_wave": kind
                .at(wave.number)
                .iter()
                .map(|point| {
                    json!({
                        "frequency": point.frequency,
                        "growth_rate": point.growth_rate,
                        "phase_speed": point.phase_speed,
                        "group_speed": finite(point.group_speed),
                    })
                })
                .collect::<Vec<_>>(),
        })
    });
    json!({
        "model": case.kind.name(),
        "wave": {
            "number": wave.number,
            "direction_deg": wave.direction_deg,
            "elevation_deg": wave.elevation_deg,
        },
        "greatest_number": greatest,
        "families": families.collect::<Vec<_>>(),
        "units": { "frequency": "rad/s", "speed": "m/s", "number": "1/m" },
    })
}

fn list(values: &[f64]) -> String {
    values.iter().map(|&x| short(x)).collect::<Vec<_>>().join(", ")
}

fn words(case: &Case, kinds: &[BranchGroup]) -> String {
    let wave = case.numbers.wave;
    let mut text = format!(
        "{}\nmodel: {}\nwaves along {}°, {}° above the plane; frequencies in rad/s, speeds in m/s\n",
        case_title(case),
        case.medium().title(),
        short(wave.direction_deg),
        short(wave.elevation_deg),
    );
    for kind in kinds {
        let count = if kind.count > 1 { format!(" (×{})", kind.count) } else { String::new() };
        let _ = writeln!(text, "\n{}{count}", kind.family.polarisation.name());
        let speed = |&[real, growth]: &[f64; 2]| match growth {
            0.0 => short(real),
            _ => format!("{} ± {}i", short(real), short(growth)),
        };
        let speeds: Vec<String> = kind.speeds().iter().map(speed).collect();
        let _ = writeln!(text, "  characteristic speeds   {}", speeds.join(", "));
        if !kind.cut_offs().is_empty() {
            let _ = writeln!(text, "  cut-off frequencies     {}", list(&kind.cut_offs()));
        }
        if !kind.short_wave_limits().is_empty() {
            let _ = writeln!(
                text,
                "  frequencies as k → ∞    {} (speed zero)",
                list(&kind.short_wave_limits())
            );
        }
        for band in &kind.bands {
            let _ = match band.to.is_finite() {
                true => writeln!(
                    text,
                    "  no such waves between   {} and {}",
                    short(band.from),
                    short(band.to)
                ),
                false => writeln!(text, "  no such waves above     {}", short(band.from)),
            };
        }
        for (branch, point) in kind.at(wave.number).iter().enumerate() {
            let growth = match point.growth_rate {
                0.0 => String::new(),
                rate => format!(", growth rate {} 1/s", short(rate)),
            };
            let _ = writeln!(
                text,
                "  at k = {} 1/m: ω = {}{growth}, phase speed {}, group speed {}  [{}]",
                short(wave.number),
                short(point.frequency),
                short(point.phase_speed),
                short(point.group_speed),
                kind.label(branch),
            );
        }
    }
    text
}

fn csv(kinds: &[BranchGroup], greatest: f64) -> Result<Vec<u8>, Error> {
    let header = ["branch", "number", "frequency", "phase_speed", "group_speed", "growth_rate"];
    let rows = kinds.iter().flat_map(|kind| {
        kind.curves(greatest).into_iter().enumerate().flat_map(|(branch, curve)| {
            let label = kind.label(branch);
            curve.into_iter().map(move |p| -> Vec<files::csv::Cell> {
                vec![
                    label.as_str().into(),
                    p.number.into(),
                    p.frequency.into(),
                    p.phase_speed.into(),
                    p.group_speed.into(),
                    p.growth_rate.into(),
                ]
            })
        })
    });
    Ok(files::csv::table(&header, rows)?)
}

fn figure(case: &Case, solid: &Solid, kinds: &[BranchGroup], greatest: f64) -> DispersionFigure {
    let wave = case.numbers.wave;
    let branches = kinds.iter().flat_map(|kind| {
        kind.curves(greatest).into_iter().enumerate().map(|(branch, curve)| Branch {
            label: kind.label(branch),
            frequency: curve.iter().map(|p| [p.number, p.frequency]).collect(),
            group_speed: curve.iter().map(|p| [p.number, p.group_speed]).collect(),
            measured: Vec::new(),
            growth: match curve.iter().any(|p| p.growth_rate > 0.0) {
                true => curve.iter().map(|p| [p.number, p.growth_rate]).collect(),
                false => Vec::new(),
            },
        })
    });
    // Below its cut-off a single branch is absent as well, but the dashed line says that.
    let bands = kinds.iter().flat_map(|kind| {
        let between = |band: &&ForbiddenBand| band.from > 0.0 && band.to.is_finite();
        kind.bands.iter().filter(between).map(|band| Band {
            label: format!("no {} waves", kind.family.polarisation.name()),
            from: band.from,
            to: band.to,
        })
    });
    let mut cutoffs: Vec<Level> = Vec::new();
    for cut_off in kinds.iter().flat_map(BranchGroup::cut_offs) {
        if cutoffs.iter().all(|level| (level.value - cut_off).abs() > 1e-9 * cut_off) {
            cutoffs.push(Level { label: format!("{} rad/s", short(cut_off)), value: cut_off });
        }
    }
    let speed_limits = match solid.elastic.downcast::<Isotropic>() {
        Some(elastic) => {
            let speeds = elastic.speeds();
            let of_elastic = if solid.plastic.is_some() { "elastic " } else { "" };
            let level =
                |label: &str, value: f64| Level { label: format!("{of_elastic}{label}"), value };
            [
                Some(level("c_p", speeds.longitudinal)),
                Some(level("c_s", speeds.shear)),
                // In the plane nothing turns about the wave vector.
                speeds.torsion.filter(|_| solid.dimensions == 3).map(|c| level("c_m", c)),
                speeds.rotation.map(|c| level("c_ω", c)),
            ]
            .into_iter()
            .flatten()
            .collect()
        }
        None => Vec::new(),
    };
    DispersionFigure {
        title: case_title(case),
        subtitle: format!(
            "{}, waves along {}°{}; solid: phase speed, dashed: group speed",
            case.medium().title(),
            short(wave.direction_deg),
            match wave.elevation_deg {
                0.0 => String::new(),
                up => format!(", {}° above the plane", short(up)),
            },
        ),
        k_label: "wave number k (1/m)".into(),
        frequency_label: "frequency ω (rad/s)".into(),
        speed_label: "speed (m/s)".into(),
        growth_label: "growth rate Re ς (1/s)".into(),
        k_log: false,
        frequency_log: false,
        branches: branches.collect(),
        bands: bands.collect(),
        cutoffs,
        speed_limits,
    }
}
