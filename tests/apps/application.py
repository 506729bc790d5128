#!/usr/bin/env python3
"""The server of wheeltap app: who may ask, which files it serves, and its runs.

usage: application.py PROGRAM [CHECK …]
"""
import http.client
import json
import math
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse

PROGRAM = os.path.abspath(sys.argv[1])
HOSTILE = "<img src=x onerror=alert(1)>\u202e \"quoted\" 'ticks' \u0636\u0631\u0631"


class App:
    """The program, serving a folder, until the end of the with block."""

    def __init__(self, folder, *options):
        self.process = subprocess.Popen([PROGRAM, "app", str(folder), "--threads", "1", *options],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for line in self.process.stdout:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/", line)
            if found:
                self.port, self.token = int(found[1]), found[2]
                break
        else:
            raise AssertionError("no address: " + self.process.stderr.read())
        self.base = f"/{self.token}/"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            assert self.process.wait(20) == 0, self.process.returncode
        finally:
            self.process.kill()
            self.process.stdout.close()
            self.process.stderr.close()

    def ask(self, path, body=None, headers=None, method=None, host=None):
        """Status, headers and text of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        method = method or ("GET" if body is None else "POST")
        connection.putrequest(method, path, skip_host=True)
        sent = {"Host": host or f"127.0.0.1:{self.port}"}
        data = None
        if body is not None:
            data = body if isinstance(body, bytes) else json.dumps(body).encode()
            sent |= {"Content-Type": "application/json", "Content-Length": str(len(data))}
        for key, value in (sent | (headers or {})).items():
            connection.putheader(key, value)
        connection.endheaders()
        if data:
            try:
                connection.send(data)
            except OSError:  # the server closes before the end of a body that is too long
                pass
        try:
            answer = connection.getresponse()
        except ConnectionError:  # closed before the end of the body
            return 0, {}, ""
        text = answer.read().decode(errors="replace")
        connection.close()
        return answer.status, answer.headers, text

    def get(self, what, status=200, **parameters):
        found, _, text = self.ask(f"{self.base}api/{what}?{urllib.parse.urlencode(parameters)}")
        assert found == status, (found, text)
        return json.loads(text)

    def post(self, what, body, status=200):
        found, _, text = self.ask(f"{self.base}api/{what}", body)
        assert found == status, (found, text)
        return json.loads(text)

    def wait(self, number, *states):
        for _ in range(600):
            run = next(r for r in self.get("runs")["runs"] if r["number"] == number)
            if run["state"] in states:
                return run
            time.sleep(0.1)
        raise AssertionError(run)

    def is_alive(self):
        assert self.get("projects")["cases"] is not None
        assert self.process.poll() is None


def damage_case(**keys):
    return {"kind": "damage", "title": "A beam",
            "beam": {"length": 1.0, "elements": 20, "supports": "simply-supported",
                     "material": {"young": 70e9, "poisson": 0.3, "density": 2700},
                     "section": {"shape": "rectangle", "width": 0.025, "height": 0.006}},
            "data": {"frequencies": [13.85, 55.4, 124.6], "cov": 0.001},
            "damage": {"count": {"min": 0, "max": 1, "prior": "uniform"}, "location": {"uniform": [0, 1]},
                       "reduction": {"uniform": [0, 0.6]}}, **keys}


def folder_with_case(root, name="beam.json", case=None):
    folder = pathlib.Path(root, "cases")
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(json.dumps(case or damage_case()))
    return folder


# ---------------------------------------------------------------- access


def only_the_token_opens_it(root):
    with App(folder_with_case(root)) as app, App(folder_with_case(root)) as other:
        assert app.token != other.token
        assert app.ask(app.base)[0] == 200
        wrong = app.token[:-1] + ("0" if app.token[-1] != "0" else "1")
        for path in ("/", "/api/projects", f"/{wrong}/", f"/{wrong}/api/projects", f"/{app.token}x/", f"/{other.token}/",
                     f"//{app.token}/", "/app.js", f"/{app.token[:16]}/api/projects"):
            status, _, text = app.ask(path)
            assert status == 403 and app.token not in text, (path, status)
            assert app.ask(path.rstrip("/") + "/api/save", {"name": "a.json", "text": "{}"})[0] in (403, 404), path
        # Only the loopback address listens.
        with open("/proc/net/tcp", encoding="ascii") as table:
            listening = [line.split()[1] for line in table if line.split()[3] == "0A"]
        assert [a for a in listening if a.endswith(f":{app.port:04X}")] == [f"0100007F:{app.port:04X}"]


def other_sites_are_rejected(root):
    with App(folder_with_case(root)) as app:
        page = app.base + "api/projects"
        for origin in ("http://evil.example", "null", f"https://127.0.0.1:{app.port}", "http://127.0.0.1", f"http://127.0.0.1:{app.port}.evil.example",
                       f"http://localhost:{app.port + 1}"):
            assert app.ask(page, headers={"Origin": origin})[0] == 403, origin
        for site in ("cross-site", "same-site"):
            assert app.ask(page, headers={"Sec-Fetch-Site": site})[0] == 403, site
        for host in ("evil.example", f"evil.example:{app.port}", "127.0.0.1", f"127.0.0.1:{app.port}.evil.example", f"[::1]:{app.port}"):
            assert app.ask(page, host=host)[0] == 403, host
        for good in ({"Origin": f"http://127.0.0.1:{app.port}"}, {"Sec-Fetch-Site": "same-origin"}, {"Sec-Fetch-Site": "none"}):
            assert app.ask(page, headers=good)[0] == 200, good
        assert app.ask(page, host=f"localhost:{app.port}")[0] == 200
        # A form of another page can send these types without asking first.
        for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", ""):
            status = app.ask(app.base + "api/save", {"name": "new.json", "text": "{}"}, headers={"Content-Type": kind})[0]
            assert status == 415, (kind, status)
        assert not pathlib.Path(root, "cases/new.json").exists()
        for method in ("PUT", "DELETE", "OPTIONS", "PATCH", "HEAD"):
            assert app.ask(page, method=method)[0] == 405, method


def answers_have_strict_headers(root):
    folder = folder_with_case(root)
    (folder / "r").mkdir()
    (folder / "r/report.html").write_text("<script>1</script>")
    with App(folder) as app:
        for path in (app.base, app.base + "app.js", app.base + "api/projects", "/", app.base + "nothing"):
            headers = app.ask(path)[1]
            policy = headers["Content-Security-Policy"]
            assert "default-src 'none'" in policy and "unsafe" not in policy and "frame-ancestors 'none'" in policy, path
            assert headers["X-Content-Type-Options"] == "nosniff" and headers["Referrer-Policy"] == "no-referrer", path
            assert headers["Cross-Origin-Resource-Policy"] == "same-origin" and headers["Cache-Control"] == "no-store", path
            assert "Access-Control-Allow-Origin" not in headers, path
        # A report runs its scripts in a sandbox, without the token of the application.
        reports = app.get("projects")["reports"]
        assert app.token not in reports
        status, headers, text = app.ask(reports + "r/report.html")
        assert status == 200 and text == "<script>1</script>"
        assert len(headers.get_all("Content-Security-Policy")) == 1
        assert headers["Content-Security-Policy"].startswith("sandbox allow-scripts")
        assert "allow-same-origin" not in headers["Content-Security-Policy"]
        for path in ("api/projects", "api/case?name=beam.json", "beam.json", "../beam.json", ""):
            assert app.ask(reports + path)[0] in (403, 404), path
        assert app.ask(reports + "api/save", {"name": "new.json", "text": "{}"})[0] == 404


# ------------------------------------------------------------------ files


def files_are_below_the_folder_only(root):
    secret = pathlib.Path(root, "secret.json")
    secret.write_text('{"kind": "damage", "title": "secret"}')
    folder = folder_with_case(root)
    (folder / "link.json").symlink_to(secret)
    (folder / "up").symlink_to(root)
    (folder / ".hidden.json").write_text(secret.read_text())
    (folder / "sub").mkdir()
    (folder / "sub/inside.json").symlink_to(folder / "beam.json")
    pathlib.Path(root, "cases-beside").mkdir()
    pathlib.Path(root, "cases-beside/secret.json").write_text(secret.read_text())
    names = ["../secret.json", "sub/../../secret.json", "./../secret.json", str(secret), "link.json", "up/secret.json", ".hidden.json",
             "..", ".", "/", "", "sub//../beam.json", "../cases-beside/secret.json", "beam.json\0.json", "beam.json\n", "a" * 2000 + ".json",
             "..\\secret.json", "/etc/passwd", "up/cases-beside/secret.json"]
    with App(folder) as app:
        for name in names:
            for what in ("case", "result", "record", "window"):
                status, _, text = app.ask(f"{app.base}api/{what}?{urllib.parse.urlencode({'name': name})}")
                assert status in (400, 403, 404) and "secret" not in text.replace("secret.json", ""), (what, name, status, text)
            before = secret.read_text()
            for what, body in (("save", {"name": name, "text": "{}", "before": None}), ("check", {"name": name, "text": "{}"}),
                               ("copy", {"name": name, "to": "copy.json"}), ("copy", {"name": "beam.json", "to": name}),
                               ("run", {"name": name}), ("start", {"kind": "damage", "structure": "beam", "folder": name})):
                status, _, text = app.ask(f"{app.base}api/{what}", body)
                assert status in (400, 403, 404, 409), (what, name, status, text)
            assert secret.read_text() == before
        # Encoded once or twice, in the path and in the parameter.
        for path in ("..%2fsecret.json", "%2e%2e/secret.json", "%2e%2e%2fsecret.json", "..%252fsecret.json", "..%c0%afsecret.json",
                     "sub/%2e%2e/%2e%2e/secret.json", "%00", "beam.json%00", "up%2fsecret.json"):
            assert app.ask(f"{app.base}api/case?name={path}")[0] in (400, 403, 404), path
            for base in (app.base, app.get("projects")["reports"]):
                status, _, text = app.ask(base + path)
                assert status in (400, 403, 404) and "secret" not in text.replace("secret.json", ""), (base, path, status)
        listed = json.dumps(app.get("projects"))
        assert "secret" not in listed and "hidden" not in listed and "link.json" not in listed
        assert app.get("case", name="beam.json")["text"].startswith("{")
        # A case may not name an input outside the folder either.
        pathlib.Path(root, "outside.csv").write_text("1.0\n2.0\n")
        for name in ("../outside.csv", str(pathlib.Path(root, "outside.csv")), "up/outside.csv"):
            case = damage_case(data={"file": name, "cov": 0.01})
            answer = app.post("check", {"name": "beam.json", "text": json.dumps(case)})
            assert not answer["valid"] and answer["pointer"] == "/data/file" and "outside the folder" in answer["reason"], answer
        app.is_alive()


def other_files_are_not_replaced(root):
    folder = folder_with_case(root)
    (folder / "notes.json").write_text('{"mine": 1}')
    (folder / "text.txt").write_text("mine")
    with App(folder) as app:
        version = app.get("case", name="notes.json")["version"]
        app.post("save", {"name": "notes.json", "text": "{}", "before": version}, 403)
        app.post("save", {"name": "text.txt", "text": "{}", "before": None}, 400)
        app.post("save", {"name": "beam.json", "text": "{}", "before": None}, 409)
        version = app.get("case", name="beam.json")["version"]
        (folder / "beam.json").write_text(json.dumps(damage_case(title="Edited elsewhere")))
        app.post("save", {"name": "beam.json", "text": "{}", "before": version}, 409)
        assert "Edited elsewhere" in (folder / "beam.json").read_text()
        version = app.get("case", name="beam.json")["version"]
        app.post("save", {"name": "beam.json", "text": '{"kind": "damage"}', "before": version})
        assert (folder / "beam.json").read_text() == '{"kind": "damage"}'
        app.post("copy", {"name": "beam.json", "to": "second.json"})
        app.post("copy", {"name": "beam.json", "to": "second.json"}, 409)
        app.post("copy", {"name": "beam.json", "to": "other/second.json"}, 400)


# ----------------------------------------------------------------- limits


def oversized_and_malformed_requests_are_rejected(root):
    with App(folder_with_case(root)) as app:
        status = app.ask(app.base + "api/check", b"[" * (9 << 20))[0]
        assert status in (413, 0), status
        for body in (b"", b"{", b"[]", b"null", b"\xff\xfe", b'{"name": 1}', b'{"name": "a.json"}', b'{"name": "a.json", "text": 5}',
                     b"[" * 100000, b'{"name": null, "text": null}', b"\0" * 100):
            for what in ("check", "save", "start", "copy", "drawing", "run", "stop"):
                status, _, text = app.ask(f"{app.base}api/{what}", body)
                assert status == 400 and "error" in json.loads(text), (what, body[:20], status, text)
        status = app.ask(app.base + "api/case?name=" + "a" * 6000)[0]
        assert status in (400, 414), status
        for query in ("window?name=beam.json", "window?name=none.csv", "checks?name=none.csv", "checks", "record?name=beam.json", "spectrum", "schema?kind=nothing", "schema", "case",
                      "result?name=beam.json&file=../beam.json", "result?name=.&file=beam.json", "outline", "outline?name=beam.json", "nothing", ""):
            assert app.ask(f"{app.base}api/{query}")[0] in (400, 403, 404), query
        for deep in ("[" * 3000 + "]" * 3000, '{"kind": ' * 200 + "1" + "}" * 200, "{" * 50000):
            answer = app.post("check", {"name": "beam.json", "text": deep})
            assert not answer["valid"], deep[:20]
        for raw in (b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * 100000 + b"\r\n\r\n", b"\0\1\2\3\r\n\r\n", b"GET\r\n\r\n",
                    b"POST /" + app.token.encode() + b"/api/check HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n" % app.port
                    + b"Content-Type: application/json\r\nContent-Length: 99999999999999999999\r\n\r\n{}",
                    b"GET /" + b"%" * 3000 + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"):
            with socket.create_connection(("127.0.0.1", app.port), 10) as connection:
                connection.sendall(raw)
                connection.shutdown(socket.SHUT_WR)
                try:
                    assert b" 200 " not in connection.recv(200)
                except ConnectionResetError:
                    pass
        app.is_alive()


def slow_connections_do_not_block_it(root):
    with App(folder_with_case(root)) as app:
        slow = [socket.create_connection(("127.0.0.1", app.port), 10) for _ in range(100)]
        for connection in slow:
            try:
                connection.sendall(b"GET /")
            except OSError:
                pass
        app.is_alive()
        for connection in slow:
            connection.close()
        app.is_alive()


def hostile_names_are_text(root):
    folder = folder_with_case(root, "<script>alert(1)<x>.json", damage_case(title=HOSTILE))
    (folder / "beam.json").write_text(json.dumps(damage_case(title="\x1b[31mred\x07")))
    with App(folder) as app:
        cases = {c["name"]: c for c in app.get("projects")["cases"]}
        assert "<img src=x" in cases["<script>alert(1)<x>.json"]["title"]
        assert "\x1b" not in cases["beam.json"]["title"] and "\x07" not in cases["beam.json"]["title"]
        _, headers, _ = app.ask(app.base + "api/projects")
        assert headers["Content-Type"] == "application/json"
        answer = app.post("check", {"name": "beam.json", "text": json.dumps(damage_case(**{"<b>bad</b>": 1}))})
        assert answer["pointer"] == "/<b>bad<~1b>" and "unknown key" in answer["reason"], answer


# ------------------------------------------------------------- cases, runs


def checks_are_those_of_the_program(root):
    with App(folder_with_case(root)) as app:
        good = damage_case()
        assert app.post("check", {"name": "beam.json", "text": json.dumps(good)}) == {"valid": True}
        good["beam"]["material"]["poisson"] = 0.7
        text = json.dumps(good)
        answer = app.post("check", {"name": "beam.json", "text": text})
        pathlib.Path(root, "cases/bad.json").write_text(text)
        said = subprocess.run([PROGRAM, "damage", str(pathlib.Path(root, "cases/bad.json")), "--dry-run"], capture_output=True, text=True)
        assert said.returncode == 65
        assert answer["pointer"] == "/beam/material/poisson" and said.stderr.rstrip().endswith(answer["reason"]), (answer, said.stderr)
        answer = app.post("check", {"name": "beam.json", "text": '{"kind": "damage",,}'})
        assert answer["pointer"] == "/" and ":1:19:" in answer["reason"], answer
        # Every starter case is valid where it was written.
        for i, starter in enumerate(app.get("projects")["starters"]):
            name = app.post("start", {**starter, "folder": f"starter {i}"})["name"]
            text = app.get("case", name=name)["text"]
            assert app.post("check", {"name": name, "text": text}) == {"valid": True}, name
        states = {c["name"]: c["state"] for c in app.get("projects")["cases"]}
        assert states.pop("bad.json") == "draft" and set(states.values()) == {"ready"}, states


def a_run_gives_the_bits_of_the_command_line(root):
    folder = folder_with_case(root)
    with App(folder) as app:
        number = app.post("run", {"name": "beam.json", "seed": 7, "quick": True})["number"]
        app.post("run", {"name": "beam.json"}, 409)  # its folder is in use
        assert app.wait(number, "done", "failed")["state"] == "done"
        subprocess.run([PROGRAM, "damage", str(folder / "beam.json"), "-o", root + "/again", "--seed", "7", "--quick", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        by_app, by_hand = (json.loads(pathlib.Path(p, "summary.json").read_text()) for p in (folder / "beam-results", root + "/again"))
        assert by_app["models"] == by_hand["models"] and by_app["parameters"] == by_hand["parameters"]
        case = app.get("projects")["cases"][0]
        assert case["result"] == "beam-results" and case["state"] in ("converged", "not-converged"), case
        assert app.get("result", name="beam-results")["models"] == by_app["models"]
        assert app.ask(app.get("projects")["reports"] + "beam-results/report.html")[0] == 200
        version = app.get("case", name="beam.json")["version"]
        app.post("save", {"name": "beam.json", "text": json.dumps(damage_case(title="Changed")), "before": version})
        assert app.get("projects")["cases"][0]["state"] == "changed"
        bad = damage_case(data={"frequencies": [], "cov": 0.001})
        version = app.get("case", name="beam.json")["version"]
        app.post("save", {"name": "beam.json", "text": json.dumps(bad), "before": version})
        assert "/data/frequencies" in app.post("run", {"name": "beam.json"}, 400)["error"]


def commands_of_a_case_do_not_run(root):
    case = damage_case(predictor={"command": f"touch {root}/ran"})
    with App(folder_with_case(root, case=case)) as app:
        app.post("run", {"name": "beam.json"}, 400)
        assert not pathlib.Path(root, "ran").exists()


def a_killed_server_leaves_a_checkpoint(root):
    folder = folder_with_case(root, case=damage_case(damage={
        "count": {"min": 0, "max": 3, "prior": "uniform"}, "location": {"uniform": [0, 1]}, "reduction": {"uniform": [0, 0.6]}}))
    app = App(folder)
    number = app.post("run", {"name": "beam.json"})["number"]
    for _ in range(600):
        if (folder / "beam-results/checkpoint.nc").exists():
            break
        run = next(r for r in app.get("runs")["runs"] if r["number"] == number)
        assert run["state"] in ("queued", "running"), run
        time.sleep(0.1)
    assert app.get("runs")["runs"][0]["stage"]
    app.process.kill()
    app.process.wait()
    app.process.stdout.close()
    app.process.stderr.close()
    with App(folder) as again:
        for _ in range(100):  # the system kills the run with its server
            if again.get("projects")["cases"][0]["state"] == "interrupted":
                break
            time.sleep(0.1)
        assert again.get("projects")["cases"][0]["state"] == "interrupted"
        number = again.post("run", {"name": "beam.json", "resume": True})["number"]
        again.wait(number, "running")
        for _ in range(100):
            run = next(r for r in again.get("runs")["runs"] if r["number"] == number)
            if run["stage"] or run["state"] != "running":
                break
            time.sleep(0.1)
        again.post("stop", {"number": number})
        assert again.wait(number, "stopped", "done", "failed")["state"] in ("stopped", "done")
        waiting = again.post("run", {"name": "beam.json", "resume": True})["number"]
        assert again.get("runs")["runs"][-1]["number"] == waiting


def records_are_decimated_on_the_server(root):
    folder = folder_with_case(root)
    values = [((i * 7919) % 1009) / 100 for i in range(5000)]
    values[3333] = 1e3  # one sample
    (folder / "record.csv").write_text("time [s],a [m/s^2]\n" + "".join(f"{i / 100},{v}\n" for i, v in enumerate(values)))
    with App(folder) as app:
        assert [r["name"] for r in app.get("projects")["records"]] == ["record.csv"]
        table = app.get("record", name="record.csv")["tables"][0]
        assert table["rows"] == 5000 and abs(table["sample_rate_hz"] - 100) < 1e-6 and table["channels"][0]["unit"] == "m/s^2" and table["channels"][0]["number"] == 2, table
        channel = app.get("checks", name="record.csv")["tables"][0][0]
        rms = math.sqrt(sum(v * v for v in values) / 5000)
        assert abs(channel["rms"] / rms - 1) < 1e-9 and any("spike" in fault for fault in channel["faults"]), channel
        coarse = app.get("window", name="record.csv", channels="0", points=50)
        assert coarse["step"] == 100 and not coarse["exact"] and len(coarse["channels"][0]["low"]) == 50
        for i in range(50):
            part = values[100 * i:100 * i + 100]
            assert abs(coarse["channels"][0]["low"][i] - min(part)) < 1e-4 and abs(coarse["channels"][0]["high"][i] - max(part)) < 1e-4
        fine = app.get("window", name="record.csv", channels="0", begin=3300, end=3400)
        assert fine["exact"] and fine["channels"][0]["low"] == values[3300:3400]
        spectrum = app.get("spectrum", name="record.csv", channels="0")
        assert len(spectrum["frequencies_hz"]) == len(spectrum["density"]) > 100
        for bad in ({"channels": "1"}, {"channels": "x"}, {"channels": "0,"}, {"table": 5}, {"begin": 6000}, {"begin": "-1"}, {"points": "1e3"}):
            app.get("window", 400, name="record.csv", **bad)
        # A record whose sampling rate is typed.
        (folder / "values.csv").write_text("a\n" + "".join(f"{v}\n" for v in values))
        assert app.get("record", name="values.csv")["tables"][0]["channels"][0]["number"] == 1
        assert app.get("spectrum", name="values.csv", channels="0")["frequencies_hz"] == []
        assert abs(app.get("spectrum", name="values.csv", channels="0", rate="12.5")["frequencies_hz"][-1] - 6.25) < 1e-4
        for bad in ("0", "-1", "x", "nan", "inf", "1e400", "5Hz", ""):
            app.get("spectrum", 400, name="values.csv", channels="0", rate=bad)


def records_have_the_layout_of_a_case(root):
    folder = folder_with_case(root)
    (folder / "layout.csv").write_text("date;f [Hz];note;air\n" + "".join(f"2026-01-01T00:{i:02};{'' if i % 4 == 0 else i};ok;7\n" for i in range(40)))
    (folder / "back\\slash.csv").write_text("a,b\n1,2\n")
    with App(folder) as app:
        assert [r["name"] for r in app.get("projects")["records"]] == ["layout.csv"]  # no name that the server rejects
        table = app.get("record", name="layout.csv")["tables"][0]
        assert table["rows"] == 40 and table["time_column"] == "date" and table["times"]["start"].startswith("2026-01-01"), table
        assert table["left_out"] == [{"name": "note", "number": 3, "is_time_stamp": False}], table
        f, air = app.get("checks", name="layout.csv")["tables"][0]
        assert f["missing"] == 0.25 and (f["lowest"], f["highest"]) == (1, 39) and (air["missing"], air["lowest"], air["highest"]) == (0, 7, 7), (f, air)
        skipping = json.dumps({"skip": 11, "header": 0})
        assert app.get("record", name="layout.csv", layout=skipping)["tables"][0]["rows"] == 30
        assert app.get("checks", name="layout.csv", layout=skipping)["tables"][0][0]["missing"] == 7 / 30
        assert app.get("window", name="layout.csv", layout=skipping, channels="0")["end"] == 30
        assert app.get("record", name="layout.csv")["tables"][0]["rows"] == 40  # the other layout stays in memory
        for bad in ("", "[", "[]", "3", {"decimal": ""}, {"decimal": 1}, {"separator": "xx"}, {"skip": "a"}, {"sheet": "x"}, {"resample": 1}, {"time_format": "%Q"}, {"resample": True, "sample_rate": -1}):
            app.get("record", 400, name="layout.csv", layout=bad if isinstance(bad, str) else json.dumps(bad))


def drawing(*entities):
    return "\n".join(["0", "SECTION", "2", "HEADER", "9", "$INSUNITS", "70", "4", "0", "ENDSEC", "0", "SECTION", "2", "ENTITIES", *entities,
                      "0", "ENDSEC", "0", "EOF", ""])


def drawings_are_stored_beside_a_case(root):
    folder = folder_with_case(root)
    ring = drawing("0", "CIRCLE", "10", "0", "20", "0", "40", "20", "0", "CIRCLE", "10", "0", "20", "0", "40", "15")
    with App(folder) as app:
        asked = {"case": "beam.json", "file": "ring.dxf", "text": ring}
        assert app.post("drawing", asked) == {"file": "ring.dxf"}
        assert app.post("drawing", asked) == {"file": "ring.dxf"}
        assert (folder / "ring.dxf").read_text() == ring
        assert app.get("projects")["drawings"] == [{"name": "ring.dxf"}]
        app.post("drawing", asked | {"text": drawing("0", "CIRCLE", "10", "0", "20", "0", "40", "1")}, 409)
        for bad, status in ((".ring.dxf", 403), ("ring.txt", 400), ("a/ring.dxf", 400), ("../ring.dxf", 400), ("", 400), ("x\n.dxf", 403)):
            app.post("drawing", asked | {"file": bad}, status)
        app.post("drawing", asked | {"case": "../beam.json"}, 403)
        said = app.post("drawing", asked | {"file": "bad.dxf", "text": drawing("0", "CIRCLE", "10", "x")}, 400)["error"]
        assert "bad.dxf" in said and "'x': must be a number" in said and "\n" not in said, said
        assert not (folder / "bad.dxf").exists() and (folder / "ring.dxf").read_text() == ring
        # The program's own reader gives the picture, in metres.
        region, = app.get("outline", name="beam.json", file="ring.dxf")["regions"]
        assert len(region["holes"]) == 1 and abs(max(y for y, _ in region["outline"]) - 0.02) < 2e-4, region
        app.get("outline", 400, name="beam.json", file="ring.dxf", unit="m")  # the file states millimetres
        app.get("outline", 400, name="beam.json", file="beam.json")
        pathlib.Path(root, "outside.dxf").write_text(ring)
        (folder / "link.dxf").symlink_to(pathlib.Path(root, "outside.dxf"))
        for name in ("../outside.dxf", str(pathlib.Path(root, "outside.dxf")), "link.dxf", "x/../../outside.dxf"):
            app.get("outline", 403, name="beam.json", file=name)
        assert "no such file" in app.get("outline", 400, name="beam.json", file="none.dxf")["error"]
        section = {"shape": "polygon", "file": "ring.dxf"}
        case = damage_case()
        case["beam"]["section"] = section
        assert app.post("check", {"name": "beam.json", "text": json.dumps(case)}) == {"valid": True}


def a_run_has_a_trace_of_its_probabilities(root):
    folder = folder_with_case(root, case=damage_case(damage={
        "count": {"min": 0, "max": 2, "prior": "uniform"}, "location": {"uniform": [0, 1]}, "reduction": {"uniform": [0, 0.6]}}))
    with App(folder) as app:
        number = app.post("run", {"name": "beam.json"})["number"]
        for _ in range(1200):
            run = next(r for r in app.get("runs")["runs"] if r["number"] == number)
            assert run["state"] in ("queued", "running"), run
            if len(run.get("trace", {}).get("seconds", [])) > 3:
                break
            time.sleep(0.05)
        seconds, models = run["trace"]["seconds"], run["trace"]["models"]
        assert seconds == sorted(seconds) and 3 < len(seconds) <= 200, seconds
        assert {m["name"] for m in models} == {"0 damages", "1 damage", "2 damages"}, models
        for i in range(len(seconds)):
            assert abs(sum(m["probability"][i] for m in models) - 1) < 1e-3, run["trace"]
        stages = [s["name"] for s in run["stages"]]
        assert stages[-1] == run["stage"] == "sampling" and len(stages) == len(set(stages)) > 1, stages
        assert [s["begin"] for s in run["stages"]] == sorted(s["begin"] for s in run["stages"])
        app.post("stop", {"number": number})
        assert "trace" not in app.wait(number, "stopped", "done")


def poles_of_a_case_are_its_modes(root):
    folder = pathlib.Path(root, "tower")
    subprocess.run([PROGRAM, "init", "modal", "-o", folder], check=True, stdout=subprocess.DEVNULL)
    case = json.loads((folder / "modal.json").read_text())

    def modal(name, status=0, **keys):
        (folder / "chosen.json").write_text(json.dumps(case | keys))
        run = subprocess.run([PROGRAM, "modal", folder / "chosen.json", "-o", folder / name], capture_output=True, text=True)
        assert run.returncode == status, run
        return run.stderr if status else [json.loads((folder / name / f).read_text()) for f in ("summary.json", "modes.json", "poles.json")]

    summary, modes, poles = modal("automatic")
    diagram = summary["stabilisation"]["poles"]
    own = poles["set_ups"][0]
    assert own["poles"] == diagram and len(own["shapes"]) == len(diagram) and len(own["sensors"]) == len(own["shapes"][0]["real"])
    chosen = [{"order": m["order"], "frequency": float(f"{m['frequency_hz']:.6g}")} for m in summary["modes"]]
    by_hand, same, _ = modal("by-hand", poles=chosen[::-1])
    assert same["frequencies_hz"] == modes["frequencies_hz"] and same["covariance"] == modes["covariance"] and same["shapes"] == modes["shapes"]
    assert by_hand["procedure"]["chosen_by_hand"] and "chosen_by_hand" not in summary["procedure"]
    one, _, _ = modal("one", poles=chosen[:1])
    assert len(one["modes"]) == 1 and any("list of poles" in r["why"] for r in one["rejected"])
    first = chosen[0]
    for keys, pointer, words in (
            ({"poles": [first, {"order": 1000, "frequency": 3.0}]}, "/poles/1/order", "<= 400"),
            ({"poles": [first, {"order": 398, "frequency": 3.0}]}, "/poles/1", "even numbers from 2 to"),
            ({"poles": [{"order": first["order"], "frequency": 1.01 * first["frequency"]}]}, "/poles/0", "within 0.5 %"),
            ({"poles": [first, first]}, "/poles/1", "same pole as number 1"),
            ({"poles": []}, "/poles", "at least one"),
            ({"poles": [first], "method": "efdd"}, "/poles", "ssi-cov")):
        said = modal("bad", 65, **keys)
        assert f"chosen.json: {pointer}: " in said and words in said and said.count("\n") == 1, said


CHECKS = [only_the_token_opens_it, other_sites_are_rejected, answers_have_strict_headers, files_are_below_the_folder_only,
          other_files_are_not_replaced, oversized_and_malformed_requests_are_rejected, slow_connections_do_not_block_it,
          hostile_names_are_text, checks_are_those_of_the_program, a_run_gives_the_bits_of_the_command_line,
          commands_of_a_case_do_not_run, a_killed_server_leaves_a_checkpoint, records_are_decimated_on_the_server,
          records_have_the_layout_of_a_case, poles_of_a_case_are_its_modes, drawings_are_stored_beside_a_case, a_run_has_a_trace_of_its_probabilities]

if __name__ == "__main__":
    for check in CHECKS:
        if len(sys.argv) > 2 and check.__name__ not in sys.argv[2:]:
            continue
        with tempfile.TemporaryDirectory() as place:
            check(place)
        print(check.__name__, "passed")
