"""The stubs and annotations are right: `mypy --strict` of the package and of a program that uses it."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_mypy_accepts_the_package_and_its_use(tmp_path: Path) -> None:
    # A path in the folder of installed packages would make all of them files to be checked.
    settings = ["--strict", "--config-file", str(HERE.parent / "pyproject.toml"), "--cache-dir", str(tmp_path)]
    for target in (["-p", "wellposed"], [str(HERE / "typed_use.py")]):
        done = subprocess.run(
            [sys.executable, "-m", "mypy", *settings, *target], capture_output=True, text=True, cwd=tmp_path
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_has_what_the_module_has() -> None:
    import ast

    import wellposed
    from wellposed import _wellposed

    stub = Path(wellposed.__file__).parent / "_wellposed.pyi"
    names = {
        own.name
        for own in ast.parse(stub.read_text()).body
        if isinstance(own, (ast.ClassDef, ast.FunctionDef))
    }
    assert names == {own for own in dir(_wellposed) if not own.startswith("_") and own != "VERSION"}
