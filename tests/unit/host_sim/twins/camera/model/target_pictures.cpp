// Draws Tango as a camera near by would see it, for people to look at: target_pictures FOLDER.

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <png.h>

#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/paths.h"

namespace vbar::twins::camera {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

// The picture of a pinhole camera of `size` x `size` pixels of `pitch` rad, photons/(m^2 s) a pixel.
std::vector<double> pixels(const std::vector<LightSample>& samples, int size, double pitch) {
  std::vector<double> image(static_cast<std::size_t>(size * size));
  for (const LightSample& s : samples) {
    // Shared among the four pixels around it, or the picture shows how many texels fall into each pixel.
    const double x = s.direction_camera.x() / s.direction_camera.z() / pitch + 0.5 * (size - 1);
    const double y = s.direction_camera.y() / s.direction_camera.z() / pitch + 0.5 * (size - 1);
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    if (i < 0 || j < 0 || i + 1 >= size || j + 1 >= size) continue;
    for (int down = 0; down < 2; ++down)
      for (int right = 0; right < 2; ++right)
        image[static_cast<std::size_t>((j + down) * size + i + right)] +=
            s.photons_per_m2_s * (right == 0 ? 1.0 - (x - i) : x - i) * (down == 0 ? 1.0 - (y - j) : y - j);
  }
  return image;
}

// Pictures beside and above each other, three in a row, each pixel drawn `zoom` times as large.
class Sheet {
 public:
  Sheet(int count, int size, int zoom)
      : size_(size),
        zoom_(zoom),
        width_(3 * size * zoom),
        height_((count + 2) / 3 * size * zoom),
        grey_(static_cast<std::size_t>(width_ * height_)) {}

  void put(int number, const std::vector<double>& image, double white) {
    const int left = number % 3 * size_ * zoom_, top = number / 3 * size_ * zoom_;
    for (int j = 0; j < size_ * zoom_; ++j)
      for (int i = 0; i < size_ * zoom_; ++i) {
        const double value = image[static_cast<std::size_t>(j / zoom_ * size_ + i / zoom_)] / white;
        grey_[static_cast<std::size_t>((top + j) * width_ + left + i)] =
            static_cast<png_byte>(255.0 * std::pow(std::min(1.0, value), 1.0 / 2.2));
      }
  }

  void write(const std::filesystem::path& file) const {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(width_);
    header.height = static_cast<png_uint_32>(height_);
    header.format = PNG_FORMAT_GRAY;
    png_image_write_to_file(&header, file.c_str(), 0, grey_.data(), 0, nullptr);
  }

 private:
  int size_, zoom_, width_, height_;
  std::vector<png_byte> grey_;
};

// Views from around the body, the Sun over the camera's right shoulder; below, the Earth.
TargetView view_of(int number, double range_m) {
  const double azimuth = 0.5 + 1.0472 * number, height = number % 3 == 0 ? 0.6 : (number % 3 == 1 ? -0.5 : 0.15);
  const Matrix3 body_from_standing = (Eigen::AngleAxisd(azimuth, Vector3::UnitZ())).toRotationMatrix();
  Matrix3 R_camera_standing;  // x right, y down (-z of the body), z away from the viewer
  R_camera_standing << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  TargetView view;
  view.R_camera_body = Eigen::AngleAxisd(height, Vector3::UnitX()).toRotationMatrix() * R_camera_standing *
                       body_from_standing.transpose();
  view.position_camera = Vector3(0.0, 0.0, range_m) - view.R_camera_body * Vector3(0.0, 0.0, 0.16);
  view.sun_camera = Vector3(0.7, -0.5, -0.7).normalized();
  view.sun_photons_per_m2_s = 1.0;
  view.nadir_camera = Vector3::UnitY();
  view.earth_photons_per_m2_s = 0.15;
  return view;
}

}  // namespace
}  // namespace vbar::twins::camera

int main(int argc, char** argv) {
  using namespace vbar::twins::camera;
  if (argc != 2) {
    fmt::print(stderr, "usage: target_pictures FOLDER\n");
    return 2;
  }
  TargetRenderer renderer(load_cad_model(vbar::tests::source_path("data/models/tango.obj")));
  std::vector<LightSample> samples;
  constexpr double kPixel = 1.0 / 5972.7;
  for (const double range : {5.0, 20.0, 100.0}) {
    const double pitch = range > 50.0 ? kPixel : range < 10.0 ? 3.6 * kPixel : 0.9 * kPixel;
    const int size = range > 50.0 ? 100 : 512;
    Sheet sheet(6, size, 512 / size);
    for (int number = 0; number < 6; ++number) {
      TargetView view = view_of(number, range);
      view.texel_pitch = 0.5 * pitch;
      renderer.render(view, samples);
      sheet.put(number, pixels(samples, size, pitch), 0.25 * pitch * pitch);
      double flux = 0.0;
      for (const LightSample& s : samples) flux += s.photons_per_m2_s;
      fmt::print("{:5.0f} m, view {}: {} texels across, {} lit, magnitude at 75 km {:.2f}\n", range, number,
                 renderer.texels(), samples.size(),
                 -26.74 - 2.5 * std::log10(flux * range * range / (75.0e3 * 75.0e3)));
    }
    sheet.write(std::filesystem::path(argv[1]) / fmt::format("tango_{:.0f}m.png", range));
  }
}
