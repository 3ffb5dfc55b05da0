//! Verifies the key `ends` of saturated joints: closed and open ends of layers reflect the fluid's pressure with opposite
//! signs, and ends that contradict other sections are refused.

use crate::support;

use support::{parse_case, replace_first};
use wellposed::study::ignore_progress;
use wellposed::study::simulate::SimulationSettings;

/// Half-width of the short layer, m.
const HALF: f64 = 0.75;

/// Two rows of rock with one saturated layer between them, of `cells` cells from x₁ = −[`HALF`] on; a load on the upper
/// side about x₁ = 0 compresses the layer for a short time. `boundary` is the kind of the boundaries normal to x₁.
fn create_layer_case(cells: usize, ends: &str, boundary: &str) -> String {
    format!(
        "[model]
kind = 'classical'
lambda = 1.89e10
mu = 2.43e10
density = 2700
[[block]]
name = 'rock'
cells = [{cells}, 20]
spacing = 0.0125
origin = [{from:?}, -0.25]
repeat = [1, 2]
[[joint]]
every = 'x2'
kind = 'saturated'
thickness = 1e-3
skeleton_density = 1300
fluid_density = 250
added_density = 100
undrained_stiffness = 1.5e9
coupling_stiffness = 0.45e9
fluid_stiffness = 0.7e9
instantaneous_compliance = 2.7e-9
delayed_compliance = 5e-9
viscosity = 7500
collapse_stiffness = 6e9
porosity = 0.1
{ends}
[time]
duration = 9e-4
[[boundary]]
side = 'x1-'
kind = '{boundary}'
[[boundary]]
side = 'x1+'
kind = '{boundary}'
[[boundary]]
side = 'x2-'
kind = 'non-reflecting'
{load}",
        from = -HALF,
        load = format_load(0.0, -1e6),
    )
}

/// Load of a pressure pulse with an amplitude, Pa, on 0.2 m about a coordinate x₁, m.
fn format_load(centre: f64, amplitude: f64) -> String {
    format!(
        "[[load]]
side = 'x2+'
field = 'sigma22'
amplitude = {amplitude:?}
from = {:?}
to = {:?}
time = {{ kind = 'pulse', duration = 1.5e-4 }}
",
        centre - 0.1,
        centre + 0.1,
    )
}

/// Number of cells of the short layer along x₁.
const CELLS: usize = 120;

/// Final pressures of the fluid by face of the layer for |x₁| < [`HALF`], Pa.
fn compute_pressures(case: &str) -> Vec<f64> {
    let case = parse_case(case).expect("a sound case");
    let result = wellposed::simulate(&case, SimulationSettings::default(), &ignore_progress)
        .expect("a sound case");
    let faces = result.fields.joint_faces.iter().filter(|face| face.position[0] < HALF);
    faces.map(|face| face.record.pressure).collect()
}

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).fold(0.0, |largest: f64, (one, other)| largest.max((one - other).abs()))
}

/// Verifies by the method of images that closed and open ends reflect the pressure with opposite signs: between planes of
/// symmetry closed ends have images of the same load, between planes of antisymmetry open ends have those of the opposite
/// load. The images are in a periodic layer of twice the length. The other kind of ends does not have these images.
#[test]
fn ends_reflect_pressure_like_images_of_the_load() {
    let cases = [("closed", "open", "symmetry", -1e6), ("open", "closed", "antisymmetry", 1e6)];
    for (ends, others, boundary, amplitude) in cases {
        let compute = |word: &str| {
            compute_pressures(&create_layer_case(CELLS, &format!("ends = '{word}'"), boundary))
        };
        let found = compute(ends);
        let periodic = create_layer_case(2 * CELLS, "", "periodic");
        let images = compute_pressures(&(periodic + &format_load(2.0 * HALF, amplitude)));
        assert_eq!(images.len(), CELLS);
        let largest = images.iter().fold(0.0, |largest: f64, own| largest.max(own.abs()));
        assert!(largest > 1e5, "{largest}");
        let error = largest_difference(&found, &images);
        assert!(error < 1e-12 * largest, "{ends}: {error:e} of {largest:e}");
        let wrong = largest_difference(&compute(others), &images);
        assert!(wrong > largest, "{others}: {wrong:e} of {largest:e}");
        println!("{ends}: {error:e}, {others}: {wrong:e} of {largest:e}");
    }
    // Ends are closed by default.
    let compute = |ends: &str| compute_pressures(&create_layer_case(CELLS, ends, "free"));
    assert_eq!(compute(""), compute("ends = 'closed'"));
}

/// Verifies the refusals: joints without fluid, different ends along one axis, layers without ends.
#[test]
fn contradictory_ends_are_refused() {
    let case = create_layer_case(CELLS, "ends = 'open'", "non-reflecting");
    let refuse = |text: &str| parse_case(text).expect_err("a refusal");
    let elastic = replace_first(&case, "kind = 'saturated'", "kind = 'elastic'");
    let (head, rest) = elastic.split_once("skeleton_density").expect("constants");
    let (_, tail) = rest.split_once("[time]").expect("a time");
    let constants = "density = 1500\nlongitudinal_speed = 1000\nshear_speed = 500\nends = 'open'\n";
    assert_eq!(
        refuse(&format!("{head}{constants}[time]{tail}")),
        "folder/x.toml:19: joint[0].ends: found in a joint of kind 'elastic'; leave it out; joints with ends: saturated"
    );
    assert_eq!(
        refuse(&replace_first(&case, "'open'", "'opne'")),
        "folder/x.toml:27: joint[0].ends: found 'opne'; did you mean 'open'? allowed: closed, open"
    );
    let (before, joint) = case.split_once("[[joint]]").expect("a joint");
    let (joint, after) = joint.split_once("[time]").expect("a time");
    let closed = replace_first(
        joint,
        "every = 'x2'",
        "inside = { shape = 'box', from = [-1, -1], to = [0, 1] }",
    );
    let closed = replace_first(&closed, "'open'", "'closed'");
    let wide = replace_first(before, "repeat = [1, 2]", "repeat = [2, 2]");
    let wide = replace_first(&wide, "cells = [120, 20]", "cells = [60, 20]");
    let message = refuse(&format!("{wide}[[joint]]{joint}[[joint]]{closed}[time]{after}"));
    assert_eq!(
        message,
        "folder/x.toml:43: joint[1].ends: found 'closed', beside 'open' of joint[0] (folder/x.toml:12); the same for all saturated joints with layers along x1"
    );
    let periodic = create_layer_case(CELLS, "ends = 'open'", "periodic");
    assert_eq!(
        refuse(&periodic),
        "folder/x.toml:27: joint[0].ends: found 'open' with periodic boundaries; leave it out: layers along a periodic axis have no ends"
    );
}
