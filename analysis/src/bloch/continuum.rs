//! Plane waves of the equivalent Cosserat continuum.

use crate::solids::PlaneWaves;
use models::common::elementary::Elementary;
use models::elastoplastic::Solid;
use models::solid::ElasticLaw;
use models::solid::parameters::PlaneCompliances;

/// Angular frequencies of the three plane waves of a Cosserat solid in plane strain at the wave vector κ, 1/m,
/// ascending, rad/s; two are zero at κ = 0, the third is ω*.
pub fn continuum_frequencies(solid: &PlaneCompliances, wave_vector: [f64; 2]) -> Vec<f64> {
    let length = wave_vector[0].root_sum_square(wave_vector[1]);
    let [x, y] = match length > 0.0 {
        true => wave_vector.map(|component| component / length),
        false => [1.0, 0.0],
    };
    let elastic = Solid::new(ElasticLaw::from(*solid), 2, None);
    // The response of an elastic solid is always defined.
    let roots =
        PlaneWaves::new(&elastic).map_or(Vec::new(), |waves| waves.roots([x, y, 0.0], length));
    let mut frequencies: Vec<f64> =
        roots.iter().map(|root| root.im).filter(|&frequency| frequency > 0.0).collect();
    frequencies.sort_by(f64::total_cmp);
    // Waves of zero frequency have no pair of roots of either sign.
    let mut all = vec![0.0; 3usize.saturating_sub(frequencies.len())];
    all.append(&mut frequencies);
    all
}
