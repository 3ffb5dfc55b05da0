"""The Zarr store of the program, read by xarray, has the final fields of the run."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

CASE = "cases/dynamics/foundation.toml"


@pytest.mark.parametrize("precision", ["f64", "f32"])
def test_last_snapshot_is_the_final_state(program, program_path: Path, precision: str) -> None:
    xarray = pytest.importorskip("xarray")
    zarr = pytest.importorskip("zarr", minversion="3")
    settings = ("output.snapshot_interval=0.01", f"output.snapshot_precision={precision}")
    folder: Path = program("run", CASE, *(own for text in settings for own in ("--set", text)))
    done = subprocess.run([program_path, "gather", folder, "--zarr=50"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    store = zarr.storage.ZipStore(folder / "snapshots.zarr.zip", mode="r")
    found = xarray.open_zarr(store)
    final = np.load(folder / "fields.npz")
    assert np.array_equal(found.time, [0, 0.01, 0.02, 0.03])
    for axis in ("x1", "x2"):
        assert np.array_equal(found[axis], final[axis])
    for name in ("v1", "v2", "sigma11", "sigma22", "sigma12", "dissipation"):
        assert found[name].dims == ("time", "x2", "x1")
        assert np.array_equal(found[name][-1], final[name].astype(found[name].dtype)), name
    assert found.v1.dtype == {"f64": np.float64, "f32": np.float32}[precision]
    assert found.sigma22.attrs["units"] == "Pa"
