#!/usr/bin/env python3
"""Five damages at once, from frequencies and mode shapes: five_damages.py PROGRAM

A simply supported beam of a hundred elements that has lost half of the stiffness of five, which lie at least 0.15 m apart
by lot; ten frequencies at 0.05 %, their shapes at twenty sensors at 1 %; up to six damages are possible. At least five
must be found, unless one lies at a support, the run must have converged, and of the model with five each true element
must lie in the 95 % interval of a damage. A run takes minutes: a long test (WHEELTAP_LONG_TESTS=1), of three layouts.
"""
import json
import os
import random
import sys
import tempfile

from runs import Checks, probabilities, summary

if not os.environ.get("WHEELTAP_LONG_TESTS"):
    print("a long test: set WHEELTAP_LONG_TESTS=1")
    sys.exit(77)
check = Checks()
for layout in range(3):
    dice = random.Random(layout)
    places = [0.0, 0.0]  # not yet
    while min(b - a for a, b in zip(places, places[1:] + [9.0])) < 0.15:
        places = sorted(dice.randrange(1, 100) / 100 - 0.005 for _ in range(5))
    case = {
        "kind": "damage",
        "beam": {"length": 1.0, "elements": 100, "supports": "simply-supported",
                 "material": {"young": 70e9, "poisson": 0.3, "density": 2700},
                 "section": {"shape": "rectangle", "width": 0.025, "height": 0.006}},
        "data": {"modes": 10, "cov": 0.0005, "shape_sd": 0.01, "seed": layout + 1,
                 "sensors": [{"at": round((i + 0.7) / 20.5, 4)} for i in range(20)]},
        "damage": {"count": {"min": 0, "max": 6, "prior": "uniform"}, "location": {"uniform": [0, 1]},
                   "reduction": {"uniform": [0, 0.9]},
                   "truth": [{"location": p, "reduction": 0.5} for p in places]},
        "predictor": "fe"}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "case.json")
        with open(path, "w") as f:
            json.dump(case, f)
        s = summary(sys.argv[1], path, "--draws", "8000")
    words = ", ".join(f"{p:.3f}" for p in places)
    check.that(s["diagnostics"]["converged"], f"damages at {words}: the run has converged")
    p = probabilities(s)
    # The first and last elements of a beam on pins hardly bend: a loss there need not be seen.
    seen = 0.03 < places[0] and places[-1] < 0.97
    check.that(not seen or p["5 damages"] + p["6 damages"] > 0.999, f"P(5) = {p['5 damages']:.3f}, P(6) = {p['6 damages']:.3f}")
    found = s["parameters"]["5 damages"]
    for i, truth in enumerate(places, 1):
        low, high = (found[f"location[{i}]"][q] for q in ("q2.5", "q97.5"))
        check.that(low < truth + 0.005 and high > truth - 0.005,
                   f"the element about {truth:.3f} m: 95 % from {low:.4f} to {high:.4f} m, reduction "
                   f"{found[f'reduction[{i}]']['mean']:.2f}")
check.end()
