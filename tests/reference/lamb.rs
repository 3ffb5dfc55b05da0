//! Lamb's problem in the plane as a case with defaults only, run by a program and compared.

use super::reference::{Error, HalfPlane, Ricker, error};
use std::fs;
use std::path::Path;
use std::process::Command;

/// The half-plane: Poisson's ratio ¼.
pub const HALF_PLANE: HalfPlane = HalfPlane { lambda: 8e7, mu: 8e7, density: 2000.0 };
/// The force's function of time.
pub const RICKER: Ricker = Ricker { frequency: 20.0 };
const FORCE: f64 = 1e5;

/// Name and place (x, depth) of receivers, in wavelengths of the Rayleigh wave.
pub const RECEIVERS: [(&str, [f64; 2]); 5] = [
    ("surface1", [1.0, 0.0]),
    ("surface3", [3.0, 0.0]),
    ("below", [0.0, 2.0]),
    ("oblique", [1.5, 1.5]),
    ("shallow", [2.0, 0.5]),
];

/// Where receivers are compared.
#[allow(dead_code, reason = "tests and benchmarks use a part each")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At the point given.
    Point,
    /// At the centre of the cell that holds it; the force, too, acts at the middle of a face.
    Cell,
}

/// Errors by receiver and component.
pub fn errors(
    program: &Path,
    is_vertical: bool,
    cells: f64,
    place: Place,
    sets: &[String],
) -> Vec<(String, Error)> {
    let wavelength = HALF_PLANE.rayleigh_speed() / RICKER.frequency;
    let h = wavelength / cells;
    let p = HALF_PLANE.pressure_speed();
    // From the first to the last of the Rayleigh wave that passes the farthest receiver; nothing
    // comes back from the sides until then.
    let duration = 3.0 / RICKER.frequency + 3.0 / RICKER.frequency;
    let half_width = (0.5 * (p * duration + 3.0 * wavelength) / h).ceil();
    let depth = (0.5 * (p * duration + 2.0 * wavelength) / h).ceil();
    let shift = if place == Place::Cell { 0.5 } else { 0.0 };
    let mut text = format!(
        "title = \"Lamb\"\n[model]\nkind = \"classical\"\ndimensions = 2\nlambda = {}\nmu = {}\n\
         density = {}\n[grid]\ncells = [{}, {}]\nspacing = {h}\norigin = [{}, {}]\n\
         [time]\nduration = {duration}\n",
        HALF_PLANE.lambda,
        HALF_PLANE.mu,
        HALF_PLANE.density,
        2.0 * half_width,
        depth,
        -(half_width + shift) * h,
        -depth * h,
    );
    for side in ["x1-", "x1+", "x2-"] {
        text += &format!("[[side]]\nside = \"{side}\"\nkind = \"non-reflecting\"\n");
    }
    let field = if is_vertical { "sigma22" } else { "sigma12" };
    text += &format!(
        "[[load]]\nside = \"x2+\"\nfield = \"{field}\"\nat = 0\namplitude = {FORCE}\n\
         time = {{ kind = \"ricker\", frequency = {} }}\n",
        RICKER.frequency
    );
    let mut points = Vec::new();
    for (name, at) in RECEIVERS {
        let mut at = at.map(|x| x * wavelength);
        if place == Place::Cell {
            at = [(at[0] / h).round() * h, ((at[1] / h - 1e-6).floor().max(0.0) + 0.5) * h];
        }
        points.push(at);
        text += &format!(
            "[[receiver]]\nname = \"{name}\"\nat = [{}, {}]\nfields = [\"v1\", \"v2\"]\n",
            at[0], -at[1]
        );
    }
    let folder = tempfile::tempdir().expect("a scratch folder");
    let [case, out] = ["lamb.toml", "out"].map(|name| folder.path().join(name));
    fs::write(&case, text).expect("a case written");
    let mut command = Command::new(program);
    command.arg("run").arg(&case).arg("--out").arg(&out);
    for set in sets {
        command.arg("--set").arg(set);
    }
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = fs::read_to_string(out.join("receivers.csv")).expect("a table of receivers");
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().expect("a header");
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.iter().map(|number| number.parse().expect("a number")).collect())
        .collect();
    let column = |name: &str| -> Vec<f64> {
        let index = names.iter().position(|n| *n == name).expect("a column");
        rows.iter().map(|row| row[index]).collect()
    };
    let time = column("time");
    let mut results = Vec::new();
    for ((name, _), at) in RECEIVERS.iter().zip(points) {
        // Positive stress of the upper side pulls upwards; x₂ points up, z down.
        let force = if is_vertical { [0.0, -FORCE] } else { [FORCE, 0.0] };
        let [v1, down] = HALF_PLANE.lamb(force, at, &time, RICKER, 1);
        let v2: Vec<f64> = down.iter().map(|v| -v).collect();
        for (component, exact) in [("v1", v1), ("v2", v2)] {
            // On the axis one component vanishes by symmetry.
            if at[0] == 0.0 && (component == "v1") == is_vertical {
                continue;
            }
            let name = format!("{name}.{component}");
            results.push((name.clone(), error(&column(&name), &exact)));
        }
    }
    results
}
