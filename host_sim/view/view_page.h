#pragma once
// view.html: a run to be looked at, turned and scrubbed in a browser. One file that opens from disk and loads nothing:
// its programs (host_sim/view/web) and the tables of the run are in it.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"

namespace vbar::view {

struct CellTable;

/// Returns the page without data; empty in a build that was configured without the programs of the page.
[[nodiscard]] std::string_view page_template();

/// Returns the page with a title and the JSON of its runs. Throws std::runtime_error without page_template().
[[nodiscard]] std::string filled_page(std::string_view title, nlohmann::json runs);

/// How a build comes to contain the page, for messages.
inline constexpr const char* kHowToGetPage =
    "this build of vbar is without the page of runs: install npm (ci/install.sh view), run "
    "host_sim/view/web/install.sh, "
    "then configure and build again";

/// A run on the page. Without its mission the page lacks shapes, cameras, keep-out and Sun, and states `note`.
struct ViewedRun {
  std::string name;
  const report::RunRecord& record;
  const mission::Mission* mission = nullptr;
  std::string note{};
};

/// Returns the page of at least one run; the others are drawn beside the first one. Throws std::runtime_error without
/// page_template().
[[nodiscard]] std::string view_page(std::span<const ViewedRun> runs, const std::filesystem::path& data_directory);

/// Throws std::runtime_error that names the file.
void write_view(const std::filesystem::path& file, std::span<const ViewedRun> runs,
                const std::filesystem::path& data_directory);

/// Writes view.html, if this build has the page, then report.html, which links to it or states how to get it, into the
/// run's folder. Returns the file of the report. Throws std::runtime_error that names the file.
std::filesystem::path write_pages(const std::filesystem::path& run_folder, const ViewedRun& run,
                                  const std::filesystem::path& data_directory);

// What a page draws beside the tables of a run and only the mission states: shapes of the spacecraft, cameras, keep-out
// radii, sunlight.

/// Returns the scene: the bodies of the servicer and of the target with their shapes, cameras, waypoints with their
/// keep-out radii. A shape that cannot be read is left out, with the reason under "notes".
[[nodiscard]] nlohmann::json scene_of(const mission::Mission& mission, const report::RunRecord& record,
                                      const std::filesystem::path& data_directory);

/// Returns the direction to the Sun, the fraction of its light that reaches the servicer, and whether that is eclipse,
/// at steps of the run.
[[nodiscard]] CellTable sunlight_of(const mission::Mission& mission, const report::RunRecord& record);

// The page of a propagation (vbar propagate): orbits over time, and the motion of the second spacecraft relative to the
// first one.

/// Returns whether the folder holds a propagation, and not a run.
[[nodiscard]] bool is_propagation(const std::filesystem::path& folder);

/// Returns the page of a complete propagation. The ephemerides are read part by part, as those of a month at steps of a
/// second are 2 GB; of more than 20,000 rows the page has those in which a column has an extreme in its part, as that
/// of a run. Throws std::runtime_error that names the file and the line.
[[nodiscard]] std::string propagation_page(const std::filesystem::path& folder, std::string_view name);

}  // namespace vbar::view
