#pragma once
// Source: single-point positions of the servicer's own receiver, for its own orbit.

#include <optional>

#include "fsw/sources/own_gnss/own_gnss_aiding.h"
#include "fsw/sources/source.h"

namespace vbar::fsw::sources {

/// An antenna on the spacecraft.
[[nodiscard]] bool is_valid(const receiver_configuration& configuration);

class OwnGnssSource {
 public:
  static constexpr std::int32_t kUse = navigation_configuration::kUseOwnGnss;
  bool configure(const Configuration& configuration);
  void collect(Context& context, RecordFiler records);
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aiding_.watch(now); }
  void stop(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aid().go_to(AidState::kOff, now); }
  void report(const Telemetry& /*telemetry*/) const {}
  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  /// Its positions do not measure the relative orbit.
  [[nodiscard]] static GpsTime last_measurement() { return {}; }
  [[nodiscard]] const OwnGnssCounters& counters() const { return aiding_.counters(); }

 private:
  OwnGnssAiding aiding_;
  GpsTime filed_until_{-1};
};

}  // namespace vbar::fsw::sources
