#!/usr/bin/env python3
"""Flies the nineteen cases of Basilisk's accuracy comparison (cases.toml) by `vbar propagate` and compares them with Orekit's states.

    fly_cases.py VBAR [CASE...]     a row for each case: largest difference over its last day, m, beside the published ones; status 1 if one is above
                                    its limit. `quick` for the cases that take a second or less
    --keep FOLDER                   leaves missions and ephemerides there
"""
import argparse
import csv
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
CASES = tomllib.loads((HERE / "cases.toml").read_text())

MISSION = """[mission]
description = "{name}, of Basilisk's comparison with GMAT and Orekit"
epoch_utc = "{epoch}T00:00:00Z"
duration_h = {hours}
step_s = 3600.0

[truth]
gravity_degree = {degree}
gravity_order = {order}
gravity_file = "{gravity}"
permanent_tide = false
{forces}shadow = "conical"
relative_tolerance = 1e-13
earth_orientation_file = "{here}/earth_orientation_{year}.txt"
space_weather_file = "{weather}"

[[spacecraft]]
name = "satellite"
mass_kg = 1000.0
drag_area_m2 = 10.0
drag_coefficient = 2.2
radiation_area_m2 = 10.0
radiation_coefficient = 1.5
orbit_file = "./{name}.opm"
"""
STATE = """CCSDS_OPM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = VBAR
OBJECT_NAME = {name}
OBJECT_ID = 2026-000A
CENTER_NAME = EARTH
REF_FRAME = GCRF
TIME_SYSTEM = UTC
EPOCH = {epoch}T00:00:00
"""


def write_mission(folder, name, case):
    epoch = case.get("epoch", "2026-01-01")
    state = CASES["orbits"][case["orbit"]]
    fields = zip(("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT"), state)
    (folder / f"{name}.opm").write_text(STATE.format(name=name, epoch=epoch) + "".join(f"{key} = {value / 1e3:.12g}\n" for key, value in fields))
    mission = folder / f"{name}.toml"
    mission.write_text(MISSION.format(
        name=name, epoch=epoch, year=epoch[:4], hours=24.0 * case.get("days", 30), here=HERE, degree=case.get("degree", 0), order=case.get("order", 0),
        gravity=case.get("gravity", HERE / "egm96_20.gfc"), forces="".join(f"{force} = true\n" for force in case.get("forces", [])),
        weather=HERE / "space_weather_2024.txt" if case.get("space_weather") else "constant"))
    return mission


def fly(vbar, folder, name, case):
    """Positions in GCRF, m, by seconds after the epoch."""
    mission = write_mission(folder, name, case)
    subprocess.run([vbar, "propagate", mission, "--out", folder / name, "--quiet"], check=True)
    with open(folder / name / "satellite.csv", newline="") as table:
        return {int(row["time_s"]): [float(row[f"position_eci_{axis}_m"]) for axis in "xyz"] for row in csv.DictReader(table)}


def reference_of(name):
    with open(HERE / "reference.csv", newline="") as table:
        return {int(row["time_s"]): [float(row[axis]) for axis in ("x_m", "y_m", "z_m")] for row in csv.DictReader(table) if row["case"] == name}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("vbar", type=pathlib.Path)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    unknown = set(options.cases) - set(CASES["case"]) - {"quick"}
    if unknown:
        parser.error(f"found {', '.join(sorted(unknown))}; accepted: quick, {', '.join(CASES['case'])}")
    failed = []
    print(f"{'case':22}{'vbar-Orekit':>14}{'Basilisk-Orekit':>18}{'Basilisk-GMAT':>16}{'GMAT-Orekit':>14}   m")
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or pathlib.Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name, case in CASES["case"].items():
            is_quick = "quick" in options.cases and not case.get("slow")
            if options.cases and name not in options.cases and not is_quick:
                continue
            published = "".join(f"{case['published'].get(pair, '–'):>{width}}"
                                for pair, width in (("basilisk_orekit", 18), ("basilisk_gmat", 16), ("gmat_orekit", 14)))
            if "gap" in case:
                print(f"{name:22}{'not flown':>14}{published}")
                continue
            flown, reference = fly(options.vbar.resolve(), folder, name, case), reference_of(name)
            largest = max(math.dist(flown[time], position) for time, position in reference.items())
            print(f"{name:22}{largest:14.3f}{published}", flush=True)
            if not largest <= case["limit_m"]:
                failed.append(f"{name}: found {largest:.3f} m, accepted: up to {case['limit_m']} m")
    print("\n".join(failed))
    return 1 if failed else 0


sys.exit(main())
