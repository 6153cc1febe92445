#include "hil_drivers/tron/bench/scene/lab_renderer.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "hil_drivers/tron/bench/scene/lab_drawing.h"
#include "hil_drivers/tron/bench/scene/lens_blur.h"
#include "hil_drivers/tron/bench/scene/lens_map.h"
#include "hil_drivers/tron/bench/scene/view_check.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::tron::bench {
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
  Stage(const BenchFile& bench, const GapSettings& switches, std::uint64_t number, const std::filesystem::path& data)
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

LabRenderer::LabRenderer(const BenchFile& bench, const GapSettings& gap, std::uint64_t seed,
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
