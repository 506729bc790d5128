"""Natural frequencies and shapes."""
from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional

import numpy as np

from . import _core
from ._cases import Case, located, overriding


@dataclass(frozen=True)
class Modes:
    """The lowest modes of a beam or structure, rigid-body ones included."""

    frequencies_hz: np.ndarray
    rigid_body_modes: int
    certified: bool  #: no mode below the last is missing
    x: Optional[np.ndarray]  #: of a beam's nodes [m]
    shapes: Any  #: of a beam: (mode, node) deflections; of a structure: a list of {node: {direction: motion}}
    report: Dict[str, Any]  #: all that `wheeltap modes --json --shapes` prints

    def __len__(self) -> int:
        return len(self.frequencies_hz)


def modes(case: Case, n: Optional[int] = None, *, truth: bool = False, changes: Optional[Mapping[str, Any]] = None,
          folder: Optional[str] = None) -> Modes:
    """The n lowest modes of the case's beam or structure: intact, or as damaged as the case's truth says."""
    path, text = located(case, folder)
    report = json.loads(_core.modes(path, text, overriding(changes), n, truth))
    x = np.array(report["x_m"]) if "x_m" in report else None
    return Modes(np.array(report["frequencies_hz"]), report["rigid_body_modes"], report["certified"], x,
                 np.array(report["deflections"]) if x is not None else report["shapes"], report)
