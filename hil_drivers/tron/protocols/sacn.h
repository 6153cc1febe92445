#pragma once
// Data packets of ANSI E1.31-2018 (sACN: DMX512 over UDP), big-endian:
//
//     0  u16 0x0010, u16 0, "ASC-E1.17" padded to 12 bytes       root layer
//    16  flags 0x7 and length - 16, u32 4, CID[16]
//    38  flags 0x7 and length - 38, u32 2, source name[64]       framing layer
//   108  u8 priority, u16 universe of synchronisation, u8 sequence, u8 options, u16 universe
//   115  flags 0x7 and length - 115, u8 2, u8 0xA1, u16 0, u16 1, u16 1 + slots
//   125  u8 start code, slots

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron::sacn {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;
using Cid = std::array<std::uint8_t, 16>;  ///< identifies a source

inline constexpr std::uint16_t kPort = 5568;
inline constexpr std::size_t kMaxSlots = 512;
inline constexpr std::size_t kSlotsAt = 126;
inline constexpr std::size_t kMaxPacketBytes = kSlotsAt + kMaxSlots;
inline constexpr std::size_t kSourceNameBytes = 64;  ///< the last one of them NUL
inline constexpr int kMaxPriority = 200;
inline constexpr std::uint16_t kMaxUniverse = 63999;

struct DataPacket {
  Cid cid{};
  std::string source_name;
  std::uint8_t priority = 100;
  std::uint16_t synchronisation = 0;  ///< universe; 0: none
  std::uint8_t sequence = 0;
  bool is_preview = false;     ///< not meant for lights
  bool is_terminated = false;  ///< the source ends; the slots are without meaning
  bool is_synchronisation_forced = false;
  std::uint16_t universe = 1;
  std::uint8_t start_code = 0;  ///< 0: levels
  std::vector<std::uint8_t> slots;
  friend bool operator==(const DataPacket&, const DataPacket&) = default;
};

/// Replaces the content of `datagram`. Throws std::invalid_argument for a field that E1.31 does not permit.
void encode_data_packet(const DataPacket& packet, Bytes& datagram);

/// Decodes bytes from the network. Throws std::invalid_argument with the position of the error.
[[nodiscard]] DataPacket decode_data_packet(ByteSpan datagram);

// Values of 16 bits in slots of DMX512: two adjacent slots, the coarse one first.

/// Stores the values in `slots` from number `start_slot` (from 1); `slots` has to be long enough.
inline void store_values(std::span<const std::uint16_t> values, int start_slot, std::vector<std::uint8_t>& slots) {
  auto at = static_cast<std::size_t>(start_slot - 1);
  for (const std::uint16_t value : values) {
    slots[at++] = static_cast<std::uint8_t>(value >> 8U);
    slots[at++] = static_cast<std::uint8_t>(value & 0xFFU);
  }
}

/// Loads values from slots; slots that a packet does not have are zero.
inline void load_values(std::span<const std::uint8_t> slots, int start_slot, std::span<std::uint16_t> values) {
  auto at = static_cast<std::size_t>(start_slot - 1);
  const auto next = [&]() -> unsigned { return at < slots.size() ? slots[at++] : 0U; };
  for (std::uint16_t& value : values) {
    const unsigned coarse = next();
    value = static_cast<std::uint16_t>((coarse << 8U) | next());
  }
}

// Source of sACN: sends levels of lights to one receiver, unicast. Nothing acknowledges them.

/// Returns the CID of the source that controls the lights of a testbed: the same whenever it is started. A UUID of
/// version 8 (RFC 9562).
[[nodiscard]] Cid cid_of_bench(const std::string& bench);

class Sender {
 public:
  static constexpr int kTerminatedPackets = 3;
  static constexpr double kKeepAliveSeconds = 0.8;  ///< E1.31 6.6.1: between 800 and 1000 ms

  /// Sends to `settings.address`. Throws std::runtime_error, std::invalid_argument.
  Sender(const SacnSettings& settings, const std::string& bench);
  /// Ends the source if it is still active.
  ~Sender();
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  /// Sends values from the start slot of the settings; the other slots are zero. Throws std::runtime_error if the
  /// system does not accept the datagram, std::invalid_argument if the values do not fit into the universe.
  void send(std::span<const std::uint16_t> values);
  /// Sends the last values again; nothing if there are none or the source has ended. It has to be called at least every
  /// kKeepAliveSeconds: a receiver drops a source after 2.5 s.
  void keep_alive();
  /// Sends three packets with the option "terminated"; send() starts the source again.
  void terminate() noexcept;

  [[nodiscard]] std::uint64_t packets() const;
  /// Returns the name for messages: "lights at 127.0.20.4:5568, universe 1".
  [[nodiscard]] std::string description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::sacn
