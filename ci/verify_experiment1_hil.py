"""Experiment 1 through the emulated Optical Stimulator, each bench with its own calibration: a section of docs/verification.md."""
import statistics
import subprocess

from flights import fly
from verify_experiment1 import WAYPOINTS, at_waypoints

MISSION = "missions/experiment1_hil.toml"
BENCH = "vbar_os_bench {data}/benches/optical_stimulator.toml --directory {directory} --seed {seed}"
SEEDS = range(1, 6)
# Medians over the seeds, m. Paper, hardware in the loop: navigation and control.
NAVIGATION_LIMITS = (10.0, 4.0, 1.0, 0.6, 0.8, 0.6, 0.8)
CONTROL_LIMITS = (8.0, 5.0, 2.0, 1.0, 1.0, 1.0, 1.0)
PAPER_NAVIGATION = (75.27, 23.03, 9.58, 6.70, 10.12, 1.09, 3.06)
PAPER_CONTROL = (113.88, 73.59, 13.17, 6.44, 10.11, 1.22, 4.47)


def calibrate(build, root, folder, seed):
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"calibration_{seed}.toml"
    result = subprocess.run([build / "vbar_os_calibrate", "--out", file, "--bench", BENCH, "--seed", str(seed)], cwd=root,
                            capture_output=True, text=True, timeout=1800, check=False)
    if result.returncode not in (0, 3):  # 3: the goal of the residuals was missed, which the table shows
        raise SystemExit(f"vbar_os_calibrate, seed {seed}: {result.stdout}{result.stderr}")
    return file


def waypoint_rows(flown):
    rows = []
    for k, (navigation, control) in enumerate(zip(at_waypoints(flown, "navigation_error_m"),
                                                  at_waypoints(flown, "control_error_m"))):
        n, c = statistics.median(navigation), statistics.median(control)
        rows.append((WAYPOINTS[k], f"{n:.2f} m", f"{max(navigation):.2f} m", f"{NAVIGATION_LIMITS[k]:g} m",
                     f"{PAPER_NAVIGATION[k]:g} m", f"{c:.2f} m", f"{max(control):.2f} m", f"{CONTROL_LIMITS[k]:g} m",
                     f"{PAPER_CONTROL[k]:g} m", n <= NAVIGATION_LIMITS[k] and c <= CONTROL_LIMITS[k]))
    return rows


def share(summary, key):
    images = summary["sensor_figures"]["images"]
    return 100.0 * images[key] / images["images"]


def other_rows(flown, logs):
    """(what, median, worst, limit, met)."""
    def row(what, values, low, high, digits, unit=""):
        found = statistics.median(values)
        worst = min(values) if high is None else max(values)
        limit = f"at least {low:g}" if high is None else (f"{high:g}" if low is None else f"{low:g} to {high:g}")
        met = (low is None or found >= low) and (high is None or found <= high)
        return (what, f"{found:.{digits}f} {unit}", f"{worst:.{digits}f} {unit}", f"{limit} {unit}", met)

    bench = [summary["optical_stimulator"] for summary in flown]
    return [
        row("held-out residual of the calibration, region", [b["calibration_residual_arcsec"] for b in bench], None, 1.5, 2, "arcsec"),
        row("residual of the self check", [b["self_check_arcsec"] for b in bench], None, 3.0, 2, "arcsec"),
        row("delta-v, waypoints 0 to 7", [s["dv_mps"] for s in flown], None, 4.1, 3, "m/s"),
        row("bearing bias, target beyond 5 km", [s["bearing_error_arcsec"]["bias"] for s in flown], None, 3.0, 2, "arcsec"),
        row("bearing noise, target beyond 5 km", [s["bearing_error_arcsec"]["std"] for s in flown], None, 5.0, 2, "arcsec"),
        row("attitude from stars, mean across the boresight", [s["star_attitude_error_arcsec"]["mean"] for s in flown], None, 2.0, 2,
            "arcsec"),
        row("images with a bearing", [share(s, "with_bearing") for s in flown], 77.0, None, 1, "%"),
        row("images with stars identified", [share(s, "with_stars") for s in flown], 99.0, None, 1, "%"),
        row("bearings to another object", [float(s["sensor_figures"]["images"]["wrong_targets"]) for s in flown], None, 0.0, 0),
        row("mean NEES of the ROE, 6 degrees of freedom", [s["navigation_nees"] for s in flown], 4.5, 7.5, 2),
        row("images that show an earlier picture", [b["stale_frames"] for b in bench], None, 0.0, 0),
        row("log", [size / 1e9 for size in logs], None, 0.4, 3, "GB"),
        row("wall clock", [s["wall_s"] / 60.0 for s in flown], None, 7.0, 1, "min"),
    ]


def section(build, root, runs, table):
    """The lines of the section and whether all limits are met. `table(head, rows)` writes a table."""
    flown, logs = [], []
    for seed in SEEDS:
        print(f"calibrating and flying: experiment 1 through the emulated Optical Stimulator, seed {seed}", flush=True)
        calibration = calibrate(build, root, runs / "experiment1_hil", seed)
        folder = runs / "experiment1_hil" / f"run-{seed}"
        flown.append(fly(build, root, MISSION, folder, seed, [f'testbed.optical_stimulator.calibration="{calibration}"']))
        logs.append((folder / "packets.lcmlog").stat().st_size)
    waypoints, others = waypoint_rows(flown), other_rows(flown, logs)
    yes = lambda good: "yes" if good else "**no**"
    lines = [
        "## Experiment 1 through the emulated Optical Stimulator",
        "",
        f"Emulated bench at fast pace, mission and bench seeds {SEEDS[0]} to {SEEDS[-1]}, each bench with its own calibration and a day's"
        " drift since; no hardware took part. Medians and worst seeds; limits hold for the medians. The figures of the paper are those"
        " of its hardware in the loop.",
        "",
        table(["waypoint", "navigation error", "worst", "limit", "paper", "control error", "worst", "limit", "paper", "met"],
              [(*row[:-1], yes(row[-1])) for row in waypoints]),
        "",
        table(["quantity", "median", "worst", "limit", "met"], [(*row[:-1], yes(row[-1])) for row in others]),
        "",
    ]
    return lines, all(s["complete"] for s in flown) and all(row[-1] for row in waypoints + others)
