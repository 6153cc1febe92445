#!/usr/bin/env python3
"""A laser range finder beside the receivers of experiment 3: recorded, evaluated, in the report, without effect on the flight."""
import csv
import math
import statistics
import unittest

from vbar_program import SOURCE, fly, hashes, main, scratch, vbar

SHORT = ("mission.duration_h=0.5",)
BIAS_SIGMA_M, NOISE_SIGMA_M = 0.02, 0.01


class RangeFinder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.run_folder = cls.folder / "run"
        cls.summary = fly(cls.run_folder, *SHORT, mission=SOURCE / "missions" / "range_finder.toml")
        with open(cls.run_folder / "range_finder.csv", newline="") as table:
            cls.rows = list(csv.DictReader(table))

    def test_the_flight_is_the_one_without_it(self):
        without = fly(self.folder / "without", *SHORT, mission=SOURCE / "missions" / "experiment3.toml")
        self.assertEqual(hashes(self.summary)[0], hashes(without)[0])

    def test_navigation_estimates_its_bias(self):
        used = fly(self.folder / "used", *SHORT, "spacecraft.servicer.sensors.lidar.used_by_navigation=true",
                   mission=SOURCE / "missions" / "range_finder.toml")
        self.assertNotEqual(hashes(self.summary)[1], hashes(used)[1])
        with open(self.folder / "used" / "telemetry_range.csv", newline="") as table:
            last = list(csv.DictReader(table))[-1]
        errors = [float(row["error_m"]) for row in self.rows if row["measured_m"]]
        self.assertGreater(int(last["used"]), 100)
        self.assertEqual(int(last["refused"]), 0)
        self.assertLess(float(last["bias_sigma_m"]), 0.5 * BIAS_SIGMA_M)
        self.assertLess(abs(float(last["bias_m"]) - statistics.mean(errors)), 3 * float(last["bias_sigma_m"]))

    def test_measurements_are_beside_the_truth(self):
        self.assertEqual(len(self.rows), 181)  # every 10 s, both ends included
        measured = [row for row in self.rows if row["measured_m"]]
        self.assertGreater(len(measured), 50)
        errors = [float(row["measured_m"]) - float(row["true_m"]) for row in measured]
        for row, error in zip(measured, errors):
            self.assertAlmostEqual(float(row["error_m"]), error, places=9)
            self.assertEqual(row["in_field_of_view"], "1")
        self.assertLess(abs(statistics.mean(errors)), 4 * math.hypot(BIAS_SIGMA_M, NOISE_SIGMA_M))
        self.assertAlmostEqual(statistics.pstdev(errors), NOISE_SIGMA_M, delta=4 * NOISE_SIGMA_M / math.sqrt(2 * len(errors)))

    def test_truth_is_the_table_of_truth(self):
        with open(self.run_folder / "truth.csv", newline="") as table:
            truth = {row["time_s"]: row for row in csv.DictReader(table)}
        for row in self.rows:
            at = truth[row["time_s"]]
            distance = math.dist(*([float(at[f"{name}_position_eci_{axis}_m"]) for axis in "xyz"] for name in ("servicer", "target")))
            self.assertAlmostEqual(float(row["true_m"]), distance, places=6)

    def test_summary_and_report(self):
        figures = self.summary["sensor_figures"]["lidar"]
        measured = [row for row in self.rows if row["measured_m"]]
        self.assertEqual(figures["measurements"], len(measured))
        self.assertEqual(figures["epochs"], len(self.rows))
        self.assertAlmostEqual(figures["range_error_mean_m"], statistics.mean(float(row["error_m"]) for row in measured), places=12)
        self.assertEqual(self.summary["health"]["rejected_type"], 0)
        self.assertIn("Laser range finder", (self.run_folder / "report.html").read_text())

    def test_replay_and_report_of_the_folder(self):
        result = vbar("replay", self.run_folder)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        before = (self.run_folder / "report.html").read_text()
        self.assertEqual(vbar("report", self.run_folder).returncode, 0)
        self.assertEqual((self.run_folder / "report.html").read_text(), before)


if __name__ == "__main__":
    main()
