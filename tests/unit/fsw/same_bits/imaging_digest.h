#pragma once
// A digest of what is found in images of whole numbers: stars, a saturated disc, a gradient, a gap.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/object_detector.h"
#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::same_bits {

inline std::vector<std::uint16_t> arbitrary_image(Arguments& arguments, int width, int height) {
  std::vector<std::uint16_t> pixels;
  for (int k = 0; k < width * height; ++k) {
    const double noise = arguments.between(0.0, 3.0) + arguments.between(0.0, 3.0);
    pixels.push_back(static_cast<std::uint16_t>(60.0 + 0.05 * (k % width) + noise));
  }
  const auto brighten = [&](int x, int y, int by) {
    std::uint16_t& pixel = pixels[static_cast<std::size_t>(y * width + x)];
    pixel = static_cast<std::uint16_t>(pixel + by < 4095 ? pixel + by : 4095);
  };
  for (int star = 0; star < 60; ++star) {
    const int x = static_cast<int>(arguments.between(3.0, width - 4.0));
    const int y = static_cast<int>(arguments.between(3.0, height - 4.0));
    const int light = static_cast<int>(arguments.between(30.0, 3000.0));
    constexpr std::array<int, 3> kShare{1, 2, 1};
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        brighten(x + i - 1, y + j - 1,
                 light * kShare[static_cast<std::size_t>(i)] * kShare[static_cast<std::size_t>(j)] / 4);
      }
    }
  }
  for (int j = -9; j <= 9; ++j) {
    for (int i = -9; i <= 9; ++i) {
      if (i * i + j * j < 90) brighten(width / 3 + i, height / 2 + j, 9000);
    }
  }
  for (int k = 0; k < 868; ++k) pixels[static_cast<std::size_t>(width * height / 4 + k)] = fsw::imaging::kMissingPixel;
  return pixels;
}

inline std::uint64_t imaging_digest() {
  Arguments arguments(7);
  Digest digest;
  const auto detector = std::make_unique<fsw::imaging::ObjectDetector>();
  const fsw::imaging::CameraModel camera{.focal_length_px = {5972.7, 5970.1},
                                         .principal_point_px = {150.3, 120.1},
                                         .distortion = {-0.1, 0.3, 0.001, -0.002, 0.1}};
  for (int image = 0; image < 5; ++image) {
    const std::vector<std::uint16_t> pixels = arbitrary_image(arguments, 300, 250);
    const fsw::imaging::DetectionReport report =
        detector->detect({{.width = 300, .height = 250}, pixels}, {.detection_sigmas = 4.0});
    digest.add(report.background_dn);
    digest.add(report.noise_dn);
    digest.add(static_cast<double>(report.components));
    for (const fsw::imaging::DetectedObject& object : detector->objects()) {
      for (const double x : {object.centroid_px.x(), object.centroid_px.y(), object.sigma_px, object.flux_dn,
                             object.radius_px, static_cast<double>(object.pixels)}) {
        digest.add(x);
      }
      const fsw::Vector3 direction = fsw::imaging::direction_of(camera, object.centroid_px).value();
      for (int axis = 0; axis < 3; ++axis) digest.add(direction(axis));
    }
  }
  return digest.value();
}

}  // namespace vbar::same_bits
