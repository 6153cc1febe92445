#include "fsw/vision/pose/network_weights.h"

#include <cstdint>
#include <cstring>

#include "fsw/packets/crc.h"
#include "fsw/vision/pose/architecture.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "fsw/vision/pose/number_range.h"

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

}  // namespace vbar::fsw::pose
