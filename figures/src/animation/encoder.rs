//! Encoders of the frames of an animation.

use super::FrameTiming;
use super::palette::Palette;
use crate::error::FigureError;
use crate::picture::Colour;
use std::io::Write;

/// Encoder of frames of equal size, given as three bytes per pixel.
pub(super) enum FrameEncoder<W: Write> {
    Gif { encoder: gif::Encoder<W>, palette: Palette, size: [u16; 2], delay: u16 },
    Apng { writer: png::Writer<W>, width: usize, previous: Vec<u8> },
}

impl<W: Write> FrameEncoder<W> {
    pub(super) fn new_gif(
        writer: W,
        size: [u16; 2],
        timing: FrameTiming,
        colours: &[Colour],
    ) -> Result<Self, FigureError> {
        let palette = Palette::new(colours);
        let mut encoder = gif::Encoder::new(writer, size[0], size[1], &palette.to_bytes())?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        Ok(Self::Gif { encoder, palette, size, delay: timing.delay })
    }

    pub(super) fn new_apng(
        writer: W,
        size: [u16; 2],
        timing: FrameTiming,
    ) -> Result<Self, FigureError> {
        let [width, height] = size.map(u32::from);
        let mut encoder = png::Encoder::new(writer, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        // Zero plays are endless repetition.
        encoder.set_animated(timing.count, 0)?;
        encoder.set_frame_delay(timing.delay, 100)?;
        let writer = encoder.write_header()?;
        Ok(Self::Apng { writer, width: usize::from(size[0]), previous: Vec::new() })
    }

    pub(super) fn write_frame(&mut self, pixels: &[u8]) -> Result<(), FigureError> {
        match self {
            Self::Gif { encoder, palette, size, delay } => {
                let frame = gif::Frame {
                    delay: *delay,
                    width: size[0],
                    height: size[1],
                    buffer: palette.index_pixels(pixels).into(),
                    ..gif::Frame::default()
                };
                encoder.write_frame(&frame)?;
            }
            Self::Apng { writer, width, previous } => {
                if previous.is_empty() {
                    writer.write_image_data(pixels)?;
                } else {
                    // Only the area that has changed is written.
                    let [from, to] = changed_area(previous, pixels, *width);
                    let size = [0, 1].map(|axis| (to[axis] - from[axis]) as u32);
                    writer.reset_frame_position()?;
                    writer.set_frame_dimension(size[0], size[1])?;
                    writer.set_frame_position(from[0] as u32, from[1] as u32)?;
                    let rows = pixels.chunks_exact(3 * *width).take(to[1]).skip(from[1]);
                    let part = rows.flat_map(|row| &row[3 * from[0]..3 * to[0]]);
                    writer.write_image_data(&part.copied().collect::<Vec<u8>>())?;
                }
                previous.clear();
                previous.extend_from_slice(pixels);
            }
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Result<(), FigureError> {
        match self {
            Self::Gif { encoder, .. } => {
                let mut writer = encoder.into_inner()?;
                Ok(writer.flush().map_err(gif::EncodingError::from)?)
            }
            Self::Apng { writer, .. } => Ok(writer.finish()?),
        }
    }
}

/// Returns the first column and row, and those after the last, of the area in which two frames differ; that of the first
/// pixel if they are equal.
fn changed_area(before: &[u8], after: &[u8], width: usize) -> [[usize; 2]; 2] {
    let mut area = [[usize::MAX; 2], [0; 2]];
    let rows = before.chunks_exact(3 * width).zip(after.chunks_exact(3 * width));
    for (row, (old, new)) in rows.enumerate().filter(|(_, (old, new))| old != new) {
        let is_different = |byte: &usize| old[*byte] != new[*byte];
        let [Some(first), Some(last)] =
            [(0..3 * width).find(is_different), (0..3 * width).rfind(is_different)]
        else {
            continue;
        };
        let [from, to] = &mut area;
        *from = [from[0].min(first / 3), from[1].min(row)];
        *to = [to[0].max(last / 3 + 1), row + 1];
    }
    if area[1][1] == 0 { [[0; 2], [1; 2]] } else { area }
}
