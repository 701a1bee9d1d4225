#!/usr/bin/env python3
"""The posterior of a contact's stiffness K and damping B after 20 packs: a plot, or a table without matplotlib."""
import sys

import armcmc
import numpy as np

DT, SAMPLES, PACKS = 1e-3, 100, 20  # s, samples in a pack
K, B, P, NOISE = 4.0, 2.3, 1.7, 0.1  # N/m^p, N s/m^(p+1), 1, N

rng = np.random.default_rng(1)
t = DT * np.arange(1, SAMPLES * PACKS + 1)
x, v = 0.5 + 0.5 * np.sin(3.0 * t), 1.5 * np.cos(3.0 * t)
f = x**P * (K + B * v) + NOISE * rng.standard_normal(t.size)

estimator = armcmc.Estimator("hunt_crossley", sampler={"seed": 1})
for pack in np.split(np.arange(t.size), PACKS):
    estimate = estimator.step(np.column_stack([x, v])[pack], f[pack], DT, t[pack[-1]])
samples, weights = estimator.draws()

for name, true in (("K", K), ("B", B)):
    q = estimate[name]
    print(f"{name} = {q.mean:.3f} +- {q.sd:.3f} {q.unit}, 95 % in [{q.quantiles[0]:.3f}, {q.quantiles[4]:.3f}], true {true}")
try:
    import matplotlib
except ImportError:
    sys.exit(0)
matplotlib.use("Agg")
from matplotlib import pyplot

figure, axes = pyplot.subplots(1, 3, figsize=(12, 3.5), layout="constrained")
for axis, name, true in zip(axes, "KB", (K, B)):
    edges, density = estimate[name].histogram
    axis.stairs(density, edges, fill=True)
    axis.axvline(true, color="black")
    axis.set(xlabel=f"{name} in {estimate[name].unit}", ylabel="density")
axes[2].scatter(samples[:, 0], samples[:, 1], s=2000 * weights, alpha=0.3)
axes[2].set(xlabel="K", ylabel="B")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "posterior.png")
