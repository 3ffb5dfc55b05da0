//! Damped modes of cells with viscous joints: chains, limits of the retardation time, stability.

use super::media::build_medium;
use models::interface::opening_line::LayerMass;
use num_complex::Complex64;
use wellposed_analysis::bloch::BlochError;
use wellposed_analysis::bloch::cell::{
    BlockRow, Cell, CellBlock, CellModel, Joint, JointComponent, JointDelay,
};
use wellposed_analysis::bloch::chain::{Chain, ChainElement, ChainPolarisation, LayerCompliance};

/// One block; joints of 5 mm layers, viscous in shear with a delayed compliance twice the instantaneous one.
fn build_cell_model(time: f64, degree: usize, weld: Option<f64>) -> CellModel {
    let medium = build_medium(5e-3);
    let h = medium.period;
    let mut joint = Joint::from_layer(&medium.layer, false);
    let compliance = 2.0 * medium.layer.tangential_compliance();
    joint.tangential.delay = Some(JointDelay { compliance, retardation_time: time });
    let top = weld.map_or(joint, |factor| {
        let stiffness = factor * medium.block.shear_modulus() / h;
        let component = JointComponent { mass: LayerMass::new_box(0.0), stiffness, delay: None };
        Joint { normal: component, tangential: component }
    });
    let block = CellBlock { width: h, material: medium.block, right_joint: joint, top_joint: top };
    let row = BlockRow { height: h, offset: 0.0, blocks: vec![block] };
    CellModel::new(&Cell::new(vec![row]).expect("valid"), degree)
}

/// Verifies that along an axis, with welded joints normal to the other (extrapolated in 1/K), the damped shear waves
/// are those of the chain.
#[test]
fn damped_cell_along_an_axis_equals_the_chain() {
    let medium = build_medium(5e-3);
    let elastic = medium.layer.tangential_compliance();
    let chain = Chain::new(vec![
        ChainElement::from_block(&medium.block, medium.period, ChainPolarisation::Transverse),
        ChainElement::Layer {
            mass: LayerMass::new_box(medium.layer.mass()),
            compliance: LayerCompliance { elastic, delayed: 2.0 * elastic, retardation_time: 4e-5 },
        },
    ])
    .expect("valid");
    let models = [1e3, 2e3, 4e3].map(|factor| build_cell_model(4e-5, 6, Some(factor)));
    let mut worst = 0.0f64;
    for shift in [0.7, 2.0] {
        let values = models.each_ref().map(|model| {
            let modes = model.damped_modes([shift / medium.period, 0.0]).expect("modes");
            let least = modes.frequencies.iter().map(|omega| omega.im).fold(0.0, f64::min);
            println!("least decay {least:e}, rounding {:e} rad/s", modes.rounding);
            assert!(modes.is_stable());
            modes.frequencies
        });
        for branch in 0..2 {
            let expected = chain.damped_frequency(branch, shift).expect("a wave");
            let [a, b, c] = values.each_ref().map(|values| {
                let distance = |value: &Complex64| (value - expected).norm();
                let nearest = values.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                *nearest.expect("a mode")
            });
            let (x, y) = (2.0 * b - a, 2.0 * c - b);
            let found = y + (y - x) / 3.0;
            let error = (found / expected - 1.0).norm();
            println!("κh = {shift}, branch {branch}: ω = {expected:.3}, error {error:.1e}");
            worst = worst.max(error);
        }
    }
    assert!(worst < 5e-7, "{worst:e}");
}

/// Verifies that slow and fast retardation give the real frequencies of the instantaneous and of the relaxed stiffness,
/// that waves decay between these limits, and that the Hermitian eigenproblem is rejected.
#[test]
fn slow_and_fast_retardation_reach_undamped_limits() {
    let at = [25.0, 14.0];
    let elastic = |share: f64| {
        let medium = build_medium(5e-3);
        let mut joint = Joint::from_layer(&medium.layer, false);
        joint.tangential.stiffness *= share;
        let block = CellBlock {
            width: medium.period,
            material: medium.block,
            right_joint: joint,
            top_joint: joint,
        };
        let row = BlockRow { height: medium.period, offset: 0.0, blocks: vec![block] };
        CellModel::new(&Cell::new(vec![row]).expect("valid"), 4)
            .modes(at, 4, false)
            .expect("modes")
            .frequencies()
    };
    for (time, share) in [(1.0, 1.0), (1e-9, 1.0 / 3.0)] {
        let modes = build_cell_model(time, 4, None).damped_modes(at).expect("modes");
        for (found, expected) in modes.frequencies.iter().zip(elastic(share)) {
            println!("τ = {time:e}: {found:.4}, elastic {expected:.4}");
            assert!((found / expected - 1.0).norm() < 1e-4);
        }
    }
    let viscous = build_cell_model(4e-5, 4, None);
    let modes = viscous.damped_modes(at).expect("modes");
    assert!(modes.is_stable());
    assert!(modes.frequencies[..3].iter().all(|omega| omega.im > 1e-3 * omega.re));
    // Two faces with five points each: as many relaxing modes, with rates between 1/τ and (1 + C₁K)/τ = 3/τ.
    let rates = &modes.decay_rates;
    println!("{:?} {rates:?}", &modes.frequencies[..3]);
    assert_eq!(rates.len(), 10);
    assert!(rates.iter().all(|rate| (0.99..3.01).contains(&(rate * 4e-5))));
    assert_eq!(viscous.modes(at, 3, false), Err(BlochError::ViscousJoint));
}
