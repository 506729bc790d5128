# %% [markdown]
# # A first answer, on the command line
#
# A beam has natural frequencies; damage lowers them, each by as much as the mode bends where the damage is. This
# tutorial goes from ten frequencies to a place to inspect, in five commands. It needs the program and nothing else.
#
# `wheeltap init` writes a case that runs, and beside it a page that explains each of its keys. Here it is a steel cantilever.
# %%
wheeltap init damage -o my-beam
head -n 24 my-beam/damage.json
# %% [markdown]
# Before looking for damage, see whether the model is the beam. These are its frequencies without damage; compare them
# with what was measured, or would be, on a sound beam. A model that is 2 % off will have its error called damage.
# %%
wheeltap modes my-beam/damage.json --modes 5
# %% [markdown]
# Now the run. There is nothing to tune; `--seed` makes it repeatable.
# %%
wheeltap damage my-beam/damage.json -o results/my-beam --seed 1 --quiet
# %% [markdown]
# The first lines are the answer: how many damages, with what probability, where and how bad, with 95 % intervals. Then
# comes what to keep in mind. The last lines say whether the run may be relied on (`Converged`), and how small a share of the
# prior could hold something that it missed.
#
# Everything is in the folder: `report.html` to read and to hand on, `summary.json` with every number, `posterior.nc` with
# every draw.
# %%
ls results/my-beam
# %% [markdown]
# **Would a smaller damage have been seen?** Simulate the one that you fear, and look for it. Here it is 5 % at 0.5 m,
# with ten modes known to 0.1 %.
# %%
wheeltap simulate my-beam/damage.json -o my-beam/feared.json --set 'data={"modes": 10, "cov": 0.001}' \
  --set 'damage.truth=[{"location": 0.5, "reduction": 0.05, "extent": 0.03}]'
wheeltap damage my-beam/feared.json -o results/feared --seed 1 --quiet | head -n 12
# %% [markdown]
# Read its probability of no damage: it is what a sound verdict would have been worth. Where it is not small, such a damage
# can hide, and the way out is more modes or better known ones, not a longer run.
#
# From here on: put your own beam and frequencies into `my-beam/damage.json`, with the [guide](../guide.md) beside you, and read
# [how to read a report](../report.md) before you act on one.
