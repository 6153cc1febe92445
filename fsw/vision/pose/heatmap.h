#pragma once
// A keypoint from the network's heatmap: its position to a fraction of a cell, its covariance, and whether it is
// unimodal.
//
// The softmax of the heatmap is the distribution of the keypoint position, widened by the Gaussian of the training.
// Mean and second moments are taken in a window around the highest cell, since a pedestal of a hundredth over the whole
// heatmap would outweigh the peak. Truncation of the Gaussian by window and edge is corrected: beside the edge it would
// bias the mean by a seventh of a cell.

#include <span>

#include "fsw/core/types.h"
#include "fsw/vision/pose/crop.h"
#include "fsw/vision/pose/keypoint.h"
#include "fsw/vision/pose/keypoint_network.h"

namespace vbar::fsw::pose {

/// Statistics of a heatmap, in cells; an integer is the centre of a cell.
struct MapPeak {
  Vector2 place = Vector2::Zero();   ///< centre of a Gaussian with the mean found in the window
  Matrix2 excess = Matrix2::Zero();  ///< second moments, less those of such a Gaussian in the window, cells^2
  double peak = 0.0;                 ///< share of the probability in the highest cell and its neighbours, 0 to 1
  double second = 0.0;               ///< highest cell outside the window over the highest of all
  bool is_at_border = false;         ///< the highest cell is in the first or last row or column
};

/// Returns the statistics of a heatmap. `target_sigma_cells` is the sigma of the Gaussian of the training, above 0. The
/// result is all zero, at the border, if a logit is not finite.
MapPeak read_map(std::span<const float, pose::kMapCells> logits, double target_sigma_cells);

/// Returns the covariance of the position, cells^2: `covariance_scale` times the positive semidefinite part of the
/// excess, plus `covariance_floor` for each axis.
Matrix2 place_covariance(const MapPeak& peak, const pose::Calibration& calibration);

/// Returns the keypoint on the detector. It is unusable if the peak is at the border, lower than `least_peak`, or
/// ambiguous: outside the window another cell exceeds 0.6 of the peak.
Keypoint keypoint_of(const MapPeak& peak, const pose::Calibration& calibration, const CropRegion& region);

}  // namespace vbar::fsw::pose
