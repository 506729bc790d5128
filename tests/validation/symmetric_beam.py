#!/usr/bin/env python3
"""On a symmetric beam every chain must weigh x and L - x alike: symmetric_beam.py PROGRAM CASE

In each chain the expected numbers of damages left and right of the middle must differ by no more than 4.5
Monte Carlo standard errors, those being below 0.02; and the run must say in words why.
"""
import sys

from runs import Checks, summary

check = Checks()
s = summary(sys.argv[1], sys.argv[2])
symmetry = s["diagnostics"]["symmetry"]
for i, chain in enumerate(symmetry["per_chain"]):
    difference = chain["left"] - chain["right"]
    check.that(chain["mcse_of_difference"] < 0.02 and
               abs(difference) <= 4.5 * chain["mcse_of_difference"],
               f"chain {i}: left {chain['left']:.4f}, right {chain['right']:.4f}, "
               f"difference {difference:+.4f} ± {chain['mcse_of_difference']:.4f}")
check.that(any("cannot distinguish a location x from its mirror image" in w for w in s["diagnostics"]["warnings"]),
           "the summary says that the two places cannot be told apart")
check.end()
