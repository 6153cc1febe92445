#include "host_sim/twins/recorded_log.h"

#include <algorithm>
#include <stdexcept>

namespace vbar::twins {

RecordedLog::RecordedLog(const std::filesystem::path& file, const Selection& selection) {
  for (PacketRecord& record : read_packet_log(file).records) {
    if (!record.to_flight) continue;
    const auto view = fsw::packets::parse_packet(record.packet);
    if (!view.ok() || view.value().header.apid != selection.apid ||
        view.value().header.spacecraft != selection.spacecraft)
      continue;
    deliveries_.push_back({record.time, std::move(record.packet)});
  }
  if (deliveries_.empty())
    throw std::runtime_error(file.string() + ": contains no packet of the sensor to be replayed");
  std::stable_sort(deliveries_.begin(), deliveries_.end(),
                   [](const Delivery& a, const Delivery& b) { return a.time < b.time; });
}

std::vector<RecordedLog::Delivery>::const_iterator RecordedLog::first_at_or_after(fsw::GpsTime time) const {
  return std::lower_bound(deliveries_.begin(), deliveries_.end(), time,
                          [](const Delivery& delivery, fsw::GpsTime t) { return delivery.time < t; });
}

std::optional<fsw::GpsTime> RecordedLog::next_epoch(fsw::GpsTime from) const {
  const auto next = first_at_or_after(from);
  if (next == deliveries_.end()) return std::nullopt;
  return next->time;
}

Measurement RecordedLog::measure(const TruthSnapshot& truth) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kReady;
  measurement.available = truth.time;
  measurement.bypasses_link = true;
  for (auto it = first_at_or_after(truth.time); it != deliveries_.end() && it->time == truth.time; ++it)
    measurement.packets.push_back(it->packet);
  return measurement;
}

}  // namespace vbar::twins
