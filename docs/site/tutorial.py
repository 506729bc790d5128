#!/usr/bin/env python3
"""Runs a tutorial and, for the manual, writes down what it showed.

usage: tutorial.py FILE [--page PAGE.md] [--program WHEELTAP] [--package FOLDER] [--root FOLDER] [--compiled PROGRAM]

A tutorial is a file that runs as it is, Python or shell, in cells: `# %%` begins one, `# %% [markdown]` one whose
comments are prose (the format that Jupyter's and other editors know). A file without cells is one. Of a C++ file the
opening comment is the prose, and what was compiled of it is run. Cells run in order, as one program, in a folder that
looks like a fresh clone, and without a display; a cell that fails ends the tutorial with exit code 1. PAGE gets prose,
code, what the cells printed, and their figures, which are kept beside it. Exit code 77: what it needs is not there.
"""
import argparse
import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
import textwrap
import traceback

FENCE = "```"


def cells(text, comment):
    """(kind, first line, text) of each cell; kind is markdown or code."""
    found, kind, start, lines = [], "code", 1, []

    def close():
        body = "\n".join(lines).strip("\n")
        if kind == "markdown":
            body = "\n".join(re.sub(rf"^{comment} ?", "", line) for line in body.splitlines())
        if body.strip():
            # The code's own line numbers are kept, so that errors name them.
            found.append((kind, start + next((i for i, line in enumerate(lines) if line.strip()), 0), body))

    for number, line in enumerate(text.splitlines(), 1):
        mark = re.match(rf"^{comment} %%\s*(\[markdown\])?\s*$", line)
        if mark:
            close()
            kind, start, lines = ("markdown" if mark[1] else "code"), number + 1, []
        elif not (number == 1 and line.startswith("#!")):
            lines.append(line)
    close()
    return found


def docstring_first(found):
    """The docstring of a Python file as prose."""
    kind, start, body = found[0]
    if kind == "code" and body.startswith('"""'):
        prose, code = body[3:].split('"""', 1)
        prose = re.sub(r"\n\n    python3 .*", "", prose.strip())
        rest = code.strip("\n")
        moved = start + body[:body.index(rest)].count("\n") if rest else start
        return [("markdown", start, prose)] + ([("code", moved, rest)] if rest else []) + found[1:]
    return found


def figures(folder, stem, taken):
    """Saves the figures that a cell left open, and names them."""
    pyplot = sys.modules.get("matplotlib.pyplot")
    if pyplot is None:
        return []
    names = []
    for number in pyplot.get_fignums():
        if folder:
            names.append(f"{stem}-{taken + len(names) + 1}.svg")
            pyplot.figure(number).savefig(os.path.join(folder, names[-1]), bbox_inches="tight")
        pyplot.close(number)
    return names


def run_python(found, path, folder, stem):
    """(kind, text) of what was shown; raises what a cell raises."""
    names, shown, taken = {"__name__": "__main__"}, [], 0
    sys.argv = [path]
    for kind, line, body in found:
        shown.append((kind if kind == "markdown" else "python", body))
        if kind == "markdown":
            continue
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                exec(compile("\n" * (line - 1) + body, path, "exec"), names)
        except BaseException:
            sys.stdout.write(printed.getvalue())
            raise
        if printed.getvalue().strip():
            shown.append(("text", printed.getvalue().rstrip()))
        for name in figures(folder, stem, taken):
            shown.append(("figure", name))
            taken += 1
    return shown


def run_shell(found, program):
    """One shell runs all cells; a line of its own between them tells their outputs apart."""
    mark = "-- tutorial cell --"
    script = ["set -euo pipefail", f'PATH="{os.path.dirname(os.path.abspath(program))}:$PATH"']
    for kind, _, body in found:
        if kind == "code":
            script += [body, f"echo '{mark}'"]
    ran = subprocess.run(["bash", "-c", "\n".join(script)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    if ran.returncode != 0:
        sys.stdout.write(ran.stdout)
        raise RuntimeError(f"a command ended with {ran.returncode}")
    outputs = iter(ran.stdout.split(mark + "\n"))
    shown = []
    for kind, _, body in found:
        shown.append((kind if kind == "markdown" else "sh", body))
        if kind == "code":
            printed = next(outputs)
            if printed.strip():
                shown.append(("text", printed.rstrip()))
    return shown


def run_compiled(text, program):
    """The opening comment of a C++ file, its code, and what its program printed."""
    prose = re.match(r"(//[^\n]*\n)+", text)
    words = "\n".join(re.sub(r"^// ?", "", line) for line in prose[0].splitlines()) if prose else ""
    ran = subprocess.run([program], capture_output=True, text=True)
    if ran.returncode != 0:
        raise RuntimeError(f"{program} ended with {ran.returncode}: {ran.stderr}")
    return [("markdown", words), ("cpp", text[prose.end():].strip() if prose else text), ("text", ran.stdout.rstrip())]


def page(shown, title, source):
    lines = []
    if not (shown and shown[0][0] == "markdown" and shown[0][1].startswith("# ")):
        lines += [f"# {title}", ""]
    for kind, body in shown:
        if kind == "markdown":
            lines += [body, ""]
        elif kind == "figure":
            lines += [f"![figure]({body})", ""]
        else:
            if kind == "text":
                body = "\n".join(textwrap.fill(line, 110) if len(line) > 130 else line for line in body.splitlines())
            lines += [FENCE + kind, body, FENCE, ""]
    lines += [f"This page is `{source}`, and what it showed when the manual was built: run it yourself.", ""]
    return "\n".join(lines)


def shown_by(path, text, arguments, folder, stem):
    if path.endswith(".cpp"):
        return run_compiled(text, arguments.compiled)
    if path.endswith(".sh"):
        return run_shell(cells(text, "#"), arguments.program)
    sys.path.insert(0, os.path.abspath(arguments.package))
    return run_python(docstring_first(cells(text, "#")), path, folder, stem)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    for option in ("--page", "--program", "--package", "--compiled", "--title"):
        parser.add_argument(option)
    parser.add_argument("--root", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
    arguments = parser.parse_args()
    if arguments.file.endswith(".py"):
        try:
            import matplotlib
            matplotlib.use("Agg")
            matplotlib.rcParams["svg.hashsalt"] = "wheeltap"
        except ImportError as missing:
            print(f"skipped: {missing}")
            sys.exit(77)
    path, root = os.path.abspath(arguments.file), os.path.abspath(arguments.root)
    for option in ("page", "program", "package", "compiled"):
        if getattr(arguments, option):
            setattr(arguments, option, os.path.abspath(getattr(arguments, option)))
    with open(path, encoding="utf-8") as f:
        text = f.read()
    stem = os.path.splitext(os.path.basename(path))[0]
    folder = os.path.dirname(arguments.page) if arguments.page else None
    with tempfile.TemporaryDirectory() as clone:
        for name in ("data", "examples"):
            os.symlink(os.path.join(root, name), os.path.join(clone, name))
        os.chdir(clone)
        try:
            shown = shown_by(path, text, arguments, folder, stem)
        except Exception:
            traceback.print_exc()
            sys.exit(f"{arguments.file} failed")
        finally:
            os.chdir("/")
    if arguments.page:
        with open(arguments.page, "w", encoding="utf-8") as f:
            f.write(page(shown, arguments.title or stem, os.path.relpath(path, root)))
    print(f"{os.path.relpath(path, root)}: {len(shown)} parts, as they should be")


if __name__ == "__main__":
    main()
