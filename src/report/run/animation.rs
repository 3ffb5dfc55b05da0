//! The animation of the snapshots of a run.

use super::{flow, solid};
use crate::Error;
use crate::case::{Case, InTime};
use figures::{Animation, FieldFigure};

/// The values of a snapshot, or why it has none.
type Values<'a> = Box<dyn Fn(&[u8]) -> Result<Vec<f64>, String> + 'a>;

/// The figure of such values at a time, s.
type Figure<'a> = Box<dyn Fn(f64, Vec<f64>) -> FieldFigure + 'a>;

/// How snapshots of a case become the frames of an animation.
pub struct Frames<'a> {
    values: Values<'a>,
    figure: Figure<'a>,
}

/// What is drawn of a snapshot.
pub struct Frame {
    /// Its time, s.
    time: f64,
    values: Vec<f64>,
}

impl Frame {
    /// Greatest magnitude of the values.
    pub fn greatest(&self) -> f64 {
        self.values.iter().fold(0.0, |sum, value| sum.max(value.abs()))
    }
}

impl<'a> Frames<'a> {
    /// Those of a case; `None` where it asks for no snapshots.
    ///
    /// # Errors
    /// The case does not say how it is run in time.
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

    /// What is drawn of the file of a snapshot.
    ///
    /// # Errors
    /// Why it is no snapshot of this case.
    pub fn frame(&self, snapshot: &[u8]) -> Result<Frame, String> {
        let time = files::vti::plain_time(snapshot).ok_or("has no time")?;
        Ok(Frame { time, values: (self.values)(snapshot)? })
    }

    /// A GIF of frames one after the other, in one scale of colours up to `greatest`.
    ///
    /// # Errors
    /// That of a frame, or one cannot be drawn.
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
