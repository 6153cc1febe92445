#pragma once
// Exchange of a picture for an image: shows the picture, takes an image and accepts it only if the frame strip in it
// states that it shows this picture at the calibrated brightness. Else it takes another one, a number of times.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "hil_drivers/optical_stimulator/pictures/display_light.h"
#include "hil_drivers/optical_stimulator/pictures/frame_strip.h"

namespace vbar::optical_stimulator {

// Interfaces of display and camera to the exchange of a picture for an image.

class Screen {
 public:
  Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  virtual ~Screen() = default;

  /// Returns when the picture is on the screen. Throws std::runtime_error, one sentence.
  virtual void show(const Picture& picture) = 0;
};

struct CameraFrame {
  std::vector<std::uint16_t> dn;  ///< pixels of the region, rows from the top
  int packets_resent = 0;
  int tries = 1;           ///< triggers until it was whole
  double receive_s = 0.0;  ///< wall clock, from the trigger
  int stale = 0;           ///< images of earlier triggers, refused
};

class FrameCamera {
 public:
  FrameCamera() = default;
  FrameCamera(const FrameCamera&) = delete;
  FrameCamera& operator=(const FrameCamera&) = delete;
  virtual ~FrameCamera() = default;

  /// Takes a new exposure, whole. Throws std::runtime_error, one sentence that names the camera, if it does not
  /// deliver.
  virtual CameraFrame take() = 0;
  /// Opens the camera again with all its settings. Throws as take().
  virtual void reopen() = 0;
};

struct ExchangeSettings {
  int width = 500;                           ///< width of the camera's region
  std::chrono::nanoseconds settle{};         ///< from the picture on the screen to the trigger
  std::chrono::nanoseconds display_frame{};  ///< further wait before another try
  double gain_dn_per_electron = 0.125;
  double white_electrons = 12000.0;  ///< light of the white cells of the strip, as calibrated
  double brightness_tolerance = 0.05;
  int retries = 3;
  std::uint16_t first_frame = 1;            ///< number of the first picture
  std::chrono::milliseconds absence{5000};  ///< absence of the camera after which the run ends
};

struct ExchangedImage {
  std::vector<std::uint16_t> dn;  ///< camera's region below the strip
  std::uint16_t frame = 0;        ///< number of the picture
  int tries = 1;                  ///< images taken for it
  int stale = 0;                  ///< images of another picture or of an earlier trigger, refused
  int packets_resent = 0;
  int reconnects = 0;
  double brightness = 0.0;               ///< brightness of the strip, relative to the calibration
  double show_s = 0.0, receive_s = 0.0;  ///< wall clock, of all tries
};

class Exchange {
 public:
  Exchange(const ExchangeSettings& settings, const FrameStrip& strip, Screen& screen, FrameCamera& camera)
      : settings_(settings), strip_(strip), screen_(screen), camera_(camera), next_(settings.first_frame) {}

  /// Draws the next number into the strip of the picture and returns the image that shows it. Throws
  /// std::runtime_error, one sentence, when all tries have failed or after cancel().
  ExchangedImage take(Picture& picture);

  /// Returns the number of the next picture.
  [[nodiscard]] std::uint16_t next_frame() const { return next_; }

  /// Cancels from another thread: take() does not wait any longer.
  void cancel() { is_cancelled_ = true; }

 private:
  struct Trouble;  // Counts the failures of one picture so far.

  CameraFrame take_frame(ExchangedImage& image);
  void reconnect(const std::string& reason, ExchangedImage& image);
  [[nodiscard]] bool is_accepted(const CameraFrame& frame, ExchangedImage& image, Trouble& trouble) const;
  void wait(std::chrono::nanoseconds span) const;

  ExchangeSettings settings_;
  const FrameStrip& strip_;
  Screen& screen_;
  FrameCamera& camera_;
  std::uint16_t next_;
  std::atomic<bool> is_cancelled_{false};
};

}  // namespace vbar::optical_stimulator
