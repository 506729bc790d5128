#!/usr/bin/env python3
"""What an emulator does to the answer: emulators.py PROGRAM CASE EXACT DATA

Ten sites on the beam whose posterior is known exactly: trusted blindly the answer is wrong, and the run says so;
with "exact" it is the exact posterior, in its model probabilities, where the damages are, and in the quantiles of
one damage against an FE run. Tolerances are 4.5 Monte Carlo standard errors.

With WHEELTAP_LONG_TESTS=1 also: three damages among up to five, by the FE solution and by ANOVA, from the prior;
and 200 simulated cases of two damages whose 95 % intervals must cover.
"""
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import netCDF4

from runs import Checks, summary

program, case, exact_path, data = sys.argv[1:5]
with open(exact_path) as f:
    exact = json.load(f)
check = Checks()
SITES = {"sites": [1, 12, 23, 34, 45, 56, 67, 78, 89, 100], "multipliers": [0.4, 0.6, 0.8, 1.0]}


def run(case, *options):
    """The summary, and the draws of one damage's parameters."""
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, "damage", case, "-o", out, "--quiet", *options], check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(out, "summary.json")) as f:
            s = json.load(f)
        with netCDF4.Dataset(os.path.join(out, "posterior.nc")) as file:
            p = file["posterior"]
            one = p["k"][:] == 1
            return s, {name: sorted(map(float, p[name][:, :, 0][one])) for name in ("location", "reduction")}


def predictor(**more):
    return ["--set", "predictor=" + json.dumps({**SITES, **more})]


def share_below(draws, x):
    return sum(d <= x for d in draws) / len(draws)


blind = summary(program, case, *predictor(emulator_error=False))
p = {m["name"]: m for m in blind["models"]}
off = abs(p["1 damage"]["probability"] - exact["probabilities"]["1 damage"])
check.that(off > 10 * p["1 damage"]["mcse"], f"trusted blindly: P(1 damage) is off by {off:.3f}")
check.that(blind["emulator"]["check"]["moved"] and any("emulator error changed the results" in w for w in blind["diagnostics"]["warnings"]),
           "and the run reports that the emulator error changed the results")

fe, fe_draws = run(case)
s, draws = run(case, *predictor(exact=True))
check.that(s["diagnostics"]["converged"], "exact: converged")
for m in s["models"]:
    want = exact["probabilities"][m["name"]]
    check.that(abs(m["probability"] - want) <= 4.5 * m["mcse"] + 1e-10,  # exact to ten digits
               f"exact: P({m['name']}) = {m['probability']:.4f} ± {m['mcse']:.4f}, exactly {want:.4f}")
for count, want in exact["inclusion_by_element"].items():
    got = s["damage"]["inclusion_by_element"]["given_count"][count]
    worst = max(abs(a - b) for a, b in zip(got, want))
    check.that(worst < 0.015, f"exact: inclusion given {count}, largest difference {worst:.4f}")
for name, values in draws.items():
    ess = [x["parameters"]["1 damage"][name + "[1]"]["ess_bulk"] for x in (fe, s)]
    for q in (0.025, 0.5, 0.975):
        x = fe_draws[name][int(q * len(fe_draws[name]))]
        got = share_below(values, x)
        error = math.sqrt(q * (1 - q) * (1 / ess[0] + 1 / ess[1]))
        check.that(abs(got - q) <= 4.5 * error, f"exact: P({name} <= {x:.4f}) = {got:.4f} ± {error:.4f}, FE {q}")
calls = s["emulator"]["full_model_calls"]["likelihood"]
check.that(calls < s["cost"]["likelihood_evaluations"],
           f"exact: {calls} FE calls for {s['cost']['likelihood_evaluations']} of the emulator")

if os.environ.get("WHEELTAP_LONG_TESTS"):
    three = {kind: summary(program, os.path.join(data, f"beam/three-damages-{kind}.json")) for kind in ("fe", "anova")}
    for kind, s in three.items():
        check.that(s["diagnostics"]["converged"], f"three damages, {kind}: converged in {s['cost']['wall_seconds']:.0f} s")
    for a, b in zip(three["fe"]["models"], three["anova"]["models"]):
        error = math.hypot(a["mcse"], b["mcse"])
        check.that(abs(a["probability"] - b["probability"]) <= 4.5 * error,
                   f"three damages: P({a['name']}) = {a['probability']:.4f} by FE, {b['probability']:.4f} by ANOVA, ± {error:.4f}")
    a, b = (three[kind]["damage"]["inclusion_by_element"]["overall"] for kind in ("fe", "anova"))
    worst = max(abs(x - y) for x, y in zip(a, b))
    check.that(worst < 0.03, f"three damages: inclusion, largest difference {worst:.4f}")

    # A cantilever: no mirror images, so that intervals of the ordered damages are intervals of places.
    with open(case) as f:
        c = json.load(f)
    c["beam"]["supports"] = "cantilever"
    c["damage"]["count"] = {"min": 2, "max": 2}
    c["damage"]["location"] = {"uniform": [0.04, 0.95]}
    c["predictor"] = {"sites": list(range(5, 100, 10)), "multipliers": [0.4, 0.6, 0.8, 1.0]}
    misses = {}
    generator = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "case.json")
        for n in range(200):
            truth = sorted((generator.uniform(0.04, 0.95), generator.uniform(0.0, 0.6)) for _ in range(2))
            c["damage"]["truth"] = [{"location": x, "reduction": r} for x, r in truth]
            c["data"] = {"modes": 20, "cov": 0.001, "seed": n + 1}
            with open(path, "w") as f:
                json.dump(c, f)
            s = summary(program, path, "--warmup", "12000", "--draws", "5000", "--seed", str(n + 1))
            for i, pair in enumerate(truth, start=1):
                for name, value in zip(("location", "reduction"), pair):
                    q = s["parameters"]["2 damages"][f"{name}[{i}]"]
                    misses[f"{name}[{i}]"] = misses.get(f"{name}[{i}]", 0) + (not q["q2.5"] <= value <= q["q97.5"])
    for name, n in sorted(misses.items()):
        check.that(n <= 20, f"200 cases of two damages: the 95 % interval of {name} misses {n} times (20 or fewer)")
check.end()
