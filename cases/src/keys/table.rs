//! Rows of the key table.

use super::key::{Field, Key, Presence, Sets, Users};
use crate::schema::Range;
use models::common::parameter::Parameter as Constant;
use models::elastoplastic::Plastic;
use models::flow::state::State;
use models::flow::{FlowKind, RotationKind};
use models::registry;
use models::solid::SolidKind;
use models::solid::parameters::Theory;
use models::yield_set::YieldSetKind;
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
const SOLIDS: Users = Users::Solids(|_| true);
const PLANE_AND_SPACE: Users = Users::Solids(|solid| !solid.is_plane);
const WITH_ROTATION: Users = Users::Solids(|solid| solid.theory != Theory::Classical);
const WITH_COUPLES: Users = Users::Solids(|solid| solid.theory == Theory::Cosserat);

const YIELDING: Sets = Sets::Any(|_| true);
const CURVED: Sets = Sets::Any(|set| set.is_curved);
const BY_NAMED_CONDITIONS: Sets = Sets::Any(|set| !set.conditions.is_empty());
const PLANE_AND_SPACE_SETS: Sets = Sets::Any(|set| !set.is_plane);

/// Writes one row per key: name; label, unit, meaning; kinds of model and yield sets, presence, range, field.
macro_rules! keys {
    ($($name:literal: $label:literal [$unit:literal] $meaning:literal;
       $kinds:ident $(that yield by $sets:ident)?, $presence:expr $(, in $range:expr)?, $field:expr;)*) => {
        &[$(Key {
            name: $name,
            label: $label,
            unit: $unit,
            meaning: $meaning,
            users: $kinds,
            sets: keys!(@sets $($sets)?),
            presence: $presence,
            range: keys!(@range $($range)?),
            field: $field,
        }),*]
    };
    (@range) => { Range::Finite };
    (@range $range:expr) => { $range };
    (@sets) => { None };
    (@sets $sets:ident) => { Some($sets) };
}

/// Returns all scalar keys of a case file, in the order of writing. Required keys of `[map]` and `[compare]` are
/// required only if their section is present.
pub fn keys() -> &'static [Key] {
    /// Number of registry entries for which the table was built, and the table.
    static TABLE: RwLock<(usize, &[Key])> = RwLock::new((0, &[]));
    let (flows, solids, sets) = (registry::flows(), registry::solids(), registry::yield_sets());
    let entries = flows.len() + solids.len() + sets.len();
    let (made_for, table) = *TABLE.read().unwrap_or_else(PoisonError::into_inner);
    if made_for == entries {
        return table;
    }
    let mut table = HEAD.to_vec();
    let add = |table: &mut Vec<Key>, key: Key| {
        if table.iter().all(|other| other.name != key.name) {
            table.push(key);
        }
    };
    for constant in flows.iter().flat_map(|flow| flow.parameters()) {
        add(&mut table, Key::of_model(constant));
    }
    table.extend_from_slice(SOLID);
    for constant in ordered(solids.iter().map(|solid| solid.parameters.iter())) {
        add(&mut table, Key::of_model(constant));
    }
    table.extend_from_slice(STATE);
    for constant in ordered(sets.iter().map(|set| set.parameters.iter().map(|own| &own.0))) {
        add(&mut table, Key::of_yield_set(constant));
    }
    table.extend_from_slice(REST);
    let of_models = flows.iter().flat_map(|flow| flow.parameters());
    let of_models: Vec<&Constant> =
        of_models.chain(solids.iter().flat_map(|solid| solid.parameters)).collect();
    let of_sets: Vec<&Constant> =
        sets.iter().flat_map(|set| set.parameters.iter().map(|own| &own.0)).collect();
    for key in &mut table {
        match key.name {
            "model.kind" => key.meaning = kinds_of_model(&flows, &solids).leak(),
            "yield.kind" => key.meaning = kinds_of_set(&sets).leak(),
            _ => {}
        }
        let (all, name) = match key.field {
            Field::Constant(name) => (&of_models, name),
            Field::YieldConstant(name) => (&of_sets, name),
            _ => continue,
        };
        // If registry entries with this constant have different ranges, only the model or yield set checks the range.
        if all.iter().any(|own| own.name == name && own.range != key.range) {
            key.range = Range::Finite;
        }
    }
    // Intentional leak, as for registry entries: keys are returned by static reference.
    let table: &'static [Key] = table.leak();
    *TABLE.write().unwrap_or_else(PoisonError::into_inner) = (entries, table);
    table
}

/// Lists the allowed kinds of model as text.
fn kinds_of_model(flows: &[FlowKind], solids: &[SolidKind]) -> String {
    let flows = alternatives(flows.iter().map(|flow| flow.name()));
    let solids = alternatives(solids.iter().map(|solid| solid.name));
    format!("{flows} for flows; {solids} for solids")
}

/// Lists the allowed yield sets as text.
fn kinds_of_set(sets: &[YieldSetKind]) -> String {
    let sets = alternatives(sets.iter().map(|set| set.name));
    format!("{sets}; without the section [yield] a solid stays elastic")
}

/// Joins alternatives, e.g. `a, b or c`.
fn alternatives<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Merges the constants of several registry entries without repetition, where possible in the order of every entry: a
/// constant is inserted before the first listed constant that follows it in its entry.
fn ordered<I: Iterator<Item = &'static Constant>>(
    entries: impl Iterator<Item = I>,
) -> Vec<&'static Constant> {
    let mut all: Vec<&'static Constant> = Vec::new();
    for entry in entries {
        let mut next = 0;
        let own: Vec<&'static Constant> = entry.collect();
        for (index, constant) in own.iter().enumerate() {
            if let Some(place) = all.iter().position(|other| other.name == constant.name) {
                next = next.max(place + 1);
                continue;
            }
            // First listed constant that follows this one in the entry.
            let follows = |other: &&Constant| own[index..].iter().any(|o| o.name == other.name);
            let place = all.iter().position(follows).unwrap_or(all.len());
            all.insert(place.max(next), constant);
            next = place.max(next) + 1;
        }
    }
    all
}

/// Keys before the constants of flows; the meaning of `model.kind` is filled in from the registry.
static HEAD: &[Key] = keys! {
    "title": "title" [""] "one line that says what the case is";
        ALL, Optional, Text;
    "name": "name" [""] "names the folder of results: at most 255 letters, digits, '-', '_' and '.', not dots alone; absent: the name of the file";
        ALL, Optional, Text;

    "model.kind": "kind of model" [""] "";
        ALL, Required(0.0), Text;
};

/// Keys of solids before their constants.
static SOLID: &[Key] = keys! {
    "model.dimensions": "dimensions" [""] "2 for plane strain, 3 for space";
        PLANE_AND_SPACE, Required(3.0), Whole(|n| &mut n.dimensions);
};

/// Keys between the constants of solids and the constants of yield sets.
static STATE: &[Key] = keys! {
    "background.density": "density ρ" ["kg/m³"] "density ρ; > 0";
        FLOWS, Required(1600.0), in State::DENSITY, Number(|n| &mut n.background.density);
    "background.pressure": "pressure p" ["Pa"] "pressure p, positive in compression; > −c cot φ";
        FLOWS, Required(1000.0), Number(|n| &mut n.background.pressure);
    "background.stress_angle_deg": "stress angle Ψ_Σ" ["deg"] "angle Ψ_Σ of the greater (more tensile) principal stress from x₁, anticlockwise";
        FLOWS, Required(45.0), Number(|n| &mut n.background.stress_angle_deg);
    "background.shear_rate": "shear rate Q_D" ["1/s"] "magnitude Q_D of the deviatoric deformation rate; > 0";
        FLOWS, Required(1.0), in State::SHEAR_RATE, Number(|n| &mut n.background.shear_rate);
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
        FLOWS, Optional, in State::DEVIATORIC_STRESS, OptionalNumber(|n| &mut n.background.deviatoric_stress);
    "background.velocity_gradient": "velocity gradient ∇V" ["1/s"] "velocity gradient, entry [i][j] = ∂ⱼVᵢ; derived, checked where given";
        FLOWS, Optional, OptionalMatrix(|n| &mut n.background.velocity_gradient);
    "background.acceleration": "acceleration DV/Dt − F" ["m/s²"] "material acceleration less body force; derived, checked where given";
        FLOWS, Optional, OptionalPair(|n| &mut n.background.acceleration);
    "background.body_moment": "body moment G" ["m²/s²"] "body moment per unit mass; derived, checked where given";
        WITH_BALANCE_OF_SPIN, Optional, OptionalNumber(|n| &mut n.background.body_moment);
    "background.stress_angle_rate_deg": "stress-angle rate DΨ_Σ/Dt" ["deg/s"] "material rate of the stress angle; derived, checked where given";
        WITH_STRESS_ANGLE_RATE, Optional, OptionalNumber(|n| &mut n.background.stress_angle_rate_deg);

    "yield.kind": "yield set" [""] "";
        SOLIDS, Required(0.0), Text;
    "yield.active": "active conditions" [""] "the conditions that hold with equality, as in [\"+sigma21\", \"-m32\"]; absent: as the stress of [stress] decides";
        SOLIDS that yield by BY_NAMED_CONDITIONS, Optional, Texts;
};

/// Keys after the constants of yield sets.
static REST: &[Key] = keys! {
    "yield.plastic_rate": "plastic rate Λ" ["1/s"] "rate Λ at which the background flows, its stress at rest; ≥ 0; damps waves, changes no speed";
        SOLIDS that yield by CURVED, Or(0.0), in Plastic::RATE, Number(|n| &mut n.plastic_rate);

    "stress.pressure": "pressure p" ["Pa"] "mean pressure in the plane p = −½(σ₁₁ + σ₂₂); the other stresses are scaled until they yield";
        SOLIDS that yield by YIELDING, Or(0.0), Number(|n| &mut n.stress.pressure);
    "stress.deviatoric_stress": "deviatoric stress q" ["Pa"] "deviatoric stress q in the plane, half the difference of the principal stresses, before scaling";
        SOLIDS that yield by YIELDING, Or(1.0), Number(|n| &mut n.stress.deviatoric_stress);
    "stress.stress_angle_deg": "stress angle ψ_σ" ["deg"] "angle of the greater principal stress from x₁, anticlockwise";
        SOLIDS that yield by YIELDING, Or(0.0), Number(|n| &mut n.stress.stress_angle_deg);
    "stress.out_of_plane_stress": "out-of-plane stress σ₃₃ + p" ["Pa"] "stress σ₃₃ across the plane in excess of −p, before scaling";
        PLANE_AND_SPACE that yield by PLANE_AND_SPACE_SETS, Or(0.0), Number(|n| &mut n.stress.out_of_plane_stress);
    "stress.rotational_stress": "rotational stress r" ["Pa"] "r = ½(σ₂₁ − σ₁₂), second index the face normal, before scaling";
        WITH_ROTATION that yield by YIELDING, Or(0.0), Number(|n| &mut n.stress.rotational_stress);
    "stress.couple_stress": "couple stress" ["N/m"] "couple stress [m₃₁, m₃₂], before scaling; m₁₃ and m₂₃ are 0";
        WITH_COUPLES that yield by YIELDING, Or(0.0), Pair(|n| &mut n.stress.couple_stress);

    "wave.number": "wave number k" ["1/m"] "wave number k at which roots are listed; > 0";
        ALL, Or(1000.0), in Range::Positive, Number(|n| &mut n.wave.number);
    "wave.direction_deg": "wave direction ψ_K" ["deg"] "direction ψ_K of the wave vector from x₁, anticlockwise";
        ALL, Or(0.0), Number(|n| &mut n.wave.direction_deg);

    "wave.elevation_deg": "wave elevation" ["deg"] "angle of the wave vector above the plane of x₁ and x₂; 0 in plane strain";
        PLANE_AND_SPACE, Or(0.0), Number(|n| &mut n.wave.elevation_deg);
    "wave.greatest_number": "greatest wave number" ["1/m"] "greatest wave number of dispersion curves; 0: 4 over the solid's own length";
        SOLIDS, Or(0.0), in Range::NotNegative, Number(|n| &mut n.wave.greatest_number);

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
