#!/usr/bin/env python3
"""The table of tools/bench/compare-peers, from the folder that armcmc-bench --write-packs and the peers have filled.

Effective draws are the posterior variance over the mean squared error of the estimated posterior mean, against quadrature,
over the replicates; of the parameter that has fewest. The standard library of Python is all that it needs.
"""

import argparse
import csv
import json
import math
import pathlib
import statistics
import sys

GOAL = 15.0
OURS = "armcmc"
REFERENCE = "fit"  # not a sampler


def read_posterior(folder):
    with open(folder / "parameters.csv", newline="") as file:
        return {row["name"]: (float(row["posterior_mean"]), float(row["posterior_sd"])) for row in csv.DictReader(file)}


def read_peer(path, posterior):
    """One peer's CSV: comments "# key: text", a header, and a row for each replicate."""
    about = {}
    with open(path, newline="") as file:
        lines = file.read().splitlines()
    while lines and lines[0].startswith("#"):
        key, _, text = lines.pop(0)[1:].partition(":")
        about[key.strip()] = text.strip()
    rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]
    if not rows:
        raise ValueError(f"{path}: no replicates")
    fewest, bias = math.inf, 0.0
    for name, (mean, sd) in posterior.items():
        errors = [(row[name] - mean) / sd for row in rows]
        mse = statistics.fmean(e * e for e in errors)
        fewest = min(fewest, 1.0 / mse if mse > 0.0 else math.inf)
        bias = max(bias, abs(statistics.fmean(errors)))
    ms = statistics.median(row["ms"] for row in rows)
    return {
        "peer": about.get("peer", path.stem),
        "how": about.get("how", ""),
        "program": path.stem,
        "replicates": len(rows),
        "evaluations": statistics.fmean(row["evaluations"] for row in rows),
        "acceptance": statistics.fmean(row["acceptance"] for row in rows),
        "ms": ms,
        "effective_draws": fewest,
        "relative_error": math.sqrt(2.0 / len(rows)),
        "bias_sd": bias,
        "effective_draws_per_ms": fewest / ms,
    }


def summarise(folder, order):
    cases = []
    for case in sorted(path.parent for path in folder.glob("*/parameters.csv")):
        posterior = read_posterior(case)
        peers = [read_peer(case / f"{name}.csv", posterior) for name in order if (case / f"{name}.csv").exists()]
        ours = [p for p in peers if p["program"].startswith(OURS)]
        others = [p for p in peers if not p["program"].startswith(OURS) and p["program"] != REFERENCE]
        best = max(others, key=lambda p: p["effective_draws_per_ms"], default=None)
        ratios = {}
        if best is not None:
            ratios = {p["program"]: p["effective_draws_per_ms"] / best["effective_draws_per_ms"] for p in ours}
        cases.append({
            "case": case.name,
            "posterior": {name: {"mean": m, "sd": s} for name, (m, s) in posterior.items()},
            "peers": peers,
            "best_peer": best["program"] if best else None,
            "times_best_peer": ratios,
        })
    return {"goal_times_best_peer": GOAL, "cases": cases}


def digits(value):
    """Three digits, and thousands apart."""
    if not math.isfinite(value):
        return "inf"
    if value >= 1000.0:
        return f"{round(value, 2 - int(math.floor(math.log10(value)))):,.0f}".replace(",", " ")
    return f"{value:.3g}"


def cost(peer):
    return ["", ""] if peer["program"] == REFERENCE else [digits(peer["evaluations"]), f"{peer['acceptance']:.2f}"]


def effective(peer):
    spread = "" if peer["program"] == REFERENCE else f" ± {100.0 * peer['relative_error']:.0f} %"
    return digits(peer["effective_draws"]) + spread


def markdown(report):
    about = report["about"]
    out = [", ".join(f"{key} {about[key]}" for key in ("commit", "date", "machine") if about.get(key)) + ".", ""] if about else []
    if about.get("quick") == "true":
        out += ["A quick run: too few replicates and evaluations to conclude from.", ""]
    if about.get("left_out"):
        out += [f"Left out, as their packages are missing: {about['left_out']}.", ""]
    out += ["| case | sampler | ms a pack | evaluations | acceptance | replicates | effective draws | a ms | armcmc, times |",
           "|---|---|---|---|---|---|---|---|---|"]
    how = {}
    for case in report["cases"]:
        ours = next((p for p in case["peers"] if p["program"].startswith(OURS)), None)
        for p in case["peers"]:
            times = ours["effective_draws_per_ms"] / p["effective_draws_per_ms"] if ours else math.nan
            out.append("| " + " | ".join([
                case["case"], p["peer"], digits(p["ms"]), *cost(p),
                str(p["replicates"]), effective(p),
                digits(p["effective_draws_per_ms"]), digits(times)]) + " |")
            how[p["peer"]] = p["how"]
    out.append("")
    for case in report["cases"]:
        if case["best_peer"]:
            best = next(p["peer"] for p in case["peers"] if p["program"] == case["best_peer"])
            ratios = ", ".join(f"{name.removeprefix(OURS + '_')} {digits(value)}"
                               for name, value in case["times_best_peer"].items())
            out.append(f"`{case['case']}`: effective draws a millisecond, times those of the best peer ({best}): {ratios}; "
                       f"the goal is {report['goal_times_best_peer']:.0f}.")
    out.append("")
    out += [f"- {peer}: {text}." for peer, text in how.items()]
    return "\n".join(out) + "\n"


def main(arguments):
    parser = argparse.ArgumentParser(description="The table of tools/bench/compare-peers.")
    parser.add_argument("folder", type=pathlib.Path, help="CASE/parameters.csv, CASE/PEER.csv")
    parser.add_argument("--order", default="armcmc_weighted,armcmc_chain,bfl,gsl,emcee,mcmc,rstan,fit",
                        help="programs, in the order of the table")
    parser.add_argument("--about", action="append", default=[], metavar="KEY=TEXT", help="of the run, for the report")
    parser.add_argument("--json", type=pathlib.Path, help="also write the report there")
    a = parser.parse_args(arguments)
    try:
        report = summarise(a.folder, a.order.split(","))
        report["about"] = dict(text.split("=", 1) for text in a.about)
        if not report["cases"]:
            raise ValueError(f"{a.folder}: no case")
    except (OSError, ValueError, KeyError) as error:
        print(f"summary.py: {error}", file=sys.stderr)
        return 2
    if a.json:
        a.json.write_text(json.dumps(report, indent=2) + "\n")
    sys.stdout.write(markdown(report))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
