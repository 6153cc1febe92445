#!/usr/bin/env python3
"""Poses that an emulated TRON really showed, against those of the mission: from the folder of a run of experiment2_hil.

    ci/tron_truth.py RUN_FOLDER...     medians and 95 % of position and attitude, for each run
"""
import csv
import math
import pathlib
import sys
import tomllib


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as text:
        return list(csv.DictReader(text))


def product(a, b):
    w, x, y, z = a
    W, X, Y, Z = b
    return (w * W - x * X - y * Y - z * Z, w * X + x * W + y * Z - z * Y, w * Y - x * Z + y * W + z * X, w * Z + x * Y - y * X + z * W)


def conjugate(q):
    return (q[0], -q[1], -q[2], -q[3])


def turned(q, v):
    return product(product(q, (0.0, *v)), conjugate(q))[1:]


def numbers(row, names):
    return tuple(float(row[name]) for name in names)


def true_poses(folder, camera_position_m, body_file):
    """By time: pose of the target's model in the camera, whose axes are those of the servicer; full scale."""
    with open(body_file, "rb") as text:
        centre_of_mass_m = tomllib.load(text)["centre_of_mass_m"]
    attitudes = {}
    for row in rows_of(folder / "attitude.csv"):
        attitudes[(row["time_s"], row["spacecraft"])] = numbers(row, [f"q_body_eci_{k}" for k in "wxyz"])
    poses = {}
    for row in rows_of(folder / "truth.csv"):
        servicer, target = (attitudes.get((row["time_s"], name)) for name in ("servicer", "target"))
        if servicer is None or target is None:
            continue
        places = [numbers(row, [f"{name}_position_eci_{k}_m" for k in "xyz"]) for name in ("servicer", "target")]
        q_camera_body = product(servicer, conjugate(target))
        ahead = turned(servicer, [b - a for a, b in zip(*places)])
        origin = turned(q_camera_body, centre_of_mass_m)
        poses[float(row["time_s"])] = (q_camera_body, [a - c - o for a, c, o in zip(ahead, camera_position_m, origin)])
    return poses


def pose_errors(folder, camera_position_m, body_file, scale):
    """Of each image of a lit target: shown less commanded pose, mm in the laboratory of this scale, deg. An image whose frame is missing in
    bench_truth.csv is an error."""
    shown = {int(row["image"]): row for row in rows_of(folder / "bench_truth.csv")}
    wanted = true_poses(folder, camera_position_m, body_file)
    errors = []
    frame = 0  # that of the start, without light
    for row in rows_of(folder / "tron.csv"):
        frame += int(row["tries"])
        if row["failure"] or not row["pose_source"]:
            continue
        q, place = wanted[float(row["time_s"])]
        place_shown = numbers(shown[frame], [f"C_{k}_m" for k in "xyz"])
        q_shown = numbers(shown[frame], [f"q_C_T_{k}" for k in "wxyz"])
        cosine = abs(sum(a * b for a, b in zip(q, q_shown)))
        errors.append((1e3 * math.dist(place_shown, [scale * k for k in place]), math.degrees(2.0 * math.acos(min(1.0, cosine)))))
    if not errors:
        raise SystemExit(f"{folder}: no image of a lit target")
    return errors


def quantile(values, share):
    return sorted(values)[min(len(values) - 1, round(share * (len(values) - 1)))]


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    camera = tomllib.loads((root / "missions/experiment2.toml").read_text())["spacecraft"][0]["sensors"]["camera"]
    scale = tomllib.loads((root / "data/benches/tron.toml").read_text())["scale"]
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    for folder in map(pathlib.Path, sys.argv[1:]):
        errors = pose_errors(folder, camera["position_body_m"], root / "data/bodies/tango.toml", scale)
        print(folder, *(f"{quantile([error[k] for error in errors], share):.3f} {unit}"
                        for k, unit in ((0, "mm"), (1, "deg")) for share in (0.5, 0.95)))


if __name__ == "__main__":
    main()
