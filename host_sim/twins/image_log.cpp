#include "host_sim/twins/image_log.h"

#include <utility>

namespace vbar::twins {

void ImageLogWriter::write_recipe(fsw::GpsTime time, const LoggedImage& recipe) {
  if (tiles_ == Tiles::kWhole) return;
  known_.insert(recipe.key);
  writer_.write_recipe(time, recipe.bytes);
}

void ImageLogWriter::write_recording(fsw::GpsTime time, const LoggedImage& recording) {
  if (tiles_ == Tiles::kAsRuns) known_.insert(recording.key);
  writer_.write_recording(time, recording.bytes);
}

void ImageLogWriter::write(const PacketRecord& record) {
  if (joins_run(record)) return;
  end_run();
  const auto tile = record.to_flight ? tile_run_of(record.packet) : std::nullopt;
  if (tile && known_.contains(tile->key())) {
    run_ = PacketRecord{record.step, record.time, true, {}, tile};
  } else {
    writer_.write(record);
  }
}

bool ImageLogWriter::joins_run(const PacketRecord& record) {
  if (!run_ || !record.to_flight) return false;
  const auto tile = tile_run_of(record.packet);
  return tile && extend(*run_->tiles, *tile, record.packet);
}

void ImageLogWriter::end_step() {
  end_run();
  writer_.flush();
}

void ImageLogWriter::end_run() {
  if (run_) writer_.write(*std::exchange(run_, std::nullopt));
}

}  // namespace vbar::twins
