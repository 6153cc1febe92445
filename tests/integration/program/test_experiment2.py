#!/usr/bin/env python3
"""Experiment 2, image in and maneuver out: it navigates, the same bits on every flight computer, and input that does not serve."""
import csv
import math
import unittest

from vbar_program import SOURCE, ZYNQ_IMAGE, fly, hashes, main, missing, overrides, scratch, vbar

EXPERIMENT2 = SOURCE / "missions" / "experiment2.toml"
# Half an hour: the first minute, a quarter of an hour in the dark, and 170 images after it.
SHORT = ("mission.duration_h=0.5",)
ZYNQ = ("flight_computer.target=zynq_qemu", "flight_computer.link=udp")
HOST_PROCESS = ("flight_computer.target=host_process", "flight_computer.link=udp")


def poses(folder):
    with (folder / "poses.csv").open() as file:
        return list(csv.DictReader(file))


class Experiment2(unittest.TestCase):
    """One flight, looked at from all sides."""

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.reference_folder = cls.folder / "reference"
        cls.reference = fly(cls.reference_folder, *SHORT, mission=EXPERIMENT2)
        cls.poses = poses(cls.reference_folder)

    def fly_again(self, *settings, name="run"):
        summary = fly(self.folder / name, *SHORT, *settings, mission=EXPERIMENT2)
        self.assertEqual(hashes(summary), hashes(self.reference))
        return summary

    def test_the_target_is_seen_and_followed(self):
        lit = [row for row in self.poses if float(row["sunlit"]) == 1.0]
        self.assertGreaterEqual(len(lit), 150)
        used = [row for row in lit if row["fate"] == "keypoints"]
        self.assertGreater(len(used), 0.7 * len(lit))
        self.assertEqual(self.reference["sensor_figures"]["pose"]["restarts"], 0)
        last = [float(row["attitude_error_deg"]) for row in self.poses[-60:]]
        self.assertLess(sum(last) / len(last), 3.2)
        self.assertGreater(self.reference["maneuvers"], 0)

    def test_nothing_is_seen_in_the_dark(self):
        dark = [row for row in self.poses if float(row["sunlit"]) == 0.0]
        self.assertGreaterEqual(len(dark), 150)
        for row in dark:
            self.assertEqual((row["status"], row["pnp_inliers"], row["fate"]), ("dark", "0", "none"), row["time_s"])

    def test_the_dark_is_survived_with_what_was_handed_over(self):
        """The place along track grows in doubt as its covariance says, and the first images after the dark find it."""
        with (self.reference_folder / "estimate.csv").open() as file:
            estimates = [row for row in csv.DictReader(file) if row["navigation_valid"] == "1"]
        self.assertGreaterEqual(len(estimates), 0.98 * len(self.poses))
        sigmas = [float(row["sigma_rtn_t_m"]) for row in estimates]
        self.assertLess(sigmas[-1], 0.1)
        with (self.reference_folder / "truth.csv").open() as file:
            truth = {row["time_s"]: row for row in csv.DictReader(file)}
        far = 0
        for row in estimates:
            true = truth[row["time_s"]]
            squares = [((float(row[f"relative_position_rtn_{axis}_m"]) - float(true[f"relative_position_rtn_{axis}_m"])) /
                        float(row[f"sigma_rtn_{axis}_m"])) ** 2 for axis in "rtn"]
            far += math.sqrt(sum(squares) / 3) > 8
        self.assertLess(far, 0.05 * len(estimates))

    def test_the_leg_is_planned_on_what_was_handed_over(self):
        """A leg of an hour that waits for the end of the dark costs a quarter more."""
        with (self.reference_folder / "maneuvers.csv").open() as file:
            first = float(next(csv.DictReader(file))["execution_time_s"])
        start = float(self.poses[0]["time_s"])
        self.assertLess(first - start, 60.0)

    def test_in_process_again(self):
        self.fly_again()

    def test_another_seed_gives_another_tumble(self):
        other = fly(self.folder / "run", "mission.duration_h=0.01", "mission.seed=2", mission=EXPERIMENT2)
        self.assertNotEqual(other["telemetry_sha256"], self.reference["telemetry_sha256"])

    def test_host_process(self):
        self.fly_again(*HOST_PROCESS)

    def test_replay_makes_the_images_again(self):
        result = vbar("replay", self.reference_folder)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("identical", result.stdout)

    def test_the_report_shows_what_the_network_saw(self):
        report = (self.reference_folder / "report.html").read_text()
        for part in ("keypoint", "PnP", "attitude error", "data:image/png"):
            self.assertIn(part, report)
        self.assertGreater(len(list((self.reference_folder / "gallery").iterdir())), 3)


class Experiment2OnTheZynq(unittest.TestCase):
    """250 images over the emulated board's Ethernet, 90 of them with the target in the light."""

    ARC = ("mission.duration_h=0.35",)

    def test_the_same_bits(self):
        if missing(ZYNQ_IMAGE):
            self.skipTest(missing(ZYNQ_IMAGE))
        with scratch() as folder:
            here = fly(folder / "here", *self.ARC, mission=EXPERIMENT2)
            there = fly(folder / "zynq", *self.ARC, *ZYNQ, mission=EXPERIMENT2, timeout=1200)
            self.assertGreaterEqual(sum(float(row["sunlit"]) > 0.0 for row in poses(folder / "here")), 85)
            self.assertGreater(here["maneuvers"], 0)
            self.assertEqual(hashes(there), hashes(here))
            self.assertEqual(there["flight_step"]["unit"], "instructions")
            self.assertLess(there["flight_step"]["stack_bytes_max"], 128 * 1024)


class Experiment2BadInput(unittest.TestCase):
    """One message that names the place."""

    def refuse(self, *parts, settings):
        with scratch() as folder:
            result = vbar("run", EXPERIMENT2, "--out", folder / "run", *overrides(*SHORT, *settings))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(result.stderr.count("vbar:"), 1, result.stderr)
            for part in parts:
                self.assertIn(part, result.stderr)
            self.assertFalse((folder / "run").exists())

    def test_keys_of_pose(self):
        self.refuse("pose", "keypoint_sigma", "keypoint_sigma_scale", settings=["navigation.pose.keypoint_sigma=1"])
        self.refuse("navigation.pose.keypoint_sigma_scale", settings=["navigation.pose.keypoint_sigma_scale=0"])
        self.refuse("navigation.acceleration_psd", "outside its limits", settings=["navigation.acceleration_psd=1e-15"])
        self.refuse("navigation.pose.initial_poses", "12", settings=["navigation.pose.initial_poses=13"])
        self.refuse("navigation.apriori.sigma_a_da_m", settings=["navigation.apriori.sigma_a_da_m=0"])
        self.refuse("navigation.apriori", "sigma_a_dL_m", settings=["navigation.apriori.sigma_a_dL_m=1"])

    def test_a_target_that_does_not_tumble(self):
        self.refuse("target", "tumble", settings=["spacecraft.target.attitude.profile=inertial"])

    def test_a_navigation_that_is_none(self):
        self.refuse("navigation", "angles_only", "pose", settings=["spacecraft.servicer.sensors.camera.navigation=vision"])


if __name__ == "__main__":
    main()
