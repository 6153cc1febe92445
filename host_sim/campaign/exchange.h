#pragma once
// Cases that are flown elsewhere: a campaign's folder without what was kept of its flights, as a folder or one archive,
// and the way back of its results. The copy is a campaign's folder itself: program, data and missions travel with it.

#include <cstddef>
#include <filesystem>

#include "host_sim/campaign/plan.h"

namespace vbar::campaign {

/// The script of an exported campaign: flies it and packs results.tar.gz.
inline constexpr const char* kFlyScript = "fly.sh";

struct Exported {
  std::filesystem::path to;
  std::size_t cases = 0;  ///< that are left to fly
};

/// Writes the campaign with its cases to `to`, a folder, or an archive if that ends in .tar.gz or .tgz; empty:
/// NAME-cases.tar.gz, NAME being that of the campaign's folder. Throws app::Refused if no case is left to fly or `to`
/// exists, std::runtime_error if it cannot be written.
[[nodiscard]] Exported export_cases(const Folder& folder, std::filesystem::path to);

struct Imported {
  std::size_t taken = 0;  ///< results that were added
  std::size_t known = 0;  ///< of cases that have a result with the same outputs here
  std::size_t left = 0;   ///< cases that are left to fly
};

/// Adds the results of `from`: an exported folder that was flown, or the archive of its results. Throws app::Refused,
/// with nothing imported, for an archive that is not whole, a program, data, mission or cases other than those of the
/// campaign, which it names, a damaged line and a case whose outputs differ from those on record.
[[nodiscard]] Imported import_results(const Folder& folder, const std::filesystem::path& from);

}  // namespace vbar::campaign
