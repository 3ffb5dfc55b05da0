//! Whether parts cover a box, or intervals an interval.

use num_rational::BigRational;
use num_traits::Zero;

/// Whether these boxes, each given by its ends along the axes, lie in the whole box, do not overlap and have its volume.
pub(crate) fn covers(whole: &[[BigRational; 2]], parts: &[Vec<[BigRational; 2]>]) -> bool {
    // Along axes on which the whole is one number, each part must be that number.
    let is_inside = |part: &Vec<[BigRational; 2]>| {
        part.len() == whole.len()
            && part.iter().zip(whole).all(|(own, all)| {
                let is_whole = own == all;
                is_whole || (own[0] < own[1] && own[0] >= all[0] && own[1] <= all[1])
            })
    };
    let volume = |own: &[[BigRational; 2]]| {
        let sizes = own.iter().map(|[low, high]| high - low).filter(|size| !size.is_zero());
        sizes.fold(BigRational::from_integer(1.into()), |product, size| product * size)
    };
    let is_apart = |a: &Vec<[BigRational; 2]>, b: &Vec<[BigRational; 2]>| {
        a.iter().zip(b).any(|(a, b)| a[1] <= b[0] || b[1] <= a[0])
    };
    let pairs = parts.iter().enumerate().flat_map(|(i, a)| parts[..i].iter().map(move |b| (a, b)));
    let sum = parts.iter().fold(BigRational::zero(), |sum, own| sum + volume(own));
    parts.iter().all(is_inside)
        && (parts.len() == 1 || pairs.into_iter().all(|(a, b)| is_apart(a, b)))
        && sum == volume(whole)
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
        // A box of one number along an axis.
        let line = [ends(3, 3), ends(0, 4)];
        assert!(covers(&line, &[vec![ends(3, 3), ends(0, 4)]]));
        assert!(!covers(&line, &[vec![ends(2, 2), ends(0, 4)]]));
        assert!(covers(&[], &[Vec::new()]));
        assert!(!covers(&[], &[Vec::new(), Vec::new()]));
    }
}
