#!/usr/bin/env python3
"""Kills flights and their resumes at random instants, and compares what is left with undisturbed flights.

    ci/verify_resume.py BINARY [--rows NAME,...] [--kills 20] [--costs 5] [--seed 18] [--json FILE]

BINARY is a built vbar; the working directory is the root of the repository. A row is a mission and a flight computer. Its flight is killed
by SIGKILL at `kills` instants, uniform over the log of an undisturbed flight; every time but the first it is a resume that is killed, and the
last resume is left to end. Then every file has to be that of the undisturbed flight, but for the fields of WALL_CLOCK. `costs` further
flights are killed once: the processor time of the flight until then, children included, against that of its resume until it has reached
the end of the log. The exit status is 1 if a file differs.
"""
import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

import flights

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "integration" / "program"))
os.environ.setdefault("VBAR_SOURCE_DIR", str(pathlib.Path.cwd()))

# name: mission and settings. Arcs are short where a whole flight takes minutes.
ROWS = {
    "ideal": ("ideal_navigation",),
    "experiment3": ("experiment3",),
    "experiment1_1h": ("experiment1", "mission.duration_h=1"),
    "experiment2_20min": ("experiment2", "mission.duration_h=0.3333333333"),
    "experiment1": ("experiment1",),
    "experiment2": ("experiment2",),
    "ideal_host_process": ("ideal_navigation", "flight_computer.target=host_process"),
    "ideal_zynq_uart": ("ideal_navigation", "mission.duration_h=6", "flight_computer.target=zynq_qemu"),
    "ideal_zynq_udp": ("ideal_navigation", "mission.duration_h=6", "flight_computer.target=zynq_qemu", "flight_computer.link=udp"),
    "experiment3_zynq_uart": ("experiment3", "mission.duration_h=0.5", "flight_computer.target=zynq_qemu"),
    "experiment3_zynq_udp": ("experiment3", "mission.duration_h=0.5", "flight_computer.target=zynq_qemu", "flight_computer.link=udp"),
}
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def processor_s(pid):
    """Of a living process, its threads and its descendants that live or that were waited for."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / TICKS_PER_S


def tree_s(pid):
    from vbar_program import children_of
    return processor_s(pid) + sum(processor_s(child) for child in children_of(pid))


def size_of(file):
    """Zero if there is none: a resume moves its log when it has ended."""
    try:
        return file.stat().st_size
    except FileNotFoundError:
        return 0


class Row:
    def __init__(self, binary, name, folder):
        self.binary, self.name, self.folder = binary, name, folder
        mission, *settings = ROWS[name]
        self.fly = ["run", mission, "--quiet", *[part for setting in settings for part in ("--set", setting)]]

    def start(self, *arguments):
        return subprocess.Popen([self.binary, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def undisturbed(self):
        self.whole = self.folder / "whole"
        begun = time.monotonic()
        run = self.start(*self.fly, "--out", self.whole)
        _, errors = run.communicate()
        if run.returncode not in flights.COMPLETE:
            raise SystemExit(f"{self.name}: the undisturbed flight failed: {errors}")
        self.wall_s = time.monotonic() - begun
        self.log_bytes = (self.whole / "packets.lcmlog").stat().st_size

    def is_complete(self, folder):
        summary = folder / "summary.json"
        return summary.exists() and json.loads(summary.read_text())["complete"]

    def kill(self, folder, share):
        """Flies or resumes, and kills it when its log has this share of its final length. Its processor time, or None if it ended before."""
        resuming = folder.with_name(folder.name + ".resuming")
        is_resume = (folder / "mission.toml").exists()
        if is_resume:
            run = self.start("resume", folder, "--quiet")
        else:
            shutil.rmtree(folder, ignore_errors=True)
            run = self.start(*self.fly, "--out", folder)
        log = (resuming if is_resume else folder) / "packets.lcmlog"
        while run.poll() is None:
            if size_of(log) >= share * self.log_bytes:
                run.send_signal(signal.SIGSTOP)
                spent = tree_s(run.pid)
                run.send_signal(signal.SIGKILL)
                run.communicate()
                return spent
            time.sleep(0.0005)
        _, errors = run.communicate()
        if run.returncode not in flights.COMPLETE:
            raise SystemExit(f"{self.name}: exit status {run.returncode}: {errors}")
        return None

    def resume(self, folder):
        """Resumes to the end. Processor time until the end of the log."""
        run = self.start("resume", folder)
        spent = None
        for line in run.stdout:
            if line.startswith("identical to the log"):
                run.send_signal(signal.SIGSTOP)
                spent = tree_s(run.pid)
                run.send_signal(signal.SIGCONT)
        _, errors = run.communicate()
        if run.returncode not in flights.COMPLETE:
            raise SystemExit(f"{self.name}: the resume failed: {errors}")
        return spent

    def killed_often(self, draw, kills):
        """Number of kills that met a flight or a resume under way, and the files that differ in the end."""
        from test_resume import differences
        folder = self.folder / "killed"
        met = 0
        while met < kills and not self.is_complete(folder):
            met += self.kill(folder, draw.random()) is not None
        if not self.is_complete(folder):
            self.resume(folder)
        found = differences(folder, self.whole)
        found += [path.name for path in self.folder.glob("killed.*")]
        shutil.rmtree(folder)
        return met, found

    def costs(self, draw, number):
        """Pairs: processor time of a flight until it was killed, and of its resume until there."""
        pairs = []
        while len(pairs) < number:
            folder = self.folder / "once"
            spent = self.kill(folder, draw.uniform(0.3, 0.9))
            if spent is not None:
                pairs.append((spent, self.resume(folder)))
            shutil.rmtree(folder)
        return pairs


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", type=pathlib.Path)
    parser.add_argument("--rows", default="ideal,experiment3,experiment1_1h,experiment2_20min,ideal_host_process")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--costs", type=int, default=5)
    parser.add_argument("--seed", type=int, default=18)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    binary = arguments.binary.resolve()
    os.environ.setdefault("VBAR_BINARY_DIR", str(binary.parent))
    unknown = set(arguments.rows.split(",")) - set(ROWS)
    if unknown:
        parser.error(f"unknown rows: {', '.join(sorted(unknown))}; accepted: {', '.join(ROWS)}")

    results, good = [], True
    print("| flight | wall s | kills | files that differ | resume / flight, processor time to the end of the log |")
    print("|---|---|---|---|---|", flush=True)
    for name in arguments.rows.split(","):
        with tempfile.TemporaryDirectory(prefix="vbar-resume-") as scratch:
            row = Row(binary, name, pathlib.Path(scratch))
            draw = random.Random(f"{arguments.seed} {name}")
            row.undisturbed()
            met, found = row.killed_often(draw, arguments.kills)
            pairs = row.costs(draw, arguments.costs)
            ratios = [again / before for before, again in pairs]
            cost = f"{statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})" if ratios else "-"
            print(f"| {name} | {row.wall_s:.1f} | {met} | {', '.join(found) or 'none'} | {cost} |", flush=True)
            results.append({"row": name, "wall_s": row.wall_s, "kills": met, "different": found, "costs": pairs})
            good &= not found
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
