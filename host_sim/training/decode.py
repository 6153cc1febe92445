"""Keypoints from heatmaps, as in the flight software (fsw/vision/pose/heatmap.cpp): mean and second moments in a window about
the highest cell, less what the Gaussian that training asked for has of them itself."""

import dataclasses

import numpy
import torch

import crops

REACH = 3  # cells of a window beside its middle
MOST_SECOND = 0.6  # of the highest cell: what is higher outside the window is another place
LEAST_SLOPE = 0.3


@dataclasses.dataclass
class Peaks:
    """n x 11 of each."""

    places: numpy.ndarray  # cells, x and y
    excess: numpy.ndarray  # second moments beyond the target's, cells^2, 2 x 2
    shares: numpy.ndarray  # of the highest 3 x 3 cells
    is_clear: numpy.ndarray  # one peak, not at the border

    def __getitem__(self, chosen):
        return Peaks(self.places[chosen], self.excess[chosen], self.shares[chosen], self.is_clear[chosen])

    def accepted(self, least_share):
        return self.is_clear & (self.shares >= least_share)


def near(middle, reach):
    """Which cells of an axis lie within reach of `middle` (n): n x 32."""
    return numpy.abs(numpy.arange(crops.MAP_SIDE)[None] - middle[:, None]) <= reach


def axis_moments(weights):
    """Mean and variance over the cells of an axis, of weights n x 32."""
    cells = numpy.arange(crops.MAP_SIDE)
    total = weights.sum(1)
    mean = (weights * cells).sum(1) / total
    return mean, (weights * (cells - mean[:, None])**2).sum(1) / total


def allowed_for_cut(mean, variance, inside, sigma):
    """The centre of the Gaussian that has this mean in the window, and the variance less that Gaussian's there."""
    cells = numpy.arange(crops.MAP_SIDE)

    def cut(centre):
        return axis_moments(inside * numpy.exp(-0.5 * ((cells - centre[:, None]) / sigma)**2))

    centre = mean.copy()
    for _ in range(4):
        of_cut, spread = cut(centre)
        centre += (mean - of_cut) / numpy.maximum(spread / sigma**2, LEAST_SLOPE)
    return centre, variance - cut(centre)[1]


def decode(logits, sigma=1.0):
    """Peaks of maps, n x 11 x 32 x 32. `sigma`: of the Gaussians that training asked for, cells."""
    shape, side = logits.shape[:2], crops.MAP_SIDE
    p = torch.softmax(logits.double().flatten(2), 2).reshape(-1, side, side).numpy()
    highest = p.reshape(len(p), -1).argmax(1)
    row, column = highest // side, highest % side
    axis = numpy.arange(side)

    share = (p * near(row, 1)[:, :, None] * near(column, 1)[:, None, :]).sum((1, 2))
    around = near(row, REACH)[:, :, None] & near(column, REACH)[:, None, :]
    top = p.reshape(len(p), -1).max(1)
    second = numpy.where(around, 0.0, p).reshape(len(p), -1).max(1) / top
    at_border = (row == 0) | (column == 0) | (row == side - 1) | (column == side - 1)

    # Once more around the mean: a window that cuts one side of the peak draws the mean away from it.
    first = p * around
    total = first.sum((1, 2))
    rows = near(numpy.floor((first.sum(2) * axis).sum(1) / total + 0.5), REACH)
    columns = near(numpy.floor((first.sum(1) * axis).sum(1) / total + 0.5), REACH)
    window = p * rows[:, :, None] * columns[:, None, :]
    x, xx = axis_moments(window.sum(1))
    y, yy = axis_moments(window.sum(2))
    xy = (window * (axis[None, None, :] - x[:, None, None]) * (axis[None, :, None] - y[:, None, None])).sum((1, 2))
    xy /= window.sum((1, 2))
    x, xx = allowed_for_cut(x, xx, columns, sigma)
    y, yy = allowed_for_cut(y, yy, rows, sigma)
    excess = numpy.stack([numpy.stack([xx, xy], -1), numpy.stack([xy, yy], -1)], -1)
    is_clear = ~at_border & (second <= MOST_SECOND)
    return Peaks(numpy.stack([x, y], -1).reshape(*shape, 2), excess.reshape(*shape, 2, 2), share.reshape(shape),
                 is_clear.reshape(shape))


def stretched(places, stretch):
    """Scaled away from the centre of the crop."""
    middle = 0.5 * (crops.MAP_SIDE - 1)
    return middle + (1.0 + stretch) * (places - middle)


def covariances(excess, scale, floor):
    """scale * excess+ + floor I: what is below zero along an axis is none."""
    values, axes = numpy.linalg.eigh(excess)
    values = scale * numpy.maximum(values, 0.0) + floor
    return numpy.einsum("...ij,...j,...kj->...ik", axes, values, axes)
