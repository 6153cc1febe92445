#!/usr/bin/env python3
"""vbar fit: an orbit that vbar propagate flew, fitted from its OEM and flown again, and what is refused."""
import csv
import math
import re
import unittest

from vbar_program import SOURCE, main, overrides, scratch, vbar

ORBIT = SOURCE / "missions" / "full_force_orbit.toml"
SHORT = overrides("mission.duration_h=6", "truth.gravity_degree=20", "truth.gravity_order=20")


class Fit(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        # Areas other than those of the fit: 1.5 and 0.8 of them.
        flown = vbar("propagate", ORBIT, "--oem", "--out", cls.folder / "flown", *SHORT,
                     *overrides("spacecraft.mango.drag_area_m2=1.95", "spacecraft.mango.radiation_area_m2=2.0"))
        assert flown.returncode == 0, flown.stderr
        cls.oem = cls.folder / "flown" / "mango.oem"

    def fit(self, *arguments):
        return vbar("fit", ORBIT, self.oem, "--no-ocean-tides", *arguments, *SHORT)

    def test_a_flown_orbit_is_found_and_flown_again(self):
        out = self.folder / "fit"
        result = self.fit("--out", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        rms = float(re.search(r"residuals  rms ([\d.]+) m", result.stdout)[1])
        self.assertLess(rms, 1e-3)  # digits of the OEM: a micrometre; two integrations: below a millimetre
        for name, expected in (("drag scale", 1.5), ("radiation scale", 0.8)):
            value = float(re.search(rf"{name} +([-\d.]+)", result.stdout)[1])
            self.assertAlmostEqual(value, expected, delta=0.01)
        self.assertNotIn("does not fit as one", result.stdout)
        self.assertIn("<svg", (out / "fit.html").read_text())
        with (out / "residuals.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["use"] for row in rows], ["fitted"] * 361)

        again = vbar("propagate", out / "mango.toml", "--out", self.folder / "again")
        self.assertEqual(again.returncode, 0, again.stderr)
        ends = []
        for folder in ("flown", "again"):
            with (self.folder / folder / "mango.csv").open() as file:
                ends.append(list(csv.DictReader(file))[-1])
        self.assertEqual(ends[0]["utc"], ends[1]["utc"])
        distance = math.dist(*([float(end[f"position_eci_{axis}_m"]) for axis in "xyz"] for end in ends))
        self.assertLess(distance, 0.01)

    def test_a_prediction_is_compared_by_day(self):
        result = self.fit("--days", "0.1", "--predict", "1", "--fix", "radiation", "--out", self.folder / "predicted")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"(?m)^day   1 ")

    def test_refusals_are_a_sentence(self):
        short, empty = self.folder / "short.oem", self.folder / "empty.oem"
        lines = self.oem.read_text().splitlines(keepends=True)
        first = next(k for k, line in enumerate(lines) if line.startswith("20"))
        short.write_text("".join(lines[:first + 5]))
        empty.write_text("")
        for arguments, message in (
                ([empty], "an orbit in one of the formats"),
                ([self.folder / "none.oem"], "cannot open the orbit file"),
                ([self.oem, "--object", "tango"], "has no object"),
                ([self.oem, "--from", "2011-07-19T00:00:00Z"], "0 positions over 0 s in the span to fit; accepted: at least 10"),
                ([self.oem, "--from", "yesterday"], "--from: "),
                ([self.oem, "--burn", "2011-07-18T02:00:00Z,1"], "accepted: UTC,R,T,N or UTC,R,T,N,DURATION"),
                ([self.oem, "--burn", "2011-07-18T23:00:00Z,0,1,0"], "is not within the arc from"),
                ([self.oem, "--spacecraft", "tango"], "has no spacecraft \"tango\""),
                ([short], "5 positions over 240 s")):
            with self.subTest(message):
                result = vbar("fit", ORBIT, *arguments, "--out", self.folder / "refused", *SHORT)
                self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
                self.assertIn(message, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)
                self.assertFalse((self.folder / "refused").exists())


if __name__ == "__main__":
    main()
