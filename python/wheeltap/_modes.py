"""Computed natural frequencies and mode shapes."""
from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional

import numpy as np

from . import _core
from ._cases import Case, located, overriding


@dataclass(frozen=True)
class Modes:
    """The lowest modes of a beam or structure, including rigid-body modes."""

    frequencies_hz: np.ndarray
    rigid_body_modes: int
    certified: bool  #: True if it is certain that no mode is missing below the last mode
    x: Optional[np.ndarray]  #: positions of a beam's nodes [m]
    shapes: Any  #: beam: (mode, node) deflections; structure: a list of {node: {direction: motion}}
    report: Dict[str, Any]  #: the output of `wheeltap modes --json --shapes`

    def __len__(self) -> int:
        return len(self.frequencies_hz)


def modes(case: Case, n: Optional[int] = None, *, truth: bool = False, changes: Optional[Mapping[str, Any]] = None,
          folder: Optional[str] = None) -> Modes:
    """Computes the n lowest modes of the structure of a case: intact, or (`truth=True`) with the true defects."""
    path, text = located(case, folder)
    report = json.loads(_core.modes(path, text, overriding(changes), n, truth))
    x = np.array(report["x_m"]) if "x_m" in report else None
    return Modes(np.array(report["frequencies_hz"]), report["rigid_body_modes"], report["certified"], x,
                 np.array(report["deflections"]) if x is not None else report["shapes"], report)
