#pragma once
// A log of a run without the pixels of its images: it holds their recipes instead, and runs of tiles in place
// of the tiles that went to the flight software. A recipe and its runs are some 2 kB an image, the tiles 600 kB.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "host_sim/twins/camera/image_recipe.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::twins::camera {

/// Identifies an image as its tiles do: spacecraft, unit, number.
using ImageKey = std::tuple<std::uint8_t, std::uint8_t, std::int32_t>;

/// Writes such a log. Tiles of images whose recipe it was not given stay whole.
class RecipeLogWriter {
 public:
  /// As PacketLogWriter.
  explicit RecipeLogWriter(const std::filesystem::path& file) : writer_(file) {}

  /// Before the tiles of its image. Throws std::runtime_error for an invalid recipe.
  void write_recipe(fsw::GpsTime time, std::span<const std::uint8_t> recipe);

  /// Packets in order. A tile may be held back until it is known how far its run goes.
  void write(const PacketRecord& record);

  /// Writes what was held back: at the end of every step, because a run does not reach beyond one.
  void end_step();

  /// As PacketLogWriter.
  void finish() { writer_.finish(); }

 private:
  bool joins_run(const PacketRecord& record);

  PacketLogWriter writer_;
  std::set<ImageKey> known_;
  std::optional<PacketRecord> run_;
};

/// Restores the tiles by regenerating the images. One image at a time is kept.
class TileRestorer {
 public:
  /// The packets of an image, all its tiles in order.
  using MakeImage = std::function<std::vector<Packet>(const ImageRecipe&)>;

  /// `recipes` of a log (PacketLog::recipes). Throws std::runtime_error for a damaged one.
  TileRestorer(std::span<const std::vector<std::uint8_t>> recipes, MakeImage make_image);

  /// The packets of a run. Throws std::runtime_error, which names the image, if there is no recipe for it, or if the
  /// checksum of the regenerated tiles differs from that of the flown ones.
  std::vector<Packet> packets_of(const TileRun& run);

 private:
  std::map<ImageKey, ImageRecipe> recipes_;
  MakeImage make_image_;
  std::optional<ImageKey> made_;
  std::vector<Packet> packets_;  // of that image
};

}  // namespace vbar::twins::camera
