#include "host_sim/app/resumed_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/app/flown_mission.h"
#include "host_sim/files/remove_link.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/run_lock.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/report/text_file.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/twins/flown_log.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

/// "<run folder>.replaced": the run that was replaced, where two folders cannot change places at once.
fs::path replaced_folder(const fs::path& run_folder) {
  return run_folder.string() + ".replaced";
}

[[noreturn]] void fail(const fs::path& folder, const char* what, int error) {
  throw std::runtime_error(fmt::format("{}: {}: {}", folder.string(), what, std::generic_category().message(error)));
}

void synchronise(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool done = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!done) fail(path, "cannot be brought to the disk", error);
}

void synchronise_all(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) synchronise(entry.path());
  synchronise(folder);
}

std::set<std::string> names_of_run_files() {
  std::set<std::string> names{report::RunLock::kFile};
  for (const std::string& file : {report::summary_file("").string(), std::string(kMissionCopy),
                                  std::string(kOverridesCopy), std::string(kBranchCopy)})
    names.insert({file, files::neighbour_of(file).string()});
  for (const std::string& file : report::flight_files(sensors::extensions())) names.insert(file);
  return names;
}

/// Moves what no run writes.
void keep_other_files(const fs::path& from, const fs::path& to) {
  const std::set<std::string> of_run = names_of_run_files();
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    const fs::path name = entry.path().filename();
    if (!of_run.contains(name.string()) && !fs::exists(to / name)) fs::rename(entry.path(), to / name);
  }
}

/// Whether both hold the same mission.
bool is_same_mission(const fs::path& a, const fs::path& b) {
  return std::ranges::all_of(std::array{kMissionCopy, kOverridesCopy}, [&](const char* file) {
    return fs::exists(a / file) && fs::exists(b / file) &&
           files::read_text_file(a / file) == files::read_text_file(b / file);
  });
}

/// Number of intact events; 0 if there is no log, or a damaged one.
std::uint64_t events_in(const fs::path& folder) {
  try {
    return twins::FlownLog(report::packet_log_file(folder)).events();
  } catch (const std::runtime_error&) {
    return 0;
  }
}

/// Exchanges the folders and returns the place of the run that was replaced.
fs::path exchange(const fs::path& run_folder, const fs::path& next) {
  if (::renameat2(AT_FDCWD, next.c_str(), AT_FDCWD, run_folder.c_str(), RENAME_EXCHANGE) == 0) return next;
  if (errno != EINVAL && errno != ENOSYS) fail(run_folder, "cannot be replaced", errno);
  const fs::path replaced = replaced_folder(run_folder);  // a file system that cannot exchange
  fs::rename(run_folder, replaced);
  fs::rename(next, run_folder);
  return replaced;
}

void remove_replaced(const fs::path& replaced, const fs::path& run_folder) {
  keep_other_files(replaced, run_folder);
  fs::remove_all(replaced);
}

}  // namespace

fs::path resuming_folder(const fs::path& run_folder) {
  return run_folder.string() + ".resuming";
}

void replace_run(const fs::path& run_folder) {
  const fs::path next = resuming_folder(run_folder);
  synchronise_all(next);
  const fs::path replaced = exchange(run_folder, next);
  synchronise(run_folder.parent_path());
  remove_replaced(replaced, run_folder);
}

void settle_earlier_resume(const fs::path& run_folder) {
  const fs::path replaced = replaced_folder(run_folder);
  files::remove_link(replaced);
  files::remove_link(resuming_folder(run_folder));
  if (report::is_summary(report::summary_file(replaced))) {
    if (fs::exists(run_folder)) {
      remove_replaced(replaced, run_folder);
    } else {
      fs::rename(replaced, run_folder);
    }
  }
  const fs::path next = resuming_folder(run_folder);
  if (!report::is_summary(report::summary_file(next))) {
    std::error_code ignored;
    fs::remove(next, ignored);  // an empty one
    return;
  }
  if (is_same_mission(run_folder, next) && events_in(next) > events_in(run_folder)) {
    replace_run(run_folder);
  } else {
    remove_replaced(next, run_folder);
  }
}

void remove_resumed(const fs::path& run_folder) {
  fs::remove_all(resuming_folder(run_folder));
}

}  // namespace vbar::app
