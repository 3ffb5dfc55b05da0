//! Draws every kind of figure from synthetic data into the folder given as first argument; with a second argument, only
//! the figures whose names begin with it.

mod bands;
mod diagrams;
mod fields;
mod growth_rates;
mod joints;
mod panels;
mod records;
mod sampling;
mod verdict_maps;
mod waves;

use crate::bands::build_band_figure;
use crate::diagrams::build_diagram;
use crate::fields::{
    build_bar_field, build_crack_field, build_energy_field, build_field_pair,
    build_two_material_field, build_wave_field, build_wave_frame,
};
use crate::growth_rates::{build_directions_figure, build_growth_figure, build_polar_figure};
use crate::joints::{build_circulation_field, build_joint_field};
use crate::panels::build_panels_figure;
use crate::records::{build_ledger, build_seismogram};
use crate::sampling::sample_interval;
use crate::verdict_maps::{build_all_verdicts_map, build_noncoaxiality_map};
use crate::waves::{build_dispersion_figure, build_speeds_figure, build_sphere_figure};
use std::error::Error;
use std::path::PathBuf;
use wellposed_figures::{AnimationFormat, FieldFigure, FigureError, FigureFormat, animate};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: gallery FOLDER [NAME]")?;
    let prefix = std::env::args().nth(2).unwrap_or_default();
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    let save = |name: &str, draw: &dyn Fn(FigureFormat) -> Result<Vec<u8>, FigureError>| {
        if !name.starts_with(&prefix) {
            return Ok::<(), Box<dyn Error>>(());
        }
        for (format, ending) in [(FigureFormat::Png, "png"), (FigureFormat::Svg, "svg")] {
            std::fs::write(folder.join(name).with_extension(ending), draw(format)?)?;
        }
        Ok(())
    };
    save("noncoaxiality", &|format| build_noncoaxiality_map().draw(format))?;
    save("every_verdict", &|format| build_all_verdicts_map().draw(format))?;
    save("growth", &|format| build_growth_figure().draw(format))?;
    save("polar", &|format| build_polar_figure().draw(format))?;
    save("directions", &|format| build_directions_figure().draw(format))?;
    save("dispersion", &|format| build_dispersion_figure(false).draw(format))?;
    save("dispersion_growth", &|format| build_dispersion_figure(true).draw(format))?;
    save("bands", &|format| build_band_figure(false).draw(format))?;
    save("bands_damped", &|format| build_band_figure(true).draw(format))?;
    save("diagram", &|format| build_diagram().draw(format))?;
    save("field_wave", &|format| build_wave_field().draw(format))?;
    save("field_materials", &|format| build_two_material_field().draw(format))?;
    save("field_bar", &|format| build_bar_field().draw(format))?;
    save("field_curves", &|format| build_crack_field().draw(format))?;
    save("field_hill", &|format| build_energy_field().draw(format))?;
    save("field_pair", &|format| build_field_pair().draw(format))?;
    save("field_joints", &|format| build_joint_field([20, 10]).draw(format))?;
    save("field_joints_dense", &|format| build_joint_field([200, 100]).draw(format))?;
    save("field_circulation", &|format| build_circulation_field(20).draw(format))?;
    save("field_circulation_dense", &|format| build_circulation_field(100).draw(format))?;
    save("seismogram", &|format| build_seismogram([6, 3], 4_000).draw(format))?;
    save("seismogram_long", &|format| build_seismogram([3, 10], 1_000_000).draw(format))?;
    save("ledger", &|format| build_ledger(true).draw(format))?;
    save("ledger_residual", &|format| build_ledger(false).draw(format))?;
    let frames: Vec<FieldFigure> =
        sample_interval(0.0, 0.4, 25).into_iter().map(build_wave_frame).collect();
    for format in [AnimationFormat::Gif, AnimationFormat::Apng] {
        let name = format!("wave.{}", format.extension());
        if name.starts_with(&prefix) {
            std::fs::write(folder.join(name), animate(&frames, format, 0.08, 800)?)?;
        }
    }
    save("panels", &|format| build_panels_figure().draw(format))?;
    save("speeds", &|format| build_speeds_figure().draw(format))?;
    save("sphere", &|format| build_sphere_figure(false).draw(format))?;
    save("sphere_growth", &|format| build_sphere_figure(true).draw(format))
}
