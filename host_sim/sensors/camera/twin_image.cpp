#include "host_sim/sensors/camera/twin_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/report/colour_picture.h"
#include "host_sim/sensors/camera/known_camera.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/twins/camera/exposure_of_truth.h"

namespace vbar::sensors {
namespace {

constexpr std::uint16_t kMissing = 0xFFFF;
constexpr double kSigmaOfMad = 1.4826;  // factor of a normal distribution
constexpr double kShownFrom_sigma = 5.0;
constexpr int kHalfWindow = 4;  // px, of a centroid

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The differences of the pixels that both images have.
std::vector<double> differences(const ImagePair& pair) {
  std::vector<double> all;
  for (std::size_t k = 0; k < pair.testbed.size(); ++k)
    if (pair.testbed[k] != kMissing) all.push_back(static_cast<double>(pair.testbed[k]) - pair.twin[k]);
  return all;
}

struct Noise {
  double median_dn = 0.0, sigma_dn = 0.0;
};

Noise noise_of(const ImagePair& pair) {
  std::vector<double> all = differences(pair);
  const double middle = median(all);
  for (double& value : all) value = std::abs(value - middle);
  // Whole numbers: identical images have no deviation, and one step of the converter is no feature.
  return {middle, std::max(kSigmaOfMad * median(std::move(all)), 0.5)};
}

/// Centroid of the light above the median of a window about a place; empty at the edge, without light and with missing
/// pixels.
std::optional<Eigen::Vector2d> centroid(const ImagePair& pair, std::span<const std::uint16_t> dn, double x_px,
                                        double y_px) {
  const int x0 = static_cast<int>(std::lround(x_px)) - pair.origin_x_px;
  const int y0 = static_cast<int>(std::lround(y_px)) - pair.origin_y_px;
  if (x0 < kHalfWindow || y0 < kHalfWindow || x0 + kHalfWindow >= pair.width || y0 + kHalfWindow >= pair.height)
    return std::nullopt;
  const auto at = [&](int x, int y) { return dn[static_cast<std::size_t>(y * pair.width + x)]; };
  std::vector<double> window;
  for (int y = y0 - kHalfWindow; y <= y0 + kHalfWindow; ++y)
    for (int x = x0 - kHalfWindow; x <= x0 + kHalfWindow; ++x) {
      if (at(x, y) == kMissing) return std::nullopt;
      window.push_back(at(x, y));
    }
  const double background = median(window);
  double sum = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (int y = y0 - kHalfWindow; y <= y0 + kHalfWindow; ++y)
    for (int x = x0 - kHalfWindow; x <= x0 + kHalfWindow; ++x) {
      const double light = std::max(at(x, y) - background, 0.0);
      sum += light;
      moment += light * Eigen::Vector2d(x, y);
    }
  if (!(sum > 0.0)) return std::nullopt;
  return moment / sum;
}

}  // namespace

TakeTwinImage twin_of_testbed_camera(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                     const mission::Sensor& sensor) {
  if (testbeds::find_testbed(sensor.settings->source) == nullptr) return {};
  struct Twin {
    std::unique_ptr<twins::camera::ImageMaker> camera;
    twins::camera::CameraMount mount;
  };
  return [twin = std::make_shared<Twin>(), &mission, &servicer, &sensor](const twins::TruthSnapshot& truth,
                                                                         std::int64_t number) {
    if (!twin->camera) {
      const auto data = mission::data_directory();
      const CameraSensor known = known_camera(settings_of<CameraSensor>(sensor), mission, data).sensor;
      twin->mount = mount_of(mission, servicer, known, data);
      mission::Sensor calibrated = sensor;
      calibrated.settings = std::make_shared<const CameraSensor>(known);
      twin->camera = make_digital_camera(mission, servicer, calibrated, data);
    }
    return twin->camera->take(twins::camera::exposure_of_truth(twin->mount, truth, number)).dn;
  };
}

std::vector<std::uint8_t> difference_png(const ImagePair& pair) {
  const Noise noise = noise_of(pair);
  report::ColourPicture picture(pair.width, pair.height);
  for (int y = 0; y < pair.height; ++y)
    for (int x = 0; x < pair.width; ++x) {
      const auto k = static_cast<std::size_t>(y * pair.width + x);
      if (pair.testbed[k] == kMissing) continue;
      const double difference = static_cast<double>(pair.testbed[k]) - pair.twin[k] - noise.median_dn;
      const double size = std::abs(difference) / noise.sigma_dn;
      if (size < kShownFrom_sigma) continue;
      // The scale is logarithmic: from a third of the brightness to full brightness at a hundred times the limit.
      const double share = std::min(1.0 / 3.0 + std::log10(size / kShownFrom_sigma) / 3.0, 1.0);
      const auto strong = static_cast<std::uint8_t>(std::lround(255.0 * share));
      const auto weak = static_cast<std::uint8_t>(strong / 3);
      picture.set(x, y, difference > 0.0 ? report::Colour{strong, weak, weak} : report::Colour{weak, weak, strong});
    }
  return picture.png();
}

std::optional<Eigen::Vector2d> target_shift_px(const ImagePair& pair, const telemetry_objects& objects) {
  std::vector<double> stars_x, stars_y;
  std::optional<Eigen::Vector2d> target;
  const int count = std::min<int>(objects.count, std::size(objects.kind));
  for (int k = 0; k < count; ++k) {
    const auto in_testbed =
        centroid(pair, pair.testbed, static_cast<double>(objects.x_px[k]), static_cast<double>(objects.y_px[k]));
    const auto in_twin =
        centroid(pair, pair.twin, static_cast<double>(objects.x_px[k]), static_cast<double>(objects.y_px[k]));
    if (!in_testbed || !in_twin) continue;
    const Eigen::Vector2d shift = *in_testbed - *in_twin;
    if (objects.kind[k] == telemetry_objects::kKindTarget) target = shift;
    if (objects.kind[k] != telemetry_objects::kKindStar) continue;
    stars_x.push_back(shift.x());
    stars_y.push_back(shift.y());
  }
  if (!target || stars_x.empty()) return std::nullopt;
  return *target - Eigen::Vector2d(median(stars_x), median(stars_y));
}

std::string difference_text(const ImagePair& pair, const ImageRow& row, const telemetry_objects* objects,
                            double focal_length_px) {
  const Noise noise = noise_of(pair);
  std::string text = fmt::format("median {:.1f} DN, noise {:.1f} DN", noise.median_dn, noise.sigma_dn);
  const auto shift_px = objects != nullptr ? target_shift_px(pair, *objects) : std::nullopt;
  if (!shift_px || !row.bearing_error_x_arcsec) return text;
  const Eigen::Vector2d error(*row.bearing_error_x_arcsec, row.bearing_error_y_arcsec.value_or(0.0));
  const Eigen::Vector2d of_twin = error - *shift_px / focal_length_px / fsw::math::kArcsecond;
  return text + fmt::format(", bearing error {:.1f}, {:.1f} arcsec, in the image of the twin {:.1f}, {:.1f} arcsec",
                            error.x(), error.y(), of_twin.x(), of_twin.y());
}

}  // namespace vbar::sensors
