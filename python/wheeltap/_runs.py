"""Sampling runs and their results."""
from __future__ import annotations

import json
import os
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _core
from ._cases import Case, located, overriding
from ._page import HasReport
from ._progress import Watcher, watching

Path = Union[str, "os.PathLike[str]"]


class Draws(Mapping[str, np.ndarray]):
    """The draws by name, as in posterior.nc: read-only arrays (chain, draw) or (chain, draw, slot).

    An array is a view of the memory of the run, without a copy. A parameter is NaN in the draws of models that do not
    have this parameter. If a parameter has one slot per damage, the slots that a draw does not use are NaN.
    """

    def __init__(self, columns: Dict[str, Tuple[np.ndarray, Tuple[str, ...], str, str]]):
        self._columns = columns

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            raise KeyError(f"{name!r}; there are: {', '.join(self._columns)}")
        return self._columns[name][0][...]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def dims(self, name: str) -> Tuple[str, ...]:
        """Names of an array's dimensions."""
        return self._columns[name][1]

    def unit(self, name: str) -> str:
        """Unit of a parameter; empty if the parameter has no unit or an unknown unit."""
        return self._columns[name][2]

    @property
    def models(self) -> List[str]:
        """Names of the models, indexed by draws["model"]."""
        return self._columns["model"][3].split(";")

    def __repr__(self) -> str:
        inside = ", ".join(f"{name} {array.shape}" for name, (array, *_) in self._columns.items())
        return f"<Draws: {inside}>"


class Result(HasReport):
    """The results of a finished run. You can pickle a Result."""

    def __init__(self, run: "_core.Run"):
        self._run: Optional["_core.Run"] = run
        self._set(run.summary, run.text, run.run_id, run.stopped_early, list(run.lines))

    def _set(self, summary: str, text: str, run_id: str, stopped_early: bool, lines: List[str]) -> None:
        self._summary_json = summary
        self._draws: Optional[Draws] = None
        self._posterior: Optional[bytes] = None
        self.summary: Dict[str, Any] = json.loads(summary)  #: all numbers, as in summary.json
        self.text = text  #: the terminal output of the program
        self.run_id = run_id  #: identifier of the run; equal for runs of the same case with the same seed and options
        self.stopped_early = stopped_early
        self.notes = lines  #: messages issued during the run

    @property
    def answer(self) -> str:
        """The first sentences of the report, with a warning at the beginning if the run has not converged."""
        said = self.summary.get("answer") or {}
        return " ".join(part for part in (said.get(key) for key in ("caution", "headline", "detail")) if part)

    @property
    def probabilities(self) -> Dict[str, float]:
        """Posterior probability of each model."""
        return {model["name"]: model["probability"] for model in self.summary["models"]}

    @property
    def models(self) -> List[Dict[str, Any]]:
        """All results of each model: name, prior, probability, mcse, log_evidence, …"""
        return self.summary["models"]

    @property
    def converged(self) -> bool:
        """True if the chains have converged; if False, `warnings` gives the reasons."""
        return bool(self.summary["diagnostics"]["converged"])

    @property
    def warnings(self) -> List[str]:
        """Warnings, most serious first."""
        return self.summary["diagnostics"]["warnings"]

    @property
    def draws(self) -> Draws:
        """Draws of every parameter, and of the model index ("model"), by name."""
        if self._draws is None:
            assert self._run is not None
            self._draws = Draws(self._run.columns())
        return self._draws

    @property
    def chains(self) -> "List[_core.Chain]":
        """The engine's memory of each chain: model, theta, log_prior, log_likelihood, accepted."""
        if self._run is None:
            raise ValueError("chains: not available for a result from a pickle or a folder: use draws")
        return self._run.chains()

    def draws_of(self, parameter: str, model: Optional[str] = None) -> np.ndarray:
        """Returns a copy of all draws of a parameter in one vector, e.g. draws_of("location[2]", "2 damages").

        If `model` is not given, the vector contains the draws of all models that have the parameter.
        """
        name, _, slot = parameter.partition("[")
        name = name.replace(" ", "_") if name not in self.draws else name
        values = self.draws[name]
        if slot:
            values = values[..., int(slot.rstrip("]")) - 1]
        if model is not None:
            if model not in self.draws.models:
                raise ValueError(f"no model {model!r}; there are: {', '.join(self.draws.models)}")
            values = values[self.draws["model"] == self.draws.models.index(model)]
        values = np.asarray(values).ravel()
        return values[~np.isnan(values)]

    @property
    def posterior_nc(self) -> bytes:
        """The content of posterior.nc as bytes."""
        if self._posterior is None:
            assert self._run is not None
            self._posterior = self._run.posterior_nc()
        return self._posterior

    def to_xarray(self) -> Any:
        """Returns the groups of posterior.nc (posterior, sample_stats, …) as an xarray DataTree, or as a dictionary of
        Datasets if xarray has no DataTree. Needs xarray and netCDF4."""
        import netCDF4
        import xarray

        groups = {}
        with netCDF4.Dataset("posterior.nc", memory=self.posterior_nc) as file:
            attributes = {name: file.getncattr(name) for name in file.ncattrs()}
            for name, group in file.groups.items():
                groups[name] = xarray.open_dataset(xarray.backends.NetCDF4DataStore(group)).load()
        if hasattr(xarray, "DataTree"):
            tree = xarray.DataTree.from_dict({f"/{name}": dataset for name, dataset in groups.items()})
            tree.attrs.update(attributes)
            return tree
        return groups

    def save(self, folder: Path) -> None:
        """Writes the files of the program: summary.json, posterior.nc, report.html, summary.txt; all or none."""
        _core.keep(os.fspath(folder), self._summary_json, self.text, self.run_id, self.posterior_nc)

    def _page(self) -> str:
        return _core.report_page(self._summary_json, self.posterior_nc)

    def __repr__(self) -> str:
        return f"<Result: {self.answer}>"

    def __getstate__(self) -> Dict[str, Any]:
        columns = {name: self.draws._columns[name] for name in self.draws}
        return {"set": (self._summary_json, self.text, self.run_id, self.stopped_early, self.notes),
                "columns": columns, "posterior": self.posterior_nc}

    def __setstate__(self, state: Dict[str, Any]) -> None:
        self._run = None
        self._set(*state["set"])
        self._draws = Draws(state["columns"])
        self._posterior = state["posterior"]


def _run(work: Callable[..., "_core.Run"], case: Case, folder: Optional[Path], changes: Optional[Mapping[str, Any]],
         progress: Watcher, options: Dict[str, Any]) -> Result:
    path, text = located(case, folder)
    with watching(progress) as watch:
        return Result(work(path, text, overriding(changes), options, watch))


def damage(case: Case, *, seed: Optional[int] = None, chains: Optional[int] = None, warmup: Optional[int] = None,
           draws: Optional[int] = None, progress: Watcher = True, changes: Optional[Mapping[str, Any]] = None,
           folder: Optional[Path] = None, **options: Any) -> Result:
    """Identifies the number, locations and severities of damages.

    case      path of a case file, or a dictionary of the same content
    seed      seed of the Markov chains (default 1); the same seed gives the same draws for any number of threads
    chains, warmup, draws
              numbers of chains, of warm-up iterations and of draws per chain; by default, the engine chooses them
    progress  True: a line on standard error; False: nothing. A function of a Progress: called a few times per second;
              if the function returns False, the run stops early and returns the draws so far
    changes   changes of the case: {"data.cov": 0.002}
    folder    folder of the files that a dictionary names (default: the current folder)
    options   threads, search, quick, prior_only, evidence ("tmcmc+bridge"), max_memory_gb, max_hours, allow_commands,
              allow_hosts (a list of names)

    Ctrl-C ends the run immediately with KeyboardInterrupt, and the draws are lost. An invalid case raises CaseError
    with the message of the program. A file that cannot be read raises FileError.
    """
    return _run(_core.damage, case, folder, changes, progress,
                {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, **options})


def update(case: Case, *, seed: Optional[int] = None, chains: Optional[int] = None, warmup: Optional[int] = None,
           draws: Optional[int] = None, progress: Watcher = True, changes: Optional[Mapping[str, Any]] = None,
           folder: Optional[Path] = None, **options: Any) -> Result:
    """Infers the parameters of a structure from its measured modes. The arguments are those of `damage`."""
    return _run(_core.update, case, folder, changes, progress,
                {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, **options})


def sid(case: Case, *, seed: Optional[int] = None, chains: Optional[int] = None, warmup: Optional[int] = None,
        draws: Optional[int] = None, progress: Watcher = True, changes: Optional[Mapping[str, Any]] = None,
        folder: Optional[Path] = None, **options: Any) -> Result:
    """Identifies the equation of motion from a record. The arguments are those of `damage`."""
    return _run(_core.sid, case, folder, changes, progress,
                {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, **options})


def load(folder: Path) -> Result:
    """Loads a finished run from a folder written by the program or `Result.save`. Needs netCDF4."""
    import netCDF4

    def read(name: str, mode: str) -> Any:
        try:
            with open(os.path.join(os.fspath(folder), name), mode, **({} if "b" in mode else {"encoding": "utf-8"})) \
                    as file:
                return file.read()
        except OSError as error:
            raise _core.FileError(f"{error.filename}: {error.strerror}") from None

    summary, text, posterior = read("summary.json", "r"), read("summary.txt", "r"), read("posterior.nc", "rb")
    columns = {}
    with netCDF4.Dataset("posterior.nc", memory=posterior) as file:
        group = file.groups["posterior"]
        for name, variable in group.variables.items():
            if variable.dimensions[:2] == ("chain", "draw"):
                array = np.ma.filled(variable[...], np.nan) if variable.dtype.kind == "f" else np.asarray(variable[...])
                array.flags.writeable = False
                columns[name] = (array, variable.dimensions, getattr(variable, "units", ""),
                                 getattr(variable, "names", ""))
    kept = json.loads(summary)
    result = Result.__new__(Result)
    result.__setstate__({"set": (summary, text, kept["wheeltap"].get("run", ""),
                                 bool(kept["diagnostics"].get("stopped_early")), []),
                         "columns": columns, "posterior": posterior})
    return result
