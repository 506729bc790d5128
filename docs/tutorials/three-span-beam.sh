# %% [markdown]
# # Damage of a three-span beam from raw accelerations
#
# With two commands, this tutorial identifies the number, locations and severities of three damages from a public
# record. The record is from the Third International Competition for Structural Health Monitoring (IC-SHM 2022). The
# committee simulated the random vibration of a continuous beam with spans of 6, 10 and 6 m and 44 elements of 0.5 m.
# The record contains five acceleration channels with noise, of 500 s at a sampling rate of 100 Hz. The excitation and
# Young's modulus are unknown. The first natural frequency of the undamaged beam is known: 9.4367 Hz.
#
# Copy the folder of the example. `README.md` in this folder states the source and the licence of the record.
# %%
cp -rL data/three-span-beam my-beam
ls my-beam
# %% [markdown]
# **Modes.** The first command identifies the natural frequencies and mode shapes of the record. The case names the
# file, the sampling rate, the five channels and the frequency band.
# %%
wheeltap modal my-beam/modal.json -o my-beam/modal --quiet
# %% [markdown]
# The coefficients of variation of the frequencies are 0.06 to 0.1 %. `modes.json` also contains the mode shapes at the
# five sensors and all covariances.
#
# **Damage.** The second command reads `modal/modes.json` and infers Young's modulus and the damages together. You need
# not copy any results of the first command into the case. These keys of the case describe the test:
# %%
sed -n '/"parameters"/,/^  },/p' my-beam/damage.json
# %% [markdown]
# - `parameters` gives Young's modulus a prior from 10¹¹ to 10¹² Pa. The section and the density in the case are
#   assumptions. These assumptions affect only the estimate of Young's modulus, because the frequencies depend only on
#   the ratio of bending stiffness to mass.
# - `baseline` contains the frequency of the undamaged beam.
# - `data` uses the four lowest modes and states the location of each sensor.
# - Any of the 44 elements may be damaged, up to three at once.
#
# The frequencies of the undamaged model show why the case uses four modes:
# %%
wheeltap modes my-beam/damage.json --modes 5
# %% [markdown]
# `wheeltap modes` uses the median of the prior of Young's modulus. The median is too large, so all computed frequencies
# are too high by the same factor, 10.6155/9.4367. The fifth mode of the beam is therefore at 70.8/10.6155 × 9.4367 =
# 62.9 Hz, above half the sampling rate of 100 Hz. In two records of the data set, `wheeltap modal` lists an alias of
# this mode near 39 Hz.
#
# Now identify the damage:
# %%
wheeltap damage my-beam/damage.json -o my-beam/results --seed 1 --quiet
# %% [markdown]
# **Interpretation.**
#
# - The probability of three damages is above 99.9 %. The probabilities of zero, one and two damages are negligible.
# - The locations are 3.0 to 3.5 m on the left span, 4.5 to 5.0 m on the middle span and 2.5 to 3.0 m on the right span.
#   These locations are the elements 7, 22 and 38 of the beam, counted from 1. In the model, a damage covers one
#   element. The data do not determine a position inside the element, so the interval of a location is as long as the
#   element.
# - Each reduction is close to 20 %. The intervals of the reductions are valid for a damage that covers exactly one
#   element of 0.5 m.
# - The baseline determines Young's modulus with a coefficient of variation of about 0.004 %.
# - One warning concerns the largest number of damages: the run did not consider more than three damages. To include
#   four damages, set `damage.count.max` to 4.
# - The second-last line of the output reports that the run converged.
#
# ## All six records
#
# The data set contains six records. For each record, we changed the key `record.file` and ran the same two commands
# with the default settings. The committee did not publish the true damage. The committee states that only the elements
# 7, 22 and 38 may be damaged; the case does not use this information. The team that published the records estimated
# reductions with a neural network. The team trained the network on computed mode shapes of beams with damage in these
# three elements only.
#
# | record | probability of the number of damages | elements | reduction, 95 % interval | team (elements 7, 22, 38) |
# |---|---|---|---|---|
# | 1 | one 79 %, two 18 %, three 2 % | 22 | 11.1 % (10.5 to 11.7 %) | 0.3, 9.7, 0.5 % |
# | 2 | one 87 %, two 12 %, three 1 % | 22 | 50.0 % (49.7 to 50.2 %) | 0.0, 50.0, 0.4 % |
# | 3 | one 91 %, two 9 %, three 1 % | 7 | 22.5 % (21.3 to 23.7 %) | 22.1, 0.0, 0.4 % |
# | 4 | one 64 %, two 32 %, three 4 % | 7 | 40.9 % (39.9 to 41.8 %) | 41.4, 0.0, 1.9 % |
# | 5 | three, above 99.9 % | 7, 22, 38 | 19.5 % (18.2 to 20.8 %), 20.6 % (20.0 to 21.1 %), 20.5 % (19.1 to 21.8 %) | 19.3, 20.1, 18.9 % |
# | 6 | three, above 99.9 % | 7, 22, 38 | 40.9 % (40.1 to 41.6 %), 40.3 % (40.0 to 40.5 %), 40.1 % (39.3 to 40.8 %) | 39.7, 40.1, 40.3 % |
#
# The table gives the reductions for the most probable number of damages. All six runs converged.
#
# - If the team's reductions below 2 % count as no damage, the most probable number of damages agrees with the result of
#   the team in all records.
# - The number of damages is certain only for the records 5 and 6. In record 4, the probability of two damages is 32 %.
#   The data can hardly exclude a small second damage, because 44 elements are candidates and each number of damages has
#   the same prior probability. In record 4, the most probable position of a second damage is the first element of the
#   left span. This element is next to the support, where a reduction hardly changes the modes. The expected number of
#   damages in this element is 0.16.
# - Three of the team's ten reductions above 2 % are outside the intervals: element 22 of record 1 (9.7 %), element 38
#   of record 5 (18.9 %) and element 7 of record 6 (39.7 %). The estimates of the team also have errors, and the true
#   values are unknown. The posterior predictive p-value of record 1 is 0.04; the p-values of the other records are 0.15
#   or higher.
# - The intervals include the errors of the identified modes. The intervals include no model error, because the record
#   was simulated with the same elements as those of the model. For a real beam, add `discrepancy` to `data`
#   ([states](../states.md#model-error)).
# - In the records 2 and 6, `wheeltap modal` lists the alias of the fifth mode near 39 Hz. The key `"modes": 4` excludes
#   this alias.
#
# The page on [test planning](../planning.md#example-detectable-reductions-of-a-three-span-beam) compares these results
# with the reductions that `wheeltap plan` predicts to be detectable.
