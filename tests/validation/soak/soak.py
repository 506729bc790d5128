#!/usr/bin/env python3
"""Random cases through the whole program, unattended: soak.py damage|sid PROGRAM ROWS [--cases 0:1000] [--check]

Each case is a file drawn at random (structure or chain, kinds of damage or laws, priors, noise, excitation); its truth
comes from the case's own prior, so that over many cases probabilities and intervals are calibrated exactly (Talts et al.
2018, equation 1), and the run has the program's defaults. ROWS has a line of JSON a case and is continued. Printed are the
exit codes, how probabilities and intervals held, and every miss with what its run had said of itself. --check ends with
1 where a run crashed or said nothing of a miss that chance does not explain.
"""
import argparse
import collections
import json
import math
import os
import subprocess
import sys
import tempfile
import time

import netCDF4
import numpy as np

IMPROBABLE = 0.001   # a miss: the true model had less
TAIL = 0.0005        # a miss: the truth lies outside the central 99.9 % of its model
ENOUGH = 400         # draws of the true model, to rank the truth among them
STEEL = {"young": 210e9, "poisson": 0.3, "density": 7850}


# ---- damage: beams, frames and buildings -------------------------------------------------------------------------

def beam(rng):
    length = rng.uniform(0.5, 12)
    elements = int(rng.integers(20, 101))
    depth = length / rng.uniform(15, 40)
    supports = ["simply-supported", "cantilever", "clamped-clamped", "clamped-pinned", "free-free", "springs"][
        rng.integers(6)]
    if supports == "springs":
        supports = [{"at": 0, "fix": ["deflection"]},
                    {"at": length * int(elements * rng.uniform(0.6, 1)) / elements, "fix": ["deflection"],
                     "stiffness": float(10 ** rng.uniform(5, 8))}]
    structure = {"beam": {"length": length, "elements": elements, "supports": supports,
                          "material": STEEL, "section": {"shape": "rectangle", "width": 2 * depth, "height": depth}}}
    mass = STEEL["density"] * 2 * depth * depth * length
    return "beam", structure, {"reduction": uniform(0, 0.7), "crack": uniform(0.01, 0.6),
                               "mass": uniform(0, 0.1 * mass)}, line([("", length)])


def frame(rng):
    height, span = rng.uniform(1, 4, 2)
    storeys = int(rng.integers(1, 3))
    post, girder = rng.uniform(0.1, 0.3, 2)
    elements = int(rng.integers(4, 9))
    nodes = {f"{side}{k}": [x, k * height] for k in range(storeys + 1) for side, x in (("l", 0.0), ("r", span))}
    members, lengths = [], []
    for k in range(storeys):
        for name, ends, section, length in (
                (f"left {k}", [f"l{k}", f"l{k + 1}"], "post", height),
                (f"right {k}", [f"r{k}", f"r{k + 1}"], "post", height),
                (f"girder {k}", [f"l{k + 1}", f"r{k + 1}"], "girder", span)):
            members.append({"name": name, "nodes": ends, "elements": elements, "material": "steel", "section": section})
            lengths.append((name, length))
    joint = rng.random() < 0.3
    if joint:
        members[2]["ends"] = {"l1": {"rotation": float(10 ** rng.uniform(5, 7))}}
    structure = {"structure": {
        "dimension": 2, "materials": {"steel": STEEL},
        "sections": {"post": {"shape": "rectangle", "width": post, "height": post},
                     "girder": {"shape": "rectangle", "width": girder, "height": girder}},
        "nodes": nodes, "members": members,
        "supports": [{"node": n, "fix": ["x", "y", "rotation"]} for n in ("l0", "r0")]}}
    mass = STEEL["density"] * storeys * (2 * height * post ** 2 + span * girder ** 2)
    return "frame", structure, {"reduction": uniform(0, 0.7), "crack": uniform(0.01, 0.6),
                                "mass": uniform(0, 0.1 * mass)}, line(lengths)


def building(rng):
    storeys = int(rng.integers(3, 9))
    mass, stiffness = 10 ** rng.uniform(2, 5), 10 ** rng.uniform(5, 8)
    links = [{"name": f"storey {k + 1}", "between": [k, k + 1], "stiffness": float(stiffness * rng.uniform(0.7, 1.3))}
             for k in range(storeys)]
    masses = list(mass * rng.uniform(0.7, 1.3, storeys))
    return ("building", {"structure": {"chain": {"masses": masses, "links": links}}}, {"storey": uniform(0, 0.8)},
            {"points": [link["name"] for link in links]})


def uniform(low, high):
    return {"uniform": [low, high]}


def line(lengths):
    return {"members": lengths}


SEVERITY = {"reduction": "reduction", "crack": "depth", "mass": "mass", "storey": "reduction"}


def draw_place(rng, places, severity_key, severity):
    """A place from the prior, uniform over all lengths or points."""
    if "points" in places:
        return {"link": places["points"][rng.integers(len(places["points"]))], severity_key: severity}
    lengths = np.array([length for _, length in places["members"]])
    s = rng.uniform(0, lengths.sum())
    member = int(np.searchsorted(np.cumsum(lengths), s))
    s -= lengths[:member].sum()
    name = places["members"][member][0]
    return {**({"member": name} if name else {}), "location": float(s), severity_key: severity}


def frequencies(program, *arguments):
    run = subprocess.run([program, "modes", *arguments, "--json"], capture_output=True, text=True)
    if run.returncode != 0:
        raise RuntimeError(run.stderr)
    return json.loads(run.stdout)["frequencies_hz"]


def damage_case(rng, program, folder):
    family, structure, kinds, places = (beam, frame, building)[rng.choice(3, p=[0.4, 0.4, 0.2])](rng)
    names = list(kinds)
    rng.shuffle(names)
    names = names[:1 + (rng.random() < 0.3 and len(names) > 1)]
    blocks, counts = [], []
    for name in names:
        most = 1 if len(names) > 1 else int(rng.integers(1, 4))
        weights = np.ones(most + 1)
        prior = "uniform"
        if rng.random() < 0.3:
            mean = float(rng.uniform(0.3, 1.5))
            prior = {"poisson": mean}
            weights = np.array([mean ** k / math.factorial(k) for k in range(most + 1)])
        count = int(rng.choice(most + 1, p=weights / weights.sum()))
        low, high = kinds[name]["uniform"]
        truth = [draw_place(rng, places, SEVERITY[name], float(rng.uniform(low, high))) for _ in range(count)]
        blocks.append({"kind": name, "count": {"min": 0, "max": most, "prior": prior}, SEVERITY[name]: kinds[name],
                       **({"location": uniform(0, structure["beam"]["length"])} if family == "beam" else {}),
                       "truth": truth})
        counts.append(count)
    modes = int(rng.integers(6, 13))
    if family == "building":
        modes = min(modes, len(places["points"]))
    cv = float(10 ** rng.uniform(-3.3, -2))
    case = {"kind": "damage", "title": f"soak: {family}", **structure,
            "damage": blocks if len(blocks) > 1 else blocks[0]}
    # Of the intact structure's frequencies, so that the noise does not know the truth.
    path = os.path.join(folder, "truth.json")
    with open(path, "w") as f:
        json.dump({**case, "data": {"modes": modes, "cov": cv}}, f)
    free = 2 if structure.get("beam", {}).get("supports") == "free-free" else 0
    intact, true = (np.array(frequencies(program, path, "--modes", str(modes + free), *also)[free:])
                    for also in ([], ["--truth"]))
    sd = cv * intact
    unknown_noise = rng.random() < 0.2
    case["data"] = {"frequencies": list(true + sd * rng.normal(size=modes))}
    if unknown_noise:
        # The noise from its prior; relative to what was measured, which the truth's is to its true value: cov² apart.
        cv = float(10 ** rng.uniform(-3.3, -2))
        case["data"] = {"frequencies": list(true * (1 + cv * rng.normal(size=modes))),
                        "cov": {"log_uniform": [10 ** -3.3, 1e-2]}}
    else:
        case["data"]["sd"] = list(sd)
    about = {"family": family + (", unknown noise" if unknown_noise else ""), "cov": cv, "modes": modes,
             "kinds": [f"{c} of {b['count']['max']} {b['kind']}" for b, c in zip(blocks, counts)]}
    deepest = {f"sum of {SEVERITY[n]} of {n}": sum(t[SEVERITY[n]] for t in b["truth"])
               for n, b, c in zip(names, blocks, counts) if c}
    for b in blocks:
        del b["truth"]
    return case, about, counts, deepest


def damage_model(models, counts):
    """The index of the model with these counts, whose names begin with them: "1 added mass, 0 cracks"."""
    return [[int(part.split()[0]) for part in m["name"].split(", ")] for m in models].index(counts)


def severities(draws, index, truths):
    """Per draw of the true model the sum of each kind's severities."""
    chosen = draws["model"][:].reshape(-1) == index
    out = {}
    for name in truths:
        word = name.split()[2]
        variable, = (v for v in draws.variables if v == word or v.endswith("_" + word))
        values = np.ma.filled(draws[variable][:].astype(float), np.nan)
        out[name] = np.nansum(values.reshape(chosen.size, -1)[chosen], axis=1)
    return out


# ---- sid: chains and their laws ----------------------------------------------------------------------------------

LAWS = {  # coefficients with their priors; X a typical extension, k a typical stiffness, v a typical velocity
    "cubic": lambda X, k, v: ("cubic", {"stiffness": uniform(0, 1.0 * k / X ** 2)}),
    "quadratic": lambda X, k, v: ("quadratic", {"stiffness": uniform(0, 0.3 * k / X)}),
    "bilinear": lambda X, k, v: ("bilinear", {"stiffness": uniform(0, k)}),
    "contact": lambda X, k, v: ("contact", {"stiffness": uniform(0.2 * k, 4 * k), "gap": uniform(0, 2 * X)}),
    "coulomb": lambda X, k, v: ("coulomb", {"force": uniform(0, 0.5 * k * X)}),
    "quadratic_damping": lambda X, k, v: ("quadratic_damping", {"damping": uniform(0, 2.0 / v)}),
}


def sid_case(rng, _, __):
    masses = int(rng.choice([1, 2, 3], p=[0.5, 0.3, 0.2]))
    m, k, c = 1.0, 100.0, 1.0
    X = 0.01
    rate = float(rng.choice([20, 40]))
    samples = int(rng.integers(100, 301))
    based = rng.random() < 0.25
    kind = ["white", "sine"][int(rng.random() < 0.25)]
    if kind == "white":  # σ_x² = S/(2 c k) of one mass, S = variance/rate
        excitation = {"kind": "white", "variance": 2 * c * k * X ** 2 * rate * 4 / (m * m if based else 1)}
    else:
        excitation = {"kind": "sine", "amplitude": 2 * k * X, "frequency": float(rng.uniform(0.5, 2.5))}
    excitation["base" if based else "mass"] = True if based else 1
    channels = [{"column": "base acceleration [m/s^2]", "role": "base-acceleration"} if based else
                {"column": "force [N]", "role": "force", "mass": 1}]
    quantity = ["displacement", "acceleration"][int(rng.random() < 0.3)]
    unit = {"displacement": "m", "acceleration": "m/s^2"}[quantity]
    channels += [{"column": f"{quantity} {i + 1} [{unit}]", "role": "response", "mass": i + 1, "quantity": quantity,
                  "frame": "relative" if based else "absolute"} for i in range(masses)]
    scale = X * (k / m if quantity == "acceleration" else 1)
    noise = [0.005 * scale, 0.2 * scale]
    parameters = {"k": uniform(0.5 * k, 1.5 * k), "c": uniform(0.1 * c, 3 * c), "noise": {"log_uniform": noise}}
    own = rng.random() < 0.3 and masses > 1  # each link a stiffness of its own in one of the models

    def model(name, prior, law=None, separate=False):
        links = []
        for i in range(masses):
            stiffness = f"k{i + 1}" if separate else "k"
            if separate:
                parameters[stiffness] = parameters["k"]
            links.append({"between": [i, i + 1], "stiffness": stiffness, "damping": "c"})
        if law:
            key, coefficients = LAWS[law](X, k, X * math.sqrt(k / m))
            at = links[rng.integers(masses)]
            block = {}
            for word, prior_of in coefficients.items():
                parameters[f"{law}_{word}"] = prior_of
                block[word] = f"{law}_{word}"
            if key in ("bilinear", "contact"):
                block["side"] = str(rng.choice(["opening", "closing"]))
            at[key] = block
        return {"name": name, "prior": prior, "masses": [m] * masses, "noise": "noise", "links": links}

    laws = list(LAWS)
    rng.shuffle(laws)
    laws = laws[:int(rng.integers(1, 3))]
    names = ["linear", *laws] + (["separate"] if own else [])
    weights = rng.dirichlet(3 * np.ones(len(names)))
    models = [model(n, float(w), n if n in LAWS else None, n == "separate") for n, w in zip(names, weights)]
    true = int(rng.choice(len(names), p=weights))
    used = set()

    def words(value):
        if isinstance(value, str):
            used.add(value)
        for part in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
            words(part)
    words({key: v for key, v in models[true].items() if key != "name"})
    truth = {p: draw_prior(rng, prior) for p, prior in parameters.items() if p in used}
    case = {"kind": "sid", "title": "soak: " + ", ".join(names), "record": {"channels": channels},
            "parameters": parameters, "models": models,
            "truth": {"model": names[true], "parameters": {p: v for p, v in truth.items() if p != "noise"},
                      "noise": truth["noise"], "samples": samples, "sample_rate": rate,
                      "seed": int(rng.integers(1, 2 ** 31)), "excitation": [excitation]}}
    about = {"family": f"{masses} mass" + ("es" if masses > 1 else ""), "samples": samples, "models": names,
             "kinds": [names[true]], "excitation": kind + (" base" if based else ""), "quantity": quantity}
    return case, about, names[true], truth


def draw_prior(rng, prior):
    (kind, bounds), = prior.items()
    u = rng.random()
    if kind == "uniform":
        return float(bounds[0] + u * (bounds[1] - bounds[0]))
    return float(bounds[0] * (bounds[1] / bounds[0]) ** u)


def sid_model(models, name):
    return [m["name"] for m in models].index(name)


def parameters_of(draws, index, truths):
    chosen = draws["model"][:].reshape(-1) == index
    return {name: np.ma.filled(draws[name][:].astype(float), np.nan).reshape(-1)[chosen] for name in truths}


KINDS = {"damage": (damage_case, damage_model, severities), "sid": (sid_case, sid_model, parameters_of)}


# ---- a run and its row -------------------------------------------------------------------------------------------

def one(what, program, number, options):
    make, find, values = KINDS[what]
    rng = np.random.default_rng([number, 5, len(what)])
    with tempfile.TemporaryDirectory() as folder:
        case, about, which, truths = make(rng, program, folder)
        path, out = os.path.join(folder, "case.json"), os.path.join(folder, "out")
        with open(path, "w") as f:
            json.dump(case, f)
        begin = time.time()
        run = subprocess.run([program, what, path, "-o", out, "--seed", str(number + 1), "--threads", "1", *options],
                             capture_output=True, text=True)
        row = {"case": number, **about, "exit": run.returncode, "seconds": round(time.time() - begin, 1)}
        if run.returncode != 0:
            return {**row, "error": run.stderr[-400:].replace(folder + os.sep, "")}
        with open(os.path.join(out, "summary.json")) as f:
            s = json.load(f)
        index = find(s["models"], which)
        row.update(P=[m["probability"] for m in s["models"]], truth=index, basis=s["models"][index]["basis"],
                   converged=s["diagnostics"]["converged"], fit=s["fit"]["ok"],
                   warnings=s["diagnostics"]["warnings"][:3], why=s["diagnostics"]["not_established"][:2],
                   calls=s["cost"]["likelihood_evaluations"], ranks={})
        with netCDF4.Dataset(os.path.join(out, "posterior.nc")) as nc:
            for name, draws in values(nc["posterior"], index, truths).items():
                if draws.size >= ENOUGH:
                    row["ranks"][name] = float(np.mean(draws < truths[name]))
    return row


def of_scores(rows):
    """How far -ln P(truth), summed, lies from what the stated P expect of it, in standard errors (below: too unsure)."""
    distance = variance = 0.0
    for r in rows:
        bits = [(p, -math.log(p)) for p in r["P"] if p > 0]
        expected = sum(p * b for p, b in bits)
        distance += -math.log(max(r["P"][r["truth"]], 1e-12)) - expected
        variance += sum(p * b * b for p, b in bits) - expected ** 2
    return distance / math.sqrt(variance) if variance > 0 else 0.0 if distance == 0 else math.inf


REFUSED = ["grows without bound", "frequencies must increase"]


def misses(row):
    found = []
    if row["P"][row["truth"]] < IMPROBABLE:
        found.append(f"the true model has P = {row['P'][row['truth']]:.1g}")
    return found + [f"{name} lies at {u:.4f} of its draws" for name, u in row["ranks"].items()
                    if not TAIL < u < 1 - TAIL]


def of_probabilities(cell):
    """Two-sided, by doubling the smaller tail: of how many of independent events, each (its probability, whether it was),
    came true."""
    pmf = np.ones(1)
    for p, _ in cell:
        pmf = np.convolve(pmf, [1 - p, p])
    true = sum(t for _, t in cell)
    return min(1.0, 2 * min(pmf[:true + 1].sum(), pmf[true:].sum()))


def report(rows):
    print(f"{len(rows)} cases: " + ", ".join(f"exit code {code}: {n}" for code, n in
                                             sorted(collections.Counter(r["exit"] for r in rows).items())))
    # What is left is calibrated as before, as good as: the likelihood of these is zero, and that of noise which swaps two
    # close frequencies, which a case must not, is small.
    refused = [r for r in rows if r["exit"] == 65 and any(words in r["error"] for words in REFUSED)]
    for words in REFUSED:
        if n := sum(words in r["error"] for r in refused):
            print(f"{n} of them refused as they must be: {words}")
    rows = [r for r in rows if r not in refused]
    failed = [r for r in rows if r["exit"] != 0]
    for r in failed:
        print(f"  case {r['case']} ({r['family']}): {r['exit']}: {r['error'].strip()}")
    rows = [r for r in rows if r["exit"] == 0]
    if not rows:
        return len(failed)
    sure = [r for r in rows if r["converged"] and r["fit"]]
    print(f"converged {sum(r['converged'] for r in rows)}, fit ok {sum(r['fit'] for r in rows)}, both {len(sure)}; "
          f"median {np.median([r['seconds'] for r in rows]):.1f} s, longest {max(r['seconds'] for r in rows):.0f} s")

    print("\n| P stated | models | sum of P | true | p |\n| --- | ---: | ---: | ---: | ---: |")
    edges = [0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0 + 1e-9]
    wrong = len(failed)
    for low, high in zip(edges, edges[1:]):
        cell = [(p, i == r["truth"]) for r in rows for i, p in enumerate(r["P"]) if low <= p < high]
        if not cell:
            continue
        total, true, p = sum(p for p, _ in cell), sum(t for _, t in cell), of_probabilities(cell)
        wrong += p < 1e-4
        print(f"| {low:g} to {min(high, 1):g} | {len(cell)} | {total:.2f} | {true} | {p:.2f} |")
    score = of_scores(rows)
    wrong += abs(score) > 4
    print(f"\nlogarithmic score, standard errors from what these P expect: {score:.2f}")

    print("\n| quantity, in the true model | ranks | 90 % intervals held | p | outside 99.9 % |\n"
          "| --- | ---: | ---: | ---: | ---: |")
    ranks = collections.defaultdict(list)
    for r in rows:
        for name, u in r["ranks"].items():
            ranks[name].append(u)
            ranks["all"].append(u)
    for name in sorted(ranks, key=lambda n: (n == "all", n)):
        u = np.array(ranks[name])
        inside = (u >= 0.05) & (u <= 0.95)
        held, p = int(inside.sum()), of_probabilities([(0.9, within) for within in inside.tolist()])
        wrong += p < 1e-4 and name != "all"
        print(f"| {name} | {u.size} | {held} ({held / u.size:.3f}) | {p:.2f} | {int(((u <= TAIL) | (u >= 1 - TAIL)).sum())} |")

    missed = [r for r in rows if misses(r)]
    silent = [r for r in missed if r in sure]
    chance = (sum(p for r in sure for p in r["P"] if p < IMPROBABLE) + 2 * TAIL * sum(len(r["ranks"]) for r in sure))
    print(f"\n{len(missed)} misses; {len(silent)} of them in runs that had converged and fitted ({chance:.1f} expected by chance)")
    for r in missed:
        said = "said nothing" if r in silent else "not converged" if not r["converged"] else "misfit"
        print(f"  case {r['case']} ({r['family']}; truth {', '.join(r['kinds'])}): {'; '.join(misses(r))}; {said}"
              + (f": {r['why'][0]}" if r["why"] else ""))
    surplus = sum(math.exp(-chance) * chance ** i / math.factorial(i) for i in range(len(silent)))  # P(fewer)
    return wrong + (1 - surplus < 1e-3 and bool(silent))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=KINDS)
    parser.add_argument("program")
    parser.add_argument("rows")
    parser.add_argument("--cases", default="0:1000")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--case", type=int, help="write this case to standard output, and end")
    parser.add_argument("options", nargs="*", help="of the program, after --")
    options = parser.parse_args()
    if options.case is not None:
        with tempfile.TemporaryDirectory() as folder:
            rng = np.random.default_rng([options.case, 5, len(options.what)])
            case, about, which, truths = KINDS[options.what][0](rng, options.program, folder)
            json.dump(case, sys.stdout, indent=1)
            print(f"\n{about}\n{which} {truths}", file=sys.stderr)
        return
    first, last = map(int, options.cases.split(":"))
    rows = []
    if os.path.exists(options.rows):
        with open(options.rows) as f:
            rows = [json.loads(text) for text in f]
    known = {r["case"] for r in rows}
    for number in range(first, last):
        if number in known:
            continue
        row = one(options.what, options.program, number, options.options)
        rows.append(row)
        with open(options.rows, "a") as f:
            f.write(json.dumps(row) + "\n")
        said = "exit code " + str(row["exit"]) if row["exit"] else (
            f"P(truth) = {row['P'][row['truth']]:.3f}, {'converged' if row['converged'] else 'NOT converged'}"
            + ("" if row["fit"] else ", MISFIT") + "".join(f"; {m}" for m in misses(row)))
        print(f"case {number} ({row['family']}): {said}; {row['seconds']} s", flush=True)
    print()
    wrong = report(rows)
    sys.exit(1 if options.check and wrong else 0)


main()
