#include "hil_drivers/tron/plan/plan.h"

#include <algorithm>
#include <chrono>
#include <numeric>

#include <fmt/format.h>

#include "hil_drivers/tron/motion/joint_path.h"

namespace vbar::tron {
namespace {

// Bench time of an image beside its moves: 25 cycles at rest before and again after the correction, twice 20 frames of
// motion capture at 100 Hz; a correction of a millimetre.
constexpr double kSettle_s = 0.14, kCapture_s = 0.22, kCorrection_s = 0.1;

double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

std::string_view name_of(MountFace face) {
  return std::ranges::find(kMountFaces, face, &std::pair<std::string_view, MountFace>::second)->first;
}

double percent(int part, int whole) {
  return whole > 0 ? 100.0 * part / whole : 0.0;
}

}  // namespace

Posture home_of(const BenchFile& bench) {
  Posture home;
  for (std::size_t k = 0; k < kJoints; ++k) {
    home.camera_rad(static_cast<Eigen::Index>(k)) = bench.camera_robot.home_rad[k];
    home.target_rad(static_cast<Eigen::Index>(k)) = bench.target_robot.home_rad[k];
  }
  home.carriage_m = bench.track.home_m;
  return home;
}

PlanFigures plan(const BenchFile& bench, const std::vector<Scene>& scenes, const PlacementSettings& settings,
                 const std::vector<fsw::Vector3>& keypoints_m, double exposure_s) {
  const auto begin = std::chrono::steady_clock::now();
  const Geometry geometry(bench);
  PlacementSearch search(geometry, settings, points_of_target(bench, keypoints_m));
  PlanFigures figures;
  figures.face = bench.target.face;
  Posture at = home_of(bench);
  std::int64_t number = 0;
  for (const Scene& scene : scenes) {
    const std::int64_t image = number++;
    if (scene.sunlit <= 0.0 && scene.earth_to_sun <= 1e-5) continue;
    ++figures.images;
    const auto found = search.find(scene, at, image);
    if (const auto* const none = std::get_if<NoPlacement>(&found)) {
      figures.refused.lamp += none->lamp;
      figures.refused.reach += none->reach;
      figures.refused.collision += none->collision;
      figures.refused.hidden += none->hidden;
      continue;
    }
    const auto& placement = std::get<Placement>(found);
    ++figures.feasible;
    if (placement.hidden == 0) ++figures.clear;
    figures.sun_error_max_rad = std::max(figures.sun_error_max_rad, placement.sun_error_rad);
    figures.move_s.push_back(placement.move_s);
    figures.bench_s.push_back(placement.move_s + 2.0 * (kSettle_s + kCapture_s) + kCorrection_s + exposure_s);
    at = placement.posture;
  }
  std::ranges::sort(figures.move_s);
  std::ranges::sort(figures.bench_s);
  figures.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return figures;
}

std::string plan_table(const std::vector<PlanFigures>& faces) {
  std::string text =
      fmt::format("{:8} {:>7} {:>10} {:>10} {:>16} {:>12} {:>12} {:>12} {:>10}\n", "face", "images", "clear",
                  "feasible", "not reproducible", "median (s)", "95 % (s)", "bench (min)", "Sun (deg)");
  for (const PlanFigures& face : faces)
    text +=
        fmt::format("{:8} {:>7} {:>8.1f} % {:>8.1f} % {:>16} {:>12.2f} {:>12.2f} {:>12.1f} {:>10.3f}\n",
                    name_of(face.face), face.images, percent(face.clear, face.images),
                    percent(face.feasible, face.images), face.images - face.feasible, quantile(face.bench_s, 0.5),
                    quantile(face.bench_s, 0.95), std::accumulate(face.bench_s.begin(), face.bench_s.end(), 0.0) / 60.0,
                    face.sun_error_max_rad * 57.29577951308232);
  return text;
}

}  // namespace vbar::tron
