"""Wheeltap: damage identification, model updating and system identification, by Bayesian model selection.

    import wheeltap as wt
    result = wt.damage("case.json", seed=1)
    print(result.answer, result.probabilities, result.draws["location"])

Cases are files or dictionaries of the same content. The page docs/python.md has an example of every function.
"""
from ._compiled import require_compiled_module

require_compiled_module()

from ._cases import (beam, beta, gamma, half_normal, inverse_gamma, log_normal, log_uniform, normal, rectangle, schema,
                     student_t, table, truncated_normal, uniform)
from ._core import CaseError, Chain, FileError, Progress, __version__
from ._engine import Model, Quantiles, from_quantiles, sample
from ._modal import Modal, modal
from ._modes import Modes, modes
from ._plan import Plan, plan
from ._monitor import Monitored, monitor
from ._records import Record, data, read_record, simulate
from ._rig import Link, Response, Rig
from ._runs import Draws, Result, damage, load, sid, update

__all__ = [
    "CaseError", "Chain", "Draws", "FileError", "Link", "Modal", "Model", "Modes", "Monitored", "Plan", "Progress",
    "Quantiles", "Record", "Response", "Result", "Rig", "__version__", "beam", "beta", "damage", "data",
    "from_quantiles", "gamma", "half_normal", "inverse_gamma", "load", "log_normal", "log_uniform", "modal", "modes",
    "monitor", "normal", "plan", "plot", "read_record", "rectangle", "sample", "schema", "sid", "simulate", "student_t",
    "table", "truncated_normal", "uniform", "update",
]


def __getattr__(name: str):
    if name == "plot":  # the only part that needs matplotlib
        import importlib
        return importlib.import_module(".plot", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
