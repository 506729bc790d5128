"""Standard figures of results with matplotlib, for example `wheeltap.plot.models(result)`.

Every function draws into `ax`, or into a new figure, and returns the axes.
"""
from __future__ import annotations

from typing import Any, List, Optional, Sequence

import matplotlib.pyplot as plt
import numpy as np

__all__ = ["frequencies", "inclusion", "models", "pairs", "record", "stabilisation", "traces", "where"]

BLUE, GREY, RED = "#2f6f9f", "#9a9a9a", "#b5482f"


def _axes(ax: Any, height: float = 3.0) -> Any:
    return ax if ax is not None else plt.subplots(figsize=(7.0, height), layout="constrained")[1]


def _plain(ax: Any) -> Any:
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _probable(result: Any) -> str:
    return max(result.probabilities, key=lambda name: result.probabilities[name])


def models(result: Any, ax: Any = None) -> Any:
    """Posterior probability of each model, with two Monte Carlo standard errors; lines show the priors."""
    found = result.models
    ax = _plain(_axes(ax, 0.8 + 0.4 * len(found)))
    rows = np.arange(len(found))
    errors = [2.0 * (m["mcse"] or 0.0) for m in found]
    ax.barh(rows, [m["probability"] for m in found], xerr=errors, color=BLUE, height=0.6, ecolor="black")
    ax.vlines([m["prior"] for m in found], rows - 0.4, rows + 0.4, color=GREY, linestyle=":", label="prior")
    ax.set_yticks(rows, [m["name"] for m in found])
    ax.invert_yaxis()
    ax.set_xlim(0.0, 1.0)
    ax.set_xlabel("probability")
    ax.legend(frameon=False, loc="lower right")
    return ax


def inclusion(result: Any, ax: Any = None) -> Any:
    """Posterior expected number of damages in each element along the beam."""
    damage = result.summary.get("damage", {}).get("inclusion_by_element")
    if damage is None or "beam" not in result.summary:
        raise ValueError("inclusion: needs a damage run of a beam")
    beam = result.summary["beam"]
    kinds = {"": damage} if "overall" in damage else damage
    ax = _plain(_axes(ax))
    edges = np.linspace(0.0, beam["length"], beam["elements"] + 1)
    for color, (name, of) in zip((BLUE, RED, GREY), kinds.items()):
        ax.stairs(of["overall"], edges, fill=True, color=color, alpha=0.8, label=name or None)
    for kind in result.summary.get("kinds", []):
        for one in kind.get("truth") or []:
            if "location" in one:
                ax.axvline(one["location"], color="black", linestyle="--", linewidth=0.8)
    ax.set_xlim(0.0, beam["length"])
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("location [m]")
    ax.set_ylabel("expected number in an element")
    if len(kinds) > 1:
        ax.legend(frameon=False)
    return ax


def where(result: Any, ax: Any = None) -> Any:
    """Locations of defects. For a beam, the figure is that of `inclusion`. Other structures: the 30 largest expected
    numbers of defects at named locations (member, joint, storey, spring, group). Dots: true locations, if known."""
    summary = result.summary
    if "beam" in summary:
        return inclusion(result, ax)
    found = summary.get("damage", {}).get("inclusion_by_element")
    if found is None or "structure" not in summary:
        raise ValueError("where: needs a damage run of a structure")
    kinds = summary["kinds"]
    by_kind = {kinds[0]["name"]: found} if "overall" in found else found
    bars = []
    for color, kind in zip((BLUE, RED, GREY), kinds):
        cells = by_kind[kind["name"]]["overall"]
        line = summary["structure"]["lines"][kind["name"]]
        starts = [stretch["first_cell"] for stretch in line["stretches"]] + [len(cells)]
        true = [one.get(line["of"], one.get("member")) for one in kind.get("truth") or []]
        bars += [(sum(cells[first:last]), stretch["name"], kind["name"], color, stretch["name"] in true)
                 for stretch, first, last in zip(line["stretches"], starts, starts[1:])]
    bars = sorted(bars, key=lambda bar: -bar[0])[:30]
    ax = _plain(_axes(ax, 0.8 + 0.3 * len(bars)))
    rows = np.arange(len(bars))
    ax.barh(rows, [bar[0] for bar in bars], color=[bar[3] for bar in bars], height=0.6)
    ax.plot([0.0] * sum(bar[4] for bar in bars), [row for row, bar in zip(rows, bars) if bar[4]], "o", color="black",
            markersize=4, clip_on=False)
    ax.set_yticks(rows, [bar[1] if len(kinds) == 1 else f"{bar[2]}: {bar[1]}" for bar in bars])
    ax.invert_yaxis()
    ax.set_xlim(left=0.0)
    ax.set_xlabel(f"expected number of {kinds[0]['plural'] if len(kinds) == 1 else 'defects'}")
    return ax


def pairs(result: Any, model: Optional[str] = None, parameters: Optional[Sequence[str]] = None) -> np.ndarray:
    """Scatter plots of the posterior of all pairs of parameters of a model (default: the most probable model)."""
    model = model or _probable(result)
    names: List[str] = list(parameters or result.summary["parameters"].get(model, {}))
    if not names:
        raise ValueError(f"pairs: {model!r} has no parameters")
    columns = {name: result.draws_of(name, model) for name in names}
    n = len(names)
    _, axes = plt.subplots(n, n, figsize=(1.5 + 1.8 * n, 1.5 + 1.8 * n), squeeze=False, layout="constrained")
    for i, below in enumerate(names):
        for j, left in enumerate(names):
            ax = axes[i, j]
            if j > i:
                ax.axis("off")
            elif i == j:
                ax.hist(columns[left], bins=40, color=BLUE, histtype="stepfilled")
                ax.set_yticks([])
            else:
                step = max(1, len(columns[left]) // 4000)
                ax.plot(columns[left][::step], columns[below][::step], ".", color=BLUE, markersize=2, alpha=0.3)
            if i == n - 1:
                ax.set_xlabel(left)
            else:
                ax.set_xticklabels([])
            if j == 0 and i > 0:
                ax.set_ylabel(below)
            elif j > 0:
                ax.set_yticklabels([])
    axes[0, 0].figure.suptitle(model)
    return axes


def traces(result: Any, names: Optional[Sequence[str]] = None) -> np.ndarray:
    """Trace plots of all chains: the model index, and each parameter."""
    names = list(names or result.draws)
    columns = []
    for name in names:
        array = result.draws[name]
        if array.ndim == 2:
            columns.append((name, array))
        else:
            columns += [(f"{name}[{s + 1}]", array[..., s]) for s in range(array.shape[2])]
    _, axes = plt.subplots(len(columns), 1, figsize=(7.0, 1.2 * len(columns) + 0.5), squeeze=False, sharex=True,
                           layout="constrained")
    for ax, (name, array) in zip(axes[:, 0], columns):
        step = max(1, array.shape[1] // 2000)
        for chain in array:
            _plain(ax).plot(np.arange(0, array.shape[1], step), chain[::step], linewidth=0.5)
        ax.set_ylabel(name)
    axes[-1, 0].set_xlabel("draw")
    return axes[:, 0]


def frequencies(result: Any, ax: Any = None) -> Any:
    """Measured minus predicted frequency of each mode, in standard deviations of the measurement. Bars are the 95 %
    intervals of the prediction."""
    found = result.summary.get("data", {}).get("modes")
    if not isinstance(found, list):
        raise ValueError("frequencies: this run has no measured frequencies")
    known = [m for m in found if m.get("observed") is not None and m.get("sd")]
    ax = _plain(_axes(ax))
    mode = [m["mode"] for m in known]
    sd = np.array([m["sd"] for m in known])
    observed, mean, low, high = (np.array([m[key] for m in known]) for key in ("observed", "mean", "q2.5", "q97.5"))
    ax.axhspan(-2.0, 2.0, color=GREY, alpha=0.2, linewidth=0)
    ax.axhline(0.0, color=GREY, linewidth=0.8)
    ax.errorbar(mode, (observed - mean) / sd, yerr=np.maximum([(high - mean) / sd, (mean - low) / sd], 0.0), fmt="o",
                color=BLUE, markersize=4)
    ax.set_xlabel("mode")
    ax.set_ylabel("(measured - predicted) / sd")
    return ax


def record(result: Any, response: Optional[str] = None, ax: Any = None) -> Any:
    """A measured response of a sid run and the 95 % posterior predictive band. Needs xarray and netCDF4."""
    groups = result.to_xarray()
    if "posterior_predictive" not in groups or "sample" not in groups["posterior_predictive"].dims:
        raise ValueError("record: this run has no record")
    predictive, observed = groups["posterior_predictive"], groups["observed_data"]
    names = [name for name in predictive.data_vars if "sample" in predictive[name].dims]
    name = response or names[0]
    if name not in names:
        raise ValueError(f"record: no response {name!r}; there are: {', '.join(names)}")
    ax = _plain(_axes(ax))
    low, high = np.quantile(predictive[name].values, [0.025, 0.975], axis=(0, 1))
    time = observed["time"].values
    ax.fill_between(time, low, high, color=BLUE, alpha=0.35, linewidth=0, label="95 % predicted")
    ax.plot(time, observed[name].values, color="black", linewidth=0.7, label="measured")
    ax.set_xlabel("time [s]")
    ax.set_ylabel(f"{name} [{observed[name].attrs.get('units', '')}]")
    ax.legend(frameon=False)
    return ax


def stabilisation(modal: Any, ax: Any = None) -> Any:
    """Stabilisation diagram: poles of all model orders with their standard deviations, and lines at the modes."""
    found = modal.summary["stabilisation"]
    at = {name: i for i, name in enumerate(found["columns"])}
    poles = np.array([[np.nan if x is None else x for x in pole] for pole in found["poles"]], dtype=float)
    ax = _plain(_axes(ax, 4.0))
    low, high = modal.summary["procedure"]["band"]
    known = poles[poles[:, at["frequency_sd"]] < 0.05 * poles[:, at["frequency_hz"]]]
    for f in modal.frequencies_hz:
        ax.axvline(f, color=RED, linewidth=0.8)
    ax.errorbar(known[:, at["frequency_hz"]], known[:, at["order"]], xerr=known[:, at["frequency_sd"]], fmt=".",
                color=BLUE, markersize=4, elinewidth=0.7)
    ax.set_xlim(low, high)
    ax.set_xlabel("frequency [Hz]")
    ax.set_ylabel("model order")
    return ax
