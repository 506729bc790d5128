"""Chains of masses whose links have Python functions as force laws."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterator, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from ._engine import Model

Array = np.ndarray
#: A known number, or the name of a parameter.
Coefficient = Union[float, str]


@dataclass(frozen=True)
class Link:
    """A link from mass a to mass b (0: the ground, or the moving base); `between` is (a, b).

    tension(e, rate, p) returns n tensions [N], which pull a towards b. The arguments are arrays of n values: extensions
    e = y_b - y_a [m], extension rates [m/s], and the parameters p["name"], one value per parameter vector of a batch.
    """

    between: Tuple[int, int]
    tension: Callable[[Array, Array, Mapping[str, Array]], Any]


@dataclass(frozen=True)
class Response:
    """The record of a sensor on a mass. The standard deviation of its normal noise is a number or a parameter.

    quantity    "displacement", "velocity" (both relative to a moving base) or "acceleration" (absolute)
    """

    mass: int
    values: Any
    noise: Coefficient
    quantity: str = "displacement"


class _Named(Mapping[str, Array]):
    """Columns of x by parameter name. The set `asked` holds the names that were accessed."""

    def __init__(self, names: Sequence[str], x: Array):
        self._columns = {name: x[:, i] for i, name in enumerate(names)}
        self.asked: set = set()

    def __getitem__(self, name: str) -> Array:
        if name not in self._columns:
            raise _core.CaseError(f"rig: \"{name}\" is not a parameter of the model; there are: "
                                  f"{', '.join(self._columns) or 'none'}")
        self.asked.add(name)
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def of(self, coefficient: Coefficient) -> Union[float, Array]:
        return self[coefficient] if isinstance(coefficient, str) else float(coefficient)


def _series(values: Any, what: str, samples: Optional[int]) -> Array:
    out = np.ascontiguousarray(values, dtype=float)
    if out.ndim != 1 or not np.isfinite(out).all():
        raise _core.CaseError(f"rig: {what}: must be finite numbers, one per sample")
    if samples is not None and len(out) != samples:
        raise _core.CaseError(f"rig: {what}: has {len(out)} samples: must have {samples}, as the first response")
    return out


@dataclass
class Rig:
    """A chain of masses 1, 2, …, connected by links, with measured excitations and responses.

        m_i z̈_i = f_i(t) - m_i ÿ_b(t) + Σ tensions of links that begin at i - Σ tensions of links that end at i

    z is the motion relative to the base (without base excitation, the absolute motion), starting at rest. Forces and
    ÿ_b are linear between samples. The classical Runge-Kutta method takes `steps` time steps per sample, for all
    parameter vectors of a batch together. The number of time steps is fixed; `step_error` returns the time-step error.

    masses             [kg]: numbers or names of parameters
    links              Link(between, tension)
    responses          Response(mass, values, noise)
    sample_rate        [Hz]
    forces             {mass: samples} [N]
    base_acceleration  ÿ_b [m/s²]
    """

    masses: Sequence[Coefficient]
    links: Sequence[Link]
    responses: Sequence[Response]
    sample_rate: float
    forces: Mapping[int, Any] = field(default_factory=dict)
    base_acceleration: Optional[Any] = None
    steps: int = 4

    def __post_init__(self) -> None:
        n = len(self.masses)
        if not n or not self.links or not self.responses:
            raise _core.CaseError("rig: needs at least one mass, one link and one response")
        if not self.sample_rate > 0:
            raise _core.CaseError(f"rig: sample_rate = {self.sample_rate}, must be above 0")
        if self.steps < 1:
            raise _core.CaseError(f"rig: steps = {self.steps}, must be 1 or more")
        for mass in [*self.forces, *(r.mass for r in self.responses)]:
            if not 1 <= mass <= n:
                raise _core.CaseError(f"rig: mass {mass}: must be from 1 to {n}")
        for link in self.links:
            if len(set(link.between)) != 2 or not all(0 <= mass <= n for mass in link.between):
                raise _core.CaseError(f"rig: link between {link.between}: must be two of 0 to {n}")
        samples: Optional[int] = None
        self._measured = []
        for response in self.responses:
            if response.quantity not in ("displacement", "velocity", "acceleration"):
                raise _core.CaseError(f"rig: quantity \"{response.quantity}\": must be \"displacement\", \"velocity\" "
                                      "or \"acceleration\"")
            self._measured.append(_series(response.values, f"response of mass {response.mass}", samples))
            samples = len(self._measured[0])
        self._push = np.zeros((samples, n))
        for mass, values in self.forces.items():
            self._push[:, mass - 1] = _series(values, f"force on mass {mass}", samples)
        self._base = (np.zeros(samples) if self.base_acceleration is None else
                      _series(self.base_acceleration, "base_acceleration", samples))

    def _simulate(self, p: _Named, n: int, steps: int) -> Dict[str, Array]:
        """Computes {quantity: (samples, masses, n)} by _core.integrate."""
        mass = np.array([np.broadcast_to(p.of(m), n) for m in self.masses], dtype=float)
        laws = [lambda e, rate, tension=link.tension: tension(e, rate, p) for link in self.links]
        with np.errstate(all="ignore"):  # a diverging motion has zero likelihood and is not an error
            found = _core.integrate(mass, [tuple(link.between) for link in self.links], laws, self._push, self._base,
                                    1.0 / (self.sample_rate * steps), steps)
        return dict(zip(("displacement", "velocity", "acceleration"), found))

    def simulate(self, parameters: Optional[Mapping[str, float]] = None, *, steps: Optional[int] = None) -> Dict[
            str, Array]:
        """Returns the computed "displacement", "velocity" and "acceleration", each a (samples, masses) array."""
        names = list(parameters or {})
        p = _Named(names, np.array([[float((parameters or {})[name]) for name in names]]))
        return {name: values[:, :, 0] for name, values in self._simulate(p, 1, steps or self.steps).items()}

    def step_error(self, parameters: Mapping[str, float]) -> float:
        """Returns the largest RMS change of a response, relative to its RMS, for time steps half as long."""
        one, two = self.simulate(parameters), self.simulate(parameters, steps=2 * self.steps)
        worst = 0.0
        for response in self.responses:
            a, b = (s[response.quantity][:, response.mass - 1] for s in (one, two))
            worst = max(worst, float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b ** 2))))
        return worst

    def model(self, name: str, parameters: Mapping[str, Any], prior: float = 1.0) -> Model:
        """Returns this chain as a model for wt.sample; `parameters` are priors by name, as in wt.Model.

        Raises CaseError for a parameter that no mass, force law or noise uses, and for a missing parameter.
        """
        names = list(parameters)

        def log_likelihood(x: Array) -> Array:
            return self._log_likelihood(_Named(names, x), len(x))

        tried = _Named(names, np.ones((1, len(names))))
        self._log_likelihood(tried, 1)
        unused = [n for n in names if n not in tried.asked]
        if unused:
            raise _core.CaseError(f"rig: \"{unused[0]}\" of model \"{name}\": no mass, law or noise uses it")
        return Model(name, parameters, log_likelihood, prior)

    def _log_likelihood(self, p: _Named, n: int) -> Array:
        """Σ over responses and samples of ln N(y; z(θ), σ²); -inf if the motion grows without bound."""
        found = self._simulate(p, n, self.steps)
        total = np.zeros(n)
        for response, measured in zip(self.responses, self._measured):
            sigma = p.of(response.noise)
            with np.errstate(all="ignore"):
                r = (measured[:, None] - found[response.quantity][:, response.mass - 1]) / sigma
                total = total - 0.5 * (r * r).sum(axis=0) - len(measured) * np.log(sigma * np.sqrt(2 * np.pi))
        return np.where(np.isfinite(total), total, -np.inf)
