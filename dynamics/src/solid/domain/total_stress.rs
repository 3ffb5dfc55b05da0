//! Yield sets and initial stresses in lanes of double precision, for the return mapping of total stresses.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use crate::simd::{Group, Number, Real, Vector};
use crate::solid::medium::Medium;
use models::solid::parameters::Isotropic;
use models::solid::stress::{Shape, Stress, Tensor};
use models::solid::waves::Field;
use models::yield_set::parameters::Mises;
use models::yield_set::return_mapping::{Cone, PARTS};

/// Block: lanes of double precision. A group in single precision has two blocks.
pub(super) type Wide = <f64 as Real>::Lanes;

/// Number of lanes of a block.
pub(super) const WIDTH: usize = 8;

/// Returns the number of blocks of a group.
pub(super) const fn blocks_per_group<T: Real>() -> usize {
    T::Lanes::COUNT / WIDTH
}

/// Force and couple stress.
pub(super) type Tensors<N> = [Tensor<N>; 2];

/// Strength beyond any stress, whose products do not overflow.
const UNBOUNDED: f64 = 1e120;

/// Yield sets for total stresses, by lane pattern.
#[derive(Clone, Default, PartialEq)]
pub(super) struct TotalStressSets {
    pub(super) shape: Shape,
    /// Field of each component of force and couple stress; one field stands for both ij and ji in classical solids.
    pub(super) places: Tensors<Option<usize>>,
    /// Fields of the components that are stored: without the mirrored ones.
    pub(super) targets: Tensors<Option<usize>>,
    /// Parts of the stress with a nonzero weight in any cone.
    pub(super) seen: [bool; PARTS],
    /// By pattern, then by block of a group.
    pub(super) blocks: Vec<Block>,
}

/// Constants of the lanes of a block.
#[derive(Clone, PartialEq)]
pub(super) struct Block {
    pub(super) media: [u16; WIDTH],
    /// Mask of the lanes with a cone.
    pub(super) cones: u16,
    pub(super) cone: Cone<Wide>,
    /// See [`Isotropic::energy_moduli`].
    pub(super) moduli: [[Wide; 3]; 2],
    pub(super) half_spaces: Vec<HalfSpace>,
    /// Mask of the lanes whose yield set is neither a cone nor a polyhedron.
    pub(super) others: u16,
}

/// Half-space n·s ≤ k in lanes.
#[derive(Clone, PartialEq)]
pub(super) struct HalfSpace {
    /// Indices of components, as in [`TotalStressSets::places`], and components of n.
    pub(super) normal: Vec<([usize; 3], Wide)>,
    pub(super) strength: Wide,
}

/// Initial stress in lanes.
#[derive(Clone)]
pub(super) struct InitialStress(pub(super) Tensors<Wide>);

impl InitialStress {
    /// Returns the same stress in all lanes.
    pub(super) fn uniform(stress: &Stress) -> Self {
        Self::by_lane(|_| *stress)
    }

    /// Returns the stress `stress(lane)` in each lane.
    pub(super) fn by_lane(stress: impl Fn(usize) -> Stress) -> Self {
        let lanes: [Stress; WIDTH] = std::array::from_fn(stress);
        let tensor = |of: fn(&Stress) -> &Tensor<f64>| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| Wide::by_lane(|lane| of(&lanes[lane])[i][j]))
            })
        };
        Self([tensor(|own| &own.force), tensor(|own| &own.couple)])
    }

    /// Returns the stress of a lane.
    pub(super) fn of(&self, lane: usize) -> Stress {
        let [force, couple] =
            self.0.each_ref().map(|own| own.map(|row| row.map(|lanes| lanes.lanes()[lane])));
        Stress { force, couple }
    }
}

/// Returns the initial stress by block of a row of `groups` groups, from the stress by layer across the first axis.
pub(super) fn initial_blocks<T: Real>(layers: &[Stress], groups: usize) -> Vec<InitialStress> {
    let places =
        (0..groups).flat_map(|group| (0..blocks_per_group::<T>()).map(move |half| (group, half)));
    let at = |(group, half): (usize, usize)| {
        let cell = move |lane: usize| (half * WIDTH + lane) * groups + group;
        InitialStress::by_lane(|lane| layers.get(cell(lane)).copied().unwrap_or_default())
    };
    places.map(at).collect()
}

impl Block {
    fn new(media: &[Medium], lanes: &[u16]) -> Self {
        let own = |lane: usize| &media[usize::from(lanes[lane])];
        let cone_of = |lane: usize| {
            let medium = own(lane);
            let set = medium.yields.as_ref()?.downcast::<Mises>()?;
            Some(Cone::new(set, medium.law.downcast::<Isotropic>()?))
        };
        let known: [Option<Cone<f64>>; WIDTH] = std::array::from_fn(cone_of);
        let half_spaces_of = |lane: usize| match (&known[lane], &own(lane).yields) {
            (None, Some(set)) => set.half_spaces(),
            _ => None,
        };
        let polyhedra: Vec<_> = (0..WIDTH).map(half_spaces_of).collect();
        let bits = |is: &dyn Fn(usize) -> bool| {
            (0..WIDTH).map(|lane| u16::from(is(lane)) << lane).sum::<u16>()
        };
        let most = polyhedra.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let half_space = |index: usize| {
            let of = |lane: usize| polyhedra[lane].as_ref().and_then(|own| own.get(index));
            let lanes = |which: usize, i: usize, j: usize| {
                Wide::by_lane(|lane| {
                    of(lane).map_or(0.0, |own| tensors(&own.0.normal)[which][i][j])
                })
            };
            let components = (0..18).map(|number| [number / 9, number / 3 % 3, number % 3]);
            let normal = components.map(|own| (own, lanes(own[0], own[1], own[2])));
            HalfSpace {
                normal: normal.filter(|own| own.1 != Wide::ZERO).collect(),
                strength: Wide::by_lane(|lane| of(lane).map_or(UNBOUNDED, |own| own.1)),
            }
        };
        let cones = known.map(|own| own.unwrap_or(Cone::unbounded(UNBOUNDED)));
        let moduli: [[[f64; 3]; 2]; WIDTH] = std::array::from_fn(|lane| {
            own(lane).law.downcast::<Isotropic>().map_or([[1.0; 3]; 2], Isotropic::energy_moduli)
        });
        Self {
            media: std::array::from_fn(|lane| lanes[lane]),
            cones: bits(&|lane| known[lane].is_some()),
            cone: Cone::gather(|value| Wide::by_lane(|lane| value(&cones[lane]))),
            moduli: std::array::from_fn(|which| {
                std::array::from_fn(|part| Wide::by_lane(|lane| moduli[lane][which][part]))
            }),
            half_spaces: (0..most).map(half_space).collect(),
            others: bits(&|lane| {
                own(lane).yields.is_some() && known[lane].is_none() && polyhedra[lane].is_none()
            }),
        }
    }
}

pub(super) fn tensors(stress: &Stress) -> Tensors<f64> {
    [stress.force, stress.couple]
}

impl TotalStressSets {
    /// Creates the yield sets of all lane patterns. The shape of the stresses depends on `media` and on all `initial`
    /// stresses.
    pub(super) fn new(media: &[Medium], patterns: &[Vec<u16>], initial: &[Stress]) -> Self {
        let fields = &media[0].fields;
        let index = |field: Field| fields.iter().position(|own| *own == field);
        let is_symmetric = media[0].rotation.is_none();
        let places = |which: usize, mirrors: bool| -> Tensor<Option<usize>> {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let of = |i, j| match which {
                        0 => index(Field::Stress(i, j)),
                        _ => index(Field::Couple(i, j)),
                    };
                    of(i, j).or_else(|| of(j, i).filter(|_| mirrors))
                })
            })
        };
        let [places, targets] =
            [is_symmetric, false].map(|mirrors| [0, 1].map(|which| places(which, mirrors)));
        let is_zero = |which: usize, i: usize, j: usize| {
            let is_zero = |own: &Stress| tensors(own)[which][i][j] == 0.0;
            places[which][i][j].is_none() && initial.iter().all(is_zero)
        };
        let mut shape = Shape {
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
            has_couples: places[1] != [[None; 3]; 3]
                || initial.iter().any(|own| own.couple != [[0.0; 3]; 3]),
        };
        // Four shapes have separate compiled loops; other shapes are treated as the general ones.
        if !shape.is_symmetric || shape.has_couples {
            shape = Shape { is_symmetric: false, has_couples: true, ..shape };
        }
        let blocks: Vec<Block> = patterns
            .iter()
            .flat_map(|pattern| pattern.chunks(WIDTH).map(|lanes| Block::new(media, lanes)))
            .collect();
        let mut seen = [false; PARTS];
        for block in &blocks {
            for (seen, weights) in seen.iter_mut().zip(&block.cone.half_weights) {
                *seen |= weights.lanes().iter().any(|weight| *weight > 0.0);
            }
        }
        Self { shape, places, targets, seen, blocks }
    }
}

/// Loads force and couple stress.
#[inline(always)]
pub(super) fn load_tensors<V: Vector<f64>>(tensors: &Tensors<Wide>) -> Tensors<V> {
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

/// Loads moduli.
#[inline(always)]
pub(super) fn load_moduli<V: Vector<f64>>(moduli: &[[Wide; 3]; 2]) -> [[V; 3]; 2] {
    let mut loaded = [[V::ZERO; 3]; 2];
    for which in 0..2 {
        for part in 0..3 {
            loaded[which][part] = V::load(&moduli[which][part]);
        }
    }
    loaded
}

/// Loads a cone.
#[inline(always)]
pub(super) fn load_cone<V: Vector<f64>>(cone: &Cone<Wide>) -> Cone<V> {
    let [mut half_weights, mut stiffnesses, mut rates] = [[V::ZERO; PARTS]; 3];
    for part in 0..PARTS {
        half_weights[part] = V::load(&cone.half_weights[part]);
        stiffnesses[part] = V::load(&cone.stiffnesses[part]);
        rates[part] = V::load(&cone.rates[part]);
    }
    let [force, couple] = &cone.rounding_weights;
    Cone {
        strength: V::load(&cone.strength),
        friction: V::load(&cone.friction),
        mean_drop: V::load(&cone.mean_drop),
        a: V::load(&cone.a),
        half_weights,
        stiffnesses,
        rates,
        rounding_weights: [V::load(force), V::load(couple)],
    }
}
