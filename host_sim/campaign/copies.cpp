#include "host_sim/campaign/copies.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/own_program.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/recorded_mission.h"

namespace vbar::campaign {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigestDigits = 64;

bool is_inside(const fs::path& file, const fs::path& parent) {
  const fs::path relative = file.lexically_relative(parent);
  return !relative.empty() && *relative.begin() != "..";
}

void copy_one(const fs::path& from, const fs::path& to) {
  try {
    fs::create_directories(to.parent_path());
    fs::copy_file(from, to, fs::copy_options::overwrite_existing);
  } catch (const fs::filesystem_error& error) {
    throw std::runtime_error(
        fmt::format("{}: cannot be copied to {}: {}", from.string(), to.string(), error.code().message()));
  }
}

void copy_data(const Folder& folder) {
  const fs::path data = mission::data_directory();
  for (const auto& entry : fs::recursive_directory_iterator(data))
    if (entry.is_regular_file()) copy_one(entry.path(), folder.data() / entry.path().lexically_relative(data));
}

std::string checksums_of(const Folder& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder.copies()))
    if (entry.is_regular_file() && entry.path() != folder.checksums()) files.insert(entry.path());
  std::string text;
  for (const fs::path& file : files) {
    const auto sha256 = files::sha256_of_file(file);
    if (!sha256) throw std::runtime_error(file.string() + ": cannot be read");
    text += fmt::format("{}  {}\n", *sha256, file.lexically_relative(folder.copies()).string());
  }
  return text;
}

}  // namespace

std::vector<std::pair<fs::path, std::string>> listed_copies(const Folder& folder) {
  std::vector<std::pair<fs::path, std::string>> listed;
  for (const std::string& line : report::read_lines(folder.checksums())) {
    if (line.empty()) continue;
    const std::string name = line.size() > kDigestDigits + 2 ? line.substr(kDigestDigits + 2) : line;
    listed.emplace_back(folder.copies() / name, line.substr(0, kDigestDigits));
  }
  return listed;
}

std::string kind_of_copy(const Folder& folder, const fs::path& file) {
  if (file == folder.program()) return "program";
  if (is_inside(file, folder.data())) return "data";
  return is_inside(file, folder.mission_files()) ? "mission" : "flight image";
}

fs::path copy_of_mission(const fs::path& mission) {
  const Folder relative{fs::path()};
  return relative.mission_files() / mission.relative_path();
}

void make_copies(const Folder& folder, const UsedFiles& used, const std::string& mission_text) {
  const fs::path program = files::own_program();
  copy_one(program, folder.program());
  copy_data(folder);
  const fs::path mission = folder.root() / copy_of_mission(used.mission);
  fs::create_directories(mission.parent_path());
  files::replace_text_file(mission, mission_text);
  for (const fs::path& file : used.beside_mission) copy_one(file, folder.mission_files() / file.relative_path());
  // The program finds images by their places relative to its own.
  for (const fs::path& image : used.flight_images)
    copy_one(image,
             (folder.program().parent_path() / image.lexically_relative(program.parent_path())).lexically_normal());
  files::replace_text_file(folder.checksums(), checksums_of(folder));
}

void check_copies(const Folder& folder) {
  for (const auto& [file, listed] : listed_copies(folder)) {
    const auto sha256 = files::sha256_of_file(file);
    if (!sha256) throw std::runtime_error(file.string() + ": cannot be read; the campaign's copies are not whole");
    if (*sha256 != listed)
      throw std::runtime_error(file.string() +
                               ": differs from the file that the campaign began with (SHA-256); "
                               "restore it, or begin a new campaign");
  }
}

bool flies_as_the_copy(const Folder& folder) {
  for (const auto& [file, listed] : listed_copies(folder)) {
    if (file == folder.program()) {
      if (files::sha256_of_file(files::own_program_bytes()) != listed) return false;
    } else if (!is_inside(file, folder.data()) && !is_inside(file, folder.mission_files())) {
      return false;
    }
  }
  return true;
}

namespace {

constexpr const char* kOnlyTrusted = "which is used only with --trust";

[[noreturn]] void refuse(const fs::path& where, const std::string& what) {
  throw app::Refused(fmt::format("{}: {}, {}", where.string(), what, kOnlyTrusted));
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
