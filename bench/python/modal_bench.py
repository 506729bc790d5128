#!/usr/bin/env python3
"""Modes and their standard deviations beside pyOMA2's, on the same records: time and coverage.

    PYTHONPATH=build/release/python python3 bench/python/modal_bench.py [--records N] [--order N] [--skip-time]

pyOMA2 (pip install pyoma_2, or its src on PYTHONPATH) is not installed by this project; without it only our columns are printed.
Its settings are its own defaults (20 block rows, 50 segments), orders to 20, covariance-driven and data-driven; a mode is read
at the stated order (--order), its pole nearest to the truth, as one who reads a stabilisation chart well would. Ours has no
settings. The records are a chain of three masses (1 kg, 200 N/m, damping 1.5 %), 900 s at 20 Hz, independent white forces, noise
of 5 %; and, for the time, eight such masses, 61 440 samples, orders to 80 (pyOMA2 at every second one).
"""
import argparse
import contextlib
import io
import logging
import math
import os
import sys
import time

import numpy as np
from scipy.linalg import eigh, expm

import wheeltap as wt

try:
    with contextlib.redirect_stderr(io.StringIO()):
        from pyoma2.functions import ssi
    logging.disable(logging.WARNING)
except ImportError:
    ssi = None


class Chain:
    """M ẍ + C ẋ + K x = f, f held over each sample; modal damping."""

    def __init__(self, masses, stiffness, step, zeta=0.015):
        self.n, self.step, self.zeta = masses, step, zeta
        k = 2 * np.eye(masses) - np.eye(masses, k=1) - np.eye(masses, k=-1)
        k[-1, -1] = 1
        squares, shapes = eigh(stiffness * k)
        omega = np.sqrt(squares)
        self.hz = omega / (2 * math.pi)
        block = np.zeros((3 * masses, 3 * masses))
        block[:masses, masses:2 * masses] = np.eye(masses)
        block[masses:2 * masses] = np.hstack(
            [-stiffness * k, -shapes @ np.diag(2 * zeta * omega) @ shapes.T, np.eye(masses)])
        self.rows, self.discrete = block[masses:2 * masses], expm(block * step)[:2 * masses]

    def accelerations(self, samples, noise, seed):
        dice = np.random.default_rng(seed)
        lead = int(12 / (self.zeta * 2 * math.pi * self.hz[0] * self.step))
        force = dice.standard_normal((lead + samples, self.n))
        state, y = np.zeros(3 * self.n), np.empty((samples, self.n))
        for i, f in enumerate(force):
            state[2 * self.n:] = f
            if i >= lead:
                y[i - lead] = self.rows @ state
            state[:2 * self.n] = self.discrete @ state
        return y + noise * y.std(axis=0) * dice.standard_normal(y.shape)


def ours(y, rate, band, order=None):
    found = wt.modal(channels={f"a{i}": y[:, i] for i in range(y.shape[1])}, sample_rate=rate, band=band, threads=2,
                     changes={"order.max": order} if order else None)
    n = len(found)
    return found.frequencies_hz, found.damping, found.frequencies_sd, np.sqrt(np.diag(found.covariance)[n:])


def theirs(y, rate, method, ordmax, blocks=20, step=1):
    """Frequencies, damping ratios and standard deviations, poles × orders."""
    with contextlib.redirect_stderr(io.StringIO()):  # progress bars
        hankel, spread = ssi.build_hank(y.T, y.T, blocks, method, calc_unc=True, nb=50)
        o, a, c, _ = ssi.SSI_fast(hankel, blocks, ordmax, step)
        f, xi, _, _, f_sd, xi_sd, _ = ssi.SSI_poles(o, a, c, ordmax, 1 / rate, step, xi_max=0.2, calc_unc=True, H=hankel,
                                                    T=spread)
    return f, xi, f_sd, xi_sd


def nearest(hz, f, *others):
    """Of each true frequency the pole nearest to it, NaN where none is within 5 %."""
    rows = []
    for truth in hz:
        off = np.where(np.isfinite(f), np.abs(f - truth), np.inf)
        best = int(np.argmin(off))
        rows.append([v[best] if off[best] < 0.05 * truth else math.nan for v in (f, *others)])
    return np.array(rows)


def coverage(records, order):
    chain = Chain(3, 200.0, 0.05)
    rate, found = 20.0, {}
    for r in range(records):
        y = chain.accelerations(18000, 0.05, r)
        found.setdefault("Wheeltap", []).append(nearest(chain.hz, *ours(y, rate, [0.3, 10.0])))
        for method in ("cov", "dat") if ssi else ():
            f, xi, f_sd, xi_sd = (t[:, order] for t in theirs(y, rate, method, 20))
            found.setdefault(f"pyOMA2 {method}", []).append(nearest(chain.hz, f, xi, f_sd, xi_sd))
    print(f"{records} records; of each 95 % interval the share that holds; median and root mean square of the"
          " predicted over the empirical standard deviation")
    names = [f"{q}{m}" for m in (1, 2, 3) for q in ("f", "ζ")]
    print(f"{'':12}" + "".join(f"{n:>19}" for n in names) + f"{'all held':>10}{'found':>8}")
    for tool, rows in found.items():
        rows, line, held = np.array(rows), "", []
        for m in range(3):
            for q, truth in ((0, chain.hz[m]), (1, chain.zeta)):
                x, sd = rows[:, m, q], rows[:, m, q + 2]
                there = np.isfinite(x) & np.isfinite(sd)
                hold = np.abs(x[there] - truth) <= 1.96 * sd[there]
                held.extend(hold)
                line += f"{hold.mean():7.3f}{np.median(sd[there]) / x[there].std(ddof=1):6.2f}"
                line += f"{math.sqrt(np.mean(sd[there]**2)) / x[there].std(ddof=1):6.2f}"
        print(f"{tool:12}{line}{np.mean(held):10.3f}{len(held):8}")


def processor_time(work):
    began, clock = time.process_time(), time.perf_counter()
    work()
    return time.process_time() - began, time.perf_counter() - clock


def cost():
    chain = Chain(8, 400.0, 0.04)
    y = chain.accelerations(61440, 0.05, 1)
    print("\n8 channels of 61 440 samples with standard deviations, in seconds of processor and clock")
    for order in (20, 40, 80):
        mine = processor_time(lambda: ours(y, 25.0, [0.2, 12.5], order))
        line = f"orders to {order:2}: Wheeltap {mine[0]:8.2f} {mine[1]:8.2f}"
        if ssi:
            other = processor_time(lambda: theirs(y, 25.0, "cov", order, step=2))
            line += f"   pyOMA2 cov {other[0]:9.2f} {other[1]:9.2f}   ratio of clocks {other[1] / mine[1]:.0f}"
        print(line, flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=100)
    parser.add_argument("--order", type=int, default=10)
    parser.add_argument("--skip-time", action="store_true")
    options = parser.parse_args()
    coverage(options.records, options.order)
    if not options.skip_time:
        cost()
