#include "hil_drivers/optical_stimulator/imaging/self_check.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/pictures/picture_maker.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator {

namespace {

constexpr int kReach_px = 6;
constexpr int kSteps = 20;

}  // namespace

std::optional<Spot> windowed_centroid(std::span<const std::uint16_t> dn, int width, const fsw::Vector2& near,
                                      double background_dn, double sigma_px, double least_dn) {
  const int height = static_cast<int>(dn.size() / static_cast<std::size_t>(width));
  const auto x0 = static_cast<int>(std::lround(near.x())), y0 = static_cast<int>(std::lround(near.y()));
  if (x0 < kReach_px || y0 < kReach_px || x0 >= width - kReach_px || y0 >= height - kReach_px) return std::nullopt;
  Spot spot{near, 0.0};
  for (int step = 0; step < kSteps; ++step) {
    double weights = 0.0, sum = 0.0;
    fsw::Vector2 offset = fsw::Vector2::Zero();
    for (int y = y0 - kReach_px; y <= y0 + kReach_px; ++y)
      for (int x = x0 - kReach_px; x <= x0 + kReach_px; ++x) {
        const double light =
            dn[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] -
            background_dn;
        const fsw::Vector2 from = fsw::Vector2(x, y) - spot.centre;
        const double weighted = light * std::exp(-0.5 * from.squaredNorm() / (sigma_px * sigma_px));
        sum += light;
        weights += weighted;
        offset += weighted * from;
      }
    if (!(sum >= least_dn) || !(weights > 0.0)) return std::nullopt;
    spot.dn = sum;
    const fsw::Vector2 change = 2.0 * offset / weights;
    spot.centre += change;
    if ((spot.centre - near).lpNorm<Eigen::Infinity>() > kReach_px) return std::nullopt;
    if (change.norm() < 1e-5) break;
  }
  return spot;
}

using fsw::Vector2;

FittedDay fit_day(std::span<const DotPair> dots, const Vector2& middle) {
  if (dots.size() < 2) throw std::invalid_argument("a rotation needs two dots");
  Vector2 from = Vector2::Zero(), to = Vector2::Zero();
  for (const DotPair& dot : dots) {
    from += dot.by_map - middle;
    to += dot.shown - middle;
  }
  from /= static_cast<double>(dots.size());
  to /= static_cast<double>(dots.size());
  // As complex numbers: to = factor from + shift.
  double squares = 0.0, along = 0.0, across = 0.0;
  for (const DotPair& dot : dots) {
    const Vector2 a = dot.by_map - middle - from, b = dot.shown - middle - to;
    squares += a.squaredNorm();
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  if (!(squares > 0.0)) throw std::invalid_argument("a rotation needs two places");
  FittedDay day;
  day.correction.scale = std::hypot(along, across) / squares;
  day.correction.rotation_rad = std::atan2(across, along);
  const fsw::Matrix2 turn = day.correction.scale * Eigen::Rotation2Dd(day.correction.rotation_rad).toRotationMatrix();
  day.correction.shift_px = to - turn * from;
  for (const DotPair& dot : dots)
    day.residuals_px.push_back((middle + turn * (dot.by_map - middle) + day.correction.shift_px - dot.shown).norm());
  return day;
}

namespace {

using twins::camera::Region;

constexpr double kArcsec = M_PI / 648000.0;
constexpr double kDotSigma_px = 0.7;
constexpr double kDotElectrons = 6e4;      // a third of the full well in the brightest camera pixel
constexpr double kGreyElectrons = 8000.0;  // light of a camera pixel
constexpr int kDotImages = 4;
constexpr double kApart_px = 24.0, kMargin_px = 16.0;

/// Random, so that they are not of the calibration's grid; the same on each day.
std::vector<Vector2> dot_places(const Region& region, int count) {
  engine::RandomStream random(1, "optical_stimulator/self_check");
  std::vector<Vector2> places;
  constexpr int kTries = 10000;
  for (int k = 0; k < kTries && static_cast<int>(places.size()) < count; ++k) {
    const Vector2 place(random.uniform(region.x + kMargin_px, region.x + region.width - 1 - kMargin_px),
                        random.uniform(region.y + kMargin_px, region.y + region.height - 1 - kMargin_px));
    const bool is_free =
        std::ranges::all_of(places, [&](const Vector2& other) { return (other - place).norm() > kApart_px; });
    if (is_free) places.push_back(place);
  }
  return places;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Standard deviation of normal values, of which a few may be outliers.
double robust_sigma(std::vector<double> values) {
  const double centre = median(values);
  for (double& value : values) value = std::abs(value - centre);
  constexpr double kSigmaPerDeviation = 1.4826;
  return kSigmaPerDeviation * median(std::move(values));
}

}  // namespace

std::string complaint_of(const SelfCheckFigures& figures) {
  std::string complaints;
  const auto check = [&](bool is_accepted, const std::string& figure) {
    if (!is_accepted) complaints += (complaints.empty() ? "" : "; ") + figure;
  };
  const auto check_ratio = [&](const char* name, double ratio, double limit) {
    check(std::abs(ratio - 1.0) <= limit, fmt::format("{} {:.3f} of the calibration's, accepted: {:.2f} to {:.2f}",
                                                      name, ratio, 1.0 - limit, 1.0 + limit));
  };
  check(figures.dots >= SelfCheck::kDots * 9 / 10,
        fmt::format("{} of {} dots were found", figures.dots, SelfCheck::kDots));
  check(figures.residual_arcsec <= kResidualLimit_arcsec,
        fmt::format("mean residual {:.1f} arcsec, accepted: at most {:.0f}", figures.residual_arcsec,
                    kResidualLimit_arcsec));
  check(figures.correction.shift_px.norm() <= kShiftLimit_px,
        fmt::format("the display has moved by {:.2f} of its pixels, accepted: at most {:.0f}",
                    figures.correction.shift_px.norm(), kShiftLimit_px));
  const double ppm = 1e6 * (figures.correction.scale - 1.0);
  check(std::abs(ppm) <= kScaleLimit_ppm,
        fmt::format("the scale has changed by {:.0f} ppm, accepted: at most {:.0f}", ppm, kScaleLimit_ppm));
  check_ratio("brightness", figures.brightness, kBrightnessLimit);
  check_ratio("noise", figures.noise, kNoiseLimit);
  check_ratio("offset", figures.offset, kOffsetLimit);
  return complaints;
}

SelfCheck::SelfCheck(const StimulatorCalibration& calibration, const twins::camera::CameraSettings& camera,
                     const DisplayMap& map, const DisplayLight& light)
    : calibration_(calibration), camera_(camera), map_(map), light_(light) {
  const twins::camera::Optics optics(camera);
  for (const Vector2& place : dot_places(camera.region, kDots))
    if (const auto pixel = map.project(optics.direction_of(place))) dots_.push_back({place, *pixel});
}

SelfCheckFigures SelfCheck::run(Exchange& exchange) const {
  SelfCheckFigures figures;
  Picture picture(light_.width(), light_.height());
  const Image first = exchange.take(picture).dn, second = exchange.take(picture).dn;
  check_black(first, second, figures);

  for (const Dot& dot : dots_) draw_dot(light_, dot.display_px, kDotSigma_px, kDotElectrons, picture);
  std::vector<Image> images;
  for (int k = 0; k < kDotImages; ++k) images.push_back(exchange.take(picture).dn);
  check_dots(images, figures);

  std::ranges::fill(picture.counts, std::uint8_t{0});
  const Region grey = display_region(camera_.region, camera_, map_, light_.width(), light_.height(), 0);
  const double area = std::pow(camera_.focal_length_px() / map_.focal_length_px(), 2);
  const std::vector<float> wanted(static_cast<std::size_t>(grey.width) * static_cast<std::size_t>(grey.height),
                                  static_cast<float>(kGreyElectrons * area));
  static_cast<void>(PictureMaker(light_).draw({grey, wanted}, picture));
  check_grey(exchange.take(picture).dn, figures);
  return figures;
}

double SelfCheck::black_dn() const {
  const twins::camera::DetectorSettings& detector = camera_.detector;
  return detector.offset_dn + detector.gain_dn_per_electron * detector.dark_electrons_per_s * camera_.exposure_s;
}

void SelfCheck::check_black(const Image& first, const Image& second, SelfCheckFigures& figures) const {
  const twins::camera::DetectorSettings& detector = camera_.detector;
  std::vector<double> means, differences;
  for (std::size_t k = 0; k < first.size(); ++k) {
    means.push_back(0.5 * (first[k] + second[k]));
    differences.push_back(first[k] - second[k]);
  }
  // Whole numbers have a coarse median: the mean of those near it.
  const double centre = median(means), sigma = std::max(1.0, robust_sigma(differences) / std::sqrt(2.0));
  constexpr double kNear = 5.0;
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    if (!(std::abs(means[k] - centre) < kNear * sigma)) continue;
    sum += means[k];
    squares += differences[k] * differences[k];
    count += 1.0;
  }
  const double noise_dn = std::sqrt(squares / count / 2.0);
  const double electrons = detector.read_noise_electrons * detector.read_noise_electrons +
                           detector.dark_electrons_per_s * camera_.exposure_s;
  constexpr double kRounding = 1.0 / 12.0;  // variance, DN^2
  const double expected_dn =
      std::sqrt(detector.gain_dn_per_electron * detector.gain_dn_per_electron * electrons + kRounding);
  figures.noise = noise_dn / expected_dn;
  figures.offset = sum / count / black_dn();

  constexpr double kHot = 10.0;  // sigmas
  for (std::size_t k = 0; k < means.size(); ++k) {
    if (!(means[k] > sum / count + kHot * noise_dn)) continue;
    const int x = camera_.region.x + static_cast<int>(k % static_cast<std::size_t>(camera_.region.width));
    const int y = camera_.region.y + static_cast<int>(k / static_cast<std::size_t>(camera_.region.width));
    const bool is_known = std::ranges::any_of(calibration_.camera.hot_pixels,
                                              [&](const HotPixel& hot) { return hot.x == x && hot.y == y; });
    figures.new_hot_pixels += is_known ? 0 : 1;
  }
}

/// The middle half, where no edge of the grey area is near.
void SelfCheck::check_grey(const Image& image, SelfCheckFigures& figures) const {
  const Region& region = camera_.region;
  std::vector<double> values;
  for (int y = region.height / 4; y < 3 * region.height / 4; ++y)
    for (int x = region.width / 4; x < 3 * region.width / 4; ++x)
      values.push_back(
          image[static_cast<std::size_t>(y) * static_cast<std::size_t>(region.width) + static_cast<std::size_t>(x)]);
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  figures.brightness = (mean - black_dn()) / (camera_.detector.gain_dn_per_electron * kGreyElectrons);
}

void SelfCheck::check_dots(const std::vector<Image>& images, SelfCheckFigures& figures) const {
  const twins::camera::Optics optics(camera_);
  const Vector2 corner(camera_.region.x, camera_.region.y);
  const double least_dn = 0.2 * kDotElectrons * camera_.detector.gain_dn_per_electron;
  const double sigma_px = 1.2 * camera_.optics.point_spread_sigma_px;
  std::vector<DotPair> pairs;
  for (const Dot& dot : dots_) {
    Vector2 sum = Vector2::Zero();
    int found = 0;
    for (const Image& image : images) {
      const auto spot =
          windowed_centroid(image, camera_.region.width, dot.camera_px - corner, black_dn(), sigma_px, least_dn);
      if (!spot) continue;
      sum += spot->centre + corner;
      ++found;
    }
    if (found < static_cast<int>(images.size())) continue;
    const auto by_map = map_.project(optics.direction_of(sum / found));
    if (by_map) pairs.push_back({*by_map, dot.display_px});
  }
  figures.dots = static_cast<int>(pairs.size());
  if (pairs.size() < 2) return;
  const FittedDay day = fit_day(pairs, Vector2(0.5 * (light_.width() - 1), 0.5 * (light_.height() - 1)));
  figures.correction = day.correction;
  const double mean_px = std::accumulate(day.residuals_px.begin(), day.residuals_px.end(), 0.0) /
                         static_cast<double>(day.residuals_px.size());
  figures.residual_arcsec = mean_px / map_.focal_length_px() / kArcsec;
}

}  // namespace vbar::optical_stimulator
