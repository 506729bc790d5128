"""Likelihoods of Python's own: known answers, and what goes wrong."""
import os
import tempfile
import unittest

import numpy as np
from cases import wt

QUICK = {"seed": 1, "warmup": 500, "draws": 1000, "progress": False}

# n = 20 readings of mean 0.5 and unit noise: M0 has mean 0, M1 mean μ ~ N(0, 1). In closed form
# BF10 = (1 + n)^(-1/2) exp(n² ȳ² / (2 (n + 1))) = 2.360070, and μ | M1 ~ N(n ȳ / (n + 1), 1 / (n + 1)).
N, MEAN = 20, 0.5
BAYES_FACTOR = np.exp(N ** 2 * MEAN ** 2 / (2 * (N + 1))) / np.sqrt(1 + N)


def nothing(x):
    return np.full(len(x), -0.5 * N * MEAN ** 2)


def something(x):
    return -0.5 * N * (MEAN - x[:, 0]) ** 2


def models(**changes):
    first = {"name": "nothing", "parameters": {}, "log_likelihood": nothing}
    second = {"name": "something", "parameters": {"mu": wt.normal(0, 1)}, "log_likelihood": something}
    second.update(changes)
    return [wt.Model(**first), wt.Model(**second)]


class Engine(unittest.TestCase):
    def test_a_bayes_factor_in_closed_form(self):
        self.assertAlmostEqual(BAYES_FACTOR, 2.360070, places=5)
        result = wt.sample(models(), **{**QUICK, "draws": 5000})
        exact = BAYES_FACTOR / (1 + BAYES_FACTOR)
        told = result.summary["models"][1]
        self.assertLess(abs(told["probability"] - exact), 4.5 * told["mcse"] + 1e-12)
        self.assertLess(told["mcse"], 0.02)
        mu = result.summary["parameters"]["something"]["mu"]
        error = 1 / np.sqrt((N + 1) * mu["ess_bulk"])
        self.assertLess(abs(mu["mean"] - N * MEAN / (N + 1)), 4.5 * error)
        self.assertTrue(np.isnan(result.draws["mu"][result.draws["model"] == 0]).all())
        self.assertIn("something", result.answer)

    def test_prior_weights_count(self):
        result = wt.sample(models(prior=3.0), **QUICK)
        told = result.summary["models"][1]
        self.assertAlmostEqual(told["prior"], 0.75, places=12)
        exact = 3 * BAYES_FACTOR / (1 + 3 * BAYES_FACTOR)
        self.assertLess(abs(told["probability"] - exact), 4.5 * told["mcse"])

    def test_a_likelihood_of_nothing_returns_the_prior(self):
        for prior, mean, sd in ((wt.table([0, 1, 2], [0, 5, 0]), 1.0, 6 ** -0.5), (wt.inverse_gamma(5, 2), 0.5, 12 ** -0.5),
                                (wt.student_t(8, 3, 1), 3.0, (8 / 6) ** 0.5)):
            told = wt.sample(wt.Model("it", {"x": prior}, lambda x: np.zeros(len(x))), **QUICK).draws_of("x", "it")
            self.assertAlmostEqual(told.mean(), mean, delta=5 * sd / np.sqrt(len(told) / 4), msg=str(prior))
            self.assertAlmostEqual(told.std() / sd, 1.0, delta=0.25, msg=str(prior))

    def test_one_model_needs_no_list(self):
        alone = wt.sample(models()[0], **QUICK)
        self.assertEqual(list(alone.probabilities), [models()[0].name])
        with self.assertRaisesRegex(TypeError, "must be of the type wt.Model, and one is str"):
            wt.sample(["nothing"], **QUICK)

    def test_one_row_at_a_time_gives_the_same_draws(self):
        batch = wt.sample(models(), **QUICK)
        single = wt.sample([wt.Model("nothing", {}, lambda x: float(nothing(x[None])[0]), batch=False),
                            wt.Model("something", {"mu": wt.normal(0, 1)},
                                     lambda x: float(something(x[None])[0]), batch=False)], **QUICK)
        np.testing.assert_array_equal(batch.draws["mu"], single.draws["mu"])
        threads = wt.sample(models(), threads=2, **QUICK)
        np.testing.assert_array_equal(batch.draws["mu"], threads.draws["mu"])

    def test_batches_come_while_models_are_searched(self):
        sizes = []

        def counted(x):
            sizes.append(len(x))
            return something(x)

        wt.sample(models(log_likelihood=counted), **QUICK)
        self.assertGreaterEqual(max(sizes), 16)
        self.assertIn(1, sizes)

    def test_what_a_function_keeps_stays_as_it_was(self):
        kept = []

        def keeping(x):
            kept.append((x, x.copy()))
            return something(x)

        wt.sample(models(log_likelihood=keeping), **{**QUICK, "draws": 200})
        for array, copy in kept:
            np.testing.assert_array_equal(array, copy)

    def test_exceptions_come_through(self):
        def broken(x):
            raise ZeroDivisionError("in the user's function")

        with self.assertRaisesRegex(ZeroDivisionError, "in the user's function"):
            wt.sample(models(log_likelihood=broken), **QUICK)

    def test_misshapen_returns(self):
        with self.assertRaisesRegex(ValueError, '"something": must return .* numbers for .* rows'):
            wt.sample(models(log_likelihood=lambda x: np.zeros((len(x), 2))), **QUICK)
        with self.assertRaisesRegex(TypeError, "must return an array of numbers, returned str"):
            wt.sample(models(log_likelihood=lambda x: "much"), **QUICK)
        with self.assertRaisesRegex(TypeError, r"must return one number, returned ndarray of shape \(5,\)"):
            wt.sample(models(log_likelihood=lambda x: np.zeros(5), batch=False), **QUICK)
        with self.assertRaisesRegex(wt.CaseError, "^sample: .*something"):
            wt.sample(models(log_likelihood=lambda x: np.full(len(x), np.nan)), **QUICK)

    def test_wrong_models(self):
        with self.assertRaisesRegex(wt.CaseError, "/models/1/parameters/mu/uniform: .*lower"):
            wt.sample(models(parameters={"mu": wt.uniform(1, 0)}), **QUICK)
        with self.assertRaisesRegex(wt.CaseError, "/models/1/parameters/mu/flat: .*unknown key"):
            wt.sample(models(parameters={"mu": {"flat": [0, 1]}}), **QUICK)
        other = wt.Model("other", {"mu": wt.normal(0, 2)}, something)
        with self.assertRaisesRegex(wt.CaseError, "/models/2/parameters/mu: .*same name"):
            wt.sample([*models(), other], **QUICK)
        with self.assertRaisesRegex(wt.CaseError, "/models: .*nothing"):
            wt.sample([models()[0], models()[0]], **QUICK)
        with self.assertRaisesRegex(wt.CaseError, "/models: "):
            wt.sample([], **QUICK)

    def test_columns_are_in_the_order_of_the_parameters(self):
        # Not that of the alphabet: z ~ N(1, 0.1²), a ~ N(5, 0.1²), and a likelihood that is flat.
        seen = []

        def flat(x):
            seen.append(x)
            return np.zeros(len(x))

        result = wt.sample([wt.Model("m", {"z": wt.normal(1, 0.1), "a": wt.normal(5, 0.1)}, flat)], **QUICK)
        x = np.concatenate(seen)
        self.assertLess(np.abs(x.mean(axis=0) - [1, 5]).max(), 0.5)
        self.assertLess(abs(result.draws["z"].mean() - 1), 0.05)
        self.assertLess(abs(result.draws["a"].mean() - 5), 0.05)

    def test_a_prior_by_its_quantiles(self):
        # N(0, 1) by Φ⁻¹ instead of by name: the same problem, and the closed form of the first test.
        from statistics import NormalDist
        inverse = np.vectorize(NormalDist().inv_cdf, otypes=[float])

        def quantile(u):
            return inverse(np.clip(u, 1e-300, 1 - 1e-16))

        told = wt.sample(models(parameters={"mu": wt.from_quantiles(quantile)}), **{**QUICK, "draws": 5000})
        exact = BAYES_FACTOR / (1 + BAYES_FACTOR)
        p = told.summary["models"][1]
        self.assertLess(abs(p["probability"] - exact), 4.5 * p["mcse"])
        mu = told.summary["parameters"]["something"]["mu"]
        self.assertLess(abs(mu["mean"] - N * MEAN / (N + 1)), 4.5 / np.sqrt((N + 1) * mu["ess_bulk"]))
        self.assertLess(abs(mu["sd"] * np.sqrt(N + 1) - 1), 0.1)
        self.assertAlmostEqual(told.draws_of("mu", "something").mean(), mu["mean"], places=12)
        self.assertEqual(told.summary["priors"]["mu"], "by its quantile function")
        one, other = wt.from_quantiles(quantile), wt.from_quantiles(quantile)
        with self.assertRaisesRegex(wt.CaseError, "mu: .*same name"):
            wt.sample([wt.Model("a", {"mu": one}, something), wt.Model("b", {"mu": other}, something)], **QUICK)

    def test_save_and_report(self):
        result = wt.sample(models(), title="Is there anything?", **QUICK)
        with tempfile.TemporaryDirectory() as folder:
            result.save(folder)
            self.assertEqual(sorted(os.listdir(folder)), ["posterior.nc", "report.html", "summary.json", "summary.txt"])
        self.assertIn("Is there anything?", result.report())
        self.assertIn("Is there anything?", result.text)


if __name__ == "__main__":
    unittest.main()
