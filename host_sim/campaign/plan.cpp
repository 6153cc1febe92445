#include "host_sim/campaign/plan.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/case_records.h"
#include "host_sim/campaign/copies.h"
#include "host_sim/campaign_report/requirement.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/report/json_file.h"
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

constexpr std::size_t kFormat = 1;
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

Json json_of(const Keep& keep) {
  for (const auto& [name, kind] : kKeepKinds)
    if (kind == keep.kind) return {{"runs", name}, {"worst", keep.worst}};
  return nullptr;
}

Keep keep_of(const report::JsonObject& object) {
  const std::string runs = object.text("runs");
  for (const auto& [name, kind] : kKeepKinds)
    if (runs == name) return {kind, object.count("worst")};
  object.fail("runs", fmt::format("found \"{}\"; accepted: summary, failed, worst or all", runs));
}

Plan plan_of_json(const report::JsonObject& object) {
  if (const auto format = object.count("format"); format != kFormat)
    object.fail("format", fmt::format("found {}; accepted: {}", format, kFormat));
  Plan plan;
  plan.name = object.text("name");
  plan.description = object.text("description");
  plan.mission = object.text("mission");
  plan.vbar_version = object.text("vbar_version");
  plan.commit = object.text_or("commit", "");
  plan.program_sha256 = object.text("program_sha256");
  plan.seeds_from = object.text_or("seeds_from", "");
  plan.cases = object.count("cases");
  plan.cases_sha256 = object.text("cases_sha256");
  plan.keys = object.texts("keys");
  plan.swept = object.texts("swept");
  for (const report::JsonObject& pass : object.objects("pass"))
    plan.passes.push_back({pass.text("key"), pass.number_or_null("most"), pass.number_or_null("least")});
  plan.samples_h = object.get<std::vector<double>>("samples_h", "a list of numbers");
  plan.requirements = campaign_report::requirements_of(object);
  plan.independent = object.flag("independent");
  plan.mission_file = object.text("mission_file");
  plan.set = object.texts("set");
  plan.keep = keep_of(object.object("keep"));
  plan.case_time_limit_s = object.number("case_time_limit_s");
  plan.expected_case_s = object.number("expected_case_s");
  plan.retries = static_cast<std::int64_t>(object.count("retries"));
  plan.stop_after_failures = static_cast<std::int64_t>(object.count("stop_after_failures"));
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
  plan.requirements = campaign.requirements;
  plan.seeds_from = campaign.seeds_from;
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
  Json requirements = Json::array();
  for (const Requirement& one : plan.requirements) requirements.push_back(campaign_report::json_of(one));
  const Json json{{"format", kFormat},
                  {"name", plan.name},
                  {"description", plan.description},
                  {"mission", plan.mission},
                  {"vbar_version", plan.vbar_version},
                  {"commit", plan.commit},
                  {"program_sha256", plan.program_sha256},
                  {"seeds_from", plan.seeds_from},
                  {"cases", plan.cases},
                  {"cases_sha256", plan.cases_sha256},
                  {"keys", plan.keys},
                  {"swept", plan.swept},
                  {"pass", passes},
                  {"samples_h", plan.samples_h},
                  {"require", requirements},
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
  const Json json = report::read_json_file(file);
  return plan_of_json({json, file.string()});
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
    const std::string& key_file = spacecraft.flight_computer->telecommand_key_file;
    if (!key_file.empty() && !fs::path(key_file).is_absolute())
      throw app::Refused("flight_computer.telecommand_key_file: found the relative path " + key_file +
                         "; accepted: an absolute path");
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

void prepare(const CampaignFile& campaign, const Folder& folder, const Build& build, bool quiet) {
  folder.refuse_links();
  refuse_used_folder(folder);
  Plan plan = plan_of(campaign);
  const std::vector<Case> cases = expand(campaign);
  const fs::path mission = find_mission_of(campaign);
  const UsedFiles used = load_all(plan, cases, mission, quiet);
  plan.mission = mission.stem().string();
  plan.mission_file = copy_of_mission(mission).string();
  plan.vbar_version = build.version;
  plan.commit = build.commit;
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
