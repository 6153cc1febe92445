#!/usr/bin/env python3
"""Optimum costs of random rendezvous problems by a general cone solver (CVXOPT), for the Koenig-D'Amico solver to meet.

    koenig_reference.py --write FILE        all problems into FILE (minutes)
    koenig_reference.py --check FILE        solves every 41st again and compares (seconds); exit 77 without CVXOPT
    koenig_reference.py --legs              optimum and least-squares burns of the mission's close legs

Independent of the flight code in both halves. The effects of impulses are central differences of a two-orbit model: the
deputy's mean elements become a Kepler state, get the impulse, become elements again and drift with their own secular J2 rates
to the arrival. The optimum is that of the second-order cone program over all candidate times at once, no active set.

Problem k is drawn from random.Random(k), in the order of draw_problem(). Units of the file: km, deg, s, m, mm/s.
"""

import argparse
import csv
import math
import random
import sys

try:
    import numpy as np
    from cvxopt import matrix, solvers
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

MU = 3.986004415e14
EARTH_RADIUS = 6378136.3
J2 = 1.0826358191967e-3
PROBLEMS = 1200
COSTS = ["steerable"] * 10 + ["orthogonal_pairs", "radial_and_plane"]  # problem k has cost k mod 12
GROUPS = {"steerable": [[0, 1, 2]], "orthogonal_pairs": [[0], [1], [2]], "radial_and_plane": [[0], [1, 2]]}
FIELDS = ["cost", "a_km", "ex", "ey", "i_deg", "u_deg", "window_s", "times", "da_m", "dl_m", "dex_m", "dey_m", "dix_m",
          "diy_m", "optimum_mm_s"]


def draw_problem(k):
    """Low Earth orbits, windows of 0.2 to 3.6 orbits, 40 to 600 times, changes of 1 mm to 1 km, a fifth of them zero."""
    r = random.Random(k)
    a_km = round(r.uniform(6800.0, 7600.0), 1)
    e = r.uniform(0.0, 0.02)
    perigee = r.uniform(0.0, 2.0 * math.pi)
    problem = {"cost": COSTS[k % len(COSTS)], "a_km": a_km, "ex": round(e * math.cos(perigee), 5),
               "ey": round(e * math.sin(perigee), 5), "i_deg": round(r.uniform(20.0, 160.0), 2),
               "u_deg": round(r.uniform(-180.0, 180.0), 2)}
    period = 2.0 * math.pi * math.sqrt((a_km * 1e3) ** 3 / MU)
    problem["window_s"] = round(period * r.uniform(0.2, 3.6))
    problem["times"] = r.randint(40, 600)
    for field in FIELDS[8:14]:
        size = float(f"{10.0 ** r.uniform(-3.0, 3.0):.3g}")
        problem[field] = 0.0 if r.random() < 0.2 else math.copysign(size, r.random() - 0.5)
    if not any(problem[field] for field in FIELDS[8:14]):
        problem["dey_m"] = 1.0
    return problem


def cartesian(q):
    """Kepler state of elements [a, ex, ey, i, raan, u], arrays over time: columns of q."""
    a, ex, ey, i, raan, u = q
    F = u.copy()
    for _ in range(30):
        F -= (F - ex * np.sin(F) + ey * np.cos(F) - u) / (1.0 - ex * np.cos(F) - ey * np.sin(F))
    eta = np.sqrt(1.0 - ex**2 - ey**2)
    b = 1.0 / (1.0 + eta)
    c, s = np.cos(F), np.sin(F)
    r = a * (1.0 - ex * c - ey * s)
    x, y = a * ((1 - b * ey**2) * c + b * ex * ey * s - ex), a * ((1 - b * ex**2) * s + b * ex * ey * c - ey)
    speed = np.sqrt(MU * a) / r
    vx, vy = speed * (b * ex * ey * c - (1 - b * ey**2) * s), speed * ((1 - b * ex**2) * c - b * ex * ey * s)
    P = np.array([np.cos(raan), np.sin(raan), 0 * raan])
    Q = np.array([-np.sin(raan) * np.cos(i), np.cos(raan) * np.cos(i), np.sin(i)])
    return x * P + y * Q, vx * P + vy * Q


def elements(position, velocity):
    r = np.linalg.norm(position, axis=0)
    h = np.cross(position, velocity, axis=0)
    w = h / np.linalg.norm(h, axis=0)
    i, raan = np.arctan2(np.hypot(w[0], w[1]), w[2]), np.arctan2(w[0], -w[1])
    a = 1.0 / (2.0 / r - np.sum(velocity**2, axis=0) / MU)
    P = np.array([np.cos(raan), np.sin(raan), 0 * raan])
    Q = np.cross(w, P, axis=0)
    evec = np.cross(velocity, h, axis=0) / MU - position / r
    ex, ey = np.sum(evec * P, axis=0), np.sum(evec * Q, axis=0)
    x, y = np.sum(position * P, axis=0), np.sum(position * Q, axis=0)
    eta = np.sqrt(1.0 - ex**2 - ey**2)
    b = 1.0 / (1.0 + eta)
    c = ex + ((1 - b * ex**2) * x - b * ex * ey * y) / (a * eta)
    s = ey + ((1 - b * ey**2) * y - b * ex * ey * x) / (a * eta)
    return np.array([a, ex, ey, i, raan, np.arctan2(s, c) - ex * s + ey * c])


def drift(q, dt):
    """Secular motion of mean elements under J2 (Brouwer, first order)."""
    a, ex, ey, i, raan, u = q
    n = np.sqrt(MU / a**3)
    eta = np.sqrt(1.0 - ex**2 - ey**2)
    k = 0.75 * J2 * n * (EARTH_RADIUS / (a * eta**2)) ** 2
    perigee = k * (5.0 * np.cos(i) ** 2 - 1.0) * dt
    mean_anomaly = (n + k * eta * (3.0 * np.cos(i) ** 2 - 1.0)) * dt
    return np.array([a, ex * np.cos(perigee) - ey * np.sin(perigee), ex * np.sin(perigee) + ey * np.cos(perigee), i,
                     raan - 2.0 * k * np.cos(i) * dt, u + perigee + mean_anomaly])


def wrap(angle):
    return np.remainder(angle + np.pi, 2.0 * np.pi) - np.pi


def roe(chief, deputy):
    node = wrap(deputy[4] - chief[4])
    return np.array([deputy[0] / chief[0] - 1.0, wrap(deputy[5] - chief[5] + node * np.cos(chief[3])),
                     deputy[1] - chief[1], deputy[2] - chief[2], deputy[3] - chief[3], node * np.sin(chief[3])])


def grid_times(problem):
    return np.linspace(0.0, problem["window_s"], problem["times"])


def effects(problem, t):
    """[time, 6, 3]: change of the ROE at the arrival per impulse in RTN at the times t after the start."""
    start = np.array([problem["a_km"] * 1e3, problem["ex"], problem["ey"], math.radians(problem["i_deg"]), 0.0,
                      math.radians(problem["u_deg"])])
    to_go = problem["window_s"] - t
    chief = drift(np.repeat(start[:, None], t.size, axis=1), t)
    position, velocity = cartesian(chief)
    arrival = drift(chief, to_go)
    radial = position / np.linalg.norm(position, axis=0)
    normal = np.cross(position, velocity, axis=0)
    normal /= np.linalg.norm(normal, axis=0)
    axes = [radial, np.cross(normal, radial, axis=0), normal]
    result = np.empty((t.size, 6, 3))
    step = 0.1  # m/s: second-order terms cancel, third-order ones are 1e-9, rounding 1e-9
    for k, axis in enumerate(axes):
        change = [roe(arrival, drift(elements(position, velocity + sign * step * axis), to_go)) for sign in (1.0, -1.0)]
        result[:, :, k] = ((change[0] - change[1]) / (2.0 * step)).T
    return result


def optimum(problem):
    """Least cost, mm/s: maximise w'lambda with |G' lambda| <= 1 for every time and group of axes."""
    g = effects(problem, grid_times(problem))
    w = np.array([problem[field] for field in FIELDS[8:14]]) / (problem["a_km"] * 1e3)
    gramian = np.einsum("tik,tjk->ij", g, g)
    row_scale = np.sqrt(np.diag(gramian))
    lower = np.linalg.cholesky(gramian / np.outer(row_scale, row_scale)) * row_scale[:, None] / math.sqrt(len(g))
    g, w = np.linalg.solve(lower, g), np.linalg.solve(lower, w)  # the state in which all directions cost alike
    size = np.linalg.norm(w)
    rows, cones, right = [], [], []
    for group in GROUPS[problem["cost"]]:
        block = np.zeros((g.shape[0], 1 + len(group), 6))
        block[:, 1:, :] = -np.transpose(g[:, :, group], (0, 2, 1))
        rows.append(block.reshape(-1, 6))
        cones += [1 + len(group)] * g.shape[0]
        right.append(np.tile([1.0] + [0.0] * len(group), g.shape[0]))
    solution = solve_cone_program(matrix(-w / size), matrix(np.vstack(rows)), matrix(np.concatenate(right)), cones)
    return 1e3 * size * -solution["primal objective"]


def solve_cone_program(c, G, h, cones):
    """To a relative gap of 1e-7; where CVXOPT's last steps fail by rounding, to 1e-6 or 1e-5."""
    for gap in (1e-7, 1e-6, 1e-5):
        solvers.options.update(show_progress=False, abstol=1e-14, reltol=gap, feastol=1e-7)
        try:
            solution = solvers.conelp(c, G, h, dims={"l": 0, "q": cones, "s": []}, kktsolver="chol")
        except (ValueError, ArithmeticError):
            continue
        if solution["status"] == "optimal":
            return solution
    raise RuntimeError("CVXOPT did not solve the program")


def write(path):
    with open(path, "w", newline="") as file:
        rows = csv.DictWriter(file, FIELDS, lineterminator="\n")
        rows.writeheader()
        for k in range(PROBLEMS):
            problem = draw_problem(k)
            rows.writerow(problem | {"optimum_mm_s": f"{optimum(problem):.7g}"})


def check(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == PROBLEMS, len(rows)
    worst = 0.0
    for k in range(0, PROBLEMS, 41):
        problem = draw_problem(k)
        for field in FIELDS[:14]:
            assert str(problem[field]) == rows[k][field], (k, field, problem[field], rows[k][field])
        expected = float(rows[k]["optimum_mm_s"])
        worst = max(worst, abs(optimum(problem) / expected - 1.0))
    print(f"{len(range(0, PROBLEMS, 41))} optima agree within {worst:.1e}")
    assert worst < 1e-5, worst  # the gap to which the cone solver works where its last steps fail


def print_legs():
    """Waypoint 8 to 9 and 9 to 10, from the mission's mean elements at its epoch and the pseudo-states at the arrivals."""
    np.set_printoptions(precision=5, suppress=True)
    epoch = np.array([7078138.944, 0.00104134174, 1.5923745e-5, *np.radians([98.1853293, -90.0001291, -0.6886792])])
    for start, window, change in ((140400, 3600, [0.5, 0.145713, 0.995478, -1.999991, 2.0, -1.001241]),
                                  (144000, 4500, [0.0, -1.512391, 3e-6, 0.002818, -1.0, -0.012331])):
        a, ex, ey, i, _, u = drift(epoch, start)
        leg = {"cost": "steerable", "a_km": a / 1e3, "ex": ex, "ey": ey, "i_deg": math.degrees(i), "u_deg": math.degrees(u),
               "window_s": window, "times": window // 10 + 1} | dict(zip(FIELDS[8:14], change))
        print(f"leg of {window} s: optimum on a 10 s grid {optimum(leg):.6f} mm/s")
        for times in ([0, window], [0, window / 2, window]):
            A = a * np.hstack(list(effects(leg, np.array(times, float))))
            for alpha in (0.0, 1e4):
                x = A.T @ np.linalg.solve(A @ A.T + alpha * np.eye(6), change)
                total = 1e3 * np.linalg.norm(x.reshape(-1, 3), axis=1).sum()
                residual = np.linalg.norm(A @ x - change)
                print(f"  times {times}, alpha {alpha:g}: condition {np.linalg.cond(A):.4f}, residual {residual:.6f} m, "
                      f"sum {total:.5f} mm/s")
                print(1e3 * x.reshape(-1, 3))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    choice = arguments.add_mutually_exclusive_group(required=True)
    choice.add_argument("--write", metavar="FILE")
    choice.add_argument("--check", metavar="FILE")
    choice.add_argument("--legs", action="store_true")
    options = arguments.parse_args()
    if options.write:
        write(options.write)
    elif options.check:
        check(options.check)
    else:
        print_legs()


if __name__ == "__main__":
    main()
