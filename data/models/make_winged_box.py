#!/usr/bin/env python3
"""Writes winged_box.obj and winged_box.mtl, an invented microsatellite, into the folder of this script or another one:

    make_winged_box.py [FOLDER]

A box of 0.4 x 0.4 x 0.5 m with two solar wings along x whose cells face +y. It is a difficult target: half a turn about any of its axes
leaves the outline nearly unchanged, and only a baffle (+y), an antenna (+z, at a corner), an adapter ring (-z) and the sides of the
wings distinguish the four attitudes. Body frame: z from the adapter ring to the antenna, origin in the bottom plane, metres.
"""
import pathlib
import sys

import make_tango
from make_tango import Face, Mesh, box, crinkled, ring, tube

HALF_X, HALF_Y, HEIGHT = 0.20, 0.20, 0.50
WING_ROOT, WING_TIP, WING_LOW, WING_HIGH = 0.27, 0.73, 0.05, 0.45
WING_THICKNESS = 0.016


def corner(x, y, z):
    return (x * HALF_X, y * HALF_Y, z * HEIGHT)


def body(mesh):
    plus_x = Face(corner(1, -1, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, -1, 1))
    minus_x = Face(corner(-1, 1, 0), corner(-1, -1, 0), corner(-1, -1, 1), corner(-1, 1, 1))
    plus_y = Face(corner(1, 1, 0), corner(-1, 1, 0), corner(-1, 1, 1), corner(1, 1, 1))
    minus_y = Face(corner(-1, -1, 0), corner(1, -1, 0), corner(1, -1, 1), corner(-1, -1, 1))
    top = Face(corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1))
    bottom = Face(corner(-1, 1, 0), corner(1, 1, 0), corner(1, -1, 0), corner(-1, -1, 0))

    for name, face, seed in (("plus_x", plus_x, 101), ("minus_x", minus_x, 113), ("minus_y", minus_y, 127), ("bottom", bottom, 131)):
        mesh.part(f"side_{name}")
        crinkled(mesh, face, 8, 10, 0.005, seed, lambda i, j: "mli_gold")
    mesh.part("side_plus_y")  # foil and the baffle of an instrument
    crinkled(mesh, plus_y, 8, 10, 0.005, 139, lambda i, j: "mli_gold" if j < 6 else "mli_black")
    tube(mesh, plus_y.at(0.07, 0.12, -0.006), plus_y.at(0.07, 0.12, 0.12), 0.055, 0.065, "black_paint", 20)
    tube(mesh, plus_y.at(0.07, 0.12, -0.006), plus_y.at(0.07, 0.12, 0.12), 0.054, 0.064, "black_paint", 20, inner=True)
    tube(mesh, plus_y.at(0.07, 0.12, -0.006), plus_y.at(0.07, 0.12, 0.02), 0.05, 0.05, "aluminium", 20, "lens")
    mesh.part("side_minus_y_plates")
    box(mesh, minus_y, 0.0, -0.06, 0.30, 0.22, 0.006, "aluminium", "radiator_mirror")
    mesh.part("ring")
    ring(mesh, bottom, 0.0, 0.0, 0.11, 0.135, 0.04, "aluminium")
    mesh.part("top")  # white plate, patch antenna, whip at a corner
    crinkled(mesh, top, 6, 6, 0.002, 149, lambda i, j: "white_paint")
    box(mesh, top, -0.09, -0.08, 0.12, 0.12, 0.02, "aluminium", "kapton")
    root, tip = top.at(0.16, 0.16, -0.006), top.at(0.27, 0.27, 0.20)
    tube(mesh, root, make_tango.mix(root, tip, 0.3), 0.014, 0.010, "aluminium", 12)
    tube(mesh, make_tango.mix(root, tip, 0.3), tip, 0.009, 0.007, "antenna", 12, "antenna")


def wing(mesh, sign, name):
    """Its cells on +y, 5 x 4; a yoke to the body."""
    mesh.part(name)
    y = 0.5 * WING_THICKNESS
    first, last = sorted((sign * WING_ROOT, sign * WING_TIP))
    front = Face((last, y, WING_LOW), (first, y, WING_LOW), (first, y, WING_HIGH), (last, y, WING_HIGH))
    columns, rows, gap = 5, 4, 0.02  # gap: a share of a cell
    for i in range(columns):
        for j in range(rows):
            left, right = (i + gap) / columns, (i + 1 - gap) / columns
            low, high = (j + gap) / rows, (j + 1 - gap) / rows
            mesh.face("solar_cell", [front.patch(left, low), front.patch(right, low), front.patch(right, high), front.patch(left, high)])
    corners = [(last, WING_LOW), (first, WING_LOW), (first, WING_HIGH), (last, WING_HIGH)]
    behind = 0.002  # the substrate, behind the cells
    mesh.face("solar_substrate", [(x, y - behind, z) for x, z in corners])
    mesh.face("white_paint", [(x, -y, z) for x, z in reversed(corners)])
    for k in range(4):
        (x0, z0), (x1, z1) = corners[k], corners[(k + 1) % 4]
        mesh.face("aluminium", [(x0, -y, z0), (x1, -y, z1), (x1, y - behind, z1), (x0, y - behind, z0)])
    middle = 0.5 * (WING_LOW + WING_HIGH)
    for z in (middle - 0.08, middle + 0.08):
        tube(mesh, (sign * (HALF_X - 0.006), 0.0, middle), (sign * WING_ROOT, 0.0, z), 0.008, 0.008, "aluminium", 8)


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    mesh = Mesh()
    body(mesh)
    wing(mesh, 1, "wing_plus_x")
    wing(mesh, -1, "wing_minus_x")
    mesh.write(folder / "winged_box.obj", "Winged box, body frame, metres. Written by make_winged_box.py.", "winged_box.mtl")
    used = {material for _, faces in mesh.parts for material, _, _ in faces}
    make_tango.write_materials(folder / "winged_box.mtl", "winged_box.obj", "make_winged_box.py",
                               {name: values for name, values in make_tango.MATERIALS.items() if name in used})


if __name__ == "__main__":
    main()
