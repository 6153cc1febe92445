#pragma once
// X server without a monitor (Xvfb), which belongs to the emulator, and what is on its screen.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil_drivers/optical_stimulator/bench/screen/xwd.h"
#include "host_sim/io/child_process.h"

namespace vbar::optical_stimulator::bench {

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

}  // namespace vbar::optical_stimulator::bench
