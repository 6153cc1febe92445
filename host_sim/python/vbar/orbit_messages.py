"""Ephemerides of a run as CCSDS messages: OEM 2.0 (CCSDS 502.0-B) of orbits, AEM 1.0 (CCSDS 504.0-B) of attitudes.

The covariance of the estimated target is that of the relative state: RTN sigmas without correlations, in GCRF axes. The velocity of
the tables is that in the rotating RTN frame.
"""
import datetime
import math

from vbar.recorded_tables import RunError

AXES = "xyz"
RTN = "rtn"


def epoch_text(time):
    return time.isoformat(timespec="microseconds")


def head(run, kind, version, name, times, frame_lines, comment):
    return "\n".join([f"CCSDS_{kind}_VERS = {version}",
                      f"CREATION_DATE = {datetime.datetime.now(datetime.timezone.utc):%Y-%m-%dT%H:%M:%S}", "ORIGINATOR = VBAR", "",
                      "META_START", f"COMMENT {comment}", f"OBJECT_NAME = {name}", f"OBJECT_ID = {name}", *frame_lines[0], "TIME_SYSTEM = UTC",
                      f"START_TIME = {epoch_text(run.utc(times[0]))}", f"STOP_TIME = {epoch_text(run.utc(times[-1]))}", *frame_lines[1], "META_STOP", ""])


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.hypot(*a)
    return [x / length for x in a]


def rtn_axes(position, velocity):
    """R, T, N in ECI, and the rate of the frame about N."""
    momentum = cross(position, velocity)
    r, n = unit(position), unit(momentum)
    return [r, cross(n, r), n], math.hypot(*momentum) / sum(x * x for x in position)


def target_state(servicer, relative):
    """Position and velocity in ECI of a spacecraft whose relative state in the rotating RTN of the servicer is given."""
    position, velocity = servicer[:3], servicer[3:]
    axes, rate = rtn_axes(position, velocity)
    r, v = relative[:3], relative[3:]
    v = [v[0] - rate * r[1], v[1] + rate * r[0], v[2]]
    return [*(position[k] + sum(r[i] * axes[i][k] for i in range(3)) for k in range(3)),
            *(velocity[k] + sum(v[i] * axes[i][k] for i in range(3)) for k in range(3))]


def covariance_eci(servicer, sigmas):
    """6 x 6 in GCRF axes, of the relative state with these RTN sigmas in the rotating frame."""
    axes, rate = rtn_axes(servicer[:3], servicer[3:])
    transform = [[0.0] * 6 for _ in range(6)]
    for k in range(3):
        for i in range(3):
            transform[k][i] = transform[k + 3][i + 3] = axes[i][k]
        transform[k + 3][0] = rate * axes[1][k]
        transform[k + 3][1] = -rate * axes[0][k]
    return [[sum(transform[a][i] * sigmas[i] ** 2 * transform[b][i] for i in range(6)) for b in range(6)] for a in range(6)]


def state_line(run, time_s, state):
    position, velocity = (" ".join(f"{1e-3 * x:.12f}" for x in part) for part in (state[:3], state[3:]))
    return f"{epoch_text(run.utc(time_s))} {position} {velocity}"


def oem(run, name, times, states, covariances, comment):
    """The text of an orbit ephemeris message; states in m and m/s, covariances a list of (time, 6 x 6), or empty."""
    text = head(run, "OEM", "2.0", name, times, (["CENTER_NAME = EARTH", "REF_FRAME = GCRF"], []), comment)
    lines = [state_line(run, time, state) for time, state in zip(times, states)]
    if covariances:
        lines += ["", "COVARIANCE_START"]
        for time, matrix in covariances:
            lines.append(f"EPOCH = {epoch_text(run.utc(time))}")
            lines += [" ".join(f"{1e-6 * matrix[row][column]:.15e}" for column in range(row + 1)) for row in range(6)]
        lines.append("COVARIANCE_STOP")
    return text + "\n" + "\n".join(lines) + "\n"


def eci_columns(craft):
    return [f"{craft}_position_eci_{axis}_m" for axis in AXES] + [f"{craft}_velocity_eci_{axis}_mps" for axis in AXES]


def relative_columns(prefix=""):
    return [f"relative_position_rtn_{axis}_m" for axis in RTN] + [f"relative_velocity_rtn_{axis}_mps" for axis in RTN]


def estimated_states(run):
    """Rows (time, state of the target in ECI, covariance of the relative state) where navigation is valid."""
    if "telemetry_navigation" not in run.tables:
        return []
    sigma_columns = [f"sigma_rtn_{axis}_m" for axis in RTN] + [f"sigma_rtn_{axis}_mps" for axis in RTN]
    rows = run.numbers("telemetry_navigation", "time_s", "valid", *eci_columns("servicer"), *relative_columns(), *sigma_columns)
    return [(row[0], target_state(row[2:8], row[8:14]), covariance_eci(row[2:8], row[14:20])) for row in rows
            if row[1] == 1 and math.hypot(*row[2:5]) > 0]


def orbits(run):
    """{file: text}: the true orbits, and that of the target as navigation estimates it, where it is valid."""
    files = {}
    times = [row[0] for row in run.numbers("truth", "time_s")]
    for craft in ("servicer", "target"):
        states = run.numbers("truth", *eci_columns(craft))
        files[f"{craft}_true.oem"] = oem(run, craft.upper(), times, states, [], "true orbit of a simulated run of vbar")
    rows = estimated_states(run)
    if rows:
        files["target_estimated.oem"] = oem(
            run, "TARGET", [row[0] for row in rows], [row[1] for row in rows], [(row[0], row[2]) for row in rows],
            "estimated orbit; the covariance is that of the state relative to the servicer, without correlations in RTN")
    return files


def attitudes(run):
    """{file: text}: the true attitude of each spacecraft that has one, as rotation from GCRF to its body."""
    if "attitude" not in run.tables:
        raise RunError(f"{run.folder}: no attitude.csv: no spacecraft of its mission has an attitude")
    rows = list(zip(run.tables["attitude"]["spacecraft"],
                    run.numbers("attitude", "time_s", "q_body_eci_w", "q_body_eci_x", "q_body_eci_y", "q_body_eci_z")))
    files = {}
    for craft in dict.fromkeys(name for name, _ in rows):
        own = [row for name, row in rows if name == craft]
        text = head(run, "AEM", "1.0", craft.upper(), [row[0] for row in own],
                    (["CENTER_NAME = EARTH", "REF_FRAME_A = GCRF", "REF_FRAME_B = SC_BODY_1", "ATTITUDE_DIR = A2B"],
                     ["ATTITUDE_TYPE = QUATERNION", "QUATERNION_TYPE = LAST"]), "true attitude of a simulated run of vbar")
        # The message turns axes, the tables components: the vector parts are opposite.
        lines = [f"{epoch_text(run.utc(t))} {-x!r} {-y!r} {-z!r} {w!r}" for t, w, x, y, z in own]
        files[f"{craft}.aem"] = text + "\nDATA_START\n" + "\n".join(lines) + "\nDATA_STOP\n"
    return files
