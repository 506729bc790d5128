# %% [markdown]
# # Damage in a beam, with Python
#
# How many elements of a simply supported beam have lost stiffness? Which elements, and how much stiffness? The data are
# twenty natural frequencies. The data are simulated, so that you can compare the result with the true damage: a
# stiffness reduction of 30 % at 0.09 m.
# %%
import matplotlib.pyplot as plt
import numpy as np

import wheeltap as wt

case = {
    "kind": "damage",
    "beam": wt.beam(1.0, elements=100, supports="simply-supported", section=wt.rectangle(0.025, 0.006),
                    young=70e9, poisson=0.3, density=2700),
    "data": {"modes": 20, "cov": 0.001},
    "damage": {"count": {"min": 0, "max": 2, "prior": "uniform"}, "location": wt.uniform(0, 1),
               "reduction": wt.uniform(0, 0.6), "truth": [{"location": 0.09, "reduction": 0.3}]},
}
result = wt.damage(case, seed=1)
print(result.answer)
# %% [markdown]
# `result.answer` contains the main results as text, as at the top of a report. The following probabilities come from
# draws, so they have a Monte Carlo error. If `result.converged` is false, do not use the results of the run.
# %%
for model in result.models:
    print(f"{model['name']:>10}: {model['probability']:.3f} ± {model['mcse']:.3f}   (prior {model['prior']:.2f})")
assert result.converged, result.warnings

figure, (top, bottom) = plt.subplots(2, 1, figsize=(7, 5), layout="constrained")
wt.plot.models(result, ax=top)
wt.plot.inclusion(result, ax=bottom)
# %% [markdown]
# The figure of the locations has two peaks, although there is only one damage. The beam is symmetric. With the beam
# length L, a damage at x and a damage at L - x give the same frequencies. No analysis of these frequencies can
# therefore distinguish the two locations. The following code folds the locations about midspan, so that mirror images
# coincide:
# %%
x = result.draws_of("location[1]", "1 damage")
folded = np.minimum(x, 1.0 - x)
print(f"left half: {np.mean(x < 0.5):.2f} of the draws; folded: {folded.mean():.3f} ± {folded.std():.3f} m")
assert abs(folded.mean() - 0.095) < 0.02
# %% [markdown]
# The true damage is in the element from 0.09 to 0.10 m. Location and severity are correlated: a large damage near the
# support has the same effect as a smaller damage further away from the support, because the beam hardly bends near the
# support.
# %%
wt.plot.pairs(result, "1 damage");
# %% [markdown]
# **How can a test distinguish the two locations?** Measure data that differ between damage at one location and damage
# at the other: mode shapes, frequencies with an added mass away from midspan ([several states](../states.md)), or
# frequencies with other supports. Simulate the planned test before you carry it out. This example simulates the same
# beam with one clamped end:
# %%
clamped = {**case, "beam": {**case["beam"], "supports": "clamped-pinned"}}
told = wt.damage(clamped, seed=1, warmup=2000, draws=2000)
x = told.draws_of("location[1]", "1 damage")
print(f"left half: {np.mean(x < 0.5):.2f} of the draws; {x.mean():.3f} ± {x.std():.3f} m")
assert np.mean(x < 0.5) > 0.99
wt.plot.inclusion(told);
