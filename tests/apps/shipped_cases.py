#!/usr/bin/env python3
"""Compares every shipped case, shortened and with a fixed seed, with a stored summary.

usage: shipped_cases.py check   PROGRAM CASE EXPECTED   one case; exits 1 if a number changed
       shipped_cases.py refresh PROGRAM DATA EXPECTED   all cases under DATA; stores and shows the changes

The same seed gives the same chain, so numbers are compared to floating-point tolerance (convergence
measures to 1 %: they use ranks, which the last bit of a draw can swap).
"""
import json
import math
import os
import subprocess
import sys
import tempfile

SHORT = ["--seed", "1", "--chains", "2", "--warmup", "6000", "--draws", "2000", "--quiet"]
RELATIVE, ABSOLUTE = 1e-6, 1e-9
ON_RANKS = ("ess_bulk", "ess_tail", "rhat", "mcse")


def expected_path(case, data, folder):
    name = os.path.relpath(case, data).replace(os.sep, "-")
    return os.path.join(folder, name)


def run(program, case):
    """The numbers of a shortened run whose change a user would notice."""
    with open(case) as f:
        kind = json.load(f)["kind"]
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, kind, case, "-o", out, *SHORT], check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(out, "summary.json")) as f:
            s = json.load(f)
    keep = {"models": s["models"], "parameters": s["parameters"],
            "likelihood_evaluations": s["cost"]["likelihood_evaluations"],
            "warnings": len(s["diagnostics"]["warnings"])}
    if "damage" in s:
        by_kind = s["damage"]["inclusion_by_element"]
        if "overall" in by_kind:
            by_kind = {"": by_kind}
        keep["inclusion"] = {kind: {str(e): x for e, x in enumerate(v["overall"]) if x > 0.01}
                             for kind, v in by_kind.items()}
    return keep


def differences(want, got, where=""):
    if isinstance(want, dict) and isinstance(got, dict):
        for key in sorted(set(want) | set(got)):
            if key not in want:
                yield f"{where}/{key}: new"
            elif key not in got:
                yield f"{where}/{key}: gone"
            else:
                yield from differences(want[key], got[key], f"{where}/{key}")
    elif isinstance(want, list) and isinstance(got, list) and len(want) == len(got):
        for i, (w, g) in enumerate(zip(want, got)):
            yield from differences(w, g, f"{where}/{i}")
    elif isinstance(want, float) or isinstance(got, float):
        ok = (want is not None and got is not None and
              math.isclose(want, got, abs_tol=ABSOLUTE,
                           rel_tol=0.01 if where.endswith(ON_RANKS) else RELATIVE))
        if not ok:
            yield f"{where}: {want} -> {got}"
    elif want != got:
        yield f"{where}: {want} -> {got}"


def show(name, lines):
    print(f"{name}: {len(lines)} numbers moved")
    for line in lines[:12]:
        print("  " + line)
    if len(lines) > 12:
        print(f"  … and {len(lines) - 12} more")


def main():
    what, program, cases, expected = sys.argv[1:5]
    if what == "check":
        with open(expected) as f:
            want = json.load(f)
        moved = list(differences(want, run(program, cases)))
        if moved:
            show(cases, moved)
            print("If this change is meant, store it with scripts/refresh-expected.")
            sys.exit(1)
        return
    os.makedirs(expected, exist_ok=True)
    stale = set(os.listdir(expected))
    for folder, _, files in sorted(os.walk(cases)):
        if os.path.basename(folder) == "sid":
            continue  # minutes each; tests/apps/sid_case_test.cpp parses and simulates them
        if os.path.basename(folder) in ("four-dof-two-labs", "sections", "structures", "three-span-beam", "uff"):
            continue  # no runs
        for file in sorted(files):
            if not file.endswith(".json"):
                continue
            case = os.path.join(folder, file)
            path = expected_path(case, cases, expected)
            stale.discard(os.path.basename(path))
            got = run(program, case)
            if os.path.exists(path):
                with open(path) as f:
                    moved = list(differences(json.load(f), got))
                if not moved:
                    continue
                show(file, moved)
            else:
                print(f"{file}: new")
            with open(path, "w") as f:
                json.dump(got, f, indent=1)
                f.write("\n")
    for name in stale:
        print(f"{name}: its case is gone, removed")
        os.remove(os.path.join(expected, name))


main()
