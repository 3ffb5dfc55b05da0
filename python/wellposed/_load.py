"""Results from the folders that the program writes."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _wellposed
from ._case import Case
from ._result import CLASSES, Result
from ._table import Array, Table, from_columns

#: Tables of each study, the first one first.
_TABLES = {
    "point": ["growth_by_direction", "growth_by_wave_number", "linearised"],
    "map": ["map"],
    "dispersion": ["dispersion"],
    "speeds": ["speeds", "sphere"],
    "shocks": ["shocks", "profile", "spall"],
    "diagram": ["diagram"],
    "compare": ["compare"],
    "check": [],
    "run": ["fields", "joints", "receivers", "ledger", "spectrum"],
}


def load(folder: str | os.PathLike[str], study: Optional[str] = None) -> Result:
    """Open a folder of results of the program; arrays are read when they are used.

    Parameters
    ----------
    folder : str or path-like
        The folder.
    study : str, optional
        Study whose results are opened, such as ``"map"``; needed if the folder holds several.

    Returns
    -------
    Result
        Of the class of the study. Snapshots in VTK files are not read.

    Raises
    ------
    FileNotFoundError
        The folder holds no results of the study.
    ValueError
        The folder holds results of several studies, and `study` is not given.
    """
    path = Path(folder)
    found = [name for name in _TABLES if (path / f"{name}.json").is_file()]
    if study is not None and study not in _TABLES:
        raise ValueError(f"study: found {study!r}; expected one of: {', '.join(_TABLES)}")
    if not found or (study is not None and study not in found):
        raise FileNotFoundError(
            f"{path}: found no results{f' of {study}' if study else ''}; "
            "expected a folder that the program has written"
        )
    if study is None and len(found) > 1:
        raise ValueError(f"{path}: found results of {', '.join(found)}; name one of them as study")
    name = study or found[0]
    attributes = json.loads((path / f"{name}.json").read_text(encoding="utf-8"))
    text = (path / f"{name}.txt").read_text(encoding="utf-8")
    case = Case(path / "case.toml")
    tables: dict[str, Table] = {}
    for table in _TABLES[name]:
        for kind, read in (("npz", _open_archive), ("csv", _open_csv)):
            file = path / f"{table}.{kind}"
            if file.is_file():
                tables[table] = read(file, case, attributes)
                break
    return CLASSES[name](name, case, text, attributes, tables, _Files(path, name))


class _Files:
    """Pictures of a folder."""

    def __init__(self, folder: Path, study: str) -> None:
        self._folder = folder
        self._study = study

    @property
    def picture_names(self) -> list[str]:
        names = {file.stem for file in self._folder.glob("*.png") if not file.stem.startswith(".")}
        return sorted(names, key=lambda name: (name != self._study, name))

    def draw(self, name: str, format: str) -> bytes:
        return (self._folder / f"{name}.{format}").read_bytes()


class _Lazy(Mapping[str, Array]):
    """Arrays that are read when they are used."""

    def __init__(self, names: list[str], read: Callable[[str], Array]) -> None:
        self._names = names
        self._read = read
        self._known: dict[str, Array] = {}

    def __getitem__(self, name: str) -> Array:
        if name not in self._known:
            if name not in self._names:
                raise KeyError(name)
            self._known[name] = self._read(name)
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _open_archive(file: Path, _case: Case, _attributes: dict[str, Any]) -> Table:
    archive = np.load(file)
    names: list[str] = list(archive.files)
    described = "names" if "names" in names else "axes"
    units: dict[str, str] = {}
    if "units" in names and described in names:
        units = dict(zip(map(str, archive[described]), map(str, archive["units"])))
    # Axes by the coordinates or the columns that the archive has.
    if "axes" in names:
        axes = tuple(str(own) for own in archive["axes"])
    elif file.stem == "fields":
        axes = tuple(own for own in ("x3", "x2", "x1") if own in names)
    else:
        axes = ({"receivers": "time", "joints": "face"}.get(file.stem, "row"),)

    def read(name: str) -> Array:
        values: NDArray[Any] = archive[name]
        if name.endswith("_names"):
            own: tuple[str, ...] = (name[:-1],)
        elif name in ("names", "units", "axes"):
            inner = "quantity" if file.stem == "fields" else "column"
            own = ("axis" if "axes" in names else inner,)
        elif name in axes and len(axes) > 1:
            own = (name,)
        elif name in _AXES:
            own = _AXES[name]
        else:
            own = axes[: values.ndim]
        unit = units.get(name) or _wellposed.column_unit(file.name, name) or ""
        return Array(values, own, unit)

    return Table(file.stem, _Lazy(names, read))


#: Axes of arrays that are no fields.
_AXES = {
    "deformation": ("row", "column"),
    "A": ("equation", "unknown"),
    "B": ("direction", "equation", "unknown"),
    "C": ("equation", "unknown"),
    "terms": ("term", "part"),
}


def _open_csv(file: Path, case: Case, attributes: dict[str, Any]) -> Table:
    with file.open(newline="", encoding="utf-8") as opened:
        header = next(csv.reader(opened))
    columns: dict[str, Array] = {}

    def read(name: str) -> Array:
        if not columns:
            columns.update(_read_csv(file, attributes)._arrays)
        return columns[name]

    return Table(file.stem, _Lazy(header, read))


def _read_csv(file: Path, attributes: dict[str, Any]) -> Table:
    with file.open(newline="", encoding="utf-8") as opened:
        header, *rows = csv.reader(opened)
    units = _record_units(file.stem, attributes)
    columns: dict[str, tuple[NDArray[Any], str]] = {}
    for index, name in enumerate(header):
        cells = [row[index] for row in rows]
        try:
            values: NDArray[Any] = np.array([float(cell) if cell else np.nan for cell in cells])
        except ValueError:
            values = np.array(cells, dtype=str)
        unit = units(name) or _wellposed.column_unit(file.name, name) or ""
        columns[name] = (values, unit)
    return from_columns(file.stem, columns)


def _record_units(table: str, attributes: dict[str, Any]) -> Callable[[str], Optional[str]]:
    """Units of the energies of a run, which depend on the case."""

    def unit(name: str) -> Optional[str]:
        if table not in ("ledger", "spectrum") or name == "time":
            return None
        return "W/m3" if name == "power" else str(attributes["ledger"]["unit"])

    return unit
