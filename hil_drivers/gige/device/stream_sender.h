#pragma once
// Stream channel of the emulated camera: sends blocks as paced packets, and packets of the last blocks again on
// request.

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "hil_drivers/gige/wire/gvsp.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::gige {

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

}  // namespace vbar::gige
