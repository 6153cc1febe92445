#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/tron/program/commands.h"
#include "hil_drivers/tron/program/mission_plan.h"
#include "host_sim/files/output_file.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/load.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/run_control.h"

namespace vbar::tron {
namespace {

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
