#include "host_sim/twins/tile_run.h"

#include "fsw/packets/messages.h"

namespace vbar::twins {
namespace {

constexpr std::uint64_t kFnvOffset = 0xcbf29ce484222325U;
constexpr std::uint64_t kFnvPrime = 0x00000100000001b3U;

/// Adds a packet by its CRC, in which the packet ends.
std::uint64_t add_to_checksum(std::uint64_t checksum, const Packet& packet) {
  for (const std::uint8_t byte : std::span(packet).last(fsw::packets::kPacketCrcBytes))
    checksum = (checksum ^ byte) * kFnvPrime;
  return checksum;
}

}  // namespace

std::optional<TileRun> tile_run_of(const Packet& packet) {
  const auto view = fsw::packets::parse_packet(packet);
  if (!view.ok() || view.value().header.apid != fsw::packets::Apid::kImageTile) return std::nullopt;
  const auto tile = fsw::packets::decode<image_tile>(view.value());
  if (!tile.ok()) return std::nullopt;
  TileRun run;
  run.spacecraft = view.value().header.spacecraft;
  run.unit = view.value().header.unit;
  run.image = tile.value().image;
  run.first_tile = tile.value().tile;
  run.tiles = 1;
  run.checksum = add_to_checksum(kFnvOffset, packet);
  return run;
}

bool extend(TileRun& run, const TileRun& next, const Packet& packet) {
  const bool follows = next.spacecraft == run.spacecraft && next.unit == run.unit && next.image == run.image &&
                       next.first_tile == run.first_tile + run.tiles;
  if (!follows) return false;
  run.tiles = static_cast<std::int16_t>(run.tiles + 1);
  run.checksum = add_to_checksum(run.checksum, packet);
  return true;
}

std::uint64_t checksum_of(std::span<const Packet> packets) {
  std::uint64_t checksum = kFnvOffset;
  for (const Packet& packet : packets) checksum = add_to_checksum(checksum, packet);
  return checksum;
}

}  // namespace vbar::twins
