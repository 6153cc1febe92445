"""Calibration of the network's heatmaps: fits it on crops that are not part of the training set, writes it into the
weights file, and the figures on held-out crops into a file beside it."""

import argparse
import math
import pathlib
import tomllib

import numpy
import torch

import augment
import crops
import decode
import keypoint_network
import train_keypoints

TARGET_SIGMA_CELLS = 1.0
GROSS_CELLS = 3.0  # farther off than this a keypoint is wrong, not inexact
MOST_GROSS = 0.01  # of the keypoints that are accepted
CHI_SQUARE_MEDIAN = 1.3863  # of two degrees of freedom; their mean is 2
CLASSES = 6  # of sharpness, all to have the right median
CROP_RADII = 2.3  # what a crop's side spans at the target in flight (fsw/vision/pose/crop.h)


def peaks_of(layers, table):
    with torch.no_grad():
        logits = torch.cat([keypoint_network.run_folded(layers, augment.standardised(augment.samples_of(images)))
                            for images in numpy.array_split(table["image"], max(1, len(table) // 100))])
    return decode.decode(logits, TARGET_SIGMA_CELLS)


def errors_of(peaks, table, stretch):
    """Errors (cells, n x 2) and peaks of the valid keypoints."""
    counts = table["counts"] > 0.5
    return (decode.stretched(peaks.places, stretch) - table["cells"])[counts], peaks[counts]


def radius_of(body):
    """Of the sphere about the centre of mass that holds all keypoints of a body file, m."""
    stated = tomllib.loads(body.read_text())
    return max(math.dist(keypoint["at_m"], stated["centre_of_mass_m"]) for keypoint in stated["keypoints"])


def fit_stretch(peaks, table, least, radius_m):
    """How much too near their middle the keypoints of a crop lie, for crops as they are cut in flight. A network that is
    not sure of the target's size leans towards the usual one: a straight line over the logarithm of the size, read at
    flight's."""
    errors = peaks.places - table["cells"]
    chosen = (table["counts"] > 0.5) & peaks.accepted(least) & (numpy.linalg.norm(errors, axis=2) <= GROSS_CELLS)
    distance = numpy.linalg.norm(table["centre_of_mass_camera"], axis=1)
    size = numpy.log(table["region"][:, 2] * distance / table["camera"][:, 0] / (CROP_RADII * radius_m))
    normal, right = numpy.zeros((2, 2)), numpy.zeros(2)
    for crop in numpy.flatnonzero(chosen.sum(1) >= 4):
        cells, error = table["cells"][crop, chosen[crop]], errors[crop, chosen[crop]]
        cells, error = cells - cells.mean(0), error - error.mean(0)
        row = numpy.array([1.0, size[crop]])
        normal += (cells * cells).sum() * numpy.outer(row, row)
        right -= (cells * error).sum() * row
    nearer = numpy.linalg.solve(normal, right)[0]
    return nearer / (1.0 - nearer)


def least_peak(errors, peaks):
    """The minimum peak above which at most a fraction MOST_GROSS is wrong."""
    is_gross = numpy.linalg.norm(errors, axis=1) > GROSS_CELLS
    for least in numpy.arange(0.10, 0.70, 0.01):
        accepted = peaks.accepted(least)
        if accepted.any() and is_gross[accepted].mean() <= MOST_GROSS:
            break
    return float(least)


def normalised(errors, excess, scale, floor):
    covariance = decode.covariances(excess, scale, floor)
    return numpy.einsum("ni,nij,nj->n", errors, numpy.linalg.inv(covariance), errors)


def fit_covariance(errors, excess):
    """Scale and floor (cells^2) that give classes of sharpness medians, and all of them a mean, like chi-square's. The
    mean is of what is below 20: the tail beyond is the tracker's to reject."""
    spread = numpy.trace(excess, axis1=1, axis2=2)
    classes = numpy.array_split(numpy.argsort(spread), CLASSES)
    best = None
    for floor in numpy.geomspace(0.001, 0.5, 40):
        for scale in numpy.geomspace(0.02, 5.0, 40):
            square = normalised(errors, excess, scale, floor)
            cost = sum(numpy.log(numpy.median(square[c]) / CHI_SQUARE_MEDIAN)**2 for c in classes) / CLASSES
            cost += 0.5 * numpy.log(square[square < 20.0].mean() / 2.0)**2
            if best is None or cost < best[0]:
                best = (cost, float(scale), float(floor))
    return best[1:]


def figures(errors, peaks, calibration):
    """Of held-out keypoints."""
    scale, floor, _, least, _ = calibration
    accepted = peaks.accepted(least)
    length = 4.0 * numpy.linalg.norm(errors, axis=1)
    square = normalised(errors[accepted], peaks.excess[accepted], scale, floor)
    return {
        "keypoints": len(errors),
        "median_error_samples": numpy.median(length),
        "error_90_samples": numpy.quantile(length, 0.9),
        "rejected_share": 1.0 - accepted.mean(),
        "accepted_median_error_samples": numpy.median(length[accepted]),
        "accepted_error_90_samples": numpy.quantile(length[accepted], 0.9),
        "accepted_gross_share": (length[accepted] > 4.0 * GROSS_CELLS).mean(),
        "normalised_square_median": numpy.median(square),
        "normalised_square_mean_below_20": square[square < 20.0].mean(),
        "normalised_square_share_above_20": (square >= 20.0).mean(),
    }


def tables_of(folder, kind):
    return numpy.concatenate([crops.read_shard(path) for path in crops.shards(folder, kind)])


def page(options, calibration, counts, held_out):
    lines = [f"# How data/networks/{options.body.stem}_keypoints.bin was made, and what it does. Written by host_sim/training/calibrate.py.",
             f'command = "{options.command}"', f"training_crops = {counts[0]}", f"calibration_crops = {counts[1]}",
             f"held_out_crops = {counts[2]}", f"seconds_of_training = {options.trained_s:.0f}",
             f"images_shown = {options.images}", "", "[calibration]",
             f"covariance_scale = {calibration[0]:.4f}", f"covariance_floor_cells2 = {calibration[1]:.5f}",
             f"target_sigma_cells = {calibration[2]:.1f}", f"least_peak = {calibration[3]:.2f}",
             f"stretch = {calibration[4]:.5f}", "",
             "# Errors in samples of the crop, 128 a side; a cell of a map is four.", "[held_out]"]
    lines += [f"{name} = {value:.4g}" if isinstance(value, float) else f"{name} = {value}" for name, value in held_out.items()]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--crops", type=pathlib.Path, required=True)
    parser.add_argument("--body", type=pathlib.Path, required=True, help="the target's body file")
    parser.add_argument("--weights", type=pathlib.Path, required=True, help="weights to read")
    parser.add_argument("--out", type=pathlib.Path, help="calibrated weights; its figures get the same name and .toml")
    parser.add_argument("--checkpoint", type=pathlib.Path, help="of the training, for its duration")
    parser.add_argument("--command", default="ci/train.sh")
    options = parser.parse_args()
    kept = torch.load(options.checkpoint) if options.checkpoint else {"step": 0, "elapsed_s": 0.0}
    options.trained_s, options.images = kept["elapsed_s"], train_keypoints.BATCH * kept["step"]
    layers, _ = keypoint_network.read_weights(options.weights.read_bytes())
    calibration_table, held_out_table = tables_of(options.crops, "calibration"), tables_of(options.crops, "held_out")
    all_peaks = peaks_of(layers, calibration_table)
    least = least_peak(*errors_of(all_peaks, calibration_table, 0.0))
    stretch = fit_stretch(all_peaks, calibration_table, least, radius_of(options.body))
    errors, peaks = errors_of(all_peaks, calibration_table, stretch)
    inexact = peaks.accepted(least) & (numpy.linalg.norm(errors, axis=1) <= GROSS_CELLS)
    calibration = (*fit_covariance(errors[inexact], peaks.excess[inexact]), TARGET_SIGMA_CELLS, least, stretch)
    # As stored in the file.
    calibration = tuple(float(numpy.float32(value)) for value in calibration)
    held_out_errors = errors_of(peaks_of(layers, held_out_table), held_out_table, calibration[4])
    held_out = {name: float(value) if not isinstance(value, int) else value
                for name, value in figures(*held_out_errors, calibration).items()}
    count = sum(len(crops.read_shard(path)) for path in crops.shards(options.crops, "training"))
    text = page(options, calibration, (count, len(calibration_table), len(held_out_table)), held_out)
    print(text)
    if options.out:
        options.out.write_bytes(keypoint_network.weights_file(layers, calibration))
        options.out.with_suffix(".toml").write_text(text)


if __name__ == "__main__":
    main()
