//! Laws of contacts after each sweep, in lanes; see [`crate::solid::contact_law`]. Constants are by lane pattern.

use super::component_offsets::ComponentOffsets;
use super::kernel::contacts::PathContacts;
use super::layout::RowSegment;
use super::plastic_cone::{complete_plastic_cone_step, cone_lanes, load_cone, plastic_cone_lanes};
use super::{Domain, SolverReal};
use crate::simd::{LaneGroup, Number, Real, SimdKernel, Vector};
use crate::solid::contact_faces::{BOUNDARY_HISTORY, ContactConstants};
use crate::solid::contact_law::{ContactLaw, ParticleRelaxation, TensorPlaces};
use crate::solid::ghosts::BoundaryFaces;
use crate::solid::medium::Medium;
use crate::solid::problem::Problem;
use models::granular_medium::GranularContact;
use models::porous::{PlasticPoreConeLaw, PoreConeLaw, PoreLaw, PoreState};
use models::rheology::relaxation::SymmetricTensor;
use models::solid::waves::{SolidField, VelocityStressPair};
use std::ops::Range;

/// By pattern: mask of the lanes with a law, and their constants; `None` where no lane has one.
type ByPattern<C> = Vec<Option<(u16, C)>>;

/// Offsets of the fields of a law, and its constants by pattern; `None` if no medium has the law.
type LaneLaw<O, C> = Option<(O, ByPattern<C>)>;

/// Laws of contacts by lane pattern.
#[derive(Clone)]
pub(super) struct LaneContacts<T: Real> {
    /// Upper bound, exclusive, of the offsets of all fields.
    extent: usize,
    /// Offsets of the stresses.
    stress: TensorPlaces,
    /// Law of granular media, whose fields are the excess stresses.
    granular: LaneLaw<TensorPlaces, GranularContact<T::Lanes>>,
    /// Law of porous media with contact by cone, whose fields are the excess stresses.
    cone: LaneLaw<TensorPlaces, PoreConeLaw<T::Lanes>>,
    /// Law of porous media with contact by cone beside a plastic skeleton, whose fields are excess stresses and plastic
    /// strains.
    plastic_cone: LaneLaw<[TensorPlaces; 2], PlasticPoreConeLaw<T::Lanes>>,
    /// Law of porous media, whose fields are volumetric strain and closure.
    porous: LaneLaw<[usize; 2], PoreLaw<T::Lanes>>,
    /// By medium, relaxation of viscous particles over a step, whose fields are the excess stresses; empty if no medium
    /// relaxes.
    relaxations: Vec<Option<ParticleRelaxation<T>>>,
    /// Offsets of the stresses of the springs of particles with a parallel dashpot; `None` without them.
    spring_stress: Option<TensorPlaces>,
    /// Media of the lanes by pattern.
    patterns: Vec<Vec<u16>>,
    /// Constants of the faces by axis and pattern.
    faces: Vec<Vec<ContactConstants<T::Lanes>>>,
    /// Constants of the faces along rows by layer and medium, if cell lengths depend on the layer; else empty. Those of
    /// `faces` are filled from them for the row that is swept.
    row_faces: Vec<Vec<ContactConstants<T>>>,
    /// By group of the rows of all layers, the factor of porosities in sweeps across layers; empty if it is 1.
    group_factors: Vec<T>,
    /// By axis, index of the longitudinal pair of waves.
    longitudinal: Vec<usize>,
    /// Whether any medium separates at faces.
    pub(super) separates: bool,
}

impl<T: Real> LaneContacts<T> {
    /// Creates the laws in `layers` of a region of a problem (indices in the whole grid); `None` if no medium has
    /// contacts. The offset of a field is its index times `pitch`; a row has `groups` groups.
    pub(super) fn new<const D: usize>(
        problem: &Problem<D>,
        patterns: &[Vec<u16>],
        (groups, pitch): (usize, usize),
        layers: &[usize],
    ) -> Option<Self> {
        let (media, fields) = (&problem.media, &problem.fields());
        let granular: Vec<_> = media
            .iter()
            .map(|medium| match medium.contact {
                Some(ContactLaw::Granular { law, .. }) => Some(law),
                _ => None,
            })
            .collect();
        let porous: Vec<_> = media
            .iter()
            .map(|medium| match medium.contact {
                Some(ContactLaw::Porous { law, .. }) => Some(law),
                _ => None,
            })
            .collect();
        let cone: Vec<_> = media
            .iter()
            .map(|medium| match medium.contact {
                Some(ContactLaw::PorousCone { law, .. }) => Some(law),
                _ => None,
            })
            .collect();
        let plastic_cone: Vec<_> = media
            .iter()
            .map(|medium| match medium.contact {
                Some(ContactLaw::PorousPlasticCone { law, .. }) => Some(law),
                _ => None,
            })
            .collect();
        let plastic_strain = TensorPlaces::find(fields, SolidField::PlasticStrain);
        let spring_stress = TensorPlaces::find(fields, SolidField::SpringStress);
        let excess = TensorPlaces::find(fields, SolidField::ExcessStress);
        let place = |field| Some(fields.iter().position(|own| *own == field)? * pitch);
        let history = place(SolidField::VolumetricStrain)
            .zip(place(SolidField::PoreClosure))
            .map(<[_; 2]>::from);
        if excess.is_none() && history.is_none() {
            return None;
        }
        let face_constants = |axis: usize| {
            let by_medium = ContactConstants::<T>::by_medium(problem, axis);
            let pattern_constants = |pattern: &Vec<u16>| {
                ContactConstants::group(|lane| by_medium[usize::from(pattern[lane])])
            };
            patterns.iter().map(pattern_constants).collect()
        };
        let longitudinal = |axis: usize| {
            let mut pairs = media[0].pairs[axis].iter();
            pairs.position(VelocityStressPair::is_longitudinal)
        };
        let relaxation = |medium: &Medium| {
            let law = medium.contact?.relaxation(problem.step)?;
            Some(law.map(T::from_f64))
        };
        let mut relaxations: Vec<_> = media.iter().map(relaxation).collect();
        if relaxations.iter().all(Option::is_none) {
            relaxations.clear();
        }
        let group_factors = match problem.has_field_factors() {
            true => {
                let factor = |layer: &usize| T::from_f64(problem.field_factor(*layer));
                layers.iter().flat_map(|layer| vec![factor(layer); groups]).collect()
            }
            false => Vec::new(),
        };
        Some(Self {
            extent: (fields.len() - 1) * pitch + 1,
            separates: problem.separates(),
            relaxations,
            spring_stress: spring_stress.map(|places| places.scaled(pitch)),
            patterns: patterns.to_vec(),
            faces: (0..D).map(face_constants).collect(),
            row_faces: ContactConstants::by_layer(problem, layers.iter().copied()),
            group_factors,
            longitudinal: (0..D).map(longitudinal).collect::<Option<_>>()?,
            stress: TensorPlaces::find(fields, SolidField::Stress)?.scaled(pitch),
            granular: excess.clone().map(|places| {
                let constants = |pattern: &Vec<u16>, first: GranularContact<f64>| {
                    let law = |lane: usize| granular[usize::from(pattern[lane])].unwrap_or(first);
                    granular_lanes::<T>(law)
                };
                (places.scaled(pitch), by_pattern(patterns, &granular, constants))
            }),
            plastic_cone: excess.clone().zip(plastic_strain).map(|(excess, strain)| {
                let constants = |pattern: &Vec<u16>, first: PlasticPoreConeLaw<f64>| {
                    let law =
                        |lane: usize| plastic_cone[usize::from(pattern[lane])].unwrap_or(first);
                    plastic_cone_lanes::<T>(law)
                };
                let places = [excess, strain].map(|own| own.scaled(pitch));
                (places, by_pattern(patterns, &plastic_cone, constants))
            }),
            cone: excess.map(|places| {
                let constants = |pattern: &Vec<u16>, first: PoreConeLaw<f64>| {
                    let law = |lane: usize| cone[usize::from(pattern[lane])].unwrap_or(first);
                    cone_lanes::<T>(law)
                };
                (places.scaled(pitch), by_pattern(patterns, &cone, constants))
            }),
            porous: history.map(|places| {
                let constants = |pattern: &Vec<u16>, first: PoreLaw<f64>| {
                    let law = |lane: usize| porous[usize::from(pattern[lane])].unwrap_or(first);
                    let lanes = |of: fn(&PoreLaw<f64>) -> f64| {
                        T::Lanes::from_lanes(|lane| T::from_f64(of(&law(lane))))
                    };
                    PoreLaw {
                        skeleton_modulus: lanes(|own| own.skeleton_modulus),
                        contact_modulus: lanes(|own| own.contact_modulus),
                        closed_compliance: lanes(|own| own.closed_compliance),
                        porosity: lanes(|own| own.porosity),
                    }
                };
                (places, by_pattern(patterns, &porous, constants))
            }),
        })
    }
}

/// Returns the constants of granular media by lane.
pub(super) fn granular_lanes<T: Real>(
    law: impl Fn(usize) -> GranularContact<f64>,
) -> GranularContact<T::Lanes> {
    let lanes = |of: fn(&GranularContact<f64>) -> f64| {
        T::Lanes::from_lanes(|lane| T::from_f64(of(&law(lane))))
    };
    GranularContact {
        bulk_modulus: lanes(|own| own.bulk_modulus),
        energy_modulus: lanes(|own| own.energy_modulus),
        intensity_factor: lanes(|own| own.intensity_factor),
        friction: lanes(|own| own.friction),
        yield_stress: lanes(|own| own.yield_stress),
        corner_pressure: lanes(|own| own.corner_pressure),
        compliances: [
            lanes(|own| own.compliances[0]),
            lanes(|own| own.compliances[1]),
            lanes(|own| own.compliances[2]),
        ],
    }
}

impl<T: Real> LaneContacts<T> {
    /// Fills the constants of the faces along rows for the row of a layer, by the media of the lanes of a pattern.
    pub(super) fn fill_row_faces(&mut self, layer: usize, pattern: usize, media: &[u16]) {
        let Some(by_medium) = self.row_faces.get(layer) else { return };
        let lanes = &mut self.faces[0][pattern];
        for (lane, medium) in media.iter().enumerate() {
            ContactConstants::set_lane(lanes, lane, &by_medium[usize::from(*medium)]);
        }
    }
}

/// Returns by pattern the mask of the lanes with a law, and their constants; `None` where no lane has one. Lanes without
/// a law have the constants of the first law.
fn by_pattern<L: Copy, C>(
    patterns: &[Vec<u16>],
    laws: &[Option<L>],
    constants: impl Fn(&Vec<u16>, L) -> C,
) -> ByPattern<C> {
    let pattern_constants = |pattern: &Vec<u16>| {
        let law = |lane: usize| laws[usize::from(pattern[lane])];
        let first = (0..pattern.len()).find_map(law)?;
        let mask = (0..pattern.len()).map(|lane| u16::from(law(lane).is_some()) << lane).sum();
        Some((mask, constants(pattern, first)))
    };
    patterns.iter().map(pattern_constants).collect()
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the contacts at the faces of sweeps along an axis; `None` if the faces are those of elastic media.
    pub(super) fn path_contacts(
        &self,
        axis: usize,
        half_step: usize,
    ) -> Option<PathContacts<'_, T>> {
        let LaneContacts {
            granular, porous, faces, group_factors, longitudinal, separates, ..
        } = self.lane_laws.contacts.as_ref()?;
        let excess = granular.as_ref().map(|own| &own.0).filter(|_| *separates);
        if excess.is_none() && porous.is_none() {
            return None;
        }
        let boundary_value = |boundary: &BoundaryFaces<T>| match boundary {
            BoundaryFaces::Physical(_) => Some(T::from_f64(BOUNDARY_HISTORY)),
            BoundaryFaces::Periodic | BoundaryFaces::HaloEnd => None,
        };
        Some(PathContacts {
            constants: &faces[axis],
            // Constants along rows already have the factors of the layer.
            group_factors: if axis + 1 == D { group_factors } else { &[] },
            volumetric_strain: porous.as_ref().map(|own| own.0[0]),
            excess,
            longitudinal: longitudinal[axis],
            boundary_values: self.boundaries.faces[half_step][axis].each_ref().map(boundary_value),
        })
    }

    /// Completes the elastic step of a sweep in rows of a layer, in all media with contacts.
    pub(super) fn apply_contact_laws(&mut self, layer: usize, rows: &Range<usize>) {
        if self.lane_laws.contacts.is_none() || rows.is_empty() {
            return;
        }
        for row in rows.clone() {
            let tile = self.layout.row_segment(row);
            self.apply_contact_laws_to_segment(layer, &tile);
        }
    }

    /// Relaxes the stresses of viscous particles in contact over a step, cell by cell.
    pub(super) fn relax_contacts(&mut self, layers: &Range<usize>, tile: &RowSegment) {
        let Some(contacts) = &self.lane_laws.contacts else { return };
        if contacts.relaxations.is_empty() {
            return;
        }
        for layer in layers.clone() {
            let (first, groups) = self.layout.segment_groups(layer, tile);
            let factor = T::from_f64(self.lane_laws.field_factor(layer));
            for (index, group) in groups.enumerate() {
                let pattern = self.materials.lane_pattern_indices[group] as usize;
                let fields = &mut self.field_data[first + index..];
                for (lane, medium) in contacts.patterns[pattern].iter().enumerate() {
                    let Some(law) = &contacts.relaxations[usize::from(*medium)] else { continue };
                    let law = &law.with_field_factor(factor);
                    let loss = match D {
                        2 => contacts.relax_lane::<1>(fields, lane, law),
                        _ => contacts.relax_lane::<3>(fields, lane, law),
                    };
                    self.diagnostics.dissipation.viscous_dissipation
                        [group * T::Lanes::COUNT + lane] += loss;
                }
            }
        }
    }

    /// Completes the elastic step in a segment of a row of a layer.
    pub(super) fn apply_contact_laws_to_segment(&mut self, layer: usize, tile: &RowSegment) {
        let Some(contacts) = &self.lane_laws.contacts else { return };
        let (first, groups) = self.layout.segment_groups(layer, tile);
        let lanes = T::Lanes::COUNT;
        let tile_lanes = groups.start * lanes..groups.end * lanes;
        let dissipation = &mut self.diagnostics.dissipation.plastic_dissipation;
        self.instructions.run_kernel::<T>(ContactKernel {
            field_data: &mut self.field_data[first..],
            lane_pattern_indices: &self.materials.lane_pattern_indices[groups],
            contacts,
            field_factor: T::from_f64(self.lane_laws.field_factor(layer)),
            plastic_dissipation: dissipation.get_mut(tile_lanes).unwrap_or(&mut []),
        });
    }
}

impl<T: Real> LaneContacts<T> {
    /// Relaxes the stress in a lane of a group; returns the energy lost, J/m³.
    fn relax_lane<const SHEAR_COUNT: usize>(
        &self,
        group: &mut [T::Lanes],
        lane: usize,
        law: &ParticleRelaxation<T>,
    ) -> f64 {
        let Some((excess_places, _)) = &self.granular else { return 0.0 };
        let read = |places: &TensorPlaces| {
            places.read::<T, SHEAR_COUNT>(|place| group[place].lanes()[lane])
        };
        let spring = self.spring_stress.as_ref();
        let before = [read(&self.stress), read(excess_places)];
        let spring_before = spring.map_or(SymmetricTensor::ZERO, read);
        let ([stress, excess, spring_after], loss) =
            law.apply([before[0], before[1], spring_before]);
        let of_spring = spring.map(|places| (places, spring_after));
        let pairs = [(&self.stress, stress), (excess_places, excess)];
        for (places, tensor) in pairs.into_iter().chain(of_spring) {
            let normal = places.normal.iter().zip(tensor.normal);
            for (&place, value) in normal.chain(places.shear.iter().zip(tensor.shear)) {
                group[place].lanes_mut()[lane] = value;
            }
        }
        loss.to_f64()
    }
}

/// Kernel: laws of contacts in adjacent groups of a row.
struct ContactKernel<'a, T: Real> {
    /// Field values from the first of these groups on.
    field_data: &'a mut [T::Lanes],
    lane_pattern_indices: &'a [u32],
    contacts: &'a LaneContacts<T>,
    /// Ratio of the fields of the row to the physical fields, with which thresholds are multiplied.
    field_factor: T,
    /// Accumulated plastic dissipation by group and lane, J/m³; empty if no medium is plastic.
    plastic_dissipation: &'a mut [f64],
}

impl<T: Real> SimdKernel<T> for ContactKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { field_data, lane_pattern_indices, contacts, field_factor, plastic_dissipation } =
            self;
        let LaneContacts { extent, stress, granular, cone, plastic_cone, porous, .. } = contacts;
        let extent = *extent;
        let factor = <V as Vector<T>>::splat(field_factor);
        if let Some((places, by_pattern)) = porous {
            let mut start = 0;
            while let Some((groups, lanes, law)) = next_run(start, lane_pattern_indices, by_pattern)
            {
                start = groups.end;
                let law = PoreLaw {
                    skeleton_modulus: V::load(&law.skeleton_modulus),
                    contact_modulus: V::load(&law.contact_modulus),
                    closed_compliance: V::load(&law.closed_compliance),
                    porosity: factor * V::load(&law.porosity),
                };
                for index in groups {
                    let group = &mut field_data[index..];
                    complete_pore_step::<T, V>(group, lanes, &law, stress, places);
                }
            }
        }
        if let Some((places, by_pattern)) = cone {
            let mut start = 0;
            while let Some((groups, lanes, law)) = next_run(start, lane_pattern_indices, by_pattern)
            {
                start = groups.end;
                let mut law = load_cone::<T, V>(law);
                law.offset = factor * law.offset;
                let data = &mut field_data[groups.start..];
                let tensors = ([stress, places], extent);
                match stress.shear.len() {
                    1 => complete_cone_steps::<T, V, 1>(data, groups.len(), lanes, &law, tensors),
                    _ => complete_cone_steps::<T, V, 3>(data, groups.len(), lanes, &law, tensors),
                }
            }
        }
        if let Some((places, by_pattern)) = granular {
            let all_lanes = u16::MAX >> (u16::BITS as usize - T::Lanes::COUNT);
            let mut start = 0;
            while let Some((groups, lanes, law)) = next_run(start, lane_pattern_indices, by_pattern)
            {
                start = groups.end;
                let mut law: GranularContact<V> = load_granular::<T, V>(law);
                law.yield_stress = factor * law.yield_stress;
                law.corner_pressure = factor * law.corner_pressure;
                let sums = plastic_dissipation
                    .get_mut(groups.start * T::Lanes::COUNT..groups.end * T::Lanes::COUNT)
                    .unwrap_or(&mut []);
                let data = &mut field_data[groups.start..];
                let own = (groups.len(), lanes);
                let tensors = ([stress, places], extent);
                let is_plane = stress.shear.len() == 1;
                match (is_plane, lanes == all_lanes) {
                    (true, true) => {
                        complete_granular_steps::<T, V, 1, true>(data, own, &law, tensors, sums)
                    }
                    (true, false) => {
                        complete_granular_steps::<T, V, 1, false>(data, own, &law, tensors, sums)
                    }
                    (false, true) => {
                        complete_granular_steps::<T, V, 3, true>(data, own, &law, tensors, sums)
                    }
                    (false, false) => {
                        complete_granular_steps::<T, V, 3, false>(data, own, &law, tensors, sums)
                    }
                }
            }
        }
        if let Some(([excess, strain], by_pattern)) = plastic_cone {
            let tensors = ([stress, excess, strain], extent);
            for (index, &pattern) in lane_pattern_indices.iter().enumerate() {
                let Some((lanes, law)) = &by_pattern[pattern as usize] else { continue };
                let (group, law) = (&mut field_data[index..], (law, factor));
                let dissipated = match stress.shear.len() {
                    1 => complete_plastic_cone_step::<T, V, 1>(group, *lanes, law, tensors),
                    _ => complete_plastic_cone_step::<T, V, 3>(group, *lanes, law, tensors),
                };
                let sums = plastic_dissipation.get_mut(index * T::Lanes::COUNT..);
                for (sum, own) in sums.unwrap_or(&mut []).iter_mut().zip(dissipated.lanes()) {
                    *sum += own.to_f64();
                }
            }
        }
    }
}

/// Returns the next run of adjacent groups with the same pattern from group `start` on whose lanes have a law, the mask of
/// these lanes, and the constants of the law.
#[inline(always)]
fn next_run<'a, C>(
    mut start: usize,
    lane_pattern_indices: &[u32],
    by_pattern: &'a [Option<(u16, C)>],
) -> Option<(Range<usize>, u16, &'a C)> {
    while let Some(&pattern) = lane_pattern_indices.get(start) {
        let mut end = start + 1;
        while lane_pattern_indices.get(end) == Some(&pattern) {
            end += 1;
        }
        if let Some((lanes, law)) = &by_pattern[pattern as usize] {
            return Some((start..end, *lanes, law));
        }
        start = end;
    }
    None
}

#[inline(always)]
fn complete_pore_step<T: Real, V: Vector<T>>(
    group: &mut [T::Lanes],
    lanes: u16,
    law: &PoreLaw<V>,
    stress: &TensorPlaces,
    [strain, closure]: &[usize; 2],
) {
    let [a, b, c] = stress.normal;
    let normal = [V::load(&group[a]), V::load(&group[b]), V::load(&group[c])];
    let before = PoreState {
        volumetric_strain: V::load(&group[*strain]),
        closure: V::load(&group[*closure]),
    };
    let mean_stress = V::THIRD * (normal[0] + normal[1] + normal[2]);
    let step = law.complete_step(mean_stress, before);
    for i in 0..3 {
        let value = normal[i] + step.mean_stress_change;
        normal[i].blend_lanes(lanes, value).store(&mut group[stress.normal[i]]);
    }
    let strain_after = step.state.volumetric_strain;
    before.volumetric_strain.blend_lanes(lanes, strain_after).store(&mut group[*strain]);
    before.closure.blend_lanes(lanes, step.state.closure).store(&mut group[*closure]);
}

#[inline(always)]
pub(super) fn load_granular<T: Real, V: Vector<T>>(
    law: &GranularContact<T::Lanes>,
) -> GranularContact<V> {
    GranularContact {
        bulk_modulus: V::load(&law.bulk_modulus),
        energy_modulus: V::load(&law.energy_modulus),
        intensity_factor: V::load(&law.intensity_factor),
        friction: V::load(&law.friction),
        yield_stress: V::load(&law.yield_stress),
        corner_pressure: V::load(&law.corner_pressure),
        compliances: [
            V::load(&law.compliances[0]),
            V::load(&law.compliances[1]),
            V::load(&law.compliances[2]),
        ],
    }
}

#[inline(always)]
fn complete_cone_steps<T: Real, V: Vector<T>, const SHEAR_COUNT: usize>(
    field_data: &mut [T::Lanes],
    groups: usize,
    lanes: u16,
    law: &PoreConeLaw<V>,
    ([stress_places, excess_places], extent): ([&TensorPlaces; 2], usize),
) {
    let stress_offsets = ComponentOffsets::<SHEAR_COUNT>::new(stress_places, extent);
    let excess_offsets = ComponentOffsets::<SHEAR_COUNT>::new(excess_places, extent);
    for index in 0..groups {
        let group = &mut field_data[index..];
        let stress: SymmetricTensor<V, SHEAR_COUNT> = stress_offsets.load(group);
        let excess: SymmetricTensor<V, SHEAR_COUNT> = excess_offsets.load(group);
        let step = law.complete_step(stress, excess);
        stress_offsets.store(group, lanes, &stress, &step.stress);
        excess_offsets.store(group, lanes, &excess, &step.excess);
    }
}

/// Completes the step of adjacent groups, and adds the plastic dissipation, J/m³, to `sums` unless it is empty. `IS_FULL`:
/// all lanes have the law.
#[inline(always)]
fn complete_granular_steps<T: Real, V: Vector<T>, const SHEAR_COUNT: usize, const IS_FULL: bool>(
    field_data: &mut [T::Lanes],
    (groups, lanes): (usize, u16),
    law: &GranularContact<V>,
    ([stress_places, excess_places], extent): ([&TensorPlaces; 2], usize),
    sums: &mut [f64],
) {
    let stress_offsets = ComponentOffsets::<SHEAR_COUNT>::new(stress_places, extent);
    let excess_offsets = ComponentOffsets::<SHEAR_COUNT>::new(excess_places, extent);
    for index in 0..groups {
        let group = &mut field_data[index..];
        let stress: SymmetricTensor<V, SHEAR_COUNT> = stress_offsets.load(group);
        let excess: SymmetricTensor<V, SHEAR_COUNT> = excess_offsets.load(group);
        let step = law.complete_step(stress, excess);
        match IS_FULL {
            true => {
                stress_offsets.store_all(group, &step.stress);
                excess_offsets.store_all(group, &step.excess);
            }
            false => {
                stress_offsets.store(group, lanes, &stress, &step.stress);
                excess_offsets.store(group, lanes, &excess, &step.excess);
            }
        }
        if !sums.is_empty() {
            let mut dissipated = T::Lanes::ZERO;
            let own = match IS_FULL {
                true => step.plastic_dissipation,
                false => V::ZERO.blend_lanes(lanes, step.plastic_dissipation),
            };
            own.store(&mut dissipated);
            let sums = &mut sums[index * T::Lanes::COUNT..][..T::Lanes::COUNT];
            for (sum, own) in sums.iter_mut().zip(dissipated.lanes()) {
                *sum += own.to_f64();
            }
        }
    }
}
