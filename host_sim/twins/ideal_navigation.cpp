#include "host_sim/twins/ideal_navigation.h"

#include <algorithm>

namespace vbar::twins {
namespace {

Measurement failed(const TruthSnapshot& truth, const std::string& reason) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kFailed;
  measurement.available = truth.time;
  measurement.reason = "ideal navigation: " + reason;
  return measurement;
}

void copy(const fsw::Vector3& from, double (&to)[3]) {
  std::copy(from.begin(), from.end(), to);
}

}  // namespace

IdealNavigation::IdealNavigation(const Settings& settings)
    : settings_(settings), encoder_(settings.servicer_number, settings.unit) {}

std::optional<fsw::GpsTime> IdealNavigation::next_epoch(fsw::GpsTime from) const {
  return next_periodic_epoch(settings_.start, settings_.period, from);
}

Measurement IdealNavigation::measure(const TruthSnapshot& truth) {
  const SpacecraftTruth* servicer = truth.find(settings_.servicer);
  const SpacecraftTruth* target = truth.find(settings_.target);
  if (servicer == nullptr) return failed(truth, "no spacecraft \"" + settings_.servicer + "\"");
  if (target == nullptr) return failed(truth, "no spacecraft \"" + settings_.target + "\"");

  vbar::ideal_navigation message{};
  copy(servicer->orbit.position_eci, message.servicer_position_eci);
  copy(servicer->orbit.velocity_eci, message.servicer_velocity_eci);
  copy(target->orbit.position_eci, message.target_position_eci);
  copy(target->orbit.velocity_eci, message.target_velocity_eci);
  std::optional<Packet> packet = encoder_.encode(truth.time, message);
  if (!packet) return failed(truth, "the truth holds a number that is not finite");

  Measurement measurement;
  measurement.status = MeasurementStatus::kReady;
  measurement.available = truth.time;
  measurement.packets.push_back(std::move(*packet));
  return measurement;
}

}  // namespace vbar::twins
