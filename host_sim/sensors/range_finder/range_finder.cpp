#include "host_sim/sensors/range_finder/range_finder.h"

#include <cmath>
#include <utility>

#include "host_sim/engine/random_stream.h"

namespace vbar::sensors {

std::optional<LineOfSight> line_of_sight(const twins::TruthSnapshot& truth, const std::string& servicer,
                                         const std::string& target, const fsw::Vector3& boresight_body) {
  const twins::SpacecraftTruth* const own = truth.find(servicer);
  const twins::SpacecraftTruth* const other = truth.find(target);
  if (own == nullptr || other == nullptr || !own->attitude) return std::nullopt;
  const fsw::Vector3 to_target_eci = other->orbit.position_eci - own->orbit.position_eci;
  const fsw::Vector3 to_target_body = own->attitude->q_body_eci * to_target_eci;
  return LineOfSight{to_target_eci.norm(),
                     std::atan2(boresight_body.cross(to_target_body).norm(), boresight_body.dot(to_target_body))};
}

bool is_measurable(const LineOfSight& sight, const RangeFinderSettings& settings) {
  return sight.off_boresight_rad <= settings.half_angle_rad && sight.range_m >= settings.range_min_m &&
         sight.range_m <= settings.range_max_m;
}

RangeFinder::RangeFinder(const RangeFinderSettings& settings, const Place& place, const engine::RandomStream& stream)
    : settings_(settings),
      place_(place),
      stream_(stream),
      bias_m_(settings.bias_sigma_m * stream_.normal()),
      encoder_(place.flight_number, place.unit) {}

std::optional<fsw::GpsTime> RangeFinder::next_epoch(fsw::GpsTime from) const {
  return twins::next_periodic_epoch(place_.start, settings_.period, from);
}

double RangeFinder::noise_m(fsw::GpsTime time) const {
  const auto epoch = static_cast<std::uint64_t>((time - place_.start).ns / settings_.period.ns);
  return settings_.noise_sigma_m * engine::normal_quantile(stream_.uniforms_of(epoch)[0]);
}

twins::Measurement RangeFinder::measure(const twins::TruthSnapshot& truth) {
  twins::Measurement measurement;
  measurement.available = truth.time;
  const auto sight = line_of_sight(truth, place_.servicer, place_.target, settings_.boresight_body);
  if (!sight || !std::isfinite(sight->range_m)) {
    measurement.reason =
        "range finder: the truth lacks \"" + place_.target + "\", or state or attitude of \"" + place_.servicer + "\"";
    return measurement;
  }
  measurement.status = twins::MeasurementStatus::kReady;
  if (!is_measurable(*sight, settings_)) return measurement;
  vbar::range_measurement message{};
  message.range_m = sight->range_m + bias_m_ + noise_m(truth.time);
  measurement.packets.push_back(*encoder_.encode(truth.time, message));
  return measurement;
}

}  // namespace vbar::sensors
