//! Energy conservation by the symmetriser, of valid and of faulty equations.

use crate::support::slipping_layer::SlippingLayer;
use crate::support::states::seeded_generator;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use wellposed_analysis::energy::measure_energy_conservation;

use super::random_solids::{THEORIES, random_solid_of_order_one};

/// Verifies that the symmetriser confirms energy conservation of valid solids and detects deliberate errors.
#[test]
fn symmetriser_detects_violations_of_energy_conservation() {
    let random = &mut seeded_generator(43);
    for index in 0..60 {
        let solid = random_solid_of_order_one(random, THEORIES[index % 3]);
        let sound = solid.rates::<3>();
        let found = measure_energy_conservation(&sound, &sound, 1.0);
        assert!(found.definiteness > 1e-3, "{found:?}");
        assert!(found.asymmetry.max(found.antisymmetry_defect) < 1e-14, "{found:?}");
        // Tolerance for the rounding of some thousand rotations of 24 rows by the QR algorithm.
        assert!(found.elastic_growth.max(found.yielding_growth) < 1e-12, "{found:?}");
        assert_eq!(found.zero_root_count, sound.stress_count() - sound.velocity_count());
        // A solid with an asymmetric stiffness has no energy.
        let mut other = sound.clone();
        let moved = other.stiffness[(0, 1)] + models::Rounded::from_rounded(0.1);
        other.stiffness[(0, 1)] = moved;
        let found = measure_energy_conservation(&other, &other, 1.0);
        assert!(found.asymmetry > 1e-3, "{found:?}");
    }
    // Slip with friction but without dilatancy does not conserve energy; associated slip does.
    let slipping = SlippingLayer { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy: 0.0 };
    let elastic = SlippingLayer { dilatancy: 0.6, ..slipping };
    let couple = Some(CoupleModuli { beta: 0.2, gamma: 0.4, eta: 0.3 });
    let rotation = Microrotation { alpha: 0.3, inertia: 1.0, couple };
    let solid = Isotropic::new(1.0, 1.0, 1.0, Some(rotation)).expect("sound moduli");
    let found = measure_energy_conservation(&solid.rates::<2>(), &slipping.equations(), 1.0);
    assert!(found.yielding_growth > 1e-2, "{found:?}");
    let found = measure_energy_conservation(&solid.rates::<2>(), &elastic.equations(), 1.0);
    assert!(found.yielding_growth < 1e-7, "{found:?}");
}
