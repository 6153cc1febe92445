#include "host_sim/twins/camera/recipe_log.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "host_sim/twins/camera/image_tiles.h"

namespace vbar::twins::camera {
namespace {

ImageKey key_of(const TileRun& run) {
  return {run.spacecraft, run.unit, run.image};
}

ImageKey key_of(const ImageRecipe& recipe) {
  return {recipe.spacecraft, recipe.unit, image_number_on_link(recipe.exposure.number)};
}

[[noreturn]] void fail(const TileRun& run, const std::string& what) {
  throw std::runtime_error("image " + std::to_string(run.image) + ", tiles from " + std::to_string(run.first_tile) +
                           " on: " + what);
}

}  // namespace

void RecipeLogWriter::write_recipe(fsw::GpsTime time, std::span<const std::uint8_t> recipe) {
  const auto decoded = recipe_of(recipe);
  if (!decoded) throw std::runtime_error("a sensor gave an invalid image recipe");
  known_.insert(key_of(*decoded));
  writer_.write_recipe(time, {recipe.begin(), recipe.end()});
}

void RecipeLogWriter::write(const PacketRecord& record) {
  if (joins_run(record)) return;
  end_step();
  const auto tile = record.to_flight ? tile_run_of(record.packet) : std::nullopt;
  if (tile && known_.contains(key_of(*tile))) {
    run_ = PacketRecord{record.step, record.time, true, {}, tile};
  } else {
    writer_.write(record);
  }
}

bool RecipeLogWriter::joins_run(const PacketRecord& record) {
  if (!run_ || !record.to_flight) return false;
  const auto tile = tile_run_of(record.packet);
  return tile && extend(*run_->tiles, *tile, record.packet);
}

void RecipeLogWriter::end_step() {
  if (run_) writer_.write(*std::exchange(run_, std::nullopt));
}

TileRestorer::TileRestorer(std::span<const std::vector<std::uint8_t>> recipes, MakeImage make_image)
    : make_image_(std::move(make_image)) {
  for (const std::vector<std::uint8_t>& bytes : recipes) {
    auto recipe = recipe_of(bytes);
    if (!recipe) throw std::runtime_error("a recipe of an image is damaged");
    recipes_.insert_or_assign(key_of(*recipe), std::move(*recipe));
  }
}

std::vector<Packet> TileRestorer::packets_of(const TileRun& run) {
  const ImageKey key = key_of(run);
  if (made_ != key) {
    const auto recipe = recipes_.find(key);
    if (recipe == recipes_.end()) fail(run, "the log holds no recipe for it");
    packets_ = make_image_(recipe->second);
    made_ = key;
  }
  const auto begin = static_cast<std::size_t>(run.first_tile), count = static_cast<std::size_t>(run.tiles);
  if (begin + count > packets_.size())
    fail(run, "the image made again has " + std::to_string(packets_.size()) + " tiles only");
  std::vector<Packet> packets(packets_.begin() + run.first_tile, packets_.begin() + run.first_tile + run.tiles);
  if (checksum_of(packets) != run.checksum)
    fail(run,
         "made again it is not the image that was flown; images are the same to the last bit only with the same "
         "mission, data, program and kind of processor");
  return packets;
}

}  // namespace vbar::twins::camera
