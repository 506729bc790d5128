"""Identification of modes from vibration records of a structure."""
from __future__ import annotations

import json
import os
from typing import Any, Dict, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from ._cases import Case, located, overriding, text_of
from ._page import HasReport

Path = Union[str, "os.PathLike[str]"]


class Modal(HasReport):
    """Identified modes with their uncertainty. Arrays are read-only views."""

    def __init__(self, core: "_core.Modal"):
        self._core = core
        self.summary: Dict[str, Any] = json.loads(core.summary)  #: as in summary.json

    @property
    def frequencies_hz(self) -> np.ndarray:
        """Natural frequencies [Hz]."""
        return self._core.frequencies_hz

    @property
    def frequencies_sd(self) -> np.ndarray:
        """Standard deviations of the frequencies [Hz]."""
        return np.sqrt(np.diag(self.covariance)[:len(self.frequencies_hz)])

    @property
    def frequency_covariance(self) -> np.ndarray:
        """Covariance of the frequencies [Hz²], as `data.covariance` of a case requires it."""
        n = len(self.frequencies_hz)
        return self.covariance[:n, :n]

    @property
    def damping(self) -> np.ndarray:
        """Damping ratios."""
        return self._core.damping

    @property
    def covariance(self) -> np.ndarray:
        """Covariance matrix: all frequencies [Hz], followed by all damping ratios."""
        return self._core.covariance

    @property
    def shapes(self) -> np.ndarray:
        """Complex mode shapes (sensors × modes); the largest component of each shape is 1."""
        return self._core.shapes

    @property
    def modes(self) -> Dict[str, Any]:
        """The content of modes.json."""
        return json.loads(self._core.modes_json)

    @property
    def text(self) -> str:
        """The terminal output of the program."""
        return self._core.text

    def __len__(self) -> int:
        return len(self.frequencies_hz)

    def save(self, folder: Path) -> None:
        """Writes modes.json, summary.json and report.html."""
        self._core.keep(os.fspath(folder))

    def _page(self) -> str:
        return self._core.page()

    def __repr__(self) -> str:
        return f"<Modal: {', '.join(f'{f:.4g}' for f in self.frequencies_hz)} Hz>"


def modal(case: Optional[Case] = None, *, channels: Optional[Mapping[str, Any]] = None,
          sample_rate: Optional[float] = None, band: Optional[Sequence[float]] = None,
          references: Sequence[str] = (), title: Optional[str] = None, threads: Optional[int] = None,
          changes: Optional[Mapping[str, Any]] = None, folder: Optional[Path] = None) -> Modal:
    """Identifies frequencies, damping ratios and shapes from a modal case, or from `channels` = {name: samples}.

    sample_rate  sampling rate of `channels` [Hz]
    band         [lowest, highest] frequency of the modes [Hz]
    references   names of the reference channels for the covariances of the responses; default: all channels
    """
    options = {"threads": threads}
    if (case is None) == (channels is None):
        raise ValueError("modal: needs either a case or channels, not both")
    if case is not None:
        path, text = located(case, folder)
        return Modal(_core.modal(path, text, overriding(changes), options))
    columns = {str(name): np.asarray(values, dtype=float).ravel() for name, values in channels.items()}
    unknown = [name for name in references if name not in columns]
    if unknown:
        raise ValueError(f"modal: references: no channel {unknown[0]!r}; there are: {', '.join(columns)}")
    made: Dict[str, Any] = {"kind": "modal", "title": title or "Modes", "record": {
        "file": "channels",
        "channels": [{"column": name, "role": "response", **({"reference": True} if name in references else {})}
                     for name in columns]}}
    if sample_rate is not None:
        made["record"]["sample_rate"] = sample_rate
    if band is not None:
        made["band"] = list(band)
    return Modal(_core.modal_of_channels(text_of(made), columns, options))
