"""Likelihoods of one's own for the reversible-jump engine."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping, Optional, Sequence

import numpy as np

from . import _core
from ._cases import Prior, text_of
from ._progress import Watcher, watching
from ._runs import Result


@dataclass(frozen=True)
class Model:
    """A competing model.

    parameters      priors by name: the same name in two models is the same parameter
    log_likelihood  ln p(data | parameters), every normaliser included, -inf where they are impossible: a function
                    of an (n, d) array, a row a parameter vector in the order of `parameters`, that returns n
                    numbers; with batch=False of one vector, returning one
    prior           weight a priori, relative to the other models'
    """

    name: str
    parameters: Mapping[str, Prior]
    log_likelihood: Callable[[np.ndarray], Any]
    prior: float = 1.0
    batch: bool = True


def sample(models: Sequence[Model], *, title: str = "Which model?", seed: Optional[int] = None,
           chains: Optional[int] = None, warmup: Optional[int] = None, draws: Optional[int] = None, threads: int = 1,
           progress: Watcher = True, **options: Any) -> Result:
    """Which model, with what parameters: each model is searched, its evidence computed, and all are sampled.

    The functions are called with many rows while models are searched and weighed, and with one row a step while
    chains are drawn, since a chain's next state rests on this one. They are called under the GIL: more `threads`
    pay only for functions that release it. An exception in one ends the run and is raised here.
    """
    models = list(models)
    problem = {"kind": "sample", "title": title,
               "models": [{"name": model.name, "prior": model.prior, "parameters": dict(model.parameters),
                           "order": list(model.parameters)}
                          for model in models]}
    with watching(progress) as watch:
        return Result(_core.sample(
            text_of(problem, "sample"), [model.log_likelihood for model in models], [model.batch for model in models],
            {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, "threads": threads, **options}, watch))
