#!/usr/bin/env python3
"""Satellite states out of broadcast ephemerides by RTKLIB's eph2pos (librtklib-dev), for the flight code to meet.

    satellite_states.py PROGRAM --write FOLDER RINEX...   records of navigation files, and their states, into FOLDER
    satellite_states.py PROGRAM --check FOLDER            computes the states of the records again and compares

PROGRAM is vbar_rtklib_orbits, or "none" where the library is missing (exit 77).

FOLDER/broadcast_records.csv holds the records (the flight code's own fields, so that its test needs no RINEX reader),
FOLDER/broadcast_states.csv the states: record number, time, position and velocity in the Earth-fixed frame, clock and its drift.
RTKLIB gives positions; velocities are five-point central differences of them at steps of 4 s, good to 1e-7 m/s.
"""

import argparse
import csv
import pathlib
import subprocess

import rtklib

# What is taken from the files: system, PRN, and which of its records. E11 to E20 are the first four Galileo satellites,
# C01 and C03 geostationary, C06 and C08 inclined, C11 and C14 medium orbits.
WANTED = {"brdc2930.11n": [("G", 1, 3), ("G", 10, 6), ("G", 25, 0)],
          "brdm2000.13p": [("G", 5, 4), ("G", 32, 2), ("E", 11, 20), ("E", 12, 30), ("E", 19, 50), ("E", 20, 100), ("C", 1, 3),
                           ("C", 3, 7), ("C", 6, 5), ("C", 8, 11), ("C", 11, 4), ("C", 14, 6)]}
# From the beginning to the end of the four hours in which a set may be used; odd parts of a second too.
OFFSETS_S = [-14400, -5000.125, 0, 0.25, 1234.5, 7200, 14400]
STEP_S = 4.0


RTKLIB_SYSTEM = {"G": 1, "E": 8, "C": 32}


def positions_and_clocks(program, wanted):
    """[x, y, z, clock] for each (record, time_ns)."""
    lines = [" ".join([str(RTKLIB_SYSTEM[r.system]), str(r.prn), str(r.toe_ns), str(r.toc_ns), str(ns)] +
                      [repr(value) for value in r[6:]]) + "\n" for r, ns in wanted]
    answer = subprocess.run([program], input="".join(lines), capture_output=True, text=True, check=True).stdout.splitlines()
    return [list(map(float, line.split())) for line in answer]


def states(program, wanted):
    """([x y z clock], its rate) for each (record, time_ns)."""
    step = int(STEP_S * rtklib.NS)
    points = positions_and_clocks(program, [(record, ns + k * step) for record, ns in wanted for k in range(-2, 3)])
    for n in range(len(wanted)):
        at = points[5 * n:5 * n + 5]
        yield at[2], [(8 * (at[3][i] - at[1][i]) - (at[4][i] - at[0][i])) / (12 * STEP_S) for i in range(4)]


def read_records(folder):
    with open(folder / "broadcast_records.csv", encoding="ascii") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        expect_header = next(rows)
        rtklib.expect(expect_header == list(rtklib.Ephemeris._fields), "unknown columns")
        return [rtklib.Ephemeris(r[0], int(r[1]), int(r[2]), r[3] == "1", int(r[4]), int(r[5]), *map(float, r[6:])) for r in rows]


def write(program, folder, files):
    records = []
    for file in map(pathlib.Path, files):
        found = rtklib.rinex_ephemerides(file.read_text(encoding="latin-1").splitlines())
        for system, prn, number in WANTED[file.name]:
            records.append([e for e in found if (e.system, e.prn) == (system, prn)][number])
    with open(folder / "broadcast_records.csv", "w", encoding="ascii") as out:
        out.write("# Written by tests/peers/rtklib/satellite_states.py from IGS broadcast files brdc2930.11n and brdm2000.13p\n")
        out.write(",".join(rtklib.Ephemeris._fields) + "\n")
        for e in records:
            out.write(",".join([e.system, str(e.prn), str(e.issue), str(int(e.healthy)), str(e.toe_ns), str(e.toc_ns)] +
                               [repr(value) for value in e[6:]]) + "\n")
    with open(folder / "broadcast_states.csv", "w", encoding="ascii") as out:
        out.write("# Written by tests/peers/rtklib/satellite_states.py: RTKLIB 2.4.3 b34, eph2pos, and differences of it\n")
        out.write("record,time_ns,x,y,z,vx,vy,vz,clock_s,clock_drift\n")
        wanted = [(number, record.toe_ns + int(offset * rtklib.NS)) for number, record in enumerate(records)
                  for offset in OFFSETS_S]
        for (number, ns), (at, rate) in zip(wanted, states(program, [(records[number], ns) for number, ns in wanted])):
            out.write(",".join([str(number), str(ns)] + [f"{v:.6f}" for v in at[:3]] + [f"{v:.8f}" for v in rate[:3]] +
                               [f"{at[3]:.17e}", f"{rate[3]:.6e}"]) + "\n")
    print(f"{len(records)} records, {len(records) * len(OFFSETS_S)} states")


def check(program, folder):
    records = read_records(folder)
    with open(folder / "broadcast_states.csv", encoding="ascii") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    wanted = [(records[int(row[0])], int(row[1])) for row in rows]
    for row, (at, rate) in zip(rows, states(program, wanted)):
        expected = [float(cell) for cell in row[2:]]
        # The file's last digits, and another processor's last bits in differences over seconds.
        for got, known, tolerance in zip([*at[:3], *rate[:3], at[3]], expected, [1e-6] * 3 + [2e-7] * 3 + [1e-16]):
            rtklib.expect(abs(got - known) <= tolerance, f"row {row[:2]}: {got!r} instead of {known!r}")
    print(f"{len(rows)} states as in the file")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--write", nargs="+", metavar=("FOLDER", "RINEX"))
    parser.add_argument("--check", metavar="FOLDER")
    arguments = parser.parse_args()
    if arguments.program == "none":
        rtklib.skip("RTKLIB's library (Debian package librtklib-dev) is not installed")
    if arguments.write:
        write(arguments.program, pathlib.Path(arguments.write[0]), arguments.write[1:])
    else:
        check(arguments.program, pathlib.Path(arguments.check))


if __name__ == "__main__":
    main()
