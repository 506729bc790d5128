"""Effective sample sizes and R-hat of summary.json, made again in Python from posterior.nc.

Written from the formulas of Vehtari, Gelman, Simpson, Carpenter & Bürkner (2021, Bayesian Analysis 16:667), sections
3.2, 4.1 and 4.3, and of Geyer (1992), with NumPy alone, not from our C++.
"""
import os
import sys
import tempfile
import unittest
from statistics import NormalDist

import numpy as np
from cases import cantilever, wt

try:
    import netCDF4
    import xarray  # noqa: F401
except ImportError as missing:
    raise unittest.SkipTest(str(missing))

if sys.version_info < (3, 9):
    raise unittest.SkipTest("Python 3.9")


def split(x):
    """Halves of chains as chains of their own; the middle draw of an odd number is left out."""
    n = x.shape[1] // 2
    return np.concatenate([x[:, :n], x[:, -n:]])


def average_ranks(x):
    """Ranks from 1, ties sharing their mean rank."""
    flat = x.ravel()
    values, place, count = np.unique(flat, return_inverse=True, return_counts=True)
    last = np.cumsum(count)
    return (last - 0.5 * (count - 1))[place].reshape(x.shape)


def rank_normalised(x):
    """z = Φ⁻¹((r - 3/8) / (S + 1/4)), eq. (14)."""
    inverse = np.vectorize(NormalDist().inv_cdf)
    return inverse((average_ranks(x) - 0.375) / (x.size + 0.25))


def plain_rhat(x):
    """√(((n-1)/n W + B/n) / W), eqs. (1) to (4), of chains in rows."""
    n = x.shape[1]
    within = x.var(axis=1, ddof=1).mean()
    between = n * x.mean(axis=1).var(ddof=1)
    return np.sqrt(((n - 1) / n * within + between / n) / within)


def rhat(x):
    """The larger of bulk and folded, section 4.1."""
    halves = split(x)
    folded = np.abs(halves - np.median(halves))
    return max(plain_rhat(rank_normalised(halves)), plain_rhat(rank_normalised(folded)))


def autocovariance(x):
    """Biased (1/n), by the definition, of one chain, at all lags; by the Fourier transform."""
    n = len(x)
    spectrum = np.fft.rfft(x - x.mean(), 2 * n)
    return np.fft.irfft(np.abs(spectrum) ** 2)[:n] / n


def ess(x):
    """S / τ with Geyer's initial monotone sequence, section 3.2, of chains in rows. The even term at which the positive
    sequence ends counts once, as in R's posterior: it improves the estimate of antithetic chains."""
    m, n = x.shape
    cov = np.array([autocovariance(row) for row in x])
    within = cov[:, 0].mean() * n / (n - 1)
    total = within * (n - 1) / n + (x.mean(axis=1).var(ddof=1) if m > 1 else 0.0)
    rho = 1.0 - (within - cov.mean(axis=0) * n / (n - 1)) / total
    rho[0] = 1.0
    pairs = [rho[2 * t] + rho[2 * t + 1] for t in range(n // 2)]
    kept, last_even = [], 0.0
    for t, pair in enumerate(pairs):
        if pair <= 0.0 and t > 0:
            last_even = max(rho[2 * t], 0.0)
            break
        kept.append(min(pair, kept[-1]) if kept else pair)
    tau = -1.0 + 2.0 * sum(kept) + last_even
    return m * n / max(tau, 1.0 / np.log10(m * n))


def ess_bulk(x):
    return ess(rank_normalised(split(x)))


def ess_tail(x):
    halves = split(x)
    return min(ess((halves <= np.quantile(x, q)).astype(float)) for q in (0.05, 0.95))


class Diagnostics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        case = cantilever()
        case["damage"]["count"] = {"min": 1, "max": 1, "prior": "uniform"}
        cls.result = wt.damage(case, seed=2, warmup=1000, draws=2000, progress=False)
        cls.folder = tempfile.TemporaryDirectory()
        cls.result.save(cls.folder.name)
        with netCDF4.Dataset(os.path.join(cls.folder.name, "posterior.nc")) as file:
            cls.draws = {name: np.array(file["posterior"][name])[..., 0] for name in ("location", "reduction")}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_rhat_and_ess_to_three_digits(self):
        told = self.result.summary["parameters"]["1 damage"]
        for name, x in self.draws.items():
            ours = told[f"{name}[1]"]
            self.assertEqual(x.shape, (4, 2000))
            self.assertLess(abs(rhat(x) - ours["rhat"]), 5e-4, name)
            for quantity, here in (("ess_bulk", ess_bulk(x)), ("ess_tail", ess_tail(x))):
                self.assertLess(abs(here / ours[quantity] - 1.0), 1e-3, f"{quantity} of {name}: {here} {ours[quantity]}")

    def test_the_check_can_fail(self):
        x = self.draws["location"].copy()
        x[0] += 0.3 * x.std()
        self.assertGreater(rhat(x), 1.01)
        self.assertGreater(abs(rhat(x) - self.result.summary["parameters"]["1 damage"]["location[1]"]["rhat"]), 5e-3)

    def test_an_autoregression_of_known_length(self):
        # x_t = φ x_{t-1} + e: τ = (1 + φ) / (1 - φ); 4 chains of 20 000, so the estimate is good to some percent.
        random = np.random.default_rng(1)
        phi, e = 0.6, random.standard_normal((4, 20000))
        x = np.empty_like(e)
        x[:, 0] = e[:, 0] / np.sqrt(1 - phi ** 2)
        for t in range(1, x.shape[1]):
            x[:, t] = phi * x[:, t - 1] + e[:, t]
        self.assertLess(abs(ess_bulk(x) / (x.size * (1 - phi) / (1 + phi)) - 1.0), 0.1)

    def test_netcdf4_reads_what_draws_are(self):
        np.testing.assert_array_equal(self.draws["location"], self.result.draws["location"][..., 0])

    def test_xarray_has_the_groups(self):
        groups = self.result.to_xarray()
        posterior = groups["posterior"]
        self.assertEqual(tuple(posterior["location"].dims), ("chain", "draw", "slot"))
        np.testing.assert_array_equal(posterior["location"].values, self.result.draws["location"])
        self.assertEqual(posterior["location"].attrs["units"], "m")
        self.assertLessEqual({"posterior", "sample_stats", "observed_data", "posterior_predictive"}, set(groups))
        lp = groups["sample_stats"]["lp"].values
        chain = self.result.chains[1]
        np.testing.assert_array_equal(lp[1], chain.log_prior + chain.log_likelihood)

    def test_load(self):
        again = wt.load(self.folder.name)
        self.assertEqual(again.summary["models"], self.result.summary["models"])
        np.testing.assert_array_equal(again.draws["location"], self.result.draws["location"])
        self.assertEqual(again.draws.models, self.result.draws.models)
        with self.assertRaises(wt.FileError):
            wt.load(os.path.join(self.folder.name, "nowhere"))


if __name__ == "__main__":
    unittest.main()
