//! Energy conservation by the symmetriser, of valid and of faulty equations.

use crate::support::slipping::Slipping;
use crate::support::states::seeded;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use wellposed_analysis::energy::energy;

use crate::random_solids::{KINDS, solid_of_order_one};

/// The symmetriser confirms energy conservation of valid solids and detects planted errors.
#[test]
fn energy_tells_sound_equations_from_others() {
    let random = &mut seeded(43);
    for index in 0..60 {
        let solid = solid_of_order_one(random, KINDS[index % 3]);
        let sound = solid.rates::<3>();
        let found = energy(&sound, &sound, 1.0);
        assert!(found.definiteness > 1e-3, "{found:?}");
        assert!(found.asymmetry.max(found.antisymmetry) < 1e-14, "{found:?}");
        // Rounding of some thousand rotations of 24 rows.
        assert!(found.elastic_growth.max(found.growth) < 1e-12, "{found:?}");
        assert_eq!(found.zeros, sound.stresses() - sound.velocities());
        // An asymmetric stiffness.
        let mut other = sound.clone();
        let moved = other.stiffness[(0, 1)] + models::Rounded::given(0.1);
        other.stiffness[(0, 1)] = moved;
        let found = energy(&other, &other, 1.0);
        assert!(found.asymmetry > 1e-3, "{found:?}");
    }
    // Slip with friction but without dilatancy.
    let slipping = Slipping { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy: 0.0 };
    let elastic = Slipping { dilatancy: 0.6, ..slipping };
    let couple = Some(CoupleModuli { beta: 0.2, gamma: 0.4, eta: 0.3 });
    let rotation = Microrotation { alpha: 0.3, inertia: 1.0, couple };
    let solid = Isotropic::new(1.0, 1.0, 1.0, Some(rotation)).expect("sound moduli");
    let found = energy(&solid.rates::<2>(), &slipping.equations(), 1.0);
    assert!(found.growth > 1e-2, "{found:?}");
    let found = energy(&solid.rates::<2>(), &elastic.equations(), 1.0);
    assert!(found.growth < 1e-7, "{found:?}");
}
