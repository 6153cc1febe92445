#!/usr/bin/env python3
"""Writes tango.obj and tango.mtl, the project's model of PRISMA's Tango, into the folder of this script or another one:

    make_tango.py [FOLDER]

Only the eleven keypoints are published figures (SPEED and SPEED+ data sets: corners of the top panel and of the bottom,
tips of three antennas); everything else is drawn to look like the photographs and to make every side unlike the others.
Body frame: that of the keypoints, metres, z towards the top panel. The same bytes on every run.
"""

import math
import pathlib
import sys

TOP = [(-0.37, -0.385, 0.3215), (-0.37, 0.385, 0.3215), (0.37, 0.385, 0.3215), (0.37, -0.385, 0.3215)]
BOTTOM = [(-0.37, -0.264, 0.0), (-0.37, 0.304, 0.0), (0.37, 0.304, 0.0), (0.37, -0.264, 0.0)]
ANTENNAS = [  # root under the panel's corner, tip
    (1, (-0.5427, 0.4877, 0.2535)),
    (2, (0.5427, 0.4877, 0.2591)),
    (3, (0.3050, -0.5790, 0.2515)),
]
PANEL_M = 0.02  # thickness of the top panel

# name: Kd, Ks (linear), Ns. Typical of the material; the mean of red, green and blue of both is at most 1.
MATERIALS = {
    "solar_cell": ((0.015, 0.025, 0.075), (0.05, 0.05, 0.06), 900),
    "solar_substrate": ((0.22, 0.15, 0.07), (0.04, 0.04, 0.04), 20),
    "silver_busbar": ((0.30, 0.30, 0.30), (0.50, 0.50, 0.50), 80),
    "mli_gold": ((0.30, 0.20, 0.07), (0.55, 0.40, 0.16), 60),
    "mli_black": ((0.030, 0.030, 0.032), (0.05, 0.05, 0.05), 25),
    "kapton": ((0.42, 0.24, 0.05), (0.10, 0.08, 0.04), 40),
    "aluminium": ((0.28, 0.28, 0.29), (0.45, 0.45, 0.46), 50),
    "white_paint": ((0.78, 0.78, 0.76), (0.04, 0.04, 0.04), 12),
    "black_paint": ((0.035, 0.035, 0.035), (0.04, 0.04, 0.04), 12),
    "radiator_mirror": ((0.06, 0.06, 0.06), (0.78, 0.78, 0.80), 500),
    "nozzle": ((0.09, 0.08, 0.07), (0.28, 0.26, 0.24), 30),
    "antenna": ((0.35, 0.33, 0.30), (0.25, 0.25, 0.25), 40),
    "lens": ((0.01, 0.01, 0.015), (0.06, 0.06, 0.07), 1000),
}


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scaled(a, s):
    return tuple(x * s for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return scaled(a, 1.0 / math.sqrt(sum(x * x for x in a)))


def mix(a, b, t):
    return tuple(x + t * (y - x) for x, y in zip(a, b))


class Mesh:
    """Faces by material and part. Corners go anticlockwise seen from outside."""

    def __init__(self):
        self.parts = []

    def part(self, name):
        self.parts.append((name, []))

    def face(self, material, corners, normals=None):
        if normals is None:
            n = unit(cross(sub(corners[1], corners[0]), sub(corners[-1], corners[0])))
            normals = [n] * len(corners)
        self.parts[-1][1].append((material, corners, normals))

    def write(self, path, title="Tango, body frame, metres. Written by make_tango.py.", materials="tango.mtl"):
        places, directions, lines = {}, {}, []
        for name, faces in self.parts:
            lines.append(f"o {name}")
            last = None
            for material, corners, normals in faces:
                if material != last:
                    lines.append(f"usemtl {material}")
                    last = material
                words = []
                for corner, normal in zip(corners, normals):
                    v = "%.5f %.5f %.5f" % tuple(x + 0.0 for x in corner)
                    n = "%.4f %.4f %.4f" % tuple(x + 0.0 for x in normal)
                    words.append("%d//%d" % (places.setdefault(v.replace("-0.00000", "0.00000"), len(places) + 1),
                                             directions.setdefault(n.replace("-0.0000", "0.0000"), len(directions) + 1)))
                lines.append("f " + " ".join(words))
        with open(path, "w", encoding="ascii") as file:
            file.write(f"# {title}\nmtllib {materials}\n")
            file.writelines(f"v {v}\n" for v in places)
            file.writelines(f"vn {n}\n" for n in directions)
            file.write("\n".join(lines) + "\n")


class Face:
    """A flat four-sided side with coordinates of its own: metres along u and v from the middle, height w outwards."""

    def __init__(self, a, b, c, d):  # anticlockwise from outside; u runs from a to b
        self.corners = (a, b, c, d)
        self.origin = scaled(add(add(a, b), add(c, d)), 0.25)
        self.u = unit(sub(b, a))
        self.w = unit(cross(sub(b, a), sub(d, a)))
        self.v = cross(self.w, self.u)

    def at(self, u, v, w=0.0):
        return add(self.origin, add(scaled(self.u, u), add(scaled(self.v, v), scaled(self.w, w))))

    def patch(self, s, t):
        """A point by fractions of the sides, 0 to 1."""
        a, b, c, d = self.corners
        return mix(mix(a, b, s), mix(d, c, s), t)


def hashed(i, j, k):
    """A number from 0 to 1 that looks random, the same everywhere."""
    x = (i * 374761393 + j * 668265263 + k * 2246822519 + 3266489917) & 0xFFFFFFFF
    x = ((x ^ (x >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((x ^ (x >> 16)) & 0xFFFF) / 65535.0


def crinkled(mesh, face, columns, rows, depth_m, seed, material):
    """A side covered with foil: a grid whose inner points are pushed inwards and sideways; `material(i, j)` of a cell."""
    def point(i, j):
        s, t = i / columns, j / rows
        if 0 < i < columns and 0 < j < rows:
            s += 0.3 / columns * (hashed(i, j, seed) - 0.5)
            t += 0.3 / rows * (hashed(i, j, seed + 1) - 0.5)
            return add(face.patch(s, t), scaled(face.w, -depth_m * hashed(i, j, seed + 2)))
        return face.patch(s, t)

    for i in range(columns):
        for j in range(rows):
            a, b, c, d = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            name = material(i, j)
            if (i + j) % 2:
                mesh.face(name, [a, b, c])
                mesh.face(name, [a, c, d])
            else:
                mesh.face(name, [a, b, d])
                mesh.face(name, [b, c, d])


def box(mesh, face, u, v, size_u, size_v, height, side, top=None, sunk=0.006):
    """A box on a side, its foot sunk into it."""
    hu, hv = size_u / 2, size_v / 2
    low = [face.at(u - hu, v - hv, -sunk), face.at(u + hu, v - hv, -sunk), face.at(u + hu, v + hv, -sunk),
           face.at(u - hu, v + hv, -sunk)]
    high = [add(p, scaled(face.w, height + sunk)) for p in low]
    mesh.face(top or side, high)
    for k in range(4):
        n = (k + 1) % 4
        mesh.face(side, [low[k], low[n], high[n], high[k]])


def tube(mesh, start, end, radius_start, radius_end, material, segments=12, cap=None, inner=False):
    """A round piece from start to end, with smooth normals; `cap` closes the end; inner: seen from inside."""
    axis = unit(sub(end, start))
    across = unit(cross(axis, (1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 1.0, 0.0)))
    other = cross(axis, across)
    length = math.sqrt(sum(x * x for x in sub(end, start)))
    slope = (radius_start - radius_end) / length

    def spoke(k):
        angle = 2.0 * math.pi * (k % segments) / segments
        return add(scaled(across, math.cos(angle)), scaled(other, math.sin(angle)))

    for k in range(segments):
        p, q = spoke(k), spoke(k + 1)
        np, nq = unit(add(p, scaled(axis, slope))), unit(add(q, scaled(axis, slope)))
        a, b = add(start, scaled(p, radius_start)), add(start, scaled(q, radius_start))
        c, d = add(end, scaled(q, radius_end)), add(end, scaled(p, radius_end))
        if inner:
            mesh.face(material, [b, a, d, c], [scaled(n, -1.0) for n in (nq, np, np, nq)])
        else:
            mesh.face(material, [a, b, c, d], [np, nq, nq, np])
        if cap:
            mesh.face(cap, [end, d, c])


def ring(mesh, face, u, v, inner_radius, outer_radius, height, material, segments=36):
    """A ring standing on a side."""
    low, high = face.at(u, v, -0.006), face.at(u, v, height)
    tube(mesh, low, high, outer_radius, outer_radius, material, segments)
    tube(mesh, low, high, inner_radius, inner_radius, material, segments, inner=True)
    for k in range(segments):
        def spoke(radius, m):
            angle = 2.0 * math.pi * (m % segments) / segments
            return face.at(u + radius * math.cos(angle), v + radius * math.sin(angle), height)
        mesh.face(material, [spoke(inner_radius, k), spoke(outer_radius, k), spoke(outer_radius, k + 1),
                             spoke(inner_radius, k + 1)])


def solar_panel(mesh):
    """Cells of 7 x 9 on the top, in strings; the corner towards k0 holds a sensor deck instead, so that no turn of the
    panel looks like another."""
    mesh.part("solar_panel")
    columns, rows, gap, margin = 7, 9, 0.004, 0.022
    width, height = 0.74, 0.77
    def edges(count, length):
        pitch = (length - 2 * margin) / count
        places = [0.0]
        for k in range(count):
            places += [margin + k * pitch + gap / 2, margin + (k + 1) * pitch - gap / 2]
        return places + [length]
    xs, ys = edges(columns, width), edges(rows, height)
    z = TOP[0][2]
    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            cell = i % 2 == 1 and j % 2 == 1
            column, row = i // 2, j // 2
            if cell and column < 2 and row < 2:
                material = "white_paint" if (column + row) % 2 == 0 else "kapton"
            elif cell:
                material = "solar_cell"
            else:
                material = "silver_busbar" if j in (6, 12) else "solar_substrate"
            x0, x1, y0, y1 = xs[i] - 0.37, xs[i + 1] - 0.37, ys[j] - 0.385, ys[j + 1] - 0.385
            mesh.face(material, [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)])
    low = [(x, y, z - PANEL_M) for x, y, _ in TOP]
    for k in range(4):  # TOP runs clockwise seen from above
        n = (k + 1) % 4
        mesh.face("aluminium", [low[n], low[k], TOP[k], TOP[n]])
    mesh.face("black_paint", low)
    top = Face(TOP[0], TOP[3], TOP[2], TOP[1])
    box(mesh, top, -0.275, -0.29, 0.06, 0.05, 0.025, "aluminium", "black_paint")          # Sun sensor
    tube(mesh, top.at(-0.21, -0.30, -0.005), top.at(-0.21, -0.30, 0.03), 0.016, 0.016, "white_paint", 12, "lens")
    tube(mesh, top.at(0.29, 0.33, -0.005), top.at(0.29, 0.33, 0.012), 0.028, 0.028, "white_paint", 16, "white_paint")  # GPS


def body(mesh):
    t = 1.0 - PANEL_M / TOP[0][2]
    high = [mix(b, a, t) for a, b in zip(TOP, BOTTOM)]
    # Seen from outside: left bottom, right bottom, right top, left top.
    minus_x = Face(BOTTOM[1], BOTTOM[0], high[0], high[1])
    plus_y = Face(BOTTOM[2], BOTTOM[1], high[1], high[2])
    plus_x = Face(BOTTOM[3], BOTTOM[2], high[2], high[3])
    minus_y = Face(BOTTOM[0], BOTTOM[3], high[3], high[0])
    bottom = Face(BOTTOM[0], BOTTOM[1], BOTTOM[2], BOTTOM[3])

    mesh.part("side_plus_x")  # gold foil, a label with stripes, a camera
    crinkled(mesh, plus_x, 14, 7, 0.006, 11, lambda i, j: "mli_gold")
    box(mesh, plus_x, -0.13, 0.02, 0.20, 0.12, 0.004, "white_paint")
    for k in range(3):
        box(mesh, plus_x, -0.185 + 0.055 * k, 0.02, 0.022, 0.10, 0.0055, "black_paint", sunk=0.0)
    box(mesh, plus_x, 0.17, -0.03, 0.09, 0.09, 0.05, "aluminium")
    tube(mesh, plus_x.at(0.17, -0.03, 0.045), plus_x.at(0.17, -0.03, 0.075), 0.03, 0.034, "black_paint", 16, "lens")

    mesh.part("side_minus_x")  # black foil, a radiator of mirrors
    crinkled(mesh, minus_x, 12, 6, 0.006, 23, lambda i, j: "mli_black")
    for i in range(4):
        for k in range(3):
            box(mesh, minus_x, -0.02 + 0.062 * i, -0.062 + 0.062 * k, 0.058, 0.058, 0.004, "aluminium", "radiator_mirror")
    box(mesh, minus_x, -0.18, 0.05, 0.07, 0.05, 0.03, "white_paint", "black_paint")

    mesh.part("side_plus_y")  # gold and black foil, two boxes
    crinkled(mesh, plus_y, 16, 6, 0.006, 37, lambda i, j: "mli_gold" if i < 10 else "mli_black")
    box(mesh, plus_y, -0.20, 0.0, 0.16, 0.14, 0.02, "aluminium", "white_paint")
    box(mesh, plus_y, 0.24, 0.05, 0.10, 0.06, 0.035, "kapton", "aluminium")
    tube(mesh, plus_y.at(0.05, -0.07, -0.005), plus_y.at(0.05, -0.07, 0.03), 0.022, 0.022, "aluminium", 14, "black_paint")

    mesh.part("side_minus_y")  # kapton, an umbilical plate, a nozzle
    crinkled(mesh, minus_y, 16, 6, 0.006, 51, lambda i, j: "kapton" if (i // 4) % 2 == 0 else "mli_gold")
    box(mesh, minus_y, 0.18, -0.02, 0.20, 0.12, 0.006, "aluminium")
    for k in range(4):
        tube(mesh, minus_y.at(0.11 + 0.045 * k, -0.02, 0.004), minus_y.at(0.11 + 0.045 * k, -0.02, 0.016), 0.014, 0.014,
             "black_paint", 10, "black_paint")
    tube(mesh, minus_y.at(-0.22, 0.0, -0.005), minus_y.at(-0.22, 0.0, 0.05), 0.012, 0.032, "nozzle", 16)
    tube(mesh, minus_y.at(-0.22, 0.0, -0.005), minus_y.at(-0.22, 0.0, 0.05), 0.011, 0.031, "nozzle", 16, inner=True)

    mesh.part("bottom")  # launch adapter ring and thermal plates
    crinkled(mesh, bottom, 10, 12, 0.005, 67, lambda i, j: "mli_gold" if j < 9 else "mli_black")
    ring(mesh, bottom, 0.0, 0.03, 0.13, 0.155, 0.035, "aluminium")
    box(mesh, bottom, 0.20, -0.24, 0.10, 0.14, 0.006, "white_paint")
    box(mesh, bottom, -0.20, 0.25, 0.08, 0.08, 0.025, "aluminium", "black_paint")
    tube(mesh, bottom.at(0.0, 0.03, -0.005), bottom.at(0.0, 0.03, 0.03), 0.02, 0.045, "nozzle", 18)
    tube(mesh, bottom.at(0.0, 0.03, -0.005), bottom.at(0.0, 0.03, 0.03), 0.019, 0.044, "nozzle", 18, inner=True)


def antennas(mesh):
    mesh.part("antennas")
    for corner, tip in ANTENNAS:
        root = add(TOP[corner], (-0.03 if TOP[corner][0] > 0 else 0.03, -0.03 if TOP[corner][1] > 0 else 0.03, -0.03))
        tube(mesh, root, mix(root, tip, 0.3), 0.012, 0.009, "aluminium", 12)
        tube(mesh, mix(root, tip, 0.3), tip, 0.007, 0.005, "antenna", 12, "antenna")


def write_materials(path, model="tango.obj", script="make_tango.py", materials=MATERIALS):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"# Materials of {model}, linear. Written by {script}.\n")
        for name, (kd, ks, ns) in materials.items():
            file.write(f"\nnewmtl {name}\nKd {kd[0]} {kd[1]} {kd[2]}\nKs {ks[0]} {ks[1]} {ks[2]}\nNs {ns}\nillum 2\n")


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    mesh = Mesh()
    solar_panel(mesh)
    body(mesh)
    antennas(mesh)
    mesh.write(folder / "tango.obj")
    write_materials(folder / "tango.mtl")


if __name__ == "__main__":
    main()
