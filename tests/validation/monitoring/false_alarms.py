#!/usr/bin/env python3
"""False alarms in simulated healthy years: false_alarms.py PROGRAM [--years N] [--rates 0.1 1 10]

Each series has a year of learning and a monitored healthy year: six modes, air temperature with seasons, frost, drift,
outliers, 30 % of the entries missing. Three further kinds of year contradict the model: frost that acts gradually in place
of a kink; skewless noise of three degrees of freedom with 5 % outliers; and a covariate that nobody measures. The table
states, for each kind and rate, the number of alarms, the number expected at the stated rate, P(at least as many), and the
mean rate that replay of healthy rows predicts at the threshold of the model. With the calibration "replay" the threshold
is the higher one of both; with "model" that of the model alone.

Requirements for years as modelled: with both calibrations, no more alarms than stated (one-sided Poisson, 99 %); with
replay at rates of 1 and 10, not fewer than a fifth of the stated number (also one-sided, 99 %).
"""
import sys

from years import arguments, poisson_at_least, poisson_at_most, run_all, summary_of, weather_case

KINDS = {
    "as modelled": {},
    "gradual frost": {"frost": {"below": 0, "per_degree": [-0.0016, -0.002, -0.0024] * 2, "gradual": True}},
    "heavy noise": {"noise_degrees": 3, "outliers": {"share": 0.05, "factor": 10}},
    "unmeasured covariate": {"unmeasured": {"sd": 0.002, "hours": 48}},
}
FEATURES = [f"f{i} [Hz]" for i in range(1, 7)]
FREQUENCIES = [3.98, 5.17, 9.9, 10.3, 12.6, 17.2]

parser = arguments(__doc__, 200)
parser.add_argument("--rates", type=float, nargs="+", default=[0.1, 1.0, 10.0], help="stated false alarms a year")
parser.add_argument("--calibrations", nargs="+", default=["replay", "model"], choices=["replay", "model"])
parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS), help="kinds of year")
options = parser.parse_args()


def work(task):
    kind, rate, year, calibration = task.split("|")
    case = weather_case(options, FEATURES, frequencies=FREQUENCIES, **KINDS[kind])
    case["alarm"] = {"false_alarms_per_year": float(rate), "calibration": calibration}
    monitor = summary_of(options.program, case, 1000 + int(year))["monitor"]
    stated, used = monitor["log_threshold"]["stated"], monitor["log_threshold"]["used"]
    return {"alarms": len(monitor["alarms"]), "replayed": monitor["false_alarms_per_year"]["replayed"],
            "raised": used > stated + 1e-9, "times": [a["time"] for a in monitor["alarms"]]}


tasks = [f"{kind}|{rate}|{year}|{calibration}" for year in range(options.years) for kind in options.kinds
         for rate in options.rates for calibration in options.calibrations]
results = run_all(options, tasks, work)
print("| years | threshold of | stated a year | series | alarms | expected | observed / stated | P(at least as many) | "
      "P(at most as many at a fifth) | replayed a year, mean | threshold raised |")
print("|---|---|---|---|---|---|---|---|---|---|---|")
failed = False
for kind in options.kinds:
    for calibration in options.calibrations:
        for rate in options.rates:
            rows = [results[f"{kind}|{rate}|{year}|{calibration}"] for year in range(options.years)]
            alarms, expected = sum(r["alarms"] for r in rows), rate * options.monitored * len(rows)
            p, fifth = poisson_at_least(alarms, expected), poisson_at_most(alarms, expected / 5)
            replayed = sum(r["replayed"] for r in rows) / len(rows)
            failed |= kind == "as modelled" and (p < 0.01 or (calibration == "replay" and rate >= 1.0 and fifth < 0.01))
            print(f"| {kind} | {calibration} | {rate:g} | {len(rows)} | {alarms} | {expected:g} | {alarms / expected:.2g} | "
                  f"{p:.2g} | {fifth:.2g} | {replayed:.2g} | {sum(r['raised'] for r in rows)} |")
sys.exit(failed)
