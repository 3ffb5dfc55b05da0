//! Shear bands against Rudnicki & Rice's closed form.

use super::random_solids::{random_rotation, rank_one_update, rotate_tensor, search_extremes};
use crate::support::states::seeded_generator;
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::yield_set::parameters::Mises;
use wellposed_analysis::acoustic_tensor3::AcousticTensor3;

#[test]
fn shear_bands_start_at_the_hardening_of_rudnicki_and_rice() {
    check_shear_bands(16);
}

#[test]
#[ignore = "takes half a minute"]
fn many_shear_bands_start_at_the_hardening_of_rudnicki_and_rice() {
    check_shear_bands(120);
}

/// Checks the onset of shear bands in `states` random states.
fn check_shear_bands(states: usize) {
    let random = &mut seeded_generator(10);
    let (mut worst, mut count) = ([0.0_f64; 2], 0);
    while count < states {
        let poisson: f64 = random.uniform(-0.1, 0.45);
        let shear = random.log_uniform(0.1, 10.0);
        let solid = Isotropic {
            lambda: 2.0 * shear * poisson / (1.0 - 2.0 * poisson),
            mu: shear,
            density: random.log_uniform(0.3, 3.0),
            microrotation: None,
        };
        let (friction, dilatancy) = (random.uniform(0.0, 1.2), random.uniform(-0.3, 1.2));
        // Principal values of the deviatoric stress over √J₂ in descending order, at a Lode angle in (0°, 60°).
        let lode = random.uniform(0.02, 0.98) * std::f64::consts::FRAC_PI_3;
        let deviators = [0.0, 2.0, 4.0].map(|third: f64| {
            2.0 / 3.0_f64.sqrt() * (lode - third * std::f64::consts::FRAC_PI_3).cos()
        });
        let [largest, middle, smallest] = [deviators[0], deviators[1], deviators[2]];
        let sum = (dilatancy + friction) / 3.0;
        let xi = (1.0 + poisson) * sum - middle * (1.0 - poisson);
        if xi - smallest < 0.05 || largest - xi < 0.05 {
            continue;
        }
        let expected = shear
            * ((1.0 + poisson) / (9.0 * (1.0 - poisson)) * (dilatancy - friction).powi(2)
                - 0.5 * (1.0 + poisson) * (middle + sum).powi(2));
        let angle = ((xi - smallest) / (largest - xi)).sqrt().atan();
        let q = random_rotation(random);
        let (scale, pressure) = (random.log_uniform(0.1, 10.0), random.uniform(-1.0, 1.0));
        let mut principal = [[0.0; 3]; 3];
        for i in 0..3 {
            principal[i][i] = scale * deviators[i] + pressure;
        }
        let stress = Stress { force: rotate_tensor(&q, &principal), couple: [[0.0; 3]; 3] };
        let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
        let with = |hardening: f64| {
            let set = Mises { hardening, ..Mises::new_drucker_prager(1.0, friction, dilatancy) };
            rank_one_update(&solid, &set.condition(&stress).unwrap())
                .map(|update| search_extremes(&tensor, &update))
        };
        let bulk = solid.lambda + 2.0 / 3.0 * shear;
        let least = -shear - bulk * friction * dilatancy;
        let (mut below, mut above) = (least + 1e-3 * shear, expected.max(0.0) + shear);
        assert!(with(above).unwrap().slowest.squared_speed > 0.0);
        let mut onset = None;
        while above - below > 1e-13 * shear {
            let hardening = 0.5 * (below + above);
            let slowest = with(hardening).unwrap().slowest;
            if slowest.squared_speed <= 0.0 {
                below = hardening;
                onset = Some(slowest.normal);
            } else {
                above = hardening;
            }
            if hardening == below && hardening == above {
                break;
            }
        }
        let normal = onset.unwrap();
        let along = |axis: usize| (0..3).map(|i| q[i][axis] * normal[i]).sum::<f64>().abs();
        // The expected `angle` is that from the direction of the smallest principal stress to the normal of the band.
        let found = along(0).atan2(along(2));
        worst[0] = worst[0].max((below - expected).abs() / shear);
        worst[1] = worst[1].max((found - angle).abs()).max(along(1));
        count += 1;
    }
    println!("worst h_cr {:e} G, angle {:e} rad over {count}", worst[0], worst[1]);
    assert!(worst[0] < 1e-10 && worst[1] < 1e-6);
}
