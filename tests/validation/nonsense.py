#!/usr/bin/env python3
"""Cases that no answer should be given to before saying that nothing fits: nonsense.py PROGRAM DATA

Every headline here must begin with misfit; beside each stands the same case without the mistake, whose headline
must not. Cases on measured records are left out where these are absent.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

from runs import Checks, summary

program, data = sys.argv[1:]
here = os.path.dirname(os.path.abspath(__file__))
shared = os.path.normpath(os.path.join(here, "../../../shared/data"))
SHORT = ["--warmup", "1500", "--draws", "500"]
check = Checks()


def shipped(name):
    with open(os.path.join(data, name)) as f:
        return json.load(f)


def run(case, folder, *options):
    path = os.path.join(folder, "case.json")
    with open(path, "w") as f:
        json.dump(case, f)
    return summary(program, path, *(options or SHORT), command=case["kind"])


def simulated(case, folder, name):
    """The case with its truth's data in a file of its own, and without its truth."""
    path = os.path.join(folder, "truth.json")
    with open(path, "w") as f:
        json.dump(case, f)
    out = os.path.join(folder, name)
    subprocess.run([program, "simulate", path, "-o", out, "--quiet"], check=True)
    return out


def expect(what, s, misfit):
    said = s["answer"]["headline"]
    begins = said.startswith(("None of these models", "No number of", "The frequencies fit more closely", "\u201c")) \
        and ("explain" in said or "fit more closely" in said)
    check.that(s["fit"]["ok"] != misfit and begins == misfit, f"{what}: {said[:110]}")


def record_of(name, folder):
    """A shipped case on a record in a file, which a mistake may then be made with."""
    case = shipped(os.path.join("sid", name))
    record = simulated(case, folder, "record.csv")
    case["record"]["file"] = record
    del case["truth"]
    return case


with tempfile.TemporaryDirectory() as folder:
    # A beam of a metre with one damage, its frequencies known to 0.1 %.
    beam = shipped("beam/case-a-fe.json")
    file = simulated(beam, folder, "frequencies.json")
    with open(file) as f:
        measured = json.load(f)["data"]["frequencies"][:10]
    beam["damage"].pop("truth", None)
    beam["damage"]["count"] = {"min": 0, "max": 1, "prior": "uniform"}
    beam["data"] = {"frequencies": measured, "cov": 0.001}
    expect("a beam as it is", run(beam, folder), False)
    length = json.loads(json.dumps(beam))
    length["beam"]["length"] = 1000.0
    length["damage"]["location"] = {"uniform": [0.0, 1000.0]}
    expect("its length in mm", run(length, folder), True)
    percent = json.loads(json.dumps(beam))
    percent["data"]["cov"] = 0.2
    expect("cov in per cent", run(percent, folder), True)
    # Euler and Bernoulli's frequencies of a beam of h/L = 0.2: they know no shear.
    thick = json.loads(json.dumps(beam))
    thick["beam"]["section"]["height"] = 0.2
    radius = 0.2 / math.sqrt(12.0)
    speed = math.sqrt(thick["beam"]["material"]["young"] / thick["beam"]["material"]["density"])
    thick["data"]["frequencies"] = [(n * math.pi) ** 2 * radius * speed / (2 * math.pi) for n in range(1, 7)]
    expect("Euler-Bernoulli frequencies on a thick beam", run(thick, folder), True)

    # Three masses, displacements of all.
    three = record_of("c3_bilinear_50.case.json", folder)
    three["record"]["samples"] = [0, 600]
    expect("three masses as they are", run(three, folder), False)
    exchanged = json.loads(json.dumps(three))
    responses = [c for c in exchanged["record"]["channels"] if c["role"] == "response"]
    responses[0]["column"], responses[2]["column"] = responses[2]["column"], responses[0]["column"]
    expect("channels exchanged", run(exchanged, folder), True)
    sign = json.loads(json.dumps(three))
    [c for c in sign["record"]["channels"] if c["role"] == "response"][1]["scale"] = -1.0
    expect("wrong sign of a response", run(sign, folder), True)
    other = shipped("sid/c3_bilinear_50.case.json")
    for model in other["models"]:
        model["masses"] = [20.0, 20.0, 20.0]
    other["record"] = three["record"]
    other.pop("truth")
    expect("a record of another rig", run(other, folder), True)

    silverbox = os.path.join(shared, "silverbox/snls80mv_multisine_train.csv")
    if os.path.exists(silverbox):
        with open(os.path.join(here, "measured/silverbox.json")) as f:
            case = json.load(f)
        case["record"].update(file=silverbox, samples=[1000, 1500])
        linear = json.loads(json.dumps(case))
        linear["models"] = linear["models"][:1]
        for name in ("k2", "k3"):
            del linear["parameters"][name]
        expect("linear on the Silverbox, AR(2)", run(linear, folder), True)
        del linear["residuals"]
        expect("linear on the Silverbox, white", run(linear, folder), True)
        case["models"] = case["models"][2:]
        del case["residuals"]
        expect("quadratic and cubic on the Silverbox", run(case, folder), False)
    else:
        print("left out: the Silverbox is not there")
    friction = os.path.join(shared, "friction-damper-backlash/ds2_1Hz_30lb_1.0in.csv")
    if os.path.exists(friction):
        with open(os.path.join(here, "measured/friction_damper.json")) as f:
            case = json.load(f)
        case["record"]["file"] = friction
        case["parameters"] = {"c": {"log_uniform": [1e3, 1e6]}, "sigma": case["parameters"]["sigma"]}
        case["models"] = [{"name": "viscous", "masses": [1e9], "noise": "sigma",
                           "links": [{"between": [0, 1], "damping": "c"}]}]
        expect("viscous on a friction damper", run(case, folder), True)
    else:
        print("left out: the friction damper is not there")
check.end()
