#!/usr/bin/env python3
"""Writes tango_mockup.obj and tango_mockup.mtl, the half-scale mock-up of Tango that hangs on TRON's arm, into the folder of
this script or another one:

    make_tango_mockup.py [FOLDER]

The shape is that of make_tango.py at full scale, with what a mock-up has and a satellite does not: seams where its panels
meet, cells of the solar panel printed with lines, and paints that are not those of the flight model. Which paint differs by
how much is drawn by make_tango's hash; no published figure exists. The same bytes on every run.
"""

import pathlib
import sys

import make_tango
from make_tango import BOTTOM, MATERIALS, PANEL_M, TOP, Face, box, hashed, mix

SEAM_M = 0.006   # width; 3 mm on the mock-up
LINE_M = 0.003


def seams(mesh):
    mesh.part("seams")
    t = 1.0 - PANEL_M / TOP[0][2]
    high = [mix(b, a, t) for a, b in zip(TOP, BOTTOM)]
    for k in range(4):
        n = (k + 1) % 4
        face = Face(BOTTOM[n], BOTTOM[k], high[k], high[n])
        width = min(sum((x - y) ** 2 for x, y in zip(BOTTOM[n], BOTTOM[k])) ** 0.5,
                    sum((x - y) ** 2 for x, y in zip(high[n], high[k])) ** 0.5)
        height = 0.28
        for u in (-0.27, 0.31):
            box(mesh, face, u * width, 0.0, SEAM_M, height, 0.001, "seam")
        box(mesh, face, 0.0, 0.085, 0.96 * width, SEAM_M, 0.0008, "seam")


def printed_cells(mesh):
    """Two lines along each cell and one across, 0.2 mm above it."""
    mesh.part("printed_cells")
    columns, rows, gap, margin = 7, 9, 0.004, 0.022
    z = TOP[0][2] + 0.0002
    pitch_x, pitch_y = (0.74 - 2 * margin) / columns, (0.77 - 2 * margin) / rows
    for column in range(columns):
        for row in range(rows):
            if column < 2 and row < 2:
                continue
            x0, x1 = margin + column * pitch_x + gap / 2 - 0.37, margin + (column + 1) * pitch_x - gap / 2 - 0.37
            y0, y1 = margin + row * pitch_y + gap / 2 - 0.385, margin + (row + 1) * pitch_y - gap / 2 - 0.385
            for part in (0.32, 0.68):
                x = x0 + part * (x1 - x0)
                mesh.face("printed_line", [(x - LINE_M / 2, y0, z), (x + LINE_M / 2, y0, z), (x + LINE_M / 2, y1, z),
                                           (x - LINE_M / 2, y1, z)])


def paints():
    """The flight model's materials with other albedo and gloss, 0.6 to 1.6 times, within what a surface can reflect."""
    made = {}
    for number, (name, (kd, ks, ns)) in enumerate(sorted(MATERIALS.items())):
        factor = [0.6 + hashed(number, part, 97) for part in range(3)]
        grey_kd, grey_ks = sum(kd) / 3, sum(ks) / 3
        albedo = min(factor[0], 0.72 / grey_kd)
        gloss = min(factor[1], max(0.2, (0.95 - albedo * grey_kd) / grey_ks))
        made[name] = (tuple(albedo * x for x in kd), tuple(gloss * x for x in ks), factor[2] * ns)
    made["seam"] = ((0.12, 0.12, 0.12), (0.04, 0.04, 0.04), 15.0)
    made["printed_line"] = ((0.42, 0.42, 0.40), (0.04, 0.04, 0.04), 60.0)
    return made


def write_materials(path):
    with open(path, "w", encoding="ascii") as file:
        file.write("# Materials of tango_mockup.obj, linear. Written by make_tango_mockup.py.\n")
        for name, (kd, ks, ns) in paints().items():
            file.write(f"\nnewmtl {name}\n")
            file.write("Kd %.4f %.4f %.4f\nKs %.4f %.4f %.4f\nNs %.1f\nillum 2\n" % (*kd, *ks, ns))


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    mesh = make_tango.Mesh()
    make_tango.solar_panel(mesh)
    make_tango.body(mesh)
    make_tango.antennas(mesh)
    seams(mesh)
    printed_cells(mesh)
    mesh.write(folder / "tango_mockup.obj", "Mock-up of Tango, body frame, metres, full scale. Written by make_tango_mockup.py.",
               "tango_mockup.mtl")
    write_materials(folder / "tango_mockup.mtl")


if __name__ == "__main__":
    main()
