"""Modes from simulated accelerations of a chain whose modes are known."""
import os
import tempfile
import unittest

import numpy as np
from cases import program, wt


def tower(masses=(5.0, 5.0, 5.0), stiffness=40e3, samples=20000):
    """Three storeys driven by independent white forces; accelerations with noise at 100 Hz."""
    storeys = range(1, len(masses) + 1)
    return {
        "kind": "sid", "title": "A tower",
        "record": {"channels": [{"column": f"force {i} [N]", "role": "force", "mass": i} for i in storeys]
                   + [{"column": f"floor {i} [m/s^2]", "role": "response", "mass": i, "quantity": "acceleration"}
                      for i in storeys]},
        "parameters": {"k": wt.log_uniform(1e3, 1e6)},
        "models": [{"name": "tower", "prior": 1, "masses": list(masses), "noise": 0.05,
                    "links": [{"between": [i - 1, i], "stiffness": "k", "damping": 12.0} for i in storeys]}],
        "truth": {"model": "tower", "parameters": {"k": stiffness}, "noise": 0.02, "samples": samples,
                  "sample_rate": 100, "seed": 5,
                  "excitation": [{"mass": i, "kind": "white", "variance": 100} for i in storeys]},
    }


def exact(masses=(5.0, 5.0, 5.0), stiffness=40e3):
    n = len(masses)
    k = stiffness * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    k[-1, -1] = stiffness
    return np.sqrt(np.linalg.eigvalsh(k / np.array(masses)[:, None])) / (2 * np.pi)


class Modal(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.record = wt.simulate(tower())
        cls.floors = {name: cls.record[name] for name in cls.record if name.startswith("floor")}
        cls.modal = wt.modal(channels=cls.floors, sample_rate=cls.record.sample_rate, band=[2, 30])

    def test_frequencies_within_their_uncertainty(self):
        self.assertEqual(len(self.modal), 3)
        error = (self.modal.frequencies_hz - exact()) / self.modal.frequencies_sd
        self.assertLess(np.abs(error).max(), 4.5)
        self.assertLess((self.modal.frequencies_sd / exact()).max(), 0.01)

    def test_arrays(self):
        self.assertEqual(self.modal.shapes.shape, (3, 3))
        self.assertEqual(self.modal.covariance.shape, (6, 6))
        self.assertFalse(self.modal.frequencies_hz.flags.owndata)
        self.assertTrue(np.shares_memory(self.modal.shapes, self.modal.shapes))
        with self.assertRaises(ValueError):
            self.modal.frequencies_hz[0] = 0
        np.testing.assert_allclose(np.abs(self.modal.shapes).max(axis=0), 1.0)

    def test_the_same_as_of_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            table = np.column_stack(list(self.floors.values()))
            np.savetxt(f"{folder}/r.csv", table, delimiter=",", fmt="%.17g", comments="",
                       header=",".join(self.floors))
            case = {"kind": "modal", "band": [2, 30], "record": {
                "file": "r.csv", "sample_rate": 100,
                "channels": [{"column": name, "role": "response"} for name in self.floors]}}
            of_file = wt.modal(case, folder=folder)
            np.testing.assert_array_equal(of_file.frequencies_hz, self.modal.frequencies_hz)
            of_file.save(f"{folder}/out")
            self.assertEqual(sorted(os.listdir(f"{folder}/out")), ["modes.json", "poles.json", "report.html", "summary.json"])
            self.assertEqual(of_file.modes["frequencies_hz"], list(of_file.frequencies_hz))

    def test_what_goes_wrong(self):
        with self.assertRaisesRegex(ValueError, "either a case or channels"):
            wt.modal()
        with self.assertRaisesRegex(wt.CaseError, "^channels: /record/sample_rate: is missing"):
            wt.modal(channels=self.floors)
        with self.assertRaisesRegex(wt.CaseError, "/band"):
            wt.modal(channels=self.floors, sample_rate=100, band=[30, 2])
        with self.assertRaisesRegex(ValueError, "no channel 'roof'"):
            wt.modal(channels=self.floors, sample_rate=100, references=["roof"])
        with self.assertRaisesRegex(wt.CaseError, "is constant"):
            wt.modal(channels={"a": np.zeros(5000)}, sample_rate=100)

    def test_report(self):
        self.assertIn("Stabilisation", self.modal.report())
        self.assertIn("Hz", repr(self.modal))
        self.assertIn("srcdoc", self.modal._repr_html_())


if __name__ == "__main__":
    unittest.main()
