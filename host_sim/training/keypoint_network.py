"""The keypoint network for training, and the weights file the flight software reads (docs/keypoint_network.md)."""

import struct
import zlib

import numpy
import torch
from torch import nn
from torch.nn import functional

KEYPOINTS = 11
INPUT_SIDE = 128
MAP_SIDE = 32
MAPS = 12  # the twelfth is unused: maps come in fours
# in, out, kernel, stride, ReLU
LAYERS = [(1, 24, 3, 2, 1), (24, 40, 3, 2, 1), (40, 40, 3, 1, 1), (40, 64, 3, 2, 1), (64, 64, 3, 1, 1),
          (64, 128, 3, 2, 1), (128, 128, 3, 1, 1), (128, 128, 3, 1, 1), (128, 64, 1, 1, 0), (64, 64, 3, 1, 1),
          (64, 40, 1, 1, 0), (40, 40, 3, 1, 1), (40, MAPS, 1, 1, 0)]
LEAST_SIZE = 2.0**-40  # of a weight that is not zero: no product is ever denormal
MOST_SIZE = 2.0**20
MAGIC = b"vbar keypoints 2"
CALIBRATION = 5  # numbers, then three zeros


def run(x, layer):
    """The network's structure: `layer(number from 1, input)` computes a layer, ReLU included."""
    a = layer(3, layer(2, layer(1, x)))
    b = layer(5, layer(4, a))
    x = layer(8, layer(7, layer(6, b)))
    x = layer(10, functional.interpolate(layer(9, x), scale_factor=2, mode="nearest") + b)
    x = layer(12, functional.interpolate(layer(11, x), scale_factor=2, mode="nearest") + a)
    return layer(13, x)


class KeypointNetwork(nn.Module):
    """Logits of the eleven heatmaps, batch x 11 x 32 x 32. All layers but the last use batch normalisation."""

    def __init__(self):
        super().__init__()
        last = len(LAYERS) - 1
        self.convolutions = nn.ModuleList(
            nn.Conv2d(i, KEYPOINTS if n == last else o, k, s, k // 2, bias=n == last)
            for n, (i, o, k, s, _) in enumerate(LAYERS))
        self.norms = nn.ModuleList(nn.BatchNorm2d(o) for _, o, _, _, _ in LAYERS[:last])
        for convolution in self.convolutions:
            nn.init.kaiming_normal_(convolution.weight, nonlinearity="relu")
        nn.init.zeros_(self.convolutions[last].bias)
        nn.init.normal_(self.convolutions[last].weight, std=0.01)

    def layer(self, number, x):
        x = self.convolutions[number - 1](x)
        if number < len(LAYERS):
            x = self.norms[number - 1](x)
        return functional.relu(x) if LAYERS[number - 1][4] else x

    def forward(self, x):
        return run(x, self.layer)


def folded(model):
    """Weights (out, in, ky, kx) and biases of each layer, including the normalisation, tiny ones zero."""
    layers = []
    for number, convolution in enumerate(model.convolutions):
        weight = convolution.weight.detach().double()
        if number < len(model.norms):
            norm = model.norms[number]
            factor = norm.weight.detach().double() / torch.sqrt(norm.running_var.double() + norm.eps)
            weight = weight * factor[:, None, None, None]
            bias = norm.bias.detach().double() - norm.running_mean.double() * factor
        else:
            bias = convolution.bias.detach().double()
            unused = MAPS - KEYPOINTS
            weight = torch.cat([weight, torch.zeros(unused, *weight.shape[1:], dtype=weight.dtype)])
            bias = torch.cat([bias, torch.zeros(unused, dtype=bias.dtype)])
        layers.append((tidy(weight), tidy(bias)))
    return layers


def tidy(values):
    values = torch.where(values.abs() < LEAST_SIZE, torch.zeros_like(values), values).float()
    if not bool(torch.isfinite(values).all()) or float(values.abs().max()) >= MOST_SIZE:
        raise ValueError("a weight is not finite or too large for the flight software")
    return values


def run_folded(layers, x):
    """Heatmaps as in the flight software, except for the order of its sums."""

    def layer(number, x):
        weight, bias = layers[number - 1]
        x = functional.conv2d(x, weight, bias, stride=LAYERS[number - 1][3], padding=weight.shape[-1] // 2)
        return functional.relu(x) if LAYERS[number - 1][4] else x

    return run(x, layer)[:, :KEYPOINTS]


def weights_file(layers, calibration):
    """Bytes. `calibration`: covariance scale, covariance floor (cells^2), target's sigma (cells), least peak,
    stretch."""
    data = MAGIC + struct.pack("<4I", len(LAYERS), INPUT_SIDE, MAP_SIDE, KEYPOINTS)
    for layer in LAYERS:
        data += struct.pack("<8I", *layer, 0, 0, 0)
    data += struct.pack("<8f", *calibration, 0.0, 0.0, 0.0)
    for weight, bias in layers:
        data += weight.permute(2, 3, 1, 0).contiguous().numpy().astype("<f4").tobytes()
        data += bias.numpy().astype("<f4").tobytes()
    return data + struct.pack("<I", zlib.crc32(data))


def read_weights(data):
    """Layers and calibration of a weights file."""
    if data[:16] != MAGIC or struct.unpack("<I", data[-4:])[0] != zlib.crc32(data[:-4]):
        raise ValueError("not a weights file, or a damaged one")
    at = 32 + 32 * len(LAYERS)
    calibration = struct.unpack_from(f"<{CALIBRATION}f", data, at)
    at += 32
    layers = []
    for i, o, k, _, _ in LAYERS:
        weight = numpy.frombuffer(data, "<f4", k * k * i * o, at).reshape(k, k, i, o)
        at += weight.nbytes
        bias = numpy.frombuffer(data, "<f4", o, at)
        at += bias.nbytes
        layers.append((torch.tensor(weight).permute(3, 2, 0, 1).contiguous(), torch.tensor(bias)))
    return layers, calibration
