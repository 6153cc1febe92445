#include "host_sim/twins/camera/image_recipe.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <vbar_host/image_recipe.hpp>

namespace vbar::twins::camera {
namespace {

void write(const fsw::Vector3& vector, double (&field)[3]) {
  std::copy(vector.begin(), vector.end(), field);
}

void write(const Eigen::Quaterniond& q, double (&field)[4]) {
  field[0] = q.w();
  field[1] = q.x();
  field[2] = q.y();
  field[3] = q.z();
}

void write(const std::string& text, std::uint8_t (&field)[kMaxNameBytes + 1]) {
  if (text.size() > kMaxNameBytes)
    throw std::invalid_argument("\"" + text + "\": a camera's objects and models have names of at most " +
                                std::to_string(kMaxNameBytes) + " bytes");
  std::fill(std::copy(text.begin(), text.end(), field), std::end(field), std::uint8_t{0});
}

fsw::Vector3 vector_of(const double (&field)[3]) {
  return {field[0], field[1], field[2]};
}

Eigen::Quaterniond quaternion_of(const double (&field)[4]) {
  return {field[0], field[1], field[2], field[3]};
}

std::string text_of(const std::uint8_t (&field)[kMaxNameBytes + 1]) {
  return {field, std::find(field, std::end(field), std::uint8_t{0})};
}

void write(const ObjectInView& object, vbar_host::object_in_view& message) {
  write(object.name, message.name);
  write(object.model, message.model);
  write(object.position_eci, message.position_eci);
  write(object.velocity_eci, message.velocity_eci);
  write(object.q_body_eci, message.q_body_eci);
  message.sunlit = object.sunlit;
}

ObjectInView object_of(const vbar_host::object_in_view& message) {
  return {text_of(message.name),
          text_of(message.model),
          vector_of(message.position_eci),
          vector_of(message.velocity_eci),
          quaternion_of(message.q_body_eci),
          message.sunlit};
}

}  // namespace

std::vector<std::uint8_t> bytes_of(const ImageRecipe& recipe) {
  const Exposure& exposure = recipe.exposure;
  if (exposure.objects.size() > kMaxObjectsInView)
    throw std::invalid_argument("a camera has at most " + std::to_string(kMaxObjectsInView) + " objects in view, not " +
                                std::to_string(exposure.objects.size()));
  vbar_host::image_recipe message{};
  message.spacecraft = recipe.spacecraft;
  message.unit = recipe.unit;
  message.gps_time_ns = exposure.time.ns;
  message.number = exposure.number;
  message.duration_s = exposure.duration_s.value_or(0.0);
  write(exposure.q_camera_eci, message.q_camera_eci);
  write(exposure.rate_camera, message.rate_camera);
  write(exposure.camera_position_eci, message.camera_position_eci);
  write(exposure.camera_velocity_eci, message.camera_velocity_eci);
  write(exposure.earth_velocity_bcrs, message.earth_velocity_bcrs);
  write(exposure.sun_eci, message.sun_eci);
  write(exposure.moon_eci, message.moon_eci);
  message.years_since_j2000 = exposure.years_since_j2000;
  message.count = static_cast<std::int32_t>(exposure.objects.size());
  for (std::size_t k = 0; k < exposure.objects.size(); ++k) write(exposure.objects[k], message.objects[k]);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

std::optional<ImageRecipe> recipe_of(std::span<const std::uint8_t> bytes) {
  vbar_host::image_recipe message{};
  const auto size = static_cast<std::size_t>(message.getEncodedSize());
  if (bytes.size() != size || message.decode(bytes.data(), 0, static_cast<int>(size)) < 0) return std::nullopt;
  const bool is_good = message.count >= 0 && message.count <= static_cast<std::int32_t>(kMaxObjectsInView) &&
                       fits_header(message.spacecraft) && fits_header(message.unit);
  if (!is_good) return std::nullopt;
  ImageRecipe recipe;
  recipe.spacecraft = static_cast<std::uint8_t>(message.spacecraft);
  recipe.unit = static_cast<std::uint8_t>(message.unit);
  Exposure& exposure = recipe.exposure;
  exposure.time = {message.gps_time_ns};
  exposure.number = message.number;
  if (message.duration_s > 0.0) exposure.duration_s = message.duration_s;
  exposure.q_camera_eci = quaternion_of(message.q_camera_eci);
  exposure.rate_camera = vector_of(message.rate_camera);
  exposure.camera_position_eci = vector_of(message.camera_position_eci);
  exposure.camera_velocity_eci = vector_of(message.camera_velocity_eci);
  exposure.earth_velocity_bcrs = vector_of(message.earth_velocity_bcrs);
  exposure.sun_eci = vector_of(message.sun_eci);
  exposure.moon_eci = vector_of(message.moon_eci);
  exposure.years_since_j2000 = message.years_since_j2000;
  for (std::int32_t k = 0; k < message.count; ++k) exposure.objects.push_back(object_of(message.objects[k]));
  return recipe;
}

}  // namespace vbar::twins::camera
