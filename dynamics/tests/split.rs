//! A domain in parts is the domain in one piece, to the last bit.

use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::plasticity::parameters::Mises;
use wellposed_dynamics::domain::{Boundary, Domain, DomainError, Grid, Placement, Scheme};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::{Correction, Medium};
use wellposed_dynamics::split::Split;

fn noise(index: u64) -> f64 {
    let mixed = index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn solids() -> [Isotropic; 2] {
    [1.0, 2.3].map(|factor| {
        let couple = Some(CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 });
        let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
        Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, Some(rotation)).expect("sound moduli")
    })
}

fn same<const D: usize>(sides: &[[Boundary; 2]; D], cells: [usize; D], placement: Placement) {
    // One of the two media yields.
    let [soft, stiff] = solids();
    let set = Mises { antisymmetric_weight: 0.5, ..Mises::drucker_prager(0.3, 0.2, 0.2) };
    let media = [
        Medium { correction: Some(Correction::Mises(set, soft)), ..Medium::isotropic(&soft, D) },
        Medium::isotropic(&stiff, D),
    ];
    let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
    let count: usize = cells.iter().product();
    let of_cell: Vec<u16> = (0..count).map(|i| u16::from(noise(i as u64) > 0.2)).collect();
    let grid = Grid { cells, spacing: [0.1; D] };
    let step = 1.9 * 0.1 / speed;
    let scheme = Scheme { slopes: Slopes::Limited, placement };
    let mut whole: Domain<f64, D> =
        Domain::new(grid, media.to_vec(), of_cell.clone(), sides.clone(), step, scheme)
            .expect("sound");
    let values = |index: usize| -> Vec<f64> {
        (0..count).map(|cell| noise((10_000 * index + cell) as u64)).collect()
    };
    let fields = whole.fields().to_vec();
    for (index, &field) in fields.iter().enumerate() {
        whole.values_mut(field).expect("a field").copy_from_slice(&values(index));
    }
    for _ in 0..30 {
        whole.advance(None);
    }
    for parts in 1..=3 {
        let mut split: Split<f64, D> =
            Split::new(grid, &media, &of_cell, sides, step, scheme, parts).expect("sound");
        for (index, &field) in fields.iter().enumerate() {
            split.set(field, &values(index));
        }
        // In two goes: what was exchanged in one does not matter to the next.
        split.advance(11);
        split.advance(19);
        for &field in &fields {
            let found = split.values(field).expect("a field");
            let expected = whole.values(field).expect("a field");
            let is_same = found.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(is_same && found.len() == expected.len(), "{parts} parts, {field:?}");
        }
    }
}

#[test]
fn parts_have_the_bits_of_the_whole() {
    let pair = |b: &Boundary| [b.clone(), b.clone()];
    for last in [Boundary::Periodic, Boundary::Fixed, Boundary::Free, Boundary::NonReflecting] {
        for placement in [Placement::Last, Placement::Middle] {
            same::<2>(&[pair(&Boundary::Free), pair(&last)], [9, 13], placement);
            let sides = [pair(&Boundary::Periodic), pair(&Boundary::Fixed), pair(&last)];
            same::<3>(&sides, [5, 4, 8], placement);
        }
    }
}

#[test]
fn parts_that_cannot_be_are_refused() {
    let media = [Medium::isotropic(&solids()[0], 2)];
    let grid = Grid { cells: [4, 7], spacing: [0.1, 0.1] };
    let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme { slopes: Slopes::Limited, placement: Placement::Middle };
    for (parts, expected) in [(0, true), (4, true), (3, false)] {
        let made = Split::<f64, 2>::new(grid, &media, &[0; 28], &sides, 1e-3, scheme, parts);
        let refused = matches!(made, Err(DomainError::Parts { found, cells: 7 }) if found == parts);
        assert_eq!(refused, expected, "{parts}");
    }
}
