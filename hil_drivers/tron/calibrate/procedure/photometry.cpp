#include "hil_drivers/tron/calibrate/procedure/photometry.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace vbar::tron::calibrate {
namespace {

/// Pixels of the patch in the image, by the testbed as designed, with the edges that its errors may move left out.
struct PatchPixels {
  std::vector<std::size_t> at;

  [[nodiscard]] double mean(const BenchImage& image) const {
    double sum = 0.0;
    for (const std::size_t k : at) sum += image.dn.at(k);
    return sum / static_cast<double>(at.size());
  }
  [[nodiscard]] double highest(const BenchImage& image) const {
    std::uint16_t high = 0;
    for (const std::size_t k : at) high = std::max(high, image.dn.at(k));
    return high;
  }
};

/// The brightest window within reach of the designed place: a testbed is off by degrees, the patch is the largest white
/// area there. `light`: an image with only one source on.
PatchPixels find_patch(const BenchImage& image, const LensCalibration& lens, const BenchFile& file,
                       const BoardDesign& board, const Posture& posture) {
  const Eigen::Isometry3d T_C_B = T_C_T_of_arms(calibration_as_designed(file), posture) * T_target_board(file);
  fsw::Vector2 centre = fsw::Vector2::Zero();
  double side = 1e9;
  const auto corners = board.patch();
  for (std::size_t k = 0; k < 4; ++k) {
    const fsw::Vector2 px = lens.project(T_C_B * corners[k]);
    centre += 0.25 * px;
    side = std::min(side, (px - lens.project(T_C_B * corners[(k + 1) % 4])).norm());
  }
  const int half = std::max(3, static_cast<int>(0.25 * side));
  const int search = static_cast<int>(0.09 * lens.fx_px);  // 5 deg
  const auto mean_at = [&](int x, int y) {
    double sum = 0.0;
    for (int v = y - half; v <= y + half; ++v)
      for (int u = x - half; u <= x + half; ++u)
        sum +=
            image.dn[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u)];
    return sum;
  };
  int best_x = -1, best_y = -1;
  double best = -1.0;
  const auto look_at = [&](int x, int y) {
    if (x < half || y < half || x >= image.width - half || y >= image.height - half) return;
    const double mean = mean_at(x, y);
    if (mean > best) best = mean, best_x = x, best_y = y;
  };
  const int step = std::max(2, half / 2);
  for (int dy = -search; dy <= search; dy += step)
    for (int dx = -search; dx <= search; dx += step)
      look_at(static_cast<int>(centre.x()) + dx, static_cast<int>(centre.y()) + dy);
  if (best_x < 0) throw std::runtime_error("the white patch is out of the image");
  PatchPixels pixels;
  for (int v = best_y - half; v <= best_y + half; ++v)
    for (int u = best_x - half; u <= best_x + half; ++u)
      pixels.at.push_back(static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                          static_cast<std::size_t>(u));
  return pixels;
}

LightShares only(std::size_t source, double level, double lamp_azimuth_rad) {
  LightShares shares;
  shares.lamp_azimuth_rad = lamp_azimuth_rad;
  if (source == 0)
    shares.lamp = level;
  else
    shares.boxes.at(source - 1) = level;
  return shares;
}

/// Exposure at which the patch is at about 60 % of the largest value.
double suitable_exposure(CalibrationBench& bench, const LensCalibration& lens, const BenchFile& file,
                         const BoardDesign& board, const Posture& posture, PatchPixels& patch) {
  double exposure_s = 1e-3;
  for (int k = 0; k < 8; ++k) {
    const BenchImage image = bench.take(exposure_s);
    patch = find_patch(image, lens, file, board, posture);
    const double full = std::ldexp(1.0, image.bits) - 1.0, high = patch.highest(image) / full;
    if (high > 0.4 && high < 0.8) break;
    exposure_s = std::clamp(exposure_s * (high > 0.95 ? 0.2 : 0.6 / std::max(high, 0.03)), 1e-5, 2.0);
  }
  return exposure_s;
}

}  // namespace

DarkFigures measure_dark(CalibrationBench& bench, double exposure_s, int images) {
  bench.light({});
  DarkFigures figures;
  std::vector<std::uint16_t> last;
  double square = 0.0, count = 0.0, sum = 0.0, pixels = 0.0;
  for (int k = 0; k < images; ++k) {
    const BenchImage image = bench.take(exposure_s);
    // A hot pixel is far from the others: the offset is the median, the noise by differences below 20 DN.
    std::vector<std::uint16_t> sorted = image.dn;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    for (const std::uint16_t dn : image.dn)
      if (std::abs(static_cast<double>(dn) - *middle) < 20.0) sum += dn, pixels += 1.0;
    for (std::size_t p = 0; p < last.size(); ++p) {
      const double difference = static_cast<double>(image.dn[p]) - last[p];
      if (std::abs(difference) < 20.0) square += difference * difference, count += 1.0;
    }
    last = image.dn;
  }
  figures.offset_dn = sum / std::max(1.0, pixels);
  figures.read_noise_dn = std::sqrt(square / std::max(1.0, 2.0 * count));
  return figures;
}

std::vector<LightSample> measure_lights(CalibrationBench& bench, const LensCalibration& lens, const BenchFile& file,
                                        const BoardDesign& board, const std::vector<PatchPosture>& postures,
                                        double lamp_azimuth_rad, int levels) {
  std::vector<LightSample> samples;
  for (const PatchPosture& place : postures) {
    if (!bench.move(place.posture)) continue;
    for (const PatchPosture::Light& light : place.lights) {
      bench.light(only(light.source, 1.0, lamp_azimuth_rad));
      PatchPixels patch;
      const double exposure_s = suitable_exposure(bench, lens, file, board, place.posture, patch);
      bench.light(only(light.source, 0.0, lamp_azimuth_rad));
      const double dark = patch.mean(bench.take(exposure_s));
      for (int k = 1; k <= levels; ++k) {
        const double level = static_cast<double>(k) / levels;
        bench.light(only(light.source, level, lamp_azimuth_rad));
        const double mean = patch.mean(bench.take(exposure_s));
        samples.push_back({light_source_name(light.source), level, (mean - dark) / exposure_s, light.irradiance});
      }
    }
  }
  bench.light({});
  return samples;
}

SourceFlags measured_sources(const std::vector<LightSample>& samples) {
  SourceFlags flags{};
  for (std::size_t source = 0; source < kLightSources; ++source)
    flags.at(source) = std::ranges::find(samples, light_source_name(source), &LightSample::source) != samples.end();
  return flags;
}

double lamp_dn_per_s(const std::vector<LightSample>& samples) {
  for (const LightSample& sample : samples)
    if (sample.source == light_source_name(0) && sample.level == 1.0 && sample.design_irradiance > 0.0)
      return std::max(0.0, sample.dn_per_s / sample.design_irradiance);
  return 0.0;
}

std::vector<LightTable> light_tables(const std::vector<LightSample>& samples) {
  const double lamp = lamp_dn_per_s(samples);
  std::vector<LightTable> tables;
  for (std::size_t source = 0; source < kLightSources; ++source) {
    LightTable table;
    table.source = light_source_name(source);
    for (const LightSample& sample : samples) {
      if (sample.source != table.source || !(lamp > 0.0 && sample.design_irradiance > 0.0)) continue;
      const double light = sample.dn_per_s / (lamp * sample.design_irradiance);
      const bool has_risen = table.light.empty() || (sample.level > table.level.back() && light > table.light.back());
      if (!(light > 0.0 && has_risen)) continue;
      table.level.push_back(sample.level);
      table.light.push_back(light);
    }
    if (table.level.size() >= 2) tables.push_back(table);
  }
  return tables;
}

}  // namespace vbar::tron::calibrate
