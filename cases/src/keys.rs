//! The one table of keys that a case file may hold.
//!
//! Parsing, refusal of unknown and unused keys, `--set`, the commented files of `wellposed new`
//! and the parameters that a map can sweep all read this table. Constants of flow models come from the
//! [registry](models::registry). To add another key: add a field to [`Numbers`] and a row here.

use super::kind::{Kind, Medium, Solid, Yield};
use models::cosserat::parameters::Theory;
use models::granular_flow::{Kind as Flow, RotationKind};
pub use models::parameter::Presence;
use models::parameter::{ANGLE, Parameter as Constant};
use models::registry;
use std::sync::{PoisonError, RwLock};

/// The numbers of a case exactly as its file states them: SI units, angles in degrees, `None`
/// where a key without default is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Constants of the model.
    pub model: Constants,
    /// Dimensions of a solid; 0 where its kind leaves no choice.
    pub dimensions: usize,
    /// Constants of its yield set.
    pub yields: Constants,
    /// Rate Λ at which the background of a yielding solid flows, 1/s.
    pub plastic_rate: f64,
    /// Stress of a yielding solid.
    pub stress: StressNumbers,
    /// State of the flow at the point.
    pub background: BackgroundNumbers,
    /// Wave at which roots are listed.
    pub wave: Wave,
}

/// Values of constants by name, in the units of a case file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constants(Vec<(&'static str, f64)>);

impl Constants {
    /// The value of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.place(name).ok().map(|place| self.0[place].1)
    }

    /// Sets a value.
    pub fn set(&mut self, name: &'static str, value: f64) {
        match self.place(name) {
            Ok(place) => self.0[place].1 = value,
            Err(place) => self.0.insert(place, (name, value)),
        }
    }

    /// Where a name is among all in order, or where it would be.
    fn place(&self, name: &str) -> Result<usize, usize> {
        self.0.binary_search_by(|(own, _)| (*own).cmp(name))
    }

    /// Takes a value back to what holds where none is given.
    fn reset(&mut self, name: &'static str, presence: Presence) {
        match presence {
            Presence::Default(value) => self.set(name, value),
            _ => self.0.retain(|(own, _)| *own != name),
        }
    }

    /// The values of a model's constants, in the order in which it lists them, in SI units and rad; NaN for those
    /// that are absent.
    pub fn in_order<'a>(
        &self,
        parameters: impl IntoIterator<Item = &'a Constant>,
        values: &mut Vec<f64>,
    ) {
        values.clear();
        let value = |own: &Constant| own.to_si(self.get(own.name).unwrap_or(f64::NAN));
        values.extend(parameters.into_iter().map(value));
    }
}

/// Section `[stress]`; units and meanings in [`keys`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // one row of `keys` per field says it once
pub struct StressNumbers {
    pub pressure: f64,
    pub deviatoric_stress: f64,
    pub stress_angle_deg: f64,
    pub out_of_plane_stress: f64,
    pub rotational_stress: f64,
    pub couple_stress: [f64; 2],
}

/// Section `[background]`; units and meanings in [`keys`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // one row of `keys` per field says it once
pub struct BackgroundNumbers {
    pub density: f64,
    pub pressure: f64,
    pub stress_angle_deg: f64,
    pub shear_rate: f64,
    pub velocity: [f64; 2],
    pub half_vorticity: f64,
    pub noncoaxiality_deg: Option<f64>,
    pub spin: Option<f64>,
    pub pressure_gradient: [f64; 2],
    pub stress_angle_gradient_deg: [f64; 2],
    pub density_gradient: [f64; 2],
    pub spin_gradient: [f64; 2],
    pub spin_acceleration: f64,
    pub inertia_rate: f64,
    pub inertia_gradient: [f64; 2],
    pub rotational_stress: Option<f64>,
    pub deviatoric_stress: Option<f64>,
    pub velocity_gradient: Option<[[f64; 2]; 2]>,
    pub acceleration: Option<[f64; 2]>,
    pub body_moment: Option<f64>,
    pub stress_angle_rate_deg: Option<f64>,
}

/// Section `[wave]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Wave number k, 1/m; positive.
    pub number: f64,
    /// Direction ψ_K of the wave vector, degrees anticlockwise from x₁.
    pub direction_deg: f64,
    /// Its angle above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
    /// Greatest wave number of dispersion curves, 1/m; 0 for what suits the solid.
    pub greatest_number: f64,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Section and name, as in `--set`.
    pub name: &'static str,
    /// Quantity and symbol, for axes and legends.
    pub label: &'static str,
    /// Unit; empty for text and pure numbers.
    pub unit: &'static str,
    /// What the quantity is and what is allowed, in one line.
    pub meaning: &'static str,
    users: Users,
    /// The yield sets that use it; `None` if it is no matter whether and how a solid yields.
    sets: Option<Sets>,
    /// What holds where the key is absent.
    pub presence: Presence,
    pub(super) field: Field,
}

/// The kinds of model that use a key.
#[derive(Clone, Copy, Debug)]
enum Users {
    All,
    Flows(fn(Flow) -> bool),
    Solids(fn(Solid) -> bool),
    /// Those that have a constant of that name: of flows and solids where both are of one unit.
    With(&'static str),
}

/// The yield sets that use a key, of solids of some theory.
#[derive(Clone, Copy, Debug)]
enum Sets {
    Any(fn(Yield) -> bool),
    /// Those that have a constant of that name.
    With(&'static str),
}

impl Sets {
    fn contain(self, set: Yield, theory: Theory) -> bool {
        match self {
            Self::Any(uses) => uses(set),
            Self::With(name) => set.parameters_for(theory).any(|own| own.name == name),
        }
    }
}

/// Type of a value and, for the numbers of a case, where it is kept.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    Text,
    Texts,
    Count,
    Plain,
    Whole(fn(&mut Numbers) -> &mut usize),
    /// A constant of the model, by its name.
    Constant(&'static str),
    /// A constant of the yield set, by its name.
    YieldConstant(&'static str),
    Number(fn(&mut Numbers) -> &mut f64),
    OptionalNumber(fn(&mut Numbers) -> &mut Option<f64>),
    Pair(fn(&mut Numbers) -> &mut [f64; 2]),
    OptionalPair(fn(&mut Numbers) -> &mut Option<[f64; 2]>),
    OptionalMatrix(fn(&mut Numbers) -> &mut Option<[[f64; 2]; 2]>),
}

/// A value of one of the types in the table.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Text(String),
    Texts(Vec<String>),
    Count(usize),
    Number(f64),
    Pair([f64; 2]),
    Matrix([[f64; 2]; 2]),
}

impl Value {
    /// A text.
    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl Field {
    /// The type in words.
    pub(super) fn expected(self) -> &'static str {
        match self {
            Self::Text => "text in quotes",
            Self::Texts => "a list of texts in brackets",
            Self::Count | Self::Whole(_) => "a whole number of at least 1",
            Self::Plain
            | Self::Constant(_)
            | Self::YieldConstant(_)
            | Self::Number(_)
            | Self::OptionalNumber(_) => "a finite number",
            Self::Pair(_) | Self::OptionalPair(_) => "a pair of finite numbers [x1, x2]",
            Self::OptionalMatrix(_) => "a matrix of finite numbers [[a11, a12], [a21, a22]]",
        }
    }

    /// Whether the value is kept in [`Numbers`].
    pub(super) fn is_kept(self) -> bool {
        !matches!(self, Self::Text | Self::Texts | Self::Count | Self::Plain)
    }

    /// Number of components that a map can sweep: 0 for what is no scalar or pair.
    fn components(self) -> usize {
        match self {
            Self::Constant(_)
            | Self::YieldConstant(_)
            | Self::Number(_)
            | Self::OptionalNumber(_) => 1,
            Self::Pair(_) | Self::OptionalPair(_) => 2,
            _ => 0,
        }
    }

    /// The value kept, if there is one.
    pub(super) fn load(self, numbers: &Numbers) -> Option<Value> {
        let numbers = &mut numbers.clone();
        match self {
            Self::Whole(f) => Some(Value::Count(*f(numbers))),
            Self::Constant(name) => numbers.model.get(name).map(Value::Number),
            Self::YieldConstant(name) => numbers.yields.get(name).map(Value::Number),
            Self::Number(f) => Some(Value::Number(*f(numbers))),
            Self::OptionalNumber(f) => f(numbers).map(Value::Number),
            Self::Pair(f) => Some(Value::Pair(*f(numbers))),
            Self::OptionalPair(f) => f(numbers).map(Value::Pair),
            Self::OptionalMatrix(f) => f(numbers).map(Value::Matrix),
            _ => None,
        }
    }

    /// Keeps a value of this type.
    pub(super) fn store(self, numbers: &mut Numbers, value: &Value) {
        match (self, value) {
            (Self::Whole(f), Value::Count(n)) => *f(numbers) = *n,
            (Self::Constant(name), Value::Number(x)) => numbers.model.set(name, *x),
            (Self::YieldConstant(name), Value::Number(x)) => numbers.yields.set(name, *x),
            (Self::Number(f), Value::Number(x)) => *f(numbers) = *x,
            (Self::OptionalNumber(f), Value::Number(x)) => *f(numbers) = Some(*x),
            (Self::Pair(f), Value::Pair(x)) => *f(numbers) = *x,
            (Self::OptionalPair(f), Value::Pair(x)) => *f(numbers) = Some(*x),
            (Self::OptionalMatrix(f), Value::Matrix(x)) => *f(numbers) = Some(*x),
            _ => debug_assert!(!self.is_kept(), "a value of another type than its key's"),
        }
    }
}

impl Key {
    /// The row of a constant of a model.
    fn of_model(constant: &'static Constant) -> Self {
        let name = constant.name;
        Self::of_constant("model", constant, Users::With(name), None, Field::Constant(name))
    }

    /// The row of a constant of a yield set.
    fn of_yield_set(constant: &'static Constant) -> Self {
        let name = constant.name;
        let sets = Some(Sets::With(name));
        Self::of_constant("yield", constant, SOLIDS, sets, Field::YieldConstant(name))
    }

    fn of_constant(
        section: &str,
        constant: &'static Constant,
        users: Users,
        sets: Option<Sets>,
        field: Field,
    ) -> Self {
        let Constant { name, label, unit, meaning, presence } = *constant;
        let suffix = if unit == ANGLE { "_deg" } else { "" };
        let name = format!("{section}.{name}{suffix}").leak();
        Self { name, label, unit, meaning, users, sets, presence, field }
    }

    /// The row of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        keys().iter().find(|key| key.name == name)
    }

    /// Section, and name inside it.
    pub fn split(&self) -> (&'static str, &'static str) {
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }

    /// Whether such media use the key.
    pub fn is_used_by(&self, medium: impl Into<Medium>) -> bool {
        let Medium { kind, yields } = medium.into();
        let Some(sets) = self.sets else { return self.is_for(kind) };
        match (kind, yields) {
            (Kind::Solid(solid), Some(set)) => self.is_for(kind) && sets.contain(set, solid.theory),
            _ => false,
        }
    }

    /// Whether such a model uses the key, if it yields as it must for that.
    pub(super) fn is_for(&self, kind: Kind) -> bool {
        if let (Some(sets), Kind::Solid(solid)) = (self.sets, kind)
            && !registry::yield_sets().iter().any(|set| sets.contain(*set, solid.theory))
        {
            return false;
        }
        match (self.users, kind) {
            (Users::All, _) => true,
            (Users::Flows(uses), Kind::Flow(flow)) => uses(flow),
            (Users::Solids(uses), Kind::Solid(solid)) => uses(solid),
            (Users::With(name), Kind::Flow(flow)) => {
                flow.parameters().iter().any(|own| own.name == name)
            }
            (Users::With(name), Kind::Solid(solid)) => {
                solid.parameters.iter().any(|own| own.name == name)
            }
            _ => false,
        }
    }

    /// The names of the models that use the key.
    pub(super) fn owners(&self) -> Vec<&'static str> {
        Kind::all().into_iter().filter(|kind| self.is_for(*kind)).map(Kind::name).collect()
    }

    /// The names of the yield sets that use it, in solids of some theory; empty if it is no matter whether and how a
    /// solid yields.
    pub(super) fn set_names(&self) -> Vec<&'static str> {
        let Some(sets) = self.sets else { return Vec::new() };
        let uses = |set: &Yield| THEORIES.into_iter().any(|theory| sets.contain(*set, theory));
        registry::yield_sets().into_iter().filter(uses).map(|set| set.name).collect()
    }

    /// Takes the key back to what holds where it is absent.
    pub(super) fn clear(&self, numbers: &mut Numbers) {
        let absent = match self.presence {
            Presence::Default(value) => value,
            _ => 0.0,
        };
        match self.field {
            Field::Whole(f) => *f(numbers) = absent as usize,
            Field::Constant(name) => numbers.model.reset(name, self.presence),
            Field::YieldConstant(name) => numbers.yields.reset(name, self.presence),
            Field::Number(f) => *f(numbers) = absent,
            Field::OptionalNumber(f) => *f(numbers) = None,
            Field::Pair(f) => *f(numbers) = [absent; 2],
            Field::OptionalPair(f) => *f(numbers) = None,
            Field::OptionalMatrix(f) => *f(numbers) = None,
            _ => {}
        }
    }

    /// The value that `wellposed new` shows: default or example, as TOML; `None` for what is no
    /// number of the case.
    pub fn example(&self) -> Option<String> {
        let number = match self.presence {
            Presence::Required(value) | Presence::Default(value) => value,
            Presence::Optional => 0.0,
        };
        let value = match self.field {
            Field::Whole(_) => Value::Count(number as usize),
            Field::Constant(_)
            | Field::YieldConstant(_)
            | Field::Number(_)
            | Field::OptionalNumber(_) => Value::Number(number),
            Field::Pair(_) | Field::OptionalPair(_) => Value::Pair([number; 2]),
            Field::OptionalMatrix(_) => Value::Matrix([[number; 2]; 2]),
            _ => return None,
        };
        Some(value.to_string())
    }
}

/// A scalar that a map can sweep: a number of `[model]`, `[background]`, `[yield]`, `[stress]` or
/// `[wave]`, or a component of a pair. Cheap to copy and to set.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    key: &'static Key,
    component: usize,
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Self) -> bool {
        (self.key.name, self.component) == (other.key.name, other.component)
    }
}

impl Parameter {
    /// The parameter of that name: `background.pressure`, `background.velocity[0]`.
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.name() == name)
    }

    /// All parameters, in the order of the table.
    pub fn all() -> impl Iterator<Item = Self> {
        keys().iter().flat_map(|key| {
            (0..key.field.components()).map(move |component| Self { key, component })
        })
    }

    /// Name as in `[map]`.
    pub fn name(self) -> String {
        self.numbered(self.key.name)
    }

    /// Quantity and symbol, for axes.
    pub fn label(self) -> String {
        self.numbered(self.key.label)
    }

    /// Unit, as written on an axis.
    pub fn unit(self) -> &'static str {
        self.key.unit
    }

    /// The row of the table.
    pub fn key(self) -> &'static Key {
        self.key
    }

    /// The number, if the case has one.
    pub fn get(self, numbers: &Numbers) -> Option<f64> {
        match self.key.field.load(numbers)? {
            Value::Number(x) => Some(x),
            Value::Pair(pair) => Some(pair[self.component]),
            _ => None,
        }
    }

    /// Sets the number; the other component of an absent pair becomes 0.
    pub fn set(self, numbers: &mut Numbers, value: f64) {
        match self.key.field {
            Field::Constant(name) => numbers.model.set(name, value),
            Field::YieldConstant(name) => numbers.yields.set(name, value),
            Field::Number(f) => *f(numbers) = value,
            Field::OptionalNumber(f) => *f(numbers) = Some(value),
            Field::Pair(f) => f(numbers)[self.component] = value,
            Field::OptionalPair(f) => {
                f(numbers).get_or_insert_default()[self.component] = value;
            }
            // `all` makes no parameters of other types.
            _ => {}
        }
    }

    fn numbered(self, name: &str) -> String {
        match self.key.field.components() {
            1 => name.to_owned(),
            _ => format!("{name}[{}]", self.component),
        }
    }
}

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

const THEORIES: [Theory; 3] = [Theory::Classical, Theory::Reduced, Theory::Cosserat];

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
    (@sets) => { None };
    (@sets $sets:ident) => { Some($sets) };
}

/// Every key of a case file, in the order in which files are written. Those of `[map]` and
/// `[compare]` are required where their section stands.
pub fn keys() -> &'static [Key] {
    /// The number of registered entries that the table was made for, and the table.
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
    // Never freed, as entries of the registry are not: keys are handed out by reference.
    let table: &'static [Key] = table.leak();
    *TABLE.write().unwrap_or_else(PoisonError::into_inner) = (entries, table);
    table
}

/// The constants of several entries, each once, in an order that keeps the order of every entry where they agree on one:
/// what an entry has before a constant that is listed already is put before it.
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
            // Before the first constant listed that follows in this entry.
            let follows = |other: &&Constant| own[index..].iter().any(|o| o.name == other.name);
            let place = all.iter().position(follows).unwrap_or(all.len());
            all.insert(place.max(next), constant);
            next = place.max(next) + 1;
        }
    }
    all
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

/// The keys of solids before their constants.
static SOLID: &[Key] = keys! {
    "model.dimensions": "dimensions" [""] "2 for plane strain, 3 for space";
        PLANE_AND_SPACE, Required(3.0), Whole(|n| &mut n.dimensions);
};

/// The keys between the constants of solids and those of yield sets.
static STATE: &[Key] = keys! {
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
        SOLIDS that yield by BY_NAMED_CONDITIONS, Optional, Texts;
};

/// The keys after the constants of yield sets.
static REST: &[Key] = keys! {
    "yield.plastic_rate": "plastic rate Λ" ["1/s"] "rate Λ at which the background flows, its stress at rest; ≥ 0; damps waves, changes no speed";
        SOLIDS that yield by CURVED, Or(0.0), Number(|n| &mut n.plastic_rate);

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
        ALL, Or(1000.0), Number(|n| &mut n.wave.number);
    "wave.direction_deg": "wave direction ψ_K" ["deg"] "direction ψ_K of the wave vector from x₁, anticlockwise";
        ALL, Or(0.0), Number(|n| &mut n.wave.direction_deg);

    "wave.elevation_deg": "wave elevation" ["deg"] "angle of the wave vector above the plane of x₁ and x₂; 0 in plane strain";
        PLANE_AND_SPACE, Or(0.0), Number(|n| &mut n.wave.elevation_deg);
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

/// As TOML; numbers in their shortest form that reads back to the same double.
impl std::fmt::Display for Value {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text(text) => write!(formatter, "{}", toml::Value::from(text.as_str())),
            Self::Texts(texts) => write!(formatter, "{}", toml::Value::from(texts.clone())),
            Self::Count(count) => write!(formatter, "{count}"),
            Self::Number(number) => write!(formatter, "{number:?}"),
            Self::Pair(pair) => write!(formatter, "{pair:?}"),
            Self::Matrix(matrix) => write!(formatter, "{matrix:?}"),
        }
    }
}
