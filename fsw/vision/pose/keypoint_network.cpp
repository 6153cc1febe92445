#include "fsw/vision/pose/keypoint_network.h"

#include "fsw/vision/pose/number_range.h"

namespace vbar::fsw::pose {

static_assert(sizeof(KeypointNetwork) < 1'250'000);

Status KeypointNetwork::load(std::span<const std::byte> weights) {
  weights_ = {};
  calibration_ = {};
  const Status status = check_weights_file(weights);
  if (status != Status::kOk) return status;
  weights_ = weights;
  calibration_ = calibration_of(weights);
  return Status::kOk;
}

Status KeypointNetwork::run(std::span<const float, kInputSamples> crop, Registers registers) {
  if (!is_loaded()) return Status::kNotReady;
  const Status status = take_in(crop);
  if (status != Status::kOk) return status;
  run_layers(registers);
  bool all_finite = true;
  for (const auto& map : maps_) {
    for (const float logit : map) all_finite = all_finite && logit - logit == 0.0F;
  }
  return all_finite ? Status::kOk : Status::kNotFinite;
}

Status KeypointNetwork::take_in(std::span<const float, kInputSamples> crop) {
  const FeatureMap input = activations_.input.map();
  bool all_good = true;
  for (int row = 0; row < kInputSide; ++row) {
    for (int column = 0; column < kInputSide; ++column) {
      const float sample = crop[static_cast<std::size_t>(row * kInputSide + column)];
      const float size = sample < 0.0F ? -sample : sample;
      all_good = all_good && size <= kGreatestSample;  // a NaN is rejected as well
      *input.cell(row, column) = size > kMinActivation ? sample : 0.0F;
    }
  }
  return all_good ? Status::kOk : Status::kNotFinite;
}

void KeypointNetwork::run_layers(Registers registers) {
  const FeatureMap input = activations_.input.map();
  const FeatureMap stem = activations_.stem.map();
  const FeatureMap passing_32 = activations_.passing_32.map();
  const FeatureMap kept_32 = activations_.kept_32.map();
  const FeatureMap passing_16 = activations_.passing_16.map();
  const FeatureMap kept_16 = activations_.kept_16.map();
  const FeatureMap first_8 = activations_.first_8.map();
  const FeatureMap second_8 = activations_.second_8.map();

  const auto weights = [this](int l) {
    return weights_.subspan(offset_of_layer(l), kLayers[static_cast<std::size_t>(l)].bytes());
  };
  const auto layer = [&](int l, const FeatureMap& in, const FeatureMap& out) {
    convolve_rectified(kLayers[static_cast<std::size_t>(l)], weights(l), in, out, activations_.panel, registers);
  };
  layer(0, input, stem);
  layer(1, stem, passing_32);
  layer(2, passing_32, kept_32);
  layer(3, kept_32, passing_16);
  layer(4, passing_16, kept_16);
  layer(5, kept_16, first_8);
  layer(6, first_8, second_8);
  layer(7, second_8, first_8);
  convolve_and_add_enlarged(kLayers[8], weights(8), first_8, kept_16, activations_.panel, registers);
  layer(9, kept_16, passing_16);
  convolve_and_add_enlarged(kLayers[10], weights(10), passing_16, kept_32, activations_.panel, registers);
  layer(11, kept_32, passing_32);
  convolve_to_maps(kLayers[12], weights(12), passing_32, maps_, activations_.panel, registers);
}

}  // namespace vbar::fsw::pose
