#include "host_sim/campaign/trust.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/app/flown_mission.h"
#include "host_sim/files/sha256.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::campaign {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOnlyTrusted = "which is used only with --trust";

[[noreturn]] void refuse(const fs::path& where, const std::string& what) {
  throw app::Refused(fmt::format("{}: {}, {}", where.string(), what, kOnlyTrusted));
}

bool is_inside(const fs::path& file, const fs::path& parent) {
  const fs::path relative = file.lexically_relative(parent);
  return !relative.empty() && *relative.begin() != "..";
}

/// Every file of the copies that is no data and no mission, whether or not it is listed with a checksum.
void check_programs(const Folder& folder) {
  const fs::path own = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.copies())) {
    const fs::path& file = entry.path();
    if (entry.is_directory() && !entry.is_symlink()) continue;
    if (file == folder.checksums() || is_inside(file, folder.data()) || is_inside(file, folder.mission_files()))
      continue;
    const fs::path relative = file.lexically_relative(folder.program().parent_path());
    const fs::path installed =
        file == folder.program() ? fs::path("/proc/self/exe") : (own / relative).lexically_normal();
    const auto sha256 = files::sha256_of_file(file);
    if (!sha256 || sha256 != files::sha256_of_file(installed))
      refuse(file, "is not the program of this installation (SHA-256)");
  }
}

/// Keys whose values name what is loaded, opened or started.
bool names_program(std::string_view key) {
  constexpr std::array<std::string_view, 4> kOfComputer{"library", "image", "device", "address"};
  return key.starts_with("testbed") ||
         std::ranges::find(kOfComputer, app::flight_computer_key(key)) != kOfComputer.end();
}

}  // namespace

void check_trust(const Folder& folder, const Plan& plan, const std::vector<Case>& cases, bool is_trusted) {
  if (is_trusted) return;
  check_programs(folder);
  for (const std::string& key : plan.keys)
    if (names_program(key)) refuse(folder.plan(), fmt::format("its cases differ in {}", key));
  if (cases.empty()) return;
  const fs::path file = folder.root() / plan.mission_file;
  const mission::Mission mission = sensors::load_mission(file, overrides_of(plan, cases.front(), false));
  app::check_trust(mission, folder.root(), {}, false);
  if (!mission.testbeds.empty())
    refuse(folder.root(), fmt::format("its mission names the testbed {}", mission.testbeds.front().name));
}

}  // namespace vbar::campaign
