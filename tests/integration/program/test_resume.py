#!/usr/bin/env python3
"""vbar resume: runs that were killed or interrupted are continued to the same files as undisturbed ones; branches leave a run."""
import json
import random
import re
import shutil
import signal
import struct
import subprocess
import time
import unittest

from vbar_program import MISSION, SOURCE, VBAR, ZYNQ_IMAGE, fly, hashes, main, missing, overrides, scratch, start, summary_of, vbar

DONE, FAILED, REFUSED, DIFFERENT = 0, 1, 2, 3
THINNED, DAMAGED, INTERRUPTED = 7, 9, 75

SHORT = ("mission.duration_h=3",)
PACED = ("clock.mode=real_time", "clock.speed_factor=3000")  # three hours in 3.6 s
EXPERIMENT3 = SOURCE / "missions" / "experiment3.toml"
EXPERIMENT3_SHORT = ("mission.duration_h=0.75",)

# All that may differ between two runs of a mission: what the wall clock says, and how the link to a remote flight computer fared.
WALL_CLOCK = ("wall_s", "speed_factor", "deadlines", "wall_share")
WALL_CLOCK_OF_SOURCES = ("late", "latest_s")
WALL_CLOCK_OF_LINK = ("bytes", "frames_resent", "frames_rejected", "frames_duplicated", "strangers_ignored", "step_share_max",
                      "step_share_mean")


def timeless(summary):
    """A summary without what the wall clock says."""
    summary = {key: value for key, value in summary.items() if key not in WALL_CLOCK}
    summary["provenance"] = {key: value for key, value in summary["provenance"].items() if key != "started_utc"}
    summary["sources"] = [{key: value for key, value in source.items() if key not in WALL_CLOCK_OF_SOURCES}
                          for source in summary["sources"]]
    if summary["flight_computer"] != "in_process":
        summary["link"] = {key: value for key, value in summary["link"].items() if key not in WALL_CLOCK_OF_LINK}
    return summary


def timeless_page(folder):
    """The lines of a report that no wall clock enters, and the link only with a flight computer in this process."""
    words = ["simulated in", "real time", "started, UTC", "wall clock", "in parallel"]
    if summary_of(folder)["flight_computer"] != "in_process":
        words += ["link", "frames"]
    return [line for line in (folder / "report.html").read_text().splitlines() if not any(word in line for word in words)]


def timeless_view(folder):
    """The page on which the run is watched, with a summary as above."""
    before, runs, after = re.split(r'(?<=id="runs">)(.*?)(?=</script>)', (folder / "view.html").read_text(), maxsplit=1, flags=re.DOTALL)
    runs = json.loads(runs)
    for run in runs:
        run["summary"], run["name"] = timeless(run["summary"]), ""
    return re.sub("<title>.*?</title>", "", before), runs, after


def files_of(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def differences(a, b):
    """Files of two runs that differ by more than wall-clock numbers."""
    different = sorted(set(files_of(a)) ^ set(files_of(b)))
    for name in sorted(set(files_of(a)) & set(files_of(b))):
        if name == "summary.json":
            same = timeless(summary_of(a)) == timeless(summary_of(b))
        elif name == "report.html":
            same = timeless_page(a) == timeless_page(b)
        elif name == "view.html":
            same = timeless_view(a) == timeless_view(b)
        else:
            same = (a / name).read_bytes() == (b / name).read_bytes()
        if not same:
            different.append(name)
    return different


def kill_after(seconds, *arguments):
    """Starts vbar and kills it; True if it was still running."""
    run = start(*arguments)
    try:
        run.wait(seconds)
        return False
    except subprocess.TimeoutExpired:
        return True
    finally:
        run.send_signal(signal.SIGKILL)
        run.communicate()


def wait_for_flight(folder, run):
    """Until the flight into a folder has left some steps in its log."""
    log = folder / "packets.lcmlog"
    while not log.exists() or log.stat().st_size == 0:
        if run.poll() is not None:
            raise AssertionError(f"vbar ended before it flew: {run.stderr.read()}")
        time.sleep(0.01)


def steps_of(folder):
    """Offsets and lengths of the events of a log by the step of their record, by the format of LCM's logs."""
    log = (folder / "packets.lcmlog").read_bytes()
    at, events = 0, []
    while at + 28 <= len(log):
        channel, data = struct.unpack_from(">II", log, at + 20)
        end = at + 28 + channel + data
        name = log[at + 28:at + 28 + channel]
        if end <= len(log) and name == b"VBAR_PACKET":
            events.append((struct.unpack_from(">q", log, at + 28 + channel + 8)[0], at, end))
        at = end
    return events


class Resuming(unittest.TestCase):
    MISSION, SETTINGS = MISSION, SHORT

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.whole = cls.folder / "whole"
        begun = time.monotonic()
        cls.summary = fly(cls.whole, *cls.SETTINGS, mission=cls.MISSION)
        cls.wall_s = time.monotonic() - begun

    def expect(self, result, code, *parts):
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        for part in parts:
            self.assertIn(part, result.stdout + result.stderr)

    def expect_whole(self, folder, whole=None):
        self.assertEqual(differences(folder, whole or self.whole), [])
        self.assertEqual(sorted(path.name for path in folder.parent.glob(folder.name + ".*")), [])

    def run_arguments(self, out, *settings):
        return ("run", self.MISSION, "--quiet", "--out", out, *overrides(*self.SETTINGS, *settings))

    def cut(self, steps, keep=None):
        """A folder as it is after a kill within the given step: `keep` bytes of its record are in the log."""
        copy = self.folder / "cut"
        for folder in self.folder.glob("cut*"):
            shutil.rmtree(folder)
        shutil.copytree(self.whole, copy)
        summary = summary_of(copy)
        summary["complete"], summary["incomplete_reason"] = False, "running in process 1, or killed"
        summary["commands_sha256"] = summary["telemetry_sha256"] = None
        summary["provenance"]["packet_log"] = None
        (copy / "summary.json").write_text(json.dumps(summary))
        for table in copy.glob("*.csv"):
            table.rename(table.with_name(table.name + ".part"))
        (copy / "report.html").unlink()
        _, at, end = next(event for event in steps_of(copy) if event[0] == steps)
        log = copy / "packets.lcmlog"
        log.write_bytes(log.read_bytes()[:at + ((end - at) // 2 if keep is None else keep)])
        return copy

    def change(self, folder, change):
        log = folder / "packets.lcmlog"
        log.write_bytes(change(log.read_bytes()))

    def expect_untouched(self, folder, code, *parts, **environment):
        """A resume is refused, and every file of the folder is what it was."""
        before = {name: (folder / name).read_bytes() for name in files_of(folder)}
        result = vbar("resume", folder, **environment)
        self.expect(result, code, *parts)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual({name: (folder / name).read_bytes() for name in files_of(folder)}, before)
        self.assertFalse(folder.with_name(folder.name + ".resuming").exists())


class Resume(Resuming):
    """Ideal navigation, 3 h."""

    def kills_in_one_flight(self, seed, kills, *settings, whole=None):
        """Killed at random instants, first the run and then its resumes, until one is left to end."""
        draw = random.Random(seed)
        folder = self.folder / f"killed{seed}"

        def command():
            if (folder / "mission.toml").exists():
                return "resume", folder, "--quiet"
            shutil.rmtree(folder, ignore_errors=True)  # killed before it began
            return self.run_arguments(folder, *settings)

        for _ in range(kills):
            if not kill_after(draw.uniform(0.0, 1.1 * self.wall_s), *command()):
                break
        if not (folder / "summary.json").exists() or not summary_of(folder)["complete"]:
            result = vbar(*command())
            if "the run is complete" not in result.stderr:  # the last kill met a complete run before its folder took its place
                self.expect(result, DONE)
        if not (folder / "report.html").exists():  # killed after the run, before its page
            self.expect(vbar("resume", folder), REFUSED, "the run is complete", "vbar report writes the page")
            self.expect(vbar("report", folder), DONE)
        self.expect_whole(folder, whole)

    def test_killed_at_random_instants(self):
        for seed in (1, 2, 3):
            with self.subTest(seed):
                self.kills_in_one_flight(seed, 4)

    def test_interrupted(self):
        folder = self.folder / "interrupted"
        run = start(*self.run_arguments(folder, *PACED))
        wait_for_flight(folder, run)
        time.sleep(1.5)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, INTERRUPTED)
        (folder / "notes.txt").write_text("of the user\n")
        resumed = start("resume", folder)
        wait_for_flight(folder.with_name("interrupted.resuming"), resumed)
        resumed.send_signal(signal.SIGTERM)
        resumed.communicate(timeout=60)
        self.assertEqual(resumed.returncode, INTERRUPTED)
        self.assertEqual(summary_of(folder)["incomplete_reason"], "interrupted")
        self.expect(vbar("resume", folder), DONE, "flying again", "identical to the log")
        self.assertEqual((folder / "notes.txt").read_text(), "of the user\n")
        (folder / "notes.txt").unlink()
        self.assertEqual(hashes(summary_of(folder)), hashes(self.summary))
        self.assertEqual((folder / "packets.lcmlog").read_bytes(), (self.whole / "packets.lcmlog").read_bytes())

    def test_a_kill_while_the_folders_change_places(self):
        """What a killed resume leaves at each of its last steps is completed by the next one."""
        folder, beside, replaced = (self.folder / f"cut{end}" for end in ("", ".resuming", ".replaced"))
        self.cut(100, 0)  # before: the longer log is that beside
        shutil.copytree(folder, beside)
        self.change(folder, lambda log: log[:len(log) // 2])
        (folder / "notes.txt").write_text("of the user\n")
        self.expect(vbar("resume", folder), DONE, "flying again: 100 steps")
        self.assertEqual((folder / "notes.txt").read_text(), "of the user\n")
        (folder / "notes.txt").unlink()
        self.expect_whole(folder)
        for old in (beside, replaced):  # after: the run that was replaced is still there
            self.cut(100, 0).rename(old)
            (old / "notes.txt").write_text("of the user\n")
            shutil.copytree(self.whole, folder)
            self.expect(vbar("resume", folder), REFUSED, "the run is complete")
            self.assertEqual((folder / "notes.txt").read_text(), "of the user\n")
            (folder / "notes.txt").unlink()
            self.expect_whole(folder)
        self.cut(100, 0).rename(replaced)  # in between, on a file system that cannot exchange two folders
        shutil.copytree(self.whole, beside)
        self.expect(vbar("resume", folder), REFUSED, "the run is complete")
        self.expect_whole(folder)

    def test_a_log_that_ends_within_a_record(self):
        for keep in (None, 0, 3, 30):
            folder = self.cut(100, keep)
            self.expect(vbar("resume", folder), DONE, "flying again: 100 steps", "identical to the log")
            self.expect_whole(folder)

    def test_a_log_damaged_at_its_end(self):
        folder = self.cut(100, 0)
        self.change(folder, lambda log: log[:-3] + bytes([log[-3] ^ 1]) + log[-2:])
        self.expect(vbar("resume", folder), DONE, "the log ends within the event at byte", "identical")
        self.expect_whole(folder)
        folder = self.cut(100, 0)
        self.change(folder, lambda log: log + bytes(4096))
        self.expect(vbar("resume", folder), DONE, "identical")
        self.expect_whole(folder)

    def test_no_log_at_all(self):
        folder = self.cut(100, 0)
        (folder / "packets.lcmlog").unlink()
        self.expect(vbar("resume", folder), DONE, "flying again: 0 steps")
        self.expect_whole(folder)

    def test_a_log_damaged_in_the_middle(self):
        draw = random.Random(18)
        for _ in range(4):
            folder = self.cut(100, 0)
            size = (folder / "packets.lcmlog").stat().st_size
            at, bit = draw.randrange(size // 4, 3 * size // 4), 1 << draw.randrange(8)
            self.change(folder, lambda log: log[:at] + bytes([log[at] ^ bit]) + log[at + 1:])
            self.assertIn(vbar("resume", folder).returncode, (THINNED, DAMAGED), f"byte {at}, bit {bit}")
        self.expect_untouched(folder, vbar("resume", folder).returncode, "packets.lcmlog: byte")
        folder = self.cut(100, 0)
        events = steps_of(folder)
        self.change(folder, lambda log: log[:events[40][1]] + log[events[44][1]:])
        self.expect_untouched(folder, THINNED, "records are missing")

    def test_a_log_of_another_run(self):
        other = self.folder / "other"
        fly(other, *SHORT, "mission.start_h=1")
        folder = self.cut(100, 0)
        shutil.copy(other / "packets.lcmlog", folder / "packets.lcmlog")
        self.expect_untouched(folder, DIFFERENT, "packets.lcmlog is not what is flown now: at 0.0000 h: ")

    def test_an_answer_that_differs_is_named_with_its_step(self):
        """A log as flight software with another opinion at step 50 had left it: with checksums that hold."""
        folder = self.cut(100, 0)
        drift = self.folder / "drift"
        fly(drift, *SHORT, 'fault=[{kind="thrust_scale",value=0.5,at_h=0.5}]')
        with open(drift / "packets.lcmlog", "rb") as log:
            (folder / "packets.lcmlog").write_bytes(log.read()[:(folder / "packets.lcmlog").stat().st_size])
        result = vbar("resume", folder)
        self.expect(result, DIFFERENT, "is not what is flown now: at ")
        hour, step = re.search(r"at ([0-9.]+) h: step (\d+), packet ", result.stderr).groups()
        self.assertGreaterEqual(float(hour), 0.5)
        self.assertAlmostEqual(float(hour), int(step) / 60.0, places=3)

    def test_another_mission_program_or_data(self):
        folder = self.cut(100, 0)
        with (folder / "mission.toml").open("a") as file:
            file.write("# changed\n")
        self.expect_untouched(folder, REFUSED, "mission.toml differs from that of the run")
        folder = self.cut(100, 0)
        (folder / "overrides.txt").write_text("mission.duration_h=2\n")
        self.expect_untouched(folder, REFUSED, "overrides.txt differs")
        for key, words in (("program_sha256", "this program"), ("data", "data file")):
            folder = self.cut(100, 0)
            summary = summary_of(folder)
            if key == "data":
                summary["provenance"]["data"][0]["sha256"] = "0" * 64
            else:
                summary["provenance"][key] = "0" * 64
            (folder / "summary.json").write_text(json.dumps(summary))
            self.expect_untouched(folder, REFUSED, words)

    def test_folders_that_cannot_be_resumed(self):
        self.expect_untouched(self.whole, REFUSED, "the run is complete, nothing is left to fly")
        with scratch() as here:
            self.expect(vbar("resume", here / "none"), REFUSED, "no such run folder")
            (here / "photo.jpg").write_text("")
            self.expect(vbar("resume", here), REFUSED, "summary.json: no such file")
            self.assertEqual(files_of(here), ["photo.jpg"])
        unlogged = self.folder / "unlogged"
        run = start(*self.run_arguments(unlogged, "record.packets=false", "clock.mode=real_time"))
        while not (unlogged / "mission.toml").exists() and run.poll() is None:
            time.sleep(0.01)
        run.kill()
        run.communicate()
        self.expect(vbar("resume", unlogged), REFUSED, "record.packets = false has no log")
        folder = self.cut(100, 0)
        beside = folder.with_name(folder.name + ".resuming")
        beside.mkdir()
        (beside / "photo.jpg").write_text("")
        self.expect(vbar("resume", folder), REFUSED, "holds something other than a run")
        self.assertEqual(files_of(beside), ["photo.jpg"])

    def test_a_run_under_way(self):
        folder = self.folder / "busy"
        run = start(*self.run_arguments(folder, "clock.mode=real_time", "clock.speed_factor=100"))
        try:
            wait_for_flight(folder, run)
            self.expect(vbar("resume", folder), REFUSED, "being written", str(run.pid))
        finally:
            run.send_signal(signal.SIGKILL)
            run.communicate()

    def test_what_a_folder_names_is_not_loaded_without_trust(self):
        folder = self.cut(100, 0)
        (folder / "overrides.txt").write_text(f"flight_computer.library={self.folder}/hostile.so\n")
        self.expect_untouched(folder, REFUSED, "hostile.so", "--trust")

    def test_a_folder_by_any_of_its_names(self):
        folder = self.cut(150)
        link = self.folder / "link"
        link.symlink_to(folder)
        result = subprocess.run([VBAR, "resume", "link/"], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.expect(result, DONE, "identical")
        link.unlink()
        self.expect_whole(folder)


class ResumeExperiment3(Resuming):
    """Carrier phase, half an hour of which the flight software navigates by it."""

    MISSION, SETTINGS = EXPERIMENT3, EXPERIMENT3_SHORT
    kills_in_one_flight = Resume.kills_in_one_flight

    def test_killed_at_random_instants(self):
        self.kills_in_one_flight(31, 4)


class ResumeElsewhere(Resuming):
    """A flight computer in another process is started again, and flown to where it was."""

    SETTINGS = ("mission.duration_h=1", "flight_computer.target=host_process")
    kills_in_one_flight = Resume.kills_in_one_flight

    def test_serial_and_udp(self):
        for seed, link in ((41, "serial"), (42, "udp")):
            with self.subTest(link):
                setting = f"flight_computer.link={link}"
                whole = self.folder / link
                fly(whole, *self.SETTINGS, setting)
                self.kills_in_one_flight(seed, 2, setting, whole=whole)


class ResumeOnTheZynq(ResumeElsewhere):
    """The emulated Zynq is started again; what it answers to the recorded packets is compared with the log."""

    SETTINGS = ("mission.duration_h=1", "flight_computer.target=zynq_qemu")

    @classmethod
    def setUpClass(cls):
        if missing(ZYNQ_IMAGE):
            raise unittest.SkipTest(missing(ZYNQ_IMAGE))
        super().setUpClass()


class Branch(Resuming):
    """A branch is flown from a run's start as the run was, and from its own time on otherwise."""

    AT = 1.5

    def branch(self, *settings, at=AT):
        out = self.folder / "branch"
        shutil.rmtree(out, ignore_errors=True)
        return out, vbar("resume", self.whole, "--at", at, "--out", out, *overrides(*settings))

    def expect_refused(self, code, *parts, settings, at=AT):
        out, result = self.branch(*settings, at=at)
        self.expect(result, code, *parts)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertFalse(out.exists())

    def first_step_that_differs(self, out):
        log, other = ((folder / "packets.lcmlog").read_bytes() for folder in (self.whole, out))
        return next(step for step, at, end in steps_of(out) if log[at:end] != other[at:end])

    def test_a_fault_after_its_time(self):
        fault = f'fault=[{{kind="thrust_scale",value=0.5,at_h={self.AT}}}]'
        out, result = self.branch(fault)
        self.expect(result, DONE)
        with_fault = fly(self.folder / "with_fault", *SHORT, fault)
        self.assertEqual(hashes(summary_of(out)), hashes(with_fault))
        self.assertNotEqual(hashes(with_fault), hashes(self.summary))
        self.assertEqual((out / "branch.txt").read_text(), f"at_h = {self.AT}\noverrides = 1\n")
        self.assertEqual(summary_of(out)["provenance"]["overrides"], [*SHORT, fault])
        self.assertTrue(summary_of(self.whole)["complete"])
        self.expect_refused(DIFFERENT, "is not what is flown now", "has an effect before 2.5 h", settings=(fault,), at=2.5)

    def test_a_waypoint_is_commanded_at_its_time(self):
        out, result = self.branch("waypoint.1.time_h=5")
        self.expect(result, DONE)
        self.assertEqual(self.first_step_that_differs(out), 60 * self.AT)
        self.assertEqual(len((out / "telemetry_telecommand.csv").read_text().splitlines()),
                         len((self.whole / "telemetry_telecommand.csv").read_text().splitlines()) + 1)

    def test_a_longer_run(self):
        out, result = self.branch("mission.duration_h=4", at=2.9)
        self.expect(result, DONE)
        longer = fly(self.folder / "longer", "mission.duration_h=4")
        self.assertEqual(hashes(summary_of(out)), hashes(longer))

    def test_a_branch_that_was_killed(self):
        setting = "waypoint.1.time_h=5"
        out, result = self.branch(setting)
        self.expect(result, DONE)
        killed = self.folder / "killed"
        run = start("resume", self.whole, "--at", self.AT, "--out", killed, *overrides(setting, *PACED))
        wait_for_flight(killed, run)
        run.send_signal(signal.SIGKILL)
        run.communicate()
        self.expect(vbar("resume", killed), DONE, "identical")
        self.assertEqual(hashes(summary_of(killed)), hashes(summary_of(out)))

    def test_what_cannot_change_in_flight(self):
        self.expect_refused(REFUSED, "orbit", settings=("spacecraft.servicer.orbit.nonsense=1",))
        self.expect_refused(DIFFERENT, "h: step 0, packet", "--set mission.start_h=1", settings=("mission.start_h=1",))
        self.expect_refused(REFUSED, "the log of the run holds 0.0000 to 3.0000 h", settings=("mission.seed=2",), at=3.5)
        self.expect(vbar("resume", self.whole, "--at", "1"), REFUSED, "--set")
        self.expect(vbar("resume", self.whole, "--set", "mission.seed=2"), REFUSED, "--at")


if __name__ == "__main__":
    main()
