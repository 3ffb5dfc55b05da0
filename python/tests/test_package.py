"""Cases, errors, results and runs of the package."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import wellposed

FLOW = {
    "grid.cells": [36, 36],
    "initial[0].to": 8,
    "time.duration": 4e-6,
    "output.ledger_interval": 1e-6,
}
TEXT = """
[model]
kind = "harris-grekova"
friction_angle_deg = 30
moment_of_inertia = 1.25e-7
rotational_strength = 0
[background]
density = 1600
pressure = 1000
shear_rate = 2
stress_angle_deg = 0
noncoaxiality_deg = 50
[wave]
number = 500
"""
SECTIONS = {
    "model": {
        "kind": "harris-grekova",
        "friction_angle_deg": np.float64(30),
        "moment_of_inertia": 1.25e-7,
        "rotational_strength": np.int64(0),
    },
    "background": {
        "density": 1600,
        "pressure": 1000,
        "shear_rate": 2,
        "stress_angle_deg": 0,
        "noncoaxiality_deg": 50,
    },
    "wave": {"number": 500},
}


def test_path_text_and_dict_are_the_same_case(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(TEXT)
    cases = [wellposed.Case(source) for source in (file, str(file), TEXT, SECTIONS)]
    assert len({case.to_toml() for case in cases}) == 1
    results = [wellposed.point(case) for case in cases]
    assert {result.verdict for result in results} == {"ill-posed"}
    # Harris & Grekova (2005): well-posed below 45°.
    for overrides in (
        {"background.noncoaxiality_deg": 40},
        ["background.noncoaxiality_deg=40"],
        {"background.noncoaxiality_deg": np.float64(40)},
    ):
        assert wellposed.point(SECTIONS, set=overrides).verdict == "well-posed"
        assert wellposed.point(cases[0], set=overrides).verdict == "well-posed"


def test_a_dict_sets_keys_of_a_section() -> None:
    axis = {"parameter": "background.pressure", "from": 500, "to": 1e3}
    flat = {f"map.y.{key}": value for key, value in axis.items()}
    found = wellposed.Case("noncoaxiality-bound", set={"map.y": axis})
    assert found.to_toml() == wellposed.Case("noncoaxiality-bound", set=flat).to_toml()
    assert "background.pressure" in found.to_toml()


def test_lists_of_tables_and_odd_texts_survive_the_dict() -> None:
    from wellposed._case import to_toml

    import tomllib

    sections = {
        "title": 'quote " backslash \\ line\nbreak ω \x7f',
        "receiver": [{"name": "a b", "at": np.array([0.1, -2.5e-300])}, {"at": (1, 2)}],
        "odd key": {"α": True, "x": [[1, 2], [3.0, float("inf")]], "deep": {"er": {"y": False}}},
    }
    expected = {
        "title": sections["title"],
        "receiver": [{"name": "a b", "at": [0.1, -2.5e-300]}, {"at": [1, 2]}],
        "odd key": sections["odd key"],
    }
    assert tomllib.loads(to_toml(sections)) == expected


def test_errors_have_key_line_found_and_allowed() -> None:
    with pytest.raises(wellposed.CaseError) as caught:
        wellposed.point(TEXT.replace("pressure = 1000", "pressure = -1"))
    error = caught.value
    assert isinstance(error, ValueError)
    assert (error.key, error.line) == ("background.pressure", 9)
    assert error.found is not None and "-1" in error.found
    assert error.allowed is not None and error.allowed in str(error)
    # The line of a generated text means nothing.
    wrong = {**SECTIONS, "background": {**SECTIONS["background"], "pressure": -1}}
    with pytest.raises(wellposed.CaseError) as caught:
        wellposed.point(wrong)
    assert (caught.value.key, caught.value.line) == ("background.pressure", None)
    assert "toml" not in str(caught.value)
    with pytest.raises(wellposed.CaseError, match="background.presure") as caught:
        wellposed.point(TEXT, set={"background.presure": 1})
    assert caught.value.line is None
    with pytest.raises(wellposed.CaseError, match="noncoaxiality-bound"):
        wellposed.point("noncoaxiality-bund")
    with pytest.raises(TypeError, match="object"):
        wellposed.point({"model": {"kind": object()}})
    with pytest.raises(wellposed.CaseError):
        wellposed.run(TEXT)


def test_ill_posed_runs_are_refused_unless_accepted() -> None:
    settings = {**FLOW, "time.duration": 1e-6}
    with pytest.raises(wellposed.IllPosedError, match="accept_ill_posed=True"):
        wellposed.run("plastic-potential-in-time", set=settings, progress=False)
    found = wellposed.run(
        "plastic-potential-in-time", set=settings, accept_ill_posed=True, progress=False
    )
    assert found.final_time > 0


def test_arrays_are_moved_and_outlive_their_result() -> None:
    found = wellposed.run("decay", set=FLOW, progress=False)
    field = found.fields["v1"]
    before = field.copy()
    assert field.shape == (36, 36) and field.flags.writeable and not field.flags.owndata
    # The memory belongs to an object of the extension module, not to a copy.
    assert type(field.base).__name__ == "ArrayMemory"
    del found
    gc.collect()
    assert np.array_equal(field, before)
    field[:] = 1.0
    assert field.sum() == 36 * 36


def test_xarray_has_axes_and_units() -> None:
    pytest.importorskip("xarray")
    found = wellposed.map("noncoaxiality-bound", set={"map.x.points": 7, "map.y.points": 3})
    data = found.to_xarray()
    assert dict(data.sizes) == {found.y: 3, found.x: 7}
    assert data[found.x].units == "deg"
    assert data["coefficient"].dims == (found.y, found.x)
    assert data["verdict"].flag_meanings.split()[:2] == ["well-posed", "ill-posed"]
    run = wellposed.run("decay", set=FLOW, progress=False)
    fields = run.to_xarray()
    assert fields["v1"].dims == ("x2", "x1") and fields["v1"].units == "m/s"
    assert float(fields["time"]) == run.final_time
    ledger = run.to_xarray("ledger")
    assert ledger["kinetic"].dims == ("time",) and ledger["kinetic"].units == "J/m3"
    speeds = wellposed.speeds("flutter").to_xarray()
    assert speeds["squared_speed"].units == "m2/s2"


@pytest.mark.parametrize(
    ("study", "case"),
    [
        ("map", "noncoaxiality-bound"),
        ("point", "plastic-potential"),
        ("dispersion", "forbidden-band"),
        ("dispersion", "cracks"),
        ("speeds", "flutter"),
        ("diagram", "granular-plastic"),
        ("shocks", "foam-collapse"),
    ],
)
def test_results_draw_themselves(study: str, case: str) -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    settings = {"map.x.points": 7, "map.y.points": 5} if study == "map" else None
    found = getattr(wellposed, study)(case, set=settings)
    axes = found.plot()
    assert axes.lines or axes.collections
    axes.figure.canvas.draw()
    plt.close("all")
    page = found._repr_html_()
    assert "<pre>" in page and "data:image/png;base64," in page
    assert found.picture(format="svg").startswith(b"<svg") or b"<svg" in found.picture(format="svg")
    with pytest.raises(ValueError, match="expected png, svg or pdf"):
        found.picture(format="bmp")


def test_snapshots_are_kept_or_passed_to_a_callback() -> None:
    settings = {**FLOW, "output.snapshot_interval": 2e-6}
    kept = wellposed.run("decay", set=settings, progress=False).snapshots
    taken: list[wellposed.Table] = []
    found = wellposed.run(
        "decay", set=FLOW, snapshot_interval=2e-6, on_snapshot=taken.append, progress=False
    )
    assert not found.snapshots
    assert [float(own["time"]) for own in taken] == [float(own["time"]) for own in kept]
    assert len(taken) == 3
    for own, other in zip(taken, kept):
        assert np.array_equal(own["v1"], other["v1"])
    assert np.array_equal(taken[-1]["v1"], found.fields["v1"])


def test_exceptions_of_callables_end_the_run() -> None:
    def refuse(_: wellposed.Table) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        wellposed.run("decay", set=FLOW, snapshot_interval=1e-6, on_snapshot=refuse)

    def fail(done: int, total: int) -> None:
        raise LookupError(f"{done} of {total}")

    with pytest.raises(LookupError):
        wellposed.run("decay", set=FLOW, progress=fail)


def test_progress_grows_to_its_end() -> None:
    seen: list[tuple[int, int]] = []
    wellposed.run("decay", set=FLOW, progress=lambda done, total: seen.append((done, total)))
    assert seen == sorted(seen) and seen[-1][0] == seen[-1][1]


def test_other_threads_work_during_a_run() -> None:
    counted = 0
    is_done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not is_done.wait(0.001):
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.perf_counter()
    wellposed.run("decay", set=FLOW, progress=False)
    elapsed = time.perf_counter() - begin
    is_done.set()
    thread.join()
    assert elapsed > 0.01 and counted > 2


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_interrupt_ends_a_run() -> None:
    script = (
        "import wellposed, sys\n"
        "print('started', flush=True)\n"
        "try:\n"
        "    wellposed.run('decay', set={'time.duration': 10.0}, progress=False)\n"
        "except KeyboardInterrupt:\n"
        "    sys.exit(7)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE)
    assert child.stdout is not None
    child.stdout.readline()
    time.sleep(1.0)
    begin = time.perf_counter()
    child.send_signal(signal.SIGINT)
    assert child.wait(20) == 7
    assert time.perf_counter() - begin < 5.0


def test_bundled_cases_and_folders() -> None:
    texts = wellposed.cases()
    assert any(path.endswith("noncoaxiality-bound.toml") for path in texts)
    with pytest.raises(FileNotFoundError, match="no results"):
        wellposed.load(Path(__file__).parent)


def test_compare_runs_both_cases() -> None:
    settings = {
        "block[0].repeat": [20, 10],
        "block[0].origin": [-0.5, -0.5],
        "time.duration": 1e-5,
    }
    first = wellposed.Case("comparison-breaking", set=settings)
    second = wellposed.Case(first, set={"joint[0].fracture": False})
    found = wellposed.compare(first, second, progress=False)
    assert found.attributes["averaging"]["count"] == 200
    assert found.to_xarray()["sigma22"].dims == ("time",)
