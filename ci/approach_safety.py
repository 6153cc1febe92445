"""What the runs of an approach with a table [safety] show of their safety; used by ci/verify_full_range.py.

A table without rows or columns, or a number that is not finite, ends the script: it is never a good figure.
"""
import bisect
import collections
import csv
import math

GUARD = ("guard_range", "guard_silence", "guard_burns", "guard_closing")
RETREAT = ("retreat", "drift_unsafe", "collision_probability")
# Tables of records, with the column and the values of those that updated the estimate.
RECORDS = (("images.csv", lambda row: row["fate"] in ("filter", "batch")),
           ("poses.csv", lambda row: row["fate"] == "keypoints"),
           ("gnss.csv", lambda row: int(row["codes_used"]) + int(row["phases_used"]) > 0))


def rows(file):
    """At least one."""
    with open(file, newline="") as content:
        found = list(csv.DictReader(content))
    if not found:
        raise SystemExit(f"{file}: no rows")
    return found


def number(row, column, file):
    value = float(row[column])
    if not math.isfinite(value):
        raise SystemExit(f"{file}: {column} is {row[column]} at {row['time_s']} s")
    return value


def faults(folder):
    """Number of times that each fault was raised."""
    with open(folder / "telemetry_event.csv", newline="") as content:
        table = csv.DictReader(content)
        if table.fieldnames is None or "fault" not in table.fieldnames:
            raise SystemExit(f"{folder / 'telemetry_event.csv'}: no column fault")
        return collections.Counter(row["fault"] for row in table if row["event"] == "fault_raised")


def largest_probability(folder):
    """Of a collision after the retreat burn of a step; that with an unknown position along track is not a criterion."""
    file = folder / "telemetry_safety.csv"
    return max(number(row, "collision_probability", file) for row in rows(file))


def longest_gap_s(folder, from_s, to_s):
    """Between records that updated the estimate, and the longest time in which images showed no sunlit target."""
    used, lit = [], []
    for name, is_used in RECORDS:
        if not (folder / name).exists():
            continue
        for row in rows(folder / name):
            time_s = float(row["time_s"])
            if from_s <= time_s <= to_s:
                if is_used(row):
                    used.append(time_s)
                if row.get("sunlit") == "1":
                    lit.append(time_s)
    return longest(used, from_s, to_s), longest(lit, from_s, to_s)


def longest(times_s, from_s, to_s):
    edges = [from_s, *sorted(times_s), to_s]
    return max(b - a for a, b in zip(edges, edges[1:]))


def largest_sigma_share(folder, from_s, to_s):
    """Standard deviation along track over the true distance."""
    file = folder / "truth.csv"
    truth = rows(file)
    times_s = [float(row["time_s"]) for row in truth]
    share = 0.0
    for row in rows(folder / "estimate.csv"):
        time_s = float(row["time_s"])
        if not from_s <= time_s <= to_s:
            continue
        at = bisect.bisect_left(times_s, time_s)
        if row["navigation_valid"] != "1" or at == len(truth) or times_s[at] != time_s:
            return math.inf
        range_m = math.hypot(*(number(truth[at], f"relative_position_rtn_{axis}_m", file) for axis in "rtn"))
        share = max(share, number(row, "sigma_rtn_t_m", folder / "estimate.csv") / range_m)
    return share
