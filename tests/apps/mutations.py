#!/usr/bin/env python3
"""Runs shipped cases with one to three values changed at random, reads shipped measured files with some bytes changed,
and checks the documented exit codes and limits.

usage: mutations.py PROGRAM DATA [COUNT] [SEED]

Every mutation must end with exit code 0, 65 or 66, without a signal, within 10 s of processor time and 1 GB. The script
prints the case and output of all other ends and keeps them in the folder that its last line names. A run may be long or
large if --dry-run announces it. Runs have `--warmup 100 --draws 100`; one case of damage or identification in ten is
simulated and one in ten has its modes computed.

ctest runs 40 of them (apps.mutations). The long run, about half an hour on two cores:

    tests/apps/mutations.py build/release/apps/wheeltap data 3000
"""
import concurrent.futures
import copy
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile

SECONDS, BYTES = 10, 1 << 30
SHORT = ["--quiet", "--chains", "2", "--warmup", "100", "--draws", "100", "--threads", "1"]
NUMBERS = [0, -1, 1, 2, 0.5, 5.0, 1e-320, 1e-300, 1e-12, 1e12, 1e300, 1.7e308, -1e300, 2**31, 2**32 + 1, 2**63, 2**64,
           10**30, -(2**31) - 1, 1e9, 20, 64, 1000]
TEXTS = ["", " ", "x", "..", "a/b", "k" * 257, "\x1b[31m", "two\nlines", "\u202e", "梁", "NaN", "1e5", "/dev/zero",
         "/", "no such file", "-1", "\ud800".encode("utf-8", "replace").decode()]
OTHERS = [None, True, False, [], {}, [[]], [0], [1, 2, 3], {"uniform": [0, 1]}, {"normal": [0, 1e300]},
          {"log_uniform": [1e-320, 1]}, {"truncated_normal": [0, 1, 40, 50]}, {"truncated_normal": [-1e10, 1, 0, 1]},
          {"beta": [1e-5, 1e5]}, {"gamma": [1e-300, 1]}, {"half_normal": 1e-320}, {"log_normal": [0, 1000]},
          {"student_t": [1e-300, 0, 1]}, {"inverse_gamma": [1e-3, 1]}, {"table": {"x": [0, 1e-320, 1], "density": [0, 1e300, 1]}},
          {"table": {"x": [-1e307, 0, 1e307], "density": [0, 1, 0]}}]


def places(value, start=()):
    """The paths of all values in a case."""
    keys = value.keys() if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        yield start + (key,)
        yield from places(value[key], start + (key,))


def at(case, path):
    for key in path:
        case = case[key]
    return case


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def mutate(case, rng):
    case = copy.deepcopy(case)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        path = rng.choice(list(places(case)))
        if rng.random() < 0.5:  # the parser rejects most other changes
            path = rng.choice([p for p in places(case) if is_number(at(case, p))] or [path])
        parent = at(case, path[:-1])
        key, old = path[-1], parent[path[-1]]
        how = rng.random()
        if how < 0.08:
            del parent[key]
        elif how < 0.14 and isinstance(parent, dict):
            parent[rng.choice(TEXTS + ["kind", "name", "prior"])] = parent.pop(key)
        elif how < 0.2 and isinstance(parent, list):
            parent.insert(rng.randrange(len(parent) + 1), copy.deepcopy(rng.choice(parent)))
        elif how < 0.26:
            parent[key] = copy.deepcopy(at(case, rng.choice(list(places(case)))))
        elif is_number(old) and how < 0.75:
            parent[key] = rng.choice([old * 10, old / 10, -old, old + 1, max(old - 1, 0), old * 1e6, float(old), old * 2,
                                      old * rng.random(), old * (1 + rng.random())])
        else:
            parent[key] = copy.deepcopy(rng.choice(rng.choice((NUMBERS, NUMBERS, TEXTS, OTHERS))))
    return case


def mutate_bytes(data, rng):
    """A file with a few bytes changed, truncated, or with a part repeated or moved."""
    data = bytearray(data[:200_000])
    for _ in range(rng.choice((1, 1, 2, 5))):
        if not data:
            break
        here, how = rng.randrange(len(data)), rng.random()
        if rng.random() < 0.5:
            here = rng.randrange(min(len(data), 600))  # headers
        if how < 0.4:
            data[here] = rng.choice((0, 10, 13, 32, 44, 45, 46, 48, 57, 69, 101, 127, 255, rng.randrange(256)))
        elif how < 0.55:
            del data[here:]
        elif how < 0.7:
            del data[here:here + rng.randrange(1, 90)]
        elif how < 0.85:
            data[here:here] = data[here:here + rng.randrange(1, 90)]
        else:
            data[here:here] = rng.choice((b"nan", b"inf", b"1e999", b"-", b"99999999999", b"    -1\n", b"\xff\xfe", b"\0"))
    return bytes(data)


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS + 1, SECONDS + 2))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def announced(program, case, out):
    """Whether --dry-run announces a long or large run."""
    kind = kind_of(case)
    try:
        asked = subprocess.run([program, kind, str(case), "-o", str(out), "--dry-run", *options_of(kind)],
                               capture_output=True, timeout=60, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return False
    text = asked.stdout.decode(errors="replace")
    seconds = sum(float(n.replace(" ", "")) * {"s": 1, "min": 60, "h": 3600}[unit]
                  for n, unit in re.findall(r", ([0-9][0-9. e+]*) (s|min|h)\b", text))
    gigabytes = max([float(n) for n in re.findall(r"about ([0-9.e+-]+) GB", text)], default=0.0)
    # Estimates are correct within a factor of ten.
    return seconds > SECONDS / 10 or gigabytes > BYTES / 1e9 / 10


def kind_of(case):
    kind = re.search(r'"kind": "(sid|update|modal)"', case.read_text())
    return kind[1] if kind else "damage"


def options_of(command):
    return ["--quiet", "--threads", "1"] if command == "modal" else SHORT


def command_line(program, kind, case, folder, rng):
    """The command for a mutated case: mostly its run."""
    how = rng.random()
    if kind in ("damage", "sid") and how < 0.1:
        return [program, "simulate", str(case), "-o", str(folder / "simulated.csv")]
    if kind == "damage" and how < 0.2:
        return [program, "modes", str(case), "--modes", "3"]
    if kind == "section":
        return [program, "section", str(case), "--json"]
    if kind == "data":
        return [program, "data", str(case)]
    return [program, kind, str(case), "-o", str(folder / "out"), *options_of(kind)]


def run(program, origin, number, seed, scratch):
    """The fault found by one mutation, or None."""
    rng = random.Random(f"{seed}/{number}")
    folder = scratch / str(number)
    folder.mkdir()
    # In a folder with links to the files next to the original, which the case names.
    for neighbour in origin.parent.iterdir():
        (folder / neighbour.name).symlink_to(neighbour)
    if origin.suffix == ".json":
        case = folder / "mutated.json"
        original = json.loads(origin.read_text())
        case.write_text(json.dumps(mutate(original, rng)))
        kind = original.get("kind", "section")
    else:
        case = folder / ("mutated" + origin.suffix)
        case.write_bytes(mutate_bytes(origin.read_bytes(), rng))
        kind = "data"
    process = subprocess.Popen(command_line(program, kind, case, folder, rng),
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                               preexec_fn=limits)
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = 0  # waited for
    code = os.waitstatus_to_exitcode(status)
    seconds, largest = usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024
    why = []
    if code not in (0, 65, 66):
        why.append(f"signal {-code}" if code < 0 else f"exit code {code}")
    if seconds > SECONDS:
        why.append(f"{seconds:.0f} s")
    if largest > BYTES:
        why.append(f"{largest / 1e9:.1f} GB")
    last = said.decode(errors="replace").rstrip("\n").split("\n")[-1]
    if code in (65, 66) and not last.startswith("wheeltap: "):
        why.append("no line says why")
    if any(byte < 32 and byte != 10 or byte == 127 for byte in said):
        why.append("control characters on standard error")
    too_much = seconds > SECONDS or largest > BYTES
    if why and too_much and kind not in ("data", "section") and code in (0, 65, 66, 130, -signal.SIGXCPU, -signal.SIGKILL) and announced(program, case, folder / "out"):
        why = []
    if not why:
        shutil.rmtree(folder)
        return code, None
    return code, f"{case} (of {origin.name}): {', '.join(why)}: {last[:200]}"


def command_line_of_script():
    """PROGRAM DATA [COUNT] [SEED]"""
    program, data = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 3000
    return program, data, count, sys.argv[4] if len(sys.argv) > 4 else "1"


def main():
    program, data, count, seed = command_line_of_script()
    cases = sorted(data.rglob("*.json")) + [p for p in sorted(data.rglob("*")) if p.suffix in (".csv", ".uff")]
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="wheeltap-mutations-"))
    codes, faults = {}, 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        jobs = [pool.submit(run, program, cases[n % len(cases)], n, seed, scratch) for n in range(count)]
        for job in concurrent.futures.as_completed(jobs):
            code, complaint = job.result()
            codes[code] = codes.get(code, 0) + 1
            if complaint:
                faults += 1
                print(complaint, flush=True)
    print(f"{count} mutations of {len(cases)} cases: "
          + ", ".join(f"{n} ended with {code}" for code, n in sorted(codes.items()))
          + f"; {faults} faults" + (f", kept in {scratch}" if faults else ""))
    if not faults:
        shutil.rmtree(scratch)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
