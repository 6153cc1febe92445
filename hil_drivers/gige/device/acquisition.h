#pragma once
// Trigger, exposure and readout of the emulated camera. A callback gives what the detector sees.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "hil_drivers/gige/device/registers.h"
#include "hil_drivers/gige/device/stream_sender.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::gige {

/// Requests one exposure.
struct Request {
  twins::camera::Region region;
  double exposure_s = 0.0;
  double gain_db = 0.0;
  double black_level_dn = 0.0;  ///< offset in numbers of the converter
  std::int64_t number = 0;      ///< exposures before this one
};

/// Holds rows of region.width, right-aligned numbers of the converter.
struct Image {
  std::vector<std::uint16_t> dn;
};

/// Exposes; called when an exposure begins, on the thread of the io_context. Throws nothing.
using Expose = std::function<Image(const Request& request)>;

enum class Pace {
  kFast,  ///< exposure and readout take no time
  kReal,
};

struct AcquisitionStatistics {
  std::int64_t triggers = 0;
  std::int64_t triggers_dropped = 0;  ///< during an exposure
  std::int64_t exposures = 0;
  std::int64_t frames_dropped = 0;  ///< with the stream channel full
  std::int64_t frames_lost = 0, frames_repeated = 0;
};

class Acquisition {
 public:
  Acquisition(boost::asio::io_context& context, Registers& registers, StreamSender& sender, const Description& camera,
              Pace pace, double readout_s, Expose expose);

  void start();
  void stop();
  /// Triggers; without effect during an exposure, as with cameras of Point Grey.
  void trigger();

  void set_exposure_factor(double factor) { exposure_factor_ = factor; }
  /// Ignores the next `count` triggers: they are acknowledged and have no effect.
  void ignore_triggers(int count) { ignored_triggers_ = count; }
  /// Loses the next `count` frames: they are exposed and not sent.
  void lose_frames(int count) { lost_frames_ = count; }
  /// Repeats frames: in the place of the next `count` frames the one before is sent, with its time stamp.
  void repeat_frames(int count) { repeated_frames_ = count; }
  void set_payload_type(wire::PayloadType type) { payload_type_ = type; }

  [[nodiscard]] const AcquisitionStatistics& statistics() const { return statistics_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame;

  [[nodiscard]] bool is_triggered() const;
  [[nodiscard]] double frame_period_s() const;
  void begin_exposure();
  void expose();
  void end_exposure(Frame frame);
  void read_out(std::shared_ptr<const Frame> frame);
  /// Sends without the faults of frames.
  void send(const Frame& frame);
  /// Calls `next` after `delay_s` at real pace, at fast pace at the next turn of the context; not after stop().
  void after(double delay_s, std::function<void()> next);
  void run_freely();

  boost::asio::io_context& context_;
  Registers& registers_;
  StreamSender& sender_;
  Description camera_;
  Pace pace_;
  double readout_s_;
  Expose expose_;
  Clock::time_point epoch_ = Clock::now();
  boost::asio::steady_timer frame_timer_;
  bool is_acquiring_ = false;
  bool is_exposing_ = false;
  std::shared_ptr<int> run_ =
      std::make_shared<int>(0);  ///< replaced by start and stop, so that what was begun before is dropped
  double exposure_factor_ = 1.0;
  int ignored_triggers_ = 0, lost_frames_ = 0, repeated_frames_ = 0;
  std::shared_ptr<const Frame> last_frame_;  ///< that was sent
  wire::PayloadType payload_type_ = wire::PayloadType::kImage;
  AcquisitionStatistics statistics_;
};

}  // namespace vbar::gige
