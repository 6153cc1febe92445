#pragma once
// A window that covers one output of an X display and shows grey pictures pixel by pixel: no scaling, no colour
// management, no pointer, no screen saver.

#include <chrono>
#include <memory>
#include <string>

#include "hil_drivers/optical_stimulator/pictures/display_light.h"

namespace vbar::optical_stimulator {

struct DisplaySettings {
  std::string x_display;                         ///< ":7"; empty: that of the environment
  std::string output;                            ///< its name ("HDMI-1"); empty: the only one
  int width = 0, height = 0;                     ///< as calibrated; 0: as the output is
  std::chrono::milliseconds answer_limit{5000};  ///< wait for the X server; then it counts as lost
};

class Display {
 public:
  /// Opens the window, shows black and checks: the size of the output, gamma ramps that are identities, and that pixels
  /// read back are those sent. Throws std::runtime_error, one sentence that names the display. A process has one at a
  /// time.
  explicit Display(const DisplaySettings& settings);
  /// Shows black and closes the window.
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  [[nodiscard]] int width() const { return settings_.width; }
  [[nodiscard]] int height() const { return settings_.height; }

  /// Returns when the pixels of the picture, which must have the display's size, are on the screen. Not from two
  /// threads at a time. Throws std::runtime_error if the window has been lost or the X server does not answer.
  void show(const Picture& picture);

  /// Returns what the X server says the screen shows there now.
  [[nodiscard]] Picture read_back() const;

 private:
  struct Window;

  void check_pixels();
  [[nodiscard]] int draw(const Picture& picture);
  void check_connection() const;

  DisplaySettings settings_;
  std::unique_ptr<Window> window_;
};

}  // namespace vbar::optical_stimulator
