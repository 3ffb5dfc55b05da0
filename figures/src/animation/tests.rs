//! Tests of animations.

use super::*;
use crate::field::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use crate::format::FigureFormat;
use crate::growth::LabelledCurve;
use crate::panels::{CurvePanel, PanelsFigure};
use plotters::style::RGBColor;

fn sample_frame(time: f64, is_signed: bool) -> FieldFigure {
    let axis = |label: &str, to: f64| FieldAxis { label: label.to_owned(), start: 0.0, end: to };
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

fn options(frame_count: usize, seconds_per_frame: f64, width: u32) -> AnimationOptions {
    AnimationOptions { format: AnimationFormat::Gif, frame_count, seconds_per_frame, width }
}

/// Decoded content of an APNG.
struct DecodedApng {
    size: [u32; 2],
    frame_count: u32,
    /// Number of repetitions; 0 for endless repetition.
    play_count: u32,
    /// Delay of each frame, s, and its pixels, three bytes per pixel.
    frames: Vec<(f64, Vec<u8>)>,
}

fn decode_apng(bytes: &[u8]) -> DecodedApng {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let size = [reader.info().width, reader.info().height];
    let control = *reader.info().animation_control().unwrap();
    let mut canvas = vec![0; 3 * (size[0] * size[1]) as usize];
    let mut frames = Vec::new();
    for _ in 0..control.num_frames {
        let mut part = vec![0; reader.output_buffer_size().unwrap()];
        let own = reader.next_frame(&mut part).unwrap();
        let frame = *reader.info().frame_control().unwrap();
        assert_eq!([frame.width, frame.height], [own.width, own.height]);
        let lines = part[..own.buffer_size()].chunks_exact(own.line_size);
        for (row, line) in (frame.y_offset as usize..).zip(lines) {
            let start = 3 * (row * size[0] as usize + frame.x_offset as usize);
            canvas[start..start + line.len()].copy_from_slice(line);
        }
        let delay = f64::from(frame.delay_num) / f64::from(frame.delay_den);
        frames.push((delay, canvas.clone()));
    }
    let (frame_count, play_count) = (control.num_frames, control.num_plays);
    DecodedApng { size, frame_count, play_count, frames }
}

/// Frames of an APNG, of which only the changed area is stored, are the drawn pictures with all their colours.
#[test]
fn apng_has_the_drawn_frames() {
    let figures = [0.0, 0.3, 0.3].map(|time| sample_frame(time, true));
    let bytes = animate(&figures, AnimationFormat::Apng, 2.5, 1600).unwrap();
    let DecodedApng { size, frame_count, play_count, frames } = decode_apng(&bytes);
    assert_eq!([frame_count, play_count], [3, 0]);
    for (figure, (delay, pixels)) in figures.iter().zip(&frames) {
        let still = figure.draw(FigureFormat::Png).unwrap();
        assert_eq!(size, crate::tests::png_size(&still));
        assert_eq!(*delay, 2.5);
        assert!(crate::tests::decode_png(&still).1 == *pixels);
    }
    // A frame without changes needs no space.
    let shorter = animate(&figures[..2], AnimationFormat::Apng, 2.5, 1600).unwrap();
    assert!(bytes.len() - shorter.len() < 200);
}

/// Curves are frames with a fixed vertical axis, on which equal values have equal positions.
#[test]
fn curves_are_frames() {
    let frame = |scale: f64| PanelsFigure {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        panels: vec![CurvePanel {
            x_label: "x, m".to_owned(),
            y_label: "v, m/s".to_owned(),
            curves: vec![LabelledCurve {
                label: String::new(),
                points: (0..50).map(f64::from).map(|x| [x, scale * (0.2 * x).sin()]).collect(),
            }],
            y_values: Some([-2.0, 2.0]),
            positions: vec![("border".to_owned(), vec![20.0])],
            ..CurvePanel::default()
        }],
    };
    let figures = [1.0, 2.0].map(frame);
    let gif = decode_gif(&animate(&figures, AnimationFormat::Gif, 0.1, 800).unwrap());
    assert_ne!(gif.frames[0], gif.frames[1]);
    // Columns left of the frame have the names of the axis, which are equal.
    let row = 3 * usize::from(gif.size[0]);
    let left = |frame: &[u8]| frame.chunks_exact(row).flat_map(|own| own[..180].to_vec()).collect();
    let [before, after]: [Vec<u8>; 2] = [left(&gif.frames[0]), left(&gif.frames[1])];
    assert!(before == after && before.iter().any(|byte| *byte < 128));
    let mut free = frame(1.0);
    free.panels[0].y_values = None;
    let error = animate(&[free], AnimationFormat::Gif, 0.1, 800).unwrap_err();
    assert!(error.to_string().contains("one of them has none"));
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
        let pixels = frame.buffer.iter().flat_map(|index| &palette[3 * usize::from(*index)..][..3]);
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
        let bytes = animate(&figures, AnimationFormat::Gif, 0.08, 640).unwrap();
        assert_eq!(&bytes[..6], b"GIF89a");
        let DecodedGif { size, repeat, delays, frames } = decode_gif(&bytes);
        let [width, height] = crate::tests::png_size(&figures[0].draw(FigureFormat::Png).unwrap());
        let expected = f64::from(height) * 640.0 / f64::from(width);
        assert_eq!(size[0], 640);
        assert!((f64::from(size[1]) - expected).abs() <= 0.5);
        assert_eq!(repeat, gif::Repeat::Infinite);
        assert_eq!(frames.len(), 4);
        assert_eq!(delays, [8; 4]);
        assert_ne!(frames[1], frames[2]);
    }
}

#[test]
fn equal_values_have_equal_colours_in_all_frames() {
    for is_signed in [false, true] {
        let figures = [0.0, 0.4, 1.3].map(|time| sample_frame(time, is_signed));
        let DecodedGif { size, frames, .. } =
            decode_gif(&animate(&figures, AnimationFormat::Gif, 0.1, 800).unwrap());
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
    for is_signed in [true, false] {
        let mut bytes = Vec::new();
        let mut animation = Animation::new(&mut bytes, options(15, 0.1, 200)).unwrap();
        let mut figure = sample_frame(0.5, is_signed);
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
        animation.finish().unwrap();
        assert_eq!(decode_gif(&bytes).frames.len(), 15);
    }
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
        assert!(Animation::new(Vec::new(), options(2, seconds, 100)).is_err(), "{seconds}");
    }
    assert!(Animation::new(Vec::new(), options(2, 1.0, 0)).is_err());
    assert!(
        animate::<FieldFigure>(&[], AnimationFormat::Gif, 1.0, 100)
            .unwrap_err()
            .to_string()
            .contains("no frames")
    );
    let mut bytes = Vec::new();
    let mut animation = Animation::new(&mut bytes, options(2, 1.0, 100)).unwrap();
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
    assert!(label_text(animation.add_frame(&doubled)).contains("they have ±1.5 and ±3"));
    let longer = other(&|figure| figure.x.end = 60.0);
    assert!(label_text(animation.add_frame(&longer)).contains("of one size"));
    assert!(label_text(animation.add_frame(&other(&|figure| figure.rows = 3))).contains("values"));
    assert!(animation.add_frame(&sample_frame(0.0, false)).is_err());
    animation.add_frame(&sample_frame(1.0, true)).unwrap();
    assert!(label_text(animation.add_frame(&sample_frame(1.0, true))).contains("more than 2"));
    animation.finish().unwrap();
    assert_eq!(decode_gif(&bytes).frames.len(), 2);
    let mut short = Animation::new(Vec::new(), options(2, 1.0, 100)).unwrap();
    short.add_frame(&sample_frame(1.0, true)).unwrap();
    assert!(label_text(short.finish()).contains("has 1 of 2 frames"));
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
    let mut animation = Animation::new(FailingWriter, options(2, 0.1, 100)).unwrap();
    let problem = animation.add_frame(&sample_frame(0.0, true)).unwrap_err().to_string();
    assert!(problem.contains("disk full"), "{problem}");
    assert!(
        animation.add_frame(&sample_frame(0.0, true)).unwrap_err().to_string().contains("lost")
    );
    assert!(animation.finish().is_err());
}
