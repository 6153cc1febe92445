#include "hil_drivers/tron/calibration/procedure.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/tron/calibration/corner_detection.h"

namespace vbar::tron::calibrate {

namespace {

/// Pixels of the patch in the image, by the testbed as designed, with the edges that its errors may move left out.
struct PatchPixels {
  std::vector<std::size_t> at;

  [[nodiscard]] double mean(const CalibrationImage& image) const {
    double sum = 0.0;
    for (const std::size_t k : at) sum += image.dn.at(k);
    return sum / static_cast<double>(at.size());
  }
  [[nodiscard]] double highest(const CalibrationImage& image) const {
    std::uint16_t high = 0;
    for (const std::size_t k : at) high = std::max(high, image.dn.at(k));
    return high;
  }
};

/// The brightest window within reach of the designed place: a testbed is off by degrees, the patch is the largest white
/// area there. `light`: an image with only one source on.
PatchPixels find_patch(const CalibrationImage& image, const LensCalibration& lens, const TestbedDesign& file,
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
double suitable_exposure(CalibrationTestbed& bench, const LensCalibration& lens, const TestbedDesign& file,
                         const BoardDesign& board, const Posture& posture, PatchPixels& patch) {
  double exposure_s = 1e-3;
  for (int k = 0; k < 8; ++k) {
    const CalibrationImage image = bench.take(exposure_s);
    patch = find_patch(image, lens, file, board, posture);
    const double full = std::ldexp(1.0, image.bits) - 1.0, high = patch.highest(image) / full;
    if (high > 0.4 && high < 0.8) break;
    exposure_s = std::clamp(exposure_s * (high > 0.95 ? 0.2 : 0.6 / std::max(high, 0.03)), 1e-5, 2.0);
  }
  return exposure_s;
}

}  // namespace

DarkFigures measure_dark(CalibrationTestbed& bench, double exposure_s, int images) {
  bench.light({});
  DarkFigures figures;
  std::vector<std::uint16_t> last;
  double square = 0.0, count = 0.0, sum = 0.0, pixels = 0.0;
  for (int k = 0; k < images; ++k) {
    const CalibrationImage image = bench.take(exposure_s);
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

std::vector<LightSample> measure_lights(CalibrationTestbed& bench, const LensCalibration& lens,
                                        const TestbedDesign& file, const BoardDesign& board,
                                        const std::vector<PatchPosture>& postures, double lamp_azimuth_rad,
                                        int levels) {
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

namespace {

constexpr double kLow = 0.2, kHigh = 0.9, kWanted = 0.6;  ///< white of the board, of the largest value
constexpr double kExposureLow_s = 2e-5, kExposureHigh_s = 1.0;

/// The white of the board: 90 % of the pixels within the box of its corners are darker.
double white_of(const CalibrationImage& image, const std::vector<Corner>& corners) {
  fsw::Vector2 low(1e9, 1e9), high(-1e9, -1e9);
  for (const Corner& corner : corners) {
    low = low.cwiseMin(corner.px);
    high = high.cwiseMax(corner.px);
  }
  std::vector<std::uint16_t> sample;
  for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()); y += 2)
    for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()); x += 2)
      sample.push_back(image.dn.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                   static_cast<std::size_t>(x)));
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(sample.size() - 1));
  std::ranges::nth_element(sample, at);
  return *at / (std::ldexp(1.0, image.bits) - 1.0);
}

struct Seen {
  std::vector<Corner> corners;
  double white = 0.0;
};

Seen look(CalibrationTestbed& bench, const BoardDesign& board, double exposure_s) {
  const CalibrationImage image = bench.take(exposure_s);
  Seen seen;
  seen.corners = detect_corners({image.width, image.height, image.dn}, board);
  if (!seen.corners.empty()) seen.white = white_of(image, seen.corners);
  return seen;
}

std::vector<Measurement> measure_all(CalibrationTestbed& bench, const BoardDesign& board,
                                     const std::vector<Posture>& postures, const std::string& name, double& exposure_s,
                                     const Progress& progress) {
  std::vector<Measurement> measurements;
  int seen = 0, unreached = 0;
  for (const Posture& posture : postures) {
    if (!bench.move(posture)) {
      ++unreached;
      continue;
    }
    measurements.push_back(measure_board(bench, board, exposure_s));
    seen += measurements.back().corners.empty() ? 0 : 1;
    if (progress && (measurements.size() == 1 || measurements.size() % 20 == 0))
      progress(
          fmt::format("{}: {} of {} postures, board seen at {}", name, measurements.size(), postures.size(), seen));
  }
  if (progress)
    progress(
        fmt::format("{}: {} postures, board seen at {}, no way to {}", name, measurements.size(), seen, unreached));
  return measurements;
}

/// From where the last one was measured there may be no way to a posture: its sources get others.
std::vector<LightSample> measure_all_lights(CalibrationTestbed& bench, const TestbedDesign& file,
                                            const LensCalibration& lens, const ProcedureSettings& settings,
                                            std::vector<PatchPosture> patches, const PostureFilter& filter,
                                            const Progress& progress) {
  constexpr std::uint64_t kRounds = 8;
  const BoardDesign board;
  std::vector<LightSample> samples;
  for (std::uint64_t round = 1;; ++round) {
    const auto found =
        measure_lights(bench, lens, file, board, patches, settings.lamp_azimuth_rad, settings.light_levels);
    samples.insert(samples.end(), found.begin(), found.end());
    const SourceFlags measured = measured_sources(samples);
    const auto missing = std::ranges::find(measured, false);
    if (missing == measured.end()) return samples;
    const std::string name = light_source_name(static_cast<std::size_t>(missing - measured.begin()));
    if (round == kRounds)
      throw std::runtime_error(
          fmt::format("no way without a collision to the white patch in the light of {}, in {} rounds", name, kRounds));
    if (progress) progress(fmt::format("no way to the white patch in the light of {}: other postures are tried", name));
    patches =
        choose_patch_postures(file, lens, board, settings.lamp_azimuth_rad, settings.seed + round, filter, measured);
  }
}

}  // namespace

ProcedureSettings quick(ProcedureSettings settings) {
  settings.fitted = 60;
  settings.judged = 20;
  settings.light_levels = std::min(settings.light_levels, 3);
  return settings;
}

LensCalibration lens_as_designed(const twins::camera::CameraSettings& camera, const twins::camera::Region& region) {
  LensCalibration lens;
  lens.width_px = region.width;
  lens.height_px = region.height;
  lens.fx_px = lens.fy_px = camera.focal_length_px();
  lens.cx_px = camera.optics.principal_point_px[0] - region.x;
  lens.cy_px = camera.optics.principal_point_px[1] - region.y;
  lens.distortion = camera.optics.distortion;
  return lens;
}

LightShares board_lights(const TestbedDesign& file, double lamp_azimuth_rad) {
  LightShares shares;
  shares.lamp = 1.0;
  shares.lamp_azimuth_rad = lamp_azimuth_rad;
  // A box behind the board would shine into the camera.
  for (std::size_t k = 0; k < kBoxes; ++k)
    shares.boxes[k] = file.boxes.boxes[k].centre_m.x() < file.lamp.centre_m.x() ? 1.0 : 0.0;
  return shares;
}

Measurement measure_board(CalibrationTestbed& bench, const BoardDesign& board, double& exposure_s) {
  const MeasuredPosture place = bench.measure();
  Measurement measurement;
  measurement.posture = place.posture;
  measurement.vicon = place.vicon;
  const double first_s = exposure_s;
  for (const double factor : {1.0, 4.0, 0.25, 16.0, 0.0625}) {
    double next_s = std::clamp(first_s * factor, kExposureLow_s, kExposureHigh_s);
    Seen seen = look(bench, board, next_s);
    if (seen.corners.empty()) continue;
    for (int k = 0; k < 3 && (seen.white < kLow || seen.white > kHigh); ++k) {
      next_s = std::clamp(next_s * (seen.white > kHigh ? 0.5 : kWanted / std::max(seen.white, 0.02)), kExposureLow_s,
                          kExposureHigh_s);
      Seen again = look(bench, board, next_s);
      if (again.corners.size() < seen.corners.size() / 2) break;
      seen = std::move(again);
    }
    measurement.corners = std::move(seen.corners);
    exposure_s = next_s;
    return measurement;
  }
  return measurement;
}

CalibrationData measure_testbed(CalibrationTestbed& bench, const TestbedDesign& file, const LensCalibration& lens,
                                const ProcedureSettings& settings, const PostureFilter& filter,
                                const Progress& progress) {
  const BoardDesign board;
  // Chosen first: a testbed that has no such postures is not moved at all.
  const auto fitted = choose_postures(file, lens, board, settings.fitted, settings.seed, {}, filter);
  const auto judged = choose_postures(file, lens, board, settings.judged, settings.seed + 1'000'003, {}, filter);
  std::vector<PatchPosture> patches;
  if (settings.light_levels > 0)
    patches = choose_patch_postures(file, lens, board, settings.lamp_azimuth_rad, settings.seed, filter);
  CalibrationData data;
  data.width_px = lens.width_px;
  data.height_px = lens.height_px;
  const TestbedIdentity identity = bench.identity();
  data.validity.bench = file.name;
  data.validity.emulated = identity.is_emulated;
  data.validity.seed = settings.seed;
  data.validity.camera_model = identity.camera_model;
  data.validity.camera_serial = identity.camera_serial;
  bench.mount(Mounted::kBoard);
  double exposure_s = settings.exposure_s;
  bench.light(board_lights(file, settings.lamp_azimuth_rad));
  data.fitted = measure_all(bench, board, fitted, "to be fitted", exposure_s, progress);
  data.judged = measure_all(bench, board, judged, "to be judged", exposure_s, progress);
  if (settings.light_levels > 0) {
    data.lights = measure_all_lights(bench, file, lens, settings, patches, filter, progress);
    data.dark = measure_dark(bench, 1e-3);
    if (progress)
      progress(fmt::format("{} levels of light; camera: offset {:.2f} DN, noise {:.2f} DN", data.lights.size(),
                           data.dark.offset_dn, data.dark.read_noise_dn));
  }
  bench.light({});
  bench.mount(Mounted::kTarget);
  return data;
}

TestbedFit calibrate(const CalibrationData& data, const TestbedDesign& file, const LensCalibration& lens,
                     const std::string& data_sha256, const Progress& progress) {
  if (data.validity.bench != file.name)
    throw std::runtime_error(
        fmt::format("the data are of the bench {}, the bench file is of {}", data.validity.bench, file.name));
  TestbedFit fit = fit_testbed(file, lens, {data.fitted, data.judged}, progress);
  Calibration& calibration = fit.calibration;
  calibration.validity = data.validity;
  calibration.validity.data_sha256 = data_sha256;
  calibration.lights = light_tables(data.lights);
  calibration.camera = {data.bits, data.dark.offset_dn, data.dark.read_noise_dn, lamp_dn_per_s(data.lights)};
  return fit;
}

namespace {

constexpr int kMinPoses = 5;

/// Medians of the calibration's own fused poses; those of the paper where the file has none.
ErrorFigures reached(const Calibration& calibration) {
  for (const StageFigures& stage : calibration.figures)
    if (stage.stage == "fused") return stage.board;
  ErrorFigures paper;
  paper.translation_median_mm = 2.9;
  paper.rotation_median_deg = 0.35;
  paper.pixel_median_px = 2.0;
  return paper;
}

}  // namespace

CheckResult judge(const Calibration& calibration, const TestbedDesign& file,
                  const std::vector<Measurement>& measurements) {
  CheckResult result;
  const ErrorFigures before = reached(calibration);
  result.translation_limit_mm = 2.0 * before.translation_median_mm + 1.0;
  result.rotation_limit_deg = 2.0 * before.rotation_median_deg + 0.1;
  result.pixel_limit_px = 2.0 * before.pixel_median_px + 0.5;
  std::vector<Measurement> ordered = measurements;
  for (Measurement& measurement : ordered) {
    if (!measurement.vicon) continue;
    const auto as_calibrated = [&](const Eigen::Isometry3d& pose) {
      return reordered(pose, file.vicon.rotation, calibration.vicon.rotation);
    };
    measurement.vicon =
        ViconObjects{as_calibrated(measurement.vicon->T_V_camera), as_calibrated(measurement.vicon->T_V_target)};
  }
  result.fused = evaluate(calibration, Source::kFused, BoardDesign{}, T_target_board(file), ordered);
  result.figures = figures_of("check", result.fused);
  result.beyond_gate = static_cast<int>(std::ranges::count_if(
      result.fused, [](const EvaluatedPose& pose) { return pose.sources == FusionSources::kArmsAlone; }));
  const ErrorFigures& now = result.figures.board;
  if (result.figures.poses < kMinPoses)
    result.reason = fmt::format("board and motion capture were seen at {} postures, {} are needed",
                                result.figures.poses, kMinPoses);
  else if (!(now.translation_median_mm <= result.translation_limit_mm))
    result.reason =
        fmt::format("translation {:.2f} mm, limit {:.2f} mm", now.translation_median_mm, result.translation_limit_mm);
  else if (!(now.rotation_median_deg <= result.rotation_limit_deg))
    result.reason =
        fmt::format("rotation {:.3f} deg, limit {:.3f} deg", now.rotation_median_deg, result.rotation_limit_deg);
  else if (!(now.pixel_median_px <= result.pixel_limit_px))
    result.reason = fmt::format("pixels {:.2f} px, limit {:.2f} px", now.pixel_median_px, result.pixel_limit_px);
  else if (4 * result.beyond_gate > result.figures.poses)
    result.reason =
        fmt::format("arms and motion capture disagree at {} of {} postures", result.beyond_gate, result.figures.poses);
  result.is_valid = result.reason.empty();
  return result;
}

CheckResult check(CalibrationTestbed& bench, const TestbedDesign& file, const Calibration& calibration, int poses,
                  std::uint64_t seed, const PostureFilter& filter, const Progress& progress) {
  const ProcedureSettings settings;
  const BoardDesign board;
  const auto postures = choose_postures(file, calibration.lens, board, poses, seed + 2'000'003, {}, filter);
  bench.mount(Mounted::kBoard);
  bench.light(board_lights(file, settings.lamp_azimuth_rad));
  double exposure_s = settings.exposure_s;
  std::vector<Measurement> measurements;
  for (const Posture& posture : postures)
    if (bench.move(posture)) measurements.push_back(measure_board(bench, board, exposure_s));
  bench.light({});
  bench.mount(Mounted::kTarget);
  if (progress) progress(fmt::format("{} of {} postures measured", measurements.size(), postures.size()));
  return judge(calibration, file, measurements);
}

}  // namespace vbar::tron::calibrate
