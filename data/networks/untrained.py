"""Writes a weights file of the keypoint network (layout: fsw/network/architecture.h) that was never trained.

Usage: untrained.py FILE. Random weights of the size that He et al. (2015) start training with: activations neither grow
nor fade from layer to layer. For work on the program before there are trained weights.
"""

import pathlib
import struct
import sys
import zlib

import numpy

# channels in, channels out, side of the kernel, stride, rectified
LAYERS = [(1, 24, 3, 2, 1), (24, 40, 3, 2, 1), (40, 40, 3, 1, 1), (40, 64, 3, 2, 1), (64, 64, 3, 1, 1), (64, 128, 3, 2, 1),
          (128, 128, 3, 1, 1), (128, 128, 3, 1, 1), (128, 64, 1, 1, 0), (64, 64, 3, 1, 1), (64, 40, 1, 1, 0),
          (40, 40, 3, 1, 1), (40, 12, 1, 1, 0)]
KEYPOINTS = 11
LEAST = 2.0**-40


def storable(numbers):
    """Weights as a file may hold them: 0 or at least 2^-40 in size."""
    return numpy.where(numpy.abs(numbers) < LEAST, 0.0, numbers).astype("<f4")


def main():
    random = numpy.random.default_rng(1)
    file = b"vbar keypoints 1" + struct.pack("<4I", len(LAYERS), 128, 32, KEYPOINTS)
    for layer in LAYERS:
        file += struct.pack("<8I", *layer, 0, 0, 0)
    file += struct.pack("<4f", 1.0, 0.05, 1.0, 0.05)
    for channels_in, channels_out, kernel, _, _ in LAYERS:
        inputs = kernel * kernel * channels_in
        weights = random.normal(0.0, (2.0 / inputs) ** 0.5, (inputs, channels_out))
        biases = random.normal(0.0, 0.05, channels_out)
        if channels_out == 12:
            weights[:, KEYPOINTS:] = 0.0
            biases[KEYPOINTS:] = 0.0
        file += storable(weights).tobytes() + storable(biases).tobytes()
    pathlib.Path(sys.argv[1]).write_bytes(file + struct.pack("<I", zlib.crc32(file)))


if __name__ == "__main__":
    main()
