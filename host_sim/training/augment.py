"""Augmentation of crops in addition to the renderer: rotations, noise, blur, contrast, occlusions."""

import math

import torch
from torch.nn import functional

import crops

BYTES_A_SAMPLE = 4.0
LEAST_DEVIATION = 0.5  # as in fsw/vision/pose/crop.cpp


def standardised(samples):
    """Mean 0 and deviation 1 of each crop, as in cut_crop. batch x 1 x side x side."""
    flat = samples.flatten(1)
    mean = flat.mean(1)
    deviation = torch.sqrt(((flat - mean[:, None])**2).mean(1)).clamp(min=LEAST_DEVIATION)
    return (samples - mean[:, None, None, None]) / deviation[:, None, None, None]


def samples_of(images):
    return torch.tensor(images).unsqueeze(1).float() / BYTES_A_SAMPLE


def turned(images, cells, turns):
    """By quarters, anticlockwise, together with the keypoints."""
    last = crops.MAP_SIDE - 1
    x, y = cells[..., 0], cells[..., 1]
    for _ in range(turns):
        x, y = y, last - x
    return torch.rot90(images, turns, (2, 3)), torch.stack([x, y], -1)


def uniform(count, low, high):
    return low + (high - low) * torch.rand(count, 1, 1, 1)


def log_uniform(count, low, high):
    return torch.exp(uniform(count, math.log(low), math.log(high)))


def happens(count, share):
    return torch.rand(count, 1, 1, 1) < share


def blurred(x):
    """Blur of a quarter of the crops: 10 to 100 % of a 3 x 3 binomial mean."""
    kernel = torch.tensor([1.0, 2.0, 1.0]) / 4.0
    soft = functional.conv2d(functional.pad(x, (1, 1, 1, 1), mode="replicate"), torch.outer(kernel, kernel)[None, None])
    part = uniform(len(x), 0.1, 1.0) * happens(len(x), 0.25)
    return x + part * (soft - x)


def with_patches(x):
    """A bar or patch of uniform brightness over a tenth of the crops."""
    count, side = len(x), x.shape[-1]
    place = torch.arange(side)
    middle = torch.rand(count, 2) * side
    half = torch.exp(torch.rand(count, 2) * math.log(20.0)) * 1.5
    rows = (place[None] - middle[:, :1]).abs() < half[:, :1]
    columns = (place[None] - middle[:, 1:]).abs() < half[:, 1:]
    inside = (rows[:, :, None] & columns[:, None, :])[:, None] & happens(count, 0.1)
    return torch.where(inside, uniform(count, 0.0, 50.0).expand_as(x), x)


def augmented(images, cells):
    """A batch for training from bytes (batch x side x side) and places of keypoints: standardised crops, places."""
    x, cells = samples_of(images), torch.from_numpy(cells)
    quarter = (len(x) + 3) // 4
    parts = [turned(x[i * quarter:(i + 1) * quarter], cells[i * quarter:(i + 1) * quarter], i) for i in range(4)]
    x, cells = torch.cat([p[0] for p in parts]), torch.cat([p[1] for p in parts])
    count = len(x)
    x = with_patches(x)
    x = 64.0 * (x / 64.0).clamp(min=1e-4)**torch.where(happens(count, 0.5), uniform(count, 0.7, 1.4), torch.ones(1))
    x = blurred(x)
    x = x * torch.where(happens(count, 0.3), log_uniform(count, 0.5, 1.5), torch.ones(1))
    noise = log_uniform(count, 0.03, 1.5) * happens(count, 0.5)
    x = (x + noise * torch.randn_like(x)).clamp(min=0.0)
    return standardised(x), cells
