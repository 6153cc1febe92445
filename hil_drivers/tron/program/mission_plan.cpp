#include "hil_drivers/tron/program/mission_plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "hil_drivers/tron/motion_planning/arm_planner.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/ideal_navigation_kind.h"
#include "host_sim/simulation/assembly.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/twins/camera/exposure.h"

namespace vbar::tron {

namespace {

/// Notes what a camera would see, and delivers nothing.
class SceneTap final : public twins::PacketSource {
 public:
  struct Settings {
    twins::camera::CameraMount mount;
    std::string model;  ///< CAD model of the target
    fsw::GpsTime epoch;
    engine::Cadence images{fsw::GpsTime{}, fsw::duration_of_seconds(60)};
    double exposure_s = 0.0, scale = 1.0;
  };
  SceneTap(Settings settings, std::vector<SceneAhead>& scenes) : settings_(std::move(settings)), scenes_(scenes) {}

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override {
    return settings_.images.next_at(from);
  }
  twins::Measurement measure(const twins::TruthSnapshot& truth) override {
    const auto exposure =
        twins::camera::exposure_of_truth(settings_.mount, truth, static_cast<std::int64_t>(scenes_.size()));
    if (const auto scene = scene_of(exposure, settings_.model, settings_.scale))
      scenes_.push_back({fsw::seconds(truth.time - settings_.epoch), settings_.exposure_s, *scene});
    twins::Measurement measurement;
    measurement.status = twins::MeasurementStatus::kReady;
    measurement.available = truth.time;
    return measurement;
  }

 private:
  Settings settings_;
  std::vector<SceneAhead>& scenes_;
};

/// The camera by whose images navigation finds the pose, otherwise the one whose images it uses, with a target that it
/// can see.
const sensors::CameraSensor& camera_of(const mission::Mission& mission, const mission::Spacecraft& servicer) {
  const sensors::CameraSensor* camera = sensors::first_camera_for(sensors::CameraSensor::kKeypoints, servicer);
  if (camera == nullptr) camera = sensors::navigation_camera(servicer);
  const mission::Spacecraft* target = camera != nullptr ? mission.find_spacecraft(camera->observed) : nullptr;
  if (target == nullptr || target->model.empty() || !target->attitude)
    throw mission::MissionError(mission.file.string(), "spacecraft.sensors", "no camera that navigates",
                                "a camera that navigates by a spacecraft with a model and an attitude");
  return *camera;
}

/// True states in the place of all sensors.
mission::Mission with_true_states(mission::Mission mission, const std::string& servicer, const std::string& observed) {
  for (mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (spacecraft.name != servicer) continue;
    auto navigation = std::make_shared<sensors::NavigationSensor>();
    navigation->source = "ideal";
    navigation->observed = observed;
    navigation->navigation = vbar::navigation_configuration::kUseIdeal;
    navigation->period = mission.step.shortest_period();
    spacecraft.sensors.clear();
    spacecraft.sensors.push_back({"navigation", std::string(sensors::kIdealNavigation.name), std::move(navigation)});
    spacecraft.flight_computer = mission::FlightComputer{};
  }
  mission.clock = {};
  mission.truth_source = mission::kTruthModel;
  return mission;
}

}  // namespace

std::vector<SceneAhead> fly_ahead(const mission::Mission& mission, const std::filesystem::path& data_directory,
                                  double scale, const std::function<void(fsw::Duration)>& progress,
                                  const std::function<bool()>& stop_requested) {
  const mission::Spacecraft& servicer = app::flying_spacecraft(mission);
  const sensors::CameraSensor& camera = camera_of(mission, servicer);
  const mission::Mission ideal = with_true_states(mission, servicer.name, camera.observed);
  std::vector<SceneAhead> scenes;
  const auto make_sources = [&](const mission::Mission& flown, const mission::Spacecraft& carrier,
                                const std::filesystem::path& data, twins::TruthOutlook* outlook) {
    sensors::MadeSources made = sensors::make_sources(flown, carrier, data, outlook);
    SceneTap::Settings settings{sensors::mount_of(mission, servicer, camera, data),
                                mission.find_spacecraft(camera.observed)->model,
                                mission.epoch,
                                camera.images,
                                camera.settings.exposure_s,
                                scale};
    made.sources.push_back({"scenes", "digital", std::make_unique<SceneTap>(std::move(settings), scenes)});
    return made;
  };
  app::AssembledMission assembled(ideal, data_directory, make_sources);
  const auto computer = app::connect_flight_computer(app::flying_spacecraft(ideal));
  const auto wall = mission::make_wall_clock(ideal, sensors::installation());
  report::RunRecord record;
  record.extensions = sensors::extensions();
  if (assembled.fly({*computer, *wall, {}, progress, stop_requested}, record)) computer->close();
  return scenes;
}

namespace {

constexpr double kCorrection_rad = 0.2 * std::numbers::pi / 180.0;
constexpr double kCorrection_m = 0.002;

Posture home_of(const TestbedDesign& bench) {
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

double correction_s_of(const TestbedDesign& bench) {
  const Posture from = home_of(bench);
  Posture to = from;
  to.camera_rad.array() += kCorrection_rad;
  to.target_rad.array() += kCorrection_rad;
  to.carriage_m += kCorrection_m;
  return rest_to_rest_s(1.0, TestbedAxisLimits(bench).of(from, to));
}

FacePlan plan_face(const TestbedDesign& designed, MountFace face, std::span<const SceneAhead> scenes,
                   const std::vector<std::size_t>& blocks, const PlacementSettings& settings,
                   const std::filesystem::path& data_directory, const PlanProgress& progress) {
  TestbedDesign bench = designed;
  bench.target.face = face;
  const TestbedBodies bodies(bench);
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
