"""Cases as files or dictionaries, and functions that return parts of a case, such as priors."""
from __future__ import annotations

import json
import os
from typing import Any, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core

Case = Union[str, "os.PathLike[str]", Mapping[str, Any]]
Prior = Mapping[str, Any]


def _plain(value: Any) -> Any:
    """Converts NumPy arrays and numbers for JSON."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a case cannot contain a {type(value).__name__}: use numbers, strings, lists and dictionaries")


def text_of(case: Mapping[str, Any], name: str = "case") -> str:
    """Converts a dictionary to JSON text."""
    try:
        return json.dumps(case, default=_plain, allow_nan=False)
    except ValueError as error:
        raise _core.CaseError(f"{name}: /: {error}: a case must not contain NaN or infinities") from None


def located(case: Case, folder: Optional[Union[str, "os.PathLike[str]"]]) -> Tuple[str, Optional[str]]:
    """Returns a case as (path, text). For a file, text is None; for a dictionary, the path is "case" in `folder`."""
    if isinstance(case, Mapping):
        path = "case" if folder is None else os.path.join(os.fspath(folder), "case")
        return path, text_of(case, path)
    return os.fspath(case), None


def overriding(changes: Optional[Mapping[str, Any]]) -> Sequence[str]:
    """Converts {"data.cov": 0.01} to arguments of the command line's --set."""
    return [f"{key}={json.dumps(value, default=_plain)}" for key, value in (changes or {}).items()]


def beam(length: float, *, section: Mapping[str, Any], young: float, density: float, poisson: float = 0.3,
         elements: int = 100, supports: Any = "simply-supported") -> dict:
    """A straight Timoshenko beam: length [m], Young's modulus [Pa], density [kg/m³], `supports` as in a case file."""
    return {"length": length, "elements": elements, "supports": supports,
            "material": {"young": young, "poisson": poisson, "density": density}, "section": dict(section)}


def rectangle(width: float, height: float) -> dict:
    """A rectangular section [m]; the bending axis is parallel to its width."""
    return {"shape": "rectangle", "width": width, "height": height}


def uniform(lower: float, upper: float) -> dict:
    """A uniform prior on [lower, upper]."""
    return {"uniform": [lower, upper]}


def log_uniform(lower: float, upper: float) -> dict:
    """A prior p(x) ∝ 1/x on [lower, upper], 0 < lower."""
    return {"log_uniform": [lower, upper]}


def normal(mean: float, sd: float) -> dict:
    """A normal prior N(mean, sd²)."""
    return {"normal": [mean, sd]}


def log_normal(mu: float, sigma: float) -> dict:
    """A log-normal prior, ln x ~ N(mu, sigma²)."""
    return {"log_normal": [mu, sigma]}


def half_normal(sd: float) -> dict:
    """A half-normal prior |N(0, sd²)|."""
    return {"half_normal": sd}


def gamma(shape: float, scale: float) -> dict:
    """A gamma prior with mean shape · scale."""
    return {"gamma": [shape, scale]}


def beta(a: float, b: float, on: Sequence[float] = (0.0, 1.0)) -> dict:
    """A beta prior, scaled to the interval `on`."""
    return {"beta": [a, b], "on": list(on)}


def truncated_normal(mean: float, sd: float, lower: float, upper: float) -> dict:
    """A normal prior N(mean, sd²) truncated to [lower, upper]."""
    return {"truncated_normal": [mean, sd, lower, upper]}


def inverse_gamma(shape: float, scale: float) -> dict:
    """An inverse-gamma prior: the mean of 1/x is shape / scale; for shape > 1, the mean of x is scale / (shape - 1)."""
    return {"inverse_gamma": [shape, scale]}


def student_t(nu: float, location: float, scale: float) -> dict:
    """A Student t prior with `nu` degrees of freedom and heavy tails; nu = 1 is the Cauchy distribution."""
    return {"student_t": [nu, location, scale]}


def table(x: Sequence[float], density: Sequence[float]) -> dict:
    """A prior with a piecewise linear density through the points (x, density), for example an expert's estimate or a
    histogram. The unit of `density` is arbitrary. `x` increases; `density` is positive, or 0 at the ends."""
    return {"table": {"x": [float(v) for v in x], "density": [float(v) for v in density]}}


def schema(kind: str = "damage") -> dict:
    """Returns the JSON Schema of a kind of case: "damage", "update", "sid", "modal", …"""
    return json.loads(_core.schema(kind))
