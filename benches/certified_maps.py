#!/usr/bin/env python3
"""Certified maps against dense sampling: cells that are not decided, by those that the boundary crosses, and times.

    python3 benches/certified_maps.py target/release/wellposed [CELLS …]

needs numpy and some gigabytes of scratch space. A cell is crossed if points of a map with 4 points per step (2 from 1000
cells on) inside it or on its edges have different verdicts, or a marginal one; for the plastic potential, which is ill-posed
on both sides of φ = ν, if φ − ν changes its sign or vanishes in it.
"""

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

CASES = {
    "noncoaxiality bound": ["noncoaxiality-bound"],
    "dilatant domain": ["dilatant-domain"],
    "plastic potential": ["plastic-potential"],
    "double shearing": [
        "cases/flow/double-shearing.toml",
        "--set",
        "map={ x = { parameter = 'background.noncoaxiality_deg', from = -40, to = 40 }, "
        "y = { parameter = 'model.friction_angle_deg', from = 6, to = 50 } }",
    ],
    "flutter": ["flutter"],
    "shear bands": ["shear-band"],
}


def run(program, case, points, out, *options):
    """Computes a map; returns its arrays, its report and the time of all threads, s."""
    sizes = ["--set", f"map.x.points={points}", "--set", f"map.y.points={points}"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [program, "map", *case, *sizes, "--no-pictures", "--out", str(out), "--force", *options]
    subprocess.run(command, check=True, capture_output=True)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    arrays = np.load(out / "map.npz")
    return arrays["verdict"], json.loads((out / "map.json").read_text()), arrays, seconds


def crossed_cells(verdict, cells, per_step):
    """Cells with different verdicts among their points, or with a marginal one."""
    least = np.full((cells, cells), 127)
    most = np.full((cells, cells), -1)
    for i in range(per_step + 1):
        for j in range(per_step + 1):
            stop_i, stop_j = i + per_step * (cells - 1) + 1, j + per_step * (cells - 1) + 1
            part = verdict[i:stop_i:per_step, j:stop_j:per_step]
            least, most = np.minimum(least, part), np.maximum(most, part)
    return int(((least != most) | (most == 2)).sum())


def cells_on_diagonal(arrays):
    """Cells in which the model constants of both axes may be equal."""
    y, x = (arrays[str(own)] for own in arrays["axes"])
    difference = y[:, None] - x[None, :]
    corners = [difference[:-1, :-1], difference[1:, :-1], difference[:-1, 1:], difference[1:, 1:]]
    return int(((np.min(corners, axis=0) <= 0) & (np.max(corners, axis=0) >= 0)).sum())


def main():
    program, *sizes = sys.argv[1:]
    print("| map | cells | crossed | not decided | ratio | area proved | certified, s | ordinary, s |")
    print("|---|---|---|---|---|---|---|---|")
    for cells in [int(own) for own in sizes] or [300, 1000]:
        per_step = 4 if cells < 1000 else 2
        for name, case in CASES.items():
            with tempfile.TemporaryDirectory() as scratch:
                folder = Path(scratch)
                _, report, arrays, both = run(program, case, cells + 1, folder / "certified", "--certified")
                ordinary = run(program, case, cells + 1, folder / "ordinary")[3]
                own = report["certified"]
                if name == "plastic potential":
                    crossed = cells_on_diagonal(arrays)
                else:
                    dense = run(program, case, per_step * cells + 1, folder / "dense")[0]
                    crossed = crossed_cells(dense, cells, per_step)
                open_cells = own["cell_counts"]["not decided"]
                ratio = f"{open_cells / crossed:.2f}" if crossed else "–"
                shares = own["area_shares"]
                outside = shares["no state"]
                proved = 1 - shares["not decided"] - outside
                print(
                    f"| {name} | {cells}² | {crossed} | {open_cells} | {ratio} | "
                    f"{100 * proved / (1 - outside):.2f} % | {both - ordinary:.1f} | {ordinary:.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
