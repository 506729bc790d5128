#!/usr/bin/env python3
"""Repeated tests of two nominally equal bench frames: four_dof.py PROGRAM DATA

The first half of a laboratory's tests against the second half, and one laboratory against the other. Two cases:

- shipped: the shipped case, with uncertain masses and a model error of 0.3 %. Both halves have the same model error
  and masses, so this comparison is lenient.
- strict: known masses and no model error. The difference is then due to the scatter between tests alone.

Four stiffnesses from four frequencies have several solutions. Each solution is compared with the nearest solution of the
other half.
"""
import csv
import json
import math
import os
import sys
import tempfile

from measured import Checks, short
from runs import summary

program, data = sys.argv[1], os.path.join(sys.argv[2], "four-dof-two-labs")
check = Checks()
STIFFNESSES = ["k1", "k2", "k3", "k4"]
MASS = 0.1122
RARE = 0.01  # solutions with a smaller probability are not compared


def tests_of(laboratory):
    with open(os.path.join(data, f"laboratory_{laboratory}.csv")) as f:
        rows = list(csv.reader(f))[1:]
    return [[float(x) if x.strip() not in ("", "nan") else None for x in row] for row in rows]


def shipped_case(laboratory, tests):
    with open(os.path.join(data, f"update-{laboratory}.json")) as f:
        case = json.load(f)
    case["data"]["repeats"] = tests
    return case


def strict_case(laboratory, tests):
    case = shipped_case(laboratory, tests)
    case["structure"]["chain"]["masses"] = [MASS] * 4
    case["parameters"] = {k: case["parameters"][k] for k in STIFFNESSES}
    del case["data"]["discrepancy"]
    return case


def run(case):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "case.json")
        with open(path, "w") as f:
            json.dump(case, f)
        s = summary(program, path, *short(), command="update")
    d = s["diagnostics"]
    print(f"     {s['repeats']['tests']} tests, scatter "
          + ", ".join(f"{100 * x:.2f}" for x in s["repeats"]["scatter"])
          + f" %, outliers {s['repeats']['outliers']}, equivalent independent tests "
          + ", ".join(f"{x:.1f}" for x in s["repeats"]["independent_tests"])
          + f"; converged {d['converged']}, {s['cost']['wall_seconds']:.0f} s")
    return s


def solutions(s):
    """Mean and sd of each stiffness in each separate solution, with its probability."""
    found = s["solutions"] or [{"probability": 1.0, "parameters": next(iter(s["parameters"].values()))}]
    return [(x["probability"], {k: (x["parameters"][k]["mean"], x["parameters"][k]["sd"]) for k in STIFFNESSES})
            for x in found if x["probability"] > RARE]


def distance(a, b):
    return max(abs(math.log(a[k][0] / b[k][0])) for k in STIFFNESSES)


def in_sd(a, b, k):
    return (b[k][0] - a[k][0]) / math.hypot(a[k][1], b[k][1])


def compare(first, second):
    """Pairs of the nearest solutions."""
    return [(p, a, *min(((q, b) for q, b in second), key=lambda x: distance(a, x[1]))) for p, a in first]


def phi(z):
    return 0.5 * math.erfc(-z / math.sqrt(2.0))


def percent(p):
    return "> 99.99 %" if p > 0.9999 else "< 0.01 %" if p < 0.0001 else f"{100 * p:.1f} %"


for name, make in (("shipped", shipped_case), ("strict", strict_case)):
    whole = {}
    for laboratory in ("de", "br"):
        tests = tests_of(laboratory)
        half = len(tests) // 2
        print(f"{name}, laboratory {laboratory}")
        whole[laboratory] = solutions(run(make(laboratory, tests)))
        first, second = (solutions(run(make(laboratory, t))) for t in (tests[:half], tests[half:]))
        check.that(len(first) == len(second), f"{len(first)} and {len(second)} solutions in the two halves")
        for p, a, q, b in compare(first, second):
            print("     " + "; ".join(f"{k} {a[k][0]:.0f} +- {a[k][1]:.0f}, {b[k][0]:.0f} +- {b[k][1]:.0f}"
                                      for k in STIFFNESSES))
            z = [in_sd(a, b, k) for k in STIFFNESSES]
            check.that(max(map(abs, z)) < 3.0,
                       f"solution with P = {p:.3f} and {q:.3f}: the halves differ by "
                       + ", ".join(f"{x:.2f}" for x in z) + " sd of the difference")
    print(f"{name}: laboratory br against laboratory de")
    for p, a, q, b in compare(whole["de"], whole["br"]):
        print(f"     solution with P = {p:.3f} and {q:.3f}: " + "; ".join(
            f"{k} {a[k][0]:.0f} +- {a[k][1]:.0f}, {b[k][0]:.0f} +- {b[k][1]:.0f}, "
            f"{100 * (b[k][0] / a[k][0] - 1):+.1f} %, P(br > de) = {percent(phi(in_sd(a, b, k)))}" for k in STIFFNESSES))
check.end()
