#include "host_sim/cli/viewer.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <unistd.h>

#include "host_sim/files/own_program.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::app {

namespace {

constexpr int kRequestsOfViewer = STDERR_FILENO + 1;  ///< descriptor in the program that serves the page
constexpr std::string_view kSpeed = "speed ";

void report_failure(const std::filesystem::path& program, int error) {
  files::print_error("vbar",
                     fmt::format("{} cannot be started: {}", program.string(), std::generic_category().message(error)));
}

}  // namespace

std::optional<engine::PaceRequest> pace_request_of(std::string_view line) {
  using Kind = engine::PaceRequest::Kind;
  if (line == "pause") return engine::PaceRequest{Kind::kPause};
  if (line == "go_on") return engine::PaceRequest{Kind::kGoOn};
  if (line == "step") return engine::PaceRequest{Kind::kStep};
  if (!line.starts_with(kSpeed)) return std::nullopt;
  line.remove_prefix(kSpeed.size());
  double factor = 0.0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), factor);
  const bool is_whole = error == std::errc() && end == line.data() + line.size();
  if (!is_whole || !(factor >= engine::kSpeedFactorMin && factor <= engine::kSpeedFactorMax)) return std::nullopt;
  return engine::PaceRequest{Kind::kNone, factor};
}

std::filesystem::path Viewer::program() {
  std::filesystem::path found = files::program_beside("watch");
  if (found.empty()) throw Refused("--view: the program vbar_watch is not beside this one");
  return found;
}

Viewer::Viewer(const std::filesystem::path& program, const std::filesystem::path& run_folder,
               std::optional<double> controlled_speed) {
  std::vector<std::string> words{program.string(), run_folder.string(), "--of-run", std::to_string(::getpid())};
  io::FileDescriptor writing_end;
  if (controlled_speed) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) {
      report_failure(program, errno);
      return;
    }
    requests_ = io::FileDescriptor(ends[0]);
    writing_end = io::FileDescriptor(ends[1]);
    words.insert(words.end(), {"--control", fmt::format("{}", *controlled_speed)});
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  if (controlled_speed) ::posix_spawn_file_actions_adddup2(&actions, writing_end.get(), kRequestsOfViewer);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, kRequestsOfViewer + (controlled_speed ? 1 : 0));
  pid_t ignored = 0;
  const int error = ::posix_spawn(&ignored, program.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) report_failure(program, error);
}

std::optional<engine::PaceRequest> Viewer::next_request() {
  if (requests_.get() < 0) return std::nullopt;
  std::array<char, 256> part{};
  if (const ssize_t count = ::read(requests_.get(), part.data(), part.size()); count > 0)
    text_.append(part.data(), static_cast<std::size_t>(count));
  for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
    const std::string line = text_.substr(0, end);
    text_.erase(0, end + 1);
    if (const auto request = pace_request_of(line)) return request;
  }
  return std::nullopt;
}

}  // namespace vbar::app
