# %% [markdown]
# # Damage of a three-span beam from raw accelerations
#
# This tutorial leads from a public record to the number, locations and severities of three damages with two commands. The record
# is from the Third International Competition for Structural Health Monitoring (IC-SHM 2022). The committee simulated the random
# vibration of a continuous beam with spans of 6, 10 and 6 m and 44 elements of 0.5 m. Five accelerations were recorded for 500 s
# at 100 Hz, with noise. The excitation is unknown. Young's modulus is unknown, but the first natural frequency of the undamaged
# beam is known: 9.4367 Hz.
#
# Copy the folder of the example. `README.md` in this folder states the source and the licence of the record.
# %%
cp -rL data/three-span-beam my-beam
ls my-beam
# %% [markdown]
# **Modes.** The first command identifies the natural frequencies and mode shapes of the record. The case names the file, the
# sampling rate, the five channels and the frequency band.
# %%
wheeltap modal my-beam/modal.json -o my-beam/modal --quiet
# %% [markdown]
# The frequencies have standard deviations of 0.06 to 0.1 %. `modes.json` also contains the mode shapes at the five sensors and
# all covariances.
#
# **Damage.** The second command reads `modal/modes.json` and infers Young's modulus and the damages together. The case contains no
# number from the first command. These keys of the case describe the test:
# %%
sed -n '/"parameters"/,/^  },/p' my-beam/damage.json
# %% [markdown]
# - `parameters` gives Young's modulus a prior from 10¹¹ to 10¹² Pa. The section and the density in the case are assumptions. The
#   frequencies depend only on the ratio of bending stiffness to mass, so only the value of Young's modulus depends on these
#   assumptions.
# - `baseline` contains the frequency of the undamaged beam.
# - `data` uses the four lowest modes and states the location of each sensor.
# - Any of the 44 elements may be damaged, up to three at once.
#
# The frequencies of the undamaged model show why the case uses four modes:
# %%
wheeltap modes my-beam/damage.json --modes 5
# %% [markdown]
# At the median of its prior, Young's modulus is too large, so all frequencies are too high by the same factor, 10.6155/9.4367. The
# fifth mode of the beam is therefore at 70.8/10.6155 × 9.4367 = 62.9 Hz, above half the sampling rate of 100 Hz. In two records of
# the data set, `wheeltap modal` lists a fifth mode near 39 Hz, which is the alias of this mode.
#
# Now identify the damage:
# %%
wheeltap damage my-beam/damage.json -o my-beam/results --seed 1 --quiet
# %% [markdown]
# **Interpretation.**
#
# - Three damages have a probability above 99.9 %. The probabilities of zero, one and two damages are negligible.
# - The locations are 3.0 to 3.5 m on the left span, 4.5 to 5.0 m on the middle span and 2.5 to 3.0 m on the right span. These are
#   the elements 7, 22 and 38 of the beam, counted from 1. Damage covers one element of the model. The data do not determine a
#   place inside the element, so each interval of a location is as long as the element.
# - Each reduction is close to 20 %. The intervals are for a damage that covers exactly one element of 0.5 m.
# - The baseline determines Young's modulus to about 0.004 %.
# - The warning about the largest number of damages is correct: the run did not consider four damages. To consider them,
#   set `damage.count.max` to 4.
# - The second-last line reports that the run converged.
#
# ## All six records
#
# The data set contains six records. The same two commands with the same two files, except for the key `record.file`, gave the
# following results with the default settings. The committee did not publish the true damage. It states that only the elements 7,
# 22 and 38 may be damaged; the case does not use this information. The team that published the records trained a neural network
# on computed mode shapes of beams with damage in these three elements only.
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
# Reductions are those of the most probable number of damages. All six runs converged.
#
# - In all records, the most probable number of damages agrees with the team, if reductions below 2 % of the team count as
#   no damage.
# - The number is certain only for the records 5 and 6. In record 4, two damages have a probability of 32 %. A small second damage is
#   hard to exclude, because 44 elements are candidates and the prior gives each number the same probability. In record 4, the
#   second candidate is the first element of the left span, next to the support, where a reduction hardly changes the modes. Its
#   expected number is 0.16.
# - Three of the team's ten reductions above 2 % are outside the intervals: element 22 of record 1 (9.7 %), element 38 of record 5
#   (18.9 %) and element 7 of record 6 (39.7 %). The values of the team have errors as well, and the true values are unknown. The
#   predictive p-value of record 1 is 0.04; those of the other records are 0.15 or higher.
# - The intervals contain the errors of the identified modes. They contain no model error, because the beam is simulated
#   with the same elements. For a real beam, add `discrepancy` to `data` ([states](../states.md#model-error)).
# - In the records 2 and 6, `wheeltap modal` lists the alias of the fifth mode near 39 Hz. The key `"modes": 4` excludes the alias in
#   every record.
#
# The page on [test planning](../planning.md#example-detectable-reductions-of-a-three-span-beam) compares these results with the
# reductions that `wheeltap plan` predicts to be detectable.
