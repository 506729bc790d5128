# %% [markdown]
# # First damage identification on the command line
#
# A damage lowers the natural frequencies of a beam. The more a mode bends at the damage, the more its frequency decreases. This
# tutorial leads from ten frequencies to a location for inspection in five commands. It needs only the program.
#
# `wheeltap init` writes a complete case and a page that explains each of its keys. The case in this tutorial is a steel
# cantilever.
# %%
wheeltap init damage -o my-beam
head -n 24 my-beam/damage.json
# %% [markdown]
# Before you search for damage, check whether the model agrees with the real beam. The command prints the model's frequencies
# without damage. Compare them with frequencies that were measured, or would be measured, on the undamaged beam. If the model is
# wrong by 2 %, Wheeltap attributes this error to damage.
# %%
wheeltap modes my-beam/damage.json --modes 5
# %% [markdown]
# Run the identification. There are no settings to tune; `--seed` makes the run repeatable.
# %%
wheeltap damage my-beam/damage.json -o results/my-beam --seed 1 --quiet
# %% [markdown]
# The first lines are the result: the number of damages with its probability, and their location and severity with 95 %
# intervals. Warnings follow. The last lines show whether you can rely on the run (`Converged`), and how small a share of the
# prior may contain a solution that the run missed.
#
# The folder contains all results: `report.html` to read and to send, `summary.json` with all numbers, `posterior.nc` with all
# draws.
# %%
ls results/my-beam
# %% [markdown]
# **Would the data show a smaller damage?** Simulate the smallest damage that you must find, and search for it. In this example
# it is 5 % at 0.5 m, and the noise of the ten frequencies is 0.1 %.
# %%
wheeltap simulate my-beam/damage.json -o my-beam/feared.json --set 'data={"modes": 10, "cov": 0.001}' \
  --set 'damage.truth=[{"location": 0.5, "reduction": 0.05, "extent": 0.03}]'
wheeltap damage my-beam/feared.json -o results/feared --seed 1 --quiet | head -n 12
# %% [markdown]
# Read the probability of no damage. If it is not small, these data cannot exclude such a damage, and a result of "no damage"
# proves little. Measure more modes, or measure them more accurately. A longer run does not help.
#
# Next, enter your own beam and frequencies into `my-beam/damage.json`; the [guide](../guide.md) describes the keys. Before you
# act on a result, read [how to read a report](../report.md).
