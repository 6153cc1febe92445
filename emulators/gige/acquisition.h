#pragma once
// Trigger, exposure and readout of the emulated camera. A callback gives what the detector sees.

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "emulators/gige/registers.h"
#include "hil_drivers/gige/protocol/gvsp.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::gige {

// Stream channel of the emulated camera: sends blocks as paced packets, and packets of the last blocks again on
// request.

/// Holds probabilities, of each packet that leaves.
struct PacketFaults {
  double loss = 0.0, duplicate = 0.0, reorder = 0.0;
};

struct StreamStatistics {
  std::int64_t blocks = 0;
  std::int64_t packets = 0;          ///< sent, with duplicates and those sent again
  std::int64_t resend_requests = 0;  ///< commands
  std::int64_t packets_resent = 0;
  std::int64_t packets_unavailable = 0;  ///< asked for again and not kept
  std::int64_t packets_lost = 0;         ///< by PacketFaults
};

class StreamSender {
 public:
  /// Throws boost::system::system_error if `address` is not one of this computer.
  StreamSender(boost::asio::io_context& context, const boost::asio::ip::address_v4& address, std::uint64_t seed);

  struct Channel {
    boost::asio::ip::udp::endpoint destination;
    std::uint32_t packet_size = 1400;  ///< with the headers of IP, UDP and GVSP
    std::chrono::nanoseconds packet_delay{0};
  };
  void set_channel(const Channel& channel) { channel_ = channel; }
  void set_faults(const PacketFaults& faults) { faults_ = faults; }
  /// Makes the sender silent: it drops what it has and what it gets.
  void set_silent(bool silent);

  /// Queues the block; its number follows from those before. Returns false if kMaxQueued blocks wait already.
  bool send(const wire::Leader& leader, wire::Bytes payload);
  void resend(const wire::PacketResend& request);
  /// Sends one packet of `channel.packet_size`, for a host that tries sizes.
  void send_test_packet(bool do_not_fragment);
  /// Drops the queue and the blocks kept.
  void clear();
  void close();

  [[nodiscard]] const StreamStatistics& statistics() const { return statistics_; }

  static constexpr std::size_t kMaxQueued = 4, kKept = 4;

 private:
  struct Block {
    std::uint16_t number = 0;
    wire::Leader leader;
    wire::Bytes payload;
    std::size_t data_bytes = 0;  ///< payload of a packet
    [[nodiscard]] std::uint32_t data_packets() const {
      return static_cast<std::uint32_t>((payload.size() + data_bytes - 1) / data_bytes);
    }
    [[nodiscard]] std::uint32_t last_packet() const { return data_packets() + 1; }
  };
  /// Holds the packets still to be sent of a block; without one: packets that are not kept.
  struct Run {
    std::shared_ptr<const Block> block;
    std::uint16_t number = 0;
    std::uint32_t next = 0, last = 0;
    bool again = false;
  };

  void pump();
  void send_next(Run& run);
  void encode(const Run& run);
  void transmit(const wire::Bytes& datagram);

  boost::asio::ip::udp::socket socket_;
  boost::asio::steady_timer timer_;
  engine::RandomStream random_;
  Channel channel_;
  PacketFaults faults_;
  bool is_silent_ = false;
  bool is_pumping_ = false;
  std::uint16_t next_number_ = 1;
  std::deque<Run> resends_, blocks_;
  std::deque<std::shared_ptr<const Block>> kept_;
  std::chrono::steady_clock::time_point due_;
  wire::Bytes datagram_, delayed_;
  StreamStatistics statistics_;
  std::shared_ptr<int> alive_ = std::make_shared<int>(0);
};

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
  std::int64_t frames_lost = 0, frames_repeated = 0, frames_delayed = 0;
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
  /// Delays the next `count` frames: each is sent after the next trigger only, before the frame of that trigger, with
  /// its own time stamp. `alone`: the frame of that trigger is delayed likewise, otherwise it follows at once.
  void delay_frames(int count, bool alone) {
    delayed_frames_ = count;
    delays_all_ = alone;
  }
  void set_payload_type(wire::PayloadType type) { payload_type_ = type; }
  /// Returns the time of the clock of the frames' time stamps.
  [[nodiscard]] std::uint64_t ticks() const;

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
      std::make_shared<int>(0);  ///< replaced by start and stop, which drops what had started before
  double exposure_factor_ = 1.0;
  int ignored_triggers_ = 0, lost_frames_ = 0, repeated_frames_ = 0, delayed_frames_ = 0;
  bool delays_all_ = false;
  std::shared_ptr<const Frame> last_frame_;     ///< that was sent
  std::shared_ptr<const Frame> delayed_frame_;  ///< that is sent after the next trigger
  wire::PayloadType payload_type_ = wire::PayloadType::kImage;
  AcquisitionStatistics statistics_;
};

}  // namespace vbar::gige
