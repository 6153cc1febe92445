#!/usr/bin/env python3
"""Experiment 1 on every flight computer: the same bits, images made again in a replay, and input that does not serve."""
import collections
import csv
import os
import re
import shutil
import struct
import unittest

from vbar_program import SOURCE, ZYNQ_IMAGE, fly, hashes, main, missing, overrides, scratch, summary_of, vbar

EXPERIMENT1 = SOURCE / "missions" / "experiment1.toml"
# 70 minutes: 30 bearings for the first orbit, and some twenty that the filter folds in.
SHORT = ("mission.duration_h=1.1667",)
SIX_HOURS = ("mission.duration_h=6",)
ZYNQ = ("flight_computer.target=zynq_qemu", "flight_computer.link=udp")
HOST_PROCESS = ("flight_computer.target=host_process", "flight_computer.link=udp")

# 69 images whose tiles would be 41 MB.
LOG_LIMIT_BYTES = 5_000_000


def require_zynq(test):
    if missing(ZYNQ_IMAGE):
        test.skipTest(missing(ZYNQ_IMAGE))


def bearings_folded_in(folder):
    with (folder / "images.csv").open() as file:
        return [row["fate"] for row in csv.DictReader(file)].count("filter")


def recipes_by_unit(folder):
    """How many images of each camera a log has the recipes of."""
    log = (folder / "packets.lcmlog").read_bytes()
    units = collections.Counter()
    at = 0
    while at < len(log):
        channel, data = struct.unpack_from(">II", log, at + 20)
        body = at + 28 + channel
        if log[at + 28:body] == b"VBAR_IMAGE_RECIPE":
            units[struct.unpack_from(">h", log, body + 10)[0]] += 1  # after the type's hash and the spacecraft
        at = body + data
    return dict(units)


class TwoCameras(unittest.TestCase):
    """A second camera of the spacecraft is recorded beside the one that navigation uses, and changes nothing else."""

    # Before the other by its name, but after it by its unit.
    SECOND = tuple(f"spacecraft.servicer.sensors.a_wide.{setting}" for setting in (
        "kind=camera", "camera=tron", "navigation=none", "period_s=120"))
    SHORT = ("mission.duration_h=0.25",)

    def test_both_are_recorded(self):
        with scratch() as folder:
            one = fly(folder / "one", *self.SHORT, mission=EXPERIMENT1)
            two = fly(folder / "two", *self.SHORT, *self.SECOND, mission=EXPERIMENT1)
            self.assertEqual(hashes(two), hashes(one))
            self.assertEqual(two["sensor_figures"]["images"]["images"], one["sensor_figures"]["images"]["images"])
            self.assertEqual(two["sensor_figures"]["images"]["without_truth"], 0)
            self.assertEqual(two["navigation"], "angles_only")
            epochs = {source["name"]: source["epochs"] for source in two["sources"]}
            self.assertEqual((epochs["servicer/a_wide"], epochs["servicer/camera"]), (7, 15))
            self.assertEqual(recipes_by_unit(folder / "one"), {0: 15})
            self.assertEqual(recipes_by_unit(folder / "two"), {0: 15, 2: 7})
            result = vbar("replay", folder / "two")
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertIn("identical", result.stdout)


class Experiment1(unittest.TestCase):
    """Bits do not depend on where the flight software runs, nor on whether its images were logged or are made again."""

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.reference_folder = cls.folder / "reference"
        cls.reference = fly(cls.reference_folder, *SHORT, mission=EXPERIMENT1)

    def fly_again(self, *settings, name="run"):
        summary = fly(self.folder / name, *SHORT, *settings, mission=EXPERIMENT1)
        self.assertEqual(hashes(summary), hashes(self.reference))
        return summary

    def replay(self, folder, *settings):
        result = vbar("replay", folder, *overrides(*settings))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("identical", result.stdout)

    def test_the_target_is_found_and_the_filter_runs(self):
        summary = self.reference
        self.assertGreaterEqual(summary["sensor_figures"]["images"]["images"], 60)
        self.assertEqual(summary["sensor_figures"]["images"]["wrong_targets"], 0)
        self.assertGreater(summary["sensor_figures"]["images"]["with_bearing"], summary["sensor_figures"]["images"]["images"] / 2)
        self.assertGreaterEqual(bearings_folded_in(self.reference_folder), 10)

    def test_in_process_again(self):
        self.fly_again()

    def test_another_seed_gives_other_bits(self):
        other = fly(self.folder / "run", *SHORT, "mission.seed=2", mission=EXPERIMENT1)
        self.assertNotEqual(other["telemetry_sha256"], self.reference["telemetry_sha256"])

    def test_host_process(self):
        self.fly_again(*HOST_PROCESS)

    def test_zynq_over_ethernet(self):
        require_zynq(self)
        step = self.fly_again(*ZYNQ)["flight_step"]
        self.assertEqual(step["unit"], "instructions")
        # The linker script's stack is 256 KiB; the other half is for what no mission has reached yet.
        self.assertLess(step["stack_bytes_max"], 128 * 1024)

    def test_replay_makes_the_images_again(self):
        log = self.reference_folder / "packets.lcmlog"
        self.assertLess(log.stat().st_size, LOG_LIMIT_BYTES)
        self.replay(self.reference_folder)
        self.replay(self.reference_folder, *HOST_PROCESS)

    def test_replay_into_the_zynq(self):
        require_zynq(self)
        self.replay(self.reference_folder, *ZYNQ)

    def test_a_replay_with_another_camera_is_refused(self):
        """What is made again is checked against what was flown: another seed is another detector's noise."""
        other = self.folder / "other_seed"
        shutil.copytree(self.reference_folder, other)
        with (other / "overrides.txt").open("a") as file:
            file.write("mission.seed=2\n")
        result = vbar("replay", other)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertRegex(result.stderr, "image 0")

    def test_a_log_may_keep_the_tiles(self):
        settings = ("mission.duration_h=0.1", "record.images=tiles")
        folder = self.folder / "tiles"
        summary = fly(folder, *settings, mission=EXPERIMENT1)
        small = fly(self.folder / "run", settings[0], mission=EXPERIMENT1)
        self.assertEqual(hashes(summary), hashes(small))
        # 500 x 800 pixels of 12 bits.
        self.assertGreater((folder / "packets.lcmlog").stat().st_size, summary["sensor_figures"]["images"]["images"] * 500 * 800 * 12 / 8)
        # With the tiles in the log nothing is made again: another seed changes nothing.
        with (folder / "overrides.txt").open("a") as file:
            file.write("mission.seed=2\n")
        self.replay(folder)


class Experiment1SixHours(unittest.TestCase):
    """The first leg, with its burns, has the same bits on the emulated Zynq."""

    def test_the_same_bits(self):
        require_zynq(self)
        with scratch() as folder:
            here = fly(folder / "here", *SIX_HOURS, mission=EXPERIMENT1)
            self.assertGreater(here["maneuvers"], 0)
            self.assertEqual(here["sensor_figures"]["images"]["wrong_targets"], 0)
            self.assertEqual(hashes(fly(folder / "zynq", *SIX_HOURS, *ZYNQ, mission=EXPERIMENT1)), hashes(here))


class Experiment1BadInput(unittest.TestCase):
    """One message that names the place."""

    def refuse(self, mission, *parts, settings=(), data=None):
        if data:
            os.environ["VBAR_DATA"] = str(data)
            self.addCleanup(os.environ.pop, "VBAR_DATA", None)
        with scratch() as folder:
            result = vbar("run", mission, "--out", folder / "run", *overrides(*SHORT, *settings))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(result.stderr.count("vbar:"), 1, result.stderr)
            for part in parts:
                self.assertIn(part, result.stderr)
            self.assertFalse((folder / "run").exists())

    def test_a_model_that_is_not_there(self):
        self.refuse(EXPERIMENT1, "teapot.obj: no such file", settings=["spacecraft.target.model=teapot"])

    def test_an_unknown_camera(self):
        self.refuse(EXPERIMENT1, "polaroid", "optical_stimulator or tron",
                    settings=["spacecraft.servicer.sensors.camera.camera=polaroid"])

    def test_a_target_that_is_nobody(self):
        self.refuse(EXPERIMENT1, "nobody", "decoy_behind",
                    settings=["spacecraft.servicer.sensors.camera.target=nobody"])

    def test_a_camera_without_gnss(self):
        sections = re.split(r"(?m)^(?=\[)", EXPERIMENT1.read_text())
        kept = [section for section in sections if not section.startswith("[spacecraft.sensors.gnss")]
        self.assertEqual(len(sections) - len(kept), 2)
        with scratch() as folder:
            (folder / "blind.toml").write_text("".join(kept))
            self.refuse(folder / "blind.toml", "blind.toml", "a camera without a GNSS receiver")

    def test_a_star_catalogue_that_is_not_there(self):
        with scratch() as data:
            for room in (SOURCE / "data").iterdir():
                if room.name != "stars":
                    (data / room.name).symlink_to(room)
            self.refuse(EXPERIMENT1, "hipparcos_v8.csv", "No such file or directory", data=data)


if __name__ == "__main__":
    main()
