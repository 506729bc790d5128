#!/usr/bin/env python3
"""Delays on the Z24 bridge: z24.py PROGRAM [--learning HOURS]

Learns on the first hours of ../shared/data/z24-monitoring (1440: 60 days; 4301: the first 3116 rows) at one false alarm in
ten years, and monitors the remaining healthy hours, once as measured and then with the second frequency lowered by 1, 2
and 4 % from each of five hours on. The table states the delay of the first alarm after that hour, and the delay of the best
chart, whose threshold is raised until it gives no false alarm in the healthy hours. It fails if there is an alarm in the
healthy hours, or if the monitor is later than the best chart. Exit code 77 without the data.
"""
import argparse
import csv
import io
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("program")
parser.add_argument("--learning", type=float, default=1440, help="hours of learning (default 1440)")
parser.add_argument("--data", default=os.path.join(os.path.dirname(__file__), "../../../../shared/data/z24-monitoring"))
options = parser.parse_args()
path = os.path.join(options.data, "undamaged.csv")
if not os.path.exists(path):
    print("z24-monitoring is not here")
    sys.exit(77)
with open(path) as file:
    header, *rows = csv.reader(file)
hours = [float(row[0]) for row in rows]
CASE = {"kind": "monitor", "title": "Z24",
        "series": {"file": "series.csv", "time": "hour", "time_unit": "h", "features": header[1:5], "covariates": header[5:]},
        "learning": {"until": options.learning}, "alarm": {"false_alarms_per_year": 0.1}}


def lowered(percent, since):
    return [[*row[:2], str(float(row[2]) * (1 - percent / 100)), *row[3:]] if float(row[0]) >= since else row for row in rows]


def run(folder, table, *more):
    text = io.StringIO()
    csv.writer(text).writerows([header, *table])
    with open(os.path.join(folder, "series.csv"), "w") as file:
        file.write(text.getvalue())
    with open(os.path.join(folder, "case.json"), "w") as file:
        json.dump(CASE, file)
    subprocess.run([options.program, "monitor", "case.json", "-o", "out", "--quiet", *more], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    with open(os.path.join(folder, "out", "summary.json")) as file:
        return json.load(file)["monitor"]


def statistics(folder):
    """Statistic of each chart, for the hours after learning."""
    with open(os.path.join(folder, "out", "charts.csv")) as file:
        table = list(csv.DictReader(file))
    names = [name for name in table[0] if name != "time"]
    return {name: [(float(row["time"]), float(row[name] or "nan")) for row in table] for name in names}


with tempfile.TemporaryDirectory() as base:
    healthy = run(base, rows, "--charts")
    print(f"learning until hour {options.learning:g}: {len(healthy['alarms'])} alarms in the healthy hours; charts: " +
          ", ".join(f"{c['name']} {c['alarms']}" for c in healthy["charts"]))
    failed = len(healthy["alarms"]) > 0
    highest = {name: max([1.0, *(v for _, v in values if math.isfinite(v))])
               for name, values in statistics(base).items()}
    onsets = [h for h in (1600, 2000, 2500, 3200, 4000, 4400, 4500, 4600, 4650, 4700) if h > options.learning][:5]
    print("| lowered by | from hour | monitor, h | best chart, h |\n|---|---|---|---|")
    shutil.rmtree(os.path.join(base, "out"))
    run(base, [row for row in rows if float(row[0]) < onsets[0]])
    for since in onsets:
        run(base, [row for row in rows if float(row[0]) < since], "--resume")
        for percent in (4, 2, 1):
            with tempfile.TemporaryDirectory() as changed:
                shutil.copytree(os.path.join(base, "out"), os.path.join(changed, "out"))
                found = run(changed, lowered(percent, since), "--resume", "--charts")
                delays = [a["time"] - since for a in found["alarms"] if a["time"] >= since]
                charts = {name: next((h - since for h, v in values if h >= since and v > highest[name]), math.inf)
                          for name, values in statistics(changed).items()}
                best = min(charts, key=charts.get)
                failed |= (delays[0] if delays else math.inf) > charts[best]
                print(f"| {percent} % | {since} | {delays[0] if delays else 'none'} | "
                      f"{f'{charts[best]:g} ({best})' if charts[best] < math.inf else 'none'} |", flush=True)
sys.exit(failed)
