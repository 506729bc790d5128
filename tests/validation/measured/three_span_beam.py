#!/usr/bin/env python3
"""A simulated three-span beam of IC-SHM 2022, from raw accelerations to damage: three_span_beam.py PROGRAM DATA

The two commands of the tutorial, with the shipped cases. The committee did not publish the true damage; the reductions are
compared with those of the team that published the records. The shipped record 5 is run with short chains. With
WHEELTAP_LONG_TESTS=1, the six records of ../shared/data are run with default settings, if they are there.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

from measured import Checks, short
from runs import probabilities, summary

program, data = sys.argv[1:]
shared = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../../shared/data/ic-shm-2022-beam")
# Elements that may be damaged, as (member, first metre of the element in this member).
PLACES = {7: (0, 3.0), 22: (1, 4.5), 38: (2, 2.5)}
# Reductions of the elements 7, 22 and 38 that the team found.
TEAM = {1: (.003, .097, .005), 2: (0, .500, .004), 3: (.221, 0, .004), 4: (.414, 0, .019), 5: (.193, .201, .189),
        6: (.397, .401, .403)}
TOLERANCE = 0.04


def identified(record, options):
    """The summary of both commands for a record."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("modal.json", "damage.json"):
            shutil.copy(os.path.join(data, "three-span-beam", name), folder)
        subprocess.run([program, "modal", os.path.join(folder, "modal.json"), "-o", os.path.join(folder, "modal"), "--quiet",
                        "--set", "record.file=" + json.dumps(os.path.abspath(record))], check=True, stdout=subprocess.DEVNULL)
        return summary(program, os.path.join(folder, "damage.json"), *options)


def compare(number, s):
    """Count, locations and reductions against those of the team; reductions below TOLERANCE may be missing."""
    named = probabilities(s)
    best = max(named, key=named.get)
    inclusion = s["damage"]["inclusion_by_element"]["overall"]
    found = dict.fromkeys(PLACES, 0.0)
    for i in range(1, 1 + int(best.split()[0])):
        p = s["parameters"][best]
        for element, (member, start) in PLACES.items():
            if p[f"member[{i}]"]["q50"] == member and start <= p[f"location[{i}]"]["q50"] <= start + 0.5:
                found[element] = p[f"reduction[{i}]"]["q50"]
    team = dict(zip(PLACES, TEAM[number]))
    expected = sum(r >= TOLERANCE for r in team.values())
    words = ", ".join(f"{e}: {r:.3f} (team {team[e]:.3f})" for e, r in found.items())
    check.that(best.startswith(str(expected)), f"record {number}: {best}, P = {named[best]:.4f}; expected {expected}")
    check.that(all(abs(found[e] - team[e]) < TOLERANCE for e in PLACES), f"record {number}, reduction of elements {words}")
    # Two or three damages keep some probability in the records of one damage, with the others anywhere.
    inside = sum(inclusion[e - 1] for e in PLACES)
    check.that(inside > 0.6 * sum(inclusion), f"record {number}: expected number of damages in elements 7, 22 and 38: "
               f"{inside:.3f}, elsewhere {sum(inclusion) - inside:.3f}")
    print(f"     R-hat {s['diagnostics']['rhat_max']:.3f}, {'converged' if s['diagnostics']['converged'] else 'NOT CONVERGED'}, "
          f"predictive p = {s['fit']['p']:.2g}, {s['cost']['wall_seconds']:.0f} s")


check = Checks()
compare(5, identified(os.path.join(data, "three-span-beam", "record-5.npy"), short()))
if os.environ.get("WHEELTAP_LONG_TESTS"):
    for record in range(1, 7):
        path = os.path.join(shared, f"test_{record}.mat")
        if os.path.exists(path):
            compare(record, identified(path, []))
        else:
            print(f"     skipped: {path} is not there")
check.end()
