#!/usr/bin/env python3
"""The program at a terminal, in a pipe, and under Ctrl-C.

usage: terminal.py PROGRAM CASE
"""
import json
import os
import pty
import subprocess
import sys
import tempfile

SHORT = ["--chains", "2", "--warmup", "4000", "--draws", "1000"]
BOLD, CLEAR_LINE = b"\x1b[1m", b"\x1b[K"


def at_a_terminal(arguments, environment=None, interrupt_at=None):
    """Returns exit code and all output. Types Ctrl-C when `interrupt_at` is true of the output."""
    child, terminal = pty.fork()
    if child == 0:
        os.execve(arguments[0], arguments, {**os.environ, "TERM": "xterm", **(environment or {})})
    shown = b""
    while True:
        try:
            piece = os.read(terminal, 65536)
        except OSError:  # Linux reports the end like this
            break
        if not piece:
            break
        shown += piece
        if interrupt_at and interrupt_at(shown):
            os.write(terminal, b"\x03")
            interrupt_at = None
    assert interrupt_at is None, "the run ended before it was interrupted"
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), shown


def main(program, case):
    os.environ.pop("NO_COLOR", None)
    with tempfile.TemporaryDirectory() as out:
        run = [program, "damage", case, "-o", os.path.join(out, "run")]

        piped = subprocess.run(run + SHORT, capture_output=True, check=True)
        assert b"\x1b" not in piped.stdout + piped.stderr, "escape codes in a pipe"
        assert b"\r" not in piped.stdout + piped.stderr, "a bar in a pipe"
        lines = piped.stderr.decode().splitlines()
        for stage in ("exploring", "searching", "tuning", "sampling"):
            assert any(line.startswith(f"{stage}: ") for line in lines), f"no line of {stage} in a log"
        quiet = subprocess.run(run + SHORT + ["--quiet"], capture_output=True, check=True)
        assert quiet.stderr == b"", "lines in spite of --quiet"

        # A quick run is marked and never converged.
        look = subprocess.run(run + ["--quick"], capture_output=True, check=True)
        assert b"quick run" in look.stdout and b"NOT CONVERGED" in look.stdout.splitlines()[-1]
        with open(os.path.join(run[-1], "summary.json")) as f:
            summary = json.load(f)
        assert summary["diagnostics"]["quick"] and not summary["diagnostics"]["converged"]
        with open(os.path.join(run[-1], "report.html"), encoding="utf-8") as f:
            assert "Quick run" in f.read(), "the report does not say that the run was quick"

        code, shown = at_a_terminal(run + SHORT)
        assert code == 0 and BOLD in shown and CLEAR_LINE in shown, "no bar or colour at a terminal"
        assert "▲".encode() in shown, "the beam is drawn with its supports"

        code, shown = at_a_terminal(run + SHORT, {"NO_COLOR": "1"})
        assert code == 0 and BOLD not in shown and b"\x1b[3" not in shown, "colour in spite of NO_COLOR"

        # Ctrl-C, when the bar of the draws shows probabilities and the time left, keeps and summarises the draws.
        def sampling(shown):
            bars = shown.split(b"sampling", 1)
            return len(bars) == 2 and b"P(" in bars[1] and b" left" in bars[1]
        run[-1] = os.path.join(out, "stopped")
        code, shown = at_a_terminal(run + ["--chains", "2", "--warmup", "4000", "--draws", "2000000"],
                                    interrupt_at=sampling)
        assert code == 0, f"Ctrl-C ended with {code}"
        assert b"P(" in shown and b"/s" in shown and b" left" in shown, "the bar lacks P(model), rate or time left"
        with open(os.path.join(run[-1], "summary.json")) as f:
            summary = json.load(f)
        assert summary["diagnostics"]["stopped_early"] and not summary["diagnostics"]["converged"]
        assert 100 <= summary["cost"]["draws_a_chain"] < 2000000
        assert abs(sum(m["probability"] for m in summary["models"]) - 1) < 1e-9
        for name in ("posterior.nc", "report.html"):
            assert os.path.getsize(os.path.join(run[-1], name)) > 1000, name
        assert b"NOT CONVERGED" in shown.splitlines()[-1]
        # Before the first draw, it keeps the results of the searches.
        for stage, warmup in (b"exploring", "2000000"), (b"tuning", "40000"):
            run[-1] = os.path.join(out, "stopped-" + stage.decode())
            code, shown = at_a_terminal(run + ["--warmup", warmup],
                                        interrupt_at=lambda shown: stage in shown)
            assert code == 0, f"Ctrl-C while {stage} ended with {code}"
            with open(os.path.join(run[-1], "summary.json")) as f:
                summary = json.load(f)
            assert summary["diagnostics"]["stopped_early"] and not summary["diagnostics"]["converged"]
            assert summary["cost"]["draws_a_chain"] >= 100
            assert b"NOT CONVERGED" in shown.splitlines()[-1]
    print("the terminal shows what it should")


if __name__ == "__main__":
    main(*sys.argv[1:])
