#pragma once
// What `vbar` can be asked to do. Each returns the program's exit code: 0 done, 1 not (said on standard error), 2 done
// but the result is not what was hoped for (outputs differ).

#include <filesystem>
#include <string>
#include <vector>

namespace vbar::app {

/// In a run folder: the mission file and the overrides it was flown with, one a line.
inline constexpr const char* kMissionCopy = "mission.toml";
inline constexpr const char* kOverridesCopy = "overrides.txt";

struct RunOptions {
  std::filesystem::path mission;
  std::filesystem::path out;           ///< empty: runs/<mission>-<seed>
  std::vector<std::string> overrides;  ///< "path=value"
};
int run_command(const RunOptions& options);

struct PropagateOptions {
  std::filesystem::path mission;
  std::filesystem::path out;           ///< empty: runs/<mission>-truth
  bool oem = false;                    ///< CCSDS orbit ephemeris messages too
  std::vector<std::string> overrides;  ///< "path=value"
};
int propagate_command(const PropagateOptions& options);

struct ReplayOptions {
  std::filesystem::path run_folder;
  std::vector<std::string> overrides;
};
int replay_command(const ReplayOptions& options);

/// Of one run: its report.html. Of several: a comparison in `out`, beside the first run unless given.
int report_command(const std::vector<std::filesystem::path>& run_folders, const std::filesystem::path& out);

int missions_command(const std::filesystem::path& folder);

}  // namespace vbar::app
