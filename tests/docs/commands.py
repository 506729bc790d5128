#!/usr/bin/env python3
"""Runs every command that a document shows, as it is written.

usage: commands.py PROGRAM ROOT DOCUMENT

The lines of each code block (indented by four, or fenced as ```sh) run in one shell, in order, in a folder that
looks like a fresh clone after the build: ROOT's files, and PROGRAM as build/release/apps/wheeltap. Commands named in
running text have placeholders, so these are only looked up: the script must be there, the program must have the
command and its options.
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile

# Shown, not run, and why.
EXCEPTIONS = {
    "./scripts/demo": "installs packages and builds: what it runs after that is the first command of the README",
    "scripts/demo": "the same",
    "./scripts/test": "runs this test",
}


def blocks(text):
    """Lines of code blocks, and the text between them."""
    code, prose, fence, indented_may_start = [], [], None, True
    for line in text.splitlines():
        if line.startswith("```"):
            fence = None if fence is not None else line[3:].strip()
            continue
        if fence is not None:
            if fence == "sh":
                code.append(line)
        elif line.startswith("    ") and indented_may_start:
            code.append(line[4:])
        else:
            prose.append(line)
            indented_may_start = not line.strip()
    return code, "\n".join(prose)


def named(prose):
    """Commands in backticks."""
    for words in re.findall(r"`([^`]+)`", prose):
        words = " ".join(words.split())
        if re.match(r"(wheeltap|build/release/apps/wheeltap) [a-z-]", words) or re.match(r"(\./)?scripts/", words):
            yield words


def look_up(command, program, root):
    words = shlex.split(command)
    if "scripts/" in words[0]:
        assert os.access(os.path.join(root, words[0]), os.X_OK), f"{command}: no such script"
        return
    if words[1] == "…" or words[1].startswith("-"):
        return
    help_text = subprocess.run([program, words[1], "--help"], capture_output=True, text=True)
    assert help_text.returncode == 0, f"{command}: the program has no such command"
    for option in (w.split("=")[0] for w in words[2:] if w.startswith("-")):
        assert option in help_text.stdout, f"{command}: there is no option {option}"


def main(program, root, document):
    with open(os.path.join(root, document), encoding="utf-8") as f:
        code, prose = blocks(f.read())
    for command in named(prose):
        look_up(command, program, root)
    shown = [line for line in code if line.strip()]
    assert shown, f"{document} shows no command"
    script = ["set -euo pipefail"]
    for line in shown:
        if line.split("#")[0].strip() in EXCEPTIONS:
            continue
        # A command may go on in the next line.
        if not (script[-1].endswith("\\") or line.startswith("#")):
            script.append(f"echo {shlex.quote('+ ' + line)} >&2")
        script.append(line)
    with tempfile.TemporaryDirectory() as clone:
        os.makedirs(os.path.join(clone, "build/release/apps"))
        os.symlink(os.path.abspath(program), os.path.join(clone, "build/release/apps/wheeltap"))
        for name in ("data", "scripts", "docs", "examples"):
            os.symlink(os.path.join(os.path.abspath(root), name), os.path.join(clone, name))
        ran = subprocess.run(["bash", "-c", "\n".join(script)], cwd=clone, stdin=subprocess.DEVNULL,
                             stdout=subprocess.DEVNULL)
        assert ran.returncode == 0, f"{document}: the last command above ended with {ran.returncode}"
    print(f"{document}: {sum(line.startswith('echo ') for line in script)} commands ran")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except AssertionError as error:
        sys.exit(str(error))
