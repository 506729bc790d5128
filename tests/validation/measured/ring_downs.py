#!/usr/bin/env python3
"""A steel cantilever on a roller that moves and stops: ring_downs.py PROGRAM

After each stop it rings freely, for half a second to a second: ERA must find its first two frequencies where their peaks in the
spectrum stand out a hundredfold, the first within 0.3 Hz and the second within 1.5 Hz of the medians over five runs.
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parents[4] / "shared" / "data" / "dropbear-roller-beam"
RATE, CLEAR = 5000, 100.0

if not DATA.exists():
    sys.exit(77)
program = sys.argv[1]
medians = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(open(DATA / "frequency_vs_roller_summary.csv"))]
failed, seen = 0, [0, 0]
with tempfile.TemporaryDirectory() as folder:
    for dwell in csv.DictReader(open(DATA / "dwell_frequencies_runs0-4.csv")):
        record = DATA / f"slow10_test{dwell['run']}.csv"
        asked = [i for i in (1, 2) if float(dwell[f"f{i}_peak_over_median"]) > CLEAR]
        if not record.exists() or not asked:
            continue
        here = min(medians, key=lambda row: abs(row["roller_position_V"] - float(dwell["roller_position_V"])))
        first, last = (int(float(dwell[f"dwell_{end}_s"]) * RATE) for end in ("start", "end"))
        case = {"kind": "modal", "method": "era", "band": [10, 300],
                "record": {"file": str(record), "decays": [[first + 100, last - 50]],  # the roller is at rest
                           "channels": [{"column": "lowg_accel_V", "role": "response", "node": "tip", "direction": "y"}]}}
        path = pathlib.Path(folder) / "case.json"
        path.write_text(json.dumps(case))
        subprocess.run([program, "modal", path, "-o", pathlib.Path(folder) / "out"], check=True,
                       stdout=subprocess.DEVNULL)
        modes = json.loads((pathlib.Path(folder) / "out" / "summary.json").read_text())["modes"]
        for i in asked:
            known, most = here[f"f{i}_Hz_median"], (0.3, 1.5)[i - 1]
            nearest = min((m["frequency_hz"] for m in modes), key=lambda f: abs(f - known), default=0.0)
            good = abs(nearest - known) <= most
            seen[i - 1] += 1
            failed += not good
            print(f"{'ok   ' if good else 'FAILS'} run {dwell['run']}, roller {here['roller_mm_inferred']:.0f} mm: "
                  f"f{i} {nearest:.2f} Hz, known {known:.2f}")
print(f"{seen[0]} first and {seen[1]} second frequencies, {failed} too far off")
sys.exit(failed > 0 or min(seen) < 5)
