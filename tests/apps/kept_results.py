#!/usr/bin/env python3
"""Makes small runs of every command, changes one file of a results folder at random, and reads the folder again.

usage: kept_results.py PROGRAM DATA [COUNT] [SEED]

In summary.json and modes.json it removes values, gives them another shape, or changes them like mutations.py; in other
files it changes bytes. Then `report`, `compare` with the unchanged run and, one time in ten, `--resume` must end with
exit code 0, 65 or 66, without a signal, within 10 s of processor time, with one error line if the code is not 0. The
script keeps the folders of all other ends in the folder that its last line names.

ctest makes 60 of them (apps.kept_results). The long run, three minutes on two idle cores:

    tests/apps/kept_results.py build/release/apps/wheeltap data 3000
"""
import concurrent.futures
import copy
import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

from mutations import (NUMBERS, OTHERS, SECONDS, SHORT, TEXTS, at, command_line_of_script, limits, mutate, mutate_bytes,
                       places)

RUNS = {
    "beam": ("damage", "beam/case-a-fe.json", [*SHORT, "--evidence"]),
    "frame": ("damage", "structures/cracked-portal.json", SHORT),
    "storeys": ("update", "structures/storeys-update.json", [*SHORT, "--evidence"]),
    "rig": ("sid", "sid/c1_linear.case.json", SHORT),
    "sweep": ("sid", "sid/c3_stiffness_sweep.case.json", SHORT),
    "modes": ("modal", "uff/free-beam-modal.json", ["--quiet"]),
}


def said(command):
    """Exit code, or minus the signal, and standard error."""
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                          preexec_fn=limits)
    return done.returncode, done.stderr


def reshape(kept, rng):
    """A copy with a few parts removed or replaced; in a long list one of the first, so that all kinds of parts occur."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        path = rng.choice([p for p in places(kept) if all(isinstance(key, str) or key < 5 for key in p)])
        parent = at(kept, path[:-1])
        if rng.random() < 0.25:
            del parent[path[-1]]
        else:
            parent[path[-1]] = copy.deepcopy(rng.choice(rng.choice((NUMBERS, TEXTS, OTHERS))))
    return kept


def change(folder, rng):
    """Changes one file of the folder."""
    path = folder / rng.choice([f.name for f in sorted(folder.iterdir())] + 8 * ["summary.json"])
    if path.suffix == ".json" and rng.random() < 0.9:
        path.write_text(json.dumps(rng.choice((mutate, reshape, reshape))(json.loads(path.read_text()), rng)))
    elif path.suffix == ".html":  # is written again
        path.unlink()
    else:
        data = path.read_bytes()
        path.write_bytes(mutate_bytes(data, rng) + data[200_000:])


def again(program, data, made, number, seed, scratch):
    """The exit codes of the commands that read a changed folder, and a complaint or None."""
    rng = random.Random(f"{seed}/{number}")
    name = sorted(RUNS)[number % len(RUNS)]
    command, case, options = RUNS[name]
    folder = scratch / str(number)
    shutil.copytree(made / name, folder)
    change(folder, rng)
    readings = [[program, "report", str(folder)]]
    if command != "modal":
        readings.append([program, "compare", str(folder), str(made / name), *rng.choice(([], ["--json"]))])
        if rng.random() < 0.1:
            readings.append([program, command, str(data / case), "-o", str(folder), *options, "--resume"])
    codes = []
    for reading in readings:
        code, words = said(reading)
        codes.append(code)
        lines = [line for line in words.decode(errors="replace").split("\n") if line.startswith("wheeltap: ")]
        why = []
        if code not in (0, 65, 66):
            why.append(f"signal {-code}" if code < 0 else f"exit code {code}")
        elif len(lines) != (code != 0):
            why.append(f"{len(lines)} lines with exit code {code}")
        if any(byte < 32 and byte != 10 or byte == 127 for byte in words):
            why.append("control characters on standard error")
        if why:
            return codes, f"{' '.join(reading[1:])}: {', '.join(why)}: {words.decode(errors='replace')[-200:]}"
    shutil.rmtree(folder)
    return codes, None


def main():
    program, data, count, seed = command_line_of_script()
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="wheeltap-kept-results-"))
    made = scratch / "made"
    codes, faults = {}, 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        runs = {name: pool.submit(subprocess.run, [program, command, str(data / case), "-o", str(made / name), *options],
                                  stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL, check=True)
                for name, (command, case, options) in RUNS.items()}
        for run in runs.values():
            run.result()
        jobs = [pool.submit(again, program, data, made, n, seed, scratch) for n in range(count)]
        for job in concurrent.futures.as_completed(jobs):
            ended, complaint = job.result()
            for code in ended:
                codes[code] = codes.get(code, 0) + 1
            if complaint:
                faults += 1
                print(complaint, flush=True)
    print(f"{count} changes to {len(RUNS)} finished runs: "
          + ", ".join(f"{n} ended with {code}" for code, n in sorted(codes.items()))
          + f"; {faults} faults" + (f", kept in {scratch}" if faults else f", none over {SECONDS} s"))
    if not faults:
        shutil.rmtree(scratch)
    sys.exit(1 if faults else 0)


main()
