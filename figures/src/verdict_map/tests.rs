//! Tests of verdict maps.

use super::axes::AxisExtent;
use super::boundaries::Boundaries;
use super::colour_map::{INFINITE_LEVEL_COLOUR, SHADE_COUNT, shade_colour};
use super::figure::STEP_PARTS;
use super::figure::{FillStyle, Hatching, MapCurve, VerdictCategory, VerdictMap, VerdictMapAxis};
use super::hatching::category_fill;
use super::levels::{LevelField, LevelRange};
use super::raster::VerdictRaster;
use super::shares::format_percent;
use crate::colour::luminance;
use crate::format::FigureFormat;
use std::sync::Arc;

use crate::tests::check_drawing;

/// Builds a map whose left half is well-posed and whose right half is ill-posed, with a level that increases to the
/// right.
fn sample_map(columns: usize, rows: usize) -> VerdictMap {
    let axis = |label: &str, points: usize| VerdictMapAxis {
        label: label.to_owned(),
        values: (0..points).map(|index| 10.0 * index as f64).collect(),
        is_log: false,
    };
    let ill_posed = |cell: usize| 2 * (cell % columns) >= columns;
    let level = |cell: usize| {
        if ill_posed(cell) { 1.3_f64.powi((cell % columns) as i32) } else { f64::NAN }
    };
    VerdictMap {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        x: axis("non-coaxiality Δ (°)", columns),
        y: axis("friction angle φ (°)", rows),
        categories: vec![
            VerdictCategory {
                label: "well-posed".to_owned(),
                fill_style: FillStyle::WellPosed,
                level_factor: 1.0,
            },
            VerdictCategory {
                label: "ill-posed, order 1".to_owned(),
                fill_style: FillStyle::IllPosed(Hatching::Plain),
                level_factor: 1.0,
            },
            VerdictCategory {
                label: "indeterminate".to_owned(),
                fill_style: FillStyle::Indeterminate,
                level_factor: 1.0,
            },
        ],
        category_indices: (0..columns * rows).map(|cell| u8::from(ill_posed(cell))).collect(),
        growth_levels: Arc::new((0..columns * rows).map(level).collect()),
        level_label: "growth rate (1/s)".to_owned(),
        boundaries: Default::default(),
        is_line: Arc::default(),
        curves: vec![MapCurve {
            label: "bound".to_owned(),
            points: vec![[45.0, -1e3], [45.0, 1e3]],
        }],
    }
}

fn picture_texts(map: &VerdictMap) -> Vec<String> {
    map.to_picture().unwrap().texts().map(|text| text.content.clone()).collect()
}

/// Checks a verdict map as [`check_drawing`] does.
fn check_map(map: &VerdictMap) {
    check_drawing(&map.to_picture().unwrap(), |format| map.draw(format));
}

#[test]
fn legend_lists_present_categories_with_shares() {
    let texts = picture_texts(&sample_map(20, 6));
    for expected in ["well-posed (50.0 %)", "ill-posed, order 1 (50.0 %)", "bound"] {
        assert!(texts.iter().any(|text| text == expected), "{expected} not in {texts:?}");
    }
    assert!(texts.iter().all(|text| !text.contains("indeterminate")));
    assert_eq!(format_percent(1, 100_000), "<0.1 %");
    assert_eq!(format_percent(99_999, 100_000), ">99.9 %");
    assert_eq!(format_percent(7, 7), "100 %");
}

#[test]
fn cells_have_expected_positions() {
    // The cell at x = 10, y = 20 is at the same position for ascending and for descending axes.
    let mut map = sample_map(4, 3);
    map.curves.clear();
    map.category_indices.fill(0);
    map.category_indices[2 * 4 + 1] = 2;
    let mut turned = map.clone();
    turned.x.values.reverse();
    turned.y.values.reverse();
    turned.category_indices.reverse();
    Arc::make_mut(&mut turned.growth_levels).reverse();
    let drawn = map.draw(FigureFormat::Png).unwrap();
    assert_eq!(drawn, turned.draw(FigureFormat::Png).unwrap());
    let (width, pixels) = crate::tests::decode_png(&drawn);
    let grey = |x: usize, y: usize| pixels[3 * (y * width + x)];
    // In the uppermost row (y = 20) only the second column is dark.
    let dark = |from: usize, to: usize| {
        (from..to).filter(|&x| (200..280).any(|y| grey(x, y) < 200)).count()
    };
    assert!(dark(540, 800) > 200);
    assert_eq!(dark(200, 400) + dark(950, 1400), 0);
}

/// The edges of the area between the axes are the lines of the frame in the picture.
#[test]
fn plot_area_is_inside_the_frame() {
    let mut map = sample_map(4, 3);
    map.curves.clear();
    map.category_indices.fill(0);
    let [left, top, width, height] = map.plot_area().unwrap();
    let (columns, pixels) = crate::tests::decode_png(&map.draw(FigureFormat::Png).unwrap());
    let rows = pixels.len() / (3 * columns);
    let is_dark = |x: f64, y: f64| pixels[3 * (y as usize * columns + x as usize)] < 130;
    let along = |count: usize, start: f64, length: f64| {
        let end = count as f64 * (start + length);
        [count as f64 * start, end - 0.43 * count as f64 * length, end]
    };
    let ([x0, x1, x2], [y0, y1, y2]) = (along(columns, left, width), along(rows, top, height));
    for (x, y, direction) in [(x0, y1, -1.0), (x2, y1, 1.0), (x1, y0, -1.0), (x1, y2, 1.0)] {
        let at = |offset: f64| match y == y1 {
            true => is_dark(x + direction * offset, y),
            false => is_dark(x, y + direction * offset),
        };
        assert!(at(-1.5) || at(0.0) || at(1.5), "{x}, {y}");
        assert!(!at(6.0) && !at(-6.0), "{x}, {y}");
    }
}

/// A set of points on a diagonal is drawn as a line, and its share is zero.
#[test]
fn sets_without_area_are_drawn_as_lines() {
    let mut map = sample_map(9, 9);
    map.category_indices = (0..81).map(|cell| u8::from(cell % 10 != 0)).collect();
    Arc::make_mut(&mut map.growth_levels).fill(1.0);
    map.curves.clear();
    let without = map.draw(FigureFormat::Png).unwrap();
    map.is_line = Arc::new((0..81).map(|cell| cell % 10 == 0).collect());
    check_map(&map);
    let texts = picture_texts(&map);
    for expected in ["well-posed (on lines, 0 %)", "ill-posed, order 1 (100 %)"] {
        assert!(texts.iter().any(|text| text == expected), "{expected} not in {texts:?}");
    }
    assert_ne!(without, map.draw(FigureFormat::Png).unwrap());
    map.boundaries = [STEP_PARTS, 0].map(|parts| Arc::new(vec![parts; 81]));
    check_map(&map);
}

/// A point without neighbours in its set is a disc only if its category has no area: the tip of an area is none.
#[test]
fn tips_of_areas_are_no_single_points() {
    let mut map = sample_map(9, 9);
    map.curves.clear();
    // Ill-posed are the right half and a point in the left half.
    map.category_indices[4 * 9 + 1] = 1;
    map.is_line = Arc::new((0..81).map(|cell| cell == 4 * 9 + 1).collect());
    assert!(map.line_cells().iter().all(|is_line| !is_line));
    check_map(&map);
    for cell in [4 * 9 + 1, 5 * 9 + 2] {
        (map.category_indices[cell], Arc::make_mut(&mut map.is_line)[cell]) = (1, true);
    }
    assert_eq!(map.line_cells().iter().filter(|is_line| **is_line).count(), 2);
}

/// Builds the raster of a level that increases linearly with the distance from an oblique boundary, at which it vanishes;
/// returns it with that distance.
fn half_plane_raster() -> (VerdictRaster, impl Fn([f64; 2]) -> f64) {
    let (columns, rows) = (12, 9);
    let distance = |[x, y]: [f64; 2]| x + 2.3 * y - 10.4;
    let at = |cell: usize| [(cell % columns) as f64, (cell / columns) as f64];
    let cells = || (0..columns * rows).map(at);
    let boundaries = [[1.0, 0.0], [0.0, 1.0]].map(|step: [f64; 2]| {
        let share = |from: [f64; 2]| {
            let next = [from[0] + step[0], from[1] + step[1]];
            distance(from) / (distance(from) - distance(next))
        };
        cells().map(share).collect()
    });
    let raster = VerdictRaster {
        columns,
        rows,
        categories: cells().map(|place| u8::from(distance(place) > 0.0)).collect(),
        levels: cells().map(distance).collect(),
        boundaries,
        is_line: vec![false; columns * rows],
    };
    (raster, distance)
}

/// Between points and up to the boundary, a linear level is exact, whatever values other categories have.
#[test]
fn levels_extend_linearly_to_the_boundary() {
    let (mut raster, distance) = half_plane_raster();
    for (level, category) in raster.levels.iter_mut().zip(&raster.categories) {
        if *category == 0 {
            *level = f64::NAN;
        }
    }
    let field = LevelField::new(&raster, 1, [5.0, 30.0]);
    let mut count = 0;
    for (i, j) in (0..=110).flat_map(|i| (0..=80).map(move |j| (i, j))) {
        let place = [0.1 * f64::from(i), 0.1 * f64::from(j)];
        if distance(place) > 0.0 {
            assert!((field.level_at(place) - distance(place)).abs() < 1e-12, "{place:?}");
            count += 1;
        }
    }
    assert!(count > 1000);
}

/// Contour lines end at the boundary of their category or at the edge of the map, not between points.
#[test]
fn contour_lines_end_at_boundaries() {
    let (mut raster, distance) = half_plane_raster();
    // The levels increase along the boundary, so that their contour lines meet it.
    let columns = raster.columns;
    for (cell, level) in raster.levels.iter_mut().enumerate() {
        *level = 1.0 + (cell % columns) as f64;
    }
    let boundaries = Boundaries::new(&raster);
    let step = 0.01;
    let field = LevelField::new(&raster, 1, [10.0, 10.0]);
    let lines = field.trace_contours(&boundaries, 6.5, step);
    assert_eq!(lines.len(), 1);
    let ends = [lines[0][0], lines[0][lines[0].len() - 1]];
    for end in ends {
        assert!((end[0] - 5.5).abs() < 1e-12);
        assert!(distance(end).abs() < 3.0 * step || end[1] == 8.0, "{end:?}");
    }
    assert!(lines[0].iter().all(|place| distance(*place) > -3.0 * step));
}

/// The colour bar names contour lines only if there are some.
#[test]
fn colour_bar_names_contour_lines() {
    let has_name = |map: &VerdictMap| picture_texts(map).iter().any(|text| text == "contour");
    let mut map = sample_map(40, 6);
    assert!(has_name(&map));
    Arc::make_mut(&mut map.growth_levels).fill(1.0);
    assert!(!has_name(&map));
}

/// Single points of a set without area are drawn as discs, inside the frame.
#[test]
fn single_points_without_area_are_drawn_as_discs() {
    let mut map = sample_map(9, 9);
    map.category_indices = (0..81).map(|cell| u8::from(cell != 0 && cell != 8)).collect();
    Arc::make_mut(&mut map.growth_levels).fill(1.0);
    map.curves.clear();
    map.is_line = Arc::new((0..81).map(|cell| cell == 0 || cell == 8).collect());
    check_map(&map);
    let texts = picture_texts(&map);
    assert!(texts.iter().any(|text| text == "well-posed (at single points, 0 %)"), "{texts:?}");
}

/// Positions on a logarithmic axis are logarithms, its ticks are at decades and, without labels, between them.
#[test]
fn logarithmic_axes_have_ticks_at_decades() {
    let mut map = sample_map(10, 4);
    (map.x.values, map.x.is_log) =
        ((0..10).map(|i| 10_f64.powf(f64::from(i) / 3.0)).collect(), true);
    map.curves[0].points = vec![[100.0, 0.0], [100.0, 30.0]];
    check_map(&map);
    let texts = picture_texts(&map);
    for expected in ["1", "10", "10²", "10³"] {
        assert!(texts.iter().any(|text| text == expected), "{expected} not in {texts:?}");
    }
    let extent = AxisExtent::from_axis(&map.x).unwrap();
    assert!((extent.fraction(100.0) - 2.0 / 3.0).abs() < 1e-12);
    let ticks = extent.ticks(&map.x, 1000.0, false);
    assert_eq!(ticks.iter().filter(|(_, label)| label.is_empty()).count(), 3 * 8);
    let fifty = extent.fraction(50.0);
    assert!(ticks.iter().any(|(share, label)| label.is_empty() && (share - fifty).abs() < 1e-12));
}

#[test]
fn any_number_of_points_is_drawn() {
    for (columns, rows) in [(1, 1), (1, 2), (2, 1), (2, 2), (3, 40), (1700, 2)] {
        check_map(&sample_map(columns, rows));
    }
}

#[test]
fn any_level_is_drawn() {
    for level in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 5e-324, 7.0, f64::MAX] {
        let mut equal = sample_map(8, 5);
        Arc::make_mut(&mut equal.growth_levels).fill(level);
        check_map(&equal);
    }
    for level in [f64::NAN, f64::INFINITY, -1.0, f64::MAX] {
        let mut mixed = sample_map(8, 5);
        Arc::make_mut(&mut mixed.growth_levels)[6] = level;
        check_map(&mixed);
    }
    let mut wide = sample_map(60, 2);
    for (cell, level) in Arc::make_mut(&mut wide.growth_levels).iter_mut().enumerate() {
        *level = 10_f64.powi(10 * (cell as i32 % 60) - 300);
    }
    check_map(&wide);
}

#[test]
fn fill_styles_differ_in_greyscale() {
    use FillStyle::*;
    let styles = [
        WellPosed,
        IllPosed(Hatching::Plain),
        IllPosed(Hatching::Rising),
        IllPosed(Hatching::Falling),
        IllPosed(Hatching::Horizontal),
        IllPosed(Hatching::Vertical),
        IllPosed(Hatching::Grid),
        UnboundedAtFiniteWaveNumber,
        Marginal,
        Indeterminate,
        OutsideModel,
    ];
    let mut map = sample_map(styles.len(), 2);
    map.categories = styles
        .map(|style| VerdictCategory {
            label: format!("{style:?}"),
            fill_style: style,
            level_factor: 1.0,
        })
        .to_vec();
    map.category_indices = (0..2 * styles.len()).map(|cell| (cell % styles.len()) as u8).collect();
    check_map(&map);
    let fills: Vec<(f64, usize, [f64; 2])> = (0..styles.len())
        .map(|index| {
            let (ground, hatches) = category_fill(styles[index]);
            let along = hatches.first().map_or([0.0; 2], |hatch| hatch.direction);
            (luminance(ground), hatches.len(), along)
        })
        .collect();
    for (index, one) in fills.iter().enumerate() {
        for other in &fills[..index] {
            let same_hatch = (one.1, one.2) == (other.1, other.2);
            assert!(!same_hatch || (one.0 - other.0).abs() > 40.0, "{one:?} {other:?}");
        }
    }
}

#[test]
fn luminance_decreases_evenly() {
    let steps: Vec<f64> = (0..SHADE_COUNT)
        .map(|step| luminance(shade_colour(step as f64 / (SHADE_COUNT - 1) as f64)))
        .collect();
    assert!(steps.windows(2).all(|pair| pair[1] < pair[0]));
    assert!(steps.windows(2).all(|pair| pair[0] - pair[1] < 4.0));
    assert!(luminance(INFINITE_LEVEL_COLOUR) < steps[SHADE_COUNT - 1] - 8.0);
}

#[test]
fn outliers_do_not_stretch_the_colour_range() {
    let mut levels: Vec<f64> = (1..=1000).map(f64::from).collect();
    let range = LevelRange::from_levels(levels.iter().copied()).unwrap();
    assert_eq!((range.low, range.high, range.has_clipped_levels), (0.0, 3.0, [false; 2]));
    levels.push(1e16);
    let range = LevelRange::from_levels(levels.iter().copied()).unwrap();
    assert!(range.high <= 3.0 && range.has_clipped_levels == [false, true]);
    assert!(LevelRange::from_levels([f64::NAN, 0.0, -3.0].into_iter()).is_none());
}

#[test]
fn long_labels_stay_within_the_picture() {
    let long = "a rather long description of what is meant ".repeat(40);
    let mut map = sample_map(12, 7);
    map.categories[0].label = long.clone();
    map.categories[1].label = "x".repeat(3000);
    for text in [&mut map.title, &mut map.subtitle, &mut map.level_label] {
        text.clone_from(&long);
    }
    map.x.label.clone_from(&long);
    map.y.label.clone_from(&long);
    check_map(&map);
    for text in [&mut map.title, &mut map.subtitle, &mut map.level_label] {
        text.clear();
    }
    check_map(&map);
}

#[test]
fn arbitrary_curves_are_drawn() {
    let mut map = sample_map(12, 7);
    let odd = [
        vec![],
        vec![[1.0, 1.0]],
        vec![[0.0, 0.0], [f64::NAN, 1.0], [f64::INFINITY, 2.0], [50.0, 20.0], [1e308, -1e308]],
    ];
    map.curves = odd.map(|points| MapCurve { label: "odd".to_owned(), points }).to_vec();
    check_map(&map);
}

#[test]
fn wrong_input_is_refused() {
    let refused = |change: &dyn Fn(&mut VerdictMap)| {
        let mut map = sample_map(4, 3);
        change(&mut map);
        map.draw(FigureFormat::Svg).unwrap_err().to_string()
    };
    assert!(
        refused(&|map| {
            Arc::make_mut(&mut map.growth_levels).pop();
        })
        .contains("11 values for 4 × 3 cells")
    );
    assert!(refused(&|map| map.category_indices[5] = 3).contains("category 3"));
    assert!(refused(&|map| map.categories.clear()).contains("0 categories"));
    assert!(refused(&|map| map.x.values.clear()).contains("has no points"));
    assert!(refused(&|map| map.x.values[1] = f64::NAN).contains("not a finite number"));
    assert!(refused(&|map| map.y.values[1] = 11.0).contains("not uniformly spaced"));
    assert!(refused(&|map| map.y.values.fill(1.0)).contains("does not extend"));
    assert!(refused(&|map| map.y.is_log = true).contains("not positive"));
    assert!(refused(&|map| map.y.values = vec![-1e308, 0.0, 1e308]).contains("does not extend"));
}

#[test]
fn equal_maps_give_equal_bytes() {
    for format in [FigureFormat::Png, FigureFormat::Svg] {
        let map = sample_map(30, 20);
        assert_eq!(map.draw(format).unwrap(), map.draw(format).unwrap());
    }
}
