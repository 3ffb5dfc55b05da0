"""Exceptions of the package."""

from __future__ import annotations


class StudyError(RuntimeError):
    """A study failed for a reason that is not an error of its case."""


class IllPosedError(StudyError):
    """The equations of a flow to be simulated are ill-posed."""


class CaseError(ValueError):
    """A case cannot be read or is invalid.

    Parameters
    ----------
    message : str
        Message with position, key, found and allowed values.
    key, found, allowed : str, optional
        See the attributes.
    line : int, optional
        See the attributes.

    Attributes
    ----------
    key : str or None
        Key with its section; ``None`` if the case could not be parsed.
    line : int or None
        Line in the file or text; ``None`` for overrides, for cases given as ``dict`` and for missing keys.
    found : str or None
        Description of the fault, such as the invalid value.
    allowed : str or None
        Allowed values, or the remedy.
    """

    def __init__(
        self,
        message: str,
        key: str | None = None,
        line: int | None = None,
        found: str | None = None,
        allowed: str | None = None,
    ) -> None:
        super().__init__(message, key, line, found, allowed)
        self.key = key
        self.line = line
        self.found = found
        self.allowed = allowed

    def __str__(self) -> str:
        return str(self.args[0])
