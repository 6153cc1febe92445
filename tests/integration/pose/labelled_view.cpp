#include "tests/integration/pose/labelled_view.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace vbar::test {
namespace {

constexpr std::size_t kHeader = 48;
constexpr std::size_t kNumbers = 56;
constexpr std::size_t kRecord = fsw::pose::kCropSamples + 4 * kNumbers;

std::uint32_t integer_at(const std::string& bytes, std::size_t place) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[place + k]);
  return value;
}

LabelledView view_at(const std::string& bytes, std::size_t place) {
  LabelledView view;
  for (std::size_t k = 0; k < view.samples.size(); ++k) {
    view.samples[k] = 0.25F * static_cast<float>(static_cast<std::uint8_t>(bytes[place + k]));
  }
  standardise(view.samples);
  std::array<double, kNumbers> n{};
  for (std::size_t k = 0; k < kNumbers; ++k) {
    const std::uint32_t integer = integer_at(bytes, place + view.samples.size() + 4 * k);
    float value = 0.0F;
    std::memcpy(&value, &integer, sizeof value);
    n[k] = static_cast<double>(value);
  }
  for (std::size_t k = 0; k < view.cells.size(); ++k) {
    view.cells[k] = {n[2 * k], n[2 * k + 1]};
    view.counts[k] = n[22 + k] > 0.5;
  }
  view.truth.R_camera_body = Eigen::Quaterniond(n[36], n[33], n[34], n[35]).normalized().toRotationMatrix();
  view.truth.position_camera_m = {n[37], n[38], n[39]};
  view.region = {{n[40], n[41]}, n[42]};
  view.camera = {.focal_length_px = {n[43], n[43]},
                 .principal_point_px = {n[44], n[45]},
                 .distortion = {n[46], n[47], n[48], n[49], n[50]}};
  return view;
}

}  // namespace

void standardise(fsw::pose::CropSamples& samples) {
  double sum = 0.0;
  double squares = 0.0;
  for (const float sample : samples) {
    sum += static_cast<double>(sample);
    squares += static_cast<double>(sample) * static_cast<double>(sample);
  }
  const double count = static_cast<double>(samples.size());
  const double mean = sum / count;
  const double deviation = std::max(0.5, std::sqrt(std::max(0.0, squares / count - mean * mean)));
  for (float& sample : samples) sample = static_cast<float>((static_cast<double>(sample) - mean) / deviation);
}

std::vector<LabelledView> read_shard(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const bool is_shard = bytes.size() >= kHeader && bytes.compare(0, 12, "vbar crops 1") == 0 &&
                        integer_at(bytes, 20) == fsw::pose::kCropSide && integer_at(bytes, 28) == kNumbers &&
                        bytes.size() == kHeader + integer_at(bytes, 16) * kRecord;
  if (!is_shard) throw std::runtime_error(file.string() + ": not a whole shard of crops (vbar crops 1)");
  std::vector<LabelledView> views;
  for (std::size_t place = kHeader; place < bytes.size(); place += kRecord) views.push_back(view_at(bytes, place));
  return views;
}

}  // namespace vbar::test
