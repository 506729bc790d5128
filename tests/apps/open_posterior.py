#!/usr/bin/env python3
"""Opens posterior.nc with xarray and compares it with summary.json: open_posterior.py PROGRAM CASE"""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
import xarray as xr

program, case = sys.argv[1:3]
with tempfile.TemporaryDirectory() as out:
    subprocess.run([program, "damage", case, "-o", out, "--chains", "3", "--warmup", "6000", "--draws", "1500",
                    "--quiet"], check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(out, "summary.json")) as f:
        summary = json.load(f)
    path = os.path.join(out, "posterior.nc")
    groups = {g: xr.load_dataset(path, group=g)
              for g in ("posterior", "sample_stats", "posterior_predictive", "observed_data")}

posterior, stats = groups["posterior"], groups["sample_stats"]
for g in ("posterior", "sample_stats", "posterior_predictive"):
    for name, variable in groups[g].data_vars.items():
        assert variable.dims[:2] == ("chain", "draw"), (g, name, variable.dims)
        assert variable.shape[:2] == (3, 1500), (g, name, variable.shape)

k = posterior["k"].values
location, reduction = posterior["location"].values, posterior["reduction"].values
slots = np.arange(location.shape[2])
used = slots[None, None, :] < k[:, :, None]
assert np.array_equal(~np.isnan(location), used), "unused slots are NaN, used ones are not"
assert np.array_equal(~np.isnan(reduction), used)
assert np.all(np.diff(location, axis=2)[used[:, :, 1:]] >= 0), "slots are in order of location"
assert np.array_equal(stats["k"].values, k)
assert np.all(np.isfinite(stats["lp"])) and np.all(stats["log_likelihood"] <= 1e6)
moves = stats["move"].attrs["names"].split(";")
assert stats["move"].min() >= 0 and stats["move"].max() < len(moves)
assert set(np.unique(stats["accepted"])) <= {0, 1}

names = posterior["model"].attrs["names"].split(";")
for i, model in enumerate(summary["models"]):
    assert names[i] == model["name"]
    assert abs((posterior["model"].values == i).mean() - model["probability"]) < 1e-12
for model, table in summary["parameters"].items():
    mine = posterior["model"].values == names.index(model)
    if "location[1]" in table:
        assert abs(location[:, :, 0][mine].mean() - table["location[1]"]["mean"]) < 1e-9

observed = groups["observed_data"]["frequency"].values
predicted = groups["posterior_predictive"]["frequency"].values
assert predicted.shape == (3, 1500, len(observed))
sd = groups["observed_data"]["sd"].values
assert np.all(np.abs(predicted.mean(axis=(0, 1)) - observed) < 4 * sd), "predictions lie where data do"
assert np.all(predicted.std(axis=(0, 1)) > 0.9 * sd), "predictions carry the noise"
print("posterior.nc holds what summary.json says")
