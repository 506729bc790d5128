#!/usr/bin/env python3
"""A friction damper with backlash under prescribed displacement: friction_damper.py PROGRAM

Friction behind a backlash wins against friction alone; its force is that of the measured plateau (2.3 kip) within
15 %, and the backlash is there.
"""
import sys

from measured import Checks, nrmse, probabilities, read_case, run

program = sys.argv[1]
check = Checks()
# Short: friction takes many sub-steps, and this is two minutes of one core already.
s = run(program, read_case("friction_damper.json"), "--warmup", "1000", "--draws", "300")
model = "Coulomb behind backlash"
p = s["parameters"].get(model, {})
check.that(probabilities(s)["Coulomb"] < 1e-3, f"P(Coulomb alone) = {probabilities(s)['Coulomb']:.4f}")
plateau = 2.3 * 4448.22
check.that(abs(p["F"]["mean"] / plateau - 1) < 0.15, f"friction {p['F']['mean'] / 1e3:.1f} kN, plateau {plateau / 1e3:.1f} kN")
check.that(p["g"]["q2.5"] > 0.5e-3, f"backlash 2 x {1e3 * p['g']['mean']:.2f} mm, engaged stiffness {p['k']['mean'] / 1e6:.1f} kN/mm")
check.that(nrmse(s, model)[0] < 0.2, f"NRMSE {100 * nrmse(s, model)[0]:.1f} %, R-hat {s['diagnostics']['rhat_max']:.2f}")
check.end()
