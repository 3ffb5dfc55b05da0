//! All characteristic speeds of a direction.

use super::eigenbasis::{Groups, identity};
use super::elastic_waves::AcousticTensor3;
use super::error::SphereError;
use super::rank_one::RankOne;
use super::secular_roots::RootPair;
use num_complex::Complex64;

impl AcousticTensor3 {
    /// Squared characteristic speeds of waves with the unit normal `normal`, m²/s², real ones first.
    ///
    /// # Errors
    /// See [`search`](Self::search).
    pub fn speeds_squared(
        &self,
        update: &RankOne,
        normal: [f64; 3],
    ) -> Result<Vec<Complex64>, SphereError> {
        let change = self.change(update)?;
        let (values, basis) = self.elastic(&normal, &identity());
        let groups = Groups::new(&values[..self.size]);
        let secular = change.at(&normal, &basis, &groups);
        let mut roots: Vec<Complex64> =
            secular.kept[..secular.kept_count].iter().map(|&x| Complex64::new(x, 0.0)).collect();
        match (secular.count, secular.changes()) {
            (0, _) => {}
            (2, _) => push_pair(&mut roots, &secular.quadratic()),
            (count, 1) => {
                for index in (0..=count).filter(|&index| secular.is_odd(index)) {
                    roots.push(Complex64::new(secular.root(index, secular.size(), true), 0.0));
                }
            }
            (count, 3) => {
                let (found, rest) = secular.last_two();
                roots.extend(found[..count - 2].iter().map(|&x| Complex64::new(x, 0.0)));
                push_pair(&mut roots, &rest);
            }
            (count, _) => roots.extend(&secular.all()[..count]),
        }
        roots.sort_by(|x, y| {
            let key = |z: &Complex64| z.im != 0.0;
            key(x).cmp(&key(y)).then(x.re.total_cmp(&y.re)).then(x.im.total_cmp(&y.im))
        });
        Ok(roots.into_iter().map(|root| root * self.unit).collect())
    }
}

/// Adds both roots of a pair.
fn push_pair(roots: &mut Vec<Complex64>, pair: &RootPair) {
    let root = Complex64::new(pair.square, 0.0).sqrt();
    roots.extend([pair.middle - root, pair.middle + root]);
}
