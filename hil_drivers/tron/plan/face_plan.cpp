#include "hil_drivers/tron/plan/face_plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

namespace vbar::tron {
namespace {

constexpr double kCorrection_rad = 0.2 * std::numbers::pi / 180.0;
constexpr double kCorrection_m = 0.002;

Posture home_of(const BenchFile& bench) {
  return {Joints::Map(bench.camera_robot.home_rad.data()), Joints::Map(bench.target_robot.home_rad.data()),
          bench.track.home_m};
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

double quantile(std::vector<double> sample, double share) {
  if (sample.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(sample);
  const double place = share * static_cast<double>(sample.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sample.size() - 1);
  return sample[below] + (place - static_cast<double>(below)) * (sample[above] - sample[below]);
}

double correction_s_of(const BenchFile& bench) {
  const Posture from = home_of(bench);
  Posture to = from;
  to.camera_rad.array() += kCorrection_rad;
  to.target_rad.array() += kCorrection_rad;
  to.carriage_m += kCorrection_m;
  return rest_to_rest_s(1.0, AxisLimitsOfBench(bench).of(from, to));
}

FacePlan plan_face(const BenchFile& designed, MountFace face, std::span<const SceneAhead> scenes,
                   const std::vector<std::size_t>& blocks, const PlacementSettings& settings,
                   const std::filesystem::path& data_directory, const PlanProgress& progress) {
  BenchFile bench = designed;
  bench.target.face = face;
  const BenchBodies bodies(bench);
  const PathPlanner paths(bench, bodies);
  const PlacementSearch search(bench, bodies, paths, bodies.points_to_see(data_directory), settings);
  const ImageTimes times{.correction_s = correction_s_of(bench)};
  FacePlan plan;
  plan.face = face;
  Posture at = home_of(bench);
  std::optional<double> lamp_rad;
  bool is_first = true;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    if (std::ranges::find(blocks, k) != blocks.end()) is_first = true;
    if (progress && progress(static_cast<double>(k) / static_cast<double>(scenes.size()))) break;
    const SceneAhead& ahead = scenes[k];
    if (!(ahead.scene.sunlit > 0.0)) continue;
    ++plan.images;
    const auto started = std::chrono::steady_clock::now();
    const auto found = search.find(ahead.scene, at, static_cast<std::int64_t>(k), lamp_rad);
    plan.wall_s.push_back(seconds_since(started));
    if (const auto* none = std::get_if<NoPlacement>(&found)) {
      plan.failures.emplace_back(k, none->reason);
      continue;
    }
    const auto& placement = std::get<Placement>(found);
    plan.detours += paths.is_straight_free(at, placement.posture) ? 0 : 1;
    ++plan.taken;
    plan.clear += placement.hidden == 0 ? 1 : 0;
    plan.sun_error_max_rad = std::max(plan.sun_error_max_rad, placement.sun_error_rad);
    if (!is_first) {
      plan.move_s.push_back(placement.move_s);
      plan.bench_s.push_back(placement.move_s + times.settling_s + times.correction_s + ahead.exposure_s);
    }
    is_first = false;
    at = placement.posture;
    lamp_rad = placement.lamp_azimuth_rad;
  }
  return plan;
}

}  // namespace vbar::tron
