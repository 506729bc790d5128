#!/usr/bin/env python3
"""Runs an example of examples/python without a display, in a folder of its own, and looks at what it leaves.

usage: run_example.py EXAMPLE     (WHEELTAP_PACKAGE in the environment)
"""
import os
import runpy
import sys
import tempfile

LONGEST = {"case_a.py": 40, "accelerations_to_damage.py": 60}


def case_a(names):
    assert names["result"].converged, names["result"].warnings
    one = names["result"].probabilities["1 damage"]
    assert 0.6 < one < 0.9, f"P(1 damage) = {one}; the exact posterior of the shipped case A has 0.75"
    assert os.path.getsize("case_a.png") > 10000


def accelerations_to_damage(names):
    result = names["result"]
    assert result.converged, result.warnings
    assert result.probabilities["1 soft storey"] > 0.9, result.probabilities
    place = result.draws_of("link[1]", "1 soft storey")
    assert (place == 1).mean() > 0.9, "storey 2, the second in the case's order"
    loss = result.draws_of("reduction[1]", "1 soft storey")
    assert abs(loss.mean() - 0.15) < 4.5 * loss.std(), (loss.mean(), loss.std())
    for name in ("modes.png", "damage.png", "tower/summary.json", "tower/report.html"):
        assert os.path.getsize(name) > 2000, name


def main(example):
    name = os.path.basename(example)
    with open(example, encoding="utf-8") as f:
        lines = sum(1 for _ in f)
    assert lines <= LONGEST[name], f"{name} has {lines} lines, at most {LONGEST[name]}"
    sys.path.insert(0, os.environ["WHEELTAP_PACKAGE"])
    os.environ["MPLBACKEND"] = "Agg"
    try:
        import matplotlib  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing}")
        sys.exit(77)
    example = os.path.abspath(example)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        sys.argv = [example]
        names = runpy.run_path(example, run_name="__main__")
        globals()[name.removesuffix(".py")](names)
        os.chdir("/")


if __name__ == "__main__":
    main(sys.argv[1])
