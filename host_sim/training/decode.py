"""Keypoints from maps, as the flight software finds them: highest cell, mean and second moments about it."""

import numpy
import torch

import crops

WINDOW = 3  # cells either way


def decode(logits):
    """Places (cells, x and y), second moments (cells^2), share of the highest 3 x 3 cells; n x 11 each."""
    count, keypoints = logits.shape[:2]
    side = crops.MAP_SIDE
    p = torch.softmax(logits.double().flatten(2), 2).reshape(count * keypoints, side, side).numpy()
    highest = p.reshape(len(p), -1).argmax(1)
    row, column = highest // side, highest % side
    padded = numpy.pad(p, ((0, 0), (WINDOW, WINDOW), (WINDOW, WINDOW)))
    reach = numpy.arange(2 * WINDOW + 1)
    window = padded[numpy.arange(len(p))[:, None, None], (row[:, None] + reach)[:, :, None],
                    (column[:, None] + reach)[:, None, :]]
    peak = window[:, WINDOW - 1:WINDOW + 2, WINDOW - 1:WINDOW + 2].sum((1, 2))
    window = window / window.sum((1, 2), keepdims=True)
    off = reach - WINDOW
    x, y = (window * off[None, None, :]).sum((1, 2)), (window * off[None, :, None]).sum((1, 2))
    xx = (window * (off[None, None, :] - x[:, None, None])**2).sum((1, 2))
    yy = (window * (off[None, :, None] - y[:, None, None])**2).sum((1, 2))
    xy = (window * (off[None, None, :] - x[:, None, None]) * (off[None, :, None] - y[:, None, None])).sum((1, 2))
    shape = (count, keypoints)
    places = numpy.stack([column + x, row + y], -1).reshape(*shape, 2)
    moments = numpy.stack([numpy.stack([xx, xy], -1), numpy.stack([xy, yy], -1)], -1).reshape(*shape, 2, 2)
    return places, moments, peak.reshape(shape)


def covariances(moments, scale, floor, target_sigma):
    """scale * (moments - target_sigma^2 I)+ + floor I: what is below zero along an axis is none."""
    values, axes = numpy.linalg.eigh(moments - target_sigma**2 * numpy.eye(2))
    values = scale * numpy.maximum(values, 0.0) + floor
    return numpy.einsum("...ij,...j,...kj->...ik", axes, values, axes)
