#!/usr/bin/env python3
"""Acquisition of the target in experiment 1 over many seeds: a table of acquisition times and incorrect solutions.

    ci/acquisition.py BINARY [--seeds 1000-1199] [--hours 1.5] [--apriori 1] [--runs FOLDER]

BINARY is a built vbar; the working directory is the root of the repository. `--apriori 3` trebles the errors of the a-priori orbit.
Two seeds are flown at a time. The run folders are kept with --runs, in that folder, and are otherwise deleted.

Acquisition: the first image at which the filter runs. An incorrect solution: the true relative orbit exceeds five sigmas of the
filter's covariance (NEES of six degrees of freedom beyond 40.3, the probability of five sigmas) at an image after acquisition, or a
bearing is that of an object other than the target. The exit status is 1 with an incorrect solution.
"""
import argparse
import concurrent.futures
import csv
import pathlib
import shutil
import subprocess
import tempfile

import flights

MISSION = "missions/experiment1.toml"
APRIORI_SIGMAS_M = {"sigma_a_da_m": 30.0, "sigma_a_dlambda_m": 1000.0, "sigma_a_de_m": 200.0, "sigma_a_di_m": 200.0}
NEES_LIMIT = 40.3
LIMITS_MIN = (38, 45, 60, 90)


def fly(binary, seed, hours, factor, folder):
    """The rows of images.csv."""
    command = ["nice", binary, "run", MISSION, "--seed", str(seed), "--quiet", "--force", "--out", str(folder),
               "--set", f"mission.duration_h={hours}"]
    for key, sigma in APRIORI_SIGMAS_M.items():
        command += ["--set", f"navigation.apriori.{key}={factor * sigma}"]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode not in flights.COMPLETE:
        raise SystemExit(f"seed {seed}: {result.stderr.strip()}")
    with open(folder / "images.csv", newline="") as file:
        return list(csv.DictReader(file))


def first_min(rows, is_it):
    return next((float(row["time_s"]) / 60.0 for row in rows if is_it(row)), None)


def judge(rows):
    """(minutes to the first bearing, to acquisition, bearings to another object, largest NEES)."""
    wrong = sum(row["status"] == "bearing" and row["target_object"] != row["true_object"] for row in rows)
    nees = max((float(row["nees"]) for row in rows if row["nees"]), default=0.0)
    return (first_min(rows, lambda row: row["status"] == "bearing"),
            first_min(rows, lambda row: row["filter_runs"] == "1"), wrong, nees)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("--seeds", default="1000-1199")
    parser.add_argument("--hours", type=float, default=1.5)
    parser.add_argument("--apriori", type=float, default=1.0)
    parser.add_argument("--runs")
    options = parser.parse_args()
    first, last = (int(part) for part in options.seeds.split("-"))
    seeds = range(first, last + 1)
    root = pathlib.Path(options.runs or tempfile.mkdtemp(prefix="acquisition-"))

    def one(seed):
        folder = root / str(seed)
        rows = fly(options.binary, seed, options.hours, options.apriori, folder)
        if not options.runs:
            shutil.rmtree(folder)
        return judge(rows)

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        judged = dict(zip(seeds, pool.map(one, seeds)))
    if not options.runs:
        root.rmdir()

    times = [acquired for _, acquired, _, _ in judged.values()]
    print(f"{len(times)} seeds, a-priori errors times {options.apriori:g}, {options.hours:g} h")
    for limit in LIMITS_MIN:
        count = sum(time is not None and time <= limit for time in times)
        print(f"  acquired within {limit:3d} min: {count:4d}  {100.0 * count / len(times):5.1f} %")
    print(f"  not acquired:           {times.count(None):4d}")
    incorrect = [seed for seed, (_, _, wrong, nees) in judged.items() if wrong > 0 or nees > NEES_LIMIT]
    print(f"  incorrect solutions:    {len(incorrect):4d}  {incorrect if incorrect else ''}")
    print(f"  largest NEES:           {max(nees for *_, nees in judged.values()):6.1f}")
    print("  seeds later than 45 min or incorrect: seed, first bearing, acquisition (min), other bearings, largest NEES")
    for seed, (bearing, acquired, wrong, nees) in judged.items():
        if acquired is None or acquired > 45 or seed in incorrect:
            print(f"    {seed}  {bearing}  {acquired}  {wrong}  {nees:.1f}")
    return 1 if incorrect else 0


if __name__ == "__main__":
    raise SystemExit(main())
