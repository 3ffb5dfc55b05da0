//! Conversion of a case of a blocky medium to a case of the equivalent Cosserat continuum.

use super::case::Case;
use super::dynamics::{
    CourantWaves, FaceLoad, InitialStateTerm, ReconstructionScheme, RecordedQuantity, SolidRun,
    StateComponent,
};
use super::error::CaseError;
use super::kind::ModelKind;
use super::numbers::ConstantValues;
use super::periodic_blocks::SquareBlocks;
use models::common::decimal::format_exact;
use models::interface::continuum::OpeningLimit;
use models::interface::homogenised::HomogenisedConstants;
use models::interface::parameters::LayerMaterial;
use models::registry;
use models::solid::waves::SolidField;
use models::yield_set::parameters::InterlayerYieldSet;
use std::fmt::Write as _;

/// Options of the conversion of a blocky medium to a continuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContinuumOptions {
    /// Number of cells of the grid per block along each axis; at least 1.
    pub cells_per_block: usize,
    /// Limit of the couple stress of joints that slip.
    pub opening_limit: OpeningLimit,
}

impl Default for ContinuumOptions {
    fn default() -> Self {
        Self { cells_per_block: 1, opening_limit: OpeningLimit::default() }
    }
}

/// Equivalent continuum of a blocky medium.
#[derive(Clone, Debug)]
pub struct EquivalentContinuum {
    /// Blocks and joints of the blocky medium.
    pub blocks: SquareBlocks,
    /// Constants of the equivalent continuum.
    pub constants: HomogenisedConstants,
    /// Yield set that represents the slip of joints; `None` for elastic joints.
    pub yield_set: Option<InterlayerYieldSet>,
    /// The case of the continuum, parsed from `toml`.
    pub case: Case,
    /// Text of the case file of the continuum.
    pub toml: String,
    /// Notes on properties of the blocky medium that the continuum does not represent or represents differently.
    pub notes: Vec<String>,
}

impl Case {
    /// Converts a case of a blocky medium to the case of its equivalent Cosserat continuum, on a grid of the same
    /// extent with the same boundary conditions, loads, sources, initial state, time and output.
    ///
    /// # Errors
    /// The blocks are not square or differ, the joints differ or have no equivalent, or an initial state is an
    /// eigenmode of the material of the blocks.
    pub fn to_equivalent_continuum(
        &self,
        options: &ContinuumOptions,
    ) -> Result<EquivalentContinuum, CaseError> {
        let blocks = self.to_square_blocks()?;
        let Some(run) = &self.solid_run else {
            return Err(self.material.positions.key_error(
                "block",
                "missing",
                "expected a blocky medium",
            ));
        };
        let yield_set = self.convert_joint(&blocks, run, options)?;
        let constants = blocks.medium.homogenise().map_err(|error| self.locate_error(error))?;
        let mut notes = Vec::new();
        if let LayerMaterial::Breaking(..) = blocks.joint.material {
            notes.push(
                "broken joints lose their strength; the continuum keeps τ₀, κ_τ, μ₀ and κ_μ"
                    .to_owned(),
            );
        }
        let mut case = self.clone();
        case.name = format!("{}-continuum", self.name);
        if !case.title.is_empty() {
            case.title += ", equivalent continuum";
        }
        (case.map, case.compared_kinds, case.check_options) = (None, None, None);
        let material = &mut case.material;
        material.kind = ModelKind::Solid(registry::COSSERAT_COMPLIANCES);
        material.active_conditions = None;
        let solid = &constants.solid;
        material.numbers.model_constants = to_constants(&[
            ("a1", solid.a1),
            ("b1", solid.b1),
            ("a2", solid.a2),
            ("b2", solid.b2),
            ("alpha2", solid.alpha2),
            ("density", solid.density),
            ("inertia", solid.inertia),
        ]);
        material.numbers.dimensions = 0;
        material.yield_set = yield_set.map(|_| registry::INTERLAYER);
        material.numbers.yield_constants = ConstantValues::default();
        if let Some(set) = &yield_set {
            let couple =
                set.couple.map_or([0.0; 3], |own| [own.strength, own.friction, own.dilatancy]);
            material.numbers.yield_constants = to_constants(&[
                ("shear_strength", set.shear_strength),
                ("shear_friction", set.shear_friction),
                ("shear_dilatancy", set.shear_dilatancy),
                ("couple_strength", couple[0]),
                ("couple_friction", couple[1]),
                ("couple_dilatancy", couple[2]),
            ]);
            // State analysed by `wellposed point`: pure shear along the joints.
            material.numbers.stress = Default::default();
            (material.numbers.stress.deviatoric_stress, material.numbers.stress.stress_angle_deg) =
                (1.0, 45.0);
        }
        case.solid_run = Some(convert_run(run, &blocks, options, yield_set.is_some(), &mut notes)?);
        let toml = header(self, &blocks, &constants, options, &notes) + &case.to_toml();
        let parsed = Self::parse(&toml, &format!("{}.toml", case.name), &[])?;
        Ok(EquivalentContinuum { blocks, constants, yield_set, case: parsed, toml, notes })
    }

    /// Converts the strength of the joints to a yield set; `None` for elastic joints.
    fn convert_joint(
        &self,
        blocks: &SquareBlocks,
        run: &SolidRun,
        options: &ContinuumOptions,
    ) -> Result<Option<InterlayerYieldSet>, CaseError> {
        let own = run.blocks.iter().flat_map(|own| &own.joints);
        let index = own.clone().position(|joint| joint.law == blocks.joint).unwrap_or(0);
        let key = |name: &str| format!("joint[{index}].{name}");
        if options.cells_per_block == 0 {
            let allowed = "expected at least one cell per block";
            return Err(run.key_error("block[0].cells", "found 0 cells per block", allowed));
        }
        if matches!(blocks.joint.material, LayerMaterial::Elastic(_)) {
            return Ok(None);
        }
        let Some(strength) = blocks.joint.material.strength() else {
            let name = blocks.joint.kind.name;
            let path = match blocks.joint.kind.components {
                Some(_) => format!("joint[{index}]"),
                None => key("kind"),
            };
            let allowed = "expected elastic, elastic-plastic or breaking: the continuum has no viscosity, \
                           pores or cracks; wellposed dispersion computes the waves in media with such joints";
            return Err(run.key_error(&path, format!("found {name}"), allowed));
        };
        if strength.slip.hardening > 0.0 {
            let found = format!("found {}", format_exact(strength.slip.hardening));
            let allowed = "expected 0: the interlayer yield set does not harden";
            return Err(run.key_error(&key("slip_hardening"), found, allowed));
        }
        let set = strength.to_yield_set(blocks.medium.period, options.opening_limit);
        set.map(Some).ok_or_else(|| {
            let allowed = "expected a friction above 0, or kind = \"breaking\" with a tensile_strength: \
                           without both the joints carry any couple, the yield set does not";
            run.key_error(&key("shear_friction"), "found 0", allowed)
        })
    }
}

fn to_constants(values: &[(&'static str, f64)]) -> ConstantValues {
    let mut constants = ConstantValues::default();
    for &(name, value) in values {
        constants.set_value(name, value);
    }
    constants
}

/// Returns the shear stress σ₁₂ or σ₂₁ with exchanged indices; `None` for other components.
fn transpose(component: StateComponent) -> Option<StateComponent> {
    match component.0 {
        SolidField::Stress(i, j) if i != j => Some(StateComponent(SolidField::Stress(j, i))),
        _ => None,
    }
}

/// Converts the sections of the simulation from a classical to a Cosserat solid. In classical solids σ₂₁ = σ₁₂: a load
/// is one on the component that acts on the face, an initial state one of both.
fn convert_run(
    run: &SolidRun,
    blocks: &SquareBlocks,
    options: &ContinuumOptions,
    yields: bool,
    notes: &mut Vec<String>,
) -> Result<SolidRun, CaseError> {
    let mut own = run.clone();
    own.blocks = None;
    for axis in 0..2 {
        own.grid.cells[axis] = blocks.count[axis] * options.cells_per_block;
        own.grid.spacing[axis] = blocks.medium.period / options.cells_per_block as f64;
    }
    if own.time.courant_waves == CourantWaves::Shear {
        own.time.courant_waves = CourantWaves::Fastest;
        notes
            .push("courant_of = \"fastest\" in place of \"s\": the continuum has spins".to_owned());
    }
    if yields && own.scheme.reconstruction == ReconstructionScheme::FourthOrder {
        own.scheme.reconstruction = ReconstructionScheme::Eno2;
        notes.push("order = \"eno2\" in place of \"fourth-order\": plastic fronts".to_owned());
    }
    for load in &mut own.loads {
        convert_load(load);
    }
    own.initial_terms.clear();
    for (index, term) in run.initial_terms.iter().enumerate() {
        own.initial_terms.push(term.clone());
        match term {
            InitialStateTerm::PlaneWave { .. } | InitialStateTerm::PlanePulse(_) => {
                let found = format!("found {}", term.name());
                let allowed = "an initial state other than plane waves: these are waves of the \
                               material of the blocks, not of the medium; use a load or a pulse";
                return Err(run.key_error(&format!("initial[{index}].kind"), found, allowed));
            }
            InitialStateTerm::Pulse { component, .. }
            | InitialStateTerm::Uniform { component, .. } => {
                let Some(other) = transpose(*component) else { continue };
                let mut copy = term.clone();
                match &mut copy {
                    InitialStateTerm::Pulse { component, .. }
                    | InitialStateTerm::Uniform { component, .. } => *component = other,
                    _ => {}
                }
                own.initial_terms.push(copy);
            }
            InitialStateTerm::Rotation { .. }
            | InitialStateTerm::RigidRotation { .. }
            | InitialStateTerm::Loosening { .. } => {}
        }
    }
    for (component, value) in &run.initial_stress {
        if let Some(other) = transpose(*component) {
            own.initial_stress.push((other, *value));
        }
    }
    for receiver in &mut own.receivers {
        let spin = RecordedQuantity::Component(StateComponent(SolidField::Spin(2)));
        let others: Vec<RecordedQuantity> = receiver
            .fields
            .iter()
            .filter_map(|field| match field {
                RecordedQuantity::Component(component) => transpose(*component),
                RecordedQuantity::TimeIntegral(_) => None,
            })
            .map(RecordedQuantity::Component)
            .chain([spin])
            .collect();
        receiver.fields.extend(others);
    }
    Ok(own)
}

/// Converts a load on a shear stress of a classical solid: the second index becomes the normal of the loaded face.
fn convert_load(load: &mut FaceLoad) {
    if let SolidField::Stress(_, normal) = load.component.0
        && normal != load.face.axis
        && let Some(other) = transpose(load.component)
    {
        load.component = other;
    }
}

/// Formats the comment at the head of the case file of the continuum.
fn header(
    source: &Case,
    blocks: &SquareBlocks,
    constants: &HomogenisedConstants,
    options: &ContinuumOptions,
    notes: &[String],
) -> String {
    let mut text =
        format!("# Equivalent Cosserat continuum of the blocky medium of {}", source.name);
    let path = source.source_path().map(|path| path.display().to_string());
    let _ = match path.filter(|path| !path.contains(['\n', '\r'])) {
        Some(path) => writeln!(text, " ({path})."),
        None => writeln!(text, "."),
    };
    let h = blocks.medium.period;
    let _ = writeln!(text, "#\n# {} × {} blocks of {h:?} m.", blocks.count[0], blocks.count[1]);
    text += "# Sure for long waves: a1, b1, a2 - b2, density. Leading order in K_t h/mu of the blocks: a2 and b2 alone,\n\
             # inertia. Not unique: alpha2.\n";
    let _ = writeln!(text, "# K_t h/mu = {:.3}.", constants.stiffness_ratio);
    if blocks.joint.material.strength().is_some() {
        let _ = writeln!(text, "# Couple friction {}.", options.opening_limit.description());
    }
    for note in notes {
        let _ = writeln!(text, "# Note: {note}.");
    }
    text.push('\n');
    text
}
