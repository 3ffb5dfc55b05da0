"""The program, whose results the package must have to the bit."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session", autouse=True)
def backend() -> None:
    import matplotlib

    matplotlib.use("Agg")


@pytest.fixture(scope="session")
def program_path() -> Path:
    """Path of the program: environment variable ``wellposed``, by default that of ``target``."""
    default = ROOT / "target" / "release" / "wellposed"
    path = Path(os.environ.get("wellposed", default))
    if not path.is_file():
        pytest.skip(f"no program at {path}")
    return path.resolve()


@pytest.fixture(scope="session")
def program(program_path: Path, tmp_path_factory: pytest.TempPathFactory):
    """Run a verb of the program; returns the folder."""

    def run(*arguments: str) -> Path:
        folder = tmp_path_factory.mktemp("results") / "out"
        done = subprocess.run(
            [program_path, *arguments, "--pictures", "none", "--out", str(folder)],
            capture_output=True,
            text=True,
            cwd=ROOT,
        )
        assert done.returncode == 0, done.stderr
        return folder

    return run
