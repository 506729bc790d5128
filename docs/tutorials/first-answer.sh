# %% [markdown]
# # First damage identification on the command line
#
# A damage lowers the natural frequencies of a beam. The more a mode bends the beam at the damage, the more the
# frequency of this mode decreases. This tutorial needs only the program. With five commands, you compute from ten
# frequencies the location that you should inspect.
#
# `wheeltap init` writes a complete case and a page that explains each key of the case. The case in this tutorial is a
# steel cantilever.
# %%
wheeltap init damage -o my-beam
head -n 24 my-beam/damage.json
# %% [markdown]
# Before you search for damage, check whether the model agrees with the real beam. The next command prints the
# frequencies of the model without damage. Compare these frequencies with measured frequencies of the undamaged beam, if
# available. If the frequencies of the model are wrong by 2 %, Wheeltap attributes this error to damage.
# %%
wheeltap modes my-beam/damage.json --modes 5
# %% [markdown]
# Run the identification. The identification has no settings that you must tune. With the same `--seed`, a run gives the
# same results again.
# %%
wheeltap damage my-beam/damage.json -o results/my-beam --seed 1 --quiet
# %% [markdown]
# The first lines of the output state the result: the number of damages with its probability, and the location and
# severity of each damage with 95 % intervals. Warnings follow. The last lines show whether the run has converged
# (`Converged`). The last lines also state the resolution of the search: the run may have missed a posterior mode that
# the searches reach only from a small part of the prior.
#
# The folder contains all results: the report `report.html`, all numbers in `summary.json`, and all draws in
# `posterior.nc`.
# %%
ls results/my-beam
# %% [markdown]
# **Would the data show a smaller damage?** Simulate the smallest damage that you must find, and search for this damage.
# In this example, the damage is a stiffness reduction of 5 % at 0.5 m, and the coefficient of variation of the ten
# frequencies is 0.1 %.
# %%
wheeltap simulate my-beam/damage.json -o my-beam/feared.json --set 'data={"modes": 10, "cov": 0.001}' \
  --set 'damage.truth=[{"location": 0.5, "reduction": 0.05, "extent": 0.03}]'
wheeltap damage my-beam/feared.json -o results/feared --seed 1 --quiet | head -n 12
# %% [markdown]
# Read the probability of no damage. If the probability of no damage is not small, ten frequencies of this accuracy
# cannot exclude a damage of this size. A result "no damage" then does not show that the beam is intact. Measure more
# modes, or measure the modes more accurately. A longer run of the program does not add information.
#
# Next, enter your own beam and frequencies into `my-beam/damage.json`; the [guide](../guide.md) describes the keys.
# Before you act on a result, read [how to read a report](../report.md).
