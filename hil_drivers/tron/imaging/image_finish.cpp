#include "hil_drivers/tron/imaging/image_finish.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/twins/camera/pixel_noise.h"

namespace vbar::tron {

std::vector<std::uint16_t> binned_by_two(std::span<const std::uint16_t> dn, int width, int height) {
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0 ||
      dn.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::invalid_argument(
        fmt::format("{} pixels are not an image of {} x {} that can be binned by two", dn.size(), width, height));
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::uint16_t> means(dn.size() / 4);
  std::size_t k = 0;
  for (std::size_t row = 0; row < dn.size(); row += 2 * columns) {
    const std::uint16_t* const upper = dn.data() + row;
    const std::uint16_t* const lower = upper + columns;
    for (std::size_t x = 0; x < columns; x += 2)
      means[k++] = static_cast<std::uint16_t>((upper[x] + upper[x + 1] + lower[x] + lower[x + 1] + 2U) / 4U);
  }
  return means;
}

namespace {

/// Less is rounding.
constexpr float kCovered = 0.01F;

std::size_t index(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// By the binomial filter of three by three, whose standard deviation is 0.71 px.
std::vector<float> blurred(std::span<const float> values, int width) {
  const int height = static_cast<int>(values.size()) / width;
  const auto pass = [&](std::span<const float> from, int dx, int dy) {
    std::vector<float> to(from.size());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto at = [&](int sign) {
          return from[index(std::clamp(x + sign * dx, 0, width - 1), std::clamp(y + sign * dy, 0, height - 1), width)];
        };
        to[index(x, y, width)] = 0.25F * at(-1) + 0.5F * at(0) + 0.25F * at(1);
      }
    return to;
  };
  return pass(pass(values, 1, 0), 0, 1);
}

}  // namespace

DarkLevel dark_level(std::span<const std::uint16_t> dn) {
  if (dn.size() < 100) throw std::invalid_argument("a dark image of fewer than 100 pixels");
  std::vector<std::uint16_t> sorted(dn.begin(), dn.end());
  std::ranges::sort(sorted);
  // Moments of the middle two thirds, so that hot pixels and rounding to whole numbers do not matter. A normal
  // distribution cut off at its sixths has 0.5365 of its standard deviation left.
  constexpr double kOfMiddle = 0.5365;
  const std::size_t sixth = sorted.size() / 6;
  double sum = 0.0, squares = 0.0;
  const auto middle = std::span(sorted).subspan(sixth, sorted.size() - 2 * sixth);
  for (const std::uint16_t value : middle) sum += value;
  const double mean = sum / static_cast<double>(middle.size());
  for (const std::uint16_t value : middle) squares += (value - mean) * (value - mean);
  // Rounding adds 1/12 to the variance, and the noise that is drawn is rounded again.
  const double deviation = std::sqrt(squares / static_cast<double>(middle.size())) / kOfMiddle;
  return {mean, std::sqrt(std::max(0.0, deviation * deviation - 1.0 / 12.0))};
}

std::vector<std::uint8_t> grown(std::span<const float> covered, int width, int radius_px) {
  const int height = static_cast<int>(covered.size()) / width;
  const auto at = [width](int x, int y) { return index(x, y, width); };
  std::vector<std::uint8_t> mask(covered.size(), 0);
  const auto is_covered = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && covered[at(x, y)] >= kCovered;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!is_covered(x, y)) continue;
      mask[at(x, y)] = 1;
      // Only the edge has anything to add.
      if (is_covered(x - 1, y) && is_covered(x + 1, y) && is_covered(x, y - 1) && is_covered(x, y + 1)) continue;
      for (int dy = -radius_px; dy <= radius_px; ++dy) {
        if (y + dy < 0 || y + dy >= height) continue;
        const int reach = static_cast<int>(std::sqrt(static_cast<double>(radius_px * radius_px - dy * dy)));
        const int first = std::max(0, x - reach), last = std::min(width - 1, x + reach);
        std::fill(mask.begin() + static_cast<std::ptrdiff_t>(at(first, y + dy)),
                  mask.begin() + static_cast<std::ptrdiff_t>(at(last, y + dy)) + 1, std::uint8_t{1});
      }
    }
  return mask;
}

Outline outline_of(twins::camera::Silhouette& silhouette, const twins::camera::Projection& lens,
                   const Eigen::Isometry3d& T_C_B, const twins::camera::Region& region) {
  std::vector<float> sharp;
  silhouette.draw(lens, T_C_B.translation(), T_C_B.linear(), region, sharp);
  return {region.width, blurred(sharp, region.width), grown(sharp, region.width, Outline::kMargin_px)};
}

void subtract_background(const Outline& outline, const DarkLevel& dark, std::span<std::uint16_t> dn) {
  if (outline.mask.size() != dn.size()) throw std::invalid_argument("an outline of another size than the image");
  // Beyond what the lens scatters of the target, and near enough to be the same wall.
  constexpr int kNearest_px = 4, kFarthest_px = 9;
  const int width = outline.width, height = static_cast<int>(dn.size()) / width;
  const std::vector<std::uint8_t> near = grown(outline.covered, width, kNearest_px);
  const std::vector<std::uint16_t> taken(dn.begin(), dn.end());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = index(x, y, width);
      const float open = 1.0F - outline.covered[at];
      if (outline.mask[at] == 0 || open < 0.01F) continue;
      double sum = 0.0, count = 0.0;
      for (int v = std::max(0, y - kFarthest_px); v <= std::min(height - 1, y + kFarthest_px); ++v)
        for (int u = std::max(0, x - kFarthest_px); u <= std::min(width - 1, x + kFarthest_px); ++u)
          if (near[index(u, v, width)] == 0) {
            sum += taken[index(u, v, width)];
            count += 1.0;
          }
      if (count == 0.0) continue;  // in a corner between two parts of the target, which hide the wall
      const double wall_dn = std::max(0.0, sum / count - dark.offset_dn);
      dn[at] = static_cast<std::uint16_t>(std::max(0L, std::lround(taken[at] - static_cast<double>(open) * wall_dn)));
    }
}

void replace_background(std::span<const std::uint8_t> mask, const DarkLevel& dark, std::uint64_t key,
                        std::int64_t image, std::uint16_t full_scale_dn, std::span<std::uint16_t> dn) {
  using namespace twins::camera;
  if (mask.size() != dn.size()) throw std::invalid_argument("a mask of another size than the image");
  ChunkWords words;
  ChunkFloats normal;
  for (std::size_t first = 0; first < dn.size(); first += kChunk) {
    const std::size_t count = std::min(kChunk, dn.size() - first);
    const auto masked = mask.subspan(first, count);
    if (std::ranges::find(masked, std::uint8_t{0}) == masked.end()) continue;
    draw_words({key, static_cast<std::uint64_t>(image)}, NoiseKind::kRead, static_cast<std::uint32_t>(first / kChunk),
               words);
    normal_numbers(words, normal);
    for (std::size_t k = 0; k < count; ++k)
      if (masked[k] == 0)
        dn[first + k] = static_cast<std::uint16_t>(
            std::clamp(std::lround(dark.offset_dn + dark.noise_dn * static_cast<double>(normal[k])), 0L,
                       static_cast<long>(full_scale_dn)));
  }
}

double ExpectedLight::electrons(const Eigen::Isometry3d& T_C_B, const TargetLight& light,
                                const twins::camera::CameraSettings& camera) {
  twins::camera::TargetView view;
  view.position_camera = T_C_B.translation();
  view.R_camera_body = T_C_B.linear();
  view.sun_camera = light.sun_C;
  view.sun_photons_per_m2_s = light.sun_photons_per_m2_s;
  view.nadir_camera = light.earth_C;
  view.earth_photons_per_m2_s = light.earth_photons_per_m2_s;
  view.earth_half_angle = light.earth_half_angle;
  renderer_.render(view, samples_);
  double photons = 0.0;
  for (const twins::camera::LightSample& sample : samples_) photons += sample.photons_per_m2_s;
  return photons * camera.electrons_per_photon_m2() * camera.exposure_s;
}

double measured_electrons(std::span<const std::uint16_t> dn, std::span<const std::uint8_t> mask, double offset_dn,
                          double gain_dn_per_electron) {
  double sum = 0.0, pixels = 0.0;
  for (std::size_t k = 0; k < dn.size() && k < mask.size(); ++k) {
    if (mask[k] == 0) continue;
    sum += dn[k];
    pixels += 1.0;
  }
  return (sum - pixels * offset_dn) / gain_dn_per_electron;
}

namespace {

twins::camera::CadModel diffuse_only(twins::camera::CadModel model) {
  for (twins::camera::Material& material : model.materials) material.specular = {};
  return model;
}

}  // namespace

ImageFinish::ImageFinish(const twins::camera::CameraSettings& camera, const twins::camera::CadModel& model,
                         const std::vector<std::uint16_t>& dark, std::uint64_t key)
    : camera_(camera),
      lens_(camera),
      silhouette_(model),
      expected_(model),
      expected_diffuse_(diffuse_only(model)),
      dark_(dark_level(binned(dark))),
      key_(key) {}

std::vector<std::uint16_t> ImageFinish::binned(const std::vector<std::uint16_t>& frame) const {
  return binned_by_two(frame, 2 * camera_.region.width, 2 * camera_.region.height);
}

FinishedImage ImageFinish::finish(const std::vector<std::uint16_t>& frame, std::int64_t image,
                                  const Eigen::Isometry3d& T_C_B, const std::optional<TargetLight>& light) {
  FinishedImage finished;
  finished.dn = binned(frame);
  std::vector<std::uint8_t> mask(finished.dn.size(), 0);
  if (light) {
    Outline outline = outline_of(silhouette_, lens_, T_C_B, camera_.region);
    subtract_background(outline, dark_, finished.dn);
    mask = std::move(outline.mask);
    TargetLight sunlight = *light, earth_light = *light;
    sunlight.earth_photons_per_m2_s = earth_light.sun_photons_per_m2_s = 0.0;
    const double of_sun = expected_.electrons(T_C_B, sunlight, camera_);
    const double of_earth = expected_.electrons(T_C_B, earth_light, camera_);
    const double measured =
        measured_electrons(finished.dn, mask, dark_.offset_dn, camera_.detector.gain_dn_per_electron);
    // With fewer electrons the noise of the mask's pixels decides.
    constexpr double kLeast = 1e5;
    if (of_sun + of_earth > kLeast) finished.light_level = measured / (of_sun + of_earth);
    const double of_sun_diffuse = expected_diffuse_.electrons(T_C_B, sunlight, camera_);
    if (of_sun_diffuse > std::max(kLeast, of_earth)) finished.sunlight_level = (measured - of_earth) / of_sun_diffuse;
  }
  const auto full_scale = static_cast<std::uint16_t>((1U << static_cast<unsigned>(camera_.detector.bits)) - 1U);
  replace_background(mask, dark_, key_, image, full_scale, finished.dn);
  return finished;
}

}  // namespace vbar::tron
