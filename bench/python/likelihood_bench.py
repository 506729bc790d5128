#!/usr/bin/env python3
"""What a likelihood in Python costs above its own work, and in what batches the engine asks.

    PYTHONPATH=build/release/python python3 bench/python/likelihood_bench.py

The first table times calls through the engine's interface (inference::Likelihood::log_likelihoods) less the function's
own time on the same rows, the median of turns taken one after the other. The second runs the engine on two models of
four and five parameters and counts the rows of each call.
"""
import statistics
import time

import numpy as np

import wheeltap as wt
from wheeltap import _core
from wheeltap._cases import text_of

D = 4
PROBLEM = text_of({"kind": "sample", "models": [
    {"name": "m", "parameters": {f"x{i}": wt.normal(0, 1) for i in range(D)}, "order": [f"x{i}" for i in range(D)]}]})


def gaussian(x):
    return -0.5 * np.einsum("ij,ij->i", x, x)


def single(x):
    return -0.5 * (x @ x)


def seconds(work, turns):
    begun = time.perf_counter()
    for _ in range(turns):
        work()
    return (time.perf_counter() - begun) / turns


def overhead(n, batch):
    x = np.random.default_rng(1).standard_normal((n, D))
    function = gaussian if batch else single
    rows = list(x)
    called = _core.Likelihood(PROBLEM, [function], [batch])
    through, own = [], []
    turns = max(3, 20000 // max(n, 100))
    for _ in range(25):
        through.append(seconds(lambda: called(0, x), turns))
        own.append(seconds((lambda: function(x)) if batch else (lambda: [function(r) for r in rows]), turns))
    return (statistics.median(through) - statistics.median(own)) / n, statistics.median(own) / n


def engine():
    calls = {}

    def counted(x):
        calls[len(x)] = calls.get(len(x), 0) + 1
        return gaussian(x[:, :D])

    four = {f"x{i}": wt.normal(0, 3) for i in range(D)}
    models = [wt.Model("four", four, counted), wt.Model("five", four | {"x4": wt.normal(0, 3)}, counted)]
    begun = time.perf_counter()
    result = wt.sample(models, seed=1, progress=False)
    spent = time.perf_counter() - begun
    rows = sum(n * count for n, count in calls.items())
    in_batches = sum(n * count for n, count in calls.items() if n >= 16)
    print(f"\nA run of two models ({'converged' if result.converged else 'NOT converged'}): {rows} rows in "
          f"{sum(calls.values())} calls, {spent:.1f} s, {1e6 * spent / rows:.2f} µs a row;")
    print(f"{100 * in_batches / rows:.0f} % of the rows came in batches of 16 or more (largest {max(calls)}), "
          f"{100 * calls.get(1, 0) / rows:.0f} % one at a time.")


if __name__ == "__main__":
    print("rows a call   overhead a row [µs]   the function's own [µs]")
    for n in (1, 10, 100, 1000, 10000):
        extra, own = overhead(n, True)
        print(f"{n:>11}   {1e6 * extra:>19.3f}   {1e6 * own:>23.3f}")
    extra, own = overhead(1000, False)
    print(f"batch=False   {1e6 * extra:>19.3f}   {1e6 * own:>23.3f}   (1000 rows)")
    engine()
