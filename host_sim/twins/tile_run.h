#pragma once
// Image tiles that a log holds without their pixels.

#include <cstdint>
#include <optional>
#include <span>

#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

/// Consecutive tiles of one image, in order.
struct TileRun {
  std::uint8_t spacecraft = 0;  ///< as in the packets' headers
  std::uint8_t unit = 0;
  std::int32_t image = 0;
  std::int16_t first_tile = 0;
  std::int16_t tiles = 0;
  std::uint64_t checksum = 0;  ///< FNV-1a, 64 bits, of the packets' own CRCs, one after another
  [[nodiscard]] ImageKey key() const { return {spacecraft, unit, image}; }
  friend bool operator==(const TileRun&, const TileRun&) = default;
};

/// Returns the run of this packet alone; empty if it is not an image tile.
[[nodiscard]] std::optional<TileRun> tile_run_of(const Packet& packet);

/// Appends the run of the next tile; false, without a change, if it is not the next one. `packet` is the tile.
bool extend(TileRun& run, const TileRun& next, const Packet& packet);

/// Returns the checksum of a run of these packets, each a whole space packet.
[[nodiscard]] std::uint64_t checksum_of(std::span<const Packet> packets);

}  // namespace vbar::twins
