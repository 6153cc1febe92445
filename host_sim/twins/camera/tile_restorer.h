#pragma once
// The tiles of images that a log holds as recipes or recordings.

#include <functional>
#include <map>
#include <optional>
#include <set>

#include "host_sim/twins/camera/image_recipe.h"
#include "host_sim/twins/tile_source.h"

namespace vbar::twins::camera {

/// Restores the tiles from the recorded pixels or, without these, by rendering the image of the recipe. One image at a
/// time is kept as packets.
class TileRestorer final : public TileSource {
 public:
  /// The packets of an image, all its tiles in order.
  using MakeImage = std::function<std::vector<Packet>(const ImageRecipe&)>;

  /// Throws DamagedLog, which names the file, for a damaged recipe or recording; the pixels of recordings are decoded
  /// when they are needed.
  TileRestorer(ImagesOfLog&& images, MakeImage make_image);

  /// Restores the packets of a run. Also throws std::runtime_error if the log holds nothing of the image, or if the
  /// checksum of the restored tiles differs from that of the tiles in the recorded run.
  std::vector<Packet> packets_of(const TileRun& run) override;

  [[nodiscard]] std::vector<fsw::GpsTime> exposures() const override;
  [[nodiscard]] std::optional<LoggedImage> recipe_at(fsw::GpsTime exposure) const override;
  [[nodiscard]] std::optional<LoggedImage> recording_at(fsw::GpsTime exposure) const override;

 private:
  /// Places in the lists of the log.
  struct Image {
    std::optional<std::size_t> recipe, recording;
  };
  void add_recipe(std::size_t place);
  void add_recording(std::size_t place);
  [[nodiscard]] const Image* find(fsw::GpsTime exposure) const;
  [[nodiscard]] std::vector<Packet> all_packets_of(const TileRun& run) const;
  [[nodiscard]] std::vector<Packet> recorded_packets(std::size_t recording, const TileRun& run) const;
  [[noreturn]] void fail(const TileRun& run, const std::string& what) const;

  ImagesOfLog log_;
  MakeImage make_image_;
  std::map<ImageKey, Image> images_;
  std::map<fsw::GpsTime, ImageKey> keys_;  ///< by the time of the exposure
  std::optional<ImageKey> made_;
  std::vector<Packet> packets_;  // packets of that image
};

}  // namespace vbar::twins::camera
