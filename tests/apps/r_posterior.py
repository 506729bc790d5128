#!/usr/bin/env python3
"""posterior.nc read by R: ESS and R-hat by r-cran-posterior, an independent implementation, equal those of summary.json
to three digits.

usage: r_posterior.py PROGRAM DATA     exit code 77 without R, ncdf4 or posterior
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

# posterior divides autocovariances at lag t by n, where the paper's equation (10) has n - 1: its τ is below ours by
# (τ - 1)/n, and its ESS above by less than 1/n of itself. n is half of a chain.
DRAWS = 2000
TOLERANCE = {"rhat": 5e-4, "ess_bulk": 2 / DRAWS, "ess_tail": 2 / DRAWS, "mean": 1e-9, "sd": 1e-9}
# The second case has hardly any warm-up, so that R-hat is not 1 and ESS is small.
RUNS = {
    "a structure's stiffnesses": ("update", "structures/storeys-update.json", [], ["--warmup", "1000"]),
    "one damage of a beam": ("damage", "beam/case-b-fe.json",
                             ["--set", 'damage.count={"min": 1, "max": 1, "prior": "uniform"}'],
                             ["--warmup", "100"]),
}


def by_r(path):
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "r_posterior.R")
    printed = subprocess.run(["Rscript", "--vanilla", script, path], capture_output=True, text=True, check=True).stdout
    rows = (line.split(";") for line in printed.splitlines())
    return {(row[0], int(row[1])): dict(zip(("rhat", "ess_bulk", "ess_tail", "mean", "sd"), map(float, row[2:])))
            for row in rows}


def main(program, data):
    for title, (command, case, changes, length) in RUNS.items():
        with tempfile.TemporaryDirectory() as out:
            subprocess.run([program, command, os.path.join(data, case), "-o", out, "--seed", "1", "--quiet", *changes, *length,
                            "--draws", str(DRAWS)], check=True, stdout=subprocess.DEVNULL)
            with open(os.path.join(out, "summary.json"), encoding="utf-8") as f:
                [told] = json.load(f)["parameters"].values()
            theirs = by_r(os.path.join(out, "posterior.nc"))
        compared = 0
        for name, ours in told.items():
            base, _, slot = name.partition("[")
            here = theirs[base, int(slot.rstrip("]") or 1)]
            for quantity, value in here.items():
                error = abs(value / ours[quantity] - 1)
                print(f"{title}: {name}: {quantity} {ours[quantity]:.6g}, R {value:.6g}")
                assert error < TOLERANCE[quantity], f"{title}: {quantity} of {name}: {ours[quantity]}, R: {value}"
                compared += 1
        assert compared >= 10, f"{title}: {compared} numbers compared"


if __name__ == "__main__":
    if not shutil.which("Rscript") or subprocess.run(
            ["Rscript", "--vanilla", "-e", "library(ncdf4); library(posterior)"], capture_output=True).returncode != 0:
        print("skipped: no R with ncdf4 and posterior (r-base-core, r-cran-ncdf4, r-cran-posterior)")
        sys.exit(77)
    main(*sys.argv[1:])
