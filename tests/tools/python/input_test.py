"""What callers give to the Python package: arrays of every kind, paths of any bytes, tables, the wrong interpreter."""

import copy
import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path

import armcmc
import numpy as np
from support import DT, LINE, PROGRAMS, SOURCE, InScratch

U, Y = np.linspace(0.0, 1.0, 50)[:, None], 2.0 * np.linspace(0.0, 1.0, 50) + 0.1


class Arrays(InScratch):
    def refused(self, words, u, y):
        e = self.line()
        with self.assertRaises(ValueError) as caught:
            e.step(u, y, DT)
        self.assertIn(words, str(caught.exception))
        self.assertEqual(e.step(U, Y, DT).seq, 1)

    def test_any_layout_and_type_of_real_numbers_gives_the_same_bits(self):
        wide = np.zeros((100, 3))
        wide[::2, 1] = U[:, 0]
        wanted = self.line().step(U, Y, DT)["a"].mean
        for u, y in ((wide[::2, 1:2], np.repeat(Y, 2)[::2]), (np.asfortranarray(U)[::-1][::-1], Y[::-1][::-1]),
                     (U.astype(">f8"), Y.astype(object)), (U.astype(np.longdouble), np.ma.masked_array(Y)),
                     (U.tolist(), Y.tolist())):
            self.assertEqual(self.line().step(u, y, DT)["a"].mean, wanted)

    def test_what_is_no_number_is_refused(self):
        times = np.zeros((50, 1), dtype="datetime64[s]")
        self.refused("u is no array of real numbers: its elements are of type datetime64[s]", times, Y)
        self.refused("u is no array of real numbers: its elements are of type timedelta64[s]", times - times, Y)
        self.refused("y is no array of real numbers: its elements are of type <U3", U, Y.astype("U3"))
        self.refused("y is no array of real numbers: ", U, np.array([10**400] * 50, dtype=object))
        self.refused("u has masked values: leave out those samples", np.ma.masked_array(U, mask=U > 0.5), Y)

    def test_times_since_1970_give_the_same_estimates(self):
        e, other = self.line(), self.line()
        for k in (1, 2, 3, 5):
            estimate, wanted = e.step(U, Y, DT, 1.7e9 + 0.05 * k), other.step(U, Y, DT, 0.05 * k)
            self.assertEqual(estimate.seq, wanted.seq)
            # There, times are 2.4e-7 s apart: 5e-6 of a pack.
            self.assertAlmostEqual(estimate["a"].mean, wanted["a"].mean, delta=5e-6 * wanted["a"].sd)
        with self.assertRaisesRegex(ValueError, "later than 9e9 s"):
            e.step(U, Y, 1e9)

    def test_a_mode_is_an_integer(self):
        e = self.line()
        e.step(U, Y, DT)
        self.assertEqual(e.draws(np.int8(0))[0].shape[1], 2)
        for mode, words in (("always", "mode = 'always': give the number"), (0.0, "mode = 0.0: give the number"),
                            (2**70, "does not exist: give 0 to 0"), (-(2**70), "does not exist: give 0 to 0")):
            for function in (e.draws, e.draw_names):
                with self.subTest(mode), self.assertRaisesRegex(ValueError, words):
                    function(mode)


class Objects(InScratch):
    def test_an_estimator_is_not_copied(self):
        e = self.line()
        for copied in (copy.copy, copy.deepcopy, pickle.dumps):
            with self.assertRaisesRegex(TypeError, "neither copied nor pickled: make another one"):
                copied(e)
        self.assertIn("line.toml: a, b>", repr(e))

    def test_an_object_without_an_estimator_is_not_made(self):
        own = type(armcmc.Estimator("servo_axis")._own)
        derived = type("Derived", (own,), {})
        for make in (own, derived, lambda: own.__new__(own), lambda: own.__new__(derived), lambda: object.__new__(own),
                     lambda: own.__mro__[1].__new__(own)):
            with self.assertRaises(TypeError):
                make().reset()
        with self.assertRaisesRegex(TypeError, "armcmc.Estimator"):
            own.__new__(own)

    def test_an_estimate_is_copied_and_outlives_its_estimator(self):
        e = self.line()
        estimate = e.step(U, Y, DT)
        samples, weights = e.draws()
        del e
        self.assertEqual(pickle.loads(pickle.dumps(copy.deepcopy(estimate)))["a"].mean, estimate["a"].mean)
        self.assertAlmostEqual(float(weights.sum()), 1.0, places=9)
        self.assertTrue(np.isfinite(samples).all())

    def test_a_name_that_is_not_there_is_answered_with_those_that_are(self):
        estimate = self.line().step(U, Y, DT)
        with self.assertRaisesRegex(KeyError, "no 'c' here; there are a, b, seq, "):
            estimate["c"]
        with self.assertRaisesRegex(AttributeError, "no 'c' here; there are seq, "):
            estimate.c
        with self.assertRaisesRegex(KeyError, "no 'c' here"):
            armcmc.Estimate()["c"]

    def test_threads_share_an_estimator(self):
        e, steps = self.line(sampler={"draws": 500}), []

        def work():
            for _ in range(10):
                steps.append(e.step(U, Y, DT).seq)
                e.draws()

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(steps), list(range(1, 41)))


class Paths(InScratch):
    def test_names_of_any_bytes_work_and_are_told(self):
        odd = os.fsencode(self.dir) + b"/a\xff.toml"
        with open(odd, "w") as file:
            file.write(LINE)
        for path in (odd, os.fsdecode(odd), Path(os.fsdecode(odd))):
            self.assertEqual(armcmc.Estimator(path).inputs[0].name, "x")
        with self.assertRaisesRegex(ValueError, r"b\\xff.toml: cannot be read"):
            armcmc.Estimator(os.fsdecode(odd.replace(b"a\xff", b"b\xff")))
        config = os.fsencode(self.dir) + b"/c\xff.toml"
        with open(config, "w") as file:
            file.write("schema = 1\n[sampler]\ndraws = 700\n")
        e = armcmc.Estimator("hunt_crossley", config, sampler={"seed": 3})
        self.assertEqual(e.step(np.ones((9, 2)), np.ones(9), DT).modes[0].draws, 700)

    def test_what_is_no_path_is_refused(self):
        with self.assertRaisesRegex(ValueError, r"model = 'a\\x00b': neither a path nor a name contains a zero byte"):
            armcmc.Estimator("a\0b")
        with self.assertRaisesRegex(TypeError, "config is of type int, expected a path or a name"):
            armcmc.Estimator("servo_axis", 3)
        (self.dir / "bytes.toml").write_bytes(bytes(range(32, 256)))
        for keywords in ({}, {"method": "rls"}):
            with self.subTest(keywords), self.assertRaisesRegex(ValueError, "bytes.toml"):
                armcmc.Estimator("servo_axis", self.dir / "bytes.toml", **keywords)

    def test_arrays_of_numpy_configure(self):
        draws = self.line(sampler={"draws": np.array(700)}).step(U, Y, DT).modes[0].draws
        self.assertEqual(draws, 700)


class Tables(InScratch):
    def setUp(self):
        super().setUp()
        if not (PROGRAMS / "armcmc-gap").exists():
            self.skipTest("armcmc-gap is not built")
        t = DT * np.arange(3000)
        q, v, a = np.sin(5.0 * t), 5.0 * np.cos(5.0 * t), -25.0 * np.sin(5.0 * t)
        force = 90.0 * a + 200.0 * v + 40.0 * np.sign(v) + np.random.default_rng(1).standard_normal(t.size)
        self.table = {"t": t, "q": q, "v": v, "a": a, "F": force}

    def csv(self):
        rows = "\n".join(",".join(repr(float(x)) for x in row) for row in zip(*self.table.values()))
        return self.file("run.csv", "t,q,v,a,F\n" + rows + "\n")

    def refused(self, words, *arguments, **keywords):
        with self.assertRaises(ValueError) as caught:
            armcmc.gap(*arguments, **keywords)
        self.assertIn(words, str(caught.exception))
        self.assertNotIn("--", str(caught.exception))
        self.assertNotIn("/armcmc-gap-", str(caught.exception))

    def test_arrays_give_the_result_of_the_csv(self):
        def core(result):
            self.assertNotIn(result["data"].pop("file"), "/")
            return {key: value for key, value in result.items() if key not in ("seconds", "budget")}

        wanted = core(armcmc.gap("servo_axis", self.csv()))
        self.assertEqual(json.dumps(core(armcmc.gap("servo_axis", self.table))), json.dumps(wanted))
        self.assertIn("coulomb", str(wanted["effects"]))
        fields = np.rec.fromarrays(list(self.table.values()), names="t,q,v,a,F")
        self.assertEqual(armcmc.gap("servo_axis", fields, without="coulomb_friction", seed=2)["seed"], 2)

    def test_a_table_that_is_none_says_why(self):
        t = self.table
        self.refused("data has no named columns: give a dict", "servo_axis", np.column_stack(list(t.values())))
        self.refused("data has columns of the shapes t (3000,)", "servo_axis", {**t, "F": t["F"][1:]})
        self.refused("data['F'] is no array of real numbers", "servo_axis", {**t, "F": t["F"] * 1j})
        self.refused("data has no column F; its header has t,q,v,a,", "servo_axis", {k: t[k] for k in "tqva"})
        self.refused("data: a diagnosis needs at least 100 rows", "servo_axis", {k: c[:20] for k, c in t.items()})
        t["F"][100] = np.nan
        self.refused("data['F'] is not finite at row 100", "servo_axis", t)
        self.assertIn("coulomb", str(armcmc.gap("servo_axis", t, skip_bad=True)["effects"]))

    def test_the_program_speaks_of_keywords(self):
        self.refused("(did you mean servo_axis?)", "servo_axs", self.table)
        bad = self.file("bad.csv", "t,q,v,a,F\nx,1,1,1,1\n")
        self.refused("bad.csv:2: t = x: expected a finite number (skip_bad counts and skips", "servo_axis", bad)
        self.refused("bad.toml:5", self.file("bad.toml", LINE.replace("a*x + b", "a*")), self.csv())
        self.refused("without: no effect is called", "servo_axis", self.table, without=["coulom"])
        self.refused("model = None: give a plant", None, bad)
        self.refused("give None as model", "servo_axis", SOURCE / "tools/gap/recordings/emps_estimation.toml")
        self.refused("out /dev/null/x: no folder", "servo_axis", self.table, out="/dev/null/x")

    def test_other_threads_go_on_and_an_interrupt_ends_it(self):
        script = ("import armcmc, sys, tempfile, threading, time\n"
                  "tempfile.tempdir = sys.argv[2]\n"
                  "threading.Thread(target=lambda: (time.sleep(0.2), print('running', flush=True)), daemon=True).start()\n"
                  "try:\n    armcmc.gap('servo_axis', sys.argv[1])\n"
                  "except KeyboardInterrupt:\n    print('interrupted')\n")
        (self.dir / "scratch").mkdir()
        with subprocess.Popen([sys.executable, "-c", script, self.csv(), self.dir / "scratch"], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            self.assertEqual(process.stdout.readline(), "running\n")
            started = time.monotonic()
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
        self.assertEqual((out, err), ("interrupted\n", ""))
        self.assertLess(time.monotonic() - started, 30.0)
        self.assertEqual(list((self.dir / "scratch").iterdir()), [])


class Interpreter(InScratch):
    def test_that_of_another_version_is_told_which_to_run(self):
        package = self.dir / "armcmc"
        shutil.copytree(Path(armcmc.__file__).parent, package, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
        (package / "_armcmc.cpython-39-x86_64-linux-gnu.so").touch()
        run = subprocess.run([sys.executable, "-c", "import armcmc"], env={**os.environ, "PYTHONPATH": str(self.dir)},
                             capture_output=True, text=True, check=False)
        self.assertIn("ImportError: armcmc was built for another Python (_armcmc.cpython-39-x86_64-linux-gnu.so), and "
                      f"{sys.executable} is Python 3.", run.stderr)

    @unittest.skipUnless(sys.executable == "/usr/bin/python3" and "ARMCMC_CMAKE" in os.environ,
                         "needs a build for Debian's Python")
    def test_the_build_takes_debians_and_says_what_another_lacks(self):
        self.file("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(choice CXX)\n"
                                    f"include({SOURCE}/tools/cmake/PythonInterpreter.cmake)\n")
        (self.dir / "bin").mkdir()
        first = self.file("bin/python3", '#!/bin/sh\nexec /usr/bin/python3 -I -S "$@"\n')  # finds no NumPy
        first.chmod(0o755)
        environment = {**os.environ, "PATH": f"{first.parent}:{os.environ['PATH']}"}
        for name in ("VIRTUAL_ENV", "CONDA_PREFIX", "PYTHONPATH"):
            environment.pop(name, None)

        def configure(*options):
            return subprocess.run([os.environ["ARMCMC_CMAKE"], "-S", self.dir, "-B", self.dir / "build", *options],
                                  env=environment, capture_output=True, text=True, check=False)

        run = configure()
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Python module: for /usr/bin/python3, Python 3.", run.stdout)
        shutil.rmtree(self.dir / "build")
        run = configure(f"-DPython_EXECUTABLE={first}")
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(f"cannot be built for {first}", " ".join(run.stderr.split()))
        self.assertIn("NumPy (python3-numpy)", run.stderr)


if __name__ == "__main__":
    unittest.main()
