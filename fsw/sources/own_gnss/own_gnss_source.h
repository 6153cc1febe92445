#pragma once
// Source: single-point positions of the servicer's own receiver, for its own orbit.

#include <optional>

#include "fsw/sources/own_gnss/own_gnss_aiding.h"
#include "fsw/sources/source.h"

namespace vbar::fsw::sources {

class OwnGnssSource {
 public:
  /// Nominal phase centre from the centre of mass, m, body axes.
  void configure(const Vector3& antenna_body_m) { aiding_.set_antenna(antenna_body_m); }
  void collect(Context& context, RecordFiler records);
  void fold(const Record& record, Context& context, trunk::Trunk& trunk);
  [[nodiscard]] std::optional<GpsTime> owes(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime now, trunk::Trunk& /*trunk*/) { aiding_.watch(now); }
  void stop(GpsTime now, trunk::Trunk& /*trunk*/) { aid().go_to(AidState::kOff, now); }
  void report(const Telemetry& /*telemetry*/) const {}
  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  [[nodiscard]] const OwnGnssCounters& counters() const { return aiding_.counters(); }

 private:
  OwnGnssAiding aiding_;
  GpsTime filed_until_{-1};
};

}  // namespace vbar::fsw::sources
