#!/usr/bin/env python3
"""tle_test.py VBAR SOURCE: two-line elements as initial orbit, by data/orbits/tle_to_oem.py. 77 without python3-sgp4 and python3-erfa."""
import csv
import datetime
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import erfa  # noqa: F401
    import sgp4  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing.name} is not installed")
    sys.exit(77)

VBAR, SOURCE = map(pathlib.Path, sys.argv[1:3])
SCRIPT = SOURCE / "data/orbits/tle_to_oem.py"
sys.path.insert(0, str(SCRIPT.parent))
sys.dont_write_bytecode = True
import tle_to_oem  # noqa: E402

# Vanguard 1, of the verification cases of "Revisiting Spacetrack Report #3" (AIAA 2006-6753).
VANGUARD = ("1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753",
            "2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667")
STATION = """ISS (ZARYA)
1 25544U 98067A   08264.51782528 -.00002182  00000-0 -11606-4 0  2927
2 25544  51.6416 247.4627 0006703 130.5360 325.0288 15.72125391563537
"""


def series_line(line, epoch):
    """A line of the set with another epoch and its checksum: digits, and 1 for each minus sign."""
    if not line.startswith("1 "):
        return line
    line = line[:18] + epoch + line[32:68]
    return line + str(sum(int(c) if c.isdigit() else int(c == "-") for c in line) % 10)


SERIES = "".join(series_line(line, epoch) + "\n" for epoch in ("08263.40000000", "08264.51782528", "08266.90000000")
                 for line in STATION.splitlines())


class Published(unittest.TestCase):
    def test_rotation_from_teme(self):
        # Vallado, Fundamentals of Astrodynamics, example of 2004-04-06: TEME and J2000 in km, the latter without the observed offsets.
        state = tle_to_oem.eme2000_of_teme(datetime.datetime(2004, 4, 6, 7, 51, 28, 386009), (5094.18016210, 6127.64465950, 6380.34453270))
        self.assertLess(math.dist(state, (5102.5096, 6123.01152, 6378.1363)), 1e-4)

    def test_state_of_vanguard_1(self):
        epoch = datetime.datetime(2000, 6, 27, 18, 50, 19, 733568)
        [(_, position, velocity)] = tle_to_oem.states_of(*VANGUARD, [epoch], "five")
        teme = tle_to_oem.eme2000_of_teme(epoch, (7022.46529266, -1400.08296755, 0.03995155))
        teme_velocity = tle_to_oem.eme2000_of_teme(epoch, (1.893841015, 6.405893759, 4.534807250))
        self.assertLess(math.dist(position, teme), 2e-5)  # of the epoch's microsecond
        self.assertLess(math.dist(velocity, teme_velocity), 2e-8)


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)

    def convert(self, text, *arguments):
        (self.root / "elements.tle").write_text(text)
        return subprocess.run([sys.executable, SCRIPT, self.root / "elements.tle", "--from", "2008-09-20T12:20:00", "--to", "2008-09-20T12:40:00",
                               *arguments], capture_output=True, text=True)

    def test_a_mission_flies_from_it(self):
        converted = self.convert(STATION)
        self.assertEqual(converted.returncode, 0, converted.stderr)
        (self.root / "station.oem").write_text(converted.stdout)
        mission = self.root / "station.toml"
        mission.write_text(f'extends = "{SOURCE}/missions/ideal_navigation.toml"\n[mission]\nepoch_utc = "2008-09-20T12:25:00Z"\nduration_h = 0.05\n'
                           '[[spacecraft]]\nname = "servicer"\norbit_file = "./station.oem"\n')
        flown = subprocess.run([VBAR, "run", mission, "--out", self.root / "run", "--quiet"], capture_output=True, text=True)
        self.assertEqual(flown.returncode, 0, flown.stderr)
        with open(self.root / "run/truth.csv", newline="") as table:
            first = next(csv.DictReader(table))
        row = next(line for line in converted.stdout.splitlines() if line.startswith("2008-09-20T12:25:00"))
        expected = [1e3 * float(value) for value in row.split()[1:4]]
        # The next state of the table is that of the mission's epoch, through EME2000's 0.02 arcsec.
        self.assertLess(math.dist([float(first[f"servicer_position_eci_{axis}_m"]) for axis in "xyz"], expected), 2.0)

    def test_refusals(self):
        for text, arguments, reason in (
                ("", (), "found no two-line elements"),
                (STATION.replace("51.6416", "51.6417"), (), "elements.tle:2: "),
                (STATION.splitlines()[1] + "\n", (), "elements.tle:1: found a first line without the second line"),
                (STATION + "\n".join(VANGUARD), (), "2 objects, accepted: --object with the name or number of one of ISS (ZARYA) (25544), 00005"),
                (SERIES + "\n".join(VANGUARD), (), "2 objects, accepted: --object with the name or number of one of ISS (ZARYA) (25544), 00005"),
                (STATION, ("--object", "MIR"), "no set of MIR, accepted: --object with one of ISS (ZARYA) (25544)")):
            with self.subTest(reason):
                refused = self.convert(text, *arguments)
                self.assertEqual(refused.returncode, 1)
                self.assertIn(reason, refused.stderr)
                self.assertEqual(refused.stdout, "")
                self.assertEqual(len(refused.stderr.splitlines()), 1)
        chosen = self.convert(STATION + "\n".join(VANGUARD), "--object", "25544")
        self.assertIn("OBJECT_NAME = ISS (ZARYA)", chosen.stdout)

    def test_the_nearest_of_a_series_is_used(self):
        alone, of_series = self.convert(STATION), self.convert(SERIES)
        self.assertEqual(of_series.returncode, 0, of_series.stderr)
        # Day 264.51782528 of 2008 is 2008-09-20T12:25:40, 5 min 40 s after --from; the others are a day and more from it.
        used = "used: the set of 2008-09-20T12:25:40 (line 5), 0.00 days after --from, nearest of 3"
        self.assertIn(used, of_series.stderr)
        self.assertIn(f"COMMENT {used}\n", of_series.stdout)
        rows = [[line for line in converted.stdout.splitlines() if line.startswith("2008-")] for converted in (alone, of_series)]
        self.assertEqual(rows[0], rows[1])
        self.assertEqual(alone.stderr, "")

    def test_an_old_set_is_noted_with_its_error(self):
        old = self.convert("\n".join(series_line(line, "08259.51782528") for line in STATION.splitlines()) + "\n")
        self.assertEqual(old.returncode, 0, old.stderr)
        # 5 days, at 1 to 3 km a day.
        self.assertIn("note: the set of 2008-09-15T12:25:40 (line 2), 5.00 days before --from, is used 5.0 days from its epoch: "
                      "an error of 5 to 15 km must be expected", old.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
