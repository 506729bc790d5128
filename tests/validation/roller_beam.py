#!/usr/bin/env python3
"""The measured cantilever with a roller at six known places: roller_beam.py PROGRAM FOLDER

With room for one support it must be found (P > 0.99), at places that rise with the roller sensor's voltage
by 50 to 66 mm/V and lie within 10 mm of those inferred. With room for two, the run must say that two
frequencies cannot exclude a second one between the clamp and the roller.
"""
import csv
import os
import sys

from runs import Checks, probabilities, summary

program, folder = sys.argv[1:3]
with open(os.path.join(folder, "frequency_vs_roller_summary.csv")) as f:
    rows = list(csv.DictReader(f))
check = Checks()
short = ["--warmup", "6000", "--draws", "4000"]
volts, found = [], []
for row in rows:
    volt, inferred = float(row["roller_position_V"]), float(row["roller_mm_inferred"])
    name = os.path.join(folder, f"roller-{round(inferred):03d}mm")
    one = summary(program, name + ".json", *short)
    mean = 1e3 * one["parameters"]["1 support"]["location[1]"]["mean"]
    p = probabilities(one)["1 support"]
    check.that(p > 0.99 and abs(mean - inferred) < 10,
               f"{volt:.4f} V: P(1 support) = {p:.4f}, at {mean:.1f} mm, inferred {inferred:.1f} mm")
    volts.append(volt)
    found.append(mean)

    two = summary(program, name + "-two.json", *short)
    p = probabilities(two)["2 supports"]
    said = [w for w in two["diagnostics"]["warnings"]
            if "cannot exclude 2 supports" in w and "between the clamp at 0 m and the support" in w]
    check.that(p > 0.05 and len(said) == 1,
               f"{volt:.4f} V: with room for two, P(2 supports) = {p:.3f}, and it says what is hidden")
check.that(all(a < b for a, b in zip(found, found[1:])), "the places rise with the voltage")
n = len(volts)
mv, mf = sum(volts) / n, sum(found) / n
slope = sum((v - mv) * (f - mf) for v, f in zip(volts, found)) / sum((v - mv) ** 2 for v in volts)
check.that(50 < slope < 66, f"slope {slope:.1f} mm/V")
check.end()
