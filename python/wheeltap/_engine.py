"""User-defined likelihoods for the reversible-jump engine."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from ._cases import Prior, text_of
from ._progress import Watcher, watching
from ._runs import Result


@dataclass(frozen=True)
class Quantiles:
    """A prior, given by its quantile function."""

    ppf: Callable[[np.ndarray], Any]


def from_quantiles(function: Callable[[np.ndarray], Any]) -> Quantiles:
    """The prior of x = function(u), with u uniform on [0, 1]. `function` accepts arrays and must not decrease."""
    return Quantiles(function)


@dataclass(frozen=True)
class Model:
    """A competing model.

    parameters      priors by name. The same name in two models is the same parameter. A prior is a dictionary as in
                    a case (wt.uniform, …), a distribution of scipy.stats, or wt.from_quantiles(function). Any object
                    with a method `ppf` is allowed: its quantile function, for arrays of probabilities
    log_likelihood  function that returns ln p(data | parameters) with all normalising constants, and -inf for zero
                    likelihood. Its argument is an (n, d) array with one parameter vector per row, in the order of
                    `parameters`; it returns n numbers. With batch=False, it takes one vector and returns one number
    prior           prior weight relative to the other models
    """

    name: str
    parameters: Mapping[str, Union[Prior, "Quantiles"]]
    log_likelihood: Callable[[np.ndarray], Any]
    prior: float = 1.0
    batch: bool = True


def _in_place(quantiles: Mapping[int, Callable[..., Any]], log_likelihood: Callable[..., Any]) -> Callable[..., Any]:
    """Returns a likelihood that first converts columns of probabilities in x (a copy for this call) to quantiles."""
    if not quantiles:
        return log_likelihood

    def of_probabilities(x: np.ndarray) -> Any:
        for i, ppf in quantiles.items():
            x[..., i] = ppf(x[..., i])
        return log_likelihood(x)

    return of_probabilities


def sample(models: Union[Model, Sequence[Model]], *, title: str = "Which model?", seed: Optional[int] = None,
           chains: Optional[int] = None, warmup: Optional[int] = None, draws: Optional[int] = None, threads: int = 1,
           progress: Watcher = True, **options: Any) -> Result:
    """Samples competing models and their parameters, after a search and an evidence estimate for each model.

    The search and the evidence estimate call the likelihoods with many rows. Sampling calls them with one row per
    step, because the next state of a chain depends on the current state. All calls hold the GIL, so more `threads` help
    only if the likelihoods release the GIL. An exception in a likelihood ends the run; `sample` raises this exception.
    """
    models = [models] if isinstance(models, Model) else list(models)
    for model in models:
        if not isinstance(model, Model):
            raise TypeError(f"sample: models must be of the type wt.Model, and one is {type(model).__name__}")
    laws: Dict[str, Any] = {}
    functions, listed = [], []
    for model in models:
        places = {}
        for place, (name, prior) in enumerate(model.parameters.items()):
            if not hasattr(prior, "ppf"):
                continue
            if laws.setdefault(name, prior) is not prior:
                raise _core.CaseError(f"sample: {name}: has another prior in an earlier model: the same name is the "
                                      "same parameter")
            places[place] = prior.ppf
        functions.append(_in_place(places, model.log_likelihood))
        listed.append({"name": model.name, "prior": model.prior, "order": list(model.parameters), "parameters": {
            name: {"uniform": [0, 1]} if hasattr(prior, "ppf") else prior for name, prior in model.parameters.items()}})
    problem = {"kind": "sample", "title": title, "models": listed}
    with watching(progress) as watch:
        return Result(_core.sample(
            text_of(problem, "sample"), functions, [model.batch for model in models],
            {name: law.ppf for name, law in laws.items()},
            {"seed": seed, "chains": chains, "warmup": warmup, "draws": draws, "threads": threads, **options}, watch))
