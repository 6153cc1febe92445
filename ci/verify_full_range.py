"""The whole mission over ten seeds, by two cameras and to a target that cooperates from waypoint 4 on: sections of
docs/verification.md."""
import concurrent.futures
import csv
import dataclasses
import statistics

import approach_safety as safety
from consistency import HEAD, table_of
from flights import ZYNQ, fly

WAYPOINTS = range(1, 11)
# Medians over the seeds, m; the worst seed may have three times as much.
CONTROL_LIMITS = (5, 3, 1.5, 0.8, 0.8, 0.8, 0.8, 0.10, 0.02, 0.02)
WORST = 3.0
# Delta-v of legs: name, waypoints at their ends, limit in m/s.
LEGS = (("legs 0 to 7", range(1, 8), 4.2), ("leg 7 to 8", (8,), 9e-3), ("legs 8 to 10", (9, 10), 6.9e-3))
ATTITUDE_FROM_M = 50.0
ATTITUDE_LIMIT_DEG = 1.5
FROM_7_S, TO_8_S = 36 * 3600.0, 39 * 3600.0
SIGMA_LIMIT = 0.10
PROBABILITY_LIMIT = 1e-4
# The cameras against the orbit by carrier phase: normalised innovation squared per degree of freedom, mean of a run.
NIS_LIMITS = (0.5, 1.5)
COOPERATES_FROM_S = 24 * 3600.0
# After an hour in which the slew ends, the integers are found and the cameras are calibrated.
CALIBRATED_FROM_S = 25 * 3600.0
BEARING_DEGREES = 2
SPEED_LIMIT = 400.0


def at_waypoint(summary, index, key):
    """Infinite if navigation had no valid state there."""
    value = next(w[key] for w in summary["waypoints"] if w["index"] == index)
    return float("inf") if value is None else value


def metres(value):
    return "lost" if value == float("inf") else f"{value:.3g} m" if value < 1 else f"{value:.2f} m"


def waypoint_rows(flown, navigation_limits):
    """(waypoint, navigation: median, worst, limit; control likewise, met)."""
    found = []
    for index, *limits in zip(WAYPOINTS, navigation_limits, CONTROL_LIMITS):
        row, met = [index], True
        for key, limit in zip(("navigation_error_m", "control_error_m"), limits):
            values = [at_waypoint(s, index, key) for s in flown]
            median = statistics.median(values)
            row += [metres(median), metres(max(values)), metres(limit)]
            met = met and median <= limit and max(values) <= WORST * limit
        found.append((*row, met))
    return found


def row_of(what, values, limit, text, judged=statistics.median):
    """(what, median, worst, limit, met). The limit holds for what `judged` makes of the values: max if every run must meet it."""
    return (what, text(statistics.median(values)), text(max(values)), text(limit), judged(values) <= limit)


def leg_rows(flown):
    found = []
    for name, ends, limit in LEGS:
        burnt = [sum(at_waypoint(s, index, "leg_dv_mps") for index in ends) for s in flown]
        text = (lambda v: f"{v:.3f} m/s") if limit > 1 else (lambda v: f"{1e3 * v:.2f} mm/s")
        found.append(row_of(f"delta-v, {name}", burnt, limit, text))
    return found


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
    return (statistics.median(errors) if errors else float("inf")), first_s < TO_8_S


def attitude_rows(flown, folders):
    found = [attitudes(folder) for folder in folders]
    known = sum(is_known for _, is_known in found)
    return [row_of(f"attitude error from {ATTITUDE_FROM_M:g} m on, median", [error for error, _ in found], ATTITUDE_LIMIT_DEG,
                       lambda v: f"{v:.2f} deg"),
            ("seeds with an attitude before waypoint 8", str(known), "", str(len(flown)), known == len(flown))]


def safety_rows(folders):
    gaps = [safety.longest_gap_s(folder, FROM_7_S, TO_8_S) for folder in folders]
    alarms = [safety.faults(folder) for folder in folders]
    seconds = lambda v: f"{v:.0f} s"
    return [
        ("waypoints 7 to 8: longest time without a record, against the longest without a sunlit image", seconds(max(gap for gap, _ in gaps)),
         "", seconds(max(dark for _, dark in gaps)), all(gap <= dark for gap, dark in gaps)),
        row_of("waypoints 7 to 8: sigma along track, share of the range", [safety.largest_sigma_share(f, FROM_7_S, TO_8_S) for f in folders],
                SIGMA_LIMIT, lambda v: f"{100 * v:.1f} %", max),
        row_of("collision probability, greatest", [safety.largest_probability(f) for f in folders], PROBABILITY_LIMIT, lambda v: f"{v:.1g}", max),
        row_of("alarms of the guard", [sum(a[name] for name in safety.GUARD) for a in alarms], 0, str, max),
        row_of("retreats, and drifts that call for one", [sum(a[name] for name in safety.RETREAT) for a in alarms], 0, str, max),
    ]


def other_faults(folders):
    """A sentence with the faults that were raised, other than those of safety_rows()."""
    total, runs = {}, {}
    for folder in folders:
        for name, count in safety.faults(folder).items():
            if name not in safety.GUARD + safety.RETREAT:
                total[name] = total.get(name, 0) + count
                runs[name] = runs.get(name, 0) + 1
    if not total:
        return "No fault was raised."
    return "Faults raised: " + ", ".join(f"`{name}` {total[name]} times in {runs[name]} runs" for name in sorted(total)) + "."


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


def cross_check_rows(flown, folders):
    found = []
    low, high = NIS_LIMITS
    for name, what in (("images.csv", "bearings"), ("poses.csv", "keypoints")):
        values = [innovations(folder, name) for folder in folders]
        found.append((f"NIS of used {what} per degree of freedom, mean from 25 h on", f"{statistics.median(values):.2f}",
                      f"{min(values):.2f} to {max(values):.2f}", f"{low:g} to {high:g}", all(low <= value <= high for value in values)))
    fixed = [s["first_fix_s"] - COOPERATES_FROM_S if s["first_fix_s"] is not None else float("inf") for s in flown]
    found.append(("first integers after the crosslink begins", f"{statistics.median(fixed):.0f} s", f"{max(fixed):.0f} s", "",
                  max(fixed) < float("inf")))
    return found


@dataclasses.dataclass(frozen=True)
class Variant:
    name: str
    title: str
    mission: str
    navigation_limits: tuple  # at the waypoints, m
    rows: object              # of summaries and folders: rows of its own
    text: str
    seeds: range = range(1, 11)

    def section(self, build, root, runs, table):
        """The lines of the section and whether all limits are met. `table(head, rows)` writes a table."""
        print(f"flying: {self.mission}", flush=True)
        folders = [runs / f"{self.name}-{seed}" for seed in self.seeds]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            flown = list(pool.map(lambda seed, folder: fly(build, root, self.mission, folder, seed, reuse=True), self.seeds, folders))
        print("flying: the same alone, to measure its speed, and on the emulated Zynq", flush=True)
        alone = fly(build, root, self.mission, runs / f"{self.name}-alone", self.seeds[0])
        zynq = fly(build, root, self.mission, runs / f"{self.name}-zynq", self.seeds[0], ZYNQ, reuse=True)
        return self.lines_of(flown, folders, alone, zynq, table)

    def lines_of(self, flown, folders, alone, zynq, table):
        """The section of runs that have been flown."""
        yes = lambda good: "yes" if good else "**no**"
        same = lambda s: all(s[key] == flown[0][key] for key in ("commands_sha256", "telemetry_sha256"))
        waypoints = waypoint_rows(flown, self.navigation_limits)
        others = leg_rows(flown) + self.rows(flown, folders) + safety_rows(folders)
        speed = alone["speed_factor"]
        others.append(("times real time, in process, first seed alone", f"{speed:.0f}", "", f"at least {SPEED_LIMIT:g}", speed >= SPEED_LIMIT))
        printed = lambda rows: [(*row[:-1], yes(row[-1])) for row in rows]
        lines = [
            f"## {self.title}", "",
            f"Waypoints 0 to 10, 41.25 h, `{self.mission}`, in process, seeds {self.seeds[0]} to {self.seeds[-1]}. {self.text} Limits hold for"
            f" the medians; the worst seed may have {WORST:g} times as much at a waypoint.", "",
            table(["waypoint", "navigation error", "worst", "limit", "control error", "worst", "limit", "met"], printed(waypoints)), "",
            table(["quantity", "median", "worst or range", "limit", "met"], printed(others)), "",
            other_faults(folders), "",
        ]
        for name, column, title in (("images.csv", "nees", "NEES of the relative orbit, at bearings"),
                                    ("poses.csv", "nees", "NEES of the relative orbit, at keypoints"),
                                    ("poses.csv", "attitude_nees", "NEES of attitude and rate")):
            lines += [f"{title} (6 expected):", "", table(HEAD, list(table_of(folders, name, column))), ""]
        step = zynq["flight_step"]
        lines += [f"The first seed has the same hashes alone: {yes(same(alone))} (commands `{alone['commands_sha256'][:16]}…`), and on the"
                  f" emulated Zynq over Ethernet: {yes(same(zynq))}, {zynq['wall_s']:.0f} s of wall-clock time; a step takes at most"
                  f" {step['max']:,} {step['unit']} and {step['stack_bytes_max']:,} bytes of stack.", ""]
        met = all(row[-1] for row in waypoints + others) and all(s["complete"] for s in (*flown, alone, zynq)) and same(alone) and same(zynq)
        return lines, met


CAMERAS = Variant(
    name="full_range",
    title="The whole mission by two cameras",
    mission="missions/full_range_retreat.toml",
    navigation_limits=(5, 2.5, 0.7, 0.5, 0.7, 0.6, 0.6, 0.08, 0.015, 0.02),
    rows=attitude_rows,
    text="Drifts are assessed, and a guard and a retreat stand by.")
COOPERATIVE = Variant(
    name="full_range_cooperative",
    title="The whole mission to a cooperating target",
    mission="missions/full_range_cooperative_retreat.toml",
    navigation_limits=(5, 2.5, 0.7, 0.5, 0.03, 0.015, 0.010, 0.008, 0.008, 0.008),
    rows=cross_check_rows,
    text="From waypoint 4 on (1 km, 24 h) the target leaves its tumble, points at the zenith and sends its receiver's data; both cameras"
         " continue in the same filter. Drifts are assessed, and a guard and a retreat stand by.")
