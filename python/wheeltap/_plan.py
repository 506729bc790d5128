"""Plans of tests: what a test could detect, and which sensors to use."""
from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Optional, Union

from . import _core
from ._cases import Case, located, overriding
from ._page import HasReport

Path = Union[str, "os.PathLike[str]"]


class Plan(HasReport):
    """A planned test."""

    def __init__(self, core: "_core.Plan"):
        self._core = core
        self.summary: Dict[str, Any] = json.loads(core.summary)  #: as in summary.json

    @property
    def designs(self) -> List[Dict[str, Any]]:
        """The designs by probability of the right location: sensors, information, detection, right_place, mcse."""
        return self.summary["plan"]["designs"]

    @property
    def sensors(self) -> List[str]:
        """Names of the sensors of the best design."""
        return self.designs[0]["sensor_names"]

    @property
    def smallest_detectable(self) -> List[Dict[str, Any]]:
        """For every location, the smallest severity that the best design detects with probability 0.9, or None."""
        return self.summary["plan"]["smallest_detectable"]

    @property
    def damage_case(self) -> Dict[str, Any]:
        """The damage case of the best design. Its key `truth` simulates the data of a test."""
        return json.loads(self._core.damage_case)

    @property
    def text(self) -> str:
        """The terminal output of the program."""
        return self._core.text

    def save(self, folder: Path) -> None:
        """Writes summary.json, damage.json and report.html."""
        self._core.keep(os.fspath(folder))

    def _page(self) -> str:
        return self._core.page()

    def __repr__(self) -> str:
        best = self.designs[0]
        return f"<Plan: {', '.join(self.sensors) or 'frequencies'}, detects {best['detection']:.3g}>"


def plan(case: Case, *, seed: Optional[int] = None, scenarios: int = 100_000, checks: int = 10,
         threads: Optional[int] = None, changes: Optional[Mapping[str, Any]] = None,
         folder: Optional[Path] = None) -> Plan:
    """Plans a test for a damage case with the key "plan" in place of "data".

    scenarios  number of simulated tests for each of the best designs
    checks     number of simulated tests that the full engine also analyses
    """
    path, text = located(case, folder)
    return Plan(_core.plan(path, text, overriding(changes), {"seed": seed, "threads": threads}, scenarios, checks))
