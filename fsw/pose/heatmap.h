#pragma once
// A keypoint out of the network's map: where it lies to a fraction of a cell, how well that is known, and whether it is
// one place at all.
//
// The map's softmax is the distribution of the keypoint's place, widened by the Gaussian that training asks for. Its
// mean and second moments are taken in a window around the highest cell, for a pedestal of a hundredth over the whole
// map would outweigh the peak. What window and map's edge cut off that Gaussian is allowed for: beside the edge it
// would draw the mean in by a seventh of a cell.

#include <span>

#include "fsw/core/types.h"
#include "fsw/network/keypoint_network.h"
#include "fsw/pose/crop.h"
#include "fsw/pose/keypoint.h"

namespace vbar::fsw::pose {

/// What a map says, in cells; an integer is the centre of a cell.
struct MapPeak {
  Vector2 place = Vector2::Zero();   ///< where a Gaussian has the mean found in the window
  Matrix2 excess = Matrix2::Zero();  ///< second moments, less those of such a Gaussian in the window, cells^2
  double peak = 0.0;                 ///< share of the map in the highest cell and its neighbours, 0 to 1
  double second = 0.0;               ///< highest cell outside the window over the highest of all
  bool is_at_border = false;         ///< the highest cell is in the map's first or last row or column
};

/// `target_sigma_cells`: of training's Gaussian, above 0. All zero, at the border, of logits of which one is not
/// finite.
MapPeak read_map(std::span<const float, network::kMapCells> logits, double target_sigma_cells);

/// Covariance of the place, cells^2: `covariance_scale` times the excess, none along an axis where it is negative, plus
/// `covariance_floor` for each axis.
Matrix2 place_covariance(const MapPeak& peak, const network::Calibration& calibration);

/// The keypoint on the detector. Unusable if the peak is at the border, lower than `least_peak`, or not the only one:
/// another exceeds 0.6 of it outside the window.
Keypoint keypoint_of(const MapPeak& peak, const network::Calibration& calibration, const CropRegion& region);

}  // namespace vbar::fsw::pose
