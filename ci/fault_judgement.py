"""What a run of ci/fault_table.py shows, and what it misses of its row.

Figures come from the tables of the run folder. One that is missing, empty or not finite where the row needs it ends the judgement
(JudgementError) or is a miss; it never passes.
"""
import bisect
import csv
import dataclasses
import json
import math
import statistics


class JudgementError(Exception):
    """The run folder does not hold what its judgement needs."""


@dataclasses.dataclass
class Case:
    faults: list             # tables of [[fault]], without at_h
    event: object            # the fault that the flight software must raise, or several of which any counts; "": none
    within: object           # s, or a function of the periods of images and steps; None: with the burns, whenever they are
    points: tuple = ()       # at which it is flown; empty: all
    distance_m: float = 2.0
    retreats: object = None  # True: must, False: must not, None: may
    sources: tuple = ()      # sources that must be aiding again at the end
    within_burns: object = None  # the number of burns from the fault on with which it must be reported
    error_ratio: object = None   # navigation error against the nominal run, at most; from error_from_s after the start on, to
    error_from_s: float = 0.0    # an hour after the end
    error_m: object = None       # navigation error over the same time from the start on, at most
    fixed_within_s: object = None  # fixed integers again, after the end
    valid_within_s: object = None  # a valid estimate again, after the end
    arrival_ratio: object = None   # larger control error of the next two waypoints against the nominal run, at most


@dataclasses.dataclass
class Nominal:
    """What the run without the fault shows."""
    navigation_errors: list
    control_errors: list


@dataclasses.dataclass
class Window:
    """Seconds since the epoch: the fault, and the hour after it over which errors are compared."""
    begin_s: float
    end_s: float

    @property
    def last_s(self):
        return self.end_s + 3600.0


def window_of(case, begin_s):
    """A fault without an end is judged over its first hour."""
    return Window(begin_s, begin_s + max((table.get("for_s", 0.0) for table in case.faults), default=0.0))


def number_of(text, what):
    """A finite number."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise JudgementError(f"{what} is {text!r}, not a number")
    return number


def rows_of(file, columns=()):
    """Rows of a table that must have these columns."""
    try:
        with file.open(newline="") as content:
            table = csv.DictReader(content)
            rows = list(table)
    except OSError as error:
        raise JudgementError(f"{file}: {error.strerror}") from None
    missing = [name for name in columns if name not in (table.fieldnames or ())]
    if missing:
        raise JudgementError(f"{file}: no column {', '.join(missing)}")
    return rows


POSITION = [f"relative_position_rtn_{axis}_m" for axis in "rtn"]


def distances(run):
    """(time, true distance from centre to centre) of each step."""
    rows = rows_of(run / "truth.csv", ["time_s", *POSITION])
    if not rows:
        raise JudgementError(f"{run / 'truth.csv'}: no rows")
    return [(number_of(row["time_s"], "time_s"), math.hypot(*(number_of(row[name], name) for name in POSITION))) for row in rows]


def navigation_errors(run):
    """(time, length of the estimated relative position minus the true one) of each step with a valid estimate."""
    truth = {row["time_s"]: row for row in rows_of(run / "truth.csv", ["time_s", *POSITION])}
    errors = []
    for row in rows_of(run / "estimate.csv", ["time_s", "navigation_valid", *POSITION]):
        if row["navigation_valid"] != "1":
            continue
        true = truth.get(row["time_s"])
        if true is None:
            raise JudgementError(f"{run}: an estimate at {row['time_s']} s without a truth")
        errors.append((number_of(row["time_s"], "time_s"),
                       math.hypot(*(number_of(row[name], name) - number_of(true[name], name) for name in POSITION))))
    return errors


def control_errors(run):
    """(time, control error) of each waypoint that was reached."""
    return [(number_of(row["time_s"], "time_s"), number_of(row["control_error_m"], "control_error_m"))
            for row in rows_of(run / "waypoints.csv", ["time_s", "control_error_m"]) if row["control_error_m"]]


def valid_after_s(run, end_s):
    """Time from `end_s` until the first valid estimate; None: never."""
    times = (number_of(row["time_s"], "time_s") for row in rows_of(run / "estimate.csv", ["time_s", "navigation_valid"])
             if row["navigation_valid"] == "1")
    return next((time_s - end_s for time_s in times if time_s >= end_s), None)


def begin_of(run):
    """When the first fault of a run began: for faults that begin with an event."""
    rows = rows_of(run / "faults.csv", ["begin_s"])
    if not rows:
        raise JudgementError(f"{run / 'faults.csv'}: no rows")
    return number_of(rows[0]["begin_s"], "begin_s")


def arrival_misses(case, window, errors, nominal):
    """What the control errors of the two waypoints after the fault miss."""
    flown, expected = ([pair for pair in series if pair[0] >= window.begin_s][:2] for series in (errors, nominal.control_errors if nominal else []))
    if not expected:
        raise JudgementError("the run without the fault reaches no waypoint after it")
    if [time_s for time_s, _ in flown] != [time_s for time_s, _ in expected]:
        return ["does not arrive"]
    ratio = max(error_m for _, error_m in flown) / max(error_m for _, error_m in expected)
    return [] if ratio <= case.arrival_ratio else [f"arrives with {ratio:.2f} times the nominal error"]


def between(series, from_s, to_s):
    return [value for time_s, value in series if from_s <= time_s <= to_s]


def error_misses(case, window, errors, nominal):
    """What the navigation errors of a run miss; `nominal`: those of the run without the fault."""
    misses = []
    if case.error_m is not None:
        during = between(errors, window.begin_s, window.last_s)
        if not during:
            misses.append("no estimate")
        elif not max(during) <= case.error_m:
            misses.append(f"error {max(during):.3f} m, not {case.error_m:g}")
    if case.error_ratio is not None:
        from_s = window.begin_s + case.error_from_s
        flown, expected = between(errors, from_s, window.last_s), between(nominal, from_s, window.last_s)
        if not expected:
            raise JudgementError("the nominal run has no estimate in the time that is compared")
        if not len(flown) >= 0.5 * len(expected):
            return misses + [f"{len(flown)} estimates, nominally {len(expected)}"]
        for name, of in (("maximum", max), ("median", statistics.median)):
            ratio = of(flown) / of(expected)
            if not ratio <= case.error_ratio:
                misses.append(f"{name} error {ratio:.2f} times nominal")
    return misses


def largest_ratio(case, window, errors, nominal):
    """For the table: the larger of the ratios of maximum and median; None where they are not compared."""
    if case.error_ratio is None:
        return None
    from_s = window.begin_s + case.error_from_s
    flown, expected = between(errors, from_s, window.last_s), between(nominal, from_s, window.last_s)
    return max(of(flown) / of(expected) for of in (max, statistics.median)) if flown and expected else None


def fixed_after_s(rows, end_s):
    """Time from `end_s` until telemetry of carrier phase reports fixed integers; None: never."""
    times = [number_of(row["time_s"], "time_s") for row in rows]
    for row, time_s in zip(rows[bisect.bisect_left(times, end_s):], times[bisect.bisect_left(times, end_s):]):
        if number_of(row["fixed"], "fixed") > 0:
            return time_s - end_s
    return None


def names(event):
    return (event,) if isinstance(event, str) else tuple(event)


def judge(run, case, begin_s, period_s, step_s, nominal, sensed_until_s=math.inf):
    """What the run shows, and the list of what it misses. `period_s`, `step_s`: of images and steps at the point; `nominal`: of the run without the fault,
    needed by cases with a ratio. Until `sensed_until_s` images are as frequent as the mission has them: a retreat after it is not the fault's."""
    window = window_of(case, begin_s)
    try:
        summary = json.loads((run / "summary.json").read_text())
    except (OSError, ValueError) as error:
        raise JudgementError(f"{run / 'summary.json'}: {error}") from None
    events = rows_of(run / "telemetry_event.csv", ["step_time_s", "event", "fault", "device", "after"])
    raised = [(number_of(e["step_time_s"], "step_time_s") - begin_s, e["fault"]) for e in events if e["event"] == "fault_raised"]
    raised = [(after_s, fault) for after_s, fault in raised if after_s >= 0.0]
    reported_s = min((after_s for after_s, fault in raised if fault in names(case.event)), default=None)
    retreat_s = min((after_s for after_s, fault in raised if fault == "retreat"), default=None)
    aid = {e["device"]: e["after"] for e in events if e["event"] == "aid"}
    after = [distance_m for time_s, distance_m in distances(run) if time_s >= begin_s]
    if not after:
        raise JudgementError(f"{run}: it ends before the fault")
    distance_m = min(after)
    figures = summary["sensor_figures"].get("faults", {})
    misses = []
    if not summary.get("complete", False):
        misses.append("incomplete")
    if case.faults:
        if not figures["without_effect"] < figures["injected"]:
            misses.append("no effect")  # of one of two cameras it is enough
        distance_m = min(distance_m, number_of(str(figures.get("min_distance_m")), "min_distance_m"))
    if not distance_m >= case.distance_m:
        misses.append("distance")
    if any(names(case.event)) and reported_s is None:
        misses.append("not reported")
    if case.within is not None and reported_s is not None:
        limit_s = case.within(period_s, step_s) if callable(case.within) else case.within
        if not reported_s <= limit_s:
            misses.append(f"reported later than {limit_s:.0f} s")
    if case.within_burns is not None and reported_s is not None:
        burns = sum(begin_s <= number_of(row["execution_time_s"], "execution_time_s") <= begin_s + reported_s
                    for row in rows_of(run / "maneuvers.csv", ["execution_time_s"]))
        if burns > case.within_burns:
            misses.append(f"reported at burn {burns}, not {case.within_burns}")
    if case.retreats is True and retreat_s is None:
        misses.append("does not retreat")
    if case.retreats is False and retreat_s is not None and begin_s + retreat_s <= sensed_until_s:
        misses.append("retreats")
    misses += [f"{source} {aid.get(source)}" for source in case.sources if aid.get(source) not in ("aiding", "suspended")]
    if case.fixed_within_s is not None:
        fixed_s = fixed_after_s(rows_of(run / "gnss.csv", ["time_s", "fixed"]), window.end_s)
        if fixed_s is None or not fixed_s <= case.fixed_within_s:
            misses.append("not fixed again" if fixed_s is None else f"fixed after {fixed_s:.0f} s")
    ratio = None
    if case.error_ratio is not None or case.error_m is not None:
        errors = navigation_errors(run)
        of_nominal = nominal.navigation_errors if nominal else []
        misses += error_misses(case, window, errors, of_nominal)
        ratio = largest_ratio(case, window, errors, of_nominal)
    if case.valid_within_s is not None:
        valid_s = valid_after_s(run, window.end_s)
        if valid_s is None or not valid_s <= case.valid_within_s:
            misses.append("no estimate again" if valid_s is None else f"estimate again after {valid_s:.0f} s")
    if case.arrival_ratio is not None:
        misses += arrival_misses(case, window, control_errors(run), nominal)
    return {"distance_m": distance_m, "reported_s": reported_s, "retreat_s": retreat_s, "error_ratio": ratio, "misses": misses,
            "raised": sorted({fault for _, fault in raised}), "wall_s": summary.get("wall_s")}
