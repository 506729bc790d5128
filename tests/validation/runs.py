"""Running the program and reading what it wrote."""
import json
import os
import subprocess
import sys
import tempfile


def summary(program, case, *options, command="damage"):
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, command, case, "-o", out, "--quiet", *options], check=True,
                       stdout=subprocess.DEVNULL)
        with open(os.path.join(out, "summary.json")) as f:
            return json.load(f)


def probabilities(s):
    return {m["name"]: m["probability"] for m in s["models"]}


class Checks:
    """Prints one line a check and remembers whether any failed."""

    def __init__(self):
        self.failed = 0

    def that(self, ok, text):
        self.failed += not ok
        print(("ok   " if ok else "FAIL ") + text)

    def end(self):
        print(f"{self.failed} failed")
        sys.exit(self.failed > 0)
