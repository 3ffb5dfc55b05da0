//! Strongest flutter and slowest wave, by forms with a certificate where these decide, else by the search.

use super::deviatoric_associativity::AssociatedDeviators;
use super::elastic_waves::AcousticTensor3;
use super::error::NormalSearchError;
use super::extremes::WaveExtremes;
use super::rank_one::RankOneUpdate;
use super::search::NormalSearchWorkspace;

/// Method by which extremes over all wave normals were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtremesMethod {
    /// A form over the sphere whose maximum is proved to be global.
    Certified,
    /// Search from a grid of wave normals.
    Search,
}

impl AcousticTensor3 {
    /// Strongest flutter and slowest real wave over all directions:
    /// [`certified_extremes`](Self::certified_extremes), or [`search_extremes`](Self::search_extremes) if it is
    /// undecided.
    ///
    /// # Errors
    /// A vector has the wrong length or is not finite.
    pub fn find_extremes(
        &self,
        update: &RankOneUpdate,
        workspace: &mut NormalSearchWorkspace,
    ) -> Result<(WaveExtremes, ExtremesMethod), NormalSearchError> {
        Ok(match self.certified_extremes(update)? {
            Some(extremes) => (extremes, ExtremesMethod::Certified),
            None => (self.search_extremes(update, workspace)?, ExtremesMethod::Search),
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
        let Some(waves) = &self.isotropic else { return Ok(None) };
        let slowest = AssociatedDeviators::new(waves, &update)
            .filter(AssociatedDeviators::excludes_flutter)
            .and_then(|form| form.slowest_wave());
        Ok(slowest.map(|(normal, value)| WaveExtremes {
            flutter: None,
            slowest: self.scale_slowest(&update, normal, value),
        }))
    }
}
