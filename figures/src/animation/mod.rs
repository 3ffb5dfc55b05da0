//! Animations of time-dependent fields and curves as GIF and APNG.

mod encoder;
mod frame;
mod palette;
#[cfg(test)]
mod tests;

pub use frame::FrameFigure;

use crate::error::FigureError;
use encoder::FrameEncoder;
use frame::FrameScale;
use std::io::Write;

/// File format of an animation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimationFormat {
    /// GIF with 256 colours.
    Gif,
    /// Animated PNG with all colours; its first frame is also the picture that programs without animations show.
    Apng,
}

impl AnimationFormat {
    /// Returns the file name extension of the format, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Gif => "gif",
            Self::Apng => "apng",
        }
    }
}

/// Options of an animation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnimationOptions {
    /// File format.
    pub format: AnimationFormat,
    /// Number of frames.
    pub frame_count: usize,
    /// Time for which each frame is shown, s; rounded to hundredths of a second, of which viewers require at least two.
    pub seconds_per_frame: f64,
    /// Width, pixels; reduced to 1600, the width of a figure, if larger. The height follows from the first frame.
    pub width: u32,
}

/// Animation of figures, written frame by frame, so that only one frame is in memory.
///
/// Frames must have the same size and scales: for fields [`fixed_limit`](crate::FieldFigure::fixed_limit),
/// [`is_signed`](crate::FieldFigure::is_signed) and [`is_root_scaled`](crate::FieldFigure::is_root_scaled), for curves [`y_values`](crate::CurvePanel::y_values). Axes, marks and
/// labels should not change either. All frames of a GIF share one palette that contains the colours of the fields, so
/// that a value has the same colour in all frames. The animation repeats indefinitely.
///
/// A refused frame leaves the written frames unchanged. The file is incomplete until [`Animation::finish`].
pub struct Animation<W: Write> {
    state: AnimationState<W>,
    frame_timing: FrameTiming,
    frame_width: u16,
    format: AnimationFormat,
    written_count: usize,
}

/// Number of frames, and the time for which each is shown.
#[derive(Clone, Copy)]
struct FrameTiming {
    count: u32,
    /// Frame delay in hundredths of a second.
    delay: u16,
}

enum AnimationState<W: Write> {
    NoFrames(W),
    Encoding(Box<StartedAnimation<W>>),
    /// The writer was lost after an error.
    WriterLost,
}

/// Encoder and the properties fixed by the first frame.
struct StartedAnimation<W: Write> {
    encoder: FrameEncoder<W>,
    /// Width and height of the picture before downscaling, in pixels.
    picture_size: [u32; 2],
    frame_size: [u16; 2],
    scale: FrameScale,
}

/// Draws figures as the frames of an animation and returns the bytes of the file; each frame is shown for
/// `seconds_per_frame` and is `width` pixels wide. See [`Animation`].
///
/// # Errors
/// An error of [`Animation::new`], [`Animation::add_frame`] or [`Animation::finish`].
pub fn animate<'a, F>(
    frames: &'a [F],
    format: AnimationFormat,
    seconds_per_frame: f64,
    width: u32,
) -> Result<Vec<u8>, FigureError>
where
    FrameFigure<'a>: From<&'a F>,
{
    let mut bytes = Vec::new();
    let options = AnimationOptions { format, frame_count: frames.len(), seconds_per_frame, width };
    let mut animation = Animation::new(&mut bytes, options)?;
    for frame in frames {
        animation.add_frame(frame)?;
    }
    animation.finish()?;
    Ok(bytes)
}

impl<W: Write> Animation<W> {
    /// Creates an animation without frames.
    ///
    /// # Errors
    /// The frame delay is outside 0.02 s to 655.35 s after rounding, the width is 0, or there are no frames or more
    /// than 2³¹.
    pub fn new(writer: W, options: AnimationOptions) -> Result<Self, FigureError> {
        let AnimationOptions { format, frame_count, seconds_per_frame, width } = options;
        let hundredths = (100.0 * seconds_per_frame).round();
        if !(2.0..=f64::from(u16::MAX)).contains(&hundredths) {
            return animation_error(format!(
                "cannot show each frame for {seconds_per_frame} s, but for 0.02 s to 655 s"
            ));
        }
        if width == 0 {
            return animation_error("cannot be 0 pixels wide".to_owned());
        }
        let count = match i32::try_from(frame_count) {
            Ok(0) => return animation_error("has no frames".to_owned()),
            Ok(count) => count.unsigned_abs(),
            Err(_) => return animation_error(format!("cannot have {frame_count} frames")),
        };
        let width = width.min(crate::page::WIDTH as u32) as u16;
        Ok(Self {
            state: AnimationState::NoFrames(writer),
            frame_timing: FrameTiming { count, delay: hundredths as u16 },
            frame_width: width,
            format,
            written_count: 0,
        })
    }

    /// Draws a frame and writes it to the file.
    ///
    /// # Errors
    /// The frame has no fixed scale or another scale or size than the first frame, is one too many, cannot be drawn or
    /// written, or the writer was lost in an earlier error.
    pub fn add_frame<'a>(&mut self, figure: impl Into<FrameFigure<'a>>) -> Result<(), FigureError> {
        let figure = figure.into();
        let Some(scale) = figure.scale() else {
            return animation_error(
                "needs frames of one scale, but one of them has none".to_owned(),
            );
        };
        let count = self.frame_timing.count as usize;
        if self.written_count == count {
            return animation_error(format!("has more than {count} frames"));
        }
        let picture = figure.to_picture()?;
        let picture_size = [picture.width, picture.height];
        if let AnimationState::Encoding(started) = &self.state {
            if started.scale != scale {
                return animation_error(format!(
                    "needs frames of one scale, but they have {} and {scale}",
                    started.scale
                ));
            }
            if started.picture_size != picture_size {
                let [width, height] = started.picture_size;
                return animation_error(format!(
                    "needs frames of one size, but they have {width} × {height} and {} × {} pixels",
                    picture_size[0], picture_size[1]
                ));
            }
        }
        let pixels = picture.render_pixels()?;
        if matches!(self.state, AnimationState::NoFrames(_)) {
            self.start_encoding(figure, scale, picture_size)?;
        }
        let AnimationState::Encoding(started) = &mut self.state else {
            return animation_error("has lost its writer in an earlier failure".to_owned());
        };
        let small = downscale(&pixels, started.picture_size, started.frame_size);
        started.encoder.write_frame(&small)?;
        self.written_count += 1;
        Ok(())
    }

    /// Writes the header; size and colours are those of the first frame.
    fn start_encoding(
        &mut self,
        figure: FrameFigure,
        scale: FrameScale,
        picture_size: [u32; 2],
    ) -> Result<(), FigureError> {
        let AnimationState::NoFrames(writer) =
            std::mem::replace(&mut self.state, AnimationState::WriterLost)
        else {
            return Ok(());
        };
        let share = f64::from(self.frame_width) / f64::from(picture_size[0]);
        let height = (f64::from(picture_size[1]) * share).round().clamp(1.0, f64::from(u16::MAX));
        let frame_size = [self.frame_width, height as u16];
        let encoder = match self.format {
            AnimationFormat::Gif => {
                FrameEncoder::new_gif(writer, frame_size, self.frame_timing, &figure.colours())?
            }
            AnimationFormat::Apng => FrameEncoder::new_apng(writer, frame_size, self.frame_timing)?,
        };
        let started = StartedAnimation { encoder, picture_size, frame_size, scale };
        self.state = AnimationState::Encoding(Box::new(started));
        Ok(())
    }

    /// Completes the file.
    ///
    /// # Errors
    /// Frames are missing, writing fails, or the writer was lost in an earlier error.
    pub fn finish(self) -> Result<(), FigureError> {
        let count = self.frame_timing.count as usize;
        match self.state {
            AnimationState::WriterLost => {
                animation_error("has lost its writer in an earlier failure".to_owned())
            }
            _ if self.written_count < count => {
                animation_error(format!("has {} of {count} frames", self.written_count))
            }
            AnimationState::Encoding(started) => started.encoder.finish(),
            AnimationState::NoFrames(_) => animation_error("has no frames".to_owned()),
        }
    }
}

/// Returns the error of an invalid animation.
fn animation_error<T>(problem: String) -> Result<T, FigureError> {
    Err(FigureError::Animation(problem))
}

/// Downscales a picture of three bytes per pixel: each target pixel is the mean over the area it covers.
fn downscale(pixels: &[u8], from: [u32; 2], to: [u16; 2]) -> Vec<u8> {
    let [[columns, width], [rows, height]] =
        [0, 1].map(|axis| [from[axis] as usize, usize::from(to[axis])]);
    // Integer units: a source pixel is `count` units long, a target pixel `all` units.
    let parts = |all: usize, count: usize, index: usize| {
        let (start, end) = (index * all, (index + 1) * all);
        (start / count..end.div_ceil(count)).map(move |source| {
            let overlap = ((source + 1) * count).min(end) - (source * count).max(start);
            (source, overlap as u64)
        })
    };
    let area = (columns * rows) as u64;
    let mut small = Vec::with_capacity(3 * width * height);
    let mut sums = vec![0_u64; 3 * columns];
    for y in 0..height {
        sums.fill(0);
        for (row, weight) in parts(rows, height, y) {
            let line = &pixels[3 * columns * row..3 * columns * (row + 1)];
            for (sum, value) in sums.iter_mut().zip(line) {
                *sum += weight * u64::from(*value);
            }
        }
        for x in 0..width {
            let mut means = [area / 2; 3];
            for (column, weight) in parts(columns, width, x) {
                for (mean, sum) in means.iter_mut().zip(&sums[3 * column..]) {
                    *mean += weight * sum;
                }
            }
            small.extend(means.map(|mean| (mean / area) as u8));
        }
    }
    small
}
