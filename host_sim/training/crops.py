"""Shards of crops, as host_sim/training/shard_file.h describes them."""

import pathlib
import struct

import numpy

KEYPOINTS = 11
SIDE = 128
MAP_SIDE = 32
NUMBERS = 56
HEADER = 48

RECORD = numpy.dtype([
    ("image", "u1", (SIDE, SIDE)),
    ("cells", "<f4", (KEYPOINTS, 2)),
    ("counts", "<f4", (KEYPOINTS,)),
    ("q_camera_body", "<f4", (4,)),  # x y z w
    ("centre_of_mass_camera", "<f4", (3,)),
    ("region", "<f4", (3,)),  # centre x, y, side; px
    ("camera", "<f4", (8,)),  # focal length, principal point (px), k1 k2 p1 p2 k3
    ("phase_angle", "<f4"),
    ("sunlit", "<f4"),
    ("exposure", "<f4"),
    ("spread_px", "<f4"),
    ("nadir_angle", "<f4"),
])


def read_shard(path):
    """The crops of a file, as an array of RECORD."""
    data = pathlib.Path(path).read_bytes()
    if data[:16].rstrip(b"\0") != b"vbar crops 1":
        raise ValueError(f"{path}: not a file of crops")
    count, side, keypoints, numbers = struct.unpack_from("<4I", data, 16)
    if (side, keypoints, numbers) != (SIDE, KEYPOINTS, NUMBERS) or len(data) != HEADER + count * RECORD.itemsize:
        raise ValueError(f"{path}: {count} crops of {side} samples, {keypoints} keypoints, {numbers} numbers "
                         f"in {len(data)} bytes")
    return numpy.frombuffer(data, RECORD, count, HEADER)


def shards(folder, kind):
    """Files of a kind, in order."""
    return sorted(pathlib.Path(folder).glob(f"{kind}_*.crops"))
