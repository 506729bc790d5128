"""Case A of Tiboaca's thesis (2016): one element of a simply supported beam has lost 30 % of its stiffness. The program
identifies number, locations and severities of damages from 20 frequencies, simulated with 0.1 % noise.

    python3 examples/python/case_a.py [FIGURE]
"""
import sys

import matplotlib.pyplot as plt

import wheeltap as wt

case = {
    "kind": "damage",
    "title": "Case A from Python",
    "beam": wt.beam(1.0, elements=100, supports="simply-supported", section=wt.rectangle(0.025, 0.006),
                    young=70e9, poisson=0.3, density=2700),
    "data": {"modes": 20, "cov": 0.001},
    "damage": {
        "count": {"min": 0, "max": 2, "prior": "uniform"},
        "location": wt.uniform(0.0, 1.0),
        "reduction": wt.uniform(0.0, 0.6),
        "truth": [{"location": 0.09, "reduction": 0.3}],
    },
}
result = wt.damage(case, seed=1)
print(result.answer)
for name, probability in result.probabilities.items():
    print(f"{name:>10}: {probability:.3f}")

figure, (top, bottom) = plt.subplots(2, 1, figsize=(7, 5), layout="constrained")
wt.plot.models(result, ax=top)
wt.plot.inclusion(result, ax=bottom)
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "case_a.png", dpi=150)
