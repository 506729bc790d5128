#!/usr/bin/env python3
"""A tutorial that fails is seen to fail, and its page shows what was printed: tutorials.py TUTORIAL_RUNNER"""
import os
import subprocess
import sys
import tempfile

RUNNER = sys.argv[1]


def ran(name, text, *more):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        page = os.path.join(folder, "page.md")
        done = subprocess.run([sys.executable, RUNNER, path, "--page", page, "--package", folder, "--program", sys.executable,
                               *more], capture_output=True, text=True)
        if done.returncode == 77:
            print(done.stdout)
            sys.exit(77)
        shown = ""
        if os.path.exists(page):
            with open(page, encoding="utf-8") as f:
                shown = f.read()
        return done.returncode, done.stdout + done.stderr, shown


PROSE = "# %% [markdown]\n# # Title\n#\n# Words.\n# %%\n"
for name, good, bad, line in (("a.sh", "echo $((6 * 7))\n", "echo before\nfalse\necho after\n", ""),
                              ("a.py", "print(6 * 7)\n", "print('before')\nassert 1 == 2\n", "line 7")):
    code, said, page = ran(name, PROSE + good)
    assert code == 0, said
    assert page.startswith("# Title\n\nWords.\n") and "```text\n42\n```" in page, page
    code, said, page = ran(name, PROSE + bad)
    assert code == 1 and "before" in said and "after" not in said and line in said, (code, said)
    assert not page, "a page of a tutorial that failed"
print("failures are seen")
