#!/usr/bin/env python3
"""The posterior of a contact's stiffness K and damping B after 20 packs: a plot, or a table without matplotlib."""
import armcmc
import numpy as np

DT, SAMPLES, PACKS = 1e-3, 100, 20  # s, samples in a pack
TRUE, P, NOISE = {"K": 4.0, "B": 2.3}, 1.7, 0.1  # N/m^p and N s/m^(p+1), 1, N

rng = np.random.default_rng(1)
t = DT * np.arange(1, SAMPLES * PACKS + 1)
x, v = 0.5 + 0.5 * np.sin(3.0 * t), 1.5 * np.cos(3.0 * t)
f = x**P * (TRUE["K"] + TRUE["B"] * v) + NOISE * rng.standard_normal(t.size)

estimator = armcmc.Estimator("hunt_crossley", sampler={"seed": 1})
for pack in np.split(np.arange(t.size), PACKS):
    estimate = estimator.step(np.column_stack([x, v])[pack], f[pack], DT, t[pack[-1]])
for name, true in TRUE.items():
    q = estimate[name]
    print(f"{name} = {q.mean:.3f} +- {q.sd:.3f} {q.unit}, 95 % in [{q.quantiles[0]:.3f}, {q.quantiles[4]:.3f}], true {true}")

samples, weights = estimator.draws()
draws = samples[rng.choice(weights.size, 3000, p=weights)]  # of equal weight
try:
    from matplotlib.figure import Figure
except ImportError:
    raise SystemExit(0) from None
figure = Figure(figsize=(12, 3.5), layout="constrained")
axes = figure.subplots(1, 3)
for axis, name in zip(axes, TRUE):
    axis.stairs(*reversed(estimate[name].histogram), fill=True)
    axis.axvline(TRUE[name], color="black", label="true")
    axis.set(xlabel=f"{name} in {estimate[name].unit}", ylabel="density")
limits = {f"{a}lim": estimate[name].histogram[0][[0, -1]] for a, name in zip("xy", TRUE)}
axes[2].scatter(draws[:, 0], draws[:, 1], s=4, alpha=0.3)
axes[2].plot(*TRUE.values(), "k+", markersize=12)
axes[2].set(xlabel="K", ylabel="B", **limits)
figure.savefig("posterior.png")
