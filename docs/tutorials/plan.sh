# %% [markdown]
# # Sensors of a modal test, chosen before the test
#
# A modal test costs time and sensors. This tutorial plans the test of a steel portal frame: it chooses 4 of 11 sensors,
# predicts which damages the test detects, and simulates the test. The tutorial needs only the program.
#
# `wheeltap init` writes a complete case and a page that explains each key of the case. The key `plan` describes the
# test.
# %%
wheeltap init plan -o my-test
sed -n '/"plan"/,$p' my-test/plan.json
# %% [markdown]
# - `sensors` lists the candidate sensors, and `choose` the number of sensors that the test uses.
# - `seconds` and `damping` determine the standard deviations of the frequencies. `shape_sd` is the standard deviation
#   of the components of the mode shapes.
# - `masses` defines a mass that may be added to the frame in a second part of the test.
# - `costs` gives the costs of the test, of a missed damage and of a false alarm in one currency.
#
# **Plan.** The next command simulates 10 000 tests for each of the best sensor layouts. The default is 100 000
# simulated tests. `--check 0` omits the comparison with the full engine.
# %%
wheeltap plan my-test/plan.json -o results/plan --scenarios 10000 --check 0 --quiet
# %% [markdown]
# The first sentence of the output applies to damages drawn from the prior. It states the probability that the test
# detects the damage, and the probability that the inferred number and locations of damages are correct. The recommended
# sensors follow. Further sentences name the smallest detectable damage, and the locations that the test cannot
# distinguish. The first table compares sensor layouts. The second table compares tests with other numbers of sensors,
# other record lengths, other numbers of modes, and the added mass.
#
# **Unknown stiffness.** The plan assumes that Young's modulus is known. In reality, Young's modulus in the model has an
# error. Give Young's modulus a prior, in this example with a relative standard deviation of 3 %. A plan with an unknown
# coefficient cannot have added masses, so remove the key `masses`.
# %%
sed -e 's/"young": 210e9/"young": "E"/' -e '/"masses": \[{"node": "B"/d' \
  -e 's/"plan": {/"parameters": {"E": {"log_normal": [26.07, 0.03]}}, "plan": {/' my-test/plan.json > my-test/unknown.json
wheeltap plan my-test/unknown.json -o results/unknown --scenarios 10000 --check 0 --quiet | head -n 20
# %% [markdown]
# Compare the results of both plans for frequencies alone and for the recommended sensors. An unknown modulus changes
# all frequencies by the same factor. A damage changes the ratios of the frequencies and the mode shapes, so a test with
# sensors keeps most of its information about damage.
#
# **Rehearsal.** `wheeltap plan` writes a damage case for the recommended sensors. With the key `truth` of this case,
# Wheeltap simulates one test, with the smallest detectable damage at the most difficult location. For all frequencies,
# the case uses the largest coefficient of variation of any planned mode. The simulated data are then less accurate than
# the data of the planned test. For this reason, this example uses a larger damage, a stiffness reduction of 10 %:
# %%
wheeltap damage results/plan/damage.json -o results/rehearsal --seed 1 --quiet \
  --set 'damage.truth.defects=[{"member": "left post", "location": 0.15, "reduction": 0.1}]' | head -n 24
# %% [markdown]
# The identification finds one damage near its true location. For the smallest detectable damage, the same
# identification may find no damage.
#
# After your test, delete the key `truth`. In `data`, keep only `sensors`, and add the modes of the record with `from`.
# The page on [test planning](../planning.md) describes the keys, the method and its limits.
