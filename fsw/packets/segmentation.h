#pragma once
// Messages longer than a packet. They are cut into segments that travel as packets of one APID with consecutive
// sequence counts (CCSDS 133.0-B-2, 4.1.3.4.2 sequence flags), and reassembled on the other side. All segments carry
// the time, spacecraft and unit of the message.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/packets/packet.h"

namespace vbar::fsw::packets {

/// Cuts one payload into packets. The payload must outlive the segmenter.
class Segmenter {
 public:
  /// `header.sequence_count` is that of the first segment; the flags are set here. `segment_bytes` (1 to
  /// kMaxPayloadBytes, else the nearest of these) is the payload of every packet but the last.
  Segmenter(const PacketHeader& header, std::span<const std::uint8_t> payload,
            std::size_t segment_bytes = kMaxPayloadBytes);

  [[nodiscard]] bool done() const { return done_; }
  /// Writes the next packet and returns its length; afterwards header().sequence_count is the one to continue with.
  /// kNotReady when done; kTooLong if `out` is too small, and the same segment can be tried again.
  Result<std::size_t> next(std::span<std::uint8_t> out);
  [[nodiscard]] const PacketHeader& header() const { return header_; }

 private:
  PacketHeader header_;
  std::span<const std::uint8_t> rest_;
  std::size_t segment_bytes_;
  bool first_ = true;
  bool done_ = false;
};

/// The packets that a reassembler accepts.
struct Stream {
  Apid apid = Apid::kTick;
  std::uint8_t spacecraft = 0;
  std::uint8_t unit = 0;
};

/// Reassembles the segments of one stream in memory of its owner. A segment that does not fit changes only a counter,
/// so a message survives duplicates and segments that arrive early, as long as the missing one is sent again.
class SegmentAssembly {
 public:
  struct Counters {
    std::uint32_t messages = 0;    ///< completed
    std::uint32_t duplicates = 0;  ///< segments or packets that were received already
    std::uint32_t misplaced = 0;   ///< segments without a beginning, or ahead of a missing one
    std::uint32_t abandoned = 0;   ///< messages whose end never came before the next message began
    std::uint32_t oversized = 0;   ///< messages longer than the memory, dropped completely
  };

  SegmentAssembly(const Stream& stream, std::span<std::uint8_t> memory) : stream_(stream), memory_(memory) {}

  /// Processes the next packet received. When it completes a message, returns the message as if it had come in one
  /// packet (kUnsegmented, sequence count of its first segment); its payload is valid until the next call. Otherwise
  /// kNotReady (accepted, more is needed), kWrongType (packet of another stream), kBadSequence (duplicate or
  /// misplaced), kTooLong (message too long).
  Result<PacketView> push(const PacketView& packet);

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// Returns true for a packet of a message that is complete already.
  [[nodiscard]] bool is_past(const PacketHeader& header) const;
  Result<PacketView> begin(const PacketView& packet);
  Result<PacketView> proceed(const PacketView& packet);
  Result<PacketView> take(const PacketView& packet);

  Stream stream_;
  std::span<std::uint8_t> memory_;
  PacketHeader first_;  ///< header of the message's first segment
  std::size_t size_ = 0;
  std::uint16_t expected_ = 0;  ///< sequence count of the next segment
  bool assembling_ = false;
  bool has_completed_ = false;
  std::uint16_t completed_until_ = 0;  ///< sequence count after the last completed message
  GpsTime completed_time_;
  Counters counters_;
};

/// SegmentAssembly with memory of its own for messages of up to `kCapacity` payload bytes.
template <std::size_t kCapacity>
class Reassembler {
 public:
  explicit Reassembler(const Stream& stream) : assembly_(stream, memory_) {}
  Reassembler(const Reassembler&) = delete;
  Reassembler& operator=(const Reassembler&) = delete;

  /// Processes a packet as SegmentAssembly::push does.
  Result<PacketView> push(const PacketView& packet) { return assembly_.push(packet); }
  [[nodiscard]] const SegmentAssembly::Counters& counters() const { return assembly_.counters(); }

 private:
  std::array<std::uint8_t, kCapacity> memory_{};
  SegmentAssembly assembly_;
};

}  // namespace vbar::fsw::packets
