#include "emulators/optical_stimulator/screen.h"

#include <algorithm>
#include <chrono>
#include <cmath>
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

Pictures Panel::show(Pictures pictures, const PanelFaults& faults) {
  Pictures shown = faults.is_late && !screen_before_.empty() ? screen_before_ : pictures;
  screen_before_ = std::move(pictures);
  if (faults.is_frozen && !shown_before_.empty()) {
    shown = shown_before_;
  } else {
    shown_before_ = shown;
  }
  for (Picture& picture : shown) picture = with(picture, faults);
  return shown;
}

Picture Panel::with(const Picture& picture, const PanelFaults& faults) const {
  if (!faults.is_covered && !faults.is_mirrored && !faults.is_rotated) return picture;
  constexpr std::uint8_t kWindowCount = 128;
  auto counts = std::make_shared<std::vector<std::uint8_t>>(*picture.counts);
  const auto row_begin = [&](int row) { return counts->begin() + static_cast<std::ptrdiff_t>(row) * width_; };
  if (faults.is_covered)
    for (int row = height_ / 4; row < 3 * height_ / 4; ++row)
      std::fill(row_begin(row) + width_ / 4, row_begin(row) + 3 * width_ / 4, kWindowCount);
  if (faults.is_rotated) std::reverse(counts->begin(), counts->end());
  if (faults.is_mirrored)
    for (int row = 0; row < height_; ++row) std::reverse(row_begin(row), row_begin(row) + width_);
  return {std::move(counts), picture.fraction};
}

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

namespace {

/// Pictures older than this belong to no exposure.
constexpr double kKept_s = 60.0;

double seconds(ScreenWatch::Clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

Pictures pictures_of(const std::deque<TimedPicture>& shown, double begin_s, double end_s, double response_s) {
  // The light of a picture shown from a to b rises as 1 - exp(-(t - a)/tau) and falls as exp(-(t - b)/tau): the
  // integral of what the step at `at` has reached.
  const auto after_step = [&](double at) {
    const double from = std::max(begin_s, at);
    if (from >= end_s) return 0.0;
    if (response_s <= 0.0) return end_s - from;
    return (end_s - from) + response_s * (std::exp((at - end_s) / response_s) - std::exp((at - from) / response_s));
  };
  Pictures pictures;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const double reached = k == 0 ? end_s - begin_s : after_step(shown[k].begin_s);
    const double left = k + 1 < shown.size() ? after_step(shown[k + 1].begin_s) : 0.0;
    const double fraction = (reached - left) / (end_s - begin_s);
    if (fraction > 0.0) pictures.push_back({shown[k].counts, fraction});
  }
  return pictures;
}

ScreenWatch::ScreenWatch(const DisplaySettings& settings, Pace pace, ReadScreen read)
    : settings_(settings), read_(std::move(read)) {
  if (pace == Pace::kReal) thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

ScreenWatch::~ScreenWatch() = default;

void ScreenWatch::watch(const std::stop_token& stop) {
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / settings_.refresh_hz));
  std::vector<std::uint8_t> grey;
  for (Clock::time_point next = Clock::now(); !stop.stop_requested(); next += period) {
    std::this_thread::sleep_until(next);
    read_(grey);
    const double begin_s = seconds(next - origin_) + settings_.latency_frames / settings_.refresh_hz;
    const std::lock_guard lock(mutex_);
    if (shown_.empty() || *shown_.back().counts != grey)
      shown_.push_back({begin_s, std::make_shared<const std::vector<std::uint8_t>>(grey)});
    while (shown_.size() > 1 && shown_[1].begin_s < begin_s - kKept_s) shown_.pop_front();
    next = std::max(next, Clock::now() - period);  // a loaded computer leaves out refreshes
  }
}

Pictures ScreenWatch::during(Clock::time_point begin, double exposure_s) {
  if (!thread_.joinable()) {
    auto counts = std::make_shared<std::vector<std::uint8_t>>();
    read_(*counts);
    return {{std::move(counts), 1.0}};
  }
  const double begin_s = seconds(begin - origin_), end_s = begin_s + exposure_s;
  std::this_thread::sleep_until(begin +
                                std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(exposure_s)));
  const std::lock_guard lock(mutex_);
  if (shown_.empty()) return {};
  return pictures_of(shown_, begin_s, end_s, 1e-3 * settings_.response_ms);
}

}  // namespace vbar::optical_stimulator::bench
