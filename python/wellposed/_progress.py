"""Progress bars."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Optional, Union

Progress = Union[bool, Callable[[int, int], object]]
"""``True`` for a bar of ``tqdm`` if it is installed, ``False``, or a callable that takes the finished and all steps."""


@contextmanager
def open_progress(
    progress: Progress, label: str
) -> Iterator[Optional[Callable[[int, int], object]]]:
    """Yield the callable that the extension module calls; close the bar at the end."""
    if callable(progress):
        yield progress
        return
    try:
        if not progress:
            raise ImportError
        from tqdm import tqdm
    except ImportError:
        yield None
        return
    # Short studies show no bar.
    with tqdm(desc=label, total=1, unit="step", delay=0.5, leave=False) as bar:

        def update(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield update
