#pragma once
// GigE Vision camera by its IP address (Aravis 0.8): settings set and read back, software trigger, whole images only.
// Nothing is broadcast and no camera is searched for.
//
// An image belongs to its trigger: the camera's clock is latched before each trigger (GigE Vision, registers 0944h,
// 0948h, 094Ch), and an image with an earlier time stamp is refused and counted. For a camera without such a clock the
// stamps must rise, and after a trigger without an image the acquisition is restarted, which ends what is under way.

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "hil_drivers/gige/protocol/gvsp.h"
#include "hil_drivers/gige/protocol/stream_setup.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::gige {

/// Reports one sentence that begins with the camera's address.
class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Holds a whole image.
struct Frame {
  int width = 0, height = 0;
  std::vector<std::uint16_t> dn;  ///< right-aligned, rows of width
  int bits = 0;                   ///< resolution of the converter
  std::int64_t packets_resent = 0;
  std::int64_t stale_images = 0;   ///< images of other triggers that arrived before this one, refused
  double receive_s = 0.0;          ///< wall clock, from the trigger
  std::uint64_t timestamp_ns = 0;  ///< clock of the camera; 0: it states none
};

/// States why there is no image; the caller decides whether to try again.
struct NoFrame {
  enum class Reason {
    kTimeout,     ///< the trigger was acknowledged and no image came
    kIncomplete,  ///< packets are missing
    kNoAnswer,    ///< to the trigger: the camera is gone
    kNotOwner,    ///< another program has taken the camera, or its heartbeat was missed: reconnect()
    kInvalid,     ///< an image of another size or format
    kStale,       ///< only images that were exposed before the trigger came
    kStopped,     ///< stop() was called
  };
  Reason reason = Reason::kTimeout;
  std::string text;  ///< one sentence that begins with the address
};

class Camera {
 public:
  struct Settings {
    std::string address;                      ///< IPv4
    std::string interface_address;            ///< interface of this computer; empty: the one that routes to `address`
    std::string model;                        ///< that the camera's has to contain; empty: any
    std::string serial;                       ///< empty: any
    int sensor_width = 0, sensor_height = 0;  ///< 0: any
    double exposure_s = 0.2;
    double gain_db = 0.0;
    std::optional<double> black_level_percent;  ///< empty: as the camera has it
    twins::camera::Region region{710, 200, 500, 800};
    wire::PixelFormat pixel_format = wire::PixelFormat::kMono16;
    int converter_bits = 12;                ///< expected; the data decide
    int packet_size = 1400;                 ///< with the headers of IP, UDP and GVSP
    std::optional<double> packet_delay_us;  ///< empty: what the socket's buffer stands
    /// Size that is requested of the kernel; empty: what holds an image.
    std::optional<std::size_t> socket_buffer_bytes;
    double timeout_s = 1.0;  ///< for an image, beyond exposure and transfer
  };

  struct Identity {
    std::string vendor, model, version, manufacturer_info, serial;
    /// Returns true if the camera names itself an emulation.
    [[nodiscard]] bool is_emulated() const;
  };

  explicit Camera(Settings settings);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// Throws CameraError if the camera is absent, owned by another, another one, or does not accept a setting.
  void open();
  /// Triggers and waits for the image. Throws CameraError if the camera is not open.
  [[nodiscard]] std::variant<Frame, NoFrame> take();
  /// Changes the exposure of the images to come. Throws CameraError.
  void set_exposure(double exposure_s);
  /// Changes the region. Throws CameraError; the camera is then closed.
  void set_region(const twins::camera::Region& region);
  /// Opens again with all settings. Throws CameraError.
  void reconnect();
  /// Releases the camera; without effect if it is not open.
  void close() noexcept;
  /// Stops from any thread, also from a signal handler: take() returns kStopped within 50 ms of its wait, now and ever
  /// after.
  void stop() noexcept;

  /// Number of images of other triggers refused so far, late ones that were waiting at a trigger included.
  [[nodiscard]] std::int64_t stale_images() const;

  [[nodiscard]] bool is_open() const;
  [[nodiscard]] const Identity& identity() const;
  [[nodiscard]] const Settings& settings() const;
  /// Returns how the images travel, one sentence.
  [[nodiscard]] std::string transport() const;

 private:
  class Connection;
  Settings settings_;
  Identity identity_;
  std::int64_t stale_before_ = 0;  ///< number of earlier connections
  std::unique_ptr<Connection> connection_;
  struct Stop;
  std::unique_ptr<Stop> stop_;
};

}  // namespace vbar::gige
