"""The whole mission by two cameras over ten seeds: a section of docs/verification.md."""
import concurrent.futures
import csv
import statistics

from consistency import HEAD, table_of
from flights import fly

MISSION = "missions/full_range.toml"
SEEDS = range(1, 11)
WAYPOINTS = range(1, 11)
# Medians over the seeds, m; the worst seed may have three times as much.
NAVIGATION_LIMITS = (5, 2.5, 0.7, 0.5, 0.7, 0.6, 0.6, 0.08, 0.015, 0.02)
CONTROL_LIMITS = (5, 3, 1.5, 0.8, 0.8, 0.8, 0.8, 0.10, 0.02, 0.02)
WORST = 3.0
# Delta-v of legs: name, waypoints at their ends, limit in m/s.
LEGS = (("legs 0 to 7", range(1, 8), 4.2), ("leg 7 to 8", (8,), 9e-3), ("legs 8 to 10", (9, 10), 6.9e-3))
ATTITUDE_FROM_M = 50.0
ATTITUDE_LIMIT_DEG = 1.5


def at_waypoint(summary, index, key):
    """Infinite if navigation had no valid state there."""
    value = next(w[key] for w in summary["waypoints"] if w["index"] == index)
    return float("inf") if value is None else value


def metres(value):
    return "lost" if value == float("inf") else f"{value:.3g} m" if value < 1 else f"{value:.2f} m"


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


def attitudes(folder):
    """Median error from ATTITUDE_FROM_M on, deg, and whether the attitude was known before waypoint 8."""
    errors, first_s = [], float("inf")
    with open(folder / "poses.csv", newline="") as file:
        for row in csv.DictReader(file):
            if not row["attitude_error_deg"]:
                continue
            first_s = min(first_s, float(row["time_s"]))
            if float(row["range_m"]) <= ATTITUDE_FROM_M:
                errors.append(float(row["attitude_error_deg"]))
    return (statistics.median(errors) if errors else float("inf")), first_s < 39 * 3600


def other_rows(flown, folders, alone):
    """(what, median, worst, limit, met)."""
    def row(what, values, limit, text):
        median = statistics.median(values)
        return (what, text(median), text(max(values)), text(limit), median <= limit)

    rows = []
    for name, ends, limit in LEGS:
        burnt = [sum(at_waypoint(s, index, "leg_dv_mps") for index in ends) for s in flown]
        text = (lambda v: f"{v:.3f} m/s") if limit > 1 else (lambda v: f"{1e3 * v:.2f} mm/s")
        rows.append(row(f"delta-v, {name}", burnt, limit, text))
    found = [attitudes(folder) for folder in folders]
    rows.append(row(f"attitude error from {ATTITUDE_FROM_M:g} m on, median", [error for error, _ in found],
                    ATTITUDE_LIMIT_DEG, lambda v: f"{v:.2f} deg"))
    known = sum(is_known for _, is_known in found)
    rows.append(("seeds with an attitude before waypoint 8", str(known), "", str(len(flown)), known == len(flown)))
    rows.append(("times real time, in process, seed 1 alone", f"{alone['speed_factor']:.0f}", "", "at least 400",
                 alone["speed_factor"] >= 400.0))
    return rows


def section(build, root, runs, table):
    """The lines of the section and whether all limits are met. `table(head, rows)` writes a table."""
    yes = lambda good: "yes" if good else "**no**"
    print(f"flying: {MISSION}", flush=True)
    folders = [runs / f"full_range-{seed}" for seed in SEEDS]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        flown = list(pool.map(lambda seed, folder: fly(build, root, MISSION, folder, seed), SEEDS, folders))
    print("flying: the same alone, to measure its speed", flush=True)
    alone = fly(build, root, MISSION, runs / "full_range-alone", 1)
    hashes = ("commands_sha256", "telemetry_sha256")
    same = all(alone[key] == flown[0][key] for key in hashes)
    waypoints, others = waypoint_rows(flown), other_rows(flown, folders, alone)
    printed = lambda rows: [(*row[:-1], yes(row[-1])) for row in rows]
    lines = [
        "## The whole mission by two cameras",
        "",
        f"Waypoints 0 to 10, 41.25 h, `{MISSION}`, in process, seeds {SEEDS[0]} to {SEEDS[-1]}. Limits hold for the medians; the worst"
        f" seed may have {WORST:g} times as much at a waypoint.",
        "",
        table(["waypoint", "navigation error", "worst", "limit", "control error", "worst", "limit", "met"], printed(waypoints)),
        "",
        table(["quantity", "median", "worst", "limit", "met"], printed(others)),
        "",
    ]
    for name, column, title in (("images.csv", "nees", "NEES of the relative orbit, at bearings"),
                                ("poses.csv", "nees", "NEES of the relative orbit, at keypoints"),
                                ("poses.csv", "attitude_nees", "NEES of attitude and rate")):
        lines += [f"{title} (6 expected):", "", table(HEAD, list(table_of(folders, name, column))), ""]
    lines += [f"The run of seed 1 alone has the same hashes: {yes(same)} (commands `{alone['commands_sha256'][:16]}…`). It was not"
              " flown on the emulated Zynq.", ""]
    return lines, same and all(s["complete"] for s in flown) and all(row[-1] for row in waypoints + others)
