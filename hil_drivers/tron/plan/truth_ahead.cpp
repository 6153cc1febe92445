#include "hil_drivers/tron/plan/truth_ahead.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "hil_drivers/tron/scene/scene_of_exposure.h"
#include "host_sim/app/assemble.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/ideal_navigation/ideal_navigation_kind.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/twins/camera/exposure_of_truth.h"

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

}  // namespace vbar::tron
