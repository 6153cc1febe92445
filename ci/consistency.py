#!/usr/bin/env python3
"""Consistency of the estimates of runs: NEES of the relative orbit by range, and of the attitude, against their expected value.

usage: ci/consistency.py RUN_FOLDER...     runs of one mission with different seeds

The NEES of six components has the mean 6. Errors of successive images are correlated, so that the mean of a bin over one run
varies widely; the table gives, for each bin, the mean over the runs of the means of each run, and the smallest and largest.
A bin without a value, or a value that is not a number, ends the program with an error.
"""
import csv
import math
import pathlib
import sys

BINS_M = [(30e3, 100e3), (6e3, 30e3), (3e3, 6e3), (1e3, 3e3), (300, 1e3), (100, 300), (20, 100), (0, 20)]


def values(table, column, range_column):
    """(range, NEES) of the rows that have one."""
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            if row[column]:
                value = float(row[column])
                if not math.isfinite(value):
                    raise SystemExit(f"{table}: {column} is {row[column]} at {row['time_s']} s")
                yield float(row[range_column]), value


def mean(numbers):
    return sum(numbers) / len(numbers)


def table_of(folders, name, column, range_column="range_m"):
    """Rows: bin, mean over runs, least and greatest of a run, number of runs and values."""
    runs = [list(values(folder / name, column, range_column)) for folder in folders]
    for low, high in BINS_M:
        binned = [[nees for distance, nees in run if low <= distance < high] for run in runs]
        binned = [run for run in binned if run]
        if binned:
            means = [mean(run) for run in binned]
            yield [f"{low:g} to {high:g} m", f"{mean(means):.2f}", f"{min(means):.2f}", f"{max(means):.2f}",
                   str(len(binned)), str(sum(map(len, binned)))]


def markdown(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


HEAD = ["range", "NEES, mean of the runs", "least", "greatest", "runs", "images"]


def main():
    folders = [pathlib.Path(argument) for argument in sys.argv[1:]]
    if not folders or any(argument.startswith("-") for argument in sys.argv[1:]):
        raise SystemExit(__doc__)
    found = False
    for name, column, title in (("images.csv", "nees", "relative orbit, bearings"),
                                ("poses.csv", "nees", "relative orbit, keypoints"),
                                ("poses.csv", "attitude_nees", "attitude and rate, keypoints")):
        if not all((folder / name).exists() for folder in folders):
            continue
        rows = list(table_of(folders, name, column))
        if rows:
            found = True
            print(f"\n{title}\n\n{markdown(HEAD, rows)}")
    if not found:
        raise SystemExit("no NEES in these runs")


if __name__ == "__main__":
    main()
