"""What the tests against RTKLIB share: running convbin and vbar_receiver_tool, and reading RINEX."""

import collections
import datetime
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIP = 77
GPS_EPOCH = datetime.datetime(1980, 1, 6)
NS = 10 ** 9
WEEK_S = 604800
BEIDOU_MINUS_GPS_S = -14

ELEMENTS = ["sqrt_a", "e", "m0", "delta_n", "omega0", "omega_dot", "i0", "i_dot", "omega", "cuc", "cus", "cic", "cis", "crc",
            "crs", "toe_of_week_s", "af0", "af1", "af2", "group_delay_s"]
Ephemeris = collections.namedtuple("Ephemeris", ["system", "prn", "issue", "healthy", "toe_ns", "toc_ns"] + ELEMENTS)
Observation = collections.namedtuple("Observation", ["code", "phase_usable", "pseudorange", "phase", "doppler", "cn0", "lock"])


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIP)


def expect(condition, message):
    if not condition:
        print(f"FAILED: {message}")
        sys.exit(1)


def convbin(data):
    """convbin's observation and navigation files, as lines, from a receiver's bytes."""
    if not shutil.which("convbin"):
        skip("convbin (Debian package rtklib) is not installed")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "log.gps").write_bytes(data)
        subprocess.run(["convbin", "-r", "nov", "log.gps", "-o", "obs", "-n", "nav", "-v", "3.02", "-od", "-os"], cwd=folder,
                       capture_output=True, check=True)
        return [(folder / name).read_text().splitlines() if (folder / name).exists() else [] for name in ("obs", "nav")]


def flight_decoder(tool, data):
    """({(time_ns, system, prn, signal): Observation}, [Ephemeris], counters) by the flight code."""
    lines = subprocess.run([tool], input=data, capture_output=True, check=True).stdout.decode().splitlines()
    observations, ephemerides, counters = {}, [], None
    for kind, *fields in (line.split() for line in lines):
        if kind == "observation":
            key = (int(fields[0]), fields[1], int(fields[2]), int(fields[3]))
            expect(key not in observations, f"{key} comes twice")
            observations[key] = Observation(int(fields[4]), fields[5] == "1", *map(float, fields[6:]))
        elif kind == "ephemeris":
            ephemerides.append(Ephemeris(fields[0], int(fields[1]), int(fields[2]), fields[3] == "1", int(fields[4]),
                                         int(fields[5]), *map(float, fields[6:])))
        else:
            counters = list(map(int, fields))
    return observations, ephemerides, counters


def gps_ns(moment):
    return (moment - GPS_EPOCH) // datetime.timedelta(microseconds=1) * 1000


def body_of(lines):
    for number, line in enumerate(lines):
        if "END OF HEADER" in line:
            return lines[number + 1:]
    return []


def rinex_observations(lines):
    """{(time_ns, satellite, type): (value, loss-of-lock indicator)} of a RINEX 3 observation file; blanks left out."""
    types = {}
    for line in lines:
        if line[60:].startswith("SYS / # / OBS TYPES") and line[0] != " ":
            types[line[0]] = line[7:58].split()
    found, time = {}, None
    for line in body_of(lines):
        if line[0] == ">":
            year, month, day, hour, minute = map(int, line[2:18].split())
            whole, fraction = line[19:29].strip().split(".")
            time = gps_ns(datetime.datetime(year, month, day, hour, minute, int(whole))) + int(fraction) * 100
            continue
        for k, name in enumerate(types[line[0]]):
            cell = line[3 + 16 * k:19 + 16 * k]
            if cell[:14].strip():
                found[time, line[:3].replace(" ", "0"), name] = (float(cell[:14]), int(cell[14:15].strip() or 0))
    return found


def rinex_ephemerides(lines):
    """GPS, Galileo and BeiDou records of a RINEX 2 (GPS) or 3 navigation file, as Ephemeris."""
    rest, found = list(body_of(lines)), []
    version = float(lines[0][:9])
    first, indent = (22, 3) if version < 3 else (23, 4)
    while rest:
        head = rest.pop(0)
        system = "G" if version < 3 else head[0]
        length = 3 if system in "RS" else 7
        record = [head] + [rest.pop(0) for _ in range(length)]
        if system not in "GEC":
            continue
        if version < 3:
            prn, year, month, day, hour, minute = map(int, head[:17].split())
            year += 2000
        else:
            prn, year, month, day, hour, minute = map(int, head[1:20].split())
        values = []
        for number, line in enumerate(record):
            start = first if number == 0 else indent
            cells = [line[k:k + 19] for k in range(start, start + (57 if number == 0 else 76), 19)]
            values += [float(cell.replace("D", "E")) if cell.strip() else 0.0 for cell in cells]
        second = 0 if version < 3 else int(head[20:23])
        found.append(ephemeris_of_record(system, prn, datetime.datetime(year, month, day, hour, minute, second), values))
    return found


def ephemeris_of_record(system, prn, toc, v):
    """v: the record's numbers, clock first (RINEX 3.02, tables A5, A8, A12)."""
    af0, af1, af2, issue, crs, delta_n, m0, cuc, e, cus, sqrt_a, toe, cic, omega0, cis, i0, crc, omega, omega_dot, i_dot = v[:20]
    health = v[24]
    group_delay = v[26] if system == "E" else v[25]
    toc_s = gps_ns(toc) // NS - (BEIDOU_MINUS_GPS_S if system == "C" else 0)
    toe_of_week_gps = int(toe) - (BEIDOU_MINUS_GPS_S if system == "C" else 0)
    toe_s = toc_s + (toe_of_week_gps - toc_s + WEEK_S // 2) % WEEK_S - WEEK_S // 2
    return Ephemeris(system, prn, int(issue), health == 0, toe_s * NS, toc_s * NS, sqrt_a, e, m0, delta_n, omega0, omega_dot, i0,
                     i_dot, omega, cuc, cus, cic, cis, crc, crs, toe, af0, af1, af2, group_delay)


def close(a, b, relative):
    return abs(a - b) <= relative * max(abs(a), abs(b))


def expect_same_ephemeris(ours, theirs):
    name = f"{theirs.system}{theirs.prn:02d} of {theirs.toe_ns // NS}"
    for field in ("system", "prn", "issue", "healthy", "toe_ns", "toc_ns"):
        expect(getattr(ours, field) == getattr(theirs, field),
               f"{name}: {field} is {getattr(ours, field)}, convbin's {getattr(theirs, field)}")
    for field in ELEMENTS:
        a, b = getattr(ours, field), getattr(theirs, field)
        expect(close(a, b, 6e-12), f"{name}: {field} is {a!r}, convbin's {b!r}")  # RINEX has 12 digits, rounded
