//! Whether parts cover a box, or intervals an interval.

use num_rational::BigRational;
use num_traits::Zero;

/// Whether these boxes, each given by its ends along the axes, lie in the whole box, do not overlap and have its volume.
pub(crate) fn covers(whole: &[[BigRational; 2]], parts: &[Vec<[BigRational; 2]>]) -> bool {
    let is_inside = |part: &Vec<[BigRational; 2]>| {
        let inside = |(own, all): (&[BigRational; 2], &[BigRational; 2])| {
            all[0] <= own[0] && own[0] < own[1] && own[1] <= all[1]
        };
        part.len() == whole.len() && part.iter().zip(whole).all(inside)
    };
    let volume = |own: &[[BigRational; 2]]| {
        let one = BigRational::from_integer(1.into());
        own.iter().fold(one, |product, [low, high]| product * (high - low))
    };
    let is_apart = |a: &Vec<[BigRational; 2]>, b: &Vec<[BigRational; 2]>| {
        a.iter().zip(b).any(|(a, b)| a[1] <= b[0] || b[1] <= a[0])
    };
    let mut pairs =
        parts.iter().enumerate().flat_map(|(i, a)| parts[..i].iter().map(move |b| (a, b)));
    let sum = parts.iter().fold(BigRational::zero(), |sum, own| sum + volume(own));
    parts.iter().all(is_inside) && sum == volume(whole) && pairs.all(|(a, b)| is_apart(a, b))
}

/// Whether these intervals, in any order, follow each other without gap or overlap from the first to the second number.
pub(crate) fn covers_interval(
    [first, last]: &[BigRational; 2],
    mut parts: Vec<[BigRational; 2]>,
) -> bool {
    parts.sort();
    let end =
        parts.iter().try_fold(first, |end, [low, high]| (low == end && low < high).then_some(high));
    end == Some(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(low: i64, high: i64) -> [BigRational; 2] {
        [low, high].map(|own| BigRational::from_integer(own.into()))
    }

    #[test]
    fn gaps_overlaps_and_strays_are_found() {
        let whole = [ends(0, 2), ends(0, 4)];
        let halves = [vec![ends(0, 2), ends(0, 1)], vec![ends(0, 2), ends(1, 4)]];
        assert!(covers(&whole, &halves));
        assert!(!covers(&whole, &halves[..1]));
        let overlapping = [vec![ends(0, 2), ends(0, 2)], vec![ends(0, 2), ends(1, 3)]];
        assert!(!covers(&whole, &overlapping));
        let outside = [vec![ends(0, 2), ends(0, 1)], vec![ends(0, 2), ends(2, 5)]];
        assert!(!covers(&whole, &outside));
        // A part of no size, and one that is repeated.
        assert!(!covers(&whole, &[vec![ends(0, 2), ends(0, 4)], vec![ends(1, 1), ends(0, 4)]]));
        assert!(!covers(
            &whole,
            &[halves[0].clone(), halves[0].clone(), halves[0].clone(), halves[0].clone()]
        ));
        assert!(covers(&[], &[Vec::new()]));
        assert!(!covers(&[], &[Vec::new(), Vec::new()]));
        assert!(!covers(&[], &[]));
    }

    #[test]
    fn chains_without_gap_cover_an_interval() {
        let whole = ends(-1, 3);
        assert!(covers_interval(&whole, vec![ends(1, 3), ends(-1, 1)]));
        assert!(!covers_interval(&whole, vec![ends(2, 3), ends(-1, 1)]));
        assert!(!covers_interval(&whole, vec![ends(0, 3), ends(-1, 1)]));
        assert!(!covers_interval(&whole, vec![ends(1, 1), ends(1, 3), ends(-1, 1)]));
        assert!(!covers_interval(&whole, vec![ends(1, 4), ends(-1, 1)]));
        assert!(!covers_interval(&whole, Vec::new()));
    }
}
