"""Notebooks run, and so do the Python blocks of the documentation and the examples of docstrings."""

from __future__ import annotations

import doctest
import importlib
import inspect
import re
import subprocess
from pathlib import Path

import pytest

import wellposed

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs(path: Path, tmp_path: Path) -> None:
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "stored without outputs"
    client = nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()


def list_blocks(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)


PAGES = [ROOT / "README.md", ROOT / "python" / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
#: Results of the program that a block reads: arguments of the verb, shortened.
RESULTS = {
    "out/noncoaxiality-bound": ("map", "noncoaxiality-bound"),
    "out/foundation": ("run", "foundation", "--set", "time.duration=1e-3"),
    "out/lamb-3d": ("run", "lamb-3d", "--set", "time.duration=0.04"),
}


@pytest.mark.filterwarnings("ignore:FigureCanvasAgg is non-interactive")
@pytest.mark.parametrize("page", [page for page in PAGES if list_blocks(page)], ids=lambda page: page.name)
def test_python_blocks_run(
    program, program_path: Path, page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.chdir(tmp_path)
    blocks = list_blocks(page)
    for folder, arguments in RESULTS.items():
        if any(folder in block for block in blocks):
            Path("out").mkdir(exist_ok=True)
            Path(folder).symlink_to(program(*arguments), target_is_directory=True)
    if any("snapshots.zarr.zip" in block for block in blocks):
        pytest.importorskip("zarr", minversion="3")
        subprocess.run([program_path, "gather", "out/lamb-3d", "--zarr"], check=True)
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page.name, "exec"), names)
    plt.close("all")


@pytest.mark.parametrize("name", ["wellposed", "wellposed._studies", "wellposed._case"])
def test_examples_of_docstrings_hold(name: str) -> None:
    module = importlib.import_module(name)
    found = doctest.testmod(module, extraglobs={"wellposed": wellposed})
    assert found.attempted > 0 and found.failed == 0


def test_every_public_name_is_described() -> None:
    page = (ROOT / "docs/python.md").read_text()
    for name in wellposed.__all__:
        own = getattr(wellposed, name)
        if not (inspect.isclass(own) or inspect.isfunction(own)):
            continue
        assert own.__doc__, name
        if inspect.isfunction(own):
            assert f"`{name}(" in page or f"wellposed.{name}(" in page, name
            # numpydoc: every argument is described.
            text = inspect.getdoc(own) or ""
            for argument in inspect.signature(own).parameters:
                assert re.search(rf"^(.*, )?{argument}(,.*)? : ", text, re.M), (name, argument)
