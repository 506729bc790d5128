"""wt.plan: the plan of a test, its files and its errors."""
import json
import os
import tempfile
import unittest

from cases import wt

CASE = {
    "kind": "damage", "title": "Beam",
    "beam": {"length": 1.0, "elements": 20, "supports": "simply-supported",
             "material": {"young": 70e9, "poisson": 0.3, "density": 2700},
             "section": {"shape": "rectangle", "width": 0.025, "height": 0.006}},
    "damage": {"count": {"min": 0, "max": 1, "prior": "uniform"},
               "location": {"uniform": [0, 1]}, "reduction": {"uniform": [0, 0.6]}},
    "plan": {"sensors": [{"every": 0.2}], "choose": 2, "modes": 4, "seconds": 3600,
             "damping": 0.002, "shape_sd": 0.01, "false_alarm": 0.05, "tolerance": 0.1}}


class Plan(unittest.TestCase):
    def test_it_names_sensors_and_keeps_its_files(self):
        plan = wt.plan(CASE, seed=1, scenarios=1000, checks=0)
        self.assertEqual(len(plan.sensors), 2)
        self.assertIn("<html", plan.report())
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "out")
            plan.save(out)
            with open(os.path.join(out, "damage.json"), encoding="utf-8") as file:
                self.assertEqual(len(json.load(file)["data"]["sensors"]), 2)

    def test_what_goes_wrong(self):
        with self.assertRaisesRegex(ValueError, "scenarios: must be a whole number"):
            wt.plan(CASE, scenarios=2)
        with self.assertRaisesRegex(wt.CaseError, "/plan/choose"):
            wt.plan(CASE, scenarios=1000, changes={"plan.choose": 1})


if __name__ == "__main__":
    unittest.main()
