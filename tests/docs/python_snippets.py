#!/usr/bin/env python3
"""Runs the Python that a document shows, as it is written.

usage: python_snippets.py PACKAGE_FOLDER ROOT DOCUMENT

The blocks fenced as ```python run one after the other, as one program, in a folder that looks like a fresh clone.
"""
import os
import sys
import tempfile
import traceback


def blocks(text):
    """(first line, code) of each block."""
    found, fence = [], None
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if fence is not None:
                if fence[0] == "python":
                    found.append((fence[1], "\n".join(fence[2])))
                fence = None
            else:
                fence = (line[3:].strip(), number + 1, [])
        elif fence is not None:
            fence[2].append(line)
    return found


def main(package, root, document):
    sys.path.insert(0, os.path.abspath(package))
    os.environ["MPLBACKEND"] = "Agg"
    with open(os.path.join(root, document), encoding="utf-8") as f:
        found = blocks(f.read())
    assert found, f"{document} shows no Python"
    with tempfile.TemporaryDirectory() as clone:
        for name in ("data", "examples"):
            os.symlink(os.path.join(os.path.abspath(root), name), os.path.join(clone, name))
        os.chdir(clone)
        names = {"__name__": "__main__"}
        for line, code in found:
            print(f"+ {document}:{line}", file=sys.stderr)
            # Errors then name the line of the document.
            exec(compile("\n" * (line - 1) + code, document, "exec"), names)
        os.chdir("/")
    print(f"{document}: {len(found)} blocks ran")


if __name__ == "__main__":
    try:
        import matplotlib  # noqa: F401  what the page needs beside NumPy
        import netCDF4  # noqa: F401
        import xarray  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing}")
        sys.exit(77)
    try:
        main(*sys.argv[1:])
    except Exception:
        traceback.print_exc()
        sys.exit(1)
