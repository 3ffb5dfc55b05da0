"""Results of studies."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Protocol

from numpy.typing import NDArray

from ._case import Case
from ._table import Table, from_raw

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

    from ._wellposed import RawResult


class _Drawer(Protocol):
    """What draws the pictures of a result."""

    @property
    def picture_names(self) -> list[str]: ...

    def draw(self, name: str, format: str) -> bytes: ...


class Result:
    """Result of a study.

    ``result["name"]`` is an array of the first table.

    Attributes
    ----------
    study : str
        Name of the study, such as ``"map"``.
    case : Case
        The case.
    text : str
        Report as the program prints it.
    attributes : dict
        Report as the program's JSON file has it.
    tables : mapping of str to Table
        Tables by the name of the program's file without extension.
    """

    #: Arrays that :meth:`plot` draws by default, and the one on the horizontal axis.
    _plotted: tuple[tuple[str, ...], Optional[str]] = ((), None)

    def __init__(
        self,
        study: str,
        case: Case,
        text: str,
        attributes: dict[str, Any],
        tables: Mapping[str, Table],
        drawer: _Drawer,
    ) -> None:
        self.study = study
        self.case = case
        self.text = text
        self.attributes = attributes
        self.tables = tables
        self._drawer = drawer

    @property
    def table(self) -> Table:
        """The first table."""
        for table in self.tables.values():
            return table
        raise KeyError(f"{self.study}: this result has no tables; see attributes and text")

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.table[name]

    def to_xarray(self, table: Optional[str] = None) -> xarray.Dataset:
        """Convert a table to a dataset with named axes and units.

        Parameters
        ----------
        table : str, optional
            Name of the table; by default the first.

        Returns
        -------
        xarray.Dataset
        """
        chosen = self.table if table is None else self.tables[table]
        dataset = chosen.to_xarray()
        dataset.attrs = {"title": self.case.title, "case": self.case.name, "study": self.study}
        return dataset

    def plot(
        self,
        *names: str,
        table: Optional[str] = None,
        x: Optional[str] = None,
        ax: Optional[Axes] = None,
    ) -> Axes:
        """Draw arrays of a table with Matplotlib; see :meth:`Table.plot`.

        Parameters
        ----------
        *names : str
            Arrays to be drawn.
        table : str, optional
            Name of the table; by default the first.
        x : str, optional
            Array on the horizontal axis of curves.
        ax : matplotlib.axes.Axes, optional
            Axes to draw into.

        Returns
        -------
        matplotlib.axes.Axes
        """
        if table is not None:
            return self.tables[table].plot(*names, x=x, ax=ax)
        default_names, default_x = self._plotted
        return self.table.plot(*(names or default_names), x=x or default_x, ax=ax)

    @property
    def pictures(self) -> list[str]:
        """Names of the pictures that the program draws."""
        return self._drawer.picture_names

    def picture(self, name: Optional[str] = None, format: str = "png") -> bytes:
        """Draw a picture as the program does.

        Parameters
        ----------
        name : str, optional
            Name of the picture; by default the first.
        format : {"png", "svg", "pdf"}
            File format.

        Returns
        -------
        bytes
            Content of the file.
        """
        if name is None:
            if not self.pictures:
                raise ValueError(f"{self.study}: this result has no pictures")
            name = self.pictures[0]
        return self._drawer.draw(name, format)

    def __repr__(self) -> str:
        return f"<wellposed.{type(self).__name__} of {self.case.name!r}>\n{self.text}"

    def _repr_html_(self) -> str:
        picture = ""
        if self.pictures:
            data = base64.b64encode(self.picture()).decode()
            picture = f'<img style="max-width: 100%" alt="{html.escape(self.pictures[0])}" '
            picture += f'src="data:image/png;base64,{data}">'
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{html.escape(', '.join(table))}</td></tr>"
            for name, table in self.tables.items()
        )
        tables = f"<table><tr><th>table</th><th>arrays</th></tr>{rows}</table>" if rows else ""
        return f"<div><pre>{html.escape(self.text)}</pre>{picture}{tables}</div>"


class PointResult(Result):
    """Analysis of one state: background, characteristics, roots, growth, verdict with evidence."""

    @property
    def verdict(self) -> Optional[str]:
        """Verdict, such as ``"well-posed"``; ``None`` if the state does not deform fully."""
        return _text(self.attributes.get("verdict"))

    @property
    def order(self) -> Optional[float]:
        """Order of growth in the wave number of an ill-posed state."""
        return _number(self.attributes.get("order"))

    @property
    def coefficient(self) -> Optional[float]:
        """Growth coefficient lim Re ς / k^order, m^order/s."""
        return _number(self.attributes.get("coefficient"))

    @property
    def certified(self) -> Optional[dict[str, Any]]:
        """What is proved of all states of a box: ``verdict``, ``method``, ``box``, ``shares``; ``None`` if it was not asked for."""
        found = self.attributes.get("certified")
        return found if isinstance(found, dict) else None


class MapResult(Result):
    """Verdict over two parameters."""

    @property
    def x(self) -> str:
        """Parameter on the horizontal axis."""
        return str(self.attributes["x"]["parameter"])

    @property
    def y(self) -> str:
        """Parameter on the vertical axis."""
        return str(self.attributes["y"]["parameter"])

    @property
    def verdict(self) -> NDArray[Any]:
        """Codes of the verdicts, with axes (y, x): indices of :attr:`verdict_names`."""
        return self["verdict"]

    @property
    def verdict_names(self) -> list[str]:
        """Names of the verdicts by code."""
        return [str(name) for name in self["verdict_names"]]

    @property
    def well_posed_share(self) -> Optional[float]:
        """Share of well-posed states among the assessed states."""
        return _number(self.attributes["well_posed_share"])


class DispersionResult(Result):
    """Frequencies and speeds of the waves of a solid by wave number, or Bloch waves of a blocky medium."""


class SpeedsResult(Result):
    """Characteristic speeds of a solid by direction, elastic and yielding."""


class ShocksResult(Result):
    """Exact plane waves in a granular or porous medium."""


class DiagramResult(Result):
    """Stress against strain of a rheological scheme, and energies of its elements."""

    _plotted = (("stress",), "strain")


class HomogeniseResult(Result):
    """Cosserat continuum that is equivalent to a blocky medium."""

    _toml = ""

    @property
    def continuum(self) -> Case:
        """Case of the continuum."""
        return Case(self._toml)


class ComparisonResult(Result):
    """Differences between two runs of the same problem."""


class CheckResult(Result):
    """Frequencies and growth rates of waves: predicted by the analysis, measured by a solver."""

    @property
    def agrees(self) -> Optional[bool]:
        """Whether all measurements agree; ``None`` if nothing can be measured."""
        found = self.attributes.get("agrees")
        return None if found is None else bool(found)


class RunResult(Result):
    """Simulation of a solid or a flow: fields, receiver records, energy ledger.

    Attributes
    ----------
    snapshots : sequence of Table
        Fields at the times of the snapshots, unless a callback took them.
    """

    snapshots: Sequence[Table] = ()

    @property
    def fields(self) -> Table:
        """Fields at the end; axes (x2, x1), in space (x3, x2, x1)."""
        return self.tables["fields"]

    @property
    def ledger(self) -> Table:
        """Energy ledger."""
        return self.tables["ledger"]

    @property
    def receivers(self) -> Optional[Table]:
        """Receiver records; ``None`` without receivers."""
        return self.tables.get("receivers")

    @property
    def final_time(self) -> float:
        """Simulated time reached, s."""
        return float(self.attributes["time"])

    @property
    def stopped(self) -> Optional[str]:
        """Reason why the run ended before its duration; ``None`` if it is complete."""
        return _text(self.attributes["stopped"])


#: Class of the result of each study.
CLASSES: dict[str, type[Result]] = {
    "point": PointResult,
    "map": MapResult,
    "dispersion": DispersionResult,
    "speeds": SpeedsResult,
    "shocks": ShocksResult,
    "diagram": DiagramResult,
    "homogenise": HomogeniseResult,
    "compare": ComparisonResult,
    "check": CheckResult,
    "run": RunResult,
}


def from_raw_result(raw: RawResult, case: Case) -> Result:
    """Create the result of the class of its study."""
    tables = {name: from_raw(name, arrays) for name, arrays in raw.tables.items()}
    result = CLASSES[raw.name](raw.name, case, raw.text, json.loads(raw.json), tables, raw)
    if isinstance(result, RunResult):
        result.snapshots = [from_raw("fields", arrays) for arrays in raw.snapshots]
    return result


def _text(value: Any) -> Optional[str]:
    return None if value is None else str(value)


def _number(value: Any) -> Optional[float]:
    return None if value is None else float(value)
