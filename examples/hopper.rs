//! Draws the non-coaxiality of radial flow in a hopper against the position and the friction of the wall.
//!
//! `cargo run --release --example hopper -- hopper.png`
//!
//! A material of friction angle 30° flows towards the apex between walls at 20° from the axis (`models::flow::hopper`). The
//! verdict of the Harris–Grekova model on each state is that of its formula; it is counted in the subtitle. Prints the
//! largest non-coaxiality, which is half the largest friction of the wall.

use std::error::Error;
use wellposed::figures::{FieldAxis, FieldFigure, FigureFormat};
use wellposed::models::flow::Model;
use wellposed::models::flow::closed_form::ClosedFormVerdict;
use wellposed::models::flow::hopper::{RadialFlow, RadialScales};
use wellposed::models::registry::HARRIS_GREKOVA;

const FRICTION_ANGLE_DEG: f64 = 30.0;
const WALL_ANGLE_DEG: f64 = 20.0;

/// Cells per degree along both axes.
const CELLS_PER_DEGREE: usize = 4;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "hopper.png".into());
    let friction_angle = FRICTION_ANGLE_DEG.to_radians();
    let model = Model::new(HARRIS_GREKOVA, &[friction_angle, 0.0, 0.0, 1.25e-7, 0.0])?;
    let scales = RadialScales { density: 1600.0, gravity: 9.81, radius: 1.0, axis_flow: 0.2 };
    let [columns, rows] =
        [WALL_ANGLE_DEG, FRICTION_ANGLE_DEG].map(|angle| angle as usize * CELLS_PER_DEGREE);
    let middle = |index: usize| ((index as f64 + 0.5) / CELLS_PER_DEGREE as f64).to_radians();
    let mut values = Vec::with_capacity(columns * rows);
    let mut well_posed = 0;
    for row in 0..rows {
        let flow = RadialFlow::new(friction_angle, WALL_ANGLE_DEG.to_radians(), middle(row))?;
        for column in 0..columns {
            let fields = flow.fields_at(middle(column)).ok_or("singular before the wall")?;
            let background = model.background(&fields.to_state(&scales))?;
            let state = background.flow().ok_or("not on yield")?;
            let verdict = model.closed_form_verdict(state);
            well_posed += usize::from(verdict == Some(ClosedFormVerdict::WellPosed));
            values.push(fields.noncoaxiality().to_degrees().abs());
        }
    }
    let largest = values.iter().copied().fold(0.0, f64::max);
    println!("well-posed: {well_posed} of {} states; largest |Δ|: {largest:.3}°", values.len());
    let figure = FieldFigure {
        title: "Non-coaxiality of radial flow in a hopper".into(),
        subtitle: format!(
            "φ = {FRICTION_ANGLE_DEG}°, walls at {WALL_ANGLE_DEG}° from the axis; {well_posed} of {} states are \
             well-posed (|Δ| < 45°)",
            values.len()
        ),
        x: FieldAxis {
            label: "angle ϑ from the axis (°)".into(), start: 0.0, end: WALL_ANGLE_DEG
        },
        y: FieldAxis {
            label: "friction angle δ_w of the wall (°)".into(),
            start: 0.0,
            end: FRICTION_ANGLE_DEG,
        },
        columns,
        rows,
        values,
        label: "non-coaxiality |Δ| (°)".into(),
        contour_levels: Some(vec![1.0, 2.5, 5.0, 7.5, 10.0, 12.5]),
        ..FieldFigure::default()
    };
    std::fs::write(path, figure.draw(FigureFormat::Png)?)?;
    Ok(())
}
