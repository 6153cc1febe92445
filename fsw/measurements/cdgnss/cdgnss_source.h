#pragma once
// Source: differences of code and carrier phase between the receivers of servicer and target.

#include <cstdint>
#include <optional>

#include "fsw/core/result.h"
#include "fsw/estimation/gauss_markov.h"
#include "fsw/measurements/cdgnss/cdgnss_aiding.h"
#include "fsw/measurements/source.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::measurements {

// The telecommand of carrier phase, validated and converted to settings.

[[nodiscard]] bool is_valid(const carrier_configuration& configuration);

/// kOutOfRange for an invalid telecommand.
Result<CarrierSettings> carrier_settings(const carrier_configuration& configuration,
                                         const receiver_configuration& receiver);
/// Returns the wander of a single difference, hence of two independent channels.
[[nodiscard]] estimation::GaussMarkov phase_wander_of(const carrier_configuration& configuration);

class CdgnssSource {
 public:
  static constexpr std::int32_t kUse = CdgnssAiding::kSource.bit;
  bool configure(const Configuration& configuration);
  /// Files the epochs of both receivers with one tag, in order.
  void collect(Context& context, RecordFiler records);
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  /// The oldest epoch of the servicer whose counterpart may still arrive.
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime /*now*/) const { return owed_; }
  void watch(GpsTime now, filter::RelativeNavigationFilter& filter) { aiding_.watch(now, filter); }
  void suspend(GpsTime now, filter::RelativeNavigationFilter& filter) { aiding_.suspend(now, filter); }
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }

  /// Time of the latest pair processed.
  [[nodiscard]] GpsTime last_measurement() const { return aiding_.last_pair().value_or(GpsTime{}); }
  [[nodiscard]] bool is_fixed() const { return aiding_.is_fixed(); }
  [[nodiscard]] const CdgnssAiding& aiding() const { return aiding_; }
  /// Epochs of the servicer without a counterpart in time.
  [[nodiscard]] std::int32_t alone() const { return alone_; }
  /// Another source has updated the relative orbit.
  void share_orbit() { aiding_.share_orbit(); }

  void report(const Telemetry& telemetry) const;

  static constexpr int kSilentAfter = 3;

 private:
  CdgnssAiding aiding_;
  Duration pair_wait_ = duration_of_seconds(12);  ///< how long an epoch of the servicer waits for that of the target
  GpsTime decided_until_{-1};                     ///< tags up to this are filed, or were alone
  std::optional<GpsTime> owed_;
  std::int32_t alone_ = 0;
  int alone_in_a_row_ = 0;  ///< from kSilentAfter on the target is silent: nothing is pending until it is heard again
};

}  // namespace vbar::fsw::measurements
