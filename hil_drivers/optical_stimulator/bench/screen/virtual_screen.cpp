#include "hil_drivers/optical_stimulator/bench/screen/virtual_screen.h"

#include <chrono>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host_sim/io/file_descriptor.h"

namespace vbar::optical_stimulator::bench {
namespace {

constexpr std::chrono::seconds kStartLimit{60};
constexpr std::chrono::milliseconds kEndPatience{2000};
constexpr const char* kServer = "Xvfb";

/// The line that the server writes when it accepts clients.
std::string read_display_number(int pipe, io::ChildProcess& server) {
  const auto until = std::chrono::steady_clock::now() + kStartLimit;
  std::string number;
  while (std::chrono::steady_clock::now() < until) {
    pollfd ready{pipe, POLLIN, 0};
    if (::poll(&ready, 1, 100) > 0) {
      char c = 0;
      if (::read(pipe, &c, 1) != 1) break;
      if (c == '\n') return number;
      if (c >= '0' && c <= '9') number += c;
    }
    if (server.has_ended()) break;
  }
  throw std::runtime_error(
      fmt::format("{} did not start: {}; its last words: {}", kServer, server.status_text(), server.output_tail(300)));
}

}  // namespace

VirtualScreen::VirtualScreen(int width, int height, const std::filesystem::path& directory) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "a pipe for Xvfb");
  const io::FileDescriptor reader(ends[0]);
  std::vector<io::FileDescriptor> inherited;
  inherited.emplace_back(ends[1]);
  const std::filesystem::path buffers = directory / "framebuffer";
  std::filesystem::create_directories(buffers);
  // No cursor, no screen saver, no reset when the last client has gone: only clients change pixels.
  const std::vector<std::string> arguments{kServer,     "-displayfd",
                                           "3",         "-screen",
                                           "0",         fmt::format("{}x{}x24", width, height),
                                           "-fbdir",    buffers.string(),
                                           "-nolisten", "tcp",
                                           "-noreset",  "-nocursor",
                                           "-s",        "0"};
  try {
    server_.emplace(arguments, std::move(inherited));
  } catch (const std::system_error& error) {
    throw std::runtime_error(fmt::format("{} cannot be started: {}", kServer, error.code().message()));
  }
  display_ = ":" + read_display_number(reader.get(), *server_);
  map(buffers / "Xvfb_screen0");
  if (layout_.width != width || layout_.height != height)
    throw std::runtime_error(fmt::format("{}: a screen of {} x {} pixels in place of {} x {}", kServer, layout_.width,
                                         layout_.height, width, height));
  // Both programs have it mapped; without a name it vanishes with them.
  std::error_code ignored;
  std::filesystem::remove_all(buffers, ignored);
}

VirtualScreen::~VirtualScreen() {
  if (server_) server_->terminate(kEndPatience);
  if (!file_.empty()) ::munmap(file_.data(), file_.size());
}

void VirtualScreen::map(const std::filesystem::path& file) {
  const io::FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (opened.get() < 0 || ::fstat(opened.get(), &status) != 0)
    throw std::system_error(errno, std::generic_category(), file.string());
  const auto size = static_cast<std::size_t>(status.st_size);
  void* mapped = size > 0 ? ::mmap(nullptr, size, PROT_READ, MAP_SHARED, opened.get(), 0) : MAP_FAILED;
  if (mapped == MAP_FAILED) throw std::runtime_error(file.string() + ": cannot be mapped");
  file_ = {static_cast<std::uint8_t*>(mapped), size};
  layout_ = read_xwd_layout(file_);
}

}  // namespace vbar::optical_stimulator::bench
