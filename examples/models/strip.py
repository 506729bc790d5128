#!/usr/bin/env python3
"""Example of an external model: natural frequencies of a steel strip under tension between two hinges.

usage: strip.py PARAMETERS PREDICTIONS

    (2 pi f_n)^2 = (n pi / L)^4 E I / (rho A) + (n pi / L)^2 N / (rho A)
"""
import json
import math
import sys

LENGTH, WIDTH, HEIGHT, DENSITY = 1.0, 0.02, 0.002, 7850.0  # m, m, m, kg/m3
MODES = 4


def frequencies(young, tension):
    area, inertia = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12
    waves = [n * math.pi / LENGTH for n in range(1, MODES + 1)]
    return [math.sqrt((k**4 * young * inertia + k**2 * tension) / (DENSITY * area)) / (2 * math.pi) for k in waves]


if __name__ == "__main__":
    with open(sys.argv[1]) as file:
        asked = json.load(file)
    with open(sys.argv[2], "w") as file:
        json.dump(frequencies(asked["E"], asked["N"]), file)
