"""ci/approach_safety.py measures what a run shows, and passes neither a NaN nor a missing table. Usage: approach_safety_test.py ROOT."""

import csv
import math
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "ci"))
import approach_safety as safety  # noqa: E402


def write(file, rows):
    with open(file, "w", newline="", encoding="utf-8") as text:
        table = csv.DictWriter(text, rows[0].keys())
        table.writeheader()
        table.writerows(rows)


class Approach(unittest.TestCase):
    """10 m from the target, an image a minute for 6000 s; the target is dark from 2000 s to 4000 s."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.folder = pathlib.Path(directory.name)
        self.times = [60 * n for n in range(101)]

    def write_images(self, is_used):
        write(self.folder / "images.csv", [{"time_s": t, "fate": "filter" if is_used(t) else "none", "sunlit": int(not 2000 < t < 4000)}
                                           for t in self.times])

    def write_states(self, sigma_m="0.5", is_valid="1"):
        write(self.folder / "truth.csv", [{"time_s": t, **{f"relative_position_rtn_{a}_m": x for a, x in zip("rtn", (0, 10, 0))}} for t in self.times])
        write(self.folder / "estimate.csv", [{"time_s": t, "navigation_valid": is_valid, "sigma_rtn_t_m": sigma_m if t == 3000 else "0.1"} for t in self.times])

    def write_events(self, *faults):
        write(self.folder / "telemetry_event.csv", [{"event": "aid", "fault": "none"}] + [{"event": "fault_raised", "fault": name} for name in faults])

    def test_gap_of_an_eclipse_is_not_longer_than_it(self):
        self.write_images(lambda t: not 2000 < t < 4000)
        self.assertEqual(safety.longest_gap_s(self.folder, 0, 6000), (2040, 2040))

    def test_gap_without_a_reason_is_longer(self):
        self.write_images(lambda t: t < 1000 or t > 4000)
        gap_s, dark_s = safety.longest_gap_s(self.folder, 0, 6000)
        self.assertEqual(gap_s, 4020 - 960)
        self.assertEqual(dark_s, 2040)

    def test_no_record_at_all_is_a_gap_of_the_whole_time(self):
        self.write_images(lambda t: False)
        self.assertEqual(safety.longest_gap_s(self.folder, 0, 6000)[0], 6000)

    def test_sigma_is_the_largest_share_of_the_range(self):
        self.write_states()
        self.assertAlmostEqual(safety.largest_sigma_share(self.folder, 0, 6000), 0.05)
        self.assertAlmostEqual(safety.largest_sigma_share(self.folder, 3060, 6000), 0.01)

    def test_lost_navigation_has_no_sigma(self):
        self.write_states(is_valid="0")
        self.assertEqual(safety.largest_sigma_share(self.folder, 0, 6000), math.inf)

    def test_nan_and_missing_tables_end_the_script(self):
        self.write_states(sigma_m="nan")
        with self.assertRaisesRegex(SystemExit, "sigma_rtn_t_m is nan at 3000 s"):
            safety.largest_sigma_share(self.folder, 0, 6000)
        write(self.folder / "telemetry_safety.csv", [{"time_s": 0, "collision_probability": "nan"}])
        with self.assertRaisesRegex(SystemExit, "collision_probability is nan"):
            safety.largest_probability(self.folder)
        (self.folder / "telemetry_event.csv").write_text("")
        with self.assertRaisesRegex(SystemExit, "no column fault"):
            safety.faults(self.folder)

    def test_probability_is_the_greatest(self):
        write(self.folder / "telemetry_safety.csv", [{"time_s": t, "collision_probability": f"{t}e-9"} for t in (0, 5, 3)])
        self.assertEqual(safety.largest_probability(self.folder), 5e-9)

    def test_faults_are_counted(self):
        self.write_events("hold", "guard_range", "hold")
        self.assertEqual(safety.faults(self.folder), {"hold": 2, "guard_range": 1})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
