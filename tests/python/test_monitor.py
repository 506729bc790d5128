"""wt.monitor: a series in memory, its results as arrays and as an xarray Dataset."""
import os
import tempfile
import unittest

import numpy as np
from cases import wt


def series(rows=260, onset=200):
    """Two features of one temperature; from `onset` on the second is 3 % lower."""
    random = np.random.default_rng(4)
    hours = np.arange(rows, dtype=float)
    air = 5.0 + 6.0 * np.sin(hours / 4.0) + random.normal(size=rows)
    f1 = 4.0 * np.exp(-0.0005 * air + 0.001 * random.normal(size=rows))
    f2 = 5.0 * np.exp(-0.0007 * air + 0.001 * random.normal(size=rows))
    f2[hours >= onset] *= 0.97
    f1[7] = np.nan
    return {"hour": hours, "f1": f1, "f2": f2, "air": air}


CASE = {"kind": "monitor", "title": "Bridge",
        "series": {"file": "table.csv", "time": "hour", "features": ["f1", "f2"], "covariates": ["air"]},
        "learning": {"until": 100, "hinges": 0, "lag": False}, "alarm": {"false_alarms_per_year": 1}}


class Monitor(unittest.TestCase):
    def test_a_series_in_memory(self):
        found = wt.monitor(CASE, series=series(), seed=1)
        self.assertTrue(found.alarm)
        self.assertGreaterEqual(found.alarms[0]["time"], 200)
        self.assertLessEqual(found.alarms[0]["time"], 224)
        self.assertGreater(found.probability_changed, 0.9)
        columns = found.columns()
        self.assertEqual(len(columns["time"]), 260)
        self.assertTrue(np.isnan(columns["f1"][7]))
        self.assertIn("Alarm at", repr(found))
        self.assertIn("<html", found.report())
        try:
            dataset = found.to_xarray()
        except ImportError:
            return
        self.assertEqual(list(dataset.feature.values), ["f1", "f2"])
        self.assertEqual(dataset.measured.shape, (260, 2))
        self.assertEqual(int(dataset.alarm.sum()), len(found.alarms))

    def test_what_goes_wrong(self):
        with self.assertRaisesRegex(wt.CaseError, "the series ends before this time"):
            wt.monitor(CASE, series=series(rows=60))
        with self.assertRaisesRegex(ValueError, "same length"):
            wt.monitor(CASE, series={**series(), "air": np.zeros(3)})
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(wt.FileError, "table.csv"):
            wt.monitor(CASE, output=os.path.join(folder, "out"), folder=folder)


if __name__ == "__main__":
    unittest.main()
