#pragma once
// Converts an exposure into pixels: the renderer and the detector of the digital twin, or the driver of an optical
// testbed. Timing, numbering and packets are the sensor's (camera_sensor.h).

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/photon_image.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

struct TakenImage {
  std::vector<std::uint16_t> dn;  ///< the pixels of the camera's region, rows from the top
  std::vector<Note> notes = {};   ///< on this image: achieved pose, retries
  std::string failure = {};       ///< if there is no image: why, one sentence
};

class ImageTaker {
 public:
  ImageTaker() = default;
  ImageTaker(const ImageTaker&) = delete;
  ImageTaker& operator=(const ImageTaker&) = delete;
  virtual ~ImageTaker() = default;

  // As those of PacketSource.
  virtual void start(fsw::GpsTime first_epoch) { static_cast<void>(first_epoch); }
  /// Stops the taker, from another thread than take(), which then returns without delay.
  virtual void stop(StopReason reason) { static_cast<void>(reason); }

  /// Takes an image, on the sensor's own thread, always the same one. An exception ends the run.
  virtual TakenImage take(const Exposure& exposure) = 0;

  /// Returns whether take() is a pure function of the exposure, so that a log may keep the exposure in place of the
  /// pixels.
  [[nodiscard]] virtual bool is_reproducible() const { return false; }

  /// Returns the figures so far; also called while take() runs.
  [[nodiscard]] virtual std::vector<Note> statistics() const { return {}; }
};

// The digital camera: from an exposure to an image by renderer and detector. The sensor takes its images with it; a
// replay regenerates the packets with it from the recipes of a log.

/// Fills the image, whose region is set and whose pixels are zero, with expected photo-electrons: a pure function of
/// the exposure.
using Renderer = std::function<void(const Exposure&, PhotonImage&)>;

class ImageMaker final : public ImageTaker {
 public:
  struct Settings {
    CameraSettings camera;
    std::string name;  ///< of the camera, e.g. "servicer/camera": names its random numbers
    std::uint64_t seed = 0;
    std::uint8_t spacecraft = 0;  ///< flight number of the spacecraft whose flight software receives the images
    std::uint8_t unit = 0;        ///< number of the camera
  };

  /// Makes a camera; `renderer` must not be empty.
  ImageMaker(const Settings& settings, Renderer renderer);

  /// Takes an image: a pure function of the settings and the exposure.
  TakenImage take(const Exposure& exposure) override;
  [[nodiscard]] bool is_reproducible() const override { return true; }
  /// Returns "render_s" and "detector_s": wall-clock time spent.
  [[nodiscard]] std::vector<Note> statistics() const override;

  /// Returns the packets of the image.
  std::vector<Packet> packets_of(const Exposure& exposure);

  [[nodiscard]] const Settings& settings() const { return settings_; }
  [[nodiscard]] const Detector& detector() const { return detector_; }

 private:
  Settings settings_;
  Renderer renderer_;
  Detector detector_;
  PhotonImage photons_;
  std::atomic<double> render_s_{0.0};
  std::atomic<double> detector_s_{0.0};
};

/// Returns the packets of an image taken.
std::vector<Packet> packets_of(const ImageMaker::Settings& settings, const Exposure& exposure,
                               std::span<const std::uint16_t> dn);

/// Adds the time from its construction to its destruction, s.
class Stopwatch {
 public:
  explicit Stopwatch(std::atomic<double>& total_s) : total_s_(total_s) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { total_s_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  std::atomic<double>& total_s_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace vbar::twins::camera
