#!/usr/bin/env python3
"""docs/laws.md and its pictures are what `wheeltap laws` makes.

usage: laws.py PROGRAM ROOT

The page must agree to the letter, the pictures but for their numbers' last digit, which another compiler may round
otherwise. Made again, from the root: wheeltap laws --figures docs/figures > docs/laws.md
"""
import os
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
AGAIN = "make it again: wheeltap laws --figures docs/figures > docs/laws.md"


def text_of(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def same_picture(a, b):
    x, y = ([float(n) for n in NUMBER.findall(t)] for t in (a, b))
    return NUMBER.sub("#", a) == NUMBER.sub("#", b) and all(abs(p - q) < 0.11 for p, q in zip(x, y))


def main(program, root):
    figures = os.path.join(root, "docs/figures")
    with tempfile.TemporaryDirectory() as made:
        page = subprocess.run([program, "laws", "--figures", made], capture_output=True, text=True, check=True).stdout
        assert page == text_of(os.path.join(root, "docs/laws.md")), f"docs/laws.md is not what the program says; {AGAIN}"
        for name in sorted(os.listdir(made)):
            assert os.path.exists(os.path.join(figures, name)), f"docs/figures has no {name}; {AGAIN}"
            assert same_picture(text_of(os.path.join(made, name)), text_of(os.path.join(figures, name))), \
                f"docs/figures/{name} is not what the program draws; {AGAIN}"
            assert f"(figures/{name})" in page, f"the page does not show {name}"
        left = [f for f in os.listdir(figures) if f.startswith("law-") and f not in os.listdir(made)]
        assert not left, f"docs/figures has {', '.join(left)} of laws that are no more"
    print("docs/laws.md and its pictures agree with the program")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except AssertionError as error:
        sys.exit(str(error))
