"""Crops with their keypoints marked, as one image for inspection: contact_sheet.py SHARD PNG [FIRST]."""

import struct
import sys
import zlib

import numpy

import crops

ACROSS, DOWN, ENLARGED = 8, 8, 2
COLOURS = [(255, 60, 60), (60, 255, 60), (80, 120, 255), (255, 255, 60), (255, 60, 255), (60, 255, 255),
           (255, 150, 50), (170, 90, 255), (255, 255, 255), (150, 255, 150), (255, 150, 200)]


def png(rgb):
    height, width, _ = rgb.shape
    rows = numpy.concatenate([numpy.zeros((height, 1), numpy.uint8), rgb.reshape(height, -1)], axis=1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b""))


def picture(record):
    big = numpy.repeat(numpy.repeat(record["image"], ENLARGED, 0), ENLARGED, 1)
    rgb = numpy.stack([big] * 3, -1)
    rgb[0], rgb[:, 0] = 60, 60
    for k in range(crops.KEYPOINTS):
        if record["counts"][k] < 0.5:
            continue
        x, y = (record["cells"][k] + 0.5) * 4 * ENLARGED
        for dx, dy in ((0, 0), (3, 0), (-3, 0), (0, 3), (0, -3), (2, 0), (-2, 0), (0, 2), (0, -2)):
            i, j = int(x) + dx, int(y) + dy
            if 0 <= i < rgb.shape[1] and 0 <= j < rgb.shape[0]:
                rgb[j, i] = COLOURS[k]
    return rgb


def main():
    records = crops.read_shard(sys.argv[1])[int(sys.argv[3]) if len(sys.argv) > 3 else 0:]
    pictures = [picture(record) for record in records[:ACROSS * DOWN]]
    rows = [numpy.concatenate(pictures[i:i + ACROSS], 1) for i in range(0, len(pictures), ACROSS)]
    with open(sys.argv[2], "wb") as file:
        file.write(png(numpy.concatenate(rows, 0)))


if __name__ == "__main__":
    main()
