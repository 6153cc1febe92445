#pragma once
// The keypoint network (after SPN, Park and D'Amico 2023): input a crop of the image, output a heatmap per keypoint.
//
// A convolutional encoder down to a sixteenth of the crop and a decoder up to a quarter, with ReLU. Single precision;
// every sum in a fixed order and without denormal numbers (number_range.h), so that the heatmaps are bit-identical on
// every target.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/core/result.h"
#include "fsw/vision/pose/activations.h"
#include "fsw/vision/pose/network_weights.h"
#include "fsw/vision/pose/registers.h"
#include "fsw/vision/pose/sizes.h"

namespace vbar::fsw::pose {

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
