"""Monitoring of features, such as natural frequencies, under changing weather: onset of a change, and alarms."""
from __future__ import annotations

import csv
import json
import os
import tempfile
from typing import Any, Dict, List, Mapping, Optional, Union

import numpy as np

from . import _core
from ._cases import Case, located, overriding
from ._page import HasReport

Path = Union[str, "os.PathLike[str]"]


class Monitored(HasReport):
    """The results of a call of `monitor`."""

    def __init__(self, summary: str, text: str, folder: str, temporary: Any):
        self.summary: Dict[str, Any] = json.loads(summary)  #: as in summary.json
        self.text = text  #: the terminal output of the program
        self.folder = folder  #: holds summary.json, series.csv, state.nc and report.html
        self._temporary = temporary  # removes the folder with this object

    @property
    def alarm(self) -> bool:
        """True if there was an alarm."""
        return bool(self.summary["monitor"]["alarm"])

    @property
    def alarms(self) -> List[Dict[str, Any]]:
        """The alarms: time, onset with its 95 % interval, shift of each feature."""
        return self.summary["monitor"]["alarms"]

    @property
    def probability_changed(self) -> float:
        """P(at least one change since the end of the training period)."""
        return float(self.summary["monitor"]["probability_changed"])

    def columns(self, name: str = "series.csv") -> Dict[str, np.ndarray]:
        """The columns of series.csv, or of charts.csv, by header; empty cells are NaN. Dates are datetime64 in UTC."""
        with open(os.path.join(self.folder, name), encoding="utf-8", newline="") as file:
            header, *rows = csv.reader(file)
        out: Dict[str, np.ndarray] = {}
        for i, column in enumerate(header):
            cells = [row[i] for row in rows]
            if i == 0 and cells and ":" in cells[0]:
                out[column] = np.array([cell.rstrip("Z").replace(" ", "T") for cell in cells], dtype="datetime64[ns]")
            else:
                out[column] = np.array([float(cell) if cell else np.nan for cell in cells])
        return out

    def to_xarray(self) -> Any:
        """Returns series.csv as an xarray Dataset over time and feature, with the variables measured, predicted, sd,
        corrected, log_statistic, probability_changed and alarm. Needs xarray."""
        import xarray
        columns = self.columns()
        names = [name[:-len(" predicted")] for name in columns if name.endswith(" predicted")]
        over = ("time", "feature")

        def of(suffix: str) -> np.ndarray:
            return np.stack([columns[name + suffix] for name in names], axis=1)

        return xarray.Dataset(
            {"measured": (over, of("")), "predicted": (over, of(" predicted")), "sd": (over, of(" sd")),
             "corrected": (over, of(" corrected")), "log_statistic": ("time", columns["log statistic"]),
             "probability_changed": ("time", columns["P(changed)"]), "alarm": ("time", columns["alarm"] > 0)},
            coords={"time": columns["time"], "feature": names},
            attrs={"time_unit": self.summary["monitor"].get("time_unit", "")})

    def _page(self) -> str:
        with open(os.path.join(self.folder, "report.html"), encoding="utf-8") as file:
            return file.read()

    def __repr__(self) -> str:
        return f"<Monitored: {self.summary['answer'][0]}>"


def monitor(case: Case, *, series: Optional[Mapping[str, Any]] = None, output: Optional[Path] = None,
            resume: bool = False, charts: bool = False, seed: Optional[int] = None, threads: Optional[int] = None,
            changes: Optional[Mapping[str, Any]] = None, folder: Optional[Path] = None) -> Monitored:
    """Monitors the series of a monitor case.

    series  {column: values} in place of the table of the case; NaN: missing value
    output  folder of the results; default: a temporary folder that exists as long as the returned object
    resume  process only the rows that are new since the last call with this `output`
    charts  for comparison, also run the usual control charts
    """
    temporary = tempfile.TemporaryDirectory(prefix="wheeltap-") if output is None else None
    where = os.fspath(output) if output is not None else temporary.name  # type: ignore[union-attr]
    path, text = located(case, folder)
    overrides = list(overriding(changes))
    if series is not None:
        os.makedirs(where, exist_ok=True)
        table = os.path.join(os.path.abspath(where), "table.csv")
        columns = {str(name): np.asarray(values) for name, values in series.items()}
        lengths = {len(values) for values in columns.values()}
        if len(lengths) != 1:
            raise ValueError("monitor: series: all columns must have the same length")
        with open(table, "w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            for row in zip(*columns.values()):
                writer.writerow(["" if isinstance(x, float) and np.isnan(x) else x for x in
                                 (x.item() if isinstance(x, np.generic) and x.dtype.kind in "fi" else x for x in row)])
        overrides += overriding({"series.file": table})
    return Monitored(*_core.monitor(path, text, overrides, where, resume, charts, {"seed": seed, "threads": threads}),
                     where, temporary)
