"""Chains whose links pull as Python functions say: against the program's own laws, closed forms, and the step."""
import unittest

import numpy as np
from cases import wt

# Two masses, the upper one driven; a softening friction-like law that both sides know: cubic and quadratic damping.
CASE = {
    "kind": "sid", "title": "rig",
    "record": {"channels": [
        {"column": "force [N]", "role": "force", "mass": 2},
        {"column": "y1 [m]", "role": "response", "mass": 1, "quantity": "displacement"},
        {"column": "y2 [m/s^2]", "role": "response", "mass": 2, "quantity": "acceleration"}]},
    "parameters": {"k": {"uniform": [1, 1000]}, "k3": {"uniform": [0, 1e6]}, "q": {"uniform": [0, 100]}},
    "models": [{"name": "own", "masses": [2.0, 1.0], "noise": 1e-6, "links": [
        {"between": [0, 1], "stiffness": "k", "damping": 0.4},
        {"between": [1, 2], "stiffness": 300, "damping": 0.2, "cubic": "k3", "quadratic_damping": "q"}]}],
    "truth": {"model": "own", "parameters": {"k": 400, "k3": 2e5, "q": 3.0}, "noise": 0, "samples": 400,
              "sample_rate": 50, "seed": 3,
              "excitation": [{"mass": 2, "kind": "band-limited", "low": 0.5, "high": 8, "variance": 4}]}}
TRUE = {"k": 400.0, "k3": 2e5, "q": 3.0}


def lower(e, rate, p):
    return p["k"] * e + 0.4 * rate


def upper(e, rate, p):
    return 300 * e + 0.2 * rate + p["k3"] * e**3 + p["q"] * rate * np.abs(rate)


def rig(record, steps=16, noise=0.01, **changes):
    said = dict(masses=[2.0, 1.0], links=[wt.Link((0, 1), lower), wt.Link((1, 2), upper)], sample_rate=50.0,
                forces={2: record["force"]}, steps=steps,
                responses=[wt.Response(1, record["y1"], noise),
                           wt.Response(2, record["y2"], noise, "acceleration")])
    return wt.Rig(**{**said, **changes})


class Rigs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.record = wt.simulate(CASE)

    def test_moves_as_the_programs_own_chain(self):
        moved = rig(self.record).simulate(TRUE)
        for column, quantity, mass in (("y1", "displacement", 0), ("y2", "acceleration", 1)):
            own = self.record[column]
            error = np.sqrt(np.mean((moved[quantity][:, mass] - own) ** 2) / np.mean(own ** 2))
            self.assertLess(error, 2e-6, column)  # the program's own step leaves up to 1e-6

    def test_the_step_error_falls_with_the_fourth_power(self):
        errors = [rig(self.record, steps).step_error(TRUE) for steps in (4, 8, 16)]
        for coarse, fine in zip(errors, errors[1:]):
            self.assertGreater(np.log2(coarse / fine), 3.6)
            self.assertLess(np.log2(coarse / fine), 4.4)

    def test_a_moved_base_is_a_force_on_every_mass(self):
        t = np.arange(400) / 50.0
        base = np.sin(9 * t)
        moved = rig(self.record, forces={}, base_acceleration=base).simulate(TRUE)
        pushed = rig(self.record, forces={1: -2.0 * base, 2: -1.0 * base}).simulate(TRUE)
        np.testing.assert_allclose(moved["displacement"], pushed["displacement"], rtol=0, atol=1e-14)
        np.testing.assert_allclose(moved["acceleration"] - base[:, None], pushed["acceleration"], rtol=0, atol=1e-12)

    def test_likelihood_of_a_batch(self):
        model = rig(self.record, steps=8, noise="sigma").model(
            "mine", {"sigma": wt.log_uniform(1e-4, 1), "k": wt.uniform(1, 1000), "k3": wt.uniform(0, 1e6),
                     "q": wt.uniform(0, 100)})
        x = np.array([[0.01, 400, 2e5, 3.0], [0.02, 350, 2e5, 3.0], [0.01, 400, -1e12, 3.0]])
        values = model.log_likelihood(x)
        for row, value in zip(x[:2], values[:2]):
            moved = rig(self.record, steps=8).simulate(dict(zip(["k", "k3", "q"], row[1:])))
            r = np.concatenate([self.record["y1"] - moved["displacement"][:, 0],
                                self.record["y2"] - moved["acceleration"][:, 1]])
            exact = np.sum(-0.5 * (r / row[0]) ** 2 - np.log(row[0] * np.sqrt(2 * np.pi)))
            self.assertAlmostEqual(value / exact, 1.0, places=10)
        self.assertEqual(values[2], -np.inf)  # runs away
        self.assertAlmostEqual(model.log_likelihood(x[1:2])[0] / values[1], 1.0, places=12)

    def test_a_law_is_found(self):
        """A spring that hardens by a law of no list, T = k e + a sinh(e / e0), against a linear one."""
        rng = np.random.default_rng(5)
        force = 3.0 * rng.standard_normal(60)
        linear = wt.Link((0, 1), lambda e, rate, p: p["k"] * e + 0.5 * rate)
        sinh = wt.Link((0, 1), lambda e, rate, p: p["k"] * e + p["a"] * np.sinh(e / 0.03) + 0.5 * rate)

        def of(link, y):
            return wt.Rig([1.0], [link], [wt.Response(1, y, 2e-3)], 20.0, {1: force}, steps=2)

        clean = of(sinh, np.zeros(60)).simulate({"k": 60.0, "a": 0.5})["displacement"][:, 0]
        y = clean + 2e-3 * rng.standard_normal(60)
        k = {"k": wt.uniform(1, 200)}
        found = wt.sample([of(linear, y).model("linear", k), of(sinh, y).model("sinh", {**k, "a": wt.uniform(0, 5)})],
                          seed=1, warmup=200, draws=200, progress=False)
        self.assertGreater(found.probabilities["sinh"], 0.99)
        told = found.summary["parameters"]["sinh"]["a"]
        self.assertLess(abs(told["mean"] - 0.5), 4 * told["sd"])
        self.assertLess(told["sd"], 0.2)

    def test_refusals(self):
        def refused(words, make):
            with self.assertRaises(wt.CaseError) as caught:
                make()
            self.assertIn(words, str(caught.exception))

        good = {"k": wt.uniform(1, 1000), "k3": wt.uniform(0, 1e6), "q": wt.uniform(0, 100)}
        record = self.record
        refused("\"k9\" of model \"m\": no mass", lambda: rig(record).model("m", {**good, "k9": wt.uniform(0, 1)}))
        refused("\"q\" is not a parameter", lambda: rig(record).model("m", {n: good[n] for n in ("k", "k3")}))
        refused("mass 3", lambda: rig(record, forces={3: record["force"]}))
        refused("between (0, 5)", lambda: rig(record, links=[wt.Link((0, 5), lower)]))
        refused("399 samples", lambda: rig(record, forces={2: record["force"][1:]}))
        refused("finite", lambda: rig(record, base_acceleration=np.full(400, np.nan)))
        refused("quantity \"place\"", lambda: rig(record, responses=[wt.Response(1, record["y1"], 1.0, "place")]))
        refused("steps = 0", lambda: rig(record, steps=0))
        refused("sample_rate", lambda: rig(record, sample_rate=0.0))
        refused("at least one", lambda: rig(record, links=[]))


if __name__ == "__main__":
    unittest.main()
