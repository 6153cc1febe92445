#!/usr/bin/env python3
"""What a run leaves as evidence: verdicts of a replay on damaged records, locked and kept folders, full disks, provenance, exit codes."""
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import time
import unittest

from vbar_program import BINARY, MISSION, SOURCE, VBAR, fly, main, missing, overrides, scratch, start, summary_of, vbar

SHORT = "mission.duration_h=1"
PACED = ("clock.mode=real_time", "clock.speed_factor=1000")

DONE, FAILED, REFUSED, DIFFERENT, KILLED, EMPTY, CUT, THINNED, FOREIGN, DAMAGED = range(10)
NEVER_NAVIGATED, INTERRUPTED = 10, 75


def events_of(log):
    """The events of an LCM log, by its format: 28 bytes of header, channel, data."""
    events, at = [], 0
    while at < len(log):
        channel, data = struct.unpack_from(">II", log, at + 20)
        end = at + 28 + channel + data
        events.append(log[at:end])
        at = end
    return events


class Evidence(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.flown = cls.folder / "flown"
        cls.summary = fly(cls.flown, SHORT)

    def expect(self, result, code, *parts):
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        for part in parts:
            self.assertIn(part, result.stdout + result.stderr)


class ReplayVerdicts(Evidence):
    """Each damage of a record has its own sentence and exit code; none is taken for a record that was reproduced."""

    def damaged(self, change):
        """A copy of the run whose log is `change` of the log."""
        copy = self.folder / "copy"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(self.flown, copy)
        log = copy / "packets.lcmlog"
        log.write_bytes(change(log.read_bytes()))
        return copy

    def test_a_whole_record(self):
        self.expect(vbar("replay", self.flown), DONE, "identical: 61 steps", "packets", "bytes", "SHA-256",
                    self.summary["telemetry_sha256"][:16])

    def test_an_empty_log(self):
        self.expect(vbar("replay", self.damaged(lambda log: b"")), EMPTY, "the log is empty", "61 steps")

    def test_a_log_cut_at_its_end(self):
        for size in (0.5, 0.99):
            with self.subTest(size):
                self.expect(vbar("replay", self.damaged(lambda log: log[:int(size * len(log))])), CUT, "cut at its end")
        self.expect(vbar("replay", self.damaged(lambda log: log[:-1])), CUT)
        self.expect(vbar("replay", self.damaged(lambda log: b"".join(events_of(log)[:-1]))), CUT)

    def test_a_thinned_log(self):
        def without(first, last):
            return lambda log: b"".join(events_of(log)[:first] + events_of(log)[last:])

        self.expect(vbar("replay", self.damaged(without(100, 101))), THINNED, "records are missing", "event 101")
        self.expect(vbar("replay", self.damaged(without(0, 3))), THINNED, "records are missing")

    def test_a_thinned_log_with_new_numbers(self):
        def thin(log):
            kept = [event for k, event in enumerate(events_of(log)) if not 100 <= k < 140]
            return b"".join(event[:4] + struct.pack(">q", k) + event[12:] for k, event in enumerate(kept))

        self.expect(vbar("replay", self.damaged(thin)), THINNED, "of step")

    def test_a_log_of_other_outputs(self):
        other = self.folder / "other"
        fly(other, SHORT, "mission.start_h=1")
        log = (other / "packets.lcmlog").read_bytes()
        self.expect(vbar("replay", self.damaged(lambda _: log)), FOREIGN, "other outputs")

    def test_any_changed_byte_is_found(self):
        size = (self.flown / "packets.lcmlog").stat().st_size
        codes = set()
        for at in range(5, size, size // 40):
            def flip(log, at=at):
                return log[:at] + bytes([log[at] ^ 0x10]) + log[at + 1:]

            result = vbar("replay", self.damaged(flip))
            self.assertIn(result.returncode, (DIFFERENT, CUT, THINNED, FOREIGN, DAMAGED), f"byte {at}: {result.stdout}")
            self.assertEqual((result.stdout + result.stderr).count("\n"), 1, result.stdout + result.stderr)
            codes.add(result.returncode)
        self.assertIn(DAMAGED, codes)

    def test_sizes_that_cannot_be(self):
        for place in (20, 24):
            for value in (0x7FFFFFFF, 0xFFFFFFFF, 0x01000000):
                def claim(log, place=place, value=value):
                    return log[:place] + struct.pack(">I", value) + log[place + 4:]

                self.expect(vbar("replay", self.damaged(claim)), DAMAGED, "packets.lcmlog: byte 0:")
        self.expect(vbar("replay", self.damaged(lambda log: b"\x7fELF" + log)), DAMAGED, "byte 0: not an LCM log")

    def test_a_killed_run(self):
        folder = self.folder / "killed"
        run = start("run", MISSION, "--out", folder, *overrides(*PACED))
        time.sleep(3)
        run.kill()
        run.communicate()
        self.assertIn("killed", summary_of(folder)["incomplete_reason"])
        self.expect(vbar("replay", folder), KILLED, "was killed", "identical")

    def test_overrides_without_effect_are_refused(self):
        for setting in ("mission.seed=7", "guidance.mode=hold", "truth.drag=true"):
            self.expect(vbar("replay", self.flown, "--set", setting), REFUSED, setting, "no effect on a replay")
        self.expect(vbar("replay", self.flown, "--set", "flight_computer.compute_latency_s=1"), DONE)
        self.expect(vbar("replay", self.flown, "--set", "spacecraft.servicer.flight_computer.target=in_process"), DONE)

    def test_what_a_folder_names_is_not_loaded_without_trust(self):
        hostile = self.damaged(lambda log: log)
        library = self.folder / "hostile.so"
        (hostile / "overrides.txt").write_text(f"mission.duration_h=1\nflight_computer.library={library}\n")
        self.expect(vbar("replay", hostile), REFUSED, str(library), "--trust")
        self.expect(vbar("replay", hostile, "--trust"), FAILED, "cannot be loaded")
        self.expect(vbar("replay", hostile, "--set", f"flight_computer.library={library}"), FAILED, "cannot be loaded")
        (hostile / "overrides.txt").write_text("flight_computer.target=board\nflight_computer.device=/dev/ttyS99\n")
        self.expect(vbar("replay", hostile), REFUSED, "/dev/ttyS99", "--trust")
        (hostile / "overrides.txt").write_text("flight_computer.target=board\nflight_computer.link=udp\n"
                                               "flight_computer.address=192.0.2.1\nflight_computer.port=4000\n")
        self.expect(vbar("replay", hostile), REFUSED, "192.0.2.1", "--trust")


class RunsAreKept(Evidence):
    """No run is overwritten silently, and one folder has one writer."""

    def test_an_existing_run_is_replaced_only_by_force(self):
        before = (self.flown / "summary.json").read_bytes()
        self.expect(vbar("run", MISSION, "--out", self.flown), REFUSED, "holds a run", "--force")
        self.assertEqual((self.flown / "summary.json").read_bytes(), before)
        self.expect(vbar("run", MISSION, "--out", self.flown, "--set", SHORT, "--force"), DONE)

    def test_default_folders_are_numbered(self):
        with scratch() as here:
            for name in ("ideal_navigation-1", "ideal_navigation-1.2", "ideal_navigation-1.3"):
                result = subprocess.run([VBAR, "run", MISSION, "--set", "mission.duration_h=0.1"], cwd=here,
                                        capture_output=True, text=True, timeout=60)
                self.expect(result, DONE, f"runs/{name}/report.html")

    def test_one_writer_at_a_time(self):
        folder = self.folder / "busy"
        run = start("run", MISSION, "--out", folder, *overrides(*PACED))
        try:
            time.sleep(1.5)
            self.expect(vbar("run", MISSION, "--out", folder, "--force"), REFUSED, "being written", str(run.pid))
        finally:
            run.send_signal(signal.SIGINT)
            run.communicate(timeout=60)
        self.assertEqual(run.returncode, INTERRUPTED)
        self.assertFalse((folder / "run.lock").exists())

    def test_signals_leave_a_record_that_says_so(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            folder = self.folder / f"signal{number}"
            run = start("run", MISSION, "--out", folder, *overrides(*PACED))
            time.sleep(1.5)
            run.send_signal(number)
            run.communicate(timeout=60)
            self.assertEqual(run.returncode, INTERRUPTED)
            self.assertEqual(summary_of(folder)["incomplete_reason"], "interrupted")
            self.expect(vbar("replay", folder), DONE, "the run itself is incomplete: interrupted")

    def test_a_full_disk(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", disk], capture_output=True).returncode:
            self.skipTest("mounting a small disk is not permitted")
        try:
            result = vbar("run", MISSION, "--out", disk / "run")
            self.expect(result, FAILED, "No space left on device")
            self.assertEqual(result.stderr.count("vbar:"), 1, result.stderr)
            summary = summary_of(disk / "run")
            self.assertFalse(summary["complete"])
            self.assertIn("No space left on device", summary["incomplete_reason"])
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_a_full_disk_loses_nothing(self):
        """Disks that fill during the flight: the summary is whole, and once there is space a resume continues to the record of a
        flight that was not disturbed."""
        settings = overrides("mission.duration_h=0.3")
        mission = SOURCE / "missions" / "experiment3.toml"
        undisturbed = fly(self.folder / "undisturbed", "mission.duration_h=0.3", mission=mission)
        disk = self.folder / "small"
        disk.mkdir()
        for size in (600, 1200):
            if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", disk], capture_output=True).returncode:
                self.skipTest("mounting a small disk is not permitted")
            try:
                self.expect(vbar("run", mission, "--out", disk / "run", *settings), FAILED, "No space left on device")
                summary = summary_of(disk / "run")
                self.assertFalse(summary["complete"])
                self.assertIn("No space left on device", summary["incomplete_reason"])
                subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
                self.expect(vbar("resume", disk / "run"), DONE)
                summary = summary_of(disk / "run")
                self.assertTrue(summary["complete"])
                self.assertEqual(summary["telemetry_sha256"], undisturbed["telemetry_sha256"])
                self.assertEqual((disk / "run/estimate.csv").read_bytes(), (self.folder / "undisturbed/estimate.csv").read_bytes())
                self.expect(vbar("replay", disk / "run"), DONE)
            finally:
                subprocess.run(["umount", disk], check=True)

    def test_a_limit_on_the_size_of_files_is_an_error_like_a_full_disk(self):
        folder = self.folder / "limited"
        command = f"ulimit -f 200; exec {VBAR} run {MISSION} --out {folder}"  # blocks of 512 bytes
        result = subprocess.run(["sh", "-c", command], capture_output=True, text=True, timeout=300)
        self.expect(result, FAILED, "File too large")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        summary = summary_of(folder)
        self.assertFalse(summary["complete"])
        self.assertIn("File too large", summary["incomplete_reason"])
        self.expect(vbar("resume", folder), DONE)
        self.assertTrue(summary_of(folder)["complete"])

    def test_output_that_cannot_be_written_is_not_that_of_the_run(self):
        for name, setting in (("closed", "<&- >&- 2>&-"), ("out", ">&-"), ("full", ">/dev/full 2>&1")):
            run = self.folder / f"output_{name}"
            command = f"exec {VBAR} run {MISSION} --set {SHORT} --out {run} {setting}"
            self.assertEqual(subprocess.run(["sh", "-c", command]).returncode, DONE, name)
            self.assertTrue(summary_of(run)["complete"], name)
            self.assertEqual((run / "packets.lcmlog").read_bytes(), (self.flown / "packets.lcmlog").read_bytes(), name)

    def test_what_is_a_link_in_a_run_folder_is_replaced(self):
        victim = self.folder / "victim"
        victim.write_text("content")
        copy = self.folder / "linked"
        shutil.copytree(self.flown, copy)
        for name in ("run.lock", "summary.json.new", "packets.lcmlog", "truth.csv", "truth.csv.part", "report.html", "view.html"):
            (copy / name).unlink(missing_ok=True)
            (copy / name).symlink_to("../victim")
        self.expect(vbar("run", MISSION, "--force", "--out", copy, *overrides(SHORT)), DONE)
        self.assertEqual(victim.read_text(), "content")
        self.assertFalse((copy / "truth.csv").is_symlink())
        self.expect(vbar("replay", copy), DONE)

    def test_a_full_standard_output(self):
        with open("/dev/full", "w") as full:
            result = subprocess.run([VBAR, "missions", SOURCE / "missions"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, FAILED)
        self.assertIn("No space left on device", result.stderr)


class Provenance(Evidence):
    """summary.json says what flew; a replay says what has changed since; changed data do not fly unnoticed."""

    def test_what_flew(self):
        provenance = self.summary["provenance"]
        self.assertEqual(provenance["program_sha256"], hashlib.sha256(VBAR.read_bytes()).hexdigest())
        self.assertEqual(provenance["mission_sha256"],
                         hashlib.sha256((self.flown / "mission.toml").read_bytes()).hexdigest())
        self.assertEqual(provenance["overrides"], [SHORT])
        self.assertEqual(provenance["epoch_utc"], "2011-07-18T01:00:00.000Z")
        self.assertEqual(provenance["host"], os.uname().nodename)
        for key in ("vbar_version", "commit", "compiler", "build_type", "started_utc"):
            self.assertTrue(provenance[key], key)
        log = (self.flown / "packets.lcmlog").read_bytes()
        self.assertEqual(provenance["packet_log"]["sha256"], hashlib.sha256(log).hexdigest())
        self.assertIn("gravity/ggm05s_120.txt", [file["file"] for file in provenance["data"]])
        for file in provenance["data"]:
            contents = (SOURCE / "data" / file["file"]).read_bytes()
            self.assertEqual((file["bytes"], file["sha256"]), (len(contents), hashlib.sha256(contents).hexdigest()))

    def test_a_library_is_named(self):
        library = BINARY / "libvbar_example_article.so"
        if missing(library):
            self.skipTest(missing(library))
        summary = fly(self.folder / "library", SHORT, f"flight_computer.library={library}")
        self.assertEqual(summary["provenance"]["flight_software"]["sha256"],
                         hashlib.sha256(library.read_bytes()).hexdigest())

    def with_data(self, change, *arguments):
        """Runs vbar with a copy of the data in which `change` was made."""
        data = self.folder / "data"
        shutil.rmtree(data, ignore_errors=True)
        shutil.copytree(SOURCE / "data", data)
        change(data)
        return subprocess.run([VBAR, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                              env={**os.environ, "VBAR_DATA": str(data)})

    def test_truncated_and_changed_data_are_refused(self):
        file = pathlib.Path("gravity") / "ggm05s_120.txt"

        def cut(data):
            lines = (data / file).read_text().splitlines(keepends=True)
            (data / file).write_text("".join(lines[:int(0.98 * len(lines))]))

        def edit(data):
            text = (data / file).read_text()
            (data / file).write_text(re.sub(r"(?m)^(2 0 -4\.8)", r"2 0 -4.9", text))

        for change in (cut, edit):
            with self.subTest(change.__name__):
                self.refuse_data(change, file)

    def refuse_data(self, change, file):
        result = self.with_data(change, "run", MISSION, "--out", self.folder / "run", "--set", SHORT, "--force")
        self.expect(result, REFUSED, str(file))
        self.assertFalse((self.folder / "run").exists())

    def test_a_replay_says_what_has_changed(self):
        def edit(data):
            with (data / "gravity" / "ggm05s_120.txt").open("a") as file:
                file.write("# changed\n")

        result = self.with_data(edit, "replay", self.flown)
        self.expect(result, DONE, "note: data file gravity/ggm05s_120.txt differs", "identical")
        copy = self.folder / "copy"
        shutil.copytree(self.flown, copy)
        with (copy / "mission.toml").open("a") as file:
            file.write("# changed\n")
        self.expect(vbar("replay", copy), DONE, "note:", "mission.toml differs")


class FaultyLibrary(Evidence):
    """Foreign flight software that crashes or hangs ends the run with one sentence, and its record says so."""

    LIBRARY = BINARY / "tests" / "unit" / "pil_bridge" / "libvbar_article_with_faults.so"

    def settings(self, fault):
        """`fault`: as numbered in article_with_faults.c."""
        if missing(self.LIBRARY):
            self.skipTest(missing(self.LIBRARY))
        return overrides(f"flight_computer.library={self.LIBRARY}", f"spacecraft.servicer.number={fault}",
                         "spacecraft.target.number=9")

    def test_a_crash(self):
        folder = self.folder / "crash"
        result = vbar("run", MISSION, "--out", folder, *self.settings(1))
        self.expect(result, FAILED, "crashed at step 0: Segmentation fault")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn("crashed at step 0", summary_of(folder)["incomplete_reason"])

    def test_a_hang_ends_a_second_after_ctrl_c(self):
        folder = self.folder / "hang"
        run = start("run", MISSION, "--out", folder, *self.settings(2))
        time.sleep(2)
        run.send_signal(signal.SIGINT)
        _, errors = run.communicate(timeout=10)
        self.assertEqual(run.returncode, FAILED)
        self.assertIn("did not return at step 0", errors)
        self.assertIn("did not return at step 0", summary_of(folder)["incomplete_reason"])


class CommandLine(Evidence):
    """What a user types."""

    def test_set_does_not_take_the_mission(self):
        result = vbar("run", "--out", self.folder / "a", "--set", "mission.duration_h=0.1", "--set", "mission.seed=3",
                      MISSION)
        self.expect(result, DONE)
        self.assertEqual(summary_of(self.folder / "a")["seed"], 3)

    def test_missions_go_by_name_from_anywhere(self):
        with scratch() as here:
            def run(*arguments):
                return subprocess.run([VBAR, *arguments], cwd=here, capture_output=True, text=True, timeout=120)

            self.expect(run("missions"), DONE, "experiment3")
            self.expect(run("run", "ideal_navigation", "--set", "mission.duration_h=0.1"), DONE)
            self.expect(run("run", "experiment33"), REFUSED, "did you mean experiment3?")
            self.expect(run("run", "missions/experiment33.toml"), REFUSED, "did you mean experiment3?")

    def test_bad_usage(self):
        self.expect(vbar("runn"), REFUSED, "did you mean run?")
        self.expect(vbar(), REFUSED)
        self.expect(vbar("run"), REFUSED, "mission")
        self.expect(vbar("run", MISSION, "--seed", "-1"), REFUSED, "--seed: found -1; accepted: an integer from 0 to 9223372036854775807")
        self.expect(vbar("campaign", "run", MISSION, "--jobs", "0"), REFUSED, "--jobs: found 0; accepted: an integer from 1 to")
        self.expect(vbar("resume", "x", "--set", "a=b", "--at", "-1"), REFUSED, "--at: found -1; accepted: a number from 0")
        self.expect(vbar("run", MISSION, "--sed", "3"), REFUSED, "vbar run: there is no option --sed (did you mean --seed?)")
        self.expect(vbar("campaign", "run", MISSION, "--job=3"), REFUSED, "vbar campaign run: there is no option --job (did you mean --jobs?)")
        self.expect(vbar("keys", "a", "b"), REFUSED, 'vbar keys: unexpected argument "b"')

    def test_help_is_a_command_too(self):
        self.assertEqual(vbar("help").stdout, vbar("--help").stdout)
        self.assertEqual(vbar("help", "campaign", "run").stdout, vbar("campaign", "run", "--help").stdout)

    def test_a_mission_by_its_name(self):
        line = vbar("missions", "experiment3").stdout
        self.assertIn(line.split("  ")[-1], vbar("missions").stdout)
        self.assertEqual(line.count("\n"), 1)
        self.expect(vbar("missions", "experimnt3"), REFUSED, "did you mean experiment3?")

    def test_version_and_help(self):
        self.expect(vbar("--version"), DONE, "vbar 0.3.0", "commit")
        self.expect(vbar("--help"), DONE, "75 interrupted", "log cut", "vbar_NAME")

    def test_another_word_runs_the_program_of_that_name(self):
        """As git does: with its arguments, and with its exit code."""
        self.expect(vbar("tron", "--help"), DONE, "plan")
        self.expect(vbar("tron", "plan", "no_such_mission", "bench.toml"), REFUSED, "vbar tron", "no_such_mission")
        self.expect(vbar("../vbar_tron", "--help"), REFUSED, "there is no command")
        with scratch() as here:
            self.expect(vbar("tron", "plan", MISSION, here / "none.toml"), REFUSED, "none.toml")
            self.expect(vbar("tron", "plan", MISSION, SOURCE / "data/benches/tron.toml"), REFUSED, "no camera that navigates")

    def test_check_flies_nothing(self):
        with scratch() as here:
            self.expect(vbar("run", MISSION, "--check", "--out", here / "run"), DONE, "can be flown")
            self.expect(vbar("run", MISSION, "--check", "--set", "mission.duration_h=-1"), REFUSED, "duration_h")
            self.assertFalse((here / "run").exists())

    def test_check_states_what_data_are_missing(self):
        later = vbar("run", "full_force_navigation", "--check", "--set", "mission.epoch_utc=2026-12-01T00:00:00Z")
        self.expect(later, DONE, "data: ", "can be flown")
        self.assertNotIn("data: ", vbar("run", "full_force_navigation", "--check").stdout)

    def test_quiet_prints_nothing(self):
        result = vbar("run", MISSION, "--quiet", "--out", self.folder / "quiet", "--set", SHORT)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (DONE, "", ""))
        result = vbar("replay", self.folder / "quiet", "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (DONE, "", ""))

    def test_a_run_that_never_navigated(self):
        """Angles-only navigation needs more images than there are in 0.2 h; the flight software reports it after 300 s."""
        out = self.folder / "lost"
        short = ("mission.duration_h=0.2", "guidance.navigation_timeout_s=300")
        result = vbar("run", SOURCE / "missions/experiment1.toml", "--quiet", "--out", out, *overrides(*short))
        self.expect(result, NEVER_NAVIGATED, "never navigated")
        summary = summary_of(out)
        self.assertTrue(summary["complete"] and summary["never_navigated"])
        self.assertIn("never_navigated", summary["health"]["faults"])
        self.assertFalse(self.summary["never_navigated"])

    def test_reports_that_differ(self):
        other = self.folder / "seed2"
        fly(other, SHORT, "mission.start_h=1")
        out = self.folder / "comparison.html"
        self.expect(vbar("report", self.flown, other, "--out", out), DONE)
        self.expect(vbar("report", self.flown, other, "--out", out, "--fail-if-different"), DIFFERENT)
        self.expect(vbar("report", self.flown, self.flown, "--out", out, "--fail-if-different"), DONE)

    def test_propagation_counts_from_the_start_of_the_span(self):
        """The hours from the epoch to the start are not part of what is reported."""
        for start_h in (0, 24):
            folder = self.folder / f"start{start_h}"
            result = vbar("propagate", MISSION, "--out", folder, "--set", SHORT, "--set", f"mission.start_h={start_h}")
            self.expect(result, DONE)
            steps = [one["steps"] for one in json.loads((folder / "propagation.json").read_text())["spacecraft"]]
            self.assertLess(max(steps), 200)


if __name__ == "__main__":
    main()
