#pragma once
// The program that serves the page of a run while it goes on, and what a person asks for on that page.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "host_sim/engine/controlled_wall_clock.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::app {

/// A request as the page sends it: "pause", "go_on", "step" or "speed 50", the factor within
/// engine::kSpeedFactorMin and kSpeedFactorMax. None for any other text.
[[nodiscard]] std::optional<engine::PaceRequest> pace_request_of(std::string_view line);

/// A process of its own, which reads the folder as it grows, so that no viewer can delay or change the run. It inherits
/// no descriptor but the standard ones, and the writing end of a pipe of requests if it may make them: the lock of the
/// folder ends with the run. It lives on for a while after the run.
class Viewer {
 public:
  /// The program beside this one. Throws Refused if there is none.
  [[nodiscard]] static std::filesystem::path program();

  /// Starts it; if it cannot be started, that is printed. `controlled_speed`: the speed factor of a run whose pace the
  /// page may change.
  Viewer(const std::filesystem::path& program, const std::filesystem::path& run_folder,
         std::optional<double> controlled_speed);

  /// The next request of the page, none if none waits. Never waits.
  [[nodiscard]] std::optional<engine::PaceRequest> next_request();

 private:
  io::FileDescriptor requests_;
  std::string text_;  ///< read from the pipe, of a request that is not whole yet or not taken yet
};

}  // namespace vbar::app
