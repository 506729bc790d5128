#!/usr/bin/env python3
"""Predictions by external models, and models of Wheeltap on a server.

usage: outside_models.py PROGRAM CASE_A CHECK
"""
import copy
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

from umbridge import Broken, Client, Model, Server

# A steel strip under tension: L = 1 m, 20 x 2 mm, so slender that shear is negligible.
LENGTH, WIDTH, HEIGHT, DENSITY = 1.0, 0.02, 0.002, 7850.0
AREA, INERTIA = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12
TRUTH = {"E": 2.05e11, "N": 40.0}
MODES = 4
SHORT = ["--quiet", "--chains", "2", "--threads", "2", "--warmup", "500", "--draws", "1000"]


def strip(x):
    """f_n of a simply supported beam: (2 pi f)^2 = (n pi/L)^4 EI/(rho A) + (n pi/L)^2 N/(rho A)."""
    e, n = x
    return [math.sqrt((k**4 * e * INERTIA + k**2 * n) / (DENSITY * AREA)) / (2 * math.pi)
            for k in (i * math.pi / LENGTH for i in range(1, MODES + 1))]


def strip_gradient(x, sens):
    slope = [0.0, 0.0]
    for i, f in enumerate(strip(x)):
        k = (i + 1) * math.pi / LENGTH
        rate = sens[i] / (8 * math.pi**2 * f * DENSITY * AREA)
        slope[0] += rate * k**4 * INERTIA
        slope[1] += rate * k**2
    return slope


OFF = [1.001, -0.5e-3 + 1, 1.0005, 0.9992]  # relative errors of measurement
DATA = [f * e for f, e in zip(strip(list(TRUTH.values())), OFF)]

NATIVE = {
    "kind": "update", "title": "A strip under tension",
    "structure": {
        "dimension": 2,
        "materials": {"steel": {"young": "E", "poisson": 0.3, "density": DENSITY}},
        "sections": {"strip": {"shape": "rectangle", "width": WIDTH, "height": HEIGHT}},
        "nodes": {"A": [0, 0], "B": [LENGTH, 0]},
        "members": [{"name": "strip", "nodes": ["A", "B"], "elements": 24, "material": "steel", "section": "strip",
                     "axial_force": "N"}],
        "supports": [{"node": "A", "fix": ["x", "y"]}, {"node": "B", "fix": ["y"]}]},
    "parameters": {"E": {"log_normal": [math.log(2e11), 0.05]}, "N": {"uniform": [0, 100]}},
    "data": {"frequencies": DATA, "cov": 0.001},
}


def outside(predictor):
    case = {key: value for key, value in NATIVE.items() if key != "structure"}
    return {**case, "predictor": predictor}


class Runs:
    def __init__(self, program, folder):
        self.program, self.folder, self.made = program, pathlib.Path(folder), 0

    def case(self, case):
        self.made += 1
        path = self.folder / f"case{self.made}.json"
        path.write_text(json.dumps(case))
        return path

    def run(self, case, *options, out=None, command="update", short=SHORT):
        out = out or self.folder / f"out{self.made}"
        path = case if isinstance(case, pathlib.Path) else self.case(case)
        done = subprocess.run([self.program, command, path, "-o", out, *short, *options], capture_output=True, text=True,
                              timeout=900)
        return done, out

    def summary(self, case, *options, **how):
        done, out = self.run(case, *options, **how)
        assert done.returncode == 0, done.stderr
        return json.loads((out / "summary.json").read_text())

    def fails(self, case, code, *words, options=(), command="update"):
        """Checks that the program ends with the code and with one line that has all the words."""
        done, _ = self.run(case, *options, command=command)
        assert done.returncode == code, (done.returncode, done.stderr)
        lines = done.stderr.strip().splitlines()
        assert len(lines) == 1, lines
        for word in words:
            assert word in lines[0], (word, lines[0])
        return lines[0]


def draws(folder):
    import netCDF4
    with netCDF4.Dataset(folder / "posterior.nc") as file:
        return {name: values[:].tobytes() for name, values in file["posterior"].variables.items()
                if name not in ("chain", "draw")}


def same_posterior(a, b, model="the structure"):
    """Means differ by less than 4.5 standard errors (one false alarm in 10^5), sds by less than half."""
    told = []
    for name, p in a["parameters"][model].items():
        q = b["parameters"][model][name]
        error = math.sqrt(p["sd"]**2 / p["ess_bulk"] + q["sd"]**2 / q["ess_bulk"])
        told.append((name, p["mean"], q["mean"], error))
        assert abs(p["mean"] - q["mean"]) < 4.5 * error, told[-1]
        assert 0.67 < p["sd"] / q["sd"] < 1.5, (name, p["sd"], q["sd"])
    print(told)


class Serving:
    """`wheeltap serve` as a process, after it has printed its address."""

    def __init__(self, program, case, *options):
        self.process = subprocess.Popen([program, "serve", case, "--quiet", *options], stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        assert line.startswith("Serving "), line
        self.url = line.split(" at ")[1].split(" ")[0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        assert self.process.wait(30) == 0


def a_python_server_predicts_the_beam(runs, _):
    native = runs.summary(NATIVE)
    for gradient in (None, strip_gradient):
        with Server({"strip": Model(2, MODES, strip, gradient)}) as server:
            told = runs.summary(outside({"umbridge": server.url}))
            same_posterior(native, told)
            assert told["fit"]["ok"] == native["fit"]["ok"]
            # No request is sent twice.
            assert told["predictor"]["asked"] == server.calls, (told["predictor"], server.calls)
            assert len({tuple(x) for x in server.asked}) == server.calls
            assert (told["predictor"]["gradients"] > 0) == bool(gradient)


def ours_served_gives_the_same_bits(runs, _):
    """The same bits for any number of threads, and the posterior of the native run, whose moves also use curvatures."""
    with Serving(runs.program, runs.case(NATIVE)) as server:
        case, found = outside({"umbridge": server.url}), []
        for threads in ("1", "3"):
            short = [threads if before == "--threads" else word for before, word in zip([""] + SHORT, SHORT)]
            done, served = runs.run(case, short=short)
            assert done.returncode == 0, done.stderr
            found.append(draws(served))
        assert found[0].keys() >= {"E", "N"} and found[0] == found[1]
        same_posterior(runs.summary(NATIVE), runs.summary(case))


def ours_passes_a_client(runs, case_a):
    with Serving(runs.program, runs.case(NATIVE)) as server:
        client = Client(server.url)
        status, info = client.get("/Info")
        assert status == 200 and info["protocolVersion"] == 1.0, info
        assert info["models"] == ["forward", "log_likelihood", "posterior"], info
        assert client.post("/ModelInfo", name="forward") == (200, {"support": {
            "Evaluate": True, "Gradient": True, "ApplyJacobian": False, "ApplyHessian": False}})
        assert client.post("/InputSizes", name="forward", config={}) == (200, {"inputSizes": [2]})
        assert client.post("/OutputSizes", name="forward", config={}) == (200, {"outputSizes": [MODES]})
        assert client.post("/OutputSizes", name="posterior", config={}) == (200, {"outputSizes": [1]})
        x = [1.9e11, 55.0]
        for ours, exact in zip(client.evaluate("forward", x), strip(x)):
            assert abs(ours / exact - 1) < 2e-4, (ours, exact)
        sens = [0.3, -1.0, 0.2, 0.7]
        status, answer = client.post("/Gradient", name="forward", outWrt=0, inWrt=0, input=[x], sens=sens, config={})
        assert status == 200, answer
        for ours, exact in zip(answer["output"], strip_gradient(x, sens)):
            assert abs(ours / exact - 1) < 5e-3, (ours, exact)
        # The density of the data, computed here from the predictions; plus that of the prior.
        density = sum(-0.5 * ((d - f) / (0.001 * d))**2 - math.log(0.001 * d * math.sqrt(2 * math.pi))
                      for d, f in zip(DATA, client.evaluate("forward", x)))
        likelihood, = client.evaluate("log_likelihood", x)
        assert abs(likelihood / density - 1) < 1e-10, (likelihood, density)
        prior = (-0.5 * (math.log(x[0] / 2e11) / 0.05)**2 - math.log(x[0] * 0.05 * math.sqrt(2 * math.pi))
                 - math.log(100))
        posterior, = client.evaluate("posterior", x)
        assert abs(posterior - likelihood - prior) < 1e-8, (posterior, likelihood, prior)
        assert client.evaluate("posterior", [1.9e11, 101.0]) == [-sys.float_info.max]
        for status, kind, path, question in [
                (400, "ModelNotFound", "/Evaluate", {"name": "another", "input": [x]}),
                (400, "InvalidInput", "/Evaluate", {"name": "forward", "input": [[1.0]]}),
                (400, "InvalidInput", "/Evaluate", {"name": "forward", "input": [["a", 1.0]]}),
                (400, "InvalidInput", "/Evaluate", {"name": "forward"}),
                (400, "InvalidInput", "/Gradient", {"name": "forward", "outWrt": 0, "inWrt": 1, "input": [x],
                                                    "sens": sens}),
                (400, "UnsupportedFeature", "/ApplyHessian", {"name": "forward"})]:
            told = client.post(path, **question)
            assert told[0] == status and told[1]["error"]["type"] == kind, (path, question, told)
        deep = "[" * 100_000 + "]" * 100_000
        for question in (f'{{"name": {deep}}}', f'{{"name": "forward", "input": [[{deep}, 1]]}}', deep, " " * (17 << 20)):
            client.connection.request("POST", "/Evaluate", question)
            answer = client.connection.getresponse()
            answer.read()
            assert answer.status in (400, 413), (question[:40], answer.status)
            client.connection.close()
        assert client.evaluate("forward", x)  # and the server continues
    with Serving(runs.program, pathlib.Path(case_a)) as server:
        client = Client(server.url)
        most = json.loads(pathlib.Path(case_a).read_text())["damage"]["count"]["max"]
        assert client.post("/InputSizes", name="forward", config={})[1] == {"inputSizes": [2 * most]}
        intact = client.evaluate("forward", [0.0] * 2 * most)
        one = client.evaluate("forward", [0.305, 0.4] + [0.0] * 2 * (most - 1))
        assert all(f < g for f, g in zip(one, intact)), (one, intact)


def chains_are_served(runs, _):
    """A mass on a spring under a constant force: its motion and likelihood have a closed form."""
    mass, damping, force, sd = 2.0, 1.5, 3.0, 0.001
    times = [0.02 * i for i in range(150)]

    def motion(k):
        omega, zeta = math.sqrt(k / mass), damping / (2 * math.sqrt(k * mass))
        damped = omega * math.sqrt(1 - zeta**2)
        return [force / k * (1 - math.exp(-zeta * omega * t) * (
            math.cos(damped * t) + zeta * omega / damped * math.sin(damped * t))) for t in times]

    measured = [x + 0.001 * math.sin(7 * i) for i, x in enumerate(motion(100.0))]
    lines = [f"{t!r},{force!r},{x!r}" for t, x in zip(times, measured)]
    (runs.folder / "record.csv").write_text("\n".join(["t [s],force [N],x [m]", *lines]) + "\n")
    link = {"between": [0, 1], "stiffness": "k", "damping": damping}
    case = {"kind": "sid", "parameters": {"k": {"uniform": [50, 200]}, "k3": {"uniform": [0, 100]}},
            "record": {"file": "record.csv", "initial": "rest", "channels": [
                {"column": "t", "role": "time"}, {"column": "force", "role": "force", "mass": 1},
                {"column": "x", "role": "response", "mass": 1, "quantity": "displacement"}]},
            "models": [{"name": "linear", "masses": [mass], "noise": sd, "links": [link]},
                       {"name": "duffing", "masses": [mass], "noise": sd, "links": [{**link, "cubic": "k3"}]}]}
    with Serving(runs.program, runs.case(case)) as server:
        client = Client(server.url)
        for k in (100.0, 77.7):
            told = client.evaluate("forward linear", [k])
            wanted = motion(k)
            assert len(told) == len(times)
            assert max(abs(a - b) for a, b in zip(told, wanted)) < 1e-9 * force / k, k
            likelihood, = client.evaluate("log_likelihood linear", [k])
            density = sum(-0.5 * ((y - x) / sd)**2 - math.log(sd * math.sqrt(2 * math.pi))
                          for x, y in zip(wanted, measured))
            assert abs(likelihood / density - 1) < 1e-6, (likelihood, density)
            posterior, = client.evaluate("posterior linear", [k])
            assert abs(posterior - likelihood + math.log(150)) < 1e-8, (posterior, likelihood)
        stiffer = client.evaluate("forward duffing", [100.0, 90.0])
        assert stiffer != client.evaluate("forward linear", [100.0])
        limp = client.evaluate("forward duffing", [100.0, 0.0])
        assert max(abs(a - b) for a, b in zip(limp, motion(100.0))) < 1e-5
        # Responses of two records follow each other, and their likelihoods add up.
        alone = client.evaluate("forward linear", [90.0]), client.evaluate("log_likelihood linear", [90.0])[0]
        twice = {**case, "records": [case["record"], case["record"]]}
        del twice["record"]
        with Serving(runs.program, runs.case(twice)) as both:
            assert Client(both.url).evaluate("forward linear", [90.0]) == alone[0] * 2
            assert abs(Client(both.url).evaluate("log_likelihood linear", [90.0])[0] / (2 * alone[1]) - 1) < 1e-12
        # The server chooses an unspecified order like a run: these residuals are a sine.
        with Serving(runs.program, runs.case({**case, "residuals": {"ar": "auto"}})) as coloured:
            inputs, = Client(coloured.url).post("/InputSizes", name="log_likelihood linear", config={})[1]["inputSizes"]
            assert inputs > 1, inputs
        status, answer = client.post("/Evaluate", name="forward linear", input=[[-4.0e9]])
        assert status in (400, 500) and "is unbounded with these parameters" in answer["error"]["message"], (status, answer)


def a_damage_is_found_by_a_served_beam(runs, case_a):
    options = ["--quiet", "--chains", "2", "--threads", "2", "--warmup", "2000", "--draws", "2000"]
    native = json.loads(pathlib.Path(case_a).read_text())
    native["predictor"] = "fe"
    native["damage"]["count"]["max"] = 1
    mine = runs.summary(native, command="damage", short=options)
    with Serving(runs.program, runs.case(native)) as server:
        told = runs.summary({**native, "predictor": {"umbridge": server.url}}, command="damage", short=options)
    assert told["predictor"]["inputs"] == ["location[1]", "reduction[1]"]
    for a, b in zip(mine["models"], told["models"]):
        assert abs(a["probability"] - b["probability"]) < 4.5 * math.hypot(a["mcse"], b["mcse"]) + 1e-6, (a, b)
    # The shares of a place and its mirror image, which frequencies cannot distinguish, may differ.
    a, b = (run["parameters"]["1 damage"]["reduction[1]"] for run in (mine, told))
    error = math.sqrt(a["sd"]**2 / a["ess_bulk"] + b["sd"]**2 / b["ess_bulk"])
    print(a["mean"], b["mean"], error)
    assert abs(a["mean"] - b["mean"]) < 4.5 * error


def an_emulator_in_front_of_a_beam(runs, case_a):
    """An emulator trained on a served beam equals one trained on Wheeltap's beam, bit for bit; only training calls it."""
    native = json.loads(pathlib.Path(case_a).with_name("case-a-table.json").read_text())
    native["damage"]["count"]["max"] = 1
    front = {**native["predictor"], "sites": native["predictor"]["sites"][0], "holdout": 60}
    # The beam of the case is a different one and has no effect.
    softer = copy.deepcopy(native)
    softer["beam"]["material"]["young"] = 6e10
    with Serving(runs.program, runs.case({**softer, "predictor": "fe"})) as server:
        measured = {"frequencies": Client(server.url).evaluate("forward", [0.09, 0.3]), "cov": 0.001}
        for one in native, softer:
            one["data"] = measured
            del one["damage"]["truth"]
        done, mine = runs.run({**softer, "predictor": {**front, "symmetrise": False}}, command="damage")
        assert done.returncode == 0, done.stderr
        case = {**native, "predictor": {"umbridge": server.url, "emulator": front}}
        done, other = runs.run(case, command="damage")
        assert done.returncode == 0, done.stderr
        told = json.loads((other / "summary.json").read_text())
        assert draws(mine) == draws(other)
        a, b = (json.loads((out / "summary.json").read_text())["emulator"] for out in (mine, other))
        assert a["counts"] == b["counts"], (a, b)
        # 10 sites x 4 levels, 60 validation runs, the intact beam, and 50 checked draws.
        assert 100 < told["predictor"]["asked"] <= 40 + 60 + 1 + 60, told["predictor"]
        for wrong, words in (({"table": "x.nc"}, "Wheeltap's beam model"), ({**front, "symmetrise": True}, "symmetric"),
                             ({"runs": 40}, "runs")):
            runs.fails({**case, "predictor": {"umbridge": server.url, "emulator": wrong}}, 65, "/predictor/emulator", words,
                       command="damage")
        table = subprocess.run([runs.program, "table", runs.case(case), "-o", runs.folder / "t.nc"], capture_output=True,
                               text=True)
        assert table.returncode == 65 and "Wheeltap's beam model" in table.stderr, table.stderr
    # A server that is gone ends it with one line.
    runs.fails({**case, "predictor": {**case["predictor"], "retries": 0}}, 66, "/predictor", "no server listens",
               command="damage")


PROGRAM = """#!/usr/bin/env python3
import json, math, sys
asked = json.load(open(sys.argv[1]))
json.dump(model([asked["E"], asked["N"]]), open(sys.argv[2], "w"))
"""
NUMBERS = """#!/usr/bin/env python3
import sys
n, e = (float(line) for line in open(sys.argv[1]))
open(sys.argv[2], "w").write(" ".join(map(repr, model([e, n]))))
"""


def write_program(path, text, model="strip"):
    """Writes a program with the strip of this file, or another model."""
    here = pathlib.Path(__file__).read_text()
    source = here[here.index("# A steel strip"):here.index("def strip_gradient")]
    path.write_text(text.replace("\nimport ", "\nimport math, ", 1).replace("\nasked", f"\n{source}\nmodel = {model}\nasked")
                    .replace("\nn, e", f"\n{source}\nmodel = {model}\nn, e"))
    path.chmod(0o755)


FRONT = {"runs": 30, "holdout": 8}


def programs_predict(runs, _):
    write_program(runs.folder / "model", PROGRAM)
    write_program(runs.folder / "numbers", NUMBERS)
    named = {"command": "./model {in} {out}", "emulator": FRONT}
    line = runs.fails(outside(named), 64, "/predictor/command", "--allow-commands")
    assert "./model" in line
    found = []
    scratch = runs.folder / "scratch"
    scratch.mkdir()
    os.environ["TMPDIR"] = str(scratch)
    for predictor in [named, {"command": [str(runs.folder / "numbers"), "{in}", "{out}"], "format": "numbers",
                              "inputs": ["N", "E"], "emulator": FRONT}]:
        told = runs.summary(outside(predictor), "--allow-commands")
        assert told["predictor"]["asked"] == 38
        found.append(draws(runs.folder / f"out{runs.made - 1}"))
    left = os.listdir(scratch)
    assert not left, left
    with Server({"strip": Model(2, MODES, strip)}) as server:
        runs.summary(outside({"umbridge": server.url, "emulator": FRONT}))
        found.append(draws(runs.folder / f"out{runs.made - 1}"))
    assert found[0] == found[1] == found[2]


def an_emulator_in_front(runs, _):
    native = runs.summary(NATIVE)
    with Server({"strip": Model(2, MODES, strip)}) as server:
        told = runs.summary(outside({"umbridge": server.url, "emulator": {}}))
        assert server.calls == 50  # 40 to train it, 10 to measure it
    same_posterior(native, told)
    emulator = told["predictor"]["emulator"]
    print(emulator)
    assert emulator["runs"] == 40 and emulator["fresh_runs"] == 10
    assert all(mode["q2"] > 0.99 for mode in emulator["modes"]), emulator
    # A bad emulator causes a warning, and its error widens the posterior.
    with Server({"strip": Model(2, MODES, lambda x: [f * (1 + 0.01 * math.sin(40 * x[1])) for f in strip(x)])}) as server:
        rough = runs.summary(outside({"umbridge": server.url, "emulator": {}}))
    print(rough["predictor"]["emulator"])
    a, b = (run["parameters"]["the structure"]["E"]["sd"] for run in (native, rough))
    assert b > 2 * a, (a, b)


def failing_programs_are_named(runs, _):
    def program(text):
        path = runs.folder / "bad"
        path.write_text("#!/usr/bin/env python3\nimport json, sys, time\n" + text)
        path.chmod(0o755)

    def fails(*words, **keys):
        runs.fails(outside({"command": "./bad {in} {out}", "retries": 0, **keys}), 65, "/predictor", *words,
                   options=["--allow-commands"])

    out = 'json.dump({}, open(sys.argv[2], "w"))'
    program('sys.exit("no licence")')
    fails("exit code 1", "no licence", "its files are in")
    fails("exit code 1", "3 times", retries=2)
    program("pass")
    fails("wrote no predictions")
    program(out.format("[1.0, 2.0]"))
    fails("2 predictions, must be 4")
    program(out.format('[1.0, 2.0, float("nan"), 4.0]'))
    fails("not finite")
    program('open(sys.argv[2], "w").write("[" * 100_000 + "]" * 100_000)')
    fails("invalid JSON")
    program('open(sys.argv[2], "w").write(" " * (17 << 20))')
    fails("17825792 bytes", "16777216")
    program('open(sys.argv[2], "w").write("1 2 nan 4")')
    fails("prediction 3 is nan", format="numbers")
    program('open(sys.argv[2], "w").write("1 2 three 4")')
    fails("three", "not a number", format="numbers")
    program("time.sleep(600)")
    began = time.monotonic()
    fails("longer than 0.3 s", timeout=0.3)
    assert time.monotonic() - began < 60
    program("import os; os.kill(os.getpid(), 9)")
    fails("signal 9")
    runs.fails(outside({"command": "./missing {in} {out}"}), 65, "missing", "does not exist", options=["--allow-commands"])
    runs.fails(outside({"command": "./bad {in}"}), 65, "/predictor/command", "{out}")
    runs.fails(outside({"command": "./bad {in} {out}", "modle": 1}), 65, "/predictor/modle")


def a_stop_is_heard_before_anything_is_possible(runs, _):
    """If every point of the prior is impossible, a run tries a hundred thousand points, for hours with a program."""
    path = runs.folder / "bad"
    path.write_text("#!/usr/bin/env python3\nimport os, pathlib, signal, sys\n"
                    f"calls = pathlib.Path({str(runs.folder / 'calls')!r})\n"
                    "calls.open('a').write('x')\n"
                    "if len(calls.read_text()) == 30: os.kill(os.getppid(), signal.SIGTERM)\n"
                    "open(sys.argv[2], 'w').write('[-1, -1, -1, -1]')\n")
    path.chmod(0o755)
    done, out = runs.run(outside({"command": "./bad {in} {out}"}), "--allow-commands")
    assert done.returncode == 130, (done.returncode, done.stderr)
    assert done.stderr.startswith("wheeltap: stopped before the first results"), done.stderr
    assert not list(out.glob("*.part*")), list(out.iterdir())


def failing_servers_are_named(runs, _):
    with Server({"strip": Model(2, MODES, strip)}) as server:
        gone = server.url
        runs.fails(outside({"umbridge": gone, "model": "another"}), 65, "no model", "another", "strip")
    runs.fails(outside({"umbridge": gone, "retries": 1}), 66, "/predictor", gone, "no server listens", "2 times")
    runs.fails(outside({"umbridge": "ftp://here"}), 65, "/predictor/umbridge")

    def fails(model, code, *words, **keys):
        with Server({"strip": model}) as server:
            runs.fails(outside({"umbridge": server.url, "retries": 0, **keys}), code, "/predictor", *words)

    def raising(broken):
        def answer(_):
            raise broken
        return answer

    fails(Model(3, MODES, strip), 65, "has 3 inputs", "the case has 2")
    fails(Model(2, 3, strip), 65, "has 3 outputs", "the case has 4")
    fails(Model(2, MODES, lambda x: strip(x)[:3]), 65, "3 numbers", "must be 4")
    fails(Model(2, MODES, lambda x: [1.0, math.nan, 2.0, 3.0]), 65, "not finite")
    fails(Model(2, MODES, lambda x: [1.0, None, 2.0, 3.0]), 65, "null", "finite number")
    fails(Model(2, MODES, raising(Broken(text="<html>"))), 65, "invalid JSON")
    fails(Model(2, MODES, raising(Broken(text="[" * 100_000 + "]" * 100_000))), 65, "invalid JSON")
    fails(Model(2, MODES, raising(Broken(text=" " * (17 << 20)))), 65, "more than 16777216 bytes")
    fails(Model(2, MODES, raising(Broken(endless=True))), 66, "no answer in 0.3 s", timeout=0.3)
    fails(Model(2, MODES, raising(Broken(status=400))), 65, "HTTP 400", "broken")
    fails(Model(2, MODES, raising(Broken(status=500))), 66, "HTTP 500", "broken")
    fails(Model(2, MODES, raising(ConnectionAbortedError())), 66, "connection broke")
    never = threading.Event()
    fails(Model(2, MODES, lambda x: never.wait(600)), 66, "no answer in 0.3 s", timeout=0.3)

    # A server that fails temporarily costs only time.
    stumbles = iter([500, 503])

    def stumbling(x):
        status = next(stumbles, None)
        if status:
            raise Broken(status=status)
        return strip(x)

    with Server({"strip": Model(2, MODES, stumbling)}) as server:
        runs.summary(outside({"umbridge": server.url, "emulator": FRONT}))
    assert next(stumbles, None) is None


def a_killed_server_costs_nothing(runs, _):
    with Server({"strip": Model(2, MODES, strip)}) as server:
        path = runs.case(outside({"umbridge": server.url, "retries": 0}))
        whole = runs.run(path, out=runs.folder / "whole")
        assert whole[0].returncode == 0, whole[0].stderr
        all_calls, port = server.calls, server.port
    last = all_calls // 2

    def dying(x):
        if server.calls > last:
            raise ConnectionAbortedError
        return strip(x)

    out = runs.folder / "killed"
    with Server({"strip": Model(2, MODES, dying)}, port) as server:
        done, _ = runs.run(path, out=out)
    kept = re.search(r"(\d+) results are stored", done.stderr)
    assert done.returncode == 66 and kept, (done.returncode, done.stderr)
    assert last - 2 <= int(kept[1]) <= last, (kept[1], last)  # one answer may still be in progress
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert not (out / "summary.json").exists()
    with Server({"strip": Model(2, MODES, strip)}, port) as server:
        done, _ = runs.run(path, "--resume", out=out)
        assert done.returncode == 0, done.stderr
        print(all_calls, last, server.calls)
        assert server.calls == all_calls - last
    assert draws(out) == draws(runs.folder / "whole")
    told = json.loads((out / "summary.json").read_text())["predictor"]
    assert told["remembered"] == last and told["asked"] == all_calls - last
    # A user's file outlives cases: with other data, the run requests only missing answers.
    with Server({"strip": Model(2, MODES, strip)}) as server:
        case = outside({"umbridge": server.url, "memory": "answers", "emulator": FRONT})
        runs.summary(case)
        first = server.calls
        case["data"] = {"frequencies": [f * 1.001 for f in DATA], "cov": 0.002}
        runs.summary(case)
        assert first == server.calls == 38, (first, server.calls)


CHECKS = [a_python_server_predicts_the_beam, ours_served_gives_the_same_bits, ours_passes_a_client, chains_are_served,
          a_damage_is_found_by_a_served_beam, an_emulator_in_front_of_a_beam, programs_predict, an_emulator_in_front, failing_programs_are_named,
          failing_servers_are_named, a_stop_is_heard_before_anything_is_possible, a_killed_server_costs_nothing]

if __name__ == "__main__":
    program, case_a, name = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        next(check for check in CHECKS if check.__name__ == name)(Runs(program, folder), case_a)
