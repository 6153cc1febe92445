#pragma once
// Output of packets, the only one of the flight software: headers, sequence counts, the sink.

#include <array>
#include <cstdint>
#include <tuple>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::messaging {

class Outbox {
 public:
  Outbox(std::uint8_t spacecraft, vbar_packet_sink sink, void* context)
      : spacecraft_(spacecraft), sink_(sink), context_(context) {}

  void set_sink(vbar_packet_sink sink, void* context) {
    sink_ = sink;
    context_ = context;
  }

  /// Encodes and sends a message that message_list.h lists as from the flight software. A message with a NaN or
  /// infinity is dropped and counted: the interface excludes such values. `unit` is that of the device concerned.
  template <class Message>
  void send(GpsTime time, const Message& message, std::uint8_t unit = 0) {
    packets::PacketHeader header;
    header.time = time;
    header.unit = unit;
    header.spacecraft = spacecraft_;
    std::uint16_t& count = std::get<SequenceCount<Message>>(sequence_counts_).next;
    header.sequence_count = count;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): encode writes what is read
    std::array<std::uint8_t, packets::kMaxPacketBytes> buffer;
    const Result<std::size_t> size = packets::encode(header, message, buffer);
    if (!size.ok()) {
      ++dropped_;
      return;
    }
    count = static_cast<std::uint16_t>((count + 1U) & 0x3FFFU);
    sink_(context_, buffer.data(), size.value());
  }

  [[nodiscard]] std::uint8_t spacecraft() const { return spacecraft_; }
  [[nodiscard]] std::int32_t dropped() const { return dropped_; }

  /// Holds the sequence count of the packets of one message: 14 bits.
  template <class Message>
  struct SequenceCount {
    std::uint16_t next = 0;
  };
  using SequenceCounts = packets::TupleOfRoute<&packets::is_from_flight, SequenceCount>::Type;
  /// Holds what outlives a step, for the snapshot.
  struct Retained {
    SequenceCounts sequence_counts;
    std::int32_t dropped = 0;
  };
  [[nodiscard]] Retained retained() const { return {sequence_counts_, dropped_}; }
  void restore(const Retained& retained) {
    sequence_counts_ = retained.sequence_counts;
    dropped_ = retained.dropped;
  }

 private:
  std::uint8_t spacecraft_;
  vbar_packet_sink sink_;
  void* context_;
  SequenceCounts sequence_counts_;
  std::int32_t dropped_ = 0;
};

}  // namespace vbar::fsw::messaging
