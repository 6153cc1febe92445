#pragma once
// The keypoint network (after SPN, Park and D'Amico 2023): a crop of the image in, a map of each keypoint out.
//
// A convolutional encoder down to a sixteenth of the crop and back up to a quarter, rectifiers only. Single precision;
// every sum in a fixed order, so that the maps are the same bits on every target.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"

namespace vbar::fsw::network {

inline constexpr int kInputSide = 128;
inline constexpr int kMapSide = 32;
inline constexpr int kKeypoints = 11;
inline constexpr std::size_t kInputSamples = static_cast<std::size_t>(kInputSide) * kInputSide;
inline constexpr std::size_t kMapCells = static_cast<std::size_t>(kMapSide) * kMapSide;

/// What was found on images that training never saw, and what use of the maps goes by.
struct Calibration {
  float covariance_scale = 1.0F;    ///< of a map's second moments, less the training target's own
  float covariance_floor = 0.0F;    ///< added to each axis, cells^2
  float target_sigma_cells = 1.0F;  ///< of the Gaussian maps that training asked for
  float least_peak = 0.0F;          ///< a map whose highest cell holds less tells nothing
};

class KeypointNetwork {
 public:
  /// Uses `weights`, a file of data/networks, where it stands: it must stay there, aligned to 16 bytes. Checks all of
  /// it first: kTooShort, kTooLong, kWrongType (not such a file, or of another architecture), kBadChecksum, kNotFinite.
  /// After a failure there is no network.
  Status load(std::span<const std::byte> weights);
  [[nodiscard]] bool is_loaded() const;
  [[nodiscard]] const Calibration& calibration() const;

  /// Rows from the top. kNotReady without weights.
  Status run(std::span<const float, kInputSamples> crop);

  /// Of the last run: the logits of keypoint k, cells in rows. Their softmax over the map is the distribution of where
  /// the keypoint lies.
  [[nodiscard]] std::span<const float, kMapCells> logits(int keypoint) const;
};

/// The weights on board.
std::span<const std::byte> weights_on_board();

}  // namespace vbar::fsw::network
