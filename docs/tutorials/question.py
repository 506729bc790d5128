# %% [markdown]
# # User-defined models for the engine
#
# The reversible-jump sampler (the engine), which infers the number of damages, can also compare models of other
# phenomena. You define models with priors and likelihoods. The engine returns the probability of each model, with its
# Monte Carlo error, and the draws of the parameters. The data in this example are readings of the length of a crack
# over load cycles. Does the crack grow at all? Is the growth rate constant?
# %%
import matplotlib.pyplot as plt
import numpy as np

import wheeltap as wt

cycles = np.linspace(0, 1, 15)                                    # millions
random = np.random.default_rng(3)
length = 2.0 + 0.3 * cycles + 0.5 * cycles**2 + 0.05 * random.standard_normal(15)    # mm
# %% [markdown]
# The argument of a likelihood function is an array with one parameter vector in each row. The function returns one
# number for each row: ln p(data | parameters), including all normalising constants. If possible, the engine passes many
# parameter vectors in one call, so that NumPy computes with whole arrays.
# %%
def density(mean, noise):
    return (-0.5 * ((length - mean) / noise) ** 2 - np.log(noise * np.sqrt(2 * np.pi))).sum(axis=1)


def still(x):
    return density(x[:, 0:1] + 0 * cycles, x[:, 1:2])


def steady(x):
    return density(x[:, 0:1] + x[:, 2:3] * cycles, x[:, 1:2])


def faster(x):
    return density(x[:, 0:1] + x[:, 2:3] * cycles + x[:, 3:4] * cycles**2, x[:, 1:2])


start = {"start": wt.uniform(0, 5), "noise": wt.log_uniform(0.01, 1)}
result = wt.sample([
    wt.Model("does not grow", start, still),
    wt.Model("grows steadily", {**start, "rate": wt.half_normal(1)}, steady),
    wt.Model("grows faster and faster", {**start, "rate": wt.half_normal(1), "rise": wt.half_normal(1)}, faster),
], seed=1, warmup=1000, draws=2000)
for model in result.models:
    print(f"{model['name']:>24}: {model['probability']:.3f} ± {model['mcse']:.3f}")
assert result.converged, result.warnings
# %% [markdown]
# The priors influence the model probabilities. `half_normal(1)` states that growth rates are of the order of 1 mm per
# million cycles. If the prior of one parameter were a hundred times as wide, the posterior odds of the models with this
# parameter would be a hundred times smaller. Therefore priors must be proper (have a finite integral), and you must
# report the priors with the results.
# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
wt.plot.models(result, ax=left)
right.plot(cycles, length, "o", markersize=4)
draws = [result.draws_of(name, "grows faster and faster") for name in ("start", "rate", "rise")]
a, b, c = (d[:400, None] for d in draws)
low, high = np.quantile(a + b * cycles + c * cycles**2, [0.025, 0.975], axis=0)
right.fill_between(cycles, low, high, alpha=0.3, linewidth=0)
right.set(xlabel="load cycles [10⁶]", ylabel="length [mm]");
# %% [markdown]
# [User-defined likelihoods and moves](../libraries.md#user-defined-likelihoods-and-moves) describes user-defined models
# in C++. There is also an [example program](../../examples/polynomial_degree.cpp).
