//! Strongest flutter and slowest wave, by forms with a certificate where these decide, else by the search.

use super::deviatoric_associativity::AssociatedDeviators;
use super::elastic_waves::AcousticTensor3;
use super::error::NormalSearchError;
use super::extremes::WaveExtremes;
use super::rank_one::RankOneUpdate;
use super::search::NormalSearchWorkspace;
use super::tensor_update::TensorUpdate;

/// Method by which extremes over all wave normals were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtremesMethod {
    /// A form over the sphere whose maximum is proved to be global.
    Certified,
    /// Search from a grid of wave normals.
    Search,
}

impl AcousticTensor3 {
    /// Strongest flutter and slowest real wave over all directions: by [`certified_extremes`](Self::certified_extremes);
    /// if undecided, by [`search_extremes`](Self::search_extremes), limited to the directions that the forms leave open.
    ///
    /// # Errors
    /// A vector has the wrong length or is not finite.
    pub fn find_extremes(
        &self,
        update: &RankOneUpdate,
        workspace: &mut NormalSearchWorkspace,
    ) -> Result<(WaveExtremes, ExtremesMethod), NormalSearchError> {
        let update = self.project_update(update)?;
        Ok(match self.decide_by_forms(&update) {
            (Some(slowest), true) => {
                (self.scale_extremes(&update, slowest, None), ExtremesMethod::Certified)
            }
            (slowest, _) => {
                (self.search_projected(&update, slowest, workspace), ExtremesMethod::Search)
            }
        })
    }

    /// Slowest wave over all directions, if it is proved that no direction has a slower one and that no speed is
    /// complex; `None` if undecided. Decides for isotropic elasticity and deviatorically associated flow (see the
    /// [module](super)), except where flutter occurs or is near.
    ///
    /// # Errors
    /// A vector has the wrong length or is not finite.
    pub fn certified_extremes(
        &self,
        update: &RankOneUpdate,
    ) -> Result<Option<WaveExtremes>, NormalSearchError> {
        let update = self.project_update(update)?;
        let (slowest, excludes_flutter) = self.decide_by_forms(&update);
        let certain = slowest.filter(|_| excludes_flutter);
        Ok(certain.map(|slowest| self.scale_extremes(&update, slowest, None)))
    }

    /// The wave (normal, c²) at whose c² the maximum of the secular function over all directions is proved to be 1, and
    /// whether it is proved that there is no flutter.
    fn decide_by_forms(&self, update: &TensorUpdate) -> (Option<([f64; 3], f64)>, bool) {
        let form = self.isotropic.as_ref().and_then(|own| AssociatedDeviators::new(own, update));
        form.map_or((None, false), |form| (form.slowest_wave(), form.excludes_flutter()))
    }
}
