"""Tests of the Python package armcmc; run by ctest with the package of the build tree on the path."""

import csv
import os
import subprocess
import sys
import unittest

import armcmc
import numpy as np
from support import DT, LINE, PROGRAMS, SOURCE, InScratch, contact

GROWTH = """schema = 1
name = "growth"
title = "Gain with a lognormal prior"
output = "y"
law = "g*x"
[signals]
x = { unit = "1" }
y = { unit = "1" }
[parameters]
g = { unit = "1", prior = "lognormal", mean = 2.0, sd = 1.0 }
[noise]
law = "gaussian"
std = 0.1
estimate = true
"""


class Package(unittest.TestCase):
    def test_has_the_version_of_the_programs(self):
        text = (SOURCE / "CMakeLists.txt").read_text()
        self.assertIn(f"VERSION {armcmc.__version__} ", text)

    def test_knows_the_plants_that_came_along(self):
        there = sorted(file.parent.name for file in (SOURCE / "core/plants").glob("*/plant.toml"))
        self.assertEqual(armcmc.models(), there)

    def test_says_what_a_pack_holds_and_what_is_sampled(self):
        e = armcmc.Estimator("servo_axis")
        self.assertEqual([(i.name, i.unit) for i in e.inputs], [("q", "m"), ("v", "m/s"), ("a", "m/s^2")])
        self.assertEqual((e.output.name, e.output.unit), ("F", "N"))
        self.assertEqual([(p.name, p.unit, p.mean, p.upper) for p in e.parameters],
                         [("M", "kg", 90.0, 500.0), ("Fv", "N s/m", 200.0, 2000.0), ("off", "N", 0.0, 80.0)])
        self.assertEqual(e.draw_names(), ["M", "Fv", "off", "noise_std"])


class Configuration(InScratch):
    def refused(self, words, *arguments, **keywords):
        with self.assertRaises(ValueError) as caught:
            armcmc.Estimator(*arguments, **keywords)
        self.assertIn(words, str(caught.exception))
        self.assertNotIn("--model", str(caught.exception))

    def test_says_what_is_wrong(self):
        self.refused("did you mean servo_axis?", "servo_axs")
        self.refused("none.toml: cannot be read", "none.toml")
        self.refused("sampler.drws: unknown key (did you mean draws?)", "servo_axis", sampler={"drws": 1000})
        self.refused("sampler.draws = 5: expected an integer in [200", "servo_axis", sampler={"draws": 5})
        self.refused("nosie: unknown key (did you mean noise?)", "servo_axis", nosie={"std": 1.0})
        self.refused("expected a number, a text", "servo_axis", sampler={"draws": None})
        self.refused("none: no such file", "servo_axis", config="none")
        self.refused("law", self.file("bad.toml", LINE.replace("a*x + b", "a*z + b")))
        self.refused("wrong.toml:2", "servo_axis", config=self.file("wrong.toml", "schema = 1\nmodel = 3\n"))

    def test_keywords_replace_keys_of_the_file_and_leave_the_others(self):
        config = self.file("own.toml", "schema = 1\n[sampler]\ndraws = 700\nseed = 5\n[timing]\nperiod_ms = 50\n")
        t, u, y = contact(100)

        def draws(**overrides):
            return armcmc.Estimator("hunt_crossley", config, **overrides).step(u, y, DT).modes[0].draws

        self.assertEqual(draws(), 700)
        self.assertEqual(draws(sampler={"draws": np.int64(900)}), 900)
        e = [armcmc.Estimator("hunt_crossley", c, sampler=s).step(u, y, DT)["K"].mean
             for c, s in [(config, {"draws": 900}), (None, {"draws": 900, "seed": 5}), (None, {"draws": 900, "seed": 6})]]
        self.assertEqual(e[0], e[1])
        self.assertNotEqual(e[0], e[2])


class Steps(InScratch):
    def test_a_linear_plant_agrees_with_least_squares(self):
        rng = np.random.default_rng(3)
        x = rng.uniform(-1.0, 1.0, 200)
        y = 3.0 * x - 2.0 + 0.5 * rng.standard_normal(200)
        estimate = self.line(sampler={"seed": 1}).step(x[:, None], y, DT)
        design = np.column_stack([x, np.ones_like(x)])
        wanted = np.linalg.lstsq(design, y, rcond=None)[0]
        sd = 0.5 * np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
        for name, mean, s in zip("ab", wanted, sd):
            q, n = estimate[name], estimate.modes[0].kish_ess
            # Monte Carlo errors, five times: of a mean, and of a standard deviation by the chain.
            self.assertLess(abs(q.mean - mean), 5.0 * s / np.sqrt(n))
            self.assertLess(abs(q.sd / s - 1.0), 5.0 / np.sqrt(2.0 * estimate.modes[0].ess))
            self.assertLess(abs(q.quantiles[4] - mean - 1.96 * s), 0.3 * s)
            edges, density = q.histogram
            self.assertEqual((edges.size, density.size), (65, 64))
            self.assertAlmostEqual(float(np.sum(density * np.diff(edges))), 1.0, places=9)
            self.assertEqual(q.unit, {"a": "N/m", "b": "N"}[name])
        self.assertTrue(estimate.modes[0].known)

    def test_says_what_is_wrong_with_a_pack_and_is_as_before(self):
        e, other = self.line(), self.line()
        u, y = np.linspace(0.0, 1.0, 50)[:, None], np.linspace(0.0, 2.0, 50)
        bad = [
            ("u has 2 columns, expected 1: x", (np.zeros((50, 2)), y, DT)),
            ("u has shape (50,), expected (samples, 1)", (u[:, 0], y, DT)),
            ("y has shape (50, 1), expected (samples,)", (u, y[:, None], DT)),
            ("u has 49 rows and y 50 samples", (u[:49], y, DT)),
            ("at most 256 samples, y has 257: cut the data", (np.zeros((257, 1)), np.zeros(257), DT)),
            ("y is empty", (np.zeros((0, 1)), np.zeros(0), DT)),
            ("y is not finite at sample 7", (u, np.where(np.arange(50) == 7, np.nan, y), DT)),
            ("u, column x, is not finite at sample 0", (np.full((50, 1), np.inf), y, DT)),
            ("y is no array of real numbers", (u, y + 1j, DT)),
            ("dt is the sample interval in seconds", (u, y, 0.0)),
            ("dt = None: give a number", (u, y, None)),
            ("t_last is not a number", (u, y, DT, np.nan)),
            ("give packs in order, or call reset()", (u, y, DT, 0.01)),
        ]
        first = e.step(u, y, DT)
        other.step(u, y, DT)
        for words, arguments in bad:
            with self.subTest(words), self.assertRaises(ValueError) as caught:
                e.step(*arguments)
            self.assertIn(words, str(caught.exception))
        after, wanted = e.step(u, y, DT), other.step(u, y, DT)
        self.assertEqual((first.seq, after.seq), (1, 2))
        self.assertEqual(after["a"].mean, wanted["a"].mean)
        self.assertAlmostEqual(after.t_last, 0.1)

    def test_packs_that_are_missing_leave_out_their_numbers(self):
        e = self.line()
        u, y = np.linspace(0.0, 1.0, 50)[:, None], np.linspace(0.0, 2.0, 50)
        self.assertEqual([e.step(u, y, DT, t).seq for t in (0.05, 0.10, 0.25)], [1, 2, 5])
        self.assertEqual(e.step(u, y, DT).t_last, 0.30)

    def test_reset_forgets(self):
        e = self.line(sampler={"seed": 4})
        u, y = np.linspace(0.0, 1.0, 50)[:, None], np.linspace(0.0, 2.0, 50)
        first = e.step(u, y, DT)
        self.assertNotEqual(e.step(u, y, DT)["a"].mean, first["a"].mean)
        e.reset()
        again = e.step(u, y, DT)
        self.assertEqual((again.seq, again["a"].mean), (1, first["a"].mean))


class Draws(InScratch):
    def test_their_weighted_mean_is_the_published_one(self):
        e = armcmc.Estimator("hunt_crossley", sampler={"seed": 2})
        _, u, y = contact(500)
        for pack in np.split(np.arange(500), 5):
            estimate = e.step(u[pack], y[pack], DT)
        samples, weights = e.draws()
        self.assertEqual(samples.shape, (weights.size, 3))
        self.assertAlmostEqual(float(weights.sum()), 1.0, places=9)
        self.assertEqual(e.draw_names(), ["K", "B", "p"])
        mean = weights @ samples
        for name, value in zip(e.draw_names(), mean):
            q = estimate[name]
            # Control variates take sampling error out of the published one.
            self.assertLess(abs(value - q.mean), 5.0 * q.sd / np.sqrt(estimate.modes[0].kish_ess), name)

    def test_are_of_the_end_of_a_pack_in_which_parameters_move(self):
        e = armcmc.Estimator("hunt_crossley", sampler={"seed": 2})
        t, u, y = contact(6000)
        y = y + u[:, 0] ** 1.7 * 0.3 * t  # K grows by 0.3 N/m^p per second
        for pack in np.split(np.arange(6000), 60):
            estimate = e.step(u[pack], y[pack], DT)
        self.assertGreater(estimate.modes[0].p_drifted, 0.9)
        samples, weights = e.draws()
        k = estimate["K"]
        self.assertLess(abs(float(weights @ samples[:, 0]) - k.mean), 5.0 * k.sd / np.sqrt(estimate.modes[0].kish_ess))

    def test_are_in_the_units_of_the_parameters(self):
        e = armcmc.Estimator(self.file("growth.toml", GROWTH), sampler={"seed": 2})
        x = np.linspace(0.1, 1.0, 200)
        estimate = e.step(x[:, None], 3.0 * x + 0.1 * np.random.default_rng(1).standard_normal(200), DT)
        samples, weights = e.draws()
        self.assertEqual(e.draw_names(), ["g", "noise_std"])
        g, noise = weights @ samples
        self.assertLess(abs(g - estimate["g"].mean), 5.0 * estimate["g"].sd / np.sqrt(estimate.modes[0].kish_ess))
        self.assertLess(abs(g - 3.0), 0.1)
        self.assertLess(abs(noise / 0.1 - 1.0), 0.3)

    def test_say_when_there_are_none(self):
        e = armcmc.Estimator("hunt_crossley")
        with self.assertRaisesRegex(ValueError, "drawn nothing of mode 0"):
            e.draws()
        with self.assertRaisesRegex(ValueError, "mode 1 does not exist: give 0 to 0"):
            e.draws(1)
        _, u, y = contact(100)
        e.step(u, y, DT)
        e.draws()
        e.reset()
        with self.assertRaisesRegex(ValueError, "drawn nothing"):
            e.draws()

    def test_stay_as_they_are_when_the_next_step_comes(self):
        e = armcmc.Estimator("hunt_crossley")
        _, u, y = contact(200)
        e.step(u[:100], y[:100], DT)
        samples, _ = e.draws()
        before = samples.copy()
        e.step(u[100:], y[100:], DT)
        np.testing.assert_array_equal(samples, before)


class Replay(InScratch):
    def test_is_equal_to_the_bit(self):
        if not (PROGRAMS / "armcmc-replay").exists():
            self.skipTest("armcmc-replay is not built")
        t, u, y = contact(501)
        table = np.column_stack([t, u, y])
        rows = "\n".join(",".join(repr(float(v)) for v in row) for row in table)
        data, config = self.file("run.csv", "t,x,v,f\n" + rows + "\n"), self.file(
            "own.toml", 'schema = 1\n[model]\nname = "hunt_crossley"\n[timing]\nperiod_ms = 100\n')
        subprocess.run([PROGRAMS / "armcmc-replay", "--config", config, "--data", data, "--out", self.dir / "out.csv"],
                       check=True, capture_output=True)
        with open(self.dir / "out.csv", newline="") as file:
            wanted = list(csv.DictReader(file))
        self.assertEqual(len(wanted), 5)
        e = armcmc.Estimator("hunt_crossley", config)
        for k, row in enumerate(wanted):
            pack = slice(1 + 100 * k, 101 + 100 * k)
            estimate = e.step(u[pack], y[pack], DT, t[pack][-1])
            for name in ("K", "B", "p"):
                q = estimate[name]
                for suffix, value in (("", q.map), ("_ap", q.mean), ("_sd", q.sd), ("_q025", q.quantiles[0]),
                                      ("_chain_mean", q.chain_mean)):
                    self.assertEqual(float(row[name + suffix]), value, (k, name + suffix))
            for name, value in (("log_evidence", estimate.modes[0].log_evidence), ("y_pred", estimate.y_pred),
                                ("y_lo", estimate.y_band[0]), ("y_rmse", estimate.y_rmse)):
                self.assertEqual(float(row[name]), value, (k, name))


class Gap(InScratch):
    def setUp(self):
        super().setUp()
        if not (PROGRAMS / "armcmc-gap").exists():
            self.skipTest("armcmc-gap is not built")

    def test_is_the_result_of_the_program(self):
        rng = np.random.default_rng(1)
        t = DT * np.arange(4000)
        q, v, a = np.sin(5.0 * t), 5.0 * np.cos(5.0 * t), -25.0 * np.sin(5.0 * t)
        force = 90.0 * a + 200.0 * v + 40.0 * np.sign(v) + rng.standard_normal(t.size)
        rows = "\n".join(",".join(repr(float(x)) for x in row) for row in np.column_stack([t, q, v, a, force]))
        data = self.file("run.csv", "t,q,v,a,F\n" + rows + "\n")
        result = armcmc.gap("servo_axis", data, self.dir / "gap")
        self.assertIn("coulomb", str(result["effects"]))
        self.assertTrue((self.dir / "gap/report.html").exists())

    def test_says_what_is_wrong(self):
        with self.assertRaisesRegex(ValueError, "none.csv"):
            armcmc.gap("servo_axis", self.dir / "none.csv")


class Example(InScratch):
    def run_example(self, **environment):
        return subprocess.run([sys.executable, SOURCE / "tools/python/examples/posterior.py"], check=True, text=True,
                              capture_output=True, cwd=self.dir, env={**os.environ, **environment}).stdout

    def check_table(self, out):
        self.assertEqual(len(out.splitlines()), 2)
        for line, true in zip(out.splitlines(), (4.0, 2.3)):
            mean, sd = float(line.split()[2]), float(line.split()[4])
            self.assertLess(abs(mean - true), 4.0 * sd, line)

    def test_runs_and_finds_the_truth(self):
        self.check_table(self.run_example())
        try:
            from matplotlib import image
        except ImportError:
            self.skipTest("matplotlib is not installed")
        picture = image.imread(self.dir / "posterior.png")[:, :, :3]
        height, width = picture.shape[:2]
        for k in range(3):  # each panel shows more than a few points: inside its axes
            panel = picture[height // 10 : height * 3 // 4, int(width * (k / 3 + 0.08)) : int(width * (k / 3 + 0.3))]
            self.assertGreater(np.mean(panel.min(axis=2) < 0.8), 0.05, k)

    def test_prints_the_table_without_matplotlib(self):
        self.file("matplotlib.py", "raise ImportError\n")
        path = os.pathsep.join([str(self.dir), os.environ["PYTHONPATH"]])
        self.check_table(self.run_example(PYTHONPATH=path))
        self.assertFalse((self.dir / "posterior.png").exists())


if __name__ == "__main__":
    unittest.main()
