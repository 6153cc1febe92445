"""A run as CZML 1.0, the scene language of CesiumJS: true orbits, the orbit of the target as navigation estimates it, and burns.

Positions are in m in the inertial frame (CZML's INERTIAL is ICRF; the tables are in GCRF). Attitudes are left out: those of CZML are
relative to the rotating Earth.
"""
import json
import math

from vbar import orbit_messages
from vbar.recorded_tables import RunError

COLOURS = {"servicer": [42, 120, 214, 255], "target": [224, 86, 15, 255], "target_estimated": [16, 145, 106, 255], "burn": [185, 132, 0, 255]}
BURN_SHOWN_S = 600.0


def utc_text(run, time_s):
    return orbit_messages.epoch_text(run.utc(time_s)) + "Z"


def interval(run, begin_s, end_s):
    return f"{utc_text(run, begin_s)}/{utc_text(run, end_s)}"


def sampled(run, times, states):
    """The position property of an orbit; polynomials of degree 5 between its samples."""
    return {"epoch": utc_text(run, 0.0), "referenceFrame": "INERTIAL", "interpolationAlgorithm": "LAGRANGE", "interpolationDegree": 5,
            "cartesian": [value for time, state in zip(times, states) for value in (time, *state[:3])]}


def label(text, colour):
    return {"text": text, "font": "13px sans-serif", "fillColor": {"rgba": colour}, "horizontalOrigin": "LEFT", "pixelOffset": {"cartesian2": [10, -8]}}


def orbit_packet(run, name, text, times, states):
    colour = COLOURS[name]
    return {"id": name, "name": text, "availability": interval(run, times[0], times[-1]), "position": sampled(run, times, states),
            "point": {"pixelSize": 9, "color": {"rgba": colour}}, "label": label(text, colour),
            "path": {"width": 1.5, "leadTime": 3000, "trailTime": 3000, "resolution": 30, "material": {"solidColor": {"color": {"rgba": colour}}}}}


def burn_packets(run, times, states):
    """A point for ten minutes where the servicer was at the step before each executed burn."""
    if "maneuvers" not in run.tables:
        return []
    packets = []
    for number, (time, *dv) in enumerate(run.numbers("maneuvers", "execution_time_s", *[f"executed_dv_rtn_{axis}_mps" for axis in orbit_messages.RTN])):
        size = math.hypot(*dv)
        rows = [k for k, step in enumerate(times) if step <= time]
        if not (size > 0) or not rows:
            continue
        packets.append({"id": f"burn_{number}", "name": f"burn of {1e3 * size:.3g} mm/s", "availability": interval(run, time, min(time + BURN_SHOWN_S, times[-1])),
                        "position": {"referenceFrame": "INERTIAL", "cartesian": list(states[rows[-1]][:3])},
                        "point": {"pixelSize": 7, "color": {"rgba": COLOURS["burn"]}}, "label": label(f"{1e3 * size:.3g} mm/s", COLOURS["burn"])})
    return packets


def scene(run):
    """The packets of a run: the document first."""
    times = [row[0] for row in run.numbers("truth", "time_s")]
    if len(times) < 2:
        raise RunError(f"{run.folder}: truth.csv has fewer than two steps")
    packets = [{"id": "document", "name": run.name, "version": "1.0",
                "clock": {"interval": interval(run, times[0], times[-1]), "currentTime": utc_text(run, times[0]), "multiplier": 100, "range": "CLAMPED"}}]
    true = {craft: run.numbers("truth", *orbit_messages.eci_columns(craft)) for craft in ("servicer", "target")}
    packets += [orbit_packet(run, craft, craft, times, states) for craft, states in true.items()]
    estimates = orbit_messages.estimated_states(run)
    if len(estimates) > 1:
        packets.append(orbit_packet(run, "target_estimated", "target, estimated", *zip(*[(row[0], row[1]) for row in estimates])))
    return packets + burn_packets(run, times, true["servicer"])


def czml(run):
    return json.dumps(scene(run), allow_nan=False)
