"""Identifies damage of a tower with four storeys from raw accelerations under wind, simulated before and after the
second storey lost 15 % of its stiffness. The program identifies the modes of both records, and then the damage.

    python3 examples/python/accelerations_to_damage.py [FOLDER]
"""
import sys

import matplotlib.pyplot as plt

import wheeltap as wt

STOREYS, MASS, STIFFNESS = range(1, 5), 5000.0, 8e6


def accelerations(stiffness, seed):
    """Simulates noisy accelerations of the floors, 15 minutes at 50 Hz; stiffness: k1 … k4 in N/m."""
    return wt.simulate({
        "kind": "sid",
        "record": {"channels": [
            channel for i in STOREYS for channel in (
                {"column": f"wind {i} [N]", "role": "force", "mass": i},
                {"column": f"floor {i} [m/s^2]", "role": "response", "mass": i, "quantity": "acceleration"})]},
        "parameters": {f"k{i}": wt.log_uniform(1e5, 1e8) for i in STOREYS},
        "models": [{"name": "tower", "prior": 1, "masses": [MASS] * 4, "noise": 0.001,
                    "links": [{"between": [i - 1, i], "stiffness": f"k{i}", "damping": 6000} for i in STOREYS]}],
        "truth": {"model": "tower", "parameters": {f"k{i}": k for i, k in zip(STOREYS, stiffness)}, "noise": 0.001,
                  "samples": 45000, "sample_rate": 50, "seed": seed,
                  "excitation": [{"mass": i, "kind": "white", "variance": 1e6} for i in STOREYS]},
    })


def modes(record):
    floors = {name: record[name] for name in record if name.startswith("floor")}
    modal = wt.modal(channels=floors, sample_rate=record.sample_rate, band=[1, 18])
    print(modal.text)
    return modal


folder = sys.argv[1] if len(sys.argv) > 1 else "."
before = modes(accelerations([STIFFNESS] * 4, seed=1))
after = modes(accelerations([STIFFNESS, 0.85 * STIFFNESS, STIFFNESS, STIFFNESS], seed=2))
links = [{"name": f"storey {i}", "between": [i - 1, i], "stiffness": STIFFNESS} for i in STOREYS]
result = wt.damage({
    "kind": "damage", "title": "A tower in the wind",
    "structure": {"chain": {"masses": [MASS] * 4, "links": links}},
    "baseline": {"data": {"frequencies": before.frequencies_hz, "sd": before.frequencies_sd}},
    "data": {"frequencies": after.frequencies_hz, "covariance": after.frequency_covariance},
    "damage": {"kind": "storey", "count": {"min": 0, "max": 2, "prior": "uniform"}, "reduction": wt.uniform(0, 0.6)},
}, seed=1)
print(result.text)
wt.plot.stabilisation(after).figure.savefig(f"{folder}/modes.png")
wt.plot.models(result).figure.savefig(f"{folder}/damage.png")
result.save(f"{folder}/tower")
