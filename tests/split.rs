//! Plans of the distribution over ranks: typical distributions of blocks, and refusals.

use crate::program::*;
use wellposed::load;
use wellposed::study::simulate::{SplitResult, plan_split};

const TEST_FOLDER: &str = "split";

/// Plans the parts of a case with settings, and checks that they tile the grid.
fn split(folder: &str, text: &str, settings: &[&str], ranks: usize) -> SplitResult {
    let folder = create_case_folder(TEST_FOLDER, folder, text);
    let case = load(folder.join("case.toml"), settings).unwrap();
    let found = plan_split(&case, ranks, 1).unwrap();
    assert_eq!(found.ranks.len(), ranks);
    assert_eq!(found.part_counts.iter().product::<usize>(), ranks);
    let mut owners = vec![0; found.cell_counts.iter().product()];
    for row in &found.ranks {
        let mut cells = vec![0];
        for (count, [first, end]) in found.cell_counts.iter().zip(&row.cells).rev() {
            let extend = |index: usize| (*first..*end).map(move |place| index * count + place);
            cells = cells.into_iter().flat_map(extend).collect();
        }
        assert_eq!(cells.len(), row.cell_count);
        assert!(row.stored_cell_count >= row.cell_count && row.memory_bytes > 0.0);
        cells.into_iter().for_each(|cell| owners[cell] += 1);
    }
    assert!(owners.iter().all(|count| *count == 1));
    // What one rank shares with others the others share with it.
    assert!(ranks == 1 || found.ranks.iter().map(|row| row.surface_faces).sum::<usize>() % 2 == 0);
    found
}

/// Square blocks of `cells` cells along each axis.
fn blocks(repeat: &str, cells: usize) -> String {
    let model = "[model]\nkind = 'classical'\nlambda = 1e9\nmu = 1e9\ndensity = 2000\n";
    format!(
        "{model}[[block]]\nname = 'rock'\ncells = [{cells}, {cells}]\nsize = [0.2, 0.2]\nrepeat = {repeat}\n[time]\nduration = 1e-3\n"
    )
}

/// Verifies the numbers of parts, and that the rank with the most work has hardly more than the mean.
#[test]
fn blocks_are_distributed_evenly() {
    let check = |found: SplitResult, counts: &[usize], imbalance: f64| {
        assert_eq!(found.part_counts, counts);
        assert!(found.work_imbalance <= imbalance, "{}", found.work_imbalance);
    };
    // Two blocks on seven ranks, twelve on four, twenty-four on as many.
    check(split("two", &blocks("[2, 1]", 60), &[], 7), &[7, 1], 1.06);
    check(split("twelve", &blocks("[4, 3]", 20), &[], 4), &[2, 2], 1.0);
    let found = split("each", &blocks("[6, 4]", 20), &[], 24);
    assert!(
        found.ranks.iter().all(|row| row
            .cells
            .iter()
            .all(|[first, end]| { first % 20 == 0 && end - first == 20 }))
    );
    check(found, &[6, 4], 1.0);
    // A row of blocks for each of a hundred ranks.
    let found = split("rows", &blocks("[10, 100]", 20), &["parallel.parts=[1, 100]"], 100);
    assert!(
        found.ranks.iter().all(|row| row.cells == [[0, 200], [20 * row.rank, 20 * row.rank + 20]])
    );
    check(found, &[1, 100], 1.0);
    // An annulus on twenty-five ranks; as it is periodic, all ranks have neighbours on both sides along the angle.
    let annulus = include_str!("../cases/porous/rockhole-blow.toml");
    let found = split("annulus", annulus, &["grid.cells=[100, 100]"], 25);
    assert!(found.ranks.iter().all(|row| row.neighbours >= 3));
    check(found, &[5, 5], 1.0);
    // Cubes in space on 64 ranks, and on 68, which 17 divides.
    let space = include_str!("data/program-space.toml");
    check(split("cubes", space, &["grid.cells=[64, 64, 64]", "receiver=[]"], 64), &[4, 4, 4], 1.0);
    let cells = ["grid.cells=[170, 60, 60]", "receiver=[]"];
    check(split("more", space, &cells, 68), &[17, 2, 2], 1.0);
}

#[test]
fn plans_are_printed_drawn_and_refused() {
    let folder = create_case_folder(TEST_FOLDER, "program", &blocks("[4, 3]", 20));
    let (text, _) = run_with_exit_code(0, &folder, "split case.toml --ranks 4 --threads 2");
    for part in ["80 × 60 cells in 2 × 2 parts; threads of each rank: 2", "40 … 79", "picture: "]
    {
        assert!(text.contains(part), "{text}");
    }
    let names = list_entries(&folder.join("out/case"));
    for name in ["split.csv", "split.json", "split.png", "split.svg", "split.txt"] {
        assert!(names.iter().any(|own| own == name), "{names:?}");
    }
    run_with_exit_code(0, &folder, "verify out/case");
    let (json, _) = run_with_exit_code(0, &folder, "split case.toml --ranks 4 --format json");
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(report["ranks"][3]["cells"], serde_json::json!([[40, 80], [30, 60]]));
    assert_eq!(report["units"]["bytes_per_step"], "bytes/step");
    let refuse = |arguments: &str, part: &str| {
        let (_, error) = run_with_exit_code(2, &folder, &format!("split {arguments}"));
        assert!(error.contains(part), "{error}");
    };
    refuse(
        "case.toml --ranks 4 --set parallel.parts=[3,2]",
        "parallel.parts: 3 × 2 parts for 4 ranks",
    );
    refuse("case.toml --ranks 4 --set parallel.parts=[4]", "parallel.parts: ");
    refuse("case.toml --ranks 4 --set parallel.parts=[2,2,1]", "expected 2, one per axis");
    refuse("case.toml --ranks 4 --set parallel.cuts=[4]", "parallel.parts: missing");
    refuse("case.toml --ranks 500", "500 ranks for 4800 cells");
    refuse("case.toml --ranks 0", "expected a whole number from 1");
    refuse("decay --ranks 2", "a flow, whose simulation runs in one process");
    refuse("flutter --ranks 2", "");
    // Files of the picture in space.
    let (plan, _) = run_with_exit_code(0, &folder, "split lamb-3d --ranks 3 --dry-run");
    assert!(plan.contains("split-x2x3.png") && !plan.contains("split.png"), "{plan}");
}

/// Verifies the table of times and its picture with small media; the times themselves are those of the machine.
#[test]
fn blocks_are_timed_beside_the_model() {
    let folder = create_case_folder(TEST_FOLDER, "time", &blocks("[2, 2]", 5));
    let arguments = "time case.toml --blocks 8,4 --ranks 1,2 --steps 2";
    let (text, _) = run_with_exit_code(0, &folder, arguments);
    for part in [
        "ranks 2: threads of one process, t_cell ",
        "ranks 1: a wave crosses the medium in a time T ∝ N^",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let (json, _) = run_with_exit_code(0, &folder, &format!("{arguments} --format json"));
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    let rows = report["rows"].as_array().unwrap();
    let cells: Vec<u64> = rows.iter().map(|row| row["cells"].as_u64().unwrap()).collect();
    assert_eq!(cells, [400, 1600, 400, 1600]);
    let is_positive = |row: &serde_json::Value, key: &str| row[key].as_f64().unwrap() > 0.0;
    assert!(rows.iter().all(|row| is_positive(row, "step_time") && is_positive(row, "model_time")));
    // A crossing takes twice as many steps with twice as many blocks.
    let steps = |row: usize| rows[row]["crossing_steps"].as_u64().unwrap();
    assert!(steps(1).abs_diff(2 * steps(0)) <= 1);
    assert!(list_entries(&folder.join("out/case")).contains(&"time.png".to_owned()));
    let page = std::fs::read_to_string(folder.join("out/case/report.html")).unwrap();
    let command = "wellposed time case.toml --blocks 4,8 --ranks 1,2 --steps 2 --threads 1";
    assert!(page.contains(command), "{command}");
    let (_, error) = run_with_exit_code(2, &folder, "time lamb-2d --blocks 4");
    assert!(error.contains("block"), "{error}");
    let (_, error) = run_with_exit_code(2, &folder, "split case.toml");
    assert!(
        error.contains("--ranks <N>: missing; expected wellposed split --ranks <N> <CASE>"),
        "{error}"
    );
    let (_, error) = run_with_exit_code(2, &folder, "time case.toml --blocks 4 --ranks 50");
    assert!(error.contains("50 ranks for 400 cells"), "{error}");
}
