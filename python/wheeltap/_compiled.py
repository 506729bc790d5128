"""Check of the compiled part of the package, _core, which the build places next to these files."""
import importlib.machinery
import pathlib
import sys


def require_compiled_module():
    """If _core is missing for this interpreter, raises ImportError with the command that builds _core."""
    folder = pathlib.Path(__file__).parent
    if any((folder / ("_core" + suffix)).exists() for suffix in importlib.machinery.EXTENSION_SUFFIXES):
        return
    others = sorted(path.name for path in folder.glob("_core.*") if path.suffix in (".so", ".pyd"))
    version = ".".join(str(number) for number in sys.version_info[:2])
    found = (f"{others[0]} is built for another interpreter than this Python {version}: use that one, or configure "
             f"with -DPython3_EXECUTABLE={sys.executable}." if others else
             "its compiled module is not built: run `scripts/build release wheeltap_python` in Wheeltap's source "
             "folder, then set PYTHONPATH to build/release/python there.")
    raise ImportError(f"wheeltap cannot be imported from {folder}: {found}", name="wheeltap._core")
