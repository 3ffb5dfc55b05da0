//! Animated GIFs of time-dependent fields.

use std::collections::HashMap;
use std::io::Write;

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::field::FieldFigure;
use crate::format::FigureFormat;
use crate::picture::{Colour, INK, WHITE};

/// Maximum number of colours of a GIF palette.
const MAX_COLOURS: usize = 256;
/// Number of shades between ink and paper, used for the antialiased edges of letters and lines.
const GREY_COUNT: u8 = 24;
/// Shares of ink in the mixtures of ink and field colours, used for antialiased edges on the field.
const INK_SHARES: [f64; 2] = [0.35, 0.7];

/// Animated GIF of fields, written frame by frame, so that only one frame is in memory.
///
/// All frames share one palette that contains the field colours, so that a value has the same colour in all frames.
/// Frames must have the same [`FieldFigure::fixed_limit`], [`FieldFigure::is_signed`] and picture size; axes, marks and
/// label should not change either. The animation repeats indefinitely.
///
/// A refused frame leaves the written frames unchanged. The file is incomplete until [`GifAnimation::finish`].
pub struct GifAnimation<W: Write> {
    state: EncoderState<W>,
    /// Frame delay in hundredths of a second.
    frame_delay: u16,
    frame_width: u16,
}

enum EncoderState<W: Write> {
    NoFrames(W),
    Encoding(Box<AnimationEncoder<W>>),
    /// The writer was lost after an error.
    WriterLost,
}

/// Properties fixed by the first frame.
struct AnimationEncoder<W: Write> {
    gif_encoder: gif::Encoder<W>,
    palette: Palette,
    /// Width and height of the picture before downscaling, in pixels.
    picture_size: [u32; 2],
    frame_size: [u16; 2],
    fixed_limit: f64,
    is_signed: bool,
}

/// Draws fields as the frames of an animated GIF and returns the bytes of the file; each frame is shown for
/// `seconds_per_frame` and is `width` pixels wide. See [`GifAnimation`].
///
/// # Errors
/// An error of [`GifAnimation::new`], [`GifAnimation::add_frame`] or [`GifAnimation::finish`].
pub fn animate(
    frames: &[FieldFigure],
    seconds_per_frame: f64,
    width: u32,
) -> Result<Vec<u8>, FigureError> {
    let mut animation = GifAnimation::new(Vec::new(), seconds_per_frame, width)?;
    for frame in frames {
        animation.add_frame(frame)?;
    }
    animation.finish()
}

impl<W: Write> GifAnimation<W> {
    /// Creates an animation without frames. `seconds_per_frame` is rounded to hundredths of a second, of which viewers
    /// require at least two. `width` is in pixels and is reduced to 1600, the width of a figure, if larger. The height
    /// follows from the first frame.
    ///
    /// # Errors
    /// The frame delay is outside 0.02 s to 655.35 s after rounding, or the width is 0.
    pub fn new(writer: W, seconds_per_frame: f64, width: u32) -> Result<Self, FigureError> {
        let hundredths = (100.0 * seconds_per_frame).round();
        if !(2.0..=f64::from(u16::MAX)).contains(&hundredths) {
            return animation_error(format!(
                "cannot show each frame for {seconds_per_frame} s, but for 0.02 s to 655 s"
            ));
        }
        if width == 0 {
            return animation_error("cannot be 0 pixels wide".to_owned());
        }
        let width = width.min(crate::page::WIDTH as u32) as u16;
        Ok(Self {
            state: EncoderState::NoFrames(writer),
            frame_delay: hundredths as u16,
            frame_width: width,
        })
    }

    /// Draws a frame and writes it to the file.
    ///
    /// # Errors
    /// The frame has no fixed scale or another scale or size than the first frame, cannot be drawn or written, or the
    /// writer was lost in an earlier error.
    pub fn add_frame(&mut self, figure: &FieldFigure) -> Result<(), FigureError> {
        let Some(fixed_limit) = figure.fixed_limit else {
            return animation_error(
                "needs frames of one scale, but one of them has none".to_owned(),
            );
        };
        let picture = figure.to_picture(FigureFormat::Png)?;
        let picture_size = [picture.width, picture.height];
        if let EncoderState::Encoding(encoder) = &self.state {
            if encoder.fixed_limit != fixed_limit {
                let first = encoder.fixed_limit;
                return animation_error(format!(
                    "needs frames of one scale, but they have {first} and {fixed_limit}"
                ));
            }
            if encoder.is_signed != figure.is_signed {
                let problem = "needs frames of one scale, but only some have a sign";
                return animation_error(problem.to_owned());
            }
            if encoder.picture_size != picture_size {
                let [width, height] = encoder.picture_size;
                return animation_error(format!(
                    "needs frames of one size, but they have {width} × {height} and {} × {} pixels",
                    picture_size[0], picture_size[1]
                ));
            }
        }
        let pixels = picture.render_pixels()?;
        if matches!(self.state, EncoderState::NoFrames(_)) {
            self.start_encoding(figure, fixed_limit, picture_size)?;
        }
        let EncoderState::Encoding(encoder) = &mut self.state else {
            return animation_error("has lost its writer in an earlier failure".to_owned());
        };
        let small = downscale(&pixels, encoder.picture_size, encoder.frame_size);
        let [width, height] = encoder.frame_size;
        let frame = gif::Frame {
            delay: self.frame_delay,
            width,
            height,
            buffer: encoder.palette.index_pixels(&small).into(),
            ..gif::Frame::default()
        };
        Ok(encoder.gif_encoder.write_frame(&frame)?)
    }

    /// Writes the header; size and colours are those of the first frame.
    fn start_encoding(
        &mut self,
        figure: &FieldFigure,
        fixed_limit: f64,
        picture_size: [u32; 2],
    ) -> Result<(), FigureError> {
        let EncoderState::NoFrames(writer) =
            std::mem::replace(&mut self.state, EncoderState::WriterLost)
        else {
            return Ok(());
        };
        let share = f64::from(self.frame_width) / f64::from(picture_size[0]);
        let height = (f64::from(picture_size[1]) * share).round().clamp(1.0, f64::from(u16::MAX));
        let frame_size = [self.frame_width, height as u16];
        let palette = Palette::new(&figure.cell_colours());
        let mut encoder =
            gif::Encoder::new(writer, frame_size[0], frame_size[1], &palette.to_bytes())?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        let is_signed = figure.is_signed;
        let animation_encoder = AnimationEncoder {
            gif_encoder: encoder,
            palette,
            picture_size,
            frame_size,
            fixed_limit,
            is_signed,
        };
        self.state = EncoderState::Encoding(Box::new(animation_encoder));
        Ok(())
    }

    /// Completes the file and returns the writer.
    ///
    /// # Errors
    /// The animation has no frame, writing fails, or the writer was lost in an earlier error.
    pub fn finish(self) -> Result<W, FigureError> {
        match self.state {
            EncoderState::Encoding(encoder) => {
                let mut writer = encoder.gif_encoder.into_inner()?;
                writer.flush().map_err(gif::EncodingError::from)?;
                Ok(writer)
            }
            EncoderState::NoFrames(_) => animation_error("has no frames".to_owned()),
            EncoderState::WriterLost => {
                animation_error("has lost its writer in an earlier failure".to_owned())
            }
        }
    }
}

/// Returns the error of an invalid animation.
fn animation_error<T>(problem: String) -> Result<T, FigureError> {
    Err(FigureError::Animation(problem))
}

/// Palette of an animation, with a cache of the nearest palette colour of each other colour.
struct Palette {
    colours: Vec<[u8; 3]>,
    nearest_index: HashMap<[u8; 3], u8>,
}

impl Palette {
    /// Builds the palette: shades of ink on paper, the colours of a field and, within the remaining capacity, mixtures
    /// of field colours with ink.
    fn new(field: &[Colour]) -> Self {
        let channels = |RGBColor(red, green, blue): Colour| [red, green, blue];
        let mixed = |from: Colour, to: Colour, share: f64| {
            let (from, to) = (channels(from), channels(to));
            [0, 1, 2].map(|part| {
                let (from, to) = (f64::from(from[part]), f64::from(to[part]));
                (from + share * (to - from)).round() as u8
            })
        };
        let mut colours: Vec<[u8; 3]> = Vec::new();
        let mut add = |colour: [u8; 3]| {
            if colours.len() < MAX_COLOURS && !colours.contains(&colour) {
                colours.push(colour);
            }
        };
        for step in 0..GREY_COUNT {
            add(mixed(INK, WHITE, f64::from(step) / f64::from(GREY_COUNT - 1)));
        }
        field.iter().for_each(|colour| add(channels(*colour)));
        let mixture_capacity =
            MAX_COLOURS.saturating_sub(GREY_COUNT.into()).saturating_sub(field.len());
        let every = (INK_SHARES.len() * field.len()).div_ceil(mixture_capacity.max(1)).max(1);
        for colour in field.iter().skip(every / 2).step_by(every) {
            for share in INK_SHARES {
                add(mixed(*colour, INK, share));
            }
        }
        Self { colours, nearest_index: HashMap::new() }
    }

    fn to_bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }

    /// Returns the palette index of the nearest colour for each pixel.
    fn index_pixels(&mut self, pixels: &[u8]) -> Vec<u8> {
        let Self { colours, nearest_index } = self;
        let pixels = pixels.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]);
        let index = |pixel: [u8; 3]| {
            let distance = |colour: &[u8; 3]| -> i32 {
                let parts = colour.iter().zip(pixel).zip([3, 5, 2]);
                parts.map(|((a, b), weight)| weight * (i32::from(*a) - i32::from(b)).pow(2)).sum()
            };
            let nearest = colours.iter().enumerate().min_by_key(|(_, colour)| distance(colour));
            nearest.map_or(0, |(index, _)| index as u8)
        };
        pixels.map(|pixel| *nearest_index.entry(pixel).or_insert_with(|| index(pixel))).collect()
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{FieldAxis, FieldMark, FieldMarkKind};

    fn sample_frame(time: f64, is_signed: bool) -> FieldFigure {
        let axis =
            |label: &str, to: f64| FieldAxis { label: label.to_owned(), start: 0.0, end: to };
        let value = |cell: usize| {
            let (x, y) = ((cell % 60) as f64, (cell / 60) as f64);
            let wave = 2.0 * (0.4 * (x - 30.0).hypot(y - 20.0) - 9.0 * time).sin() * time;
            if is_signed { wave } else { wave.abs() }
        };
        let mut values: Vec<f64> = (0..2400).map(value).collect();
        // One value common to all frames, in a patch of cells with equal values.
        for cell in [0, 1, 2, 60, 61, 62, 120, 121, 122] {
            values[cell] = if is_signed { -0.9375 } else { 0.9375 };
        }
        FieldFigure {
            title: "Title".to_owned(),
            subtitle: format!("t = {time} s"),
            x: axis("x₁, m", 6.0),
            y: axis("x₂, m", 4.0),
            columns: 60,
            rows: 40,
            values,
            label: "velocity v₂, m/s".to_owned(),
            is_signed,
            fixed_limit: Some(1.5),
            has_yielded: vec![false; 2400],
            marks: vec![FieldMark {
                position: [3.0, 2.0],
                name: "R1".to_owned(),
                kind: FieldMarkKind::Receiver,
            }],
            ..FieldFigure::default()
        }
    }

    /// Decoded content of a GIF.
    struct DecodedGif {
        size: [u16; 2],
        repeat: gif::Repeat,
        /// Frame delays in hundredths of a second.
        delays: Vec<u16>,
        /// Pixels of each frame, three bytes per pixel.
        frames: Vec<Vec<u8>>,
    }

    fn decode_gif(bytes: &[u8]) -> DecodedGif {
        let mut decoder = gif::DecodeOptions::new().read_info(bytes).unwrap();
        let size = [decoder.width(), decoder.height()];
        let palette = decoder.global_palette().unwrap().to_vec();
        let (mut delays, mut frames) = (Vec::new(), Vec::new());
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!([frame.width, frame.height], size);
            assert!(frame.palette.is_none());
            let pixels =
                frame.buffer.iter().flat_map(|index| &palette[3 * usize::from(*index)..][..3]);
            delays.push(frame.delay);
            frames.push(pixels.copied().collect());
        }
        DecodedGif { size, repeat: decoder.repeat(), delays, frames }
    }

    #[test]
    fn decoded_animation_has_the_written_frames() {
        let times = [0.0, 0.3, 0.6, 1.2];
        for is_signed in [false, true] {
            let figures = times.map(|time| sample_frame(time, is_signed));
            let bytes = animate(&figures, 0.08, 640).unwrap();
            assert_eq!(&bytes[..6], b"GIF89a");
            let DecodedGif { size, repeat, delays, frames } = decode_gif(&bytes);
            let [width, height] =
                crate::tests::png_size(&figures[0].draw(FigureFormat::Png).unwrap());
            let expected = f64::from(height) * 640.0 / f64::from(width);
            assert_eq!(size[0], 640);
            assert!((f64::from(size[1]) - expected).abs() <= 0.5);
            assert_eq!(repeat, gif::Repeat::Infinite);
            assert_eq!(frames.len(), 4);
            assert_eq!(delays, [8; 4]);
            assert_ne!(frames[1], frames[2]);

            let mut animation = GifAnimation::new(Vec::new(), 0.08, 640).unwrap();
            figures.iter().for_each(|figure| animation.add_frame(figure).unwrap());
            assert_eq!(animation.finish().unwrap(), bytes);
        }
    }

    #[test]
    fn equal_values_have_equal_colours_in_all_frames() {
        for is_signed in [false, true] {
            let figures = [0.0, 0.4, 1.3].map(|time| sample_frame(time, is_signed));
            let DecodedGif { size, frames, .. } = decode_gif(&animate(&figures, 0.1, 800).unwrap());
            let [width, height] = size.map(usize::from);
            let pixel = |frame: usize, x: usize, y: usize| {
                let start = 3 * (y * width + x);
                &frames[frame][start..start + 3]
            };
            // The patch is in the lower left corner of the field and has a colour that occurs nowhere else.
            let colours = figures[0].cell_colours();
            let value = if is_signed { 96 - 60 } else { 60 };
            let RGBColor(red, green, blue) = colours[value];
            let found = |frame: usize| -> Vec<(usize, usize)> {
                let all = (0..height).flat_map(|y| (0..width / 2).map(move |x| (x, y)));
                all.filter(|&(x, y)| pixel(frame, x, y) == [red, green, blue]).collect()
            };
            // Contour lines may touch the boundary of the patch, but not its interior.
            let all = found(0);
            let inner: Vec<(usize, usize)> = all
                .iter()
                .copied()
                .filter(|&(x, y)| {
                    let corners = [(x - 5, y - 5), (x + 5, y - 5), (x - 5, y + 5), (x + 5, y + 5)];
                    corners.iter().all(|corner| all.contains(corner))
                })
                .collect();
            assert!(inner.len() > 40, "{}", inner.len());
            for frame in 1..3 {
                assert!(inner.iter().all(|&(x, y)| pixel(frame, x, y) == [red, green, blue]));
                // The colour bar and the area to the right of the field are equal in all frames.
                for (x, y) in
                    (width * 85 / 100..width).flat_map(|x| (0..height * 3 / 4).map(move |y| (x, y)))
                {
                    assert_eq!(pixel(0, x, y), pixel(frame, x, y), "{x} {y}");
                }
            }
        }
    }

    #[test]
    fn frame_size_is_independent_of_values() {
        let mut animation = GifAnimation::new(Vec::new(), 0.1, 200).unwrap();
        for is_signed in [true, false] {
            let mut figure = sample_frame(0.5, is_signed);
            if !is_signed {
                animation = GifAnimation::new(Vec::new(), 0.1, 200).unwrap();
            }
            for value in [0.0, 1.0, -1e-3, 1e300, f64::NAN, f64::NEG_INFINITY, 0.2] {
                figure.values[300..900].fill(value);
                figure.has_yielded[3] = !figure.has_yielded[3];
                animation.add_frame(&figure).unwrap();
                figure.values.fill(value);
                animation.add_frame(&figure).unwrap();
            }
            for (cell, value) in figure.values.iter_mut().enumerate() {
                *value = (cell as f64).powi(3).sin();
            }
            animation.add_frame(&figure).unwrap();
        }
        assert_eq!(decode_gif(&animation.finish().unwrap()).frames.len(), 15);
    }

    #[test]
    fn downscaling_averages_covered_areas() {
        let pixels: Vec<u8> = [10, 20, 40, 70].into_iter().flat_map(|value| [value; 3]).collect();
        assert_eq!(downscale(&pixels, [4, 1], [2, 1]), [15, 15, 15, 55, 55, 55]);
        assert_eq!(downscale(&pixels, [2, 2], [1, 1]), [35; 3]);
        // Each target pixel covers 3/2 source pixels.
        let pixels: Vec<u8> = [30, 60, 90].into_iter().flat_map(|value| [value; 3]).collect();
        assert_eq!(downscale(&pixels, [3, 1], [2, 1]), [40, 40, 40, 80, 80, 80]);
        assert_eq!(downscale(&[77; 3 * 49], [7, 7], [3, 4]), [77; 36]);
        assert_eq!(downscale(&pixels, [3, 1], [3, 1]), pixels);
    }

    #[test]
    fn inconsistent_frames_are_refused() {
        let label_text = |result: Result<(), FigureError>| result.unwrap_err().to_string();
        for seconds in [0.0, 0.01, -1.0, f64::NAN, f64::INFINITY, 1e4] {
            assert!(GifAnimation::new(Vec::new(), seconds, 100).is_err(), "{seconds}");
        }
        assert!(GifAnimation::new(Vec::new(), 1.0, 0).is_err());
        assert!(animate(&[], 1.0, 100).unwrap_err().to_string().contains("no frames"));
        let mut animation = GifAnimation::new(Vec::new(), 1.0, 100).unwrap();
        let other = |change: &dyn Fn(&mut FieldFigure)| {
            let mut figure = sample_frame(1.0, true);
            change(&mut figure);
            figure
        };
        assert!(
            label_text(animation.add_frame(&other(&|figure| figure.fixed_limit = None)))
                .contains("has none")
        );
        animation.add_frame(&sample_frame(0.0, true)).unwrap();
        let doubled = other(&|figure| figure.fixed_limit = Some(3.0));
        assert!(label_text(animation.add_frame(&doubled)).contains("they have 1.5 and 3"));
        let longer = other(&|figure| figure.x.end = 60.0);
        assert!(label_text(animation.add_frame(&longer)).contains("of one size"));
        assert!(
            label_text(animation.add_frame(&other(&|figure| figure.rows = 3))).contains("values")
        );
        assert!(animation.add_frame(&sample_frame(0.0, false)).is_err());
        animation.add_frame(&sample_frame(1.0, true)).unwrap();
        assert_eq!(decode_gif(&animation.finish().unwrap()).frames.len(), 2);
    }

    #[test]
    fn failing_writer_is_reported() {
        struct FailingWriter;
        impl Write for FailingWriter {
            fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
                Err(std::io::Error::other("disk full"))
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let mut animation = GifAnimation::new(FailingWriter, 0.1, 100).unwrap();
        let problem = animation.add_frame(&sample_frame(0.0, true)).unwrap_err().to_string();
        assert!(problem.contains("disk full"), "{problem}");
        assert!(
            animation.add_frame(&sample_frame(0.0, true)).unwrap_err().to_string().contains("lost")
        );
        assert!(animation.finish().is_err());
    }
}
