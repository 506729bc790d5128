"""Measured and simulated records."""
from __future__ import annotations

import json
import os
from typing import Any, Dict, Iterator, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from ._cases import Case, located, overriding

Path = Union[str, "os.PathLike[str]"]


class Record(Mapping[str, np.ndarray]):
    """Simultaneously sampled columns by name. The columns are read-only views of the data in memory."""

    def __init__(self, columns: Mapping[str, Any], units: Mapping[str, str], sample_rate: Optional[float]):
        self._columns = dict(columns)
        self.units = dict(units)  #: unit per column; empty if unknown
        self.sample_rate = sample_rate  #: [Hz]; None if there is neither a time column nor a given rate

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            raise KeyError(f"{name!r}; there are: {', '.join(self._columns)}")
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def samples(self) -> int:
        return len(next(iter(self._columns.values()))) if self._columns else 0

    def __repr__(self) -> str:
        rate = f" at {self.sample_rate:g} Hz" if self.sample_rate else ""
        return f"<Record: {self.samples} samples{rate} of {', '.join(self._columns)}>"


def _record(found: Dict[str, Any]) -> Record:
    return Record(found["columns"], found["units"], found["sample_rate"])


def read_record(path: Path, columns: Sequence[str] = (), sample_rate: Optional[float] = None) -> Record:
    """Reads all columns of a measured file (delimited text, MATLAB, universal), or time and the given columns.

    Give `sample_rate` [Hz] for files without a time column.
    """
    return _record(_core.read_record(os.fspath(path), list(columns), sample_rate))


def data(path: Path, sample_rate: Optional[float] = None) -> Dict[str, Any]:
    """Describes a measured file and its anomalies: the output of `wheeltap data --json`."""
    return json.loads(_core.data(os.fspath(path), sample_rate))


def simulate(case: Case, *, seed: Optional[int] = None, changes: Optional[Mapping[str, Any]] = None,
             folder: Optional[Path] = None) -> Union[Record, Dict[str, Any]]:
    """Simulates noisy data from the `truth` of a case. Returns a Record for a sid case, else the case with its data."""
    path, text = located(case, folder)
    made = _core.simulate(path, text, overriding(changes), {"seed": seed})
    return json.loads(made) if isinstance(made, str) else _record(made)
