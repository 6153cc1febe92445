"""ci/fault_judgement.py finds what a run misses, and passes neither a NaN nor a missing table. Usage: fault_judgement_test.py ROOT."""

import csv
import json
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "ci"))
import fault_table  # noqa: E402
from fault_judgement import Case, JudgementError, Nominal, begin_of, judge, navigation_errors, window_of  # noqa: E402

BEGIN_S = 1000.0
SILENT = {"kind": "silent", "unit": "gnss", "for_s": 600.0}


def write(file, rows):
    with open(file, "w", newline="", encoding="utf-8") as text:
        table = csv.DictWriter(text, rows[0].keys())
        table.writeheader()
        table.writerows(rows)


class Run(unittest.TestCase):
    """10 m from the target, every 60 s for 6000 s, with errors of 1 cm and of 3 cm from BEGIN_S on."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.folder = pathlib.Path(directory.name)
        self.times = [60.0 * n for n in range(100)]
        self.write_positions(lambda time_s: 0.03 if time_s >= BEGIN_S else 0.01)
        self.nominal = Nominal([(time_s, 0.01) for time_s in self.times], [(900.0, 0.5), (3000.0, 0.02), (4000.0, 0.05), (5000.0, 0.01)])
        self.events = [self.event(1020.0, "fault_raised", fault="crosslink_silent"), self.event(1020.0, "aid", device="carrier_pair", after="suspended"),
                       self.event(1650.0, "aid", device="carrier_pair", after="aiding")]
        write(self.folder / "telemetry_event.csv", self.events)
        write(self.folder / "gnss.csv", [{"time_s": t, "fixed": 0 if BEGIN_S <= t < 1600.0 else 20} for t in self.times])
        self.write_summary()

    @staticmethod
    def event(time_s, event, fault="", device="", after=""):
        return {"step_time_s": time_s, "event": event, "fault": fault, "device": device, "after": after}

    def write_summary(self, complete=True, **figures):
        faults = {"injected": 1, "without_effect": 0, "min_distance_m": 9.9, **figures}
        (self.folder / "summary.json").write_text(json.dumps({"complete": complete, "sensor_figures": {"faults": faults}}))

    def write_positions(self, error_m, distance_m=lambda time_s: 10.0, is_valid=lambda time_s: True):
        truth, estimate = [], []
        for time_s in self.times:
            place = {"relative_position_rtn_r_m": 0.0, "relative_position_rtn_t_m": distance_m(time_s), "relative_position_rtn_n_m": 0.0}
            truth.append({"time_s": time_s, **place})
            off = {**place, "relative_position_rtn_r_m": error_m(time_s)}
            estimate.append({"time_s": time_s, "navigation_valid": "1" if is_valid(time_s) else "0", **off})
        write(self.folder / "truth.csv", truth)
        write(self.folder / "estimate.csv", estimate)

    def misses(self, **keys):
        case = Case(**{"faults": [SILENT], "event": "crosslink_silent", "within": 30.0, **keys})
        return judge(self.folder, case, BEGIN_S, 60.0, 5.0, self.nominal)["misses"]

    def test_a_run_that_meets_its_row_misses_nothing(self):
        self.assertEqual(self.misses(sources=("carrier_pair",), fixed_within_s=60.0, error_ratio=3.1, error_m=0.04, retreats=False), [])

    def test_errors_are_compared_with_the_nominal_run(self):
        self.assertEqual(self.misses(error_ratio=2.9), ["maximum error 3.00 times nominal", "median error 3.00 times nominal"])
        self.assertEqual(self.misses(error_m=0.02), ["error 0.030 m, not 0.02"])
        self.write_positions(lambda time_s: 0.03 if BEGIN_S <= time_s < 1500.0 else 0.01)
        self.assertEqual(self.misses(error_ratio=1.2, error_from_s=600.0), [])
        self.assertEqual(self.misses(error_ratio=1.2), ["maximum error 3.00 times nominal"])

    def test_time_limits(self):
        self.assertEqual(self.misses(within=10.0), ["reported later than 10 s"])
        self.assertEqual(self.misses(within=lambda period_s, step_s: period_s / 10.0), ["reported later than 6 s"])
        self.assertEqual(self.misses(within=lambda period_s, step_s: step_s), ["reported later than 5 s"])
        self.assertEqual(self.misses(event="image_frozen"), ["not reported"])
        self.assertEqual(self.misses(event=("image_frozen", "crosslink_silent")), [])
        self.assertEqual(self.misses(retreats=True), ["does not retreat"])
        self.assertEqual(self.misses(fixed_within_s=10.0), ["fixed after 20 s"])
        write(self.folder / "gnss.csv", [{"time_s": t, "fixed": 0} for t in self.times])
        self.assertEqual(self.misses(fixed_within_s=60.0), ["not fixed again"])

    def test_a_retreat_counts_while_images_are_frequent(self):
        write(self.folder / "telemetry_event.csv", self.events + [self.event(3000.0, "fault_raised", fault="retreat")])

        def misses(retreats, sensed_until_s):
            case = Case([SILENT], "crosslink_silent", 30.0, retreats=retreats)
            return judge(self.folder, case, BEGIN_S, 60.0, 5.0, self.nominal, sensed_until_s)["misses"]
        self.assertEqual(misses(False, 3000.0), ["retreats"])
        self.assertEqual(misses(False, 2999.0), [])
        self.assertEqual(misses(True, 2999.0), [])

    def test_distance_and_effect(self):
        self.write_positions(lambda _: 0.01, distance_m=lambda time_s: 1.9 if time_s == 3000.0 else 10.0)
        self.assertEqual(self.misses(), ["distance"])
        self.write_positions(lambda _: 0.01)
        self.write_summary(min_distance_m=1.99)
        self.assertEqual(self.misses(), ["distance"])
        self.write_summary(without_effect=1)
        self.assertEqual(self.misses(), ["no effect"])
        self.write_summary(complete=False)
        self.assertEqual(self.misses(), ["incomplete"])

    def test_arrivals_are_those_at_the_next_two_waypoints(self):
        def fly(*control_errors_m):
            write(self.folder / "waypoints.csv", [{"time_s": t, "control_error_m": e} for t, e in zip((900.0, 3000.0, 4000.0, 5000.0), control_errors_m)])
        fly(9.0, 0.02, 0.09, 9.0)
        self.assertEqual(self.misses(arrival_ratio=2.0), [])
        self.assertEqual(self.misses(arrival_ratio=1.5), ["arrives with 1.80 times the nominal error"])
        for arrivals in ((9.0, 0.02), (9.0, 0.02, "", 9.0)):
            fly(*arrivals)
            self.assertEqual(self.misses(arrival_ratio=2.0), ["does not arrive"])
        fly(9.0, 0.02, "nan", 9.0)
        with self.assertRaisesRegex(JudgementError, "'nan'"):
            self.misses(arrival_ratio=2.0)
        fly(9.0, 0.02, 0.09)
        self.nominal = None
        with self.assertRaisesRegex(JudgementError, "without the fault"):
            self.misses(arrival_ratio=2.0)

    def test_a_valid_estimate_again(self):
        self.write_positions(lambda _: 0.01, is_valid=lambda time_s: not BEGIN_S < time_s < 2000.0)
        self.assertEqual(self.misses(valid_within_s=440.0), [])
        self.assertEqual(self.misses(valid_within_s=400.0), ["estimate again after 440 s"])
        self.write_positions(lambda _: 0.01, is_valid=lambda time_s: time_s < 1500.0)
        self.assertEqual(self.misses(valid_within_s=400.0), ["no estimate again"])

    def test_a_fault_that_begins_with_an_event(self):
        write(self.folder / "faults.csv", [{"begin_s": 1234.0}])
        self.assertEqual(begin_of(self.folder), 1234.0)
        write(self.folder / "faults.csv", [{"begin_s": ""}])
        with self.assertRaisesRegex(JudgementError, "begin_s"):
            begin_of(self.folder)

    def test_a_nan_does_not_pass(self):
        self.write_positions(lambda time_s: "nan" if time_s == 2400.0 else 0.01)
        with self.assertRaisesRegex(JudgementError, "is 'nan', not a number"):
            self.misses(error_m=1.0)
        self.write_positions(lambda time_s: "" if time_s == 2400.0 else 0.01)
        with self.assertRaisesRegex(JudgementError, "is '', not a number"):
            self.misses(error_ratio=100.0)
        self.write_summary(min_distance_m=None)
        with self.assertRaisesRegex(JudgementError, "min_distance_m"):
            self.misses()

    def test_estimates_that_are_missing_are_no_small_errors(self):
        self.write_positions(lambda _: 0.01, is_valid=lambda time_s: time_s < 1200.0)
        self.assertEqual(self.misses(error_ratio=2.0), ["3 estimates, nominally 70"])
        self.write_positions(lambda _: 0.01, is_valid=lambda time_s: time_s < BEGIN_S)
        self.assertEqual(self.misses(error_m=1.0), ["no estimate"])
        self.nominal = None
        with self.assertRaisesRegex(JudgementError, "nominal run"):
            self.misses(error_ratio=2.0)

    def test_a_table_or_column_that_is_missing_is_an_error(self):
        for name in ("truth.csv", "estimate.csv", "telemetry_event.csv", "gnss.csv", "summary.json"):
            with self.subTest(name):
                content = (self.folder / name).read_bytes()
                (self.folder / name).unlink()
                with self.assertRaisesRegex(JudgementError, name):
                    self.misses(error_m=1.0, fixed_within_s=60.0)
                (self.folder / name).write_bytes(content.replace(b"time_s", b"hour"))
                if name != "summary.json":
                    with self.assertRaisesRegex(JudgementError, "no column"):
                        self.misses(error_m=1.0, fixed_within_s=60.0)
                (self.folder / name).write_bytes(content)

    def test_errors_of_a_run(self):
        self.assertEqual([round(error_m, 12) for _, error_m in navigation_errors(self.folder)], [0.01] * 17 + [0.03] * 83)


class Table(unittest.TestCase):
    def test_every_case_has_points_and_limits_that_can_be_judged(self):
        for name, case in fault_table.CASES.items():
            with self.subTest(name):
                self.assertTrue(set(fault_table.points_of(case)) <= set(fault_table.POINTS))
                self.assertGreaterEqual(case.distance_m, 1.0)
                self.assertEqual(window_of(case, 5.0).begin_s, 5.0)

    def test_nominal_runs_last_as_long_as_the_longest_comparison(self):
        asked = {}

        class Flights:
            def add_nominal(self, point, seed, is_cooperative, after_h):
                asked[point, seed, is_cooperative] = after_h
        fault_table.add_nominals(Flights(), [("cooperative: receiver reset", "9m", 1), ("cooperative: receiver silent 1 h", "9m", 1), ("none", "9m", 1)])
        self.assertEqual(asked, {("9m", 1, True): 2.0})
        asked.clear()
        fault_table.add_nominals(Flights(), [("burns 10 % short", "9m", 1)])
        self.assertEqual(asked, {("9m", 1, False): fault_table.AFTER_H})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
