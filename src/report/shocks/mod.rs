//! Report on exact plane waves in granular and porous media.

mod figures;

use super::format::{case_title, format_short};
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::shocks::{
    FrontState, PistonResult, ProfilePoint, ReleaseResult, ShocksResult, SpallResult, WaveRow,
};
use ::files::csv::CsvCell;
use std::fmt::Write as _;

impl Report for ShocksResult {
    const NAME: &'static str = "shocks";
    const UNITS: &'static [(&'static str, &'static str)] = &[
        ("speed", "m/s"),
        ("velocity", "m/s"),
        ("pressure", "Pa"),
        ("modulus", "Pa"),
        ("dissipation", "J/m³"),
        ("position", "m"),
        ("time", "s"),
    ];

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!(
            "{}\nmedium: {}, density {} kg/m³; compression strain ε, pressure p = −σ₁₁\n\n",
            case_title(case),
            self.medium,
            format_short(self.density),
        );
        self.write_diagram(&mut text);
        if let Some(piston) = &self.piston {
            piston.write_text(&mut text);
        }
        if let Some(spall) = &self.spall {
            spall.write_text(&mut text);
        }
        self.write_verdict(&mut text);
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let piston = self.piston.as_ref().map(|own| {
            let figure = figures::create_piston_figure(case, self, own);
            ReportPicture::new(Self::NAME, move |format| figure.draw(format))
        });
        let spall = self.spall.as_ref().map(|own| {
            let figure = figures::create_spall_figure(case, self, own);
            ReportPicture::new("spall", move |format| figure.draw(format))
        });
        Ok(piston.into_iter().chain(spall).collect())
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let mut tables = Vec::new();
        if let Some(piston) = &self.piston {
            tables.push(("shocks.csv", create_wave_table(piston)));
            let profiles = vec![(piston.profile_time, piston.profile.as_slice())];
            tables.push(("profile.csv", create_profile_table("profile.csv", "position", profiles)));
        }
        if let Some(spall) = &self.spall {
            let profiles: Vec<(f64, &[ProfilePoint])> =
                spall.profiles.iter().map(|(time, points)| (*time, points.as_slice())).collect();
            tables.push(("spall.csv", create_profile_table("spall.csv", "distance", profiles)));
        }
        Ok(tables)
    }
}

impl ShocksResult {
    fn write_diagram(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "Diagram in uniaxial strain\n  {:<22} {:>12} {:>14} {:>14} {:>12}",
            "state", "from ε", "from p, Pa", "modulus, Pa", "sound, m/s"
        );
        for row in &self.diagram {
            let number = |value: Option<f64>| value.map_or("−∞".to_owned(), format_short);
            let _ = writeln!(
                text,
                "  {:<22} {:>12} {:>14} {:>14} {:>12}",
                row.state,
                number(row.from_strain),
                row.from_pressure.map_or(String::new(), format_short),
                format_short(row.modulus),
                format!("{:.1}", row.sound_speed),
            );
        }
    }

    fn write_verdict(&self, text: &mut String) {
        text.push_str("\nVerdict\n");
        if let Some(piston) = &self.piston {
            let _ = writeln!(text, "  {}", piston.summary());
        }
        if self.medium == "porous" {
            let _ = match self.solitary_threshold {
                Some(pressure) => writeln!(
                    text,
                    "  one shock without precursor (solitary wave) above {} Pa",
                    format_short(pressure)
                ),
                None => writeln!(text, "  no solitary wave at any pressure"),
            };
        }
        let verdict = match self.is_strictly_hyperbolic {
            true => "strictly hyperbolic in all states: all speeds of sound are positive",
            false => "not strictly hyperbolic in all states",
        };
        let _ = writeln!(text, "  {verdict}");
        for note in &self.notes {
            let _ = writeln!(text, "  note: {note}");
        }
    }
}

/// Head of a table of waves.
const WAVE_HEAD: &str = "ahead ε, p (Pa), v (m/s) → behind ε, p (Pa), v (m/s)";

impl PistonResult {
    fn write_text(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\nWaves behind a piston of {} Pa and {} m/s\n  {:<26} {:>10} {:>14}  {WAVE_HEAD}",
            format_short(self.pressure),
            format_short(self.speed),
            "wave",
            "speed, m/s",
            "loss, J/m³",
        );
        write_waves(&self.waves, text);
        if let Some(release) = &self.release {
            release.write_text(text);
        }
    }

    /// Describes the waves in one line.
    fn summary(&self) -> String {
        let names: Vec<String> = self
            .waves
            .iter()
            .map(|wave| format!("{} at {:.1} m/s", wave.kind, wave.speed))
            .collect();
        names.join(", then ")
    }
}

impl ReleaseResult {
    fn write_text(&self, text: &mut String) {
        let _ = writeln!(text, "\nRelease after {} s", format_short(self.duration));
        write_waves(&self.waves, text);
        let _ = writeln!(
            text,
            "  at the surface: velocity {} m/s, remaining ε = {}",
            format_short(self.surface_velocity),
            format_short(self.residual_strain),
        );
        if let Some(own) = &self.overtaking {
            let after = own.pressure.map_or(String::new(), |pressure| {
                format!("; the pressure falls to {} Pa", format_short(pressure))
            });
            let _ = writeln!(
                text,
                "  the first of them overtakes the last loading wave at x = {} m, t = {} s{after}",
                format_short(own.position),
                format_short(own.time),
            );
        }
    }
}

impl SpallResult {
    fn write_text(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\nSpall at a free end: {} of {} m/s and {} s\n  pressure of the pulse {} Pa, speed of sound {:.1} m/s\n  \
             layer of thickness {} m, velocity at the end {} m/s; everything behind it comes to rest",
            self.shape,
            format_short(self.pulse_velocity),
            format_short(self.duration),
            format_short(self.pressure),
            self.sound_speed,
            format_short(self.thickness),
            format_short(self.layer_velocity),
        );
        let _ = match self.shape {
            "triangle" => writeln!(text, "  the layer extends at a uniform rate, without tension"),
            _ => writeln!(
                text,
                "  gap between layer and column at t = {} s: {} m",
                format_short(self.profile_time),
                format_short(self.gap),
            ),
        };
    }
}

fn write_waves(waves: &[WaveRow], text: &mut String) {
    let state =
        |own: &FrontState| [own.strain, own.pressure, own.velocity].map(format_short).join(", ");
    for wave in waves {
        let _ = writeln!(
            text,
            "  {:<26} {:>10} {:>14}  {} → {}  ({} → {})",
            wave.kind,
            format!("{:.2}", wave.speed),
            format_short(wave.dissipation),
            state(&wave.ahead),
            state(&wave.behind),
            wave.states[0],
            wave.states[1],
        );
    }
}

fn create_wave_table(piston: &PistonResult) -> DataFile<'_> {
    let header = [
        "stage",
        "wave",
        "speed",
        "strain_ahead",
        "pressure_ahead",
        "velocity_ahead",
        "strain_behind",
        "pressure_behind",
        "velocity_behind",
        "sound_ahead",
        "sound_behind",
        "dissipation",
    ];
    let loading = piston.waves.iter().map(|wave| ("loading", wave));
    let release = piston.release.iter().flat_map(|own| &own.waves).map(|wave| ("release", wave));
    let rows = loading.chain(release).map(|(stage, wave)| -> Vec<CsvCell> {
        let mut cells: Vec<CsvCell> = vec![stage.into(), wave.kind.into(), wave.speed.into()];
        for own in [wave.ahead, wave.behind] {
            cells.extend([own.strain, own.pressure, own.velocity].map(CsvCell::from));
        }
        cells.extend(wave.sound_speeds.map(CsvCell::from));
        cells.push(wave.dissipation.into());
        cells
    });
    DataFile::table("shocks.csv", header, rows)
}

fn create_profile_table<'a>(
    file: &str,
    position: &'static str,
    profiles: Vec<(f64, &'a [ProfilePoint])>,
) -> DataFile<'a> {
    let points =
        profiles.into_iter().flat_map(|(time, points)| points.iter().map(move |own| (time, own)));
    let rows = points.map(|(time, own)| -> Vec<CsvCell> {
        let FrontState { strain, velocity, pressure } = own.state;
        [time, own.position, pressure, velocity, strain].map(CsvCell::from).to_vec()
    });
    DataFile::table(file, ["time", position, "pressure", "velocity", "strain"], rows)
}
