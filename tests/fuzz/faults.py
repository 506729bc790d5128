#!/usr/bin/env python3
"""Whose faults the inputs are that ended a fuzzing target which reads by other people's libraries.

usage: faults.py TARGET REPLAY FOLDER

TARGET reads in its own process, so a corrupt file that crashes libmatio, HDF5 or NetCDF ends it; the
program reads such files in a child (io/read_apart.hpp) and must live. Prints where the inputs in FOLDER
end the target, and how many each. Exits with 1 where that is a line of this project, or where REPLAY,
the same target in a build without the fuzzer, does not live through an input within 20 s.
"""
import collections
import os
import re
import subprocess
import sys

FRAME = re.compile(r"^\s+#\d+ 0x[0-9a-f]+\s+(?:in (?P<function>.+?) )?\(?(?P<place>/[^ )]+)", re.M)


def innermost(report, project):
    """The innermost frame that stands in a library or in a line of the project."""
    for frame in FRAME.finditer(report):
        place = frame["place"]
        if place.startswith(project):
            path = place[len(project):]
            if ":" in path and not path.startswith("build/"):
                return True, path
        elif ".so" in os.path.basename(place):
            name = os.path.basename(place).split("+")[0]
            return False, f"{name}: {frame['function'] or 'a function without a name'}"
    return None, "nowhere that is known"


def run(program, path, seconds):
    environment = dict(os.environ)
    environment["ASAN_OPTIONS"] = "allocator_may_return_null=1:detect_leaks=0"
    try:
        done = subprocess.run([program, path], env=environment, capture_output=True, text=True,
                              errors="replace", timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stderr


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    target, replay, folder = sys.argv[1:]
    project = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))) + os.sep
    seen, ours = collections.Counter(), 0
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        code, report = run(target, path, 60)
        if code is None:
            where = "more than 60 s"
        elif code == 0:
            where = f"alone it passes ({name.split('-')[0]})"
        else:
            own, where = innermost(report, project)
            if own is not False:
                ours += 1
                print(f"faults: {path}: {where}", file=sys.stderr)
        seen[where] += 1
        lived, said = run(replay, path, 20)
        if lived != 0:
            ours += 1
            print(f"faults: {path}: {replay} ended with {lived} {said[-200:]}", file=sys.stderr)
    for where, times in seen.most_common():
        print(f"{times:5d}  {where}")
    print(f"{sum(seen.values())} inputs, {ours} to mend")
    sys.exit(1 if ours else 0)


main()
