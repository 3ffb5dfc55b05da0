//! Certified map: verdicts proved for all states of cells, which are boxes of the two parameters.

use crate::Error;
use crate::case::{Case, MapAxes, ModelKind, ParameterSweep, SweepParameter};
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
use models::solid::parameters::{Isotropic, Theory};
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
    /// A verdict that is proved for all states, or the failure to prove one.
    Assessed(BoxVerdict),
    /// No corner has a fully deforming flow or a yielding solid with a response.
    NoState,
}

impl CellVerdict {
    /// All values, in the order of their codes.
    pub const ALL: [Self; 4] = [
        Self::Assessed(BoxVerdict::WellPosed),
        Self::Assessed(BoxVerdict::IllPosed),
        Self::Assessed(BoxVerdict::NotDecided),
        Self::NoState,
    ];

    /// Name in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Assessed(own) => own.name(),
            Self::NoState => "no state",
        }
    }

    fn code(self) -> u8 {
        match self {
            Self::Assessed(own) => own as u8,
            Self::NoState => 3,
        }
    }
}

/// Part of a cell: lower corner and size in eighths of the step, and the code of its verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    place: [u8; 2],
    size: u8,
    code: u8,
}

/// Verdicts proved for the cells between the points of a map, with refinement of those that are not decided.
#[derive(Clone, Debug, Serialize)]
pub struct CertifiedMap {
    /// Method of the proof and its assumptions.
    pub method: &'static str,
    /// Numbers of cells along x and y.
    pub cells: [usize; 2],
    /// Numbers of cells all of whose parts have the same verdict, by the name of their [`CellVerdict`]; the others count as
    /// not decided.
    #[serde(serialize_with = "super::summary::serialize_as_object")]
    pub cell_counts: [(&'static str, usize); 4],
    /// Shares of the area of the map by the name of their [`CellVerdict`], part by part.
    #[serde(serialize_with = "super::summary::serialize_as_object")]
    pub area_shares: [(&'static str, f64); 4],
    /// Boxes that are not decided, in which the boundary of the verdict lies: lower and upper x, lower and upper y.
    #[serde(rename = "undecided_boxes")]
    pub undecided: Vec<[f64; 4]>,
    /// Codes of the parts of all cells, with x fastest: [`CELL_PARTS`] parts of each cell along each axis.
    #[serde(skip)]
    pub parts: Vec<u8>,
}

/// Computes the certified map of a case on the rayon thread pool in which it is called.
///
/// # Errors
/// The case has no map, an axis of it has one point or varies a number over which nothing is proved, or no proof is known
/// for the material; [`Error::Cancelled`].
pub fn certify_map(case: &Case, progress: ProgressCallback) -> Result<CertifiedMap, Error> {
    let map = case.require_map()?;
    let proof = Proof::find(case).map_err(|error| case.locate_error(error))?;
    for (key, sweep) in [("map.x", &map.x), ("map.y", &map.y)] {
        let name = sweep.parameter.name();
        let refuse = |rejected_value: String, allowed_values: String| InputError {
            input: key,
            rejected_value,
            allowed_values,
        };
        let error = if sweep.point_count < 2 {
            refuse("one point".into(), "expected two or more points: cells lie between them".into())
        } else if !proof.allows(&name) {
            refuse(name, format!("a certified map varies {}", proof.allowed_names()))
        } else {
            continue;
        };
        return Err(case.locate_error(error).into());
    }
    let cells = [map.x.point_count - 1, map.y.point_count - 1];
    let done = AtomicUsize::new(0);
    let rows: Vec<Vec<Vec<Part>>> = (0..cells[1])
        .into_par_iter()
        .map_init(
            || BoxAssessor { case: case.clone(), map, proof },
            |assessor, row| {
                let own = (0..cells[0]).map(|column| assessor.refine([column, row])).collect();
                report_progress(progress, done.fetch_add(1, Ordering::Relaxed) + 1, cells[1])?;
                Ok(own)
            },
        )
        .collect::<Result<_, Error>>()?;
    Ok(CertifiedMap::new(map, proof.method(), cells, &rows))
}

impl CertifiedMap {
    fn new(
        map: &MapAxes,
        method: &'static str,
        cells: [usize; 2],
        rows: &[Vec<Vec<Part>>],
    ) -> Self {
        let mut cell_counts = CellVerdict::ALL.map(|own| (own.name(), 0));
        let mut part_counts = [0usize; 4];
        let mut undecided = Vec::new();
        let width = cells[0] * CELL_PARTS;
        let mut parts = vec![0; width * cells[1] * CELL_PARTS];
        for (row, own) in rows.iter().enumerate() {
            for (column, of_cell) in own.iter().enumerate() {
                let is_uniform = of_cell.iter().all(|part| part.code == of_cell[0].code);
                let code = if is_uniform { of_cell[0].code } else { 2 };
                cell_counts[usize::from(code)].1 += 1;
                for part in of_cell {
                    let size = usize::from(part.size);
                    part_counts[usize::from(part.code)] += size * size;
                    let [x, y] = part.place.map(usize::from);
                    for line in y..y + size {
                        let start = (row * CELL_PARTS + line) * width + column * CELL_PARTS + x;
                        parts[start..start + size].fill(part.code);
                    }
                    if part.code == 2 {
                        let ends = |sweep: &ParameterSweep, cell: usize, place: u8| {
                            [place, place + part.size]
                                .map(|own| sweep.value_at(position(cell, own)))
                        };
                        let [left, right] = ends(&map.x, column, part.place[0]);
                        let [low, high] = ends(&map.y, row, part.place[1]);
                        undecided.push([left, right, low, high]);
                    }
                }
            }
        }
        let all = parts.len() as f64;
        let area_shares = std::array::from_fn(|code| {
            (CellVerdict::ALL[code].name(), part_counts[code] as f64 / all)
        });
        Self { method, cells, cell_counts, area_shares, undecided, parts }
    }
}

/// Position along an axis, in steps, of a place in a cell in eighths of the step.
fn position(cell: usize, place: u8) -> f64 {
    cell as f64 + f64::from(place) / CELL_PARTS as f64
}

/// The parameter of an axis that runs between these ends, in any order.
fn enclose_axis(axis: usize, [first, last]: [f64; 2]) -> TaylorModel {
    TaylorModel::parameter(axis, first.min(last), first.max(last))
}

/// A proof that is known for a material.
#[derive(Clone, Copy)]
enum Proof {
    Flow(FlowKind),
    Layers { is_positive: bool },
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
            ModelKind::Flow(kind) if material.numbers.background.spin.is_some() => Err(refuse(
                "spin",
                format!("a spin of {}", kind.name()),
                "over a box of states the non-coaxiality must be given, not the spin",
            )),
            ModelKind::Flow(kind) => Ok(Self::Flow(kind)),
            ModelKind::Solid(solid) => {
                let (set, dimensions) = (material.yield_set, material.numbers.dimensions);
                let active = material.active_conditions.as_deref();
                let is_set = |model: &models::yield_set::YieldSetModel| {
                    set.is_some_and(|own| own.name == model.name)
                };
                let has_couples = solid.theory == Theory::Cosserat;
                let (law, _) = setup::solid::create_elastic_law_and_set(material)?;
                let is_isotropic = law.downcast::<Isotropic>().is_some();
                match active {
                    Some(&[index @ 0..4])
                        if is_set(&INTERLAYER) && !has_couples && is_isotropic =>
                    {
                        Ok(Self::Layers { is_positive: index % 2 == 0 })
                    }
                    None if (is_set(&DRUCKER_PRAGER) || is_set(&VON_MISES))
                        && material.numbers.stress.rotational_stress == 0.0
                        && material.numbers.stress.couple_stress == [0.0; 2]
                        && solid.theory == Theory::Classical
                        && is_isotropic
                        && dimensions == 3 =>
                    {
                        Ok(Self::Cone)
                    }
                    _ => Err(refuse(
                        "kind",
                        format!("{} in {dimensions} dimensions", solid.name),
                        "nothing is proved over boxes of this solid; proofs are known for one slipping layer of a \
                         classical or reduced Cosserat solid in the plane, and for a classical solid in space with the \
                         yield set drucker-prager or von-mises",
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

    fn method(self) -> &'static str {
        match self {
            Self::Flow(_) => {
                "signs of the closed-form conditions, enclosed by Taylor models; for ν > 0 those of the leading symbol"
            }
            Self::Layers { .. } => {
                "sum, product and discriminant of both squared speeds as forms in the wave normal, positive or negative by \
                 Bernstein coefficients; Taylor models in the parameters; leading symbol"
            }
            Self::Cone => {
                "strict copositivity of the quadratic form of the determinant of the acoustic tensor; Taylor models in the \
                 parameters"
            }
        }
    }
}

/// Assessor of boxes, one per thread.
struct BoxAssessor<'a> {
    case: Case,
    map: &'a MapAxes,
    proof: Proof,
}

/// What the corners of a box hold.
enum Corners {
    /// A state at each corner; of flows the last one.
    All(Option<Box<DeformingFlow>>),
    Some,
    None,
}

impl BoxAssessor<'_> {
    /// Proves the verdict over a cell, and where it fails, over its quarters and their quarters.
    fn refine(&mut self, cell: [usize; 2]) -> Vec<Part> {
        let mut parts = Vec::new();
        self.add_parts(cell, [0; 2], CELL_PARTS as u8, &mut parts);
        parts
    }

    fn add_parts(&mut self, cell: [usize; 2], place: [u8; 2], size: u8, parts: &mut Vec<Part>) {
        let verdict = self.assess(cell, place, size);
        let is_open = verdict == CellVerdict::Assessed(BoxVerdict::NotDecided);
        if !is_open || size == 1 {
            parts.push(Part { place, size, code: verdict.code() });
            return;
        }
        let half = size / 2;
        for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
            self.add_parts(cell, [place[0] + right, place[1] + up], half, parts);
        }
    }

    fn assess(&mut self, cell: [usize; 2], place: [u8; 2], size: u8) -> CellVerdict {
        let ends = [0, 1].map(|axis| {
            let sweep = if axis == 0 { &self.map.x } else { &self.map.y };
            [place[axis], place[axis] + size].map(|own| sweep.value_at(position(cell[axis], own)))
        });
        let corners = self.check_corners(&ends);
        let Corners::All(flow) = corners else {
            return match corners {
                Corners::None => CellVerdict::NoState,
                _ => CellVerdict::Assessed(BoxVerdict::NotDecided),
            };
        };
        CellVerdict::Assessed(match self.proof {
            Proof::Flow(kind) => self.prove_flow(kind, flow, &ends),
            Proof::Layers { is_positive } => self.prove_layers(is_positive, &ends),
            Proof::Cone => self.prove_cone(&ends),
        })
    }

    /// Checks whether the corners of a box have states. Ranges of constants and of backgrounds are convex, so that all
    /// states between them exist, too.
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
                        Ok(Background::FullyDeforming(flow)) if flow.stress.pressure >= 0.0 => {
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
        for (axis, sweep) in [&self.map.x, &self.map.y].into_iter().enumerate() {
            if sweep.parameter.name() == name {
                return Some(enclose_axis(axis, ends[axis]));
            }
        }
        let parameter = SweepParameter::find_by_name(name)?;
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
