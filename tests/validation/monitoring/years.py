"""Simulated years under weather, monitored by the program: what the studies of this folder share."""
import argparse
import concurrent.futures
import json
import math
import os
import subprocess
import tempfile

YEAR = 8766.0  # hours


def arguments(text, years):
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the wheeltap program")
    parser.add_argument("--years", type=int, default=years, help=f"monitored years of each kind (default {years})")
    parser.add_argument("--interval", type=float, default=1.0, help="hours between two rows (default 1)")
    parser.add_argument("--learning", type=float, default=1.0, help="years of learning (default 1)")
    parser.add_argument("--monitored", type=float, default=1.0, help="monitored years in a series (default 1)")
    parser.add_argument("--jobs", type=int, default=1, help="series at once (default 1)")
    parser.add_argument("--log", help="a file of results, one line a series: a later call continues from it")
    return parser


def weather_case(options, features, covariates=("air [degC]",), **truth):
    """A monitor case: air between about -15 and 35 degrees, frost, drift, outliers and missing entries."""
    rows = round((options.learning + options.monitored) * YEAR / options.interval)
    slopes = [-0.0004 - 0.0001 * (j % 3) for j in range(len(features))]
    base = {
        "rows": rows, "interval_hours": options.interval,
        "weather": {"mean": 10, "season": 10, "day": 4, "front_sd": 3, "front_hours": 60, "first_day": 0},
        "per_degree": slopes, "frost": {"below": 0, "per_degree": [4 * s for s in slopes]}, "lag_hours": 5,
        "drift": {"sd": 0.001, "hours": 72, "correlation": 0.5}, "noise": 0.002,
        "outliers": {"share": 0.01, "factor": 10}, "missing": 0.3}
    base.update(truth)
    return {"kind": "monitor", "title": "A simulated year",
            "series": {"file": "series.csv", "time": "hour", "time_unit": "h", "features": list(features),
                       "covariates": list(covariates)},
            "learning": {"until": options.learning * YEAR}, "truth": base}


def summary_of(program, case, seed, *more):
    """Simulates the case's series and monitors it; its summary."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "case.json")
        with open(path, "w") as f:
            json.dump(case, f)
        quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        subprocess.run([program, "simulate", path, "-o", os.path.join(folder, "series.csv"), "--seed", str(seed)], **quiet)
        subprocess.run([program, "monitor", path, "-o", os.path.join(folder, "out"), "--quiet", "--threads", "1",
                        "--seed", str(seed), *more], **quiet)
        with open(os.path.join(folder, "out", "summary.json")) as f:
            return json.load(f)


def run_all(options, tasks, work):
    """work(task) for each task (a name), in parallel; a dictionary by task. Results in the log are not computed again."""
    done = {}
    if options.log and os.path.exists(options.log):
        with open(options.log) as f:
            for line in f:
                entry = json.loads(line)
                done[entry["task"]] = entry["result"]
    left = [t for t in tasks if t not in done]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for task, result in zip(left, pool.map(work, left)):
            done[task] = result
            if options.log:
                with open(options.log, "a") as f:
                    f.write(json.dumps({"task": task, "result": result}) + "\n")
    return {t: done[t] for t in tasks}


def poisson_at_least(count, mean):
    """P(X >= count)."""
    below = sum(math.exp(k * math.log(mean) - mean - math.lgamma(k + 1)) for k in range(count))
    return max(0.0, 1.0 - below)


def poisson_at_most(count, mean):
    """P(X <= count)."""
    return 1.0 - poisson_at_least(count + 1, mean)


def binomial_interval(successes, n):
    """Wilson's 95 % interval."""
    if n == 0:
        return 0.0, 1.0
    z, p = 1.96, successes / n
    middle, width = p + z * z / (2 * n), z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return (middle - width) / (1 + z * z / n), (middle + width) / (1 + z * z / n)
