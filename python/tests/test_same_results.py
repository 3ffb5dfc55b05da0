"""Results of the package and of the program have the same bits, and folders opened by `load` have the same tables."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import wellposed

JOINTS = {"time.duration": 2e-6}
FLOW = {
    "grid.cells": [36, 36],
    "initial[0].to": 8,
    "time.duration": 4e-6,
    "output.ledger_interval": 1e-6,
}

CASES = [
    ("map", "noncoaxiality-bound", {"map.x.points": 13, "map.y.points": 9}),
    ("map", "flutter", {"map.x.points": 5, "map.y.points": 4}),
    ("point", "plastic-potential", {}),
    ("point", "forbidden-band", {}),
    ("point", "two-fluids", {}),
    ("dispersion", "forbidden-band", {}),
    ("dispersion", "cracks", {}),
    ("speeds", "flutter", {}),
    ("diagram", "granular-plastic", {}),
    ("shocks", "foam-collapse", {}),
    ("shocks", "sand-spall", {}),
    ("check", "heat", {}),
    ("run", "decay", FLOW),
    ("run", "cracks", JOINTS),
]


@pytest.mark.parametrize(("study", "case", "settings"), CASES)
def test_program_and_package_agree(program, study: str, case: str, settings: dict) -> None:
    options = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
    folder: Path = program(study, case, *options)
    # Studies without progress are short.
    is_short = study in ("diagram", "shocks")
    progress = {} if is_short else {"progress": False}
    found = getattr(wellposed, study)(case, set=settings, **progress)
    stored = wellposed.load(folder)
    assert type(found) is type(stored)
    assert found.attributes == json.loads((folder / f"{study}.json").read_text())
    assert found.text == (folder / f"{study}.txt").read_text()
    assert found.case.to_toml() == stored.case.to_toml()
    assert list(found.tables) == list(stored.tables)
    for name, table in found.tables.items():
        other = stored.tables[name]
        is_csv = not (folder / f"{name}.npz").is_file()
        # Records of a run have lists of names and units, which CSV files lack.
        own = [array for array in table if not (is_csv and array in ("names", "units"))]
        assert own == list(other), name
        for array in own:
            assert table.unit(array) == other.unit(array), (name, array)
            assert table.axes(array) == other.axes(array), (name, array)
            assert table[array].dtype.kind == other[array].dtype.kind, (name, array)
            assert table[array].shape == other[array].shape, (name, array)
            if table[array].dtype.kind == "f":
                # Equal bits, except that not-a-number has several.
                nan = np.isnan(table[array])
                assert np.array_equal(nan, np.isnan(other[array])), (name, array)
                same = np.where(nan, 0.0, table[array]).tobytes()
                assert same == np.where(nan, 0.0, other[array]).tobytes(), (name, array)
            else:
                assert np.array_equal(table[array], other[array]), (name, array)


def test_homogenise_writes_the_case_of_the_program(program, tmp_path: Path) -> None:
    import os
    import subprocess

    file = tmp_path / "continuum.toml"
    path = os.environ.get("wellposed", "target/release/wellposed")
    root = Path(__file__).parents[2]
    subprocess.run(
        [path, "homogenise", "comparison-breaking", "--out", str(file)], cwd=root, check=True
    )
    found = wellposed.homogenise("comparison-breaking")
    assert found._toml == file.read_text()
    assert found.continuum.to_toml() == wellposed.Case(file).to_toml()
