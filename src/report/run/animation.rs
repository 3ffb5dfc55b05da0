//! Animation of the snapshots of a run.

use super::{flow, solid};
use crate::Error;
use crate::case::{Case, InTime};
use figures::{Animation, FieldFigure};

/// Function from the bytes of a snapshot to the values to be drawn, or an error message.
type Values<'a> = Box<dyn Fn(&[u8]) -> Result<Vec<f64>, String> + 'a>;

/// Function from a time, s, and the values of its snapshot to a figure.
type Figure<'a> = Box<dyn Fn(f64, Vec<f64>) -> FieldFigure + 'a>;

/// Conversion of snapshots of a case to frames of an animation.
pub struct Frames<'a> {
    values: Values<'a>,
    figure: Figure<'a>,
}

/// Time and values of a snapshot to be drawn.
pub struct Frame {
    /// Time of the snapshot, s.
    time: f64,
    values: Vec<f64>,
}

impl Frame {
    /// Returns the greatest absolute value.
    pub fn greatest(&self) -> f64 {
        self.values.iter().fold(0.0, |sum, value| sum.max(value.abs()))
    }
}

impl<'a> Frames<'a> {
    /// Creates the conversion for a case; `None` if the case requests no snapshots.
    ///
    /// # Errors
    /// The case has no simulation.
    pub fn new(case: &'a Case) -> Result<Option<Self>, Error> {
        Ok(match case.in_time()? {
            InTime::Solid(dynamics) if dynamics.output.snapshot_interval > 0.0 => {
                let section = solid::Section::new(dynamics);
                let picture = dynamics.output.picture;
                let drawn = solid::Section::new(dynamics);
                Some(Self {
                    values: Box::new(move |bytes| section.of_snapshot(bytes, picture)),
                    figure: Box::new(move |time, values| drawn.figure(case, picture, time, values)),
                })
            }
            InTime::Flow(run) if run.output.snapshot_interval > 0.0 => Some(Self {
                values: Box::new(|bytes| flow::of_snapshot(bytes, run)),
                figure: Box::new(|time, values| flow::figure(case, run, time, values)),
            }),
            _ => None,
        })
    }

    /// Reads time and values from the bytes of a snapshot.
    ///
    /// # Errors
    /// The bytes are not a snapshot of this case; a message.
    pub fn frame(&self, snapshot: &[u8]) -> Result<Frame, String> {
        let time = files::vti::plain_time(snapshot).ok_or("has no time")?;
        Ok(Frame { time, values: (self.values)(snapshot)? })
    }

    /// Draws the frames as a GIF with a common colour scale up to `greatest`.
    ///
    /// # Errors
    /// A frame is an error or cannot be drawn.
    pub fn animation<E: From<Error>>(
        &self,
        greatest: f64,
        frames: impl Iterator<Item = Result<Frame, E>>,
    ) -> Result<Vec<u8>, E> {
        const SECONDS_PER_FRAME: f64 = 0.1;
        const WIDTH: u32 = 800;
        let animation = Animation::new(Vec::new(), SECONDS_PER_FRAME, WIDTH);
        let mut animation = animation.map_err(Error::from)?;
        for frame in frames {
            let Frame { time, values } = frame?;
            let mut figure = (self.figure)(time, values);
            figure.scale = Some(greatest);
            animation.add(&figure).map_err(Error::from)?;
        }
        Ok(animation.finish().map_err(Error::from)?)
    }
}
