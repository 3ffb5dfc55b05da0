//! Draws every kind of figure from synthetic data into the folder given as argument.

mod fields;
mod growth_rates;
mod records;
mod sampling;
mod verdict_maps;
mod waves;

use crate::fields::{field_bar, field_curves, field_hill, field_materials, field_wave, moving};
use crate::growth_rates::{directions, growth, polar};
use crate::records::{ledger, seismogram};
use crate::sampling::grid;
use crate::verdict_maps::{every_verdict, noncoaxiality};
use crate::waves::{dispersion, speeds, sphere};
use std::error::Error;
use std::path::PathBuf;
use wellposed_figures::{FieldFigure, FigureError, Format, animate};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: gallery FOLDER")?;
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    let save = |name: &str, draw: &dyn Fn(Format) -> Result<Vec<u8>, FigureError>| {
        for (format, ending) in [(Format::Png, "png"), (Format::Svg, "svg")] {
            std::fs::write(folder.join(name).with_extension(ending), draw(format)?)?;
        }
        Ok::<(), Box<dyn Error>>(())
    };
    save("noncoaxiality", &|format| noncoaxiality().draw(format))?;
    save("every_verdict", &|format| every_verdict().draw(format))?;
    save("growth", &|format| growth().draw(format))?;
    save("polar", &|format| polar().draw(format))?;
    save("directions", &|format| directions().draw(format))?;
    save("dispersion", &|format| dispersion(false).draw(format))?;
    save("dispersion_growth", &|format| dispersion(true).draw(format))?;
    save("field_wave", &|format| field_wave().draw(format))?;
    save("field_materials", &|format| field_materials().draw(format))?;
    save("field_bar", &|format| field_bar().draw(format))?;
    save("field_curves", &|format| field_curves().draw(format))?;
    save("field_hill", &|format| field_hill().draw(format))?;
    save("seismogram", &|format| seismogram([6, 3], 4_000).draw(format))?;
    save("seismogram_long", &|format| seismogram([3, 10], 1_000_000).draw(format))?;
    save("ledger", &|format| ledger(true).draw(format))?;
    save("ledger_residual", &|format| ledger(false).draw(format))?;
    let frames: Vec<FieldFigure> = grid(0.0, 0.4, 25).into_iter().map(moving).collect();
    std::fs::write(folder.join("wave.gif"), animate(&frames, 0.08, 800)?)?;
    save("speeds", &|format| speeds().draw(format))?;
    save("sphere", &|format| sphere(false).draw(format))?;
    save("sphere_growth", &|format| sphere(true).draw(format))
}
