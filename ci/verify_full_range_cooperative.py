"""The whole mission to a target that cooperates from waypoint 4 on, over ten seeds: a section of docs/verification.md."""
import concurrent.futures
import csv
import statistics

from consistency import HEAD, table_of
from flights import fly
from verify_full_range import CONTROL_LIMITS, LEGS, WORST, WAYPOINTS, at_waypoint, metres

MISSION = "missions/full_range_cooperative.toml"
SEEDS = range(1, 11)
# Medians over the seeds, m; the worst seed may have three times as much.
NAVIGATION_LIMITS = (5, 2.5, 0.7, 0.5, 0.03, 0.015, 0.010, 0.008, 0.008, 0.008)
# The cameras against the orbit by carrier phase: normalised innovation squared per degree of freedom, mean of a run.
NIS_LIMITS = (0.5, 1.5)
COOPERATES_FROM_S = 24 * 3600.0
# After an hour in which the slew ends, the integers are found and the cameras are calibrated.
CALIBRATED_FROM_S = 25 * 3600.0
BEARING_DEGREES = 2


def waypoint_rows(flown):
    """(waypoint, navigation: median, worst, limit; control likewise, met)."""
    rows = []
    for index, *limits in zip(WAYPOINTS, NAVIGATION_LIMITS, CONTROL_LIMITS):
        row, met = [index], True
        for key, limit in zip(("navigation_error_m", "control_error_m"), limits):
            values = [at_waypoint(s, index, key) for s in flown]
            median = statistics.median(values)
            row += [metres(median), metres(max(values)), metres(limit)]
            met = met and median <= limit and max(values) <= WORST * limit
        rows.append((*row, met))
    return rows


def innovations(folder, name):
    """Mean NIS per degree of freedom of the bearings or poses that were used, from CALIBRATED_FROM_S on."""
    sums, count = 0.0, 0
    with open(folder / name, newline="") as file:
        for row in csv.DictReader(file):
            used = row["fate"] in (("filter",) if name == "images.csv" else ("keypoints",))
            if not used or float(row["time_s"]) < CALIBRATED_FROM_S:
                continue
            degrees = BEARING_DEGREES if name == "images.csv" else float(row["nis_degrees"])
            if degrees > 0:
                sums += float(row["nis"]) / degrees
                count += 1
    return sums / count if count else float("inf")


def other_rows(flown, folders):
    """(what, median, least and greatest, limit, met)."""
    rows = []
    for name, ends, limit in LEGS:
        burnt = [sum(at_waypoint(s, index, "leg_dv_mps") for index in ends) for s in flown]
        text = (lambda v: f"{v:.3f} m/s") if limit > 1 else (lambda v: f"{1e3 * v:.2f} mm/s")
        median = statistics.median(burnt)
        rows.append((f"delta-v, {name}", text(median), f"{text(min(burnt))} to {text(max(burnt))}", text(limit), median <= limit))
    for name, what in (("images.csv", "bearings"), ("poses.csv", "keypoints")):
        values = [innovations(folder, name) for folder in folders]
        median = statistics.median(values)
        rows.append((f"NIS of used {what} per degree of freedom, mean from 25 h on", f"{median:.2f}",
                     f"{min(values):.2f} to {max(values):.2f}", f"{NIS_LIMITS[0]:g} to {NIS_LIMITS[1]:g}",
                     NIS_LIMITS[0] <= median <= NIS_LIMITS[1]))
    fixed = [s["first_fix_s"] - COOPERATES_FROM_S if s["first_fix_s"] is not None else float("inf") for s in flown]
    rows.append(("first integers after the crosslink begins", f"{statistics.median(fixed):.0f} s",
                 f"{min(fixed):.0f} to {max(fixed):.0f} s", "", True))
    return rows


def section(build, root, runs, table, seeds=SEEDS):
    """The lines of the section and whether all limits are met. `table(head, rows)` writes a table."""
    yes = lambda good: "yes" if good else "**no**"
    print(f"flying: {MISSION}", flush=True)
    folders = [runs / f"full_range_cooperative-{seed}" for seed in seeds]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        flown = list(pool.map(lambda seed, folder: fly(build, root, MISSION, folder, seed), seeds, folders))
    return lines_of(flown, folders, seeds, table, yes)


def lines_of(flown, folders, seeds, table, yes):
    """The section of runs that have been flown."""
    waypoints, others = waypoint_rows(flown), other_rows(flown, folders)
    printed = lambda rows: [(*row[:-1], yes(row[-1])) for row in rows]
    lines = [
        "## The whole mission to a cooperating target",
        "",
        f"Waypoints 0 to 10, 41.25 h, `{MISSION}`, in process, seeds {seeds[0]} to {seeds[-1]}. From waypoint 4 on (1 km, 24 h) the"
        " target leaves its tumble, points at the zenith and sends its receiver's data; both cameras continue in the same filter."
        f" Limits hold for the medians; the worst seed may have {WORST:g} times as much at a waypoint.",
        "",
        table(["waypoint", "navigation error", "worst", "limit", "control error", "worst", "limit", "met"], printed(waypoints)),
        "",
        table(["quantity", "median", "range", "limit", "met"], printed(others)),
        "",
    ]
    for name, column, title in (("images.csv", "nees", "NEES of the relative orbit, at bearings"),
                                ("poses.csv", "nees", "NEES of the relative orbit, at keypoints"),
                                ("poses.csv", "attitude_nees", "NEES of attitude and rate")):
        lines += [f"{title} (6 expected):", "", table(HEAD, list(table_of(folders, name, column))), ""]
    return lines, all(s["complete"] for s in flown) and all(row[-1] for row in waypoints + others)
