#!/usr/bin/env python3
"""Do intervals between windows hold on the other half of a record? windows.py PROGRAM SET

Each half of the record is run by itself, split into windows. Of every parameter, the nominal 90 % interval of a
further window (between_windows, q5 to q95) from one half is held against what each window of the other half
says, both ways: 80 to 100 % should lie within. Beside it, what the run's own interval (mean ± 1.645 sd) holds.
"""
import os
import sys

from measured import Checks, read_case, run

# The case, its model, the scored samples of each half with what stands before them, and the windows of each: several
# periods of the slowest mode, but for the friction damper, which has seven periods in all.
SETS = {
    "silverbox": ("silverbox.json", "Duffing with quadratic stiffness", [(1000, 4000, 200), (4000, 7000, 200)], 6),
    "frame": ("frame_low.json", "linear", [(2000, 3500, 2000), (3500, 5000, 3500)], 4),
    "bistable": ("bistable_left.json", "cubic and quadratic", [(0, 1280, 0), (1280, 2560, 0)], 5),
    "friction": ("friction_damper.json", "Coulomb behind backlash", [(19, 3091, 0), (3091, 6163, 3072)], 3),
}


def binomial_bounds(held, of, level=0.95):
    """Clopper and Pearson's, by bisection."""
    def tail(p, first, last):
        term, total = (1 - p) ** of, 0.0
        for i in range(of + 1):
            if first <= i <= last:
                total += term
            term *= (of - i) / (i + 1) * p / (1 - p) if p < 1 else 0.0
        return total

    def solve(rises, target):
        low, high = 1e-12, 1 - 1e-12
        for _ in range(60):
            p = 0.5 * (low + high)
            low, high = (p, high) if (rises(p) < target) else (low, p)
        return 0.5 * (low + high)

    alpha = 0.5 * (1 - level)
    return (0.0 if held == 0 else solve(lambda p: tail(p, held, of), alpha),
            1.0 if held == of else solve(lambda p: -tail(p, 0, held), -alpha))


def half(program, case, model, samples, windows):
    first, last, lead_in = samples
    copy = dict(case, windows=windows, record=dict(case["record"], samples=[first, last], lead_in=lead_in))
    copy.pop("residuals", None)  # white: the interval between windows is to hold without
    copy["models"] = [m for m in case["models"] if m["name"] == model]
    used = str(copy["models"]) + str(copy["record"])
    copy["parameters"] = {name: p for name, p in case["parameters"].items() if f"'{name}'" in used}
    # Windows start from the best draw and climb: the chains need not be long.
    return run(program, copy, "--chains", "2", "--warmup", "1000", "--draws", "300")


def main():
    program, name = sys.argv[1], sys.argv[2]
    if not os.environ.get("WHEELTAP_LONG_TESTS"):
        print("minutes to half an hour: run with scripts/test --long or scripts/windows-study")
        sys.exit(77)
    check = Checks()
    file, model, halves, windows = SETS[name]
    case = read_case(file)
    found = [half(program, case, model, samples, windows)["parameters"][model] for samples in halves]
    held = run_held = of = 0
    for label in found[0]:
        if any("between_windows" not in f[label] for f in found):
            continue
        row = []
        for mine, other in ((found[0], found[1]), (found[1], found[0])):
            b, e = mine[label]["between_windows"], mine[label]
            values = [v for v in other[label]["between_windows"]["windows"]["value"] if v is not None]
            inside = sum(b["q5"] <= v <= b["q95"] for v in values)
            held, of = held + inside, of + len(values)
            run_held += sum(abs(v - e["mean"]) <= 1.645 * e["sd"] for v in values)
            row.append(f"{b['q5']:.4g} to {b['q95']:.4g} holds {inside} of {len(values)}"
                       f" (windows scatter by {b['scatter']['times_own_interval']:.1f})")
        print(f"     {label}: " + "; ".join(row))
    low, high = binomial_bounds(held, of)
    # Windows of one half share its parameters: the counts are not independent, and the bounds too narrow.
    check.that(held >= 0.8 * of, f"{name}: intervals between windows hold {held} of {of} values of the other half"
               f" ({100 * held / of:.0f} %; binomial 95 % {100 * low:.0f} to {100 * high:.0f} %), the run's own {run_held}")
    check.end()


main()
