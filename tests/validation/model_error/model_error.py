#!/usr/bin/env python3
"""Damage of frames whose model is wrong: model_error.py PROGRAM ROWS [--cases 0:400] [--alone] [--discrepancy WHICH] [--jobs N]

Portal frames with random spans and sections, clamped feet and rigid corners, as the model has them. The true ones have
elastic feet and corners, members that are 3 % (one sd) heavier or lighter, and a brace that the model lacks; they come
from Euler-Bernoulli elements of this file's own. Even cases are healthy, of odd ones an element has lost 10 to 70 % of
its stiffness. Five frequencies (0.1 %) and shapes at seven sensors (2 % of the largest entry), healthy and damaged, go
to `wheeltap damage`, with --alone the damaged ones only. Inferred is the discrepancy of frequencies, shapes and pieces'
stiffnesses ("stiffness"), of the former two with modes that may mix ("mixing"), or without ("common"), or none.

ROWS is a file with a line of JSON a case, which is continued. Prints what all of its rows come to.
"""
import argparse
import concurrent.futures
import json
import math
import os
import subprocess
import tempfile

import netCDF4
import numpy as np

YOUNG, DENSITY, ELEMENTS, MODES = 2e11, 7850.0, 4, 5
COV, SHAPE_SD = 0.001, 0.02
SHORT = ["--chains", "4", "--warmup", "1000", "--draws", "1000", "--search", "20", "--threads", "1", "--quiet"]


class Frame:
    """Members A-B (post), B-C (beam), C-D (post), each of ELEMENTS elements."""

    def __init__(self, rng):
        self.height, self.span = rng.uniform(0.6, 1.5, 2)
        self.depth = {"left post": rng.uniform(0.006, 0.012), "beam": rng.uniform(0.006, 0.012),
                      "right post": rng.uniform(0.006, 0.012)}
        h, s = self.height, self.span
        self.nodes = {"A": (0, 0), "B": (0, h), "C": (s, h), "D": (s, 0)}
        self.members = [("left post", "A", "B"), ("beam", "B", "C"), ("right post", "C", "D")]
        self.width = 0.03

    def length(self, member):
        return self.span if member == "beam" else self.height

    def bending(self, member):
        return YOUNG * self.width * self.depth[member] ** 3 / 12

    def case(self):
        sensors = [{"member": "left post", "at": self.height / 2, "direction": "x"},
                   {"node": "B", "direction": "x"}, {"node": "C", "direction": "x"},
                   {"member": "right post", "at": self.height / 2, "direction": "x"},
                   *({"member": "beam", "at": self.span * k / 4, "direction": "y"} for k in (1, 2, 3))]
        return {"kind": "damage", "structure": {
            "dimension": 2, "materials": {"steel": {"young": YOUNG, "poisson": 0.3, "density": DENSITY}},
            "sections": {m: {"shape": "rectangle", "width": self.width, "height": d} for m, d in self.depth.items()},
            "nodes": self.nodes,
            "members": [{"name": m, "nodes": [a, b], "elements": ELEMENTS, "material": "steel", "section": m}
                        for m, a, b in self.members],
            "supports": [{"node": n, "fix": ["x", "y", "rotation"]} for n in "AD"]},
            "damage": {"kind": "reduction", "count": {"min": 0, "max": 1, "prior": "uniform"},
                       "reduction": {"uniform": [0, 0.9]}}}, sensors


class Truth:
    """What the frame is: drawn about it, by `rng`."""

    def __init__(self, frame, rng):
        self.frame = frame
        self.mass = {m: rng.normal(1, 0.03) for m, _, _ in frame.members}
        # Rotational springs, in EI/L of the member that they are at.
        self.corner = 10 ** rng.uniform(1.3, 2.3, 2)
        self.foot = 10 ** rng.uniform(1.7, 2.7, 2)
        self.brace = rng.uniform(0, 0.05)  # of the frame's stiffness against sway, about

    def modes(self, damage=None):
        """Frequencies [Hz] and shapes at the sensors; `damage`: (member, element, reduction)."""
        f = self.frame
        count = 0
        stiffness, mass = [], []  # (degrees of freedom, matrix)

        def new(n):
            nonlocal count
            count += n
            return list(range(count - n, count))

        at = {n: new(2) + new(1) for n in f.nodes}  # x, y, rotation
        places = {}
        for m, a, b in f.members:
            length = f.length(m) / ELEMENTS
            c, s = (np.array(f.nodes[b], float) - np.array(f.nodes[a], float)) / f.length(m)
            # A beam's ends are tied to its nodes by springs: rotations of their own.
            ends = [list(at[a]), list(at[b])]
            if m == "beam":
                for k in (0, 1):
                    own = new(1)[0]
                    k_r = self.corner[k] * f.bending(m) / f.length(m)
                    stiffness.append(([at[(a, b)[k]][2], own], k_r * np.array([[1, -1], [-1, 1]])))
                    ends[k][2] = own
            line = [ends[0]] + [new(3) for _ in range(ELEMENTS - 1)] + [ends[1]]
            places[m] = line
            area = f.width * f.depth[m]
            for e in range(ELEMENTS):
                lost = damage[2] if damage and damage[:2] == (m, e) else 0.0
                k, w = element((1 - lost) * YOUNG * area, (1 - lost) * f.bending(m),
                               DENSITY * area * self.mass[m], length, c, s)
                dofs = line[e] + line[e + 1]
                stiffness.append((dofs, k))
                mass.append((dofs, w))
        for node, k in zip("AD", self.foot):
            post = "left post" if node == "A" else "right post"
            stiffness.append(([at[node][2]], np.array([[k * f.bending(post) / f.height]])))
        sway = 12 * (f.bending("left post") + f.bending("right post")) / f.height ** 3
        stiffness.append(([at["B"][0]], np.array([[self.brace * sway]])))
        K, M = np.zeros((count, count)), np.zeros((count, count))
        for into, parts in ((K, stiffness), (M, mass)):
            for dofs, matrix in parts:
                into[np.ix_(dofs, dofs)] += matrix
        free = [i for i in range(count) if i not in at["A"][:2] + at["D"][:2]]
        massless = np.array([M[i, i] == 0 for i in free])  # nodes' own rotation is in their posts
        assert not massless.any()
        L = np.linalg.cholesky(M[np.ix_(free, free)])
        inverse = np.linalg.inv(L)
        values, vectors = np.linalg.eigh(inverse @ K[np.ix_(free, free)] @ inverse.T)
        shapes = np.zeros((count, MODES))
        shapes[free] = (inverse.T @ vectors)[:, :MODES]
        half, quarter = ELEMENTS // 2, ELEMENTS // 4
        seen = [places["left post"][half][0], at["B"][0], at["C"][0], places["right post"][half][0],
                *(places["beam"][k * quarter][1] for k in (1, 2, 3))]
        return np.sqrt(values[:MODES]) / (2 * math.pi), shapes[seen].T


def element(axial, bending, mass, length, c, s):
    """Stiffness and consistent mass of an Euler-Bernoulli beam-column at direction (c, s)."""
    a, b = axial / length, bending / length ** 3
    k, m = np.zeros((6, 6)), np.zeros((6, 6))
    k[np.ix_([0, 3], [0, 3])] = a * np.array([[1, -1], [-1, 1]])
    m[np.ix_([0, 3], [0, 3])] = mass * length / 6 * np.array([[2, 1], [1, 2]])
    n = length
    k[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = b * np.array(
        [[12, 6 * n, -12, 6 * n], [6 * n, 4 * n * n, -6 * n, 2 * n * n],
         [-12, -6 * n, 12, -6 * n], [6 * n, 2 * n * n, -6 * n, 4 * n * n]])
    m[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = mass * n / 420 * np.array(
        [[156, 22 * n, 54, -13 * n], [22 * n, 4 * n * n, 13 * n, -3 * n * n],
         [54, 13 * n, 156, -22 * n], [-13 * n, -3 * n * n, -22 * n, 4 * n * n]])
    turn = np.zeros((6, 6))
    for i in (0, 3):
        turn[i:i + 2, i:i + 2] = [[c, s], [-s, c]]
        turn[i + 2, i + 2] = 1
    return turn.T @ k @ turn, turn.T @ m @ turn


def measured(modes, sensors, rng):
    frequencies, shapes = modes
    shapes = shapes / np.abs(shapes).max(axis=1, keepdims=True)
    return {"frequencies": list(frequencies * (1 + COV * rng.normal(size=MODES))), "cov": COV, "sensors": sensors,
            "shapes": (shapes + SHAPE_SD * rng.normal(size=shapes.shape)).tolist(), "shape_sd": SHAPE_SD}


DISCREPANCIES = {
    "stiffness": {"cov": {"log_uniform": [1e-4, 0.3]}, "shape": {"log_uniform": [1e-3, 0.5]},
                  "stiffness": {"log_uniform": [0.01, 0.5]}},
    "mixing": {"cov": {"log_uniform": [1e-4, 0.3]}, "shape": {"log_uniform": [1e-3, 0.5]},
            "mixing": 0.7},
    "common": {"cov": {"log_uniform": [1e-4, 0.3]}, "shape": {"log_uniform": [1e-3, 0.5]}},
    "none": None}


def one(program, number, alone, which):
    rng = np.random.default_rng([number, 17])
    frame = Frame(rng)
    truth = Truth(frame, rng)
    damage = None
    if number % 2:
        member = frame.members[rng.integers(3)][0]
        damage = (member, int(rng.integers(ELEMENTS)), float(rng.uniform(0.1, 0.7)))
    case, sensors = frame.case()
    case["baseline"] = {"data": measured(truth.modes(), sensors, rng)}
    case["data"] = measured(truth.modes(damage), sensors, rng)
    if alone:
        del case["baseline"]
    discrepancy = DISCREPANCIES[which]
    for part in (case, case.get("baseline", {})):
        if part and discrepancy:
            part["data"]["discrepancy"] = discrepancy
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "case.json")
        with open(path, "w") as f:
            json.dump(case, f)
        run = subprocess.run([program, "damage", path, "-o", folder + "/out", "--seed", str(number + 1), *SHORT],
                             capture_output=True, text=True)
        if run.returncode not in (0, 2):
            return {"case": number, "damage": damage, "failed": run.stderr[-300:]}
        with open(folder + "/out/summary.json") as f:
            summary = json.load(f)
        row = {"case": number, "damage": damage, "converged": summary["diagnostics"]["converged"],
               "fit": summary["fit"]["ok"], "P": {m["name"]: m["probability"] for m in summary["models"]}}
        if damage:
            with netCDF4.Dataset(folder + "/out/posterior.nc") as nc:
                draws = nc["posterior"]
                reduction = np.ma.filled(draws["reduction"][:], np.nan).reshape(-1)
                reduction = reduction[~np.isnan(reduction)]
            if reduction.size >= 100:
                row["rank"] = float(np.mean(reduction < damage[2]))
    return row


def table(rows):
    rows = [r for r in rows if "failed" not in r]
    healthy = [r for r in rows if r["damage"] is None]
    damaged = [r for r in rows if r["damage"] is not None]
    called = lambda some, limit: sum(r["P"].get("1 damage", 0) > limit for r in some)
    print(f"healthy: {called(healthy, 0.95)} of {len(healthy)} called damaged with P > 0.95 "
          f"({called(healthy, 0.5)} with P > 0.5)")
    for low, high in ((0.1, 0.3), (0.3, 0.5), (0.5, 0.7)):
        some = [r for r in damaged if low <= r["damage"][2] < high]
        print(f"lost {low:.0%} to {high:.0%}: {called(some, 0.95)} of {len(some)} called so with P > 0.95 "
              f"({called(some, 0.5)} with P > 0.5)")
    ranked = [r for r in damaged if "rank" in r]
    held = sum(0.05 <= r["rank"] <= 0.95 for r in ranked)
    print(f"90 % intervals of the reduction, given one damage, hold {held} of {len(ranked)}"
          + (f" ({held / len(ranked):.3f})" if ranked else ""))
    print(f"converged {sum(r['converged'] for r in rows)} of {len(rows)}, fit ok {sum(r['fit'] for r in rows)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("rows")
    parser.add_argument("--cases", default="0:400")
    parser.add_argument("--alone", action="store_true")
    parser.add_argument("--discrepancy", choices=DISCREPANCIES, default="stiffness")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    first, last = map(int, options.cases.split(":"))
    rows = []
    if os.path.exists(options.rows):
        with open(options.rows) as f:
            rows = [json.loads(line) for line in f]
    known = {r["case"] for r in rows}
    wanted = [number for number in range(first, last) if number not in known]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(one, options.program, number, options.alone, options.discrepancy) for number in wanted]
        for done in concurrent.futures.as_completed(runs):
            rows.append(done.result())
            with open(options.rows, "a") as f:
                f.write(json.dumps(rows[-1]) + "\n")
    for r in rows:
        if "failed" in r:
            print(f"case {r['case']}: {r['failed']}")
    table(rows)


main()
