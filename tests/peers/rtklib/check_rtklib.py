#!/usr/bin/env python3
"""The emulated GNSS receivers' bytes through RTKLIB.

    check_rtklib.py TOOL convbin      every epoch, observation and ephemeris arrives, with its numbers
    check_rtklib.py TOOL single       rnx2rtkp finds each receiver in orbit and on the ground
    check_rtklib.py TOOL baseline     rnx2rtkp fixes the ambiguities and finds the baseline of two spacecraft

RTKLIB's position file tells a solution's time with the receiver clock taken off, the truth the receiver's own epoch: they differ
by under a millisecond, and are matched by the nearest whole second.
"""

import csv
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIP = 77
EPOCHS, PERIOD_S = 360, 10


def expect(condition, message):
    if not condition:
        print(f"FAILED: {message}")
        sys.exit(1)


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, check=True)


def record(tool, folder, scene):
    """Both receivers' logs of an hour, and their RINEX files."""
    run(tool, folder, scene, EPOCHS, PERIOD_S)
    for name in ("servicer", "target"):
        answer = run("convbin", "-r", "nov", "-v", "3.02", "-od", "-os", "-oi", "-ot", "-ol", folder / f"{name}.gps")
        said = (answer.stdout + answer.stderr).lower()
        expect("error" not in said, f"convbin says: {said[-300:]}")


def truth_of(folder):
    with open(folder / "truth.csv", encoding="ascii") as file:
        return {round(float(row["time_of_week_s"])): row for row in csv.DictReader(file)}


def vector(row, name):
    return [float(row[f"{name}_{axis}"]) for axis in "xyz"]


def solutions(file):
    """(second of week, x, y, z, quality) of each line of rnx2rtkp."""
    for line in file.read_text(encoding="ascii").splitlines():
        if line.startswith("%"):
            continue
        part = line.split()
        yield round(float(part[1])), [float(p) for p in part[2:5]], int(part[5])


def epochs_of(rinex):
    """Numbers of epochs, and of satellites over all epochs, in a RINEX 3 observation file."""
    lines = rinex.read_text(encoding="ascii").splitlines()
    begin = next(k for k, line in enumerate(lines) if "END OF HEADER" in line) + 1
    return sum(line.startswith(">") for line in lines[begin:]), sum(line[:1] in "GEC" for line in lines[begin:])


def navigation_sets(rinex):
    """The eight lines' numbers of each ephemeris of a RINEX 3 navigation file, by satellite and toe."""
    lines = rinex.read_text(encoding="ascii").splitlines()
    at = next(k for k, line in enumerate(lines) if "END OF HEADER" in line) + 1
    sets = {}
    while at + 7 < len(lines):
        numbers = [lines[at][23 + 19 * k:42 + 19 * k] for k in range(3)]
        for line in lines[at + 1:at + 8]:
            numbers += [line[4 + 19 * k:23 + 19 * k] for k in range(4)]
        values = [float(text.replace("D", "e")) if text.strip() else 0.0 for text in numbers]
        sets[lines[at][:3], round(values[11])] = values
        at += 8
    return sets


# Where RINEX 3 keeps each number that ephemerides.csv names (the group delay differs by system).
PLACES = {"af0": 0, "af1": 1, "af2": 2, "issue": 3, "crs": 4, "delta_n": 5, "m0": 6, "cuc": 7, "e": 8, "cus": 9, "sqrt_a": 10,
          "cic": 12, "omega0": 13, "cis": 14, "i0": 15, "crc": 16, "omega": 17, "omega_dot": 18, "i_dot": 19}
GROUP_DELAY = {"G": 25, "E": 26, "C": 25}


def check_convbin(tool):
    for scene in ("orbit", "week_end"):
        check_files(tool, scene)


def check_files(tool, scene):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        record(tool, folder, scene)
        for receiver in ("servicer", "target"):
            epochs, observations = epochs_of(folder / f"{receiver}.obs")
            # Nothing is tracked at the moment of switching on; all later epochs are there.
            expect(epochs == EPOCHS - 1, f"{receiver}: {epochs} epochs")
            sent = sum(int(row[f"{receiver}_satellites"]) for row in truth_of(folder).values())
            expect(observations == sent, f"{receiver}: {observations} of {sent} satellites")
        found = navigation_sets(folder / "servicer.nav")
        compared = set()
        with open(folder / "ephemerides.csv", encoding="ascii") as file:
            for row in csv.DictReader(file):
                values = found.get((row["satellite"], round(float(row["toe_of_week_s"]))))
                if values is None:
                    continue  # never heard in this hour
                system = row["satellite"][0]
                compared.add(system)
                for key, place in {**PLACES, "group_delay_s": GROUP_DELAY[system]}.items():
                    told = float(row[key])
                    # RINEX prints twelve digits after 0.: half a last one is at most 5e-12 of the number. An angle may come back
                    # a turn away, and its turn added before printing.
                    difference = abs(values[place] - told)
                    if key in ("m0", "omega0", "omega"):
                        difference = abs(math.remainder(values[place] - told, 2 * math.pi))
                    expect(difference <= 5.01e-12 * abs(told) + (1e-11 if key in ("m0", "omega0", "omega") else 0),
                           f"{row['satellite']} {key}: RTKLIB reads {values[place]}, sent was {told}")
        expect(compared == set("GEC"), f"ephemerides of {compared} only")
        header = (folder / "servicer.nav").read_text(encoding="ascii").split("END OF HEADER")[0]
        expect("GPSA" in header and "LEAP SECONDS" in header, "no ionosphere or leap seconds in the navigation file")


def position(folder, systems, *options):
    """rnx2rtkp's solutions of an hour. Neither troposphere nor ionosphere is taken off: the emulator has none of the first, on
    the ground none of the second, and in orbit a metre of it is left. (Systems go by an options file: Debian's rnx2rtkp reads
    -sys G as all of them.) Every elevation counts: in orbit the sky goes below the horizontal."""
    settings, output = folder / "options.conf", folder / "solution.pos"
    settings.write_text("pos1-tropopt=off\npos1-ionoopt=off\nout-timeform=tow\nout-solformat=xyz\npos1-elmask=-20\n"
                        f"pos1-navsys={systems}\n", encoding="ascii")
    run("rnx2rtkp", "-k", settings, *options, "-o", output)
    return list(solutions(output))


GPS, ALL = 1, 1 + 8 + 32


def check_single(tool):
    for scene, systems in (("orbit", GPS), ("orbit", ALL), ("week_end", ALL), ("ground", GPS)):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            record(tool, folder, scene)
            truth = truth_of(folder)
            fixes = position(folder, systems, "-p", "0", folder / "servicer.obs", folder / "servicer.nav")
            errors = sorted(math.dist(found, vector(truth[second], "servicer")) for second, found, _ in fixes)
            expect(len(errors) > 0.95 * EPOCHS, f"{scene} {systems}: {len(errors)} solutions")
            median = errors[len(errors) // 2]
            print(f"{scene}, systems {systems}: {len(errors)} fixes, median {median:.2f} m, largest {errors[-1]:.2f} m")
            # Uncorrected broadcast satellites: 1 m a range, times a dilution of 2 and more.
            expect(median < 3.0 and errors[-1] < 12.0, f"{scene} {systems}: median {median} m, largest {errors[-1]} m")


def to_enu(position):
    """Rotation rows east, north, up at an ECEF position (ellipsoid of GRS80)."""
    x, y, z = position
    squared = 6.69438002290e-3
    p = math.hypot(x, y)
    latitude = math.atan2(z, p * (1 - squared))
    for _ in range(10):
        n = 6378137.0 / math.sqrt(1 - squared * math.sin(latitude) ** 2)
        latitude = math.atan2(z + squared * n * math.sin(latitude), p)
    longitude = math.atan2(y, x)
    s, c, so, co = math.sin(latitude), math.cos(latitude), math.sin(longitude), math.cos(longitude)
    return ((-so, co, 0.0), (-s * co, -s * so, c), (c * co, c * so, s))


def check_baseline(tool):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        record(tool, folder, "orbit")
        truth = truth_of(folder)
        for systems in (GPS, ALL):
            # The base moves too: mode 4.
            found = position(folder, systems, "-p", "4", "-a", "-f", "2", folder / "target.obs", folder / "servicer.obs",
                             folder / "servicer.nav")
            errors, total = [], 0
            for second, enu, quality in found:
                total += 1
                if quality != 1:
                    continue
                base, rover = vector(truth[second], "servicer"), vector(truth[second], "target")
                difference = [r - b for r, b in zip(rover, base)]
                expected = [sum(a * d for a, d in zip(row, difference)) for row in to_enu(base)]
                errors.append(math.dist(enu, expected))
            errors.sort()
            print(f"systems {systems}: {len(errors)} of {total} fixed, median {1e3 * errors[len(errors) // 2]:.1f} mm, "
                  f"largest {1e3 * errors[-1]:.1f} mm")
            # The first epoch may lack ephemerides, a slip unfixes now and then.
            expect(len(errors) > 0.95 * EPOCHS, f"systems {systems}: {len(errors)} of {total} epochs fixed")
            # Carrier noise of 1 mm through the geometry: millimetres. A wrong integer would be decimetres.
            expect(errors[len(errors) // 2] < 0.005 and errors[-1] < 0.03, f"systems {systems}: largest {errors[-1]} m")


def main():
    tool, what = sys.argv[1:]
    for program in ("convbin", "rnx2rtkp"):
        if shutil.which(program) is None:
            print(f"skipped: {program} is not installed (Debian package rtklib)")
            sys.exit(SKIP)
    {"convbin": check_convbin, "single": check_single, "baseline": check_baseline}[what](tool)


if __name__ == "__main__":
    main()
