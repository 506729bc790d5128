# %% [markdown]
# # Equation of motion of a mass on a spring
#
# A known force excites a mass on a spring, and a sensor measures the displacement. Is the spring linear, or is it a
# hardening spring? Define both models as chains of masses and links, with priors for the unknown parameters. The run
# returns the probability of each model. This example simulates the record of a mass of 0.5 kg on a spring with the
# stiffness k = 50 N/m and the cubic hardening k₃ = 1000 N/m³. The force is white noise, the sampling rate is 100 Hz,
# and the standard deviation of the measurement noise is 0.05 m.
# %%
import matplotlib.pyplot as plt

import wheeltap as wt

case = {
    "kind": "sid",
    "record": {"channels": [
        {"column": "force [N]", "role": "force", "mass": 1},
        {"column": "displacement [m]", "role": "response", "mass": 1, "quantity": "displacement"}]},
    "parameters": {"k": wt.uniform(0, 100), "k3": wt.uniform(0, 1e4)},
    "models": [
        {"name": "linear", "prior": 0.5, "masses": [0.5], "noise": 0.05,
         "links": [{"between": [0, 1], "stiffness": "k", "damping": 0.1}]},
        {"name": "duffing", "prior": 0.5, "masses": [0.5], "noise": 0.05,
         "links": [{"between": [0, 1], "stiffness": "k", "damping": 0.1, "cubic": "k3"}]}],
    "truth": {"model": "duffing", "parameters": {"k": 50, "k3": 1000}, "noise": 0.05, "samples": 300, "sample_rate": 100,
              "seed": 1, "excitation": [{"mass": 1, "kind": "white", "variance": 100}]},
}
record = wt.simulate(case)
figure, axis = plt.subplots(figsize=(7, 2.5), layout="constrained")
axis.plot(record["displacement"], linewidth=1)
axis.set(xlabel="sample", ylabel="displacement [m]");
# %% [markdown]
# How long must the record be? In a short record, both models predict nearly the same motion, and the data cannot
# distinguish them. The simpler model then has the higher probability, because it has fewer free parameters. A longer
# record shows the hardening of the spring.
# %%
for samples in (50, 100, 300, 500):
    result = wt.sid(case, changes={"truth.samples": samples}, seed=1, warmup=1000, draws=1000)
    assert result.converged, result.warnings
    k = result.summary["parameters"]["duffing"].get("k", {})
    print(f"{samples} samples: P(duffing) = {result.probabilities['duffing']:.4f}",
          f"  k: {k['q2.5']:.1f} to {k['q97.5']:.1f} N/m" if k else "")
assert result.probabilities["duffing"] > 0.99
# %% [markdown]
# On average, one in twenty 95 % intervals does not contain the true value. For example, the interval of k from 300
# samples of this record does not contain the true value k = 50 N/m.
#
# The most probable model is only the best of the models that you defined. Before you use the results, check whether
# this model explains the record. The band in the figure is the 95 % prediction interval, including noise.
# %%
wt.plot.record(result)
print("fit:", result.summary["fit"]["ok"])
for name in ("k", "k3"):
    told = result.summary["parameters"]["duffing"][name]
    print(f"{name:>3}: {told['q50']:.4g}   95 %: {told['q2.5']:.4g} to {told['q97.5']:.4g}")
# %% [markdown]
# [Force laws](../laws.md) describes all force laws of a link, from friction to gaps. [Selection of force-law
# terms](../system-identification.md#selection-of-force-law-terms) describes how to find the terms of a force law
# without writing one model for each combination of terms.
