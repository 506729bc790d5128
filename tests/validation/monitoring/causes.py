#!/usr/bin/env python3
"""Causes of changes of a structure under weather: causes.py PROGRAM [--years N] [--structures beam frame]

For a three-span beam and a portal frame, N years each of damage, of an added mass and of a sensor fault (an offset of the
thermometer or of one feature in turn). Place and severity are drawn from the priors of the case, the instant from the
first half of the monitored period. Of the series with an alarm after the instant, the table states: how many 90 %
intervals of place and of severity hold the truth; P(damage) in five bins beside the share of damage in them; and of the
changes without damage whose shift lies more than five standard deviations from every damage, how many have a P(damage)
below 0.05.
"""
import math
import random
import sys

from years import YEAR, arguments, binomial_interval, run_all, summary_of, weather_case

BEAM = {"beam": {
    "length": 30.0, "elements": 30,
    "supports": [{"at": x, "fix": ["deflection"]} for x in (0.0, 9.0, 20.0, 30.0)],
    "material": {"young": 30e9, "poisson": 0.2, "density": 2500}, "section": {"shape": "rectangle", "width": 1.0, "height": 0.6}}}
FRAME = {"structure": {
    "dimension": 2,
    "materials": {"steel": {"young": 210e9, "poisson": 0.3, "density": 7850}},
    "sections": {"bar": {"shape": "rectangle", "width": 0.2, "height": 0.1}},
    "nodes": {"A": [0, 0], "B": [0, 4], "C": [6, 4], "D": [6, 0]},
    "members": [{"name": name, "nodes": nodes, "elements": n, "material": "steel", "section": "bar"}
                for name, nodes, n in (("left post", ["A", "B"], 8), ("girder", ["B", "C"], 12), ("right post", ["C", "D"], 8))],
    "supports": [{"node": "A", "fix": ["x", "y", "rotation"]}, {"node": "D", "fix": ["x", "y"]}]}}
MEMBERS = {"left post": (0.0, 4.0), "girder": (4.0, 6.0), "right post": (10.0, 4.0)}  # start on the line, length
CAUSES = ("damage", "mass", "sensor")
FEATURES = [f"f{i} [Hz]" for i in range(1, 7)]

parser = arguments(__doc__, 100)
parser.add_argument("--structures", nargs="+", default=["beam", "frame"], choices=["beam", "frame"])
parser.set_defaults(interval=2.0, monitored=0.5)
options = parser.parse_args()


def place_of(structure, x):
    if structure == "beam":
        return {"location": x}
    name, (start, _) = max((item for item in MEMBERS.items() if item[1][0] <= x), key=lambda item: item[1][0])
    return {"on": name, "at": x - start}


def case_of(structure, cause, dice):
    """A case and its truth: place on the line, severity."""
    length, most = (30.0, 2000.0) if structure == "beam" else (14.0, 150.0)
    x, share = length * dice.random(), dice.random()
    hour = (options.learning + 0.5 * options.monitored * dice.random()) * YEAR
    reduction = {"kind": "reduction", "count": {"max": 1}, "reduction": {"uniform": [0, 0.8]}}
    mass = {"kind": "mass", "count": {"max": 1}, "mass": {"uniform": [0, most]}}
    if structure == "beam":
        reduction["location"] = mass["location"] = {"uniform": [0, length]}
    change, severity = {"hour": hour, "damage": True}, None
    if cause == "damage":
        severity = 0.8 * share
        reduction["truth"] = [{**place_of(structure, x), "reduction": severity}]
    elif cause == "mass":
        severity = most * share
        mass["truth"] = [{**place_of(structure, x), "mass": severity}]
    elif dice.random() < 0.5:
        change = {"hour": hour, "covariates": {"air [degC]": dice.choice((-1, 1)) * math.exp(dice.uniform(0, math.log(10)))}}
    else:
        change = {"hour": hour, "features": {dice.choice(FEATURES): dice.choice((-1, 1)) * math.exp(
            dice.uniform(math.log(0.002), math.log(0.03)))}}
    case = weather_case(options, FEATURES, missing=0.1, changes=[change])
    case.update(BEAM if structure == "beam" else FRAME)
    case["damage"] = [reduction, mass]
    case["explanation"] = {"prior": {"damage": 1, "mass": 1, "sensor": 1, "other": 0.2}}
    return case, {"hour": hour, "place": x, "severity": severity}


def work(task):
    structure, cause, year = task.split("|")
    case, truth = case_of(structure, cause, random.Random(task))
    monitor = summary_of(options.program, case, 5000 + int(year))["monitor"]
    alarm = next((a for a in monitor["alarms"] if a["time"] >= truth["hour"]), None)
    if alarm is None:
        return {"truth": truth, "found": None}
    explained = alarm["explanation"]
    kinds = {d["name"]: d for d in explained["defects"]}
    found = {"delay": alarm["time"] - truth["hour"], "before": alarm is not monitor["alarms"][0],
             **{k: v for k, v in explained.items() if k not in ("defects", "sensor_faults")},
             "sensor_faults": {s["name"]: s["probability"] for s in explained["sensor_faults"]}}
    for name, kind in (("damage", "damage"), ("mass", "added mass")):
        found[f"{name} place"], found[f"{name} severity"] = kinds[kind]["location"], kinds[kind]["severity"]
    return {"truth": truth, "found": found}


def holds(interval, truth):
    if interval["q5"] is None or interval["q95"] is None:  # the kind has no probability
        return False
    return interval["q5"] <= truth <= interval["q95"]


def share(n, of):
    low, high = binomial_interval(n, of)
    return f"{n} of {of} ({100 * n / max(1, of):.0f} %, 95 % interval {100 * low:.0f} to {100 * high:.0f} %)"


failed = []


def require(ok, text):
    if not ok:
        failed.append(text)


def consistent(n, of, low, high):
    """Whether the 95 % interval of a share reaches [low, high]."""
    a, b = binomial_interval(n, of)
    return a <= high and b >= low


tasks = [f"{s}|{c}|{y}" for y in range(options.years) for s in options.structures for c in CAUSES]
results = run_all(options, tasks, work)
for structure in options.structures:
    print(f"\n## {structure}")
    alarmed = {c: [] for c in CAUSES}
    for cause in CAUSES:
        every = [results[f"{structure}|{cause}|{y}"] for y in range(options.years)]
        alarmed[cause] = [r for r in every if r["found"]]
        print(f"{cause}: alarms {len(alarmed[cause])} of {len(every)}")
    for cause in ("damage", "mass"):
        for what in ("place", "severity"):
            held = sum(holds(r["found"][f"{cause} {what}"], r["truth"][what]) for r in alarmed[cause])
            require(consistent(held, len(alarmed[cause]), 0.85, 0.95), f"{structure}: {what} of {cause}")
            print(f"90 % interval of the {what} of {cause} holds the truth: {share(held, len(alarmed[cause]))}")
    pairs = [(r["found"]["probability_damage"], cause == "damage") for cause in CAUSES for r in alarmed[cause]]
    print("| P(damage) | changes | mean P(damage) | damage |\n|---|---|---|---|")
    for low in range(5):
        members = [(p, d) for p, d in pairs if low / 5 <= p < (low + 1) / 5 or (low == 4 and p == 1.0)]
        mean = sum(p for p, _ in members) / max(1, len(members))
        if members:
            error = math.sqrt(sum(p * (1 - p) for p, _ in members)) / len(members)
            require(abs(sum(d for _, d in members) / len(members) - mean) < 3 * error + 0.02, f"{structure}: bin {low + 1}")
        print(f"| {low / 5:.1f} to {(low + 1) / 5:.1f} | {len(members)} | {mean:.3f} | {share(sum(d for _, d in members), len(members))} |")
    far = [r["found"]["probability_damage"] for cause in ("mass", "sensor") for r in alarmed[cause]
           if (r["found"]["sds_from_damage"] or 0.0) > 5.0]
    print(f"more than five standard deviations from every damage: P(damage) < 0.05 in {share(sum(p < 0.05 for p in far), len(far))}")
    require(consistent(sum(p < 0.05 for p in far), len(far), 0.95, 1.0), f"{structure}: shifts far from every damage")
print("\nnot as required: " + (", ".join(failed) or "none"))
sys.exit(bool(failed))
