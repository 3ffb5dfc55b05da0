"""Tables: named arrays with axes and units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

    from ._wellposed import RawArray


class Array(NamedTuple):
    """An array of a table.

    Attributes
    ----------
    values : numpy.ndarray
        Values, the slowest axis first.
    axes : tuple of str
        Names of the axes.
    unit : str
        Unit; ``"1"`` if dimensionless, empty if the values are no quantities.
    """

    values: NDArray[Any]
    axes: tuple[str, ...]
    unit: str


class Table(Mapping[str, NDArray[Any]]):
    """Named arrays with axes and units: the content of a CSV or NPZ file of the program.

    ``table["name"]`` is the array of that name.

    Parameters
    ----------
    name : str
        Name of the file without extension.
    arrays : mapping
        Arrays by name.
    """

    def __init__(self, name: str, arrays: Mapping[str, Array]) -> None:
        self.name = name
        self._arrays = arrays

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays[name].values

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        return f"<wellposed.Table {self.name!r}: {', '.join(self)}>"

    def axes(self, name: str) -> tuple[str, ...]:
        """Names of the axes of an array, slowest first."""
        return self._arrays[name].axes

    def unit(self, name: str) -> str:
        """Unit of an array."""
        return self._arrays[name].unit

    def label(self, name: str) -> str:
        """Label of an array for pictures: name and unit."""
        unit = self.unit(name) if name in self else ""
        return name if unit in ("", "1") else f"{name} ({unit})"

    def to_xarray(self) -> xarray.Dataset:
        """Convert to a dataset with named axes, and units as attributes ``units``.

        Codes such as the verdicts of a map have the attributes ``flag_values`` and ``flag_meanings`` of the CF conventions.

        Returns
        -------
        xarray.Dataset
        """
        import xarray

        used = {axis for own in self._arrays.values() if not _is_text(own) for axis in own.axes}
        variables: dict[str, tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]] = {}
        coordinates = dict(variables)
        for name, (values, axes, unit) in self._arrays.items():
            if _is_text(self._arrays[name]) and not set(axes) <= used:
                continue
            attributes: dict[str, Any] = {"units": unit} if unit else {}
            meanings = self._arrays.get(f"{name}_names")
            if meanings is not None:
                attributes["flag_values"] = list(range(len(meanings.values)))
                attributes["flag_meanings"] = " ".join(
                    str(own).replace(" ", "_") for own in meanings.values
                )
            target = coordinates if axes in ((name,), ()) else variables
            target[name] = (axes, values, attributes)
        return xarray.Dataset(variables, coordinates)

    def plot(self, *names: str, x: Optional[str] = None, ax: Optional[Axes] = None) -> Axes:
        """Draw arrays with Matplotlib: a map of one array with two axes, or curves.

        Parameters
        ----------
        *names : str
            Arrays to be drawn; by default the first ones of one unit.
        x : str, optional
            Array on the horizontal axis of curves; by default the first.
        ax : matplotlib.axes.Axes, optional
            Axes to draw into.

        Returns
        -------
        matplotlib.axes.Axes
        """
        import matplotlib.pyplot as plt

        unknown = [name for name in (*names, *([x] if x else [])) if name not in self]
        if unknown:
            raise KeyError(f"found {unknown[0]!r}; expected one of: {', '.join(self)}")
        own = ax if ax is not None else plt.figure(layout="constrained").subplots()
        planar = [
            name
            for name in names or self
            if len(self.axes(name)) == 2 and all(axis in self for axis in self.axes(name))
        ]
        if planar and (x is None):
            _draw_map(self, planar[0], own)
        else:
            _draw_curves(self, names, x, own)
        return own


def from_raw(name: str, arrays: list[RawArray]) -> Table:
    """Create a table from arrays of the extension module; columns of tables have no axes."""
    if any(axes is None for _, axes, _, _ in arrays):
        return from_columns(name, {own: (values, unit) for own, _, unit, values in arrays})
    return Table(name, {own: Array(values, axes or (), unit) for own, axes, unit, values in arrays})


def from_columns(name: str, columns: Mapping[str, tuple[NDArray[Any], str]]) -> Table:
    """Create a table from columns with units; the axis is the first column if it increases, else ``row``."""
    axis = "row"
    if columns:
        first, (values, _) = next(iter(columns.items()))
        if values.dtype.kind == "f" and np.all(np.diff(values) > 0):
            axis = first
    return Table(
        name, {own: Array(values, (axis,), unit) for own, (values, unit) in columns.items()}
    )


def _is_text(array: Array) -> bool:
    return array.values.dtype.kind == "U"


def _draw_map(table: Table, name: str, ax: Axes) -> None:
    vertical, horizontal = table.axes(name)
    values = table[name]
    figure = ax.get_figure()
    meanings = f"{name}_names"
    if meanings in table:
        import matplotlib.colors as colours

        texts = [str(own) for own in table[meanings]]
        present = np.unique(values)
        # Seven colours that people with colour blindness can tell apart, after Okabe and Ito.
        palette = ["#56b4e9", "#d55e00", "#f0e442", "#999999", "#cccccc", "#ffffff", "#cc79a7"]
        # The same code has the same colour in all maps; "none" takes the last one.
        shift = 1 if texts[0] == "none" else 0
        drawn = ax.pcolormesh(
            table[horizontal],
            table[vertical],
            np.searchsorted(present, values),
            cmap=colours.ListedColormap([palette[(own - shift) % len(palette)] for own in present]),
            vmin=-0.5,
            vmax=len(present) - 0.5,
        )
        if figure is not None:
            bar = figure.colorbar(drawn, ax=ax, ticks=range(len(present)))
            bar.set_ticklabels([texts[own] for own in present])
    else:
        drawn = ax.pcolormesh(table[horizontal], table[vertical], values)
        if figure is not None:
            figure.colorbar(drawn, ax=ax, label=table.label(name))
    ax.set_xlabel(table.label(horizontal))
    ax.set_ylabel(table.label(vertical))


def _draw_curves(table: Table, names: Iterable[str], x: Optional[str], ax: Axes) -> None:
    lists = [own for own in table if len(table.axes(own)) == 1]
    groups = [own for own in lists if table.unit(own) == "" and own not in ("names", "units")]
    quantities = [own for own in lists if table.unit(own) and own not in groups]
    if not quantities:
        raise ValueError(f"{table.name}: has no curves to draw; draw a part of to_xarray()")
    horizontal = x or quantities[0]
    shown = list(names)
    if not shown:
        others = [own for own in quantities if table.unit(own) != table.unit(horizontal)] or [
            own for own in quantities if own != horizontal
        ]
        shown = [own for own in others if table.unit(own) == table.unit(others[0])]
    along = table.axes(horizontal)
    groups = [own for own in groups if table.axes(own) == along]
    keys = list(zip(*(table[own] for own in groups))) if groups else []
    for key in dict.fromkeys(keys) if groups else [()]:
        chosen = (
            np.array([own == key for own in keys]) if groups else np.full(len(table[horizontal]), True)
        )
        for name in shown:
            parts = [_format_group(own, value) for own, value in zip(groups, key)]
            parts += [name] if len(shown) > 1 else []
            ax.plot(table[horizontal][chosen], table[name][chosen], label=", ".join(parts))
    ax.set_xlabel(table.label(horizontal))
    ax.set_ylabel(table.label(shown[0]) if len(shown) == 1 else table.unit(shown[0]))
    if len(ax.lines) > 1:
        ax.legend(fontsize="small")


def _format_group(name: str, value: Any) -> str:
    return str(value) if isinstance(value, str) else f"{name} {value:g}"
