#!/usr/bin/env python3
"""Opens posterior.nc of a sid run with xarray and compares it with summary.json:
open_sid_posterior.py PROGRAM CASE"""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
import xarray as xr

program, case = sys.argv[1:3]
with tempfile.TemporaryDirectory() as out:
    subprocess.run([program, "sid", case, "-o", out, "--chains", "3", "--warmup", "6000", "--draws", "500",
                    "--set", "record.samples=[0,300]", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(out, "summary.json")) as f:
        summary = json.load(f)
    path = os.path.join(out, "posterior.nc")
    posterior = xr.load_dataset(path, group="posterior")
    stats = xr.load_dataset(path, group="sample_stats")
    for group in ("posterior_predictive", "observed_data"):
        xr.load_dataset(path, group=group)
    given = xr.load_dataset(path, group="constant_data")
    noise_free = xr.load_dataset(path, group="noise_free")
    paths = xr.load_dataset(path, group="link_paths")

for data in (posterior, stats):
    for name, variable in data.data_vars.items():
        assert variable.dims[:2] == ("chain", "draw"), (name, variable.dims)
        assert variable.shape[:2] == (3, 500), (name, variable.shape)

model = posterior["model"].values
names = posterior["model"].attrs["names"].split(";")
assert names == [m["name"] for m in summary["models"]]
assert np.array_equal(stats["k"].values, model), "the model's index is the indicator that jumps"
for i, row in enumerate(summary["models"]):
    assert abs((model == i).mean() - row["probability"]) < 1e-12
moves = stats["move"].attrs["names"].split(";")
assert stats["move"].min() >= 0 and stats["move"].max() < len(moves)
assert set(np.unique(stats["accepted"])) <= {0, 1}
assert np.all(np.isfinite(stats["lp"])) and np.all(np.isfinite(stats["log_likelihood"]))

# A parameter is NaN exactly if the model of the draw does not have it.
for name in {p for table in summary["parameters"].values() for p in table}:
    values = posterior[name].values
    for i, m in enumerate(names):
        if m not in summary["parameters"]:
            continue
        mine = values[model == i]
        assert np.all(np.isnan(mine) != (name in summary["parameters"][m])), (name, m)
        if name in summary["parameters"][m]:
            assert abs(mine.mean() - summary["parameters"][m][name]["mean"]) < 1e-9 * abs(mine.mean())
# The excitation of the record: white with variance 100, 300 samples (standard error 8 %).
force = given["force"]
assert force.dims == ("sample",) and force.size == 300 and force.attrs["units"] == "N"
assert 60 < force.values.var() < 140, force.values.var()

# Without noise: quantiles in order.
quantiles = noise_free["displacement"]
assert quantiles.dims == ("quantile", "sample") and quantiles.attrs["units"] == "m", quantiles
assert np.all(np.diff(quantiles.values, axis=0) >= 0)
# The motion of the link: its units, and the stiff ends of a hardening spring.
assert [paths[name + "_0_1"].attrs["units"] for name in ("extension", "rate", "tension")] == ["m", "m/s", "N"]
assert paths["tension_0_1"].values.argmax() == paths["extension_0_1"].values.argmax()

# The law of the link is that of the draws: k e + k3 e^3.
[law] = summary["links"]["duffing"]
assert law["between"] == [0, 1]
e = np.array(law["extension"])
low, middle, high = (np.array(law["tension"][q]) for q in ("q2.5", "q50", "q97.5"))
assert np.all(low <= middle) and np.all(middle <= high) and e.min() < 0 < e.max()
mine = model == names.index("duffing")
tension = np.outer(posterior["k"].values[mine], e) + np.outer(posterior["k3"].values[mine], e**3)
# The median of 400 draws has a standard error of 1.25 / sqrt(400) sd; six of these are allowed.
assert np.all(np.abs(np.median(tension, axis=0) - middle) <= 6 * 1.25 / 20 * tension.std(axis=0) + 1e-12)

ladder = summary["diagnostics"]["ladder"]
assert ladder["while_drawing"] or ladder["round_trips"] is None
print("posterior.nc holds what summary.json says")
