#!/usr/bin/env python3
"""Sensors in other processes (testbed.external): vbar's own receivers served by a second process, a range finder in Python and one in C,
and programs that end, hang or send what is not theirs."""
import contextlib
import csv
import os
import signal
import socket
import statistics
import subprocess
import sys
import time
import unittest

from vbar_program import BINARY, SOURCE, children_of, fly, hashes, is_running, main, overrides, scratch, start, vbar

SENSOR_IN_C = BINARY / "vbar_example_sensor"
EXTERNAL_RECEIVERS = [f"spacecraft.{name}.sensors.gnss.source=external" for name in ("servicer", "target")]
SHORT = "mission.duration_h=0.1"
EXTERNAL_LIDAR = """
extends = "{missions}/range_finder.toml"
[mission]
name = "external"
duration_h = 0.1
[testbed.external]
{program}
answer_limit_s = 2.0
[[spacecraft]]
name = "servicer"
[spacecraft.sensors.lidar]
source = "external"
"""
SENSOR_IN_PYTHON = """
import os, time, vbar, vbar_sensor
class Sensor:
    def __init__(self, start, header):
        assert bytes(start.name).rstrip(b"\\0") == b"servicer/lidar"
        self.epochs = 0
    def first_epoch_ns(self, start_ns):
        return start_ns
    def measure(self, time_ns, states, earth, commands):
        self.epochs += 1
        message = vbar.range_measurement()
        message.range_m = 8.0
        {measure}
        return [message], time_ns + 1_000_000_000
vbar_sensor.serve(Sensor)
"""


def rows_of(folder):
    with open(folder / "range_finder.csv", newline="") as table:
        return list(csv.DictReader(table))


class External(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.python = {"PYTHONPATH": BINARY / "python"}

    def mission(self, program):
        file = self.folder / "external.toml"
        file.write_text(EXTERNAL_LIDAR.format(missions=SOURCE / "missions", program=program))
        return file

    def fly_sensor(self, measure):
        """Flies with a sensor in Python that does something else at its epochs; what vbar says."""
        script = self.folder / "sensor.py"
        script.write_text(SENSOR_IN_PYTHON.format(measure=measure))
        mission = self.mission(f'program = "{sys.executable} {script}"')
        return vbar("run", mission, "--quiet", "--force", "--out", self.folder / "run", **self.python)

    def assert_one_sentence(self, result, *parts):
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for part in parts:
            self.assertIn(part, result.stderr)
        self.assertNotIn("Traceback (most recent call last)", result.stderr.split("its last output")[0])

    def served(self, name, duration, more=""):
        """A mission whose sensors vbar serves in other processes, where their source is external."""
        file = self.folder / "served.toml"
        original = SOURCE / "missions" / f"{name}.toml"
        file.write_text(f"""
extends = "{original}"
[mission]
name = "served"
[testbed.external]
program = "vbar serve {original} --set mission.seed={{seed}} --set {duration}"
{more}
""")
        return file

    def assert_same_bits(self, mission, external, *settings):
        within = fly(self.folder / "within", *settings, mission=mission)
        without = fly(self.folder / "without", *settings, *external, mission=mission)
        self.assertEqual(hashes(within), hashes(without))
        self.assertIn("external", {source["kind"] for source in without["sources"]})

    def test_receivers_in_other_processes_give_the_same_bits(self):
        for seed in (1, 2):
            self.assert_same_bits(self.served("experiment3", SHORT), EXTERNAL_RECEIVERS, SHORT, f"mission.seed={seed}")
        replayed = vbar("replay", self.folder / "without")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)

    def test_images_of_another_process_give_the_same_bits(self):
        self.assert_same_bits(self.served("experiment1", SHORT), ["spacecraft.servicer.sensors.camera.source=external"], SHORT)

    def test_silence_is_injected_and_a_slip_is_refused(self):
        fault = '[[fault]]\nkind = "{}"\nunit = "gnss"\nat_h = 39.02\n{}'
        duration = "mission.duration_h=0.2"
        mission = self.served("experiment3", duration, fault.format("silent", 'spacecraft = "target"\nfor_s = 120.0'))
        self.assert_same_bits(mission, EXTERNAL_RECEIVERS, duration)
        with open(self.folder / "without" / "faults.csv", newline="") as table:
            self.assertEqual([float(row["end_s"]) - float(row["begin_s"]) for row in csv.DictReader(table)], [120.0])
        refused = vbar("run", self.served("experiment3", duration, fault.format("cycle_slip", "value_cycles = 1")),
                       *overrides(*EXTERNAL_RECEIVERS), "--check")
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn('a receiver with source = "digital": that of external does not fail on request', refused.stderr)

    def test_a_run_is_not_resumed(self):
        fly(self.folder / "whole", mission=self.mission(f'program = "{SENSOR_IN_C} --stream 3"'))
        branch = vbar("resume", self.folder / "whole", "--at", 39.05, "--set", "guidance.dv_min_mmps=2.0", "--out", self.folder / "branch")
        self.assertEqual(branch.returncode, 2, branch.stderr)
        self.assertIn("a run with the testbed external cannot be flown again", branch.stderr)

    def test_range_finder_in_python(self):
        fly(self.folder / "python", "mission.duration_h=0.25", mission=SOURCE / "missions" / "external_range_finder.toml", **self.python)
        rows = rows_of(self.folder / "python")
        self.assertEqual(len(rows), 901)
        errors = [float(row["error_m"]) for row in rows]
        self.assertAlmostEqual(statistics.pstdev(errors), 0.01, delta=4 * 0.01 / (2 * len(errors)) ** 0.5)

    def test_range_finder_in_c(self):
        fly(self.folder / "c", mission=self.mission(f'program = "{SENSOR_IN_C} --stream 3"'))
        rows = rows_of(self.folder / "c")
        self.assertEqual(len(rows), 361)
        self.assertTrue(all(abs(float(row["error_m"])) < 1e-12 for row in rows))

    def test_program_that_waits_at_an_address(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        with subprocess.Popen([SENSOR_IN_C, "--udp", f"127.0.0.1:{port}"], stderr=subprocess.DEVNULL) as sensor:
            try:
                fly(self.folder / "udp", mission=self.mission(f'udp = "127.0.0.1:{port}"'))
                sensor.wait(timeout=10)  # it ends with the goodbye of the run
            finally:
                sensor.kill()
        self.assertEqual(len(rows_of(self.folder / "udp")), 361)

    def test_program_that_ends(self):
        result = self.fly_sensor("os._exit(3) if self.epochs == 5 else None")
        self.assert_one_sentence(result, "source servicer/lidar: program ", "failed at step 5", "exit status 3")

    def test_program_that_raises(self):
        result = self.fly_sensor("self.nothing")
        self.assert_one_sentence(result, "failed at step 1", "has no attribute 'nothing'")

    def test_program_that_hangs(self):
        began = time.monotonic()
        result = self.fly_sensor("time.sleep(60) if self.epochs == 5 else None")
        self.assert_one_sentence(result, "failed at step 5", "was still running and has been ended")
        self.assertLess(time.monotonic() - began, 30)

    def test_program_that_is_killed(self):
        script = self.folder / "slow.py"
        script.write_text(SENSOR_IN_PYTHON.format(measure="time.sleep(0.05)"))
        run = start("run", self.mission(f'program = "{sys.executable} {script}"'), "--quiet", "--out", self.folder / "killed",
                    env=os.environ | {"PYTHONPATH": str(BINARY / "python")})
        with contextlib.ExitStack() as stack:
            stack.callback(run.kill)
            deadline = time.monotonic() + 20
            while not (self.folder / "killed" / "packets.lcmlog").exists() and time.monotonic() < deadline:
                time.sleep(0.02)
            children = children_of(run.pid)
            os.kill(children[0], signal.SIGKILL)
            _, message = run.communicate(timeout=30)
        self.assertEqual(run.returncode, 1, message)
        self.assertIn("killed by signal 9", message)
        self.assertEqual(message.count("\n"), 1, message)
        self.assertFalse(is_running(children[0]))

    def test_invalid_measurements(self):
        for measure, fault in (
            ("message.range_m = float('nan')", "its answer holds a packet of APID 0x016 whose message has another size or type, or a number"),
            ("message = vbar.ideal_navigation()", "its answer holds a packet of APID 0x010, which this sensor does not have"),
            ("message = vbar.tick()", "its answer holds a packet of APID 0x001, which this sensor does not have"),
            ("time_ns -= 1_000_000_000", "its next epoch is not later than the present one")):
            self.assert_one_sentence(self.fly_sensor(measure), f"source servicer/lidar: {fault}")

    def test_missions_that_are_refused(self):
        for program, fault in (("", "neither program nor udp"),
                               ('udp = "localhost"', 'an IPv4 address and a port, "127.0.0.1:5005"'),
                               ('program = "a"\nudp = "127.0.0.1:5005"', "nothing beside program"),
                               ('[[testbed.external.source]]\nname = "servicer/lidar"', "neither program nor udp")):
            result = vbar("run", self.mission(program), "--check")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(fault, result.stderr)

    def test_programs_that_are_missing(self):
        for program, fault in (('program = "no_such_program"', "no_such_program"),
                               ('[[testbed.external.source]]\nname = "servicer/radar"\nprogram = "x"\n[testbed.grand]',
                                "names no program for the source servicer/lidar")):
            mission = self.mission(program)
            mission.write_text(mission.read_text().replace("\n[testbed.grand]\nanswer_limit_s = 2.0", ""))
            result = vbar("run", mission, "--quiet", "--force", "--out", self.folder / "run")
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(fault, result.stderr)


if __name__ == "__main__":
    main()
