"""Every standard figure is drawn, and shows the run's numbers."""
import os
import unittest

os.environ["MPLBACKEND"] = "Agg"

import numpy as np
from cases import DATA, SHORT, cantilever, wt

try:
    import matplotlib.pyplot as plt
    import netCDF4  # noqa: F401
    import xarray  # noqa: F401
except ImportError as missing:
    raise unittest.SkipTest(str(missing))


class Plot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.damage = wt.damage(cantilever(), **SHORT)
        cls.sid = wt.sid(f"{DATA}/sid/c1_duffing.case.json", changes={"truth.samples": 200}, **SHORT)

    def tearDown(self):
        for number in plt.get_fignums():
            plt.figure(number).canvas.draw()
        plt.close("all")

    def test_models(self):
        ax = wt.plot.models(self.damage)
        self.assertEqual([bar.get_width() for bar in ax.patches], list(self.damage.probabilities.values()))
        mine = plt.subplots()[1]
        self.assertIs(wt.plot.models(self.sid, ax=mine), mine)

    def test_inclusion(self):
        ax = wt.plot.inclusion(self.damage)
        values = ax.patches[0].get_data().values
        self.assertEqual(len(values), 40)
        self.assertAlmostEqual(values.sum(), self.damage.draws["k"].mean(), delta=0.02)
        with self.assertRaisesRegex(ValueError, "needs a damage run of a beam"):
            wt.plot.inclusion(self.sid)

    def test_where(self):
        self.assertEqual(len(wt.plot.where(self.damage).patches), 1)  # a beam's own figure
        frame = wt.damage(f"{DATA}/structures/cracked-portal.json", **SHORT)
        ax = wt.plot.where(frame)
        widths = [bar.get_width() for bar in ax.patches]
        self.assertEqual(widths, sorted(widths, reverse=True))
        told = frame.summary["damage"]["inclusion_by_member"]
        self.assertEqual(len(widths), sum(map(len, told.values())))
        for label, width in zip(ax.get_yticklabels(), widths):
            kind, place = label.get_text().split(": ")
            self.assertAlmostEqual(told[kind][place], width, delta=1e-9)
        truth = [(kind["name"], one.get("member", one.get("node"))) for kind in frame.summary["kinds"]
                 for one in kind["truth"]]
        dots = {ax.get_yticklabels()[int(row)].get_text() for row in ax.lines[0].get_ydata()}
        self.assertEqual(dots, {f"{kind}: {place}" for kind, place in truth})
        with self.assertRaisesRegex(ValueError, "needs a damage run of a structure"):
            wt.plot.where(self.sid)

    def test_pairs(self):
        axes = wt.plot.pairs(self.damage, "2 damages")
        self.assertEqual(axes.shape, (4, 4))
        self.assertEqual(wt.plot.pairs(self.sid, parameters=["k", "k3"]).shape, (2, 2))
        with self.assertRaisesRegex(ValueError, "has no parameters"):
            wt.plot.pairs(self.damage, "0 damages")

    def test_traces(self):
        axes = wt.plot.traces(self.damage)
        self.assertEqual([ax.get_ylabel() for ax in axes],
                         ["model", "k", "location[1]", "location[2]", "reduction[1]", "reduction[2]"])
        np.testing.assert_array_equal(axes[1].lines[0].get_ydata(), self.damage.draws["k"][0])

    def test_frequencies(self):
        ax = wt.plot.frequencies(self.damage)
        self.assertEqual(len(ax.lines[1].get_xdata()), 5)
        with self.assertRaisesRegex(ValueError, "no measured frequencies"):
            wt.plot.frequencies(self.sid)

    def test_record(self):
        ax = wt.plot.record(self.sid)
        self.assertEqual(len(ax.lines[0].get_xdata()), 200)
        with self.assertRaisesRegex(ValueError, "there are: displacement"):
            wt.plot.record(self.sid, "velocity")
        with self.assertRaisesRegex(ValueError, "has no record"):
            wt.plot.record(self.damage)

    def test_stabilisation(self):
        t = np.arange(8000) / 50.0
        noise = np.random.default_rng(1).standard_normal((2, 8000))
        y = np.zeros((2, 8000))
        for row, (f, zeta) in zip(range(2), ((5.0, 0.02), (9.0, 0.02))):
            w = 2 * np.pi * f
            h = np.exp(-zeta * w * t[:500]) * np.sin(w * t[:500])
            y[row] = np.convolve(noise[row], h)[:8000]
        modal = wt.modal(channels={"a": y[0] + y[1], "b": y[0] - y[1]}, sample_rate=50, band=[1, 20])
        self.assertGreaterEqual(len(modal), 2)
        ax = wt.plot.stabilisation(modal)
        self.assertEqual(ax.get_xlim(), (1.0, 20.0))


if __name__ == "__main__":
    unittest.main()
