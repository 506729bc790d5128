"""What goes wrong is said in the program's words, and nothing half-written stays."""
import _thread
import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from cases import SHORT, cantilever, program, wt


class Errors(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def written(self, case):
        path = os.path.join(self.folder.name, "case.json")
        with open(path, "w") as f:
            json.dump(case, f)
        return path

    def test_an_import_without_the_compiled_module_names_the_build_command(self):
        package = os.path.join(self.folder.name, "wheeltap")
        shutil.copytree(os.path.dirname(wt.__file__), package, ignore=shutil.ignore_patterns("_core*.so", "__pycache__"))
        run = subprocess.run([sys.executable, "-c", "import wheeltap"], capture_output=True, text=True,
                             env={**os.environ, "PYTHONPATH": self.folder.name})
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("scripts/build release wheeltap_python", run.stderr)
        self.assertNotIn("circular", run.stderr)

    def test_case_errors_are_the_programs_line(self):
        wrong = []
        for keys, value in [(("beam", "material", "poisson"), 0.7), (("beam", "elements"), 2.5),
                            (("damage", "location"), {"uniform": [1, 0]}), (("data", "cov"), "much"),
                            (("beam", "colour"), "red"), (("predictor",), {"table": "no.nc"})]:
            case = cantilever()
            at = case
            for key in keys[:-1]:
                at = at[key]
            at[keys[-1]] = value
            wrong.append(case)
        for case in wrong:
            path = self.written(case)
            code, _, err = program("damage", path, "-o", f"{self.folder.name}/out", "--quiet")
            self.assertIn(code, (65, 66))
            kind = wt.CaseError if code == 65 else wt.FileError
            with self.assertRaises(kind) as raised:
                wt.damage(path, **SHORT)
            self.assertEqual(f"wheeltap: {raised.exception}\n", err)

    def test_a_dictionary_is_named_case(self):
        case = cantilever()
        case["beam"]["material"]["poisson"] = 0.7
        with self.assertRaisesRegex(wt.CaseError, r"^case: /beam/material/poisson: 0\.7: must be < 0\.5"):
            wt.damage(case, **SHORT)
        with self.assertRaisesRegex(wt.CaseError, "^case: /: .*NaN"):
            wt.damage(cantilever(data={"frequencies": [float("nan")], "cov": 0.01}), **SHORT)

    def test_kinds_of_error(self):
        self.assertTrue(issubclass(wt.CaseError, ValueError))
        self.assertTrue(issubclass(wt.FileError, OSError))
        self.assertIsInstance(pickle.loads(pickle.dumps(wt.CaseError("a"))), wt.CaseError)
        with self.assertRaisesRegex(wt.FileError, "no.json: "):
            wt.damage("no.json", **SHORT)
        with self.assertRaisesRegex(ValueError, "chains = 0, must be a whole number from 1 to 1000"):
            wt.damage(cantilever(), chains=0)
        with self.assertRaisesRegex(ValueError, 'no option "speed"'):
            wt.damage(cantilever(), speed=3)
        with self.assertRaisesRegex(wt.CaseError, "/sweep: .*loop"):
            wt.sid({"kind": "sid", "sweep": {}}, progress=False)
        with self.assertRaisesRegex(wt.CaseError, "--set"):
            wt.damage(cantilever(), changes={"": 3}, **SHORT)
        with self.assertRaisesRegex(wt.CaseError, "max-memory"):
            wt.damage(cantilever(), max_memory_gb=1e-6, progress=False)

    def test_save_into_what_cannot_be_written(self):
        result = wt.damage(cantilever(), **SHORT)
        path = os.path.join(self.folder.name, "file")
        with open(path, "w") as f:
            f.write("in the way")
        with self.assertRaises(wt.FileError):
            result.save(path)
        with open(path) as f:
            self.assertEqual(f.read(), "in the way")

    def test_progress(self):
        seen = []
        wt.damage(cantilever(), **{**SHORT, "draws": 3000, "progress": seen.append})
        self.assertTrue(seen)
        for p in seen:
            self.assertTrue(0.0 <= p.fraction <= 1.0 and p.stage and p.evaluations >= 0)

    def test_progress_may_stop_the_run(self):
        def until_drawing(p):
            return not (p.stage == "sampling" and p.fraction > 0.0)

        result = wt.damage(cantilever(), **{**SHORT, "draws": 1_000_000, "progress": until_drawing})
        self.assertTrue(result.stopped_early)
        self.assertFalse(result.converged)
        self.assertLess(result.draws["k"].shape[1], 1_000_000)

    def test_what_progress_raises_ends_the_run(self):
        def refuse(p):
            raise LookupError("enough")

        begun = time.monotonic()
        with self.assertRaisesRegex(LookupError, "enough"):
            wt.damage(cantilever(), **{**SHORT, "draws": 1_000_000, "progress": refuse})
        self.assertLess(time.monotonic() - begun, 60.0)

    def test_other_threads_run_while_it_samples(self):
        count = [0]
        done = threading.Event()

        def work():
            while not done.is_set():
                count[0] += 1
                time.sleep(0.001)

        other = threading.Thread(target=work)
        other.start()
        try:
            begun = time.monotonic()
            wt.damage(cantilever(), **{**SHORT, "draws": 20000, "threads": 1})
            seconds = time.monotonic() - begun
        finally:
            done.set()
            other.join()
        # With the GIL held it would have had no turn at all.
        self.assertGreater(count[0], 10 * seconds)

    def test_an_interrupt_ends_the_run_and_leaves_nothing(self):
        script = ("import sys; sys.path.insert(0, %r)\nimport cases\nfrom cases import wt\n"
                  "def begun(p):\n    print('begun', flush=True)\n"
                  "r = wt.damage(cases.cantilever(), seed=1, draws=1_000_000,"
                  " progress=begun)\n"
                  "r.save('out')\n") % os.path.dirname(os.path.abspath(__file__))
        run = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               cwd=self.folder.name)
        try:
            first = run.stdout.readline()
            begun = time.monotonic()
            run.send_signal(signal.SIGINT)
            _, err = run.communicate(timeout=60)
        finally:
            run.kill()
        self.assertIn(b"begun", first)
        self.assertIn(b"KeyboardInterrupt", err)
        self.assertLess(time.monotonic() - begun, 30.0)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_an_interrupt_is_caught_in_the_same_process(self):
        # As a notebook's "interrupt the kernel" has it: the session goes on.
        def interrupt(p):
            _thread.interrupt_main()

        with self.assertRaises(KeyboardInterrupt):
            wt.damage(cantilever(), **{**SHORT, "draws": 1_000_000, "progress": interrupt})
        self.assertEqual(wt.damage(cantilever(), **SHORT).draws["k"].shape, (4, 200))


if __name__ == "__main__":
    unittest.main()
