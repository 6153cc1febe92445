#!/usr/bin/env python3
"""One run through two testbeds (emulated benches): each serves its camera, waits parked, and its twin takes over or the run stops."""
import csv
import os
import pathlib
import signal
import subprocess
import time
import unittest

from vbar_program import BINARY, COMPLETE, SOURCE, children_of, is_running, main, missing, overrides, scratch, start, summary_of, vbar

MISSION = SOURCE / "missions" / "full_range_hil.toml"
BENCH_FILE = SOURCE / "data" / "benches" / "optical_stimulator.toml"
BENCH = f"vbar_os_bench {BENCH_FILE} --directory {{directory}} --seed 1 --set rails.zero_error_mm=0"
TRUE_CALIBRATION = BINARY / "tests" / "integration" / "vbar_os_true_calibration"
# From waypoint 8 on: a minute of the far camera, an hour without an image, half a minute of the close camera.
HALVES = ("mission.start_h=39", "mission.duration_h=1.125", "mission.step_s=20", "spacecraft.target.relative.waypoint=8",
          "navigation.apriori.kind=roe", "navigation.apriori.sigma_a_da_m=0.02", "navigation.apriori.sigma_a_dlambda_m=0.3",
          "navigation.apriori.sigma_a_de_m=0.03", "navigation.apriori.sigma_a_di_m=0.03", "camera.period_s=20", "camera.until_h=39.017", "close_camera.period_s=[[40.116,5.0]]")
FAR_IMAGES = 3


def command_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


class FullRangeHil(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if reason := missing(TRUE_CALIBRATION, BINARY / "vbar_os_bench", BINARY / "vbar_tron_bench"):
            raise unittest.SkipTest(reason)
        cls.folder = cls.enterClassContext(scratch())
        calibration = cls.folder / "calibration.toml"
        subprocess.run([TRUE_CALIBRATION, BENCH_FILE, "1", calibration], check=True)
        cls.settings = (f'testbed.optical_stimulator.bench="{BENCH}"', f'testbed.optical_stimulator.calibration="{calibration}"')

    def begin(self, name, *settings):
        return start("run", MISSION, "--force", "--out", self.folder / name, *overrides(*HALVES, *self.settings, *settings))

    def test_each_testbed_serves_its_camera_and_is_parked(self):
        process = self.begin("both")
        _, errors = process.communicate(timeout=500)
        self.assertIn(process.returncode, COMPLETE, errors)
        summary = summary_of(self.folder / "both")
        far, close = summary["optical_stimulator"], summary["tron"]
        self.assertEqual((far["bench"], close["bench"]), ("emulated", "emulated"))
        self.assertEqual(far["images"], FAR_IMAGES)
        self.assertGreaterEqual(close["images"], 5)
        self.assertAlmostEqual(far["parked_h"], 39.017, delta=0.001)
        self.assertAlmostEqual(close["started_h"], 40.116, delta=0.0015)
        self.assertNotIn("started_h", far)
        self.assertNotIn("parked_h", close)
        with (self.folder / "both" / "notes.csv").open() as file:
            events = [(row["source"], row["name"]) for row in csv.DictReader(file) if row["name"].startswith("testbed_")]
        self.assertEqual(events, [("servicer/camera", "testbed_parked"), ("servicer/close_camera", "testbed_start_wall_s")])
        self.assertEqual(vbar("replay", self.folder / "both").returncode, 0)

    def test_testbed_that_dies_hands_over_to_its_twin(self):
        process = self.begin("twin", 'testbed.optical_stimulator.on_failure="twin"', "camera.until_h=39.5")
        children = self.signal_bench(process, "twin", "vbar_os_bench", signal.SIGKILL)
        _, errors = process.communicate(timeout=500)
        self.assertIn(process.returncode, COMPLETE, errors)
        self.assertEqual(errors.count("the digital twin of servicer/camera takes over"), 1, errors)
        summary = summary_of(self.folder / "twin")
        self.assertIn("killed by signal 9", summary["optical_stimulator"]["failure"])
        self.assertIn("testbed optical_stimulator handed over to its digital twin at", summary["verdict_reason"])
        self.assertLess(summary["optical_stimulator"]["images"], 5)
        epochs = {source["name"]: source["epochs"] for source in summary["sources"]}
        self.assertGreater(epochs["servicer/camera"], 80)
        self.assertEqual(vbar("replay", self.folder / "twin").returncode, 0)
        self.assertFalse(any(is_running(pid) for pid in children))

    def test_testbed_that_dies_stops_the_run(self):
        process = self.begin("stop", "camera.until_h=39.5")
        self.signal_bench(process, "stop", "vbar_os_bench", signal.SIGKILL)
        _, errors = process.communicate(timeout=120)
        self.assertNotIn(process.returncode, COMPLETE)
        self.assertEqual(errors.count("run incomplete"), 1, errors)
        self.assertEqual(vbar("replay", self.folder / "stop").returncode, 0)  # what was flown

    def signal_bench(self, process, name, program, number):
        """Once an image is in the log."""
        log = self.folder / name / "packets.lcmlog"
        for _ in range(1200):
            if log.exists() and log.stat().st_size > 300_000:
                break
            self.assertIsNone(process.poll(), "the run ended")
            time.sleep(0.05)
        children = children_of(process.pid)
        os.kill(next(pid for pid in children if program in command_of(pid)), number)
        return children


if __name__ == "__main__":
    main()
