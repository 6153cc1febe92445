#pragma once
// Pictures that are on a display during an exposure.
//
// Pace "fast": what is on the screen now; it has been there for longer than the display's latency. Pace "real": the
// screen is taken at every refresh, shown by the display a number of refreshes later and for one period, and each
// pixel follows exponentially.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "emulators/optical_stimulator/light_path.h"
#include "emulators/optical_stimulator/settings.h"
#include "host_sim/io/child_process.h"

namespace vbar::optical_stimulator::bench {

// Framebuffer file of Xvfb: an X window dump (XWD, version 7) whose pixels the server changes in place.

struct XwdLayout {
  int width = 0, height = 0;
  std::size_t bytes_per_line = 0;
  std::size_t pixels = 0;  ///< offset of the first
};

/// Reads the header (big-endian words). Throws std::runtime_error, one sentence, for a file that is not a dump of
/// 32-bit pixels with red, green and blue in bytes 2, 1 and 0 of a little-endian word, or that is too short for its
/// pixels.
[[nodiscard]] XwdLayout read_xwd_layout(std::span<const std::uint8_t> file);

/// Reads the grey values of the pixels, rows from the top: luma by ITU-R BT.709 in 256ths, the value itself of a grey
/// pixel.
void read_grey(std::span<const std::uint8_t> file, const XwdLayout& layout, std::vector<std::uint8_t>& grey);

// Pictures that the display shows while the camera exposes, and the faults of a display.

struct PanelFaults {
  bool is_late = false;     ///< shows what the screen held at the exposure before
  bool is_frozen = false;   ///< shows what it showed last before the fault
  bool is_covered = false;  ///< a window of another program lies over its middle
  bool is_mirrored = false;
  bool is_rotated = false;  ///< by 180 deg

  friend bool operator==(const PanelFaults&, const PanelFaults&) = default;
};

/// Holds a picture of the screen during an exposure, with its part of the light.
struct Picture {
  std::shared_ptr<const std::vector<std::uint8_t>> counts;
  double fraction = 1.0;
};
using Pictures = std::vector<Picture>;

class Panel {
 public:
  Panel(int width, int height) : width_(width), height_(height) {}

  /// Returns what the panel shows of `pictures`, which were on the screen during the exposure.
  [[nodiscard]] Pictures show(Pictures pictures, const PanelFaults& faults);

 private:
  [[nodiscard]] Picture with(const Picture& picture, const PanelFaults& faults) const;

  int width_, height_;
  Pictures screen_before_;  ///< on the screen at the exposure before
  Pictures shown_before_;   ///< shown at the last exposure without a frozen display
};

// X server without a monitor (Xvfb), which belongs to the emulator, and what is on its screen.

class VirtualScreen {
 public:
  /// Starts the server on a free display number; it ends with this object, and with this program however that ends.
  /// `directory` exists; nothing stays in it. To be made by a thread that outlives it. Throws std::runtime_error.
  VirtualScreen(int width, int height, const std::filesystem::path& directory);
  ~VirtualScreen();
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;

  /// Returns the display's name, such as ":7".
  [[nodiscard]] const std::string& display() const { return display_; }
  /// Reads the grey values of what is on the screen now; may be called by any thread.
  void read(std::vector<std::uint8_t>& grey) const { read_grey(file_, layout_, grey); }
  [[nodiscard]] bool has_ended() { return server_ && server_->has_ended(); }

 private:
  void map(const std::filesystem::path& file);

  std::optional<io::ChildProcess> server_;
  std::string display_;
  std::span<std::uint8_t> file_;
  XwdLayout layout_;
};

using ReadScreen = std::function<void(std::vector<std::uint8_t>& grey)>;

/// Holds a picture that the display begins to show at `begin_s`.
struct TimedPicture {
  double begin_s = 0.0;
  std::shared_ptr<const std::vector<std::uint8_t>> counts;
};

/// Returns the parts of the light of an exposure from `begin_s` to `end_s`: pictures in order, the first of which was
/// shown before it; `response_s`: time constant of the pixels.
[[nodiscard]] Pictures pictures_of(const std::deque<TimedPicture>& shown, double begin_s, double end_s,
                                   double response_s);

class ScreenWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Starts a thread in pace "real", which calls `read`.
  ScreenWatch(const DisplaySettings& settings, Pace pace, ReadScreen read);
  ~ScreenWatch();
  ScreenWatch(const ScreenWatch&) = delete;
  ScreenWatch& operator=(const ScreenWatch&) = delete;

  /// Returns the pictures of an exposure that began at `begin`; in pace "real" it has ended when this returns.
  [[nodiscard]] Pictures during(Clock::time_point begin, double exposure_s);

 private:
  void watch(const std::stop_token& stop);

  DisplaySettings settings_;
  ReadScreen read_;
  Clock::time_point origin_ = Clock::now();
  std::mutex mutex_;
  std::deque<TimedPicture> shown_;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace vbar::optical_stimulator::bench
