#!/usr/bin/env python3
"""The Silverbox against what its users have found in it (Wigren & Schoukens 2013): silverbox.py PROGRAM

f0 68.3 Hz and damping ratio 0.049 within 2 %, k3/k = 4.0 within 10 %, a linear model out of the question, and a
simulation error below 1 % on a part of the record that was not fitted.
"""
import math
import sys

from measured import Checks, elsewhere, means, nrmse, probabilities, read_case, run, short, winner

program = sys.argv[1]
case = read_case("silverbox.json")
check = Checks()
s = run(program, case, *short())
check.that(s["diagnostics"]["converged"], f"R-hat {s['diagnostics']['rhat_max']:.3f}: the run has converged")
check.that(probabilities(s)["linear"] < 1e-3, f"P(linear) = {probabilities(s)['linear']:.4f}")
best = winner(s)
p = means(s, best)
f0 = math.sqrt(p["k"] / p["m"]) / (2 * math.pi)
zeta = p["c"] / (2 * math.sqrt(p["k"] * p["m"]))
check.that(abs(f0 / 68.3 - 1) < 0.02, f"{best}: f0 = {f0:.2f} Hz")
check.that(abs(zeta / 0.049 - 1) < 0.02, f"damping ratio {zeta:.4f}")
check.that(abs(p["k3"] / p["k"] / 4.0 - 1) < 0.1, f"k3/k = {p['k3'] / p['k']:.3f}")
check.that(abs(p["offset"]) > 0.003, f"input offset {1e3 * p['offset']:.2f} mV")
other = elsewhere(case, best, p, {"samples": [20000, 24000], "lead_in": 400})
e, = nrmse(run(program, other, "--warmup", "600", "--draws", "500"), best)
check.that(e < 0.01, f"simulation error on samples 20000 to 24000: NRMSE {100 * e:.2f} %")

# White residuals: the same place, narrower intervals.
white = {key: v for key, v in case.items() if key != "residuals"}
w = run(program, white, *short())
ratio = s["parameters"][best]["k3"]["sd"] / w["parameters"][winner(w)]["k3"]["sd"]
check.that(winner(w) == best and ratio > 1.1,
           f"taking the residuals for white makes the sd of k3 smaller by {ratio:.2f}")
check.end()
