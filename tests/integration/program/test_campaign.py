#!/usr/bin/env python3
"""Campaigns: the same results however they were flown, one result for each case whatever was killed, nothing flown of a campaign with
a wrong case."""
import csv
import errno
import hashlib
import json
import os
import random
import re
import shutil
import signal
import statistics
import subprocess
import time
import unittest
import zlib

import slurm_cluster
from vbar_program import SOURCE, VBAR, children_of, is_running, main, scratch, start, vbar

WALL_CLOCK = ("wall_s", "cpu_s", "host", "processor", "attempts")
LOSS = "links.crosslink.loss_probability"
CAMPAIGN = """[campaign]
name = "short"
mission = "{mission}"
seeds = "{seeds}"
set = ["mission.duration_h={hours}"]
{general}
[[sweep]]
key = "{loss}"
values = {values}
[[disperse]]
key = "spacecraft.servicer.mass_kg"
distribution = "normal"
mean = 154.0
sigma = 2.0
{rest}
"""


def campaign_file(folder, name="campaign.toml", seeds="1..10", values="[0.0, 0.2]", hours=0.05, general="", rest=""):
    file = folder / name
    file.write_text(CAMPAIGN.format(mission=SOURCE / "missions/experiment3.toml", seeds=seeds, values=values, hours=hours,
                                    general=general, rest=rest, loss=LOSS))
    return file


def rows_of(folder):
    with (folder / "results.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def comparable(folder, leave_out=()):
    """Rows without what the wall clock and the computer put there."""
    return [{key: value for key, value in row.items() if key not in (*WALL_CLOCK, *leave_out)} for row in rows_of(folder)]


def by_case(rows, columns=("seed", LOSS)):
    return {tuple(row[column] for column in columns): row for row in rows}


def run(*arguments, expect=0, **keywords):
    result = vbar("campaign", "run", *arguments, "--quiet", **keywords)
    if result.returncode != expect:
        raise AssertionError(f"exit code {result.returncode}: {result.stdout}{result.stderr}")
    return result


class Campaign(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.reference = cls.folder / "reference"
        cls.file = campaign_file(cls.folder, general="samples_h = [39.02, 39.05]")
        run(cls.file, "--out", cls.reference, "--jobs", 1)
        cls.rows = comparable(cls.reference)

    def test_every_case_has_its_row(self):
        self.assertEqual([int(row["case"]) for row in self.rows], list(range(20)))
        self.assertEqual({row["state"] for row in self.rows}, {"complete"})
        self.assertEqual({row["passed"] for row in self.rows}, {"1"})
        self.assertEqual({row["verdict"] for row in self.rows}, {"not judged"})
        self.assertIn("verdicts: 20 not judged", vbar("campaign", "status", self.reference).stdout)
        self.assertEqual(len({row["telemetry_sha256"] for row in self.rows}), 20)
        self.assertGreater(float(self.rows[0]["samples.39.05h.sigma_m"]), 0.0)

    def test_workers_and_order_change_nothing(self):
        run(self.file, "--out", self.folder / "two", "--jobs", 2)
        self.assertEqual(comparable(self.folder / "two"), self.rows)
        shares = self.folder / "shares"
        run(self.file, "--out", shares, "--jobs", 1, "--cases", "7-9,3", expect=75)
        workers = [start("campaign", "worker", shares, k, 2) for k in (1, 0)]
        for worker in workers:
            self.assertEqual(worker.wait(timeout=300), 0, worker.communicate())
        run(shares)
        self.assertEqual(comparable(shares), self.rows)

    def test_command_engine(self):
        folder = self.folder / "command"
        run(self.file, "--out", folder, "--engine", "command", "--workers", 2, "--submit", "{worker} >/dev/null 2>&1 &")
        self.assertEqual(comparable(folder), self.rows)
        self.assertEqual(len(list((folder / "results").glob("*.jsonl"))), 2)

    def test_cases_keep_their_outputs_when_others_are_added(self):
        more = """[[disperse]]
key = "spacecraft.target.mass_sigma_kg"
distribution = "uniform"
low = 0.04
high = 0.0400001
"""
        added = campaign_file(self.folder, "added.toml", seeds="1..11", values="[0.1, 0.0, 0.2]", general="samples_h = [39.02, 39.05]")
        run(added, "--out", self.folder / "added", "--cases", "0-11", expect=75)
        again = by_case(row for row in comparable(self.folder / "added") if row["state"] == "complete")
        checked = 0
        for key, row in by_case(self.rows).items():
            if key in again:
                self.assertEqual(again[key]["telemetry_sha256"], row["telemetry_sha256"])
                checked += 1
        self.assertGreaterEqual(checked, 6)
        dispersed = campaign_file(self.folder, "dispersed.toml", rest=more)
        run(dispersed, "--out", self.folder / "dispersed", "--cases", "0", expect=75)
        self.assertEqual(rows_of(self.folder / "dispersed")[5]["spacecraft.servicer.mass_kg"], self.rows[5]["spacecraft.servicer.mass_kg"])

    def test_rerun_proves_the_same_bits(self):
        result = vbar("campaign", "rerun", self.reference, 13)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("same bits", result.stdout)
        self.assertTrue((self.reference / "runs/000013/packets.lcmlog").exists())
        self.assertTrue((self.reference / "runs/000013/report.html").exists())
        self.assertEqual(vbar("campaign", "rerun", self.reference, 20).returncode, 2)

    def test_rerun_reports_a_wrong_hash(self):
        folder = self.folder / "wrong"
        run(self.file, "--out", folder, "--cases", "4", expect=75)
        (results,) = (folder / "results").glob("*.jsonl")
        names, result = results.read_text().splitlines(True)
        line = json.loads(result)
        del line["crc32"]
        line["commands_sha256"] = "0" * 64
        text = json.dumps(line, separators=(",", ":"))
        results.write_text(names + text[:-1] + ',"crc32":"%08x"}\n' % zlib.crc32(text.encode()))
        result = vbar("campaign", "rerun", folder, 4)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("commands", result.stdout)

    def test_failures_are_rows_and_stay_so(self):
        folder = self.folder / "limits"
        general = 'keep = "failed"\nsamples_h = [39.02, 39.05]'
        limits = '[[pass]]\nkey = "samples.39.05h.sigma_m"\nmost = 0.0\n[require]\npass_rate_at_least = 0.5\n'
        file = campaign_file(self.folder, "limits.toml", seeds="1..1", general=general, rest=limits)
        result = vbar("campaign", "run", file, "--out", folder)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("requirement not met: 0 of 2", result.stdout)
        for row in rows_of(folder):
            self.assertEqual((row["state"], row["passed"], row["failed_limits"]), ("complete", "0", "samples.39.05h.sigma_m"))
            self.assertTrue((folder / row["folder"] / "truth.csv").exists())
        before = list((folder / "results").iterdir())
        run(folder, expect=1)
        self.assertEqual(list((folder / "results").iterdir()), before)

    def test_a_mission_that_is_not_achieved_is_a_result(self):
        """Its case is complete; the criteria of the campaign decide whether it passes."""
        folder = self.folder / "unsafe"
        general = '[[sweep]]\nkey = "guidance.keep_out_radius_m"\nvalues = [0.5, 20.0]\n'
        run(campaign_file(self.folder, "unsafe.toml", seeds="1..1", values="[0.0]", rest=general), "--out", folder)
        self.assertEqual([(row["state"], row["passed"], row["verdict"]) for row in rows_of(folder)],
                         [("complete", "1", "not judged"), ("complete", "1", "unsafe")])
        page = vbar("campaign", "report", folder)
        self.assertEqual(page.returncode, 0, page.stderr)
        self.assertIn('<span class="bad">1 unsafe</span>', (folder / "campaign.html").read_text())

    def test_over_time(self):
        file = campaign_file(self.folder, "slow.toml", seeds="1..1", values="[0.0]", hours=2.25, general="case_time_limit_s = 0.2")
        run(file, "--out", self.folder / "slow")
        (row,) = rows_of(self.folder / "slow")
        self.assertEqual((row["state"], row["passed"]), ("over_time", ""))
        self.assertIn("0.2 s", row["reason"])


class CampaignRefusals(unittest.TestCase):
    def refused(self, folder, *parts, **keywords):
        file = campaign_file(folder, **keywords)
        result = vbar("campaign", "run", file, "--out", folder / "out")
        self.assertEqual(result.returncode, 2, result.stderr)
        for part in parts:
            self.assertIn(part, result.stderr)
        self.assertFalse((folder / "out").exists())

    def test_nothing_flies_of_a_campaign_with_a_wrong_case(self):
        with scratch() as folder:
            self.refused(folder, "case 0 ", "links.crosslink.los", "loss_probability",
                         rest='[[sweep]]\nkey = "links.crosslink.los"\nvalues = [0.1]\n')
            self.refused(folder, "case 1 (seed 1", LOSS, "from 0 to 1", values="[0.1, 1.5]")
            self.refused(folder, "pass", "most", rest='[[pass]]\nkey = "dv_mps"\n')

    def test_changed_copies_are_noticed(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..2")
            run(file, "--out", folder / "out", "--cases", "0", expect=75)
            data = next((folder / "out/bin/data/earth").glob("*.csv"))
            data.write_bytes(data.read_bytes() + b"\n")
            result = vbar("campaign", "run", folder / "out")
            self.assertEqual(result.returncode, 1)
            self.assertIn(data.name, result.stderr)

    def test_links_are_refused(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..2", values="[0.0]")
            run(file, "--out", folder / "out", "--cases", "0", expect=75)
            victim = folder / "victim"
            (victim / "sub").mkdir(parents=True)
            (victim / "sub/file").write_text("content")
            for inner in ("flying", "runs", "results", "bin"):
                with self.subTest(inner):
                    own = folder / "out" / inner
                    if own.exists():
                        own.rename(folder / "moved")
                    own.symlink_to("../victim")
                    for command in (("run", folder / "out"), ("rerun", folder / "out", 0), ("report", folder / "out")):
                        result = vbar("campaign", *command)
                        self.assertEqual(result.returncode, 2, result.stderr)
                        self.assertIn(f"{own}: is a symbolic link", result.stderr)
                    own.unlink()
                    if (folder / "moved").exists():
                        (folder / "moved").rename(own)
            (folder / "out/run.lock").symlink_to("../victim/sub/file")
            run(folder / "out")
            self.assertEqual((victim / "sub/file").read_text(), "content")

    def test_changed_cases_are_noticed(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..2", values="[0.0]")
            run(file, "--out", folder / "out", "--cases", "0", expect=75)
            table, plan = folder / "out/cases.csv", folder / "out/campaign.json"
            original, fixed = table.read_text(), plan.read_text()
            table.write_text(original.replace("\n1,2,", "\n1,77,"))
            for command in ("run", "report", "status"):
                result = vbar("campaign", command, folder / "out")
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("cases.csv: differs from the table that the campaign began with", result.stderr)
            table.write_text(original)
            plan.write_text(fixed.replace("mission.duration_h=0.05", "mission.duration_h=0.06"))  # of cases that have flown
            result = vbar("campaign", "run", folder / "out")
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("case 0: its result is that of other keys", result.stderr)
            plan.write_text(fixed)
            run(folder / "out")

    def test_the_program_of_a_foreign_folder_needs_trust(self):
        """A folder from elsewhere, with a list of checksums that fits."""
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..2", values="[0.0]")
            out = folder / "out"
            run(file, "--out", out, "--cases", "0", expect=75)
            program, sums, plan = out / "bin/host/vbar", out / "bin/SHA256SUMS", out / "campaign.json"
            before = hashlib.sha256(program.read_bytes()).hexdigest()
            program.unlink()
            program.write_text(f"#!/bin/sh\ntouch {folder}/executed\nexec {VBAR} \"$@\"\n")
            program.chmod(0o755)
            after = hashlib.sha256(program.read_bytes()).hexdigest()
            for listing in (sums, plan):
                listing.write_text(listing.read_text().replace(before, after))
            for command in (("run", out), ("rerun", out, 0), ("worker", out, 0, 1)):
                result = vbar("campaign", *command)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("is not the program of this installation", result.stderr)
                self.assertIn("--trust", result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)
            self.assertFalse((folder / "executed").exists())
            run(out, "--trust")
            self.assertTrue((folder / "executed").exists())

    def test_what_a_foreign_folder_names_needs_trust(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..2", values="[0.0]")
            out = folder / "out"
            run(file, "--out", out, "--cases", "0", expect=75)
            plan = out / "campaign.json"
            fixed = plan.read_text()
            plan.write_text(fixed.replace('"mission.duration_h=0.05"', '"mission.duration_h=0.05", "flight_computer.library=/x.so"'))
            result = vbar("campaign", "worker", out, 0, 1)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("library", result.stderr)
            self.assertIn("--trust", result.stderr)
            extra = out / "bin/lib/libc.so.6"
            extra.parent.mkdir()
            extra.write_text("")
            plan.write_text(fixed)
            result = vbar("campaign", "run", out)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("libc.so.6", result.stderr)

    def test_many_seeds_are_prepared_at_once(self):
        """Cases that differ in the seed alone are loaded once: the cost of a campaign's start is its table."""
        with scratch() as folder:
            file = folder / "campaign.toml"
            file.write_text(f'[campaign]\nname = "many"\nmission = "{SOURCE / "missions/experiment3.toml"}"\nseeds = "1..100000"\n'
                            'set = ["mission.duration_h=0.05"]\n')
            run(file, "--out", folder / "out", "--cases", "99999", expect=75)
            self.assertEqual((folder / "out/cases.csv").read_text().count("\n"), 100001)

    def test_a_campaign_is_flown_by_one_at_a_time(self):
        with scratch() as folder:
            file = campaign_file(folder, hours=2.25)
            first = start("campaign", "run", file, "--out", folder / "out", "--quiet")
            try:
                while not list((folder / "out/attempts").glob("*.jsonl")):
                    self.assertIsNone(first.poll())
                    time.sleep(0.02)
                second = vbar("campaign", "run", folder / "out")
                self.assertEqual(second.returncode, 2, second.stdout)
                self.assertIn(str(first.pid), second.stderr)
                self.assertIn("flying", vbar("campaign", "status", folder / "out").stdout)
            finally:
                first.terminate()
                self.assertEqual(first.wait(timeout=60), 75)
                first.communicate()
            self.assertEqual(list((folder / "out/flying").iterdir()), [])

    def test_disk_full(self):
        with scratch() as folder:
            disk = folder / "disk"
            disk.mkdir()
            if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=192m", "tmpfs", disk], capture_output=True).returncode != 0:
                self.skipTest("no small file system can be mounted here")
            try:
                file = campaign_file(folder)
                run(file, "--out", disk / "out", "--cases", "0-1", expect=75)
                filler = disk / "filler"
                descriptor = os.open(filler, os.O_WRONLY | os.O_CREAT)
                try:
                    while os.write(descriptor, b"\0" * 4096) > 0:
                        pass
                except OSError as error:
                    self.assertEqual(error.errno, errno.ENOSPC)
                finally:
                    os.close(descriptor)
                result = vbar("campaign", "run", disk / "out")
                self.assertEqual(result.returncode, 1, result.stdout)
                self.assertIn("No space left on device", result.stderr)
                filler.unlink()
                run(disk / "out")
                rows = rows_of(disk / "out")
                self.assertEqual({row["state"] for row in rows}, {"complete"})
                self.assertEqual(len(rows), 20)
            finally:
                subprocess.run(["umount", disk], check=True)


class CampaignRequirements(unittest.TestCase):
    """Requirements against the columns of results.csv, by other means than the program's."""
    KEY = "samples.39.05h.sigma_m"

    def fly(self, folder, *requirements, expect, seeds="1..5"):
        rest = "".join("[[require]]\n" + "\n".join(lines) + "\n" for lines in requirements)
        file = campaign_file(folder, seeds=seeds, values="[0.0]", general="samples_h = [39.05]", rest=rest)
        result = vbar("campaign", "run", file, "--out", folder / "out")
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout, json.loads((folder / "out/campaign_results.json").read_text())

    def test_statistics_make_the_exit_code(self):
        with scratch() as folder:
            key = f'key = "{self.KEY}"'
            stdout, results = self.fly(folder, [key, 'statistic = "median"', "most = 1e6", 'paper = "table_4.row_2"'],
                                       [key, 'statistic = "worst"', "most = 1e6"], [key, 'statistic = "mean"', "least = 0.0"],
                                       ['statistic = "share"', 'verdict = "not judged"', "least = 0.4"], expect=0)
            rows = rows_of(folder / "out")
            values = {int(row["case"]): float(row[self.KEY]) for row in rows}
            median, worst, mean, share = results["requirements"]
            self.assertEqual(median["value"], statistics.median(values.values()))
            self.assertEqual(median["paper"], "table_4.row_2")
            self.assertEqual(worst["value"], max(values.values()))
            self.assertEqual(worst["worst"]["case"], max(values, key=values.get))
            self.assertEqual(worst["worst"]["seed"], rows[worst["worst"]["case"]]["seed"])
            self.assertAlmostEqual(mean["value"], statistics.fmean(values.values()), delta=1e-9 * mean["value"])
            self.assertAlmostEqual(share["bound"], 0.025 ** (1 / 5), delta=1e-9, msg="all of n, Clopper and Pearson")
            self.assertTrue(results["requirements_met"])
            self.assertEqual(stdout.count("requirement met: "), 4)
            page = (folder / "out/campaign.html").read_text()
            self.assertIn("4 of 4 requirements met", page)
            self.assertIn("table_4.row_2", page)
            self.assertIn("vbar campaign rerun out", page)
            command = worst["worst"]["command"].split()
            self.assertEqual(command[:3] + command[4:], ["vbar", "campaign", "rerun", str(worst["worst"]["case"])])
            self.assertEqual(vbar("campaign", "rerun", folder / "out", command[4]).returncode, 0)
            status = vbar("campaign", "status", folder / "out").stdout
            self.assertEqual(status.count("requirement met: "), 4)

    def test_what_is_not_met_or_missing_fails(self):
        with scratch() as folder:
            stdout, results = self.fly(folder, [f'key = "{self.KEY}"', 'statistic = "median"', "most = 0.0"],
                                       ['key = "no.such_m"', 'statistic = "worst"', "most = 1.0"],
                                       [f'key = "{self.KEY}"', 'statistic = "percentile"', "percentile = 90.0", "most = 1e6",
                                        "confidence = 0.95"], expect=1)
            self.assertEqual([one["met"] for one in results["requirements"]], [False, False, False])
            self.assertIn("requirement not met: the median of " + self.KEY, stdout)
            self.assertIn("no.such_m; 5 of 5 cases have no value", stdout)
            self.assertEqual(results["requirements"][1]["missing"], [0, 1, 2, 3, 4])
            self.assertIn("too few cases for a bound at 95 % confidence, two-sided: 36 are needed", stdout)

    def test_a_case_that_was_void_is_missing(self):
        """A fault of the thruster between two burns never takes effect."""
        with scratch() as folder:
            late = '[[sweep]]\nkey = "fault"\nvalues = [[], [{ kind = "thrust_scale", at_h = 39.001, for_s = 0.001, value = 0.5 }]]\n'
            rest = f'{late}[[require]]\nkey = "{self.KEY}"\nstatistic = "worst"\nmost = 1e6\n'
            file = campaign_file(folder, seeds="1..1", values="[0.0]", general="samples_h = [39.05]", rest=rest)
            result = vbar("campaign", "run", file, "--out", folder / "out")
            self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
            self.assertEqual([row["state"] for row in rows_of(folder / "out")], ["complete", "void"])
            self.assertIn("1 of 2 cases has no value (case 1), 0 allowed", result.stdout)

    def test_seeds_are_drawn_from_the_commit(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..1", values="[0.0]")
            file.write_text(file.read_text().replace('"1..1"', '{ count = 3, from = "commit" }'))
            commit = "bd7e3cb4f00d0123456789abcdef0123456789ab"
            run(file, "--out", folder / "out", "--seeds-from", commit, "--cases", "0", expect=75)
            expected = [int(hashlib.sha256(f"{commit[:12]}\nshort\n{k}".encode()).hexdigest()[:8], 16) for k in range(3)]
            self.assertEqual([int(row["seed"]) for row in rows_of(folder / "out")], expected)
            plan = json.loads((folder / "out/campaign.json").read_text())
            self.assertEqual(plan["seeds_from"], commit[:12])
            version = vbar("--version").stdout
            self.assertIn(f"commit {plan['commit']},", version)
            before = rows_of(folder / "out")[0]
            run(file, "--out", folder / "out", "--cases", "0", expect=75)  # goes on with the seeds on record
            self.assertEqual(rows_of(folder / "out")[0], before)
            other = vbar("campaign", "run", folder / "out", "--seeds-from", "0123456789ab")
            self.assertEqual(other.returncode, 2, other.stdout)
            self.assertIn(f"--seeds-from: found 0123456789ab; accepted: {commit[:12]}", other.stderr)
            own = vbar("campaign", "run", file, "--out", folder / "own", "--cases", "0", "--quiet")
            if plan["commit"] == "unknown":
                self.assertEqual(own.returncode, 2, own.stdout)
                self.assertIn("campaign.seeds.from", own.stderr)
                self.assertIn("--seeds-from HEX", own.stderr)
            else:
                self.assertEqual(own.returncode, 75, own.stderr)
                self.assertEqual(json.loads((folder / "own/campaign.json").read_text())["seeds_from"], plan["commit"])

    def test_a_damaged_plan_is_answered_with_one_sentence(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..1", values="[0.0]")
            run(file, "--out", folder / "out")
            plan = folder / "out/campaign.json"
            whole = plan.read_text()
            for damage, expected in ((whole[:len(whole) // 2], "the file is cut off here"), (whole.replace(":", ";", 1), ":2: the file is damaged here"),
                                     (whole.replace('"cases": 1', '"cases": "one"'), 'key "cases": "one" is not an integer')):
                plan.write_text(damage)
                for command in ("status", "report", "run"):
                    result = vbar("campaign", command, folder / "out")
                    self.assertEqual(result.returncode, 1, result.stdout)
                    self.assertIn(f"{plan}", result.stderr)
                    self.assertIn(expected, result.stderr)
                    self.assertNotIn("json.exception", result.stderr)
                    self.assertEqual(result.stderr.count("\n"), 1)


class CampaignExchange(unittest.TestCase):
    """Cases that are flown from another folder, as on another computer."""
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.file = campaign_file(cls.folder, seeds="1..3", values="[0.0]")
        run(cls.file, "--out", cls.folder / "reference")
        cls.home = cls.folder / "home"
        run(cls.file, "--out", cls.home, "--cases", "0", expect=75)
        exported = vbar("campaign", "export", cls.home, "--to", cls.folder / "cases.tar.gz")
        assert exported.returncode == 0 and "cases    2\n" in exported.stdout, exported.stderr
        (cls.folder / "away").mkdir()
        subprocess.run(["tar", "xzf", cls.folder / "cases.tar.gz", "-C", cls.folder / "away"], check=True)
        cls.away = cls.folder / "away/home"
        flown = subprocess.run(["sh", cls.away / "fly.sh"], capture_output=True, text=True, cwd="/")
        assert flown.returncode == 0, flown.stdout + flown.stderr
        cls.results = cls.away / "results.tar.gz"

    def begun(self, name):
        """A campaign at home of which case 0 has flown."""
        run(self.file, "--out", self.folder / name, "--cases", "0", expect=75)
        return self.folder / name

    def refused(self, home, results, *parts):
        before = sorted(file.name for file in home.rglob("*"))
        result = vbar("campaign", "import", home, results)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        for part in (*parts, "nothing was imported"):
            self.assertIn(part, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertEqual(sorted(file.name for file in home.rglob("*")), before)

    def altered(self, name):
        shutil.copytree(self.away, self.folder / name)
        return self.folder / name

    def test_exported_cases_have_the_outputs_of_those_flown_at_home(self):
        home = self.begun("taken")
        for results, counts in ((self.results, "2 taken, 1 were known, 0 left"), (self.results, "0 taken, 3 were known, 0 left"),
                                (self.away, "0 taken, 3 were known, 0 left")):
            result = vbar("campaign", "import", home, results)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(counts, result.stdout)
            self.assertEqual(comparable(home), comparable(self.folder / "reference"))
        run(home)
        self.assertEqual(vbar("campaign", "export", home, "--to", self.folder / "none").returncode, 2)
        self.assertFalse((self.folder / "none").exists())

    def test_another_program_flies_the_one_of_the_export(self):
        home = self.begun("in_parts")
        away = self.folder / "part of it"
        self.assertEqual(vbar("campaign", "export", home, "--to", away).returncode, 0)
        self.assertEqual(vbar("campaign", "export", home, "--to", away).returncode, 2)
        other = self.folder / "other_vbar"
        shutil.copy(VBAR, other)
        with other.open("ab") as file:
            file.write(b"\0")
        flown = subprocess.run(["sh", away / "fly.sh", other, "--cases", "1"], capture_output=True, text=True)
        self.assertEqual(flown.returncode, 75, flown.stdout + flown.stderr)
        result = vbar("campaign", "import", home, away / "results.tar.gz")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("1 taken, 1 were known, 1 left", result.stdout)
        run(home)
        self.assertEqual(comparable(home), comparable(self.folder / "reference"))
        foreign = self.folder / "foreign"
        subprocess.run([other, "campaign", "run", self.file, "--out", foreign, "--quiet"], check=True, capture_output=True)
        self.refused(home, foreign, "its program is not that of this campaign (host/vbar: SHA-256")

    def test_what_differs_is_named(self):
        home = self.begun("strict")
        for kind, place in (("data", "data/earth/"), ("mission", "files/"), ("program", "host/vbar")):
            with self.subTest(kind):
                away = self.altered(f"other_{kind}")
                sums = away / "bin/SHA256SUMS"
                lines = sums.read_text().splitlines()
                (changed, *_) = (k for k, line in enumerate(lines) if line[66:].startswith(place))
                lines[changed] = "0" * 64 + lines[changed][64:]
                sums.write_text("\n".join(lines) + "\n")
                self.refused(home, away, f"its {kind} is not that of this campaign ({lines[changed][66:]}:")
        other = self.folder / "other_cases"
        run(campaign_file(self.folder, "other.toml", seeds="1..4", values="[0.0]"), "--out", other, "--cases", "1", expect=75)
        self.refused(home, other, "its cases are not those of this campaign")
        self.refused(home, self.file, "is not a whole archive")

    def test_archives_that_were_cut_are_refused(self):
        home = self.begun("whole")
        archive = self.results.read_bytes()
        cut = self.folder / "cut.tar.gz"
        for length in (0, 10, len(archive) // 2, len(archive) - 9, len(archive) - 1):
            with self.subTest(length):
                cut.write_bytes(archive[:length])
                self.refused(home, cut, f"{cut}: is not a whole archive")

    def test_results_that_were_altered_are_refused(self):
        home = self.begun("altered_home")
        away = self.altered("altered")
        lines_of = {file: file.read_text() for file in (away / "results").glob("*.jsonl")}
        (results,) = (file for file, text in lines_of.items() if '"case":1,' in text)
        text = lines_of[results]
        results.write_text(text.replace('"case":1,', '"case":2,', 1))
        self.refused(home, away, "1 lines of its results are damaged")
        names, *flights = text.splitlines(True)
        for k, flight in enumerate(flights):
            line = json.loads(flight)
            del line["crc32"]
            line["commands_sha256"] = "0" * 64
            body = json.dumps(line, separators=(",", ":"))
            flights[k] = body[:-1] + ',"crc32":"%08x"}\n' % zlib.crc32(body.encode())
        results.write_text(names + "".join(flights))
        run(home)  # the cases have results here, with other hashes
        self.refused(home, away, "case 1 has other outputs")


class CampaignKills(unittest.TestCase):
    """Kills at random instants, of a seed that is printed."""

    def setUp(self):
        seed = int(os.environ.get("VBAR_KILL_SEED", time.time_ns() % 1000000))
        print(f"VBAR_KILL_SEED={seed}")
        self.random = random.Random(seed)

    def assert_undisturbed(self, folder, reference):
        self.assertEqual(comparable(folder), comparable(reference))
        lines = [json.loads(line) for file in (folder / "results").glob("*.jsonl") for line in file.read_text().splitlines()
                 if line.endswith("}") and '"names"' not in line]
        self.assertEqual(sorted(line["case"] for line in lines), list(range(20)))
        self.assertEqual({line["state"] for line in lines}, {"complete"})
        self.assertEqual(list((folder / "flying").iterdir()), [])

    def kill(self, pid):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def test_kills_leave_one_result_for_each_case(self):
        with scratch() as folder:
            file = campaign_file(folder, general="retries = 20")
            run(file, "--out", folder / "reference")
            out = folder / "out"
            for _ in range(4):  # the whole campaign
                flight = start("campaign", "run", file, "--out", out, "--jobs", 2, "--quiet")
                time.sleep(self.random.uniform(0.0, 0.8))
                flights = children_of(flight.pid)
                self.kill(flight.pid)
                flight.wait()
                flight.communicate()
                deadline = time.monotonic() + 20.0
                while any(map(is_running, flights)) and time.monotonic() < deadline:
                    time.sleep(0.01)
                self.assertFalse(any(map(is_running, flights)), "flights outlived their worker")
            flight = start("campaign", "run", file, "--out", out, "--jobs", 2, "--quiet")
            for _ in range(4):  # single flights
                time.sleep(self.random.uniform(0.0, 0.3))
                for child in children_of(flight.pid)[:1]:
                    self.kill(child)
            self.assertEqual(flight.wait(timeout=300), 0, flight.communicate())
            flight.communicate()
            self.assert_undisturbed(out, folder / "reference")

    def test_a_case_that_is_always_killed_is_lost(self):
        with scratch() as folder:
            file = campaign_file(folder, seeds="1..1", values="[0.0]", hours=2.25, general="retries = 1")
            flight = start("campaign", "run", file, "--out", folder / "out", "--quiet")
            while flight.poll() is None:
                for child in children_of(flight.pid):
                    self.kill(child)
                time.sleep(0.01)
            flight.communicate()
            self.assertEqual(flight.returncode, 1)
            (row,) = rows_of(folder / "out")
            self.assertEqual((row["state"], row["attempts"]), ("lost", "2"))
            self.assertIn("killed 2 times", row["reason"])
            run(folder / "out", "--retry-failed")
            (row,) = rows_of(folder / "out")
            self.assertEqual((row["state"], row["attempts"]), ("complete", "3"))


class CampaignSlurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        reason = slurm_cluster.why_not()
        if reason:
            raise unittest.SkipTest(reason)
        cls.folder = cls.enterClassContext(scratch())
        cls.file = campaign_file(cls.folder)
        run(cls.file, "--out", cls.folder / "reference")
        cls.cluster = cls.enterClassContext(slurm_cluster.cluster(cls.folder / "cluster", nodes=2, processors=1))
        cls.environment = {"SLURM_CONF": cls.cluster.environment["SLURM_CONF"]}

    def test_the_same_results_on_two_nodes(self):
        out = self.folder / "two"
        run(self.file, "--out", out, "--engine", "slurm", "--workers", 2, **self.environment)
        self.assertEqual(comparable(out), comparable(self.folder / "reference"))
        self.assertEqual(len(list((out / "results").glob("*slurm*.jsonl"))), 2)

    def test_a_cancelled_job_and_a_killed_worker_go_on(self):
        out = self.folder / "killed"
        run(self.file, "--out", out, "--engine", "slurm", "--workers", 2, "--no-wait", **self.environment)
        while not list((out / "results").glob("*.jsonl")):
            time.sleep(0.05)
        again = vbar("campaign", "run", out, "--engine", "slurm", **self.environment)
        self.assertEqual(again.returncode, 2, again.stdout)
        for pid in self.workers_of(out)[:1]:
            os.kill(pid, signal.SIGKILL)
        self.cluster.ask("scancel", "--user=root")
        deadline = time.monotonic() + 60.0
        while self.cluster.ask("squeue", "--noheader") and time.monotonic() < deadline:
            time.sleep(0.1)
        run(out, "--engine", "slurm", "--workers", 2, **self.environment)
        self.assertEqual(comparable(out), comparable(self.folder / "reference"))

    @staticmethod
    def workers_of(out):
        found = subprocess.run(["pgrep", "-f", f"campaign worker {re.escape(str(out))}"], capture_output=True, text=True).stdout
        return [int(pid) for pid in found.split()]


if __name__ == "__main__":
    main()
