#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "hil_drivers/tron/motion_planning/arm_planner.h"
#include "hil_drivers/tron/motion_planning/placement.h"
#include "hil_drivers/tron/program/commands.h"
#include "host_sim/files/output_file.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/ideal_navigation_kind.h"
#include "host_sim/simulation/assembly.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/run_control.h"
#include "host_sim/twins/camera/exposure.h"

namespace vbar::tron {
namespace {

// Share of a mission's images that a testbed can show if it holds the target by one of its faces.

// Scenes of a mission's camera, from the mission's truth flown ahead.

/// Holds an image that is due.
struct SceneAhead {
  double time_s = 0.0;  ///< since the mission's epoch
  double exposure_s = 0.0;
  Scene scene;
};

/// Flies the mission ahead of time in this program: true states take the place of its sensors, so that its maneuvers
/// and pointing are those of a flight without errors of navigation. The navigation camera is not exposed; its scenes
/// are noted, lengths times `scale`. Throws mission::MissionError if no camera navigates by another spacecraft or that
/// has no model, and what the truth throws. `stop_requested` ends it early.
[[nodiscard]] std::vector<SceneAhead> fly_ahead(const mission::Mission& mission,
                                                const std::filesystem::path& data_directory, double scale,
                                                const std::function<void(fsw::Duration)>& progress,
                                                const std::function<bool()>& stop_requested);

struct FacePlan {
  MountFace face = MountFace::kBottom;
  int images = 0;  ///< sunlit
  int clear = 0;   ///< nothing hidden
  int taken = 0;   ///< at most the accepted number of points hidden
  double sun_error_max_rad = 0.0;
  std::vector<double> move_s, bench_s;                        ///< durations of the images taken
  std::vector<double> wall_s;                                 ///< durations of the search, of all images
  int detours = 0;                                            ///< paths over a retracted posture
  std::vector<std::pair<std::size_t, std::string>> failures;  ///< index of the image, reason

  [[nodiscard]] double share(int count) const { return images > 0 ? static_cast<double>(count) / images : 0.0; }
};

/// Holds the bench time of an image beside its move and its exposure.
struct ImageTimes {
  double settling_s = 0.5;
  double correction_s = 0.0;  ///< duration of one correction, see correction_s_of
};

/// Returns the duration of a correction by 0.2 deg of every axis and 2 mm of the carriage, s: arms as mastered,
/// calibrated.
[[nodiscard]] double correction_s_of(const TestbedDesign& bench);

/// Receives the `share` done, 0 to 1; true ends the search early.
using PlanProgress = std::function<bool(double share)>;

/// Places the sunlit scenes one after the other, each from where the arms stand, from the home posture on. A jump in
/// `blocks` (begin of each; empty: one) begins at a posture that fits, at no cost.
[[nodiscard]] FacePlan plan_face(const TestbedDesign& bench, MountFace face, std::span<const SceneAhead> scenes,
                                 const std::vector<std::size_t>& blocks, const PlacementSettings& settings,
                                 const std::filesystem::path& data_directory, const PlanProgress& progress = {});

/// Returns the quantile of a sample, linear between its values; NaN if it is empty.
[[nodiscard]] double quantile(std::vector<double> sample, double share);

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

constexpr double kCorrection_rad = 0.2 * std::numbers::pi / 180.0;
constexpr double kCorrection_m = 0.002;

Posture home_of(const TestbedDesign& bench) {
  return {Joints::Map(bench.camera_robot.home_rad.data()), Joints::Map(bench.target_robot.home_rad.data()),
          bench.track.home_m};
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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

constexpr double kDegree = 0.017453292519943295;
/// With a stride: images in a row, so that moves from one to the next stay as they are.
constexpr std::size_t kBlock = 20;

struct FaceName {
  const char* name;
  MountFace face;
};
constexpr std::array<FaceName, 6> kFaceNames{{{"-x", MountFace::kMinusX},
                                              {"+x", MountFace::kPlusX},
                                              {"-y", MountFace::kMinusY},
                                              {"+y", MountFace::kPlusY},
                                              {"bottom", MountFace::kBottom},
                                              {"top", MountFace::kTop}}};

struct Options {
  std::filesystem::path mission, bench, json;
  std::vector<std::string> overrides;
  std::vector<std::string> faces;  ///< empty: all
  std::size_t stride = 1;
  int trials = PlacementSettings{}.trials;
  bool quiet = false;
};

const char* name_of(MountFace face) {
  for (const FaceName& one : kFaceNames)
    if (one.face == face) return one.name;
  return "";
}

std::vector<MountFace> faces_of(const Options& options) {
  std::vector<MountFace> faces;
  for (const FaceName& one : kFaceNames)
    if (options.faces.empty() || std::ranges::find(options.faces, one.name) != options.faces.end())
      faces.push_back(one.face);
  return faces;
}

/// Returns the first of every `stride` blocks of images.
std::vector<SceneAhead> sample_of(const std::vector<SceneAhead>& scenes, std::size_t stride,
                                  std::vector<std::size_t>& blocks) {
  std::vector<SceneAhead> sample;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    if ((k / kBlock) % stride != 0) continue;
    if (stride > 1 && k % kBlock == 0) blocks.push_back(sample.size());
    sample.push_back(scenes[k]);
  }
  return sample;
}

void print_plan(const FacePlan& plan, const TestbedDesign& bench) {
  const auto percent = [&](int count) { return 100.0 * plan.share(count); };
  fmt::print("{:<7} {:>6} {:>7.1f} {:>9.1f} {:>12.1f} {:>6.2f} {:>6.2f} {:>7.2f} {:>6.2f} {:>8.2f} {:>6.2f}{}\n",
             name_of(plan.face), plan.images, percent(plan.clear), percent(plan.taken),
             percent(plan.images - plan.taken), quantile(plan.move_s, 0.5), quantile(plan.move_s, 0.95),
             quantile(plan.bench_s, 0.5), quantile(plan.bench_s, 0.95), plan.sun_error_max_rad / kDegree,
             1e3 * quantile(plan.wall_s, 0.5), plan.face == bench.target.face ? "  (as the bench file has it)" : "");
}

nlohmann::ordered_json json_of(const FacePlan& plan) {
  nlohmann::ordered_json json;
  json["face"] = name_of(plan.face);
  json["sunlit_images"] = plan.images;
  json["clear_share"] = plan.share(plan.clear);
  json["taken_share"] = plan.share(plan.taken);
  json["not_reproducible_share"] = plan.share(plan.images - plan.taken);
  const auto figures = [&](const char* name, const std::vector<double>& sample) {
    if (sample.empty()) return;
    json[name] = {{"median", quantile(sample, 0.5)}, {"p95", quantile(sample, 0.95)}, {"max", quantile(sample, 1.0)}};
  };
  figures("move_s", plan.move_s);
  figures("bench_s", plan.bench_s);
  json["sun_error_max_deg"] = plan.sun_error_max_rad / kDegree;
  json["detours"] = plan.detours;
  json["failures"] = nlohmann::ordered_json::array();
  for (const auto& [image, reason] : plan.failures) json["failures"].push_back({{"image", image}, {"reason", reason}});
  return json;
}

int plan_command(const Options& options) {
  const std::filesystem::path data = mission::data_directory();
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  const TestbedDesign bench = read_testbed_design(options.bench);
  app::catch_stop_signals();
  std::vector<SceneAhead> scenes;
  {
    app::ProgressLine progress(mission.duration, options.quiet);
    scenes = fly_ahead(
        mission, data, bench.scale, [&](fsw::Duration simulated) { progress.update(simulated); }, app::stop_requested);
  }
  if (app::stop_requested()) return app::kInterrupted;
  std::vector<std::size_t> blocks;
  const std::vector<SceneAhead> sample = sample_of(scenes, options.stride, blocks);
  PlacementSettings settings;
  settings.trials = options.trials;
  settings.seed = mission.seed;
  if (!options.quiet) {
    fmt::print("{} images in {:.2f} h; {} of them planned; {} trials each\n", scenes.size(),
               fsw::seconds(mission.duration) / 3600.0, sample.size(), settings.trials);
    fmt::print("{:<7} {:>6} {:>7} {:>9} {:>12} {:>13} {:>14} {:>8} {:>6}\n", "face", "sunlit", "clear", "at most 3",
               "not", "move s", "bench s", "Sun deg", "plan");
    fmt::print("{:<7} {:>6} {:>7} {:>9} {:>12} {:>6} {:>6} {:>7} {:>6} {:>8} {:>6}\n", "", "images", "%", "hidden %",
               "reproduced %", "median", "95 %", "median", "95 %", "max", "ms");
  }
  nlohmann::ordered_json json;
  json["mission"] = mission.name;
  json["seed"] = mission.seed;
  json["bench"] = bench.name;
  json["images"] = sample.size();
  json["trials"] = settings.trials;
  json["faces"] = nlohmann::ordered_json::array();
  for (const MountFace face : faces_of(options)) {
    const FacePlan plan =
        plan_face(bench, face, sample, blocks, settings, data, [](double) { return app::stop_requested(); });
    if (app::stop_requested()) return app::kInterrupted;
    print_plan(plan, bench);
    std::fflush(stdout);
    json["faces"].push_back(json_of(plan));
  }
  if (!options.json.empty()) files::replace_text_file(options.json, json.dump(2) + "\n");
  return app::kDone;
}

}  // namespace

void add_plan_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("plan", "which of a mission's images a bench can show, for each face of the target");
  command->add_option("mission", options->mission, "mission file (TOML), or a name that vbar missions lists")
      ->required();
  command->add_option("bench", options->bench, "bench file (TOML)")->required();
  command->add_option("--set", options->overrides, "a key of the mission file and its value; may be given again")
      ->allow_extra_args(false);
  std::vector<std::string> names;
  for (const FaceName& one : kFaceNames) names.emplace_back(one.name);
  command->add_option("--face", options->faces, "a face to plan; may be given again; by default all six")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names));
  command->add_option("--stride", options->stride, fmt::format("of N blocks of {} images plan one", kBlock))
      ->check(CLI::PositiveNumber);
  command->add_option("--trials", options->trials, "placements tried for an image")->check(CLI::Range(1, 1000000));
  command->add_option("--json", options->json, "file for the same figures");
  command->add_flag("--quiet", options->quiet, "no heading and no progress");
  command->callback([options, &exit_code] { exit_code = plan_command(*options); });
}

}  // namespace vbar::tron
