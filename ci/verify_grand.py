"""Experiment 3 through the emulated GNSS testbed over ten seeds, with three sizes of phase wander: a section of docs/verification.md."""
import statistics

from flights import fly
from verify_experiment3 import SEEDS, WANDER_TIME_S, evaluate, row_of_wander

MISSION = "missions/experiment3_grand.toml"
BENCH = "vbar_grand_bench {data}/benches/grand.toml --directory {directory} --seed {seed} --set bench.channel_phase_mm="
WANDER_CASES = [
    (0.5, {"position": 5.0, "deviation": 1.6, "velocity": 0.007, "dv": 7.6, "dv worst": 8.5}),
    (1.0, {"position": 5.0, "first fix": (300.0, 0), "nees": 6.6}),
    (2.0, {"position": 8.4, "first fix": (1200.0, 1), "nees": 8.0}),
]
# Of the first case: (what, key, scale, unit, limit, of).
LIMITS = [
    ("position error, mean from the first fix on", "position", 1e3, "mm", 12.0, "worst"),
    ("position error at waypoint 9", "waypoint 9", 1e3, "mm", 5.0, "median"),
    ("position error at waypoint 10", "waypoint 10", 1e3, "mm", 4.5, "median"),
    ("control error, larger of waypoints 9 and 10", "control", 1e3, "mm", 50.0, "worst"),
    ("lowest correlation of GPS L1 code, 10 s", "code correlation", 1.0, "", 0.7, "lowest"),
]


def flown_with(build, root, folder, wander_mm):
    overrides = [f"navigation.carrier_phase.phase_wander_sigma_mm={wander_mm}",
                 f"navigation.carrier_phase.phase_wander_time_s={WANDER_TIME_S}", f"testbed.grand.bench={BENCH}{wander_mm}"]
    flown = []
    for seed in SEEDS:
        summary = fly(build, root, MISSION, folder, seed, overrides)
        figures = evaluate(summary, folder)
        figures["code correlation"] = summary["sensor_figures"]["gnss"]["gps_l1_code_correlation_10s"]
        flown.append(figures)
    return flown


def row_of_limit(flown, what, key, scale, unit, limit, of):
    values = [scale * figures[key] for figures in flown]
    found = {"median": statistics.median, "worst": max, "lowest": min}[of](values)
    met = found >= limit if of == "lowest" else found <= limit
    return (what, f"{statistics.median(values):.2f} {unit}", f"{found:.2f} {unit}", f"{limit:g} {unit} ({of})", met)


def section(build, root, runs, table):
    """The lines of the section and whether all limits are met. `table(head, rows)` writes a table."""
    wandering, rows, complete = [], [], True
    for wander_mm, limits in WANDER_CASES:
        print(f"flying: experiment 3 through the emulated GNSS testbed, phase wander {wander_mm:g} mm", flush=True)
        flown = flown_with(build, root, runs / "experiment3_grand", wander_mm)
        complete = complete and all(figures["complete"] for figures in flown)
        wandering.append(row_of_wander((wander_mm, wander_mm), limits, flown))
        rows = rows or [row_of_limit(flown, *limit) for limit in LIMITS]
    yes = lambda good: "yes" if good else "**no**"
    lines = [
        "## Experiment 3 through the emulated GNSS testbed",
        "",
        f"Emulated bench in lock-step, seeds {SEEDS[0]} to {SEEDS[-1]}; no hardware took part. The phase wander of the generator's"
        f" channels has a correlation time of {WANDER_TIME_S:g} s, and navigation is configured for it (medians; delta-v and first fix:"
        " also the worst seed; met: the limits in ci/verify_grand.py):",
        "",
        table(["phase wander", "configured", "position error", "standard deviation", "velocity error", "delta-v", "first fix", "NEES",
               "met"], [(*row[:-1], yes(row[-1])) for row in wandering]),
        "",
        f"With a wander of {WANDER_CASES[0][0]:g} mm:",
        "",
        table(["quantity", "median", "compared", "limit", "met"], [(*row[:-1], yes(row[-1])) for row in rows]),
        "",
    ]
    return lines, complete and all(row[-1] for row in wandering + rows)
