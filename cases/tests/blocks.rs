//! Cases of blocky media: tiling, materials, selectors of joints, writing as TOML, and messages for invalid input.

use wellposed_cases::dynamics::{Blocks, JointLaw};
use wellposed_cases::{Case, generate_json_schema};

/// Sections of every case other than `[[block]]` and `[[joint]]`.
const CASE_HEADER: &str = "\
[model]
kind = 'classical'
lambda = 1.89e10
mu = 2.43e10
density = 2700
[time]
duration = 1e-4
";

/// Kind and constants of a joint with an elastic layer.
const ELASTIC_LAYER_KEYS: &str = "kind = 'elastic'\nthickness = 1e-3\ndensity = 1500\nlongitudinal_speed = 1000\nshear_speed = 500\n";

/// Section of six blocks called `rock`.
const BLOCK_SECTION: &str =
    "[[block]]\nname = 'rock'\ncells = [10, 10]\nspacing = 0.005\nrepeat = [3, 2]\n";

/// Parses a case with the given sections; the error is the message.
fn parse_case(sections: &str) -> Result<Case, String> {
    Case::parse(&format!("{CASE_HEADER}{sections}"), "x.toml", &[])
        .map_err(|error| error.to_string())
}

/// Reads a valid blocky medium; verifies that the case is written and read again unchanged.
fn read_blocks(sections: &str) -> Blocks {
    let case = parse_case(sections).unwrap_or_else(|error| panic!("{error}"));
    let blocks = case.solid_run.as_ref().and_then(|run| run.blocks.clone()).expect("blocks");
    // The resolved case describes the same medium, and the schema accepts both.
    let resolved = case.to_toml();
    let again = Case::parse(&resolved, "x.toml", &[]).unwrap_or_else(|error| panic!("{error}"));
    assert!(again == case && again.to_toml() == resolved, "{resolved}");
    for text in [format!("{CASE_HEADER}{sections}"), resolved] {
        assert!(is_valid_by_schema(&text), "{text}");
    }
    blocks
}

/// Returns whether the JSON Schema accepts a case.
fn is_valid_by_schema(text: &str) -> bool {
    let table: toml::Table = text.parse().expect("TOML");
    let json = serde_json::to_value(&table).expect("JSON");
    jsonschema::draft202012::new(&generate_json_schema()).expect("a schema").is_valid(&json)
}

/// Returns the error message of a case with invalid sections.
fn refusal_message(sections: &str) -> String {
    let error = parse_case(sections).expect_err("an error");
    assert!(error.starts_with("x.toml:"), "{error}");
    error
}

/// Formats a section `[[joint]]` with an elastic layer.
fn format_joint(selector: &str) -> String {
    format!("[[joint]]\n{selector}\n{ELASTIC_LAYER_KEYS}")
}

/// Returns for each axis the joint at the lower face of every cell, first axis fastest.
fn face_joints(blocks: &Blocks) -> [Vec<Option<u16>>; 2] {
    let row = blocks.cells[0];
    let mut faces = [0, 1].map(|_| vec![None; row * blocks.cells[1]]);
    for contact in &blocks.contacts {
        for line in contact.tangential_cells.clone() {
            let cell = match contact.axis {
                0 => contact.plane_index + row * line,
                _ => line + row * contact.plane_index,
            };
            faces[contact.axis][cell] = contact.joint_index;
        }
    }
    faces
}

/// Returns plane index and thickness of the joints normal to an axis in the row or column `line` of cells along it.
fn joint_planes(blocks: &Blocks, axis: usize, line: usize) -> Vec<(usize, f64)> {
    let faces = face_joints(blocks);
    let laws: Vec<&JointLaw> = blocks.joint_laws().collect();
    let cell = |index: usize| match axis {
        0 => index + blocks.cells[0] * line,
        _ => line + blocks.cells[0] * index,
    };
    let joint = |index: usize| {
        let law = laws[usize::from(faces[axis][cell(index)]?)];
        Some((index, law.material.thickness()))
    };
    (0..blocks.cells[axis]).filter_map(joint).collect()
}

#[test]
fn repeated_blocks_tile_their_bounding_box() {
    let blocks = read_blocks(&format!("{BLOCK_SECTION}{}", format_joint("every = 'all'")));
    assert_eq!((blocks.cells, blocks.origin, blocks.spacing), ([30, 20], [0.0; 2], [0.005; 2]));
    assert_eq!((blocks.blocks.len(), blocks.contacts.len()), (6, 2 * 2 + 3));
    for line in 0..20 {
        assert_eq!(joint_planes(&blocks, 0, line), [(10, 1e-3), (20, 1e-3)]);
    }
    for line in 0..30 {
        assert_eq!(joint_planes(&blocks, 1, line), [(10, 1e-3)]);
    }
    let owners = blocks.compute_cell_blocks().expect("owners");
    for (index, owner) in owners.iter().enumerate() {
        let [i, j] = [index % 30, index / 30];
        assert_eq!(*owner as usize, i / 10 + 3 * (j / 10));
        assert_eq!(blocks.block_of_cell([i, j]), Some(*owner as usize));
    }
    assert_eq!(blocks.block_of_cell([30, 0]), None);
    assert_eq!(blocks.block_name(5), Some("rock"));
}

#[test]
fn size_is_cells_times_spacing() {
    let by_size = read_blocks(
        "[[block]]\ncells = [10, 4]\nsize = [0.05, 0.1]\norigin = [-0.05, 0]\nrepeat = [2, 1]\n",
    );
    assert_eq!(by_size.spacing, [0.05 / 10.0, 0.1 / 4.0]);
    assert_eq!((by_size.cells, by_size.origin), ([20, 4], [-0.05, 0.0]));
    assert!(!by_size.has_joints() && by_size.contacts.len() == 1);
}

/// Two blocks below and one above share parts of their faces, in any order of the sections.
#[test]
fn blocks_of_different_lengths_share_parts_of_sides() {
    let lower = "[[block]]\nname = 'a'\ncells = [4, 3]\nspacing = 1\n";
    let right = "[[block]]\nname = 'b'\ncells = [6, 3]\nspacing = 1\norigin = [4, 0]\n";
    let upper = "[[block]]\nname = 'c'\ncells = [10, 5]\nspacing = 1\norigin = [0, 3]\n";
    for sections in [[lower, right, upper], [upper, lower, right], [right, upper, lower]] {
        let text = sections.concat()
            + &format_joint("between = ['c', 'a']")
            + &format_joint("every = 'x1'");
        let blocks = read_blocks(&text);
        assert_eq!(blocks.cells, [10, 8]);
        assert_eq!(blocks.contacts.len(), 3);
        for line in 0..10 {
            let expected = if line < 4 { vec![(3, 1e-3)] } else { Vec::new() };
            assert_eq!(joint_planes(&blocks, 1, line), expected);
        }
        for line in 0..8 {
            let expected = if line < 3 { vec![(4, 1e-3)] } else { Vec::new() };
            assert_eq!(joint_planes(&blocks, 0, line), expected);
        }
    }
}

#[test]
fn shifted_rows_are_closed_by_parts_of_blocks() {
    let text = "[[block]]\ncells = [10, 5]\nspacing = 0.1\nrepeat = [3, 4]\nrow_shift = 0.4\n";
    let blocks = read_blocks(&(text.to_owned() + &format_joint("every = 'all'")));
    assert_eq!((blocks.cells, blocks.blocks.len()), ([30, 20], 3 + 4 + 3 + 4));
    for line in 0..20 {
        let planes: Vec<usize> =
            joint_planes(&blocks, 0, line).iter().map(|(plane, _)| *plane).collect();
        let expected = if line / 5 % 2 == 0 { vec![10, 20] } else { vec![4, 14, 24] };
        assert_eq!(planes, expected);
    }
    // Each of the three planes between rows has 3 + 4 − 1 common faces.
    assert_eq!(blocks.contacts.iter().filter(|contact| contact.axis == 1).count(), 3 * 6);
}

#[test]
fn materials_follow_the_pattern() {
    let materials = "materials = [{ model = { mu = 1e10 } }, { model = { mu = 3e10 } }]\n";
    let mu = |blocks: &Blocks, column: usize, row: usize| {
        let cell = 10 * column + blocks.cells[0] * 10 * row;
        let material = usize::from(blocks.compute_cell_materials().expect("it")[cell]);
        blocks.materials[material].number("model.mu").expect("it")
    };
    type Expected = fn(usize, usize) -> bool;
    let cases: [(&str, Expected); 4] = [
        ("", |column, row| (column + row) % 2 == 1),
        ("pattern = 'rows'\n", |_, row| row == 1),
        ("pattern = 'columns'\n", |column, _| column == 1),
        ("pattern = 'list'\nlist = [0, 0, 1, 1, 1, 0]\n", |column, row| {
            [0, 0, 1, 1, 1, 0][column + 3 * row] == 1
        }),
    ];
    for (pattern, is_second) in cases {
        let blocks = read_blocks(&format!("{BLOCK_SECTION}{materials}{pattern}"));
        for (column, row) in (0..2).flat_map(|row| (0..3).map(move |column| (column, row))) {
            let expected = if is_second(column, row) { 3e10 } else { 1e10 };
            assert_eq!(mu(&blocks, column, row), expected, "{pattern}: {column}, {row}");
        }
    }
    let case = parse_case(&format!("{BLOCK_SECTION}{materials}")).expect("a case");
    let run = case.solid_run.expect("a run");
    assert_eq!(run.materials().len(), 2);
    assert_eq!(run.material_section(1), "block[0].materials[1]");
    assert_eq!(run.compute_cell_media().expect("media")[10], 1);
    // A block overrides the constants of the case, and may yield.
    let one = read_blocks(&format!(
        "{BLOCK_SECTION}model = {{ density = 2000 }}\nyield = {{ kind = 'von-mises', strength = 1e6 }}\n"
    ));
    assert_eq!(one.materials[0].number("model.density"), Some(2000.0));
    assert_eq!(one.materials[0].number("model.mu"), Some(2.43e10));
    assert!(one.materials[0].yield_set.is_some());
}

/// Every selector selects its faces; where sections `[[joint]]` select the same face, the last one applies.
#[test]
fn selectors_select_common_faces() {
    let thick = |selector: &str, thickness: &str| {
        format_joint(selector).replace("thickness = 1e-3", &format!("thickness = {thickness}"))
    };
    let blocks = read_blocks(
        &(BLOCK_SECTION.to_owned()
            + &thick("every = 'x1'", "1")
            + &thick(
                "every = 'x2'\ninside = { shape = 'box', from = [0.06, 0], to = [1, 1] }",
                "2",
            )
            + &thick("at = [0.05, 0.07]", "3")
            + &thick("inside = { shape = 'circle', center = [0.1, 0.025], radius = 0.01 }", "4")),
    );
    for line in 0..20 {
        let expected = if line < 10 { [(10, 1.0), (20, 4.0)] } else { [(10, 3.0), (20, 1.0)] };
        assert_eq!(joint_planes(&blocks, 0, line), expected);
    }
    for line in 0..30 {
        let expected = if line < 10 { vec![] } else { vec![(10, 2.0)] };
        assert_eq!(joint_planes(&blocks, 1, line), expected);
    }
    let reversed = read_blocks(
        &(BLOCK_SECTION.to_owned()
            + &thick("at = [0.05, 0.07]", "3")
            + &thick("between = ['rock', 'rock']", "5")),
    );
    assert!(reversed.contacts.iter().all(|contact| contact.joint_index == Some(1)));
}

#[test]
fn all_kinds_of_joints_are_read_and_written() {
    let elastic =
        "thickness = 1e-3\ndensity = 1500\nlongitudinal_speed = 1000\nshear_speed = 500\n";
    let plastic = "shear_strength = 1e6\nshear_friction = 0.5\n";
    let viscous = "delayed_compliance = 5e-9\nviscosity = 7500\n";
    let pores = "collapse_stiffness = 1.35e10\nporosity = 0.1\n";
    let saturated =
        "kind = 'saturated'\nthickness = 1e-3\nskeleton_density = 1300\nfluid_density = 250\n\
        added_density = 100\nundrained_stiffness = 1.5e9\ncoupling_stiffness = 0.45e9\n\
        fluid_stiffness = 0.7e9\ninstantaneous_compliance = 2.7e-9\n"
            .to_owned();
    let laws = [
        ("elastic", format!("kind = 'elastic'\nmass = 'lumped'\n{elastic}")),
        (
            "elastic-plastic",
            format!("kind = 'elastic-plastic'\n{elastic}{plastic}slip_hardening = 1e9\n"),
        ),
        ("viscous", format!("kind = 'viscous'\n{elastic}{viscous}")),
        ("porous", format!("kind = 'porous'\n{elastic}{pores}")),
        ("saturated", saturated + viscous + pores),
        ("cracked", format!("kind = 'cracked'\n{elastic}")),
        ("cracked", format!("kind = 'cracked'\n{elastic}shear_friction = 0.3\n")),
        ("breaking", format!("kind = 'breaking'\n{elastic}{plastic}tensile_strength = 5e5\n")),
        (
            "breaking",
            format!(
                "kind = 'breaking'\nfracture = false\n{elastic}{plastic}tensile_strength = 5e5\n"
            ),
        ),
        (
            "porous-viscous",
            format!("normal = 'porous'\ntangential = 'viscous'\n{elastic}{pores}{viscous}"),
        ),
        (
            "porous-plastic",
            format!(
                "normal = 'porous'\ntangential = 'plastic'\n{elastic}{pores}shear_strength = 1e6\n"
            ),
        ),
        (
            "elastic-plastic",
            format!("normal = 'elastic'\ntangential = 'plastic'\n{elastic}{plastic}"),
        ),
        ("porous", format!("normal = 'porous'\ntangential = 'elastic'\n{elastic}{pores}")),
    ];
    for (name, law) in laws {
        let blocks = read_blocks(&format!("{BLOCK_SECTION}[[joint]]\nevery = 'all'\n{law}"));
        let own = blocks.joint_laws().next().expect("a joint");
        assert_eq!(own.kind.name, name);
        assert_eq!(own.fracture, !law.contains("fracture = false"));
    }
}

#[test]
fn large_media_are_read_in_short_time() {
    let start = std::time::Instant::now();
    for repeat in ["[100, 100]", "[200, 100]"] {
        let text = BLOCK_SECTION.replace("[3, 2]", repeat) + &format_joint("every = 'all'");
        let case = parse_case(&text).expect("a case");
        let blocks = case.solid_run.and_then(|run| run.blocks).expect("blocks");
        let faces = face_joints(&blocks);
        let [n1, n2] = [blocks.cells[0] / 10, blocks.cells[1] / 10];
        let count = |axis: usize| faces[axis].iter().flatten().count();
        assert_eq!([count(0), count(1)], [(n1 - 1) * 10 * n2, (n2 - 1) * 10 * n1]);
    }
    assert!(start.elapsed().as_secs_f64() < 10.0, "{:?}", start.elapsed());
}

#[test]
fn blocks_that_do_not_tile_are_refused() {
    let first = "[[block]]\ncells = [4, 4]\nspacing = 0.5\n";
    let line = 1 + CASE_HEADER.lines().count();
    for (second, messages) in [
        (
            "[[block]]\ncells = [4, 4]\nspacing = 0.5\norigin = [2.5, 0]\n",
            ["block[0]", "no block at [2, 0], in a gap of 1 cell along x1"],
        ),
        (
            "[[block]]\ncells = [4, 4]\nspacing = 0.5\norigin = [1.5, 0]\n",
            ["block[1]", "overlaps block[0] (x.toml:"],
        ),
        (
            "[[block]]\ncells = [4, 3]\nspacing = 0.5\norigin = [2, 0]\n",
            ["at [2, 1.5]", "gap of 4"],
        ),
        ("[[block]]\ncells = [4, 4]\nspacing = 0.5\n", ["overlaps", "at [0, 0]"]),
        (
            "[[block]]\ncells = [4, 4]\nspacing = 0.5\norigin = [2.2, 0]\n",
            ["block[1].origin: found x1 = 2.2, 4.4 cells of 0.5 m", "faces of blocks must conform"],
        ),
        (
            "[[block]]\ncells = [4, 4]\nspacing = 0.25\norigin = [2, 0]\n",
            [
                "block[1].spacing: cells of 0.25 m along x1, but of 0.5 m in block[0]",
                "the same spacing",
            ],
        ),
        (
            "[[block]]\ncells = [4, 4]\nspacing = 0.5\norigin = [1e300, 0]\n",
            ["block[1].origin", "expected a tiling"],
        ),
    ] {
        let error = refusal_message(&format!("{first}{second}"));
        assert!(messages.iter().all(|message| error.contains(message)), "{error}");
        let lines = (line..line + 8).any(|line| error.starts_with(&format!("x.toml:{line}: ")));
        assert!(lines, "{error}");
    }
}

#[test]
fn invalid_keys_of_blocks_are_refused() {
    for (old, new, message) in [
        (
            "spacing = 0.005\n",
            "spacing = 0.005\nsize = [1, 1]\n",
            "block[0].size: found beside spacing",
        ),
        (
            "spacing = 0.005\n",
            "",
            "block[0].spacing: missing; add spacing to block[0]: expected a positive",
        ),
        (
            "cells = [10, 10]",
            "cells = [0, 10]",
            "block[0].cells: found [0, 10]; expected a list of 2 whole numbers",
        ),
        ("cells = [10, 10]", "cells = [10, 10, 10]", "block[0].cells: found"),
        ("spacing = 0.005", "spacing = -1", "block[0].spacing: found -1; expected a positive"),
        ("repeat = [3, 2]", "repeat = [3, 0]", "block[0].repeat: found"),
        ("repeat = [3, 2]", "repeat = [2000000, 1]", "copies; expected at most 1000000 blocks"),
        ("cells = [10, 10]", "cells = [100000, 100000]", "expected at most 4000000000 cells"),
        ("spacing = 0.005", "spacing = 0.005\norigin = [1e15, 0]", "double precision"),
        ("name = 'rock'", "name = 'a/b'", "block[0].name"),
        ("name = 'rock'", "nam = 'rock'", "block[0].nam: unknown key; did you mean 'name'?"),
        ("repeat", "row_shift = 0.0075\nrepeat", "block[0].row_shift: found 0.0075 m, 1.5 cells"),
        ("repeat", "row_shift = 0.05\nrepeat", "less than a block of 0.05 m"),
        ("repeat", "model = { mv = 1 }\nrepeat", "block[0].model.mv: unknown key"),
        ("repeat", "materials = 1\nrepeat", "expected a list of tables [{ ... }, ...]"),
        ("repeat", "materials = []\nrepeat", "block[0].materials: an empty list"),
        (
            "repeat",
            "materials = [{ model = { mu = 1 } }]\nmodel = { mu = 1 }\nrepeat",
            "block[0].model: found beside materials",
        ),
        (
            "repeat",
            "pattern = 'rows'\nrepeat",
            "block[0].pattern: found, but not used here; leave it out: it is used beside materials only",
        ),
        (
            "repeat",
            "materials = [{ model = { mu = 1 } }]\npattern = 'list'\nlist = [0]\nrepeat",
            "block[0].list: 1 indices for 6 copies",
        ),
        (
            "repeat",
            "materials = [{ model = { mu = 1 } }]\npattern = 'list'\nlist = [0, 0, 0, 0, 0, 1]\nrepeat",
            "block[0].list: found 1 with 1 materials",
        ),
        (
            "[[block]]",
            "[grid]\ncells = [1, 1]\nspacing = 1\n[[block]]",
            "grid: found beside [[block]]",
        ),
        ("[[block]]", "[[region]]\nshape = 'rest'\n[[block]]", "region: found beside [[block]]"),
    ] {
        assert!(BLOCK_SECTION.contains(old));
        let error = refusal_message(&BLOCK_SECTION.replace(old, new));
        assert!(error.contains(message), "{error}");
    }
    let error = Case::parse(&CASE_HEADER.replace("mu", "dimensions = 3\nmu"), "x.toml", &[]);
    assert!(error.is_err());
    let text = CASE_HEADER.replace("mu", "dimensions = 3\nmu") + BLOCK_SECTION;
    let error = Case::parse(&text, "x.toml", &[]).expect_err("3D").to_string();
    assert!(error.contains("model.dimensions: found 3"), "{error}");
    let many = BLOCK_SECTION.replace("[3, 2]", "[1000, 1000]");
    let three = (0..3).map(|index| format!("{many}origin = [{}, 0]\n", 50 * index));
    let error = refusal_message(&three.collect::<String>());
    assert!(error.contains("expected at most 1000000 blocks"), "{error}");
}

#[test]
fn invalid_joints_are_refused() {
    let elastic = format_joint("every = 'all'");
    let saturated = "[[joint]]\nevery = 'all'\nkind = 'saturated'\nthickness = 1e-3\nskeleton_density = 1300\n\
        fluid_density = 250\nadded_density = 100\nundrained_stiffness = 1e9\ncoupling_stiffness = 1e9\n\
        fluid_stiffness = 1e9\ninstantaneous_compliance = 2.7e-9\ndelayed_compliance = 5e-9\n\
        viscosity = 7500\ncollapse_stiffness = 1e10\nporosity = 0.1\n";
    let breaking = elastic.replace("'elastic'", "'breaking'")
        + "shear_strength = 1e6\nshear_friction = 0.5\ntensile_strength = 3e6\n";
    for (text, message) in [
        (
            saturated.to_owned(),
            "joint[0].coupling_stiffness: found 1e9; expected less than √(undrained_stiffness · fluid_stiffness) = ",
        ),
        (
            breaking,
            "joint[0].tensile_strength: found 3e6; expected at most shear_strength/shear_friction = ",
        ),
        (
            elastic.replace("thickness = 1e-3", "thickness = 0"),
            "joint[0].thickness: found 0; expected a positive",
        ),
        (elastic.replace("thickness = 1e-3\n", ""), "joint[0].thickness: missing"),
        (elastic.replace("'elastic'", "'elastc'"), "did you mean 'elastic'?"),
        (elastic.replace("kind = 'elastic'\n", ""), "joint[0].kind: missing"),
        (
            elastic.clone() + "shear_strength = 1\n",
            "joint[0].shear_strength: found in a joint of kind 'elastic'; leave it out; joints with shear_strength: elastic-plastic, breaking, porous-plastic",
        ),
        (elastic.clone() + "mass = 'lump'\n", "joint[0].mass: found 'lump'"),
        (elastic.clone() + "normal = 'porous'\n", "joint[0].normal: found beside kind"),
        (format_joint(""), "joint[0].every: missing; select the faces"),
        (format_joint("every = 'x3'"), "joint[0].every: found 'x3'"),
        (format_joint("every = 'x1'\nat = [0.05, 0.01]"), "joint[0].at: found beside every"),
        (
            format_joint("between = ['rock', 'rok']"),
            "joint[0].between: found 'rok'; did you mean 'rock'?",
        ),
        (format_joint("between = ['rock']"), "joint[0].between: found 1 names"),
        (
            format_joint("at = [0.02, 0.02]"),
            "faces between blocks: normal to x1 at x1 = 0.05, 0.1; normal to x2 at x2 = 0.05",
        ),
        (format_joint("at = [0.05, 0.05]"), "a point of 4 faces between blocks"),
        (format_joint("at = [0.5, 0.05]"), "outside the grid"),
        (
            format_joint("inside = { shape = 'circle', center = [0.02, 0.02], radius = 0.001 }"),
            "joint[0].inside: no face between two blocks has its centre in the shape",
        ),
        (
            format_joint("inside = { shape = 'sphere', center = [0, 0], radius = 1 }"),
            "joint[0].inside.shape",
        ),
    ] {
        let error = refusal_message(&format!("{BLOCK_SECTION}{text}"));
        assert!(error.contains(message), "{error}");
    }
    let short = BLOCK_SECTION.replace("cells = [10, 10]", "cells = [2, 10]");
    let error = refusal_message(&format!("{short}{elastic}"));
    let message = "block[0].cells: a block of 2 cells along x1 beside the joint at [0.01, 0.025] (joint[0], x.toml:";
    assert!(error.contains(message) && error.contains("expected at least 3 cells"), "{error}");
    let part = BLOCK_SECTION.to_owned() + "row_shift = 0.01\n";
    let error = refusal_message(&format!("{part}{elastic}"));
    assert!(error.contains("block[0].row_shift: a part of a block of 2 cells"), "{error}");
    // Blocks without joints may have few cells.
    read_blocks(&short);
    let single = BLOCK_SECTION.replace("[3, 2]", "[1, 1]");
    let error = refusal_message(&format!("{single}{elastic}"));
    assert!(
        error.contains("joint[0].every: a joint without neighbours; there is only one block"),
        "{error}"
    );
    let row = BLOCK_SECTION.replace("[3, 2]", "[3, 1]");
    let error = refusal_message(&format!("{row}{}", format_joint("every = 'x2'")));
    assert!(
        error.contains("no two blocks are neighbours along x2") && error.contains("x1 = 0.05, 0.1"),
        "{error}"
    );
    let error = refusal_message(&format!("[grid]\ncells = [9, 9]\nspacing = 1\n{elastic}"));
    assert!(error.contains("joint: found without [[block]]"), "{error}");
    let apart = "[[block]]\nname = 'a'\ncells = [4, 4]\nspacing = 1\n[[block]]\nname = 'b'\ncells = [4, 4]\nspacing = 1\norigin = [4, 0]\n\
        [[block]]\nname = 'c'\ncells = [4, 4]\nspacing = 1\norigin = [8, 0]\n";
    let error = refusal_message(&format!("{apart}{}", format_joint("between = ['a', 'c']")));
    assert!(
        error.contains(
            "no block 'a' is a neighbour of a block 'c'; neighbours with names: a and b, b and c"
        ),
        "{error}"
    );
}

#[test]
fn options_replace_keys_of_blocks_and_joints() {
    let text = format!(
        "{CASE_HEADER}{BLOCK_SECTION}materials = [{{ model = {{ mu = 1e10 }} }}]\n{}",
        format_joint("every = 'all'")
    );
    let read = |set: &str| Case::parse(&text, "x.toml", &[set.to_owned()]);
    let blocks =
        |set: &str| read(set).expect(set).solid_run.and_then(|run| run.blocks).expect("it");
    assert_eq!(blocks("block[0].repeat=[5, 4]").cells, [50, 40]);
    assert_eq!(blocks("block[0].row_shift=0.025").blocks.len(), 7);
    assert_eq!(blocks("joint[0].thickness=5e-3").joints[0].law.material.thickness(), 5e-3);
    let model = blocks("block[0].materials[0].model.mu=2e10").materials[0].number("model.mu");
    assert_eq!(model, Some(2e10));
    let error = read("joint[0].at=[0, 0]").expect_err("two selectors").to_string();
    assert!(
        error.starts_with("--set joint[0].at=[0, 0]: joint[0].at: found beside every"),
        "{error}"
    );
    let error = read("block[0].cells=[2, 10]").expect_err("a short block").to_string();
    assert!(
        error.starts_with("--set block[0].cells=[2, 10]: block[0].cells: a block of 2"),
        "{error}"
    );
}

/// The JSON Schema refuses invalid blocks and joints, except faults in relations between numbers.
#[test]
fn schema_refuses_invalid_blocks_and_joints() {
    let elastic = format_joint("every = 'all'");
    let sound = format!("{CASE_HEADER}{BLOCK_SECTION}{elastic}");
    assert!(is_valid_by_schema(&sound));
    for (old, new) in [
        ("spacing = 0.005\n", "spacing = 0.005\nsize = [1, 1]\n"),
        ("spacing = 0.005\n", ""),
        ("cells = [10, 10]", "cells = [0, 10]"),
        ("[[block]]", "[grid]\ncells = [1, 1]\nspacing = 1\n[[block]]"),
        ("[[block]]", "[[region]]\nshape = 'rest'\n[[block]]"),
        (BLOCK_SECTION, ""),
        (BLOCK_SECTION, "[grid]\ncells = [9, 9]\nspacing = 1\n"),
        ("[model]", "[model]\ndimensions = 3"),
        ("repeat", "pattern = 'rows'\nrepeat"),
        ("thickness = 1e-3", "thickness = 0"),
        ("kind = 'elastic'\n", ""),
        ("kind = 'elastic'", "kind = 'viscous'"),
        ("every = 'all'", ""),
        ("every = 'all'", "every = 'all'\nat = [1, 1]"),
        ("every = 'all'", "every = 'all'\nshear_strength = 1"),
    ] {
        assert!(sound.contains(old));
        let text = sound.replacen(old, new, 1);
        assert!(Case::parse(&text, "x.toml", &[]).is_err(), "the program takes {new}");
        assert!(!is_valid_by_schema(&text), "the validator takes {new}");
    }
}
