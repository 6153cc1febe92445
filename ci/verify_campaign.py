#!/usr/bin/env python3
"""Campaigns at full size: the same results whatever the workers, their order and their deaths, and what they store.

usage: ci/verify_campaign.py [--build build/host] [--cases 200] [--kills 20] [--real 1000] [--seed 1]

program.Campaign* has the same at a tenth of the size, with Slurm, reruns, and cases that are added.
"""
import argparse
import csv
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
WALL_CLOCK = ("wall_s", "cpu_s", "host", "processor", "attempts")
FILE = f"""[campaign]
name = "verify"
mission = "{ROOT}/missions/experiment3.toml"
seeds = "1..{{cases}}"
set = ["mission.duration_h={{hours}}"]
retries = 100
"""
COMMAND = ("--engine", "command", "--workers", "2", "--submit", "{worker} >/dev/null 2>&1 &")


class Campaigns:
    def __init__(self, build, folder, seed):
        self.vbar, self.folder, self.random = build.resolve() / "vbar", folder, random.Random(seed)
        self.met = True

    def add(self, what, result, met):
        self.met &= met
        print(f"| {what} | {result} | {'yes' if met else '**no**'} |", flush=True)

    def start(self, name, *arguments):
        """Begins the campaign of a file, or goes on with it."""
        target = (self.folder / name,) if (self.folder / name / "campaign.json").exists() else (
            self.folder / f"{name}.toml", "--out", self.folder / name)
        return subprocess.Popen([self.vbar, "campaign", "run", *target, "--quiet", *arguments])

    def fly(self, name, cases, hours, *arguments):
        (self.folder / f"{name}.toml").write_text(FILE.format(cases=cases, hours=hours))
        if self.start(name, *arguments).wait() not in (0, 75):
            raise SystemExit(f"campaign {name} failed")
        with (self.folder / name / "results.csv").open(newline="") as file:
            return [{key: value for key, value in row.items() if key not in WALL_CLOCK} for row in csv.DictReader(file)]

    def same(self, cases):
        reference = self.fly("two", cases, 2.25, "--jobs", "2")
        same = [self.fly(f"jobs{jobs}", cases, 2.25, "--jobs", str(jobs)) == reference for jobs in (1, 4)]
        self.fly("order", cases, 2.25, "--cases", f"{cases // 2}-{cases - 1}")
        same.append(self.fly("order", cases, 2.25) == reference)
        self.add(f"{cases} cases with one, two and four workers, and in another order: identical results.csv", f"{sum(same)} of 3", all(same))

    def workers(self, name):
        text = subprocess.run(["pgrep", "-f", f"campaign worker .*{re.escape(str(self.folder / name))}"], capture_output=True, text=True).stdout
        return [int(pid) for pid in text.split()]

    def kill(self, pids):
        for pid in pids:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        return len(pids)

    def killed(self, name, kills, victims, *engine):
        """A short campaign, of which `victims` of a flight under way are killed at random instants, then flown to its end."""
        undisturbed = self.fly("undisturbed", 40, 1.1, "--jobs", "2")
        (self.folder / f"{name}.toml").write_text(FILE.format(cases=40, hours=1.1))
        count = 0
        for _ in range(kills):
            flight = self.start(name, *engine)
            time.sleep(self.random.uniform(0.1, 3.0))
            count += self.kill(victims(flight, name))
            flight.terminate()
            flight.wait()
            while self.workers(name):
                time.sleep(0.1)
        self.add(f"kill -9 of {name}, {count} times: the results of an undisturbed campaign", "",
                 self.fly(name, 40, 1.1, *engine) == undisturbed and count > 0)
        shutil.rmtree(self.folder / "undisturbed")

    def storage(self, cases):
        self.fly("storage", cases, 2.25, "--jobs", "2")
        files = {file: file.stat().st_size for file in (self.folder / "storage").rglob("*") if file.is_file()}
        copies = sum(size for file, size in files.items() if self.folder / "storage/bin" in file.parents)
        whole = (copies + (sum(files.values()) - copies) * 10000 / cases) / 1e6
        self.add("storage of 10,000 cases: at most 60 MB, fewer than 200 files", f"{whole:.1f} MB, {len(files)} files", whole <= 60.0 and len(files) < 200)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/host")
    for name, default in (("cases", 200), ("kills", 20), ("real", 1000), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=default)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="vbar-campaign-") as folder:
        campaigns = Campaigns(options.build, pathlib.Path(folder), options.seed)
        campaigns.same(options.cases)
        campaigns.killed("campaign", options.kills, lambda flight, name: [flight.pid])
        campaigns.killed("worker", options.kills, lambda flight, name: campaigns.workers(name)[:1], *COMMAND)
        campaigns.killed("workers", options.kills, lambda flight, name: campaigns.workers(name), *COMMAND)
        campaigns.storage(options.real)
    return 0 if campaigns.met else 1


if __name__ == "__main__":
    sys.exit(main())
