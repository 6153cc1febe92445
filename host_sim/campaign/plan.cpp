#include "host_sim/campaign/plan.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/case_records.h"
#include "host_sim/campaign/copies.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/run_control.h"

namespace vbar::campaign {

void Folder::require_campaign() const {
  std::error_code error;
  if (!std::filesystem::is_regular_file(plan(), error))
    throw app::Refused(root_.string() +
                       ": is not the folder of a campaign; accepted: one that vbar campaign run FILE made");
  refuse_links();
}

void Folder::refuse_links() const {
  for (const std::filesystem::path& inner :
       {result_files(), attempt_files(), flying(), runs(), copies(), submissions()}) {
    std::error_code error;
    if (std::filesystem::is_symlink(std::filesystem::symlink_status(inner, error)))
      throw app::Refused(inner.string() +
                         ": is a symbolic link; accepted: a folder, or the whole campaign's folder behind a link");
  }
}

std::vector<std::filesystem::path> record_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

namespace {

constexpr int kFormat = 1;
constexpr std::array<std::pair<std::string_view, Keep::Kind>, 4> kKeepKinds{{{"summary", Keep::Kind::kSummary},
                                                                             {"failed", Keep::Kind::kFailed},
                                                                             {"worst", Keep::Kind::kWorst},
                                                                             {"all", Keep::Kind::kAll}}};

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const PassCriterion& pass) {
  return {{"key", pass.key}, {"most", json_of(pass.most)}, {"least", json_of(pass.least)}};
}

Json json_of(const std::optional<Requirement>& require) {
  if (!require) return nullptr;
  return {{"pass_rate_at_least", require->pass_rate}, {"confidence", require->confidence}};
}

Json json_of(const Keep& keep) {
  for (const auto& [name, kind] : kKeepKinds)
    if (kind == keep.kind) return {{"runs", name}, {"worst", keep.worst}};
  return nullptr;
}

std::optional<double> number(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

Keep keep_of(const Json& json) {
  for (const auto& [name, kind] : kKeepKinds)
    if (json.at("runs") == name) return {kind, json.at("worst").get<std::size_t>()};
  throw std::runtime_error("an unknown value of keep");
}

Plan plan_of_json(const Json& json) {
  if (json.at("format") != kFormat) throw std::runtime_error(fmt::format("format {} is expected", kFormat));
  Plan plan;
  json.at("name").get_to(plan.name);
  json.at("description").get_to(plan.description);
  json.at("mission").get_to(plan.mission);
  json.at("vbar_version").get_to(plan.vbar_version);
  json.at("program_sha256").get_to(plan.program_sha256);
  json.at("cases").get_to(plan.cases);
  json.at("cases_sha256").get_to(plan.cases_sha256);
  json.at("keys").get_to(plan.keys);
  json.at("swept").get_to(plan.swept);
  for (const Json& pass : json.at("pass"))
    plan.passes.push_back({pass.at("key").get<std::string>(), number(pass.at("most")), number(pass.at("least"))});
  json.at("samples_h").get_to(plan.samples_h);
  if (const Json& require = json.at("require"); !require.is_null())
    plan.require = Requirement{require.at("pass_rate_at_least").get<double>(), require.at("confidence").get<double>()};
  json.at("independent").get_to(plan.independent);
  json.at("mission_file").get_to(plan.mission_file);
  json.at("set").get_to(plan.set);
  plan.keep = keep_of(json.at("keep"));
  json.at("case_time_limit_s").get_to(plan.case_time_limit_s);
  json.at("expected_case_s").get_to(plan.expected_case_s);
  json.at("retries").get_to(plan.retries);
  json.at("stop_after_failures").get_to(plan.stop_after_failures);
  return plan;
}

}  // namespace

Plan plan_of(const CampaignFile& campaign) {
  Plan plan;
  plan.name = campaign.name;
  plan.description = campaign.description;
  plan.keys = campaign.keys();
  plan.swept = campaign.swept_keys();
  plan.passes = campaign.passes;
  plan.samples_h = campaign.samples_h;
  plan.require = campaign.require;
  plan.independent = campaign.sampling == DrawSource::Sampling::kIndependent;
  plan.set = campaign.set;
  plan.keep = campaign.keep;
  plan.case_time_limit_s = campaign.case_time_limit_s;
  plan.expected_case_s = campaign.expected_case_s;
  plan.retries = campaign.retries;
  plan.stop_after_failures = campaign.stop_after_failures;
  return plan;
}

std::string plan_json(const Plan& plan) {
  Json passes = Json::array();
  for (const PassCriterion& pass : plan.passes) passes.push_back(json_of(pass));
  const Json json{{"format", kFormat},
                  {"name", plan.name},
                  {"description", plan.description},
                  {"mission", plan.mission},
                  {"vbar_version", plan.vbar_version},
                  {"program_sha256", plan.program_sha256},
                  {"cases", plan.cases},
                  {"cases_sha256", plan.cases_sha256},
                  {"keys", plan.keys},
                  {"swept", plan.swept},
                  {"pass", passes},
                  {"samples_h", plan.samples_h},
                  {"require", json_of(plan.require)},
                  {"independent", plan.independent},
                  {"mission_file", plan.mission_file},
                  {"set", plan.set},
                  {"keep", json_of(plan.keep)},
                  {"case_time_limit_s", plan.case_time_limit_s},
                  {"expected_case_s", plan.expected_case_s},
                  {"retries", plan.retries},
                  {"stop_after_failures", plan.stop_after_failures}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Plan read_plan(const std::filesystem::path& file) {
  const std::string text = files::read_text_file(file);
  try {
    return plan_of_json(Json::parse(text));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: not the plan of a campaign: {}", file.string(), error.what()));
  }
}

std::string identity_of(const Plan& plan, const Case& one) {
  return files::sha256_of(fmt::format("{}", fmt::join(overrides_of(plan, one, false), "\n")));
}

std::vector<std::string> overrides_of(const Plan& plan, const Case& one, bool full_record) {
  std::vector<std::string> overrides = plan.set;
  for (std::size_t k = 0; k < plan.keys.size(); ++k) overrides.push_back(plan.keys[k] + "=" + one.values[k]);
  overrides.push_back(fmt::format("mission.seed={}", one.seed));
  if (!plan.samples_h.empty()) {
    std::vector<std::string> hours;
    for (const double hour : plan.samples_h) hours.push_back(text_of(hour));
    overrides.push_back(fmt::format("record.samples_h=[{}]", fmt::join(hours, ", ")));
  }
  if (!full_record) overrides.insert(overrides.end(), {"record.packets=false", "record.tables=false"});
  return overrides;
}

namespace {

namespace fs = std::filesystem;

/// A file beside the campaign's, or a mission of the catalogue.
fs::path find_mission_of(const CampaignFile& campaign) {
  const fs::path beside = campaign.file.parent_path() / campaign.mission;
  std::error_code error;
  const fs::path file =
      fs::is_regular_file(beside, error) ? beside : mission::find_mission(campaign.mission, sensors::installation());
  return fs::absolute(file).lexically_normal();
}

std::string name_of(const Plan& plan, const Case& one) {
  std::string name = fmt::format("case {} (seed {}", one.number, one.seed);
  for (std::size_t k = 0; k < plan.keys.size(); ++k) name += fmt::format(", {} = {}", plan.keys[k], one.values[k]);
  return name + ")";
}

/// Images of flight computers, and libraries that a mission states by name, stand beside the program; a library that it
/// states by its path may stand anywhere, and workers look for it from where they are.
void add_flight_software(const mission::Mission& mission, UsedFiles& used) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (!spacecraft.flight_computer) continue;
    const std::string file = app::flight_software_file(spacecraft);
    const mission::FlightTarget target = spacecraft.flight_computer->target;
    if (file.empty() && target != mission::FlightTarget::kInProcess && target != mission::FlightTarget::kBoard)
      throw app::Refused(fmt::format("flight_computer.target: the image of {} is not built", mission::name_of(target)));
    if (file.empty()) continue;
    if (file != spacecraft.flight_computer->library)
      used.flight_images.insert(fs::absolute(file).lexically_normal());
    else if (!fs::path(file).is_absolute())
      throw app::Refused("flight_computer.library: found the relative path " + file + "; accepted: an absolute path");
  }
}

void add_recorded_logs(const mission::Mission& mission, UsedFiles& used) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft)
    for (const mission::Sensor& sensor : spacecraft.sensors)
      if (!sensor.settings->log.empty())
        used.beside_mission.insert(fs::absolute(sensor.settings->log).lexically_normal());
}

void add_files_read(UsedFiles& used) {
  const fs::path data = fs::absolute(mission::data_directory()).lexically_normal();
  for (const files::FileRead& read : files::files_read()) {
    const fs::path relative = read.file.lexically_relative(data);
    if (relative.empty() || *relative.begin() == "..") used.beside_mission.insert(read.file);
  }
}

/// Loads every case; if cases differ in the seed alone, for which the mission is the same, only the first and the one
/// with the largest seed. Throws app::Refused that names the first one that cannot be flown.
UsedFiles load_all(const Plan& plan, const std::vector<Case>& cases, const fs::path& mission_file, bool quiet) {
  UsedFiles used;
  used.mission = mission_file;
  const auto largest = std::ranges::max_element(cases, {}, &Case::seed);
  std::set<std::vector<std::string>> loaded;
  app::StatusLine line(quiet);
  auto drawn = std::chrono::steady_clock::now();
  for (const Case& one : cases) {
    if (!loaded.insert(one.values).second && &one != &*largest) continue;
    if (const auto now = std::chrono::steady_clock::now(); now - drawn > std::chrono::milliseconds(200)) {
      line.draw(fmt::format("checking case {} of {}", one.number, cases.size()));
      drawn = now;
    }
    try {
      const mission::Mission mission = sensors::load_mission(mission_file, overrides_of(plan, one, false));
      if (!mission.flies()) throw app::Refused(mission_file.string() + ": has no spacecraft with a flight computer");
      add_flight_software(mission, used);
      add_recorded_logs(mission, used);
    } catch (const std::runtime_error& error) {
      throw app::Refused(fmt::format("{}: {}; nothing was flown", name_of(plan, one), error.what()));
    }
  }
  add_files_read(used);
  return used;
}

/// A preparation that was killed leaves parts of a campaign without its plan, and is restarted.
void refuse_used_folder(const Folder& folder) {
  std::error_code error;
  if (!fs::exists(folder.root(), error)) return;
  bool is_free = fs::is_directory(folder.root(), error);
  if (is_free) {
    for (const auto& entry : fs::directory_iterator(folder.root())) {
      const bool is_part = entry.path() == folder.copies() || entry.path() == folder.result_files() ||
                           entry.path() == folder.attempt_files() || entry.path() == folder.flying() ||
                           entry.path() == folder.cases() || entry.path() == folder.campaign_copy() ||
                           entry.path().filename() == report::RunLock::kFile;
      is_free = is_free && is_part;
    }
  }
  if (!is_free)
    throw app::Refused(folder.root().string() +
                       ": exists and is not the folder of this campaign; remove it or name another one with --out");
}

}  // namespace

void prepare(const CampaignFile& campaign, const Folder& folder, const std::string& vbar_version, bool quiet) {
  folder.refuse_links();
  refuse_used_folder(folder);
  Plan plan = plan_of(campaign);
  const std::vector<Case> cases = expand(campaign);
  const fs::path mission = find_mission_of(campaign);
  const UsedFiles used = load_all(plan, cases, mission, quiet);
  plan.mission = mission.stem().string();
  plan.mission_file = copy_of_mission(mission).string();
  plan.vbar_version = vbar_version;
  plan.cases = cases.size();

  fs::create_directories(folder.root());
  const report::RunLock lock(folder.root());
  fs::remove_all(folder.copies());  // copies of a preparation that was killed; a file among them may be a link
  make_copies(folder, used, mission::whole_mission_text(mission));
  plan.program_sha256 = files::sha256_of_file(folder.program()).value_or("");
  for (const fs::path& inner : {folder.result_files(), folder.attempt_files(), folder.flying()})
    fs::create_directories(inner);
  const std::string table = cases_text(plan.keys, cases);
  plan.cases_sha256 = files::sha256_of(table);
  files::replace_text_file(folder.cases(), table);
  files::replace_text_file(folder.campaign_copy(), files::read_text_file(campaign.file));
  files::replace_text_file(folder.plan(), plan_json(plan));  // last: from now on the folder holds a campaign
}

bool holds_same_campaign(const Folder& folder, const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(folder.plan(), error) && fs::is_regular_file(folder.campaign_copy(), error) &&
         files::read_text_file(folder.campaign_copy()) == files::read_text_file(file);
}

}  // namespace vbar::campaign
