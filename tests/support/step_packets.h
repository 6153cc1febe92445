#pragma once
// Inputs of a step for tests of links and flight computers: packets of all sizes, and the tick that closes them.

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "fsw/packets/messages.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::test {

/// Time of step 0: an arbitrary epoch, 2011-07-18 01:00:15 GPS, and the paper's step of 10 s.
inline constexpr std::int64_t kFirstStepNs = 994'986'015'000'000'000;
inline constexpr std::int64_t kStepPeriodNs = 10'000'000'000;

/// `count` packets: count - 1 of random size and content, and the tick of `step`. The same for the same arguments.
inline std::vector<pil::Packet> step_packets(std::uint32_t step, std::size_t count) {
  namespace packets = fsw::packets;
  std::mt19937_64 random(step * 1000003ULL + count);
  std::array<std::uint8_t, packets::kMaxPacketBytes> bytes{};
  std::vector<pil::Packet> result;
  packets::PacketHeader header;
  header.time.ns = kFirstStepNs + step * kStepPeriodNs;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    std::vector<std::uint8_t> payload(1 + random() % packets::kMaxPayloadBytes);
    for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(random() % 3 == 0 ? 0 : random() >> 56U);
    header.apid = packets::Apid::kIdealNavigation;
    const auto size = packets::write_packet(header, payload, bytes);
    result.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value()));
  }
  vbar::tick tick{};
  tick.step = step;
  tick.period_ns = kStepPeriodNs;
  const auto size = packets::encode(header, tick, bytes);
  result.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value()));
  return result;
}

/// Packets per step that exercise the window of the link: one, a few, more than a window now and then.
inline std::size_t packet_count(std::uint32_t step) {
  return step % 16 == 5 ? 70 : 1 + step % 4;
}

/// All outputs of `steps` steps, one after the other.
inline std::vector<pil::Packet> fly(pil::FlightComputer& computer, std::uint32_t steps) {
  std::vector<pil::Packet> outputs;
  for (std::uint32_t step = 0; step < steps; ++step) {
    auto result = computer.step(step, step_packets(step, packet_count(step)));
    outputs.insert(outputs.end(), result.packets.begin(), result.packets.end());
  }
  return outputs;
}

/// The tiles of a camera image of 500 x 800 px at 12 bits, and the tick of `step`.
inline std::vector<pil::Packet> image_packets(std::uint32_t step) {
  namespace packets = fsw::packets;
  std::mt19937_64 random(step);
  std::array<std::uint8_t, packets::kMaxPacketBytes> bytes{};
  std::vector<pil::Packet> result;
  packets::PacketHeader header;
  header.time.ns = kFirstStepNs + step * kStepPeriodNs;
  vbar::image_tile tile{};
  tile.image = static_cast<std::int32_t>(step);
  tile.tiles = 461;
  tile.width = 500;
  tile.height = 800;
  tile.bits = 12;
  for (; tile.tile < tile.tiles; ++tile.tile) {
    tile.pixels = static_cast<std::int16_t>(tile.tile + 1 < tile.tiles ? 868 : 400'000 - 460 * 868);
    for (std::uint8_t& byte : tile.data) byte = static_cast<std::uint8_t>(random() >> 56U);
    header.sequence_count = static_cast<std::uint16_t>(tile.tile);
    const auto size = packets::encode(header, tile, bytes);
    result.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value()));
  }
  vbar::tick tick{};
  tick.step = step;
  tick.period_ns = kStepPeriodNs;
  const auto size = packets::encode(header, tick, bytes);
  result.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value()));
  return result;
}

}  // namespace vbar::test
