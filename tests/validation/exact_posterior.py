#!/usr/bin/env python3
"""The count's posterior on a beam where brute force gives it exactly: exact_posterior.py PROGRAM CASE EXACT

Model probabilities must lie within 4.5 Monte Carlo standard errors, and the largest error in the expected
number of damages per element below 0.01. One seed, or twenty with WHEELTAP_LONG_TESTS=1. Room
for five damages instead of two must leave the odds of the first three models alone.
"""
import json
import os
import sys

from runs import Checks, summary

program, case, exact_path = sys.argv[1:4]
with open(exact_path) as f:
    exact = json.load(f)
check = Checks()
for seed in range(1, 21 if os.environ.get("WHEELTAP_LONG_TESTS") else 2):
    s = summary(program, case, "--seed", str(seed))
    check.that(s["diagnostics"]["converged"], f"seed {seed}: converged")
    for m in s["models"]:
        want = exact["probabilities"][m["name"]]
        off = abs(m["probability"] - want)
        check.that(m["mcse"] < 0.004 and off <= 4.5 * m["mcse"] + 1e-10,  # exact to ten digits
                   f"seed {seed}: P({m['name']}) = {m['probability']:.4f} ± {m['mcse']:.4f}, exactly {want:.4f}")
    for count, want in exact["inclusion_by_element"].items():
        got = s["damage"]["inclusion_by_element"]["given_count"][count]
        worst = max(abs(a - b) for a, b in zip(got, want))
        check.that(worst < 0.01, f"seed {seed}: inclusion given {count}, largest difference {worst:.4f}")

s = summary(program, case, "--set", "damage.count.max=5")
few = [m for m in s["models"] if m["name"] in exact["probabilities"]]
total = sum(m["probability"] for m in few)
for m in few:
    want = exact["probabilities"][m["name"]]
    got = m["probability"] / total
    error = m["mcse"] / total
    check.that(abs(got - want) <= 4.5 * error + 1e-10, f"0 to 5 damages: P({m['name']} | 0 to 2) = {got:.4f} ± {error:.4f}, exactly {want:.4f}")
check.end()
