//! Stress–strain diagram of a spring and a friction element in series.

use wellposed_figures::{DiagramCurve, DiagramFigure};

/// Builds the diagram of elastic-plastic cycles: stress between −1 and 1, energies against time.
pub(crate) fn build_diagram() -> DiagramFigure {
    let (mut strain, mut stress, mut dissipated, mut work) = (0.0, 0.0_f64, 0.0, 0.0);
    let (mut path, mut energies) = (vec![[0.0, 0.0]], vec![[0.0; 4]]);
    for step in 1..=700 {
        let increment: f64 = match step {
            0..=100 | 301..=500 => -0.03,
            _ => 0.03,
        };
        let trial: f64 = stress + increment;
        stress = trial.clamp(-1.0, 1.0);
        strain += increment;
        dissipated += ((trial - stress) * stress).abs();
        work += stress * increment;
        path.push([strain, stress]);
        energies.push([0.01 * f64::from(step), work, 0.5 * stress * stress, dissipated]);
    }
    let curve = |index: usize, label: &str| DiagramCurve {
        label: label.to_owned(),
        points: energies.iter().map(|row| [row[0], row[index]]).collect(),
    };
    DiagramFigure {
        title: "Elastic-plastic cycles".to_owned(),
        subtitle: "spring - hinge".to_owned(),
        strain_label: "strain ε".to_owned(),
        stress_label: "stress σ (Pa)".to_owned(),
        path,
        time_label: "time t (s)".to_owned(),
        curve_label: "energy per volume (J/m³)".to_owned(),
        curves: vec![
            curve(1, "work"),
            curve(2, "stored in spring"),
            curve(3, "dissipated by hinge"),
        ],
        start_label: "start (arrows: direction of time)".to_owned(),
        end_label: "end".to_owned(),
    }
}
