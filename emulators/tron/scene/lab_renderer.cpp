#include "emulators/tron/scene/lab_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>

#include "emulators/tron/scene/lab_drawing.h"
#include "emulators/tron/scene/lab_view.h"
#include "emulators/tron/scene/radiometry.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::tron::bench {

namespace {

constexpr int kCoarse = kCoarseStep;

std::size_t at(const Plane& plane, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(plane.width) + static_cast<std::size_t>(x);
}

void add_scaled(float factor, const float* from, std::size_t count, float* to) {
  for (std::size_t k = 0; k < count; ++k) to[k] += factor * from[k];
}

void resize_to(const Plane& like, Plane& plane) {
  plane.width = like.width;
  plane.height = like.height;
  plane.values.resize(like.values.size());
}

void spread(const std::vector<float>& taps, Plane& plane, Plane& work) {
  resize_to(plane, work);
  const int reach = static_cast<int>(taps.size()) - 1;
  for (int y = 0; y < plane.height; ++y) {
    float* const out = &work.values[at(work, 0, y)];
    std::fill_n(out, plane.width, 0.0F);
    for (int k = std::max(-reach, -y); k <= std::min(reach, plane.height - 1 - y); ++k)
      add_scaled(taps[static_cast<std::size_t>(std::abs(k))], &plane.values[at(plane, 0, y + k)],
                 static_cast<std::size_t>(plane.width), out);
  }
  for (int y = 0; y < plane.height; ++y) {
    const float* const row = &work.values[at(work, 0, y)];
    float* const out = &plane.values[at(plane, 0, y)];
    std::fill_n(out, plane.width, 0.0F);
    for (int k = -reach; k <= reach; ++k) {
      const int begin = std::max(0, -k), end = std::min(plane.width, plane.width - k);
      if (begin < end)
        add_scaled(taps[static_cast<std::size_t>(std::abs(k))], row + begin + k, static_cast<std::size_t>(end - begin),
                   out + begin);
    }
  }
}

void gather(const Plane& fine, Plane& coarse) {
  coarse.width = (fine.width + kCoarse - 1) / kCoarse;
  coarse.height = (fine.height + kCoarse - 1) / kCoarse;
  coarse.values.assign(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height), 0.0F);
  for (int y = 0; y < fine.height; ++y) {
    const float* const row = &fine.values[at(fine, 0, y)];
    float* const out = &coarse.values[at(coarse, 0, y / kCoarse)];
    for (int x = 0; x < fine.width; ++x) out[x / kCoarse] += row[x] / (kCoarse * kCoarse);
  }
}

}  // namespace

void mix_coarse(const Plane& coarse, float keep, float share, Plane& fine) {
  for (int y = 0; y < fine.height; ++y) {
    const float v = (static_cast<float>(y) + 0.5F) / kCoarse - 0.5F;
    const int j = static_cast<int>(std::floor(v));
    const float down = v - static_cast<float>(j);
    const float* const upper = &coarse.values[at(coarse, 0, std::max(j, 0))];
    const float* const lower = &coarse.values[at(coarse, 0, std::min(j + 1, coarse.height - 1))];
    float* const out = &fine.values[at(fine, 0, y)];
    for (int x = 0; x < fine.width; ++x) {
      const int i = (x + kCoarse / 2) / kCoarse - 1;
      const float across = (static_cast<float>(x) + 0.5F) / kCoarse - 0.5F - static_cast<float>(i);
      const int left = std::max(i, 0), right = std::min(i + 1, coarse.width - 1);
      const float top = upper[left] + across * (upper[right] - upper[left]);
      const float bottom = lower[left] + across * (lower[right] - lower[left]);
      out[x] = keep * out[x] + share * (top + down * (bottom - top));
    }
  }
}

double defocus_diameter_px(const twins::camera::CameraSettings& settings, double distance_m) {
  const double focal_m = 1e-3 * settings.optics.focal_length_mm, pupil_m = focal_m / settings.optics.f_number;
  // Image distances by the thin lens, compared at the detector, which is where kFocusDistanceM is sharp.
  const double diameter_m =
      pupil_m * focal_m * std::abs(1.0 / kFocusDistanceM - 1.0 / distance_m) / (1.0 - focal_m / kFocusDistanceM);
  return diameter_m / (1e-6 * settings.detector.pixel_pitch_um);
}

std::vector<float> gaussian_taps(double sigma) {
  const double wanted = sigma * sigma;
  double width2 = wanted;
  std::vector<double> weights;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const int reach = std::max(1, static_cast<int>(std::ceil(4.5 * std::sqrt(width2))));
    weights.assign(static_cast<std::size_t>(reach) + 1, 0.0);
    double sum = 0.0, variance = 0.0;
    for (int k = 0; k <= reach; ++k) {
      const double weight = std::exp(-0.5 * k * k / width2);
      weights[static_cast<std::size_t>(k)] = weight;
      sum += k == 0 ? weight : 2.0 * weight;
      variance += 2.0 * k * k * weight;
    }
    variance /= sum;
    for (double& weight : weights) weight /= sum;
    if (std::abs(variance - wanted) < 1e-9) break;
    width2 = std::clamp(width2 * wanted / std::max(variance, 1e-12), 0.01, 1e4);
  }
  return {weights.begin(), weights.end()};
}

void LensBlur::blur(const twins::camera::OpticsSettings& optics, double defocus_px, Plane& plane) {
  const double core2 = optics.point_spread_sigma_px * optics.point_spread_sigma_px + defocus_px * defocus_px / 16.0;
  if (optics.halo_fraction > 0.0) {
    gather(plane, coarse_);
    // Cells and the interpolation between them widen by (1/12 + 1/6) of a cell's square.
    const double halo2 = optics.halo_sigma_px * optics.halo_sigma_px / (kCoarse * kCoarse) - 0.25;
    if (halo2 > 0.02) spread(gaussian_taps(std::sqrt(halo2)), coarse_, coarse_half_);
  }
  spread(gaussian_taps(std::sqrt(core2)), plane, across_);
  if (optics.halo_fraction > 0.0)
    mix_coarse(coarse_, static_cast<float>(1.0 - optics.halo_fraction), static_cast<float>(optics.halo_fraction),
               plane);
}

namespace {

namespace camera = twins::camera;

constexpr const char* kSensorName = "tron_bench/camera";
constexpr int kMarginPx = 16;  // light from beside the region that reaches into it

camera::Region grown(const camera::Region& region) {
  const auto whole = [](int length) { return (length + 2 * kMarginPx + kCoarseStep - 1) / kCoarseStep * kCoarseStep; };
  return {region.x - kMarginPx, region.y - kMarginPx, whole(region.width), whole(region.height)};
}

/// A fifth of a mission: nothing has to be drawn.
bool is_dark(const LabView& view) {
  return view.lamp.power == 0.0 && std::ranges::all_of(view.box_powers, [](double power) { return power == 0.0; });
}

camera::DetectorSettings sensor_of(const camera::DetectorSettings& design, bool has_gap) {
  camera::DetectorSettings sensor = design;
  if (!has_gap) sensor.photo_response_nonuniformity = camera::DetectorSettings{}.photo_response_nonuniformity;
  return sensor;
}

bool same_sensor(const camera::CameraSettings& a, const camera::CameraSettings& b) {
  const auto &p = a.detector, &q = b.detector;
  return a.region == b.region && a.exposure_s == b.exposure_s && p.full_well_electrons == q.full_well_electrons &&
         p.gain_dn_per_electron == q.gain_dn_per_electron && p.bits == q.bits && p.offset_dn == q.offset_dn &&
         p.read_noise_electrons == q.read_noise_electrons && p.dark_electrons_per_s == q.dark_electrons_per_s &&
         p.dark_nonuniformity == q.dark_nonuniformity &&
         p.photo_response_nonuniformity == q.photo_response_nonuniformity && p.hot_pixels == q.hot_pixels &&
         p.hot_pixel_electrons_per_s == q.hot_pixel_electrons_per_s && p.blooming_fraction == q.blooming_fraction;
}

}  // namespace

struct LabRenderer::Stage {
  Stage(const TestbedDesign& bench, const GapSettings& switches, std::uint64_t number,
        const std::filesystem::path& data)
      : gap(switches), seed(number), drawing(bench, switches, number, data) {}

  void electrons_of(const LabView& view, const camera::Region& area, double distance_m);
  camera::Detector& detector_of(const camera::CameraSettings& settings);

  GapSettings gap;
  std::uint64_t seed;
  LabDrawing drawing;
  std::optional<LensMap> lens_map;
  LensBlur lens_blur;
  Plane plane;
  camera::PhotonImage image;
  std::optional<camera::Detector> detector;
  camera::CameraSettings detector_settings;
};

// The plane of radiance becomes one of electrons.
void LabRenderer::Stage::electrons_of(const LabView& view, const camera::Region& area, double distance_m) {
  if (!lens_map || !lens_map->is_of(view.camera, area)) lens_map.emplace(view.camera, area);
  const std::vector<float>& map = lens_map->electrons_per_radiance();
  const auto factor = static_cast<float>(view.camera.exposure_s * drawing.unit());
  for (std::size_t k = 0; k < map.size(); ++k) plane.values[k] *= factor * map[k];
  lens_blur.blur(view.camera.optics, gap.focus ? defocus_diameter_px(view.camera, distance_m) : 0.0, plane);
}

camera::Detector& LabRenderer::Stage::detector_of(const camera::CameraSettings& settings) {
  camera::CameraSettings wanted = settings;
  wanted.detector = sensor_of(settings.detector, gap.detector);
  if (detector && same_sensor(wanted, detector_settings)) return *detector;
  const camera::Region all{0, 0, wanted.detector.width, wanted.detector.height};
  const auto hot_pixels = camera::draw_hot_pixels(wanted.detector, all, seed, kSensorName);
  detector.emplace(wanted, seed, kSensorName, hot_pixels);
  detector_settings = wanted;
  return *detector;
}

LabRenderer::LabRenderer(const TestbedDesign& bench, const GapSettings& gap, std::uint64_t seed,
                         const std::filesystem::path& data_directory)
    : stage_(std::make_unique<Stage>(bench, gap, seed, data_directory)) {}

LabRenderer::~LabRenderer() = default;

const camera::PhotonImage& LabRenderer::expected(const LabView& view) {
  check_view(view);
  Stage& s = *stage_;
  const camera::Region& region = view.camera.region;
  if (is_dark(view)) {
    s.image.region = region;
    s.image.electrons.assign(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height), 0.0F);
    return s.image;
  }
  const camera::Region area = grown(region);
  const double distance_m = s.drawing.draw(view, area, s.plane);
  s.electrons_of(view, area, distance_m);
  s.image.region = region;
  s.image.electrons.resize(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  double sum = 0.0;
  for (int y = 0; y < region.height; ++y) {
    const float* const from =
        &s.plane.values[static_cast<std::size_t>(y + kMarginPx) * static_cast<std::size_t>(area.width) +
                        static_cast<std::size_t>(kMarginPx)];
    float* const to = &s.image.electrons[static_cast<std::size_t>(y) * static_cast<std::size_t>(region.width)];
    float of_row = 0.0F;
    for (int x = 0; x < region.width; ++x) of_row += to[x] = from[x];
    sum += static_cast<double>(of_row);
  }
  if (s.gap.room) {
    const double pixels = static_cast<double>(view.camera.detector.width) * view.camera.detector.height;
    const auto glare = static_cast<float>(camera::kVeilingGlare * sum / pixels);
    for (float& electrons : s.image.electrons) electrons += glare;
  }
  return s.image;
}

std::vector<std::uint16_t> LabRenderer::expose(const LabView& view) {
  const camera::PhotonImage& image = expected(view);
  std::vector<std::uint16_t> dn;
  stage_->detector_of(view.camera).expose(image, view.frame, dn);
  return dn;
}

}  // namespace vbar::tron::bench
