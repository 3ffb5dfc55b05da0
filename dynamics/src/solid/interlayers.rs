//! Interlayers between blocks of cells (blocky media): laws, planes of faces, and their checks.

use super::medium::Medium;
use super::problem::Problem;
use super::region::Region;
use crate::simd::Real;
use models::common::number::Number;
use models::interface::elastic::{
    COMPONENT_VARIABLE_COUNT, ElasticComponent, ElasticLayer, ElasticMaterial,
};
use models::interface::layer::{FaceRecord, LayerLaw};
use models::interface::opening_line::LayerMass;
use models::interface::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use models::solid::waves::SolidField;
use std::ops::Range;

/// Largest number of wave pairs along an axis: those of a Cosserat solid in space.
pub const MAX_PAIRS: usize = 6;

/// Largest number of history variables of the law of a face.
pub(crate) const MAX_HISTORY_VARIABLES: usize = COMPONENT_VARIABLE_COUNT * MAX_PAIRS;

/// Law of an interlayer: relates the traction components of all wave pairs of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InterlayerLaw<N> {
    /// Independent elastic components in the order of the wave pairs; those beyond the number of pairs are not used.
    Elastic([ElasticComponent<N>; MAX_PAIRS]),
    /// Law that may couple the two traction components of a classical solid in the plane, and the index of the wave
    /// pair with the normal velocity.
    Plane(LayerLaw<N>, usize),
}

impl InterlayerLaw<f64> {
    /// Creates the elastic law of a material between blocks of a medium: the normal compliance for the wave pair whose
    /// velocity is along the axis, the tangential compliance for the other velocities. Spins are continuous.
    pub fn from_material(axis: usize, material: &ElasticMaterial, medium: &Medium) -> Self {
        let mass = LayerMass::new_box(material.mass());
        let component = |compliance: f64| ElasticComponent { mass, compliance };
        let mut components = [ElasticComponent::WELDED; MAX_PAIRS];
        let pairs = medium.pairs.get(axis).map_or(&[][..], |pairs| pairs);
        for (component_of_pair, pair) in components.iter_mut().zip(pairs) {
            match pair.velocity {
                SolidField::Velocity(along) if along == axis => {
                    *component_of_pair = component(material.normal_compliance());
                }
                SolidField::Velocity(_) => {
                    *component_of_pair = component(material.tangential_compliance());
                }
                _ => {}
            }
        }
        Self::Elastic(components)
    }

    /// Checks the constants of the law, and that it applies to `pairs` wave pairs; the error is the reason.
    fn check(&self, pairs: usize) -> Result<(), &'static str> {
        let is_admissible = |value: f64| value >= 0.0 && value.is_finite();
        match self {
            Self::Plane(_, normal) => match pairs == 2 && *normal < 2 {
                true => Ok(()),
                false => Err("laws other than elastic need a classical solid in the plane"),
            },
            Self::Elastic(components) => {
                let constants = components
                    .iter()
                    .flat_map(|own| [own.mass.mass, own.mass.opening_mass, own.compliance]);
                match constants.into_iter().all(is_admissible) {
                    true => Ok(()),
                    false => Err("masses and compliances must be finite and not negative"),
                }
            }
        }
    }
}

impl<N: Number> InterlayerLaw<N> {
    /// Converts the constants to another number type.
    #[inline(always)]
    pub(crate) fn map<M: Number>(self, convert: impl Fn(N) -> M) -> InterlayerLaw<M> {
        match self {
            Self::Elastic(components) => {
                // A loop: closures lose the SIMD instructions of the kernel.
                let mut converted = [components[0].map(&convert); MAX_PAIRS];
                for pair in 1..MAX_PAIRS {
                    converted[pair] = components[pair].map(&convert);
                }
                InterlayerLaw::Elastic(converted)
            }
            Self::Plane(law, normal) => InterlayerLaw::Plane(law.map(convert), normal),
        }
    }

    /// Returns the number of history variables of a face with `pairs` wave pairs.
    pub(crate) fn history_variables(&self, pairs: usize) -> usize {
        match self {
            Self::Elastic(_) => COMPONENT_VARIABLE_COUNT * pairs,
            Self::Plane(law, _) => law.history_variable_count(),
        }
    }

    /// Returns the number of history variables of the normal component, which come first, if the law is one for plane
    /// strain with independent components; else `None`.
    pub(crate) fn normal_variable_count(&self) -> Option<usize> {
        match self {
            Self::Plane(law, _) => law.normal_variable_count(),
            Self::Elastic(_) => None,
        }
    }

    /// Returns the elastic law of the first `P` components, those of the wave pairs of an axis.
    #[inline(always)]
    pub(crate) fn elastic_layer<const P: usize>(
        components: &[ElasticComponent<N>; MAX_PAIRS],
    ) -> ElasticLayer<N, P> {
        let mut pair_components = [components[0]; P];
        pair_components.copy_from_slice(&components[..P]);
        ElasticLayer { components: pair_components }
    }
}

impl<N: Number, const P: usize> FaceLaw<N, P> for InterlayerLaw<N> {
    const HISTORY_VARIABLE_COUNT: usize = MAX_HISTORY_VARIABLES;

    fn initialise(&self, velocities: &[[N; 2]; P], history: &mut [N]) {
        match self {
            Self::Elastic(components) => {
                Self::elastic_layer(components).initialise(velocities, history);
            }
            Self::Plane(law, normal) => {
                law.initialise(&[velocities[*normal], velocities[1 - normal]], history);
            }
        }
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; P],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; P] {
        match self {
            Self::Elastic(components) => {
                Self::elastic_layer(components).advance(incoming, interval, history)
            }
            Self::Plane(law, normal) => {
                // Not compiled for other numbers of pairs: `check` refuses such laws there.
                if P != 2 {
                    return [[FaceState { velocity: N::ZERO, stress: N::ZERO }; 2]; P];
                }
                let components = [incoming[*normal], incoming[1 - normal]];
                let face_states = law.advance(&components, interval, history);
                let mut states = [face_states[0]; P];
                states[1 - normal] = face_states[1];
                states
            }
        }
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        match self {
            Self::Elastic(components) => {
                FaceLaw::<N, P>::energy(&Self::elastic_layer::<P>(components), history)
            }
            Self::Plane(law, _) => law.energy(history),
        }
    }
}

/// Laws of the faces normal to an axis at one coordinate, as indices in [`Interlayers::laws`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlaneLaws {
    /// The same law in all faces.
    Uniform(u16),
    /// Runs of faces with the same law, other axes in ascending order, first one fastest: end of the run and law, `None`
    /// without interlayer. The ends ascend, and no run is empty. Joints of large blocks take few runs.
    Runs(Vec<(usize, Option<u16>)>),
}

impl PlaneLaws {
    /// Creates the laws of the faces of a plane, from the law of each face or of runs of faces with their lengths.
    pub fn from_runs(runs: impl IntoIterator<Item = (usize, Option<u16>)>) -> Self {
        let mut merged: Vec<(usize, Option<u16>)> = Vec::new();
        let mut end = 0;
        for (length, law) in runs.into_iter().filter(|own| own.0 > 0) {
            end += length;
            match merged.last_mut().filter(|last| last.1 == law) {
                Some(last) => last.0 = end,
                None => merged.push((end, law)),
            }
        }
        match merged[..] {
            [(_, Some(law))] => Self::Uniform(law),
            _ => Self::Runs(merged),
        }
    }

    /// Creates the laws of the faces of a plane from the law of each; `None`: no interlayer.
    pub fn from_faces(laws: impl IntoIterator<Item = Option<u16>>) -> Self {
        Self::from_runs(laws.into_iter().map(|law| (1, law)))
    }
}

/// Plane of faces with interlayers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterlayerPlane {
    /// Coordinate along the axis of the cells above the faces. 0 on a periodic axis only; on other axes the blocks at
    /// both ends have at least three cells.
    pub cell: usize,
    /// Law of each face of the plane.
    pub laws: PlaneLaws,
}

impl InterlayerPlane {
    /// Returns the index of the law of a face of the plane; `None` at a face without interlayer.
    pub(crate) fn law(&self, face: usize) -> Option<u16> {
        match &self.laws {
            PlaneLaws::Uniform(law) => Some(*law),
            PlaneLaws::Runs(runs) => runs.get(runs.partition_point(|own| own.0 <= face))?.1,
        }
    }
}

/// Interlayers normal to an axis.
///
/// The thickness of an interlayer enters only its law; geometrically the interlayer is a face.
#[derive(Clone, Debug, PartialEq)]
pub struct Interlayers {
    /// Axis normal to the faces.
    pub axis: usize,
    /// Laws to which the planes refer by index.
    pub laws: Vec<InterlayerLaw<f64>>,
    /// Planes in ascending order of their coordinates.
    pub planes: Vec<InterlayerPlane>,
    /// Whether the fluid of saturated layers flows out freely where they end at a boundary (pressure zero); else the
    /// ends are closed (velocity zero).
    pub has_open_ends: bool,
}

impl Interlayers {
    /// Creates interlayers of one law between blocks of equal length, at the lower faces of cells `offset`,
    /// `offset + block_cells`, … of `cells` cells along the axis.
    pub fn new_regular(
        axis: usize,
        cells: usize,
        [offset, block_cells]: [usize; 2],
        law: InterlayerLaw<f64>,
    ) -> Self {
        let planes = (offset..cells).step_by(block_cells.max(1));
        let plane = |cell| InterlayerPlane { cell, laws: PlaneLaws::Uniform(0) };
        Self { axis, laws: vec![law], planes: planes.map(plane).collect(), has_open_ends: false }
    }

    /// Returns the plane of interlayers at the lower faces of the cells with coordinate `cell`; `None` without such.
    pub(crate) fn plane(&self, cell: usize) -> Option<&InterlayerPlane> {
        let index = self.planes.binary_search_by_key(&cell, |plane| plane.cell).ok()?;
        self.planes.get(index)
    }

    /// Returns the largest wave speed of the fluid along the layers, m/s; `None` without saturated layers.
    pub(crate) fn fluid_speed(&self) -> Option<f64> {
        let speed = |law: &InterlayerLaw<f64>| match law {
            InterlayerLaw::Plane(law, _) => Some(law.fluid()?.speed),
            InterlayerLaw::Elastic(_) => None,
        };
        self.laws.iter().filter_map(speed).reduce(f64::max)
    }

    /// Whether all faces of each plane have the same law.
    pub(crate) fn is_uniform(&self) -> bool {
        self.planes.iter().all(|plane| matches!(plane.laws, PlaneLaws::Uniform(_)))
    }

    /// Returns the largest number of history variables of a face with `pairs` wave pairs.
    pub(crate) fn history_variables(&self, pairs: usize) -> usize {
        self.laws.iter().map(|law| law.history_variables(pairs)).max().unwrap_or(0)
    }

    /// Returns the greatest common divisor of the distances between planes; 1 without two planes.
    pub(crate) fn common_distance(&self) -> usize {
        let distances = self.planes.windows(2).map(|pair| pair[1].cell.abs_diff(pair[0].cell));
        distances.reduce(greatest_common_divisor).unwrap_or(1).max(1)
    }

    /// Checks laws and planes on an axis of `cells` cells with `faces` faces in a plane and
    /// `pairs` wave pairs; the error is the reason.
    pub(crate) fn check(
        &self,
        cells: usize,
        faces: usize,
        (pairs, is_periodic): (usize, bool),
    ) -> Result<(), &'static str> {
        use crate::solid::ghosts::CLOSURE_CELLS;
        self.laws.iter().try_for_each(|law| law.check(pairs))?;
        let is_ascending = self.planes.windows(2).all(|pair| pair[0].cell < pair[1].cell);
        let (Some(first), Some(last)) = (self.planes.first(), self.planes.last()) else {
            return Err("there must be an interlayer");
        };
        if !is_ascending || last.cell >= cells {
            return Err("planes must be inside the grid, in ascending order");
        }
        if !is_periodic && first.cell.min(cells - last.cell) < CLOSURE_CELLS {
            return Err("blocks beside sides that are not periodic must have three cells");
        }
        for plane in &self.planes {
            let is_known = |law: u16| usize::from(law) < self.laws.len();
            let is_valid = match &plane.laws {
                PlaneLaws::Uniform(law) => is_known(*law),
                PlaneLaws::Runs(runs) => {
                    if !runs.is_sorted_by(|one, next| one.0 < next.0)
                        || runs.first().is_some_and(|first| first.0 == 0)
                    {
                        return Err(
                            "the ends of the runs of faces in a plane must ascend from zero",
                        );
                    }
                    runs.last().is_some_and(|last| last.0 == faces)
                        && runs.iter().filter_map(|own| own.1).all(is_known)
                }
            };
            if !is_valid {
                return Err("every face of a plane needs an existing law, or none");
            }
        }
        Ok(())
    }
}

/// Computes the greatest common divisor by Euclid's algorithm.
fn greatest_common_divisor(one: usize, other: usize) -> usize {
    if other == 0 { one } else { greatest_common_divisor(other, one % other) }
}

/// Calls a generic function with the number of wave pairs as constant.
macro_rules! with_pair_count {
    ($pairs:expr, $P:ident => $body:expr) => {
        match $pairs {
            0 | 1 => {
                const $P: usize = 1;
                $body
            }
            2 => {
                const $P: usize = 2;
                $body
            }
            3 => {
                const $P: usize = 3;
                $body
            }
            _ => {
                const $P: usize = 6;
                $body
            }
        }
    };
}
pub(crate) use with_pair_count;

/// Sets the initial history variables of a stress-free interlayer from the velocities of the adjacent cells by wave
/// pair.
pub(crate) fn initialise_history<T: Real>(
    law: &InterlayerLaw<T>,
    pairs: usize,
    velocity: impl Fn(usize, usize) -> T,
    history: &mut [T],
) {
    with_pair_count!(pairs, P => {
        let velocities: [[T; 2]; P] =
            std::array::from_fn(|pair| [velocity(pair, 0), velocity(pair, 1)]);
        law.initialise(&velocities, history);
    });
}

/// Computes the energy of an interlayer face with `pairs` wave pairs, J/m².
pub(crate) fn face_energy(
    law: &InterlayerLaw<f64>,
    pairs: usize,
    history: &[f64],
) -> FaceEnergy<f64> {
    with_pair_count!(pairs, P => FaceLaw::<f64, P>::energy(law, history))
}

/// Face with an interlayer: its position, its law, and the range of its history variables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterlayerFace {
    /// Axis normal to the face.
    pub axis: usize,
    /// Cell above the face.
    pub cell: usize,
    /// Index of the law among those of the axis.
    pub law: usize,
    /// Range of the history variables of the face in the list of those of all faces.
    pub history: Range<usize>,
}

impl<const D: usize> Problem<D> {
    /// Returns all faces with interlayers: by layer across the last axis, axis normal to the face, and cell above the
    /// face.
    pub fn interlayer_faces(&self) -> Vec<InterlayerFace> {
        self.interlayer_faces_in(&self.grid.cells.map(|count| 0..count))
    }

    /// Returns the faces with interlayers at the lower faces of the cells of a box, in the same order; ranges of history
    /// variables are those in the list of these faces.
    pub fn interlayer_faces_in(&self, cells: &[Range<usize>; D]) -> Vec<InterlayerFace> {
        let grid = &self.grid;
        let (mut faces, mut end) = (Vec::new(), 0);
        let across: [_; D] = std::array::from_fn(|axis| self.interlayers_across(axis));
        for layer in cells[D - 1].clone() {
            let mut in_layer = cells.clone();
            in_layer[D - 1] = layer..layer + 1;
            let in_layer = Region::from_box(grid.cells, in_layer);
            for (axis, interlayers) in across.iter().enumerate() {
                let Some(interlayers) = interlayers else { continue };
                let variables = interlayers.history_variables(self.media[0].pairs[axis].len());
                let stride: usize = grid.cells[..axis].iter().product();
                for cell in in_layer.owned_global_cell_iter() {
                    let plane = interlayers.plane(cell / stride % grid.cells[axis]);
                    let law =
                        plane.and_then(|plane| plane.law(face_in_plane(&grid.cells, axis, cell)));
                    let Some(law) = law else { continue };
                    let history = end..end + variables;
                    end = history.end;
                    faces.push(InterlayerFace { axis, cell, law: usize::from(law), history });
                }
            }
        }
        faces
    }

    /// Returns the state of each face of [`Self::interlayer_faces`] with a law for plane strain, for output, from the
    /// history variables of all interlayers.
    pub fn interlayer_records<T: Real>(
        &self,
        history: &[T],
    ) -> Vec<(InterlayerFace, FaceRecord<f64>)> {
        self.interlayer_records_in(&self.grid.cells.map(|count| 0..count), history)
    }

    /// Returns the states of the faces of [`Self::interlayer_faces_in`] as [`Self::interlayer_records`] does, from the
    /// history variables of these faces.
    pub(crate) fn interlayer_records_in<T: Real>(
        &self,
        cells: &[Range<usize>; D],
        history: &[T],
    ) -> Vec<(InterlayerFace, FaceRecord<f64>)> {
        let record = |face: InterlayerFace| {
            let interlayers = self.interlayers_across(face.axis)?;
            let InterlayerLaw::Plane(law, _) = interlayers.laws.get(face.law)? else { return None };
            let values = history.get(face.history.clone())?;
            let values: Vec<f64> = values.iter().map(|value| value.to_f64()).collect();
            let record = law.to_face_record(&values);
            Some((face, record))
        };
        self.interlayer_faces_in(cells).into_iter().filter_map(record).collect()
    }
}

/// Returns the lower neighbour of a cell along an axis of a grid of `cells` cells; for the first cell, the last one
/// (periodic).
pub(crate) fn lower_neighbour(cells: &[usize], axis: usize, cell: usize) -> usize {
    let (stride, count) = (cells[..axis].iter().product::<usize>(), cells[axis]);
    match cell / stride % count {
        0 => cell + (count - 1) * stride,
        _ => cell - stride,
    }
}

/// Returns the index of a cell's lower face in its plane normal to an axis.
pub(crate) fn face_in_plane(cells: &[usize], axis: usize, cell: usize) -> usize {
    let stride: usize = cells[..axis].iter().product();
    cell / (stride * cells[axis]) * stride + cell % stride
}
