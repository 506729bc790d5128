#!/usr/bin/env python3
"""False alarms and delays in simulated years: years_table.py PROGRAM [--years N] [--kinds modelled …] [--log FILE]

PROGRAM is monitoring_study, whose opening comment describes the years. Years that are already in the file --log are not
computed again.

The first table states, for each kind of year and each stated rate, the number of false alarms in the healthy years, the
number expected at the stated rate, P(at least as many), P(at most as many at a fifth of the rate), and the mean rate that
replay of healthy rows predicts at the threshold of the model. With "replay" the threshold is the higher one of both; with
"model" it is that of the model alone.

The second table compares delays with those of the control charts. The thresholds of each chart are multiplied by the
factor at which the chart has at least as many false alarms in the healthy years as the detector, so that the comparison
favours the chart. A chart detects at its first row above the threshold after the damage; the detector at its first alarm
after the damage. "not later" is the share of years in which the detector is not later than the chart, where a damage that
is not detected counts as an infinite delay.

Requirements, for years as modelled: no more false alarms than stated (one-sided Poisson, 99 %); with replay at rates of 1
and 10, not fewer than a fifth of the stated number (also 99 %); against the chart with the shortest median delay, a shorter
median, not later in at least 80 % of the years, and a share within 30 days that is not lower.
"""
import argparse
import concurrent.futures
import json
import math
import os
import statistics
import subprocess
import sys

from years import YEAR, binomial_interval, poisson_at_least, poisson_at_most

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("program", help="the program monitoring_study")
parser.add_argument("--years", type=int, default=200, help="years of each kind (default 200)")
parser.add_argument("--kinds", nargs="+", default=["modelled", "gradual", "heavy", "unmeasured", "summer"])
parser.add_argument("--hours", type=float, default=1.0, help="interval of the rows (default 1)")
parser.add_argument("--jobs", type=int, default=1, help="years at once (default 1)")
parser.add_argument("--log", help="file of results, one line for each year")
parser.add_argument("--only-tables", action="store_true", help="tables of the years in the log; computes nothing")
options = parser.parse_args()


def read_log():
    if not options.log or not os.path.exists(options.log):
        return {}
    with open(options.log) as lines:
        years = [json.loads(line) for line in lines]
    return {(y["kind"], y["year"]): y for y in years if y["interval"] == options.hours}


def compute(task):
    kind, year = task
    call = [options.program, kind, str(year), str(year + 1), str(options.hours)]
    return json.loads(subprocess.run(call, check=True, stdout=subprocess.PIPE, text=True).stdout)


def all_years():
    done = read_log()
    if options.only_tables:
        return done
    left = [(k, y) for y in range(options.years) for k in options.kinds if (k, y) not in done]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for task, year in zip(left, pool.map(compute, left)):
            done[task] = year
            if options.log:
                with open(options.log, "a") as log:
                    log.write(json.dumps(year) + "\n")
    return done


def delay_of(year, variant):
    after = [hours - year["onset"] for hours in year["damaged"][variant] if hours >= year["onset"]]
    return after[0] if after else math.inf


def days(hours):
    return f"{hours / 24:.1f}" if math.isfinite(hours) else "none"


def false_alarm_table(years):
    print("| years | threshold of | stated a year | years | alarms | expected | observed / stated | P(at least as many) | "
          "P(at most as many at a fifth) | replayed a year, mean | threshold raised |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    failed = False
    for kind in options.kinds:
        rows = [y for (k, _), y in years.items() if k == kind]
        for variant in rows[0]["healthy"] if rows else []:
            calibration, rate = variant.split()[0], float(variant.split()[1])
            alarms, expected = sum(len(y["healthy"][variant]) for y in rows), rate * sum(y["hours"] for y in rows) / YEAR
            p, fifth = poisson_at_least(alarms, expected), poisson_at_most(alarms, expected / 5)
            failed |= kind == "modelled" and (p < 0.01 or (calibration == "replay" and rate >= 1.0 and fifth < 0.01))
            print(f"| {kind} | {calibration} | {rate:g} | {len(rows)} | {alarms} | {expected:.1f} | {alarms / expected:.2g} | "
                  f"{p:.2g} | {fifth:.2g} | {statistics.mean(y['replayed'][variant] for y in rows):.2g} | "
                  f"{sum(y['raised'][variant] for y in rows)} |")
    return failed


def delay_table(years, variant):
    """Of the years as modelled; True if a requirement fails."""
    rows = [y for (k, _), y in years.items() if k == "modelled"]
    if not rows:
        return False
    alarms = sum(len(y["healthy"][variant]) for y in rows)
    ours = [delay_of(y, variant) for y in rows]
    share = sum(d <= 720 for d in ours) / len(ours)
    print(f"\nDetector at {variant} a year: {alarms} false alarms in {len(rows)} healthy years.\n")
    print("| | false alarms | median delay, days | within 30 days, % | detector not later, % |")
    print("|---|---|---|---|---|")
    print(f"| detector | {alarms} | {days(statistics.median(ours))} | {100 * share:.1f} | |")
    best = (math.inf, False)
    for chart in rows[0]["charts"]:
        counts = [sum(y["charts"][chart]["alarms"][f] for y in rows) for f in range(len(rows[0]["charts"][chart]["alarms"]))]
        enough = [f for f, count in enumerate(counts) if count >= max(alarms, 1)]
        if not enough:
            continue
        f = enough[-1]  # the largest factor with as many false alarms
        theirs = [d if (d := y["charts"][chart]["delays"][f]) >= 0 else math.inf for y in rows]
        median, within = statistics.median(theirs), sum(d <= 720 for d in theirs) / len(theirs)
        later = sum(a <= b for a, b in zip(ours, theirs)) / len(ours)
        print(f"| {chart} | {counts[f]} | {days(median)} | {100 * within:.1f} | {100 * later:.1f} |")
        best = min(best, (median, statistics.median(ours) >= median or later < 0.8 or share < within))
    low, high = binomial_interval(round(share * len(ours)), len(ours))
    print(f"\nShare within 30 days, 95 % interval: {100 * low:.1f} to {100 * high:.1f} %")
    return best[1] or not math.isfinite(statistics.median(ours))


all_of = all_years()
bad = false_alarm_table(all_of)
bad |= delay_table(all_of, "replay 1")
delay_table(all_of, "replay 10")
sys.exit(bad)
