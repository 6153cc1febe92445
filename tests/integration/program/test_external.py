#!/usr/bin/env python3
"""Sensors and the truth in other processes (testbed.external): vbar's own receivers and truth served by a second process, a range finder
in Python and one in C, a truth in Python, and programs that end, hang or send what is not theirs."""
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

from vbar_program import BINARY, SOURCE, children_of, fly, hashes, is_running, main, overrides, scratch, start, summary_of, vbar

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


EXTERNAL_TRUTH = """
extends = "{missions}/external_truth.toml"
[mission]
name = "truth"
duration_h = 0.5
[testbed.external]
answer_limit_s = 2.0
[[testbed.external.source]]
name = "truth"
program = "{python} {script}"
"""
TRUTH_IN_PYTHON = """
import os, sys, time
sys.path.insert(0, "{examples}")
import two_body_truth, vbar, vbar_sensor
class Truth(two_body_truth.TwoBodyTruth):
    times = 0
    def advance(self, time_ns, commands):
        stated = super().advance(time_ns, commands)
        self.times += 1
        servicer = stated[0][0]
        {change}
        return stated
vbar_sensor.serve_truth(Truth)
"""


def rows_of(folder, table="range_finder"):
    with open(folder / f"{table}.csv", newline="") as table:
        return list(csv.DictReader(table))


class Programs(unittest.TestCase):
    """What both classes below have."""

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.python = {"PYTHONPATH": BINARY / "python"}

    def assert_one_sentence(self, result, *parts, code=1):
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for part in parts:
            self.assertIn(part, result.stderr)
        self.assertNotIn("Traceback (most recent call last)", result.stderr.split("its last output")[0])

    def served(self, name, duration, more=""):
        """A mission whose external sources vbar serves in other processes."""
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
        return within, without

    def kill_the_program_of(self, mission):
        """Kills the program once the run has begun; exit code and message of the run."""
        run = start("run", mission, "--quiet", "--force", "--out", self.folder / "killed",
                    env=os.environ | {"PYTHONPATH": str(BINARY / "python")})
        with contextlib.ExitStack() as stack:
            stack.callback(run.kill)
            deadline = time.monotonic() + 20
            while not (self.folder / "killed" / "packets.lcmlog").exists() and time.monotonic() < deadline:
                time.sleep(0.02)
            children = children_of(run.pid)
            os.kill(children[0], signal.SIGKILL)
            _, message = run.communicate(timeout=30)
        self.assertFalse(is_running(children[0]))
        return run.returncode, message


class External(Programs):
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
        code, message = self.kill_the_program_of(self.mission(f'program = "{sys.executable} {script}"'))
        self.assertEqual(code, 1, message)
        self.assertIn("killed by signal 9", message)
        self.assertEqual(message.count("\n"), 1, message)

    def test_invalid_measurements(self):
        for measure, fault in (
            ("message.range_m = float('nan')", "its answer holds a packet of APID 0x016 whose message has another size or type, or a number"),
            ("message = vbar.ideal_navigation()", "its answer holds a packet of APID 0x010, which this sensor does not have"),
            ("message = vbar.tick()", "its answer holds a packet of APID 0x001, which this sensor does not have"),
            ("time_ns -= 1_000_000_000", "its next epoch is not later than the present one")):
            self.assert_one_sentence(self.fly_sensor(measure), f"source servicer/lidar: {fault}")

    def test_impossible_measurements_are_rejected_and_counted(self):
        """Of each epoch: nothing outside the sensor's range of 0.5 to 1000 m, and 64 packets at most."""
        for returned, rejected in (("-5.0", 1), ("1e300", 1), ("8.0", 0)):
            result = self.fly_sensor(f"message.range_m = {returned} if self.epochs == 5 else 8.0")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assert_rejected(rejected)
        self.assertEqual(self.fly_sensor("if self.epochs == 5: return [message] * 2000, time_ns + 1_000_000_000").returncode, 0)
        self.assert_rejected(2000 - 64)

    def assert_rejected(self, count):
        (source,) = [one for one in summary_of(self.folder / "run")["sources"] if one["name"] == "servicer/lidar"]
        self.assertEqual(source["packets_rejected"], count)

    def test_missions_that_are_refused(self):
        for program, fault in (("", "neither program nor udp"),
                               ('udp = "localhost"', 'an IPv4 address and a port, "127.0.0.1:5005"'),
                               ('program = "a"\nudp = "127.0.0.1:5005"', "nothing beside program"),
                               ('[[testbed.external.source]]\nname = "servicer/lidar"', "neither program nor udp")):
            result = vbar("run", self.mission(program), "--check")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(fault, result.stderr)

    def test_a_program_that_would_not_be_started(self):
        """A misspelt name, a sensor with another source, a truth by the model: refused before the flight. A testbed without any source: a note."""
        program = f'program = "{SENSOR_IN_C} --stream 3"'
        lidar = "what has source = \"external\": servicer/lidar"
        nothing = "nothing, as neither the truth nor a sensor has source = \"external\""
        for name, sensor_source, accepted in (("servicer/lidr", "external", lidar), ("truth", "external", lidar),
                                              ("servicer/lidar", "digital", nothing)):
            mission = self.mission(f'[[testbed.external.source]]\nname = "{name}"\n{program}')
            mission.write_text(mission.read_text().replace("answer_limit_s = 2.0\n", ""))
            result = vbar("run", mission, "--check", *overrides(f"spacecraft.servicer.sensors.lidar.source={sensor_source}"))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(f'found the text "{name}"; accepted: {accepted}', result.stderr)
        unused = vbar("run", self.mission(program), "--check", *overrides("spacecraft.servicer.sensors.lidar.source=digital"))
        self.assertEqual(unused.returncode, 0, unused.stderr)
        self.assertIn('data: testbed.external has no effect in this mission: neither a sensor nor the truth has source = "external"',
                      unused.stdout)

    def test_programs_that_are_missing(self):
        own = '[[testbed.external.source]]\nname = "servicer/lidar"\nprogram = "x"\n[testbed.grand]'
        for program, settings, fault in (('program = "no_such_program"', [], "no_such_program"),
                                         (own, EXTERNAL_RECEIVERS, "names no program for the source servicer/gnss")):
            mission = self.mission(program)
            mission.write_text(mission.read_text().replace("\n[testbed.grand]\nanswer_limit_s = 2.0", ""))
            result = vbar("run", mission, "--quiet", "--force", "--out", self.folder / "run", *overrides(*settings))
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(fault, result.stderr)


class ExternalTruth(Programs):
    def mission(self, change):
        """With a truth in Python that does something else."""
        script = self.folder / "truth.py"
        script.write_text(TRUTH_IN_PYTHON.format(examples=SOURCE / "hil_drivers" / "external" / "examples", change=change))
        file = self.folder / "truth.toml"
        file.write_text(EXTERNAL_TRUTH.format(missions=SOURCE / "missions", python=sys.executable, script=script))
        return file

    def fly_truth(self, change):
        return vbar("run", self.mission(change), "--quiet", "--force", "--out", self.folder / "run", **self.python)

    def assert_same_truth(self):
        for table in ("truth", "attitude", "waypoints"):
            of_both = [(self.folder / run / f"{table}.csv").read_bytes() for run in ("within", "without")]
            self.assertEqual(*of_both, table)

    def test_truth_of_another_process_gives_the_same_bits(self):
        for seed in (1, 2):
            mission = self.served("experiment3", SHORT)
            _, without = self.assert_same_bits(mission, ["truth.source=external"], SHORT, f"mission.seed={seed}")
            self.assert_same_truth()
            truth = next(source for source in without["sources"] if source["name"] == "truth")
            self.assertEqual(truth["kind"], "external")
            # Steps and measurements are 10 s apart: one exchange serves both.
            self.assertEqual(truth["epochs"], 37)
        self.assertIn("of testbed external", (self.folder / "without" / "report.html").read_text())
        replayed = vbar("replay", self.folder / "without")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)

    def test_truth_and_receivers_of_other_processes_give_the_same_bits(self):
        self.assert_same_bits(self.served("experiment3", SHORT), ["truth.source=external", *EXTERNAL_RECEIVERS], SHORT)

    def test_pointing_and_images_of_another_truth_give_the_same_bits(self):
        duration = "mission.duration_h=0.75"  # after half an hour the flight software points its camera by its own estimate
        self.assert_same_bits(self.served("experiment1", duration), ["truth.source=external"], duration)
        self.assert_same_truth()

    def test_uncommanded_impulses_reach_the_truth(self):
        fault = '[[fault]]\nkind = "thrust_uncommanded"\nat_h = 39.02\nfor_s = 30.5\nvalue_mps2 = 1e-5\ndirection_rtn = [0.0, 1.0, 0.0]'
        self.assert_same_bits(self.served("experiment3", SHORT, fault), ["truth.source=external"], SHORT)
        self.assert_same_truth()

    def test_start_of_another_mission_is_refused(self):
        mission = self.served("experiment3", SHORT)
        result = vbar("run", mission, *overrides("truth.source=external", SHORT, "mission.start_h=39.1"), "--quiet",
                      "--force", "--out", self.folder / "run")
        self.assert_one_sentence(result, "source truth: ", "elsewhere than the mission that is served", code=2)

    def test_truth_in_python(self):
        summary = fly(self.folder / "python", mission=SOURCE / "missions" / "external_truth.toml", **self.python)
        own = fly(self.folder / "own")
        # A gravity of lower degree than vbar's, as the flight software assumes it: not farther from the waypoints.
        for python, vbars in zip(rows_of(self.folder / "python", "waypoints"), rows_of(self.folder / "own", "waypoints")):
            self.assertLess(float(python["control_error_m"]), 2.0 * float(vbars["control_error_m"]) + 0.01, python["index"])
        self.assertAlmostEqual(summary["dv_mps"], own["dv_mps"], delta=0.05 * own["dv_mps"])

    def test_program_that_ends_or_hangs(self):
        self.assert_one_sentence(self.fly_truth("os._exit(3) if self.times == 5 else None"),
                                 "run incomplete: source truth: program ", "failed at step 5", "exit status 3")
        self.assert_one_sentence(self.fly_truth("time.sleep(60) if self.times == 5 else None"),
                                 "source truth: program ", "failed at step 5", "was still running and has been ended")

    def test_program_that_is_killed(self):
        code, message = self.kill_the_program_of(self.mission("time.sleep(0.1)"))
        self.assertEqual(code, 1, message)
        self.assertIn("source truth: program ", message)
        self.assertIn("killed by signal 9", message)
        self.assertEqual(message.count("\n"), 1, message)

    def test_invalid_states(self):
        for change, fault in (
            ("servicer.position_eci = [value / 1e3 for value in servicer.position_eci]",
             "below the Earth's surface, 7"),
            ("servicer.velocity_eci = [value / 1e3 for value in servicer.velocity_eci]",
             "a velocity of the spacecraft servicer that is 7"),
            ("servicer.acceleration_eci = [0.0, 0.0, 0.0]", "an acceleration of the spacecraft servicer that is 7.9"),
            ("del stated[1]", "no true_state of the spacecraft target"),
            ("stated.append(stated[0])", "a second true_state of the spacecraft servicer"),
            ("stated.append((servicer, 7))", "a true_state of spacecraft 7, which the mission does not have"),
            ("servicer.position_eci[0] = float('nan')", "with a number that is not finite"),
            ("stated.append((vbar.ideal_navigation(), 1))", "neither a true_state nor a true_earth")):
            self.assert_one_sentence(self.fly_truth(change), "source truth: at 0 s of the run its answer holds ", fault, code=2)

    def test_position_that_jumps(self):
        change = "servicer.position_eci[0] += 1000.0 if self.times == 5 else 0.0"
        self.assert_one_sentence(self.fly_truth(change), "run incomplete: source truth: at 240 s of the run its answer holds ",
                                 "a position of the spacecraft servicer that is 1000.")

    def test_a_run_is_not_resumed_and_not_propagated(self):
        fly(self.folder / "whole", mission=self.mission("pass"), **self.python)
        branch = vbar("resume", self.folder / "whole", "--at", 0.2, "--set", "guidance.dv_min_mmps=2.0", "--out", self.folder / "branch",
                      **self.python)
        self.assert_one_sentence(branch, "a run with the truth of testbed external cannot be flown again", code=2)
        self.assert_one_sentence(vbar("propagate", self.mission("pass")), 'truth.source: found "external"', code=2)

    def test_missions_that_are_refused(self):
        result = vbar("run", "ideal_navigation", "--set", "truth.source=external", "--check")
        self.assert_one_sentence(result, "truth.source", "model, as the mission has no [testbed.external]", code=2)
        result = vbar("run", self.served("ideal_navigation", SHORT), "--set", "truth.source=grand", "--check")
        self.assert_one_sentence(result, "truth.source", "accepted: model or external", code=2)


if __name__ == "__main__":
    main()
