#pragma once
// A camera in low orbit for tests and benchmarks of the camera twin, and what they measure in its images.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>
#include <png.h>

#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/photon_image.h"
#include "tests/support/paths.h"

namespace vbar::test {

inline constexpr double kSunDistance = 1.5e11;   // m
inline constexpr double kMoonDistance = 3.85e8;  // m

inline std::filesystem::path camera_data() {
  return std::filesystem::path(vbar::tests::source_path("data"));
}

/// The camera's axes: z along `boresight`, y as near to `down` as can be.
inline Eigen::Quaterniond camera_attitude(const fsw::Vector3& boresight, const fsw::Vector3& down) {
  const fsw::Vector3 z = boresight.normalized();
  const fsw::Vector3 x = down.cross(z).normalized();
  fsw::Matrix3 R_camera_eci;
  R_camera_eci << x.transpose(), z.cross(x).transpose(), z.transpose();
  return Eigen::Quaterniond(R_camera_eci);
}

/// 709 km above the Earth, looking along `boresight_eci` with the Earth below it (or behind it, if it looks up); the
/// Sun and the Moon are behind the camera.
inline twins::camera::Exposure quiet_exposure(const fsw::Vector3& boresight_eci) {
  using fsw::Vector3;
  const Vector3 boresight = boresight_eci.normalized();
  Vector3 up = Vector3::UnitZ() - boresight * boresight.z();
  if (up.norm() < 0.1) up = Vector3::UnitX() - boresight * boresight.x();
  up.normalize();
  twins::camera::Exposure exposure;
  exposure.q_camera_eci = camera_attitude(boresight, -up);
  exposure.camera_position_eci = 7.087e6 * up;
  exposure.camera_velocity_eci = -7500.0 * boresight;
  exposure.earth_velocity_bcrs = Vector3(-12000.0, -25000.0, -11000.0);
  exposure.sun_eci = kSunDistance * (-boresight + 0.3 * up).normalized();
  exposure.moon_eci = kMoonDistance * (-boresight - 0.2 * up).normalized();
  exposure.years_since_j2000 = 11.55;
  return exposure;
}

/// An object at `position_camera` from the camera that flies with it.
inline twins::camera::ObjectInView object_at(const twins::camera::Exposure& exposure,
                                             const fsw::Vector3& position_camera) {
  twins::camera::ObjectInView object;
  object.name = "target";
  object.model = "sphere";
  object.position_eci = exposure.q_camera_eci.conjugate() * position_camera;
  // It keeps its place in the camera's axes while these turn.
  object.velocity_eci = exposure.q_camera_eci.conjugate() * exposure.rate_camera.cross(position_camera);
  return object;
}

struct Blob {
  double electrons = 0.0;
  fsw::Vector2 centroid = fsw::Vector2::Zero();  // px
  fsw::Matrix2 spread = fsw::Matrix2::Zero();    // second central moments, px^2
};

/// Moments of the light within `half_width` px of `middle`.
inline Blob measure(const twins::camera::PhotonImage& image, const fsw::Vector2& middle, double half_width) {
  using fsw::Vector2;
  Blob blob;
  const auto each = [&](auto&& take) {
    for (int y = image.region.y; y < image.region.y + image.region.height; ++y)
      for (int x = image.region.x; x < image.region.x + image.region.width; ++x)
        if (std::abs(x - middle.x()) <= half_width && std::abs(y - middle.y()) <= half_width)
          take(Vector2(x, y), static_cast<double>(image.electrons[static_cast<std::size_t>(y - image.region.y) *
                                                                      static_cast<std::size_t>(image.region.width) +
                                                                  static_cast<std::size_t>(x - image.region.x)]));
  };
  each([&](const Vector2& at, double light) {
    blob.electrons += light;
    blob.centroid += light * at;
  });
  blob.centroid /= blob.electrons;
  each([&](const Vector2& at, double light) {
    const Vector2 off = at - blob.centroid;
    blob.spread += light * off * off.transpose();
  });
  blob.spread /= blob.electrons;
  return blob;
}

/// The electrons of what the image holds in `a` beyond `b`.
inline twins::camera::PhotonImage difference(const twins::camera::PhotonImage& a, const twins::camera::PhotonImage& b) {
  twins::camera::PhotonImage image = a;
  for (std::size_t i = 0; i < image.electrons.size(); ++i) image.electrons[i] -= b.electrons[i];
  return image;
}

// A camera's image as a picture for people: grey, square root of the light.

/// White at `white_electrons` and above. False if it cannot be written.
inline bool write_picture(const twins::camera::PhotonImage& image, double white_electrons,
                          const std::filesystem::path& file) {
  std::vector<std::uint8_t> grey;
  for (const float light : image.electrons)
    grey.push_back(static_cast<std::uint8_t>(std::min(255.0, 255.0 * std::sqrt(light / white_electrons))));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.region.width);
  png.height = static_cast<png_uint_32>(image.region.height);
  png.format = PNG_FORMAT_GRAY;
  return png_image_write_to_file(&png, file.c_str(), 0, grey.data(), 0, nullptr) != 0;
}

}  // namespace vbar::test
