"""The stubs say what the module has, and everything that users call explains itself."""
import ast
import inspect
import os
import pathlib
import unittest

from cases import wt
from wheeltap import _core

PACKAGE = pathlib.Path(wt.__file__).parent


def is_public(name):
    return not name.startswith("_")


class Typing(unittest.TestCase):
    def test_stub_and_module_have_the_same_names(self):
        stub = ast.parse((PACKAGE / "_core.pyi").read_text(encoding="utf-8"))
        named = {node.name: node for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(sorted(named), sorted(filter(is_public, dir(_core))))
        for name, node in named.items():
            if isinstance(node, ast.FunctionDef):
                said = [argument.arg for argument in node.args.args]
                signature = getattr(_core, name).__doc__.splitlines()[0]
                inside = signature[signature.index("(") + 1:signature.rindex(") ->")]
                self.assertEqual(said, [part.split(":")[0].strip() for part in inside.split(", ") if ":" in part], name)
            elif name not in ("CaseError", "FileError"):
                members = {m.name for m in node.body if isinstance(m, ast.FunctionDef) and is_public(m.name)}
                self.assertEqual(members, set(filter(is_public, dir(getattr(_core, name)))), name)

    def test_typed(self):
        self.assertTrue((PACKAGE / "py.typed").exists())

    def test_everything_public_has_a_docstring_and_annotations(self):
        for name in wt.__all__:
            if name in ("__version__", "plot"):
                continue
            thing = getattr(wt, name)
            self.assertTrue((thing.__doc__ or "").strip(), name)
            if inspect.isfunction(thing):
                signature = inspect.signature(thing)
                self.assertIsNot(signature.return_annotation, inspect.Signature.empty, name)
                for parameter in signature.parameters.values():
                    self.assertIsNot(parameter.annotation, inspect.Parameter.empty, f"{name}({parameter.name})")

    def test_the_import_needs_numpy_alone(self):
        script = ("import sys, wheeltap\n"
                  "heavy = {'matplotlib', 'xarray', 'netCDF4', 'pandas', 'scipy'} & set(sys.modules)\n"
                  "assert not heavy, heavy\n")
        import subprocess
        import sys
        subprocess.run([sys.executable, "-c", script], check=True,
                       env={**os.environ, "PYTHONPATH": os.environ["WHEELTAP_PACKAGE"]})


if __name__ == "__main__":
    unittest.main()
