#pragma once
// The keypoint network (after SPN, Park and D'Amico 2023): input a crop of the image, output a heatmap per keypoint.
//
// A convolutional encoder down to a sixteenth of the crop and a decoder up to a quarter, with ReLU. Single precision;
// every sum in a fixed order and without denormal numbers (architecture.h), so that the heatmaps are bit-identical on
// every target.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/core/result.h"
#include "fsw/vision/pose/architecture.h"
#include "fsw/vision/pose/convolution.h"
#include "fsw/vision/pose/feature_map.h"

namespace vbar::fsw::pose {

// A weights file in memory (architecture.h has its layout).

/// Calibration on images that were not used in training.
struct Calibration {
  float covariance_scale = 1.0F;    ///< factor of a heatmap's second moments, less the training target's variance
  float covariance_floor = 0.0F;    ///< added to each axis, cells^2
  float target_sigma_cells = 1.0F;  ///< sigma of the Gaussian that is the training target
  float least_peak = 0.0F;          ///< minimum share of the probability in the highest 3 x 3 cells
  /// Factor, as a share, by which positions are moved away from the crop's centre: since the scale of the target is not
  /// observable, the network is biased towards the mean scale of its training data.
  float stretch = 0.0F;
};

/// Returns kOk for a valid weights file of this architecture, complete, with all values in range: the result of load().
Status check_weights_file(std::span<const std::byte> file);

/// Returns the calibration of a file that was checked.
Calibration calibration_of(std::span<const std::byte> file);

// Memory of one run of the network: 1.1 MB, each store used by layers of one shape, so that borders stay 0.

struct Activations {
  FeatureStore<128, 1> input;
  FeatureStore<64, 24> stem;
  FeatureStore<32, 40> passing_32;  ///< output of the encoder, reused in the decoder
  FeatureStore<32, 40> kept_32;     ///< skip connection: of the encoder, until added in the decoder
  FeatureStore<16, 64> passing_16;
  FeatureStore<16, 64> kept_16;
  FeatureStore<8, 128> first_8;
  FeatureStore<8, 128> second_8;
  WeightPanel panel;
};

class KeypointNetwork {
 public:
  /// Uses `weights`, a file of data/networks, in place: it must stay valid. Checks the complete file first: kTooShort,
  /// kTooLong, kWrongType (not such a file, or of another architecture), kBadChecksum, kNotFinite, kOutOfRange (a
  /// weight that is not 0 and below 2^-40 or from 2^20 on in size, an invalid calibration). After a failure there is no
  /// network.
  Status load(std::span<const std::byte> weights);
  /// Moves to the same weights at another address. A state restored in another process still has the address of the
  /// process that saved it, and must be given its own before run().
  void relocate(std::span<const std::byte> same_weights) {
    if (is_loaded()) weights_ = same_weights;
  }
  [[nodiscard]] bool is_loaded() const { return !weights_.empty(); }
  [[nodiscard]] const Calibration& calibration() const { return calibration_; }

  /// Runs the network on a crop, rows from the top. kNotReady without weights; kNotFinite for a sample that is NaN or
  /// above 2^20 in size, or if the heatmaps are not finite: they are then not valid. The computer must have the
  /// registers; they do not change a bit of the result.
  Status run(std::span<const float, kInputSamples> crop, Registers registers = widest_registers());

  /// Logits of keypoint k in the last run, cells in rows. Their softmax over the heatmap is the probability
  /// distribution of the keypoint position.
  [[nodiscard]] std::span<const float, kMapCells> logits(int keypoint) const {
    return maps_[static_cast<std::size_t>(keypoint)];
  }

 private:
  Status take_in(std::span<const float, kInputSamples> crop);
  void run_layers(Registers registers);

  std::span<const std::byte> weights_;
  Calibration calibration_;
  Activations activations_;
  std::array<std::array<float, kMapCells>, kKeypoints> maps_{};
};

/// Returns the weights on board.
std::span<const std::byte> weights_on_board();

}  // namespace vbar::fsw::pose
