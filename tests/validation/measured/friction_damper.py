#!/usr/bin/env python3
"""A friction damper with backlash under prescribed displacement: friction_damper.py PROGRAM

Friction behind a backlash, with default settings: converged within two minutes of two cores; it wins against friction
alone; its force is the record's own median plateau within 10 %; and the travel after a reversal at less than a fifth of
the plateau, through the backlash and what its stiffness gives, is 4.3 mm within 20 %.
"""
import csv
import resource
import statistics
import sys

from measured import Checks, nrmse, probabilities, read_case, run

POUNDS = 4448.2216  # N in a kip


def plateau(case):
    """The median of |force| in the window where it is more than half of what it is most of the time at its height."""
    with open(case["record"]["file"]) as f:
        force = [abs(float(row["friction_force_kip"])) * POUNDS for row in csv.DictReader(f)]
    first, last = case["record"]["samples"]
    force = force[first:last]
    high = statistics.quantiles(force, n=4)[2]
    return statistics.median(x for x in force if x > 0.5 * high)


program = sys.argv[1]
check = Checks()
case = read_case("friction_damper.json")
s = run(program, case)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
model = "Coulomb behind backlash"
p = s["parameters"].get(model, {})
check.that(s["diagnostics"]["converged"], f"converged, R-hat {s['diagnostics']['rhat_max']:.3f}")
seconds = used.ru_utime + used.ru_stime
check.that(seconds < 240.0, f"{seconds:.0f} s of processor time")
check.that(probabilities(s)["Coulomb"] < 1e-3, f"P(Coulomb alone) = {probabilities(s)['Coulomb']:.4f}")
measured = plateau(case)
force, stiffness = p["F"]["mean"], p["k"]["mean"]
check.that(abs(force / measured - 1) < 0.1, f"friction {force / 1e3:.2f} kN, plateau {measured / 1e3:.2f} kN")
travel = p["g_open"]["mean"] + p["g_close"]["mean"] + 0.4 * force / stiffness
check.that(abs(travel / 4.3e-3 - 1) < 0.2, f"travel after a reversal {1e3 * travel:.2f} mm, measured 4.3 mm")
check.that(nrmse(s, model)[0] < 0.2, f"NRMSE {100 * nrmse(s, model)[0]:.1f} %")
check.end()
