#pragma once
// vbar serve: a digital sensor of a mission, or its truth, at the other end of an exchange with a run.

#include <filesystem>
#include <string>
#include <vector>

namespace vbar::external {

struct ServeOptions {
  std::filesystem::path mission;
  int stream = 3;                      ///< descriptor of the line, inherited
  std::vector<std::string> overrides;  ///< "path=value"
};

/// Serves a run in another process until its goodbye; `version` of this program is in the messages of that run. Returns
/// the exit code. Throws MissionError, what the mission's data throw, and pil::LinkError if the line fails.
int serve_command(const ServeOptions& options, const std::string& version);

}  // namespace vbar::external
