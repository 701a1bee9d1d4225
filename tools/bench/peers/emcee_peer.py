#!/usr/bin/env python3
"""emcee on one pack, all walkers of a half ensemble at once in numpy: emcee_peer.py CASE_FOLDER REPLICATES EVALUATIONS"""

import csv
import pathlib
import sys
import time

import emcee
import numpy as np

WALKERS = 200
BURN_IN = 0.2


def read_case(folder):
    pack = np.genfromtxt(folder / "pack.csv", delimiter=",", names=True)
    with open(folder / "parameters.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    prior = {key: np.array([float(row[key]) for row in rows]) for key in ("mean", "sd", "lower", "upper")}
    return {"log_x": np.log(pack["x"]), "v": pack["v"], "f": pack["f"], "weight": 1.0 / pack["noise_sd"]}, prior


def log_posterior(theta, pack, prior):
    """[walkers] of [walkers, 3]."""
    z = (theta - prior["mean"]) / prior["sd"]
    force = (theta[:, :1] + theta[:, 1:2] * pack["v"]) * np.exp(theta[:, 2:] * pack["log_x"])
    residual = (pack["f"] - force) * pack["weight"]
    value = -0.5 * (np.einsum("ij,ij->i", z, z) + np.einsum("ij,ij->i", residual, residual))
    inside = np.all((theta >= prior["lower"]) & (theta <= prior["upper"]), axis=1)
    return np.where(inside, value, -np.inf)


def fit(pack, prior):
    """Mode and inverse Gauss-Newton Hessian, by Levenberg-Marquardt from the mean of the prior."""
    theta, damping = prior["mean"].copy(), 1e-3
    value = log_posterior(theta[None, :], pack, prior)[0]
    for _ in range(60):
        h = np.exp(theta[2] * pack["log_x"])
        force = (theta[0] + theta[1] * pack["v"]) * h
        jacobian = np.stack([h, h * pack["v"], force * pack["log_x"]], axis=1) * pack["weight"][:, None]
        hessian = jacobian.T @ jacobian + np.diag(prior["sd"] ** -2.0)
        gradient = jacobian.T @ ((pack["f"] - force) * pack["weight"]) + (prior["mean"] - theta) / prior["sd"] ** 2
        step = np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), gradient)
        there = log_posterior((theta + step)[None, :], pack, prior)[0]
        if there < value:
            damping *= 10.0
            continue
        done = there - value < 1e-10
        theta, value, damping = theta + step, there, 0.1 * damping
        if done:
            break
    return theta, np.linalg.inv(hessian)


def run(pack, prior, replicate, evaluations):
    random = np.random.RandomState(1000 + replicate)
    mean, covariance = fit(pack, prior)
    start = np.clip(random.multivariate_normal(mean, covariance, size=WALKERS), prior["lower"], prior["upper"])
    sampler = emcee.EnsembleSampler(WALKERS, 3, log_posterior, args=(pack, prior), vectorize=True)
    sampler.random_state = random.get_state()
    steps = evaluations // WALKERS
    sampler.run_mcmc(start, steps)
    draws = sampler.get_chain(discard=int(BURN_IN * steps), flat=True)
    return sampler.acceptance_fraction.mean(), WALKERS * steps, draws.mean(axis=0)


def main():
    folder, replicates, evaluations = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    pack, prior = read_case(folder)
    print(f"# peer: emcee {emcee.__version__}, numpy {np.__version__}")
    print(f"# how: {WALKERS} walkers from the normal law about a least squares fit, stretch moves, vectorised; the first "
          "fifth is thrown away")
    print("ms,acceptance,evaluations,K,B,p")
    for replicate in range(replicates):
        began = time.perf_counter()
        acceptance, count, mean = run(pack, prior, replicate, evaluations)
        ms = 1e3 * (time.perf_counter() - began)
        print(f"{ms:.6g},{acceptance:.4g},{count},{mean[0]:.17g},{mean[1]:.17g},{mean[2]:.17g}")


if __name__ == "__main__":
    main()
