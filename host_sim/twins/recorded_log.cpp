#include "host_sim/twins/recorded_log.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace vbar::twins {

RecordedLog::RecordedLog(const std::filesystem::path& file, const Selection& selection,
                         const MakeTileSource& make_tiles) {
  PacketLog log = read_packet_log(file);
  for (PacketRecord& record : log.records)
    if (record.to_flight) add(std::move(record), selection);
  if (deliveries_.empty())
    throw std::runtime_error(file.string() + ": contains no packet of the sensor to be replayed");
  std::ranges::stable_sort(deliveries_, {}, &Delivery::time);
  if (std::ranges::any_of(deliveries_, [](const Delivery& delivery) { return delivery.tiles.has_value(); })) {
    if (!make_tiles) throw std::runtime_error(file.string() + ": lacks image tiles, and nothing can make them again");
    tiles_ = make_tiles(std::move(log));
    for (const fsw::GpsTime exposure : tiles_->exposures()) epochs_.insert(exposure);
  }
}

void RecordedLog::add(PacketRecord&& record, const Selection& selection) {
  using fsw::packets::Apid;
  const bool wants_images = std::ranges::find(selection.apids, Apid::kImageTile) != selection.apids.end();
  if (record.tiles) {
    if (!wants_images || record.tiles->spacecraft != selection.spacecraft) return;
    if (record.tiles->unit != selection.unit.value_or(record.tiles->unit)) return;
    plays_images_ = true;
  } else {
    const auto view = fsw::packets::parse_packet(record.packet);
    if (!view.ok() || view.value().header.spacecraft != selection.spacecraft) return;
    const fsw::packets::PacketHeader& header = view.value().header;
    if (header.unit != selection.unit.value_or(header.unit)) return;
    const Apid apid = header.apid;
    if (std::ranges::find(selection.apids, apid) == selection.apids.end()) return;
    if (apid == Apid::kImageTile) {
      plays_images_ = true;
      epochs_.insert(header.time);
    }
  }
  epochs_.insert(record.time);
  deliveries_.push_back({record.time, std::move(record.packet), record.tiles});
}

std::vector<RecordedLog::Delivery>::const_iterator RecordedLog::first_at_or_after(fsw::GpsTime time) const {
  return std::lower_bound(deliveries_.begin(), deliveries_.end(), time,
                          [](const Delivery& delivery, fsw::GpsTime t) { return delivery.time < t; });
}

std::optional<fsw::GpsTime> RecordedLog::next_epoch(fsw::GpsTime from) const {
  const auto next = epochs_.lower_bound(from);
  if (next == epochs_.end()) return std::nullopt;
  return *next;
}

Measurement RecordedLog::measure(const TruthSnapshot& truth) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kReady;
  measurement.available = truth.time;
  measurement.bypasses_link = true;
  if (tiles_) {
    measurement.recipe = tiles_->recipe_at(truth.time);
    measurement.recording = tiles_->recording_at(truth.time);
  }
  for (auto it = first_at_or_after(truth.time); it != deliveries_.end() && it->time == truth.time; ++it) {
    if (!it->tiles) {
      measurement.packets.push_back(it->packet);
    } else {
      for (Packet& tile : tiles_->packets_of(*it->tiles)) measurement.packets.push_back(std::move(tile));
    }
  }
  return measurement;
}

}  // namespace vbar::twins
