#pragma once
// Folder of a resumed run, and its exchange with that of the run that it continues. It grows in a folder beside
// that run, whose log is not touched until the other one is longer: a resume that is killed can be resumed.

#include <filesystem>

namespace vbar::app {

/// "<run folder>.resuming"
[[nodiscard]] std::filesystem::path resuming_folder(const std::filesystem::path& run_folder);

/// Completes what a killed resume left: a folder that was to take the place of the run does so if its packet log is the
/// longer one, else it is removed. Throws std::runtime_error.
void settle_earlier_resume(const std::filesystem::path& run_folder);

/// Puts resuming_folder() in the place of the run. Files in it that no run writes are kept. Whenever it is
/// interrupted, settle_earlier_resume() completes it. Throws std::runtime_error.
void replace_run(const std::filesystem::path& run_folder);

/// Removes resuming_folder(), if there is one.
void remove_resumed(const std::filesystem::path& run_folder);

}  // namespace vbar::app
