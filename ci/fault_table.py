#!/usr/bin/env python3
"""Every fault of docs/faults.md at points of the approach: what was reported and when, and the distance kept for a day.

    ci/fault_table.py BINARY [--seeds 1-3] [--points 10km,300m,40m,9m] [--cases NAME,...] [--jobs 2] [--runs FOLDER]

BINARY is a built vbar; the working directory is the root of the repository. Each case is missions/full_range_retreat.toml from the
waypoint before its point, with one fault, for 24 h after it. `distance` is the least true one from centre to centre since the fault
began, of which 2.0 m are required (1.0 m without an operational thruster); `reported` the time until the event, against its limit.
Run folders are kept with --runs, and are otherwise deleted. The exit status is 1 if a case misses its row.
"""
import argparse
import concurrent.futures
import csv
import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile

# name: hour of the fault, start and its waypoint, image period there (s), a-priori sigmas (m) of a da, a dlambda, a de, a di
POINTS = {
    "10km": (16.5, 12.0, 2, 60.0, (0.1, 4.0, 0.15, 0.1)),
    "300m": (30.8, 28.0, 5, 60.0, (0.03, 0.45, 0.04, 0.04)),
    "40m": (37.9, 36.0, 7, 20.0, (0.02, 0.3, 0.03, 0.03)),
    "9m": (39.8, 39.0, 8, 60.0, (0.01, 0.05, 0.02, 0.02)),
}
ALL = tuple(POINTS)
NEAR = ("40m", "9m")
AFTER_H = 24.0


@dataclasses.dataclass
class Case:
    faults: list            # tables of [[fault]], without at_h
    event: str              # fault that the flight software must raise
    within: object          # s, or a function of the image period; None: with the burns, whenever they are
    points: tuple = ALL
    distance_m: float = 2.0
    retreats: object = None  # True: must, False: must not, None: may
    sources: tuple = ()      # sources that must be aiding again at the end
    within_burns: object = None  # the number of burns from the fault on with which it must be reported


def fault(kind, **keys):
    return {"kind": kind, **keys}


CASES = {
    "none": Case([], "", None, retreats=False),
    "camera silent 30 min": Case([fault("silent", unit="camera", for_s=1800.0)], "images_missing", lambda p: 4 * p + 60.0, sources=("bearings",),
                                 points=("10km", "300m")),
    "cameras silent 30 min": Case([fault("silent", unit=u, for_s=1800.0) for u in ("camera", "close_camera")], "images_missing",
                                  lambda p: 4 * p + 60.0, points=NEAR),
    "cameras silent for ever": Case([fault("silent", unit=u) for u in ("camera", "close_camera")], "guard_silence", 2200.0 + 1800.0, points=NEAR,
                                    retreats=True),
    "image frozen 5 min": Case([fault("frozen", unit="camera", for_s=300.0)], "image_frozen", lambda p: 2 * p + 60.0, points=("10km", "300m", "40m")),
    "close images frozen 5 min": Case([fault("frozen", unit="close_camera", for_s=300.0)], "image_frozen", lambda p: 2 * p + 10.0, points=("9m",)),
    "star tracker 1 deg 10 min": Case([fault("attitude_error", unit="gnss", value_deg=1.0, for_s=600.0)], "attitude", lambda p: 3 * p,
                                      retreats=False),
    "receiver silent 1 h": Case([fault("receiver_silent", unit="gnss", for_s=3600.0)], "receiver_silent", lambda p: 20.0 + p, retreats=False),
    "network wrong by 90 deg 60 s": Case([fault("target_turned", unit=u, value_deg=90.0, for_s=60.0) for u in ("camera", "close_camera")], "pose_network",
                                         lambda p: 65.0 if p < 60.0 else 35.0,  # images every 20 and 10 s
                                         points=NEAR, retreats=False),
    "thruster off": Case([fault("thrust_scale", value=0.0)], "thruster", None, distance_m=1.0, within_burns=2),
    "thruster on 10 s": Case([fault("thrust_uncommanded", value_mps2=1e-3, direction_rtn=[0.0, 1.0, 0.0], for_s=10.0)], "burn_uncommanded", 61.0,
                             retreats=True),
    "burns 10 % short": Case([fault("thrust_scale", value=0.9)], "burn_size", None, retreats=False, within_burns=3),
    "reboot warm 60 s": Case([fault("computer_reboot", for_s=60.0, keeps_state=True)], "restart", lambda p: 60.0 + 2 * p, retreats=False),
    "reboot cold 60 s": Case([fault("computer_reboot", for_s=60.0)], "", None),
    "silent for 3 steps": Case([fault("computer_silent", for_s=181.0)], "step_late", lambda p: 181.0 + 2 * p, retreats=False),
}


def toml_of(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value)


def mission_of(case, point):
    at_h, start_h, waypoint, _, sigmas = POINTS[point]
    slow_h = 41.5  # from then on, images of every fifth minute
    lines = [f'extends = "{pathlib.Path.cwd() / "missions/full_range_retreat.toml"}"', "[mission]", 'name = "fault_table"',
             f"start_h = {start_h}", f"duration_h = {at_h + AFTER_H - start_h}",
             f"step_s = [[0.0, 60.0], [36.0, 20.0], [38.5, 5.0], [{slow_h}, 60.0]]",
             "[[spacecraft]]", 'name = "target"', f'relative = {{ to = "servicer", waypoint = {waypoint} }}',
             "[[spacecraft]]", 'name = "servicer"',
             "[spacecraft.sensors.camera]", f"period_s = [[0.0, 60.0], [36.0, 20.0], [39.0, 60.0], [{slow_h}, 300.0]]",
             "[spacecraft.sensors.close_camera]", f"period_s = [[38.25, 20.0], [39.0, 10.0], [{slow_h}, 300.0]]",
             "[navigation.apriori]", 'kind = "roe"']
    lines += [f"sigma_a_{key}_m = {sigma}" for key, sigma in zip(("da", "dlambda", "de", "di"), sigmas)]
    for table in case.faults:
        lines += ["[[fault]]", f"at_h = {at_h}"] + [f"{key} = {toml_of(value)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def fly(binary, folder, name, point, seed):
    case = CASES[name]
    folder.mkdir(parents=True, exist_ok=True)
    mission = folder / "mission.toml"
    mission.write_text(mission_of(case, point))
    run = folder / "run"
    result = subprocess.run(["nice", binary, "run", str(mission), "--seed", str(seed), "--quiet", "--force", "--out", str(run)],
                            capture_output=True, text=True)
    if result.returncode not in (0, 10):
        raise SystemExit(f"{name}, {point}, seed {seed}: {result.stderr.strip()}")
    return judge(run, case, point)


def rows_of(file):
    with file.open(newline="") as content:
        return list(csv.DictReader(content))


def judge(run, case, point):
    """What the run shows, and the list of what it misses."""
    begin_s, period_s = 3600.0 * POINTS[point][0], POINTS[point][3]
    summary = json.loads((run / "summary.json").read_text())
    events = rows_of(run / "telemetry_event.csv")
    raised = [e for e in events if e["event"] == "fault_raised" and float(e["step_time_s"]) >= begin_s]
    reported_s = min((float(e["step_time_s"]) - begin_s for e in raised if e["fault"] == case.event), default=None)
    retreat_s = min((float(e["step_time_s"]) - begin_s for e in raised if e["fault"] == "retreat"), default=None)
    aid = {e["device"]: e["after"] for e in events if e["event"] == "aid"}
    truth = [(float(r["time_s"]), float(r["range_m"])) for r in distances(run)]
    distance_m = min(d for t, d in truth if t >= begin_s)
    figures = summary["sensor_figures"].get("faults", {})
    misses = []
    if case.faults and not figures.get("without_effect", 0) < figures.get("injected", 0):
        misses.append("no effect")  # of one of two cameras it is enough
    if figures:
        distance_m = min(distance_m, figures["min_distance_m"])
    if not distance_m >= case.distance_m:
        misses.append("distance")
    if case.event and reported_s is None:
        misses.append("not reported")
    if case.within is not None and reported_s is not None:
        limit_s = case.within(period_s) if callable(case.within) else case.within
        if reported_s > limit_s:
            misses.append(f"reported later than {limit_s:.0f} s")
    if case.within_burns is not None and reported_s is not None:
        burns = sum(begin_s <= float(r["execution_time_s"]) <= begin_s + reported_s for r in rows_of(run / "maneuvers.csv"))
        if burns > case.within_burns:
            misses.append(f"reported at burn {burns}, not {case.within_burns}")
    if case.retreats is not None and case.retreats != (retreat_s is not None):
        misses.append("retreats" if retreat_s is not None else "does not retreat")
    for source in case.sources:
        if aid.get(source) not in ("aiding", "suspended"):
            misses.append(f"{source} {aid.get(source)}")
    return {"distance_m": distance_m, "reported_s": reported_s, "retreat_s": retreat_s, "misses": misses,
            "raised": sorted({e["fault"] for e in raised})}


def distances(run):
    for row in rows_of(run / "truth.csv"):
        yield {"time_s": row["time_s"], "range_m": sum(float(row[f"relative_position_rtn_{k}_m"]) ** 2 for k in "rtn") ** 0.5}


def seeds_of(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


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
    jobs = [(name, point, seed) for seed in options.seeds for name in names for point in points if point in CASES[name].points]
    failed = 0
    with tempfile.TemporaryDirectory(prefix="vbar-faults-") as scratch, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        root = options.runs or pathlib.Path(scratch)
        print("| fault | point | seed | reported after, s | retreat after, s | distance, m | raised | missed |\n|---|---|---|---|---|---|---|---|", flush=True)
        futures = [pool.submit(fly, options.binary, (root / f"{name}-{point}-{seed}".replace(" ", "_").replace("%", "percent")).resolve(), name, point, seed)
                   for name, point, seed in jobs]
        for (name, point, seed), future in zip(jobs, futures):
            result = future.result()
            failed += bool(result["misses"])
            text = lambda value: "–" if value is None else f"{value:.0f}"
            print(f"| {name} | {point} | {seed} | {text(result['reported_s'])} | {text(result['retreat_s'])} | {result['distance_m']:.2f} | "
                  f"{' '.join(result['raised'])} | {', '.join(result['misses'])} |", flush=True)
    print(f"\n{len(jobs)} cases, {failed} miss their row")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
