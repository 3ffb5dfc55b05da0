"""One function per study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Optional, TypeVar

from . import _wellposed
from ._case import CaseSource, Overrides, read_case
from ._progress import Progress, open_progress
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
    from_raw_result,
)
from ._table import Table, from_raw

if TYPE_CHECKING:
    from ._case import Case
    from ._wellposed import RawArray, RawResult

R = TypeVar("R", bound=Result)


def _finish(kind: type[R], raw: RawResult, case: Case) -> R:
    result = from_raw_result(raw, case)
    assert isinstance(result, kind)
    return result


def point(
    case: CaseSource,
    *,
    set: Overrides = None,
    certified: bool = False,
    over: Optional[Mapping[str, tuple[float, float]]] = None,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> PointResult:
    """Analyse the state of a case.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    certified : bool
        Whether to prove the verdict: :attr:`PointResult.certified`.
    over : dict, optional
        Least and largest values of at most two numbers, such as ``{"model.friction_angle_deg": (29, 31)}``: proves the verdict
        for all states between them.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    PointResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.

    Examples
    --------
    >>> state = {"background.noncoaxiality_deg": 50}
    >>> wellposed.point("noncoaxiality-bound", set=state).verdict
    'ill-posed'
    >>> box = {"background.noncoaxiality_deg": (-44, 44), "model.friction_angle_deg": (20, 40)}
    >>> wellposed.point("noncoaxiality-bound", over=box).certified["verdict"]
    'proved well-posed'
    """
    own = read_case(case, set)
    ends = [(key, float(low), float(high)) for key, (low, high) in (over or {}).items()]
    ranges = ends if certified or ends else None
    with open_progress(progress, "point") as report:
        raw = _wellposed.point(own._raw, ranges, report, threads)
    return _finish(PointResult, raw, own)


def map(
    case: CaseSource,
    *,
    set: Overrides = None,
    bound: bool = False,
    growth_rate: bool = False,
    model_blind: bool = False,
    certified: bool = False,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> MapResult:
    """Compute the verdict over two parameters, the section ``[map]`` of the case.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    bound : bool
        Whether to compute the supremum of the growth rate at well-posed points.
    growth_rate : bool
        Whether to compute the growth rate at the wave of the case.
    model_blind : bool
        Whether to derive every verdict from the linearised equations, none by closed form.
    certified : bool
        Whether to prove the verdict for all states of the cells between points.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    MapResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.

    Examples
    --------
    >>> found = wellposed.map("noncoaxiality-bound", set={"map.x.points": 10, "map.y.points": 2})
    >>> found.verdict.shape
    (2, 10)
    """
    own = read_case(case, set)
    with open_progress(progress, "map") as report:
        raw = _wellposed.map(own._raw, bound, growth_rate, model_blind, certified, report, threads)
    return _finish(MapResult, raw, own)


def dispersion(
    case: CaseSource,
    *,
    set: Overrides = None,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> DispersionResult:
    """Compute the dispersion relation of a solid or, with joints, the Bloch waves of a blocky medium.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    DispersionResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    with open_progress(progress, "dispersion") as report:
        raw = _wellposed.dispersion(own._raw, report, threads)
    return _finish(DispersionResult, raw, own)


def speeds(
    case: CaseSource,
    *,
    set: Overrides = None,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> SpeedsResult:
    """Compute the characteristic speeds of a solid by direction.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    SpeedsResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    with open_progress(progress, "speeds") as report:
        raw = _wellposed.speeds(own._raw, report, threads)
    return _finish(SpeedsResult, raw, own)


def shocks(
    case: CaseSource,
    *,
    set: Overrides = None,
) -> ShocksResult:
    """Compute exact plane waves in a granular or porous medium.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.

    Returns
    -------
    ShocksResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    return _finish(ShocksResult, _wellposed.shocks(own._raw), own)


def diagram(
    case: CaseSource,
    *,
    set: Overrides = None,
) -> DiagramResult:
    """Compute the diagram of a rheological scheme along its load path.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.

    Returns
    -------
    DiagramResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    return _finish(DiagramResult, _wellposed.diagram(own._raw), own)


def homogenise(
    case: CaseSource,
    *,
    set: Overrides = None,
    cells_per_block: int = 1,
    overturning: bool = False,
) -> HomogeniseResult:
    """Compute the Cosserat continuum that is equivalent to a blocky medium.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    cells_per_block : int
        Number of cells of the grid of the continuum per block along each axis.
    overturning : bool
        Whether overturning of blocks limits the couple stress, instead of the first opening of faces.

    Returns
    -------
    HomogeniseResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    raw, toml = _wellposed.homogenise(own._raw, cells_per_block, overturning)
    result = _finish(HomogeniseResult, raw, own)
    result._toml = toml
    return result


def check(
    case: CaseSource,
    *,
    set: Overrides = None,
    quick: bool = False,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> CheckResult:
    """Compare frequencies and growth rates: predicted by the analysis, measured by a solver.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    quick : bool
        Whether to measure the first wave number in two directions only, without refined grids.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    CheckResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    with open_progress(progress, "check") as report:
        raw = _wellposed.check(own._raw, quick, report, threads)
    return _finish(CheckResult, raw, own)


def run(
    case: CaseSource,
    *,
    set: Overrides = None,
    snapshot_interval: Optional[float] = None,
    on_snapshot: Optional[Callable[[Table], object]] = None,
    accept_ill_posed: bool = False,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> RunResult:
    """Simulate a solid or a flow: the sections ``[grid]``, ``[time]`` and ``[output]`` of the case.

    A simulation that stops early because of its state returns a result as well: see :attr:`RunResult.stopped`.

    Parameters
    ----------
    case : Case, str, path-like or dict
        The case: see :class:`Case`.
    set : dict or iterable of str, optional
        Overrides of keys, such as ``{"background.pressure": 1e3}``.
    snapshot_interval : float, optional
        Time between two snapshots, s; by default that of the case.
    on_snapshot : callable, optional
        Called with the fields of each snapshot, which are then not kept; the simulation waits for it, and an exception
        ends the simulation. ``fields["time"]`` is the time.
    accept_ill_posed : bool
        Whether a flow is simulated although its equations are ill-posed.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    RunResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own = read_case(case, set)
    if snapshot_interval is not None:
        own = read_case(own, {"output.snapshot_interval": snapshot_interval})
    take: Optional[Callable[[list[RawArray]], object]] = None
    if on_snapshot is not None:
        callback = on_snapshot

        def take(arrays: list[RawArray]) -> object:
            return callback(from_raw("fields", arrays))

    with open_progress(progress, "run") as report:
        raw = _wellposed.run(own._raw, accept_ill_posed, take, report, threads)
    return _finish(RunResult, raw, own)


def compare(
    first: CaseSource,
    second: CaseSource,
    *,
    set: Overrides = None,
    threads: Optional[int] = None,
    progress: Progress = True,
) -> ComparisonResult:
    """Simulate two cases of the same problem and compare the results.

    Parameters
    ----------
    first, second : Case, str, path-like or dict
        The cases; differences refer to the first.
    set : dict or iterable of str, optional
        Overrides of keys of both cases, such as ``{"background.pressure": 1e3}``.
    threads : int, optional
        Number of threads; by default one per core. Results do not depend on it.
    progress : bool or callable
        ``True`` for a bar of ``tqdm`` if it is installed, or a callable that takes the numbers of finished and of all steps.

    Returns
    -------
    ComparisonResult

    Raises
    ------
    CaseError
        The case cannot be read, is invalid or does not suit the study.
    StudyError
        The study failed.
    KeyboardInterrupt
        Ctrl-C ended the study.
    """
    own, other = read_case(first, set), read_case(second, set)
    with open_progress(progress, "compare") as report:
        raw = _wellposed.compare(own._raw, other._raw, report, threads)
    return _finish(ComparisonResult, raw, own)


def cases() -> dict[str, str]:
    """Return the bundled cases: texts by path.

    Returns
    -------
    dict of str to str
        The path, its last part, or that without ``.toml`` is a name of the case for all studies.
    """
    return dict(_wellposed.bundled_cases())
