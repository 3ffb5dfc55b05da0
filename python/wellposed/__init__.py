"""Well-posedness of continuum models of granular media: from a case to a verdict.

One function per study takes a case (a path, the name of a bundled case, TOML text or a ``dict``) with overrides and returns
a result with NumPy arrays, ``to_xarray()``, ``plot()`` and a representation in notebooks.

>>> import wellposed
>>> wellposed.point("noncoaxiality-bound", set={"background.noncoaxiality_deg": 40}).verdict
'well-posed'
"""

from ._case import Case, CaseSource, Overrides
from ._errors import CaseError, IllPosedError, StudyError
from ._load import load
from ._result import (
    CheckResult,
    ComparisonResult,
    DiagramResult,
    DispersionResult,
    HomogeniseResult,
    MapResult,
    PointResult,
    Result,
    RunResult,
    ShocksResult,
    SpeedsResult,
)
from ._studies import (
    cases,
    check,
    compare,
    diagram,
    dispersion,
    homogenise,
    map,
    point,
    run,
    shocks,
    speeds,
)
from ._table import Array, Table
from ._wellposed import VERSION as __version__

__all__ = [
    "Array",
    "Case",
    "CaseError",
    "CaseSource",
    "CheckResult",
    "ComparisonResult",
    "DiagramResult",
    "DispersionResult",
    "HomogeniseResult",
    "IllPosedError",
    "MapResult",
    "Overrides",
    "PointResult",
    "Result",
    "RunResult",
    "ShocksResult",
    "SpeedsResult",
    "StudyError",
    "Table",
    "__version__",
    "cases",
    "check",
    "compare",
    "diagram",
    "dispersion",
    "homogenise",
    "load",
    "map",
    "point",
    "run",
    "shocks",
    "speeds",
]
