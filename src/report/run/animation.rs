//! Animation of the snapshots of a run.

use super::joints::{JointScale, create_line_sets, read_joint_lines};
use super::{flow, solid};
use crate::Error;
use crate::case::dynamics::Blocks;
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::JointFace;
use figures::{FieldFigure, GifAnimation};

/// Function that reads the values to be drawn from the bytes of a snapshot, or returns an error message.
type SnapshotReader<'a> = Box<dyn Fn(&[u8]) -> Result<Vec<f64>, String> + 'a>;

/// Function that creates the figure of a snapshot from its time, s, and its values to be drawn.
type FigureBuilder<'a> = Box<dyn Fn(f64, Vec<f64>) -> FieldFigure + 'a>;

/// Converter of the snapshots of a case to the frames of an animation.
pub struct FrameConverter<'a> {
    read_values: SnapshotReader<'a>,
    build_figure: FigureBuilder<'a>,
    /// Blocky medium with joints.
    blocks: Option<&'a Blocks>,
}

/// Scale common to all frames of an animation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameScale {
    /// Largest magnitude of the plotted quantity, the end of the colour scale.
    pub max_magnitude: f64,
    /// Largest slip and opening of joints.
    pub joints: JointScale,
}

impl FrameScale {
    /// Returns the scale of both the frames of `self` and of `other`.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            max_magnitude: self.max_magnitude.max(other.max_magnitude),
            joints: self.joints.max(other.joints),
        }
    }
}

/// Time and values of a snapshot to be drawn.
pub struct AnimationFrame {
    /// Time of the snapshot, s.
    time: f64,
    /// Values to be drawn, in display units, first axis of the picture fastest.
    values: Vec<f64>,
    /// Faces of joints.
    joints: Vec<JointFace>,
}

impl AnimationFrame {
    /// Returns the largest absolute value in the frame, and the largest slip and opening.
    pub fn scale(&self) -> FrameScale {
        FrameScale {
            max_magnitude: self.values.iter().fold(0.0, |sum, value| sum.max(value.abs())),
            joints: JointScale::new(&self.joints),
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
            TimeDomainRun::Solid(dynamics) if dynamics.output.snapshot_interval > 0.0 => {
                let section = solid::PlaneSection::new(dynamics);
                let picture = dynamics.output.plotted_quantity;
                let drawn = solid::PlaneSection::new(dynamics);
                Some(Self {
                    read_values: Box::new(move |bytes| {
                        section.read_snapshot_values(bytes, picture)
                    }),
                    build_figure: Box::new(move |time, values| {
                        drawn.create_figure(case, picture, time, values)
                    }),
                    blocks: dynamics.blocks.as_ref().filter(|blocks| blocks.has_joints()),
                })
            }
            TimeDomainRun::Flow(run) if run.output.snapshot_interval > 0.0 => Some(Self {
                read_values: Box::new(|bytes| flow::read_snapshot_values(bytes, run)),
                build_figure: Box::new(|time, values| flow::create_figure(case, run, time, values)),
                blocks: None,
            }),
            _ => None,
        })
    }

    /// Returns whether the snapshots of the case have files of joints.
    pub fn has_joints(&self) -> bool {
        self.blocks.is_some()
    }

    /// Reads time and values from the bytes of a snapshot.
    ///
    /// # Errors
    /// The bytes are not a snapshot of this case; the error is a message.
    pub fn read_frame(&self, snapshot: &[u8]) -> Result<AnimationFrame, String> {
        let time = files::vti::read_plain_time(snapshot).ok_or("has no time")?;
        Ok(AnimationFrame { time, values: (self.read_values)(snapshot)?, joints: Vec::new() })
    }

    /// Reads the faces of joints of a frame from the bytes of their file.
    ///
    /// # Errors
    /// The bytes are not a file of joints; the error is a message.
    pub fn read_joints(&self, frame: &mut AnimationFrame, joints: &[u8]) -> Result<(), String> {
        frame.joints = read_joint_lines(joints)?;
        Ok(())
    }

    /// Draws the frames as a GIF with a common scale.
    ///
    /// # Errors
    /// A frame is an error or cannot be drawn.
    pub fn draw_animation<E: From<Error>>(
        &self,
        scale: FrameScale,
        frames: impl Iterator<Item = Result<AnimationFrame, E>>,
    ) -> Result<Vec<u8>, E> {
        const SECONDS_PER_FRAME: f64 = 0.1;
        const WIDTH_PIXELS: u32 = 800;
        let animation = GifAnimation::new(Vec::new(), SECONDS_PER_FRAME, WIDTH_PIXELS);
        let mut animation = animation.map_err(Error::from)?;
        for frame in frames {
            let AnimationFrame { time, values, joints } = frame?;
            let mut figure = (self.build_figure)(time, values);
            figure.fixed_limit = Some(scale.max_magnitude);
            if let Some(blocks) = self.blocks {
                figure.line_sets = create_line_sets(blocks, &joints, scale.joints);
            }
            animation.add_frame(&figure).map_err(Error::from)?;
        }
        Ok(animation.finish().map_err(Error::from)?)
    }
}
