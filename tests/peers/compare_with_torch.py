"""The keypoint network in flight code and in PyTorch: the same weights file, the same crops, the same maps.

Usage: compare_with_torch.py NETWORK_TOOL WEIGHTS. The file is read here by its own description of its layers; which layer's
output goes where is written down here a second time. Exit code 77: no PyTorch.
"""

import pathlib
import struct
import subprocess
import sys
import zlib

try:
    import numpy
    import torch
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

SIDE = 128
# Both compute in single precision and add up in different orders; a weight in the wrong place is off by a hundredth and more.
LARGEST_DIFFERENCE = 1e-4


class Network(torch.nn.Module):
    def __init__(self, file):
        super().__init__()
        assert file[:16] == b"vbar keypoints 2" and zlib.crc32(file[:-4]) == struct.unpack("<I", file[-4:])[0]
        count, input_side, self.map_side, self.keypoints = struct.unpack_from("<4I", file, 16)
        assert input_side == SIDE
        layers = [struct.unpack_from("<8I", file, 32 + 32 * layer) for layer in range(count)]
        offset = 32 + 32 * count + 32
        self.convolutions = []
        for channels_in, channels_out, kernel, stride, rectified, *_ in layers:
            weights = numpy.frombuffer(file, "<f4", kernel * kernel * channels_in * channels_out, offset)
            offset += weights.nbytes
            biases = numpy.frombuffer(file, "<f4", channels_out, offset)
            offset += biases.nbytes
            convolution = torch.nn.Conv2d(channels_in, channels_out, kernel, stride, padding=kernel // 2)
            shaped = weights.reshape(kernel, kernel, channels_in, channels_out).transpose(3, 2, 0, 1)
            convolution.weight.data = torch.from_numpy(shaped.copy())
            convolution.bias.data = torch.from_numpy(biases.copy())
            self.convolutions.append(torch.nn.Sequential(convolution, torch.nn.ReLU()) if rectified else convolution)
        assert offset == len(file) - 4

    def forward(self, crop):
        one = self.convolutions
        kept_32 = one[2](one[1](one[0](crop)))
        kept_16 = one[4](one[3](kept_32))
        deepest = one[7](one[6](one[5](kept_16)))
        up_16 = one[9](torch.nn.functional.interpolate(one[8](deepest), scale_factor=2, mode="nearest") + kept_16)
        up_32 = one[11](torch.nn.functional.interpolate(one[10](up_16), scale_factor=2, mode="nearest") + kept_32)
        return one[12](up_32)[:, :self.keypoints]


def crops():
    """Noise, an even crop, a gradient, bright boxes before a dark sky, a crop that is dark but for one sample."""
    random = numpy.random.default_rng(5)
    y, x = numpy.mgrid[0:SIDE, 0:SIDE]
    box = ((x > 30) & (x < 90) & (y > 45) & (y < 80)) | ((x > 50) & (x < 60) & (y > 10) & (y < 120))
    noisy_box = box * 2.0 - 0.5 + 0.1 * random.normal(size=(SIDE, SIDE))
    point = numpy.zeros((SIDE, SIDE))
    point[77, 13] = 100.0
    every = [random.normal(size=(SIDE, SIDE)), numpy.zeros((SIDE, SIDE)), (x - y) / 74.0, noisy_box, point]
    return numpy.stack(every).astype("<f4")[:, None]


def main():
    tool, weights = sys.argv[1:]
    torch.set_num_threads(1)
    network = Network(pathlib.Path(weights).read_bytes())
    inputs = crops()
    with torch.no_grad():
        expected = network(torch.from_numpy(inputs)).numpy()
    answer = subprocess.run([tool, weights], input=inputs.tobytes(), capture_output=True, check=True).stdout
    maps = numpy.frombuffer(answer, "<f4").reshape(expected.shape)
    worst = 0.0
    for one, (of_torch, of_flight) in enumerate(zip(expected, maps)):
        largest = numpy.abs(of_torch).max()
        worst = max(worst, float(numpy.abs(of_flight - of_torch).max() / largest))
        print(f"crop {one}: largest logit {largest:.4g}, largest difference {numpy.abs(of_flight - of_torch).max():.3g}")
    if not worst < LARGEST_DIFFERENCE:
        sys.exit(f"FAILED: {worst:.3g} of the largest logit, allowed {LARGEST_DIFFERENCE:.3g}")


if __name__ == "__main__":
    main()
