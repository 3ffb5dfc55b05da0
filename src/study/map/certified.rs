//! Certified map: verdicts proved for all states of cells, which are boxes of the two parameters.

use crate::Error;
use crate::case::{Case, MapAxes, ModelKind, SweepParameter};
use crate::setup;
use crate::study::{ProgressCallback, report_progress};
use analysis::certified::{BoxVerdict, SlippingLayers, YieldCone};
use models::InputError;
use models::common::parameter::ANGLE_UNIT;
use models::common::rounding::Rounded;
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;
use models::elastoplastic::Solid;
use models::flow::state::{Background, DeformingFlow};
use models::flow::{FlowKind, Model};
use models::solid::isotropic::{CLASSICAL, REDUCED_COSSERAT};
use models::yield_set::interlayer::INTERLAYER;
use models::yield_set::mises::{DRUCKER_PRAGER, VON_MISES};
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Largest number of halvings of a cell along each axis: parts of an eighth of the step.
const MAX_HALVINGS: u32 = 3;

/// Number of parts of a cell along each axis.
pub const CELL_PARTS: usize = 1 << MAX_HALVINGS;

/// What is known of a part of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellVerdict {
    /// All states are proved well-posed.
    WellPosed = 0,
    /// All states are proved ill-posed.
    IllPosed = 1,
    /// Neither is proved.
    NotDecided = 2,
    /// No corner of the part has a fully deforming flow or a yielding solid with a response.
    NoState = 3,
}

impl CellVerdict {
    /// All values, in the order of their codes.
    pub const ALL: [Self; 4] = [Self::WellPosed, Self::IllPosed, Self::NotDecided, Self::NoState];
}

impl From<BoxVerdict> for CellVerdict {
    fn from(own: BoxVerdict) -> Self {
        match own {
            BoxVerdict::WellPosed => Self::WellPosed,
            BoxVerdict::IllPosed => Self::IllPosed,
            BoxVerdict::NotDecided => Self::NotDecided,
        }
    }
}

/// Verdicts proved for the cells between the points of a map, with refinement of those that are not decided.
#[derive(Clone, Debug, Serialize)]
pub struct CertifiedMap {
    /// Method of the proof and its assumptions.
    pub method: String,
    /// Numbers of cells along x and y.
    pub cells: [usize; 2],
    /// Numbers of cells all of whose parts have the same verdict, by its name; the others count as not decided.
    #[serde(serialize_with = "super::summary::serialize_as_object")]
    pub cell_counts: [(&'static str, usize); 4],
    /// Shares of the area of the map, of its logarithms on logarithmic axes, by the name of the verdict of its parts.
    #[serde(serialize_with = "super::summary::serialize_as_object")]
    pub area_shares: [(&'static str, f64); 4],
    /// Boxes that are not decided: lower and upper x, lower and upper y. The boundary of the verdict lies in their union.
    #[serde(rename = "undecided_boxes")]
    pub undecided: Vec<[f64; 4]>,
    /// Codes of the parts of all cells, places of [`CellVerdict::ALL`], with x fastest: [`CELL_PARTS`] parts of each cell
    /// along each axis.
    #[serde(skip)]
    pub parts: Vec<u8>,
}

/// What is known of a row of cells.
struct CellRow {
    /// Codes of the parts, with x fastest.
    parts: Vec<u8>,
    undecided: Vec<[f64; 4]>,
}

/// Computes the certified map of a case on the rayon thread pool in which it is called.
///
/// # Errors
/// The case has no map, an axis of it has one point or varies a number over which nothing is proved, or no proof is known
/// for the material or its state; [`Error::Cancelled`].
pub fn certify_map(case: &Case, progress: ProgressCallback) -> Result<CertifiedMap, Error> {
    let map = case.require_map()?;
    let proof = Proof::find(case).map_err(|error| case.locate_error(error))?;
    for (key, sweep) in [("map.x", &map.x), ("map.y", &map.y)] {
        let name = sweep.parameter.name();
        let (rejected_value, allowed_values) = if sweep.point_count < 2 {
            ("one point".into(), "expected two or more points: cells lie between them".into())
        } else if !proof.allows(&name) {
            (name, format!("a certified map varies {}", proof.allowed_names()))
        } else {
            continue;
        };
        return Err(case
            .locate_error(InputError { input: key, rejected_value, allowed_values })
            .into());
    }
    let cells = [map.x.point_count - 1, map.y.point_count - 1];
    let done = AtomicUsize::new(0);
    let rows: Vec<CellRow> = (0..cells[1])
        .into_par_iter()
        .map_init(
            || BoxAssessor::new(case, map, proof),
            |assessor, row| {
                let own = assessor.assess_row(row, cells[0]);
                report_progress(progress, done.fetch_add(1, Ordering::Relaxed) + 1, cells[1])?;
                Ok(own)
            },
        )
        .collect::<Result<_, Error>>()?;
    Ok(CertifiedMap::new(proof, case, cells, rows))
}

impl CertifiedMap {
    fn new(proof: Proof, case: &Case, cells: [usize; 2], rows: Vec<CellRow>) -> Self {
        let names = proof.verdict_names(case);
        let width = cells[0] * CELL_PARTS;
        let mut parts = Vec::with_capacity(width * cells[1] * CELL_PARTS);
        let mut undecided = Vec::new();
        for row in rows {
            parts.extend(row.parts);
            undecided.extend(row.undecided);
        }
        let (mut cell_counts, mut part_counts) = ([0; 4], [0_usize; 4]);
        parts.iter().for_each(|&code| part_counts[usize::from(code)] += 1);
        for row in 0..cells[1] {
            for column in 0..cells[0] {
                let first = row * CELL_PARTS * width + column * CELL_PARTS;
                let lines =
                    (0..CELL_PARTS).map(|line| &parts[first + line * width..][..CELL_PARTS]);
                let code = parts[first];
                let is_uniform = lines.flatten().all(|&own| own == code);
                let place =
                    if is_uniform { usize::from(code) } else { CellVerdict::NotDecided as usize };
                cell_counts[place] += 1;
            }
        }
        let all = parts.len() as f64;
        let shares = part_counts.map(|count| count as f64 / all);
        Self {
            method: proof.method(case),
            cells,
            cell_counts: std::array::from_fn(|code| (names[code], cell_counts[code])),
            area_shares: std::array::from_fn(|code| (names[code], shares[code])),
            undecided,
            parts,
        }
    }
}

/// Position along an axis, in steps, of a place in a cell in parts of the step.
fn position(cell: usize, place: usize) -> f64 {
    cell as f64 + place as f64 / CELL_PARTS as f64
}

/// The parameter of an axis that runs between these ends.
fn enclose_axis(axis: usize, [first, last]: [f64; 2]) -> TaylorModel {
    TaylorModel::parameter(axis, first, last)
}

/// A proof that is known for a material.
#[derive(Clone, Copy)]
enum Proof {
    Flow(FlowKind),
    Layers { is_positive: bool, has_spin: bool },
    Cone,
}

impl Proof {
    fn find(case: &Case) -> Result<Self, InputError> {
        let material = &case.material;
        let refuse = |input, rejected_value: String, allowed_values: &str| InputError {
            input,
            rejected_value,
            allowed_values: allowed_values.into(),
        };
        match material.kind {
            ModelKind::Flow(kind) => {
                Self::check_flow(case, kind)?;
                Ok(Self::Flow(kind))
            }
            ModelKind::Solid(solid) => {
                let (set, dimensions) = (material.yield_set, material.numbers.dimensions);
                let active = material.active_conditions.as_deref();
                let is_set = |model: &models::yield_set::YieldSetModel| {
                    set.is_some_and(|own| own.name == model.name)
                };
                let is_solid = |model: &models::solid::SolidModel| solid.name == model.name;
                let is_classical = is_solid(&CLASSICAL);
                match active {
                    Some(&[index @ 0..4])
                        if is_set(&INTERLAYER) && (is_classical || is_solid(&REDUCED_COSSERAT)) =>
                    {
                        Ok(Self::Layers { is_positive: index % 2 == 0, has_spin: !is_classical })
                    }
                    None if (is_set(&DRUCKER_PRAGER) || is_set(&VON_MISES))
                        && material.numbers.stress.rotational_stress == 0.0
                        && material.numbers.stress.couple_stress == [0.0; 2]
                        && is_classical
                        && dimensions == 3 =>
                    {
                        Ok(Self::Cone)
                    }
                    _ => Err(refuse(
                        "kind",
                        format!(
                            "{} in {dimensions} dimensions, with the rest of the case",
                            solid.name
                        ),
                        "nothing is proved over boxes of this solid; proofs are known for classical and reduced-cosserat with \
                         the yield set interlayer and yield.active = one of +sigma21, -sigma21, +sigma12, -sigma12; and for \
                         classical in 3 dimensions with the yield set drucker-prager or von-mises, without yield.active, \
                         stress.rotational_stress and stress.couple_stress",
                    )),
                }
            }
            kind => Err(refuse(
                "kind",
                kind.name().to_owned(),
                "nothing is proved over boxes of this model: a certified map takes a flow or a solid",
            )),
        }
    }

    /// Checks that conditions are known for the background of a flow, and that its file has no numbers that a background
    /// determines: states that satisfy them at the corners of a box need not exist inside.
    fn check_flow(case: &Case, kind: FlowKind) -> Result<(), InputError> {
        let given = &case.material.numbers.background;
        let redundant = [
            ("spin", given.spin.is_some()),
            ("deviatoric_stress", given.deviatoric_stress.is_some()),
            ("rotational_stress", given.rotational_stress.is_some()),
            ("velocity_gradient", given.velocity_gradient.is_some()),
            ("acceleration", given.acceleration.is_some()),
            ("body_moment", given.body_moment.is_some()),
            ("stress_angle_rate", given.stress_angle_rate_deg.is_some()),
        ];
        if let Some((input, _)) = redundant.into_iter().find(|own| own.1) {
            return Err(InputError {
                input,
                rejected_value: "this key".into(),
                allowed_values: "a certified map takes backgrounds without numbers that follow from others; leave it out"
                    .into(),
            });
        }
        let constants = case.model_constants();
        let Ok(model) = Model::new(kind, &constants) else { return Ok(()) };
        let Ok(Background::FullyDeforming(flow)) = model.background(&case.to_flow_state()) else {
            // The map may vary the numbers that are out of range.
            return Ok(());
        };
        let enclosures: Vec<TaylorModel> =
            constants.iter().map(|&own| Rounded::from_angle(own).into()).collect();
        match model.box_conditions(&flow, &enclosures, TaylorModel::ZERO) {
            Some(_) => Ok(()),
            None => Err(InputError {
                input: "kind",
                rejected_value: format!("{} about this background", kind.name()),
                allowed_values: "nothing is proved over boxes of it; harris-grekova with dilatancy takes a uniform \
                                 background and rotational_strength = 0, double-shearing and plastic-potential any"
                    .into(),
            }),
        }
    }

    /// Names of the verdicts, in the order of [`CellVerdict::ALL`].
    fn verdict_names(self, case: &Case) -> [&'static str; 4] {
        let well_posed = match self.is_leading_symbol(case) {
            true => "leading symbol proved well-posed",
            false => "proved well-posed",
        };
        [well_posed, "proved ill-posed", "not decided", "no state"]
    }

    /// Whether well-posedness is proved of the leading symbol only.
    fn is_leading_symbol(self, case: &Case) -> bool {
        match self {
            Self::Flow(_) => {
                let sweeps = case.map.iter().flat_map(|map| [&map.x, &map.y]);
                let mut names = sweeps.map(|sweep| sweep.parameter.name());
                let key = "model.dilatancy_angle_deg";
                let value = SweepParameter::find_by_name(key)
                    .and_then(|own| own.value(&case.material.numbers));
                names.any(|own| own == key) || value.is_some_and(|own| own > 0.0)
            }
            Self::Layers { has_spin, .. } => has_spin,
            Self::Cone => false,
        }
    }

    /// Sections of numbers over which the proof holds, and single numbers.
    fn allowed(self) -> (&'static [&'static str], &'static [&'static str]) {
        match self {
            Self::Flow(_) => (
                &["model.", "wave."],
                &[
                    "background.noncoaxiality_deg",
                    "background.density",
                    "background.pressure",
                    "background.shear_rate",
                    "background.stress_angle_deg",
                ],
            ),
            Self::Layers { .. } => (&["model.", "yield.", "wave."], &[]),
            Self::Cone => (
                &["model.", "yield.", "wave."],
                &["stress.deviatoric_stress", "stress.out_of_plane_stress"],
            ),
        }
    }

    fn allows(self, name: &str) -> bool {
        let (sections, numbers) = self.allowed();
        numbers.contains(&name) || sections.iter().any(|own| name.starts_with(own))
    }

    fn allowed_names(self) -> String {
        let (sections, numbers) = self.allowed();
        let sections =
            sections.iter().map(|own| format!("numbers of [{}]", own.trim_end_matches('.')));
        let numbers = numbers.iter().map(|own| (*own).to_owned());
        sections.chain(numbers).collect::<Vec<_>>().join(", ")
    }

    fn method(self, case: &Case) -> String {
        let (of, scope) = (
            match self {
                Self::Flow(_) => "signs of conditions in closed form",
                Self::Layers { .. } => {
                    "signs of sum, product and discriminant of both squared speeds for all wave normals, by Bernstein \
                     coefficients"
                }
                Self::Cone => {
                    "strict copositivity of the quadratic form of the determinant of the acoustic tensor"
                }
            },
            if self.is_leading_symbol(case) {
                "; terms of lower order are not enclosed"
            } else {
                ""
            },
        );
        format!("{of}, enclosed by Taylor models in both parameters{scope}")
    }
}

/// Assessor of boxes, one per thread.
struct BoxAssessor<'a> {
    case: Case,
    map: &'a MapAxes,
    proof: Proof,
    /// Numbers of the case that the proof takes by name: those of solids.
    named: Vec<(&'static str, SweepParameter)>,
}

/// What the corners of a box hold.
enum Corners {
    /// A state at each corner; of flows the last one.
    All(Option<Box<DeformingFlow>>),
    Some,
    None,
}

/// A square part of a cell: place of its lower corner and size, in parts of the step.
#[derive(Clone, Copy)]
struct CellPart {
    cell: [usize; 2],
    place: [usize; 2],
    size: usize,
}

impl<'a> BoxAssessor<'a> {
    fn new(case: &Case, map: &'a MapAxes, proof: Proof) -> Self {
        const NAMES: [&str; 9] = [
            "model.lambda",
            "model.mu",
            "model.alpha",
            "yield.shear_friction",
            "yield.shear_dilatancy",
            "yield.friction",
            "yield.dilatancy",
            "yield.hardening",
            "background.noncoaxiality_deg",
        ];
        const STRESSES: [&str; 2] = ["stress.deviatoric_stress", "stress.out_of_plane_stress"];
        let find = |name| Some((name, SweepParameter::find_by_name(name)?));
        let named = NAMES.into_iter().chain(STRESSES).filter_map(find).collect();
        Self { case: case.clone(), map, proof, named }
    }

    /// Proves verdicts over the cells of a row, and where that fails, over their quarters and the quarters of these.
    fn assess_row(&mut self, row: usize, columns: usize) -> CellRow {
        let mut own =
            CellRow { parts: vec![0; columns * CELL_PARTS * CELL_PARTS], undecided: Vec::new() };
        for column in 0..columns {
            let cell = CellPart { cell: [column, row], place: [0; 2], size: CELL_PARTS };
            if self.assess_part(cell, &mut own) == Some(CellVerdict::NotDecided) {
                own.undecided.push(self.corners(cell));
            }
        }
        own
    }

    /// Writes the codes of a part; adds the undecided boxes if it has several verdicts, and returns it if it has one.
    fn assess_part(&mut self, part: CellPart, row: &mut CellRow) -> Option<CellVerdict> {
        let verdict = self.assess(part);
        let is_final = matches!(verdict, CellVerdict::WellPosed | CellVerdict::IllPosed);
        if is_final || part.size == 1 {
            let width = row.parts.len() / CELL_PARTS;
            for line in part.place[1]..part.place[1] + part.size {
                let start = line * width + part.cell[0] * CELL_PARTS + part.place[0];
                row.parts[start..start + part.size].fill(verdict as u8);
            }
            return Some(verdict);
        }
        let size = part.size / 2;
        let quarters = [[0, 0], [size, 0], [0, size], [size, size]].map(|[right, up]| CellPart {
            place: [part.place[0] + right, part.place[1] + up],
            size,
            ..part
        });
        let verdicts = quarters.map(|quarter| self.assess_part(quarter, row));
        if verdicts.iter().all(|own| *own == verdicts[0]) {
            return verdicts[0];
        }
        for (quarter, verdict) in quarters.into_iter().zip(verdicts) {
            if verdict == Some(CellVerdict::NotDecided) {
                row.undecided.push(self.corners(quarter));
            }
        }
        None
    }

    /// Lower and upper end of a part along both axes.
    fn ends(&self, part: CellPart) -> [[f64; 2]; 2] {
        let CellPart { cell, place, size } = part;
        [0, 1].map(|axis| {
            let sweep = if axis == 0 { &self.map.x } else { &self.map.y };
            [place[axis], place[axis] + size].map(|own| sweep.value_at(position(cell[axis], own)))
        })
    }

    /// Lower and upper x, lower and upper y of a part.
    fn corners(&self, part: CellPart) -> [f64; 4] {
        let [[left, right], [low, high]] = self.ends(part);
        [left, right, low, high]
    }

    fn assess(&mut self, part: CellPart) -> CellVerdict {
        let ends = self.ends(part);
        match self.check_corners(&ends) {
            Corners::None => CellVerdict::NoState,
            Corners::Some => CellVerdict::NotDecided,
            Corners::All(flow) => match self.proof {
                Proof::Flow(kind) => self.prove_flow(kind, flow, &ends).into(),
                Proof::Layers { is_positive, .. } => self.prove_layers(is_positive, &ends).into(),
                Proof::Cone => self.prove_cone(&ends).into(),
            },
        }
    }

    /// Checks whether the corners of a box have states. Without redundant numbers these form a convex set, or, under tension,
    /// one whose condition p sin φ + c cos φ > 0 is monotone in each number; so all states between corners exist, too.
    fn check_corners(&mut self, ends: &[[f64; 2]; 2]) -> Corners {
        let (mut count, mut last) = (0, None);
        for corner in 0..4 {
            let values = [ends[0][corner % 2], ends[1][corner / 2]];
            for (sweep, value) in [&self.map.x, &self.map.y].into_iter().zip(values) {
                self.case.set_number(sweep.parameter, value);
            }
            let is_state = match self.proof {
                Proof::Flow(kind) => {
                    let background = Model::new(kind, &self.case.model_constants())
                        .and_then(|model| model.background(&self.case.to_flow_state()));
                    match background {
                        Ok(Background::FullyDeforming(flow)) => {
                            last = Some(Box::new(flow));
                            true
                        }
                        _ => false,
                    }
                }
                Proof::Layers { .. } => self.has_response(|solid| solid.rates::<2>().is_ok()),
                Proof::Cone => self.has_response(|solid| solid.rates::<3>().is_ok()),
            };
            count += usize::from(is_state);
        }
        match count {
            4 => Corners::All(last),
            0 => Corners::None,
            _ => Corners::Some,
        }
    }

    /// Whether the present state of the solid yields and has a response.
    fn has_response(&self, has_rates: impl Fn(&Solid) -> bool) -> bool {
        setup::solid::create_solid(&self.case.material)
            .is_ok_and(|solid| solid.plastic_state.is_some() && has_rates(&solid))
    }

    /// Enclosure of a number of the case in the unit of its file; `None` if it is absent.
    fn enclose(&self, name: &str, ends: &[[f64; 2]; 2]) -> Option<TaylorModel> {
        let parameter = self.named.iter().find(|own| own.0 == name)?.1;
        for (axis, sweep) in [&self.map.x, &self.map.y].into_iter().enumerate() {
            if sweep.parameter == parameter {
                return Some(enclose_axis(axis, ends[axis]));
            }
        }
        let value = parameter.value(&self.case.material.numbers).filter(|own| !own.is_nan())?;
        Some(if value == 0.0 { TaylorModel::ZERO } else { TaylorModel::from_rounded(value) })
    }

    fn prove_flow(
        &self,
        kind: FlowKind,
        flow: Option<Box<DeformingFlow>>,
        ends: &[[f64; 2]; 2],
    ) -> BoxVerdict {
        let radians = |degrees: TaylorModel| degrees * TaylorModel::from_rounded(PI / 180.0);
        let constants = self.case.model_constants();
        let mut enclosures: Vec<TaylorModel> =
            constants.iter().map(|&own| Rounded::from_angle(own).into()).collect();
        for (axis, sweep) in [&self.map.x, &self.map.y].into_iter().enumerate() {
            let Some((index, constant)) = sweep.parameter.model_constant(ModelKind::Flow(kind))
            else {
                continue;
            };
            let own = enclose_axis(axis, ends[axis]);
            enclosures[index] = if constant.unit == ANGLE_UNIT { radians(own) } else { own };
        }
        let noncoaxiality =
            self.enclose("background.noncoaxiality_deg", ends).map_or(TaylorModel::ZERO, radians);
        let model = Model::new(kind, &constants).ok();
        let conditions = model
            .zip(flow)
            .and_then(|(model, flow)| model.box_conditions(&flow, &enclosures, noncoaxiality));
        conditions.map_or(BoxVerdict::NotDecided, |own| BoxVerdict::from_conditions(&own))
    }

    fn prove_layers(&self, is_positive: bool, ends: &[[f64; 2]; 2]) -> BoxVerdict {
        let number = |name: &str| self.enclose(name, ends);
        let alpha = number("model.alpha").unwrap_or(TaylorModel::ZERO);
        let layers = || {
            Some(SlippingLayers {
                lambda: number("model.lambda")?,
                mu: number("model.mu")?,
                alpha,
                friction: number("yield.shear_friction")?,
                dilatancy: number("yield.shear_dilatancy")?,
                is_positive,
            })
        };
        layers().map_or(BoxVerdict::NotDecided, |own| own.verdict())
    }

    fn prove_cone(&self, ends: &[[f64; 2]; 2]) -> BoxVerdict {
        let number = |name: &str| self.enclose(name, ends);
        let or_zero = |name: &str| number(name).unwrap_or(TaylorModel::ZERO);
        let cone = || {
            let deviatoric = number("stress.deviatoric_stress")?;
            Some(YieldCone {
                lambda: number("model.lambda")?,
                mu: number("model.mu")?,
                friction: or_zero("yield.friction"),
                dilatancy: or_zero("yield.dilatancy"),
                hardening: or_zero("yield.hardening"),
                principal_stresses: [
                    deviatoric,
                    -deviatoric,
                    or_zero("stress.out_of_plane_stress"),
                ],
            })
        };
        cone().map_or(BoxVerdict::NotDecided, |own| own.verdict())
    }
}
