//! Rows of the key table.

use super::key::{Key, KeyStorage, ModelFilter, Presence, YieldSetFilter};
use crate::schema::AllowedRange;
use models::common::parameter::Parameter;
use models::elastoplastic::PlasticState;
use models::flow::state::MaterialState;
use models::flow::{FlowKind, RotationKind};
use models::registry;
use models::solid::SolidKind;
use models::solid::parameters::Theory;
use models::yield_set::YieldSetKind;
use std::sync::{PoisonError, RwLock};

use KeyStorage::{
    Count, Number, OptionalMatrix, OptionalNumber, OptionalPair, Pair, StoredCount, Text, TextList,
    UnstoredNumber,
};
use Presence::{Default as Or, Optional, Required};

const ALL_MODELS: ModelFilter = ModelFilter::AllModels;
const FLOW_MODELS: ModelFilter = ModelFilter::Flows(|_| true);
const INTRINSIC_SPIN_FLOWS: ModelFilter =
    ModelFilter::Flows(|flow| flow.rotation() == RotationKind::IntrinsicSpin);
const SPIN_FLOWS: ModelFilter = ModelFilter::Flows(|flow| {
    matches!(flow.rotation(), RotationKind::IntrinsicSpin | RotationKind::Free)
});
const STRESS_AXES_FLOWS: ModelFilter =
    ModelFilter::Flows(|flow| flow.rotation() == RotationKind::StressAxes);
const SOLID_MODELS: ModelFilter = ModelFilter::Solids(|_| true);
const SPACE_SOLIDS: ModelFilter = ModelFilter::Solids(|solid| !solid.is_plane);
const MICROROTATION_SOLIDS: ModelFilter =
    ModelFilter::Solids(|solid| solid.theory != Theory::Classical);
const COSSERAT_SOLIDS: ModelFilter = ModelFilter::Solids(|solid| solid.theory == Theory::Cosserat);

const ALL_YIELD_SETS: YieldSetFilter = YieldSetFilter::Predicate(|_| true);
const CURVED_YIELD_SETS: YieldSetFilter = YieldSetFilter::Predicate(|set| set.is_curved);
const YIELD_SETS_WITH_CONDITIONS: YieldSetFilter =
    YieldSetFilter::Predicate(|set| !set.conditions.is_empty());
const SPACE_YIELD_SETS: YieldSetFilter = YieldSetFilter::Predicate(|set| !set.is_plane);

/// Writes one row per key: name; label, unit, meaning; kinds of model and yield sets, presence, range, storage.
macro_rules! keys {
    ($($name:literal: $label:literal [$unit:literal] $meaning:literal;
       $kinds:ident $(that yield by $sets:ident)?, $presence:expr $(, in $range:expr)?, $field:expr;)*) => {
        &[$(Key {
            name: $name,
            label: $label,
            unit: $unit,
            meaning: $meaning,
            model_filter: $kinds,
            yield_set_filter: keys!(@sets $($sets)?),
            presence: $presence,
            range: keys!(@range $($range)?),
            storage: $field,
        }),*]
    };
    (@range) => { AllowedRange::Finite };
    (@range $range:expr) => { $range };
    (@sets) => { None };
    (@sets $sets:ident) => { Some($sets) };
}

/// Returns all scalar keys of a case file, in the order of writing. Required keys of `[yield]`, `[map]` and `[compare]`
/// are required only if their section is present.
pub fn keys() -> &'static [Key] {
    /// Number of registry entries for which the table was built, and the table.
    static KEY_TABLE: RwLock<(usize, &[Key])> = RwLock::new((0, &[]));
    let (flows, solids, sets) = (registry::flows(), registry::solids(), registry::yield_sets());
    let entries = flows.len() + solids.len() + sets.len();
    let (made_for, table) = *KEY_TABLE.read().unwrap_or_else(PoisonError::into_inner);
    if made_for == entries {
        return table;
    }
    let mut table = LEADING_KEYS.to_vec();
    let add = |table: &mut Vec<Key>, key: Key| {
        if table.iter().all(|other| other.name != key.name) {
            table.push(key);
        }
    };
    for constant in flows.iter().flat_map(|flow| flow.parameters()) {
        add(&mut table, Key::from_model_constant(constant));
    }
    table.extend_from_slice(SOLID_KEYS);
    for constant in merge_constants(solids.iter().map(|solid| solid.parameters.iter())) {
        add(&mut table, Key::from_model_constant(constant));
    }
    table.extend_from_slice(STATE_KEYS);
    for constant in merge_constants(sets.iter().map(|set| set.parameters.iter().map(|own| &own.0)))
    {
        add(&mut table, Key::from_yield_constant(constant));
    }
    table.extend_from_slice(TRAILING_KEYS);
    let of_models = flows.iter().flat_map(|flow| flow.parameters());
    let of_models: Vec<&Parameter> =
        of_models.chain(solids.iter().flat_map(|solid| solid.parameters)).collect();
    let of_sets: Vec<&Parameter> =
        sets.iter().flat_map(|set| set.parameters.iter().map(|own| &own.0)).collect();
    for key in &mut table {
        match key.name {
            "model.kind" => key.meaning = format_model_kinds(&flows, &solids).leak(),
            "yield.kind" => key.meaning = format_yield_sets(&sets).leak(),
            _ => {}
        }
        let (all, name) = match key.storage {
            KeyStorage::ModelConstant(name) => (&of_models, name),
            KeyStorage::YieldConstant(name) => (&of_sets, name),
            _ => continue,
        };
        // If registry entries with this constant have different ranges, only the model or yield set checks the range.
        if all.iter().any(|own| own.name == name && own.range != key.range) {
            key.range = AllowedRange::Finite;
        }
    }
    // Intentional leak, as for registry entries: keys are returned by static reference.
    let table: &'static [Key] = table.leak();
    *KEY_TABLE.write().unwrap_or_else(PoisonError::into_inner) = (entries, table);
    table
}

/// Lists the allowed kinds of model as text.
fn format_model_kinds(flows: &[FlowKind], solids: &[SolidKind]) -> String {
    let flows = join_alternatives(flows.iter().map(|flow| flow.name()));
    let solids = join_alternatives(solids.iter().map(|solid| solid.name));
    format!("{flows} for flows; {solids} for solids; equations for a model typed in the case file")
}

/// Lists the allowed yield sets as text.
fn format_yield_sets(sets: &[YieldSetKind]) -> String {
    let sets = join_alternatives(sets.iter().map(|set| set.name));
    format!("{sets}; without the section [yield] the solid is elastic")
}

/// Joins alternatives, e.g. `a, b or c`.
fn join_alternatives<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Merges the constants of several registry entries without repetition, where possible in the order of every entry: a
/// constant is inserted before the first listed constant that follows it in its entry.
fn merge_constants<I: Iterator<Item = &'static Parameter>>(
    entries: impl Iterator<Item = I>,
) -> Vec<&'static Parameter> {
    let mut all: Vec<&'static Parameter> = Vec::new();
    for entry in entries {
        let mut next = 0;
        let own: Vec<&'static Parameter> = entry.collect();
        for (index, constant) in own.iter().enumerate() {
            if let Some(listed) = all.iter().position(|other| other.name == constant.name) {
                next = next.max(listed + 1);
                continue;
            }
            // First listed constant that follows this one in the entry.
            let follows = |other: &&Parameter| own[index..].iter().any(|o| o.name == other.name);
            let successor = all.iter().position(follows).unwrap_or(all.len());
            all.insert(successor.max(next), constant);
            next = successor.max(next) + 1;
        }
    }
    all
}

/// Keys before the constants of flows; the meaning of `model.kind` is filled in from the registry.
static LEADING_KEYS: &[Key] = keys! {
    "title": "title" [""] "title of the case, one line";
        ALL_MODELS, Optional, Text;
    "name": "name" [""] "name of the results folder: at most 255 letters, digits, '-', '_' and '.', not only dots; default: name of the case file";
        ALL_MODELS, Optional, Text;

    "model.kind": "kind of model" [""] "";
        ALL_MODELS, Required(0.0), Text;
};

/// Keys of solids before their constants.
static SOLID_KEYS: &[Key] = keys! {
    "model.dimensions": "dimensions" [""] "number of spatial dimensions: 2 (plane strain) or 3";
        SPACE_SOLIDS, Required(3.0), StoredCount(|n| &mut n.dimensions);
};

/// Keys between the constants of solids and the constants of yield sets.
static STATE_KEYS: &[Key] = keys! {
    "background.density": "density ρ" ["kg/m³"] "density ρ; > 0";
        FLOW_MODELS, Required(1600.0), in MaterialState::DENSITY, Number(|n| &mut n.background.density);
    "background.pressure": "pressure p" ["Pa"] "pressure p, positive in compression; > −c cot φ";
        FLOW_MODELS, Required(1000.0), Number(|n| &mut n.background.pressure);
    "background.stress_angle_deg": "stress angle Ψ_Σ" ["deg"] "angle Ψ_Σ of the major (most tensile) principal stress axis from x₁, anticlockwise";
        FLOW_MODELS, Required(45.0), Number(|n| &mut n.background.stress_angle_deg);
    "background.shear_rate": "shear rate Q_D" ["1/s"] "magnitude Q_D of the deviatoric deformation rate; > 0";
        FLOW_MODELS, Required(1.0), in MaterialState::SHEAR_RATE, Number(|n| &mut n.background.shear_rate);
    "background.velocity": "velocity V" ["m/s"] "velocity V";
        FLOW_MODELS, Or(0.0), Pair(|n| &mut n.background.velocity);
    "background.half_vorticity": "half the vorticity s₂₁" ["1/s"] "half the vorticity s₂₁ = ½(∂₁V₂ − ∂₂V₁), positive anticlockwise";
        FLOW_MODELS, Or(0.0), Number(|n| &mut n.background.half_vorticity);
    "background.noncoaxiality_deg": "non-coaxiality Δ" ["deg"] "non-coaxiality Δ = Ψ_D − Ψ_Σ; default: computed from spin if given, otherwise 0; must be 0 for plastic-potential";
        FLOW_MODELS, Optional, OptionalNumber(|n| &mut n.background.noncoaxiality_deg);
    "background.spin": "spin Ω" ["rad/s"] "intrinsic spin Ω, positive anticlockwise; alternative to noncoaxiality_deg";
        SPIN_FLOWS, Optional, OptionalNumber(|n| &mut n.background.spin);
    "background.pressure_gradient": "pressure gradient ∇p" ["Pa/m"] "gradient of the pressure";
        FLOW_MODELS, Or(0.0), Pair(|n| &mut n.background.pressure_gradient);
    "background.stress_angle_gradient_deg": "stress-angle gradient ∇Ψ_Σ" ["deg/m"] "gradient of the stress angle";
        FLOW_MODELS, Or(0.0), Pair(|n| &mut n.background.stress_angle_gradient_deg);
    "background.density_gradient": "density gradient ∇ρ" ["kg/m⁴"] "gradient of the density; must be 0 if ν = 0";
        FLOW_MODELS, Or(0.0), Pair(|n| &mut n.background.density_gradient);
    "background.spin_gradient": "spin gradient ∇Ω" ["rad/(s·m)"] "gradient of the spin";
        INTRINSIC_SPIN_FLOWS, Or(0.0), Pair(|n| &mut n.background.spin_gradient);
    "background.spin_acceleration": "spin acceleration DΩ/Dt" ["rad/s²"] "material rate DΩ/Dt of the spin";
        INTRINSIC_SPIN_FLOWS, Or(0.0), Number(|n| &mut n.background.spin_acceleration);
    "background.inertia_rate": "rate of inertia DI/Dt" ["m²/s"] "material rate DI/Dt of the moment of inertia";
        INTRINSIC_SPIN_FLOWS, Or(0.0), Number(|n| &mut n.background.inertia_rate);
    "background.inertia_gradient": "inertia gradient ∇I" ["m"] "gradient of the moment of inertia";
        INTRINSIC_SPIN_FLOWS, Or(0.0), Pair(|n| &mut n.background.inertia_gradient);
    "background.rotational_stress": "rotational stress r" ["Pa"] "rotational stress r = ½(σ₂₁ − σ₁₂), second index is the face normal; default: −m sign(Ω − s₂₁)";
        INTRINSIC_SPIN_FLOWS, Optional, OptionalNumber(|n| &mut n.background.rotational_stress);
    "background.deviatoric_stress": "deviatoric stress q" ["Pa"] "deviatoric stress q; default: value at yield";
        FLOW_MODELS, Optional, in MaterialState::DEVIATORIC_STRESS, OptionalNumber(|n| &mut n.background.deviatoric_stress);
    "background.velocity_gradient": "velocity gradient ∇V" ["1/s"] "velocity gradient, entry [i][j] = ∂ⱼVᵢ; derived, checked if given";
        FLOW_MODELS, Optional, OptionalMatrix(|n| &mut n.background.velocity_gradient);
    "background.acceleration": "acceleration DV/Dt − F" ["m/s²"] "material acceleration minus body force per unit mass; derived, checked if given";
        FLOW_MODELS, Optional, OptionalPair(|n| &mut n.background.acceleration);
    "background.body_moment": "body moment G" ["m²/s²"] "body moment per unit mass; derived, checked if given";
        INTRINSIC_SPIN_FLOWS, Optional, OptionalNumber(|n| &mut n.background.body_moment);
    "background.stress_angle_rate_deg": "stress-angle rate DΨ_Σ/Dt" ["deg/s"] "material rate of the stress angle; derived, checked if given";
        STRESS_AXES_FLOWS, Optional, OptionalNumber(|n| &mut n.background.stress_angle_rate_deg);

    "yield.kind": "yield set" [""] "";
        SOLID_MODELS, Required(0.0), Text;
    "yield.active": "active conditions" [""] "active yield conditions (satisfied with equality), e.g. [\"+sigma21\", \"-m32\"]; default: determined by [stress]";
        SOLID_MODELS that yield by YIELD_SETS_WITH_CONDITIONS, Optional, TextList;
};

/// Keys after the constants of yield sets.
static TRAILING_KEYS: &[Key] = keys! {
    "yield.plastic_rate": "plastic rate Λ" ["1/s"] "plastic multiplier rate Λ of the background state at constant stress; ≥ 0; damps waves without changing their speeds";
        SOLID_MODELS that yield by CURVED_YIELD_SETS, Or(0.0), in PlasticState::RATE_RANGE, Number(|n| &mut n.plastic_rate);

    "stress.pressure": "pressure p" ["Pa"] "mean in-plane pressure p = −½(σ₁₁ + σ₂₂); the other stresses are scaled to the yield surface";
        SOLID_MODELS that yield by ALL_YIELD_SETS, Or(0.0), Number(|n| &mut n.stress.pressure);
    "stress.deviatoric_stress": "deviatoric stress q" ["Pa"] "in-plane deviatoric stress q, half the difference of the principal stresses, before scaling";
        SOLID_MODELS that yield by ALL_YIELD_SETS, Or(1.0), Number(|n| &mut n.stress.deviatoric_stress);
    "stress.stress_angle_deg": "stress angle ψ_σ" ["deg"] "angle of the major principal stress axis from x₁, anticlockwise";
        SOLID_MODELS that yield by ALL_YIELD_SETS, Or(0.0), Number(|n| &mut n.stress.stress_angle_deg);
    "stress.out_of_plane_stress": "out-of-plane stress σ₃₃ + p" ["Pa"] "out-of-plane stress relative to −p, σ₃₃ + p, before scaling";
        SPACE_SOLIDS that yield by SPACE_YIELD_SETS, Or(0.0), Number(|n| &mut n.stress.out_of_plane_stress);
    "stress.rotational_stress": "rotational stress r" ["Pa"] "rotational stress r = ½(σ₂₁ − σ₁₂), second index is the face normal, before scaling";
        MICROROTATION_SOLIDS that yield by ALL_YIELD_SETS, Or(0.0), Number(|n| &mut n.stress.rotational_stress);
    "stress.couple_stress": "couple stress" ["N/m"] "couple stress [m₃₁, m₃₂], before scaling; m₁₃ and m₂₃ are 0";
        COSSERAT_SOLIDS that yield by ALL_YIELD_SETS, Or(0.0), Pair(|n| &mut n.stress.couple_stress);

    "wave.number": "wave number k" ["1/m"] "wave number k at which dispersion roots are listed; > 0";
        ALL_MODELS, Or(1000.0), in AllowedRange::Positive, Number(|n| &mut n.wave.wave_number);
    "wave.direction_deg": "wave direction ψ_K" ["deg"] "direction ψ_K of the wave vector from x₁, anticlockwise";
        ALL_MODELS, Or(0.0), Number(|n| &mut n.wave.direction_deg);

    "wave.elevation_deg": "wave elevation" ["deg"] "elevation of the wave vector above the x₁x₂ plane; 0 in plane strain";
        SPACE_SOLIDS, Or(0.0), Number(|n| &mut n.wave.elevation_deg);
    "wave.greatest_number": "largest wave number" ["1/m"] "largest wave number of dispersion curves; 0: 4 times the characteristic wave number of the solid, for classical solids wave.number";
        SOLID_MODELS, Or(0.0), in AllowedRange::NotNegative, Number(|n| &mut n.wave.max_wave_number);

    "map.x.parameter": "parameter" [""] "name of the parameter swept along the x axis";
        ALL_MODELS, Required(0.0), Text;
    "map.x.from": "first value" [""] "first value along the x axis";
        ALL_MODELS, Required(0.0), UnstoredNumber;
    "map.x.to": "last value" [""] "last value along the x axis";
        ALL_MODELS, Required(0.0), UnstoredNumber;
    "map.x.points": "points" [""] "number of points along the x axis";
        ALL_MODELS, Required(0.0), Count;
    "map.x.spacing": "spacing" [""] "spacing of the points along the x axis: linear, or log with equal ratios between positive ends; default: linear";
        ALL_MODELS, Optional, Text;
    "map.y.parameter": "parameter" [""] "name of the parameter swept along the y axis";
        ALL_MODELS, Required(0.0), Text;
    "map.y.from": "first value" [""] "first value along the y axis";
        ALL_MODELS, Required(0.0), UnstoredNumber;
    "map.y.to": "last value" [""] "last value along the y axis";
        ALL_MODELS, Required(0.0), UnstoredNumber;
    "map.y.points": "points" [""] "number of points along the y axis";
        ALL_MODELS, Required(0.0), Count;
    "map.y.spacing": "spacing" [""] "spacing of the points along the y axis: linear, or log with equal ratios between positive ends; default: linear";
        ALL_MODELS, Optional, Text;

    "compare.kinds": "kinds of model" [""] "kinds of model compared at this state";
        FLOW_MODELS, Required(0.0), TextList;
};
