#!/usr/bin/env python3
"""The emulated generator's signals through gnss-sdr, a software receiver, and RTKLIB.

    check_gnss_sdr.py TOOL receiver [FOLDER]    70 s of one spacecraft behind the serial line of the bench
    check_gnss_sdr.py TOOL baseline [FOLDER]    120 s of two spacecraft: double differences and the fixed baseline

Samples go through a FIFO, so that nothing of their 5 MB a second reaches a disk. The receivers' files are kept in FOLDER if one
is given, and in a temporary folder otherwise.
"""

import collections
import datetime
import math
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

SKIP = 77
LIGHT_MPS = 299792458.0
WAVELENGTH_M = LIGHT_MPS / 1575.42e6
GPS_EPOCH = datetime.datetime(1980, 1, 6)
WEEK_S = 604800

# gnss-sdr's carrier loop as configured: emulators/grand/samples/gnss_sdr_process.cpp.
PLL_HZ, INTEGRATION_S = 15.0, 0.010

# Satellites with a larger Doppler are reported and not judged: the phase that gnss-sdr 0.0.17 reports of them wanders by up to
# 0.06 cycles within a minute, differently in two receivers. The samples correlated directly show their phases to 0.001 cycles.
MAX_DOPPLER_HZ = 20e3

Observation = collections.namedtuple("Observation", ["code_m", "phase_cycles", "slip", "doppler_hz", "cn0_dbhz"])


def expect(condition, message):
    if not condition:
        print(f"FAILED: {message}")
        sys.exit(1)


class Reception:
    """One spacecraft: the program that makes samples, and gnss-sdr that receives them."""

    def __init__(self, tool, folder, name, seconds):
        self.folder, self.name = folder / name, name
        (self.folder / "rinex").mkdir(parents=True)
        os.mkfifo(self.folder / "samples")
        configuration = self.folder / "gnss-sdr.conf"
        said = subprocess.run([tool, "configuration", self.folder / "samples", self.folder / "rinex"], capture_output=True,
                              text=True, check=True)
        configuration.write_text(said.stdout, encoding="ascii")
        self.log = open(self.folder / "receiver.txt", "wb")
        self.receiver = subprocess.Popen(["gnss-sdr", f"--config_file={configuration}", f"--log_dir={self.folder}"],
                                         stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT, cwd=self.folder)
        self.generator = subprocess.Popen([tool, name, str(seconds), self.folder / "samples", self.folder / "truth.csv"])

    def finish(self):
        """gnss-sdr waits for ever at the end of a FIFO: it is ended once its files no longer grow."""
        status = self.generator.wait()
        size = -1
        while self.receiver.poll() is None and size != (now := self.output_size()):
            size = now
            time.sleep(4.0)
        self.stop()
        expect(status == 0, f"{self.name}: the program that makes samples ended with status {status}")

    def output_size(self):
        """Of what it prints every second; its log grows for ever."""
        return (self.folder / "receiver.txt").stat().st_size

    def stop(self):
        for process in (self.generator, self.receiver):
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
                try:
                    process.wait(10.0)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        self.log.close()

    def rinex(self, kind):
        found = list((self.folder / "rinex").glob(f"*.[0-9][0-9]{kind}"))
        expect(len(found) == 1 and found[0].stat().st_size > 0, f"{self.name}: gnss-sdr wrote no RINEX file of kind {kind}")
        return found[0]


def receive(tool, folder, names, seconds):
    receptions = [Reception(tool, folder, name, seconds) for name in names]
    try:
        for reception in receptions:
            reception.finish()
    finally:
        for reception in receptions:
            reception.stop()
    return receptions


def number(text):
    return float(text) if text.strip() else math.nan


def observations(file):
    """{(second of week, satellite): Observation} of gnss-sdr's RINEX 3: C1C, L1C, D1C, S1C. Its last record may be cut off."""
    found, second = {}, None
    lines = file.read_text(encoding="ascii").split("\n")
    begin = next(k for k, line in enumerate(lines) if "END OF HEADER" in line) + 1
    types = next(line.split()[2:6] for line in lines if "SYS / # / OBS TYPES" in line)
    expect(types == ["C1C", "L1C", "D1C", "S1C"], f"{file}: observations are {types}")
    for line in lines[begin:-1]:
        if line.startswith(">"):
            part = line[1:].split()
            moment = datetime.datetime(*(int(p) for p in part[:5]))
            second = (moment - GPS_EPOCH).total_seconds() % WEEK_S + float(part[5])
        elif line[:1] == "G" and len(line) >= 65:
            slip = line[33:34] not in (" ", "0")
            found[round(second, 7), line[:3]] = Observation(number(line[3:17]), number(line[19:33]), slip, number(line[35:49]),
                                                            number(line[51:65]))
    return found


def truth_of(file):
    """{(second, satellite): (carrier m, code m, C/N0)} and {second: antenna}."""
    ranges, antenna = {}, {}
    for line in file.read_text(encoding="ascii").split("\n")[1:-1]:
        part = line.split(",")
        second = float(part[0])
        ranges[second, part[1]] = tuple(float(p) for p in part[2:5])
        antenna[second] = [float(p) for p in part[5:8]]
    return ranges, antenna


def phase_sigma_m(cn0_dbhz):
    """Thermal noise of a carrier loop (Kaplan, Hegarty 2017, 8.3.3)."""
    cn0 = 10 ** (cn0_dbhz / 10)
    return WAVELENGTH_M / (2 * math.pi) * math.sqrt(PLL_HZ / cn0 * (1 + 1 / (2 * INTEGRATION_S * cn0)))


def check_receiver(tool, folder):
    """What gnss-sdr measures comes out of the bench's serial line as an OEM628 sends it: RTKLIB's convbin reads it."""
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([tool, "receiver", "70", folder / "gnss_sdr", folder / "line.gps", folder / "truth.csv"], check=True)
    subprocess.run(["convbin", "-r", "nov", "-v", "3.02", "-od", "-os", "-o", folder / "line.obs", "-n", folder / "line.nav",
                    folder / "line.gps"], capture_output=True, check=True)
    found, truth = observations(folder / "line.obs"), truth_of(folder / "truth.csv")
    report_codes([found], [truth])
    ephemerides = {line[:3] for line in (folder / "line.nav").read_text(encoding="ascii").split("\n") if line[:1] == "G"}
    expect(len(ephemerides) >= 5, f"ephemerides of {sorted(ephemerides)} only")
    check_phases(found, truth)


def check_phases(found, truth):
    """Without an offset of its own at the start the carrier's phase is the range's but for whole cycles."""
    judged = 0
    for satellite in sorted({name for _, name in found}):
        seconds = [s for s, name in found if name == satellite and (s, name) in truth[0]]
        if len(seconds) < 5 or any(abs(found[s, satellite].doppler_hz) > MAX_DOPPLER_HZ for s in seconds):
            continue
        cycles = [found[s, satellite].phase_cycles - truth[0][s, satellite][0] / WAVELENGTH_M for s in seconds]
        fraction = statistics.median(cycles) - round(statistics.median(cycles))
        print(f"  {satellite}: phase {1e3 * WAVELENGTH_M * fraction:+.2f} mm beside a whole number of cycles")
        expect(abs(fraction) < 0.02, f"{satellite}: phase is {fraction} cycles off")
        judged += 1
    expect(judged >= 3, f"only {judged} phases")


def spread(values):
    return statistics.pstdev(values) if len(values) > 1 else math.nan


def check_baseline(tool, folder):
    receptions = receive(tool, folder, ["servicer", "target"], 120)
    found = [observations(reception.rinex("O")) for reception in receptions]
    truth = [truth_of(reception.folder / "truth.csv") for reception in receptions]
    report_codes(found, truth)
    check_double_differences(found, truth)
    check_rtklib(folder, receptions, truth)


def report_codes(found, truth):
    for which, name in enumerate(("servicer", "target")[:len(found)]):
        by_satellite = collections.defaultdict(list)
        for key, o in found[which].items():
            if key in truth[which][0]:
                by_satellite[key[1]].append((o.code_m - truth[which][0][key][1], o.cn0_dbhz - truth[which][0][key][2]))
        expect(len(by_satellite) >= 5, f"{name}: {len(by_satellite)} satellites in RINEX")
        clock = statistics.median(c for values in by_satellite.values() for c, _ in values)
        print(f"{name}: {len({s for s, _ in found[which]})} epochs, receiver clock {1e9 * clock / LIGHT_MPS:.1f} ns")
        expect(abs(clock) < 1e-7 * LIGHT_MPS, f"{name}: receiver clock is {clock / LIGHT_MPS} s off")
        for satellite, values in sorted(by_satellite.items()):
            error_m = statistics.mean(c for c, _ in values) - clock
            loss_db = statistics.mean(d for _, d in values)
            # Code noise is 0.3 to 0.9 m; its loop of 0.5 Hz gives a new value each second. C/N0: the band is limited by sampling.
            expect(abs(error_m) < 3.0 and abs(loss_db) < 3.0, f"{name} {satellite}: code {error_m} m, C/N0 {loss_db} dB off")
            print(f"  {satellite}: {len(values)} epochs, code {statistics.mean(c for c, _ in values) - clock:+.2f} m, "
                  f"std {spread([c for c, _ in values]):.2f} m, C/N0 {statistics.mean(d for _, d in values):+.1f} dB against truth")


def arcs_of(found, satellite):
    """The satellite's epochs that both receivers have, cut where one of them lost lock."""
    arcs, last = [], None
    for second in sorted(s for s, name in found[0] if name == satellite and (s, name) in found[1]):
        if last is None or second != last + 1 or any(f[second, satellite].slip for f in found):
            arcs.append([])
        arcs[-1].append(second)
        last = second
    return arcs


def check_double_differences(found, truth):
    satellites = {name for _, name in found[0]} & {name for _, name in found[1]}
    longest = {name: max(arcs_of(found, name), key=len, default=[]) for name in satellites}
    fast = {name for name in satellites if any(abs(f[s, name].doppler_hz) > MAX_DOPPLER_HZ for f in found for s in longest[name])}
    reference = max(satellites - fast, key=lambda name: len(longest[name]))
    expect(len(longest[reference]) >= 50, f"{reference}: only {len(longest[reference])} epochs in common")

    def single(second, name):
        """Phase of target minus servicer beyond the known ranges, cycles."""
        value = [f[second, name].phase_cycles - t[0][second, name][0] / WAVELENGTH_M for f, t in zip(found, truth)]
        return value[1] - value[0]

    compared = 0
    for name in sorted(satellites - {reference}):
        seconds = [s for s in longest[name] if s in set(longest[reference])]
        if len(seconds) < 30:
            print(f"  {name}: {len(seconds)} epochs, not compared")
            continue
        double = [single(s, name) - single(s, reference) for s in seconds]
        integer = round(statistics.median(double))
        mean_mm = 1e3 * WAVELENGTH_M * (statistics.mean(double) - integer)
        std_mm = 1e3 * WAVELENGTH_M * spread(double)
        formula_mm = 1e3 * statistics.mean(
            math.sqrt(sum(phase_sigma_m(f[s, n].cn0_dbhz) ** 2 for f in found for n in (name, reference))) for s in seconds)
        print(f"  {name}-{reference}: {len(seconds)} epochs, integer {integer}, mean {mean_mm:+.2f} mm, std {std_mm:.2f} mm, "
              f"{std_mm / formula_mm:.2f} of the formula")
        if name in fast:
            print(f"  {name}: not judged, its Doppler exceeds {MAX_DOPPLER_HZ:.0f} Hz")
            continue
        expect(abs(mean_mm) <= 2.0, f"{name}-{reference}: the double difference is {mean_mm} mm off an integer")
        expect(0.6 <= std_mm / formula_mm <= 1.4, f"{name}-{reference}: std {std_mm} mm, formula {formula_mm} mm")
        compared += 1
    expect(compared >= 4, f"only {compared} double differences")


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


def check_rtklib(folder, receptions, truth):
    """The base moves too: mode 4. Ionosphere and troposphere as check_rtklib.py has them; noise of code and phase as gnss-sdr has
    it (1 m, 3 mm) at every elevation: in orbit RTKLIB's growth towards the horizon does not apply."""
    settings, output = folder / "options.conf", folder / "baseline.pos"
    settings.write_text("pos1-tropopt=off\npos1-ionoopt=off\nout-timeform=tow\nout-solformat=xyz\npos1-elmask=-20\npos1-navsys=1\n"
                        "stats-eratio1=300\nstats-errphase=0.003\nstats-errphaseel=0\n",
                        encoding="ascii")
    servicer, target = receptions
    subprocess.run(["rnx2rtkp", "-k", settings, "-p", "4", "-a", "-f", "1", "-o", output, target.rinex("O"), servicer.rinex("O"),
                    servicer.rinex("N")], capture_output=True, check=True)
    errors, total = [], 0
    for line in output.read_text(encoding="ascii").split("\n"):
        if not line or line.startswith("%"):
            continue
        part = line.split()
        total += 1
        if int(part[5]) != 1 or float(part[14]) <= 5.0:
            continue
        second = round(float(part[1]))
        base, rover = truth[0][1][second], truth[1][1][second]
        difference = [r - b for r, b in zip(rover, base)]
        expected = [sum(a * d for a, d in zip(row, difference)) for row in to_enu(base)]
        errors.append(math.dist([float(p) for p in part[2:5]], expected))
    expect(errors, f"RTKLIB fixed none of {total} epochs with a ratio above 5")
    rms_mm = 1e3 * math.sqrt(statistics.mean(e * e for e in errors))
    print(f"RTKLIB: {len(errors)} of {total} epochs fixed with a ratio above 5, {rms_mm:.1f} mm RMS (three axes together)")
    expect(rms_mm <= 10.0, f"baseline is {rms_mm} mm off")


def main():
    tool, what = sys.argv[1:3]
    needed = {"receiver": [("gnss-sdr", "gnss-sdr"), ("convbin", "rtklib")], "baseline": [("gnss-sdr", "gnss-sdr"), ("rnx2rtkp", "rtklib")]}
    for program, package in needed[what]:
        if shutil.which(program) is None:
            print(f"skipped: {program} is not installed (Debian package {package})")
            sys.exit(SKIP)
    check = {"receiver": check_receiver, "baseline": check_baseline}[what]
    if len(sys.argv) > 3:
        check(tool, pathlib.Path(sys.argv[3]).absolute())
    else:
        with tempfile.TemporaryDirectory() as name:
            check(tool, pathlib.Path(name))


if __name__ == "__main__":
    main()
