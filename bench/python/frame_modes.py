#!/usr/bin/env python3
"""The first 20 modes of a frame of 2016 members beside SciPy's shift-invert (ARPACK, SuperLU), on the same matrices.

    bench/python/frame_modes.py build/release/bench/fem/frame_modes [ELEMENTS_A_MEMBER ...]

Ours includes what SciPy does not do: it counts that no mode is missing, and takes out what rounding left in the low ones.
"""
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.io import mmread
from scipy.sparse.linalg import eigsh

program = sys.argv[1]
for elements in sys.argv[2:] or ["1", "4"]:
    with tempfile.TemporaryDirectory() as folder:
        first, *rest = subprocess.run([program, elements, folder], check=True, capture_output=True,
                                      text=True).stdout.splitlines()
        k, m = (mmread(f"{folder}/{name}.mtx").tocsc() for name in "km")
    least = np.inf
    for _ in range(5):
        start = time.perf_counter()
        squares, _ = eigsh(k, 20, m, sigma=0.0)
        least = min(least, time.perf_counter() - start)
    ours, theirs = np.array(rest, dtype=float), np.sqrt(np.sort(squares)) / (2 * np.pi)
    seconds = float(first.split(", ")[2].split()[0])
    print(f"{elements} elements a member: ours {first}; SciPy {least:.4f} s, {least / seconds:.2f} times ours; "
          f"frequencies differ by at most {np.max(np.abs(ours / theirs - 1)):.1e}")
