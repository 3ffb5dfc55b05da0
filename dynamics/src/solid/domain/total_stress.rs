//! Yield sets and initial stresses in SIMD lanes of double precision, for the return mapping of total stresses.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use crate::simd::{LaneGroup, Number, Real, Vector};
use crate::solid::medium::Medium;
use models::solid::parameters::Isotropic;
use models::solid::stress::{Stress, StressShape, Tensor};
use models::solid::waves::SolidField;
use models::yield_set::parameters::Mises;
use models::yield_set::return_mapping::{Cone, EIGENSPACE_COUNT};

/// Block: a group of lanes in double precision. A group in single precision corresponds to two blocks.
pub(super) type DoubleLanes = <f64 as Real>::Lanes;

/// Number of lanes of a block.
pub(super) const BLOCK_LANES: usize = 8;

/// Returns the number of blocks of a group.
pub(super) const fn blocks_per_group<T: Real>() -> usize {
    T::Lanes::COUNT / BLOCK_LANES
}

/// Force stress and couple stress.
pub(super) type StressTensors<N> = [Tensor<N>; 2];

/// Strength beyond any stress, Pa, whose products do not overflow.
const UNBOUNDED_STRENGTH: f64 = 1e120;

/// Yield sets for total stresses, by lane pattern.
#[derive(Clone, Default, PartialEq)]
pub(super) struct TotalStressSets {
    pub(super) shape: StressShape,
    /// Index of the field of each component of force and couple stress; in classical solids one field stands for the
    /// components ij and ji.
    pub(super) component_fields: StressTensors<Option<usize>>,
    /// Index of the field of each component that is stored: as `component_fields`, without the transposed component ji
    /// of a field that stands for ij and ji.
    pub(super) stored_fields: StressTensors<Option<usize>>,
    /// Flags of the eigenspaces of the stress with a nonzero weight in any cone.
    pub(super) active_eigenspaces: [bool; EIGENSPACE_COUNT],
    /// Constants by lane pattern, then by block of a group.
    pub(super) blocks: Vec<BlockConstants>,
}

/// Constants of the lanes of a block.
#[derive(Clone, PartialEq)]
pub(super) struct BlockConstants {
    pub(super) media: [u16; BLOCK_LANES],
    /// Mask of the lanes with a cone.
    pub(super) cone_lanes: u16,
    pub(super) cone: Cone<DoubleLanes>,
    /// Elastic moduli, see [`Isotropic::energy_moduli`].
    pub(super) moduli: [[DoubleLanes; 3]; 2],
    pub(super) half_spaces: Vec<BlockHalfSpace>,
    /// Mask of the lanes whose yield set is neither a cone nor a polyhedron.
    pub(super) other_lanes: u16,
}

/// Half-space n·s ≤ k in lanes.
#[derive(Clone, PartialEq)]
pub(super) struct BlockHalfSpace {
    /// Indices \[force or couple stress, i, j\] of components, as in [`TotalStressSets::component_fields`], and
    /// components of n.
    pub(super) normal: Vec<([usize; 3], DoubleLanes)>,
    pub(super) strength: DoubleLanes,
}

/// Initial stress in lanes.
#[derive(Clone)]
pub(super) struct InitialStress(pub(super) StressTensors<DoubleLanes>);

impl InitialStress {
    /// Returns the same stress in all lanes.
    pub(super) fn from_uniform(stress: &Stress) -> Self {
        Self::from_lanes(|_| *stress)
    }

    /// Returns the stress `stress(lane)` in each lane.
    pub(super) fn from_lanes(stress: impl Fn(usize) -> Stress) -> Self {
        let lanes: [Stress; BLOCK_LANES] = std::array::from_fn(stress);
        let tensor = |of: fn(&Stress) -> &Tensor<f64>| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| DoubleLanes::from_lanes(|lane| of(&lanes[lane])[i][j]))
            })
        };
        Self([tensor(|own| &own.force), tensor(|own| &own.couple)])
    }

    /// Returns the stress of a lane.
    pub(super) fn lane_stress(&self, lane: usize) -> Stress {
        let [force, couple] =
            self.0.each_ref().map(|own| own.map(|row| row.map(|lanes| lanes.lanes()[lane])));
        Stress { force, couple }
    }
}

/// Returns the initial stress by block of a row of `groups` groups, from the stress by layer normal to the first axis.
pub(super) fn create_initial_stress_blocks<T: Real>(
    layers: &[Stress],
    groups: usize,
) -> Vec<InitialStress> {
    let block_positions =
        (0..groups).flat_map(|group| (0..blocks_per_group::<T>()).map(move |half| (group, half)));
    let block_stress = |(group, half): (usize, usize)| {
        let cell = move |lane: usize| (half * BLOCK_LANES + lane) * groups + group;
        InitialStress::from_lanes(|lane| layers.get(cell(lane)).copied().unwrap_or_default())
    };
    block_positions.map(block_stress).collect()
}

impl BlockConstants {
    fn new(media: &[Medium], lanes: &[u16]) -> Self {
        let medium_of = |lane: usize| &media[usize::from(lanes[lane])];
        let cone_of = |lane: usize| {
            let medium = medium_of(lane);
            let set = medium.yield_set.as_ref()?.downcast::<Mises>()?;
            Some(Cone::new(set, medium.law.downcast::<Isotropic>()?))
        };
        let cones_by_lane: [Option<Cone<f64>>; BLOCK_LANES] = std::array::from_fn(cone_of);
        let half_spaces_of = |lane: usize| match (&cones_by_lane[lane], &medium_of(lane).yield_set)
        {
            (None, Some(set)) => set.half_spaces(),
            _ => None,
        };
        let polyhedra: Vec<_> = (0..BLOCK_LANES).map(half_spaces_of).collect();
        let lane_mask = |has_property: &dyn Fn(usize) -> bool| {
            (0..BLOCK_LANES).map(|lane| u16::from(has_property(lane)) << lane).sum::<u16>()
        };
        let max_count = polyhedra.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let half_space = |index: usize| {
            let half_space_of = |lane: usize| {
                polyhedra[lane].as_ref().and_then(|half_spaces| half_spaces.get(index))
            };
            let lanes = |which: usize, i: usize, j: usize| {
                DoubleLanes::from_lanes(|lane| {
                    half_space_of(lane)
                        .map_or(0.0, |half_space| to_tensors(&half_space.0.normal)[which][i][j])
                })
            };
            let components = (0..18).map(|number| [number / 9, number / 3 % 3, number % 3]);
            let normal = components.map(|own| (own, lanes(own[0], own[1], own[2])));
            BlockHalfSpace {
                normal: normal.filter(|own| own.1 != DoubleLanes::ZERO).collect(),
                strength: DoubleLanes::from_lanes(|lane| {
                    half_space_of(lane).map_or(UNBOUNDED_STRENGTH, |own| own.1)
                }),
            }
        };
        let cones = cones_by_lane
            .map(|own| own.unwrap_or(Cone::with_unreachable_strength(UNBOUNDED_STRENGTH)));
        let moduli: [[[f64; 3]; 2]; BLOCK_LANES] = std::array::from_fn(|lane| {
            medium_of(lane)
                .law
                .downcast::<Isotropic>()
                .map_or([[1.0; 3]; 2], Isotropic::energy_moduli)
        });
        Self {
            media: std::array::from_fn(|lane| lanes[lane]),
            cone_lanes: lane_mask(&|lane| cones_by_lane[lane].is_some()),
            cone: Cone::from_coefficients(|value| {
                DoubleLanes::from_lanes(|lane| value(&cones[lane]))
            }),
            moduli: std::array::from_fn(|which| {
                std::array::from_fn(|part| {
                    DoubleLanes::from_lanes(|lane| moduli[lane][which][part])
                })
            }),
            half_spaces: (0..max_count).map(half_space).collect(),
            other_lanes: lane_mask(&|lane| {
                medium_of(lane).yield_set.is_some()
                    && cones_by_lane[lane].is_none()
                    && polyhedra[lane].is_none()
            }),
        }
    }
}

/// Returns force and couple stress of a stress.
pub(super) fn to_tensors(stress: &Stress) -> StressTensors<f64> {
    [stress.force, stress.couple]
}

impl TotalStressSets {
    /// Creates the yield sets of all lane patterns. The shape of the stresses follows from `media` and all `initial`
    /// stresses.
    pub(super) fn new(media: &[Medium], patterns: &[Vec<u16>], initial: &[Stress]) -> Self {
        let fields = &media[0].fields;
        let index = |field: SolidField| fields.iter().position(|own| *own == field);
        let is_symmetric = media[0].rotation.is_none();
        let find_fields = |which: usize, mirrors: bool| -> Tensor<Option<usize>> {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let field_index = |i, j| match which {
                        0 => index(SolidField::Stress(i, j)),
                        _ => index(SolidField::Couple(i, j)),
                    };
                    field_index(i, j).or_else(|| field_index(j, i).filter(|_| mirrors))
                })
            })
        };
        let [component_fields, stored_fields] =
            [is_symmetric, false].map(|mirrors| [0, 1].map(|which| find_fields(which, mirrors)));
        let is_zero = |which: usize, i: usize, j: usize| {
            let is_zero = |own: &Stress| to_tensors(own)[which][i][j] == 0.0;
            component_fields[which][i][j].is_none() && initial.iter().all(is_zero)
        };
        let mut shape = StressShape {
            is_symmetric: is_symmetric
                && initial.iter().all(|own| {
                    let same =
                        |i: usize, j: usize| own.force[i][j].to_bits() == own.force[j][i].to_bits();
                    same(0, 1) && same(0, 2) && same(1, 2)
                }),
            is_plane: (0..18).all(|number| {
                let [which, i, j] = [number / 9, number / 3 % 3, number % 3];
                ((i == 2) != (j == 2)) == (which == 1) || is_zero(which, i, j)
            }),
            has_couples: component_fields[1] != [[None; 3]; 3]
                || initial.iter().any(|own| own.couple != [[0.0; 3]; 3]),
        };
        // Four shapes have separate compiled loops; other shapes are treated as unsymmetric stresses with couple
        // stresses.
        if !shape.is_symmetric || shape.has_couples {
            shape = StressShape { is_symmetric: false, has_couples: true, ..shape };
        }
        let blocks: Vec<BlockConstants> = patterns
            .iter()
            .flat_map(|pattern| {
                pattern.chunks(BLOCK_LANES).map(|lanes| BlockConstants::new(media, lanes))
            })
            .collect();
        let mut active_eigenspaces = [false; EIGENSPACE_COUNT];
        for block in &blocks {
            for (active_eigenspaces, weights) in
                active_eigenspaces.iter_mut().zip(&block.cone.half_weights)
            {
                *active_eigenspaces |= weights.lanes().iter().any(|weight| *weight > 0.0);
            }
        }
        Self { shape, component_fields, stored_fields, active_eigenspaces, blocks }
    }
}

/// Loads force and couple stress into registers.
#[inline(always)]
pub(super) fn load_tensors<V: Vector<f64>>(
    tensors: &StressTensors<DoubleLanes>,
) -> StressTensors<V> {
    let mut loaded = [[[V::ZERO; 3]; 3]; 2];
    for which in 0..2 {
        for i in 0..3 {
            for j in 0..3 {
                loaded[which][i][j] = V::load(&tensors[which][i][j]);
            }
        }
    }
    loaded
}

/// Loads elastic moduli into registers.
#[inline(always)]
pub(super) fn load_moduli<V: Vector<f64>>(moduli: &[[DoubleLanes; 3]; 2]) -> [[V; 3]; 2] {
    let mut loaded = [[V::ZERO; 3]; 2];
    for which in 0..2 {
        for part in 0..3 {
            loaded[which][part] = V::load(&moduli[which][part]);
        }
    }
    loaded
}

/// Loads the coefficients of a cone into registers.
#[inline(always)]
pub(super) fn load_cone<V: Vector<f64>>(cone: &Cone<DoubleLanes>) -> Cone<V> {
    let [mut half_weights, mut stiffnesses, mut rates] = [[V::ZERO; EIGENSPACE_COUNT]; 3];
    for part in 0..EIGENSPACE_COUNT {
        half_weights[part] = V::load(&cone.half_weights[part]);
        stiffnesses[part] = V::load(&cone.stiffnesses[part]);
        rates[part] = V::load(&cone.weighted_stiffnesses[part]);
    }
    let [force, couple] = &cone.rounding_weights;
    Cone {
        strength: V::load(&cone.strength),
        friction: V::load(&cone.friction),
        mean_drop: V::load(&cone.mean_drop),
        a: V::load(&cone.a),
        half_weights,
        stiffnesses,
        weighted_stiffnesses: rates,
        rounding_weights: [V::load(force), V::load(couple)],
    }
}
