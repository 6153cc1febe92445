#!/usr/bin/env python3
"""Ten minutes of experiment 3 with gnss-sdr as both receivers, in real time.

usage: ci/verify_gnss_sdr.py [--build build/host]

Requires gnss-sdr and two cores that do nothing else. Fails if navigation does not resolve the ambiguities within 300 s of its first
GNSS solution, or if its mean error from then on exceeds 15 mm.
"""
import argparse
import math
import pathlib
import shutil
import statistics
import tempfile

from flights import fly
from verify_experiment3 import FIXED, relative, rows_of

ROOT = pathlib.Path(__file__).resolve().parent.parent
MISSION = "missions/experiment3_grand_gnss_sdr.toml"
FLOAT = "gnss_float"
MAX_TIME_TO_FIX_S, MAX_MEAN_ERROR_M = 300.0, 0.015


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/host")
    build = parser.parse_args().build
    if shutil.which("gnss-sdr") is None:
        raise SystemExit("gnss-sdr is not installed (Debian package gnss-sdr)")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "run"
        summary = fly(build, ROOT, MISSION, folder)
        truth, estimates = rows_of(folder / "truth.csv"), rows_of(folder / "estimate.csv")
        start = float(truth[0]["time_s"])
        times = [(float(row["time_s"]) - start, row["navigation_source"]) for row in estimates]
        first = min((time for time, source in times if source in (FLOAT, FIXED)), default=math.inf)
        fixed = min((time for time, source in times if source == FIXED), default=math.inf)
        errors = [math.dist(relative(row, "position", "m"), relative(true, "position", "m"))
                  for true, row, (time, _) in zip(truth, estimates, times) if time >= fixed]
    mean = statistics.fmean(errors) if errors else math.inf
    print(f"gnss-sdr as both receivers: complete {summary['complete']}, first solution {first:.0f} s, first fix {fixed:.0f} s, "
          f"mean error {1e3 * mean:.1f} mm in {len(errors)} steps from then on")
    if not (summary["complete"] and fixed - first <= MAX_TIME_TO_FIX_S and mean <= MAX_MEAN_ERROR_M):
        raise SystemExit("gnss-sdr as both receivers: outside its limits (300 s, 15 mm)")


if __name__ == "__main__":
    main()
