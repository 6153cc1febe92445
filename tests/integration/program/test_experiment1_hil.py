#!/usr/bin/env python3
"""Experiment 1 through the Optical Stimulator (emulated bench): calibration over the wires, flight, record, replay, faults."""
import csv
import os
import pathlib
import signal
import subprocess
import time
import unittest

from vbar_program import (BINARY, SOURCE, ZYNQ_IMAGE, children_of, fly, is_running, main, missing, overrides, scratch, start,
                          summary_of, vbar)

MISSION = SOURCE / "missions" / "experiment1_hil.toml"
BENCH = "vbar_os_bench {data}/benches/optical_stimulator.toml --directory {directory} --seed {seed}"
CALIBRATE = BINARY / "vbar_os_calibrate"
IMAGES = 60  # one a minute


def command_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


class Experiment1Hil(unittest.TestCase):
    """One calibrated bench, and the first hour of the mission."""

    @classmethod
    def setUpClass(cls):
        if not CALIBRATE.exists():
            raise unittest.SkipTest("built without SDL2, Aravis or Ceres")
        cls.folder = cls.enterClassContext(scratch())
        cls.calibration = cls.folder / "calibration.toml"
        made = subprocess.run([CALIBRATE, "--quick", "--out", cls.calibration, "--bench", BENCH, "--seed", "1"],
                              capture_output=True, text=True, timeout=500, check=False)
        if made.returncode != 0:
            raise AssertionError(f"vbar_os_calibrate failed: {made.stdout}{made.stderr}")
        cls.settings = (f'testbed.optical_stimulator.calibration="{cls.calibration}"',)
        cls.run_folder = cls.folder / "run"
        cls.summary = fly(cls.run_folder, "mission.duration_h=1", *cls.settings, mission=MISSION, timeout=500)

    def test_every_image_is_one_of_the_bench(self):
        bench = self.summary["optical_stimulator"]
        self.assertEqual(bench["bench"], "emulated")
        self.assertEqual(bench["images"], IMAGES)
        with (self.run_folder / "bench.csv").open() as file:
            self.assertEqual(len(list(csv.DictReader(file))), IMAGES)

    def test_stars_and_target_are_found(self):
        images = self.summary["sensor_figures"]["images"]
        self.assertGreaterEqual(images["with_stars"], IMAGES - 1)
        self.assertLess(self.summary["star_attitude_error_arcsec"]["mean"], 2.0)

    def test_calibration_reaches_its_goal(self):
        bench = self.summary["optical_stimulator"]
        self.assertLess(bench["calibration_residual_arcsec"], 1.5)
        self.assertLess(bench["self_check_arcsec"], 3.0)

    def test_replay_gives_the_same_bits(self):
        computers = [(), ("flight_computer.target=host_process",)]
        if not missing(ZYNQ_IMAGE):
            computers.append(("flight_computer.target=zynq_qemu", "flight_computer.link=udp"))
        for computer in computers:
            with self.subTest(computer=computer):
                result = vbar("replay", self.run_folder, *overrides(*computer))
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_report_says_what_was_in_the_loop(self):
        page = (self.run_folder / "report.html").read_text()
        self.assertIn("emulated bench", page)

    def test_log_of_the_whole_mission_would_be_below_400_megabytes(self):
        log = self.run_folder / "packets.lcmlog"
        self.assertLess(log.stat().st_size * 36.0, 0.4e9)

    def test_missing_calibration_names_the_program_that_makes_it(self):
        result = vbar("run", MISSION, "--out", self.folder / "none",
                      *overrides('testbed.optical_stimulator.calibration="none.toml"'))
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("some minutes (less than one with --quick) by: vbar os_calibrate --seed 1 --out none.toml --bench", result.stderr)
        self.assertFalse((self.folder / "none").exists())

    def test_bench_that_dies_ends_the_run(self):
        folder = self.folder / "dies"
        process = start("run", MISSION, "--force", "--out", folder, *overrides("mission.duration_h=3", *self.settings))
        self.wait_for_images(process, folder)
        os.kill(next(pid for pid in children_of(process.pid) if "vbar_os_bench" in command_of(pid)), signal.SIGKILL)
        _, errors = process.communicate(timeout=120)
        self.assertNotEqual(process.returncode, 0)
        self.assertEqual(errors.count("run incomplete"), 1, errors)
        summary = summary_of(folder)
        self.assertFalse(summary["complete"])
        self.assertEqual(vbar("replay", folder).returncode, 0)  # what was flown

    def test_bench_that_is_stopped_ends_the_run(self):
        self.stop_in_a_run("vbar_os_bench", "camera 127.0.13.")

    def test_x_server_that_is_stopped_ends_the_run(self):
        self.stop_in_a_run("Xvfb", "its X server has not answered|camera 127.0.13.")

    def stop_in_a_run(self, program, cause):
        """SIGSTOP: the process neither answers nor ends."""
        folder = self.folder / ("stopped_" + program)
        process = start("run", MISSION, "--force", "--out", folder, *overrides("mission.duration_h=6", *self.settings))
        self.wait_for_images(process, folder)
        children = children_of(process.pid)
        os.kill(next(pid for pid in children if program in command_of(pid).split("\0")[0]), signal.SIGSTOP)
        _, errors = process.communicate(timeout=120)
        self.assertNotEqual(process.returncode, 0)
        self.assertEqual(errors.count("run incomplete"), 1, errors)
        self.assertRegex(errors, cause)
        self.assertFalse(summary_of(folder)["complete"])
        self.assertEqual(vbar("replay", folder).returncode, 0)
        self.expect_ended(children)

    def test_interrupted_run_leaves_no_process(self):
        folder = self.folder / "interrupted"
        process = start("run", MISSION, "--force", "--out", folder, *overrides("mission.duration_h=3", *self.settings))
        self.wait_for_images(process, folder)
        children = children_of(process.pid)
        self.assertTrue(any("Xvfb" in command_of(pid) for pid in children))
        process.terminate()
        process.communicate(timeout=60)
        self.assertGreater(process.returncode, 0)  # not ended by a signal
        self.expect_ended(children)

    def expect_ended(self, children):
        deadline = time.monotonic() + 20.0
        while any(is_running(pid) for pid in children) and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertFalse(any(is_running(pid) for pid in children))

    def wait_for_images(self, process, folder):
        """Until a few images are in the log."""
        log = folder / "packets.lcmlog"
        for _ in range(1200):
            if log.exists() and log.stat().st_size > 500_000:
                return
            self.assertIsNone(process.poll(), "the run ended")
            time.sleep(0.1)
        self.fail("no images within two minutes")


if __name__ == "__main__":
    main()
