"""What the comparisons with measured records share."""
import json
import os
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from runs import Checks, probabilities, summary  # noqa: F401,E402

SKIPPED = 77  # ctest's SKIP_RETURN_CODE


def short():
    """The length of a run; what the program chooses in the long tests (`scripts/test --long`)."""
    if os.environ.get("WHEELTAP_LONG_TESTS"):
        return []
    return ["--warmup", "6000", "--draws", "2000"]


def read_case(name):
    """The case file beside this one. Ends the test where its record is not there."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), name)
    with open(path) as f:
        case = json.load(f)
    record = os.path.normpath(os.path.join(os.path.dirname(path), case["record"]["file"]))
    if not os.path.exists(record):
        print(f"skipped: {record} is not there")
        sys.exit(SKIPPED)
    case["record"]["file"] = record
    return case


def run(program, case, *options):
    """The summary of a case given as a dictionary."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "case.json")
        with open(path, "w") as f:
            json.dump(case, f)
        return summary(program, path, *options, command="sid")


def means(s, model):
    return {name: p["mean"] for name, p in s["parameters"][model].items()}


def winner(s):
    return max(s["models"], key=lambda m: m["probability"])["name"]


def elsewhere(case, model, values, record):
    """The case with one model, its parameters fixed, and the noise alone unknown, on another part of the
    record (or another record): what a run makes of it is the simulation error."""
    def fixed(x):
        if isinstance(x, dict):
            return {key: fixed(v) for key, v in x.items()}
        if isinstance(x, list):
            return [fixed(v) for v in x]
        return values[x] if isinstance(x, str) and x in values and x != "sigma" else x

    kept = [m for m in case["models"] if m["name"] == model]
    copy = {key: v for key, v in case.items() if key != "residuals"}
    copy["models"] = [dict(fixed(m), name=m["name"]) for m in kept]
    copy["record"] = dict(case["record"], **record)
    copy["record"]["channels"] = [
        {key: (fixed(v) if key in ("scale", "offset") else v) for key, v in channel.items()}
        for channel in case["record"]["channels"]]
    copy["parameters"] = {"sigma": case["parameters"]["sigma"]}
    return copy


def nrmse(s, model):
    return [channel["nrmse"] for channel in s["fit_at_mean"][model]]
