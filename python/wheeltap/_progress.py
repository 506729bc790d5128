"""Progress display of a run."""
from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Optional, Union

from ._core import Progress

Watcher = Union[bool, Callable[[Progress], Any], None]


@contextmanager
def watching(progress: Watcher) -> Iterator[Optional[Callable[[Progress], Any]]]:
    """Yields a progress function: None, the function of the caller, or a display of one line on standard error."""
    if callable(progress):
        yield progress
        return
    if not progress:
        yield None
        return
    terminal = sys.stderr.isatty()
    told = [0.0, ""]

    def show(p: Progress) -> None:
        now = time.monotonic()
        if now - told[0] < (0.1 if terminal else 10.0) and p.stage == told[1]:
            return
        told[:] = [now, p.stage]
        chances = "  P = " + " ".join(f"{x:.2f}" for x in p.probabilities[:8]) if p.probabilities else ""
        line = f"{p.stage} {100 * p.fraction:3.0f} %{chances}"
        sys.stderr.write(f"\r\x1b[K{line}" if terminal else f"{line}\n")
        sys.stderr.flush()

    try:
        yield show
    finally:
        if terminal:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
