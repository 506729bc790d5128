"""Runs that sample, and what they leave."""
from __future__ import annotations

import html
import json
import os
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _core
from ._cases import Case, located, overriding
from ._progress import Watcher, watching

Path = Union[str, "os.PathLike[str]"]


class Draws(Mapping[str, np.ndarray]):
    """The draws by name, as posterior.nc names them: read-only arrays (chain, draw) or (chain, draw, slot).

    An array is a view of memory that the run holds: asking again makes no copy. A parameter is NaN in draws of
    models that do not have it, and in slots that a draw does not use.
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
        """Unit of a parameter; empty where it has none, or none is known."""
        return self._columns[name][2]

    @property
    def models(self) -> List[str]:
        """Names of the models, which draws["model"] numbers."""
        return self._columns["model"][3].split(";")

    def __repr__(self) -> str:
        inside = ", ".join(f"{name} {array.shape}" for name, (array, *_) in self._columns.items())
        return f"<Draws: {inside}>"


class Result:
    """A finished run. It can be pickled."""

    def __init__(self, run: "_core.Run"):
        self._run: Optional["_core.Run"] = run
        self._set(run.summary, run.text, run.run_id, run.stopped_early, list(run.lines))

    def _set(self, summary: str, text: str, run_id: str, stopped_early: bool, lines: List[str]) -> None:
        self._summary_json = summary
        self._draws: Optional[Draws] = None
        self._posterior: Optional[bytes] = None
        self.summary: Dict[str, Any] = json.loads(summary)  #: all numbers, as in summary.json
        self.text = text  #: what the program prints
        self.run_id = run_id  #: the same for the same case, seed and options
        self.stopped_early = stopped_early
        self.notes = lines  #: what was said while it ran

    @property
    def answer(self) -> str:
        """The sentences that head a report, the caution first where the run cannot be trusted yet."""
        said = self.summary.get("answer") or {}
        return " ".join(part for part in (said.get(key) for key in ("caution", "headline", "detail")) if part)

    @property
    def probabilities(self) -> Dict[str, float]:
        """Posterior probability of each model."""
        return {model["name"]: model["probability"] for model in self.summary["models"]}

    @property
    def models(self) -> List[Dict[str, Any]]:
        """All that is known of each model: name, prior, probability, mcse, log_evidence, …"""
        return self.summary["models"]

    @property
    def converged(self) -> bool:
        """Whether the run may be relied on; `warnings` say why where it may not."""
        return bool(self.summary["diagnostics"]["converged"])

    @property
    def warnings(self) -> List[str]:
        """What to keep in mind, the gravest first."""
        return self.summary["diagnostics"]["warnings"]

    @property
    def draws(self) -> Draws:
        """Draws of every parameter, and of the model, by name."""
        if self._draws is None:
            assert self._run is not None
            self._draws = Draws(self._run.columns())
        return self._draws

    @property
    def chains(self) -> "List[_core.Chain]":
        """The engine's own memory, chain by chain: model, theta, log_prior, log_likelihood, accepted."""
        if self._run is None:
            raise ValueError("chains: a result from a pickle or a folder has its draws, not the engine's memory")
        return self._run.chains()

    def draws_of(self, parameter: str, model: Optional[str] = None) -> np.ndarray:
        """All draws of a parameter in one vector, e.g. draws_of("location[2]", "2 damages"); a copy.

        Without a model, of all models that have it.
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
        """The bytes of posterior.nc."""
        if self._posterior is None:
            assert self._run is not None
            self._posterior = self._run.posterior_nc()
        return self._posterior

    def to_xarray(self) -> Any:
        """The groups of posterior.nc (posterior, sample_stats, …) as xarray has them: a DataTree, or, where xarray
        has none yet, a dictionary of Datasets. Needs xarray and netCDF4."""
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
        """Writes summary.json, posterior.nc, report.html and summary.txt, as the program does: all or none."""
        _core.keep(os.fspath(folder), self._summary_json, self.text, self.run_id, self.posterior_nc)

    def report(self, path: Optional[Path] = None) -> str:
        """report.html as text, written to `path` where one is given."""
        page = _core.report_page(self._summary_json, self.posterior_nc)
        if path is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(page)
        return page

    def _repr_html_(self) -> str:
        return ('<iframe style="width: 100%; height: 40em; border: 0" srcdoc="'
                + html.escape(self.report()) + '"></iframe>')

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
    """How many damages, where, how bad.

    case      a file, or a dictionary of the same content
    seed      of the chains (1); the same seed gives the same draws, with any number of threads
    chains, warmup, draws
              as the program's options: chosen by the engine unless given
    progress  True: a line on standard error; a function of a Progress: called a few times a second, and the run
              stops early, with what it has, where it returns False; False: nothing
    changes   overrides the case: {"data.cov": 0.002}
    folder    where files lie that a dictionary names (the current folder)
    options   threads, search, quick, prior_only, evidence ("tmcmc+bridge"), max_memory_gb, max_hours, allow_commands,
              allow_hosts (a list of names)

    Ctrl-C ends the run within a moment, with KeyboardInterrupt and nothing kept. Raises CaseError for what is wrong
    with the case, in the program's words, and FileError for a file that cannot be read.
    """
    return _run(_core.damage, case, folder, changes, progress,
                {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, **options})


def update(case: Case, *, seed: Optional[int] = None, chains: Optional[int] = None, warmup: Optional[int] = None,
           draws: Optional[int] = None, progress: Watcher = True, changes: Optional[Mapping[str, Any]] = None,
           folder: Optional[Path] = None, **options: Any) -> Result:
    """A structure's parameters from its measured modes. Arguments as those of `damage`."""
    return _run(_core.update, case, folder, changes, progress,
                {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, **options})


def sid(case: Case, *, seed: Optional[int] = None, chains: Optional[int] = None, warmup: Optional[int] = None,
        draws: Optional[int] = None, progress: Watcher = True, changes: Optional[Mapping[str, Any]] = None,
        folder: Optional[Path] = None, **options: Any) -> Result:
    """Which equation of motion a record obeys. Arguments as those of `damage`."""
    return _run(_core.sid, case, folder, changes, progress,
                {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, **options})


def load(folder: Path) -> Result:
    """A finished run from the folder that the program, or `Result.save`, wrote. Needs netCDF4."""
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
