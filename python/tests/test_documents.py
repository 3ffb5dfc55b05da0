"""Notebooks run, and so do the Python blocks of the documentation and the examples of docstrings."""

from __future__ import annotations

import doctest
import importlib
import inspect
import re
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


@pytest.mark.parametrize("page", ["README.md", "docs/python.md", "docs/how-to.md", "python/README.md"])
def test_python_blocks_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.M | re.S)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


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
            for argument in inspect.signature(own).parameters:
                assert re.search(rf"^    (.*, )?{argument}(,.*)? : ", own.__doc__, re.M), (name, argument)
