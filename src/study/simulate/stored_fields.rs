//! Output fields that are stored by layers of cells until a snapshot within the next step needs them.

use super::{FieldSource, FieldStore, OutputFields};
use std::cell::RefCell;
use std::io::{self, SeekFrom};
use std::ops::Range;

/// Output fields of a state, stored layer by layer, each with the values of all arrays one after the other.
pub(super) struct StoredFields {
    store: RefCell<Box<dyn FieldStore>>,
    /// All but the values by cell.
    description: OutputFields,
    layer_size: usize,
}

impl StoredFields {
    /// Stores the output fields of a source in an empty store.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(super) fn new(
        source: &dyn FieldSource,
        mut store: Box<dyn FieldStore>,
    ) -> io::Result<Self> {
        let layer_size = source.layer_size();
        for slab in source.slabs() {
            let mut slab = slab?;
            let arrays: Vec<&[f64]> = arrays(&mut slab).map(|own| &*own).collect();
            let layer_count = arrays.first().map_or(0, |own| own.len() / layer_size.max(1));
            for layer in 0..layer_count {
                let cells = layer * layer_size..(layer + 1) * layer_size;
                for own in &arrays {
                    store.write_all(&files::encode_numbers(&own[cells.clone()]))?;
                }
            }
        }
        Ok(Self { store: RefCell::new(store), description: source.describe(), layer_size })
    }

    /// Interpolates linearly to the fields `later` of a later state in some layers, in their memory; `fraction`: fraction of
    /// the time between the states.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(super) fn interpolate_layers(
        &self,
        layers: &Range<usize>,
        fraction: f64,
        later: &mut OutputFields,
    ) -> io::Result<()> {
        let size = self.layer_size;
        let mut arrays: Vec<&mut [f64]> = arrays(later).collect();
        let mut bytes = vec![0; arrays.len() * size * size_of::<f64>()];
        let mut store = self.store.borrow_mut();
        store.seek(SeekFrom::Start((layers.start * bytes.len()) as u64))?;
        for layer in 0..layers.len() {
            store.read_exact(&mut bytes)?;
            let (before, _) = bytes.as_chunks();
            for (array, before) in arrays.iter_mut().zip(before.chunks(size.max(1))) {
                let after = &mut array[layer * size..(layer + 1) * size];
                for (after, before) in after.iter_mut().zip(before) {
                    *after = interpolate(f64::from_le_bytes(*before), *after, fraction);
                }
            }
        }
        Ok(())
    }

    /// Interpolates linearly to the joints of a later state. Times of first slip and of fracture are those of the later
    /// state: laws record them at ends of steps.
    pub(super) fn interpolate_joints(&self, fraction: f64, later: &mut OutputFields) {
        for (face, before) in later.joint_faces.iter_mut().zip(&self.description.joint_faces) {
            let (after, before) = (&mut face.record, &before.record);
            let pairs = [
                (&mut after.slip, before.slip),
                (&mut after.opening, before.opening),
                (&mut after.normal_stress, before.normal_stress),
                (&mut after.shear_stress, before.shear_stress),
                (&mut after.porosity, before.porosity),
                (&mut after.pressure, before.pressure),
                (&mut after.fluid_velocity, before.fluid_velocity),
            ];
            pairs
                .into_iter()
                .for_each(|(after, before)| *after = interpolate(before, *after, fraction));
        }
    }
}

/// Iterates over the arrays of fields by cell.
fn arrays(fields: &mut OutputFields) -> impl Iterator<Item = &mut [f64]> {
    let OutputFields { quantities, plastic_dissipation, .. } = fields;
    let quantities = quantities.iter_mut().map(|own| own.values.as_mut_slice());
    quantities.chain([plastic_dissipation.as_mut_slice()]).filter(|own| !own.is_empty())
}

fn interpolate(before: f64, after: f64, fraction: f64) -> f64 {
    (1.0 - fraction) * before + fraction * after
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::simulate::{FaceRecord, FieldQuantity, JointFace};

    /// Fields of 3 × 70,000 cells whose values are known by cell and grow by `rate` per layer.
    struct Known {
        rate: f64,
    }

    const LAYERS: usize = 70_000;

    impl FieldSource for Known {
        fn describe(&self) -> OutputFields {
            let record =
                FaceRecord { slip: self.rate, slip_time: self.rate, ..FaceRecord::default() };
            let face =
                JointFace { position: [0.0; 2], axis: 0, length: 1.0, joint_index: 0, record };
            let names = ["v1", "sigma12"].map(str::to_owned);
            OutputFields {
                quantities: names.map(|name| FieldQuantity::new(name, Vec::new())).to_vec(),
                joint_faces: vec![face],
                ..OutputFields::default()
            }
        }

        fn layer_count(&self) -> usize {
            LAYERS
        }

        fn layer_size(&self) -> usize {
            3
        }

        fn read_layers(&self, layers: Range<usize>) -> io::Result<OutputFields> {
            let values = |array: f64| -> Vec<f64> {
                let cells = layers.start * 3..layers.end * 3;
                cells
                    .map(|cell| array + (cell % 3) as f64 + self.rate * (cell / 3) as f64)
                    .collect()
            };
            let mut fields = self.describe();
            for (index, own) in fields.quantities.iter_mut().enumerate() {
                own.values = values(10.0 * index as f64);
            }
            Ok(OutputFields { plastic_dissipation: values(0.5), ..fields })
        }
    }

    /// Verifies values between two states that grow linearly from layer to layer.
    #[test]
    fn stored_fields_are_interpolated() {
        let store = Box::new(io::Cursor::new(Vec::new()));
        let stored = StoredFields::new(&Known { rate: 1.0 }, store).expect("room");
        let layers = LAYERS - 2..LAYERS;
        let mut later = Known { rate: 5.0 }.read_layers(layers.clone()).expect("values");
        stored.interpolate_layers(&layers, 0.25, &mut later).expect("values");
        stored.interpolate_joints(0.25, &mut later);
        // The rates 1 and 5 become 2, but times of events remain those of the later state.
        let mut expected = Known { rate: 2.0 }.read_layers(layers).expect("values");
        expected.joint_faces[0].record.slip_time = 5.0;
        assert_eq!(later, expected);
    }
}
