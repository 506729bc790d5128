# %% [markdown]
# # Where is the damage? A beam, from Python
#
# Twenty natural frequencies of a simply supported beam, and the question how many of its elements have lost stiffness, which,
# and how much. The case is simulated, so that the answer can be held against the truth: 30 % are lost at 0.09 m.
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
# The sentence is what heads the report. The probabilities below have an error of their own, since they come from draws;
# `converged` says whether the run may be relied on at all.
# %%
for model in result.models:
    print(f"{model['name']:>10}: {model['probability']:.3f} ± {model['mcse']:.3f}   (prior {model['prior']:.2f})")
assert result.converged, result.warnings

figure, (top, bottom) = plt.subplots(2, 1, figsize=(7, 5), layout="constrained")
wt.plot.models(result, ax=top)
wt.plot.inclusion(result, ax=bottom)
# %% [markdown]
# There are two peaks, and one damage. The beam is its own mirror image, so a damage at x and one at L - x have the same
# frequencies: no analysis of these data can tell them apart. What is known is the place *or* its mirror image:
# %%
x = result.draws_of("location[1]", "1 damage")
folded = np.minimum(x, 1.0 - x)
print(f"left half: {np.mean(x < 0.5):.2f} of the draws; folded: {folded.mean():.3f} ± {folded.std():.3f} m")
assert abs(folded.mean() - 0.095) < 0.02
# %% [markdown]
# The truth is the element from 0.09 to 0.10 m. Place and severity belong together: a large damage near the support, where
# the beam hardly bends, acts like a smaller one further in.
# %%
wt.plot.pairs(result, "1 damage");
# %% [markdown]
# **What would break the tie?** Something that is not symmetric: mode shapes, a mass added off the middle
# ([several states](../states.md)), another support. Before going to the rig, simulate the test that you have in mind. Here
# is the same beam with one end clamped:
# %%
clamped = {**case, "beam": {**case["beam"], "supports": "clamped-pinned"}}
told = wt.damage(clamped, seed=1, warmup=2000, draws=2000)
x = told.draws_of("location[1]", "1 damage")
print(f"left half: {np.mean(x < 0.5):.2f} of the draws; {x.mean():.3f} ± {x.std():.3f} m")
assert np.mean(x < 0.5) > 0.99
wt.plot.inclusion(told);
