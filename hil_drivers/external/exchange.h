#pragma once
// Exchange between a run and a sensor in another process at each epoch: a batch of packets to the sensor that ends with
// a tick, and its answer, which ends with a source_answer (fsw/packets/vbar.lcm). A truth in another process is a
// source too: the packets of its answers are the truth. Both ends use these functions.

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/packet.h"
#include "host_sim/mission/mission.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::external {

/// Names of spacecraft in the truth and their numbers in packets.
class SpacecraftNumbers {
 public:
  void add(std::string name, std::uint8_t number) { known_.push_back({std::move(name), number}); }
  [[nodiscard]] std::optional<std::uint8_t> number_of(std::string_view name) const;
  /// Returns the name of a number; "spacecraft 7" for an unknown number.
  [[nodiscard]] std::string name_of(std::uint8_t number) const;

 private:
  struct Known {
    std::string name;
    std::uint8_t number = 0;
  };
  std::vector<Known> known_;
};

[[nodiscard]] SpacecraftNumbers numbers_of(const mission::Mission& mission);

/// Name of the source that is the truth.
inline constexpr std::string_view kTruth = "truth";

/// Source that the first batch opens.
struct Opening {
  std::string name;
  std::int64_t seed = 0;
  std::uint8_t spacecraft = 0;  ///< number in its packets' headers
  std::uint8_t unit = 0;        ///< number in its packets' headers
};

struct Command {
  twins::Packet packet;
  fsw::GpsTime effective;
};

/// Batch of packets to the source.
struct Batch {
  fsw::GpsTime time;
  std::optional<Opening> opening;  ///< the first batch only
  std::vector<Command> commands;
  std::optional<twins::TruthSnapshot> truth;  ///< to a sensor, after the first batch; to a truth, in the first
};

struct Answer {
  std::vector<twins::Packet> packets;
  bool is_failed = false;  ///< no measurement at this epoch
  fsw::GpsTime available;
  std::optional<fsw::GpsTime> next_epoch;
};

/// Encodes a batch or an answer. Throws std::runtime_error for a truth that is not finite or has a spacecraft without a
/// number, and for a name or a command that is too long.
[[nodiscard]] std::vector<twins::Packet> packets_of(const Batch& batch, std::int64_t step,
                                                    const SpacecraftNumbers& numbers);
[[nodiscard]] std::vector<twins::Packet> packets_of(Answer answer, fsw::GpsTime time);

/// Encodes the Earth's orientation and a state of each spacecraft. Throws as packets_of(Batch).
[[nodiscard]] std::vector<twins::Packet> packets_of(const twins::TruthSnapshot& truth,
                                                    const SpacecraftNumbers& numbers);

/// Decodes a batch or an answer. Both functions throw std::runtime_error, one sentence, for packets that are not a
/// batch or an answer.
[[nodiscard]] Batch batch_of(std::span<const twins::Packet> packets, const SpacecraftNumbers& numbers);
[[nodiscard]] Answer answer_of(std::vector<twins::Packet> packets);

/// Content of a truth's answer.
struct StatedTruth {
  twins::TruthSnapshot truth;  ///< spacecraft in the order of the packets
  bool has_earth = false;
};

/// Decodes the answer of a truth. Throws std::runtime_error, the reason, for packets other than a true_state of some
/// spacecraft, each once, and at most one true_earth, all of `time` and of finite content.
[[nodiscard]] StatedTruth truth_of(std::span<const twins::Packet> packets, fsw::GpsTime time,
                                   const SpacecraftNumbers& numbers);

/// Returns the reason why a packet of a sensor is not accepted; empty if it is. It must be whole, of an allowed message
/// of finite content, and have this spacecraft and unit.
[[nodiscard]] std::string fault_of(std::span<const std::uint8_t> packet, std::span<const fsw::packets::Apid> allowed,
                                   std::uint8_t spacecraft, std::uint8_t unit);

/// Returns the packet of a message. Throws std::runtime_error for a number that is not finite.
template <class Message>
[[nodiscard]] twins::Packet packet_of(const fsw::packets::PacketHeader& header, const Message& message) {
  twins::Packet packet(fsw::packets::kMaxPacketBytes);
  const auto size = fsw::packets::encode(header, message, packet);
  if (!size.ok()) throw std::runtime_error("a number that is not finite");
  packet.resize(size.value());
  return packet;
}

}  // namespace vbar::external
