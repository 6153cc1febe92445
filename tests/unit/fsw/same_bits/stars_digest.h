#pragma once
// A digest of attitudes from stars: images drawn from the catalogue itself, with noise and objects that are no stars,
// lost in space and tracked. The catalogue's own bytes are in it by what is found.

#include <array>

#include <Eigen/Geometry>

#include "fsw/orbit/sun.h"
#include "fsw/vision/stars/catalogue.h"
#include "fsw/vision/stars/star_identification.h"
#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::same_bits {

inline fsw::Matrix3 random_camera(Arguments& arguments) {
  // Braces: drawn from left to right, which parentheses leave to the compiler.
  const auto draw = [&arguments] {
    return fsw::Vector3{arguments.between(-1.0, 1.0), arguments.between(-1.0, 1.0), arguments.between(-1.0, 1.0)};
  };
  const fsw::Vector3 z = draw().normalized();
  const fsw::Vector3 x = z.cross(draw()).normalized();
  fsw::Matrix3 R_camera_eci;
  R_camera_eci << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_camera_eci;
}

inline void add_fix(Digest& digest, fsw::Status status, const fsw::stars::AttitudeFix& fix) {
  digest.add(static_cast<double>(status));
  if (status != fsw::Status::kOk) return;
  for (int k = 0; k < 9; ++k) digest.add(fix.R_camera_eci(k / 3, k % 3));
  digest.add(fix.sigma_rad);
  digest.add(fix.chi_square);
  digest.add(fix.log_chance);
  digest.add(fix.matches);
}

inline std::uint64_t stars_digest() {
  static fsw::stars::StarIdentifier identifier;
  static std::array<int, 512> in_cone;
  static std::array<fsw::stars::ObservedStar, 128> objects;
  constexpr double kSigma = 1.7e-5;
  const fsw::stars::Field field{fsw::Vector3::UnitZ(), 0.07};
  Arguments arguments(8);
  Digest digest;
  for (int image = 0; image < 60; ++image) {
    const fsw::Matrix3 R_camera_eci = random_camera(arguments);
    const fsw::GpsTime time{fsw::duration_of_seconds(1'000'000'000 + image * 100'000LL).ns};
    const fsw::Vector3 velocity = fsw::orbit::earth_velocity_over_c_gcrf(time);
    for (int axis = 0; axis < 3; ++axis) digest.add(fsw::orbit::sun_position_gcrf(time)(axis));
    const int near = fsw::stars::stars_in_cone(R_camera_eci.row(2), field.radius_rad, in_cone).value();
    std::size_t count = 0;
    const auto place = [&](const fsw::Vector3& direction, double magnitude) {
      const fsw::Vector3 noise{arguments.between(-kSigma, kSigma), arguments.between(-kSigma, kSigma), 0.0};
      if (count < objects.size()) objects[count++] = {(direction + noise).normalized(), kSigma, magnitude};
    };
    for (int k = 0; k < near; ++k) {
      const int star = in_cone[static_cast<std::size_t>(k)];
      place(R_camera_eci * (fsw::stars::star_direction_eci(star) + velocity), fsw::stars::star_magnitude(star));
    }
    for (int k = 0; k < 8; ++k) {
      const fsw::Vector3 direction{arguments.between(-0.05, 0.05), arguments.between(-0.05, 0.05), 1.0};
      place(direction, arguments.between(2.0, 8.0));
    }
    const std::span<const fsw::stars::ObservedStar> seen(objects.data(), count);
    add_fix(digest, identifier.lost_in_space(seen, field, velocity), identifier.fix());
    fsw::Matrix3 turned = R_camera_eci;
    turned.row(0) += 1e-3 * R_camera_eci.row(1);
    turned.row(1) -= 1e-3 * R_camera_eci.row(0);
    add_fix(digest, identifier.track(seen, field, turned, 1.5e-3, velocity), identifier.fix());
  }
  return digest.value();
}

}  // namespace vbar::same_bits
