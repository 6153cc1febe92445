#!/usr/bin/env python3
"""Campaigns at full size: flies them, compares what they leave, and prints a table of criteria and results.

usage: ci/verify_campaign.py [--build build/host] [--cases 200] [--kills 20] [--real 1000] [--seed 1] [--only NAME,...]

The names of --only are those of CHECKS. Times mean something on an idle computer only.
"""
import argparse
import csv
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/integration/program"))
import slurm_cluster  # noqa: E402

WALL_CLOCK = ("wall_s", "cpu_s", "host", "processor", "attempts")
FILE = """[campaign]
name = "verify"
mission = "{mission}"
seeds = "{seeds}"
retries = 100
samples_h = [39.25, 39.5, 39.75, 40.0, 40.25, 40.5, 40.75, 41.0, 41.25]
{general}
[[pass]]
key = "waypoints.10.navigation_error_m"
most = 0.02
{rest}
"""


class Verification:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.vbar = options.build.resolve() / "vbar"
        self.random = random.Random(options.seed)
        self.rows = []

    def add(self, what, criterion, result, met):
        self.rows.append((what, criterion, result, met))
        print(f"{'met' if met else 'NOT MET'}: {what}: {result} ({criterion})", flush=True)

    def file(self, name, seeds, general="", rest=""):
        path = self.folder / f"{name}.toml"
        path.write_text(FILE.format(mission=ROOT / "missions/experiment3.toml", seeds=seeds, general=general, rest=rest))
        return path

    def start(self, *arguments, **keywords):
        return subprocess.Popen([str(self.vbar), "campaign", *map(str, arguments)], stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True, **keywords)

    def run(self, *arguments, expect=(0,), **keywords):
        begun = time.monotonic()
        result = subprocess.run([str(self.vbar), "campaign", *map(str, arguments)], capture_output=True, text=True, **keywords)
        if result.returncode not in expect:
            raise SystemExit(f"vbar campaign {' '.join(map(str, arguments))}: {result.returncode}: {result.stdout}{result.stderr}")
        return time.monotonic() - begun

    @staticmethod
    def rows_of(folder):
        with (folder / "results.csv").open(newline="") as file:
            return [{key: value for key, value in row.items() if key not in WALL_CLOCK} for row in csv.DictReader(file)]

    @staticmethod
    def processor_time(folder):
        with (folder / "results.csv").open(newline="") as file:
            return sum(float(row["cpu_s"]) for row in csv.DictReader(file))

    def reference(self):
        """The campaign that the others are compared with, flown once."""
        folder = self.folder / "reference"
        if not (folder / "results.csv").exists():
            self.reference_wall = self.run("run", self.file("reference", f"1..{self.options.cases}"), "--out", folder, "--jobs", 2)
        return folder

    def same(self):
        reference = self.rows_of(self.reference())
        file = self.folder / "reference.toml"
        same = []
        for jobs in (1, 4):
            out = self.folder / f"jobs{jobs}"
            self.run("run", file, "--out", out, "--jobs", jobs)
            same.append(self.rows_of(out) == reference)
        out = self.folder / "order"
        last = self.options.cases - 1
        self.run("run", file, "--out", out, "--jobs", 2, "--cases", f"{last // 2}-{last}", expect=(75,))
        self.run("run", out, "--jobs", 2)
        same.append(self.rows_of(out) == reference)
        self.add(f"{self.options.cases} cases of experiment 3 with one, two and four workers, and in another order", "identical results.csv",
                 f"{sum(same) + 1} of {len(same) + 1} identical", all(same))

    def efficiency(self):
        folder = self.reference()
        share = self.processor_time(folder) / 2 / self.reference_wall
        self.add("local campaign against the processor time of its cases, 2 processors", "at least 90 %", f"{100 * share:.1f} %", share >= 0.9)

    def slurm(self):
        reason = slurm_cluster.why_not()
        if reason:
            self.add("Slurm", "runs", f"skipped: {reason}", False)
            return
        reference = self.rows_of(self.reference())
        for nodes in (1, 2):
            with slurm_cluster.cluster(self.folder / f"cluster{nodes}", nodes=nodes, processors=2 // nodes) as cluster:
                out = self.folder / f"slurm{nodes}"
                wall = self.run("run", self.folder / "reference.toml", "--out", out, "--engine", "slurm", "--workers", 2,
                                env=cluster.environment)
                self.add(f"Slurm, {nodes} node(s)", "identical results.csv", f"{len(reference)} cases", self.rows_of(out) == reference)
                if nodes == 1:
                    over = wall - self.reference_wall
                    self.add("overhead of Slurm", "at most 10 % and 10 s", f"{over:.1f} s, {100 * over / self.reference_wall:.1f} %",
                             over <= min(10.0, 0.1 * self.reference_wall))

    def rerun(self):
        folder = self.reference()
        cases = self.random.sample(range(self.options.cases), 20)
        same = 0
        for case in cases:
            result = subprocess.run([str(self.vbar), "campaign", "rerun", str(folder), str(case)], capture_output=True, text=True)
            same += result.returncode == 0 and "same bits" in result.stdout
            shutil.rmtree(folder / "runs", ignore_errors=True)
        self.add("rerun of 20 cases drawn at random", "20 of 20 the same bits", f"{same} of 20", same == 20)

    def killed(self, name, disturb, environment=None, engine=()):
        """Flies a short campaign, disturbed at random instants, then to its end."""
        file = self.folder / "killed.toml"
        if not file.exists():
            self.file("killed", "1..40", general='set = ["mission.duration_h=1.1"]').read_text()
            text = file.read_text()
            file.write_text(text.replace("samples_h", "#").replace("waypoints.10", "waypoints.9"))
            self.run("run", file, "--out", self.folder / "undisturbed", "--jobs", 2)
        environment = environment or os.environ
        out = self.folder / f"killed_{name}"
        shutil.rmtree(out, ignore_errors=True)
        disturbed = 0
        for _ in range(self.options.kills):
            target = out if (out / "campaign.json").exists() else file
            where = () if target is out else ("--out", out)
            flight = self.start("run", target, *where, "--jobs", 2 if not engine else 1, *engine, env=environment)
            time.sleep(self.random.uniform(0.1, 3.0))
            disturbed += bool(disturb(flight, out))
            flight.wait()
            if (out / "campaign.json").exists() and self.complete(out):
                shutil.rmtree(out)
        if not (out / "campaign.json").exists():
            self.run("run", file, "--out", out, "--jobs", 2, *engine, env=environment)
        self.run("run", out, "--jobs", 2, *engine, env=environment)
        same = self.rows_of(out) == self.rows_of(self.folder / "undisturbed")
        one_each = sorted(self.cases_of(out)) == list(range(40))
        self.add(f"kill -9 of {name}, {disturbed} times", "one result for each case, as undisturbed", f"same: {same}, one each: {one_each}",
                 same and one_each and disturbed > 0)

    @staticmethod
    def cases_of(out):
        """Of all results, but not of lines of names or of one that was cut."""
        lines = [line for file in (out / "results").glob("*.jsonl") for line in file.read_text().splitlines(True) if line.endswith("\n")]
        return [one["case"] for one in map(json.loads, lines) if "case" in one]

    def complete(self, out):
        return len(set(self.cases_of(out))) == 40

    @staticmethod
    def kill(*pids):
        killed = 0
        for pid in pids:
            try:
                os.kill(pid, signal.SIGKILL)
                killed += 1
            except ProcessLookupError:
                pass
        return killed

    @staticmethod
    def children(pid):
        found = []
        for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
            found += [int(child) for child in task.read_text().split()]
        return found

    def kills(self):
        self.killed("a campaign", lambda flight, out: self.kill(flight.pid))

        def kill_a_run(flight, out):
            killed = self.kill(*self.children(flight.pid)[:1])
            flight.terminate()
            return killed
        self.killed("a run", kill_a_run)

        def workers(out):
            text = subprocess.run(["pgrep", "-f", f"campaign worker .*{re.escape(str(out))}"], capture_output=True, text=True).stdout
            return [int(pid) for pid in text.split()]

        command = ("--engine", "command", "--workers", 2, "--submit", "{worker} >/dev/null 2>&1 &")

        def kill_workers(count):
            def kill(flight, out):
                killed = self.kill(*workers(out)[:count])
                flight.terminate()
                for _ in range(200):  # the others go on to their end
                    if not workers(out):
                        break
                    if count > 1:
                        self.kill(*workers(out))
                    time.sleep(0.1)
                return killed
            return kill
        self.killed("a worker", kill_workers(1), engine=command)
        self.killed("all workers", kill_workers(99), engine=command)
        if slurm_cluster.why_not():
            return
        with slurm_cluster.cluster(self.folder / "cluster_kills", nodes=2, processors=1) as cluster:
            def settle():
                for _ in range(600):
                    if not cluster.ask("squeue", "--noheader"):
                        return
                    time.sleep(0.1)

            def cancel(flight, out):
                had = bool(cluster.ask("squeue", "--noheader"))
                flight.terminate()
                flight.wait()
                cluster.ask("scancel", "--user=root")
                settle()
                return had

            def kill_node(flight, out):
                flight.terminate()
                flight.wait()
                node = self.random.choice(cluster.nodes)
                pid = cluster.pid_of(f"slurmd.{node}.pid")
                killed = self.kill(pid, *workers(out))
                cluster.ask("scancel", "--signal=KILL", "--user=root")
                cluster.ask("scancel", "--user=root")
                cluster.start_node(node)
                settle()
                return killed
            engine = ("--engine", "slurm", "--workers", 2)
            self.killed("Slurm's jobs (scancel)", cancel, environment=cluster.environment, engine=engine)
            self.killed("a Slurm node", kill_node, environment=cluster.environment, engine=engine)

    def storage(self):
        out = self.folder / "storage"
        cases = self.options.real
        file = self.file("storage", f"1..{cases}")
        file.write_text(file.read_text().replace("samples_h", "#"))  # 126 more numbers a case
        self.run("run", file, "--out", out, "--jobs", 2)
        files = [file for file in out.rglob("*") if file.is_file()]
        copies = sum(file.stat().st_size for file in files if (out / "bin") in file.parents)
        rest = sum(file.stat().st_size for file in files) - copies
        whole = (copies + rest * 10000 / cases) / 1e6
        self.add(f"storage of 10,000 cases, from {cases} real ones", "at most 60 MB, fewer than 200 files",
                 f"{whole:.1f} MB ({copies / 1e6:.1f} MB of them copies of program and data), {len(files)} files",
                 whole <= 60.0 and len(files) < 200)

    def added(self):
        def hashes(folder):
            return {(row["seed"], row.get("links.crosslink.loss_probability", "0.01")): row["telemetry_sha256"]
                    for row in self.rows_of(folder) if row["state"] == "complete"}
        sweep = '[[sweep]]\nkey = "links.crosslink.loss_probability"\nvalues = {}\n'
        mass = '[[disperse]]\nkey = "spacecraft.servicer.mass_kg"\ndistribution = "normal"\nmean = 154.0\nsigma = 2.0\n'
        before = self.folder / "before"
        self.run("run", self.file("before", "1..10", rest=sweep.format("[0.0, 0.1]") + mass), "--out", before, "--jobs", 2)
        after = self.folder / "after"
        self.run("run", self.file("after", "1..11", rest=sweep.format("[0.05, 0.0, 0.1]") + mass), "--out", after, "--jobs", 2)
        old, new = hashes(before), hashes(after)
        same = sum(new.get(key) == value for key, value in old.items())
        self.add("a case and a sweep value added", "every other case keeps its hashes", f"{same} of {len(old)}", same == len(old) == 20)
        wider = self.folder / "wider"
        other = '[[disperse]]\nkey = "gnss.start.reacquisition_min_s"\ndistribution = "uniform"\nlow = 0.5\nhigh = 1.5\n'
        self.run("run", self.file("wider", "1..10", rest=sweep.format("[0.0, 0.1]") + other + mass), "--out", wider, "--cases", "0",
                 expect=(75,))
        draws = [row["spacecraft.servicer.mass_kg"] for row in self.rows_of(before)]
        self.add("a dispersion added", "every other draw stays", f"{len(draws)} masses",
                 draws == [row["spacecraft.servicer.mass_kg"] for row in self.rows_of(wider)])


CHECKS = ["same", "efficiency", "slurm", "rerun", "added", "kills", "storage"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/host")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--real", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default=",".join(CHECKS))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="vbar-campaign-") as folder:
        verification = Verification(options, pathlib.Path(folder))
        for name in options.only.split(","):
            getattr(verification, name)()
    print("| item | criterion | result | met |\n|---|---|---|---|")
    for what, criterion, result, met in verification.rows:
        print(f"| {what} | {criterion} | {result} | {'yes' if met else '**no**'} |")
    return 0 if all(met for *_, met in verification.rows) else 1


if __name__ == "__main__":
    sys.exit(main())
