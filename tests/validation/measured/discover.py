#!/usr/bin/env python3
"""Are the laws of measured rigs found when nobody names them? discover.py PROGRAM SET [CASE.json]

The base of each set is a case's linear model (of the friction damper the bare chain), and "discover" asks which of
several terms its links have. Ten minutes to an hour each: only with WHEELTAP_LONG_TESTS.
"""
import copy
import json
import os
import sys

from measured import Checks, SKIPPED, read_case, run, winner


def silverbox():
    case = read_case("silverbox.json")
    case["record"].update(samples=[1000, 1500])
    case["models"] = [m for m in case["models"] if m["name"] == "linear"]
    case["discover"] = {"links": [[0, 1]], "terms": ["cubic", "quadratic", "bilinear", "quadratic_damping"]}
    return case, ["m", "c", "k", "offset", "sigma"]


def bistable():
    case = read_case("bistable_both.json")
    case["models"] = [m for m in case["models"] if m["name"] == "linear"]
    case["discover"] = {"links": [[1, 2]], "terms": ["cubic", "quadratic", "quintic", "quadratic_damping"]}
    return case, ["k", "c", "e0", "vb", "v0", "offset", "sigma"]


def friction():
    """Friction and a stop on either side, each in the link where the damper would have it."""
    case = read_case("friction_damper.json")
    base = copy.deepcopy(next(m for m in case["models"] if m["name"] == "Coulomb behind backlash"))
    base["name"] = "dashpot"
    for link in base["links"]:
        link.pop("contact", None)
        link.pop("coulomb", None)
    case["models"] = [base]
    case["discover"] = {"links": [[0, 2], [2, 1]], "terms": ["coulomb", "contact", {"contact": {"side": "closing"}}]}
    return case, ["sigma"]


def silverbox_checks(check, s, p):
    check.that(p["cubic"] > 0.9 and p["quadratic"] > 0.9, f"P(cubic) = {p['cubic']:.4f}, P(quadratic) = {p['quadratic']:.4f}")
    check.that(p["bilinear"] < 0.1, f"P(bilinear) = {p['bilinear']:.4f}; P(quadratic_damping) = {p['quadratic_damping']:.4f}")
    found = s["parameters"][winner(s)]
    ratio = found["cubic"]["mean"] / found["k"]["mean"]
    check.that(abs(ratio / 3.94 - 1) < 0.01, f"k3/k = {ratio:.3f} (least squares on five windows: 3.94)")


def bistable_checks(check, s, p):
    print("     " + ", ".join(f"P({name}) = {v:.4f}" for name, v in p.items()))
    found = s["parameters"][winner(s)]
    check.that(found["k"]["q97.5"] < 0, f"{winner(s)}: k from {found['k']['q2.5']:.0f} to {found['k']['q97.5']:.0f} (N/m)/kg:"
               " between two wells")
    check.that(max(p["cubic"], p["quintic"]) > 0.9, "and a term that hardens brings it back")


def friction_checks(check, s, p):
    print("     " + ", ".join(f"P({name}) = {v:.4f}" for name, v in p.items()))
    check.that(p["coulomb 2-1"] > 0.9, f"friction: P = {p['coulomb 2-1']:.4f}")
    check.that(min(p["contact 0-2"], p["contact closing 0-2"]) > 0.9, "behind a backlash that has two sides")
    mean = {name: one["mean"] for name, one in s["parameters"][winner(s)].items()}
    plateau, before = mean["coulomb force 2-1"], mean["coulomb force 0-2"]
    check.that(abs(plateau / 9960 - 1) < 0.1, f"plateau {plateau / 1000:.2f} kN (the record's own median: 9.96 kN)")
    # Both gaps, and what either side is pressed in by where a fifth of the plateau acts: on the way out the friction
    # before the backlash takes from the force, on the way in it adds to it.
    travel = (mean["contact gap 0-2"] + mean["contact gap closing 0-2"]
              + (plateau / 5 + before) / mean["contact stiffness 0-2"]
              + (plateau / 5 - before) / mean["contact stiffness closing 0-2"])
    check.that(abs(travel / 4.3e-3 - 1) < 0.2, f"travel after a reversal {travel * 1e3:.2f} mm (the record's: 4.3 mm)")


SETS = {"silverbox": (silverbox, silverbox_checks), "bistable": (bistable, bistable_checks),
        "friction": (friction, friction_checks)}


def main():
    program, name = sys.argv[1], sys.argv[2]
    if len(sys.argv) == 3 and not os.environ.get("WHEELTAP_LONG_TESTS"):
        print("ten minutes to an hour: run with scripts/test --long")
        sys.exit(SKIPPED)
    make, judge = SETS[name]
    case, parameters = make()
    case["parameters"] = {p: prior for p, prior in case["parameters"].items() if p in parameters}
    if len(sys.argv) > 3:
        with open(sys.argv[3], "w") as f:
            json.dump(case, f, indent=1)
        return
    s = run(program, case)
    check = Checks()
    check.that(s["diagnostics"]["converged"], f"R-hat {s['diagnostics']['rhat_max']:.3f}: {s['answer']['headline']}")
    judge(check, s, {t["label"]: t["probability"] for t in s["terms"]})
    check.end()


main()
