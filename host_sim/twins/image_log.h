#pragma once
// The log of a run without the tiles of its images: it holds what they can be made from, and runs of tiles in place of
// the tiles that went to the flight software. The tiles of an image are 600 kB, its recipe and its runs 2 kB, its
// recording some 120 kB.

#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "host_sim/twins/packet_log.h"

namespace vbar::twins {

/// Writes such a log. Tiles of images of which it was given neither recipe nor recording stay whole.
class ImageLogWriter {
 public:
  /// Form of a tile in the log.
  enum class Tiles {
    kAsRuns,
    kWhole,  ///< nothing: recipes are not kept; recordings are, so that an image is in the log before it is used
  };

  /// Creates the log as PacketLogWriter does.
  ImageLogWriter(const std::filesystem::path& file, Tiles tiles, EventCheck check = {})
      : writer_(file, std::move(check)), tiles_(tiles) {}

  /// Writes a recipe, before the tiles of its image.
  void write_recipe(fsw::GpsTime time, const LoggedImage& recipe);
  /// Writes a recording, before the tiles of its image. It is in the file when the function returns.
  void write_recording(fsw::GpsTime time, const LoggedImage& recording);

  /// Writes a packet; packets come in order. A tile may be held back until it is known how far its run goes.
  void write(const PacketRecord& record);

  /// Ends a step; called at the end of every step, because a run of tiles does not reach beyond one. It writes what was
  /// held back. All that was written outlives the program then. Throws as PacketLogWriter.
  void end_step();

  /// Ends the log as PacketLogWriter does.
  void finish() { writer_.finish(); }

 private:
  bool joins_run(const PacketRecord& record);
  void end_run();

  PacketLogWriter writer_;
  Tiles tiles_;
  std::set<ImageKey> known_;
  std::optional<PacketRecord> run_;
};

}  // namespace vbar::twins
