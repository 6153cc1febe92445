#!/usr/bin/env python3
"""Experiment 2 through TRON (emulated bench): flight, record, replay, faults."""
import csv
import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

from vbar_program import (BINARY, SOURCE, children_of, fly, is_running, main, overrides, scratch, start,
                          summary_of, vbar)

MISSION = SOURCE / "missions" / "experiment2_hil.toml"
BENCH = "vbar_tron_bench {data}/benches/tron_emulated.toml --directory {directory} --seed {seed}"
# Of the emulated bench with seed 1, by vbar_tron calibrate over its wires in 14 minutes: after a change of the hidden errors it has
# to be made again. The mission finds it without being given its place.
CALIBRATION = SOURCE / "data" / "calibrations" / "tron_1" / "calibration.toml"
IMAGES = 36  # of three minutes


def command_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


class Experiment2Hil(unittest.TestCase):
    """One calibrated bench, and the first three minutes of the mission."""

    @classmethod
    def setUpClass(cls):
        if not (BINARY / "vbar_tron_bench").exists():
            raise unittest.SkipTest("built without Aravis")
        cls.folder = cls.enterClassContext(scratch())
        cls.settings = ()
        cls.run_folder = cls.folder / "run"
        cls.summary = fly(cls.run_folder, "mission.duration_h=0.05", *cls.settings, mission=MISSION, timeout=500)

    def rows(self):
        with (self.run_folder / "tron.csv").open() as file:
            return list(csv.DictReader(file))

    def test_every_image_is_one_of_the_bench(self):
        bench = self.summary["tron"]
        self.assertEqual(bench["bench"], "emulated")
        self.assertEqual(bench["clock"], "virtual")
        self.assertGreaterEqual(bench["images"], IMAGES)
        self.assertEqual(len(self.rows()), bench["images"])
        self.assertEqual(bench["images_not_taken"], 0)

    def test_poses_are_those_commanded(self):
        bench = self.summary["tron"]
        self.assertLess(bench["pose_error_95_mm"], 3.0)
        self.assertLess(bench["pose_error_95_deg"], 0.25)
        self.assertLess(bench["sun_error_95_deg"], 0.5)

    def test_robots_answered_in_every_cycle(self):
        bench = self.summary["tron"]
        for name in ("rsi_delay_max", "rsi_restarts", "robot_interruptions", "rsi_datagrams_unreadable", "rsi_states_skipped"):
            self.assertEqual(bench[name], 0, name)

    def test_keypoints_are_found(self):
        lit = self.summary["tron"]["images_lit"]
        self.assertGreaterEqual(lit, 10)  # the mission begins shortly before eclipse
        self.assertGreaterEqual(self.summary["sensor_figures"]["pose"]["with_pose"], 0.9 * lit)

    def test_same_mission_gives_the_same_bits(self):
        again = fly(self.folder / "again", "mission.duration_h=0.02", *self.settings, mission=MISSION, timeout=500)
        third = fly(self.folder / "third", "mission.duration_h=0.02", *self.settings, mission=MISSION, timeout=500)
        for key in ("commands_sha256", "telemetry_sha256"):
            self.assertEqual(again[key], third[key])

    def test_replay_gives_the_same_bits(self):
        for computer in ((), ("flight_computer.target=host_process",)):
            with self.subTest(computer=computer):
                result = vbar("replay", self.run_folder, *overrides(*computer))
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_report_says_what_was_in_the_loop(self):
        self.assertIn("emulated bench", (self.run_folder / "report.html").read_text())

    def test_calibration_of_another_bench_is_refused(self):
        bench = BENCH.replace("{seed}", "2")
        result = vbar("run", MISSION, "--out", self.folder / "other", *overrides(f'testbed.tron.bench="{bench}"', *self.settings))
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("is not of this bench", result.stderr)
        self.assertFalse((self.folder / "other").exists())

    def test_missing_calibration_names_the_program_that_makes_it(self):
        result = vbar("run", MISSION, "--out", self.folder / "none", *overrides('testbed.tron.calibration="none.toml"'))
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("none.toml", result.stderr)
        self.assertFalse((self.folder / "none").exists())

    def test_faults_are_survived_and_counted(self):
        """An emergency stop and an end of RSI during moves, a hidden object, a dark lamp, a frame that is an older one."""
        faults = self.folder / "faults.jsonl"
        faults.write_text("\n".join(json.dumps(fault) for fault in (
            {"kind": "emergency_stop", "robot": "camera", "at_image": 2, "after_cycles": 40, "duration_s": 0.5},
            {"kind": "vicon_hidden", "object": "target", "at_image": 5, "images": 2},
            {"kind": "lamp_out", "at_image": 8, "images": 1},
            {"kind": "frames_stale", "at_image": 10, "count": 1},
            {"kind": "rsi_dropped", "robot": "target", "at_image": 11, "after_cycles": 40})) + "\n")
        folder = self.folder / "faults"
        summary = fly(folder, "mission.duration_h=0.024", f'testbed.tron.bench="{BENCH} --faults {faults}"', *self.settings,
                      mission=MISSION, timeout=500)
        bench = summary["tron"]
        self.assertTrue(summary["complete"])
        self.assertEqual(bench["robot_interruptions"], 2)
        self.assertEqual(bench["rsi_restarts"], 2)
        self.assertEqual(bench["poses_by_arms_alone"], 2)
        self.assertEqual(bench["images_not_taken"], 1)
        self.assertEqual(bench["images_retried"], 1)
        with (folder / "tron.csv").open() as file:
            failures = {row["image"]: row["failure"] for row in csv.DictReader(file) if row["failure"]}
        self.assertEqual(failures, {"7": "the lamp is dark"})
        self.assertLess(bench["pose_error_95_mm"], 3.0)

    def test_calibration_is_checked_over_the_wires(self):
        def check(seed):
            return subprocess.run([BINARY / "vbar_tron", "check", SOURCE / "data" / "benches" / "tron.toml", "--seed", str(seed),
                                   "--poses", "5", "--bench", BENCH, "--calibration", CALIBRATION], capture_output=True, text=True,
                                  timeout=300, check=False)

        result = check(1)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("the calibration is valid", result.stdout)
        other = check(2)
        self.assertEqual(other.returncode, 3, other.stdout + other.stderr)
        self.assertIn("not valid any more", other.stderr)

    def test_bench_that_dies_ends_the_run(self):
        folder = self.folder / "dies"
        process = start("run", MISSION, "--force", "--out", folder, *overrides("mission.duration_h=1", *self.settings))
        self.wait_for_images(process, folder)
        os.kill(next(pid for pid in children_of(process.pid) if "vbar_tron_bench" in command_of(pid)), signal.SIGKILL)
        _, errors = process.communicate(timeout=120)
        self.assertNotEqual(process.returncode, 0)
        self.assertEqual(errors.count("run incomplete"), 1, errors)
        self.assertIn("has ended: killed by signal 9", errors)
        self.assertFalse(summary_of(folder)["complete"])
        self.assertEqual(vbar("replay", folder).returncode, 0)  # what was flown

    def test_interrupted_run_leaves_no_process(self):
        folder = self.folder / "interrupted"
        process = start("run", MISSION, "--force", "--out", folder, *overrides("mission.duration_h=1", *self.settings))
        self.wait_for_images(process, folder)
        children = children_of(process.pid)
        self.assertTrue(any("vbar_tron_bench" in command_of(pid) for pid in children))
        process.terminate()
        process.communicate(timeout=60)
        deadline = time.monotonic() + 20.0
        while any(is_running(pid) for pid in children) and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertFalse(any(is_running(pid) for pid in children))

    def wait_for_images(self, process, folder):
        """Until a few images are in the log."""
        log = folder / "packets.lcmlog"
        for _ in range(1200):
            if log.exists() and log.stat().st_size > 300_000:
                return
            self.assertIsNone(process.poll(), "the run ended")
            time.sleep(0.1)
        self.fail("no images within two minutes")


if __name__ == "__main__":
    main()
