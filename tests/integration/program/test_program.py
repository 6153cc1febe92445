#!/usr/bin/env python3
"""The program from outside: the same bits on every flight computer, replay, faults, bad input, the run folder."""
import csv
import datetime
import json
import math
import os
import pathlib
import signal
import subprocess
import time
import unittest

from vbar_program import (BINARY, MISSION, SOURCE, VBAR, ZYNQ_IMAGE, ZYNQ_LINUX_PROGRAM, children_of, fly, hashes, is_running,
                          main, missing, overrides, scratch, start, summary_of, vbar)

# 6.4 h: the whole first leg with its burns, the waypoint, and the first burn of the next leg.
SHORT = "mission.duration_h=6.4"
FIRST_BURNS = "mission.duration_h=1.5"

TARGETS = {
    "host process, serial": ("flight_computer.target=host_process",),
    "host process, UDP": ("flight_computer.target=host_process", "flight_computer.link=udp"),
    "ARM Linux, serial": ("flight_computer.target=zynq_linux_qemu",),
    "Zynq, UART": ("flight_computer.target=zynq_qemu",),
    "Zynq, Ethernet": ("flight_computer.target=zynq_qemu", "flight_computer.link=udp"),
}


def not_built(name):
    if name.startswith("Zynq"):
        return missing(ZYNQ_IMAGE)
    if name.startswith("ARM"):
        return missing(ZYNQ_LINUX_PROGRAM)
    return None



def date_of(mjd):
    return datetime.date(1858, 11, 17) + datetime.timedelta(days=mjd)


def finals2000a(first_mjd, days, first_predicted):
    """Numbers of no year in the published columns (readme.finals2000A)."""
    rows = []
    for mjd in range(first_mjd, first_mjd + days):
        date, flag = date_of(mjd), "P" if mjd >= first_predicted else "I"
        rows.append(f"{date.year % 100:2d}{date.month:2d}{date.day:2d} {mjd:8.2f} {flag} {0.1:9.6f}{1e-5:9.6f} {0.35:9.6f}{1e-5:9.6f}"
                    f"  {flag}{0.05:10.7f}{1e-6:10.7f} {0.1:7.4f}{0.01:7.4f}  {flag} {0.3:9.3f}{0.1:9.3f} {-0.1:9.3f}{0.1:9.3f}\n")
    return "".join(rows)


def space_weather(first_mjd, days, first_predicted):
    """Numbers of no year in the columns of CelesTrak's text."""
    def row(mjd):
        date = date_of(mjd)
        return (f"{date.year:4d} {date.month:02d} {date.day:02d} 2637  1" + "20".rjust(3) * 8 + " 160" + "7".rjust(4) * 8 +
                "   7 0.4 2 100 140.0 0 150.0 150.0 145.0 151.0 151.0\n")
    observed = "".join(row(mjd) for mjd in range(first_mjd, first_predicted))
    predicted = "".join(row(mjd) for mjd in range(first_predicted, first_mjd + days))
    return (f"DATATYPE CssiSpaceWeather\nVERSION 1.2\nBEGIN OBSERVED\n{observed}END OBSERVED\n"
            f"BEGIN DAILY_PREDICTED\n{predicted}END DAILY_PREDICTED\n")


class SameBits(unittest.TestCase):
    """Commands and telemetry do not depend on where the flight software runs, nor on how often or how fast."""

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.reference_folder = cls.folder / "reference"
        cls.reference = fly(cls.reference_folder, SHORT)

    def test_the_arc_has_several_maneuvers(self):
        self.assertGreaterEqual(self.reference["maneuvers"], 5)

    def test_every_flight_computer(self):
        for name, settings in TARGETS.items():
            with self.subTest(name):
                if not_built(name):
                    self.skipTest(not_built(name))
                summary = fly(self.folder / "run", SHORT, *settings)
                self.assertEqual(hashes(summary), hashes(self.reference))
                if name.startswith("Zynq"):
                    self.assertEqual(summary["flight_step"]["unit"], "instructions")
                    self.assertGreater(summary["flight_step"]["max"], 0)
                    self.assertGreater(summary["flight_step"]["stack_bytes_max"], 0)

    def test_replay_into_every_flight_computer(self):
        """The whole arc in this process, its first burns into every other flight computer."""
        record = self.folder / "first_burns"
        self.assertGreaterEqual(fly(record, FIRST_BURNS)["maneuvers"], 3)
        for name, settings in {"in process": (), **TARGETS}.items():
            with self.subTest(name):
                if not_built(name):
                    self.skipTest(not_built(name))
                result = vbar("replay", record if settings else self.reference_folder, *overrides(*settings))
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                self.assertIn("identical", result.stdout)

    def test_again_with_another_speed_and_number_of_threads(self):
        for settings in ((), ("truth.threads=2",), ("clock.mode=real_time", "clock.speed_factor=20000")):
            with self.subTest(settings):
                self.assertEqual(hashes(fly(self.folder / "run", SHORT, *settings)), hashes(self.reference))

    def test_instructions_of_a_step_are_the_same_in_every_run(self):
        if missing(ZYNQ_IMAGE):
            self.skipTest(missing(ZYNQ_IMAGE))
        settings = ("mission.duration_h=0.5", "flight_computer.target=zynq_qemu", "flight_computer.link=udp")
        costs = [fly(self.folder / "run", *settings)["flight_step"] for _ in range(2)]
        self.assertEqual(costs[0], costs[1])

    def test_recorded_navigation_as_a_source_gives_the_same_run(self):
        log = self.reference_folder / "packets.lcmlog"
        summary = fly(self.folder / "run", SHORT, "spacecraft.servicer.sensors.navigation.source=recorded",
                      f"spacecraft.servicer.sensors.navigation.log={log}")
        self.assertEqual(hashes(summary), hashes(self.reference))


class ForeignArticle(unittest.TestCase):
    """A flight software that is not vbar's, written in C: as a shared library here."""

    def test_it_flies_from_a_shared_library(self):
        library = BINARY / "libvbar_example_article.so"
        if missing(library):
            self.skipTest(missing(library))
        with scratch() as folder:
            summary = fly(folder / "run", "mission.duration_h=1", f"flight_computer.library={library}")
            self.assertTrue(summary["complete"])
            self.assertNotIn("vbar GNC", summary["flight_software"])

    def test_a_library_that_is_none_is_one_clear_error(self):
        with scratch() as folder:
            result = vbar("run", MISSION, "--out", folder / "run", "--set", "flight_computer.library=/nonexistent.so")
            self.assertEqual(result.returncode, 1)
            self.assertIn("/nonexistent.so", result.stderr)
            self.assertFalse(summary_of(folder / "run")["complete"])


class BrokenOff(unittest.TestCase):
    """A run that cannot go on ends with one error, says so in its folder, and leaves no process behind."""

    def wait_for_children(self, run, count):
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            children = children_of(run.pid)
            if len(children) >= count:
                return children
            time.sleep(0.02)
        self.fail("the flight computer was never started")

    def assert_incomplete(self, run, folder, reason):
        _, errors = run.communicate(timeout=90)
        self.assertNotEqual(run.returncode, 0)
        self.assertEqual(errors.count("vbar:"), 1, errors)
        summary = summary_of(folder)
        self.assertFalse(summary["complete"])
        self.assertRegex(summary["incomplete_reason"], reason)

    def kill_in_mid_run(self, *settings):
        with scratch() as folder:
            run = start("run", MISSION, "--out", folder / "run", *overrides(*settings))
            try:
                children = self.wait_for_children(run, 1)
                time.sleep(1.5)
                os.kill(children[-1], signal.SIGKILL)
                self.assert_incomplete(run, folder / "run", ".")
                self.assertFalse([pid for pid in children if is_running(pid)])
            finally:
                run.kill()
                run.wait()

    def test_qemu_killed(self):
        if missing(ZYNQ_IMAGE):
            self.skipTest(missing(ZYNQ_IMAGE))
        self.kill_in_mid_run("flight_computer.target=zynq_qemu")

    def test_host_process_killed(self):
        # Paced, so that the run is still under way when the process dies.
        self.kill_in_mid_run("flight_computer.target=host_process", "clock.mode=real_time", "clock.speed_factor=3000")

    def test_interrupted_by_the_user(self):
        with scratch() as folder:
            run = start("run", MISSION, "--out", folder / "run", "--set", "clock.mode=real_time", "--set",
                        "clock.speed_factor=100")
            try:
                time.sleep(1.5)
                run.send_signal(signal.SIGINT)
                self.assert_incomplete(run, folder / "run", "interrupted")
                self.assertGreater(summary_of(folder / "run")["simulated_s"], 0.0)
            finally:
                run.kill()
                run.wait()


class BadInput(unittest.TestCase):
    """One message that names the place; nothing is left behind as if complete."""

    def refuse(self, arguments, *parts):
        with scratch() as folder:
            out = ["--out", folder / "run"] if arguments[0] == "run" else []
            result = vbar(*arguments, *out)
            self.assertNotEqual(result.returncode, 0)
            for part in parts:
                self.assertIn(part, result.stderr)
            self.assertFalse((folder / "run").exists())

    def test_unknown_key(self):
        self.refuse(["run", MISSION, "--set", "mission.durations_h=3"], "durations_h", "duration_h")

    def test_no_such_mission(self):
        self.refuse(["run", "no_such_mission.toml"], "no_such_mission.toml")

    def test_names_with_control_characters_stay_on_the_line_of_the_message(self):
        bad = "no_such\nvbar: verdict achieved\x1b[2J"
        for arguments, environment in (
                (("run", bad), {}), (("run", MISSION, "--set", f"mission.{bad}=1"), {}), (("run", MISSION, "--seed", bad), {}),
                (("run", MISSION, "--out", f"/proc/{bad}"), {}), (("replay", bad), {}), (("report", bad), {}), (("check", bad), {}),
                (("resume", bad), {}), (("campaign", "status", bad), {}), (("explain", bad), {}), (("keys", bad), {}),
                (("columns", bad), {}), (("new-article", bad), {}), ((bad,), {}), ((f"--{bad}",), {}),
                (("run", MISSION, "--set", f'flight_computer.library="{bad}"'), {}),
                (("propagate", MISSION, "--out", f"/proc/{bad}"), {}), (("run", MISSION, "--check"), {"VBAR_DATA": bad})):
            with self.subTest(arguments=arguments), scratch() as folder:
                result = subprocess.run([VBAR, *map(str, arguments)], capture_output=True, text=True, timeout=60, cwd=folder,
                                        env=os.environ | environment)
                self.assertNotEqual(result.returncode, 0)
                self.assertNotIn("\x1b", result.stderr)
                self.assertNotIn("\nvbar: verdict", result.stderr)
                self.assertTrue(result.stderr, result.stdout)

    def test_replay_of_a_folder_that_is_no_run(self):
        with scratch() as folder:
            self.refuse(["replay", folder], str(folder))

    def test_report_of_a_folder_that_is_no_run(self):
        with scratch() as folder:
            self.refuse(["report", folder], str(folder))

    def test_a_folder_of_something_else_is_not_overwritten(self):
        with scratch() as folder:
            (folder / "precious.txt").write_text("keep me")
            result = vbar("run", MISSION, "--out", folder)
            self.assertNotEqual(result.returncode, 0)
            self.assertEqual((folder / "precious.txt").read_text(), "keep me")


class Propagate(unittest.TestCase):
    """The truth alone, and what it refuses."""

    ORBIT = SOURCE / "missions" / "full_force_orbit.toml"
    SWARM = SOURCE / "missions" / "swarm_of_fifty.toml"

    def propagate(self, mission, folder, *settings, flags=()):
        result = vbar("propagate", mission, "--out", folder, *flags, *overrides(*settings))
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads((folder / "propagation.json").read_text())
        self.assertTrue(summary["complete"])
        return result.stdout, summary

    def test_a_day_under_all_forces_as_csv_and_oem(self):
        with scratch() as folder:
            table, summary = self.propagate(self.ORBIT, folder / "out", flags=["--oem"])
            rows = list(csv.DictReader((folder / "out" / "mango.csv").open()))
            self.assertEqual(len(rows), 24 * 60 + 1)
            self.assertEqual(rows[-1]["utc"], "2011-07-19T01:00:00.000Z")
            radii = [math.hypot(*(float(row[f"position_eci_{axis}_m"]) for axis in "xyz")) for row in rows]
            # a (1 +- e) of the file's elements, and 10 km of the Earth's oblateness.
            self.assertGreater(min(radii), 7087.3e3 * (1 - 0.0015) - 15e3)
            self.assertLess(max(radii), 7087.3e3 * (1 + 0.0015) + 15e3)
            states = [line.split() for line in (folder / "out" / "mango.oem").read_text().splitlines()
                      if line[:2] == "20"]
            self.assertEqual(len(states), len(rows))
            for state, row in zip(states, rows):
                self.assertEqual(state[0][:23] + "Z", row["utc"])
                for k, axis in enumerate("xyz"):
                    self.assertAlmostEqual(1e3 * float(state[1 + k]), float(row[f"position_eci_{axis}_m"]), delta=1e-6)
            # A satellite of 154 kg and 1.3 m^2 at 700 km in 2011 loses metres a day, not less than centimetres.
            decay = summary["spacecraft"][0]["semi_major_axis_change_by_drag_m"]
            self.assertTrue(-20.0 < decay < -0.02, decay)
            for force in ("frames", "gravity", "drag", "radiation_pressure", "sun", "moon", "solid_tides", "relativity",
                          "sampling", "integration"):
                self.assertIn(force, table)
                self.assertGreater(summary["force_wall_s"][force], 0.0)

    def test_any_number_of_threads_gives_the_same_files(self):
        with scratch() as folder:
            settings = ("mission.duration_h=0.5", "spacecraft.swarm.count=300")
            _, summary = self.propagate(self.SWARM, folder / "one", *settings, "truth.threads=1")
            self.propagate(self.SWARM, folder / "three", *settings, "truth.threads=3")
            self.assertEqual(len(summary["files"]), 300)
            for file in summary["files"]:
                self.assertEqual((folder / "one" / file).read_bytes(), (folder / "three" / file).read_bytes(), file)

    def test_a_mission_with_a_flight_computer_flies_without_it(self):
        with scratch() as folder:
            _, summary = self.propagate(MISSION, folder / "out", "mission.duration_h=1")
            self.assertEqual([one["name"] for one in summary["spacecraft"]], ["servicer", "target"])

    def test_a_mission_without_one_cannot_be_run(self):
        with scratch() as folder:
            result = vbar("run", self.ORBIT, "--out", folder / "run")
            self.assertEqual(result.returncode, 2)
            self.assertIn("vbar propagate", result.stderr)
            self.assertFalse((folder / "run").exists())

    def refuse(self, settings, *parts):
        with scratch() as folder:
            result = vbar("propagate", self.ORBIT, "--out", folder / "out", *overrides(*settings))
            self.assertEqual(result.returncode, 2)
            self.assertEqual(result.stderr.count("vbar:"), 1, result.stderr)
            for part in parts:
                self.assertIn(part, result.stderr)
            self.assertFalse((folder / "out").exists())

    def test_data_that_end_are_noticed_at_the_start(self):
        named = ["truth.earth_orientation_file=earth/eop_2009_2013.csv",
                 "truth.space_weather_file=earth/space_weather_2009_2013.csv"]
        self.refuse(named + ["mission.epoch_utc=2013-12-20T00:00:00Z", "mission.duration_h=480"], "eop_2009_2013.csv",
                    "ends at 2014-01-09T00:00:00Z")
        self.refuse(named + ["mission.epoch_utc=2009-01-02T00:00:00Z"], "space_weather_2009_2013.csv", "2009-01-02")

    def test_a_date_of_today_flies_with_published_files_and_without(self):
        today = ["mission.epoch_utc=2026-11-20T00:00:00Z", "mission.duration_h=1"]
        with scratch() as folder:
            (folder / "finals2000A.all").write_text(finals2000a(first_mjd=61350, days=60, first_predicted=61375))
            (folder / "SW-All.txt").write_text(space_weather(first_mjd=61350, days=60, first_predicted=61370))
            files = [f"truth.earth_orientation_file={folder / 'finals2000A.all'}",
                     f"truth.space_weather_file={folder / 'SW-All.txt'}"]
            flown = vbar("propagate", self.ORBIT, "--out", folder / "with", *overrides(*today, *files))
            self.assertEqual(flown.returncode, 0, flown.stderr)
            self.assertNotIn("data  ", flown.stdout)
            later = ["mission.epoch_utc=2026-12-10T00:00:00Z", "mission.duration_h=1"]
            flown = vbar("propagate", self.ORBIT, "--out", folder / "predicted", *overrides(*later, *files))
            self.assertEqual(flown.returncode, 0, flown.stderr)
            self.assertIn("Earth orientation is predicted from", flown.stdout)
            self.assertIn("Space weather is predicted from", flown.stdout)
            self.refuse(later + files + ["truth.accept_predictions=false"], "finals2000A.all", "is predicted from")
            flown = vbar("propagate", self.ORBIT, "--out", folder / "without", *overrides(*today))
            self.assertEqual(flown.returncode, 0, flown.stderr)
            self.assertIn("UT1 = UTC is assumed, an error of up to 0.9 s", flown.stdout)
            self.assertIn("F10.7 = 150 and Ap = 15 are assumed", flown.stdout)

    def test_an_orbit_outside_the_domain_of_the_planner(self):
        with scratch() as folder:
            result = vbar("run", SOURCE / "missions" / "user_orbit_eccentric.toml", "--check",
                          *overrides("waypoint.3.solver=closed_form"))
            self.assertEqual(result.returncode, 2)
            self.assertIn("waypoint 3: solver = closed_form is the closed-form solver for near-circular orbits", result.stderr)
            result = vbar("run", SOURCE / "missions" / "user_orbit_eccentric.toml", "--check",
                          *overrides("spacecraft.servicer.elements.semi_major_axis_km=24400",
                                     "spacecraft.servicer.elements.ex=0.7283"))
            self.assertEqual(result.returncode, 2)
            self.assertIn("no planner of this flight software", result.stderr)

    # Control errors of legs 1 to 10 at 0.05, 0.2, 1 and 5 deg: 98, 21, 5.7 and 0.8 m (docs/data_formats.md).
    def test_an_orbit_near_the_equator(self):
        def check(*sets):
            return vbar("run", SOURCE / "missions" / "user_orbit_400km.toml", "--check", *overrides(*sets))
        inclination = "spacecraft.servicer.elements.inclination_deg="
        for i in ("0.05", "1", "4.9", "175.2", "179.9"):
            refused = check(inclination + i)
            self.assertEqual(refused.returncode, 2, i)
            self.assertRegex(refused.stderr, r'spacecraft "servicer": its mean inclination is [0-9.]+ deg; accepted: 5 to 175 deg')
            self.assertEqual(len(refused.stderr.splitlines()), 1)
        self.assertEqual(check(inclination + "5.1").returncode, 0)

    def test_times_that_packets_do_not_carry(self):
        def check(epoch):
            return vbar("run", "ideal_navigation", "--check", *overrides(f"mission.epoch_utc={epoch}"))
        refused = check("2126-03-01T00:00:00Z")
        self.assertEqual(refused.returncode, 2)
        # 2^62 ns after 1980-01-06.
        self.assertIn("mission.epoch_utc: the run ends at 2126-03-02T", refused.stderr)
        self.assertIn("accepted: up to 2126-02-24T23:53:20Z", refused.stderr)
        self.assertEqual(check("2126-01-01T00:00:00Z").returncode, 0)

    def test_files_that_do_not_serve(self):
        self.refuse(["truth.gravity_degree=121"], "degree 121", "0 to 120")
        with scratch() as folder:
            text = (SOURCE / "data" / "gravity" / "ggm05s_120.txt").read_text()
            (folder / "cut.txt").write_text(text[:len(text) // 2])
            self.refuse([f"truth.gravity_file={folder / 'cut.txt'}"], str(folder / "cut.txt"), "expected")

    def test_settings_that_do_not_serve(self):
        self.refuse(["truth.relative_tolerance=1e-15"], "relative_tolerance", "from 1e-14 to 1e-06")
        self.refuse(["spacecraft.mango.drag_area_m2=0"], "mango", "drag needs drag_area_m2 above 0")

    def test_re_entry_leaves_parts_and_says_so(self):
        with scratch() as folder:
            result = vbar("propagate", self.ORBIT, "--out", folder / "out", *overrides(
                "spacecraft.mango.elements.semi_major_axis_km=6540", "spacecraft.mango.elements.ex=0",
                "spacecraft.mango.drag_area_m2=100"))
            self.assertEqual(result.returncode, 1)
            self.assertIn('spacecraft "mango": re-enters', result.stderr)
            self.assertIn("at 2011-07-18T", result.stderr)
            summary = json.loads((folder / "out" / "propagation.json").read_text())
            self.assertFalse(summary["complete"])
            self.assertIn("re-enters", summary["incomplete_reason"])
            self.assertFalse((folder / "out" / "mango.csv").exists())
            self.assertGreater((folder / "out" / "mango.csv.part").stat().st_size, 0)

    def test_an_orbit_that_is_no_ellipse(self):
        # A mission file gives elements, and cannot give those of an orbit that leaves the Earth.
        self.refuse(["spacecraft.mango.elements.ex=0.95"], "spacecraft.mango.elements.ex", "0.9")


class RunFolder(unittest.TestCase):
    """What a run leaves, and what reads it."""

    def test_everything_is_there_and_reports_compare(self):
        with scratch() as folder:
            for name in ("a", "b"):
                fly(folder / name, "mission.duration_h=6.4")
            for file in ("summary.json", "waypoints.csv", "truth.csv", "estimate.csv", "maneuvers.csv",
                         "packets.lcmlog", "report.html"):
                self.assertTrue((folder / "a" / file).is_file(), file)
            for file in ("waypoints.csv", "truth.csv", "estimate.csv", "maneuvers.csv", "packets.lcmlog"):
                self.assertEqual((folder / "a" / file).read_bytes(), (folder / "b" / file).read_bytes(), file)
            result = vbar("report", folder / "a", folder / "b")
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_missions_lists_the_mission(self):
        result = vbar("missions", SOURCE / "missions")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("ideal_navigation", result.stdout)


class LcmMirror(unittest.TestCase):
    """Live packets on an LCM bus, in a network of this test's own."""

    def test_lcm_logger_sees_the_run(self):
        with scratch() as folder:
            script = (
                "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && "
                f"lcm-logger --quiet --lcm-url='udpm://239.255.76.67:7667?ttl=0' {folder}/live.lcmlog & logger=$!; sleep 1; "
                f"{BINARY}/vbar run {MISSION} --out {folder}/run --set mission.duration_h=1 --set lcm.mirror=true "
                "--set clock.mode=real_time --set clock.speed_factor=1800 >/dev/null; code=$?; sleep 0.5; "
                "kill -INT $logger; wait $logger; exit $code")
            result = subprocess.run(["unshare", "--net", "sh", "-c", script], capture_output=True, text=True, timeout=60)
            if "unshare" in result.stderr or "Operation not permitted" in result.stderr:
                self.skipTest("no network namespace of our own: " + result.stderr.strip())
            self.assertEqual(result.returncode, 0, result.stderr)
            live = (folder / "live.lcmlog").read_bytes()
            self.assertGreater(live.count(b"VBAR_PACKET"), 60)


if __name__ == "__main__":
    main()
