#include "host_sim/campaign/prepare.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/progress.h"
#include "host_sim/campaign/copies.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/sha256.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/extends.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/report/run_lock.h"
#include "host_sim/report/text_file.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::campaign {
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
