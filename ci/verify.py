#!/usr/bin/env python3
"""Flies the missions at full length on every flight computer and writes the results to docs/verification.md.

usage: ci/verify.py [--build build/host] [--experiment1 | --experiment2 | --experiment3 | --grand | --full_range |
                     --full_range_cooperative | --experiment1_hil | --experiment2_hil]     (ci/verify.sh builds first)

Each option flies that mission only and replaces its section.
"""
import argparse
import pathlib
import platform
import re
import subprocess
import sys
import time

import verify_experiment1
import verify_experiment1_hil
import verify_experiment2_hil
import verify_experiment2
import verify_experiment3
import verify_full_range
import verify_grand
from flights import fly

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/verification.md"
MISSION = "missions/ideal_navigation.toml"

# name, overrides of the mission
FLIGHT_COMPUTERS = [
    ("in process", []),
    ("in process, again", []),
    ("in process, 2 truth threads", ["truth.threads=2"]),
    ("in process, paced by the wall clock at 20,000 times real time",
     ["clock.mode=real_time", "clock.speed_factor=20000"]),
    ("host process, serial", ["flight_computer.target=host_process"]),
    ("host process, UDP", ["flight_computer.target=host_process", "flight_computer.link=udp"]),
    ("ARM Linux under qemu-arm, serial", ["flight_computer.target=zynq_linux_qemu"]),
    ("emulated Zynq, UART", ["flight_computer.target=zynq_qemu"]),
    ("emulated Zynq, Ethernet", ["flight_computer.target=zynq_qemu", "flight_computer.link=udp"]),
]
REPLAYS = [name for name in ("in process", "host process, serial", "ARM Linux under qemu-arm, serial",
                             "emulated Zynq, UART", "emulated Zynq, Ethernet")]

# Requirements: waypoints, largest control error in m.
CONTROL_ERROR_LIMITS = [((1, 2, 3), 2.0), ((4, 5, 6, 7), 0.5), ((8, 9, 10), 0.01)]


def vbar(build, *arguments):
    return subprocess.run([str(build / "vbar"), *arguments], cwd=ROOT, capture_output=True, text=True, timeout=3600)


def mission_rows(summary):
    legs = {w["index"]: w["leg_dv_mps"] for w in summary["waypoints"]}
    far = sum(v for k, v in legs.items() if k <= 7)
    rows = [
        ("delta-v, legs 0 to 7", f"{far:.3f} m/s", "4.1 m/s", far <= 4.1),
        ("delta-v, leg 7 to 8", f"{1e3 * legs[8]:.3f} mm/s", "7.6 mm/s", legs[8] <= 7.6e-3),
        ("delta-v, legs 8 to 10", f"{1e3 * (legs[9] + legs[10]):.3f} mm/s", "6.0 mm/s", legs[9] + legs[10] <= 6.0e-3),
    ]
    for waypoint in summary["waypoints"]:
        for indices, limit in CONTROL_ERROR_LIMITS:
            if waypoint["index"] in indices:
                error = waypoint["control_error_m"]
                rows.append((f"control error, waypoint {waypoint['index']}", f"{error:.4f} m", f"{limit:g} m", error < limit))
    return rows


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def yes(good):
    return "yes" if good else "**no**"


def mission_table(summary):
    """The figures of ideal_navigation with their limits, as on the page."""
    return table(["quantity", "result", "at most", "met"], [(a, b, c, yes(d)) for a, b, c, d in mission_rows(summary)])


def replace_section(page, lines):
    """`page` with the section of the same heading as `lines` replaced, or appended."""
    sections = re.split(r"^(?=## )", page, flags=re.MULTILINE)
    new = "\n".join(lines)
    places = [k for k, old in enumerate(sections) if old.split("\n", 1)[0] == lines[0]]
    if not places:
        return page.rstrip("\n") + "\n\n" + new
    sections[places[0]] = new if places[0] == len(sections) - 1 else new + "\n"
    return "".join(sections)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/host")
    experiments = {"experiment1": verify_experiment1, "experiment2": verify_experiment2, "experiment3": verify_experiment3,
                   "grand": verify_grand, "full_range": verify_full_range.CAMERAS,
                   "full_range_cooperative": verify_full_range.COOPERATIVE, "experiment1_hil": verify_experiment1_hil,
                   "experiment2_hil": verify_experiment2_hil}
    for name in experiments:
        parser.add_argument(f"--{name}", action="store_true")
    options = parser.parse_args()
    build = options.build.resolve()
    runs = ROOT / "runs/verify"
    for name, experiment in experiments.items():
        if not getattr(options, name):
            continue
        lines, met = experiment.section(build, ROOT, runs, table)
        PAGE.write_text(replace_section(PAGE.read_text(), lines))
        print("\n".join(lines))
        print("verified" if met else "NOT verified: see above")
        return 0 if met else 1
    sections = [experiment.section(build, ROOT, runs, table) for experiment in experiments.values()]

    flown = []
    for number, (name, overrides) in enumerate(FLIGHT_COMPUTERS):
        print(f"flying: {name}", flush=True)
        flown.append((name, fly(build, ROOT, MISSION, runs / str(number), overrides=overrides)))
    reference = flown[0][1]
    same = lambda s: (s["commands_sha256"], s["telemetry_sha256"]) == (reference["commands_sha256"], reference["telemetry_sha256"])

    replays = []
    for name in REPLAYS:
        print(f"replaying into: {name}", flush=True)
        overrides = dict(FLIGHT_COMPUTERS)[name]
        command = ["replay", str(runs / "0")]
        for override in overrides:
            command += ["--set", override]
        result = vbar(build, *command)
        replays.append((name, result.returncode == 0, (result.stdout + result.stderr).strip()))

    rows = mission_rows(reference)
    ok = all(met for _, met in sections) and all(r[3] for r in rows) and all(same(s) for _, s in flown) and all(r[1] for r in replays)
    text = [
        "# Verification",
        "",
        f"Written by `ci/verify.sh` on {time.strftime('%Y-%m-%d')}, {platform.machine()}, {platform.freedesktop_os_release()['PRETTY_NAME']}."
        " Each run is the complete mission of 41.25 h. The Zynq is emulated by QEMU; nothing was run on a board.",
        "",
        "## Mission results and their limits (in process)",
        "",
        mission_table(reference),
        "",
        "## Bit-identical results on every flight computer",
        "",
        "Commands and telemetry against those of the run in process; [first_hour.md](first_hour.md#the-same-bits-elsewhere) prints the hashes of",
        "the present software.",
        "",
        table(["flight computer", "same bits", "wall s", "largest step", "stack bytes"],
              [(name, yes(same(s)), f"{s['wall_s']:.1f}",
                "-" if s["flight_step"]["unit"] == "none" else f"{s['flight_step']['max']:,} {s['flight_step']['unit']}",
                s["flight_step"]["stack_bytes_max"] or "-") for name, s in flown]),
        "",
        "## Replay of the recorded packets",
        "",
        table(["replayed on", "identical", "output of vbar"], [(name, yes(good), said) for name, good, said in replays]),
        "",
    ]
    for lines, _ in sections:
        text += lines
    PAGE.write_text("\n".join(text))
    print("\n".join(text))
    print("verified" if ok else "NOT verified: see above")
    return 0 if ok else 1


if __name__ == "__main__":
    sys.exit(main())
