//! The rows of the table.

use super::{ANY, Field, Key, Presence, Users};
use crate::kind::{Solid, Yield};
use models::granular_flow::RotationKind;
use models::registry;
use std::sync::{PoisonError, RwLock};

use Field::{
    Count, Number, OptionalMatrix, OptionalNumber, OptionalPair, Pair, Plain, Text, Texts, Whole,
};
use Presence::{Default as Or, Optional, Required};

const ALL: Users = Users::All;
const FLOWS: Users = Users::Flows(|_| true);
const WITH_BALANCE_OF_SPIN: Users =
    Users::Flows(|flow| flow.rotation() == RotationKind::IntrinsicSpin);
const WITH_SPIN: Users = Users::Flows(|flow| {
    matches!(flow.rotation(), RotationKind::IntrinsicSpin | RotationKind::Free)
});
const WITH_STRESS_ANGLE_RATE: Users =
    Users::Flows(|flow| flow.rotation() == RotationKind::StressAxes);
const SOLIDS: Users = Users::Solids(&Solid::ALL);
const ISOTROPIC: Users =
    Users::Solids(&[Solid::Classical, Solid::ReducedCosserat, Solid::Cosserat]);
const WITH_ROTATION: Users = Users::Solids(&[Solid::ReducedCosserat, Solid::Cosserat]);
const WITH_INERTIA: Users =
    Users::Solids(&[Solid::ReducedCosserat, Solid::Cosserat, Solid::CosseratCompliances]);
const MODULI_OF_COUPLES: Users = Users::Solids(&[Solid::Cosserat]);
const COMPLIANCES: Users = Users::Solids(&[Solid::CosseratCompliances]);
const WITH_COUPLES: Users = Users::Solids(&[Solid::Cosserat, Solid::CosseratCompliances]);

const YIELDING: &[Yield] = &Yield::ALL;
const INTERLAYER: &[Yield] = &[Yield::Interlayer];
const CONES: &[Yield] = &[Yield::DruckerPrager, Yield::CosseratMises];
const MISES: &[Yield] = &[Yield::VonMises, Yield::DruckerPrager, Yield::CosseratMises];
const COSSERAT_MISES: &[Yield] = &[Yield::CosseratMises];

/// Writes one row per key: name; label, unit; meaning; kinds and yield sets, presence, field.
macro_rules! keys {
    ($($name:literal: $label:literal [$unit:literal] $meaning:literal;
       $kinds:ident $(that yield by $sets:ident)?, $presence:expr, $field:expr;)*) => {
        &[$(Key {
            name: $name,
            label: $label,
            unit: $unit,
            meaning: $meaning,
            users: $kinds,
            sets: keys!(@sets $($sets)?),
            presence: $presence,
            field: $field,
        }),*]
    };
    (@sets) => { ANY };
    (@sets $sets:ident) => { $sets };
}

/// Every key of a case file, in the order in which files are written. Those of `[map]` and
/// `[compare]` are required where their section stands.
pub fn keys() -> &'static [Key] {
    /// The number of registered flows that the table was made for, and the table.
    static TABLE: RwLock<(usize, &[Key])> = RwLock::new((0, &[]));
    let flows = registry::flows();
    let (made_for, table) = *TABLE.read().unwrap_or_else(PoisonError::into_inner);
    if made_for == flows.len() {
        return table;
    }
    let mut table = HEAD.to_vec();
    let constants = flows.iter().flat_map(|flow| flow.parameters());
    for constant in constants {
        let key = Key::of_constant(constant);
        if table.iter().all(|other| other.name != key.name) {
            table.push(key);
        }
    }
    table.extend_from_slice(REST);
    // Never freed, as entries of the registry are not: keys are handed out by reference.
    let table: &'static [Key] = table.leak();
    *TABLE.write().unwrap_or_else(PoisonError::into_inner) = (flows.len(), table);
    table
}

/// The keys before the constants of flows.
static HEAD: &[Key] = keys! {
    "title": "title" [""] "one line that says what the case is";
        ALL, Optional, Text;
    "name": "name" [""] "names the folder of results: letters, digits, '-', '_' and '.', not dots alone; absent: the name of the file";
        ALL, Optional, Text;

    "model.kind": "kind of model" [""] "harris-grekova, double-shearing, plastic-potential or free-rotating for flows; classical, reduced-cosserat, cosserat or cosserat-compliances for solids";
        ALL, Required(0.0), Text;
};

/// The keys after them.
static REST: &[Key] = keys! {
    "model.dimensions": "dimensions" [""] "2 for plane strain, 3 for space";
        ISOTROPIC, Required(3.0), Whole(|n| &mut n.solid.dimensions);
    "model.lambda": "Lamé modulus λ" ["Pa"] "Lamé modulus λ; 3λ + 2μ > 0";
        ISOTROPIC, Required(8.1e9), Number(|n| &mut n.solid.lambda);
    "model.mu": "shear modulus μ" ["Pa"] "shear modulus μ; > 0";
        ISOTROPIC, Required(8.1e9), Number(|n| &mut n.solid.mu);
    "model.alpha": "Cosserat modulus α" ["Pa"] "modulus α of the antisymmetric strain; > 0";
        WITH_ROTATION, Required(1.005e9), Number(|n| &mut n.solid.alpha);
    "model.beta": "Cosserat modulus β" ["N"] "couple modulus β; 3β + 2γ > 0";
        MODULI_OF_COUPLES, Required(7.75e8), Number(|n| &mut n.solid.beta);
    "model.gamma": "Cosserat modulus γ" ["N"] "couple modulus γ; > 0";
        MODULI_OF_COUPLES, Required(1.5e8), Number(|n| &mut n.solid.gamma);
    "model.eta": "Cosserat modulus η" ["N"] "couple modulus η; > 0";
        MODULI_OF_COUPLES, Required(3e8), Number(|n| &mut n.solid.eta);
    "model.a1": "compliance a₁" ["1/Pa"] "compliance a₁; > |b₁|";
        COMPLIANCES, Required(4.6296296296296296e-11), Number(|n| &mut n.solid.a1);
    "model.b1": "compliance b₁" ["1/Pa"] "compliance b₁; a₁ + b₁ = a₂ − b₂ in isotropic solids";
        COMPLIANCES, Required(1.5432098765432098e-11), Number(|n| &mut n.solid.b1);
    "model.a2": "compliance a₂" ["1/Pa"] "compliance a₂; > |b₂|";
        COMPLIANCES, Required(2.7962041638724895e-10), Number(|n| &mut n.solid.a2);
    "model.b2": "compliance b₂" ["1/Pa"] "compliance b₂";
        COMPLIANCES, Required(2.178920212921872e-10), Number(|n| &mut n.solid.b2);
    "model.alpha2": "couple modulus α₂" ["N"] "couple modulus α₂; > 0";
        COMPLIANCES, Required(4.5e8), Number(|n| &mut n.solid.alpha2);
    "model.density": "density ρ" ["kg/m³"] "density ρ; > 0";
        SOLIDS, Required(2700.0), Number(|n| &mut n.solid.density);
    "model.inertia": "moment of inertia j" ["kg/m"] "moment of inertia per unit volume j; > 0";
        WITH_INERTIA, Required(2700.0), Number(|n| &mut n.solid.inertia);

    "background.density": "density ρ" ["kg/m³"] "density ρ; > 0";
        FLOWS, Required(1600.0), Number(|n| &mut n.background.density);
    "background.pressure": "pressure p" ["Pa"] "pressure p, positive in compression; > −c cot φ";
        FLOWS, Required(1000.0), Number(|n| &mut n.background.pressure);
    "background.stress_angle_deg": "stress angle Ψ_Σ" ["deg"] "angle Ψ_Σ of the greater (more tensile) principal stress from x₁, anticlockwise";
        FLOWS, Required(45.0), Number(|n| &mut n.background.stress_angle_deg);
    "background.shear_rate": "shear rate Q_D" ["1/s"] "magnitude Q_D of the deviatoric deformation rate; > 0";
        FLOWS, Required(1.0), Number(|n| &mut n.background.shear_rate);
    "background.velocity": "velocity V" ["m/s"] "velocity V";
        FLOWS, Or(0.0), Pair(|n| &mut n.background.velocity);
    "background.half_vorticity": "half the vorticity s₂₁" ["1/s"] "half the vorticity s₂₁ = ½(∂₁V₂ − ∂₂V₁), positive anticlockwise";
        FLOWS, Or(0.0), Number(|n| &mut n.background.half_vorticity);
    "background.noncoaxiality_deg": "non-coaxiality Δ" ["deg"] "non-coaxiality Δ = Ψ_D − Ψ_Σ; absent: from the spin where that is given, else 0; 0 for plastic-potential";
        FLOWS, Optional, OptionalNumber(|n| &mut n.background.noncoaxiality_deg);
    "background.spin": "spin Ω" ["rad/s"] "intrinsic spin Ω, anticlockwise; may stand in place of noncoaxiality_deg";
        WITH_SPIN, Optional, OptionalNumber(|n| &mut n.background.spin);
    "background.pressure_gradient": "pressure gradient ∇p" ["Pa/m"] "gradient of the pressure";
        FLOWS, Or(0.0), Pair(|n| &mut n.background.pressure_gradient);
    "background.stress_angle_gradient_deg": "stress-angle gradient ∇Ψ_Σ" ["deg/m"] "gradient of the stress angle";
        FLOWS, Or(0.0), Pair(|n| &mut n.background.stress_angle_gradient_deg);
    "background.density_gradient": "density gradient ∇ρ" ["kg/m⁴"] "gradient of the density; 0 where ν = 0";
        FLOWS, Or(0.0), Pair(|n| &mut n.background.density_gradient);
    "background.spin_gradient": "spin gradient ∇Ω" ["rad/(s·m)"] "gradient of the spin";
        WITH_BALANCE_OF_SPIN, Or(0.0), Pair(|n| &mut n.background.spin_gradient);
    "background.spin_acceleration": "spin acceleration DΩ/Dt" ["rad/s²"] "material rate DΩ/Dt of the spin";
        WITH_BALANCE_OF_SPIN, Or(0.0), Number(|n| &mut n.background.spin_acceleration);
    "background.inertia_rate": "rate of inertia DI/Dt" ["m²/s"] "material rate DI/Dt of the moment of inertia";
        WITH_BALANCE_OF_SPIN, Or(0.0), Number(|n| &mut n.background.inertia_rate);
    "background.inertia_gradient": "inertia gradient ∇I" ["m"] "gradient of the moment of inertia";
        WITH_BALANCE_OF_SPIN, Or(0.0), Pair(|n| &mut n.background.inertia_gradient);
    "background.rotational_stress": "rotational stress r" ["Pa"] "r = ½(σ₁₂ − σ₂₁), first index the face normal; absent: −m sign(Ω − s₂₁)";
        WITH_BALANCE_OF_SPIN, Optional, OptionalNumber(|n| &mut n.background.rotational_stress);
    "background.deviatoric_stress": "deviatoric stress q" ["Pa"] "deviatoric stress q; absent: on yield";
        FLOWS, Optional, OptionalNumber(|n| &mut n.background.deviatoric_stress);
    "background.velocity_gradient": "velocity gradient ∇V" ["1/s"] "velocity gradient, entry [i][j] = ∂ⱼVᵢ; derived, checked where given";
        FLOWS, Optional, OptionalMatrix(|n| &mut n.background.velocity_gradient);
    "background.acceleration": "acceleration DV/Dt − F" ["m/s²"] "material acceleration less body force; derived, checked where given";
        FLOWS, Optional, OptionalPair(|n| &mut n.background.acceleration);
    "background.body_moment": "body moment G" ["m²/s²"] "body moment per unit mass; derived, checked where given";
        WITH_BALANCE_OF_SPIN, Optional, OptionalNumber(|n| &mut n.background.body_moment);
    "background.stress_angle_rate_deg": "stress-angle rate DΨ_Σ/Dt" ["deg/s"] "material rate of the stress angle; derived, checked where given";
        WITH_STRESS_ANGLE_RATE, Optional, OptionalNumber(|n| &mut n.background.stress_angle_rate_deg);

    "yield.kind": "yield set" [""] "interlayer, von-mises, drucker-prager or cosserat-mises; without the section [yield] a solid stays elastic";
        SOLIDS, Required(0.0), Text;
    "yield.active": "active conditions" [""] "the conditions that hold with equality, as in [\"+sigma21\", \"-m32\"]; absent: as the stress of [stress] decides";
        SOLIDS that yield by INTERLAYER, Optional, Texts;
    "yield.shear_strength": "shear strength τ₀" ["Pa"] "shear strength τ₀ of the layers without normal stress; ≥ 0";
        SOLIDS that yield by INTERLAYER, Required(1e6), Number(|n| &mut n.yields.shear_strength);
    "yield.shear_friction": "friction of the layers" [""] "friction κ_τ of the layers; ≥ 0";
        SOLIDS that yield by INTERLAYER, Required(0.6), Number(|n| &mut n.yields.shear_friction);
    "yield.shear_dilatancy": "dilatancy of the layers" [""] "dilatancy κ̂_τ of the layers; associated if equal to the friction";
        SOLIDS that yield by INTERLAYER, Required(0.1), Number(|n| &mut n.yields.shear_dilatancy);
    "yield.couple_strength": "couple strength μ₀" ["N/m"] "couple strength μ₀ of the layers without normal stress; ≥ 0";
        WITH_COUPLES that yield by INTERLAYER, Required(1e6), Number(|n| &mut n.yields.couple_strength);
    "yield.couple_friction": "friction of rolling" ["m"] "friction κ_μ of rolling; ≥ 0";
        WITH_COUPLES that yield by INTERLAYER, Required(0.6), Number(|n| &mut n.yields.couple_friction);
    "yield.couple_dilatancy": "dilatancy of rolling" ["m"] "dilatancy κ̂_μ of rolling; associated if equal to the friction";
        WITH_COUPLES that yield by INTERLAYER, Required(0.6), Number(|n| &mut n.yields.couple_dilatancy);
    "yield.strength": "shear strength k" ["Pa"] "strength k in shear; > 0";
        SOLIDS that yield by MISES, Required(1e6), Number(|n| &mut n.yields.strength);
    "yield.friction": "friction" [""] "friction κ of τ̄ + κ σ_m ≤ k; ≥ 0";
        SOLIDS that yield by CONES, Required(0.6), Number(|n| &mut n.yields.friction);
    "yield.dilatancy": "dilatancy" [""] "dilatancy κ̂; associated if equal to the friction";
        SOLIDS that yield by CONES, Required(0.3), Number(|n| &mut n.yields.dilatancy);
    "yield.antisymmetric_weight": "antisymmetric weight h" [""] "weight h of the antisymmetric stress; ≥ 0";
        WITH_ROTATION that yield by COSSERAT_MISES, Required(1.0), Number(|n| &mut n.yields.antisymmetric_weight);
    "yield.symmetric_length": "internal length ℓ_s" ["m"] "internal length ℓ_s of the symmetric couple stress; 0: no limit to it";
        MODULI_OF_COUPLES that yield by COSSERAT_MISES, Or(0.0), Number(|n| &mut n.yields.symmetric_length);
    "yield.antisymmetric_length": "internal length ℓ_a" ["m"] "internal length ℓ_a of the antisymmetric couple stress; 0: no limit to it";
        MODULI_OF_COUPLES that yield by COSSERAT_MISES, Or(0.0), Number(|n| &mut n.yields.antisymmetric_length);
    "yield.hardening": "plastic modulus H" ["Pa"] "plastic modulus H; 0 for ideal plasticity, negative while softening";
        SOLIDS that yield by MISES, Or(0.0), Number(|n| &mut n.yields.hardening);
    "yield.plastic_rate": "plastic rate Λ" ["1/s"] "rate Λ at which the background flows, its stress at rest; ≥ 0; damps waves, changes no speed";
        SOLIDS that yield by MISES, Or(0.0), Number(|n| &mut n.yields.plastic_rate);

    "stress.pressure": "pressure p" ["Pa"] "mean pressure in the plane p = −½(σ₁₁ + σ₂₂); the other stresses are scaled until they yield";
        SOLIDS that yield by YIELDING, Or(0.0), Number(|n| &mut n.stress.pressure);
    "stress.deviatoric_stress": "deviatoric stress q" ["Pa"] "deviatoric stress q in the plane, half the difference of the principal stresses, before scaling";
        SOLIDS that yield by YIELDING, Or(1.0), Number(|n| &mut n.stress.deviatoric_stress);
    "stress.stress_angle_deg": "stress angle ψ_σ" ["deg"] "angle of the greater principal stress from x₁, anticlockwise";
        SOLIDS that yield by YIELDING, Or(0.0), Number(|n| &mut n.stress.stress_angle_deg);
    "stress.out_of_plane_stress": "out-of-plane stress σ₃₃ + p" ["Pa"] "stress σ₃₃ across the plane in excess of −p, before scaling";
        ISOTROPIC that yield by MISES, Or(0.0), Number(|n| &mut n.stress.out_of_plane_stress);
    "stress.rotational_stress": "rotational stress r" ["Pa"] "r = ½(σ₂₁ − σ₁₂), second index the face normal, before scaling";
        WITH_INERTIA that yield by YIELDING, Or(0.0), Number(|n| &mut n.stress.rotational_stress);
    "stress.couple_stress": "couple stress" ["N/m"] "couple stress [m₃₁, m₃₂], before scaling; m₁₃ and m₂₃ are 0";
        WITH_COUPLES that yield by YIELDING, Or(0.0), Pair(|n| &mut n.stress.couple_stress);

    "wave.number": "wave number k" ["1/m"] "wave number k at which roots are listed; > 0";
        ALL, Or(1000.0), Number(|n| &mut n.wave.number);
    "wave.direction_deg": "wave direction ψ_K" ["deg"] "direction ψ_K of the wave vector from x₁, anticlockwise";
        ALL, Or(0.0), Number(|n| &mut n.wave.direction_deg);

    "wave.elevation_deg": "wave elevation" ["deg"] "angle of the wave vector above the plane of x₁ and x₂; 0 in plane strain";
        ISOTROPIC, Or(0.0), Number(|n| &mut n.wave.elevation_deg);
    "wave.greatest_number": "greatest wave number" ["1/m"] "greatest wave number of dispersion curves; 0: 4 over the solid's own length";
        SOLIDS, Or(0.0), Number(|n| &mut n.wave.greatest_number);

    "map.x.parameter": "parameter" [""] "name of the number along the x axis";
        ALL, Required(0.0), Text;
    "map.x.from": "first value" [""] "first value along the x axis";
        ALL, Required(0.0), Plain;
    "map.x.to": "last value" [""] "last value along the x axis";
        ALL, Required(0.0), Plain;
    "map.x.points": "points" [""] "number of points along the x axis";
        ALL, Required(0.0), Count;
    "map.y.parameter": "parameter" [""] "name of the number along the y axis";
        ALL, Required(0.0), Text;
    "map.y.from": "first value" [""] "first value along the y axis";
        ALL, Required(0.0), Plain;
    "map.y.to": "last value" [""] "last value along the y axis";
        ALL, Required(0.0), Plain;
    "map.y.points": "points" [""] "number of points along the y axis";
        ALL, Required(0.0), Count;

    "compare.kinds": "kinds of model" [""] "kinds of model to compare on this state";
        FLOWS, Required(0.0), Texts;
};
