//! Animation of the snapshots of a run.

use super::joints::{
    JointLineScale, create_face_line_sets, create_line_sets, face_value, read_joint_lines,
};
use super::profile::create_profile;
use super::{flow, solid};
use crate::Error;
use crate::case::dynamics::{Blocks, FaceQuantity, PlottedQuantity};
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::JointFace;
use figures::{Animation, AnimationFormat, AnimationOptions, FieldFigure, FrameFigure};

/// Function that reads the values to be drawn from the bytes of a snapshot, or returns an error message.
type SnapshotReader<'a> = Box<dyn Fn(&[u8]) -> Result<Vec<f64>, String> + 'a>;

/// Function that reads the region of each cell of the picture from the bytes of a snapshot; empty without regions.
type RegionReader<'a> = Box<dyn Fn(&[u8]) -> Vec<u16> + 'a>;

/// Function that creates the figure of a snapshot from its time, s, and its values to be drawn.
type FigureBuilder<'a> = Box<dyn Fn(f64, Vec<f64>) -> FieldFigure + 'a>;

/// Converter of the snapshots of a case to the frames of an animation.
pub struct FrameConverter<'a> {
    read_values: SnapshotReader<'a>,
    /// Reader of the regions of the cells; `None` if the medium has none.
    read_regions: Option<RegionReader<'a>>,
    build_figure: FigureBuilder<'a>,
    /// Blocks and joints of a blocky medium; `None` for other media.
    jointed_blocks: Option<&'a Blocks>,
    /// Plotted quantity of the faces of joints; `None` if values of cells are plotted.
    face_quantity: Option<FaceQuantity>,
}

/// Scales and line widths common to all frames of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameScale {
    /// Least and greatest value of the plotted quantity, in display units.
    pub value_range: [f64; 2],
    /// Whether colours follow the square root of the magnitude, as in the picture of the last snapshot.
    pub is_root_scaled: bool,
    /// Largest slip and opening of joints, which determine line widths.
    pub joint_line_scale: JointLineScale,
}

impl Default for FrameScale {
    /// Returns the scale of no frames.
    fn default() -> Self {
        Self {
            value_range: [f64::INFINITY, f64::NEG_INFINITY],
            is_root_scaled: false,
            joint_line_scale: JointLineScale::default(),
        }
    }
}

impl FrameScale {
    /// Returns the scale that fits earlier frames, those of `self`, and later ones.
    #[must_use]
    pub fn and_later(self, later: Self) -> Self {
        let [least, greatest] = self.value_range;
        Self {
            value_range: [least.min(later.value_range[0]), greatest.max(later.value_range[1])],
            is_root_scaled: later.is_root_scaled,
            joint_line_scale: self.joint_line_scale.max(later.joint_line_scale),
        }
    }

    /// Returns the largest magnitude of the plotted quantity, which is the end of the colour scale; 0 without values.
    pub fn max_magnitude(&self) -> f64 {
        self.value_range
            .iter()
            .filter(|end| end.is_finite())
            .fold(0.0, |sum, end| sum.max(end.abs()))
    }
}

/// Time and values of a snapshot to be drawn.
pub struct AnimationFrame {
    /// Simulated time of the snapshot, s.
    snapshot_time: f64,
    /// Values to be drawn, in display units, first axis of the picture fastest.
    values: Vec<f64>,
    /// Region of each cell, in the order of the picture; empty for a single material.
    regions: Vec<u16>,
    /// Faces of the joints of a blocky medium, with their states; empty without joints.
    joint_faces: Vec<JointFace>,
    /// Plotted quantity of the faces, if the values of cells are not plotted.
    face_quantity: Option<FaceQuantity>,
    /// Whether waves in a solid are weak beside its largest values.
    has_weak_waves: bool,
}

impl AnimationFrame {
    /// Returns the scale of this frame alone: the range of its values, and the largest slip and opening.
    pub fn scale(&self) -> FrameScale {
        let faces = self.face_quantity.into_iter().flat_map(|quantity| {
            self.joint_faces.iter().map(move |face| face_value(&face.record, quantity))
        });
        let plotted = self.values.iter().copied().chain(faces);
        let FrameScale { value_range, .. } = FrameScale::default();
        FrameScale {
            value_range: plotted
                .filter(|value| value.is_finite())
                .fold(value_range, |[least, greatest], value| {
                    [least.min(value), greatest.max(value)]
                }),
            is_root_scaled: self.has_weak_waves,
            joint_line_scale: JointLineScale::new(&self.joint_faces),
        }
    }
}

impl<'a> FrameConverter<'a> {
    /// Creates the converter of a case; `None` if the case requests no snapshots.
    ///
    /// # Errors
    /// The case has no simulation.
    pub fn new(case: &'a Case) -> Result<Option<Self>, Error> {
        Ok(match case.time_domain_run()? {
            TimeDomainRun::Solid(solid_run) if solid_run.output.snapshot_interval > 0.0 => {
                let section = solid::PlaneSection::new(solid_run);
                let picture = solid_run.output.plotted_quantity;
                let drawn = solid::PlaneSection::new(solid_run);
                let regions = solid::PlaneSection::new(solid_run);
                Some(Self {
                    read_values: Box::new(move |bytes| {
                        section.read_snapshot_values(bytes, picture)
                    }),
                    read_regions: Some(Box::new(move |bytes| regions.read_snapshot_regions(bytes))),
                    build_figure: Box::new(move |time, values| {
                        drawn.create_figure(case, picture, time, values)
                    }),
                    jointed_blocks: solid_run.blocks.as_ref().filter(|blocks| blocks.has_joints()),
                    face_quantity: match picture {
                        PlottedQuantity::Face(quantity) => Some(quantity),
                        _ => None,
                    },
                })
            }
            TimeDomainRun::Flow(run) if run.output.snapshot_interval > 0.0 => Some(Self {
                read_values: Box::new(|bytes| flow::read_snapshot_values(bytes, run)),
                read_regions: None,
                build_figure: Box::new(|time, values| flow::create_figure(case, run, time, values)),
                jointed_blocks: None,
                face_quantity: None,
            }),
            _ => None,
        })
    }

    /// Returns whether the snapshots of the case have files of joints.
    pub fn has_joints(&self) -> bool {
        self.jointed_blocks.is_some()
    }

    /// Reads time and values from the bytes of a snapshot.
    ///
    /// # Errors
    /// The bytes are not a snapshot of this case; the error is a message.
    pub fn read_frame(&self, snapshot: &[u8]) -> Result<AnimationFrame, String> {
        let time = files::vti::read_plain_time(snapshot).ok_or("has no time")?;
        let values = (self.read_values)(snapshot)?;
        let is_solid = self.read_regions.is_some();
        Ok(AnimationFrame {
            snapshot_time: time,
            has_weak_waves: is_solid && solid::has_weak_waves(&values),
            values,
            regions: self.read_regions.as_ref().map_or_else(Vec::new, |read| read(snapshot)),
            joint_faces: Vec::new(),
            face_quantity: self.face_quantity,
        })
    }

    /// Reads the faces of joints of a frame from the bytes of their file.
    ///
    /// # Errors
    /// The bytes are not a file of joints; the error is a message.
    pub fn read_joints(&self, frame: &mut AnimationFrame, joints: &[u8]) -> Result<(), String> {
        frame.joint_faces = read_joint_lines(joints)?;
        Ok(())
    }

    /// Draws `frame_count` frames as an animation with common scales, shown for at least 5 s in total: fields, or
    /// curves if there is a single row of cells.
    ///
    /// # Errors
    /// A frame is an error or cannot be drawn.
    pub fn draw_animation<E: From<Error>>(
        &self,
        format: AnimationFormat,
        scale: FrameScale,
        frame_count: usize,
        frames: impl Iterator<Item = Result<AnimationFrame, E>>,
    ) -> Result<Vec<u8>, E> {
        const MIN_SECONDS_PER_FRAME: f64 = 0.1;
        const MIN_SECONDS: f64 = 5.0;
        const WIDTH_PIXELS: u32 = 800;
        // The time of a frame is rounded to hundredths of a second.
        let hundredths = (100.0 * MIN_SECONDS / frame_count.max(1) as f64).ceil();
        let options = AnimationOptions {
            format,
            frame_count,
            seconds_per_frame: (0.01 * hundredths).max(MIN_SECONDS_PER_FRAME),
            width: WIDTH_PIXELS,
        };
        let mut bytes = Vec::new();
        let mut animation = Animation::new(&mut bytes, options).map_err(Error::from)?;
        for frame in frames {
            let figure = self.create_figure(scale, frame?);
            let profile = create_profile(&figure, Some(scale.value_range));
            let frame = profile.as_ref().map_or(FrameFigure::Field(&figure), FrameFigure::Curves);
            animation.add_frame(frame).map_err(Error::from)?;
        }
        animation.finish().map_err(Error::from)?;
        Ok(bytes)
    }

    /// Creates the figure of a frame.
    fn create_figure(&self, scale: FrameScale, frame: AnimationFrame) -> FieldFigure {
        let AnimationFrame { snapshot_time, values, joint_faces, regions, .. } = frame;
        let mut figure = (self.build_figure)(snapshot_time, values);
        figure.fixed_limit = Some(scale.max_magnitude());
        figure.is_root_scaled = scale.is_root_scaled && figure.is_signed;
        figure.material_indices = regions;
        if let Some(blocks) = self.jointed_blocks {
            figure.line_sets = match self.face_quantity {
                Some(quantity) => create_face_line_sets(blocks, &joint_faces, quantity),
                None => create_line_sets(blocks, &joint_faces, scale.joint_line_scale),
            };
        }
        figure
    }
}
