"""Types of results, for mypy; not run."""

from pathlib import Path
from typing import Any, Optional

from numpy.typing import NDArray
from typing_extensions import assert_type

import wellposed

found = wellposed.map(Path("case.toml"), set={"map.x.points": 3}, bound=True, progress=False)
assert_type(found, wellposed.MapResult)
assert_type(found.well_posed_share, Optional[float])
assert_type(found.verdict, NDArray[Any])
assert_type(wellposed.point({"model": {"kind": "classical"}}).verdict, Optional[str])
run = wellposed.run("decay", on_snapshot=lambda fields: print(fields["v1"]), threads=2)
assert_type(run.receivers, Optional[wellposed.Table])
assert_type(wellposed.check("decay", set=["a.b=1"]).agrees, Optional[bool])
try:
    wellposed.run("decay")
except wellposed.CaseError as error:
    assert_type(error.key, Optional[str])
    assert_type(error.line, Optional[int])
wellposed.point(3)  # type: ignore[arg-type]
