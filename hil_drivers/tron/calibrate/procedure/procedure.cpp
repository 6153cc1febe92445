#include "hil_drivers/tron/calibrate/procedure/procedure.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/tron/calibrate/procedure/photometry.h"
#include "hil_drivers/tron/calibrate/vision/corner_detection.h"

namespace vbar::tron::calibrate {
namespace {

constexpr double kLow = 0.2, kHigh = 0.9, kWanted = 0.6;  ///< white of the board, of the largest value
constexpr double kExposureLow_s = 2e-5, kExposureHigh_s = 1.0;

/// The white of the board: 90 % of the pixels within the box of its corners are darker.
double white_of(const BenchImage& image, const std::vector<Corner>& corners) {
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

Seen look(CalibrationBench& bench, const BoardDesign& board, double exposure_s) {
  const BenchImage image = bench.take(exposure_s);
  Seen seen;
  seen.corners = detect_corners({image.width, image.height, image.dn}, board);
  if (!seen.corners.empty()) seen.white = white_of(image, seen.corners);
  return seen;
}

std::vector<Measurement> measure_all(CalibrationBench& bench, const BoardDesign& board,
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
std::vector<LightSample> measure_all_lights(CalibrationBench& bench, const BenchFile& file, const LensCalibration& lens,
                                            const ProcedureSettings& settings, std::vector<PatchPosture> patches,
                                            const PostureFilter& filter, const Progress& progress) {
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

LightShares board_lights(const BenchFile& file, double lamp_azimuth_rad) {
  LightShares shares;
  shares.lamp = 1.0;
  shares.lamp_azimuth_rad = lamp_azimuth_rad;
  // A box behind the board would shine into the camera.
  for (std::size_t k = 0; k < kBoxes; ++k)
    shares.boxes[k] = file.boxes.boxes[k].centre_m.x() < file.lamp.centre_m.x() ? 1.0 : 0.0;
  return shares;
}

Measurement measure_board(CalibrationBench& bench, const BoardDesign& board, double& exposure_s) {
  const BenchPlace place = bench.measure();
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

CalibrationData measure_bench(CalibrationBench& bench, const BenchFile& file, const LensCalibration& lens,
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
  const BenchIdentity identity = bench.identity();
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

BenchFit calibrate(const CalibrationData& data, const BenchFile& file, const LensCalibration& lens,
                   const std::string& data_sha256, const Progress& progress) {
  if (data.validity.bench != file.name)
    throw std::runtime_error(
        fmt::format("the data are of the bench {}, the bench file is of {}", data.validity.bench, file.name));
  BenchFit fit = fit_bench(file, lens, {data.fitted, data.judged}, progress);
  Calibration& calibration = fit.calibration;
  calibration.validity = data.validity;
  calibration.validity.data_sha256 = data_sha256;
  calibration.lights = light_tables(data.lights);
  calibration.camera = {data.bits, data.dark.offset_dn, data.dark.read_noise_dn, lamp_dn_per_s(data.lights)};
  return fit;
}

}  // namespace vbar::tron::calibrate
