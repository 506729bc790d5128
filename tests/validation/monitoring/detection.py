#!/usr/bin/env python3
"""Detection of damage under weather, beside the comparison charts: detection.py PROGRAM [--years N]

Each series has a year of learning and a monitored year of false_alarms.py's kind. At an instant in the first eleven
months of the monitored year, damage moves the frequencies by a tenth of the range of the weather's effect, along a
direction drawn at random. The table states the median delay and the share detected within 30 days, and for each chart of
the program (`wheeltap monitor --charts`, where it has the option) the same, with the share of years in which ours is no
later. The charts' thresholds must be those of an equal rate of false alarms in healthy years.
"""
import math
import random
import statistics
import subprocess
import sys

from years import YEAR, arguments, run_all, summary_of, weather_case

FEATURES = [f"f{i} [Hz]" for i in range(1, 7)]
FREQUENCIES = [3.98, 5.17, 9.9, 10.3, 12.6, 17.2]

parser = arguments(__doc__, 200)
parser.add_argument("--rate", type=float, default=1.0, help="stated false alarms a year (default 1)")
options = parser.parse_args()
charts = "--charts" in subprocess.run([options.program, "monitor", "--help"], capture_output=True, text=True).stdout


def work(task):
    dice = random.Random("damage " + task)
    hour = (options.learning + options.monitored * 11 / 12 * dice.random()) * YEAR
    case = weather_case(options, FEATURES, frequencies=FREQUENCIES)
    slope = max(abs(s) for s in case["truth"]["per_degree"])
    size = 0.1 * 40 * slope  # the weather's range is about 40 K; frost not counted
    direction = [dice.random() for _ in FEATURES]
    case["truth"]["changes"] = [{"hour": hour, "features": {
        f: -size * d / max(direction) for f, d in zip(FEATURES, direction)}}]
    case["alarm"] = {"false_alarms_per_year": options.rate}
    s = summary_of(options.program, case, 20000 + int(task), *(["--charts"] if charts else []))
    first = {"wheeltap": [a["time"] for a in s["monitor"]["alarms"]]}
    for chart in s["monitor"].get("charts", []):
        first[chart["name"]] = [a["time"] if isinstance(a, dict) else a for a in chart.get("alarms", [])]
    return {"delays": {name: min((t - hour for t in times if t >= hour), default=None) for name, times in first.items()},
            "early": {name: sum(t < hour for t in times) for name, times in first.items()},
            "healthy_years": (hour / YEAR - options.learning)}


results = list(run_all(options, [str(y) for y in range(options.years)], work).values())
healthy = sum(r["healthy_years"] for r in results)
late = math.inf
ours = [late if r["delays"]["wheeltap"] is None else r["delays"]["wheeltap"] for r in results]
print("| detector | median delay [h] | within 30 days | alarms before the damage, a year | ours no later |\n|---|---|---|---|---|")
for name in results[0]["delays"]:
    delays = [late if r["delays"].get(name) is None else r["delays"][name] for r in results]
    print(f"| {name} | {statistics.median(delays):.0f} | {sum(d <= 720 for d in delays)} of {len(delays)} | "
          f"{sum(r['early'].get(name, 0) for r in results) / healthy:.2g} | "
          f"{sum(a <= b for a, b in zip(ours, delays))} of {len(delays)} |")
if not charts:
    print("This program has no comparison charts.")
sys.exit(0)
