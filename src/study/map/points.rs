//! Results at all points of a map, one list per quantity.

use super::point_assessor::{MapPoint, PointStatus};
use crate::Error;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::sync::Arc;

/// Quantity of a map point that is a number, as its place among `MapPoint::numbers`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapNumber {
    /// [`MapPoint::growth_order`].
    GrowthOrder = 2,
    /// [`MapPoint::growth_coefficient`].
    GrowthCoefficient = 3,
    /// [`MapPoint::direction_deg`].
    Direction = 4,
    /// [`MapPoint::elevation_deg`].
    Elevation = 5,
    /// [`MapPoint::growth_bound`].
    GrowthBound = 6,
    /// [`MapPoint::growth_rate`].
    GrowthRate = 7,
    /// [`MapPoint::noncoaxiality_bound_deg`].
    NoncoaxialityBound = 8,
    /// Supremum of |Im c|, [`PointSpeeds::max_imaginary_speed`](super::PointSpeeds::max_imaginary_speed).
    Flutter = 10,
    /// [`PointSpeeds::min_squared_speed`](super::PointSpeeds::min_squared_speed).
    LeastSquaredSpeed = 11,
    /// Direction of [`PointSpeeds::slowest_normal_deg`](super::PointSpeeds::slowest_normal_deg).
    SlowestDirection = 12,
    /// Elevation of [`PointSpeeds::slowest_normal_deg`](super::PointSpeeds::slowest_normal_deg).
    SlowestElevation = 13,
}

/// Quantity of a map point that is a choice, stored as a code of one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapCode {
    /// Place of the status in [`PointStatus::ALL`].
    Status = 0,
    /// 0 without verdict, else one more than the place of the route in [`Route::ALL`](analysis::flows::Route::ALL).
    Route = 1,
    /// 0 without speeds, else one more than the place in
    /// [`Hyperbolicity::ALL`](analysis::solids::Hyperbolicity::ALL).
    Hyperbolicity = 2,
}

/// Places of the codes among `MapPoint::numbers`, and the difference of a code from the number there.
const CODE_NUMBERS: [(usize, i8); 3] = [(0, 0), (1, 1), (9, 1)];

/// Number of numbers of a point, codes included.
pub(super) const NUMBER_COUNT: usize = 14;

/// Results at the points of a map in compact form: lists of codes of one byte, and of each number that some point has.
#[derive(Clone, Debug)]
pub struct MapPoints {
    count: usize,
    codes: [Vec<i8>; 3],
    /// Lists by place among the numbers of a point; empty if no point has the number, and at the places of the codes.
    numbers: [Arc<Vec<f64>>; NUMBER_COUNT],
}

/// Creates a list of `count` equal numbers.
fn create_list<N: Clone>(count: usize, number: N) -> Result<Vec<N>, Error> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(|_| Error::Memory { points: count })?;
    list.resize(count, number);
    Ok(list)
}

impl MapPoints {
    /// Creates `count` points outside the range of the model.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub(super) fn new(count: usize) -> Result<Self, Error> {
        let outside = create_list(count, PointStatus::OutsideModel as i8)?;
        let codes = [outside, create_list(count, 0)?, create_list(count, 0)?];
        Ok(Self { count, codes, numbers: Default::default() })
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Returns whether the map has no points.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the results at a point.
    pub fn get(&self, index: usize) -> MapPoint {
        let mut numbers = [f64::NAN; NUMBER_COUNT];
        for (list, number) in self.numbers.iter().zip(&mut numbers) {
            *number = list.get(index).copied().unwrap_or(f64::NAN);
        }
        for (list, (place, offset)) in self.codes.iter().zip(CODE_NUMBERS) {
            if list[index] >= offset {
                numbers[place] = f64::from(list[index] - offset);
            }
        }
        MapPoint::from_numbers(numbers)
    }

    /// Iterates over the results at all points.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = MapPoint> {
        (0..self.count).map(|index| self.get(index))
    }

    /// Sets the results at a point.
    ///
    /// # Errors
    /// [`Error::Memory`], for a number that no point had so far.
    pub(super) fn set(&mut self, index: usize, point: &MapPoint) -> Result<(), Error> {
        let numbers = point.numbers();
        for (list, (place, offset)) in self.codes.iter_mut().zip(CODE_NUMBERS) {
            let number = numbers[place];
            list[index] = if number.is_nan() { 0 } else { number as i8 + offset };
        }
        for (place, (list, number)) in self.numbers.iter_mut().zip(numbers).enumerate() {
            if CODE_NUMBERS.iter().any(|code| code.0 == place)
                || (list.is_empty() && number.is_nan())
            {
                continue;
            }
            let list = Arc::make_mut(list);
            if list.is_empty() {
                *list = create_list(self.count, f64::NAN)?;
            }
            list[index] = number;
        }
        Ok(())
    }

    /// Returns a number of a point; NaN if the point does not have it.
    pub fn number(&self, which: MapNumber, index: usize) -> f64 {
        self.numbers[which as usize].get(index).copied().unwrap_or(f64::NAN)
    }

    /// Returns whether some point has a number.
    pub fn has_number(&self, which: MapNumber) -> bool {
        !self.numbers[which as usize].is_empty()
    }

    /// Returns a number of all points; NaN where a point does not have it.
    pub fn numbers(&self, which: MapNumber) -> Cow<'_, [f64]> {
        match &self.numbers[which as usize] {
            list if list.is_empty() => vec![f64::NAN; self.count].into(),
            list => list.as_slice().into(),
        }
    }

    /// Returns the shared list of a number of all points; empty if no point has it.
    pub fn shared_numbers(&self, which: MapNumber) -> Arc<Vec<f64>> {
        Arc::clone(&self.numbers[which as usize])
    }

    /// Returns a code of all points.
    pub fn codes(&self, which: MapCode) -> &[i8] {
        &self.codes[which as usize]
    }

    /// Returns whether a point has a status.
    pub fn has_status(&self, index: usize, status: PointStatus) -> bool {
        self.codes[MapCode::Status as usize][index] == status as i8
    }

    /// Returns whether two points have the same verdict, as [`MapPoint::has_verdict_of`] does.
    pub fn have_same_verdict(&self, one: usize, other: usize) -> bool {
        let order = |index| {
            Some(self.number(MapNumber::GrowthOrder, index)).filter(|order| order.is_finite())
        };
        let is_same = |which: MapCode| self.codes(which)[one] == self.codes(which)[other];
        is_same(MapCode::Status) && is_same(MapCode::Hyperbolicity) && order(one) == order(other)
    }
}

/// Points are serialised as a list of [`MapPoint`].
impl Serialize for MapPoints {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points come back unchanged, in any order of setting, and lists exist only of numbers that some point has.
    #[test]
    fn points_are_returned_unchanged() {
        let number = |seed: usize| if seed.is_multiple_of(3) { f64::NAN } else { seed as f64 };
        let create = |index: usize| {
            let mut numbers = [0; NUMBER_COUNT].map(|_| f64::NAN);
            numbers[0] = (index % 7) as f64;
            numbers[1] = [f64::NAN, 0.0, 1.0][index % 3];
            numbers[2] = number(index);
            numbers[4] = number(index + 1);
            if index % 2 == 1 {
                numbers[9] = (index % 4) as f64;
                numbers[10..].fill(index as f64);
            }
            MapPoint::from_numbers(numbers)
        };
        let expected: Vec<MapPoint> = (0..20).map(create).collect();
        for order in [Vec::from_iter(0..20), (0..20).rev().collect()] {
            let mut points = MapPoints::new(20).unwrap();
            order.into_iter().for_each(|index| points.set(index, &expected[index]).unwrap());
            let bits = |point: &MapPoint| point.numbers().map(f64::to_bits);
            for (index, point) in points.iter().enumerate() {
                assert_eq!(bits(&point), bits(&expected[index]));
                assert_eq!(point.status, expected[index].status);
                for (other, beside) in expected.iter().enumerate() {
                    let is_same = point.has_verdict_of(beside);
                    assert_eq!(points.have_same_verdict(index, other), is_same);
                }
            }
            assert!(points.has_number(MapNumber::GrowthOrder));
            assert!(!points.has_number(MapNumber::GrowthBound));
            assert!(points.numbers(MapNumber::GrowthBound).iter().all(|value| value.is_nan()));
        }
    }
}
