#!/usr/bin/env python3
"""BistableX, a magnetic double well on a shaker: bistable.py PROGRAM

Between the wells the linear stiffness about the middle is negative and the cubic one positive; in either well
the stiffness is positive, and the quadratic term has opposite signs: it softens the spring towards the middle.
"""
import math
import sys

from measured import Checks, means, nrmse, probabilities, read_case, run, winner

program = sys.argv[1]
check = Checks()


def fit(name):
    case = read_case(name)
    s = run(program, case)
    best = winner(s)
    e, = nrmse(s, best)
    print(f"     {case['title']}: {best}, NRMSE {100 * e:.1f} %, R-hat {s['diagnostics']['rhat_max']:.3f}")
    return s, best


s, best = fit("bistable_both.json")
p = s["parameters"][best]
check.that(probabilities(s)["linear"] < 1e-3, f"between the wells: P(linear) = {probabilities(s)['linear']:.4f}")
check.that(p["k"]["q97.5"] < 0 < p["k3"]["q2.5"],
           f"k = {p['k']['mean']:.0f} (N/m)/kg, negative; k3 = {p['k3']['mean']:.3g} (N/m^3)/kg, positive")
check.that(nrmse(s, best)[0] < 0.1, "it explains more than 99 % of the velocity's variance")
m = means(s, best)
k, k2, k3 = m["k"], m.get("k2", 0.0), m["k3"]
root = math.sqrt(k2 * k2 - 4 * k3 * k)
wells = [(-k2 - root) / (2 * k3), (-k2 + root) / (2 * k3)]
local = [k2 + 3 * k3 * e for e in wells]
check.that(local[0] < 0 < local[1],
           f"wells at {1e3 * wells[0]:.1f} and {1e3 * wells[1]:.1f} mm, quadratic terms {local[0]:.3g} and {local[1]:.3g} there")

signs = []
for name in ("bistable_left.json", "bistable_right.json"):
    s, best = fit(name)
    p = s["parameters"][best]
    check.that("k2" in p and probabilities(s)["linear"] < 1e-3, f"{best}; P(linear) = {probabilities(s)['linear']:.4f}")
    low, high = p["k2"]["q2.5"], p["k2"]["q97.5"]
    check.that(low * high > 0, f"k2 between {low:.3g} and {high:.3g} (N/m^2)/kg")
    signs.append(math.copysign(1, low))
check.that(signs[0] < 0 < signs[1], "the quadratic term changes its sign between the wells")
check.end()
