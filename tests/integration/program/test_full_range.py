#!/usr/bin/env python3
"""One mission with two cameras: the flight software changes from bearings to keypoints by itself, and nothing breaks at the change."""
import csv
import math
import unittest

from vbar_program import SOURCE, fly, hashes, main, scratch

FULL_RANGE = SOURCE / "missions" / "full_range.toml"
# From waypoint 7 on: 100 m, with the accuracy that bearings leave. Without the decoys, which are 85 km away.
FROM_WAYPOINT_7 = ("mission.start_h=36", "mission.duration_h=0.9", "spacecraft.target.relative.waypoint=7",
                   "mission.step_s=20", "camera.period_s=20", "navigation.apriori.kind=roe",
                   "navigation.apriori.sigma_a_da_m=0.02", "navigation.apriori.sigma_a_dlambda_m=0.3",
                   "navigation.apriori.sigma_a_de_m=0.03", "navigation.apriori.sigma_a_di_m=0.03")


def rows_of(folder, name):
    with (folder / name).open() as file:
        return list(csv.DictReader(file))


class HandOver(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.summary = fly(cls.folder / "run", *FROM_WAYPOINT_7, mission=FULL_RANGE)
        cls.images = rows_of(cls.folder / "run", "images.csv")
        cls.poses = rows_of(cls.folder / "run", "poses.csv")
        cls.estimates = rows_of(cls.folder / "run", "estimate.csv")

    def test_each_image_serves_one_use(self):
        bearings = {row["time_s"] for row in self.images}
        keypoints = {row["time_s"] for row in self.poses}
        self.assertTrue(bearings)
        self.assertTrue(keypoints)
        self.assertFalse(bearings & keypoints)

    def test_keypoints_take_over(self):
        used = [row for row in self.poses if row["fate"] == "keypoints"]
        self.assertGreater(len(used), 0.5 * len(self.poses))
        self.assertGreater(min(float(row["time_s"]) for row in self.poses), min(float(row["time_s"]) for row in self.images))

    def test_the_estimate_stays_valid_and_consistent(self):
        truth = {row["time_s"]: row for row in rows_of(self.folder / "run", "truth.csv")}
        judged = 0
        for row in self.estimates:
            if row["navigation_valid"] != "1":
                continue
            squares = [((float(row[f"relative_position_rtn_{axis}_m"]) - float(truth[row["time_s"]][f"relative_position_rtn_{axis}_m"])) /
                        float(row[f"sigma_rtn_{axis}_m"])) ** 2 for axis in "rtn"]
            self.assertTrue(all(math.isfinite(square) for square in squares))
            judged += 1
            self.assertLess(math.sqrt(sum(squares) / 3), 5.0, row["time_s"])
        self.assertGreater(judged, 0.95 * len(self.estimates))

    def test_the_same_again(self):
        again = fly(self.folder / "again", *FROM_WAYPOINT_7, mission=FULL_RANGE)
        self.assertEqual(hashes(again), hashes(self.summary))


if __name__ == "__main__":
    main()
