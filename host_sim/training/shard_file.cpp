#include "host_sim/training/shard_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>

#include "host_sim/files/output_file.h"

namespace vbar::training {
namespace {

constexpr std::string_view kMagic = "vbar crops 1";

void append_integer(std::uint64_t value, int bytes, std::string& out) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xFFU));
}

void append_float(double value, std::string& out) {
  append_integer(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4, out);
}

}  // namespace

void append_crop(const LabelledCrop& crop, const twins::camera::CameraSettings& camera, std::string& bytes) {
  for (const float sample : crop.samples)
    bytes.push_back(static_cast<char>(std::min(255L, std::lround(4.0F * sample))));
  const Circumstances& c = crop.circumstances;
  const auto add = [&](double value) { append_float(value, bytes); };
  for (const fsw::Vector2& cell : crop.cells)
    for (const double place : cell) add(place);
  for (const bool counts : crop.counts) add(counts ? 1.0 : 0.0);
  const Eigen::Quaterniond q_camera_body(c.R_camera_body);
  for (const double q : q_camera_body.coeffs()) add(q);
  for (const double x : c.centre_of_mass_camera) add(x);
  for (const double x : c.region.centre_px) add(x);
  add(c.region.side_px);
  add(camera.focal_length_px());
  for (const double x : camera.optics.principal_point_px) add(x);
  for (const double x : camera.optics.distortion) add(x);
  add(c.phase_angle);
  add(c.sunlit);
  add(c.exposure);
  add(c.point_spread_sigma_px);
  add(std::acos(std::clamp(c.nadir_camera.z(), -1.0, 1.0)));
}

void write_shard(const std::filesystem::path& file, std::uint64_t seed, std::int64_t first, std::uint32_t count,
                 const std::string& crops) {
  std::string header(kMagic);
  header.resize(16, '\0');
  append_integer(count, 4, header);
  append_integer(fsw::pose::kCropSide, 4, header);
  append_integer(fsw::pose::kKeypoints, 4, header);
  append_integer(kNumbers, 4, header);
  append_integer(seed, 8, header);
  append_integer(static_cast<std::uint64_t>(first), 8, header);
  files::PartialFile out(file);
  out.append(header);
  out.append(crops);
  out.finish();
}

}  // namespace vbar::training
