"""Cases that the tests share, small enough to run in a second."""
import os
import subprocess
import sys

sys.path.insert(0, os.environ["WHEELTAP_PACKAGE"])
import wheeltap as wt  # noqa: E402

PROGRAM = os.environ["WHEELTAP_PROGRAM"]
DATA = os.environ["WHEELTAP_DATA"]

SHORT = {"seed": 1, "warmup": 300, "draws": 200, "search": 20, "progress": False}


def cantilever(**changes):
    """A cantilever with one damage at 0.33 m that takes 30 % of an element's stiffness."""
    case = {
        "kind": "damage",
        "title": "A cantilever",
        "beam": wt.beam(1.0, supports="cantilever", section=wt.rectangle(0.025, 0.006), young=70e9, density=2700.0,
                        elements=40),
        "data": {"modes": 5, "cov": 0.001},
        "damage": {"count": {"min": 0, "max": 2, "prior": "uniform"}, "location": wt.uniform(0, 1),
                   "reduction": wt.uniform(0, 0.9), "truth": [{"location": 0.33, "reduction": 0.3}]},
    }
    case.update(changes)
    return case


def program(*arguments, **options):
    """The program's exit code, standard output and standard error."""
    ran = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, **options)
    return ran.returncode, ran.stdout, ran.stderr
