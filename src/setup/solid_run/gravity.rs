//! Gravity and initial stress of a solid simulation.

use super::GridConverter;
use super::geometry::cell_centre;
use crate::case::CaseError;
use dynamics::initial::{NonUniformLayer, add_lithostatic_stress, layer_densities};
use dynamics::medium::Medium;
use models::common::decimal::ToPlainText;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;

impl GridConverter<'_> {
    /// Computes the acceleration by gravity, m/s², and the initial stress. The stress is given by an axis and one
    /// stress, Pa and N/m, for each layer of cells normal to that axis; `None` if all stresses are zero. If gravity is
    /// balanced, the acceleration is zero, and the lithostatic stress that balances it is added to the uniform initial
    /// stress.
    #[allow(clippy::type_complexity, reason = "two fields of the problem")]
    pub(super) fn compute_gravity_and_initial_stress<const D: usize>(
        &self,
        media: &[Medium],
        medium_index: impl Fn(usize) -> usize,
    ) -> Result<([f64; D], Option<(usize, Vec<Stress>)>), CaseError> {
        let mut uniform = Stress::default();
        for (component, value) in &self.solid_run.initial_stress {
            match component.0 {
                SolidField::Stress(i, j) => {
                    uniform.force[i][j] = *value;
                    if self.first_medium.rotation.is_none() {
                        uniform.force[j][i] = *value;
                    }
                }
                SolidField::Couple(k, j) => uniform.couple[k][j] = *value,
                _ => {}
            }
        }
        let grid = &self.solid_run.grid;
        let mut acceleration = [0.0; D];
        let mut layers = (D - 1, vec![uniform; grid.cells[D - 1]]);
        if let Some(gravity) = &self.solid_run.gravity {
            let along = gravity.acceleration.iter().position(|a| *a != 0.0);
            match along.filter(|_| gravity.is_balanced) {
                None => acceleration.copy_from_slice(&gravity.acceleration),
                Some(axis) => {
                    let cells = &grid.cells;
                    let of_cell = (0..grid.cell_count()).map(medium_index);
                    let densities = layer_densities(cells, axis, media, of_cell)
                        .map_err(|uneven| self.create_uneven_layer_error(axis, uneven))?;
                    let mut all = vec![uniform; cells[axis]];
                    let (spacing, pull) = (grid.spacing[axis], gravity.acceleration[axis]);
                    let ratio = gravity.lateral_ratio;
                    add_lithostatic_stress(&mut all, axis, &densities, spacing, pull, ratio);
                    layers = (axis, all);
                }
            }
        }
        let is_zero = layers.1.iter().all(|stress| *stress == Stress::default());
        Ok((acceleration, (!is_zero).then_some(layers)))
    }

    /// Creates the error that the density is not uniform in a layer of cells normal to an axis.
    fn create_uneven_layer_error(
        &self,
        axis: usize,
        NonUniformLayer { cell, densities: [own, density] }: NonUniformLayer,
    ) -> CaseError {
        let found = format!(
            "densities {} and {} side by side, at x{} = {}",
            own.to_plain_text(),
            density.to_plain_text(),
            axis + 1,
            cell_centre(self.solid_run, cell)[axis].to_plain_text()
        );
        let allowed = "densities that change along gravity alone; balanced = false lets \
                       the weight act from the start";
        self.solid_run.key_error("gravity.balanced", found, allowed)
    }
}
