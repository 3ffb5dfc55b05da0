"""Cases: from a path, a text or a ``dict``."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any, Union

from . import _wellposed

CaseSource = Union["Case", str, "os.PathLike[str]", Mapping[str, Any]]
"""A case, the path of a case file, the name of a bundled case, TOML text, or a ``dict`` of sections."""

Overrides = Union[Mapping[str, Any], Iterable[str], None]
"""Overrides: a ``dict`` such as ``{"background.pressure": 1e3}``, or texts such as ``"background.pressure=1e3"``."""


class Case:
    """A case, read and checked: a medium, a state, and what is to be computed.

    Parameters
    ----------
    source : Case, str, path-like or dict
        Path of a case file, name of a bundled case, TOML text (recognised by a line break or an equals sign), or the
        sections of a case as ``dict``.
    set : dict or iterable of str, optional
        Overrides, as the option ``--set`` of the program: keys with their section.

    Raises
    ------
    CaseError
        The case cannot be read or is invalid.

    Examples
    --------
    >>> case = wellposed.Case("noncoaxiality-bound", set={"background.noncoaxiality_deg": 50})
    >>> case.name
    'noncoaxiality-bound'
    """

    def __init__(self, source: CaseSource, set: Overrides = None) -> None:
        settings = _format_overrides(set)
        if isinstance(source, Case):
            self._source: str | os.PathLike[str] | Mapping[str, Any] = source._source
            self._settings: list[str] = source._settings + settings
        else:
            self._source = source
            self._settings = settings
        self._raw = _read(self._source, self._settings)

    @property
    def name(self) -> str:
        """Name of the case."""
        return self._raw.name

    @property
    def title(self) -> str:
        """Title of the case; empty if it has none."""
        return self._raw.title

    @property
    def hints(self) -> list[str]:
        """Hints on former names of keys that the case uses."""
        return self._raw.hints

    def to_toml(self) -> str:
        """Format the resolved case, defaults included, as text of a case file."""
        return self._raw.to_toml()

    def __repr__(self) -> str:
        return f"<wellposed.Case {self.name!r}>"


def read_case(case: CaseSource, set: Overrides) -> Case:
    """Return the case of a source with overrides."""
    if isinstance(case, Case) and set is None:
        return case
    return Case(case, set)


def _read(
    source: str | os.PathLike[str] | Mapping[str, Any], settings: list[str]
) -> _wellposed.RawCase:
    if isinstance(source, Mapping):
        return _wellposed.RawCase.parse(to_toml(source), settings, False)
    if isinstance(source, str) and ("\n" in source or "=" in source):
        return _wellposed.RawCase.parse(source, settings, True)
    return _wellposed.RawCase.load(source, settings)


def _format_overrides(set: Overrides) -> list[str]:
    if set is None:
        return []
    if isinstance(set, str):
        raise TypeError("set: found a text; expected a dict or a list of texts 'key=value'")
    if isinstance(set, Mapping):
        return [f"{key}={_format_value(value)}" for key, value in set.items()]
    return list(set)


def to_toml(sections: Mapping[str, Any]) -> str:
    """Format a ``dict`` as TOML, one line per entry of each section."""
    root: list[str] = []
    tables: list[str] = []
    for name, value in sections.items():
        if isinstance(value, Mapping):
            tables.append(f"[{_format_key(name)}]")
            tables.extend(f"{_format_key(key)} = {_format_value(own)}" for key, own in value.items())
        else:
            root.append(f"{_format_key(name)} = {_format_value(value)}")
    return "\n".join(root + tables) + "\n"


def _format_key(key: object) -> str:
    text = str(key)
    is_bare = text.isascii() and text.replace("_", "").replace("-", "").isalnum()
    return text if is_bare else _format_text(text)


def _format_text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _format_value(value: object) -> str:
    # NumPy arrays and numbers have these methods.
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return _format_text(value)
    if isinstance(value, os.PathLike):
        return _format_text(os.fspath(value))
    if isinstance(value, Mapping):
        pairs = (f"{_format_key(key)} = {_format_value(own)}" for key, own in value.items())
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(value, Iterable):
        return "[" + ", ".join(map(_format_value, value)) + "]"
    raise TypeError(
        f"case: found {value!r} of type {type(value).__name__}; "
        "expected numbers, texts, booleans, lists and dicts"
    )
