//! All characteristic speeds for one wave normal.

use super::eigenbasis::new_identity;
use super::elastic_waves::AcousticTensor3;
use super::error::NormalSearchError;
use super::rank_one::RankOneUpdate;
use super::secular_roots::EigenvaluePair;
use num_complex::Complex64;

impl AcousticTensor3 {
    /// Squared characteristic speeds of waves with the unit normal `normal`, m²/s², real ones first.
    ///
    /// # Errors
    /// See [`search_extremes`](Self::search_extremes).
    pub fn squared_speeds(
        &self,
        update: &RankOneUpdate,
        normal: [f64; 3],
    ) -> Result<Vec<Complex64>, NormalSearchError> {
        let tensor_update = self.project_update(update)?;
        let secular = self.secular_equation_near(&tensor_update, &new_identity(), &normal);
        let mut roots: Vec<Complex64> = secular.unchanged_eigenvalues[..secular.unchanged_count]
            .iter()
            .map(|&x| Complex64::new(x, 0.0))
            .collect();
        match (secular.pole_count, secular.sign_changes()) {
            (0, _) => {}
            (2, _) => push_pair(&mut roots, &secular.solve_quadratic()),
            (count, 1) => {
                for index in (0..=count).filter(|&index| secular.has_odd_root_count(index)) {
                    roots.push(Complex64::new(
                        secular.solve_root(index, secular.max_magnitude(), true),
                        0.0,
                    ));
                }
            }
            (count, 3) => {
                let (found, rest) = secular.deflate_to_pair();
                roots.extend(found[..count - 2].iter().map(|&x| Complex64::new(x, 0.0)));
                push_pair(&mut roots, &rest);
            }
            (count, _) => roots.extend(&secular.iterate_aberth()[..count]),
        }
        roots.sort_by(|x, y| {
            let key = |z: &Complex64| z.im != 0.0;
            key(x).cmp(&key(y)).then(x.re.total_cmp(&y.re)).then(x.im.total_cmp(&y.im))
        });
        Ok(roots.into_iter().map(|root| root * self.squared_speed_unit).collect())
    }
}

/// Adds both roots of a pair.
fn push_pair(roots: &mut Vec<Complex64>, pair: &EigenvaluePair) {
    let root = Complex64::new(pair.squared_half_difference, 0.0).sqrt();
    roots.extend([pair.mean - root, pair.mean + root]);
}
