//! Draws `gallery/why.png`: the same perturbation of a granular flow in an ill-posed and in a well-posed model, each on
//! two grids.
//!
//! `cargo run --release --example why -- gallery/why.png`
//!
//! Both models start from the same velocity perturbation (wavelengths of at least an eighth of the box), on mean flows
//! of equal stress and shear rate. The plastic potential model is ill-posed: growth rates are proportional to k², so
//! that the shortest waves of the grid grow fastest and the solution depends on the grid. The model of Harris & Grekova
//! is well-posed for a non-coaxiality of 20°: both grids give the same solution. The verdicts in the titles are computed
//! by the analysis.

use std::error::Error;
use std::path::Path;
use wellposed::figures::{FieldAxis, FieldFigure, FigureFormat};
use wellposed::study::{ignore_progress, simulate::SimulationSettings};

const CASE_PATH: &str = "cases/flow/plastic-potential-in-time.toml";

/// Changes to the case for both models: long waves only, with an amplitude and a duration for which no point of any run
/// leaves the fully deforming region.
const COMMON_SETTINGS: [&str; 3] =
    ["initial[0].to=8", "initial[0].amplitude=1e-3", "time.duration=1.4e-3"];

/// Further changes to the case for the well-posed model.
const WELL_POSED_SETTINGS: [&str; 4] = [
    "model.kind=harris-grekova",
    "model.moment_of_inertia=1.25e-7",
    "model.rotational_strength=0",
    "background.noncoaxiality_deg=20",
];

/// Numbers of grid points along each axis.
const POINT_COUNTS: [usize; 2] = [64, 128];

/// Limit of the colour scale, 1/s: deviation of the shear rate from its mean of 5 1/s.
const COLOUR_LIMIT: f64 = 0.3;

/// Width and height, pixels, of the left part to which a panel of 1600 × 1100 pixels is cropped before it is halved.
const CROP_SIZE: [usize; 2] = [1400, 1100];

/// RGB image, three bytes per pixel, row by row.
struct RgbImage {
    width: usize,
    bytes: Vec<u8>,
}

/// Draws the panel of a run: the deviation of the shear rate from its mean at the end time.
fn draw_panel(title: &str, settings: &[&str], points: usize) -> Result<RgbImage, Box<dyn Error>> {
    let grid = format!("grid.cells=[{points}, {points}]");
    let settings = COMMON_SETTINGS.iter().chain(settings).copied().chain([grid.as_str()]);
    let case = wellposed::load(CASE_PATH, settings)?;
    let point = wellposed::analyse_point(&case, &ignore_progress)?;
    let verdict = point.verdict().ok_or("the mean flow is on yield")?.name();
    let found = wellposed::simulate(
        &case,
        SimulationSettings { accept_ill_posed: true },
        &ignore_progress,
    )?;
    let values = found.fields.get("shear_rate").ok_or("a flow has a shear rate")?;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let [length, _] = found.box_lengths.ok_or("a flow has a box")?;
    let axis = |index| FieldAxis { label: format!("x{index} (m)"), start: 0.0, end: length };
    let figure = FieldFigure {
        title: format!("{title} ({verdict}), {points} × {points} points"),
        subtitle: format!(
            "t = {:.1} ms, in the box that moves with the mean flow of {mean:.0} 1/s",
            1e3 * found.final_time
        ),
        x: axis('₁'),
        y: axis('₂'),
        columns: points,
        rows: points,
        values: values.iter().map(|value| value - mean).collect(),
        label: "deviation of the shear rate from its mean (1/s)".to_owned(),
        is_signed: true,
        fixed_limit: Some(COLOUR_LIMIT),
        // Numbered lines would hide the pattern of the finer grid.
        contour_levels: Some(Vec::new()),
        ..FieldFigure::default()
    };
    let bytes = figure.draw(FigureFormat::Png)?;
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
    let mut image = vec![0; reader.output_buffer_size().ok_or("a picture has a size")?];
    reader.next_frame(&mut image)?;
    let width = reader.info().width as usize;
    Ok(crop_and_halve(&RgbImage { width, bytes: image }))
}

/// Crops an image to [`CROP_SIZE`] and halves its size: each pixel is the mean of 2 × 2 pixels.
fn crop_and_halve(image: &RgbImage) -> RgbImage {
    let [width, height] = CROP_SIZE.map(|size| size / 2);
    let mut bytes = Vec::with_capacity(3 * width * height);
    for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
        for colour in 0..3 {
            let at = |y, x| u32::from(image.bytes[3 * (y * image.width + x) + colour]);
            let (y, x) = (2 * row, 2 * column);
            let sum = at(y, x) + at(y, x + 1) + at(y + 1, x) + at(y + 1, x + 1);
            bytes.push(((sum + 2) / 4) as u8);
        }
    }
    RgbImage { width, bytes }
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: why FILE.png")?;
    let models: [(&str, &[&str]); 2] =
        [("Plastic potential", &[]), ("Harris–Grekova", &WELL_POSED_SETTINGS)];
    let mut all = RgbImage { width: CROP_SIZE[0], bytes: Vec::new() };
    for (title, settings) in models {
        let [left, right] = POINT_COUNTS.map(|points| draw_panel(title, settings, points));
        let (left, right) = (left?, right?);
        let rows = left.bytes.chunks(3 * left.width).zip(right.bytes.chunks(3 * right.width));
        all.bytes.extend(rows.flat_map(|(left, right)| [left, right].concat()));
    }
    let mut bytes = Vec::new();
    let height = all.bytes.len() / (3 * all.width);
    let mut encoder = png::Encoder::new(&mut bytes, all.width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&all.bytes)?;
    writer.finish()?;
    wellposed::files::write_atomically(Path::new(&file), &bytes)?;
    Ok(())
}
