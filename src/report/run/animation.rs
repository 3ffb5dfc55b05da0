//! Animation of the snapshots of a run.

use super::{flow, solid};
use crate::Error;
use crate::case::{Case, TimeDomainRun};
use figures::{FieldFigure, GifAnimation};

/// Function that reads the values to be drawn from the bytes of a snapshot, or returns an error message.
type SnapshotReader<'a> = Box<dyn Fn(&[u8]) -> Result<Vec<f64>, String> + 'a>;

/// Function that creates the figure of a snapshot from its time, s, and its values to be drawn.
type FigureBuilder<'a> = Box<dyn Fn(f64, Vec<f64>) -> FieldFigure + 'a>;

/// Converter of the snapshots of a case to the frames of an animation.
pub struct FrameConverter<'a> {
    read_values: SnapshotReader<'a>,
    build_figure: FigureBuilder<'a>,
}

/// Time and values of a snapshot to be drawn.
pub struct AnimationFrame {
    /// Time of the snapshot, s.
    time: f64,
    /// Values to be drawn, in display units, first axis of the picture fastest.
    values: Vec<f64>,
}

impl AnimationFrame {
    /// Returns the largest absolute value in the frame.
    pub fn max_magnitude(&self) -> f64 {
        self.values.iter().fold(0.0, |sum, value| sum.max(value.abs()))
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
                })
            }
            TimeDomainRun::Flow(run) if run.output.snapshot_interval > 0.0 => Some(Self {
                read_values: Box::new(|bytes| flow::read_snapshot_values(bytes, run)),
                build_figure: Box::new(|time, values| flow::create_figure(case, run, time, values)),
            }),
            _ => None,
        })
    }

    /// Reads time and values from the bytes of a snapshot.
    ///
    /// # Errors
    /// The bytes are not a snapshot of this case; the error is a message.
    pub fn read_frame(&self, snapshot: &[u8]) -> Result<AnimationFrame, String> {
        let time = files::vti::read_plain_time(snapshot).ok_or("has no time")?;
        Ok(AnimationFrame { time, values: (self.read_values)(snapshot)? })
    }

    /// Draws the frames as a GIF with a common colour scale, which ends at the magnitude `max_magnitude`.
    ///
    /// # Errors
    /// A frame is an error or cannot be drawn.
    pub fn draw_animation<E: From<Error>>(
        &self,
        max_magnitude: f64,
        frames: impl Iterator<Item = Result<AnimationFrame, E>>,
    ) -> Result<Vec<u8>, E> {
        const SECONDS_PER_FRAME: f64 = 0.1;
        const WIDTH_PIXELS: u32 = 800;
        let animation = GifAnimation::new(Vec::new(), SECONDS_PER_FRAME, WIDTH_PIXELS);
        let mut animation = animation.map_err(Error::from)?;
        for frame in frames {
            let AnimationFrame { time, values } = frame?;
            let mut figure = (self.build_figure)(time, values);
            figure.fixed_limit = Some(max_magnitude);
            animation.add_frame(&figure).map_err(Error::from)?;
        }
        Ok(animation.finish().map_err(Error::from)?)
    }
}
