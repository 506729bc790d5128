"""Runs from Python are the program's runs."""
import json
import os
import pickle
import tempfile
import unittest

import numpy as np
from cases import DATA, SHORT, cantilever, program, wt


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = wt.damage(cantilever(), **SHORT)

    def test_probabilities_are_the_summarys(self):
        result = self.result
        self.assertEqual(list(result.probabilities), ["0 damages", "1 damage", "2 damages"])
        self.assertAlmostEqual(sum(result.probabilities.values()), 1.0, delta=1e-6)
        self.assertEqual(result.probabilities["1 damage"], result.summary["models"][1]["probability"])
        self.assertIn("damage", result.answer)
        self.assertEqual(result.converged, result.summary["diagnostics"]["converged"])
        self.assertIn(result.summary["answer"]["headline"], result.answer)

    def test_draws_share_memory_and_are_not_to_be_written(self):
        draws = self.result.draws
        for name in draws:
            first, second = draws[name], draws[name]
            self.assertTrue(np.shares_memory(first, second), name)
            self.assertIsNotNone(first.base)
            self.assertFalse(first.flags.owndata)
            with self.assertRaises(ValueError):
                first[0, 0] = 0
        self.assertEqual(draws["location"].shape, (4, 200, 2))
        self.assertEqual(draws.dims("location"), ("chain", "draw", "slot"))
        self.assertEqual(draws.unit("location"), "m")
        with self.assertRaisesRegex(KeyError, "there are: model, k, location, reduction"):
            draws["depth"]

    def test_chains_are_the_engines_own_memory(self):
        chain = self.result.chains[2]
        self.assertEqual(len(chain), 200)
        self.assertTrue(np.shares_memory(chain.theta, self.result.chains[2].theta))
        self.assertFalse(chain.theta.flags.owndata)
        self.assertIs(type(chain.theta.base), wt.Chain)
        two = chain.model == 2
        self.assertTrue(two.any())
        np.testing.assert_array_equal(chain.theta[two][:, [0, 2]], self.result.draws["location"][2][two])
        self.assertTrue(np.isfinite(chain.log_likelihood + chain.log_prior).all())

    def test_views_outlive_the_result(self):
        result = wt.damage(cantilever(), **SHORT)
        theta, location = result.chains[0].theta, result.draws["location"]
        before = theta.copy(), location.copy()
        del result
        scratch = [np.full(4000, 7.0) for _ in range(200)]
        np.testing.assert_array_equal(theta, before[0])
        np.testing.assert_array_equal(location, before[1])
        del scratch

    def test_draws_have_the_meaning_of_the_summary(self):
        named = self.result.summary["parameters"]["1 damage"]["location[1]"]
        x = self.result.draws_of("location[1]", "1 damage")
        self.assertAlmostEqual(x.mean(), named["mean"], places=12)
        k = self.result.draws["k"]
        self.assertTrue((np.isnan(self.result.draws["location"]).sum(axis=2) == 2 - k).all())
        with self.assertRaisesRegex(ValueError, "there are: 0 damages, 1 damage, 2 damages"):
            self.result.draws_of("location[1]", "3 damages")

    def test_threads_change_nothing(self):
        other = wt.damage(cantilever(), threads=2, **SHORT)
        np.testing.assert_array_equal(other.draws["location"], self.result.draws["location"])
        self.assertEqual(other.run_id, self.result.run_id)

    def test_the_same_files_as_the_program(self):
        os.environ["SOURCE_DATE_EPOCH"] = "0"  # the time that files say they were made
        self.addCleanup(os.environ.pop, "SOURCE_DATE_EPOCH")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "case")
            with open(path, "w") as f:
                json.dump(cantilever(), f)
            code, out, err = program("damage", path, "-o", f"{folder}/cli", "--seed", 1, "--warmup", 300, "--draws", 200,
                                     "--search", 20, "--quiet")
            self.assertEqual(code, 0, err)
            wt.damage(path, **SHORT).save(f"{folder}/python")
            self.assertEqual(sorted(os.listdir(f"{folder}/cli")), sorted(os.listdir(f"{folder}/python")))
            summaries = []
            for who in ("cli", "python"):
                with open(f"{folder}/{who}/summary.json") as f:
                    summaries.append(json.load(f))
            for s in summaries:
                s["wheeltap"].pop("command_line")
                s["cost"].pop("wall_seconds")
            self.assertEqual(*summaries)  # with the checksum of posterior.nc
            code, _, err = program("report", f"{folder}/python")
            self.assertEqual(code, 0, err)

    def test_a_date_that_is_none_is_refused(self):
        self.addCleanup(os.environ.pop, "SOURCE_DATE_EPOCH")
        result = wt.damage(cantilever(), **SHORT)
        for date in ("yesterday", "", "1.5", "-1", "1e400", "253402300800"):
            os.environ["SOURCE_DATE_EPOCH"] = date
            with tempfile.TemporaryDirectory() as folder:
                with self.assertRaisesRegex(ValueError, "^SOURCE_DATE_EPOCH: .* must be a whole number"):
                    result.save(f"{folder}/run")
                self.assertEqual(os.listdir(folder), [])

    def test_pickle(self):
        again = pickle.loads(pickle.dumps(self.result))
        self.assertEqual(again.summary, self.result.summary)
        np.testing.assert_array_equal(again.draws["location"], self.result.draws["location"])
        self.assertEqual(again.answer, self.result.answer)
        with tempfile.TemporaryDirectory() as folder:
            again.save(folder)
            self.assertTrue(os.path.exists(f"{folder}/report.html"))
        with self.assertRaisesRegex(ValueError, "from a pickle"):
            again.chains
        self.assertEqual(pickle.loads(pickle.dumps(cantilever())), cantilever())

    def test_report_is_one_page(self):
        page = self.result.report()
        self.assertTrue(page.lstrip().lower().startswith("<!doctype html"))
        self.assertIn("A cantilever", page)
        self.assertIn("srcdoc=", self.result._repr_html_())
        self.assertIn("damage", repr(self.result))

    def test_update(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(program("init", "update", "-o", folder)[0], 0)
            result = wt.update(f"{folder}/update.json", **SHORT)
        self.assertEqual(sorted(result.draws)[:3], ["k1", "k2", "k3"])
        self.assertEqual(result.draws["k1"].shape, (4, 200))
        self.assertIn("contraction", result.summary)

    def test_sid(self):
        result = wt.sid(f"{DATA}/sid/c1_duffing.case.json", changes={"truth.samples": 200}, **SHORT)
        self.assertEqual(result.draws.models, ["linear", "duffing"])
        duffing = result.draws["model"] == 1
        self.assertTrue(np.isnan(result.draws["k3"][~duffing]).all())
        self.assertTrue(np.isfinite(result.draws["k3"][duffing]).all())
        self.assertEqual(result.draws.unit("k"), "N/m")
        self.assertGreater(result.probabilities["duffing"], 0.5)

    def test_modes(self):
        found = wt.modes(cantilever(), 3)
        exact = 1.8751040687 ** 2 / (2 * np.pi) * np.sqrt(70e9 * 0.006 ** 2 / 12 / 2700)  # Euler-Bernoulli, slender
        self.assertAlmostEqual(found.frequencies_hz[0], exact, delta=1e-4 * exact)
        self.assertEqual(found.shapes.shape, (3, 41))
        self.assertTrue(found.certified)
        damaged = wt.modes(cantilever(), 3, truth=True)
        self.assertTrue((damaged.frequencies_hz < found.frequencies_hz).all())
        self.assertEqual(len(wt.modes(f"{DATA}/structures/portal-frame.json", 4)), 4)

    def test_simulate(self):
        made = wt.simulate(cantilever(), seed=3)
        self.assertEqual(len(made["data"]["frequencies"]), 5)
        self.assertEqual(made, wt.simulate(cantilever(), seed=3))
        self.assertNotEqual(made, wt.simulate(cantilever(), seed=4))
        record = wt.simulate(f"{DATA}/sid/c1_duffing.case.json")
        self.assertEqual(record.samples, 2000)
        self.assertAlmostEqual(record.sample_rate, 100.0, places=6)
        self.assertEqual(record.units["displacement"], "m")

    def test_records(self):
        path = f"{DATA}/uff/measurement_points1-2.uff"
        self.assertEqual(wt.data(path)["format"], json.loads(program("data", path, "--json")[1])["format"])
        with tempfile.TemporaryDirectory() as folder:
            with open(f"{folder}/r.csv", "w") as f:
                f.write("time [s],a [m/s^2]\n0,1\n0.5,2\n1,4\n")
            record = wt.read_record(f"{folder}/r.csv")
        np.testing.assert_array_equal(record["a"], [1, 2, 4])
        self.assertEqual((record.sample_rate, record.units["a"]), (2.0, "m/s^2"))
        self.assertFalse(record["a"].flags.owndata)

    def test_schema(self):
        self.assertEqual(wt.schema("sid"), json.loads(program("schema", "sid")[1]))


if __name__ == "__main__":
    unittest.main()
