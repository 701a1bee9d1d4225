"""What the tests of the Python package share."""

import os
import tempfile
import unittest
from pathlib import Path

import armcmc
import numpy as np

SOURCE = Path(os.environ["ARMCMC_SOURCE"])
PROGRAMS = Path(armcmc.__file__).parents[4] / "bin"
DT = 1e-3  # s

LINE = """schema = 1
name = "line"
title = "A line"
output = "y"
law = "a*x + b"
[signals]
x = { unit = "m" }
y = { unit = "N" }
[parameters]
a = { unit = "N/m", mean = 0.0, sd = 1e3 }
b = { unit = "N", mean = 0.0, sd = 1e3 }
[noise]
law = "gaussian"
std = 0.5
"""


def contact(samples, seed=1):
    """Inputs (x, v) and force of a contact with K = 4, B = 2.3, p = 1.7 and noise of 0.1 N."""
    t = DT * np.arange(1, samples + 1)
    x, v = 0.5 + 0.5 * np.sin(3.0 * t), 1.5 * np.cos(3.0 * t)
    noise = 0.1 * np.random.default_rng(seed).standard_normal(samples)
    return t, np.column_stack([x, v]), x**1.7 * (4.0 + 2.3 * v) + noise


class InScratch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.dir = Path(scratch.name)

    def file(self, name, text):
        (self.dir / name).write_text(text)
        return self.dir / name

    def line(self, **overrides):
        return armcmc.Estimator(self.file("line.toml", LINE), **overrides)
