#include "host_sim/twins/camera/tile_restorer.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "host_sim/twins/camera/image_tiles.h"
#include "host_sim/twins/camera/recorded_image.h"
#include "host_sim/twins/lcm_log_reader.h"

namespace vbar::twins::camera {
namespace {

ImageKey key_of(const ImageRecipe& recipe) {
  return {recipe.spacecraft, recipe.unit, image_number_on_link(recipe.exposure.number)};
}

}  // namespace

TileRestorer::TileRestorer(ImagesOfLog&& images, MakeImage make_image)
    : log_(std::move(images)), make_image_(std::move(make_image)) {
  for (std::size_t k = 0; k < log_.recipes.size(); ++k) add_recipe(k);
  for (std::size_t k = 0; k < log_.recordings.size(); ++k) add_recording(k);
}

void TileRestorer::add_recipe(std::size_t place) {
  const auto recipe = recipe_of(log_.recipes[place]);
  if (!recipe) throw DamagedLog(log_.file.string() + ": a recipe of an image is damaged");
  images_[key_of(*recipe)].recipe = place;
  keys_[recipe->exposure.time] = key_of(*recipe);
}

void TileRestorer::add_recording(std::size_t place) {
  const ImagesOfLog::Recording& recording = log_.recordings[place];
  const auto header = header_of_recorded_image(recording.bytes);
  if (!header)
    throw DamagedLog(log_.file.string() + ": byte " + std::to_string(recording.offset) +
                     ": a damaged record of an image");
  images_[header->key()].recording = place;
  keys_[header->label.time] = header->key();
}

void TileRestorer::fail(const TileRun& run, const std::string& what) const {
  throw std::runtime_error(log_.file.string() + ": image " + std::to_string(run.image) + ", tiles from " +
                           std::to_string(run.first_tile) + " on: " + what);
}

std::vector<Packet> TileRestorer::packets_of(const TileRun& run) {
  const ImageKey key = run.key();
  if (made_ != key) {
    made_.reset();
    packets_ = all_packets_of(run);
    made_ = key;
  }
  const auto begin = static_cast<std::size_t>(run.first_tile), count = static_cast<std::size_t>(run.tiles);
  if (begin + count > packets_.size())
    fail(run, "the restored image has " + std::to_string(packets_.size()) + " tiles only");
  std::vector<Packet> packets(packets_.begin() + run.first_tile, packets_.begin() + run.first_tile + run.tiles);
  if (checksum_of(packets) == run.checksum) return packets;
  fail(run, images_.at(key).recording
                ? "the recorded image is not the image that was flown"
                : "made again it is not the image that was flown; images are the same to the last bit only with the "
                  "same mission, data, program and kind of processor");
}

std::vector<Packet> TileRestorer::all_packets_of(const TileRun& run) const {
  const auto image = images_.find(run.key());
  if (image == images_.end()) fail(run, "the log holds neither recipe nor pixels of it");
  if (image->second.recording) return recorded_packets(*image->second.recording, run);
  return make_image_(*recipe_of(log_.recipes[*image->second.recipe]));
}

std::vector<Packet> TileRestorer::recorded_packets(std::size_t recording, const TileRun& run) const {
  const std::vector<std::uint8_t>& bytes = log_.recordings[recording].bytes;
  const ImageHeader header = *header_of_recorded_image(bytes);
  try {
    return image_tiles(header.label, header.region, header.bits, pixels_of_recorded_image(bytes));
  } catch (const std::exception& error) {
    throw DamagedLog(log_.file.string() + ": image " + std::to_string(run.image) + ", at byte " +
                     std::to_string(log_.recordings[recording].offset) + ", " + error.what());
  }
}

std::vector<fsw::GpsTime> TileRestorer::exposures() const {
  std::vector<fsw::GpsTime> times;
  times.reserve(keys_.size());
  for (const auto& [time, key] : keys_) times.push_back(time);
  return times;
}

const TileRestorer::Image* TileRestorer::find(fsw::GpsTime exposure) const {
  const auto key = keys_.find(exposure);
  return key == keys_.end() ? nullptr : &images_.at(key->second);
}

std::optional<LoggedImage> TileRestorer::recipe_at(fsw::GpsTime exposure) const {
  const Image* const image = find(exposure);
  if (image == nullptr || !image->recipe) return std::nullopt;
  return LoggedImage{keys_.at(exposure), log_.recipes[*image->recipe]};
}

std::optional<LoggedImage> TileRestorer::recording_at(fsw::GpsTime exposure) const {
  const Image* const image = find(exposure);
  if (image == nullptr || !image->recording) return std::nullopt;
  return LoggedImage{keys_.at(exposure), log_.recordings[*image->recording].bytes};
}

}  // namespace vbar::twins::camera
