#include "fsw/vision/pose/keypoint_network.h"

#include <cstdint>
#include <cstring>

#include "fsw/packets/crc.h"
#include "fsw/vision/pose/architecture.h"

namespace vbar::fsw::pose {

namespace {

template <class T>
T read(std::span<const std::byte> file, std::size_t offset) {
  T value;
  std::memcpy(&value, file.data() + offset, sizeof value);
  return value;
}

bool is_word(std::span<const std::byte> file, std::size_t& offset, int expected) {
  const auto word = read<std::uint32_t>(file, offset);
  offset += sizeof word;
  return word == static_cast<std::uint32_t>(expected);
}

bool is_of_this_architecture(std::span<const std::byte> file) {
  std::size_t offset = kMagicBytes;
  bool same = std::memcmp(file.data(), kMagic, kMagicBytes) == 0;
  for (const int expected : {kLayerCount, kInputSide, kMapSide, kKeypoints}) {
    same = is_word(file, offset, expected) && same;
  }
  for (const Layer& layer : kLayers) {
    for (const int expected : {layer.in, layer.out, layer.kernel, layer.stride, layer.is_rectified ? 1 : 0, 0, 0, 0}) {
      same = is_word(file, offset, expected) && same;
    }
  }
  return same;
}

bool checksum_holds(std::span<const std::byte> file) {
  const std::size_t covered = kFileBytes - kChecksumBytes;
  // The bytes are passed to the checksum as its byte type.
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(file.data()), covered);
  return packets::crc32_ieee(bytes) == read<std::uint32_t>(file, covered);
}

bool is_finite(float x) {
  return x - x == 0.0F;
}

Status check_weights(std::span<const std::byte> file) {
  Status status = Status::kOk;
  for (std::size_t offset = kHeaderBytes; offset + kChecksumBytes < kFileBytes; offset += sizeof(float)) {
    const auto weight = read<float>(file, offset);
    if (!is_finite(weight)) return Status::kNotFinite;
    const float size = weight < 0.0F ? -weight : weight;
    // Denormal numbers are compared here, which the vector unit cannot: the compiler generates scalar code.
    if (weight != 0.0F && !(size >= kMinWeight && size < kGreatestWeight)) status = Status::kOutOfRange;
  }
  return status;
}

Status check_calibration(const Calibration& calibration) {
  for (const float x : {calibration.covariance_scale, calibration.covariance_floor, calibration.target_sigma_cells,
                        calibration.least_peak, calibration.stretch}) {
    if (!is_finite(x)) return Status::kNotFinite;
  }
  const bool good = calibration.covariance_scale > 0.0F && calibration.covariance_floor >= 0.0F &&
                    calibration.target_sigma_cells > 0.0F && calibration.least_peak >= 0.0F &&
                    calibration.least_peak <= 1.0F && calibration.stretch > -0.2F && calibration.stretch < 0.2F;
  return good ? Status::kOk : Status::kOutOfRange;
}

}  // namespace

Status check_weights_file(std::span<const std::byte> file) {
  if (file.size() < kHeaderBytes) return Status::kTooShort;
  if (!is_of_this_architecture(file)) return Status::kWrongType;
  if (file.size() < kFileBytes) return Status::kTooShort;
  if (file.size() > kFileBytes) return Status::kTooLong;
  if (!checksum_holds(file)) return Status::kBadChecksum;
  const Status calibration = check_calibration(calibration_of(file));
  return calibration != Status::kOk ? calibration : check_weights(file);
}

Calibration calibration_of(std::span<const std::byte> file) {
  Calibration calibration;
  calibration.covariance_scale = read<float>(file, kCalibrationOffset);
  calibration.covariance_floor = read<float>(file, kCalibrationOffset + 4);
  calibration.target_sigma_cells = read<float>(file, kCalibrationOffset + 8);
  calibration.least_peak = read<float>(file, kCalibrationOffset + 12);
  calibration.stretch = read<float>(file, kCalibrationOffset + 16);
  return calibration;
}

}  // namespace vbar::fsw::pose

// Positions set by the linker (on_board_weights.S).
extern "C" {
extern const std::byte vbar_keypoint_weights[];
extern const std::uint32_t vbar_keypoint_weights_bytes;
}

namespace vbar::fsw::pose {

std::span<const std::byte> weights_on_board() {
  return {vbar_keypoint_weights, vbar_keypoint_weights_bytes};
}

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
