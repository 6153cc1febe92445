#!/usr/bin/env python3
"""Every fault of docs/faults.md at points of the approach: what was reported and when, and the distance kept for a day.

    ci/fault_table.py BINARY [--seeds 1-3] [--points 10km,300m,40m,9m] [--cases NAME,...] [--jobs 2] [--runs FOLDER]

BINARY is a built vbar; the working directory is the root of the repository. Each case is missions/full_range_retreat.toml, or
full_range_cooperative_retreat.toml, from the waypoint before its point, with one fault, for 24 h after it. `distance` is the least true
one from centre to centre since the fault began, of which 2.0 m are required (1.0 m without an operational thruster); `reported` the
time until the event, against its limit; `error` the largest ratio of navigation errors (their maximum and their median, while the fault
lasts and for an hour after it) to those of the same run without the fault, which is flown once for each point and seed; an arrival is
judged by the larger control error of the next two waypoints. From 41.5 h on, after the last waypoint, steps and images are rare, and a
retreat then is not counted as the fault's: without it there are such retreats as well. Run folders are
kept with --runs, and are otherwise deleted. The exit status is 1 if a case misses its row. ci/fault_judgement.py has the rules.
"""
import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

import flights
from fault_judgement import Case, JudgementError, Nominal, begin_of, control_errors, judge, navigation_errors, window_of

# name: hour of the fault, start and its waypoint, image period there (s), a-priori sigmas (m) of a da, a dlambda, a de, a di
POINTS = {
    "10km": (16.5, 12.0, 2, 60.0, (0.1, 4.0, 0.15, 0.1)),
    "300m": (30.8, 28.0, 5, 60.0, (0.03, 0.45, 0.04, 0.04)),
    "40m": (37.9, 36.0, 7, 20.0, (0.02, 0.3, 0.03, 0.03)),
    "9m": (39.8, 39.0, 8, 60.0, (0.01, 0.05, 0.02, 0.02)),
}
NEAR = ("40m", "9m")
FIXED = ("300m", "40m", "9m")
AFTER_H = 24.0
SLOW_H = 41.5  # from then on, steps of a minute and images of every fifth minute


def fault(kind, **keys):
    return {"kind": kind, **keys}


CASES = {
    "none": Case([], "", None, retreats=False),
    "camera silent 30 min": Case([fault("silent", unit="camera", for_s=1800.0)], "images_missing", lambda p, s: 4 * p + 60.0, sources=("bearings",),
                                 points=("10km", "300m")),
    "cameras silent 30 min": Case([fault("silent", unit=u, for_s=1800.0) for u in ("camera", "close_camera")], "images_missing",
                                  lambda p, s: 4 * p + 60.0, points=NEAR),
    "cameras silent for ever": Case([fault("silent", unit=u) for u in ("camera", "close_camera")], "guard_silence", 2200.0 + 1800.0, points=NEAR,
                                    retreats=True),
    "image frozen 5 min": Case([fault("frozen", unit="camera", for_s=300.0)], "image_frozen", lambda p, s: 2 * p + 60.0, points=("10km", "300m", "40m")),
    "close images frozen 5 min": Case([fault("frozen", unit="close_camera", for_s=300.0)], "image_frozen", lambda p, s: 2 * p + 10.0, points=("9m",)),
    "star tracker 1 deg 10 min": Case([fault("attitude_error", unit="gnss", value_deg=1.0, for_s=600.0)], "attitude", lambda p, s: 3 * p,
                                      retreats=False, error_ratio=2.0),
    "receiver silent 1 h": Case([fault("receiver_silent", unit="gnss", for_s=3600.0)], "receiver_silent", lambda p, s: 20.0 + s, retreats=False,
                                error_ratio=1.2),
    "network wrong by 90 deg 60 s": Case([fault("target_turned", unit=u, value_deg=90.0, for_s=60.0) for u in ("camera", "close_camera")], "pose_network",
                                         lambda p, s: 65.0 if p < 60.0 else 35.0,  # images every 20 and 10 s
                                         points=NEAR, retreats=False, error_ratio=2.0),
    "thruster off": Case([fault("thrust_scale", value=0.0)], "thruster", None, distance_m=1.0, within_burns=2),
    "thruster on 10 s": Case([fault("thrust_uncommanded", value_mps2=1e-3, direction_rtn=[0.0, 1.0, 0.0], for_s=10.0)], "burn_uncommanded", lambda p, s: s,
                             retreats=True),
    "burns 10 % short": Case([fault("thrust_scale", value=0.9)], "burn_size", None, retreats=False, within_burns=3, arrival_ratio=2.0),
    "first burn of the leg missed": Case([fault("thrust_scale", value=0.0, event="burn:1", for_s=1.0)], "burn_missed", lambda p, s: s, retreats=False,
                                         arrival_ratio=2.0),
    "reboot warm 60 s": Case([fault("computer_reboot", for_s=60.0, keeps_state=True)], "restart", lambda p, s: 60.0 + s, retreats=False, valid_within_s=60.0),
    "reboot cold 60 s": Case([fault("computer_reboot", for_s=60.0)], "", None, valid_within_s=2700.0),
    "silent for 3 steps": Case([fault("computer_silent", for_s=181.0)], "step_late", lambda p, s: 181.0 + s, retreats=False),
}

# To a target that cooperates, from 1 km on.
CAMERAS = ("camera", "close_camera")
COOPERATIVE = {
    "cooperative: none": Case([], "", None, FIXED, retreats=False),
    "cooperative: crosslink silent 10 min": Case([fault("silent", unit="gnss", spacecraft="target", for_s=600.0)], "crosslink_silent", 30.0, FIXED,
                                                 retreats=False, fixed_within_s=60.0),
    "cooperative: integers wrong by one cycle": Case([fault("cycle_slip", unit="gnss", value_cycles=1)], "source_inconsistent", 300.0, FIXED,
                                                     retreats=False, error_m=0.10, error_ratio=2.0, error_from_s=600.0),
    "cooperative: receiver reset": Case([fault("receiver_reset", unit="gnss")], "", None, FIXED, retreats=False, error_ratio=1.2),
    "cooperative: receiver silent 1 h": Case([fault("receiver_silent", unit="gnss", for_s=3600.0)], "receiver_silent", 20.0, FIXED,
                                             retreats=False, error_ratio=1.2),
    "cooperative: cameras and crosslink silent for ever": Case(
        [fault("silent", unit=unit) for unit in CAMERAS] + [fault("silent", unit="gnss", spacecraft="target")], "retreat", 2100.0 + 60.0, NEAR,
        retreats=True),
}
CASES |= COOPERATIVE


def toml_of(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value)


def steps_of(is_cooperative):
    """[hour, seconds] of the mission."""
    return [[0.0, 60.0], *([[24.0, 10.0]] if is_cooperative else [[36.0, 20.0]]), [38.5, 5.0], [SLOW_H, 60.0]]


def step_at(hour, is_cooperative):
    return [step_s for from_h, step_s in steps_of(is_cooperative) if from_h <= hour][-1]


def mission_of(case, point, is_cooperative, after_h=AFTER_H):
    at_h, start_h, waypoint, _, sigmas = POINTS[point]
    slow = [SLOW_H, 300.0]
    camera = [[0.0, 60.0], [36.0, 20.0], [39.0, 60.0], slow]
    close_camera = [[38.25, 20.0], [39.0, 10.0 if point == "9m" else 60.0], slow]
    name = "full_range_cooperative_retreat" if is_cooperative else "full_range_retreat"
    lines = [f'extends = "{pathlib.Path.cwd() / "missions" / name}.toml"', "[mission]", 'name = "fault_table"',
             f"start_h = {start_h}", f"duration_h = {at_h + after_h - start_h}",
             f"step_s = {steps_of(is_cooperative)}",
             "[[spacecraft]]", 'name = "target"', f'relative = {{ to = "servicer", waypoint = {waypoint} }}',
             "[[spacecraft]]", 'name = "servicer"',
             "[spacecraft.sensors.camera]", f"period_s = {camera}",
             "[spacecraft.sensors.close_camera]", f"period_s = {close_camera}",
             "[navigation.apriori]", 'kind = "roe"']
    lines += [f"sigma_a_{key}_m = {sigma}" for key, sigma in zip(("da", "dlambda", "de", "di"), sigmas)]
    for table in case.faults:
        begin = {} if "event" in table else {"at_h": at_h}
        lines += ["[[fault]]"] + [f"{key} = {toml_of(value)}" for key, value in (begin | table).items()]
    return "\n".join(lines) + "\n"


def needs_nominal(case):
    return case.error_ratio is not None or case.arrival_ratio is not None


def points_of(case):
    return case.points or tuple(POINTS)


def folder_name(*parts):
    return "-".join(map(str, parts)).replace(" ", "_").replace("%", "percent").replace(":", "")


class Flights:
    """The runs of a table, in a folder."""

    def __init__(self, binary, root, pool):
        self.binary, self.root, self.pool = binary, root.resolve(), pool
        self.nominal = {}  # (point, seed, cooperative): future of the errors without a fault

    def run(self, name, text, seed):
        folder = self.root / name
        folder.mkdir(parents=True, exist_ok=True)
        mission = folder / "mission.toml"
        mission.write_text(text)
        result = subprocess.run(["nice", self.binary, "run", str(mission), "--seed", str(seed), "--quiet", "--force", "--out", str(folder / "run")],
                                capture_output=True, text=True)
        if result.returncode not in flights.COMPLETE:
            raise SystemExit(f"{name}: {result.stderr.strip()}")
        return folder / "run"

    def add_nominal(self, point, seed, is_cooperative, after_h):
        """Flown once, before the cases that it is compared with."""
        def fly():
            name = folder_name("nominal_cooperative" if is_cooperative else "nominal", point, seed)
            run = self.run(name, mission_of(Case([], "", None), point, is_cooperative, after_h), seed)
            return Nominal(navigation_errors(run), control_errors(run))
        self.nominal[point, seed, is_cooperative] = self.pool.submit(fly)

    def add_case(self, name, point, seed):
        case, is_cooperative = CASES[name], name in COOPERATIVE
        nominal = self.nominal.get((point, seed, is_cooperative)) if needs_nominal(case) else None

        def fly():
            run = self.run(folder_name(name, point, seed), mission_of(case, point, is_cooperative), seed)
            at_h, _, _, period_s, _ = POINTS[point]
            begin_s = begin_of(run) if any("event" in table for table in case.faults) else 3600.0 * at_h
            return judge(run, case, begin_s, period_s, step_at(at_h, is_cooperative), nominal.result() if nominal else None,
                         sensed_until_s=3600.0 * SLOW_H)
        return self.pool.submit(fly)


def add_nominals(flights, jobs):
    longest_h = {}
    for name, point, seed in jobs:
        case = CASES[name]
        if not needs_nominal(case):
            continue
        key = (point, seed, name in COOPERATIVE)
        after_h = AFTER_H if case.arrival_ratio is not None else window_of(case, 0.0).last_s / 3600.0
        longest_h[key] = max(longest_h.get(key, 0.0), after_h)
    for (point, seed, is_cooperative), after_h in longest_h.items():
        flights.add_nominal(point, seed, is_cooperative, after_h)


def seeds_of(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def row_of(name, point, seed, result):
    def text(value, form="{:.0f}"):
        return "–" if value is None else form.format(value)
    return (f"| {name} | {point} | {seed} | {text(result['reported_s'])} | {text(result['retreat_s'])} | {result['distance_m']:.2f} | "
            f"{text(result['error_ratio'], '{:.2f}')} | {' '.join(result['raised'])} | {', '.join(result['misses'])} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("--seeds", default="1-3", type=seeds_of)
    parser.add_argument("--points", default=",".join(POINTS))
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--jobs", default=2, type=int)
    parser.add_argument("--runs", type=pathlib.Path)
    options = parser.parse_args()
    points, names = options.points.split(","), options.cases.split(",")
    for chosen, known in ((points, POINTS), (names, CASES)):
        for word in chosen:
            if word not in known:
                parser.error(f"{word}: accepted: {', '.join(known)}")
    jobs = [(name, point, seed) for seed in options.seeds for name in names for point in points if point in points_of(CASES[name])]
    failed = 0
    with tempfile.TemporaryDirectory(prefix="vbar-faults-") as scratch, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        flights = Flights(options.binary, options.runs or pathlib.Path(scratch), pool)
        add_nominals(flights, jobs)
        futures = [flights.add_case(*job) for job in jobs]
        print("| fault | point | seed | reported after, s | retreat after, s | distance, m | error | raised | missed |\n|" + "---|" * 9, flush=True)
        for job, future in zip(jobs, futures):
            try:
                result = future.result()
            except JudgementError as error:
                raise SystemExit(f"{', '.join(map(str, job))}: {error}") from None
            failed += bool(result["misses"])
            print(row_of(*job, result), flush=True)
    print(f"\n{len(jobs)} cases, {failed} miss their row")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
